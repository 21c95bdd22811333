//! Parameters of the equations of motion of a pair in its base plane, from its geometry and its loaded contact.

use crate::contact::{HalfCycle, LoadedContact, equivalent_stiffness};
use crate::dynamics::{
    Couplings, HalfParameters, ImpactActsOn, Parameters, Spring, Stiffness, equivalent_mass_kg, mesh_damping_n_s_per_m,
};
use crate::gear::Pair;

/// Operating point of a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperatingPoint {
    /// Angular speed of the pinion, rad/s, positive.
    pub pinion_speed_rad_s: f64,
    /// Torque on the pinion, both halves together, N m.
    pub pinion_torque_nm: f64,
}

/// Supports, couplings and damping of a pair whose pinion floats axially.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounting {
    /// Lateral stiffness of the support of each half, pinion and gear, N/m.
    pub lateral_n_per_m: [f64; 2],
    /// Axial stiffness of the support of each half of the gear, N/m.
    pub gear_axial_n_per_m: f64,
    /// Axial stiffness between the two halves, pinion and gear, N/m.
    pub halves_axial_n_per_m: [f64; 2],
    /// Damping ratio of all supports and couplings.
    pub damping_ratio: f64,
    /// Damping ratio of the mesh.
    pub mesh_damping_ratio: f64,
    /// Half of the normal backlash, m.
    pub half_backlash_m: f64,
}

/// Parameters of the equations of motion in the base plane, without impact and without stagger.
///
/// Each half has half of the mass and inertia of the gears. Its mesh stiffness along the tooth normal is that of
/// [`equivalent_stiffness`], which carries the loaded transmission error and the mean tangent stiffness of `contact`,
/// times 1/cos²β_b.
pub fn base_plane_parameters(
    pair: &Pair,
    contact: &LoadedContact,
    operation: &OperatingPoint,
    mounting: &Mounting,
) -> Parameters {
    let [pinion, gear] = [&pair.pinion, &pair.gear];
    let [pinion_mass_kg, gear_mass_kg] = [pinion, gear].map(|member| 0.5 * member.mass_kg());
    let [pinion_inertia_kg_m2, gear_inertia_kg_m2] = [pinion, gear].map(|member| 0.5 * member.inertia_kg_m2());
    let [pinion_radius_m, gear_radius_m] = [pinion, gear].map(|member| member.base_radius_m);
    let equivalent_kg = equivalent_mass_kg(pinion_radius_m, pinion_inertia_kg_m2, gear_radius_m, gear_inertia_kg_m2);
    let spring =
        |stiffness_n_per_m, mass_kg| Spring::with_damping_ratio(stiffness_n_per_m, mounting.damping_ratio, mass_kg);
    let half = |cycle: &HalfCycle| {
        let mesh_stiffness = normal_stiffness(cycle, pair.base_helix_angle_rad);
        HalfParameters {
            pinion_mass_kg,
            pinion_inertia_kg_m2,
            gear_mass_kg,
            gear_inertia_kg_m2,
            pinion_torque_nm: 0.5 * operation.pinion_torque_nm,
            pinion_lateral: spring(mounting.lateral_n_per_m[0], pinion_mass_kg),
            gear_lateral: spring(mounting.lateral_n_per_m[1], gear_mass_kg),
            pinion_axial: Spring::default(),
            gear_axial: spring(mounting.gear_axial_n_per_m, gear_mass_kg),
            mesh_damping_n_s_per_m: mesh_damping_n_s_per_m(
                mounting.mesh_damping_ratio,
                mesh_stiffness.mean_n_per_m(),
                equivalent_kg,
            ),
            mesh_stiffness,
            contact_force: None,
            impact: None,
            displacement_excitation: Vec::new(),
            phase_shift_mesh_periods: 0.0,
        }
    };
    Parameters {
        mesh_frequency_hz: operation.pinion_speed_rad_s / std::f64::consts::TAU * f64::from(pinion.teeth),
        pinion_radius_m,
        gear_radius_m,
        helix_angle_rad: pair.base_helix_angle_rad,
        half_backlash_m: mounting.half_backlash_m,
        damping_in_gap: true,
        impact_acts_on: ImpactActsOn::default(),
        halves: contact.halves.each_ref().map(half),
        couplings: Couplings {
            pinion_axial: spring(mounting.halves_axial_n_per_m[0], pinion_mass_kg),
            gear_axial: spring(mounting.halves_axial_n_per_m[1], gear_mass_kg),
            ..Couplings::default()
        },
        train: None,
    }
}

/// Stiffness of one half along the tooth normal over the mesh phase.
fn normal_stiffness(cycle: &HalfCycle, base_helix_angle_rad: f64) -> Stiffness {
    let force_n = cycle.force_bt_n.iter().sum::<f64>() / cycle.force_bt_n.len() as f64;
    let along_tangent = equivalent_stiffness(force_n, &cycle.transmission_error_m, cycle.stiffness.mean);
    let factor = base_helix_angle_rad.cos().powi(-2);
    Stiffness::Samples { values_n_per_m: along_tangent.into_iter().map(|k| k * factor).collect() }
}
