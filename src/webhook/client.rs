//! One try of a delivery: resolve, check, connect, post.

use super::network::{Network, is_permitted};
use axum::http::header::{CONTENT_TYPE, HOST, USER_AGENT};
use axum::http::uri::Scheme;
use axum::http::{Request, Uri};
use futures_util::future::BoxFuture;
use http_body_util::{BodyExt, Full, Limited};
use hyper::body::Bytes;
use hyper::client::conn::http1;
use hyper_util::rt::TokioIo;
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::pki_types::ServerName;
use tokio_rustls::rustls::{ClientConfig, RootCertStore};

/// Most bytes of an answer that are read.
const MAX_ANSWER_BYTES: usize = 16 << 10;

/// Finds the addresses of a host.
pub type Resolve = Arc<dyn Fn(String, u16) -> BoxFuture<'static, io::Result<Vec<SocketAddr>>> + Send + Sync>;

/// The resolver of the system.
pub(super) fn system_resolver() -> Resolve {
    Arc::new(|host, port| Box::pin(async move { Ok(tokio::net::lookup_host((host, port)).await?.collect()) }))
}

/// An address that is posted to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Target {
    is_tls: bool,
    host: String,
    port: u16,
    path: String,
    /// The header `Host`.
    authority: String,
}

impl Target {
    /// Reads an address.
    ///
    /// # Errors
    /// It is not an address over HTTP, or names a user.
    pub(super) fn of(url: &str) -> Result<Self, String> {
        let uri: Uri = url.parse().map_err(|error| format!("is no address: {error}"))?;
        let is_tls = match uri.scheme() {
            Some(scheme) if *scheme == Scheme::HTTPS => true,
            Some(scheme) if *scheme == Scheme::HTTP => false,
            _ => return Err("needs http:// or https://".to_owned()),
        };
        let authority = uri.authority().ok_or("has no host")?;
        if authority.as_str().contains('@') {
            return Err("may not have a user or password".to_owned());
        }
        let host = authority.host().trim_start_matches('[').trim_end_matches(']').to_owned();
        if host.is_empty() {
            return Err("has no host".to_owned());
        }
        let port = authority.port_u16().unwrap_or(if is_tls { 443 } else { 80 });
        let path = uri.path_and_query().map_or("/", |path| path.as_str()).to_owned();
        Ok(Self { is_tls, host, port, path, authority: authority.as_str().to_owned() })
    }
}

/// A message with its headers.
#[derive(Debug, Clone)]
pub(super) struct Message {
    pub id: String,
    pub time_s: i64,
    pub signature: String,
    pub body: String,
}

/// Encrypted connections to whoever has a certificate that the system trusts.
///
/// # Errors
/// TLS cannot be set up.
pub fn tls_of_system() -> Result<TlsConnector, String> {
    let mut roots = RootCertStore::empty();
    let found = rustls_native_certs::load_native_certs();
    roots.add_parsable_certificates(found.certs);
    let provider = Arc::new(tokio_rustls::rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|error| error.to_string())?
        .with_root_certificates(roots)
        .with_no_client_auth();
    Ok(TlsConnector::from(Arc::new(config)))
}

/// Posts messages.
#[derive(Clone)]
pub(super) struct Client {
    resolve: Resolve,
    permitted: Vec<Network>,
    tls: TlsConnector,
}

impl Client {
    /// A client that trusts the certificates of the system.
    ///
    /// # Errors
    /// TLS cannot be set up.
    pub(super) fn new(resolve: Resolve, permitted: Vec<Network>) -> Result<Self, String> {
        Ok(Self { resolve, permitted, tls: tls_of_system()? })
    }

    /// Posts a message and returns the status of the answer. Redirects are answers, they are not followed.
    ///
    /// # Errors
    /// Why there is no answer.
    pub(super) async fn post(&self, url: &str, message: &Message) -> Result<u16, String> {
        let target = Target::of(url)?;
        let stream = self.connect(&target).await?;
        let text = |error: &dyn std::fmt::Display| error.to_string();
        if !target.is_tls {
            return exchange(stream, &target, message).await;
        }
        let name = match target.host.parse::<IpAddr>() {
            Ok(address) => ServerName::IpAddress(address.into()),
            Err(_) => ServerName::try_from(target.host.clone()).map_err(|error| text(&error))?,
        };
        let stream = self.tls.connect(name, stream).await.map_err(|error| format!("TLS: {error}"))?;
        exchange(stream, &target, message).await
    }

    /// Connects to an address of the host that was checked: the name is not resolved again.
    async fn connect(&self, target: &Target) -> Result<TcpStream, String> {
        let addresses = match target.host.parse::<IpAddr>() {
            Ok(address) => vec![SocketAddr::new(address, target.port)],
            Err(_) => (self.resolve)(target.host.clone(), target.port)
                .await
                .map_err(|error| format!("the host is not found: {error}"))?,
        };
        if addresses.is_empty() {
            return Err("the host has no address".to_owned());
        }
        if !addresses.iter().all(|address| is_permitted(address.ip(), address.port(), &self.permitted)) {
            return Err("the host has an address that is not permitted (--webhook-allow)".to_owned());
        }
        let mut last = String::new();
        for address in addresses {
            match TcpStream::connect(address).await {
                Ok(stream) => return Ok(stream),
                Err(error) => last = error.to_string(),
            }
        }
        Err(format!("no connection: {last}"))
    }
}

async fn exchange<S>(stream: S, target: &Target, message: &Message) -> Result<u16, String>
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let (mut sender, connection) =
        http1::handshake(TokioIo::new(stream)).await.map_err(|error| format!("no connection: {error}"))?;
    let connection = tokio::spawn(async move {
        // What goes wrong is told by the request.
        let _ = connection.await;
    });
    let request = Request::post(target.path.as_str())
        .header(HOST, target.authority.as_str())
        .header(CONTENT_TYPE, "application/json")
        .header(USER_AGENT, concat!("herringbone/", env!("CARGO_PKG_VERSION")))
        .header("webhook-id", message.id.as_str())
        .header("webhook-timestamp", message.time_s)
        .header("webhook-signature", message.signature.as_str())
        .body(Full::new(Bytes::from(message.body.clone())))
        .map_err(|error| error.to_string())?;
    let answer = sender.send_request(request).await.map_err(|error| format!("no answer: {error}"));
    let status = match answer {
        Ok(answer) => {
            let status = answer.status().as_u16();
            // Read, so that the receiver can write it; what it says does not matter.
            let _ = Limited::new(answer.into_body(), MAX_ANSWER_BYTES).collect().await;
            Ok(status)
        }
        Err(error) => Err(error),
    };
    connection.abort();
    status
}
