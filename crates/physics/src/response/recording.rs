//! A run from a start: followed through its mesh periods, recorded over the last of them.

use super::analysis::PoincarePoint;
use super::channel::ChannelId;
use super::confidence::MeanSquares;
use super::energy::EnergyBalance;
use super::recorder::ChannelRecorder;
use super::regime::PoincareSection;
use super::report::RecordedMotion;
use super::statistics::MomentAccumulator;
use crate::dynamics::{
    DynamicModel, DynamicsError, MotionState, Observer, Segment, StepCounts, TrajectoryObserver, U, YG, YP,
};

/// Parts of a record whose scatter gives its standard error.
const BATCHES: u64 = 10;
/// Up to this many recorded mesh periods it is known that the motion repeats, and not input.
const SHORT_RECORD_MESH_PERIODS: u64 = 8;

/// The run, and what has been gathered of it. Mesh periods are counted as the start's are.
pub(super) struct RecordedRun<'m, const D: usize> {
    model: &'m DynamicModel<D>,
    state: MotionState<D>,
    tolerance: f64,
    first_period: u64,
    record_from: u64,
    end: u64,
    /// The state at the start of this mesh period is kept.
    store_at: u64,
    pub stored: MotionState<D>,
    /// The state from which the record starts.
    pub from: MotionState<D>,
    pub recorder: ChannelRecorder<D>,
    pub energy: Option<EnergyBalance<'m, D>>,
    recent: PoincareSection<D>,
    points: Vec<PoincarePoint>,
    batch: u64,
    batches: Vec<f64>,
    snapshot: MomentAccumulator,
    squares: MeanSquares,
    counts: StepCounts,
    error: Option<DynamicsError>,
}

impl<'m, const D: usize> RecordedRun<'m, D> {
    /// From `start` to the mesh period `end`, recorded from `record_from` on.
    pub fn new(
        model: &'m DynamicModel<D>,
        start: MotionState<D>,
        tolerance: f64,
        (record_from, end): (u64, u64),
        recorder: ChannelRecorder<D>,
    ) -> Result<Self, DynamicsError> {
        let recorded = end - record_from;
        let mut run = Self {
            model,
            state: start,
            tolerance,
            first_period: start.period,
            record_from,
            end,
            store_at: start.period,
            stored: start,
            from: start,
            recorder,
            energy: None,
            recent: if recorded > SHORT_RECORD_MESH_PERIODS {
                PoincareSection::without_rigid_body(model)?
            } else {
                PoincareSection::new()
            },
            points: Vec::with_capacity(recorded.min(1 << 20) as usize),
            batch: (recorded / BATCHES).max(1),
            batches: Vec::new(),
            snapshot: MomentAccumulator::new(false),
            squares: MeanSquares::new::<D>(recorded),
            counts: StepCounts::default(),
            error: None,
        };
        run.begin_period();
        Ok(run)
    }

    /// With the energy balance of what is recorded.
    pub fn with_energy(self, energy: Option<EnergyBalance<'m, D>>) -> Self {
        Self { energy, ..self }
    }

    /// Keeps the state at the start of the mesh period `store_at`.
    pub fn storing_state_at(self, store_at: u64) -> Self {
        Self { store_at, ..self }
    }

    fn begin_period(&mut self) {
        let state = self.state;
        if state.period == self.store_at {
            self.stored = state;
        }
        if state.period == self.record_from {
            self.from = state;
        }
        if self.wants_segments() {
            self.recent.push(state);
            self.points.push(poincare(self.model, &state));
        }
    }

    /// What was recorded; fails where the run did.
    pub fn finish(self) -> Result<FinishedRun<'m, D>, DynamicsError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let mut recent = self.recent;
        recent.push(self.state);
        let record = RecordedMotion {
            recent,
            points: self.points,
            last: self.state,
            counts: self.counts,
            batch_error: standard_error(&self.batches),
            mean_squares: self.squares.finish(),
        };
        Ok(FinishedRun { record, recorder: self.recorder, energy: self.energy, stored: self.stored, from: self.from })
    }
}

/// What a run leaves.
pub(super) struct FinishedRun<'m, const D: usize> {
    pub record: RecordedMotion<D>,
    pub recorder: ChannelRecorder<D>,
    pub energy: Option<EnergyBalance<'m, D>>,
    pub stored: MotionState<D>,
    pub from: MotionState<D>,
}

impl<'m, const D: usize> TrajectoryObserver<'m, D> for RecordedRun<'m, D> {
    fn model(&self) -> &'m DynamicModel<D> {
        self.model
    }

    fn start(&self) -> MotionState<D> {
        self.state
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn fraction_done(&self) -> f64 {
        (self.state.period - self.first_period) as f64 / (self.end - self.first_period).max(1) as f64
    }

    fn wants_segments(&self) -> bool {
        self.state.period >= self.record_from && self.state.period < self.end
    }

    fn segment(&mut self, segment: &Segment<'_, D>) {
        self.recorder.segment(segment);
        self.energy.segment(segment);
    }

    fn finish_period(&mut self, state: &MotionState<D>) -> bool {
        let recorded = self.wants_segments();
        self.state = *state;
        if recorded {
            self.squares.push(&self.recorder);
            if (state.period - self.record_from).is_multiple_of(self.batch)
                && let Some(now) = self.recorder.accumulator(ChannelId::mesh_acceleration(0))
            {
                self.batches.push(now.variance_since(&self.snapshot));
                self.snapshot = *now;
            }
        }
        let goes_on = state.period < self.end;
        if goes_on {
            self.begin_period();
        }
        goes_on
    }

    fn finished(&mut self, counts: StepCounts, error: Option<DynamicsError>) {
        (self.counts, self.error) = (counts, error);
    }
}

fn poincare<const D: usize>(model: &DynamicModel<D>, state: &MotionState<D>) -> PoincarePoint {
    let x = |row: &[f64; D]| row[YP] - row[YG] + row[U];
    PoincarePoint { x_left_m: x(&state.x), v_x_left_m_s: x(&state.v) * model.omega_ref }
}

/// Relative standard error of an RMS from the mean squares of the parts of its record.
fn standard_error(mean_squares: &[f64]) -> f64 {
    let n = mean_squares.len() as f64;
    if mean_squares.len() < 2 {
        return f64::INFINITY;
    }
    let mean = mean_squares.iter().sum::<f64>() / n;
    let variance = mean_squares.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if mean > 0.0 { 0.5 * (variance / n).sqrt() / mean } else { 0.0 }
}
