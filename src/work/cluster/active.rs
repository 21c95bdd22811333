//! The jobs that workers compute now, and their chunks that are not stored: what the database says, in memory.

use super::evaluations::EvaluationPlan;
use super::members::Members;
use super::message::{Beat, BeatAnswer, key_of};
use super::plan::SweepPlan;
use crate::store::{
    ChunkClass, ChunkKey, ChunkPart, ChunkRecord, ChunkState, Claim, JobId, JobRecord, LineEndRow, WorkClass,
};
use crate::work::stop_signal::StopReason;
use std::collections::{BTreeMap, HashMap, VecDeque};
use std::time::{Duration, Instant};

/// Time after its last beat for which a chunk counts as being computed.
const RUNNING_FOR: Duration = Duration::from_secs(4);

/// A job that workers compute.
#[derive(Debug)]
pub(super) struct ActiveJob {
    pub job: JobRecord,
    pub input: String,
    pub class: WorkClass,
    /// Which workers can take its chunks.
    pub solver: String,
    /// What is left of a sweep.
    pub plan: Option<SweepPlan>,
    /// Of an optimisation, whose search runs in this process: what its last batch still needs.
    pub evaluations: Option<EvaluationPlan>,
    pub open: BTreeMap<u32, OpenChunk>,
    pub next_chunk: u32,
    /// Rows that are stored, of how many.
    pub rows: u64,
    pub points: u64,
    /// Whether all stored rows are of this attempt.
    pub rows_are_own: bool,
    /// Computing time of earlier attempts, and of this one.
    pub computed_before: Duration,
    pub computed: Duration,
    pub turn_started: Instant,
    /// Why it is to be ended before it is computed.
    pub stop: Option<StopReason>,
    /// Progress that was published last.
    pub published: f64,
}

/// A chunk that is not stored.
#[derive(Debug, Clone)]
pub(super) struct OpenChunk {
    pub class: ChunkClass,
    pub part: ChunkPart,
    pub issue: u32,
    pub state: ChunkState,
    pub sequence: Option<u64>,
    pub issued: Instant,
    /// Last beat of a worker that computes it.
    pub seen: Option<Instant>,
    pub stage: String,
    pub fraction: f64,
    /// How often it ended without all its results.
    pub incomplete: u32,
}

impl OpenChunk {
    pub(super) fn of(record: &ChunkRecord, now: Instant) -> Self {
        Self {
            class: record.class,
            part: record.part.clone(),
            issue: record.issue,
            state: record.state,
            sequence: record.sequence,
            issued: now,
            seen: None,
            stage: String::new(),
            fraction: 0.0,
            incomplete: 0,
        }
    }

    pub(super) fn is_running(&self, now: Instant) -> bool {
        self.seen.is_some_and(|seen| now.saturating_duration_since(seen) < RUNNING_FOR)
    }
}

impl ActiveJob {
    pub(super) fn new(claim: Claim, solver: String, plan: Option<SweepPlan>, stored: u64, now: Instant) -> Self {
        let points = plan.as_ref().map_or(1, |plan| plan.order().points() as u64);
        Self {
            class: WorkClass::of_kind(&claim.job.kind),
            published: claim.job.progress,
            job: claim.job,
            input: claim.input,
            solver,
            plan,
            evaluations: None,
            open: BTreeMap::new(),
            next_chunk: 0,
            rows: stored,
            points,
            rows_are_own: stored == 0,
            computed_before: claim.computed,
            computed: Duration::ZERO,
            turn_started: now,
            stop: None,
        }
    }

    /// An optimisation, whose search runs in this process.
    pub(super) fn of_search(claim: Claim, solver: String, evaluations: EvaluationPlan, now: Instant) -> Self {
        Self { evaluations: Some(evaluations), ..Self::new(claim, solver, None, 0, now) }
    }

    /// Whether the job runs in this process and only parts of it are computed by workers: its time, its end and its
    /// progress are those of its run here.
    pub(super) fn runs_here(&self) -> bool {
        self.evaluations.is_some()
    }

    /// Positions of the rows of a part.
    pub(super) fn positions(&self, part: &ChunkPart) -> Option<Vec<[u64; 2]>> {
        match part {
            ChunkPart::Evaluations { ranges, .. } => Some(ranges.clone()),
            _ => Some(self.plan.as_ref()?.positions(part)),
        }
    }

    /// Whether all of a sweep is stored.
    pub(super) fn is_computed(&self) -> bool {
        self.open.is_empty() && self.plan.as_ref().is_some_and(|plan| plan.remaining() == 0)
    }

    /// Cuts the next chunk for workers with so many slots.
    pub(super) fn cut(&mut self, slots: usize, now: Instant) -> Option<ChunkRecord> {
        if self.stop.is_some() {
            return None;
        }
        let (class, part) = match (&mut self.plan, &mut self.evaluations) {
            (Some(plan), _) => plan.cut(slots)?,
            (None, Some(evaluations)) => (ChunkClass::Sweep, evaluations.cut(slots)?),
            (None, None) if self.next_chunk == 0 => (ChunkClass::Single, ChunkPart::Whole),
            (None, None) => return None,
        };
        let key = ChunkKey { job: self.job.id, attempt: self.job.attempt, chunk: self.next_chunk };
        self.next_chunk += 1;
        let (solver, sequence) = (self.solver.clone(), None);
        let record = ChunkRecord { key, class, solver, state: ChunkState::Waiting, issue: 1, part, sequence };
        self.open.insert(key.chunk, OpenChunk::of(&record, now));
        Some(record)
    }

    /// Fraction of the job that is done.
    pub(super) fn progress(&self) -> f64 {
        match &self.plan {
            Some(_) => self.rows as f64 / self.points.max(1) as f64,
            None => self.open.values().map(|chunk| chunk.fraction).fold(0.0, f64::max),
        }
    }

    /// Stage that is shown.
    pub(super) fn stage(&self) -> String {
        match &self.plan {
            Some(_) if self.job.kind == "tolerance" => "evaluations".to_owned(),
            Some(_) => "sweep".to_owned(),
            None => {
                self.open.values().map(|chunk| chunk.stage.clone()).find(|stage| !stage.is_empty()).unwrap_or_default()
            }
        }
    }
}

/// All of it.
#[derive(Debug, Default)]
pub(super) struct State {
    pub jobs: HashMap<JobId, ActiveJob>,
    /// Whose turn it is to have chunks cut: the first one.
    pub turns: VecDeque<JobId>,
    pub members: Members,
    /// Largest place in the stream of work that was answered.
    pub last_sequence: u64,
    /// Messages with results that were taken, stored or dropped.
    pub results_taken: u64,
    /// Sweeps whose result is put together from their rows.
    pub finishing: usize,
}

impl State {
    pub(super) fn insert(&mut self, job: ActiveJob) {
        self.turns.push_back(job.job.id);
        self.jobs.insert(job.job.id, job);
    }

    pub(super) fn remove(&mut self, id: JobId) -> Option<ActiveJob> {
        self.turns.retain(|other| *other != id);
        self.jobs.remove(&id)
    }

    pub(super) fn job(&mut self, key: ChunkKey) -> Option<&mut ActiveJob> {
        self.jobs.get_mut(&key.job).filter(|job| job.job.attempt == key.attempt)
    }

    pub(super) fn chunk(&mut self, key: ChunkKey) -> Option<&mut OpenChunk> {
        self.job(key)?.open.get_mut(&key.chunk)
    }

    /// Numbers of chunks that are not stored, of jobs of one operating point and of sweeps.
    pub(super) fn open(&self) -> (usize, usize) {
        self.count(|job| job.open.len())
    }

    /// As [`State::open`]; a job of which no chunk is cut yet counts as one.
    pub(super) fn open_soon(&self) -> (usize, usize) {
        self.count(|job| job.open.len().max(1))
    }

    fn count(&self, chunks: impl Fn(&ActiveJob) -> usize) -> (usize, usize) {
        self.jobs.values().fold((0, 0), |(singles, sweeps), job| match job.class {
            WorkClass::Single => (singles + chunks(job), sweeps),
            WorkClass::Sweep => (singles, sweeps + chunks(job)),
        })
    }

    /// Takes up what a worker does. Returns the chunks it is to stop.
    pub(super) fn beat(&mut self, beat: &Beat, now: Instant) -> BeatAnswer {
        let mut answer = BeatAnswer::default();
        for (place, chunk) in (0u32..).zip(&beat.running) {
            let key = key_of(&chunk.job, chunk.attempt, chunk.chunk).ok();
            let wanted =
                key.and_then(|key| self.job(key)).filter(|job| job.stop.is_none_or(|stop| stop == StopReason::Turn));
            match wanted.and_then(|job| job.open.get_mut(&chunk.chunk)) {
                Some(open) => {
                    open.seen = Some(now);
                    open.stage = chunk.stage.chars().take(32).collect();
                    if chunk.fraction.is_finite() {
                        open.fraction = open.fraction.max(chunk.fraction.clamp(0.0, 1.0));
                    }
                }
                None => answer.stop.push(place),
            }
        }
        answer
    }

    /// Takes up that all results of a chunk are stored.
    pub(super) fn store(&mut self, key: ChunkKey, measured: Option<(u64, f64)>, end: Option<&LineEndRow>) {
        let Some(job) = self.job(key) else { return };
        let Some(chunk) = job.open.remove(&key.chunk) else { return };
        if let Some(plan) = &mut job.plan {
            plan.store(&chunk.part, measured, end);
        }
        if let Some(evaluations) = &mut job.evaluations {
            evaluations.store(measured);
        }
    }
}
