//! Stiffness and mass of cylindrical beam sections.

use std::f64::consts::PI;

use super::shaft::{ShaftMaterial, ShaftSegment};

/// Stiffness and mass of a section, per length where not said otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BeamSection {
    /// Tension EA, N.
    pub axial_n: f64,
    /// Shear κGA, N.
    pub shear_n: f64,
    /// Bending EI, N m².
    pub bending_n_m2: f64,
    /// Torsion GJ, N m².
    pub torsion_n_m2: f64,
    /// Mass ρA, kg/m.
    pub mass_kg_per_m: f64,
    /// Rotary inertia about a diameter ρI, kg m.
    pub diametral_kg_m: f64,
    /// Polar inertia ρJ, kg m.
    pub polar_kg_m: f64,
}

impl BeamSection {
    /// The section of a segment, with the shear coefficient of the hollow circle (Cowper 1966,
    /// DOI 10.1115/1.3625046).
    pub(super) fn new(segment: &ShaftSegment, material: &ShaftMaterial) -> BeamSection {
        let (outer, inner) = (segment.diameter_m, segment.bore_m);
        let nu = material.poissons_ratio;
        let shear_modulus_pa = material.youngs_modulus_pa / (2.0 * (1.0 + nu));
        // Products of sums and differences keep thin walls exact.
        let area_m2 = PI / 4.0 * (outer - inner) * (outer + inner);
        let second_moment_m4 = area_m2 / 16.0 * (outer * outer + inner * inner);
        let m2 = (inner / outer).powi(2);
        let round = (1.0 + m2).powi(2);
        let shear_coefficient = 6.0 * (1.0 + nu) * round / ((7.0 + 6.0 * nu) * round + (20.0 + 12.0 * nu) * m2);
        BeamSection {
            axial_n: material.youngs_modulus_pa * area_m2,
            shear_n: shear_coefficient * shear_modulus_pa * area_m2,
            bending_n_m2: material.youngs_modulus_pa * second_moment_m4,
            torsion_n_m2: shear_modulus_pa * 2.0 * second_moment_m4,
            mass_kg_per_m: material.density_kg_m3 * area_m2,
            diametral_kg_m: material.density_kg_m3 * second_moment_m4,
            polar_kg_m: material.density_kg_m3 * 2.0 * second_moment_m4,
        }
    }
}
