//! The real server on a free port, with a database in a temporary folder.

use crate::process::Process;
use crate::proxy;
use std::process::Command;
use std::sync::Mutex;
use tempfile::TempDir;

/// The one name that the browser can resolve.
pub(crate) const NAME: &str = "gears.test";

pub(crate) struct Server {
    pub url: String,
    /// Host and port on which the process listens.
    address: String,
    process: Mutex<Option<Process>>,
    folder: TempDir,
}

impl Server {
    pub(crate) fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        if let Ok(url) = std::env::var("HERRINGBONE_BROWSER_TEST_URL") {
            let url = url.trim_end_matches('/').to_owned();
            return Self { url, address: String::new(), process: Mutex::default(), folder };
        }
        let (process, address) = serve(&folder, ANY_PORT, &[]);
        Self { url: format!("http://{address}"), address, process: Mutex::new(Some(process)), folder }
    }

    /// A server with a token, reached by plain HTTP under a name: browsers trust such a site less than one on this
    /// machine or behind TLS, and send it fewer headers.
    pub(crate) fn start_with_token(token: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("token");
        std::fs::write(&file, token).unwrap();
        let (process, address) = serve(&folder, ANY_PORT, &["--token-file", file.to_str().unwrap()]);
        let url = format!("http://{NAME}:{}", address.rsplit(':').next().unwrap());
        Self { url, address, process: Mutex::new(Some(process)), folder }
    }

    /// A server that is reached through a proxy which holds back streams of events.
    pub(crate) fn behind_a_buffering_proxy() -> Self {
        let server = Self::start();
        Self { url: format!("http://{}", proxy::buffering(server.address.clone())), ..server }
    }

    /// Ends the process at once, as a loss of power does.
    pub(crate) fn kill(&self) {
        drop(self.process.lock().unwrap().take());
    }

    /// Starts a process that was killed again: on the same port, with the same database.
    pub(crate) fn start_again(&self) {
        let (process, _) = serve(&self.folder, &self.address, &[]);
        *self.process.lock().unwrap() = Some(process);
    }
}

const ANY_PORT: &str = "127.0.0.1:0";

fn serve(folder: &TempDir, listen: &str, arguments: &[&str]) -> (Process, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_herringbone"));
    command.args(["serve", "--listen", listen, "--database"]).arg(folder.path().join("test.db")).args(arguments);
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
