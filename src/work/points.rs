//! The points of a running sweep: handed over by the pool's threads, written with the progress.

use crate::store::{LineEndRow, PointBatch, PointRow, PointsDigest, PointsOfResult};
use herringbone_job::not_finite;
use herringbone_job::result::{NotFinite, SweepPoint};
use herringbone_job::study::{KeptPoints, LineEnd, PointStore};
use std::collections::HashSet;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What an earlier attempt left, and what is solved but not yet written.
pub(super) struct RunningPoints {
    solver_version: &'static str,
    inner: Mutex<Inner>,
}

#[derive(Default)]
struct Inner {
    kept: KeptPoints,
    known: HashSet<u64>,
    unwritten: PointBatch,
}

impl RunningPoints {
    /// Goes on from what was written. A row that cannot be read is solved again, and so are all after it.
    pub fn after(written: PointBatch, solver_version: &'static str) -> Self {
        let mut kept = KeptPoints::default();
        for row in written.rows {
            if let Ok(point) = serde_json::from_str(&row.body) {
                kept.rows.insert(row.position as usize, point);
            }
        }
        for LineEndRow { line, position, state } in written.ends {
            let line = line as usize;
            kept.ends.insert(line, LineEnd { line, position: position as usize, state });
        }
        let known = kept.rows.keys().map(|position| *position as u64).collect();
        Self { solver_version, inner: Mutex::new(Inner { kept, known, unwritten: PointBatch::default() }) }
    }

    /// What was solved since the last call.
    pub fn take_unwritten(&self) -> PointBatch {
        let mut batch = std::mem::take(&mut self.lock().unwritten);
        batch.solver_version = self.solver_version.to_owned();
        batch
    }

    /// What could not be written comes with the next call.
    pub fn put_back(&self, mut batch: PointBatch) {
        let mut inner = self.lock();
        batch.append(std::mem::take(&mut inner.unwritten));
        inner.unwritten = batch;
    }

    /// Takes the rows out of a finished sweep: the batch that is still to be written, and what stands for the rows in the
    /// body, an empty list of points having been written at `at`.
    pub fn finished(&self, points: &[SweepPoint], at: usize) -> serde_json::Result<(PointBatch, PointsOfResult)> {
        let mut batch = self.take_unwritten();
        let known = std::mem::take(&mut self.lock().known);
        let mut digest = PointsDigest::default();
        for (position, point) in (0u64..).zip(points) {
            let body = written(point)?;
            digest.add(&body);
            if !known.contains(&position) {
                batch.rows.push(PointRow { position, body });
            }
        }
        Ok((batch, PointsOfResult { at, n: points.len() as u64, digest: digest.finish() }))
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Where the rows of a sweep belong in a result that was written without them: a byte offset. Within a string the quotes
/// would be escaped, so the empty list is found nowhere else.
pub(super) fn place_of_points(body: &str) -> Option<usize> {
    const EMPTY: &str = "\"points\":[]";
    body.find(EMPTY).map(|at| at + EMPTY.len() - 1)
}

/// A row as JSON; one with a number that is not finite says so.
fn written(row: &SweepPoint) -> serde_json::Result<String> {
    match not_finite(row).first() {
        Some(NotFinite { pointer, reason }) if row.error.is_none() => {
            serde_json::to_string(&SweepPoint { error: Some(format!("{pointer} is {reason}")), ..row.clone() })
        }
        _ => serde_json::to_string(row),
    }
}

impl PointStore for RunningPoints {
    fn load(&self) -> KeptPoints {
        std::mem::take(&mut self.lock().kept)
    }

    fn save(&self, position: usize, row: &SweepPoint, end: Option<&LineEnd>) {
        // A row that cannot be written here is written with the result, or that fails.
        let Ok(body) = written(row) else { return };
        let mut inner = self.lock();
        inner.known.insert(position as u64);
        inner.unwritten.rows.push(PointRow { position: position as u64, body });
        if let Some(LineEnd { line, position, state }) = end {
            let (line, position, state) = (*line as u64, *position as u64, state.clone());
            // Only the newest end of a line counts.
            inner.unwritten.ends.retain(|known| known.line != line);
            inner.unwritten.ends.push(LineEndRow { line, position, state });
        }
    }
}
