//! The geometry against published pairs, closed formulas and independent constructions.

mod coast;
mod corner;
mod engagement;
mod feasibility;
mod lines;
mod modification;
mod outline;
mod published;
mod tooth;
