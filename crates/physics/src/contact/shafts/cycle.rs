//! One mesh period of both halves on elastic shafts.

use serde::{Deserialize, Serialize};

use super::flexibility::{AxialFreedom, ContactShafts, DisplacementField, NODES, SectionDisplacements};
use super::frame::{Body, Section};
use super::position::{JointPosition, JointSolver};
use crate::compliance::{Compliance, Settings};
use crate::contact::ContactError;
use crate::contact::coast::backwards;
use crate::contact::cycle::{CURVE_POSITIONS, CycleBuilder};
use crate::contact::half::HalfContact;
use crate::contact::halves::{LEAST_PART, LoadedContact};
use crate::contact::lines::ContactPoint;
use crate::contact::position::LoadedPosition;
use crate::contact::refine::refine;
use crate::gear::{Half, Pair};
use crate::numerics::PeriodicMonotoneCubic;
use crate::watch::Watch;

/// Load along the face of one half, mean over all contact lines that pass a place during the mesh period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaceLoad {
    /// Middles of equal strips of the face, from the inner end.
    pub strip_m: Vec<f64>,
    /// Normal force per length of contact line in every strip.
    pub line_load_n_per_m: Vec<f64>,
    /// The same at the inner and the outer end, extended from the three strips before.
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
        self.over_mean(self.line_load_n_per_m.iter().chain(&self.ends_n_per_m).copied().fold(0.0, f64::max))
    }

    /// 1 without load.
    fn over_mean(&self, largest_n_per_m: f64) -> f64 {
        if self.mean_n_per_m > 0.0 { largest_n_per_m / self.mean_n_per_m } else { 1.0 }
    }

    /// Largest mean over 5 mm of the face over the mean.
    pub fn k_h_beta_5mm(&self) -> f64 {
        self.over_mean(self.piece_line_load_n_per_m.iter().copied().fold(0.0, f64::max))
    }

    /// Line load at a distance from the inner end, linear between strips and ends.
    pub fn at_n_per_m(&self, from_inner_m: f64) -> f64 {
        let width_m = 2.0 * self.strip_m[0] * self.strip_m.len() as f64;
        let [inner, outer] = self.ends_n_per_m;
        let places: Vec<f64> =
            std::iter::once(0.0).chain(self.strip_m.iter().copied()).chain(std::iter::once(width_m)).collect();
        let loads: Vec<f64> = std::iter::once(inner)
            .chain(self.line_load_n_per_m.iter().copied())
            .chain(std::iter::once(outer))
            .collect();
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
    /// Centre of the load from the apex plane along the shafts.
    pub centroid_z_m: f64,
    /// Openings that the shafts cause, relative to the mid-face sections at the pitch point, mean.
    pub openings_m: Vec<f64>,
}

/// Displacements of a shaft under load, mean over the mesh period. Sections: u_x, u_y, u_z (m), φ_x, φ_y, φ_z (rad),
/// the rotation relative to the section at the coupling.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ShaftState {
    /// Left outer, left inner, right inner, right outer end of the common face.
    pub face_ends: Vec<Section>,
    /// Middles of the left and of the right face.
    pub mid_faces: Vec<Section>,
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
    /// Curves of both halves. Approach (transmission error): between the mid-face sections; stiffness: of the teeth
    /// with the bodies held in their displaced shape.
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

/// Length of the pieces of the face over which the line load is averaged.
const PIECE_M: f64 = 5e-3;
/// Solves both halves of `pair` on `shafts` under the pinion's torque of the magnitude `torque_nm`. `half_stagger`
/// (part of a transverse pitch) advances the right half. `axial_n`: axial force by which a coupling holds the floating
/// member back, on the pinion and positive to the right. With `coast`, `shafts` are those of the frame of the coast
/// flanks, and curves are given over the phase of `pair` in the order in which it happens, as in
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
    let mut solve = |phase: f64, near: Option<&JointPosition>| {
        if let Some(state) = near {
            solver.start_from(state);
        }
        // Σ n_z f of the forces on the gear is the opposite of the axial force on the pinion.
        solver.solve([phase, (phase + stagger).fract()], force_bt_n, axial_n)
    };
    let positions = match settings.positions {
        Some(count) => {
            let mut states = Vec::with_capacity(count);
            for i in 0..count {
                let position = i as f64 / count as f64;
                watch.checkpoint(0.9 * position)?;
                let phase = (position + from).fract();
                states.push((phase, solve(phase, None)?));
            }
            Positions { states, resampled: None }
        }
        None => {
            let mut solved = 0.0;
            let refined = refine(pair, settings.accuracy, |phase, near| {
                solved += 1.0;
                watch.checkpoint(0.9 * solved / (solved + 32.0))?;
                solve(phase, near)
            })?;
            Positions { states: refined.states, resampled: Some((from, refined.error)) }
        }
    };
    report(pair, shafts, &positions, stagger, (compliance, settings), watch)
}

/// Solved positions: the phase of the left half, and the state.
struct Positions {
    states: Vec<(f64, JointPosition)>,
    /// Phase of the first curve position when the curves are interpolated between the states, and the error of that.
    resampled: Option<(f64, f64)>,
}

impl Positions {
    /// Part of the mesh period that each state stands for.
    fn weights(&self) -> Vec<f64> {
        let n = self.states.len();
        let phase = |i: usize| self.states[i % n].0 + (i / n) as f64;
        if self.resampled.is_none() {
            return vec![1.0 / n as f64; n];
        }
        (0..n).map(|i| 0.5 * (phase(i + 1) - if i == 0 { phase(n - 1) - 1.0 } else { phase(i - 1) })).collect()
    }

    /// A curve at the positions of the curves.
    fn curve(&self, of: impl Fn(&JointPosition) -> f64) -> Vec<f64> {
        let values: Vec<f64> = self.states.iter().map(|(_, state)| of(state)).collect();
        match self.resampled {
            None => values,
            Some((from, _)) => {
                let phases = self.states.iter().map(|s| s.0).collect();
                PeriodicMonotoneCubic::new(phases, values).samples(from, CURVE_POSITIONS)
            }
        }
    }

    /// Mean over the mesh period.
    fn mean(&self, of: impl Fn(&JointPosition) -> f64) -> f64 {
        self.weights().iter().zip(&self.states).map(|(w, (_, state))| w * of(state)).sum()
    }
}

fn report(
    pair: &Pair,
    shafts: &ContactShafts,
    positions: &Positions,
    stagger: f64,
    (compliance, settings): (&Compliance, &Settings),
    watch: Watch<'_>,
) -> Result<LoadedContactOnShafts, ContactError> {
    let (states, weights) = (&positions.states, positions.weights());
    let slices = compliance.slices();
    let cos = pair.base_helix_angle_rad.cos();
    let of_both = positions.mean(|s| s.halves.iter().flat_map(|half| &half.forces_n).sum::<f64>());
    let mut lengths = [[0.0; 2]; 2];
    let mut halves = Vec::with_capacity(2);
    for half in Half::BOTH {
        let h = half.index();
        let loaded: Vec<(f64, &LoadedPosition)> =
            weights.iter().zip(states).map(|(w, (_, s))| (*w, &s.halves[h])).collect();
        let mut solved = half_on_shafts(pair, half, shafts, &loaded, slices, &mut lengths[h]);
        solved.share = solved.normal_force_n[0] / of_both;
        solved.tooth_stiffness = std::array::from_fn(|c| positions.mean(|s| s.tilting[h][c]));
        solved.openings_m = (0..NODES).map(|k| positions.mean(|s| s.openings_m[h][k])).collect();
        halves.push(solved);
    }
    let halves = [halves.remove(0), halves.remove(0)];
    let [pinion, gear] = Body::BOTH.map(|body| shaft_state(shafts, body, positions));
    let balance_error = balance_error(shafts, &halves, [&pinion, &gear]);
    let between_couplings_m = positions.curve(|s| s.approach_m);
    let pinion_float_m = positions.curve(|s| s.shafts[0].apex[2]);
    // The curves of either half, with the bodies held in their mean shape where special states are solved.
    let mut cycles = Vec::with_capacity(2);
    for half in Half::BOTH {
        let h = half.index();
        let lead = if half == Half::Left { 0.0 } else { stagger };
        let field = displacement_field(shafts, &halves[h]);
        let mut contact = HalfContact::displaced(pair, half, compliance, settings, &field, watch);
        let mut own: Vec<(f64, f64, LoadedPosition)> = states
            .iter()
            .map(|(phase, state)| {
                let state = &state.halves[h];
                ((phase + lead).fract(), state.forces_n.iter().sum::<f64>() * cos, state.clone())
            })
            .collect();
        let builder = match positions.resampled {
            None => CycleBuilder::at_positions(pair, slices, own),
            Some((from, error)) => {
                own.sort_by(|a, b| a.0.total_cmp(&b.0));
                CycleBuilder::resampled(pair, slices, own, ((from + lead).fract(), error))
            }
        };
        // A half that the other one relieves of all load is looked at under a small one.
        let mean_n = halves[h].normal_force_n[0].max(LEAST_PART * of_both) * cos;
        cycles.push(builder.finish(&mut contact, &|_| mean_n)?);
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
        line_length_m: 0.5 * all,
        line_load_n_per_m: of_both / all,
        open_fraction: (of_left[1] + of_right[1]) / all,
        balance_error,
        halves,
        shafts: [pinion, gear],
    })
}

/// The openings of a half between its bodies, relative to the mid-face sections at the pitch point, mean over the
/// period.
fn displacement_field(shafts: &ContactShafts, half: &HalfOnShafts) -> DisplacementField {
    let mut openings_m = [0.0; NODES];
    openings_m.iter_mut().zip(&half.openings_m).for_each(|(o, mean)| *o = *mean);
    shafts.field(openings_m)
}

/// Mesh of a half as a spring in the equations of motion of the rotor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshSection {
    /// Section at which approach and tilt of the loaded teeth do not couple, from the apex plane along the shafts.
    pub position_m: f64,
    /// Mean force by approach of that section, along the flank normal, N/m.
    pub stiffness_n_per_m: f64,
    /// Moment by relative tilt of the sections, N m/rad.
    pub tilting_nm_per_rad: f64,
    /// Moment of the working load about that section less what the tilting stiffness takes of it, N m.
    pub tilting_moment_nm: f64,
}

impl HalfOnShafts {
    /// Distance from mid-face, towards the mesh-in end, of the section at which approach and tilt of the loaded teeth
    /// do not couple.
    fn uncoupled_arm_m(&self) -> f64 {
        let [stiffness, coupled, _] = self.tooth_stiffness;
        if stiffness > 0.0 { coupled / stiffness } else { 0.0 }
    }
}

impl LoadedContactOnShafts {
    /// The mesh of a half about its mean loaded state.
    pub fn mesh_section(&self, shafts: &ContactShafts, half: Half) -> MeshSection {
        let own = &self.halves[half.index()];
        let [stiffness_n_per_m, coupled_n, by_tilt_nm] = own.tooth_stiffness;
        let middle_m = 0.5 * shafts.frame.width_m;
        let arm_m = own.uncoupled_arm_m();
        let position_m = shafts.frame.z_m(half, middle_m + arm_m);
        let tilting_nm_per_rad = (by_tilt_nm - arm_m * coupled_n).max(0.0);
        // Closing by tilt per distance along z: (e_z × n) · (φ_p − φ_g).
        let n = shafts.frame.load(Body::Pinion, half, 0.0);
        let tilt = |state: &ShaftState| {
            let section = &state.mid_faces[half.index()];
            n[0] * section[4] - n[1] * section[3]
        };
        let tilt_rad = tilt(&self.shafts[0]) - tilt(&self.shafts[1]);
        let moment_nm = own.normal_force_n[0] * (own.centroid_z_m - position_m);
        MeshSection {
            position_m,
            stiffness_n_per_m,
            tilting_nm_per_rad,
            tilting_moment_nm: moment_nm - tilting_nm_per_rad * tilt_rad,
        }
    }

    /// The openings between the bodies of a half relative to those of its [`MeshSection`], for
    /// [`HalfContact::displaced`].
    pub fn field_about_mesh_section(&self, shafts: &ContactShafts, half: Half) -> DisplacementField {
        let own = &self.halves[half.index()];
        let arm_m = own.uncoupled_arm_m();
        let mut field = displacement_field(shafts, own);
        let at_section_m = field.at(0.5 * shafts.frame.width_m + arm_m, shafts.frame.pitch_point_m);
        field.opening_m.iter_mut().for_each(|opening| *opening -= at_section_m);
        field
    }

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
    positions: &[(f64, &LoadedPosition)],
    slices: usize,
    lengths: &mut [f64; 2],
) -> HalfOnShafts {
    let (width_m, cos) = (pair.spec.face_width_m, pair.base_helix_angle_rad.cos());
    let pieces = ((width_m / PIECE_M).round() as usize).max(1);
    let mut strips = Strips::new(width_m, slices);
    let mut of_pieces = Strips::new(width_m, pieces);
    let sliver_m = 0.5 * width_m / slices as f64;
    let (mut largest_n, mut least_n) = (f64::NEG_INFINITY, f64::INFINITY);
    let (mut sum, mut moment, mut peaks) = (0.0, 0.0, 0.0);
    for &(weight, position) in positions {
        let whole = position.forces_n.iter().sum::<f64>();
        (largest_n, least_n) = (largest_n.max(whole), least_n.min(whole));
        sum += weight * whole;
        let mut peak = 0.0f64;
        let mut rest = position.forces_n.as_slice();
        for line in position.points.chunk_by(|a, b| a.pair == b.pair) {
            let (forces, others) = rest.split_at(line.len());
            rest = others;
            for (i, (p, &f)) in line.iter().zip(forces).enumerate() {
                // entry_m is its own inverse.
                let from_inner_m = pair.entry_m(p.entry_m);
                let on_path = p.zone == 1;
                let length_m = if on_path { weight * p.width_m / cos } else { 0.0 };
                lengths[0] += length_m;
                if on_path && p.width_m >= sliver_m {
                    peak = peak.max(f * cos / p.width_m);
                }
                moment += weight * f * from_inner_m;
                let range = (from_inner_m - 0.5 * p.width_m, from_inner_m + 0.5 * p.width_m);
                let load = SegmentLoad::new(line, forces, i, pair);
                lengths[1] += length_m * (1.0 - load.loaded_part(p.width_m));
                for strips in [&mut strips, &mut of_pieces] {
                    strips.add_length(range, length_m);
                    strips.add_force(&load, weight);
                }
            }
        }
        peaks += weight * peak;
    }
    let mean_n_per_m = sum / lengths[0];
    // Without load every ratio to it is that of an even one.
    let over = |value: f64, mean: f64, even: f64| if sum > 0.0 { value / mean } else { even };
    let line_load_n_per_m = strips.line_loads();
    // A parabola through the middles of the three strips at the end; a load that vanishes there stays zero.
    let beyond = |strips: &mut dyn Iterator<Item = &f64>| match strips.take(3).collect::<Vec<_>>()[..] {
        [end, next, third] if *end > 0.0 => (1.875 * end - 1.25 * next + 0.375 * third).max(0.0),
        [end, ..] => *end,
        [] => 0.0,
    };
    let ends_n_per_m = [beyond(&mut line_load_n_per_m.iter()), beyond(&mut line_load_n_per_m.iter().rev())];
    let centroid_from_inner_m = over(moment, sum, 0.5 * width_m);
    HalfOnShafts {
        normal_force_n: [sum, largest_n - least_n],
        share: 0.0,
        axial_force_on_pinion_n: -shafts.frame.axial[half.index()] * sum,
        face: FaceLoad {
            strip_m: strips.middles_m(),
            ends_n_per_m,
            piece_m: of_pieces.middles_m(),
            piece_line_load_n_per_m: of_pieces.line_loads(),
            mean_n_per_m,
            line_load_n_per_m,
        },
        peak_over_mean: over(peaks, mean_n_per_m, 1.0),
        centroid_from_inner_m,
        centroid_z_m: shafts.frame.z_m(half, pair.entry_m(centroid_from_inner_m)),
        tooth_stiffness: [0.0; 3],
        openings_m: vec![0.0; NODES],
    }
}

/// Load of a segment of a contact line, linear over the part of the face that it loads.
///
/// The slope is that between the neighbours; a segment next to one without load, whose linear load would fall below
/// zero, carries a triangle on a part of its width.
struct SegmentLoad {
    range_m: (f64, f64),
    /// Force per width in the middle of the range, and its slope.
    middle_n_per_m: f64,
    slope_n_per_m2: f64,
}

impl SegmentLoad {
    /// Of point `i` of `line`, along the distance from the inner end.
    fn new(line: &[ContactPoint], forces_n: &[f64], i: usize, pair: &Pair) -> SegmentLoad {
        let place = |i: usize| pair.entry_m(line[i].entry_m);
        let load = |i: usize| forces_n[i] / line[i].width_m;
        let (at_m, width_m, own) = (place(i), line[i].width_m, load(i));
        let even = SegmentLoad {
            range_m: (at_m - 0.5 * width_m, at_m + 0.5 * width_m),
            middle_n_per_m: own,
            slope_n_per_m2: 0.0,
        };
        if own <= 0.0 {
            return even;
        }
        // Neighbours on the same part of the path that touch this segment.
        let beside = |j: Option<usize>| {
            j.filter(|&j| j < line.len() && line[j].zone == line[i].zone)
                .filter(|&j| (place(j) - at_m).abs() < 0.51 * (line[j].width_m + width_m))
        };
        let slope = |a: usize, b: usize| (load(b) - load(a)) / (place(b) - place(a));
        let loaded = |j: &usize| forces_n[*j] > 0.0;
        let (before, after) = (beside(i.checked_sub(1)), beside(Some(i + 1)));
        let at_border = [before, after].iter().flatten().any(|j| !loaded(j));
        let slope_n_per_m2 = match (before.filter(loaded), after.filter(loaded)) {
            (Some(before), Some(after)) => slope(before, after),
            (Some(j), None) | (None, Some(j)) => slope(j, i),
            (None, None) => return even,
        };
        let steepest = 2.0 * own / width_m;
        if slope_n_per_m2.abs() <= steepest {
            return SegmentLoad { slope_n_per_m2, ..even };
        }
        if !at_border {
            return SegmentLoad { slope_n_per_m2: steepest.copysign(slope_n_per_m2), ..even };
        }
        // A triangle of this slope with the whole force, at the end where the load is higher.
        let loaded_m = (2.0 * own * width_m / slope_n_per_m2.abs()).sqrt().min(width_m);
        let (low, high) = even.range_m;
        let range_m = if slope_n_per_m2 > 0.0 { (high - loaded_m, high) } else { (low, low + loaded_m) };
        let middle_n_per_m = own * width_m / loaded_m;
        SegmentLoad {
            range_m,
            middle_n_per_m,
            slope_n_per_m2: (2.0 * middle_n_per_m / loaded_m).copysign(slope_n_per_m2),
        }
    }

    /// Part of a segment of this width that is loaded.
    fn loaded_part(&self, width_m: f64) -> f64 {
        if self.middle_n_per_m > 0.0 { ((self.range_m.1 - self.range_m.0) / width_m).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Force between two places of the range.
    fn between_n(&self, low: f64, high: f64) -> f64 {
        let middle_m = 0.5 * (self.range_m.0 + self.range_m.1);
        (high - low) * (self.middle_n_per_m + self.slope_n_per_m2 * (0.5 * (low + high) - middle_m))
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

    /// Adds what a function that integrates to `of(from, to)` has within every strip between `from` and `to`.
    fn add(values: &mut [f64], width_m: f64, (from, to): (f64, f64), of: impl Fn(f64, f64) -> f64) {
        let last = values.len() - 1;
        let strip = |place: f64| ((place / width_m).max(0.0) as usize).min(last);
        // An end on the border of two strips belongs to the one between it and the other end.
        let (first, end) = (strip(from + 1e-9 * width_m), strip(to - 1e-9 * width_m));
        for (i, value) in values.iter_mut().enumerate().take(end.max(first) + 1).skip(first) {
            let low = if i == first { from } else { i as f64 * width_m };
            let high = if i >= end { to } else { (i + 1) as f64 * width_m };
            *value += of(low, high);
        }
    }

    /// Adds a length that is spread evenly over a range of the face.
    fn add_length(&mut self, (from, to): (f64, f64), length_m: f64) {
        let per_width = if to > from { length_m / (to - from) } else { 0.0 };
        Self::add(&mut self.length_m, self.width_m, (from, to), |low, high| per_width * (high - low));
    }

    fn add_force(&mut self, load: &SegmentLoad, weight: f64) {
        Self::add(&mut self.force_n, self.width_m, load.range_m, |low, high| weight * load.between_n(low, high));
    }

    fn middles_m(&self) -> Vec<f64> {
        (0..self.force_n.len()).map(|i| (i as f64 + 0.5) * self.width_m).collect()
    }

    fn line_loads(&self) -> Vec<f64> {
        self.force_n.iter().zip(&self.length_m).map(|(f, l)| if *l > 0.0 { f / l } else { 0.0 }).collect()
    }
}

fn shaft_state(shafts: &ContactShafts, body: Body, positions: &Positions) -> ShaftState {
    let mean = |of: &dyn Fn(&SectionDisplacements) -> Section| -> Section {
        std::array::from_fn(|c| positions.mean(|s| of(&s.shafts[body as usize])[c]))
    };
    let shaft = match body {
        Body::Pinion => &shafts.train.pinion,
        Body::Gear => &shafts.train.gear,
    };
    let shape_at_m = shafts.shape_m()[body as usize].to_vec();
    ShaftState {
        face_ends: (0..4).map(|i| mean(&|s| s.face_ends[i])).collect(),
        mid_faces: (0..2).map(|i| mean(&|s| s.mid_faces[i])).collect(),
        apex: mean(&|s| s.apex),
        bearings: {
            let sections: Vec<Section> = (0..shaft.bearings.len()).map(|i| mean(&|s| s.bearings[i])).collect();
            shaft.bearing_reactions(&sections)
        },
        shape: (0..shape_at_m.len()).map(|i| mean(&|s| s.shape[i])).collect(),
        shape_at_m,
    }
}

/// Largest sum of the radial forces on a shaft, and of the axial ones where nothing but bearings holds it, over the
/// tooth force.
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
            && !matches!(
                (body, shafts.freedom),
                (Body::Pinion, AxialFreedom::Pinion) | (Body::Gear, AxialFreedom::Gear)
            );
        for (c, value) in sum.iter().enumerate() {
            if c < 2 || held_by_bearings {
                worst = worst.max(value.abs() / force);
            }
        }
    }
    worst
}
