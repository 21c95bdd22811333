//! The state of access control.

use super::config::AccessConfig;
use super::failure_limiter::FailureLimiter;
use super::host::AllowedHosts;
use super::session::Sessions;
use super::token::{Token, TokenError};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Allowed hosts and authentication. Cheap to clone.
#[derive(Clone)]
pub struct Access(Arc<AccessInner>);

struct AccessInner {
    hosts: Option<AllowedHosts>,
    authenticator: Option<Authenticator>,
}

/// The token, the sessions opened with it, and the limiter of failed attempts.
pub(crate) struct Authenticator {
    pub token: Token,
    sessions: Mutex<Sessions>,
    failures: Mutex<FailureLimiter>,
}

/// An access configuration with which the service does not start.
#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    #[error(transparent)]
    Token(#[from] TokenError),
    #[error(
        "{listen} can be reached from other machines, and nothing would ask them for credentials. Give a token with \
         --token-file FILE (HERRINGBONE_TOKEN_FILE), listen on 127.0.0.1, or say --insecure (HERRINGBONE_INSECURE=true) if \
         something else keeps strangers out"
    )]
    Open { listen: SocketAddr },
}

impl Access {
    /// Reads the token, if one is configured, and decides whether the service may listen there.
    ///
    /// # Errors
    /// The token file holds no usable token, or there is no token and other machines could reach the service.
    pub fn new(config: &AccessConfig, listen: SocketAddr) -> Result<Self, AccessError> {
        let token = config.token_file.as_deref().map(Token::read).transpose()?;
        let is_local = listen.ip().to_canonical().is_loopback();
        if token.is_none() && !is_local {
            if !config.insecure {
                return Err(AccessError::Open { listen });
            }
            tracing::warn!(%listen, "reachable from other machines, and nothing asks for credentials (--insecure)");
        }
        // Without a token, a page of another site could reach the service by DNS rebinding.
        let is_checked = !config.allowed_hosts.is_empty() || (token.is_none() && is_local);
        let hosts = is_checked.then(|| AllowedHosts::new(config.allowed_hosts.clone()));
        let authenticator =
            token.map(|token| Authenticator { token, sessions: Mutex::default(), failures: Mutex::default() });
        Ok(Self(Arc::new(AccessInner { hosts, authenticator })))
    }

    /// Whether requests need a token or a session.
    pub fn has_token(&self) -> bool {
        self.0.authenticator.is_some()
    }

    /// The host names that are accepted; `None` when all are.
    pub(in crate::api) fn hosts(&self) -> Option<&AllowedHosts> {
        self.0.hosts.as_ref()
    }

    /// The authenticator; `None` when the service needs no credentials.
    pub(in crate::api) fn authenticator(&self) -> Option<&Authenticator> {
        self.0.authenticator.as_ref()
    }
}

impl Authenticator {
    pub(crate) fn sessions(&self) -> MutexGuard<'_, Sessions> {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn failures(&self) -> MutexGuard<'_, FailureLimiter> {
        self.failures.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn access(listen: &str, insecure: bool, hosts: &[&str]) -> Result<Access, AccessError> {
        let allowed_hosts = hosts.iter().map(|name| name.parse().unwrap()).collect();
        let config = AccessConfig { insecure, allowed_hosts, token_file: None };
        Access::new(&config, listen.parse().unwrap())
    }

    #[test]
    fn without_a_token_only_loopback_addresses_unless_insecure() {
        for local in ["127.0.0.1:1", "127.8.8.8:1", "[::1]:1", "[::ffff:127.0.0.1]:1"] {
            assert!(access(local, false, &[]).unwrap().hosts().is_some(), "{local}");
        }
        for reachable in ["0.0.0.0:1", "[::]:1", "192.168.0.7:1", "[::ffff:10.0.0.1]:1"] {
            let refused = access(reachable, false, &[]).err().unwrap().to_string();
            assert!(refused.contains(reachable) && refused.contains("--token-file"), "{refused}");
            assert!(access(reachable, true, &[]).unwrap().hosts().is_none(), "{reachable}");
            assert!(access(reachable, true, &["gears.example"]).unwrap().hosts().is_some(), "{reachable}");
        }
    }
}
