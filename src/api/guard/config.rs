//! Settings of access control.

use super::host::HostName;
use std::path::PathBuf;

/// Token file and host names.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct AccessConfig {
    /// File with the token that every request has to carry: one word of 16 to 1024 visible ASCII characters. Without it
    /// the service is open, and listens on this machine only.
    #[arg(long, env = "HERRINGBONE_TOKEN_FILE", value_name = "FILE")]
    pub token_file: Option<PathBuf>,

    /// Listen on an address that other machines reach though there is no token.
    #[arg(long, env = "HERRINGBONE_INSECURE")]
    pub insecure: bool,

    /// A name of this host that clients may use, besides localhost and loopback addresses; any port. With a token or
    /// `--insecure` every name is taken unless some are given here.
    #[arg(long = "allowed-host", env = "HERRINGBONE_ALLOWED_HOSTS", value_name = "NAME", value_delimiter = ',')]
    pub allowed_hosts: Vec<HostName>,
}
