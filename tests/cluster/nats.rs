//! NATS servers as processes of their own.

use crate::client;
use crate::program::PATIENCE;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Once;
use std::time::{Duration, Instant};

/// The program; `None`, and said, where there is none.
fn program() -> Option<PathBuf> {
    static SAID: Once = Once::new();
    let given = std::env::var_os("HERRINGBONE_NATS_SERVER").map(PathBuf::from);
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let known = std::env::split_paths(&paths).chain(["/usr/sbin".into()]).map(|folder| folder.join("nats-server"));
    let program = given.into_iter().chain(known).find(|path| path.is_file());
    SAID.call_once(|| match &program {
        Some(program) => {
            let version = Command::new(program).arg("--version").output().map(|output| output.stdout);
            println!("{}", String::from_utf8_lossy(&version.unwrap_or_default()).trim());
        }
        None => println!("skipped: no nats-server here (scripts/prerequisites nats-server)"),
    });
    program
}

/// One server with JetStream; killed when it is dropped.
pub(crate) struct NatsServer {
    program: PathBuf,
    folder: PathBuf,
    port: u16,
    monitor: u16,
    options: Vec<String>,
    process: Option<Child>,
}

impl NatsServer {
    /// A server over a folder; `None` where there is no program.
    pub(crate) fn start(folder: &Path) -> Option<Self> {
        Self::start_with(folder, &[])
    }

    pub(crate) fn start_with(folder: &Path, options: &[&str]) -> Option<Self> {
        let (program, [port, monitor]) = (program()?, free_ports());
        let options = options.iter().map(|option| (*option).to_owned()).collect();
        let mut server = Self { program, folder: folder.join("nats"), port, monitor, options, process: None };
        server.start_again();
        Some(server)
    }

    /// Three servers that keep what is stored together.
    pub(crate) fn start_three(folder: &Path) -> Option<[Self; 3]> {
        let (program, ports) = (program()?, free_ports::<9>());
        let routes = [6, 7, 8].map(|place: usize| format!("nats://127.0.0.1:{}", ports[place])).join(",");
        let mut servers = [0, 1, 2].map(|one: usize| {
            let listen = format!("nats://127.0.0.1:{}", ports[6 + one]);
            let name = format!("n{one}");
            let words = ["--name", &name, "--cluster_name", "three", "--cluster", &listen, "--routes", &routes];
            let options = words.map(str::to_owned).to_vec();
            let (program, folder) = (program.clone(), folder.join(name.as_str()));
            Self { program, folder, port: ports[one], monitor: ports[3 + one], options, process: None }
        });
        servers.iter_mut().for_each(Self::spawn);
        servers.iter().for_each(Self::wait);
        Some(servers)
    }

    pub(crate) fn url(&self) -> String {
        format!("nats://127.0.0.1:{}", self.port)
    }

    /// Its log, beside its folder.
    fn log(&self) -> PathBuf {
        self.folder.with_extension("log")
    }

    /// Starts it and waits until it is healthy.
    pub(crate) fn start_again(&mut self) {
        self.spawn();
        self.wait();
    }

    /// Starts it.
    pub(crate) fn spawn(&mut self) {
        let (port, monitor) = (self.port.to_string(), self.monitor.to_string());
        let mut command = Command::new(&self.program);
        command.args(["--addr", "127.0.0.1", "--port", &port, "--http_port", &monitor, "--jetstream", "--store_dir"]);
        command.arg(&self.folder).args(&self.options).stdin(Stdio::null()).stdout(Stdio::null());
        let log = std::fs::OpenOptions::new().create(true).append(true).open(self.log()).expect("a log");
        command.stderr(log);
        self.process = Some(command.spawn().expect("nats-server starts"));
    }

    /// Waits until it is healthy.
    fn wait(&self) {
        let (address, deadline) = (SocketAddr::from(([127, 0, 0, 1], self.monitor)), Instant::now() + PATIENCE);
        while client::send(address, "GET", "/healthz", &[], "").map_or(true, |answer| answer.status != 200) {
            let log = || std::fs::read_to_string(self.log()).unwrap_or_default();
            assert!(Instant::now() < deadline, "nats-server does not become healthy: {}", log());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub(crate) fn id(&self) -> u32 {
        self.process.as_ref().map_or(0, Child::id)
    }

    /// Name of the server that leads a stream.
    pub(crate) fn leader(&self, stream: &str) -> Option<String> {
        let address = SocketAddr::from(([127, 0, 0, 1], self.monitor));
        let answer = client::send(address, "GET", "/jsz?accounts=true&streams=true", &[], "").ok()?.json();
        let streams =
            answer["account_details"].as_array()?.iter().filter_map(|account| account["stream_detail"].as_array());
        let found = streams.flatten().find(|one| one["name"] == stream)?;
        found["cluster"]["leader"].as_str().map(str::to_owned)
    }

    /// kill −9.
    pub(crate) fn kill(&mut self) {
        if let Some(mut process) = self.process.take() {
            process.kill().expect("killed");
            process.wait().expect("it ends");
        }
    }

    fn signal(&self, name: &str) {
        let id = self.process.as_ref().expect("it runs").id().to_string();
        assert!(Command::new("kill").args([name, &id]).status().expect("kill runs").success());
    }

    /// Stops it, as a machine that hangs.
    pub(crate) fn pause(&self) {
        self.signal("-STOP");
    }

    pub(crate) fn go_on(&self) {
        self.signal("-CONT");
    }

    /// Deletes everything that it has stored.
    pub(crate) fn wipe(&self) {
        assert!(self.process.is_none(), "only while it is stopped");
        std::fs::remove_dir_all(&self.folder).expect("deleted");
    }
}

impl Drop for NatsServer {
    fn drop(&mut self) {
        self.kill();
    }
}

fn free_ports<const N: usize>() -> [u16; N] {
    // All are held until the last one is found.
    let held: [TcpListener; N] = std::array::from_fn(|_| TcpListener::bind("127.0.0.1:0").expect("a free port"));
    held.map(|listener| listener.local_addr().expect("an address").port())
}
