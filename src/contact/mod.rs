//! (room under construction)

pub mod iso6336;
