//! The listen address, and the limits of requests.

use super::connections::ConnectionConfig;
use super::guard::AccessConfig;
use std::net::SocketAddr;
use std::time::Duration;

/// Largest request body.
pub const MAX_BODY_BYTES: usize = 1 << 20;
/// Largest file that is imported.
pub const MAX_IMPORT_BYTES: usize = 32 << 20;
/// Most imports at once, from the reading of the file until it is answered: each takes a few times its file in memory.
pub(super) const MAX_IMPORTS: usize = 2;
/// Longest wait of `Prefer: wait=`, in seconds.
pub const MAX_WAIT_S: u64 = 30;
/// Jobs per page of a list: default and maximum.
pub(super) const DEFAULT_PAGE: u32 = 50;
pub(super) const MAX_PAGE: u32 = 200;
/// Rows per page of a sweep's points: default and maximum.
pub(super) const DEFAULT_ROWS: u64 = 1000;
pub(super) const MAX_ROWS: u64 = 10_000;
/// Largest number of rows of a sweep: its points, with increasing and decreasing values.
pub(super) const MAX_SWEEP_ROWS: u64 = herringbone_job::MAX_SWEEP_POINTS as u64 * 2;
/// Points of a downsampled series: default and bounds.
pub(super) const DEFAULT_POINTS: u64 = 2000;
pub(super) const MIN_POINTS: u64 = 4;
pub(super) const MAX_POINTS: u64 = 100_000;
/// Largest number of samples in a response without downsampling.
pub(super) const MAX_RAW_POINTS: u64 = 1_000_000;
/// Largest number of large bodies in memory at once, from the reading of their data until they are sent. The samples of
/// a series take 8 MB at most (1e6), a result or a table as much as its text.
pub(super) const MAX_LARGE_BODIES: usize = 16;
/// Length from which on a body counts as large; below, it may be in memory once for every connection.
pub(super) const LARGE_BODY_BYTES: u64 = 256 * 1024;
/// Largest number of series, or large texts, that are read and unpacked at once: while it is, each takes up to four
/// times the memory of its samples or its text.
pub(super) const MAX_LARGE_READS: usize = 4;
/// Longest notes of a job, and longest text that a list is searched for.
pub(super) const MAX_NOTES_CHARS: usize = 5000;
pub(super) const MAX_SEARCH_CHARS: usize = 200;
/// Longest `Idempotency-Key`.
pub(super) const MAX_KEY_CHARS: usize = 255;
/// Longest `X-Request-Id` accepted from a client.
pub(super) const MAX_REQUEST_ID_CHARS: usize = 128;
/// Values of `Retry-After`, in seconds: of a job that has not ended, of a full queue or database, of the limit of
/// followers, of the limit of large bodies.
pub(super) const RETRY_LIVE_S: u64 = 1;
pub(super) const RETRY_FULL_S: u64 = 5;
pub(super) const RETRY_FOLLOW_S: u64 = 5;
pub(super) const RETRY_LARGE_S: u64 = 5;
/// Interval of keep-alive comments in event streams.
pub(super) const KEEP_ALIVE: Duration = Duration::from_secs(15);

/// Listen address, limits, access control and connections.
#[derive(Debug, Clone, clap::Args)]
pub struct HttpConfig {
    /// Address to listen on; port 0 takes any free one.
    #[arg(long, env = "HERRINGBONE_LISTEN", value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    pub listen: SocketAddr,

    /// Longest time until the answer to a request begins (event streams then go on).
    #[arg(long, env = "HERRINGBONE_REQUEST_TIMEOUT_S", value_name = "SECONDS", default_value_t = 60,
          value_parser = clap::value_parser!(u32).range(i64::from(MAX_WAIT_S as u32) + 5..=3600))]
    pub request_timeout_s: u32,

    #[command(flatten)]
    pub access: AccessConfig,

    #[command(flatten)]
    pub connections: ConnectionConfig,
}

impl HttpConfig {
    pub fn request_timeout(&self) -> Duration {
        Duration::from_secs(self.request_timeout_s.into())
    }

    /// Longest wait of a request for the place of a large body, and for the permit to read it: both together end before
    /// the request times out.
    pub(super) fn large_body_wait(&self) -> Duration {
        self.request_timeout() / 3
    }
}

impl Default for HttpConfig {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from(([127, 0, 0, 1], 8080)),
            request_timeout_s: 60,
            access: AccessConfig::default(),
            connections: ConnectionConfig::default(),
        }
    }
}
