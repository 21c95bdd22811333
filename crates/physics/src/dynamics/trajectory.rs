//! Trajectories from an initial state through a number of mesh periods, without statistics or time series.

use rayon::prelude::*;

use super::error::DynamicsError;
use super::integrate::{Integrator, StepCounts};
use super::lane_batch::{POINTS_PER_TASK, TrajectoryObserver, integrate_trajectories, integrate_trajectory};
use super::model::{DynamicModel, MotionState};
use super::parameters::Parameters;
use super::segment::Segment;
use super::train_equations::train_size;
use crate::watch::{Canceled, Watch};

/// End of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FinalState {
    /// 12 displacements in the order of [the module](crate::dynamics) (m, rad), then 12 velocities (m/s, rad/s).
    pub state: [f64; 24],
    /// Steps and force evaluations of the trajectory.
    pub counts: StepCounts,
}

/// Integrates the equations of motion of `p` from `start` (12 displacements in m and rad, then 12 velocities in m/s and
/// rad/s, in the order of [the module](crate::dynamics)) through `mesh_periods`. `tolerance` is the local error of a
/// step relative to the size of the motion. Equal halves with a mirror-symmetric start are integrated in six
/// coordinates.
///
/// # Errors
/// [`DynamicsError`] for invalid parameters, for a motion that diverges and for steps below the resolution of time.
pub fn advance(
    p: &Parameters,
    start: &[f64; 24],
    mesh_periods: u64,
    integrator: Integrator,
    tolerance: f64,
    watch: &Watch<'_>,
) -> Result<FinalState, DynamicsError> {
    fn run<const D: usize>(
        p: &Parameters,
        start: &[f64; 24],
        mesh_periods: u64,
        (integrator, tolerance): (Integrator, f64),
        watch: &Watch<'_>,
    ) -> Result<FinalState, DynamicsError> {
        let model = DynamicModel::<D>::new(p)?;
        let mut observer = FinalStateObserver::new(&model, start, mesh_periods, tolerance);
        if mesh_periods > 0 {
            integrate_trajectory(&mut observer, integrator, u64::MAX, watch)?;
        }
        observer.outcome
    }
    let by = (integrator, tolerance);
    match number_of_coordinates(p, is_mirrored(start)) {
        6 => run::<6>(p, start, mesh_periods, by, watch),
        12 => run::<12>(p, start, mesh_periods, by, watch),
        52 => run::<52>(p, start, mesh_periods, by, watch),
        76 => run::<76>(p, start, mesh_periods, by, watch),
        _ => run::<100>(p, start, mesh_periods, by, watch),
    }
}

/// Number of coordinates in which a pair is solved: 6 for equal halves with a mirrored start, 12, or the size that
/// holds its train (52, 76 or 100).
pub(crate) fn number_of_coordinates(p: &Parameters, mirrored_start: bool) -> usize {
    match &p.train {
        Some(train) => train_size(train),
        None if mirrored_start && p.is_symmetric() => 6,
        None => 12,
    }
}

/// Integrates several trajectories by Taylor series as [`advance`] does, eight per thread in vector lanes (trains one
/// after the other) and on all threads of the pool. `starts` holds one state per entry of `points`. The results are
/// bit-identical to those of [`advance`].
///
/// # Errors
/// [`Canceled`] for all; [`DynamicsError`] per point as [`advance`].
pub fn advance_many(
    points: &[Parameters],
    starts: &[[f64; 24]],
    mesh_periods: u64,
    tolerance: f64,
    watch: &Watch<'_>,
) -> Result<Vec<Result<FinalState, DynamicsError>>, Canceled> {
    let pairs: Vec<_> = points.iter().zip(starts).collect();
    let groups: Result<Vec<_>, Canceled> = pairs
        .par_chunks(POINTS_PER_TASK)
        .map(|group| {
            let mut out = vec![Err(DynamicsError::Canceled(Canceled)); group.len()];
            let coordinates = |i: usize| number_of_coordinates(group[i].0, is_mirrored(group[i].1));
            let (pairs, trains): (Vec<usize>, Vec<usize>) = (0..group.len()).partition(|&i| group[i].0.train.is_none());
            // Trains have no lanes.
            for i in trains {
                let (p, start) = group[i];
                out[i] = advance(p, start, mesh_periods, Integrator::Taylor, tolerance, watch);
                if out[i] == Err(DynamicsError::Canceled(Canceled)) {
                    return Err(Canceled);
                }
            }
            let (halves, whole): (Vec<usize>, Vec<usize>) = pairs.into_iter().partition(|&i| coordinates(i) == 6);
            advance_group::<6>(group, &halves, mesh_periods, tolerance, watch, &mut out)?;
            advance_group::<12>(group, &whole, mesh_periods, tolerance, watch, &mut out)?;
            Ok(out)
        })
        .collect();
    Ok(groups?.into_iter().flatten().collect())
}

/// Observer that keeps only the final state.
struct FinalStateObserver<'m, const D: usize> {
    model: &'m DynamicModel<D>,
    state: MotionState<D>,
    mesh_periods: u64,
    tolerance: f64,
    outcome: Result<FinalState, DynamicsError>,
}

impl<'m, const D: usize> FinalStateObserver<'m, D> {
    fn new(model: &'m DynamicModel<D>, start: &[f64; 24], mesh_periods: u64, tolerance: f64) -> Self {
        let outcome = Ok(FinalState { state: *start, counts: StepCounts::default() });
        Self { model, state: model.state_from(start), mesh_periods, tolerance, outcome }
    }
}

fn advance_group<const D: usize>(
    points: &[(&Parameters, &[f64; 24])],
    indices: &[usize],
    mesh_periods: u64,
    tolerance: f64,
    watch: &Watch<'_>,
    out: &mut [Result<FinalState, DynamicsError>],
) -> Result<(), Canceled> {
    let models: Vec<_> = indices.iter().map(|&i| DynamicModel::<D>::new(points[i].0)).collect();
    let mut observers = Vec::with_capacity(indices.len());
    let mut positions = Vec::with_capacity(indices.len());
    for (&index, model) in indices.iter().zip(&models) {
        match model {
            Ok(model) => {
                observers.push(FinalStateObserver::new(model, points[index].1, mesh_periods, tolerance));
                positions.push(index);
            }
            Err(error) => out[index] = Err(error.clone()),
        }
    }
    if mesh_periods > 0 {
        integrate_trajectories(&mut observers, tolerance, u64::MAX, watch)?;
    }
    for (index, observer) in positions.into_iter().zip(observers) {
        out[index] = observer.outcome;
    }
    Ok(())
}

impl<'m, const D: usize> TrajectoryObserver<'m, D> for FinalStateObserver<'m, D> {
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
        self.state.period as f64 / self.mesh_periods as f64
    }

    fn wants_segments(&self) -> bool {
        false
    }

    fn segment(&mut self, _: &Segment<'_, D>) {}

    fn finish_period(&mut self, state: &MotionState<D>) -> bool {
        self.state = *state;
        state.period < self.mesh_periods
    }

    fn finished(&mut self, counts: StepCounts, error: Option<DynamicsError>) {
        let reached = FinalState { state: self.model.physical_state(&self.state), counts };
        self.outcome = error.map_or(Ok(reached), Err);
    }
}

/// Whether z of one half is the opposite of the other's and all else is equal, for displacements and velocities.
pub(crate) fn is_mirrored(state: &[f64; 24]) -> bool {
    [0, 12].iter().all(|&at| {
        (0..6).all(|c| {
            let (left, right) = (state[at + c], state[at + 6 + c]);
            left == if c == 1 || c == 4 { -right } else { right }
        })
    })
}
