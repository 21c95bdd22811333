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

/// Positions of one period and how well they carry its curves.
pub(super) struct RefinedPositions {
    /// Phases ascending in [0, 1) and their states.
    pub states: Vec<(f64, LoadedPosition)>,
    /// Largest change of a Fourier coefficient (mean and first harmonics of stiffness and transmission error, as parts
    /// of their means) by the positions that confirmed the others.
    pub error: f64,
}

/// Solves positions until stiffness and transmission error halfway between neighbours agree with the interpolation of
/// the others to `accuracy` of their means. `solve` gets a phase and the state nearest to it.
pub(super) fn refine(
    pair: &Pair,
    accuracy: f64,
    mut solve: impl FnMut(f64, Option<&LoadedPosition>) -> Result<LoadedPosition, ContactError>,
) -> Result<RefinedPositions, ContactError> {
    let mut states: Vec<(f64, LoadedPosition)> = Vec::with_capacity(64);
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

/// Stiffness and transmission error over the period.
struct PositionCurves {
    stiffness: PeriodicMonotoneCubic,
    error: PeriodicMonotoneCubic,
    mean: [f64; 2],
}

/// Samples for the comparison of Fourier coefficients.
const SAMPLES: usize = 128;

impl PositionCurves {
    fn new<'s>(states: impl Iterator<Item = &'s (f64, LoadedPosition)> + Clone) -> PositionCurves {
        let phase: Vec<f64> = states.clone().map(|s| s.0).collect();
        let n = phase.len() as f64;
        let of = |f: fn(&LoadedPosition) -> f64| states.clone().map(|s| f(&s.1)).collect::<Vec<_>>();
        let (k, e) = (of(|s| s.stiffness_n_per_m), of(|s| s.approach_m));
        let mean = [k.iter().sum::<f64>() / n, e.iter().map(|v| v.abs()).sum::<f64>() / n];
        PositionCurves {
            stiffness: PeriodicMonotoneCubic::new(phase.clone(), k),
            error: PeriodicMonotoneCubic::new(phase, e),
            mean,
        }
    }

    /// Distance of a state from the interpolation, as a part of the means.
    fn error(&self, phase: f64, state: &LoadedPosition) -> f64 {
        let stiffness = (self.stiffness.at(phase) - state.stiffness_n_per_m).abs() / self.mean[0];
        let error = (self.error.at(phase) - state.approach_m).abs() / self.mean[1];
        stiffness.max(error)
    }

    /// Largest change of mean or harmonics against `other`, as a part of the mean.
    fn coefficient_change(&self, other: &PositionCurves) -> f64 {
        let change = |a: &PeriodicMonotoneCubic, b: &PeriodicMonotoneCubic, mean: f64| {
            let (a, b) = (a.samples(0.0, SAMPLES), b.samples(0.0, SAMPLES));
            let difference: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
            let offset = difference.iter().sum::<f64>() / SAMPLES as f64;
            harmonics(&difference).into_iter().fold(offset.abs(), f64::max) / mean
        };
        let stiffness = change(&self.stiffness, &other.stiffness, self.mean[0]);
        stiffness.max(change(&self.error, &other.error, self.mean[1]))
    }
}
