//! The only HTTP. One file per endpoint in [`routes`]; what they share is what a request says ([`request`]), what a job
//! looks like from outside ([`view`]) and how everything that goes wrong is answered ([`problem`]).
//!
//! Invariant: every answer with a status of 400 or above is `application/problem+json` in one schema, with a code of a
//! closed list; the envelope turns what the framework itself refuses into the same form. (A request whose head cannot be
//! read never gets there: see [`connections`].)

mod columns;
mod config;
mod connections;
mod csv;
mod downsample;
mod envelope;
mod guard;
mod held;
mod openapi;
mod points;
mod problem;
mod request;
mod router;
mod routes;
mod serve;
mod state;
mod telemetry;
mod view;

pub use config::{HttpConfig, MAX_BODY_BYTES, MAX_WAIT_S};
pub use connections::ConnectionConfig;
pub use csv::{Decimal, Field as CsvField};
pub use guard::{Access, AccessConfig, AccessError, LoginNotice, LoginPage};
pub use openapi::openapi_json;
pub use problem::{Problem, ProblemCode};
pub use router::{Pages, router};
pub use serve::serve;
pub use state::AppState;
