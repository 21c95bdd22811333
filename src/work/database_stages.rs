//! The cache of stages in the database, as the study uses it.

use crate::store::Store;
use herringbone_job::study::{Stage, StageStore};
use jiff::Timestamp;
use tokio::runtime::Handle;

/// Cached stages in the database. Errors are logged only, as they cost time but no results. Not for async threads.
pub(super) struct DatabaseStages {
    pub store: Store,
    pub runtime: Handle,
    pub solver_version: &'static str,
    pub now: Timestamp,
}

impl StageStore for DatabaseStages {
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
