//! What the guards know.

use super::config::AccessConfig;
use super::failures::Failures;
use super::host::Hosts;
use super::session::Sessions;
use super::token::{Token, TokenError};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Who gets in. Cheap to clone.
#[derive(Clone)]
pub struct Access(Arc<Inner>);

struct Inner {
    hosts: Option<Hosts>,
    lock: Option<Lock>,
}

/// The token, and what was opened or tried with it.
pub struct Lock {
    pub token: Token,
    sessions: Mutex<Sessions>,
    failures: Mutex<Failures>,
}

/// Why the service does not start.
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
    /// When the token is unusable, or there is none and other machines could reach the service.
    pub fn new(config: &AccessConfig, listen: SocketAddr) -> Result<Self, AccessError> {
        let token = config.token_file.as_deref().map(Token::read).transpose()?;
        let is_local = listen.ip().to_canonical().is_loopback();
        if token.is_none() && !is_local {
            if !config.insecure {
                return Err(AccessError::Open { listen });
            }
            tracing::warn!(%listen, "reachable from other machines, and nothing asks for credentials (--insecure)");
        }
        // Without a token a page of another site could reach the service under a name of its own that leads here.
        let is_checked = !config.allowed_hosts.is_empty() || (token.is_none() && is_local);
        let hosts = is_checked.then(|| Hosts::new(config.allowed_hosts.clone()));
        let lock = token.map(|token| Lock { token, sessions: Mutex::default(), failures: Mutex::default() });
        Ok(Self(Arc::new(Inner { hosts, lock })))
    }

    /// Whether requests need a token or a session.
    pub fn has_token(&self) -> bool {
        self.0.lock.is_some()
    }

    /// `None` when every name is taken.
    pub(in crate::api) fn hosts(&self) -> Option<&Hosts> {
        self.0.hosts.as_ref()
    }

    /// `None` when the service is open.
    pub(in crate::api) fn lock(&self) -> Option<&Lock> {
        self.0.lock.as_ref()
    }
}

impl Lock {
    pub fn sessions(&self) -> MutexGuard<'_, Sessions> {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub fn failures(&self) -> MutexGuard<'_, Failures> {
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
    fn open_to_this_machine_or_on_demand_only() {
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
