//! Workers on other machines, over NATS JetStream.
//!
//! NATS is transport, not the queue of record: a chunk is a row of the database before it is published, and its results
//! are stored, fenced by attempt and chunk, before they are acknowledged. Whatever NATS loses costs time only. Order of
//! effects, each of which may happen twice: compute, publish the result, acknowledge the work; receive the result,
//! commit it, acknowledge it.

mod active;
mod admit;
mod answers;
mod config;
mod connect;
mod dispatch;
mod evaluations;
mod measure;
mod members;
mod message;
mod names;
mod plan;
mod queue;
mod reconcile;
mod results;
mod shared;
mod streams;
mod worker;

pub use config::{ClusterConfig, NatsConfig, NatsServers, QueueTarget};
pub use connect::ClusterError;
pub use names::Space;
pub use queue::{NatsQueue, NatsSetup};
pub use worker::{WorkerConfig, run_worker};
