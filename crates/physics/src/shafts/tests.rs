//! Shafts against closed forms, the reference cases and other programs.

mod fixtures;
mod statics;
