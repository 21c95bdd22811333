//! The loop of a worker: asks for one chunk for each free place. Nothing is fetched ahead, so that no chunk waits in a
//! busy worker while another one is idle.

use super::Worker;
use super::chunk_run::ChunkRun;
use crate::store::ChunkClass;
use crate::work::cluster::names::consumer;
use async_nats::jetstream::Message;
use async_nats::jetstream::consumer::PullConsumer;
use futures_util::StreamExt;
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::Semaphore;

/// Longest wait for the answer to a pull.
const ANSWER_WAIT: Duration = Duration::from_secs(3);
/// Pause of an idle worker; the service wakes it when there is work, so this is for what is delivered again.
const IDLE_PAUSE: Duration = Duration::from_secs(2);
/// First and longest pause after an error.
const RETRY_AFTER: Duration = Duration::from_millis(200);
const MAX_RETRY_AFTER: Duration = Duration::from_secs(5);

pub(super) async fn run_pull(worker: Arc<Worker>) {
    let places = Arc::new(Semaphore::new(worker.threads));
    let mut consumers = Consumers { worker: &worker, bound: HashMap::new() };
    let mut wakes = worker.nats.client.subscribe(worker.space.subject("wake")).await.ok();
    let mut pause = RETRY_AFTER;
    let mut is_first = true;
    while !worker.closing.is_cancelled() {
        let place = tokio::select! {
            place = Arc::clone(&places).acquire_owned() => place,
            () = worker.closing.cancelled() => return,
        };
        let Ok(place) = place else { return };
        let free = 1 + places.available_permits();
        match consumers.pull(free).await {
            Ok(messages) if messages.is_empty() => {
                drop(place);
                if std::mem::take(&mut is_first) && consumers.bound.is_empty() {
                    tracing::info!(space = %worker.space, "no work for this version yet");
                }
                let woken = async {
                    match &mut wakes {
                        Some(wakes) => wakes.next().await.is_some(),
                        None => std::future::pending().await,
                    }
                };
                tokio::select! {
                    is_open = woken => if !is_open { wakes = None },
                    () = tokio::time::sleep(IDLE_PAUSE) => {}
                    () = worker.closing.cancelled() => return,
                }
            }
            Ok(messages) => {
                pause = RETRY_AFTER;
                let mut first = Some(place);
                for message in messages {
                    let place = match first.take() {
                        Some(place) => place,
                        // There are as many as messages were asked for.
                        None => match Arc::clone(&places).acquire_owned().await {
                            Ok(place) => place,
                            Err(_) => return,
                        },
                    };
                    worker.chunks.spawn(ChunkRun::new(&worker, message).run(place));
                }
            }
            Err(error) => {
                drop(place);
                tracing::debug!(%error, "no work read");
                consumers.bound.clear();
                tokio::select! {
                    () = tokio::time::sleep(pause) => pause = (2 * pause).min(MAX_RETRY_AFTER),
                    () = worker.closing.cancelled() => return,
                }
            }
        }
    }
}

/// The consumers of work of this version, bound when they are there.
struct Consumers<'a> {
    worker: &'a Worker,
    bound: HashMap<String, PullConsumer>,
}

impl Consumers<'_> {
    /// Up to so many chunks: scouts and whole jobs first.
    async fn pull(&mut self, most: usize) -> Result<Vec<Message>, async_nats::Error> {
        let mut messages = Vec::new();
        for class in ChunkClass::ALL {
            for solver in &self.worker.solvers {
                if messages.len() < most
                    && let Some(consumer) = self.bind(consumer(solver, class)).await?
                {
                    let left = most - messages.len();
                    let mut fetched = consumer.fetch().max_messages(left).messages().await?;
                    while let Ok(Some(message)) = tokio::time::timeout(ANSWER_WAIT, fetched.next()).await {
                        match message {
                            Ok(message) => messages.push(message),
                            Err(error) if messages.is_empty() => return Err(error),
                            Err(_) => break,
                        }
                    }
                }
            }
        }
        Ok(messages)
    }

    /// `None` while the service has not made the consumer.
    async fn bind(&mut self, name: String) -> Result<Option<PullConsumer>, async_nats::Error> {
        if let Some(bound) = self.bound.get(&name) {
            return Ok(Some(bound.clone()));
        }
        let stream = self.worker.space.work_stream();
        match self.worker.nats.jetstream.get_consumer_from_stream(&name, stream).await {
            Ok(consumer) => {
                let consumer: PullConsumer = consumer;
                self.bound.insert(name, consumer.clone());
                Ok(Some(consumer))
            }
            Err(error) => match error.kind() {
                async_nats::jetstream::stream::ConsumerErrorKind::JetStream(_) => Ok(None),
                _ => Err(error.into()),
            },
        }
    }
}
