//! A proxy between browser and server that holds back streams of events, as proxies do that collect what they pass on.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Starts the proxy before the server at `address`; its own address.
pub(crate) fn buffering(address: String) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let own = listener.local_addr().unwrap().to_string();
    std::thread::spawn(move || {
        for client in listener.incoming().flatten() {
            let Ok(server) = TcpStream::connect(&address) else { continue };
            pass(client, server);
        }
    });
    own
}

/// Passes on in both directions until either side closes. The answers to requests for events are read and kept.
fn pass(client: TcpStream, server: TcpStream) {
    let is_held = Arc::new(AtomicBool::new(false));
    let held = Arc::clone(&is_held);
    let (to_server, to_client) = (server.try_clone().unwrap(), client.try_clone().unwrap());
    // A request stands at the start of what is read: browsers wait for an answer before they send the next.
    copy(client, to_server, move |bytes| {
        let line = bytes.split(|byte| *byte == b'\r').next().unwrap_or_default();
        let path = String::from_utf8_lossy(line);
        if path.split(' ').nth(1).is_some_and(|path| path.split('?').next().unwrap_or_default().ends_with("/events")) {
            is_held.store(true, Ordering::SeqCst);
        }
        true
    });
    copy(server, to_client, move |_| !held.load(Ordering::SeqCst));
}

fn copy(mut from: TcpStream, mut to: TcpStream, passes: impl Fn(&[u8]) -> bool + Send + 'static) {
    std::thread::spawn(move || {
        let mut bytes = vec![0; 1 << 16];
        while let Ok(count @ 1..) = from.read(&mut bytes) {
            if passes(&bytes[..count]) && to.write_all(&bytes[..count]).is_err() {
                break;
            }
        }
        let _ = to.shutdown(Shutdown::Both);
    });
}
