//! Contact outside the path of contact: the tip corner of one member against the flank of the other.
//!
//! Exact kinematics in the transverse plane. The corner of the driven member's tip at polar angle `gamma` about its own
//! centre, from the line of centres, meets the mate's circle of radius `r'` at polar angle `phi`. The separation, along the
//! base tangent of the mate, is the mate's base radius times the angle by which its flank at `r'` still has to turn.

use super::member::Member;
use super::pair::Pair;

/// One tip corner outside its theoretical path: where it is and what it does to the line of action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerContact {
    /// Separation of corner and flank along the transverse base tangent of the flank's member.
    pub gap_m: f64,
    /// Turn of the corner's member from the end of the theoretical path to this position.
    pub corner_turn_rad: f64,
    /// Radius on the mate at which the corner meets its flank.
    pub flank_radius_m: f64,
    /// Inclination of the instantaneous line of action less the working pressure angle.
    pub theta_rad: f64,
    /// Effective base radius of the corner's member on the instantaneous line of action.
    pub effective_base_radius_m: f64,
}

/// A tip corner of `corner` against the flank of `mate`.
pub(super) struct Corner<'a> {
    corner: &'a Member,
    mate: &'a Member,
    center_distance_m: f64,
    working_pressure_angle_rad: f64,
    line_of_action_m: f64,
}

impl<'a> Corner<'a> {
    pub fn mesh_in(pair: &'a Pair) -> Corner<'a> {
        Corner::new(pair, &pair.gear, &pair.pinion)
    }

    pub fn mesh_out(pair: &'a Pair) -> Corner<'a> {
        Corner::new(pair, &pair.pinion, &pair.gear)
    }

    fn new(pair: &'a Pair, corner: &'a Member, mate: &'a Member) -> Corner<'a> {
        Corner {
            corner,
            mate,
            center_distance_m: pair.center_distance_m,
            working_pressure_angle_rad: pair.working_pressure_angle_rad,
            line_of_action_m: pair.line_of_action_m,
        }
    }

    /// Polar angle of the corner where its tip circle crosses the line of action.
    pub fn start_angle_rad(&self) -> f64 {
        let cos = self.corner.base_radius_m / self.corner.tip_radius_m;
        cos.clamp(-1.0, 1.0).acos() - self.working_pressure_angle_rad
    }

    /// Roll length of the mate at which the corner crosses the line of action.
    pub fn start_roll_m(&self) -> f64 {
        self.line_of_action_m - self.corner.tip_roll_m()
    }

    /// The corner after `turn_rad` away from the line of centres (negative: towards it).
    pub fn at(&self, turn_rad: f64) -> CornerContact {
        let (a, r_tip) = (self.center_distance_m, self.corner.tip_radius_m);
        let start = self.start_angle_rad();
        let gamma = start + turn_rad;
        // sin² of the half angle keeps a - r_tip cos(gamma) exact near the line of centres.
        let radius = ((a - r_tip).powi(2) + 4.0 * a * r_tip * (0.5 * gamma).sin().powi(2)).sqrt();
        let phi = (r_tip * gamma.sin()).atan2(a - r_tip * gamma.cos());
        let start_radius = self.start_roll_m().hypot(self.mate.base_radius_m);
        let phi_start = (r_tip * start.sin()).atan2(a - r_tip * start.cos());
        let ratio = f64::from(self.corner.teeth) / f64::from(self.mate.teeth);
        let start_half_angle =
            self.mate.base_half_angle_rad - super::involute::inv_at_radius(start_radius, self.mate.base_radius_m);
        let flank_ahead = start_half_angle - self.mate.half_angle_rad(radius);
        let gap = self.mate.base_radius_m * (ratio * turn_rad - (phi - phi_start) + flank_ahead);
        let inclination = phi + (self.mate.base_radius_m / radius).clamp(-1.0, 1.0).acos();
        CornerContact {
            gap_m: gap,
            corner_turn_rad: turn_rad,
            flank_radius_m: radius,
            theta_rad: inclination - self.working_pressure_angle_rad,
            effective_base_radius_m: a * inclination.cos() - self.mate.base_radius_m,
        }
    }

    /// Depth by which the corner would cut into the mate's tooth on its way from the start of the line of action to the line
    /// of centres (positive: it cuts). Only a fillet that rises above the conjugate path can be in its way.
    pub fn fillet_cut_m(&self) -> f64 {
        let start = self.start_angle_rad();
        (1..=FILLET_SAMPLES)
            .map(|i| -self.at(-start * f64::from(i) / f64::from(FILLET_SAMPLES)).gap_m)
            .fold(0.0, f64::max)
    }
}

/// Positions of the corner between the line of action and the line of centres at which its way is checked.
const FILLET_SAMPLES: u32 = 96;

impl Pair {
    /// The gear's tip corner before the start of contact, `overrun_m` of roll before the path starts, against the pinion's
    /// flank. `None` where the corner has no flank to meet: beyond the pinion's tip, or still below the usable involute.
    pub fn mesh_in_corner(&self, overrun_m: f64) -> Option<CornerContact> {
        let corner = Corner::mesh_in(self);
        let clipped = self.path_start_m - corner.start_roll_m();
        self.corner_contact(&corner, overrun_m - clipped)
    }

    /// The pinion's tip corner after the end of contact, `overrun_m` of roll after the path ends, against the gear's flank.
    /// Angles and the effective base radius are the pinion's.
    pub fn mesh_out_corner(&self, overrun_m: f64) -> Option<CornerContact> {
        let corner = Corner::mesh_out(self);
        let clipped = self.line_of_action_m - self.path_end_m - corner.start_roll_m();
        self.corner_contact(&corner, overrun_m - clipped)
    }

    fn corner_contact(&self, corner: &Corner<'_>, roll_m: f64) -> Option<CornerContact> {
        let turn = roll_m / corner.corner.base_radius_m;
        // Beyond a right angle from the line of centres the corner leaves the mate for good.
        if !(corner.start_angle_rad() + turn).abs().le(&std::f64::consts::FRAC_PI_2) {
            return None;
        }
        let contact = corner.at(turn);
        let on_flank = contact.flank_radius_m <= corner.mate.tip_radius_m
            && contact.flank_radius_m >= corner.mate.root_form_radius_m * (1.0 - 1e-12);
        on_flank.then_some(contact)
    }

    /// Kinematic gap of a contact outside the path of contact, `overrun_m >= 0` before its start: the gear's tip corner
    /// against the pinion flank, measured along the transverse base tangent of the pinion. The overrun is roll along the line
    /// of action: the gear stands `overrun_m / r_b2` before the start of contact.
    /// `None` where the corner has no flank to meet.
    pub fn mesh_in_corner_gap_m(&self, overrun_m: f64) -> Option<f64> {
        self.mesh_in_corner(overrun_m).map(|corner| corner.gap_m)
    }

    /// The same after the end of the path: the pinion's tip corner against the gear flank.
    pub fn mesh_out_corner_gap_m(&self, overrun_m: f64) -> Option<f64> {
        self.mesh_out_corner(overrun_m).map(|corner| corner.gap_m)
    }
}
