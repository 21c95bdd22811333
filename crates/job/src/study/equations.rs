//! The numbers of the twelve equations, from the document and the results of the earlier stages.

use super::bounds::backlash_um;
use super::prepare::Prepared;
use crate::document::{ActsOn, GivenStiffness, JobDocument, Plane};
use crate::result::SpringValue;
use herringbone_physics::dynamics::{
    ContactForce, Couplings, HalfParameters, Harmonic, ImpactActsOn, ImpactExcitation, Parameters, Spring,
};
use herringbone_physics::dynamics::{Stiffness, equivalent_mass_kg, mesh_damping_n_s_per_m};
use std::sync::Arc;

/// The plane in which the equations are written: radii of both gears and helix angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MotionPlane {
    pub pinion_radius_m: f64,
    pub gear_radius_m: f64,
    pub helix_angle_rad: f64,
    /// Stiffness along s over stiffness along the transverse base tangent: equal torsional stiffness in both planes.
    pub stiffness_factor: f64,
    /// Force on the torsional equations over force along the transverse base tangent: equal moment in both planes.
    pub force_factor: f64,
}

impl MotionPlane {
    /// Base plane: base radii and β_b, k_m = k_bt / cos²β_b. Pitch plane: working pitch radii and helix angle there,
    /// with k_m R² cos²β equal to k_bt r_b² (physics of the mesh unchanged, only written elsewhere).
    pub(crate) fn new(plane: Plane, prepared: &Prepared) -> Self {
        let pair = &prepared.pair;
        let base = [pair.pinion.base_radius_m, pair.gear.base_radius_m];
        match plane {
            Plane::Base => Self {
                pinion_radius_m: base[0],
                gear_radius_m: base[1],
                helix_angle_rad: pair.base_helix_angle_rad,
                stiffness_factor: pair.base_helix_angle_rad.cos().powi(-2),
                force_factor: 1.0,
            },
            Plane::Pitch => {
                let working_cos = pair.working_pressure_angle_rad.cos();
                let helix_angle_rad = (pair.base_helix_angle_rad.tan() / working_cos).atan();
                Self {
                    pinion_radius_m: base[0] / working_cos,
                    gear_radius_m: base[1] / working_cos,
                    helix_angle_rad,
                    stiffness_factor: (working_cos / helix_angle_rad.cos()).powi(2),
                    force_factor: working_cos,
                }
            }
        }
    }
}

/// A given stiffness, unchanged: it refers to s of the plane in use.
pub(super) fn given_stiffness(given: &GivenStiffness) -> Stiffness {
    match given {
        GivenStiffness::Harmonics { mean_n_per_um, harmonics } => Stiffness::Fourier {
            mean_n_per_m: mean_n_per_um * 1e6,
            harmonics: harmonics.iter().map(|h| Harmonic { amplitude: h.amplitude, phase_rad: h.phase_rad }).collect(),
        },
        GivenStiffness::Samples { samples_n_per_um } => {
            Stiffness::Samples { values_n_per_m: samples_n_per_um.iter().map(|k| k * 1e6).collect() }
        }
    }
}

/// The same parameters with the mesh forces of the loaded contact (left, right) in place of the stiffness.
///
/// The mesh damper then has the damping ratio along the transverse direction of the mesh, c = 2 ζ √(k m_e) there with k
/// the mean tangent stiffness at the working load, so that ζ is the damping ratio of the two bodies turning on their
/// mesh: along s that is 1/cosβ times the source's c_m.
///
/// A damping that the document gives stays as it is.
pub(super) fn with_contact_forces(
    document: &JobDocument,
    mut parameters: Parameters,
    forces: &[Arc<ContactForce>; 2],
) -> Parameters {
    let cos = parameters.helix_angle_rad.cos();
    for (half, force) in parameters.halves.iter_mut().zip(forces) {
        half.contact_force = Some(force.clone());
        if document.model.mesh_damping_ns_per_m.is_none() {
            half.mesh_damping_n_s_per_m /= cos;
        }
    }
    parameters
}

/// Assembles the parameters. `stiffness` (along s) and `impact` are those of the left and the right half; the
/// excitations of the right half come `right_lead_mesh_periods` earlier than written (stagger).
pub(super) fn parameters(
    document: &JobDocument,
    prepared: &Prepared,
    plane: &MotionPlane,
    stiffness: [Stiffness; 2],
    impact: [Option<ImpactExcitation>; 2],
    right_lead_mesh_periods: f64,
) -> Parameters {
    let supports = &prepared.supports;
    let zeta = document.design.supports.damping_ratio;
    let [pinion_mass_kg, gear_mass_kg] = prepared.mass_kg.map(|mass| mass / 2.0);
    let [pinion_inertia_kg_m2, gear_inertia_kg_m2] = prepared.inertia_kg_m2.map(|inertia| inertia / 2.0);
    let spring = |n_per_um: &SpringValue, mass| Spring::with_damping_ratio(n_per_um.value * 1e6, zeta, mass);
    let torsion = |nm_per_rad: &SpringValue, inertia| Spring::with_damping_ratio(nm_per_rad.value, zeta, inertia);
    let m_e = equivalent_mass_kg(plane.pinion_radius_m, pinion_inertia_kg_m2, plane.gear_radius_m, gear_inertia_kg_m2);
    let excitation = |amplitude_um: f64| match amplitude_um {
        0.0 => Vec::new(),
        _ => vec![Harmonic { amplitude: amplitude_um * 1e-6, phase_rad: 0.0 }],
    };
    let [left_excitation, right_excitation] =
        document.model.excitation_um.map_or([0.0; 2], |excitation| [excitation.left, excitation.right]).map(excitation);
    let half = |stiffness: Stiffness, impact: Option<ImpactExcitation>, phase_shift_mesh_periods: f64| HalfParameters {
        pinion_mass_kg,
        pinion_inertia_kg_m2,
        gear_mass_kg,
        gear_inertia_kg_m2,
        pinion_torque_nm: document.operation.pinion_torque_nm / 2.0,
        pinion_lateral: spring(&supports.pinion_lateral_n_per_um, pinion_mass_kg),
        gear_lateral: spring(&supports.gear_lateral_n_per_um, gear_mass_kg),
        pinion_axial: Spring::default(),
        gear_axial: spring(&supports.gear_axial_n_per_um, gear_mass_kg),
        mesh_damping_n_s_per_m: document.model.mesh_damping_ns_per_m.unwrap_or_else(|| {
            mesh_damping_n_s_per_m(document.model.mesh_damping_ratio, stiffness.mean_n_per_m(), m_e)
        }),
        mesh_stiffness: stiffness,
        contact_force: None,
        impact,
        displacement_excitation: Vec::new(),
        phase_shift_mesh_periods,
    };
    let [left_stiffness, right_stiffness] = stiffness;
    let [left_impact, right_impact] = impact;
    let mut parameters = Parameters {
        mesh_frequency_hz: prepared.mesh_frequency_hz,
        pinion_radius_m: plane.pinion_radius_m,
        gear_radius_m: plane.gear_radius_m,
        helix_angle_rad: plane.helix_angle_rad,
        half_backlash_m: backlash_um(document) * 0.5e-6,
        damping_in_gap: document.model.damping_in_gap,
        impact_acts_on: match document.model.impact.acts_on() {
            ActsOn::Torsion => ImpactActsOn::Torsion,
            ActsOn::All => ImpactActsOn::All,
        },
        halves: [
            HalfParameters { displacement_excitation: left_excitation, ..half(left_stiffness, left_impact, 0.0) },
            HalfParameters {
                displacement_excitation: right_excitation,
                ..half(right_stiffness, right_impact, -right_lead_mesh_periods)
            },
        ],
        couplings: Couplings {
            pinion_axial: spring(&supports.pinion_halves_axial_n_per_um, pinion_mass_kg),
            gear_axial: spring(&supports.gear_halves_axial_n_per_um, gear_mass_kg),
            pinion_lateral: spring(&supports.pinion_halves_lateral_n_per_um, pinion_mass_kg),
            gear_lateral: spring(&supports.gear_halves_lateral_n_per_um, gear_mass_kg),
            pinion_torsion: torsion(&supports.pinion_halves_torsional_nm_per_rad, pinion_inertia_kg_m2),
            gear_torsion: torsion(&supports.gear_halves_torsional_nm_per_rad, gear_inertia_kg_m2),
        },
        train: None,
    };
    parameters.balance_axially();
    parameters
}
