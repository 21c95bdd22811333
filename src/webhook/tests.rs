//! Deliveries to a receiver in this process, with a clock and a resolver of the test.

use super::config::origin;
use super::signature::SigningKeys;
use super::*;
use crate::store::{DeliveryState, JobId, NewJob, Store, StoreConfig, Submission};
use jiff::{SignedDuration, Timestamp};
use std::net::SocketAddr;
use std::path::Path;
use std::sync::atomic::{AtomicI64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tempfile::TempDir;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpListener;

const SECRET: &str = "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw";

/// A request as it was received: the head in lower case, and the body.
#[derive(Debug, Clone)]
struct Received {
    head: String,
    body: String,
}

impl Received {
    fn header(&self, name: &str) -> String {
        let line = self.head.lines().find_map(|line| line.strip_prefix(&format!("{name}: ")));
        line.unwrap_or_else(|| panic!("no {name}: {}", self.head)).to_owned()
    }
}

/// Answers requests with these heads, the last of them from then on; without any, never.
struct Receiver {
    address: SocketAddr,
    received: Arc<Mutex<Vec<Received>>>,
}

impl Receiver {
    async fn start(answers: &'static [&'static str]) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let received: Arc<Mutex<Vec<Received>>> = Arc::default();
        let list = Arc::clone(&received);
        tokio::spawn(async move {
            loop {
                let (mut stream, _) = listener.accept().await.unwrap();
                let list = Arc::clone(&list);
                tokio::spawn(async move {
                    let (mut bytes, mut piece) = (Vec::new(), [0; 4096]);
                    let (head, body) = loop {
                        let n = stream.read(&mut piece).await.unwrap_or(0);
                        if n == 0 {
                            return;
                        }
                        bytes.extend_from_slice(&piece[..n]);
                        let text = String::from_utf8_lossy(&bytes).into_owned();
                        let Some((head, body)) = text.split_once("\r\n\r\n") else { continue };
                        let request = Received { head: head.to_ascii_lowercase(), body: body.to_owned() };
                        if request.header("content-length").parse() == Ok(body.len()) {
                            break (request.head, request.body);
                        }
                    };
                    let at = {
                        let mut list = list.lock().unwrap();
                        list.push(Received { head: head.replace("\r\n", "\n"), body });
                        list.len() - 1
                    };
                    let Some(answer) = answers.get(at).or(answers.last()) else {
                        std::future::pending::<()>().await;
                        return;
                    };
                    let answer = format!("HTTP/1.1 {answer}\r\ncontent-length: 0\r\n\r\n");
                    let _ = stream.write_all(answer.as_bytes()).await;
                });
            }
        });
        Self { address, received }
    }

    fn url(&self) -> String {
        format!("http://{}/hook?key=1", self.address)
    }

    fn requests(&self) -> Vec<Received> {
        self.received.lock().unwrap().clone()
    }
}

struct Fixture {
    store: Store,
    directory: TempDir,
    seconds: Arc<AtomicI64>,
    resolved: Arc<AtomicUsize>,
    config: WebhookConfig,
}

async fn open(directory: &Path) -> Store {
    Store::open(&StoreConfig::at(directory.join("jobs.db"))).await.unwrap()
}

impl Fixture {
    /// A store that tells these addresses, in the network 127.0.0.0/8.
    async fn new(urls: &[String]) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let secret = directory.path().join("secret");
        std::fs::write(&secret, format!("{SECRET}\n")).unwrap();
        let config = WebhookConfig {
            webhook_url: urls.to_vec(),
            webhook_secret_file: Some(secret),
            webhook_allow: vec!["127.0.0.0/8".parse().unwrap()],
        };
        let store = open(directory.path()).await;
        Self { store, directory, seconds: Arc::default(), resolved: Arc::default(), config }
    }

    fn now(&self) -> Timestamp {
        at(self.seconds.load(Ordering::Relaxed))
    }

    /// A deliverer over a resolver that knows every host as these addresses.
    async fn deliverer(&self, addresses: &[&str]) -> Deliverer {
        let (seconds, resolved) = (Arc::clone(&self.seconds), Arc::clone(&self.resolved));
        let addresses: Vec<std::net::IpAddr> = addresses.iter().map(|address| address.parse().unwrap()).collect();
        let setting = Setting {
            clock: Arc::new(move || at(seconds.load(Ordering::Relaxed))),
            resolve: Arc::new(move |_, port| {
                resolved.fetch_add(1, Ordering::Relaxed);
                let addresses = addresses.iter().map(|address| SocketAddr::new(*address, port)).collect();
                Box::pin(async move { Ok(addresses) })
            }),
            timeout: Duration::from_millis(300),
        };
        Deliverer::new(self.store.clone(), &self.config, setting).await.unwrap().expect("addresses")
    }

    /// Submits a job and cancels it.
    async fn end_a_job(&self) -> JobId {
        let job = NewJob {
            id: JobId::new(),
            kind: "response",
            name: Some("a \"name\"".to_owned()),
            label: None,
            input: "{}".to_owned(),
            input_hash: "hash".to_owned(),
            solver_version: "test-1",
            request_id: None,
            traceparent: None,
            idempotency: None,
        };
        let id = job.id;
        let submitted = self.store.submit(job, None, 100, self.now()).await.unwrap();
        assert!(matches!(submitted, Submission::Accepted(_)));
        self.store.cancel(id, self.now()).await.unwrap();
        id
    }

    fn pass(&self, seconds: i64) {
        self.seconds.fetch_add(seconds, Ordering::Relaxed);
    }
}

fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_800_000_000 + second).unwrap()
}

async fn round(deliverer: &mut Deliverer) -> usize {
    let started = deliverer.round().await.unwrap();
    deliverer.finish().await;
    started
}

#[tokio::test]
async fn what_fails_is_tried_again_later_as_the_same_message_with_a_new_time() {
    let receiver = Receiver::start(&["500 Broken", "503 Busy", "204 Fine"]).await;
    let fixture = Fixture::new(&[receiver.url()]).await;
    let mut deliverer = fixture.deliverer(&[]).await;
    let id = fixture.end_a_job().await;
    assert_eq!(round(&mut deliverer).await, 1);
    // Five seconds, a fifth more or less.
    fixture.pass(3);
    assert_eq!(round(&mut deliverer).await, 0);
    fixture.pass(3);
    assert_eq!(round(&mut deliverer).await, 1);
    fixture.pass(239);
    assert_eq!(round(&mut deliverer).await, 0);
    fixture.pass(122);
    assert_eq!(round(&mut deliverer).await, 1);
    fixture.pass(100_000);
    assert_eq!(round(&mut deliverer).await, 0);
    let requests = receiver.requests();
    assert_eq!(requests.len(), 3);
    let keys = SigningKeys::read(SECRET).unwrap();
    for (request, time_s) in requests.iter().zip([0, 6, 6 + 239 + 122]) {
        assert!(request.head.starts_with("post /hook?key=1 http/1.1"), "{}", request.head);
        assert_eq!(request.header("webhook-timestamp"), at(time_s).as_second().to_string());
        assert_eq!(request.header("webhook-id"), requests[0].header("webhook-id"));
        assert_eq!(request.body, requests[0].body);
        let signature = keys.sign(&request.header("webhook-id"), at(time_s).as_second(), &request.body);
        assert_eq!(request.header("webhook-signature"), signature.to_ascii_lowercase());
    }
    let body: serde_json::Value = serde_json::from_str(&requests[0].body).unwrap();
    assert_eq!((&body["type"], &body["data"]["state"]), (&"job.canceled".into(), &"canceled".into()));
    assert_eq!(body["data"]["links"]["self"], format!("/api/v1/jobs/{id}"));
    assert_eq!(body["data"]["name"], "a \"name\"");
    let listed = fixture.store.deliveries().await.unwrap();
    assert_eq!((listed[0].state, listed[0].tries, listed[0].last_status), (DeliveryState::Delivered, 3, Some(204)));
}

#[tokio::test]
async fn what_was_written_before_a_kill_is_delivered_after_the_restart() {
    let receiver = Receiver::start(&["200 OK"]).await;
    let fixture = Fixture::new(&[receiver.url()]).await;
    drop(fixture.deliverer(&[]).await);
    fixture.end_a_job().await;
    let waiting = fixture.store.deliveries().await.unwrap();
    let Fixture { store, directory, seconds, resolved, config } = fixture;
    store.close().await;
    drop(store);
    let store = open(directory.path()).await;
    let fixture = Fixture { store, directory, seconds, resolved, config };
    let mut deliverer = fixture.deliverer(&[]).await;
    assert_eq!(round(&mut deliverer).await, 1);
    assert_eq!(receiver.requests()[0].header("webhook-id"), waiting[0].id);
    assert_eq!(waiting.len(), 1);
}

#[tokio::test]
async fn addresses_inside_are_refused_whatever_name_leads_to_them() {
    let receiver = Receiver::start(&["200 OK"]).await;
    let port = receiver.address.port();
    for (url, addresses, resolutions) in [
        (format!("http://127.0.0.1:{port}/"), &[][..], 0),
        (format!("http://[::ffff:127.0.0.1]:{port}/"), &[][..], 0),
        (format!("http://inside.example:{port}/"), &["127.0.0.1"][..], 1),
        ("http://both.example/".to_owned(), &["93.184.216.34", "127.0.0.1"][..], 1),
        ("https://metadata.example/".to_owned(), &["169.254.169.254"][..], 1),
        ("http://nowhere.example/".to_owned(), &[][..], 1),
    ] {
        let mut fixture = Fixture::new(std::slice::from_ref(&url)).await;
        fixture.config.webhook_allow.clear();
        let mut deliverer = fixture.deliverer(addresses).await;
        fixture.end_a_job().await;
        assert_eq!(round(&mut deliverer).await, 1);
        // Once: what was checked is what is connected to.
        assert_eq!(fixture.resolved.load(Ordering::Relaxed), resolutions, "{url}");
        let listed = fixture.store.deliveries().await.unwrap();
        assert_eq!((listed[0].state, listed[0].last_status), (DeliveryState::Waiting, None));
        let error = listed[0].last_error.clone().unwrap();
        assert!(error.contains("not permitted") || error.contains("no address"), "{url}: {error}");
    }
    assert!(receiver.requests().is_empty());
    let fixture = Fixture::new(&[format!("http://inside.example:{port}/")]).await;
    let mut deliverer = fixture.deliverer(&["127.0.0.1"]).await;
    fixture.end_a_job().await;
    round(&mut deliverer).await;
    assert_eq!(receiver.requests().len(), 1, "its network is permitted");
    assert_eq!(receiver.requests()[0].header("host"), format!("inside.example:{port}"));
}

#[tokio::test]
async fn redirects_are_not_followed() {
    let receiver = Receiver::start(&["302 Found\r\nlocation: /elsewhere", "200 OK"]).await;
    let fixture = Fixture::new(&[receiver.url()]).await;
    let mut deliverer = fixture.deliverer(&[]).await;
    fixture.end_a_job().await;
    round(&mut deliverer).await;
    assert_eq!(receiver.requests().len(), 1);
    let listed = fixture.store.deliveries().await.unwrap();
    assert_eq!((listed[0].state, listed[0].last_status), (DeliveryState::Waiting, Some(302)));
}

#[tokio::test]
async fn an_address_that_is_gone_is_told_nothing_more() {
    let receiver = Receiver::start(&["410 Gone", "200 OK"]).await;
    let fixture = Fixture::new(&[receiver.url()]).await;
    let mut deliverer = fixture.deliverer(&[]).await;
    fixture.end_a_job().await;
    round(&mut deliverer).await;
    fixture.end_a_job().await;
    fixture.pass(1_000_000);
    assert_eq!(round(&mut deliverer).await, 0);
    let listed = fixture.store.deliveries().await.unwrap();
    assert_eq!((listed.len(), listed[0].state), (1, DeliveryState::Failed));
    drop(fixture.deliverer(&[]).await);
    fixture.end_a_job().await;
    assert_eq!(fixture.store.deliveries().await.unwrap().len(), 2, "a new start takes it up again");
}

#[tokio::test]
async fn a_receiver_that_never_answers_keeps_four_places_and_nobody_else() {
    let (silent, quick) = (Receiver::start(&[]).await, Receiver::start(&["200 OK"]).await);
    let fixture = Fixture::new(&[silent.url(), quick.url()]).await;
    let mut deliverer = fixture.deliverer(&[]).await;
    for _ in 0..6 {
        fixture.end_a_job().await;
    }
    let mut started = 0;
    let deadline = std::time::Instant::now() + Duration::from_secs(5);
    while quick.requests().len() < 6 && std::time::Instant::now() < deadline {
        started += deliverer.round().await.unwrap();
        tokio::time::sleep(Duration::from_millis(5)).await;
    }
    assert_eq!(quick.requests().len(), 6);
    assert!(started >= 10);
    deliverer.finish().await;
    let listed = fixture.store.deliveries().await.unwrap();
    let late =
        listed.iter().filter(|one| one.last_error.as_deref().is_some_and(|error| error.contains("within 0.3 s")));
    assert!((1..=4).contains(&late.count()), "{listed:?}");
    assert_eq!(listed.iter().filter(|one| one.state == DeliveryState::Delivered).count(), 6);
}

#[tokio::test]
async fn after_eight_tries_over_a_day_it_is_given_up() {
    let receiver = Receiver::start(&["404 Not Found"]).await;
    let fixture = Fixture::new(&[receiver.url()]).await;
    let mut deliverer = fixture.deliverer(&[]).await;
    fixture.end_a_job().await;
    while round(&mut deliverer).await > 0 {
        let listed = fixture.store.deliveries().await.unwrap();
        let pause = listed[0].due_at.duration_since(fixture.now()).max(SignedDuration::ZERO);
        fixture.pass(pause.as_secs() + 1);
    }
    let listed = fixture.store.deliveries().await.unwrap();
    assert_eq!((listed[0].state, listed[0].tries, receiver.requests().len()), (DeliveryState::Failed, 8, 8));
    let hours = fixture.seconds.load(Ordering::Relaxed) / 3600;
    assert!((22..34).contains(&hours), "{hours}");
    fixture.store.forget_deliveries(fixture.now()).await.unwrap();
    assert!(fixture.store.deliveries().await.unwrap().is_empty());
}

#[tokio::test]
async fn wrong_settings_are_told_without_the_path_of_the_address() {
    for url in ["ftp://host/secret", "/secret", "http:///secret", "http://user:secret@host/", "not an address"] {
        let fixture = Fixture::new(&[url.to_owned()]).await;
        let setting = Setting::real();
        let refused = Deliverer::new(fixture.store.clone(), &fixture.config, setting).await.err().unwrap();
        assert!(refused.to_string().starts_with("--webhook-url"), "{refused}");
        assert!(!refused.to_string().contains("secret"), "{refused}");
    }
    let mut fixture = Fixture::new(&["http://host/".to_owned()]).await;
    fixture.config.webhook_secret_file = Some("/nowhere/secret".into());
    let refused = Deliverer::new(fixture.store.clone(), &fixture.config, Setting::real()).await.err().unwrap();
    assert!(refused.to_string().starts_with("--webhook-secret-file"), "{refused}");
    let none = Fixture::new(&[]).await;
    assert!(Deliverer::new(none.store.clone(), &none.config, Setting::real()).await.unwrap().is_none());
    none.end_a_job().await;
    assert!(none.store.deliveries().await.unwrap().is_empty());
    assert_eq!(origin("https://u:p@host:8443/a?b"), "https://host:8443/…");
}
