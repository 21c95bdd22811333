//! Requests of workers: whether a chunk is to be computed, beats, stages; and the name of the space.

use super::connect::{ClusterError, Nats};
use super::message::{Beat, BeatAnswer, PART_BYTES, SCHEMA, StartAnswer, StartRequest, key_of};
use super::names::{SPACES, Space};
use super::shared::Shared;
use async_nats::{HeaderMap, Message, Subscriber};
use futures_util::StreamExt;
use herringbone_job::study::Stage;
use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest wait for another service with the same space.
const OWNER_WAIT: Duration = Duration::from_millis(500);
/// Headers of a stage: its key, its name, the part that is asked for or sent, and how many there are.
pub(super) const KEY: &str = "Hb-Key";
pub(super) const STAGE: &str = "Hb-Stage";
pub(super) const PART: &str = "Hb-Part";
pub(super) const PARTS: &str = "Hb-Parts";
/// Largest stage that is taken, in parts.
pub(super) const MOST_PARTS: usize = 512;
/// Stages that arrive in parts at the same time; the oldest are dropped.
const MOST_PARTIAL: usize = 64;
/// Longest texts in a beat, and most chunks.
const TEXT_BYTES: usize = 128;
const MOST_RUNNING: usize = 4096;

/// Takes the space: fails when another service has it.
///
/// # Errors
/// [`ClusterError::SpaceTaken`], or NATS refuses the subscription.
pub(super) async fn take_space(nats: &Nats, space: &Space) -> Result<Vec<Subscriber>, ClusterError> {
    let owner = space.subject("owner");
    let request = tokio::time::timeout(OWNER_WAIT, nats.client.request(owner.clone(), "".into()));
    if let Ok(Ok(_)) = request.await {
        return Err(ClusterError::SpaceTaken(space.to_string()));
    }
    let refused = |error: async_nats::SubscribeError| ClusterError::Unsuitable {
        servers: nats.servers.to_string(),
        detail: error.to_string(),
    };
    Ok(vec![
        nats.client.subscribe(owner).await.map_err(refused)?,
        nats.client.subscribe(SPACES).await.map_err(refused)?,
    ])
}

/// Answers with the name of the space.
pub(super) async fn run_owner(shared: Arc<Shared>, subscribers: Vec<Subscriber>) {
    let mut requests = futures_util::stream::select_all(subscribers);
    while let Some(request) = next(&shared, &mut requests).await {
        answer(&shared, request, None, shared.space.to_string().into_bytes()).await;
    }
}

pub(super) async fn run_starts(shared: Arc<Shared>, mut requests: Subscriber) {
    while let Some(request) = next(&shared, &mut requests).await {
        let Ok(start) = serde_json::from_slice::<StartRequest>(&request.payload) else { continue };
        let Ok(key) = key_of(&start.job, start.attempt, start.chunk) else { continue };
        // Without an answer the worker computes: the result waits.
        let Ok(go) = shared.store().is_chunk_wanted(key, start.issue).await else { continue };
        if go {
            if let Some(chunk) = shared.state().chunk(key) {
                chunk.seen = Some(Instant::now());
            }
            tracing::debug!(chunk = %key, start.issue, start.worker, start.delivered, "chunk started");
        }
        answer_json(&shared, request, &StartAnswer { go }).await;
    }
}

pub(super) async fn run_beats(shared: Arc<Shared>, mut requests: Subscriber) {
    while let Some(request) = next(&shared, &mut requests).await {
        let Ok(beat) = serde_json::from_slice::<Beat>(&request.payload) else { continue };
        if !is_plausible(&beat) {
            continue;
        }
        let now = Instant::now();
        let (said, is_new): (BeatAnswer, bool) = {
            let mut state = shared.state();
            (state.beat(&beat, now), state.members.beat(beat.clone(), now, shared.recorder().now()))
        };
        if is_new {
            tracing::info!(
                worker = beat.worker,
                host = beat.host,
                slots = beat.slots,
                solver = beat.solver_version,
                "worker joined"
            );
            shared.wake.notify_one();
        }
        answer_json(&shared, request, &said).await;
    }
}

fn is_plausible(beat: &Beat) -> bool {
    let texts = [&beat.worker, &beat.host, &beat.version, &beat.solver_version];
    beat.schema == SCHEMA
        && texts.into_iter().chain(&beat.solvers).all(|text| text.len() <= TEXT_BYTES)
        && beat.solvers.len() <= 4
        && beat.slots <= 4096
        && beat.running.len() <= MOST_RUNNING
}

pub(super) async fn run_stage_reads(shared: Arc<Shared>, mut requests: Subscriber) {
    while let Some(request) = next(&shared, &mut requests).await {
        let Some(key) = stage_key(&request) else { continue };
        let stage = shared.store().stage(&key).await.unwrap_or_else(|error| {
            tracing::warn!(%error, "stored stage not read");
            None
        });
        let Some(bytes) = stage else {
            answer(&shared, request, Some(&[(PARTS, 0)]), Vec::new()).await;
            continue;
        };
        let (parts, part) = (bytes.len().div_ceil(PART_BYTES).max(1), number(&request, PART).unwrap_or(0));
        let payload = bytes.chunks(PART_BYTES).nth(part).unwrap_or_default().to_vec();
        answer(&shared, request, Some(&[(PARTS, parts), (PART, part)]), payload).await;
    }
}

/// A stage that arrives in parts.
struct PartialStage {
    since: Instant,
    parts: Vec<Option<Vec<u8>>>,
}

impl PartialStage {
    fn new(parts: usize) -> Self {
        Self { since: Instant::now(), parts: vec![None; parts] }
    }
}

pub(super) async fn run_stage_writes(shared: Arc<Shared>, mut requests: Subscriber) {
    let mut partial: HashMap<String, PartialStage> = HashMap::new();
    while let Some(request) = next(&shared, &mut requests).await {
        let named = stage_key(&request).zip(stage_of(&request));
        let numbers = number(&request, PART).zip(number(&request, PARTS));
        let (Some((key, stage)), Some((part, parts))) = (named, numbers) else { continue };
        if parts == 0 || parts > MOST_PARTS || part >= parts || request.payload.len() > PART_BYTES {
            continue;
        }
        if partial.len() >= MOST_PARTIAL
            && let Some(oldest) = partial.iter().min_by_key(|(_, stage)| stage.since).map(|(key, _)| key.clone())
        {
            partial.remove(&oldest);
        }
        let arriving = partial.entry(key.clone()).or_insert_with(|| PartialStage::new(parts));
        if arriving.parts.len() != parts {
            *arriving = PartialStage::new(parts);
        }
        arriving.parts[part] = Some(request.payload.to_vec());
        if arriving.parts.iter().all(Option::is_some) {
            let bytes = arriving.parts.drain(..).flatten().collect::<Vec<_>>().concat();
            partial.remove(&key);
            let (version, now) = (shared.solver.version(), shared.recorder().now());
            if let Err(error) = shared.store().save_stage(&key, stage.as_str(), version, &bytes, now).await {
                tracing::warn!(%error, stage = stage.as_str(), size_bytes = bytes.len(), "stage not stored");
            }
        }
        answer(&shared, request, None, Vec::new()).await;
    }
}

/// The key of a stage: the hexadecimal digits of a hash.
fn stage_key(request: &Message) -> Option<String> {
    let key = header(request, KEY)?;
    is_stage_key(&key).then_some(key)
}

pub(super) fn is_stage_key(key: &str) -> bool {
    (16..=128).contains(&key.len()) && key.bytes().all(|byte| byte.is_ascii_hexdigit())
}

fn stage_of(request: &Message) -> Option<Stage> {
    let name = header(request, STAGE)?;
    [Stage::Geometry, Stage::Mesh, Stage::Impact, Stage::Response, Stage::Sweep]
        .into_iter()
        .find(|stage| stage.as_str() == name)
}

pub(super) fn header(message: &Message, name: &str) -> Option<String> {
    Some(message.headers.as_ref()?.get(name)?.as_str().to_owned())
}

pub(super) fn number(message: &Message, name: &str) -> Option<usize> {
    header(message, name)?.parse().ok()
}

/// The next request; `None` when the service closes.
async fn next(shared: &Shared, requests: &mut (impl futures_util::Stream<Item = Message> + Unpin)) -> Option<Message> {
    tokio::select! {
        request = requests.next() => request,
        () = shared.closing().cancelled() => None,
    }
}

async fn answer_json(shared: &Shared, request: Message, said: &impl serde::Serialize) {
    if let Ok(json) = serde_json::to_vec(said) {
        answer(shared, request, None, json).await;
    }
}

/// An answer that is lost is asked for again, or done without.
async fn answer(shared: &Shared, request: Message, numbers: Option<&[(&'static str, usize)]>, payload: Vec<u8>) {
    let Some(to) = request.reply else { return };
    let mut headers = HeaderMap::new();
    for (name, value) in numbers.unwrap_or_default() {
        headers.insert(*name, value.to_string());
    }
    let client = &shared.nats.client;
    let sent = match numbers {
        Some(_) => client.publish_with_headers(to, headers, payload.into()).await,
        None => client.publish(to, payload.into()).await,
    };
    if let Err(error) = sent {
        tracing::debug!(%error, "request not answered");
    }
}
