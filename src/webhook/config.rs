//! The settings of webhooks.

use super::client::Target;
use super::network::Network;
use super::signature::SigningKeys;
use std::path::PathBuf;

/// Addresses that are told of the ends of jobs.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct WebhookConfig {
    /// Address that is told of the end of every job (Standard Webhooks 1.0); may be given several times, in the
    /// variable separated by commas.
    #[arg(
        long,
        env = "HERRINGBONE_WEBHOOK_URL",
        value_name = "URL",
        value_delimiter = ',',
        requires = "webhook_secret_file"
    )]
    pub webhook_url: Vec<String>,

    /// File with the secret by which messages are signed (`whsec_…`); with several lines, each signs, the newest first.
    #[arg(long, env = "HERRINGBONE_WEBHOOK_SECRET_FILE", value_name = "FILE")]
    pub webhook_secret_file: Option<PathBuf>,

    /// Network in which addresses may be, with any port, besides the public internet with the ports 80 and 443; may be
    /// given several times, in the variable separated by commas.
    #[arg(long, env = "HERRINGBONE_WEBHOOK_ALLOW", value_name = "NETWORK", value_delimiter = ',')]
    pub webhook_allow: Vec<Network>,
}

/// A setting that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum WebhookError {
    #[error("--webhook-url {url}: {reason}")]
    Url { url: String, reason: String },
    #[error("--webhook-secret-file {path}: {reason}")]
    Secret { path: String, reason: String },
    #[error("certificates of the system: {0}")]
    Certificates(String),
}

impl WebhookConfig {
    /// Checks the addresses and reads the secrets.
    ///
    /// # Errors
    /// An address is none, or the file of the secrets cannot be read.
    pub(super) fn read(&self) -> Result<SigningKeys, WebhookError> {
        for url in &self.webhook_url {
            Target::of(url).map_err(|reason| WebhookError::Url { url: origin(url), reason })?;
        }
        let Some(path) = &self.webhook_secret_file else { return Ok(SigningKeys::default()) };
        let wrong = |reason: String| WebhookError::Secret { path: path.display().to_string(), reason };
        let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
        SigningKeys::read(&text).map_err(wrong)
    }
}

/// An address without its path, which may hold a secret of the receiver.
pub(crate) fn origin(url: &str) -> String {
    let (scheme, rest) = url.split_once("://").unwrap_or(("", url));
    let host = rest.split(['/', '?', '#']).next().unwrap_or_default();
    let host = host.rsplit('@').next().unwrap_or_default();
    format!("{scheme}://{host}/…")
}
