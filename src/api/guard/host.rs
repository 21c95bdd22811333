//! The check of the header `Host`, against DNS rebinding: a page of another site can have its own name resolve to this
//! machine; the browser then sends that name in `Host`.

use super::access::Access;
use crate::api::problem::{ApiError, ProblemCode};
use axum::extract::{Request, State};
use axum::http::header::HOST;
use axum::http::uri::Authority;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::net::IpAddr;
use std::str::FromStr;

/// Paths without the check: probes may use any host name.
const PROBES: [&str; 2] = ["/healthz", "/readyz"];

/// A host name or address, without a port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HostName(String);

/// The names of this host, besides loopback addresses.
pub(crate) struct AllowedHosts(Vec<HostName>);

impl FromStr for HostName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let authority: Option<Authority> = text.parse().ok();
        match authority {
            Some(authority) if authority.host() == text && !text.is_empty() => Ok(Self(text.to_ascii_lowercase())),
            _ => Err("a host's name or address is needed, without a port".to_owned()),
        }
    }
}

impl AllowedHosts {
    pub(crate) fn new(names: Vec<HostName>) -> Self {
        Self(names)
    }

    /// Whether `authority` (`name[:port]`) names this host.
    fn contains(&self, authority: &str) -> bool {
        let Ok(authority) = authority.parse::<Authority>() else { return false };
        let host = authority.host().to_ascii_lowercase();
        !authority.as_str().contains('@') && (is_loopback(&host) || self.0.iter().any(|name| name.0 == host))
    }
}

fn is_loopback(host: &str) -> bool {
    let address = host.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).unwrap_or(host);
    host == "localhost" || address.parse::<IpAddr>().is_ok_and(|address| address.to_canonical().is_loopback())
}

/// Middleware: refuses requests for other hosts. A request without a host (HTTP/1.0) does not come from a browser and
/// passes.
pub(crate) async fn check_host(State(access): State<Access>, request: Request, next: Next) -> Response {
    let Some(hosts) = access.hosts() else { return next.run(request).await };
    let names = request.headers().get_all(HOST).into_iter().map(|value| value.to_str().unwrap_or_default());
    let mut names = names.chain(request.uri().authority().map(Authority::as_str));
    if !names.all(|name| hosts.contains(name)) && !PROBES.contains(&request.uri().path()) {
        let detail = "The header Host does not name this service.";
        return ApiError::new(ProblemCode::MisdirectedRequest, detail).into_response();
    }
    next.run(request).await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_this_machine_and_given_ones() {
        let hosts = AllowedHosts::new(vec!["Gears.example".parse().unwrap(), "[2001:db8::1]".parse().unwrap()]);
        for ours in [
            "localhost",
            "LOCALHOST:80",
            "127.0.0.1:8080",
            "127.1.2.3",
            "[::1]:1",
            "gears.EXAMPLE:8",
            "[2001:db8::1]:8",
        ] {
            assert!(hosts.contains(ours), "{ours}");
        }
        for other in [
            "",
            "evil.example",
            "localhost.evil.example",
            "evil.example@localhost",
            "localhost@evil.example",
            "10.0.0.1",
            "127.0.0.1.evil.example",
            "localhost.",
            "sub.gears.example",
            "gears.example.evil",
            "[::2]",
            "localhost:80:80",
            "a b",
        ] {
            assert!(!hosts.contains(other), "{other}");
        }
    }

    #[test]
    fn an_allowed_host_is_a_name_without_a_port() {
        for wrong in ["", "gears.example:80", "http://gears.example", "a@b", "gears example", "/"] {
            assert!(wrong.parse::<HostName>().is_err(), "{wrong}");
        }
    }
}
