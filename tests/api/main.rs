//! The HTTP interface from outside: one module per route, and one each for what all routes share.

mod support;

mod any_request;
mod backup;
mod bearing_forces;
mod cancel_job;
mod command_line;
mod connections;
mod csv;
mod delete_job;
mod documents;
mod errors;
mod header_fields;
mod idempotency;
mod import;
mod kinds;
mod lifecycle;
mod list_jobs;
mod log;
mod metrics;
mod openapi;
mod operation;
mod points;
mod process;
mod read_job;
mod restart;
mod result;
mod retention;
mod reuse;
mod security;
mod series;
mod submit_job;
mod update_job;
mod validate_job;
mod watch_job;
mod watch_jobs;
