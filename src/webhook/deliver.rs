//! The deliverer: takes what is due from the outbox and posts it.

use super::client::{Client, Message, Resolve, system_resolver};
use super::config::{WebhookConfig, WebhookError};
use super::signature::SigningKeys;
use crate::store::{Delivery, DeliveryTry, Store, StoreError};
use crate::work::Clock;
use jiff::{SignedDuration, Timestamp};
use serde_json::json;
use sha2::{Digest, Sha256};
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::Semaphore;
use tokio::task::JoinSet;
use tokio_util::sync::CancellationToken;

/// Pauses before the tries after the first one; each a fifth shorter or longer by chance.
const PAUSES: [SignedDuration; 7] = [
    SignedDuration::from_secs(5),
    SignedDuration::from_mins(5),
    SignedDuration::from_mins(30),
    SignedDuration::from_hours(2),
    SignedDuration::from_hours(5),
    SignedDuration::from_hours(10),
    SignedDuration::from_hours(10),
];
/// Longest time of a try.
const TIMEOUT: Duration = Duration::from_secs(15);
/// Most tries at once to one address.
const MAX_IN_FLIGHT: usize = 4;
/// Rows that are looked at in one round.
const MAX_DUE: u32 = 256;
/// Pause between two rounds.
const ROUND: Duration = Duration::from_secs(1);
/// Time after which deliveries that do not wait are forgotten, and how often that is done.
const KEPT: SignedDuration = SignedDuration::from_hours(30 * 24);
const FORGET_EVERY: u32 = 3600;
/// Status by which a receiver says that it is gone.
const GONE: u16 = 410;
/// Longest text of an error that is kept.
const MAX_ERROR_CHARS: usize = 300;

/// What a deliverer needs from its surroundings; tests replace them.
pub struct Setting {
    pub clock: Clock,
    pub resolve: Resolve,
    pub timeout: Duration,
}

impl Setting {
    /// The clock, the resolver of the system and the time limit of the service.
    pub fn real() -> Self {
        Self { clock: Arc::new(Timestamp::now), resolve: system_resolver(), timeout: TIMEOUT }
    }
}

/// Posts what is due.
pub struct Deliverer {
    shared: Arc<Shared>,
    tasks: JoinSet<()>,
}

struct Shared {
    store: Store,
    client: Client,
    keys: SigningKeys,
    clock: Clock,
    timeout: Duration,
    /// Ids of deliveries that are being tried.
    in_flight: Mutex<HashSet<String>>,
    /// Places for tries, by address.
    places: Mutex<HashMap<String, Arc<Semaphore>>>,
}

impl Deliverer {
    /// Takes up the addresses of the configuration. `None` when there are none.
    ///
    /// # Errors
    /// A setting cannot be used, or the database cannot be written.
    pub async fn new(store: Store, config: &WebhookConfig, setting: Setting) -> anyhow::Result<Option<Self>> {
        let keys = config.read()?;
        store.set_webhooks(&config.webhook_url).await?;
        if config.webhook_url.is_empty() {
            return Ok(None);
        }
        let client = Client::new(setting.resolve, config.webhook_allow.clone()).map_err(WebhookError::Certificates)?;
        let shared = Shared {
            store,
            client,
            keys,
            clock: setting.clock,
            timeout: setting.timeout,
            in_flight: Mutex::default(),
            places: Mutex::default(),
        };
        Ok(Some(Self { shared: Arc::new(shared), tasks: JoinSet::new() }))
    }

    /// Delivers until the service closes. Errors of the database are logged.
    pub async fn run(mut self, closing: CancellationToken) {
        let mut rounds = 0_u32;
        loop {
            if let Err(error) = self.round().await {
                tracing::warn!(%error, "webhooks could not be read from the database");
            }
            if rounds.is_multiple_of(FORGET_EVERY) {
                let before = (self.shared.clock)().checked_sub(KEPT).unwrap_or(Timestamp::MIN);
                if let Err(error) = self.shared.store.forget_deliveries(before).await {
                    tracing::warn!(%error, "old webhook deliveries could not be deleted");
                }
            }
            rounds = rounds.wrapping_add(1);
            tokio::select! {
                () = tokio::time::sleep(ROUND) => {}
                () = closing.cancelled() => return,
            }
        }
    }

    /// Starts tries of what is due, as far as the addresses have places; returns how many.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn round(&mut self) -> Result<usize, StoreError> {
        while self.tasks.try_join_next().is_some() {}
        let now = (self.shared.clock)();
        let mut started = 0;
        for delivery in self.shared.store.due_deliveries(now, MAX_DUE).await? {
            if lock(&self.shared.in_flight).contains(&delivery.id) {
                continue;
            }
            let place = {
                let mut places = lock(&self.shared.places);
                let place =
                    places.entry(delivery.url.clone()).or_insert_with(|| Arc::new(Semaphore::new(MAX_IN_FLIGHT)));
                Arc::clone(place).try_acquire_owned()
            };
            let Ok(place) = place else { continue };
            lock(&self.shared.in_flight).insert(delivery.id.clone());
            let shared = Arc::clone(&self.shared);
            started += 1;
            self.tasks.spawn(async move {
                shared.attempt(&delivery).await;
                lock(&shared.in_flight).remove(&delivery.id);
                drop(place);
            });
        }
        Ok(started)
    }

    /// Waits for the tries that were started.
    pub async fn finish(&mut self) {
        while self.tasks.join_next().await.is_some() {}
    }
}

impl Shared {
    /// Makes a try and writes down what came of it.
    async fn attempt(&self, delivery: &Delivery) {
        let started = (self.clock)();
        let body = body(delivery);
        let time_s = started.as_second();
        let signature = self.keys.sign(&delivery.id, time_s, &body);
        let message = Message { id: delivery.id.clone(), time_s, signature, body };
        let answer = tokio::time::timeout(self.timeout, self.client.post(&delivery.url, &message)).await;
        let (status, error) = match answer {
            Ok(Ok(status)) if (200..300).contains(&status) => (Some(status), None),
            Ok(Ok(status)) => (Some(status), Some(format!("answered with status {status}"))),
            Ok(Err(error)) => (None, Some(error)),
            Err(_) => (None, Some(format!("no answer within {} s", self.timeout.as_secs_f64()))),
        };
        let disables = status == Some(GONE);
        let at = (self.clock)();
        let again_at = error.as_ref().filter(|_| !disables).and_then(|_| next_try(delivery, at));
        let error = error.map(|error| error.chars().take(MAX_ERROR_CHARS).collect::<String>());
        if let Some(error) = &error {
            let (id, job, tries) = (&delivery.id, delivery.job, delivery.tries + 1);
            tracing::info!(webhook_id = %id, job_id = %job, tries, %error, "a webhook was not delivered");
        }
        let outcome = DeliveryTry { at, status, error, again_at, disables };
        if let Err(error) = self.store.record_try(delivery, &outcome).await {
            // It stays due and is tried again.
            tracing::warn!(%error, "the outcome of a webhook could not be stored");
        }
    }
}

/// Time of the try after the present one; `None` when it was the last.
fn next_try(delivery: &Delivery, now: Timestamp) -> Option<Timestamp> {
    let pause = PAUSES.get(delivery.tries as usize)?;
    // The same for every restart: by the id and the number of the try.
    let digest = Sha256::digest(format!("{}.{}", delivery.id, delivery.tries));
    let chance = f64::from(u16::from_be_bytes([digest[0], digest[1]])) / f64::from(u16::MAX);
    now.checked_add(pause.mul_f64(0.8 + 0.4 * chance)).ok()
}

/// The body of a delivery: the same in every try.
fn body(delivery: &Delivery) -> String {
    let job = format!("/api/v1/jobs/{}", delivery.job);
    let state = delivery.job_state.as_str();
    json!({
        "type": format!("job.{state}"),
        "timestamp": delivery.at.to_string(),
        "data": {
            "id": delivery.job.to_string(),
            "kind": delivery.kind,
            "name": delivery.name,
            "label": delivery.label,
            "state": state,
            "links": {"self": job, "result": format!("{job}/result")},
        },
    })
    .to_string()
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
