//! Settings and bounds of connections.

use std::time::Duration;

/// Largest head of a request (request line and headers).
pub(super) const MAX_HEAD_BYTES: usize = 32 * 1024;
/// Size of the buffer of each direction of a connection.
pub(super) const MAX_BUFFER_BYTES: usize = 64 * 1024;
/// Time for which incoming bytes are discarded after the last response, so that the client receives the response.
pub(super) const LINGER: Duration = Duration::from_secs(2);

/// Number of connections, and their timeouts.
#[derive(Debug, Clone, clap::Args)]
pub struct ConnectionConfig {
    /// Connections open at once. Beyond it, the one that has waited longest without a request is closed; when all have
    /// requests in progress, further ones wait in the system's queue. Half as many clients may follow jobs.
    #[arg(long, env = "HERRINGBONE_MAX_CONNECTIONS", value_name = "N", default_value_t = 1024,
value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub max_connections: u32,

    /// Longest time from the first byte of a request (or the opening of the connection) to the end of its headers.
    #[arg(long = "header-timeout-s", env = "HERRINGBONE_HEADER_TIMEOUT_S", value_name = "SECONDS", default_value = "10",
          value_parser = duration)]
    pub header_timeout: Duration,

    /// Longest time between requests of one connection.
    #[arg(long = "idle-timeout-s", env = "HERRINGBONE_IDLE_TIMEOUT_S", value_name = "SECONDS", default_value = "75",
          value_parser = duration)]
    pub idle_timeout: Duration,

    /// Longest time in which a client takes nothing of an answer that is ready for it.
    #[arg(long = "write-timeout-s", env = "HERRINGBONE_WRITE_TIMEOUT_S", value_name = "SECONDS", default_value = "30",
          value_parser = duration)]
    pub write_timeout: Duration,
}

impl Default for ConnectionConfig {
    fn default() -> Self {
        Self {
            max_connections: 1024,
            header_timeout: Duration::from_secs(10),
            idle_timeout: Duration::from_secs(75),
            write_timeout: Duration::from_secs(30),
        }
    }
}

impl ConnectionConfig {
    /// Largest number of clients that follow jobs at once (event streams, and waits for the end of a job).
    pub fn max_followers(&self) -> usize {
        (self.max_connections / 2) as usize
    }
}

/// Parses a duration in seconds, fractions allowed: 0.05 to 3600.
///
/// # Errors
/// A message for the command line.
fn duration(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| "a number of seconds is needed".to_owned())?;
    match (0.05..=3600.0).contains(&seconds) {
        true => Ok(Duration::from_secs_f64(seconds)),
        false => Err("permitted: 0.05 to 3600 seconds".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_seconds_within_bounds() {
        assert_eq!(duration("0.25"), Ok(Duration::from_millis(250)));
        for text in ["", "0", "-1", "NaN", "inf", "3601", "10s"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }
}
