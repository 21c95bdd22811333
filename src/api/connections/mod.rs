//! Connections below the requests: how many there may be, how long each may keep the service waiting, and how they end.
//!
//! HTTP/1.1 without TLS: a reverse proxy in front does the rest. A request whose head cannot be read is answered by the
//! HTTP library itself, with 400 or (head too large) 431, no body, and the end of the connection; everything else reaches
//! the router.
//!
//! Invariant: a connection either has a request in progress, or a deadline. Only the former keep a newcomer waiting: with
//! all places taken, the connection that has waited longest without a request makes room.

mod config;
mod connection;
mod crowd;
mod listen;
mod pulse;
mod stream;

pub use config::ConnectionConfig;
pub use listen::{Endings, listen};
