//! Integration of a trajectory whose last mesh periods are recorded.

use super::analysis::PoincarePoint;
use super::channel::ChannelId;
use super::confidence::{MeanSquares, rms_interval_95};
use super::energy::EnergyBalance;
use super::poincare::PoincareSection;
use super::recorder::ChannelRecorder;
use super::report::RecordedMotion;
use crate::dynamics::{DynamicModel, DynamicsError, MotionState, Observer, Segment, StepCounts, TrajectoryObserver};

/// Number of parts of a record from which its standard error is estimated.
const BATCHES: usize = 10;
/// Shortest record that ends by its statistics, and mesh periods between two looks at them.
const STATISTICAL_RECORD_MESH_PERIODS: u64 = 300;
const MESH_PERIODS_BETWEEN_LOOKS: u64 = 50;
/// Up to this many recorded mesh periods the record is one of a known period, and periodicity is not tested.
const SHORT_RECORD_MESH_PERIODS: u64 = 8;

/// A trajectory with its record. Mesh periods are counted as those of the start.
pub(super) struct RecordedRun<'m, const D: usize> {
    model: &'m DynamicModel<D>,
    state: MotionState<D>,
    tolerance: f64,
    first_period: u64,
    record_from: u64,
    end: u64,
    /// The state at the start of this mesh period is stored.
    store_at: u64,
    pub stored: MotionState<D>,
    /// State at the start of the record.
    pub from: MotionState<D>,
    pub recorder: ChannelRecorder<D>,
    pub energy: Option<EnergyBalance<'m, D>>,
    recent: PoincareSection<D>,
    points: Vec<PoincarePoint>,
    /// Relative half of the 95 % interval of the RMS at which the record ends; 0: it has its full length.
    statistical_accuracy: f64,
    squares: MeanSquares,
    counts: StepCounts,
    error: Option<DynamicsError>,
}

impl<'m, const D: usize> RecordedRun<'m, D> {
    /// Trajectory from `start` to the mesh period `end`, recorded from the mesh period `record_from` on.
    ///
    /// # Errors
    /// [`DynamicsError`] of [`RigidBodyModes::new`](crate::dynamics).
    pub(crate) fn new(
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
            statistical_accuracy: 0.0,
            squares: MeanSquares::new::<D>(recorded),
            counts: StepCounts::default(),
            error: None,
        };
        run.begin_period();
        Ok(run)
    }

    /// Adds an energy balance of the record.
    pub(crate) fn with_energy(self, energy: Option<EnergyBalance<'m, D>>) -> Self {
        Self { energy, ..self }
    }

    /// Ends the record as soon as half of the 95 % interval of the RMS of the circumferential acceleration is within
    /// this part of it; 0: not before its end.
    pub(crate) fn until_accurate(self, statistical_accuracy: f64) -> Self {
        Self { statistical_accuracy, ..self }
    }

    /// Whether the statistics are accurate enough to end the record.
    fn is_accurate(&self, recorded: u64) -> bool {
        if self.statistical_accuracy <= 0.0
            || recorded < STATISTICAL_RECORD_MESH_PERIODS
            || !recorded.is_multiple_of(MESH_PERIODS_BETWEEN_LOOKS)
        {
            return false;
        }
        let squares = self.squares.of(ChannelId::mesh_acceleration(0));
        let interval = squares.and_then(rms_interval_95);
        interval.is_some_and(|interval| {
            interval.high - interval.low <= self.statistical_accuracy * (interval.high + interval.low)
        })
    }

    /// Stores the state at the start of the mesh period `store_at`.
    pub(crate) fn storing_state_at(self, store_at: u64) -> Self {
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

    /// The finished run.
    ///
    /// # Errors
    /// The error that ended the integration.
    pub(crate) fn finish(self) -> Result<FinishedRun<'m, D>, DynamicsError> {
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
            batch_error: self.squares.of(ChannelId::mesh_acceleration(0)).map_or(f64::INFINITY, standard_error),
            mean_squares: self.squares.finish(),
        };
        Ok(FinishedRun { record, recorder: self.recorder, energy: self.energy, stored: self.stored, from: self.from })
    }
}

/// Result of a recorded run.
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
        }
        let goes_on = state.period < self.end && !self.is_accurate(state.period.saturating_sub(self.record_from));
        if goes_on {
            self.begin_period();
        }
        goes_on
    }

    fn finished(&mut self, counts: StepCounts, error: Option<DynamicsError>) {
        (self.counts, self.error) = (counts, error);
    }
}

pub(super) fn poincare<const D: usize>(model: &DynamicModel<D>, state: &MotionState<D>) -> PoincarePoint {
    let x = |row: &[f64; D]| model.mesh_x(0, row);
    PoincarePoint { x_left_m: x(&state.x), v_x_left_m_s: x(&state.v) * model.omega_ref }
}

/// Relative standard error of an RMS from the mean squares of the mesh periods of its record, by the scatter of its
/// parts.
fn standard_error(mean_squares: &[f64]) -> f64 {
    let batch = (mean_squares.len() / BATCHES).max(1);
    let means: Vec<f64> =
        mean_squares.chunks_exact(batch).map(|part| part.iter().sum::<f64>() / batch as f64).collect();
    let n = means.len() as f64;
    if means.len() < 2 {
        return f64::INFINITY;
    }
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if mean > 0.0 { 0.5 * (variance / n).sqrt() / mean } else { 0.0 }
}
