//! # herringbone
//!
//! The HTTP simulation service for double-helical gear pairs: job store, work queue, HTTP interface, pages, command line.
//! What is calculated is in the crates `herringbone-physics` (the physics, SI) and `herringbone-job` (documents, results and the
//! stages between them). docs/ARCHITECTURE.md has the map and the invariants.

pub mod api;
pub mod store;
pub mod web;
pub mod work;
