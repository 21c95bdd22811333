//! Choice of the positions over the mesh period: coarse everywhere, fine where pairs enter and leave.

use super::cycle::harmonics;
use super::error::ContactError;
use super::position::LoadedPosition;
use crate::gear::Pair;
use crate::numerics::PeriodicMonotoneCubic;

/// Equally spaced positions to begin with.
const COARSE: usize = 16;
/// Most positions of one period.
const MOST: usize = 256;
/// Positions that are reached at most: a round that begins below [`MOST`] is finished, and doubles what there is.
pub(super) const MOST_STATES: usize = (COARSE + 3) * 16;
/// Smallest interval.
const FINEST: f64 = 1.0 / 1024.0;

/// Solved state of a position.
pub(super) trait PositionState {
    /// Stiffness and transmission error of every half that the state is of.
    fn stiffness_and_error(&self) -> impl Iterator<Item = [f64; 2]>;
}

impl PositionState for LoadedPosition {
    fn stiffness_and_error(&self) -> impl Iterator<Item = [f64; 2]> {
        std::iter::once([self.stiffness_n_per_m, self.approach_m])
    }
}

/// Positions of one period and how well they carry its curves.
pub(super) struct RefinedPositions<S = LoadedPosition> {
    /// Phases ascending in [0, 1) and their states.
    pub states: Vec<(f64, S)>,
    /// Largest change of a Fourier coefficient (mean and first harmonics of stiffness and transmission error, as parts
    /// of their means) by the positions that confirmed the others.
    pub error: f64,
}

/// Solves positions until stiffness and transmission error halfway between neighbours agree with the interpolation of
/// the others to `accuracy` of their means. `solve` gets a phase and the state nearest to it.
pub(super) fn refine<S: PositionState>(
    pair: &Pair,
    accuracy: f64,
    mut solve: impl FnMut(f64, Option<&S>) -> Result<S, ContactError>,
) -> Result<RefinedPositions<S>, ContactError> {
    let mut states: Vec<(f64, S)> = Vec::with_capacity(64);
    for phase in start_phases(pair, COARSE, 8.0 * FINEST) {
        let state = solve(phase, states.last().map(|s| &s.1))?;
        states.push((phase, state));
    }
    let mut pending: Vec<(f64, f64)> =
        (0..states.len()).map(|i| (states[i].0, states.get(i + 1).map_or(states[0].0 + 1.0, |next| next.0))).collect();
    // Phases whose states only confirmed the interpolation of the others.
    let mut confirming = Vec::new();
    while !pending.is_empty() && states.len() < MOST {
        let curves = PositionCurves::new(states.iter());
        let mut next = Vec::new();
        let mut fresh = Vec::with_capacity(pending.len());
        for &(from, to) in &pending {
            let middle = 0.5 * (from + to);
            let phase = middle.rem_euclid(1.0);
            let near = states.partition_point(|s| s.0 <= phase).max(1) - 1;
            let state = solve(phase, Some(&states[near].1))?;
            if curves.error(phase, &state) > accuracy && 0.5 * (to - from) > FINEST {
                next.extend([(from, middle), (middle, to)]);
            } else {
                confirming.push(phase);
            }
            fresh.push((phase, state));
        }
        states.append(&mut fresh);
        states.sort_by(|a, b| a.0.total_cmp(&b.0));
        pending = next;
    }
    let without = states.iter().filter(|s| !confirming.contains(&s.0));
    let error = PositionCurves::new(states.iter()).coefficient_change(&PositionCurves::new(without));
    Ok(RefinedPositions { states, error })
}

/// `count` equally spaced phases, and those at which a line of contact begins, ends, or reaches another edge of the
/// field where they are further than `least` from the others.
pub(super) fn start_phases(pair: &Pair, count: usize, least: f64) -> Vec<f64> {
    let mut phases: Vec<f64> = (0..count).map(|i| i as f64 / count as f64).collect();
    for ratio in [pair.transverse_contact_ratio, pair.overlap_ratio, pair.total_contact_ratio()] {
        let phase = ratio.rem_euclid(1.0);
        let apart = |p: &f64| (p - phase).abs().min(1.0 - (p - phase).abs());
        if phases.iter().map(apart).fold(1.0, f64::min) > least {
            phases.push(phase);
        }
    }
    phases.sort_by(f64::total_cmp);
    phases
}

/// Stiffness and transmission error of every half over the period, with their means.
struct PositionCurves {
    halves: Vec<[(PeriodicMonotoneCubic, f64); 2]>,
}

/// Samples for the comparison of Fourier coefficients.
const SAMPLES: usize = 128;

impl PositionCurves {
    fn new<'s, S: PositionState + 's>(states: impl Iterator<Item = &'s (f64, S)> + Clone) -> PositionCurves {
        let phase: Vec<f64> = states.clone().map(|s| s.0).collect();
        let n = phase.len() as f64;
        let halves = states.clone().next().map_or(0, |s| s.1.stiffness_and_error().count());
        let curve = |half: usize, value: usize| {
            let of = |s: &'s (f64, S)| s.1.stiffness_and_error().nth(half).map_or(f64::NAN, |v| v[value]);
            let values: Vec<f64> = states.clone().map(of).collect();
            let mean = values.iter().map(|v| v.abs()).sum::<f64>() / n;
            (PeriodicMonotoneCubic::new(phase.clone(), values), mean)
        };
        PositionCurves { halves: (0..halves).map(|half| [curve(half, 0), curve(half, 1)]).collect() }
    }

    /// Distance of a state from the interpolation, as a part of the means.
    fn error(&self, phase: f64, state: &impl PositionState) -> f64 {
        let mut worst = 0.0f64;
        for (curves, values) in self.halves.iter().zip(state.stiffness_and_error()) {
            for ((curve, mean), value) in curves.iter().zip(values) {
                worst = worst.max((curve.at(phase) - value).abs() / mean);
            }
        }
        worst
    }

    /// Largest change of mean or harmonics against `other`, as a part of the mean.
    fn coefficient_change(&self, other: &PositionCurves) -> f64 {
        let change = |a: &PeriodicMonotoneCubic, b: &PeriodicMonotoneCubic, mean: f64| {
            let (a, b) = (a.samples(0.0, SAMPLES), b.samples(0.0, SAMPLES));
            let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
            let offset = difference.iter().sum::<f64>() / SAMPLES as f64;
            harmonics(&difference).into_iter().fold(offset.abs(), f64::max) / mean
        };
        let both = self.halves.iter().flatten().zip(other.halves.iter().flatten());
        both.map(|((a, mean), (b, _))| change(a, b, *mean)).fold(0.0, f64::max)
    }
}
