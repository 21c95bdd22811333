//! Local contact of two flanks on a line: exact plane-strain Hertz approach of one body referenced to a depth.
//!
//! δ(w) = 2(1-ν²)w/(πE) [asinh(h/b) - ν/(1-ν) h/(√(h²+b²)+h)], b the half width of the contact band, h the depth: the
//! strain under a Hertzian pressure integrated from the surface to h (Weber's logarithm is its limit for h >> b). Each
//! body has its own E, ν and h; the band is that of both, b² = 4 R w/(π E*) with 1/E* = (1-ν1²)/E1 + (1-ν2²)/E2
//! (Johnson, Contact Mechanics, 1985, section 4.2).

use std::f64::consts::PI;

use super::half_space;
use crate::gear::Material;

/// One point of contact: curvature and depths are fixed, the line load varies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LineContact {
    /// 2(1-ν²)/(πE), per Pa, mean of both bodies.
    factor: f64,
    /// Factor of each body over the mean: 1 for equal materials.
    parts: [f64; 2],
    /// ν/(1-ν) of each body.
    lateral: [f64; 2],
    /// b² per line load, m² per (N/m).
    band2_per_load: f64,
    depths_m: [f64; 2],
}

impl LineContact {
    /// `materials` are those of both bodies, `radius_m` is the relative radius of curvature in the normal section,
    /// `depths_m` the depths of both tooth centrelines.
    pub(crate) fn new(materials: [&Material; 2], radius_m: f64, depths_m: [f64; 2]) -> LineContact {
        let compliances = materials.map(Material::plane_strain_compliance_per_pa);
        let mean = 0.5 * (compliances[0] + compliances[1]);
        LineContact {
            factor: 2.0 * mean / PI,
            parts: compliances.map(|compliance| compliance / mean),
            lateral: materials.map(|material| material.poissons_ratio / (1.0 - material.poissons_ratio)),
            band2_per_load: 8.0 * mean * radius_m / PI,
            depths_m,
        }
    }

    /// Half width of the contact band under the line load `w` (N/m).
    pub(crate) fn half_width_m(&self, w: f64) -> f64 {
        (self.band2_per_load * w).sqrt()
    }

    /// Largest pressure under the line load `w`.
    pub(crate) fn pressure_pa(&self, w: f64) -> f64 {
        if w > 0.0 { 2.0 * w / (PI * self.half_width_m(w)) } else { 0.0 }
    }

    /// Approach of both half-spaces in the middle of a segment of length `length_m`, by its own load, and its
    /// derivative with respect to the line load, at `w > 0`.
    ///
    /// The band is kept from growing wider than the segment is long (b² = b_H² / √(1 + (2 b_H / l)⁴)): beyond that the
    /// influence of the neighbours' load would exceed that of its own and the system would lose its definiteness.
    pub(crate) fn half_space_approach(&self, w: f64, length_m: f64) -> (f64, f64) {
        let widest2 = 0.25 * length_m * length_m;
        let ratio = self.band2_per_load * w / widest2;
        let bound = 1.0 + ratio * ratio;
        let r = 0.5 * length_m / (self.band2_per_load * w / bound.sqrt()).sqrt();
        let (value, slope) = half_space::own(r);
        // dr/dw = -r / (2 w (1 + ratio²)).
        (2.0 * self.factor * w * value, 2.0 * self.factor * (value - 0.5 * r * slope / bound))
    }

    /// Approach of both half-spaces per force at a point of the line at `at_m`, by a segment elsewhere on the line
    /// whose band is that of the line load `w`, but no wider than `widest_m`.
    pub(crate) fn half_space_beside(&self, at_m: f64, segment_m: (f64, f64), w: f64, widest_m: f64) -> f64 {
        let half_width = self.half_width_m(w).min(0.5 * widest_m);
        self.factor * half_space::beside(at_m, segment_m, half_width) / (segment_m.1 - segment_m.0)
    }

    /// Approach of both bodies and its derivative with respect to the line load, at `w > 0`.
    pub(crate) fn approach(&self, w: f64) -> (f64, f64) {
        let b = self.half_width_m(w);
        let b2 = b * b;
        let (mut value, mut change) = (0.0, 0.0);
        for ((h, part), lateral) in self.depths_m.into_iter().zip(self.parts).zip(self.lateral) {
            let root = (h * h + b2).sqrt();
            let ratio = h / (root + h);
            // asinh(h/b), written out: both are positive, nothing cancels.
            value += part * (((h + root) / b).ln() - lateral * ratio);
            // d asinh(h/b)/dw = -h/(2 w root); d ratio/dw = -h b²/(2 w root (root+h)²).
            change += part * (-h / (2.0 * root) + lateral * h * b2 / (2.0 * root * (root + h).powi(2)));
        }
        (self.factor * w * value, self.factor * (value + change))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::Tolerance::{Absolute, Relative};
    use herringbone_oracle::{check, check_worst};

    const PLASTIC: Material = Material { youngs_modulus_pa: 2.8e9, poissons_ratio: 0.38, density_kg_m3: 1410.0 };

    /// Band and pressure of Hertz for two materials, and the approach of each body under that band.
    #[test]
    fn two_materials_share_one_band() {
        let topic = "Contact: Hertzian approach of line contacts";
        let (radius, w, depths) = (8e-3, 50e3, [6e-3, 9e-3]);
        let contact = LineContact::new([&Material::STEEL, &PLASTIC], radius, depths);
        let effective = 1.0 / ((1.0 - 0.09) / 206e9 + (1.0 - 0.38 * 0.38) / 2.8e9);
        let pressure = (w * effective / (PI * radius)).sqrt();
        check(
            topic,
            "pressure, plastic on steel, MPa",
            contact.pressure_pa(w) * 1e-6,
            pressure * 1e-6,
            Relative(1e-12),
        );
        // The strain integral of one body from the surface to its depth, by its closed form.
        let b = (4.0 * radius * w / (PI * effective)).sqrt();
        let body = |material: &Material, h: f64| {
            let nu = material.poissons_ratio;
            let plane = 2.0 * (1.0 - nu * nu) * w / (PI * material.youngs_modulus_pa);
            plane * ((h / b).asinh() - nu / (1.0 - nu) * h / (h.hypot(b) + h))
        };
        let sum = body(&Material::STEEL, depths[0]) + body(&PLASTIC, depths[1]);
        check(topic, "approach, plastic on steel, µm", contact.approach(w).0 * 1e6, sum * 1e6, Relative(1e-12));
        // Half-spaces: the sum of both compliances, whichever body has which.
        let turned = LineContact::new([&PLASTIC, &Material::STEEL], radius, depths);
        let [one, other] = [contact, turned].map(|contact| contact.half_space_approach(w, 5e-3).0);
        check(topic, "half-spaces with the materials exchanged, µm", one * 1e6, other * 1e6, Relative(1e-14));
        let step = 1e-4 * w;
        let (up, down) = (contact.approach(w + step).0, contact.approach(w - step).0);
        check_worst(topic, "slope, plastic on steel", [(up - down) / (2.0 * step) / contact.approach(w).1 - 1.0], 1e-6);
    }

    #[test]
    fn approach_matches_reference_values() {
        let topic = "Contact: Hertzian approach of line contacts";
        let mut slopes = Vec::new();
        // E 206000 MPa, ρ 8 mm with depths 6 + 6 mm, ρ 4 mm with depths 1.6 + 1.6 mm; w in N/mm, approach in µm.
        for (radius, depth, table) in [
            (8e-3, 6e-3, [(10.0, 0.325), (50.0, 1.398), (100.0, 2.602), (300.0, 6.879), (1000.0, 19.547)]),
            (4e-3, 1.6e-3, [(10.0, 0.270), (50.0, 1.124), (100.0, 2.054), (300.0, 5.236), (1000.0, 14.088)]),
        ] {
            let contact = LineContact::new([&Material::STEEL; 2], radius, [depth; 2]);
            for (w, micrometres) in table {
                let (value, slope) = contact.approach(w * 1e3);
                let quantity = format!("ρ {} mm, depths {} mm, {w} N/mm, µm", radius * 1e3, depth * 1e3);
                check(topic, &quantity, value * 1e6, micrometres, Absolute(6e-4));
                let step = w;
                let (up, down) = (contact.approach(w * 1e3 + step).0, contact.approach(w * 1e3 - step).0);
                slopes.push((up - down) / (2.0 * step) / slope - 1.0);
            }
        }
        check_worst(topic, "slope against differences", slopes, 1e-6);
    }
}
