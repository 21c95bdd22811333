//! Evaluations of an optimisation by workers. The search runs in this process; a batch of it is cut into chunks, and
//! the search goes on when their rows are stored.

use super::active::ActiveJob;
use super::admit::{WORTH_SENDING_S, until_stored};
use super::names::{depends_on_processor, processor_class, solver_of, solver_of_class};
use super::plan::{CHUNK_S, ranges_of};
use super::shared::Shared;
use crate::store::{ChunkPart, Claim, PointRow};
use crate::work::running_points::EvaluateElsewhere;
use crate::work::stop_signal::{StopReason, StopSignal};
use herringbone_job::study::{EvaluationBatch, EvaluationTask};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::sync::Notify;

/// Most evaluations of a chunk.
const MOST_TASKS: usize = 256;
/// Longest wait until it is asked again whether the job is to stop.
const ASK_AFTER: Duration = Duration::from_millis(100);
/// Time without any worker after which evaluations are made here.
const ALONE_AFTER: Duration = Duration::from_secs(2);

/// Evaluations that were asked for and are not cut into chunks.
#[derive(Debug)]
pub(super) struct EvaluationPlan {
    measures_of_input: Option<Vec<f64>>,
    left: BTreeMap<u64, EvaluationTask>,
    /// Evaluations of the batch.
    asked: usize,
    /// Time of an evaluation.
    evaluation_s: Option<f64>,
    /// Whether the document is too large to be sent.
    is_too_large: bool,
    /// Notified when a chunk is stored.
    stored: Arc<Notify>,
}

impl EvaluationPlan {
    fn new(stored: Arc<Notify>) -> Self {
        Self {
            measures_of_input: None,
            left: BTreeMap::new(),
            asked: 0,
            evaluation_s: None,
            is_too_large: false,
            stored,
        }
    }

    fn ask(&mut self, batch: EvaluationBatch, evaluation_s: Option<f64>) {
        self.asked = batch.tasks.len();
        self.measures_of_input = batch.measures_of_input;
        self.left = batch.tasks;
        self.evaluation_s = self.evaluation_s.or(evaluation_s);
    }

    /// Cuts the next chunk for workers with so many slots: an equal share of the batch, of two seconds at most.
    pub(super) fn cut(&mut self, slots: usize) -> Option<ChunkPart> {
        let share = self.asked.div_ceil(slots.max(1));
        let most = self.evaluation_s.map_or(1.0, |seconds| (CHUNK_S / seconds).clamp(1.0, MOST_TASKS as f64));
        let mut tasks = BTreeMap::new();
        while tasks.len() < share.min(most as usize).max(1) {
            let Some((position, task)) = self.left.pop_first() else { break };
            tasks.insert(position, task);
        }
        if tasks.is_empty() {
            return None;
        }
        let positions: Vec<u64> = tasks.keys().copied().collect();
        let batch = EvaluationBatch { measures_of_input: self.measures_of_input.clone(), tasks };
        // Numbers and words: always JSON.
        let batch = serde_json::to_string(&batch).unwrap_or_default();
        Some(ChunkPart::Evaluations { ranges: ranges_of(&positions), batch })
    }

    /// Takes up that a chunk is stored: the number and time of its evaluations.
    pub(super) fn store(&mut self, measured: Option<(u64, f64)>) {
        if let Some((evaluations, work_s)) = measured
            && evaluations > 0
            && work_s.is_finite()
        {
            self.evaluation_s = Some((work_s / evaluations as f64).max(1e-6));
        }
        self.stored.notify_one();
    }

    /// Takes up that the document is too large to be sent.
    pub(super) fn refuse(&mut self) {
        self.left.clear();
        self.is_too_large = true;
        self.stored.notify_one();
    }
}

/// The workers, as the search of a job that runs in this process sees them.
pub(super) struct WorkersOfSearch {
    shared: Arc<Shared>,
    claim: Claim,
    /// Which workers can take its evaluations.
    solver: String,
    runtime: Handle,
    stored: Arc<Notify>,
}

impl WorkersOfSearch {
    pub(super) fn new(shared: &Arc<Shared>, claim: Claim, document: &herringbone_job::document::JobDocument) -> Self {
        let version = shared.solver.version();
        // Rows of this process and of the workers are mixed: they are to be equal to the last bit.
        let solver = match depends_on_processor(document) {
            true => solver_of_class(version, processor_class()),
            false => solver_of(version),
        };
        Self { shared: Arc::clone(shared), claim, solver, runtime: Handle::current(), stored: Arc::default() }
    }

    fn slots(&self) -> usize {
        self.shared.state().members.slots(&self.solver, Instant::now())
    }

    /// Whether a batch is worth sending: workers make more than one at once, and each takes longer than a message.
    fn is_worth_sending(&self, batch: &EvaluationBatch, evaluation_s: Option<f64>) -> bool {
        batch.tasks.len() > 1
            && evaluation_s.is_none_or(|seconds| seconds >= WORTH_SENDING_S)
            && self.shared.nats.is_up()
            && self.slots() > 0
    }

    fn ask(&self, batch: EvaluationBatch, evaluation_s: Option<f64>) -> bool {
        let mut state = self.shared.state();
        let id = self.claim.job.id;
        if !state.jobs.contains_key(&id) {
            let plan = EvaluationPlan::new(Arc::clone(&self.stored));
            state.insert(ActiveJob::of_search(self.claim.clone(), self.solver.clone(), plan, Instant::now()));
        }
        let Some(plan) = state.jobs.get_mut(&id).and_then(|job| job.evaluations.as_mut()) else { return false };
        if plan.is_too_large {
            return false;
        }
        plan.ask(batch, evaluation_s);
        true
    }

    /// Waits until all evaluations that were asked for are stored, or are to be made here.
    fn wait(&self, stop: &StopSignal) {
        let id = self.claim.job.id;
        let mut alone_since = None;
        loop {
            let _ = self.runtime.block_on(async { tokio::time::timeout(ASK_AFTER, self.stored.notified()).await });
            let mut state = self.shared.state();
            let slots = state.members.slots(&self.solver, Instant::now());
            let Some(job) = state.jobs.get_mut(&id) else {
                // It has failed on a worker.
                return stop.request(StopReason::Cancel);
            };
            let is_done = job.open.is_empty() && job.evaluations.as_ref().is_none_or(|plan| plan.left.is_empty());
            if is_done || stop.is_requested() {
                return;
            }
            if job.stop.is_some() {
                return stop.request(StopReason::Cancel);
            }
            alone_since = (slots == 0).then(|| alone_since.unwrap_or_else(Instant::now));
            if alone_since.is_some_and(|since: Instant| since.elapsed() > ALONE_AFTER) {
                tracing::info!("no worker is left: evaluations are made here");
                job.open.clear();
                if let Some(plan) = &mut job.evaluations {
                    plan.left.clear();
                }
                return;
            }
        }
    }
}

impl EvaluateElsewhere for WorkersOfSearch {
    fn evaluate(&self, batch: EvaluationBatch, evaluation_ms: Option<f64>, stop: &StopSignal) -> Vec<PointRow> {
        let evaluation_s = evaluation_ms.map(|milliseconds| 1e-3 * milliseconds);
        let (Some((&first, _)), Some((&last, _))) = (batch.tasks.first_key_value(), batch.tasks.last_key_value())
        else {
            return Vec::new();
        };
        let positions: Vec<u64> = batch.tasks.keys().copied().collect();
        if !self.is_worth_sending(&batch, evaluation_s) || !self.ask(batch, evaluation_s) {
            return Vec::new();
        }
        self.shared.wake.notify_one();
        self.wait(stop);
        if stop.is_requested() {
            return Vec::new();
        }
        let read = || self.shared.store().points(self.claim.job.id, first, last + 1, u32::MAX);
        let rows = self.runtime.block_on(until_stored(&self.shared, read));
        let is_of_batch = |row: &PointRow| positions.binary_search(&row.position).is_ok();
        rows.unwrap_or_default().into_iter().filter(is_of_batch).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::EvaluationPhase;
    use herringbone_job::study::EvaluationSettings;

    fn plan(positions: &[u64], evaluation_s: Option<f64>) -> EvaluationPlan {
        let task = |value: u64| EvaluationTask {
            settings: EvaluationSettings::Search,
            values: vec![value as f64 / 3.0],
            further: Vec::new(),
            phase: EvaluationPhase::Search,
            generation: Some(1),
        };
        let tasks = positions.iter().map(|position| (*position, task(*position))).collect();
        let mut plan = EvaluationPlan::new(Arc::default());
        plan.ask(EvaluationBatch { measures_of_input: Some(vec![0.1]), tasks }, evaluation_s);
        plan
    }

    fn cut_all(mut plan: EvaluationPlan, slots: usize) -> Vec<Vec<[u64; 2]>> {
        let mut all = BTreeMap::new();
        let mut cut = Vec::new();
        while let Some(ChunkPart::Evaluations { ranges, batch }) = plan.cut(slots) {
            let batch: EvaluationBatch = serde_json::from_str(&batch).unwrap();
            let positions: Vec<u64> = ranges.iter().flat_map(|[from, to]| *from..*to).collect();
            assert_eq!(batch.tasks.keys().copied().collect::<Vec<_>>(), positions);
            assert_eq!(batch.measures_of_input, Some(vec![0.1]));
            all.extend(batch.tasks);
            cut.push(ranges);
        }
        assert!(all.iter().all(|(position, task)| task.values == [*position as f64 / 3.0]));
        cut
    }

    #[test]
    fn a_batch_is_shared_by_the_slots() {
        assert_eq!(cut_all(plan(&[3, 4, 6, 7, 8], Some(0.01)), 2), [vec![[3, 5], [6, 7]], vec![[7, 9]]]);
        assert_eq!(cut_all(plan(&[3, 4], Some(0.01)), 8), [vec![[3, 4]], vec![[4, 5]]]);
        assert_eq!(cut_all(plan(&[], Some(0.01)), 8), [[[0; 2]; 0]; 0]);
    }

    #[test]
    fn chunks_last_two_seconds_at_most() {
        let positions: Vec<u64> = (0..100).collect();
        assert_eq!(cut_all(plan(&positions, Some(0.1)), 2).len(), 5);
        assert_eq!(cut_all(plan(&positions, Some(10.0)), 2).len(), 100);
        // One at a time until it is known how long one takes.
        assert_eq!(cut_all(plan(&positions, None), 2).len(), 100);
        let positions: Vec<u64> = (0..1000).collect();
        assert_eq!(cut_all(plan(&positions, Some(1e-4)), 1).len(), 4);
    }
}
