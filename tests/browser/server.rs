//! The real server on a free port, with a database in a temporary folder.

use crate::process::Process;
use std::process::Command;
use tempfile::TempDir;

/// The one name that the browser can resolve.
pub(crate) const NAME: &str = "gears.test";

pub(crate) struct Server {
    pub url: String,
    _process: Option<Process>,
    _folder: TempDir,
}

impl Server {
    pub(crate) fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        if let Ok(url) = std::env::var("HERRINGBONE_BROWSER_TEST_URL") {
            return Self { url: url.trim_end_matches('/').to_owned(), _process: None, _folder: folder };
        }
        let (process, address) = serve(&folder, &[]);
        Self { url: format!("http://{address}"), _process: Some(process), _folder: folder }
    }

    /// A server with a token, reached by plain HTTP under a name: browsers trust such a site less than one on this
    /// machine or behind TLS, and send it fewer headers.
    pub(crate) fn start_with_token(token: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("token");
        std::fs::write(&file, token).unwrap();
        let (process, address) = serve(&folder, &["--token-file", file.to_str().unwrap()]);
        let url = format!("http://{NAME}:{}", address.rsplit(':').next().unwrap());
        Self { url, _process: Some(process), _folder: folder }
    }
}

fn serve(folder: &TempDir, arguments: &[&str]) -> (Process, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_herringbone"));
    command.args(["serve", "--listen", "127.0.0.1:0", "--database"]).arg(folder.path().join("test.db")).args(arguments);
    let process = Process::start(command, "The server could not be started.");
    let address = process.wait_for("address of the server", address_in);
    (process, address)
}

/// "127.0.0.1:PORT" with a real port, wherever it stands in the line.
fn address_in(line: &str) -> Option<String> {
    const HOST: &str = "127.0.0.1:";
    line.match_indices(HOST).find_map(|(start, _)| {
        let port: String = line[start + HOST.len()..].chars().take_while(char::is_ascii_digit).collect();
        (!port.is_empty() && port != "0").then(|| format!("{HOST}{port}"))
    })
}
