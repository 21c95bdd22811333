//! Shafts against closed forms, the reference cases and other programs.

mod dynamics;
mod fixtures;
mod properties;
mod reduction;
mod reference;
mod statics;
