//! The reference cases, and the error of a state.

use std::collections::BTreeMap;

use herringbone_physics::dynamics::{
    Couplings, HalfParameters, Harmonic, ImpactActsOn, ImpactExcitation, Parameters, Spring, Stiffness,
    mesh_damping_n_s_per_m,
};
use serde::Deserialize;

/// Path of the reference data, from the crate's folder.
pub const REFERENCE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/dynamics_reference.json");

/// 12 displacements (m, rad), then 12 velocities; per half y_p, z_p, θ_p, y_g, z_g, θ_g; SI.
pub type PhysicalState = [f64; 24];

#[derive(Deserialize)]
struct Document {
    common: Common,
    cases: BTreeMap<String, Numbers>,
}

#[derive(Deserialize, Clone)]
pub struct Common {
    pub mean_stiffness_n_per_m: f64,
    pub phases_rad: Vec<f64>,
    pub impact_force_n: f64,
    pub impact_duration_mesh_periods: f64,
    pub pinion_inertia_kg_m2: f64,
    pub gear_inertia_kg_m2: f64,
    pub pinion_mass_kg: f64,
    pub gear_mass_kg: f64,
    pub lateral_n_per_m: f64,
    pub pinion_axial_coupling_n_per_m: f64,
    pub gear_axial_n_per_m: f64,
    pub gear_axial_coupling_n_per_m: f64,
    pub support_damping_ratio: f64,
    pub pinion_radius_m: f64,
    pub gear_radius_m: f64,
    pub helix_angle_deg: f64,
    pub equivalent_mass_kg: f64,
}

#[derive(Deserialize, Clone)]
pub struct Numbers {
    pub pinion_torque_per_half_nm: f64,
    pub half_backlash_m: f64,
    pub mesh_damping_ratio: f64,
    pub amplitudes: Vec<f64>,
    initial_state: Vec<f64>,
    states: BTreeMap<u64, Vec<f64>>,
}

/// One reference case.
#[derive(Clone)]
pub struct ReferenceCase {
    pub name: String,
    pub common: Common,
    pub numbers: Numbers,
    pub start: PhysicalState,
    states: BTreeMap<u64, PhysicalState>,
}

fn state(values: &[f64]) -> PhysicalState {
    values.try_into().expect("a state has 24 numbers")
}

/// Cases A, B and C.
pub fn all() -> Vec<ReferenceCase> {
    let text = std::fs::read_to_string(REFERENCE).expect("tests/data/dynamics_reference.json");
    let document: Document = serde_json::from_str(&text).expect("the reference has the known form");
    let of = |(name, numbers): (String, Numbers)| ReferenceCase {
        name,
        common: document.common.clone(),
        start: state(&numbers.initial_state),
        states: numbers.states.iter().map(|(periods, values)| (*periods, state(values))).collect(),
        numbers,
    };
    document.cases.into_iter().map(of).collect()
}

impl ReferenceCase {
    pub fn mesh_frequency_hz(&self) -> f64 {
        2000.0 / 60.0 * 17.0
    }

    pub fn mesh_damping_n_s_per_m(&self) -> f64 {
        let c = &self.common;
        mesh_damping_n_s_per_m(self.numbers.mesh_damping_ratio, c.mean_stiffness_n_per_m, c.equivalent_mass_kg)
    }

    /// Error after `periods` (1, 5, 20 …): the larger of the greatest difference among the displacements relative to
    /// the largest of the reference, and the same of the velocities. Of each half: y_p, z_p, y_g, z_g and x = y_p − y_g
    /// + R_p θ_p − R_g θ_g, by which alone the rotations act; rigid rotation is excluded.
    pub fn error(&self, periods: u64, found: &PhysicalState) -> f64 {
        let reference = &self.states[&periods];
        let (rp, rg) = (self.common.pinion_radius_m, self.common.gear_radius_m);
        let lengths = |q: &[f64]| [q[0], q[1], q[3], q[4], q[0] - q[3] + rp * q[2] - rg * q[5]];
        let mut worst = 0.0f64;
        for kind in [0, 12] {
            let (mut difference, mut largest) = (0.0f64, 0.0f64);
            for half in [kind, kind + 6] {
                let (a, b) = (lengths(&found[half..half + 6]), lengths(&reference[half..half + 6]));
                for (a, b) in a.iter().zip(b) {
                    if a.is_nan() {
                        return f64::INFINITY;
                    }
                    difference = difference.max((a - b).abs());
                    largest = largest.max(b.abs());
                }
            }
            worst = worst.max(difference / largest);
        }
        worst
    }

    /// Parameters of the case for herringbone.
    pub fn parameters(&self) -> Parameters {
        let (m, c) = (&self.common, &self.numbers);
        let z = m.support_damping_ratio;
        let spring = |stiffness, mass| Spring::with_damping_ratio(stiffness, z, mass);
        let harmonic = |(&amplitude, &phase_rad): (&f64, &f64)| Harmonic { amplitude, phase_rad };
        let half = HalfParameters {
            pinion_mass_kg: m.pinion_mass_kg,
            pinion_inertia_kg_m2: m.pinion_inertia_kg_m2,
            gear_mass_kg: m.gear_mass_kg,
            gear_inertia_kg_m2: m.gear_inertia_kg_m2,
            pinion_torque_nm: c.pinion_torque_per_half_nm,
            pinion_lateral: spring(m.lateral_n_per_m, m.pinion_mass_kg),
            gear_lateral: spring(m.lateral_n_per_m, m.gear_mass_kg),
            pinion_axial: Spring::default(),
            gear_axial: spring(m.gear_axial_n_per_m, m.gear_mass_kg),
            contact_force: None,
            mesh_stiffness: Stiffness::Fourier {
                mean_n_per_m: m.mean_stiffness_n_per_m,
                harmonics: c.amplitudes.iter().zip(&m.phases_rad).map(harmonic).collect(),
            },
            mesh_damping_n_s_per_m: self.mesh_damping_n_s_per_m(),
            impact: Some(ImpactExcitation::HalfSine {
                force_n: m.impact_force_n,
                duration_mesh_periods: m.impact_duration_mesh_periods,
                start_mesh_periods: 0.0,
            }),
            displacement_excitation: Vec::new(),
            phase_shift_mesh_periods: 0.0,
        };
        Parameters {
            mesh_frequency_hz: self.mesh_frequency_hz(),
            pinion_radius_m: m.pinion_radius_m,
            gear_radius_m: m.gear_radius_m,
            helix_angle_rad: m.helix_angle_deg.to_radians(),
            half_backlash_m: c.half_backlash_m,
            damping_in_gap: true,
            impact_acts_on: ImpactActsOn::Torsion,
            halves: [half.clone(), half],
            couplings: Couplings {
                pinion_axial: spring(m.pinion_axial_coupling_n_per_m, m.pinion_mass_kg),
                gear_axial: spring(m.gear_axial_coupling_n_per_m, m.gear_mass_kg),
                ..Couplings::default()
            },
            train: None,
        }
    }
}
