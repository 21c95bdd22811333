//! The two streams and their consumers. Only the service makes them, and it never deletes one: a stream or consumer
//! that is made again under the same name may stay without a quorum.

use super::connect::{ClusterError, Nats, START_WAIT, waited};
use super::names::{RESULT_CONSUMER, Space, consumer};
use crate::store::ChunkClass;
use async_nats::jetstream::consumer::{AckPolicy, PullConsumer, pull};
use async_nats::jetstream::stream::{Config, DiscardPolicy, Info, RetentionPolicy, StorageType};
use std::time::Duration;

/// Time in which a stream recognises a message that was sent again.
const DUPLICATE_WINDOW: Duration = Duration::from_secs(120);
/// Bounds of the stream of work.
const WORK_MESSAGES: i64 = 20_000;
const WORK_BYTES: i64 = 256 << 20;
/// Largest message of both streams.
const MESSAGE_BYTES: i32 = 1 << 20;
/// Messages of a consumer that may be unacknowledged: far more than ever are.
const UNACKNOWLEDGED: i64 = 4096;
/// Longest time for which a result is not stored before it is delivered again.
const RESULT_ACK_WAIT: Duration = Duration::from_secs(30);
/// Pause between two attempts.
const RETRY_AFTER: Duration = Duration::from_millis(500);

/// Both streams of a space.
#[derive(Clone)]
pub(super) struct Streams {
    pub nats: Nats,
    pub space: Space,
    pub replicas: usize,
    pub result_bytes: i64,
    pub ack_wait: Duration,
}

impl Streams {
    /// Makes the streams and the consumer of results; waits until the servers are able to.
    ///
    /// # Errors
    /// [`ClusterError`] after a minute.
    pub(super) async fn make(&self) -> Result<PullConsumer, ClusterError> {
        let last = std::sync::Mutex::new(String::new());
        let made = async {
            loop {
                match self.ensure().await {
                    Ok(_) => match self.result_consumer().await {
                        Ok(consumer) => return consumer,
                        Err(error) => note(&last, error),
                    },
                    Err(error) => note(&last, error),
                }
                tokio::time::sleep(RETRY_AFTER).await;
            }
        };
        let why = || last.lock().map(|text| text.clone()).unwrap_or_default();
        let made = waited(made, Some(START_WAIT), || format!("the streams of NATS ({})", why())).await;
        made.ok_or_else(|| ClusterError::Unsuitable { servers: self.nats.servers.to_string(), detail: why() })
    }

    /// Makes or corrects both streams. Returns the state of that of work.
    pub(super) async fn ensure(&self) -> Result<Info, async_nats::Error> {
        let work = Config {
            name: self.space.work_stream(),
            subjects: vec![self.space.all_work()],
            max_messages: WORK_MESSAGES,
            max_bytes: WORK_BYTES,
            ..self.common()
        };
        let results = Config {
            name: self.space.result_stream(),
            subjects: vec![self.space.all_results()],
            max_messages: -1,
            max_bytes: self.result_bytes,
            ..self.common()
        };
        self.ensure_one(results).await?;
        self.ensure_one(work).await
    }

    async fn ensure_one(&self, config: Config) -> Result<Info, async_nats::Error> {
        match self.nats.jetstream.get_stream(&config.name).await {
            Ok(stream) if is_as_wanted(&stream.cached_info().config, &config) => Ok(stream.cached_info().clone()),
            Ok(_) => Ok(self.nats.jetstream.update_stream(config).await?),
            Err(error) => match error.kind() {
                async_nats::jetstream::context::GetStreamErrorKind::JetStream(said)
                    if said.error_code() == async_nats::jetstream::ErrorCode::STREAM_NOT_FOUND =>
                {
                    let stream = self.nats.jetstream.create_stream(config).await?;
                    Ok(stream.cached_info().clone())
                }
                _ => Err(error.into()),
            },
        }
    }

    fn common(&self) -> Config {
        Config {
            retention: RetentionPolicy::WorkQueue,
            storage: StorageType::File,
            discard: DiscardPolicy::New,
            num_replicas: self.replicas,
            max_message_size: MESSAGE_BYTES,
            duplicate_window: DUPLICATE_WINDOW,
            max_messages_per_subject: -1,
            max_consumers: -1,
            ..Config::default()
        }
    }

    /// Makes the consumer of one class of work.
    pub(super) async fn work_consumer(&self, solver: &str, class: ChunkClass) -> Result<(), async_nats::Error> {
        let config = pull::Config {
            durable_name: Some(consumer(solver, class)),
            filter_subject: self.space.work(solver, class),
            ack_wait: self.ack_wait,
            ..consumer_config()
        };
        self.nats.jetstream.create_consumer_on_stream(config, self.space.work_stream()).await?;
        Ok(())
    }

    pub(super) async fn result_consumer(&self) -> Result<PullConsumer, async_nats::Error> {
        let config = pull::Config {
            durable_name: Some(RESULT_CONSUMER.to_owned()),
            filter_subject: self.space.all_results(),
            ack_wait: RESULT_ACK_WAIT,
            ..consumer_config()
        };
        Ok(self.nats.jetstream.create_consumer_on_stream(config, self.space.result_stream()).await?)
    }
}

fn consumer_config() -> pull::Config {
    pull::Config {
        ack_policy: AckPolicy::Explicit,
        max_deliver: -1,
        max_ack_pending: UNACKNOWLEDGED,
        ..pull::Config::default()
    }
}

/// Whether a stream has the settings that may change.
fn is_as_wanted(found: &Config, wanted: &Config) -> bool {
    let settings = |config: &Config| {
        (config.max_bytes, config.max_messages, config.max_message_size, config.num_replicas, config.duplicate_window)
    };
    settings(found) == settings(wanted) && found.subjects == wanted.subjects
}

fn note(last: &std::sync::Mutex<String>, error: async_nats::Error) {
    if let Ok(mut text) = last.lock() {
        *text = error.to_string();
    }
}
