//! # herringbone
//!
//! The HTTP simulation service for double-helical gear pairs: database, job queue, HTTP interface and web pages. The
//! calculation is in the crates `herringbone-physics` (the physics, in SI units) and `herringbone-job` (documents,
//! results and the stages between them). docs/ARCHITECTURE.md has the map of the modules and the invariants.

pub mod api;
pub mod store;
pub mod web;
pub mod webhook;
pub mod work;
