//! # herringbone-physics
//!
//! Contact ratios, loaded tooth contact, mesh-in impact and nonlinear vibration of double-helical gear pairs: pure functions in
//! SI units, without I/O, clock, async or HTTP. The modules, in the order a gear passes through them:
//!
//! ```text
//! gear ─▶ contact ─▶ impact ─▶ dynamics ─▶ response
//! ```

pub mod compliance;
pub mod contact;
pub mod dynamics;
pub mod fe;
pub mod gear;
pub mod impact;
pub mod iso6336;
pub mod numerics;
pub mod response;
pub(crate) mod simd;
pub mod watch;
