//! Shafts of the tests.

use crate::shafts::{Bearing, Coupling, Shaft, ShaftMaterial, ShaftSegment};

pub(super) const STEEL: ShaftMaterial =
    ShaftMaterial { youngs_modulus_pa: 206e9, poissons_ratio: 0.3, density_kg_m3: 7850.0 };

/// Shear modulus of [`STEEL`], Pa.
pub(super) const SHEAR_MODULUS_PA: f64 = 206e9 / 2.6;

/// Second moment of area of a hollow circle, m⁴.
pub(super) fn second_moment_m4(diameter_m: f64, bore_m: f64) -> f64 {
    std::f64::consts::PI / 64.0 * (diameter_m.powi(4) - bore_m.powi(4))
}

/// κGA of a hollow circle of [`STEEL`], N; Cowper's coefficient.
pub(super) fn shear_stiffness_n(diameter_m: f64, bore_m: f64) -> f64 {
    let (nu, m2) = (0.3, (bore_m / diameter_m).powi(2));
    let square = (1.0 + m2) * (1.0 + m2);
    let coefficient = 6.0 * (1.0 + nu) * square / ((7.0 + 6.0 * nu) * square + (20.0 + 12.0 * nu) * m2);
    coefficient * SHEAR_MODULUS_PA * std::f64::consts::PI / 4.0 * (diameter_m.powi(2) - bore_m.powi(2))
}

/// A shaft of segments (length, diameter, bore in m) with the apex plane at its left end and the coupling there.
pub(super) fn shaft(segments: &[[f64; 3]], bearings: Vec<Bearing>) -> Shaft {
    Shaft {
        segments: segments
            .iter()
            .map(|&[length_m, diameter_m, bore_m]| ShaftSegment { length_m, diameter_m, bore_m })
            .collect(),
        gear_position_m: 0.0,
        bearings,
        coupling: Coupling { position_m: 0.0, axial_n_per_m: 0.0, torsional: None },
        half_body: None,
        bodies: Vec::new(),
        material: STEEL,
    }
}

/// Stiffness that counts as rigid, N/m and N m/rad.
pub(super) const RIGID: f64 = 1e17;

/// A bearing that holds everything but rotation about z.
pub(super) fn clamp(position_m: f64) -> Bearing {
    Bearing { axial_n_per_m: RIGID, tilting_nm_per_rad: RIGID, ..Bearing::radial(position_m, RIGID) }
}
