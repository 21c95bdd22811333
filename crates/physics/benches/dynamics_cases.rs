//! The reference cases, for benches.

use herringbone_physics::dynamics::{
    Couplings, HalfParameters, Harmonic, ImpactActsOn, ImpactExcitation, Parameters, Spring, Stiffness,
    equivalent_mass_kg, mesh_damping_n_s_per_m,
};

/// Reference case A (linear), B (chaotic) or C (period 2).
pub(crate) fn case(name: &str) -> Parameters {
    match name {
        "A" => parameters(400.0, 1e-6, 0.1, 0.12),
        "B" => parameters(20.0, 2e-5, 0.03, 0.24),
        _ => parameters(40.0, 2e-5, 0.03, 0.24),
    }
}

/// Reference cases A (linear, contact kept) and C (period 2, contact lost and closed) of
/// tests/data/dynamics_reference.json.
fn parameters(torque_per_half_nm: f64, half_backlash_m: f64, damping_ratio: f64, amplitude: f64) -> Parameters {
    let (rp, rg) = (0.056_015_195_318_438_44, 0.144_980_505_530_064_2);
    let (mp, ip, mg, ig) = (6.0, 0.0325, 38.0, 1.85);
    let me = equivalent_mass_kg(rp, ip, rg, ig);
    let harmonics = [(1.0, 0.3), (0.05 / 0.12, 1.1), (0.25, 2.0), (0.125, 0.7)];
    let half = HalfParameters {
        pinion_mass_kg: mp,
        pinion_inertia_kg_m2: ip,
        gear_mass_kg: mg,
        gear_inertia_kg_m2: ig,
        pinion_torque_nm: torque_per_half_nm,
        pinion_lateral: Spring::with_damping_ratio(6e8, 0.03, mp),
        gear_lateral: Spring::with_damping_ratio(6e8, 0.03, mg),
        pinion_axial: Spring::default(),
        gear_axial: Spring::with_damping_ratio(2e8, 0.03, mg),
        contact_force: None,
        mesh_stiffness: Stiffness::Fourier {
            mean_n_per_m: 9e8,
            harmonics: harmonics.map(|(a, phase_rad)| Harmonic { amplitude: a * amplitude, phase_rad }).to_vec(),
        },
        mesh_damping_n_s_per_m: mesh_damping_n_s_per_m(damping_ratio, 9e8, me),
        impact: Some(ImpactExcitation::HalfSine {
            force_n: 3000.0,
            duration_mesh_periods: 0.08,
            start_mesh_periods: 0.0,
        }),
        displacement_excitation: Vec::new(),
        phase_shift_mesh_periods: 0.0,
    };
    Parameters {
        mesh_frequency_hz: 2000.0 / 60.0 * 17.0,
        pinion_radius_m: rp,
        gear_radius_m: rg,
        helix_angle_rad: 24.43f64.to_radians(),
        half_backlash_m,
        damping_in_gap: true,
        impact_acts_on: ImpactActsOn::Torsion,
        halves: [half.clone(), half],
        couplings: Couplings {
            pinion_axial: Spring::with_damping_ratio(3e8, 0.03, mp),
            gear_axial: Spring::with_damping_ratio(3e8, 0.03, mg),
            ..Couplings::default()
        },
        train: None,
    }
}
