//! Stages of a worker: in memory, in a directory if there is one, and with the service, by the hash of their inputs.

use crate::work::cluster::answers::{KEY, MOST_PARTS, PART, PARTS, STAGE, is_stage_key, number};
use crate::work::cluster::message::PART_BYTES;
use crate::work::cluster::names::Space;
use async_nats::{Client, HeaderMap, Message};
use herringbone_job::study::{Stage, StageStore};
use std::collections::{HashMap, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::runtime::Handle;

/// Longest wait for the service; without it the stage is computed.
const ANSWER_WAIT: Duration = Duration::from_secs(5);
/// Room for stages in memory.
const MEMORY_BYTES: usize = 64 << 20;

/// Stages that are shared by the chunks of a worker.
pub(super) struct StageCache {
    client: Client,
    space: Space,
    directory: Option<Arc<dyn StageStore + Send + Sync>>,
    memory: Mutex<Memory>,
}

#[derive(Default)]
struct Memory {
    stages: HashMap<String, Arc<Vec<u8>>>,
    /// Keys, oldest first.
    order: VecDeque<String>,
    bytes: usize,
}

impl Memory {
    fn insert(&mut self, key: &str, stage: Vec<u8>) {
        if stage.len() > MEMORY_BYTES || self.stages.contains_key(key) {
            return;
        }
        self.bytes += stage.len();
        self.stages.insert(key.to_owned(), Arc::new(stage));
        self.order.push_back(key.to_owned());
        while self.bytes > MEMORY_BYTES {
            let Some(oldest) = self.order.pop_front() else { return };
            self.bytes -= self.stages.remove(&oldest).map_or(0, |stage| stage.len());
        }
    }
}

impl StageCache {
    pub(super) fn new(client: Client, space: Space, directory: Option<Arc<dyn StageStore + Send + Sync>>) -> Self {
        Self { client, space, directory, memory: Mutex::default() }
    }

    async fn request(&self, what: &str, headers: HeaderMap, payload: Vec<u8>) -> Option<Message> {
        let request = async_nats::Request::new().headers(headers).payload(payload.into()).timeout(Some(ANSWER_WAIT));
        self.client.send_request(self.space.subject(what), request).await.ok()
    }

    async fn fetch(&self, key: &str) -> Option<Vec<u8>> {
        let (mut stage, mut part) = (Vec::new(), 0);
        loop {
            let mut headers = HeaderMap::new();
            headers.insert(KEY, key);
            headers.insert(PART, part.to_string());
            let answer = self.request("stage.get", headers, Vec::new()).await?;
            let parts = number(&answer, PARTS)?;
            if parts == 0 || parts > MOST_PARTS {
                return None;
            }
            stage.extend_from_slice(&answer.payload);
            part += 1;
            if part >= parts {
                return Some(stage);
            }
        }
    }

    async fn put(&self, key: &str, stage: Stage, bytes: &[u8]) {
        let parts = bytes.len().div_ceil(PART_BYTES).max(1);
        if parts > MOST_PARTS {
            return;
        }
        for part in 0..parts {
            let mut headers = HeaderMap::new();
            headers.insert(KEY, key);
            headers.insert(STAGE, stage.as_str());
            headers.insert(PART, part.to_string());
            headers.insert(PARTS, parts.to_string());
            let payload = bytes.chunks(PART_BYTES).nth(part).unwrap_or_default().to_vec();
            if self.request("stage.put", headers, payload).await.is_none() {
                tracing::debug!(stage = stage.as_str(), "stage not taken by the service");
                return;
            }
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Memory> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The stages as the study uses them. Not for async threads.
pub(super) struct WorkerStages {
    pub cache: Arc<StageCache>,
    pub runtime: Handle,
}

impl StageStore for WorkerStages {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        if !is_stage_key(key) {
            return None;
        }
        let known = self.cache.lock().stages.get(key).cloned();
        if let Some(stage) = known {
            return Some(stage.to_vec());
        }
        let stage = self.cache.directory.as_ref().and_then(|directory| directory.load(key));
        let stage = match stage {
            Some(stage) => stage,
            None => {
                let stage = self.runtime.block_on(self.cache.fetch(key))?;
                if let Some(directory) = &self.cache.directory {
                    // Its name is not known here, and not needed.
                    directory.save(key, Stage::Mesh, &stage);
                }
                stage
            }
        };
        self.cache.lock().insert(key, stage.clone());
        Some(stage)
    }

    fn save(&self, key: &str, stage: Stage, bytes: &[u8]) {
        self.cache.lock().insert(key, bytes.to_vec());
        if let Some(directory) = &self.cache.directory {
            directory.save(key, stage, bytes);
        }
        self.runtime.block_on(self.cache.put(key, stage, bytes));
    }
}
