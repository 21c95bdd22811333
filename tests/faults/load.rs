//! Clients that keep a service busy while it is killed and restarted, and record its answers.

use crate::audit::Accepted;
use crate::chance::Chance;
use crate::client::{Answer, send};
use crate::documents;
use serde_json::Value;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, RwLock};
use std::thread::JoinHandle;
use std::time::Duration;

/// The state shared by the clients.
#[derive(Default)]
struct LoadShared {
    address: RwLock<Option<SocketAddr>>,
    over: AtomicBool,
    answers: Mutex<Answers>,
}

/// The answers of the service.
#[derive(Default, Clone)]
pub(crate) struct Answers {
    pub accepted: Accepted,
    pub canceled: usize,
    /// Submissions sent again under their key because the connection broke.
    pub sent_again: usize,
    pub broken_connections: usize,
    /// Answers refusing a job for a passing reason (503).
    pub refused: usize,
    /// Answers that no request should have had.
    pub unexpected: Vec<String>,
}

/// Running clients.
pub(crate) struct Load {
    shared: Arc<LoadShared>,
    clients: Vec<JoinHandle<()>>,
}

impl Load {
    /// Starts so many clients; they wait until they are told an address.
    pub(crate) fn start(clients: u64, seed: u64, pause: Duration) -> Self {
        let shared = Arc::new(LoadShared::default());
        let start = |client| {
            let shared = Arc::clone(&shared);
            let client = Client { shared, chance: Chance::new(seed ^ (client << 32)), client, pause, keys: 0 };
            std::thread::spawn(move || client.run())
        };
        Self { clients: (0..clients).map(start).collect(), shared }
    }

    /// Sets the address of the service; `None` while it does not run.
    pub(crate) fn serve_at(&self, address: Option<SocketAddr>) {
        *self.shared.address.write().expect("not poisoned") = address;
    }

    /// Stops the clients; a service has to be there for what they still have to send again.
    pub(crate) fn stop(self) -> Answers {
        self.shared.over.store(true, Ordering::Relaxed);
        for client in self.clients {
            client.join().expect("no client panics");
        }
        self.shared.answers.lock().expect("not poisoned").clone()
    }
}

struct Client {
    shared: Arc<LoadShared>,
    chance: Chance,
    client: u64,
    pause: Duration,
    keys: u64,
}

impl Client {
    fn run(mut self) {
        while !self.shared.over.load(Ordering::Relaxed) {
            match self.chance.below(20) {
                0..10 => self.submit(&documents::response(), false),
                10..15 => self.submit(&documents::mesh(), true),
                15 => {
                    let points = 5 + self.chance.below(25) as u32;
                    self.submit(&documents::sweep(points), true);
                }
                16..18 => self.look(),
                _ => self.cancel(),
            }
            std::thread::sleep(self.pause);
        }
    }

    /// Submits; with a key again and again until it is answered, and now and then once more.
    fn submit(&mut self, document: &Value, keyed: bool) {
        let key = format!("client-{}-{}", self.client, self.keys);
        self.keys += u64::from(keyed);
        let headers = [("idempotency-key", key.as_str())];
        let headers: &[_] = if keyed { &headers } else { &[] };
        let mut times = 1 + usize::from(keyed) * (self.chance.below(3) / 2) as usize;
        while times > 0 {
            match self.send("POST", "/api/v1/jobs", headers, &document.to_string()) {
                Some(answer) if answer.status == 202 => {
                    let id = answer.json()["id"].as_str().unwrap_or_default().to_owned();
                    self.record(|answers| match keyed {
                        true => {
                            answers.accepted.ids.push(id.clone());
                            answers.accepted.keys.push((key.clone(), id));
                        }
                        false => answers.accepted.ids.push(id),
                    });
                    times -= 1;
                }
                Some(answer) if answer.status == 503 => {
                    self.record(|answers| answers.refused += 1);
                    return;
                }
                Some(answer) => {
                    let unexpected = format!("submission: {} {}", answer.status, answer.text);
                    return self.record(|answers| answers.unexpected.push(unexpected));
                }
                // Without a key nobody knows whether it was accepted.
                None if !keyed => return,
                None => {
                    self.record(|answers| answers.sent_again += 1);
                    std::thread::sleep(Duration::from_millis(2));
                }
            }
        }
    }

    fn look(&mut self) {
        let Some(id) = self.some_id() else { return };
        let Some(answer) = self.send("GET", &format!("/api/v1/jobs/{id}"), &[], "") else { return };
        if answer.status != 200 {
            let unexpected = format!("{id}: {} {}", answer.status, answer.text);
            self.record(|answers| answers.unexpected.push(unexpected));
        }
    }

    fn cancel(&mut self) {
        let Some(id) = self.some_id() else { return };
        let Some(answer) = self.send("POST", &format!("/api/v1/jobs/{id}/cancel"), &[], "") else { return };
        match answer.status {
            200 | 202 => self.record(|answers| answers.canceled += 1),
            503 => self.record(|answers| answers.refused += 1),
            _ => {
                let unexpected = format!("cancel {id}: {} {}", answer.status, answer.text);
                self.record(|answers| answers.unexpected.push(unexpected));
            }
        }
    }

    /// One of the jobs accepted last.
    fn some_id(&mut self) -> Option<String> {
        let back = self.chance.below(10) as usize;
        self.shared.answers.lock().expect("not poisoned").accepted.ids.iter().rev().nth(back).cloned()
    }

    fn send(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Option<Answer> {
        let address = *self.shared.address.read().expect("not poisoned");
        let Some(address) = address else {
            std::thread::sleep(Duration::from_millis(2));
            return None;
        };
        let answer = send(address, method, path, headers, body).ok();
        if answer.is_none() {
            self.record(|answers| answers.broken_connections += 1);
        }
        answer
    }

    fn record(&self, update: impl FnOnce(&mut Answers)) {
        update(&mut self.shared.answers.lock().expect("not poisoned"));
    }
}
