//! The geometry against published pairs, closed formulas and independent constructions.

mod corner;
mod feasibility;
mod fixtures;
mod lines;
mod modification;
mod published;
mod tooth;
