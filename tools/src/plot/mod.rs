//! Plots as SVG: fields with linear or logarithmic axes, curves, points, bars, markers, labels that avoid each other,
//! coloured maps.

mod field;
pub mod image;
mod labels;
mod marker;
mod scale;
mod sheet;

pub use field::Field;
pub use labels::{Label, place};
pub use marker::{Marker, Shape};
pub use scale::{Scale, power_of_ten, time_label};
pub use sheet::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, Sheet, Style};
