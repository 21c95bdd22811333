//! What makes a design infeasible and what an engineer should know about it.
//!
//! Values and limits carry the units of the job document, which the pointers name. Checks run in three steps (stated
//! values, teeth of each member, engagement); a step that needs the result of a failed one is left out, everything else
//! is reported at once.

use super::corner::Corner;
use super::member::Member;
use super::pair::{Fit, Pair};
use super::spec::{Infeasibility, PairSpec, Warning};
use super::tooth::Cutter;

/// Thinnest tip, in normal modules, that is accepted without a warning (usual practice; 0.4 when case-hardened).
pub(super) const TIP_THICKNESS_WARNING: f64 = 0.2;
/// Tip clearance, in normal modules, below which a warning is given (ISO 53 racks leave 0.25, the usual least is 0.1).
pub(super) const CLEARANCE_WARNING: f64 = 0.1;
/// Rim thickness over tooth height below which a tooth root sees the rim (ISO 6336-3, rim thickness factor above 1).
const RIM_WARNING: f64 = 1.2;
/// Depth, in normal modules, to which a tip corner may dip into the mate's nominal fillet before the design is refused:
/// below it tolerances, tip edge breaks and play decide, and a warning is given.
pub(super) const FILLET_CUT_LIMIT: f64 = 0.02;
/// Cut into the fillet, in normal modules, that is taken as none (rounding of the sampled path).
const FILLET_CUT_NOTICE: f64 = 1e-6;
/// Negative play along the base tangent that is not yet reported: below the resolution of gear inspection.
const JAM_NOTICE_M: f64 = 1e-6;
/// Negative play along the base tangent, in normal modules, beyond which the design is refused: thinner teeth make up for it, and no
/// thickness allowance is larger (the least backlash of ISO/TR 10064-2 for the centre distance and module stays below it).
const JAM_LIMIT: f64 = 0.1;
/// Play along the base tangent, in normal modules, beyond which a given centre distance that takes the transverse contact ratio below 1
/// is refused: no thickness allowance or axis tolerance asks for such a play.
const PLAY_LIMIT: f64 = 0.5;
/// Teeth of nominal thickness overlap by more than [`JAM_LIMIT`].
const FLANKS_OVERLAP: &str = "flanks-overlap";
/// Play along the base tangent, in normal modules, above which the given centre distance is reported as not belonging to the
/// profile shifts (backlash allowances of ISO/TR 10064-2 stay below it).
const PLAY_NOTICE: f64 = 0.1;

pub(super) const MM: f64 = 1e3;
pub(super) const UM: f64 = 1e6;

/// Everything found so far.
#[derive(Debug, Default)]
pub(super) struct Findings {
    pub reasons: Vec<Infeasibility>,
    pub warnings: Vec<Warning>,
}

impl Findings {
    pub fn refuse(&mut self, code: &str, pointer: String, detail: String, value: f64, limit: f64, unit: &str) {
        self.reasons.push(Infeasibility { code: code.into(), pointer, detail, value, limit, unit: unit.into() });
    }

    /// Takes over what another check found.
    pub fn add(&mut self, other: Findings) {
        self.reasons.extend(other.reasons);
        self.warnings.extend(other.warnings);
    }

    fn warn(&mut self, code: &str, pointer: String, detail: String) {
        self.warnings.push(Warning { code: code.into(), pointer, detail });
    }

    /// The cutter's tip rounding must fit its tip; a larger one is reduced to what fits, so that the rest can be checked.
    pub fn check_cutter(&mut self, side: &str, cutter: &mut Cutter) {
        let limit = cutter.fillet_radius_limit();
        if limit < 0.0 {
            self.refuse(
                "rack-tip-pointed",
                format!("/design/{side}/dedendum"),
                format!(
                    "the rack that cuts the {side} is pointed before it reaches a dedendum of {} m_n",
                    cutter.dedendum
                ),
                cutter.dedendum,
                std::f64::consts::FRAC_PI_4 / cutter.normal_pressure_angle_rad.tan(),
                "m_n",
            );
        } else if cutter.fillet_radius > limit {
            self.refuse(
                "fillet-radius-too-large",
                format!("/design/{side}/fillet_radius"),
                format!(
                    "a tip rounding of {} m_n does not fit the rack that cuts the {side}: at most {limit:.4} m_n",
                    cutter.fillet_radius
                ),
                cutter.fillet_radius,
                limit,
                "m_n",
            );
        }
        cutter.fillet_radius = cutter.fillet_radius.min(limit.max(0.0));
        let root_m = cutter.root_radius_m();
        if root_m < 0.05 * cutter.normal_module_m {
            self.refuse(
                "root-circle-vanishes",
                format!("/design/{side}/dedendum"),
                format!("the root circle of the {side} has a radius of {:.4} mm", root_m * MM),
                root_m * MM,
                0.05 * cutter.normal_module_m * MM,
                "mm",
            );
        }
    }

    /// The teeth of one member, whatever it meshes with.
    pub fn check_member(&mut self, side: &str, member: &Member, spec: &PairSpec) {
        let m = spec.normal_module_m;
        let least = member.root_form_radius_m.max(member.base_radius_m);
        if member.tip_radius_m <= least {
            self.refuse(
                "no-involute",
                format!("/design/{side}/addendum"),
                format!(
                    "the {side} has no involute flank: its tip radius {:.4} mm is not above {:.4} mm, where the flank starts",
                    member.tip_radius_m * MM,
                    least * MM
                ),
                member.tip_radius_m * MM,
                least * MM,
                "mm",
            );
        } else {
            self.check_tip_thickness(side, member, m);
        }
        let waist = member.root_half_angle_rad().min(member.waist_half_angle_rad());
        if waist <= 0.0 {
            self.refuse(
                "tooth-cut-off",
                format!("/design/{side}/teeth"),
                format!("the cutter leaves no tooth on the {side}: undercut takes its whole thickness"),
                waist * 2.0 * member.root_form_radius_m / m,
                0.0,
                "m_n",
            );
        }
        if member.is_undercut() {
            self.warn(
                "undercut",
                format!("/design/{side}/profile_shift"),
                format!(
                    "the {side} is undercut: its profile shift {:.4} is below {:.4}; the involute starts at {:.4} mm diameter",
                    member.profile_shift,
                    member.undercut_profile_shift,
                    2.0 * member.root_form_radius_m * MM
                ),
            );
        }
        self.check_bore(side, member);
    }

    fn check_tip_thickness(&mut self, side: &str, member: &Member, normal_module_m: f64) {
        let thickness = member.normal_thickness_m(member.tip_radius_m) / normal_module_m;
        if thickness <= 0.0 {
            self.refuse(
                "pointed-tip",
                format!("/design/{side}/addendum"),
                format!("the {side}'s tooth ends pointed below its tip circle: tip thickness {thickness:.4} m_n"),
                thickness,
                0.0,
                "m_n",
            );
        } else if thickness < TIP_THICKNESS_WARNING {
            self.warn(
                "thin-tip",
                format!("/design/{side}/addendum"),
                format!("the {side}'s tip is {thickness:.4} m_n thick in the normal section, less than {TIP_THICKNESS_WARNING} m_n"),
            );
        }
    }

    fn check_bore(&mut self, side: &str, member: &Member) {
        let rim = member.root_radius_m - member.bore_radius_m;
        if rim <= 0.0 {
            self.refuse(
                "bore-too-large",
                format!("/design/{side}/bore_diameter_mm"),
                format!(
                    "the bore of the {side}, {:.4} mm, reaches the root circle of {:.4} mm",
                    2.0 * member.bore_radius_m * MM,
                    2.0 * member.root_radius_m * MM
                ),
                2.0 * member.bore_radius_m * MM,
                2.0 * member.root_radius_m * MM,
                "mm",
            );
        } else if rim < RIM_WARNING * (member.tip_radius_m - member.root_radius_m) {
            self.warn(
                "thin-rim",
                format!("/design/{side}/bore_diameter_mm"),
                format!(
                    "the rim of the {side} is {:.4} mm thick, less than {RIM_WARNING} tooth heights: its teeth are softer than those of a solid gear",
                    rim * MM
                ),
            );
        }
    }

    /// Working centre distance with its error, or `None` when no line of action exists.
    pub fn center_distance_m(&mut self, spec: &PairSpec, base_sum_m: f64, fit: &Fit) -> Option<f64> {
        let nominal = match (spec.center_distance_m, fit.center_distance_m) {
            (Some(a), _) => a,
            (None, Some(a)) => a,
            (None, None) => {
                let sum = fit.shift_sum;
                let z = f64::from(spec.pinion.teeth + spec.gear.teeth);
                let alpha_t = (spec.normal_pressure_angle_rad.tan() / spec.helix_angle_rad.cos()).atan();
                let limit = -super::involute::inv(alpha_t) * z / (2.0 * spec.normal_pressure_angle_rad.tan());
                self.refuse(
                    "profile-shift-sum-too-small",
                    "/design/pinion/profile_shift".into(),
                    format!("no centre distance brings both flanks into contact: the profile shifts add up to {sum:.4}, at least {limit:.4} is needed"),
                    sum,
                    limit,
                    "m_n",
                );
                return None;
            }
        };
        let working = nominal + spec.assembly.center_distance_error_m;
        if working > base_sum_m * (1.0 + 1e-9) {
            return Some(working);
        }
        self.refuse(
            "center-distance-too-small",
            center_distance_pointer(spec, fit),
            format!(
                "the working centre distance {:.4} mm is not above the sum of the base radii, {:.4} mm, at any profile shifts; {}",
                working * MM,
                base_sum_m * MM,
                fitting(fit, working)
            ),
            working * MM,
            base_sum_m * MM,
            "mm",
        );
        None
    }

    /// The engagement of the two members.
    pub fn check_pair(&mut self, pair: &Pair, fit: &Fit) {
        self.check_interference("gear", "pinion", &pair.gear, &Corner::mesh_in(pair), pair);
        self.check_interference("pinion", "gear", &pair.pinion, &Corner::mesh_out(pair), pair);
        self.check_clearance("pinion", "gear", &pair.pinion, &pair.gear, pair);
        self.check_clearance("gear", "pinion", &pair.gear, &pair.pinion, pair);
        self.check_contact_ratio(pair);
        self.check_play(pair, fit);
        self.check_relief(pair);
    }

    fn check_interference(&mut self, side: &str, other: &str, member: &Member, corner: &Corner<'_>, pair: &Pair) {
        let m = pair.spec.normal_module_m;
        let at_tip = if side == "pinion" { &pair.spec.pinion } else { &pair.spec.gear };
        let pointer = format!("/design/{side}/addendum");
        let cut = corner.fillet_cut_m() / m;
        if cut > FILLET_CUT_LIMIT && corner.passes_base_tangent() {
            let limit_m = corner.radius_with_cut_m(FILLET_CUT_LIMIT * m);
            let limit = at_tip.addendum - (member.tip_radius_m - limit_m) / m;
            self.refuse(
                "tip-interference",
                pointer,
                format!(
                    "the {side}'s tip passes the point where the line of action leaves the {other}'s base circle and cuts {cut:.4} m_n deep into what the cutter has left standing there: addendum {:.4} m_n, at most {limit:.4} m_n",
                    at_tip.addendum
                ),
                at_tip.addendum,
                limit,
                "m_n",
            );
        } else if cut > FILLET_CUT_LIMIT {
            self.refuse(
                "fillet-interference",
                pointer,
                format!("the {side}'s tip cuts {cut:.4} m_n deep into the {other}'s root fillet, more than {FILLET_CUT_LIMIT} m_n"),
                cut,
                FILLET_CUT_LIMIT,
                "m_n",
            );
        } else if cut > FILLET_CUT_NOTICE {
            self.warn(
                "fillet-interference",
                pointer,
                format!(
                    "the {side}'s tip dips {:.2} um into the {other}'s nominal root fillet: the tips need an edge break or the root more depth",
                    cut * m * UM
                ),
            );
        }
    }

    fn check_clearance(&mut self, side: &str, other: &str, member: &Member, mate: &Member, pair: &Pair) {
        let clearance = (pair.center_distance_m - member.tip_radius_m - mate.root_radius_m) / pair.spec.normal_module_m;
        let pointer = format!("/design/{side}/addendum");
        if clearance < 0.0 {
            self.refuse(
                "no-tip-clearance",
                pointer,
                format!("the {side}'s tip reaches {:.4} m_n into the {other}'s root circle", -clearance),
                clearance,
                0.0,
                "m_n",
            );
        } else if clearance < CLEARANCE_WARNING {
            self.warn(
                "small-tip-clearance",
                pointer,
                format!("between the {side}'s tip and the {other}'s root {clearance:.4} m_n are left, less than {CLEARANCE_WARNING} m_n"),
            );
        }
    }

    /// Lines of contact must exist at every phase: the path of contact has a length, and transverse and overlap ratio together exceed 1.
    fn check_contact_ratio(&mut self, pair: &Pair) {
        let (ratio, overlap) = (pair.transverse_contact_ratio, pair.overlap_ratio);
        if ratio >= 1.0 {
            return;
        }
        // The tips alone would give enough: what shortens the path is the undercut of one member.
        let first_m = (pair.line_of_action_m - pair.gear.tip_roll_m()).max(0.0);
        let last_m = pair.pinion.tip_roll_m().min(pair.line_of_action_m);
        let undercut = pair.pinion.is_undercut() || pair.gear.is_undercut();
        let pointer = if last_m - first_m < pair.base_pitch_m || !undercut {
            "/design/pinion/addendum"
        } else if pair.path_start_m - first_m >= last_m - pair.path_end_m {
            "/design/pinion/profile_shift"
        } else {
            "/design/gear/profile_shift"
        };
        let why = if undercut { ", undercut included" } else { "" };
        let [shortest_m, _] = pair.contact_length_range_m();
        if ratio > 0.0 && shortest_m > 0.0 && pair.total_contact_ratio() > 1.0 {
            self.warn(
                "transverse-contact-ratio-below-one",
                pointer.into(),
                format!(
                    "the transverse contact ratio is {ratio:.4}{why}, below 1: in a transverse section no teeth touch during a part of the mesh period; the overlap ratio {overlap:.4} keeps lines of contact at every phase, the shortest {:.1} % of their mean",
                    100.0 * shortest_m / pair.mean_contact_length_m()
                ),
            );
            return;
        }
        let (value, sum) = if ratio > 0.0 && overlap > 0.0 {
            let total = pair.total_contact_ratio();
            (total, format!(", with the overlap ratio {overlap:.4} together {total:.4}"))
        } else {
            (ratio, String::new())
        };
        self.refuse(
            "contact-ratio-below-one",
            pointer.into(),
            format!("the transverse contact ratio is {ratio:.4}{why}{sum}; below 1 the teeth do not hand over: lines of contact are missing during a part of the mesh period"),
            value,
            1.0,
            "1",
        );
    }

    fn check_play(&mut self, pair: &Pair, fit: &Fit) {
        let play = pair.geometric_backlash_m;
        let limit = JAM_LIMIT * pair.spec.normal_module_m;
        let pointer = center_distance_pointer(&pair.spec, fit);
        if play < -limit {
            self.refuse(
                FLANKS_OVERLAP,
                pointer,
                format!(
                    "teeth of nominal thickness overlap by {:.1} um along the base tangent, more than {:.1} um ({JAM_LIMIT} m_n), which thinner teeth could make up for",
                    -play * UM,
                    limit * UM
                ),
                play * MM,
                -limit * MM,
                "mm",
            );
        } else if play < -JAM_NOTICE_M {
            self.warn(
                "negative-play",
                pointer,
                format!(
                    "at the working centre distance {:.4} mm teeth of nominal thickness overlap by {:.1} um along the base tangent: they must be thinner by that and the play; {}",
                    pair.center_distance_m * MM,
                    -play * UM,
                    fitting(fit, pair.center_distance_m)
                ),
            );
        } else if play > PLAY_NOTICE * pair.spec.normal_module_m {
            self.warn(
                "large-play",
                pointer,
                format!(
                    "at the working centre distance {:.4} mm teeth of nominal thickness have {:.0} um play along the base tangent; the dynamics take the play stated as backlash_um; {}",
                    pair.center_distance_m * MM,
                    play * UM,
                    fitting(fit, pair.center_distance_m)
                ),
            );
        }
    }

    /// Reasons that the pair would not have at the centre distance of its profile shifts are the centre distance's: they become one
    /// that names it, that distance, and the profile shifts that fit the one given. Its other reasons are told as they are there.
    pub fn blame_center_distance(&mut self, without_play: Findings, pair: &Pair, fitting_pair: &Pair, fit: &Fit) {
        let pointer = center_distance_pointer(&pair.spec, fit);
        let known = |reason: &Infeasibility| {
            without_play.reasons.iter().any(|r| r.code == reason.code && r.pointer == reason.pointer)
        };
        let reach = |pair: &Pair| pair.path_end_m - pair.path_start_m;
        let apart = reach(pair) <= 0.0 && reach(fitting_pair) > 0.0;
        let mut consequences: Vec<String> = self
            .reasons
            .iter()
            .filter(|reason| !known(reason) || (apart && reason.code == "contact-ratio-below-one"))
            .map(|reason| reason.detail.clone())
            .collect();
        let play = pair.geometric_backlash_m / pair.spec.normal_module_m;
        let [ratio, without] = [pair, fitting_pair].map(|pair| pair.transverse_contact_ratio);
        if consequences.is_empty() && ratio < 1.0 && without >= 1.0 && play > PLAY_LIMIT {
            consequences.push(format!(
                "the transverse contact ratio falls from {without:.4} to {ratio:.4}, and the teeth have {play:.3} m_n play along the base tangent, more than {PLAY_LIMIT} m_n"
            ));
        }
        if !consequences.is_empty() {
            let limit = fit.center_distance_m.unwrap_or(fitting_pair.center_distance_m) * MM;
            let detail = format!(
                "the working centre distance {:.4} mm does not belong to the profile shifts; {}. At {:.4} mm: {}",
                pair.center_distance_m * MM,
                fitting(fit, pair.center_distance_m),
                pair.center_distance_m * MM,
                consequences.join("; ")
            );
            self.reasons = without_play.reasons;
            self.refuse("center-distance-does-not-fit", pointer, detail, pair.center_distance_m * MM, limit, "mm");
            return;
        }
        const RATIO: &str = "transverse-contact-ratio-below-one";
        if !without_play.warnings.iter().any(|warning| warning.code == RATIO) {
            self.warnings.iter_mut().filter(|w| w.code == RATIO).for_each(|w| w.pointer.clone_from(&pointer));
        }
    }

    fn check_relief(&mut self, pair: &Pair) {
        let path = pair.path_end_m - pair.path_start_m;
        for (side, gear) in [("pinion", &pair.spec.pinion), ("gear", &pair.spec.gear)] {
            let longest = gear.flanks.iter().map(|flank| flank.tip_relief.length_m).fold(0.0, f64::max);
            if longest > path && path > 0.0 {
                self.warn(
                    "tip-relief-over-whole-path",
                    format!("/design/{side}/tip_relief/length_mm"),
                    format!(
                        "the tip relief of the {side} is {:.4} mm long, the path of contact only {:.4} mm",
                        longest * MM,
                        path * MM
                    ),
                );
            }
        }
    }
}

/// The field that moves the axes away from the distance of the profile shifts: the stated centre distance, or its error where
/// that moves them further.
fn center_distance_pointer(spec: &PairSpec, fit: &Fit) -> String {
    let error_m = spec.assembly.center_distance_error_m.abs();
    let stated = spec.center_distance_m.is_some_and(|stated| {
        fit.center_distance_m.is_none_or(|fitting| error_m == 0.0 || (stated - fitting).abs() >= error_m)
    });
    format!("/design/{}", if stated { "center_distance_mm" } else { "assembly/center_distance_error_um" })
}

/// What fits: the centre distance of the given profile shifts, the profile shifts of the given centre distance.
fn fitting(fit: &Fit, center_distance_m: f64) -> String {
    let sum = fit.shift_sum;
    let distance = match fit.center_distance_m {
        Some(a) => format!("the given profile shifts add up to {sum:.4} and fit {:.4} mm without play", a * MM),
        None => format!("the given profile shifts add up to {sum:.4} and fit no centre distance"),
    };
    let shifts = match fit.shift_sum_at(center_distance_m) {
        Some(sum) => format!("{:.4} mm fits a sum of {sum:.4}", center_distance_m * MM),
        None => format!("no sum fits {:.4} mm", center_distance_m * MM),
    };
    format!("{distance}; {shifts}")
}
