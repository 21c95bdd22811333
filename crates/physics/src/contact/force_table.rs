//! The force of one half's loaded contact as a function of approach and phase.
//!
//! F_bt(δ, φ) along the transverse base tangent: zero up to the free approach δ₀(φ), at which the first point of any
//! tooth pair touches, then rising with every line of contact, every slice and every tip corner that comes in.
//! Tabulated over η = δ − δ₀(φ) at levels common to all phases; between levels cubics with the tangent stiffness of the
//! contact analysis as slopes (Fritsch and Carlson's limits keep them monotone), between phases periodic splines.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::error::ContactError;
use super::half::HalfContact;
use super::position::ForceCurve;
use super::refine::start_phases;
use super::shafts::DisplacementField;
use crate::compliance::{Compliance, Settings};
use crate::gear::{Half, Pair};
use crate::numerics::PeriodicSpline;
use crate::watch::Watch;

/// F_bt(δ, φ) of one half: values at knots of phase and levels of approach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForceTable {
    /// Phases of the knots, ascending in [0, 1).
    pub phase: Vec<f64>,
    /// Approach above the free one, ascending from 0. Beyond the last the force goes on with its stiffness there.
    pub level_m: Vec<f64>,
    /// δ₀ at every knot.
    pub free_m: Vec<f64>,
    /// F_bt, level by level over the knots; 0 on the first level.
    pub force_n: Vec<Vec<f64>>,
    /// dF_bt/dδ, level by level over the knots.
    pub stiffness_n_per_m: Vec<Vec<f64>>,
    /// The load for which the table was made.
    pub working_force_n: f64,
    /// Largest difference between the table and contact analyses between its knots and levels, as a part of the mean
    /// force of the level, at least of a fifth of the working load.
    pub error: f64,
}

/// Levels to begin with, as parts of the mean approach under the working load.
const LEVELS: [f64; 8] = [0.1, 0.3, 0.6, 1.0, 1.5, 2.4, 3.8, 6.0];
/// Most levels, the one of no load apart.
const MOST_LEVELS: usize = 20;
/// Phases at which levels are tried.
const TRIAL_PHASES: usize = 5;
/// Equally spaced phases to begin with, and the most.
const COARSE: usize = 24;
const MOST_KNOTS: usize = 192;
/// Smallest interval between knots.
const FINEST: f64 = 1.0 / 1024.0;
/// Agreement between knots and levels, as a part of the accuracy required of the curves.
const AGREEMENT: f64 = 0.2;
/// The same where the bodies are held in a displaced shape, which is itself that of the working load alone.
const DISPLACED_AGREEMENT: f64 = 1.0;
/// Forces below this part of the working load need not be relatively accurate.
const SMALL_FORCE: f64 = 0.2;

/// Solves the contact of one half where F(δ, φ) needs it.
struct Sampler<'a> {
    field: Option<&'a DisplacementField>,
    pair: &'a Pair,
    half: Half,
    compliance: &'a Compliance,
    settings: &'a Settings,
    force_bt_n: f64,
    watch: Watch<'a>,
}

impl Sampler<'_> {
    fn contact(&self) -> HalfContact<'_> {
        match self.field {
            None => HalfContact::new(self.pair, self.half, self.compliance, self.settings, self.watch),
            Some(field) => {
                HalfContact::displaced(self.pair, self.half, self.compliance, self.settings, field, self.watch)
            }
        }
    }

    /// The curves at all phases, on the threads of the pool.
    fn curves(&self, phases: &[f64], approaches_m: &[f64]) -> Result<Vec<ForceCurve>, ContactError> {
        phases
            .par_iter()
            .map_init(
                || self.contact(),
                |contact, &phase| {
                    self.watch.checkpoint_quietly()?;
                    contact.force_curve(phase, self.force_bt_n, approaches_m)
                },
            )
            .collect()
    }

    /// Approach above the free one under the working load, mean over a few phases.
    fn working_approach_m(&self) -> Result<f64, ContactError> {
        let mut sum = 0.0;
        for i in 0..TRIAL_PHASES {
            let mut contact = self.contact();
            let phase = i as f64 / TRIAL_PHASES as f64;
            let loaded = contact.at(phase, self.force_bt_n)?;
            let free = loaded.points.iter().map(|p| p.gap_m - 0.5 * p.gap_spread_m).fold(f64::INFINITY, f64::min);
            sum += loaded.approach_m - free;
        }
        Ok(sum / TRIAL_PHASES as f64)
    }
}

/// Error scale of a level: its force, at least a small part of the working load.
fn scale(force: f64, working: f64) -> f64 {
    force.max(SMALL_FORCE * working)
}

/// Value at the middle between two levels.
fn middle(low: (f64, f64), high: (f64, f64), step: f64) -> f64 {
    0.5 * (low.0 + high.0) + 0.125 * step * (low.1 - high.1)
}

impl ForceTable {
    /// Tabulates the contact of `half` about the load `force_bt_n` > 0, from no load to several times that.
    pub fn new(
        pair: &Pair,
        half: Half,
        force_bt_n: f64,
        compliance: &Compliance,
        settings: &Settings,
        watch: Watch<'_>,
    ) -> Result<ForceTable, ContactError> {
        Self::displaced(pair, half, None, force_bt_n, (compliance, settings), watch)
    }

    /// The same with the bodies displaced by `field` and held there.
    pub fn displaced(
        pair: &Pair,
        half: Half,
        field: Option<&DisplacementField>,
        force_bt_n: f64,
        (compliance, settings): (&Compliance, &Settings),
        watch: Watch<'_>,
    ) -> Result<ForceTable, ContactError> {
        let sampler = Sampler { field, pair, half, compliance, settings, force_bt_n, watch };
        let agreement = if field.is_some() { DISPLACED_AGREEMENT } else { AGREEMENT };
        let tolerance = agreement * settings.accuracy;
        let level_m = levels(&sampler, tolerance)?;
        // The first step is halved once more: its middle says how the contact begins.
        let mut solved_m = level_m.clone();
        solved_m[0] = 0.5 * level_m[1];
        let mut knots: Vec<(f64, ForceCurve)> = Vec::new();
        let mut fresh = start_phases(pair, COARSE, 4.0 * FINEST);
        let mut intervals: Vec<(f64, f64)> = Vec::new();
        let mut error: f64 = 0.0;
        loop {
            let curves = sampler.curves(&fresh, &solved_m)?;
            if intervals.is_empty() {
                knots = fresh.into_iter().zip(curves).collect();
                let next = |i: usize| knots.get(i + 1).map_or(knots[0].0 + 1.0, |k| k.0);
                intervals = (0..knots.len()).map(|i| (knots[i].0, next(i))).collect();
            } else {
                let table = ForceTable::of(&knots, &level_m, force_bt_n, 0.0);
                let splines = Splines::new(&table);
                let mut split: Vec<(f64, f64, f64)> = Vec::new();
                for ((&(from, to), phase), curve) in intervals.iter().zip(fresh).zip(curves) {
                    let distance = splines.distance(&knots, phase, &curve);
                    let narrow = 0.5 * (to - from) <= FINEST;
                    if distance > tolerance && !narrow {
                        split.push((distance, from, 0.5 * (from + to)));
                        split.push((distance, 0.5 * (from + to), to));
                    } else {
                        error = error.max(distance);
                    }
                    knots.push((phase, curve));
                }
                knots.sort_by(|a, b| a.0.total_cmp(&b.0));
                // The worst first, up to the limit; the largest error of the others is reported.
                split.sort_by(|a, b| b.0.total_cmp(&a.0));
                let room = MOST_KNOTS.saturating_sub(knots.len());
                if let Some((distance, ..)) = split.get(room) {
                    error = error.max(*distance);
                }
                split.truncate(room);
                intervals = split.into_iter().map(|(_, from, to)| (from, to)).collect();
            }
            if intervals.is_empty() {
                break;
            }
            fresh = intervals.iter().map(|(from, to)| (0.5 * (from + to)).rem_euclid(1.0)).collect();
        }
        Ok(ForceTable::of(&knots, &level_m, force_bt_n, error))
    }

    /// The table of solved curves; the first sample of each is halfway up the first level.
    fn of(knots: &[(f64, ForceCurve)], level_m: &[f64], working_force_n: f64, error: f64) -> ForceTable {
        let levels = level_m.len();
        let column = |of: &dyn Fn(&ForceCurve) -> f64| knots.iter().map(|(_, curve)| of(curve)).collect::<Vec<f64>>();
        let mut force_n: Vec<Vec<f64>> = (0..levels).map(|i| column(&|c| c.samples[i].0)).collect();
        let mut stiffness_n_per_m: Vec<Vec<f64>> = (0..levels).map(|i| column(&|c| c.samples[i].1)).collect();
        // The first cubic goes through no force at no approach and the force halfway up the level, with the slope at
        // its end.
        let first_m = level_m[1];
        for (j, (_, curve)) in knots.iter().enumerate() {
            let (half_n, (end_n, end_slope)) = (curve.samples[0].0, curve.samples[1]);
            force_n[0][j] = 0.0;
            stiffness_n_per_m[0][j] =
                (end_slope + 8.0 * (half_n - 0.5 * end_n) / first_m).clamp(0.0, 3.0 * end_n / first_m);
        }
        for j in 0..knots.len() {
            for i in 1..levels {
                // Fritsch and Carlson (SIAM J. Numer. Anal. 17 (1980) 238): monotone where both slopes are at most
                // three times the rise.
                let rise = (force_n[i][j] - force_n[i - 1][j]) / (level_m[i] - level_m[i - 1]);
                for row in [i - 1, i] {
                    let slope = &mut stiffness_n_per_m[row][j];
                    *slope = slope.clamp(0.0, (3.0 * rise).max(0.0));
                }
            }
        }
        ForceTable {
            phase: knots.iter().map(|(phase, _)| *phase).collect(),
            level_m: level_m.to_vec(),
            free_m: column(&|c| c.free_m),
            force_n,
            stiffness_n_per_m,
            working_force_n,
            error,
        }
    }
}

/// The splines of a table over the phase, with their slopes.
struct Splines<'a> {
    table: &'a ForceTable,
    knots: PeriodicSpline,
    force_slopes: Vec<Vec<f64>>,
    free_slopes: Vec<f64>,
}

impl<'a> Splines<'a> {
    fn new(table: &'a ForceTable) -> Splines<'a> {
        let knots = PeriodicSpline::new(table.phase.clone());
        let force_slopes = table.force_n.iter().map(|force| knots.slopes(force)).collect();
        let free_slopes = knots.slopes(&table.free_m);
        Splines { table, knots, force_slopes, free_slopes }
    }

    /// Largest difference of the splines from a solved curve.
    fn distance(&self, knots: &[(f64, ForceCurve)], phase: f64, curve: &ForceCurve) -> f64 {
        let table = self.table;
        let mut worst = 0.0f64;
        let mean = |i: usize| knots.iter().map(|(_, c)| c.samples[i].0).sum::<f64>() / knots.len() as f64;
        for i in 1..table.level_m.len() {
            let force = self.knots.value(&table.force_n[i], &self.force_slopes[i], phase);
            let difference = force - curve.samples[i].0;
            worst = worst.max(difference.abs() / scale(mean(i), table.working_force_n));
        }
        // A free position that is off moves the force by no more than the stiffness of the highest level says.
        let top = table.stiffness_n_per_m.len() - 1;
        let stiffness = table.stiffness_n_per_m[top].iter().fold(0.0f64, |m, k| m.max(*k));
        let free_m = self.knots.value(&table.free_m, &self.free_slopes, phase);
        worst.max((free_m - curve.free_m).abs() * stiffness / table.working_force_n)
    }
}

/// Levels of approach from 0 on, between which cubics agree with the contact at a few phases.
fn levels(sampler: &Sampler<'_>, tolerance: f64) -> Result<Vec<f64>, ContactError> {
    let working_m = sampler.working_approach_m()?;
    let phases: Vec<f64> = (0..TRIAL_PHASES).map(|i| (i as f64 + 0.37) / TRIAL_PHASES as f64).collect();
    let mut level_m: Vec<f64> = std::iter::once(0.0).chain(LEVELS.map(|l| l * working_m)).collect();
    let mut open: Vec<usize> = (1..level_m.len() - 1).collect();
    while !open.is_empty() && level_m.len() <= MOST_LEVELS {
        // Middles of the open steps are solved along with the levels around them.
        let mut solved_m: Vec<f64> = level_m[1..].to_vec();
        solved_m.extend(open.iter().map(|&i| 0.5 * (level_m[i] + level_m[i + 1])));
        solved_m.sort_by(f64::total_cmp);
        let curves = sampler.curves(&phases, &solved_m)?;
        let at = |curve: &ForceCurve, approach: f64| {
            curve.samples[solved_m.partition_point(|&m| m < approach).min(solved_m.len() - 1)]
        };
        let mut added = Vec::new();
        for &i in &open {
            let (low, high) = (level_m[i], level_m[i + 1]);
            let error = curves.iter().fold(0.0f64, |worst, curve| {
                let (a, b, m) = (at(curve, low), at(curve, high), at(curve, 0.5 * (low + high)));
                worst.max((middle(a, b, high - low) - m.0).abs() / scale(m.0, sampler.force_bt_n))
            });
            if error > tolerance {
                added.push((error, 0.5 * (low + high)));
            }
        }
        // The worst first, up to the limit.
        added.sort_by(|a, b| b.0.total_cmp(&a.0));
        added.truncate((MOST_LEVELS + 1).saturating_sub(level_m.len()));
        let fresh: Vec<f64> = added.iter().map(|a| a.1).collect();
        level_m.extend(&fresh);
        level_m.sort_by(f64::total_cmp);
        open = (1..level_m.len() - 1)
            .filter(|&i| fresh.contains(&level_m[i]) || fresh.contains(&level_m[i + 1]))
            .collect();
    }
    Ok(level_m)
}
