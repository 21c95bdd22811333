//! Margins of a feasible pair to its warnings and refusals.

use super::feasibility::{CLEARANCE_WARNING, TIP_THICKNESS_WARNING};
use super::findings::MemberId;
use super::member::Member;
use super::pair::Pair;

/// A quantity that must stay above its limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margin {
    /// The quantity.
    pub kind: MarginKind,
    /// The member.
    pub member: MemberId,
    /// Value: a coefficient of the normal module, or m for a radius.
    pub value: f64,
    /// Limit, in the same unit.
    pub limit: f64,
}

/// Quantities of a [`Margin`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarginKind {
    /// Thickness at the tip circle in the normal section, as a coefficient; below the limit (usual practice) there is a
    /// warning.
    TipThickness,
    /// Clearance between the member's tip and the mate's root, as a coefficient.
    TipClearance,
    /// Profile shift coefficient; below the limit the rack undercuts the tooth.
    ProfileShift,
    /// Radius at which the mate's tip ends the contact (the base circle where the tip passes the base tangent point),
    /// m; the involute starts at the limit, the root form circle (ISO 21771-1).
    ActiveProfileRadius,
}

impl Pair {
    /// Margins of both members, in the same order for each.
    pub fn margins(&self) -> Vec<Margin> {
        let mut margins = self.margins_of(MemberId::Pinion, &self.pinion, &self.gear);
        margins.extend(self.margins_of(MemberId::Gear, &self.gear, &self.pinion));
        margins
    }

    fn margins_of(&self, id: MemberId, member: &Member, mate: &Member) -> Vec<Margin> {
        let m = self.spec.normal_module_m;
        let margin = |kind, value, limit| Margin { kind, member: id, value, limit };
        let last_roll_m = (self.line_of_action_m - mate.tip_roll_m()).max(0.0);
        vec![
            margin(MarginKind::TipThickness, member.normal_thickness_m(member.tip_radius_m) / m, TIP_THICKNESS_WARNING),
            margin(
                MarginKind::TipClearance,
                (self.center_distance_m - member.tip_radius_m - mate.root_radius_m) / m,
                CLEARANCE_WARNING,
            ),
            margin(MarginKind::ProfileShift, member.profile_shift, member.undercut_profile_shift),
            margin(MarginKind::ActiveProfileRadius, last_roll_m.hypot(member.base_radius_m), member.root_form_radius_m),
        ]
    }
}
