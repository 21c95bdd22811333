//! Rows of an earlier study of the same document with another sample: the sequences of a larger one begin with those of
//! a smaller one, so that only the points that are new have to be evaluated.

use crate::document::JobDocument;
use crate::result::SweepPoint;
use crate::study::hash::rows_hash;
use crate::study::{SolveContext, Stage};
use std::collections::HashSet;

/// Most rows that are kept for later studies: some megabytes.
const MOST: usize = 8192;

/// The rows that were kept.
pub(super) struct Earlier {
    key: String,
    pub rows: Vec<SweepPoint>,
}

fn bits(row: &SweepPoint) -> Vec<u64> {
    row.values.iter().map(|value| value.to_bits()).collect()
}

impl Earlier {
    /// The rows kept of studies of this document.
    pub(super) fn load(document: &JobDocument, context: &SolveContext) -> Self {
        let key = rows_hash(document);
        let stored = context.stages.load(&key).and_then(|bytes| serde_json::from_slice(&bytes).ok());
        Self { key, rows: stored.unwrap_or_default() }
    }

    /// Rows, of those of a study, that were known.
    pub(super) fn reused(&self, rows: &[SweepPoint]) -> u32 {
        let known: HashSet<Vec<u64>> = self.rows.iter().map(bits).collect();
        rows.iter().filter(|row| known.contains(&bits(row))).count() as u32
    }

    /// Keeps the rows of a study where they are more than those that are kept.
    pub(super) fn save(&self, rows: &[SweepPoint], context: &SolveContext) {
        let kept = &rows[..rows.len().min(MOST)];
        if kept.len() > self.rows.len() {
            context.stages.save(&self.key, Stage::Evaluations, &serde_json::to_vec(kept).unwrap_or_default());
        }
    }
}
