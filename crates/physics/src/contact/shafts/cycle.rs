//! One mesh period of both halves on elastic shafts.

use serde::{Deserialize, Serialize};

use super::flexibility::{AxialFreedom, ContactShafts, DisplacementField, NODES, SectionDisplacements};
use super::frame::{Body, Section};
use super::position::{JointPosition, JointSolver};
use crate::compliance::{Compliance, Settings};
use crate::contact::ContactError;
use crate::contact::coast::backwards;
use crate::contact::cycle::{CycleBuilder, HalfCycle, harmonics};
use crate::contact::half::HalfContact;
use crate::contact::halves::LoadedContact;
use crate::contact::position::LoadedPosition;
use crate::gear::{Half, Pair};
use crate::watch::Watch;

/// Load along the face of one half, mean over all contact lines that pass a place during the mesh period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaceLoad {
    /// Middles of equal strips of the face, from the inner end.
    pub strip_m: Vec<f64>,
    /// Normal force per length of contact line in every strip.
    pub line_load_n_per_m: Vec<f64>,
    /// The same at the inner and the outer end, extended linearly from the two strips before.
    pub ends_n_per_m: [f64; 2],
    /// Middles of pieces of about 5 mm of the face, from the inner end.
    pub piece_m: Vec<f64>,
    /// Means over these pieces.
    pub piece_line_load_n_per_m: Vec<f64>,
    /// Force of the half over the mean length of its contact lines.
    pub mean_n_per_m: f64,
}

impl FaceLoad {
    /// Largest line load along the face, the ends included, over the mean: K_Hβ.
    pub fn k_h_beta(&self) -> f64 {
        self.line_load_n_per_m.iter().chain(&self.ends_n_per_m).copied().fold(0.0, f64::max) / self.mean_n_per_m
    }

    /// Largest mean over 5 mm of the face over the mean.
    pub fn k_h_beta_5mm(&self) -> f64 {
        self.piece_line_load_n_per_m.iter().copied().fold(0.0, f64::max) / self.mean_n_per_m
    }

    /// Line load at a distance from the inner end, linear between strips and ends.
    pub fn at_n_per_m(&self, from_inner_m: f64) -> f64 {
        let width_m = 2.0 * self.strip_m[0] * self.strip_m.len() as f64;
        let [inner, outer] = self.ends_n_per_m;
        let places: Vec<f64> =
            std::iter::once(0.0).chain(self.strip_m.iter().copied()).chain(std::iter::once(width_m)).collect();
        let loads: Vec<f64> =
            std::iter::once(inner).chain(self.line_load_n_per_m.iter().copied()).chain(std::iter::once(outer)).collect();
        crate::numerics::interpolation::linear(&places, &loads, from_inner_m)
    }
}

/// One half on the shafts, over the mesh period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HalfOnShafts {
    /// Normal force, mean and difference of the extremes.
    pub normal_force_n: [f64; 2],
    /// Part of the normal force of both halves.
    pub share: f64,
    /// Axial force on the pinion, positive to the right.
    pub axial_force_on_pinion_n: f64,
    /// Load along the face.
    pub face: FaceLoad,
    /// Largest line load of a position over the mean line load, mean over the positions.
    pub peak_over_mean: f64,
    /// Centre of the load from the inner end.
    pub centroid_from_inner_m: f64,
    /// Force by approach (N/m), moment about the middle of the face by approach (N) and by tilt (N m) of the teeth on
    /// bodies that are held, along the flank normal, mean; distances from the mesh-out end.
    pub tooth_stiffness: [f64; 3],
    /// Openings that the shafts cause, relative to the mid-face sections at the pitch point, mean.
    pub openings_m: Vec<f64>,
}

/// Displacements of a shaft under load, mean over the mesh period. Sections: u_x, u_y, u_z (m), φ_x, φ_y, φ_z (rad), the
/// rotation relative to the section at the coupling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShaftState {
    /// Left outer, left inner, right inner, right outer end of the common face.
    pub face_ends: Vec<Section>,
    /// Apex plane.
    pub apex: Section,
    /// Force and moment of every bearing on the shaft: N, N m.
    pub bearings: Vec<Section>,
    /// Places along the shaft from the apex plane, and the sections there.
    pub shape_at_m: Vec<f64>,
    /// Sections of the deflected shaft.
    pub shape: Vec<Section>,
}

/// Loaded contact of both halves on elastic shafts over one mesh period of the left half.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadedContactOnShafts {
    /// Curves of both halves. Approach (transmission error): between the mid-face sections; stiffness: of the teeth with
    /// the bodies held in their displaced shape.
    pub contact: LoadedContact,
    /// Base-tangent displacement between the couplings at every position: wind-up and bending included.
    pub between_couplings_m: Vec<f64>,
    /// Axial shift of the pinion at the apex plane at every position, positive to the right.
    pub pinion_float_m: Vec<f64>,
    /// Left and right half.
    pub halves: [HalfOnShafts; 2],
    /// Pinion and gear.
    pub shafts: [ShaftState; 2],
    /// Mean length of the contact lines of a half, and force of both halves over that of both.
    pub line_length_m: f64,
    /// Mean line load of both halves.
    pub line_load_n_per_m: f64,
    /// Part of the length of the contact lines without load.
    pub open_fraction: f64,
    /// Largest difference of the sum of the tooth and bearing forces on either shaft from zero (radial, and axial where
    /// a bearing holds), over the tooth force.
    pub balance_error: f64,
}

/// Positions over the mesh period: to begin with, and at most.
const POSITIONS: usize = 32;
const MOST_POSITIONS: usize = 128;
/// Length of the pieces of the face over which the line load is averaged.
const PIECE_M: f64 = 5e-3;
/// Harmonics that are compared for the error of the positions.
const COMPARED: usize = 3;

/// Solves both halves of `pair` on `shafts` under the pinion's torque of the magnitude `torque_nm`. `half_stagger` (part
/// of a transverse pitch) advances the right half. `axial_n`: axial force by which a coupling holds the floating member
/// back, on the pinion and positive to the right. With `coast`, `shafts` are those of the frame of the coast flanks, and
/// curves are given over the phase of `pair` in the order in which it happens, as in
/// [`solve_coast_halves`](crate::contact::solve_coast_halves).
///
/// # Errors
/// [`ContactError`].
pub fn solve_on_shafts(
    pair: &Pair,
    shafts: &ContactShafts,
    (torque_nm, half_stagger, axial_n): (f64, f64, f64),
    coast: bool,
    (compliance, settings): (&Compliance, &Settings),
    watch: Watch<'_>,
) -> Result<LoadedContactOnShafts, ContactError> {
    if !coast {
        return solve_from(0.0, pair, shafts, (torque_nm, half_stagger, axial_n), (compliance, settings), watch);
    }
    let from = pair.coast_phase(0.0);
    let loads = (torque_nm, -half_stagger, axial_n);
    let mut solved = solve_from(from, &pair.coast(), shafts, loads, (compliance, settings), watch)?;
    let stagger = half_stagger - half_stagger.floor();
    for (half, lead) in solved.contact.halves.iter_mut().zip([0.0, stagger]) {
        half.run_backwards(lead, pair.total_contact_ratio());
    }
    let contact = &mut solved.contact;
    for curve in [
        &mut contact.transmission_error_m,
        &mut contact.axial_shift_m,
        &mut solved.between_couplings_m,
        &mut solved.pinion_float_m,
    ] {
        backwards(curve);
    }
    contact.axial_shift_m.iter_mut().for_each(|shift| *shift = -*shift);
    Ok(solved)
}

fn solve_from(
    from: f64,
    pair: &Pair,
    shafts: &ContactShafts,
    (torque_nm, half_stagger, axial_n): (f64, f64, f64),
    (compliance, settings): (&Compliance, &Settings),
    watch: Watch<'_>,
) -> Result<LoadedContactOnShafts, ContactError> {
    if !(torque_nm > 0.0 && torque_nm.is_finite()) {
        return Err(ContactError::Torque { torque_nm });
    }
    if let Some(positions) = settings.positions.filter(|&n| n < 2) {
        return Err(ContactError::Positions { positions });
    }
    let stagger = half_stagger - half_stagger.floor();
    let force_bt_n = torque_nm / pair.pinion.base_radius_m;
    let mut solver = JointSolver::new(pair, shafts, compliance, settings, watch);
    let mut solve = |position: f64| {
        let phases = [(position + from).fract(), (position + from + stagger).fract()];
        // Σ n_z f of the forces on the gear is the axial force on the pinion with the opposite sign.
        solver.solve(phases, force_bt_n, axial_n).map(|state| (phases, state))
    };
    let mut count = settings.positions.unwrap_or(POSITIONS);
    let mut states = Vec::with_capacity(count);
    for i in 0..count {
        watch.checkpoint(0.9 * i as f64 / count as f64)?;
        states.push(solve(i as f64 / count as f64)?);
    }
    let mut error = position_error(&states);
    while settings.positions.is_none() && error > settings.accuracy && count < MOST_POSITIONS {
        let mut refined = Vec::with_capacity(2 * count);
        for (i, state) in states.into_iter().enumerate() {
            watch.checkpoint_quietly()?;
            refined.push(state);
            refined.push(solve((i as f64 + 0.5) / count as f64)?);
        }
        states = refined;
        count *= 2;
        error = position_error(&states);
    }
    report(pair, shafts, states, error, (compliance, settings), watch)
}

/// Change of the first Fourier coefficients of approach and stiffness of both halves, as parts of the means, when every
/// other position is left out.
fn position_error(states: &[([f64; 2], JointPosition)]) -> f64 {
    let change = |of: &dyn Fn(&JointPosition) -> f64| {
        let all: Vec<f64> = states.iter().map(|(_, state)| of(state)).collect();
        let half: Vec<f64> = all.iter().step_by(2).copied().collect();
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let differences =
            harmonics(&all).into_iter().zip(harmonics(&half)).take(COMPARED).map(|(a, b)| (a - b).abs());
        let offset = (mean(&all) - mean(&half)).abs();
        differences.fold(offset, f64::max) / mean(&all).abs().max(f64::MIN_POSITIVE)
    };
    (0..2)
        .map(|h| {
            change(&|state| state.halves[h].approach_m).max(change(&|state| state.halves[h].stiffness_n_per_m))
        })
        .fold(0.0, f64::max)
}

fn report(
    pair: &Pair,
    shafts: &ContactShafts,
    states: Vec<([f64; 2], JointPosition)>,
    position_error: f64,
    (compliance, settings): (&Compliance, &Settings),
    watch: Watch<'_>,
) -> Result<LoadedContactOnShafts, ContactError> {
    let count = states.len() as f64;
    let cos = pair.base_helix_angle_rad.cos();
    let slices = compliance.slices();
    let of_both: f64 =
        states.iter().flat_map(|(_, s)| &s.halves).map(|half| half.forces_n.iter().sum::<f64>()).sum::<f64>() / count;
    let mut lengths = [[0.0; 2]; 2];
    let mut halves = Vec::with_capacity(2);
    for half in Half::BOTH {
        let h = half.index();
        let positions: Vec<&LoadedPosition> = states.iter().map(|(_, s)| &s.halves[h]).collect();
        let mut solved = half_on_shafts(pair, half, shafts, &positions, slices, &mut lengths[h]);
        solved.share = solved.normal_force_n[0] / of_both;
        for (_, state) in &states {
            (0..3).for_each(|c| solved.tooth_stiffness[c] += state.tilting[h][c] / count);
            solved.openings_m.iter_mut().zip(state.openings_m[h]).for_each(|(mean, o)| *mean += o / count);
        }
        halves.push(solved);
    }
    let halves = [halves.remove(0), halves.remove(0)];
    let [pinion, gear] = Body::BOTH.map(|body| shaft_state(shafts, body, &states));
    let balance_error = balance_error(shafts, &halves, [&pinion, &gear]);
    let between_couplings_m = states.iter().map(|(_, s)| s.approach_m).collect();
    let pinion_float_m = states.iter().map(|(_, s)| s.shafts[0].apex[2]).collect();
    // The curves of either half, with the bodies held in their mean shape where special states are solved.
    let mut cycles = Vec::with_capacity(2);
    for half in Half::BOTH {
        let h = half.index();
        let field = displacement_field(shafts, &halves[h]);
        let mut contact = HalfContact::displaced(pair, half, compliance, settings, &field, watch);
        let own: Vec<(f64, f64, LoadedPosition)> = states
            .iter()
            .map(|(phases, state)| {
                let state = &state.halves[h];
                (phases[h], state.forces_n.iter().sum::<f64>() * cos, state.clone())
            })
            .collect();
        let mean_n = own.iter().map(|s| s.1).sum::<f64>() / count;
        let mut cycle: HalfCycle =
            CycleBuilder::at_positions(pair, slices, own).finish(&mut contact, &|_| mean_n)?;
        cycle.position_error = Some(position_error);
        cycles.push(cycle);
    }
    let halves_of = [cycles.remove(0), cycles.remove(0)];
    let tan = pair.base_helix_angle_rad.tan();
    let [left, right] = &halves_of;
    let both = || left.transmission_error_m.iter().zip(&right.transmission_error_m);
    let contact = LoadedContact {
        equal_halves: false,
        transmission_error_m: both().map(|(l, r)| 0.5 * (l + r)).collect(),
        axial_shift_m: both().map(|(l, r)| if tan > super::SPUR { (l - r) / (2.0 * tan) } else { 0.0 }).collect(),
        axial_force_n: [0, 1].map(|h| halves[h].normal_force_n[0] * cos * tan),
        slices,
        halves: halves_of,
    };
    let [of_left, of_right] = lengths;
    let all = of_left[0] + of_right[0];
    Ok(LoadedContactOnShafts {
        contact,
        between_couplings_m,
        pinion_float_m,
        line_length_m: 0.5 * all / count,
        line_load_n_per_m: of_both / (all / count),
        open_fraction: (of_left[1] + of_right[1]) / all,
        balance_error,
        halves,
        shafts: [pinion, gear],
    })
}

/// The openings of a half between its bodies, relative to the mid-face sections at the pitch point, mean over the period.
fn displacement_field(shafts: &ContactShafts, half: &HalfOnShafts) -> DisplacementField {
    let mut openings_m = [0.0; NODES];
    openings_m.iter_mut().zip(&half.openings_m).for_each(|(o, mean)| *o = *mean);
    shafts.field(openings_m)
}

impl LoadedContactOnShafts {
    /// The openings between the bodies of a half, for [`HalfContact::displaced`].
    pub fn displacement_field(&self, shafts: &ContactShafts, half: Half) -> DisplacementField {
        displacement_field(shafts, &self.halves[half.index()])
    }
}

/// Loads of a half. `lengths` receives the length of the contact lines of all positions, and that without load.
fn half_on_shafts(
    pair: &Pair,
    half: Half,
    shafts: &ContactShafts,
    positions: &[&LoadedPosition],
    slices: usize,
    lengths: &mut [f64; 2],
) -> HalfOnShafts {
    let (width_m, cos) = (pair.spec.face_width_m, pair.base_helix_angle_rad.cos());
    let pieces = ((width_m / PIECE_M).round() as usize).max(1);
    let mut strips = Strips::new(width_m, slices);
    let mut of_pieces = Strips::new(width_m, pieces);
    let sliver_m = 0.5 * width_m / slices as f64;
    let mut forces = Vec::with_capacity(positions.len());
    let (mut moment, mut peaks) = (0.0, 0.0);
    for position in positions {
        forces.push(position.forces_n.iter().sum::<f64>());
        let mut peak = 0.0f64;
        for (p, &f) in position.points.iter().zip(&position.forces_n) {
            // entry_m is its own inverse.
            let from_inner_m = pair.entry_m(p.entry_m);
            let on_path = p.zone == 1;
            let length_m = if on_path { p.width_m / cos } else { 0.0 };
            lengths[0] += length_m;
            if f <= 0.0 {
                lengths[1] += length_m;
            }
            if on_path && p.width_m >= sliver_m {
                peak = peak.max(f * cos / p.width_m);
            }
            moment += f * from_inner_m;
            let range = (from_inner_m - 0.5 * p.width_m, from_inner_m + 0.5 * p.width_m);
            strips.add(range, f, length_m);
            of_pieces.add(range, f, length_m);
        }
        peaks += peak;
    }
    let sum: f64 = forces.iter().sum();
    let mean_n = sum / positions.len() as f64;
    let mean_n_per_m = sum / lengths[0];
    let line_load_n_per_m = strips.line_loads();
    let last = line_load_n_per_m.len() - 1;
    let beyond = |end: usize, before: usize| {
        let [end, before] = [line_load_n_per_m[end], line_load_n_per_m[before]];
        (1.5 * end - 0.5 * before).max(0.0)
    };
    let ends_n_per_m = [beyond(0, 1.min(last)), beyond(last, last.saturating_sub(1))];
    let largest = forces.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = forces.iter().copied().fold(f64::INFINITY, f64::min);
    HalfOnShafts {
        normal_force_n: [mean_n, largest - least],
        share: 0.0,
        axial_force_on_pinion_n: -shafts.frame.axial[half.index()] * mean_n,
        face: FaceLoad {
            strip_m: strips.middles_m(),
            ends_n_per_m,
            piece_m: of_pieces.middles_m(),
            piece_line_load_n_per_m: of_pieces.line_loads(),
            mean_n_per_m,
            line_load_n_per_m,
        },
        peak_over_mean: peaks / positions.len() as f64 / mean_n_per_m,
        centroid_from_inner_m: moment / sum,
        tooth_stiffness: [0.0; 3],
        openings_m: vec![0.0; NODES],
    }
}

/// Forces and lengths in equal strips of the face.
struct Strips {
    width_m: f64,
    force_n: Vec<f64>,
    length_m: Vec<f64>,
}

impl Strips {
    fn new(face_m: f64, count: usize) -> Strips {
        Strips { width_m: face_m / count as f64, force_n: vec![0.0; count], length_m: vec![0.0; count] }
    }

    /// Adds a force that is spread evenly over a range of the face.
    fn add(&mut self, (from, to): (f64, f64), force_n: f64, length_m: f64) {
        let last = self.force_n.len() - 1;
        let strip = |place: f64| ((place / self.width_m).max(0.0) as usize).min(last);
        // An end on the border of two strips belongs to the one before.
        let (first, end) = (strip(from + 1e-9 * self.width_m), strip(to - 1e-9 * self.width_m));
        if first >= end || to <= from {
            self.force_n[first] += force_n;
            self.length_m[first] += length_m;
            return;
        }
        for i in first..=end {
            let low = if i == first { from } else { i as f64 * self.width_m };
            let high = if i == end { to } else { (i + 1) as f64 * self.width_m };
            let part = (high - low) / (to - from);
            self.force_n[i] += part * force_n;
            self.length_m[i] += part * length_m;
        }
    }

    fn middles_m(&self) -> Vec<f64> {
        (0..self.force_n.len()).map(|i| (i as f64 + 0.5) * self.width_m).collect()
    }

    fn line_loads(&self) -> Vec<f64> {
        self.force_n.iter().zip(&self.length_m).map(|(f, l)| if *l > 0.0 { f / l } else { 0.0 }).collect()
    }
}

fn shaft_state(shafts: &ContactShafts, body: Body, states: &[([f64; 2], JointPosition)]) -> ShaftState {
    let count = states.len() as f64;
    let mean = |of: &dyn Fn(&SectionDisplacements) -> Section| -> Section {
        let mut sum = [0.0; 6];
        for (_, state) in states {
            let section = of(&state.shafts[body as usize]);
            sum.iter_mut().zip(section).for_each(|(s, u)| *s += u / count);
        }
        sum
    };
    let shaft = match body {
        Body::Pinion => &shafts.train.pinion,
        Body::Gear => &shafts.train.gear,
    };
    let shape_at_m = shafts.shape_m()[body as usize].to_vec();
    ShaftState {
        face_ends: (0..4).map(|i| mean(&|s| s.face_ends[i])).collect(),
        apex: mean(&|s| s.apex),
        bearings: {
            let sections: Vec<Section> = (0..shaft.bearings.len()).map(|i| mean(&|s| s.bearings[i])).collect();
            shaft.bearing_reactions(&sections)
        },
        shape: (0..shape_at_m.len()).map(|i| mean(&|s| s.shape[i])).collect(),
        shape_at_m,
    }
}

/// Largest sum of the radial forces on a shaft, and of the axial ones where nothing but bearings holds it, over the tooth
/// force.
fn balance_error(shafts: &ContactShafts, halves: &[HalfOnShafts; 2], states: [&ShaftState; 2]) -> f64 {
    let force: f64 = halves.iter().map(|half| half.normal_force_n[0]).sum();
    let mut worst = 0.0f64;
    for body in Body::BOTH {
        let (sign, train) = match body {
            Body::Pinion => (-1.0, &shafts.train.pinion),
            Body::Gear => (1.0, &shafts.train.gear),
        };
        let mut sum = [0.0; 3];
        for half in Half::BOTH {
            let load = shafts.frame.load(body, half, 0.0);
            (0..3).for_each(|c| sum[c] += sign * load[c] * halves[half.index()].normal_force_n[0]);
        }
        for bearing in &states[body as usize].bearings {
            (0..3).for_each(|c| sum[c] += bearing[c]);
        }
        let held_by_bearings = train.coupling.axial_n_per_m == 0.0
            && !matches!((body, shafts.freedom), (Body::Pinion, AxialFreedom::Pinion) | (Body::Gear, AxialFreedom::Gear));
        for (c, value) in sum.iter().enumerate() {
            if c < 2 || held_by_bearings {
                worst = worst.max(value.abs() / force);
            }
        }
    }
    worst
}
