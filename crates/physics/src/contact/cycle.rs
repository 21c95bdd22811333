//! One mesh period of one half: stiffness, transmission error, load shares.

use serde::{Deserialize, Serialize};

use super::error::ContactError;
use super::half::HalfContact;
use super::position::LoadedPosition;
use super::refine::RefinedPositions;
use crate::compliance::line_contact;
use crate::gear::Pair;
use crate::numerics::{PeriodicMonotoneCubic, interpolation};
use crate::watch::{Canceled, Watch};

/// Mean, least and largest value over the mesh period (arithmetic mean over the positions).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CurveStatistics {
    /// Arithmetic mean.
    pub mean: f64,
    /// Least value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

impl CurveStatistics {
    /// Of a non-empty list.
    pub fn of(values: &[f64]) -> CurveStatistics {
        CurveStatistics {
            mean: values.iter().sum::<f64>() / values.len() as f64,
            min: values.iter().copied().fold(f64::INFINITY, f64::min),
            max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// Line load over the flank: rows along the path of contact, columns along the face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlankMap {
    /// Roll coordinate of every row (middle of the bin).
    pub roll_m: Vec<f64>,
    /// Distance of every column from the inner end.
    pub face_m: Vec<f64>,
    /// Normal force per length of contact line, row by row; 0 where nothing touches.
    pub line_load_n_per_m: Vec<f64>,
}

/// Deflection of the pairs in mesh while the entering pair is still free: what mesh-in impact starts from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EntryDeflection {
    /// Roll before the theoretical start of contact, ascending from 0.
    pub overrun_m: Vec<f64>,
    /// Approach of the pairs in mesh along the transverse base tangent at every overrun.
    pub deflection_m: Vec<f64>,
    /// Tangent stiffness of the pairs in mesh at every overrun.
    pub stiffness_n_per_m: Vec<f64>,
}

impl EntryDeflection {
    /// Deflection along the base tangent `overrun_m` before the theoretical start, interpolated linearly and held
    /// constant beyond the table.
    pub fn deflection_before_entry_m(&self, overrun_m: f64) -> f64 {
        interpolation::linear(&self.overrun_m, &self.deflection_m, overrun_m)
    }
}

/// Loaded contact of one half over one mesh period. Forces and displacements along the transverse base tangent.
///
/// Phase 0: a pair is at its first theoretical contact at the mesh-in end; phase 1: the next one does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HalfCycle {
    /// Phase of every position, base pitches.
    pub phase: Vec<f64>,
    /// F_bt at every position: constant, except where the halves of a spur-like pair share by deflection.
    pub force_bt_n: Vec<f64>,
    /// dF_bt/dδ.
    pub stiffness_n_per_m: Vec<f64>,
    /// F_bt/δ.
    pub secant_stiffness_n_per_m: Vec<f64>,
    /// Loaded transmission error δ.
    pub transmission_error_m: Vec<f64>,
    /// Pairs that carry force, at every solved position.
    pub pairs_in_contact: Vec<u32>,
    /// Path of one pair in base pitches since its first theoretical contact, overrun included.
    pub load_share_phase: Vec<f64>,
    /// Force of the pair as a part of the half's force.
    pub load_share: Vec<f64>,
    /// Share of the entering pair 0.05 base pitches after its theoretical start of contact.
    pub load_share_at_mesh_in: f64,
    /// Length of the path over which one pair carries load, in base pitches.
    pub loaded_contact_ratio: f64,
    /// Path (base pitches) at which a pair begins and ends to carry load.
    pub load_begins_and_ends: [f64; 2],
    /// Largest normal force per length of contact line, slivers below half a slice left out.
    pub max_line_load_n_per_m: f64,
    /// The same without the ends of the theoretical lines of contact, three quarters of a normal module long each.
    pub max_line_load_interior_n_per_m: f64,
    /// Hertzian pressure at that kind of point, largest over the period.
    pub max_hertz_pressure_pa: f64,
    /// Line load over the flank.
    pub flank_map: FlankMap,
    /// Deflection before a pair enters.
    pub entry: EntryDeflection,
    /// Statistics of `stiffness_n_per_m`.
    pub stiffness: CurveStatistics,
    /// Statistics of `secant_stiffness_n_per_m`.
    pub secant_stiffness: CurveStatistics,
    /// Statistics of `transmission_error_m`.
    pub transmission_error: CurveStatistics,
    /// Amplitudes of the first harmonics of the transmission error per mesh period.
    pub transmission_error_harmonics_m: Vec<f64>,
    /// Positions solved.
    pub positions: usize,
    /// Change of the curves' Fourier coefficients by the positions that confirmed the others, as a part of the means;
    /// `None` for given positions.
    pub position_error: Option<f64>,
    /// Slices of the contact lines over the face width.
    pub slices: usize,
    /// Change of stiffness and transmission error, as a part of their means, when only half as many slices are used.
    pub slice_error: f64,
    /// Newton iterations over the whole period.
    pub iterations: u64,
}

/// Share of a base pitch after the start of contact at which the mesh-in share is taken.
pub const MESH_IN_PHASE: f64 = 0.05;
/// Rows and columns of the flank map.
const MAP_ROWS: usize = 24;
/// Ends of the lines of contact that the interior line load leaves out, in normal modules along the line: edge effects
/// reach that far.
const LINE_END_MODULES: f64 = 0.75;
/// Positions at which fewer slices are tried.
const SLICE_CHECKS: usize = 5;
/// Harmonics that are reported.
const HARMONICS: usize = 8;
/// Points of the entry table.
const ENTRY_POINTS: usize = 7;
/// Smallest share that counts as carrying load.
const LEAST_SHARE: f64 = 1e-9;

/// Positions of the curves when the solved positions are chosen by accuracy, and of spur halves that share the torque.
pub(super) const CURVE_POSITIONS: usize = 64;

/// Puts positions together to a [`HalfCycle`].
pub(super) struct CycleBuilder<'a> {
    pair: &'a Pair,
    slices: usize,
    /// Phase, F_bt, state.
    states: Vec<(f64, f64, LoadedPosition)>,
    /// Phase of the first curve position when the curves are interpolated, and the error of that.
    resampled: Option<(f64, f64)>,
}

impl<'a> CycleBuilder<'a> {
    /// Curves over the solved positions themselves, equally spaced: phase, F_bt and state of each.
    pub(super) fn at_positions(
        pair: &'a Pair,
        slices: usize,
        states: Vec<(f64, f64, LoadedPosition)>,
    ) -> CycleBuilder<'a> {
        CycleBuilder { pair, slices, states, resampled: None }
    }

    /// Curves over equally spaced positions from `from` between positions solved where they were needed.
    pub(super) fn refined(
        pair: &'a Pair,
        slices: usize,
        positions: RefinedPositions,
        force_bt_n: f64,
        from: f64,
    ) -> CycleBuilder<'a> {
        let states = positions.states.into_iter().map(|(phase, state)| (phase, force_bt_n, state)).collect();
        Self::resampled(pair, slices, states, (from, positions.error))
    }

    /// The same with a force at every position: phase (ascending), F_bt and state; phase of the first curve position
    /// and error of the positions.
    pub(super) fn resampled(
        pair: &'a Pair,
        slices: usize,
        states: Vec<(f64, f64, LoadedPosition)>,
        from_and_error: (f64, f64),
    ) -> CycleBuilder<'a> {
        CycleBuilder { pair, slices, states, resampled: Some(from_and_error) }
    }

    /// Solves the special states (mesh-in share, begin and end of load, entry) and closes the period. `force_at` gives
    /// F_bt at a phase.
    pub(super) fn finish(
        self,
        contact: &mut HalfContact<'_>,
        force_at: &dyn Fn(f64) -> f64,
    ) -> Result<HalfCycle, ContactError> {
        let states = &self.states;
        let column = |f: &dyn Fn(&(f64, f64, LoadedPosition)) -> f64| {
            let solved: Vec<f64> = states.iter().map(f).collect();
            match self.resampled {
                None => solved,
                Some((from, _)) => PeriodicMonotoneCubic::new(states.iter().map(|s| s.0).collect(), solved)
                    .samples(from, CURVE_POSITIONS),
            }
        };
        let phase = match self.resampled {
            None => states.iter().map(|s| s.0).collect(),
            Some((from, _)) => {
                (0..CURVE_POSITIONS).map(|i| (from + i as f64 / CURVE_POSITIONS as f64).fract()).collect()
            }
        };
        let stiffness = column(&|s| s.2.stiffness_n_per_m);
        let secant = column(&|s| s.1 / s.2.approach_m);
        let error = column(&|s| s.2.approach_m);
        let pairs_in_contact = states.iter().map(|s| carrying(&s.2).len() as u32).collect();
        let watch = contact.watch();
        let (load_share_phase, load_share) = self.path(watch)?;
        let mesh_in = contact.at(MESH_IN_PHASE, force_at(MESH_IN_PHASE))?;
        let load_begins_and_ends = self.carrying_range(contact, force_at, &load_share_phase, &load_share)?;
        let [max_line_load, max_interior, max_pressure] = self.extremes(watch)?;
        let entry = self.entry(contact, force_at)?;
        Ok(HalfCycle {
            phase,
            force_bt_n: column(&|s| s.1),
            stiffness: CurveStatistics::of(&stiffness),
            secant_stiffness: CurveStatistics::of(&secant),
            transmission_error: CurveStatistics::of(&error),
            transmission_error_harmonics_m: harmonics(&error),
            stiffness_n_per_m: stiffness,
            secant_stiffness_n_per_m: secant,
            transmission_error_m: error,
            pairs_in_contact,
            load_share_phase,
            load_share,
            load_share_at_mesh_in: mesh_in.share(0),
            loaded_contact_ratio: load_begins_and_ends[1] - load_begins_and_ends[0],
            load_begins_and_ends,
            max_line_load_n_per_m: max_line_load,
            max_line_load_interior_n_per_m: max_interior,
            max_hertz_pressure_pa: max_pressure,
            flank_map: self.map(watch)?,
            entry,
            positions: states.len(),
            slices: self.slices,
            slice_error: self.slice_error(contact)?,
            position_error: self.resampled.map(|(_, error)| error),
            iterations: states.iter().map(|s| u64::from(s.2.iterations)).sum(),
        })
    }

    /// Path of one pair put together from all pairs of all positions.
    fn path(&self, watch: Watch<'_>) -> Result<(Vec<f64>, Vec<f64>), Canceled> {
        let pairs = self.states.iter().flat_map(|s| s.2.points.iter().map(|p| p.pair));
        let (low, high) = pairs.fold((0, 0), |(l, h), k| (l.min(k), h.max(k)));
        let mut shares = Vec::with_capacity(self.states.len());
        for state in &self.states {
            watch.checkpoint_quietly()?;
            shares.push(state.2.shares(low, high));
        }
        let mut path = Vec::with_capacity((high - low + 1) as usize * self.states.len());
        for (line, k) in (low..=high).enumerate() {
            watch.checkpoint_quietly()?;
            path.extend(self.states.iter().zip(&shares).map(|(s, shares)| (s.0 + f64::from(k), shares[line])));
        }
        path.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(path.into_iter().unzip())
    }

    /// First and last path position with load, refined between the positions by bisection.
    fn carrying_range(
        &self,
        contact: &mut HalfContact<'_>,
        force_at: &dyn Fn(f64) -> f64,
        path: &[f64],
        share: &[f64],
    ) -> Result<[f64; 2], ContactError> {
        let step = 1.0 / 16.0;
        let first = share.iter().position(|&s| s > LEAST_SHARE).unwrap_or(0);
        let last = share.iter().rposition(|&s| s > LEAST_SHARE).unwrap_or(share.len() - 1);
        let below = if first > 0 { path[first - 1] } else { path[first] - step };
        let above = path.get(last + 1).copied().unwrap_or(path[last] + step);
        let mut out = [0.0; 2];
        for (slot, (inside, outside)) in out.iter_mut().zip([(path[first], below), (path[last], above)]) {
            let (mut inside, mut outside) = (inside, outside);
            for _ in 0..4 {
                let middle = 0.5 * (inside + outside);
                let k = middle.floor();
                let phase = middle - k;
                if contact.at(phase, force_at(phase))?.share(k as i32) > LEAST_SHARE {
                    inside = middle;
                } else {
                    outside = middle;
                }
            }
            *slot = 0.5 * (inside + outside);
        }
        Ok(out)
    }

    /// Largest line load, largest away from the ends of the lines, largest pressure.
    fn extremes(&self, watch: Watch<'_>) -> Result<[f64; 3], Canceled> {
        let cos = self.pair.base_helix_angle_rad.cos();
        let sliver = 0.5 * self.pair.spec.face_width_m / self.slices as f64;
        let end = LINE_END_MODULES * self.pair.spec.normal_module_m * cos;
        let mut largest = [0.0f64; 3];
        for (_, _, state) in &self.states {
            watch.checkpoint_quietly()?;
            let mut forces = state.forces_n.as_slice();
            for line in state.points.chunk_by(|a, b| a.pair == b.pair) {
                let (own, others) = forces.split_at(line.len());
                forces = others;
                let on_path = || line.iter().filter(|p| p.zone == 1);
                let low = on_path().map(|p| p.entry_m - 0.5 * p.width_m).fold(f64::INFINITY, f64::min);
                let high = on_path().map(|p| p.entry_m + 0.5 * p.width_m).fold(f64::NEG_INFINITY, f64::max);
                for (p, &f) in line.iter().zip(own) {
                    if p.width_m < sliver || f <= 0.0 || p.zone != 1 {
                        continue;
                    }
                    let w = f * cos / p.width_m;
                    let contact = line_contact(self.pair, p.x_m, [0.0; 2]);
                    let interior = p.entry_m > low + end && p.entry_m < high - end;
                    let values = [w, if interior { w } else { 0.0 }, contact.pressure_pa(w)];
                    largest.iter_mut().zip(values).for_each(|(l, v)| *l = l.max(v));
                }
            }
        }
        Ok(largest)
    }

    /// Change of stiffness and transmission error with half as many slices, at a few of the positions.
    fn slice_error(&self, contact: &mut HalfContact<'_>) -> Result<f64, ContactError> {
        let step = (self.states.len() / SLICE_CHECKS).max(1);
        contact.set_slices(self.slices / 2);
        let mut sums = [[0.0; 2]; 2];
        for (phase, force, state) in self.states.iter().step_by(step).filter(|state| state.1 > 0.0) {
            let coarse = contact.at(*phase, *force)?;
            for (sum, (fine, coarse)) in sums
                .iter_mut()
                .zip([(state.stiffness_n_per_m, coarse.stiffness_n_per_m), (state.approach_m, coarse.approach_m)])
            {
                sum[0] += (fine - coarse).abs();
                sum[1] += fine.abs();
            }
        }
        contact.set_slices(self.slices);
        Ok(sums.map(|[change, whole]| change / whole.max(f64::MIN_POSITIVE)).into_iter().fold(0.0, f64::max))
    }

    fn map(&self, watch: Watch<'_>) -> Result<FlankMap, Canceled> {
        let (start, end) = (self.pair.path_start_m, self.pair.path_end_m);
        let b = self.pair.spec.face_width_m;
        let cos = self.pair.base_helix_angle_rad.cos();
        let columns = self.slices.min(32);
        let mut force = vec![0.0; MAP_ROWS * columns];
        let mut length = vec![0.0; MAP_ROWS * columns];
        let bin = |value: f64, count: usize| ((value * count as f64) as usize).min(count - 1);
        for (_, _, state) in &self.states {
            watch.checkpoint_quietly()?;
            for (p, f) in state.points.iter().zip(&state.forces_n) {
                if p.zone != 1 {
                    continue;
                }
                let row = bin((p.x_m - start) / (end - start), MAP_ROWS);
                let cell = row * columns + bin(self.pair.entry_m(p.entry_m) / b, columns);
                force[cell] += f;
                length[cell] += p.width_m / cos;
            }
        }
        let middle = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
        Ok(FlankMap {
            roll_m: (0..MAP_ROWS).map(|i| start + (end - start) * middle(i, MAP_ROWS)).collect(),
            face_m: (0..columns).map(|i| b * middle(i, columns)).collect(),
            line_load_n_per_m: force.iter().zip(&length).map(|(f, l)| if *l > 0.0 { f / l } else { 0.0 }).collect(),
        })
    }

    /// Deflection before entry, up to where the corner gap exceeds it by half (at most half a base pitch).
    fn entry(
        &self,
        contact: &mut HalfContact<'_>,
        force_at: &dyn Fn(f64) -> f64,
    ) -> Result<EntryDeflection, ContactError> {
        let pitch = self.pair.base_pitch_m;
        let at_start = contact.before_entry(0.0, force_at(0.0))?;
        let mut reach = 0.02 * pitch;
        while reach < 0.5 * pitch
            && self.pair.mesh_in_corner_gap_m(reach).is_some_and(|gap| gap < 1.5 * at_start.approach_m)
        {
            reach *= 1.25;
        }
        reach = reach.min(0.5 * pitch);
        let mut table = EntryDeflection {
            overrun_m: vec![0.0],
            deflection_m: vec![at_start.approach_m],
            stiffness_n_per_m: vec![at_start.stiffness_n_per_m],
        };
        for i in 1..ENTRY_POINTS {
            let overrun = reach * i as f64 / (ENTRY_POINTS - 1) as f64;
            let state = contact.before_entry(overrun, force_at((1.0 - overrun / pitch).fract()))?;
            table.overrun_m.push(overrun);
            table.deflection_m.push(state.approach_m);
            table.stiffness_n_per_m.push(state.stiffness_n_per_m);
        }
        Ok(table)
    }
}

/// Pairs with force.
fn carrying(state: &LoadedPosition) -> Vec<i32> {
    let mut pairs: Vec<i32> =
        state.points.iter().zip(&state.forces_n).filter(|(_, f)| **f > 0.0).map(|(p, _)| p.pair).collect();
    pairs.dedup();
    pairs
}

/// Amplitudes of harmonics 1.. per period of equally spaced samples.
pub fn harmonics(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    (1..=HARMONICS.min((n - 1) / 2))
        .map(|h| {
            let step = 2.0 * std::f64::consts::PI * h as f64 / n as f64;
            let (mut re, mut im) = (0.0, 0.0);
            for (i, v) in values.iter().enumerate() {
                let (s, c) = (step * i as f64).sin_cos();
                re += (v - mean) * c;
                im += (v - mean) * s;
            }
            2.0 * re.hypot(im) / n as f64
        })
        .collect()
}
