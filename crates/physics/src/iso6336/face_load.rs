//! Face load factor of ISO 6336-1, method C, by the deformation of the pinion and its shaft.

/// Arrangement of pinion, bearings and the end through which the torque enters, as the standard's figure distinguishes
/// them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PinionArrangement {
    /// Between the bearings, off the middle towards the torque (a).
    TowardsTorque,
    /// Between the bearings, off the middle away from the torque (b).
    AwayFromTorque,
    /// Overhung, the torque entering through the bearings (c).
    Overhung,
}

impl PinionArrangement {
    /// Constant K' of a pinion that stiffens its shaft, being one with it (`stiffened`), or does not.
    pub fn constant(self, stiffened: bool) -> f64 {
        match (self, stiffened) {
            (PinionArrangement::TowardsTorque, true) => 0.48,
            (PinionArrangement::TowardsTorque, false) => 0.8,
            (PinionArrangement::AwayFromTorque, true) => -0.48,
            (PinionArrangement::AwayFromTorque, false) => -0.8,
            (PinionArrangement::Overhung, _) => 1.33,
        }
    }
}

/// Pinion of a double-helical pair on its shaft.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinionOnShaft {
    /// Reference diameter d_1, m.
    pub reference_diameter_m: f64,
    /// Diameter d_sh of the shaft of the same bending deflection, m.
    pub shaft_diameter_m: f64,
    /// Width b_B of one helix, m.
    pub helix_width_m: f64,
    /// Bearing span l, m.
    pub bearing_span_m: f64,
    /// Distance s of the middle of the pinion from the middle of the bearing span, of an overhung one from the nearer
    /// bearing, m.
    pub offset_m: f64,
    /// Arrangement.
    pub arrangement: PinionArrangement,
}

/// Ratio d_1/d_sh from which the pinion stiffens its shaft.
const STIFFENING: f64 = 1.15;
/// 1 mm µm/N in m²/N.
const MM_UM_PER_N: f64 = 1e-9;
/// Power of the whole pinion through one end: B* of a double-helical pinion.
const WHOLE_POWER: f64 = 1.5;

impl PinionOnShaft {
    /// K' of the arrangement.
    pub fn constant(&self) -> f64 {
        self.arrangement.constant(self.reference_diameter_m / self.shaft_diameter_m >= STIFFENING)
    }

    /// Equivalent misalignment f_sh (m) of the helix nearer to the torque under the line load F_m/b (N/m, b the width
    /// of both helices): `f_sh = 0.046 (F_m/b) [|1.5 + K' l s/d_1² (d_1/d_sh)⁴ − 0.3| + 0.3] (b_B/d_1)²` in µm, N/mm
    /// and mm (ISO 6336-1:2006, 7.6.2; all of the power through one end).
    pub fn equivalent_misalignment_m(&self, line_load_n_per_m: f64) -> f64 {
        let d = self.reference_diameter_m;
        let bending =
            self.constant() * self.bearing_span_m * self.offset_m / (d * d) * (d / self.shaft_diameter_m).powi(4);
        let gamma = ((WHOLE_POWER + bending - 0.3).abs() + 0.3) * (self.helix_width_m / d).powi(2);
        0.046 * MM_UM_PER_N * line_load_n_per_m * gamma
    }

    /// K_Hβ by that misalignment alone, 1.33 f_sh, without manufacturing deviations, running-in and modifications, for
    /// the stiffness c_γβ (N/m²): `1 + F c/(2 F_m/b)`, and `√(2 F c/(F_m/b))` where a part of the face is open
    /// (ISO 6336-1:2006, 7.6.1).
    pub fn k_h_beta(&self, line_load_n_per_m: f64, stiffness_n_per_m2: f64) -> f64 {
        let misalignment_m = 1.33 * self.equivalent_misalignment_m(line_load_n_per_m);
        let ratio = misalignment_m * stiffness_n_per_m2 / (2.0 * line_load_n_per_m);
        if ratio < 1.0 { 1.0 + ratio } else { 2.0 * ratio.sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::Tolerance::Relative;
    use herringbone_oracle::check;

    /// By hand: d_1 = 112.03 mm, d_sh = 85 mm, b_B = 75 mm, symmetric; F_m/b = 95.2 N/mm, c_γβ = 17 N/(mm µm).
    #[test]
    fn a_symmetric_pinion_by_hand() {
        let pinion = PinionOnShaft {
            reference_diameter_m: 0.11203,
            shaft_diameter_m: 0.085,
            helix_width_m: 0.075,
            bearing_span_m: 0.34,
            offset_m: 0.0,
            arrangement: PinionArrangement::TowardsTorque,
        };
        let by_hand_um = 0.046 * 95.2 * 1.5 * (75.0f64 / 112.03).powi(2);
        let topic = "Shafts: face load by ISO 6336-1, method C";
        let got = pinion.equivalent_misalignment_m(95.2e3) * 1e6;
        check(topic, "f_sh of a symmetric pinion, µm", got, by_hand_um, Relative(1e-12));
        let expected = 1.0 + 1.33 * by_hand_um * 17.0 / (2.0 * 95.2);
        check(topic, "K_Hβ of a symmetric pinion", pinion.k_h_beta(95.2e3, 17e9), expected, Relative(1e-12));
        // Towards the torque bending and twisting add.
        let off = PinionOnShaft { offset_m: 0.06, ..pinion };
        let away = PinionOnShaft { arrangement: PinionArrangement::AwayFromTorque, ..off };
        assert!(off.equivalent_misalignment_m(95.2e3) > pinion.equivalent_misalignment_m(95.2e3));
        assert!(away.equivalent_misalignment_m(95.2e3) < pinion.equivalent_misalignment_m(95.2e3));
    }

    /// K' = 1.33 of an overhung pinion stands for the slope F s l/(3 E I) of a beam of length l between its bearings
    /// under the moment F s at one of them, times the width b of a helix, to 7 %.
    #[test]
    fn an_overhung_pinion_is_counted_from_its_nearer_bearing() {
        let (youngs_pa, d, l, s, b) = (206e9, 0.1f64, 0.4, 0.1, 0.05);
        let load_n_per_m = 100e3;
        let area_m4 = std::f64::consts::PI / 64.0 * d.powi(4);
        let slope = load_n_per_m * 2.0 * b * s * l / (3.0 * youngs_pa * area_m4);
        let by_beam_m = slope * b;
        let pinion = PinionOnShaft {
            reference_diameter_m: d,
            shaft_diameter_m: d,
            helix_width_m: b,
            bearing_span_m: l,
            offset_m: s,
            arrangement: PinionArrangement::Overhung,
        };
        let straight = PinionOnShaft { offset_m: 0.0, ..pinion };
        let of = |pinion: &PinionOnShaft| pinion.equivalent_misalignment_m(load_n_per_m);
        let topic = "Shafts: face load by ISO 6336-1, method C";
        let bending_m = of(&pinion) - of(&straight);
        check(topic, "bending of an overhung pinion against a beam, m", bending_m, by_beam_m, Relative(0.12));
    }
}
