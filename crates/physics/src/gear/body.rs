//! Stiffness of the body of a gear between the middles of its two halves.

use super::member::Member;
use super::spec::Material;
use std::f64::consts::PI;

/// Stiffnesses of a gear body between two cross-sections. They are infinite for sections that coincide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyStiffness {
    /// Axial force over elongation, N/m.
    pub axial_n_per_m: f64,
    /// Transverse force over relative displacement of sections that stay parallel, N/m.
    pub lateral_n_per_m: f64,
    /// Torque over angle of twist, N m/rad.
    pub torsional_nm_per_rad: f64,
}

impl Member {
    /// Stiffness of the body between two sections `length_m` apart: a hollow circular cylinder from the bore to the
    /// root circle, of the gear's own material (the shaft in the bore, the teeth, and a groove in the gap are not
    /// counted).
    ///
    /// - Tension: `E A / L`; torsion: `G J / L` (Saint-Venant).
    /// - Bending: a Timoshenko beam whose end sections do not turn, `1/(L³/(12 E I) + L/(κ G A))`, bending and shear in
    ///   series. The equations of motion have no coordinate in which a half could rock, so the sections in the middles
    ///   of the halves stay parallel and carry the moments that this takes. (Ends free to turn would not resist at all:
    ///   a relative displacement would be a rigid rocking.)
    /// - κ of the hollow circle: Cowper 1966, doi:10.1115/1.3625046, `6 (1+ν)(1+m²)² / ((7+6ν)(1+m²)² + (20+12ν) m²)`,
    ///   m the bore over the root diameter.
    pub fn body_stiffness(&self, material: &Material, length_m: f64) -> BodyStiffness {
        let (r, bore) = (self.root_radius_m, self.bore_radius_m);
        let (e, nu) = (material.youngs_modulus_pa, material.poissons_ratio);
        let g = 0.5 * e / (1.0 + nu);
        let area_m2 = PI * (r - bore) * (r + bore);
        // Second moment of area about a diameter: a quarter of A (r² + bore²), half of the polar one.
        let second_moment_m4 = 0.25 * area_m2 * (r * r + bore * bore);
        let bending = length_m.powi(3) / (12.0 * e * second_moment_m4);
        let shear = length_m / (shear_coefficient(bore / r, nu) * g * area_m2);
        BodyStiffness {
            axial_n_per_m: e * area_m2 / length_m,
            lateral_n_per_m: 1.0 / (bending + shear),
            torsional_nm_per_rad: 2.0 * g * second_moment_m4 / length_m,
        }
    }
}

/// Cowper's shear coefficient of a hollow circle, `m` its inner over its outer diameter.
fn shear_coefficient(m: f64, nu: f64) -> f64 {
    let square = m * m;
    let sum = (1.0 + square).powi(2);
    6.0 * (1.0 + nu) * sum / ((7.0 + 6.0 * nu) * sum + (20.0 + 12.0 * nu) * square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::Pair;
    use crate::gear::fixtures;

    /// A thin tube has κ → 2 (1+ν)/(4+3ν), a solid bar 6 (1+ν)/(7+6ν) (Cowper, Table 1).
    #[test]
    fn the_shear_coefficient_has_its_limits() {
        for nu in [0.0, 0.3, 0.49] {
            assert!((shear_coefficient(0.0, nu) - 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu)).abs() < 1e-14);
            assert!((shear_coefficient(1.0, nu) - 2.0 * (1.0 + nu) / (4.0 + 3.0 * nu)).abs() < 1e-14);
            assert!(shear_coefficient(0.5, nu) < shear_coefficient(0.0, nu));
        }
    }

    fn source() -> Pair {
        fixtures::pair(&fixtures::source_pair(1.0))
    }

    fn bored(mut member: Member, bore_radius_m: f64) -> Member {
        member.bore_radius_m = bore_radius_m;
        member
    }

    /// Integrated numerically: the elongation, the twist and the deflection of slices in a row, the last from the
    /// moment and shear of a beam with parallel ends.
    #[test]
    fn slices_in_a_row_give_the_same() {
        let member = bored(source().pinion, 0.025);
        let (material, length) = (Material { youngs_modulus_pa: 70e9, poissons_ratio: 0.33, ..Material::STEEL }, 0.105);
        let whole = member.body_stiffness(&material, length);
        let (d, bore) = (2.0 * member.root_radius_m, 2.0 * member.bore_radius_m);
        let (area, polar) = (PI / 4.0 * (d * d - bore * bore), PI / 32.0 * (d.powi(4) - bore.powi(4)));
        let g = material.youngs_modulus_pa / 2.0 / 1.33;
        let slices = 20_000;
        let dx = length / f64::from(slices);
        let (mut twist, mut slope, mut deflection) = (0.0, 0.0, 0.0);
        for i in 0..slices {
            let x = (f64::from(i) + 0.5) * dx;
            twist += dx / (g * polar);
            // Unit force, moment L/2 at the first end.
            let curvature = (0.5 * length - x) / (material.youngs_modulus_pa * polar / 2.0);
            deflection += (slope + 0.5 * curvature * dx) * dx + dx / (shear_coefficient(bore / d, 0.33) * g * area);
            slope += curvature * dx;
        }
        assert!(slope.abs() < 1e-12 * deflection, "the end does not turn");
        assert!((whole.axial_n_per_m * length / (material.youngs_modulus_pa * area) - 1.0).abs() < 1e-12);
        assert!((whole.torsional_nm_per_rad * twist - 1.0).abs() < 1e-9);
        assert!((whole.lateral_n_per_m * deflection - 1.0).abs() < 1e-7);
    }

    #[test]
    fn what_makes_a_body_stiffer() {
        let member = bored(source().gear, 0.06);
        let base = member.body_stiffness(&Material::STEEL, 0.105);
        let longer = member.body_stiffness(&Material::STEEL, 0.21);
        assert_eq!(longer.axial_n_per_m, 0.5 * base.axial_n_per_m);
        // Twice as long: between half (shear alone) and an eighth (bending alone).
        let ratio = longer.lateral_n_per_m / base.lateral_n_per_m;
        assert!(ratio > 0.125 && ratio < 0.5, "{ratio}");
        let solid = bored(member, 0.0).body_stiffness(&Material::STEEL, 0.105);
        assert!(solid.axial_n_per_m > base.axial_n_per_m && solid.lateral_n_per_m > base.lateral_n_per_m);
        assert!(solid.torsional_nm_per_rad > base.torsional_nm_per_rad);
    }
}
