//! Webhooks (Standard Webhooks 1.0): other programs are told of the ends of jobs.
//!
//! What is to be told is a row of the database, written with the job's event (`store::webhooks`), so that nothing is
//! lost between the two. The deliverer takes the rows that are due, signs and posts them, and writes down what came of
//! it.

mod client;
mod config;
mod deliver;
mod network;
mod signature;
#[cfg(test)]
mod tests;

pub use client::{Resolve, tls_of_system};
pub(crate) use config::origin;
pub use config::{WebhookConfig, WebhookError};
pub use deliver::{Deliverer, Setting};
pub use network::Network;
