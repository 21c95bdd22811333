//! Three-dimensional finite elements of one gear: flexibility of a flank under forces anywhere on it and on its
//! neighbours.
//!
//! One helix half of one member: real involute, rack-generated fillet, tip and root land on a blank that is held on a
//! cylinder over the face width, end faces free, all teeth present. One sector is meshed (`surface`, `section`),
//! screwed along the axis (`operator`, `spline`), eliminated up to its cut faces (`dissection`, `condense`) and put
//! together to the whole gear by its circumferential waves (`cyclic`). Loads and responses are hats on the flank
//! (`loads`); the half-space part of the same hats is taken away (`half_space`), so that the rest is smooth and can be
//! interpolated to contact lines.
//!
//! Everything is SI. Coordinates along the face are entry coordinates of [`crate::gear`].

mod condense;
mod cyclic;
mod dissection;
mod flexibility;
mod half_space;
mod input;
mod loads;
mod operator;
mod section;
mod sector;
mod sizes;
mod spline;
mod stored;
mod surface;

pub use flexibility::FlankFlexibility;
pub use input::{FeError, FlankFlexibilityInput, FlankKey, MESH_VERSION, Resolution};
pub(crate) use sizes::load_grid_size;

#[cfg(test)]
mod tests;
