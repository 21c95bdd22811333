//! The geared rotor of a document with shafts: its reduction, its place in the equations of motion, its results.

use super::hash::rotor_hash;
use super::mesh::{MeshMemo, MeshStage};
use super::prepare::Prepared;
use super::shaft_contact::{MountedTrain, shafts_failed};
use super::{SolveContext, SolveError, Stage};
use crate::document::JobDocument;
use crate::result::{
    BearingForceResult, BearingForces, DirectionForce, ForceOrders, MidFaceShape, NaturalMode, PerHalf, ResponseResult,
    RotorMode, RotorResult, ShaftShape, ShapeAlongShafts, ToothForceOrders,
};
use crate::warning::Warning;
use herringbone_physics::dynamics::{ModalTrain, Parameters, equivalent_mass_kg, mesh_damping_n_s_per_m};
use herringbone_physics::gear::{Half, MemberId, Pair};
use herringbone_physics::response::{MeshOrder, OutputResponse, Response};
use herringbone_physics::shafts::{
    GearedRotor, MeshElement, ReducedRotor, ReductionSettings, RotationSense, Shaft, ShaftError,
};
use herringbone_physics::watch::Watch;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// The rotor of a point, reduced for the motion at its speed.
#[derive(Debug)]
pub(super) struct Rotor {
    full: GearedRotor,
    reduced: ReducedRotor,
    meshes: [MeshElement; 2],
    up_to_hz: f64,
}

/// The rotor at the speed of a point.
#[derive(Debug, Clone)]
pub(super) struct TurningRotor {
    rotor: Arc<Rotor>,
    /// Speed of the pinion about z.
    speed_rad_s: f64,
}

/// Mesh orders that the reduction has to carry.
const ORDERS: f64 = 8.0;
/// Ends of the frequency range of a reduction: powers of two times this, so that neighbouring speeds share one.
const LEAST_RANGE_HZ: f64 = 2000.0;
const LARGEST_RANGE_HZ: f64 = 16_000.0;
/// The finest accuracy that is asked of a reduction.
const FINEST: f64 = 1e-3;
/// Coordinates of the equations of motion at most.
const MOST_COORDINATES: usize = 96;

fn failed(error: ShaftError) -> SolveError {
    shafts_failed(Stage::Response, error)
}

/// The reduced rotor of a point, from the job's memo or computed.
///
/// # Errors
/// [`SolveError`] if the train has no rotor.
pub(super) fn find(
    document: &JobDocument,
    prepared: &Prepared,
    mounted: &MountedTrain,
    mesh: &MeshStage,
    (context, memo): (&SolveContext, &MeshMemo),
) -> Result<TurningRotor, SolveError> {
    let speed_rad_s = mounted.sense * prepared.pinion_speed_rad_s;
    let pair = &prepared.pair;
    let meshes = Half::BOTH.map(|half| mesh_element(document, pair, mounted, mesh, half));
    let mut up_to_hz = LEAST_RANGE_HZ;
    while up_to_hz < (ORDERS * prepared.mesh_frequency_hz).min(LARGEST_RANGE_HZ) {
        up_to_hz *= 2.0;
    }
    let accuracy = document.analysis.accuracy.max(FINEST);
    let numbers = meshes
        .map(|m| [m.stiffness_n_per_m, m.damping_n_s_per_m, m.position_m, m.tilting_nm_per_rad, m.tilting_moment_nm]);
    let coast = document.operation.pinion_torque_nm < 0.0;
    let key = rotor_hash(&(&pair.spec, mounted, numbers, coast, up_to_hz, accuracy));
    if let Some(rotor) = memo.rotors.get(&key) {
        return Ok(TurningRotor { rotor, speed_rad_s });
    }
    let sense = if mounted.sense > 0.0 { RotationSense::Positive } else { RotationSense::Negative };
    let full = GearedRotor::new(&mounted.train, pair, sense, &meshes).map_err(failed)?;
    let settings =
        ReductionSettings { up_to_hz, accuracy, most_coordinates: MOST_COORDINATES, pinion_speed_rad_s: speed_rad_s };
    let reduced = full.reduce(&settings, Watch::new(&|_| {}, context.canceled)).map_err(failed)?;
    let rotor = Arc::new(Rotor { full, reduced, meshes, up_to_hz });
    memo.rotors.put(key, rotor.clone());
    Ok(TurningRotor { rotor, speed_rad_s })
}

/// The mesh of a half: with a loaded contact its mean tangent stiffness at the section where approach and tilt do not
/// couple, with its tilting stiffness; otherwise the mean stiffness at mid-face.
fn mesh_element(
    document: &JobDocument,
    pair: &Pair,
    mounted: &MountedTrain,
    mesh: &MeshStage,
    half: Half,
) -> MeshElement {
    let mean_n_per_m = mesh.stiffness[half.index()].mean_n_per_m();
    let coast = document.operation.pinion_torque_nm < 0.0;
    let element = MeshElement { on_coast_flanks: coast, ..MeshElement::at_mid_face(pair, half, mean_n_per_m, 0.0) };
    let element = match &mesh.on_shafts {
        None => element,
        Some(contact) => {
            let section = contact.loaded.mesh_section(&contact.shafts, half);
            MeshElement {
                position_m: section.position_m,
                tilting_nm_per_rad: section.tilting_nm_per_rad,
                // Of the contact positive where it closes the flanks that carry.
                tilting_moment_nm: if coast { -section.tilting_moment_nm } else { section.tilting_moment_nm },
                ..element
            }
        }
    };
    let damping_n_s_per_m = document.model.mesh_damping_ns_per_m.unwrap_or_else(|| {
        let [pinion, gear] =
            [&mounted.train.pinion, &mounted.train.gear].map(|shaft| half_inertia_kg_m2(shaft, pair, half));
        let [pinion_m, gear_m] = [pair.pinion.base_radius_m, pair.gear.base_radius_m];
        let mass_kg = equivalent_mass_kg(pinion_m, pinion, gear_m, gear);
        // The damping ratio is that of both bodies turning on their mesh, across the transverse base tangent.
        let factor = if mesh.forces.is_some() { 1.0 / pair.base_helix_angle_rad.cos() } else { 1.0 };
        factor * mesh_damping_n_s_per_m(document.model.mesh_damping_ratio, mean_n_per_m, mass_kg)
    });
    MeshElement { damping_n_s_per_m, ..element }
}

/// Polar moment of inertia of one half: the shaft over the face and the half's own body.
fn half_inertia_kg_m2(shaft: &Shaft, pair: &Pair, half: Half) -> f64 {
    let inner_m = 0.5 * pair.spec.gap_width_m;
    let face = match half {
        Half::Left => (-inner_m - pair.spec.face_width_m, -inner_m),
        Half::Right => (inner_m, inner_m + pair.spec.face_width_m),
    };
    let mut from = -shaft.gear_position_m;
    let mut sum = shaft.half_body.map_or(0.0, |body| body.polar_inertia_kg_m2);
    for segment in &shaft.segments {
        let to = from + segment.length_m;
        let within = (to.min(face.1) - from.max(face.0)).max(0.0);
        let polar_m4 = PI / 32.0 * (segment.diameter_m.powi(4) - segment.bore_m.powi(4));
        sum += shaft.material.density_kg_m3 * polar_m4 * within;
        from = to;
    }
    sum
}

/// Names of the channels of the bearing and coupling forces that a document's shafts have.
pub(super) fn channel_names(document: &JobDocument) -> Vec<String> {
    let Some(resolved) = document.design.resolved_shafts() else { return Vec::new() };
    let mut names = Vec::new();
    for (member, shaft) in [("pinion", &resolved.pinion), ("gear", &resolved.gear)] {
        for bearing in 1..=shaft.bearings.len() {
            names
                .extend(["f_x", "f_y", "f_z", "m_x", "m_y"].map(|force| format!("{force}_{member}_bearing_{bearing}")));
        }
        names.extend(["m_z", "f_z"].map(|force| format!("{force}_{member}_coupling")));
    }
    names
}

impl TurningRotor {
    /// The parameters of the twelve equations with the reduced rotor in place of masses, supports and couplings.
    pub(super) fn in_equations(&self, mut parameters: Parameters, document: &JobDocument) -> Parameters {
        for (half, mesh) in parameters.halves.iter_mut().zip(&self.rotor.meshes) {
            half.mesh_damping_n_s_per_m = mesh.damping_n_s_per_m;
        }
        let torque_nm = document.operation.pinion_torque_nm;
        parameters.train = Some(Arc::new(self.rotor.reduced.train(self.speed_rad_s, torque_nm)));
        parameters
    }

    /// The modes in the terms of the equations of motion: the twelve displacements of the mid-face sections.
    pub(super) fn natural_modes(&self, parameters: &Parameters) -> Vec<NaturalMode> {
        self.rotor.natural_modes(parameters)
    }

    /// Adds what the response says of bearings and modes. `whole`: with shapes.
    pub(super) fn complete(
        &self,
        document: &JobDocument,
        (parameters, response): (&Parameters, &Response),
        block: &mut ResponseResult,
        whole: bool,
    ) -> Result<(), SolveError> {
        let rotor = &self.rotor;
        block.natural_frequencies_hz = rotor.reduced.modes.natural_frequencies_hz();
        block.lowest_natural_frequency_hz = block.natural_frequencies_hz.iter().copied().find(|hz| *hz > 0.0);
        block.bearings = bearings(document, &response.outputs);
        block.largest_bearing_force_rms_n =
            block.bearings.iter().map(|bearing| bearing.force_n.rms_n()).reduce(f64::max);
        let orders = |orders: &[MeshOrder]| ForceOrders {
            amplitudes: orders.iter().map(|order| order.amplitude).collect(),
            phases_rad: orders.iter().map(|order| order.phase_rad).collect(),
        };
        block.tooth_force_orders_n = response
            .tooth_force_orders
            .as_ref()
            .map(|force| ToothForceOrders { left: orders(&force.left), right: orders(&force.right) });
        if whole {
            block.natural_modes = rotor.natural_modes(parameters);
            block.rotor = Some(rotor.result(document, parameters, self.speed_rad_s)?);
        }
        Ok(())
    }

    /// A warning where the reduction is not as accurate as the response is to be.
    pub(super) fn warning(&self, document: &JobDocument) -> Option<Warning> {
        self.rotor.warning(document)
    }
}

impl Rotor {
    /// The modes in the terms of the equations of motion: the twelve displacements of the mid-face sections.
    fn natural_modes(&self, parameters: &Parameters) -> Vec<NaturalMode> {
        let Some(train) = &parameters.train else { return Vec::new() };
        let modes = self.reduced.modes.modes.iter().enumerate().map(|(i, mode)| {
            let mut shape: Vec<f64> = train.displacements.iter().map(|row| row[i]).collect();
            for (c, value) in shape.iter_mut().enumerate().filter(|(c, _)| c % 3 == 2) {
                *value *= if c % 6 == 2 { parameters.pinion_radius_m } else { parameters.gear_radius_m };
            }
            let largest = shape.iter().fold(0.0f64, |m, v| if v.abs() > m.abs() { *v } else { m });
            let scale = if largest == 0.0 { 1.0 } else { largest };
            let mut strain_energy = self.strain_energy(i);
            strain_energy.insert("mesh_left".to_owned(), mode.strain.meshes[0]);
            strain_energy.insert("mesh_right".to_owned(), mode.strain.meshes[1]);
            NaturalMode {
                frequency_hz: mode.frequency_hz,
                name: name(mode),
                shape: shape.iter().map(|value| value / scale).collect(),
                modal_mass_kg: 1.0 / (scale * scale),
                damping_ratio: (mode.frequency_hz > 0.0).then(|| self.damping_ratio(i, train)),
                strain_energy: if mode.frequency_hz > 0.0 { strain_energy } else { BTreeMap::new() },
                kinetic_energy: kinetic_energy(mode),
            }
        });
        modes.collect()
    }

    /// Strain energy of everything but the meshes.
    fn strain_energy(&self, mode: usize) -> BTreeMap<String, f64> {
        let strain = &self.reduced.modes.modes[mode].strain;
        let mut shares = BTreeMap::new();
        for (member, word) in ["pinion", "gear"].into_iter().enumerate() {
            shares.insert(format!("{word}_shaft"), strain.shafts[member]);
            if strain.couplings[member] > 0.0 {
                shares.insert(format!("{word}_coupling"), strain.couplings[member]);
            }
            for (index, share) in strain.bearings[member].iter().enumerate() {
                shares.insert(format!("{word}_bearing_{index}"), *share);
            }
        }
        shares
    }

    /// Damping ratio of a mode by the diagonal of the damping matrix, the meshes' dampers included.
    fn damping_ratio(&self, mode: usize, train: &ModalTrain) -> f64 {
        let meshes: f64 =
            (0..2).map(|j| self.meshes[j].damping_n_s_per_m * train.mesh[j][mode] * train.mesh[j][mode]).sum();
        let omega = TAU * self.reduced.modes.modes[mode].frequency_hz;
        (train.damping_per_s[mode * train.len() + mode] + meshes) / (2.0 * omega)
    }

    fn result(
        &self,
        document: &JobDocument,
        parameters: &Parameters,
        speed_rad_s: f64,
    ) -> Result<RotorResult, SolveError> {
        let modes = &self.reduced.modes;
        let report = &self.reduced.report;
        let whirl_frequencies_hz = self.full.whirl_frequencies_hz(modes, speed_rad_s).map_err(failed)?;
        Ok(RotorResult {
            degrees_of_freedom: self.full.unknowns() as u32,
            coordinates: self.reduced.coordinates() as u32,
            modes_kept: report.modes as u32,
            static_corrections: report.residual_vectors as u32,
            highest_frequency_hz: self.up_to_hz,
            reduction_error: report.estimated_error,
            rigid_body_modes: modes.rigid_body_modes() as u32,
            mesh_stiffness_n_per_um: PerHalf {
                left: self.meshes[0].stiffness_n_per_m * 1e-6,
                right: self.meshes[1].stiffness_n_per_m * 1e-6,
            },
            whirl_frequencies_hz,
            modes: (modes.rigid_body_modes()..modes.modes.len())
                .take(MOST_SHAPES)
                .map(|i| self.mode(i, document, parameters))
                .collect(),
        })
    }

    fn mode(&self, i: usize, document: &JobDocument, parameters: &Parameters) -> RotorMode {
        let mode = &self.reduced.modes.modes[i];
        let [pinion_left, pinion_right, gear_left, gear_right] = mode.mid_face;
        let resolved = document.design.resolved_shafts();
        let position_mm = |member: usize| {
            resolved.as_ref().map_or(0.0, |shafts| [&shafts.pinion, &shafts.gear][member].gear_position_mm)
        };
        let along = |member: usize, radius_m: f64| {
            let id = [MemberId::Pinion, MemberId::Gear][member];
            let stations_m = self.full.stations_m(id);
            let step = stations_m.len().div_ceil(MOST_STATIONS).max(1);
            let last = stations_m.len().saturating_sub(1);
            let chosen: Vec<usize> = (0..=last).filter(|k| k % step == 0 || *k == last).collect();
            let of = |c: usize, factor: f64| chosen.iter().map(|&k| mode.shafts[member][k][c] * factor).collect();
            ShaftShape {
                station_mm: chosen.iter().map(|&k| stations_m[k] * 1e3 + position_mm(member)).collect(),
                x: of(0, 1.0),
                y: of(1, 1.0),
                z: of(2, 1.0),
                twist: of(5, radius_m),
            }
        };
        RotorMode {
            frequency_hz: mode.frequency_hz,
            name: name(mode),
            damping_ratio: parameters.train.as_ref().map_or(0.0, |train| self.damping_ratio(i, train)),
            strain_energy_mesh: PerHalf { left: mode.strain.meshes[0], right: mode.strain.meshes[1] },
            strain_energy_bearings: mode.strain.all_bearings(),
            strain_energy: self.strain_energy(i),
            kinetic_energy: kinetic_energy(mode),
            shape: MidFaceShape { pinion_left, pinion_right, gear_left, gear_right },
            along: ShapeAlongShafts {
                pinion: along(0, parameters.pinion_radius_m),
                gear: along(1, parameters.gear_radius_m),
            },
        }
    }

    fn warning(&self, document: &JobDocument) -> Option<Warning> {
        let error = self.reduced.report.estimated_error;
        (error > document.analysis.accuracy).then(|| Warning {
            code: "reduction-error".to_owned(),
            pointer: "/analysis/accuracy".to_owned(),
            detail: format!(
                "the {} coordinates of the shafts follow the full model of {} degrees of freedom to {error:.1e} of the mesh and bearing \
                 receptances up to {:.0} Hz; the accuracy asked for holds for their equations",
                self.reduced.coordinates(),
                self.full.unknowns(),
                self.up_to_hz
            ),
        })
    }
}

/// Modes with shapes in a result, and sections of a shape.
const MOST_SHAPES: usize = 40;
const MOST_STATIONS: usize = 60;

/// The name of a mode, after what holds most of its strain energy.
fn name(mode: &herringbone_physics::shafts::RotorMode) -> String {
    if mode.frequency_hz == 0.0 {
        return "rotation (free)".to_owned();
    }
    let strain = &mode.strain;
    let holders = [
        ("mesh", strain.meshes.iter().sum::<f64>()),
        ("pinion bearing", strain.bearings[0].iter().sum()),
        ("gear bearing", strain.bearings[1].iter().sum()),
        ("pinion shaft", strain.shafts[0]),
        ("gear shaft", strain.shafts[1]),
        ("coupling", strain.couplings.iter().sum()),
    ];
    let kinetic = &mode.kinetic;
    let motions = [("lateral", kinetic.lateral), ("axial", kinetic.axial), ("torsional", kinetic.torsion)];
    let largest = |shares: &[(&'static str, f64)]| {
        shares.iter().fold(("", f64::NEG_INFINITY), |most, one| if one.1 > most.1 { *one } else { most }).0
    };
    format!("{} {} mode", largest(&motions), largest(&holders))
}

fn kinetic_energy(mode: &herringbone_physics::shafts::RotorMode) -> BTreeMap<String, f64> {
    let kinetic = &mode.kinetic;
    let mut shares: BTreeMap<String, f64> = [
        ("lateral", kinetic.lateral),
        ("axial", kinetic.axial),
        ("torsion", kinetic.torsion),
        ("pinion_shaft", kinetic.pinion_shaft),
        ("gear_shaft", kinetic.gear_shaft),
    ]
    .map(|(kind, share)| (kind.to_owned(), share))
    .into();
    if kinetic.machines > 0.0 {
        shares.insert("machines".to_owned(), kinetic.machines);
    }
    shares
}

/// Forces of the bearings over the steady motion.
fn bearings(document: &JobDocument, outputs: &[OutputResponse]) -> Vec<BearingForceResult> {
    let Some(resolved) = document.design.resolved_shafts() else { return Vec::new() };
    let direction = |axis: &str, member: &str, number: usize| {
        let name = format!("f_{axis}_{member}_bearing_{number}");
        outputs.iter().find(|output| output.name == name).map_or_else(DirectionForce::default, |output| {
            DirectionForce {
                mean: output.mean,
                rms: output.rms,
                amplitudes: output.orders.iter().map(|order| order.amplitude).collect(),
                phases_rad: output.orders.iter().map(|order| order.phase_rad).collect(),
            }
        })
    };
    let mut forces = Vec::new();
    for (member, shaft) in [("pinion", &resolved.pinion), ("gear", &resolved.gear)] {
        for (index, bearing) in shaft.bearings.iter().enumerate() {
            let along = |axis| direction(axis, member, index + 1);
            forces.push(BearingForceResult {
                shaft: member.to_owned(),
                index: index as u32,
                position_mm: bearing.position_mm,
                force_n: BearingForces { x: along("x"), y: along("y"), z: along("z") },
            });
        }
    }
    forces
}
