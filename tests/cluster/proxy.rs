//! A connection that can be cut: between a worker and its NATS server.

use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Forwards connections to a port of this machine, unless it is cut.
pub(crate) struct Proxy {
    port: u16,
    is_cut: Arc<AtomicBool>,
}

impl Proxy {
    pub(crate) fn to(url: &str) -> Self {
        let target = url.trim_start_matches("nats://").to_owned();
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let is_cut = Arc::new(AtomicBool::new(false));
        let state = Arc::clone(&is_cut);
        thread::spawn(move || {
            for connection in listener.incoming().map_while(Result::ok) {
                // One that is cut is closed at once.
                if !state.load(Ordering::Relaxed)
                    && let Ok(there) = TcpStream::connect(&target)
                {
                    join(connection, there, &state);
                }
            }
        });
        Self { port, is_cut }
    }

    pub(crate) fn url(&self) -> String {
        format!("nats://127.0.0.1:{}", self.port)
    }

    pub(crate) fn cut(&self) {
        self.is_cut.store(true, Ordering::Relaxed);
    }

    pub(crate) fn mend(&self) {
        self.is_cut.store(false, Ordering::Relaxed);
    }
}

fn join(here: TcpStream, there: TcpStream, is_cut: &Arc<AtomicBool>) {
    let copies = [(here.try_clone(), there.try_clone()), (Ok(there), Ok(here))];
    for (from, to) in copies {
        let (from, to, is_cut) = (from.expect("a stream"), to.expect("a stream"), Arc::clone(is_cut));
        thread::spawn(move || forward(from, to, &is_cut));
    }
}

/// Copies until the connection ends or is cut.
fn forward(mut from: TcpStream, mut to: TcpStream, is_cut: &AtomicBool) {
    let _ = from.set_read_timeout(Some(Duration::from_millis(20)));
    let mut bytes = [0; 65_536];
    while !is_cut.load(Ordering::Relaxed) {
        match from.read(&mut bytes) {
            Ok(0) => break,
            Ok(count) => {
                if to.write_all(&bytes[..count]).is_err() {
                    break;
                }
            }
            Err(error) if [ErrorKind::WouldBlock, ErrorKind::TimedOut].contains(&error.kind()) => {}
            Err(_) => break,
        }
    }
    let _ = from.shutdown(std::net::Shutdown::Both);
    let _ = to.shutdown(std::net::Shutdown::Both);
}
