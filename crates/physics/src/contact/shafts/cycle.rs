//! One mesh period of both halves on elastic shafts.

use serde::{Deserialize, Serialize};

use super::face_load::{HalfOnShafts, half_on_shafts};
use super::flexibility::{AxialFreedom, ContactShafts, NODES, SectionDisplacements, StationLoads};
use super::frame::{Body, Section};
use super::mesh_section::displacement_field;
use super::position::{JointPosition, JointSolver};
use crate::compliance::{Compliance, Settings};
use crate::contact::ContactError;
use crate::contact::coast::backwards;
use crate::contact::cycle::{CURVE_POSITIONS, CycleBuilder};
use crate::contact::half::HalfContact;
use crate::contact::halves::{LEAST_PART, LoadedContact};
use crate::contact::position::LoadedPosition;
use crate::contact::refine::refine;
use crate::gear::{Half, Pair};
use crate::numerics::PeriodicMonotoneCubic;
use crate::watch::Watch;

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

/// Load of both halves on elastic shafts, mean over one mesh period of the left half.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadOnShafts {
    /// Left and right half.
    pub halves: [HalfOnShafts; 2],
    /// Mean length of the contact lines of a half.
    pub line_length_m: f64,
    /// Force of both halves over the length of the contact lines of both.
    pub line_load_n_per_m: f64,
    /// Part of the length of the contact lines without load.
    pub open_fraction: f64,
    /// Axial shift of the pinion at the apex plane, positive to the right.
    pub pinion_float_m: f64,
}

/// Loaded contact of both halves on elastic shafts over one mesh period of the left half.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadedContactOnShafts {
    /// Mean loads.
    pub load: LoadOnShafts,
    /// Curves of both halves. Approach (transmission error): between the mid-face sections; stiffness: of the teeth
    /// with the bodies held in their displaced shape.
    pub contact: LoadedContact,
    /// Base-tangent displacement between the couplings at every position: wind-up and bending included.
    pub between_couplings_m: Vec<f64>,
    /// Axial shift of the pinion at the apex plane at every position, positive to the right.
    pub pinion_float_m: Vec<f64>,
    /// Pinion and gear.
    pub shafts: [ShaftState; 2],
    /// Largest difference of the sum of the tooth and bearing forces on either shaft from zero (radial, and axial where
    /// a bearing holds), over the tooth force.
    pub balance_error: f64,
}

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
    let stagger = half_stagger - half_stagger.floor();
    if !coast {
        let loads = (torque_nm, stagger, axial_n);
        let positions = solve_positions(0.0, pair, shafts, loads, (compliance, settings), watch)?;
        return report(pair, shafts, &positions, stagger, (compliance, settings), watch);
    }
    let (reversed, opposite) = (pair.coast(), (-half_stagger).rem_euclid(1.0));
    let loads = (torque_nm, opposite, axial_n);
    let positions = solve_positions(pair.coast_phase(0.0), &reversed, shafts, loads, (compliance, settings), watch)?;
    let mut solved = report(&reversed, shafts, &positions, opposite, (compliance, settings), watch)?;
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

/// The loads of [`solve_on_shafts`] alone.
///
/// # Errors
/// [`ContactError`].
pub fn load_on_shafts(
    pair: &Pair,
    shafts: &ContactShafts,
    (torque_nm, half_stagger, axial_n): (f64, f64, f64),
    coast: bool,
    (compliance, settings): (&Compliance, &Settings),
    watch: Watch<'_>,
) -> Result<LoadOnShafts, ContactError> {
    let reversed;
    let (from, pair, lead) = if coast {
        reversed = pair.coast();
        (pair.coast_phase(0.0), &reversed, -half_stagger)
    } else {
        (0.0, pair, half_stagger)
    };
    let loads = (torque_nm, lead.rem_euclid(1.0), axial_n);
    let positions = solve_positions(from, pair, shafts, loads, (compliance, settings), watch)?;
    Ok(mean_load(pair, shafts, &positions, compliance.slices()))
}

/// Solves the positions over a mesh period from the phase `from` on; `stagger` is in [0, 1).
fn solve_positions(
    from: f64,
    pair: &Pair,
    shafts: &ContactShafts,
    (torque_nm, stagger, axial_n): (f64, f64, f64),
    (compliance, settings): (&Compliance, &Settings),
    watch: Watch<'_>,
) -> Result<Positions, ContactError> {
    if !(torque_nm > 0.0 && torque_nm.is_finite()) {
        return Err(ContactError::Torque { torque_nm });
    }
    if let Some(positions) = settings.positions.filter(|&n| n < 2) {
        return Err(ContactError::Positions { positions });
    }
    let force_bt_n = torque_nm / pair.pinion.base_radius_m;
    let mut solver = JointSolver::new(pair, shafts, compliance, settings, watch);
    let mut solve = |phase: f64, near: Option<&JointPosition>| {
        if let Some(state) = near {
            solver.start_from(state);
        }
        // Σ n_z f of the forces on the gear is the opposite of the axial force on the pinion.
        solver.solve([phase, (phase + stagger).fract()], force_bt_n, axial_n)
    };
    Ok(match settings.positions {
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
    })
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
    let states = &positions.states;
    let slices = compliance.slices();
    let cos = pair.base_helix_angle_rad.cos();
    let load = mean_load(pair, shafts, positions, slices);
    let halves = &load.halves;
    let of_both: f64 = halves.iter().map(|half| half.normal_force_n[0]).sum();
    let [pinion, gear] = shaft_states(shafts, positions);
    let balance_error = balance_error(shafts, halves, [&pinion, &gear]);
    let between_couplings_m = positions.curve(|s| s.approach_m);
    let pinion_float_m = positions.curve(|s| s.apex_m);
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
    Ok(LoadedContactOnShafts {
        load,
        contact,
        between_couplings_m,
        pinion_float_m,
        balance_error,
        shafts: [pinion, gear],
    })
}

fn mean_load(pair: &Pair, shafts: &ContactShafts, positions: &Positions, slices: usize) -> LoadOnShafts {
    let (states, weights) = (&positions.states, positions.weights());
    let of_both = positions.mean(|s| s.halves.iter().flat_map(|half| &half.forces_n).sum::<f64>());
    let mut lengths = [[0.0; 2]; 2];
    let halves = Half::BOTH.map(|half| {
        let h = half.index();
        let loaded: Vec<(f64, &LoadedPosition)> =
            weights.iter().zip(states).map(|(w, (_, s))| (*w, &s.halves[h])).collect();
        let mut solved = half_on_shafts(pair, half, shafts, &loaded, slices, &mut lengths[h]);
        solved.share = solved.normal_force_n[0] / of_both;
        solved.tooth_stiffness = std::array::from_fn(|c| positions.mean(|s| s.tilting[h][c]));
        solved.openings_m = (0..NODES).map(|k| positions.mean(|s| s.openings_m[h][k])).collect();
        solved
    });
    let [of_left, of_right] = lengths;
    let all = of_left[0] + of_right[0];
    LoadOnShafts {
        halves,
        line_length_m: 0.5 * all,
        line_load_n_per_m: of_both / all,
        open_fraction: (of_left[1] + of_right[1]) / all,
        pinion_float_m: positions.mean(|s| s.apex_m),
    }
}

/// Pinion and gear under the mean loads: displacements are linear in them.
fn shaft_states(shafts: &ContactShafts, positions: &Positions) -> [ShaftState; 2] {
    let mean_loads: StationLoads = [0, 1].map(|h| {
        let stations = positions.states.first().map_or(0, |(_, state)| state.loads[h].len());
        (0..stations).map(|j| [0, 1].map(|c| positions.mean(|s| s.loads[h][j][c]))).collect()
    });
    let [pinion, gear] = shafts.displacements(&mean_loads, positions.mean(|s| s.float_m));
    [shaft_state(shafts, Body::Pinion, pinion), shaft_state(shafts, Body::Gear, gear)]
}

fn shaft_state(shafts: &ContactShafts, body: Body, displaced: SectionDisplacements) -> ShaftState {
    let shaft = match body {
        Body::Pinion => &shafts.train.pinion,
        Body::Gear => &shafts.train.gear,
    };
    ShaftState {
        face_ends: displaced.face_ends.to_vec(),
        mid_faces: displaced.mid_faces.to_vec(),
        apex: displaced.apex,
        bearings: shaft.bearing_reactions(&displaced.bearings),
        shape_at_m: shafts.shape_m()[body as usize].to_vec(),
        shape: displaced.shape,
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
