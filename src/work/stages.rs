//! The study's store of finished stages, over the database. Called on the pool's threads, never on async ones.

use crate::store::Store;
use herringbone_job::study::{Stage, StageStore};
use jiff::Timestamp;
use tokio::runtime::Handle;

/// Stages in the database. A cache: whatever goes wrong costs time, not results, so it is logged and forgotten.
pub(super) struct StoredStages {
    pub store: Store,
    pub runtime: Handle,
    pub solver_version: &'static str,
    pub now: Timestamp,
}

impl StageStore for StoredStages {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        self.runtime.block_on(self.store.stage(key)).unwrap_or_else(|error| {
            tracing::warn!(%error, "stored stage not read");
            None
        })
    }

    fn save(&self, key: &str, stage: Stage, bytes: &[u8]) {
        let saved = self.store.save_stage(key, stage.as_str(), self.solver_version, bytes, self.now);
        if let Err(error) = self.runtime.block_on(saved) {
            tracing::warn!(%error, stage = stage.as_str(), size_bytes = bytes.len(), "stage not stored");
        }
    }
}
