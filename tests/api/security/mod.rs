//! Access control, and information in responses.

mod escaping;
mod headers;
mod host;
mod leaks;
mod login;
mod origin;
mod start;
mod token;

use crate::support::*;
use herringbone::api::{AccessConfig, HttpConfig};

pub(crate) const TOKEN: &str = "correct-horse-battery-staple";

/// A service with a token.
pub(crate) async fn guarded() -> App {
    let directory = tempfile::tempdir().expect("temporary directory");
    let file = directory.path().join("token");
    std::fs::write(&file, format!("{TOKEN}\n")).expect("written");
    let access = AccessConfig { token_file: Some(file), ..AccessConfig::default() };
    app_with_http(HttpConfig { access, ..HttpConfig::default() }).await
}

/// The header of someone who has the token.
pub(crate) fn bearer() -> (&'static str, String) {
    ("authorization", format!("Bearer {TOKEN}"))
}
