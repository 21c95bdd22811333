//! Settings of a service with workers on other machines, and of the connection to NATS.

use super::names::Space;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Where jobs are computed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum QueueTarget {
    /// In this process.
    Local,
    /// On workers that are reached through these NATS servers.
    Nats(NatsServers),
}

/// Addresses of the servers of one NATS.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NatsServers(Vec<String>);

impl NatsServers {
    pub(super) fn addresses(&self) -> &[String] {
        &self.0
    }
}

impl std::fmt::Display for NatsServers {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&self.0.join(","))
    }
}

impl FromStr for NatsServers {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let servers: Vec<String> = text.split(',').map(|one| one.trim().to_owned()).collect();
        for server in &servers {
            let rest = server.strip_prefix("nats://").or_else(|| server.strip_prefix("tls://"));
            match rest {
                None | Some("") => return Err("give nats://HOST:PORT or tls://HOST:PORT".to_owned()),
                Some(rest) if rest.contains('@') => {
                    return Err("a user in the address would be logged: use --nats-user or --nats-creds".to_owned());
                }
                Some(_) => {}
            }
        }
        Ok(Self(servers))
    }
}

impl FromStr for QueueTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "local" => Ok(Self::Local),
            servers => servers.parse().map(Self::Nats).map_err(|error| format!("give local, or an address: {error}")),
        }
    }
}

/// Settings of the service.
#[derive(Debug, Clone, clap::Args)]
pub struct ClusterConfig {
    /// Where jobs are computed: `local` in this process, or by workers that take them from NATS at
    /// `nats://HOST:PORT` (several servers of one NATS with commas between them; `tls://` for an encrypted connection).
    #[arg(long, env = "HERRINGBONE_QUEUE", value_name = "local|nats://HOST:PORT", default_value = "local")]
    pub queue: QueueTarget,

    /// Servers of the NATS that keep each message.
    #[arg(long, env = "HERRINGBONE_NATS_REPLICAS", value_name = "N", default_value_t = 1,
          value_parser = clap::value_parser!(u8).range(1..=5))]
    pub nats_replicas: u8,

    /// Name under which this service and its workers find each other; one of its own, kept in the database, when not
    /// given.
    #[arg(long, env = "HERRINGBONE_SPACE", value_name = "NAME")]
    pub space: Option<Space>,

    /// Jobs that the service computes itself besides, first of all those that are not worth sending.
    #[arg(long, env = "HERRINGBONE_LOCAL_WORKERS", value_name = "N", default_value_t = 0,
          value_parser = clap::value_parser!(u32).range(0..=1024))]
    pub local_workers: u32,

    /// Results that may wait in NATS, in MiB; beyond that the workers keep theirs and take no more work.
    #[arg(long, env = "HERRINGBONE_NATS_RESULTS_MIB", value_name = "MIB", default_value_t = 2048,
          value_parser = clap::value_parser!(u32).range(64..=1_048_576))]
    pub nats_results_mib: u32,

    /// How long a worker may be silent before its work is given to another one.
    #[arg(long, env = "HERRINGBONE_ACK_WAIT_S", value_name = "SECONDS", default_value_t = 30,
          value_parser = clap::value_parser!(u32).range(2..=600))]
    pub ack_wait_s: u32,

    #[command(flatten)]
    pub nats: NatsConfig,
}

impl ClusterConfig {
    pub(super) fn ack_wait(&self) -> Duration {
        Duration::from_secs(self.ack_wait_s.into())
    }
}

/// Settings of the connection to NATS.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct NatsConfig {
    /// Certificates of the authorities that sign the certificates of the NATS servers (PEM).
    #[arg(long, env = "HERRINGBONE_NATS_CA", value_name = "FILE")]
    pub nats_ca: Option<PathBuf>,

    /// Certificate by which this program is known to the NATS servers (PEM).
    #[arg(long, env = "HERRINGBONE_NATS_CERT", value_name = "FILE", requires = "nats_key")]
    pub nats_cert: Option<PathBuf>,

    /// Key of that certificate (PEM).
    #[arg(long, env = "HERRINGBONE_NATS_KEY", value_name = "FILE", requires = "nats_cert")]
    pub nats_key: Option<PathBuf>,

    /// Credentials of the NATS user (a file with JWT and seed).
    #[arg(long, env = "HERRINGBONE_NATS_CREDS", value_name = "FILE", conflicts_with = "nats_user")]
    pub nats_creds: Option<PathBuf>,

    /// Name of the NATS user.
    #[arg(long, env = "HERRINGBONE_NATS_USER", value_name = "NAME", requires = "nats_password_file")]
    pub nats_user: Option<String>,

    /// File with the password of the NATS user, in its first line.
    #[arg(long, env = "HERRINGBONE_NATS_PASSWORD_FILE", value_name = "FILE", requires = "nats_user")]
    pub nats_password_file: Option<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_those_of_nats_servers_and_contain_no_secrets() {
        assert_eq!("local".parse(), Ok(QueueTarget::Local));
        let servers: NatsServers = "nats://a:4222, tls://b".parse().unwrap();
        assert_eq!(servers.addresses(), ["nats://a:4222", "tls://b"]);
        for bad in ["", "http://a", "nats://", "nats://user:secret@a:4222", "nats://a,b"] {
            assert!(bad.parse::<QueueTarget>().is_err(), "{bad}");
        }
    }
}
