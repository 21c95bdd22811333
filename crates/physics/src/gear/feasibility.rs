//! Checks of a design: what makes it infeasible and what is worth a warning.
//!
//! Checks run in three steps (stated values, teeth of each member, engagement); a step that needs the result of a
//! failed one is left out, everything else is reported at once.

use super::corner::Corner;
use super::findings::{
    AssemblyField, CenterDistanceFit, Consequence, GearField, Infeasibility, InfeasibilityReason, MemberId, SpecField,
    Warning, WarningReason,
};
use super::member::Member;
use super::pair::{Pair, ZeroBacklashFit};
use super::spec::PairSpec;
use super::tooth::Cutter;
use std::mem::discriminant;

/// Thinnest tip, in normal modules, that is accepted without a warning (usual practice; 0.4 when case-hardened).
pub(super) const TIP_THICKNESS_WARNING: f64 = 0.2;
/// Tip clearance, in normal modules, below which a warning is given (ISO 53 racks leave 0.25, the usual least is 0.1).
pub(super) const CLEARANCE_WARNING: f64 = 0.1;
/// Rim thickness over tooth height below which the rim weakens the tooth root (ISO 6336-3, rim thickness factor above
/// 1).
const RIM_WARNING: f64 = 1.2;
/// Depth, in normal modules, to which a tip corner may dip into the mate's nominal fillet before the design is refused:
/// below it tolerances, tip edge breaks and backlash decide, and a warning is given.
pub(super) const FILLET_CUT_LIMIT: f64 = 0.02;
/// Cut into the fillet, in normal modules, that is taken as none (rounding of the sampled path).
const FILLET_CUT_NOTICE: f64 = 1e-6;
/// Negative backlash along the base tangent that is not yet reported: below the resolution of gear inspection.
const OVERLAP_NOTICE_M: f64 = 1e-6;
/// Negative backlash along the base tangent, in normal modules, beyond which the design is refused: thinner teeth make
/// up for it, and no thickness allowance is larger (the least backlash of ISO/TR 10064-2 for the centre distance and
/// module stays below it).
const OVERLAP_LIMIT: f64 = 0.1;
/// Backlash along the base tangent, in normal modules, beyond which a given centre distance that takes the transverse
/// contact ratio below 1 is refused: no thickness allowance or axis tolerance asks for so much.
const BACKLASH_LIMIT: f64 = 0.5;
/// Backlash along the base tangent, in normal modules, above which the given centre distance is reported as not
/// belonging to the profile shifts (backlash allowances of ISO/TR 10064-2 stay below it).
const BACKLASH_NOTICE: f64 = 0.1;

/// Reasons and warnings of one or more checks.
#[derive(Debug, Default)]
pub(super) struct Findings {
    /// Reasons why the design is infeasible.
    pub reasons: Vec<Infeasibility>,
    /// Warnings of a feasible design.
    pub warnings: Vec<Warning>,
}

impl Findings {
    /// Adds a reason.
    pub(super) fn refuse(&mut self, field: SpecField, reason: InfeasibilityReason) {
        self.reasons.push(Infeasibility { field, reason });
    }

    fn warn(&mut self, field: SpecField, reason: WarningReason) {
        self.warnings.push(Warning { field, reason });
    }

    /// Appends the findings of another check.
    pub(super) fn add(&mut self, other: Findings) {
        self.reasons.extend(other.reasons);
        self.warnings.extend(other.warnings);
    }

    /// The cutter's tip rounding must fit its tip; a larger one is reduced to what fits, so that the rest can be
    /// checked.
    pub(super) fn check_cutter(&mut self, member: MemberId, cutter: &mut Cutter) {
        let limit = cutter.fillet_radius_limit();
        if limit < 0.0 {
            let limit = std::f64::consts::FRAC_PI_4 / cutter.normal_pressure_angle_rad.tan();
            self.refuse(
                SpecField::Member(member, GearField::Dedendum),
                InfeasibilityReason::RackTipPointed { dedendum: cutter.dedendum, limit },
            );
        } else if cutter.fillet_radius > limit {
            self.refuse(
                SpecField::Member(member, GearField::FilletRadius),
                InfeasibilityReason::FilletRadiusTooLarge { fillet_radius: cutter.fillet_radius, limit },
            );
        }
        cutter.fillet_radius = cutter.fillet_radius.min(limit.max(0.0));
        let root_radius_m = cutter.root_radius_m();
        let limit_m = 0.05 * cutter.normal_module_m;
        if root_radius_m < limit_m {
            self.refuse(
                SpecField::Member(member, GearField::Dedendum),
                InfeasibilityReason::RootCircleVanishes { root_radius_m, limit_m },
            );
        }
    }

    /// The teeth of one member, whatever it meshes with.
    pub(super) fn check_member(&mut self, id: MemberId, member: &Member, spec: &PairSpec) {
        let m = spec.normal_module_m;
        let start_radius_m = member.root_form_radius_m.max(member.base_radius_m);
        if member.tip_radius_m <= start_radius_m {
            self.refuse(
                SpecField::Member(id, GearField::Addendum),
                InfeasibilityReason::NoInvolute { tip_radius_m: member.tip_radius_m, start_radius_m },
            );
        } else {
            self.check_tip_thickness(id, member, m);
        }
        let waist = member.root_half_angle_rad().min(member.waist_half_angle_rad());
        if waist <= 0.0 {
            let thickness = waist * 2.0 * member.root_form_radius_m / m;
            self.refuse(SpecField::Member(id, GearField::Teeth), InfeasibilityReason::ToothCutOff { thickness });
        }
        if member.is_undercut() {
            self.warn(
                SpecField::Member(id, GearField::ProfileShift),
                WarningReason::Undercut {
                    profile_shift: member.profile_shift,
                    limit: member.undercut_profile_shift,
                    form_radius_m: member.root_form_radius_m,
                },
            );
        }
        self.check_bore(id, member);
    }

    fn check_tip_thickness(&mut self, id: MemberId, member: &Member, normal_module_m: f64) {
        let field = SpecField::Member(id, GearField::Addendum);
        let thickness = member.normal_thickness_m(member.tip_radius_m) / normal_module_m;
        if thickness <= 0.0 {
            self.refuse(field, InfeasibilityReason::PointedTip { thickness });
        } else if thickness < TIP_THICKNESS_WARNING {
            self.warn(field, WarningReason::ThinTip { thickness, limit: TIP_THICKNESS_WARNING });
        }
    }

    fn check_bore(&mut self, id: MemberId, member: &Member) {
        let field = SpecField::Member(id, GearField::BoreRadius);
        let thickness_m = member.root_radius_m - member.bore_radius_m;
        if thickness_m <= 0.0 {
            let Member { bore_radius_m, root_radius_m, .. } = *member;
            self.refuse(field, InfeasibilityReason::BoreTooLarge { bore_radius_m, root_radius_m });
        } else if thickness_m < RIM_WARNING * (member.tip_radius_m - member.root_radius_m) {
            self.warn(field, WarningReason::ThinRim { thickness_m, limit_tooth_heights: RIM_WARNING });
        }
    }

    /// Working centre distance with its error, or `None` when no line of action exists.
    pub(super) fn center_distance_m(
        &mut self,
        spec: &PairSpec,
        base_radius_sum_m: f64,
        fit: &ZeroBacklashFit,
    ) -> Option<f64> {
        let nominal = match (spec.center_distance_m, fit.center_distance_m) {
            (Some(a), _) => a,
            (None, Some(a)) => a,
            (None, None) => {
                let sum = fit.shift_sum;
                let z = f64::from(spec.pinion.teeth + spec.gear.teeth);
                let alpha_t = (spec.normal_pressure_angle_rad.tan() / spec.helix_angle_rad.cos()).atan();
                let limit = -super::involute::inv(alpha_t) * z / (2.0 * spec.normal_pressure_angle_rad.tan());
                self.refuse(
                    SpecField::Member(MemberId::Pinion, GearField::ProfileShift),
                    InfeasibilityReason::ProfileShiftSumTooSmall { sum, limit },
                );
                return None;
            }
        };
        let working = nominal + spec.assembly.center_distance_error_m;
        if working > base_radius_sum_m * (1.0 + 1e-9) {
            return Some(working);
        }
        self.refuse(
            center_distance_field(spec, fit),
            InfeasibilityReason::CenterDistanceTooSmall { base_radius_sum_m, fit: center_distance_fit(fit, working) },
        );
        None
    }

    /// The engagement of the two members.
    pub(super) fn check_pair(&mut self, pair: &Pair, fit: &ZeroBacklashFit) {
        self.check_interference(MemberId::Gear, &pair.gear, &Corner::mesh_in(pair), pair);
        self.check_interference(MemberId::Pinion, &pair.pinion, &Corner::mesh_out(pair), pair);
        self.check_clearance(MemberId::Pinion, &pair.pinion, &pair.gear, pair);
        self.check_clearance(MemberId::Gear, &pair.gear, &pair.pinion, pair);
        self.check_contact_ratio(pair);
        self.check_backlash(pair, fit);
        self.check_relief(pair);
    }

    fn check_interference(&mut self, id: MemberId, member: &Member, corner: &Corner<'_>, pair: &Pair) {
        let m = pair.spec.normal_module_m;
        let addendum = match id {
            MemberId::Pinion => pair.spec.pinion.addendum,
            MemberId::Gear => pair.spec.gear.addendum,
        };
        let field = SpecField::Member(id, GearField::Addendum);
        let cut = corner.fillet_cut_m() / m;
        if cut > FILLET_CUT_LIMIT && corner.passes_base_tangent() {
            let limit_m = corner.radius_with_cut_m(FILLET_CUT_LIMIT * m);
            let limit = addendum - (member.tip_radius_m - limit_m) / m;
            self.refuse(field, InfeasibilityReason::TipInterference { cut, addendum, limit });
        } else if cut > FILLET_CUT_LIMIT {
            self.refuse(field, InfeasibilityReason::FilletInterference { cut, limit: FILLET_CUT_LIMIT });
        } else if cut > FILLET_CUT_NOTICE {
            self.warn(field, WarningReason::FilletInterference { cut_m: cut * m });
        }
    }

    fn check_clearance(&mut self, id: MemberId, member: &Member, mate: &Member, pair: &Pair) {
        let clearance = (pair.center_distance_m - member.tip_radius_m - mate.root_radius_m) / pair.spec.normal_module_m;
        let field = SpecField::Member(id, GearField::Addendum);
        if clearance < 0.0 {
            self.refuse(field, InfeasibilityReason::NoTipClearance { clearance });
        } else if clearance < CLEARANCE_WARNING {
            self.warn(field, WarningReason::SmallTipClearance { clearance, limit: CLEARANCE_WARNING });
        }
    }

    /// Lines of contact must exist at every phase: the path of contact has a length, and transverse and overlap ratio
    /// together exceed 1.
    fn check_contact_ratio(&mut self, pair: &Pair) {
        let (transverse, overlap) = (pair.transverse_contact_ratio, pair.overlap_ratio);
        if transverse >= 1.0 {
            return;
        }
        // The tips alone would give enough: what shortens the path is the undercut of one member.
        let first_m = (pair.line_of_action_m - pair.gear.tip_roll_m()).max(0.0);
        let last_m = pair.pinion.tip_roll_m().min(pair.line_of_action_m);
        let undercut = pair.pinion.is_undercut() || pair.gear.is_undercut();
        let field = if last_m - first_m < pair.base_pitch_m || !undercut {
            SpecField::Member(MemberId::Pinion, GearField::Addendum)
        } else if pair.path_start_m - first_m >= last_m - pair.path_end_m {
            SpecField::Member(MemberId::Pinion, GearField::ProfileShift)
        } else {
            SpecField::Member(MemberId::Gear, GearField::ProfileShift)
        };
        let [shortest_m, _] = pair.contact_length_range_m();
        if transverse > 0.0 && shortest_m > 0.0 && pair.total_contact_ratio() > 1.0 {
            let shortest_over_mean = shortest_m / pair.mean_contact_length_m();
            self.warn(
                field,
                WarningReason::TransverseContactRatioBelowOne { transverse, overlap, undercut, shortest_over_mean },
            );
            return;
        }
        self.refuse(field, InfeasibilityReason::ContactRatioBelowOne { transverse, overlap, undercut });
    }

    fn check_backlash(&mut self, pair: &Pair, fit: &ZeroBacklashFit) {
        let backlash_m = pair.geometric_backlash_m;
        let limit_m = OVERLAP_LIMIT * pair.spec.normal_module_m;
        let field = center_distance_field(&pair.spec, fit);
        let fit = center_distance_fit(fit, pair.center_distance_m);
        if backlash_m < -limit_m {
            self.refuse(field, InfeasibilityReason::FlanksOverlap { backlash_m, limit_m, limit: OVERLAP_LIMIT });
        } else if backlash_m < -OVERLAP_NOTICE_M {
            self.warn(field, WarningReason::NegativeBacklash { backlash_m, fit });
        } else if backlash_m > BACKLASH_NOTICE * pair.spec.normal_module_m {
            self.warn(field, WarningReason::LargeBacklash { backlash_m, fit });
        }
    }

    /// Reasons that the pair would not have at the centre distance of its profile shifts are the centre distance's:
    /// they become one that names it, that distance, and the profile shifts that fit the one given. Its other reasons
    /// stay as they are there.
    pub(super) fn blame_center_distance(
        &mut self,
        without_backlash: Findings,
        pair: &Pair,
        fitting_pair: &Pair,
        fit: &ZeroBacklashFit,
    ) {
        let field = center_distance_field(&pair.spec, fit);
        let known = |found: &Infeasibility| {
            without_backlash
                .reasons
                .iter()
                .any(|r| discriminant(&r.reason) == discriminant(&found.reason) && r.field == found.field)
        };
        let reach = |pair: &Pair| pair.path_end_m - pair.path_start_m;
        let apart = reach(pair) <= 0.0 && reach(fitting_pair) > 0.0;
        let ratio_is_short =
            |found: &Infeasibility| matches!(found.reason, InfeasibilityReason::ContactRatioBelowOne { .. });
        let mut consequences: Vec<Consequence> = self
            .reasons
            .iter()
            .filter(|found| !known(found) || (apart && ratio_is_short(found)))
            .cloned()
            .map(Consequence::Infeasible)
            .collect();
        let backlash = pair.geometric_backlash_m / pair.spec.normal_module_m;
        let [working, fitting] = [pair, fitting_pair].map(|pair| pair.transverse_contact_ratio);
        if consequences.is_empty() && working < 1.0 && fitting >= 1.0 && backlash > BACKLASH_LIMIT {
            consequences.push(Consequence::ContactRatioLost { fitting, working, backlash, limit: BACKLASH_LIMIT });
        }
        if !consequences.is_empty() {
            let fitting_m = fit.center_distance_m.unwrap_or(fitting_pair.center_distance_m);
            let fit = center_distance_fit(fit, pair.center_distance_m);
            self.reasons = without_backlash.reasons;
            self.refuse(field, InfeasibilityReason::CenterDistanceDoesNotFit { fitting_m, fit, consequences });
            return;
        }
        let about_ratio =
            |warning: &Warning| matches!(warning.reason, WarningReason::TransverseContactRatioBelowOne { .. });
        if !without_backlash.warnings.iter().any(about_ratio) {
            self.warnings.iter_mut().filter(|warning| about_ratio(warning)).for_each(|warning| warning.field = field);
        }
    }

    fn check_relief(&mut self, pair: &Pair) {
        let path_m = pair.path_end_m - pair.path_start_m;
        for (member, gear) in MemberId::BOTH.into_iter().zip([&pair.spec.pinion, &pair.spec.gear]) {
            let length_m = gear.flanks.iter().map(|flank| flank.tip_relief.length_m).fold(0.0, f64::max);
            if length_m > path_m && path_m > 0.0 {
                self.warn(
                    SpecField::Member(member, GearField::TipReliefLength),
                    WarningReason::TipReliefOverWholePath { length_m, path_m },
                );
            }
        }
    }
}

/// The field that moves the axes away from the distance of the profile shifts: the stated centre distance, or its error
/// where that moves them further.
fn center_distance_field(spec: &PairSpec, fit: &ZeroBacklashFit) -> SpecField {
    let error_m = spec.assembly.center_distance_error_m.abs();
    let stated = spec.center_distance_m.is_some_and(|stated| {
        fit.center_distance_m.is_none_or(|fitting| error_m == 0.0 || (stated - fitting).abs() >= error_m)
    });
    if stated { SpecField::CenterDistance } else { SpecField::Assembly(AssemblyField::CenterDistanceError) }
}

fn center_distance_fit(fit: &ZeroBacklashFit, center_distance_m: f64) -> CenterDistanceFit {
    CenterDistanceFit {
        center_distance_m,
        shift_sum: fit.shift_sum,
        fitting_center_distance_m: fit.center_distance_m,
        fitting_shift_sum: fit.shift_sum_at(center_distance_m),
    }
}
