//! Access control, around every route, in this order: header fields that contradict each other ([`header_fields`]), the
//! host name in the request ([`host`]), the origin of the page that sent it ([`origin`]), and the token or a session
//! opened with it ([`credentials`]).
//!
//! Invariant: without a token the service listens on this machine only, or was started with `--insecure`.

mod access;
mod config;
mod cookie;
mod credentials;
mod failure_limiter;
mod header_fields;
mod host;
mod login;
mod origin;
mod session;
mod token;

pub use access::{Access, AccessError};
pub use config::AccessConfig;
pub(super) use credentials::check_credentials;
pub(super) use header_fields::check_header_fields;
pub(super) use host::check_host;
pub(super) use login::routes as login_routes;
pub use login::{LoginNotice, LoginRenderer};
pub(super) use origin::check_origin;
