//! Ranges of the stated values in which the formulas of this room hold.

use super::feasibility::{Findings, MM, UM};
use super::spec::{FlankModification, GearSpec, Material, PairSpec};

impl Findings {
    /// A stated value outside `[low, high]`; not a number is outside.
    fn range(&mut self, pointer: &str, value: f64, [low, high]: [f64; 2], unit: &str) {
        if !(value >= low && value <= high) {
            let limit = if value > high { high } else { low };
            self.refuse(
                "value-out-of-range",
                format!("/design/{pointer}"),
                format!("{value} {unit} is outside {low} … {high} {unit}"),
                value,
                limit,
                unit,
            );
        }
    }

    /// Stated values one by one: finite, and in the range in which the formulas of this room hold.
    pub fn check_values(&mut self, spec: &PairSpec) {
        self.range("normal_module_mm", spec.normal_module_m * MM, [0.01, 200.0], "mm");
        self.range("pressure_angle_deg", spec.normal_pressure_angle_rad.to_degrees(), [5.0, 45.0], "deg");
        self.range("helix_angle_deg", spec.helix_angle_rad.to_degrees(), [0.0, 45.0 + 1e-9], "deg");
        self.range("face_width_mm", spec.face_width_m * MM, [0.01, 1e4], "mm");
        self.range("gap_width_mm", spec.gap_width_m * MM, [0.0, 1e4], "mm");
        if let Some(a) = spec.center_distance_m {
            self.range("center_distance_mm", a * MM, [1e-3, 1e6], "mm");
        }
        self.check_material("material", &spec.material);
        let assembly = &spec.assembly;
        for (name, value) in [
            ("center_distance_error_um", assembly.center_distance_error_m),
            ("in_plane_misalignment_um", assembly.in_plane_misalignment_m),
            ("out_of_plane_misalignment_um", assembly.out_of_plane_misalignment_m),
            ("apex_offset_um", assembly.apex_offset_m),
        ] {
            self.range(&format!("assembly/{name}"), value * UM, [-1e4, 1e4], "um");
        }
        for (side, gear) in [("pinion", &spec.pinion), ("gear", &spec.gear)] {
            self.check_gear_values(side, gear, spec);
        }
    }

    fn check_material(&mut self, at: &str, material: &Material) {
        let of = |name: &str| format!("{at}/{name}");
        self.range(&of("youngs_modulus_gpa"), material.youngs_modulus_pa * 1e-9, [0.01, 2000.0], "GPa");
        self.range(&of("poissons_ratio"), material.poissons_ratio, [0.0, 0.499], "1");
        self.range(&of("density_kg_m3"), material.density_kg_m3, [1.0, 50_000.0], "kg/m3");
    }

    fn check_gear_values(&mut self, side: &str, gear: &GearSpec, spec: &PairSpec) {
        let at = |name: &str| format!("{side}/{name}");
        self.range(&at("teeth"), f64::from(gear.teeth), [5.0, 1000.0], "1");
        self.range(&at("profile_shift"), gear.profile_shift, [-5.0, 5.0], "m_n");
        self.range(&at("addendum"), gear.addendum, [0.0, 5.0], "m_n");
        self.range(&at("dedendum"), gear.dedendum, [0.01, 5.0], "m_n");
        self.range(&at("fillet_radius"), gear.fillet_radius, [0.0, 2.0], "m_n");
        self.range(&at("tip_alteration"), gear.tip_alteration, [-5.0, 5.0], "m_n");
        self.range(&at("bore_diameter_mm"), gear.bore_radius_m * 2.0 * MM, [0.0, 1e5], "mm");
        if let Some(material) = &gear.material {
            self.check_material(&at("material"), material);
        }
        let width_m = gear.face_width_m.unwrap_or(spec.face_width_m);
        // What both halves stand out towards the middle has to find room in the gap.
        let widest_m = spec.face_width_m + spec.gap_width_m;
        self.range(&at("face_width_mm"), width_m * MM, [spec.face_width_m * MM, widest_m * MM * (1.0 + 1e-12)], "mm");
        let half_width_mm = 0.5 * width_m.max(spec.face_width_m) * MM;
        let flanks = gear.flanks.iter().chain(gear.coast_flanks.iter().flatten());
        for FlankModification { tip_relief, lead_crowning_m, helix_slope_m, end_relief } in flanks {
            self.range(&at("tip_relief/amount_um"), tip_relief.amount_m * UM, [0.0, 1e4], "um");
            self.range(&at("tip_relief/length_mm"), tip_relief.length_m * MM, [0.0, 1e4], "mm");
            self.range(&at("lead_crowning_um"), lead_crowning_m * UM, [-1e4, 1e4], "um");
            self.range(&at("helix_slope_um"), helix_slope_m * UM, [-1e4, 1e4], "um");
            self.range(&at("end_relief/amount_um"), end_relief.amount_m * UM, [0.0, 1e4], "um");
            self.range(&at("end_relief/length_mm"), end_relief.length_m * MM, [0.0, half_width_mm], "mm");
        }
        self.reasons.dedup();
    }
}
