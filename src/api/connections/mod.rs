//! TCP connections: their number, their deadlines and their shutdown.
//!
//! HTTP/1.1 without TLS, which is left to a reverse proxy. A request whose head cannot be parsed is answered by the
//! HTTP library itself, with 400 or (head too large) 431, no body, and the end of the connection; everything else
//! reaches the router.
//!
//! Invariant: a connection either has a request in progress, or a deadline. Only the former keep a new connection
//! waiting: at the bound, the connection that has been idle longest is closed.

mod config;
mod connection;
mod limiter;
mod listen;
mod state;
mod stream;

pub use config::ConnectionConfig;
pub(crate) use listen::{ShutdownTokens, listen};
