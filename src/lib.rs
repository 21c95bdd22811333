//! # herringbone
//!
//! Contact ratios, loaded tooth contact, mesh-in impact and nonlinear vibration of double-helical gear pairs, as an
//! HTTP service. The rooms of the house, in the order a gear passes through them:
//!
//! ```text
//! job document ─▶ gear ─▶ contact ─▶ impact ─▶ dynamics ─▶ response ─▶ result ─▶ store ─▶ api / web
//! ```
//!
//! [`gear`], [`contact`], [`fe`], [`impact`], [`dynamics`] and [`response`] are the physics: pure functions in SI units.
//! [`job`] is the document that goes in and the result that comes out, [`study`] decides which stages a job needs.
//! With the feature `server` (default) come the store, the work queue, the HTTP interface and the pages.
//! docs/ARCHITECTURE.md has the map and the invariants.

pub mod contact;
pub mod dynamics;
pub mod fe;
pub mod gear;
pub mod impact;
pub mod job;
#[cfg(test)]
pub(crate) mod oracle;
pub mod response;
pub(crate) mod simd;
pub mod study;
pub mod watch;

#[cfg(feature = "server")]
pub mod api;
#[cfg(feature = "server")]
pub mod store;
#[cfg(feature = "server")]
pub mod web;
#[cfg(feature = "server")]
pub mod work;
