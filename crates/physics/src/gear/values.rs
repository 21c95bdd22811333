//! Ranges of the stated values in which the formulas of this module hold.

use super::feasibility::Findings;
use super::findings::{AssemblyField, GearField, InfeasibilityReason, MaterialField, MemberId, SpecField};
use super::spec::{FlankModification, GearSpec, Material, PairSpec};

impl Findings {
    /// A stated value outside `[minimum, maximum]`; not a number is outside.
    fn range(&mut self, field: SpecField, value: f64, [minimum, maximum]: [f64; 2]) {
        if !(value >= minimum && value <= maximum) {
            self.refuse(field, InfeasibilityReason::ValueOutOfRange { value, minimum, maximum });
        }
    }

    /// Stated values one by one: finite, and in the range in which the formulas of this module hold.
    pub(super) fn check_values(&mut self, spec: &PairSpec) {
        let [least_angle, largest_angle, largest_helix] = [5f64, 45.0, 45.0 + 1e-9].map(f64::to_radians);
        self.range(SpecField::NormalModule, spec.normal_module_m, [1e-5, 0.2]);
        self.range(SpecField::NormalPressureAngle, spec.normal_pressure_angle_rad, [least_angle, largest_angle]);
        self.range(SpecField::HelixAngle, spec.helix_angle_rad, [0.0, largest_helix]);
        self.range(SpecField::FaceWidth, spec.face_width_m, [1e-5, 10.0]);
        self.range(SpecField::GapWidth, spec.gap_width_m, [0.0, 10.0]);
        if let Some(center_distance_m) = spec.center_distance_m {
            self.range(SpecField::CenterDistance, center_distance_m, [1e-6, 1e3]);
        }
        self.check_material(SpecField::Material, &spec.material);
        let assembly = &spec.assembly;
        for (field, value) in [
            (AssemblyField::CenterDistanceError, assembly.center_distance_error_m),
            (AssemblyField::InPlaneMisalignment, assembly.in_plane_misalignment_m),
            (AssemblyField::OutOfPlaneMisalignment, assembly.out_of_plane_misalignment_m),
            (AssemblyField::ApexOffset, assembly.apex_offset_m),
        ] {
            self.range(SpecField::Assembly(field), value, [-1e-2, 1e-2]);
        }
        for (member, gear) in MemberId::BOTH.into_iter().zip([&spec.pinion, &spec.gear]) {
            self.check_gear_values(member, gear, spec);
        }
    }

    fn check_material(&mut self, at: impl Fn(MaterialField) -> SpecField, material: &Material) {
        self.range(at(MaterialField::YoungsModulus), material.youngs_modulus_pa, [1e7, 2e12]);
        self.range(at(MaterialField::PoissonsRatio), material.poissons_ratio, [0.0, 0.499]);
        self.range(at(MaterialField::Density), material.density_kg_m3, [1.0, 50_000.0]);
    }

    fn check_gear_values(&mut self, member: MemberId, gear: &GearSpec, spec: &PairSpec) {
        let at = |field: GearField| SpecField::Member(member, field);
        self.range(at(GearField::Teeth), f64::from(gear.teeth), [5.0, 1000.0]);
        self.range(at(GearField::ProfileShift), gear.profile_shift, [-5.0, 5.0]);
        self.range(at(GearField::Addendum), gear.addendum, [0.0, 5.0]);
        self.range(at(GearField::Dedendum), gear.dedendum, [0.01, 5.0]);
        self.range(at(GearField::FilletRadius), gear.fillet_radius, [0.0, 2.0]);
        self.range(at(GearField::TipAlteration), gear.tip_alteration, [-5.0, 5.0]);
        self.range(at(GearField::BoreRadius), gear.bore_radius_m, [0.0, 50.0]);
        if let Some(material) = &gear.material {
            self.check_material(|field| at(GearField::Material(field)), material);
        }
        let width_m = gear.face_width_m.unwrap_or(spec.face_width_m);
        // The excess width of both halves towards the middle must fit into the gap.
        let widest_m = spec.face_width_m + spec.gap_width_m;
        self.range(at(GearField::FaceWidth), width_m, [spec.face_width_m, widest_m * (1.0 + 1e-12)]);
        let half_width_m = 0.5 * width_m.max(spec.face_width_m);
        let flanks = gear.flanks.iter().chain(gear.coast_flanks.iter().flatten());
        for FlankModification { tip_relief, lead_crowning_m, helix_slope_m, end_relief } in flanks {
            self.range(at(GearField::TipReliefAmount), tip_relief.amount_m, [0.0, 1e-2]);
            self.range(at(GearField::TipReliefLength), tip_relief.length_m, [0.0, 10.0]);
            self.range(at(GearField::LeadCrowning), *lead_crowning_m, [-1e-2, 1e-2]);
            self.range(at(GearField::HelixSlope), *helix_slope_m, [-1e-2, 1e-2]);
            self.range(at(GearField::EndReliefAmount), end_relief.amount_m, [0.0, 1e-2]);
            self.range(at(GearField::EndReliefLength), end_relief.length_m, [0.0, half_width_m]);
        }
        self.reasons.dedup();
    }
}
