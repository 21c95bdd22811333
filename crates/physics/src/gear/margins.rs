//! How far a feasible pair stays from what would be warned of or refused.

use super::feasibility::{CLEARANCE_WARNING, MM, TIP_THICKNESS_WARNING};
use super::member::Member;
use super::pair::Pair;

/// A quantity that must stay above its limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Margin {
    /// What is meant: `tip-thickness`, `tip-clearance`, `profile-shift`, `active-profile`.
    pub code: &'static str,
    /// Whose: `pinion` or `gear`.
    pub member: &'static str,
    pub value: f64,
    pub limit: f64,
    pub unit: &'static str,
}

impl Pair {
    /// Margins of both members, in the same order for each.
    ///
    /// - `tip-thickness`: at the tip circle in the normal section; below the limit (usual practice) there is a warning.
    /// - `tip-clearance`: between the member's tip and the mate's root.
    /// - `profile-shift`: coefficient; below the limit the rack undercuts the tooth.
    /// - `active-profile`: diameter at which the mate's tip ends the contact (the base circle where the tip passes the base tangent
    ///   point); the involute starts at the limit, the root form circle (ISO 21771).
    pub fn margins(&self) -> Vec<Margin> {
        let mut margins = self.margins_of("pinion", &self.pinion, &self.gear);
        margins.extend(self.margins_of("gear", &self.gear, &self.pinion));
        margins
    }

    fn margins_of(&self, name: &'static str, member: &Member, mate: &Member) -> Vec<Margin> {
        let m = self.spec.normal_module_m;
        let margin = |code, value, limit, unit| Margin { code, member: name, value, limit, unit };
        let last_roll_m = (self.line_of_action_m - mate.tip_roll_m()).max(0.0);
        vec![
            margin("tip-thickness", member.normal_thickness_m(member.tip_radius_m) / m, TIP_THICKNESS_WARNING, "m_n"),
            margin(
                "tip-clearance",
                (self.center_distance_m - member.tip_radius_m - mate.root_radius_m) / m,
                CLEARANCE_WARNING,
                "m_n",
            ),
            margin("profile-shift", member.profile_shift, member.undercut_profile_shift, "1"),
            margin(
                "active-profile",
                2.0 * last_roll_m.hypot(member.base_radius_m) * MM,
                2.0 * member.root_form_radius_m * MM,
                "mm",
            ),
        ]
    }
}
