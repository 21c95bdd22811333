//! Faults of the real program: killed, out of disk space, on a damaged file, shut down under
//! load.

mod audit;
mod audit_tests;
mod chance;
mod client;
mod clock;
mod corners;
mod database;
mod documents;
mod kill;
mod load;
mod program;
mod room;
mod shutdown;
mod solves;
