//! Shooting method for periodic motions: period map, monodromy matrix, Newton correction, Floquet multipliers.

use nalgebra::{Complex, DMatrix, DVector, Dyn, LU, SymmetricEigen};

use super::equations::PER_HALF;
use super::error::DynamicsError;
use super::integrate::{Integrator, Motion, StepCounts};
use super::modal::RIGID_BODY_EIGENVALUE;
use super::modal_train::MAX_RIGID_BODY_MODES;
use super::model::{DynamicModel, MotionState};
use super::recurrence::norm;
use super::segment::{Observer, Segment};
use super::variation::{ObserverPair, Perturbation, Variation};
use crate::numerics::eigen::eigenvalues;
use crate::watch::Watch;

/// Accuracy and limits of the integrations of a search.
#[derive(Clone, Copy)]
pub(crate) struct IntegrationLimits<'a> {
    /// Local error of a step relative to the size of the motion.
    pub tolerance: f64,
    pub max_steps: u64,
    pub watch: &'a Watch<'a>,
}

/// Shooting method for a model, with its rigid-body modes separated.
pub(crate) struct Shooting<'m, const D: usize> {
    model: &'m DynamicModel<D>,
    active: Vec<usize>,
    masses: [f64; D],
    /// Rigid-body modes, normalised to nᵀ M n = 1.
    rigid_body: Vec<[f64; D]>,
    limits: IntegrationLimits<'m>,
}

/// Newton corrections with one monodromy matrix.
pub(crate) struct Corrector<'s, 'm, const D: usize> {
    shooting: &'s Shooting<'m, D>,
    projector: Option<DMatrix<f64>>,
    /// I − monodromy, factored.
    system: LU<f64, Dyn, Dyn>,
    periods: u64,
}

impl<const D: usize> Corrector<'_, '_, D> {
    /// Correction of the start; `defect` is end − start. Rigid-body modes get the velocity that cancels their drift.
    /// None if the linear system is singular.
    pub(crate) fn correction(&self, defect: &Perturbation<D>) -> Option<Perturbation<D>> {
        let active = &self.shooting.active;
        let n = active.len();
        let r = DVector::from_fn(2 * n, |i, _| if i < n { defect.0[active[i]] } else { defect.1[active[i - n]] });
        let solution = match &self.projector {
            Some(projector) => projector * self.system.solve(&(projector * r))?,
            None => self.system.solve(&r)?,
        };
        let (mut x, mut v) = ([0.0; D], [0.0; D]);
        for (i, &c) in active.iter().enumerate() {
            x[c] = solution[i];
            v[c] = solution[i + n];
        }
        let closing = self.shooting.closing_velocity(defect, self.periods);
        (0..D).for_each(|c| v[c] += closing[c]);
        x.iter().chain(&v).all(|c| c.is_finite()).then_some((x, v))
    }
}

/// Motion over whole mesh periods, with its monodromy matrix.
pub(crate) struct PeriodMap<const D: usize> {
    pub end: MotionState<D>,
    /// Derivative of the end by the start, over (active displacements, active velocities).
    pub monodromy: DMatrix<f64>,
    /// Largest velocity in scaled time at the start of a step.
    pub size: f64,
    /// Whether a half has left its flank.
    pub separated: bool,
    pub counts: StepCounts,
}

/// Records the largest velocity and any loss of contact.
struct AmplitudeMonitor {
    size: f64,
    separated: bool,
    first: Option<[i8; 2]>,
}

impl<const D: usize> Observer<D> for AmplitudeMonitor {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        let sides = segment.contact.map(i8::signum);
        self.separated |= *self.first.get_or_insert(sides) != sides || sides[..DynamicModel::<D>::HALVES].contains(&0);
        self.size = self.size.max(norm(&segment.rows[1]));
    }
}

impl<'m, const D: usize> Shooting<'m, D> {
    pub(crate) fn new(
        model: &'m DynamicModel<D>,
        mean_stiffness_n_per_m: [f64; 2],
        limits: IntegrationLimits<'m>,
    ) -> Result<Self, DynamicsError> {
        let active: Vec<usize> = model.active().collect();
        let masses = model.masses_kg();
        let rigid_body = rigid_body_modes(model, &active, &masses, mean_stiffness_n_per_m)?;
        Ok(Self { model, active, masses, rigid_body, limits })
    }

    /// Velocity along the rigid-body modes, in addition to that of the start, with which a motion does not drift along
    /// them; `defect`: end less start after `periods` mesh periods.
    pub(crate) fn closing_velocity(&self, defect: &Perturbation<D>, periods: u64) -> [f64; D] {
        let time = periods as f64 * self.model.period_tau;
        let mut v = [0.0; D];
        for mode in &self.rigid_body {
            let speed = -self.along(mode, &defect.0) / time;
            (0..D).for_each(|c| v[c] += speed * mode[c]);
        }
        v
    }

    /// Integrates the motion of `motion_model` from `start` over `periods` mesh periods, with the unit perturbations of
    /// this model (that of antisymmetric perturbations, or the motion's own).
    ///
    /// # Errors
    /// [`DynamicsError`].
    pub(crate) fn period_map(
        &self,
        motion_model: &DynamicModel<D>,
        start: MotionState<D>,
        periods: u64,
    ) -> Result<PeriodMap<D>, DynamicsError> {
        let IntegrationLimits { tolerance, max_steps, watch } = self.limits;
        let mut variation = Variation::new(self.model, Variation::unit_perturbations(self.model), tolerance);
        let mut motion = Motion::new(motion_model, start, Integrator::Taylor, tolerance, max_steps);
        let mut amplitude = AmplitudeMonitor { size: 0.0, separated: false, first: None };
        for _ in 0..periods {
            motion.advance_period(&mut ObserverPair(&mut variation, &mut amplitude), watch, 0.0)?;
            watch.checkpoint(0.0)?;
        }
        let monodromy = variation.monodromy();
        if monodromy.iter().any(|c| !c.is_finite()) {
            return Err(DynamicsError::Diverged { time_s: motion.time_s() });
        }
        let AmplitudeMonitor { size, separated, .. } = amplitude;
        Ok(PeriodMap { end: motion.state, monodromy, size, separated, counts: motion.counts })
    }

    /// The motion over a mesh period from `start`, and its monodromy matrix with the reference mesh stiffnesses in
    /// place of those along the motion. None for anything but a train, or if its complex modes are nearly dependent.
    ///
    /// # Errors
    /// [`DynamicsError`].
    pub(crate) fn approximate_period_map(&self, start: MotionState<D>) -> Result<Option<PeriodMap<D>>, DynamicsError> {
        let Some(modes) = self.model.train_modes() else { return Ok(None) };
        let IntegrationLimits { tolerance, max_steps, watch } = self.limits;
        let mut motion = Motion::new(self.model, start, Integrator::Taylor, tolerance, max_steps);
        let mut amplitude = AmplitudeMonitor { size: 0.0, separated: false, first: None };
        motion.advance_period(&mut amplitude, watch, 0.0)?;
        let monodromy = modes.free_motion(self.model.period_tau);
        let AmplitudeMonitor { size, separated, .. } = amplitude;
        Ok(Some(PeriodMap { end: motion.state, monodromy, size, separated, counts: motion.counts }))
    }

    /// Component along a rigid-body mode: nᵀ M q.
    fn along(&self, n: &[f64; D], q: &[f64; D]) -> f64 {
        (0..D).map(|c| n[c] * self.masses[c] * q[c]).sum()
    }

    /// Projector onto the complement of the rigid-body modes, over (active displacements, active velocities).
    /// None where no active coordinate moves in them.
    fn rigid_body_projector(&self) -> Option<DMatrix<f64>> {
        if DynamicModel::<D>::IS_TRAIN {
            return None;
        }
        let n = self.active.len();
        let mut q = DMatrix::identity(2 * n, 2 * n);
        for mode in &self.rigid_body {
            for (r, &cr) in self.active.iter().enumerate() {
                for (c, &cc) in self.active.iter().enumerate() {
                    let part = mode[cr] * mode[cc] * self.masses[cc];
                    q[(r, c)] -= part;
                    q[(r + n, c + n)] -= part;
                }
            }
        }
        Some(q)
    }

    /// Newton corrections of the start for a motion that is to repeat after `periods` mesh periods, with this monodromy
    /// matrix.
    pub(crate) fn corrector<'s>(&'s self, monodromy: &DMatrix<f64>, periods: u64) -> Corrector<'s, 'm, D> {
        let size = 2 * self.active.len();
        let projector = self.rigid_body_projector();
        let system = match &projector {
            Some(projector) => DMatrix::identity(size, size) - projector * monodromy * projector,
            None => DMatrix::identity(size, size) - monodromy,
        };
        Corrector { shooting: self, projector, system: system.lu(), periods }
    }

    /// Largest mean force along a rigid-body mode over `periods`, N.
    pub(crate) fn unbalanced_force_n(&self, defect: &Perturbation<D>, periods: u64) -> f64 {
        let omega = self.model.omega_ref;
        let time = periods as f64 * self.model.period_tau;
        self.rigid_body.iter().fold(0.0f64, |worst, mode| {
            let largest = mode.iter().fold(0.0f64, |m, c| m.max(c.abs()));
            worst.max((self.along(mode, &defect.1) * omega * omega / time / largest).abs())
        })
    }

    /// Floquet multipliers, rigid-body modes excluded, largest first.
    pub(crate) fn multipliers(&self, monodromy: &DMatrix<f64>) -> Vec<Complex<f64>> {
        let (found, removed) = match self.rigid_body_projector() {
            Some(projector) => (eigenvalues(&projector * monodromy * &projector), self.rigid_body.len()),
            None => (eigenvalues(monodromy.clone()), 0),
        };
        let Some(mut all) = found else { return Vec::new() };
        all.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        // The eigenvalues of the removed modes are the zeros at the end.
        all.truncate((all.len() - 2 * removed).max(1));
        all
    }
}

/// Rigid-body modes: eigenvectors of M^-½ K M^-½ with eigenvalue zero, in solver coordinates. Those of a train are
/// coordinates that are not among the `active`.
pub(super) fn rigid_body_modes<const D: usize>(
    model: &DynamicModel<D>,
    active: &[usize],
    masses: &[f64; D],
    mean_stiffness_n_per_m: [f64; 2],
) -> Result<Vec<[f64; D]>, DynamicsError> {
    if let Some(train) = &model.train {
        let unit = |i: usize| {
            let mut mode = [0.0; D];
            mode[D - MAX_RIGID_BODY_MODES + i] = 1.0;
            mode
        };
        return Ok((0..train.rigid).map(unit).collect());
    }
    let n = active.len();
    let mut k = DMatrix::zeros(n, n);
    for (column, &c) in active.iter().enumerate() {
        let mut unit = [0.0; D];
        unit[c] = 1.0;
        let mut a = model.acceleration_of_springs(&unit);
        for j in 0..DynamicModel::<D>::HALVES {
            let acceleration = model.acceleration_of_mesh_force(j, mean_stiffness_n_per_m[j] * model.s(j, &unit));
            for i in j * PER_HALF..(j + 1) * PER_HALF {
                a[i] += acceleration[i];
            }
        }
        for (row, &r) in active.iter().enumerate() {
            k[(row, column)] = -a[r] * (masses[r] / masses[c]).sqrt();
        }
    }
    let symmetric = (&k + k.transpose()) * 0.5;
    let scale = symmetric.amax();
    let eigen = SymmetricEigen::try_new(symmetric, f64::EPSILON, 10_000).ok_or(DynamicsError::InvalidParameter {
        name: "stiffness matrix",
        value: scale,
        reason: "its eigenvalues cannot be computed",
    })?;
    let largest = eigen.eigenvalues.amax();
    Ok((0..n)
        .filter(|&i| eigen.eigenvalues[i] <= RIGID_BODY_EIGENVALUE * largest)
        .map(|i| {
            let mut mode = [0.0; D];
            for (row, &r) in active.iter().enumerate() {
                mode[r] = eigen.eigenvectors[(row, i)] / masses[r].sqrt();
            }
            mode
        })
        .collect())
}
