//! A run from a start: followed through its mesh periods, recorded over the last of them.

use super::analysis::PoincarePoint;
use super::channel::ChannelId;
use super::confidence::MeanSquares;
use super::energy::EnergyBalance;
use super::recorder::Recorder;
use super::regime::Section;
use super::report::Record;
use super::statistics::Gathered;
use crate::dynamics::{DynamicsError, Model, Numerics, Observer, TrajectoryObserver, Segment, State, U, YG, YP};

/// Parts of a record whose scatter gives its standard error.
const BATCHES: u64 = 10;
/// Up to this many recorded mesh periods it is known that the motion repeats, and not asked.
const KNOWN_TO_REPEAT: u64 = 8;

/// The run, and what has been gathered of it. Mesh periods are counted as the start's are.
pub(super) struct Run<'m, const D: usize> {
    model: &'m Model<D>,
    state: State<D>,
    tolerance: f64,
    first: u64,
    record_from: u64,
    end: u64,
    /// The state at the start of this mesh period is kept.
    keep_at: u64,
    pub kept: State<D>,
    /// The state from which the record starts.
    pub from: State<D>,
    pub recorder: Recorder<D>,
    pub energy: Option<EnergyBalance<'m, D>>,
    recent: Section<D>,
    points: Vec<PoincarePoint>,
    batch: u64,
    batches: Vec<f64>,
    snapshot: Gathered,
    squares: MeanSquares,
    numerics: Numerics,
    error: Option<DynamicsError>,
}

impl<'m, const D: usize> Run<'m, D> {
    /// From `start` to the mesh period `end`, recorded from `record_from` on.
    pub fn new(
        model: &'m Model<D>,
        start: State<D>,
        tolerance: f64,
        (record_from, end): (u64, u64),
        recorder: Recorder<D>,
    ) -> Result<Self, DynamicsError> {
        let recorded = end - record_from;
        let mut run = Self {
            model,
            state: start,
            tolerance,
            first: start.period,
            record_from,
            end,
            keep_at: start.period,
            kept: start,
            from: start,
            recorder,
            energy: None,
            recent: if recorded > KNOWN_TO_REPEAT { Section::without_rigid_body(model)? } else { Section::new() },
            points: Vec::with_capacity(recorded.min(1 << 20) as usize),
            batch: (recorded / BATCHES).max(1),
            batches: Vec::new(),
            snapshot: Gathered::new(false),
            squares: MeanSquares::new::<D>(recorded),
            numerics: Numerics::default(),
            error: None,
        };
        run.period_begins();
        Ok(run)
    }

    /// With the energy balance of what is recorded.
    pub fn with_energy(self, energy: Option<EnergyBalance<'m, D>>) -> Self {
        Self { energy, ..self }
    }

    /// Keeps the state at the start of the mesh period `keep_at`.
    pub fn keeping(self, keep_at: u64) -> Self {
        Self { keep_at, ..self }
    }

    fn period_begins(&mut self) {
        let state = self.state;
        if state.period == self.keep_at {
            self.kept = state;
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
    pub fn finish(self) -> Result<Finished<'m, D>, DynamicsError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let mut recent = self.recent;
        recent.push(self.state);
        let record = Record {
            recent,
            points: self.points,
            last: self.state,
            numerics: self.numerics,
            batch_error: standard_error(&self.batches),
            mean_squares: self.squares.finish(),
        };
        Ok(Finished { record, recorder: self.recorder, energy: self.energy, kept: self.kept, from: self.from })
    }
}

/// What a run leaves.
pub(super) struct Finished<'m, const D: usize> {
    pub record: Record<D>,
    pub recorder: Recorder<D>,
    pub energy: Option<EnergyBalance<'m, D>>,
    pub kept: State<D>,
    pub from: State<D>,
}

impl<'m, const D: usize> TrajectoryObserver<'m, D> for Run<'m, D> {
    fn model(&self) -> &'m Model<D> {
        self.model
    }

    fn start(&self) -> State<D> {
        self.state
    }

    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn fraction_done(&self) -> f64 {
        (self.state.period - self.first) as f64 / (self.end - self.first).max(1) as f64
    }

    fn wants_segments(&self) -> bool {
        self.state.period >= self.record_from && self.state.period < self.end
    }

    fn segment(&mut self, segment: &Segment<'_, D>) {
        self.recorder.segment(segment);
        self.energy.segment(segment);
    }

    fn finish_period(&mut self, state: &State<D>) -> bool {
        let recorded = self.wants_segments();
        self.state = *state;
        if recorded {
            self.squares.push(&self.recorder);
            if (state.period - self.record_from).is_multiple_of(self.batch)
                && let Some(now) = self.recorder.gathered(ChannelId::mesh_acceleration(0))
            {
                self.batches.push(now.variance_since(&self.snapshot));
                self.snapshot = *now;
            }
        }
        let goes_on = state.period < self.end;
        if goes_on {
            self.period_begins();
        }
        goes_on
    }

    fn finished(&mut self, numerics: Numerics, error: Option<DynamicsError>) {
        (self.numerics, self.error) = (numerics, error);
    }
}

fn poincare<const D: usize>(model: &Model<D>, state: &State<D>) -> PoincarePoint {
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
