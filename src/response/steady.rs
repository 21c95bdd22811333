//! Finds the motion to report: periodic without loss of contact, periodic with it, or a record of one that does not repeat.

use nalgebra::{Complex, DMatrix};

use super::regime::{CHAOS_PER_MESH_PERIOD, Section, largest, lyapunov};
use crate::dynamics::{
    Deviation, DynamicsError, Integrator, Limits, Model, Motion, Numerics, PER_HALF, Shooting, State, Unobserved,
    difference,
};

/// Mesh periods after which a motion that has not come near to repeating is taken not to repeat.
const PATIENCE_MESH_PERIODS: u64 = 1500;
/// Relative change over its period from which Newton's method is tried.
const NEAR_REPEAT: f64 = 1e-3;
/// Mesh periods between two tries.
const BETWEEN_TRIES: u64 = 40;
/// Mesh periods over which a Lyapunov exponent is averaged.
const LYAPUNOV_MESH_PERIODS: u64 = 400;
/// Length of the record of a motion that does not repeat.
const LONG_RECORD_MESH_PERIODS: u64 = 2000;

/// A motion ready to be recorded.
pub(super) struct Found<const D: usize> {
    pub start: State<D>,
    /// Mesh periods to record.
    pub record: u64,
    /// The period in mesh periods and the linear map over it; None when the motion does not repeat.
    pub orbit: Option<(u64, DMatrix<f64>)>,
    /// Largest modulus of the Floquet multipliers, per mesh period.
    pub floquet: Option<f64>,
    /// All of them over the orbit, those against the mirror symmetry included, largest first.
    pub multipliers: Vec<Complex<f64>>,
    /// Largest Lyapunov exponent per mesh period.
    pub lyapunov: Option<f64>,
    /// The halves do not keep their mirror symmetry: deviations against it grow.
    pub leaves_symmetry: bool,
    pub tolerance: f64,
    pub numerics: Numerics,
}

/// What the search needs to know.
pub(super) struct Search<'a, const D: usize> {
    pub model: &'a Model<D>,
    pub mean_stiffness_n_per_m: [f64; 2],
    pub limits: Limits<'a>,
    /// A motion that does not repeat is an error.
    pub must_repeat: bool,
}

impl<const D: usize> Search<'_, D> {
    /// The steady state reached from `start`, or the periodic one without loss of contact when it exists and is stable.
    pub fn run(&self, start: State<D>) -> Result<Found<D>, DynamicsError> {
        let shooting = Shooting::new(self.model, self.mean_stiffness_n_per_m, self.limits)?;
        let mut numerics = Numerics::default();
        if let Some(found) = self.without_separation(&shooting, start, &mut numerics)? {
            return Ok(found);
        }
        self.with_separation(&shooting, start, numerics)
    }

    fn motion(&self, start: State<D>) -> Motion<'_, D> {
        Motion::new(self.model, start, Integrator::Taylor, self.limits.tolerance, self.limits.max_steps)
    }

    /// With contact held the equations are linear: one period from any start gives the periodic solution.
    fn without_separation(
        &self,
        shooting: &Shooting<'_, D>,
        start: State<D>,
        numerics: &mut Numerics,
    ) -> Result<Option<Found<D>>, DynamicsError> {
        let held = self.model.holding_contact();
        let mut first = start;
        for j in 0..Model::<D>::HALVES {
            first.contact[j] = if self.model.halves[j].load < 0.0 { -1 } else { 1 };
        }
        let once = shooting.map(&held, first, 1)?;
        *numerics += once.numerics;
        let defect = difference(&once.end, &first);
        let unbalanced_n = shooting.unbalanced_n(&defect, 1);
        let load = (0..Model::<D>::HALVES).fold(0.0f64, |m, j| m.max(self.model.largest_push_n(j)));
        // Rounding and truncation leave a little; a real imbalance is far above.
        if unbalanced_n > 1e-6 * load {
            return Err(DynamicsError::Unbalanced { force_n: unbalanced_n });
        }
        let within = shooting.multipliers(&once.map);
        let modulus = within.first().map(|m| m.norm());
        if !modulus.is_some_and(|m| m < 1.0) {
            return Ok(None);
        }
        let Some(correction) = shooting.correction(&defect, &once.map, 1) else { return Ok(None) };
        let orbit_start = moved(self.model, first, &correction);
        if orbit_start.contact != first.contact {
            return Ok(None);
        }
        let mut motion = self.motion(orbit_start);
        motion.advance_period(&mut Unobserved, self.limits.watch, 0.0)?;
        *numerics += motion.numerics;
        if motion.contact_changed {
            return Ok(None);
        }
        let (against, multipliers) = self.with_those_against_symmetry(within, orbit_start, 1)?;
        Ok(Some(Found {
            multipliers,
            start: orbit_start,
            record: 1,
            orbit: Some((1, once.map)),
            floquet: modulus.map(|m| m.max(against)),
            lyapunov: None,
            leaves_symmetry: against > 1.0,
            tolerance: self.limits.tolerance,
            numerics: *numerics,
        }))
    }

    fn with_separation(
        &self,
        shooting: &Shooting<'_, D>,
        start: State<D>,
        mut numerics: Numerics,
    ) -> Result<Found<D>, DynamicsError> {
        let mut motion = self.motion(start);
        let mut section = Section::new();
        section.push(motion.state);
        let mut next_try = 8;
        for period in 1..=PATIENCE_MESH_PERIODS {
            let fraction = 0.9 * period as f64 / PATIENCE_MESH_PERIODS as f64;
            motion.advance_period(&mut Unobserved, self.limits.watch, fraction)?;
            self.limits.watch.checkpoint(fraction)?;
            section.push(motion.state);
            if period < next_try {
                continue;
            }
            if let Some((n, _)) = section.repeats(NEAR_REPEAT) {
                next_try = period + BETWEEN_TRIES;
                if let Some(mut found) = self.newton(shooting, motion.state, n as u64, section.size())? {
                    numerics += motion.numerics;
                    found.numerics += numerics;
                    return Ok(found);
                }
            }
        }
        numerics += motion.numerics;
        motion.numerics = Numerics::default();
        if self.must_repeat {
            let change = section.change(1).unwrap_or(f64::INFINITY);
            return Err(DynamicsError::NotPeriodic { mesh_periods: PATIENCE_MESH_PERIODS, change });
        }
        let mut across = self.motion(motion.state);
        let exponent = lyapunov(&mut across, self.model, LYAPUNOV_MESH_PERIODS, self.limits.watch)?;
        numerics += across.numerics;
        let leaves_symmetry = if D == PER_HALF {
            let mut against = self.motion(motion.state);
            let opposite = self.model.against_symmetry();
            let exponent = lyapunov(&mut against, &opposite, LYAPUNOV_MESH_PERIODS, self.limits.watch)?;
            numerics += against.numerics;
            exponent > CHAOS_PER_MESH_PERIOD
        } else {
            false
        };
        Ok(Found {
            start: motion.state,
            record: LONG_RECORD_MESH_PERIODS,
            orbit: None,
            floquet: None,
            multipliers: Vec::new(),
            lyapunov: Some(exponent),
            leaves_symmetry,
            tolerance: self.limits.tolerance,
            numerics,
        })
    }

    /// Newton's method on the map over `n` mesh periods; None when it does not lead to a stable motion close by.
    fn newton(
        &self,
        shooting: &Shooting<'_, D>,
        near: State<D>,
        n: u64,
        size: f64,
    ) -> Result<Option<Found<D>>, DynamicsError> {
        let mut start = State { period: 0, ..near };
        let mut numerics = Numerics::default();
        let mut last = f64::INFINITY;
        for _ in 0..10 {
            let round = shooting.map(self.model, start, n)?;
            numerics += round.numerics;
            let defect = difference(&round.end, &start);
            let change = largest(&defect) / size;
            if change < 10.0 * self.limits.tolerance || (change < 1e-9 && change >= 0.3 * last) {
                let within = shooting.multipliers(&round.map);
                let modulus = within.first().map(|m| m.norm());
                if !modulus.is_some_and(|m| m < 1.0) {
                    return Ok(None);
                }
                let (against, multipliers) = self.with_those_against_symmetry(within, start, n)?;
                return Ok(Some(Found {
                    multipliers,
                    start,
                    record: n,
                    orbit: Some((n, round.map)),
                    floquet: modulus.map(|m| m.max(against).powf(1.0 / n as f64)),
                    lyapunov: None,
                    leaves_symmetry: against > 1.0,
                    tolerance: self.limits.tolerance,
                    numerics,
                }));
            }
            last = change;
            let Some(correction) = shooting.correction(&defect, &round.map, n) else { return Ok(None) };
            if largest(&correction) > 0.1 * size {
                return Ok(None);
            }
            start = moved(self.model, start, &correction);
        }
        Ok(None)
    }

    /// Largest modulus of the Floquet multipliers of deviations against the mirror symmetry over `n` periods (0 with twelve
    /// coordinates, whose own map has them all), and these among the multipliers `within` the symmetry.
    fn with_those_against_symmetry(
        &self,
        mut within: Vec<Complex<f64>>,
        start: State<D>,
        n: u64,
    ) -> Result<(f64, Vec<Complex<f64>>), DynamicsError> {
        if D != PER_HALF {
            return Ok((0.0, within));
        }
        let opposite = self.model.against_symmetry();
        let shooting = Shooting::new(&opposite, self.mean_stiffness_n_per_m, self.limits)?;
        let round = shooting.map(self.model, start, n)?;
        let against = shooting.multipliers(&round.map);
        let largest = against.first().map_or(f64::INFINITY, |m| m.norm());
        within.extend(against);
        within.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Ok((largest, within))
    }
}

/// A state with a deviation added, its contact found anew.
pub(super) fn moved<const D: usize>(model: &Model<D>, mut state: State<D>, by: &Deviation<D>) -> State<D> {
    for c in 0..D {
        state.x[c] += by.0[c];
        state.v[c] += by.1[c];
    }
    for j in 0..Model::<D>::HALVES {
        state.contact[j] = model.contact_of(model.s(j, &state.x));
    }
    state
}
