//! The points of a running sweep: passed on by the threads of the pool, stored together with the progress.

use super::stop_signal::StopSignal;
use crate::store::{EndStateRow, LineEndRow, PointBatch, PointRow, PointsDigest, RowsSummary};
use herringbone_job::not_finite;
use herringbone_job::result::{NotFinite, SweepPoint};
use herringbone_job::study::{EvaluationBatch, LineEnd, PointStore, StoredPoints};
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Makes evaluations on other machines.
pub(super) trait EvaluateElsewhere: Send + Sync {
    /// Has evaluations made; returns the rows that are stored then, none when the job is to stop. `evaluation_ms`: mean
    /// time of an evaluation in this process.
    fn evaluate(&self, batch: EvaluationBatch, evaluation_ms: Option<f64>, stop: &StopSignal) -> Vec<PointRow>;
}

/// The points from an earlier attempt, and those that are solved and not yet stored.
pub(super) struct RunningPoints {
    solver_version: &'static str,
    state: Mutex<PointsState>,
    elsewhere: Option<(Arc<dyn EvaluateElsewhere>, Arc<StopSignal>)>,
}

#[derive(Default)]
struct PointsState {
    /// Points of an earlier attempt, until the solver takes them.
    resumed: StoredPoints,
    /// Positions of all points that are stored or will be with the next batch.
    positions: HashSet<u64>,
    unwritten: PointBatch,
}

impl RunningPoints {
    /// Resumes from stored points. A row that cannot be read is solved again.
    pub(super) fn resume(stored: PointBatch, solver_version: &'static str) -> Self {
        let mut resumed = StoredPoints::default();
        for row in stored.rows {
            if let Ok(point) = serde_json::from_str(&row.body) {
                resumed.rows.insert(row.position as usize, point);
            }
        }
        for LineEndRow { line, position, state } in stored.ends {
            let line = line as usize;
            resumed.ends.insert(line, LineEnd { line, position: position as usize, state });
        }
        let positions = resumed.rows.keys().map(|position| *position as u64).collect();
        let state = PointsState { resumed, positions, unwritten: PointBatch::default() };
        Self { solver_version, state: Mutex::new(state), elsewhere: None }
    }

    /// With what makes evaluations on other machines until the job is to stop.
    pub(super) fn with_elsewhere(self, elsewhere: Option<(Arc<dyn EvaluateElsewhere>, Arc<StopSignal>)>) -> Self {
        Self { elsewhere, ..self }
    }

    /// Takes the points that were solved since the last call.
    pub(super) fn take_unwritten(&self) -> PointBatch {
        let mut batch = std::mem::take(&mut self.lock().unwritten);
        batch.solver_version = self.solver_version.to_owned();
        batch
    }

    /// Takes up to `most` of the points that were solved since the last call, all of a sweep whose lines are followed,
    /// and whether there are more.
    pub(super) fn take_some_unwritten(&self, most: usize) -> (PointBatch, bool) {
        let mut state = self.lock();
        let unwritten = &mut state.unwritten;
        if unwritten.rows.len() <= most || !unwritten.ends.is_empty() {
            drop(state);
            return (self.take_unwritten(), false);
        }
        let later = unwritten.rows.split_off(most);
        let rows = std::mem::replace(&mut unwritten.rows, later);
        (PointBatch { solver_version: self.solver_version.to_owned(), rows, ..PointBatch::default() }, true)
    }

    /// Number of points that are not yet stored.
    pub(super) fn unwritten(&self) -> usize {
        self.lock().unwritten.rows.len()
    }

    /// Returns a batch that could not be stored, for the next call of [`RunningPoints::take_unwritten`].
    pub(super) fn restore(&self, mut batch: PointBatch) {
        let mut state = self.lock();
        batch.append(std::mem::take(&mut state.unwritten));
        state.unwritten = batch;
    }

    /// The batch of points of a finished sweep that are not yet stored, and the summary of all its rows; `None` when
    /// `is_stopped` becomes true, which is asked before each row.
    ///
    /// # Errors
    /// A point cannot be written as JSON.
    pub(super) fn finish(
        &self,
        points: &[SweepPoint],
        is_stopped: &dyn Fn() -> bool,
    ) -> serde_json::Result<Option<(PointBatch, RowsSummary)>> {
        let mut batch = self.take_unwritten();
        let positions = std::mem::take(&mut self.lock().positions);
        let mut digest = PointsDigest::default();
        for (position, point) in (0u64..).zip(points) {
            if is_stopped() {
                self.restore(batch);
                return Ok(None);
            }
            let body = to_json(point)?;
            digest.add(&body);
            if !positions.contains(&position) {
                batch.rows.push(PointRow { position, body });
            }
        }
        Ok(Some((batch, RowsSummary { count: points.len() as u64, digest: digest.finish() })))
    }

    fn lock(&self) -> MutexGuard<'_, PointsState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A point as JSON. A number that is not finite is reported as the error of the point.
fn to_json(row: &SweepPoint) -> serde_json::Result<String> {
    match not_finite(row).first() {
        Some(NotFinite { pointer, reason }) if row.error.is_none() => {
            serde_json::to_string(&SweepPoint { error: Some(format!("{pointer} is {reason}")), ..row.clone() })
        }
        _ => serde_json::to_string(row),
    }
}

impl PointStore for RunningPoints {
    fn load(&self) -> StoredPoints {
        std::mem::take(&mut self.lock().resumed)
    }

    fn save(&self, position: usize, row: &SweepPoint, end: Option<&LineEnd>) {
        // A row that cannot be written as JSON fails the job at its end.
        let Ok(body) = to_json(row) else { return };
        let mut state = self.lock();
        state.positions.insert(position as u64);
        state.unwritten.rows.push(PointRow { position: position as u64, body });
        if let Some(LineEnd { line, position, state: end_state }) = end {
            let end_state_row =
                end_state.clone().map(|end_state| EndStateRow { position: *position as u64, state: end_state });
            state.unwritten.end_states.extend(end_state_row);
            let end = LineEndRow { line: *line as u64, position: *position as u64, state: end_state.clone() };
            // Only the last end of a line is stored.
            state.unwritten.ends.retain(|earlier| earlier.line != end.line);
            state.unwritten.ends.push(end);
        }
    }

    fn evaluate(&self, batch: EvaluationBatch, evaluation_ms: Option<f64>) -> HashMap<usize, SweepPoint> {
        let Some((elsewhere, stop)) = &self.elsewhere else { return HashMap::new() };
        let rows = elsewhere.evaluate(batch, evaluation_ms, stop);
        let read = |row: PointRow| Some((row.position as usize, serde_json::from_str(&row.body).ok()?));
        let rows: HashMap<usize, SweepPoint> = rows.into_iter().filter_map(read).collect();
        self.lock().positions.extend(rows.keys().map(|position| *position as u64));
        rows
    }
}
