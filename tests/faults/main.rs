//! What happens when things go wrong: the real program, killed, out of room, on a damaged file, asked to stop under
//! load.

mod audit;
mod chance;
mod client;
mod clock;
mod database;
mod documents;
mod kill;
mod load;
mod program;
mod room;
mod shutdown;
mod solves;
