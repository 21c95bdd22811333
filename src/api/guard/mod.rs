//! Who gets in. Around every route, in this order: the name the client used for this host ([`host`]), the site whose page
//! made the browser ask ([`origin`]), and the token or a session opened with it ([`credentials`]).
//!
//! Invariant: without a token the service listens on this machine only, or was told that it may be open.

mod access;
mod config;
mod cookie;
mod credentials;
mod failures;
mod host;
mod login;
mod origin;
mod session;
mod token;

pub use access::{Access, AccessError};
pub use config::AccessConfig;
pub use credentials::check_credentials;
pub use host::check_host;
pub use login::{LoginNotice, LoginPage, routes as login_routes};
pub use origin::check_origin;
