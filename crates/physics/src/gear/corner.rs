//! Contact outside the path of contact: a corner of one member against the flank of the other.
//!
//! Exact standing in the transverse plane. A corner of one member (its tip edge; where undercut shortens the path, the
//! edge its involute starts with) at polar angle `gamma` about its own centre, from the line of centres, meets the
//! mate's circle of radius `r'` at polar angle `phi`. The separation, along the base tangent of the mate, is the mate's
//! base radius times the angle by which its flank at `r'` still has to turn.

use super::involute::inv_at_radius;
use super::member::Member;
use super::pair::Pair;

/// A corner contact outside the theoretical path: how far apart, and the instantaneous line of action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerContact {
    /// Separation of corner and flank along the transverse base tangent of the flank's member.
    pub gap_m: f64,
    /// Turn of the gear from the near end of the theoretical path to this position, positive away from it.
    pub gear_turn_rad: f64,
    /// Radius at which the corner meets the flank, on the flank's member.
    pub flank_radius_m: f64,
    /// Inclination of the instantaneous line of action less the working pressure angle; positive: steeper.
    pub theta_rad: f64,
    /// Distance of the instantaneous line of action from the pinion's axis: its base radius where its flank is touched.
    pub pinion_arm_m: f64,
    /// Distance of the instantaneous line of action from the gear's axis: its base radius where its flank is touched.
    pub gear_arm_m: f64,
}

/// The edge at `radius_m` of `corner` against the flank of `mate`.
pub(super) struct Corner<'a> {
    corner: &'a Member,
    radius_m: f64,
    mate: &'a Member,
    center_distance_m: f64,
    working_pressure_angle_rad: f64,
    line_of_action_m: f64,
}

/// Position of a corner relative to its mate.
struct CornerKinematics {
    gap_m: f64,
    flank_radius_m: f64,
    theta_rad: f64,
    arm_m: f64,
}

impl<'a> Corner<'a> {
    /// The gear's tip against the pinion.
    pub(super) fn mesh_in(pair: &'a Pair) -> Corner<'a> {
        Corner::new(pair, &pair.gear, pair.gear.tip_radius_m, &pair.pinion)
    }

    /// The pinion's tip against the gear.
    pub(super) fn mesh_out(pair: &'a Pair) -> Corner<'a> {
        Corner::new(pair, &pair.pinion, pair.pinion.tip_radius_m, &pair.gear)
    }

    fn new(pair: &'a Pair, corner: &'a Member, radius_m: f64, mate: &'a Member) -> Corner<'a> {
        Corner {
            corner,
            radius_m,
            mate,
            center_distance_m: pair.center_distance_m,
            working_pressure_angle_rad: pair.working_pressure_angle_rad,
            line_of_action_m: pair.line_of_action_m,
        }
    }

    /// Polar angle of the corner where its circle crosses the line of action.
    fn start_angle_rad(&self) -> f64 {
        (self.corner.base_radius_m / self.radius_m).clamp(-1.0, 1.0).acos() - self.working_pressure_angle_rad
    }

    /// Roll length of the mate at which the corner crosses the line of action; negative before the mate's base tangent
    /// point.
    fn start_roll_m(&self) -> f64 {
        self.line_of_action_m - self.corner.roll_length_m(self.radius_m)
    }

    /// The corner's member turned by `turn_rad` from where the corner crosses the line of action, positive away from
    /// the line of centres where the corner is a tip.
    fn at(&self, turn_rad: f64) -> CornerKinematics {
        let (a, r) = (self.center_distance_m, self.radius_m);
        let start = self.start_angle_rad();
        let gamma = start + turn_rad;
        let phi = |gamma: f64| (r * gamma.sin()).atan2(a - r * gamma.cos());
        // sin² of the half angle keeps a - r cos(gamma) exact near the line of centres.
        let flank_radius = ((a - r).powi(2) + 4.0 * a * r * (0.5 * gamma).sin().powi(2)).sqrt();
        let base = self.mate.base_radius_m;
        // Where the corner crosses the line of action before the base tangent point, the flank conjugate to its own is
        // the other branch of the involute.
        let start_roll_m = self.start_roll_m();
        let start_inv = inv_at_radius(start_roll_m.hypot(base), base);
        let start_half_angle = self.mate.base_half_angle_rad - if start_roll_m < 0.0 { -start_inv } else { start_inv };
        let flank_ahead = start_half_angle - self.mate.half_angle_rad(flank_radius);
        let ratio = f64::from(self.corner.teeth) / f64::from(self.mate.teeth);
        let inclination = phi(gamma) + (base / flank_radius).clamp(-1.0, 1.0).acos();
        CornerKinematics {
            gap_m: base * (ratio * turn_rad - (phi(gamma) - phi(start)) + flank_ahead),
            flank_radius_m: flank_radius,
            theta_rad: inclination - self.working_pressure_angle_rad,
            arm_m: a * inclination.cos() - base,
        }
    }

    /// The standing after `turn_rad`, if the corner then faces the usable flank of the mate. With `past_tip` the flank
    /// goes on past its tip by the separation itself: two edges that pass each other at that distance hand over without
    /// a break.
    fn on_flank(&self, turn_rad: f64, past_tip: bool) -> Option<CornerKinematics> {
        // Beyond a right angle from the line of centres the corner has left the mate for good.
        if (self.start_angle_rad() + turn_rad).abs() > std::f64::consts::FRAC_PI_2 {
            return None;
        }
        let kinematics = self.at(turn_rad);
        let low = self.mate.root_form_radius_m * (1.0 - ROUNDING);
        let beyond = if past_tip { kinematics.gap_m.max(0.0) } else { 0.0 };
        let high = self.mate.tip_radius_m * (1.0 + ROUNDING) + beyond;
        (low..=high).contains(&kinematics.flank_radius_m).then_some(kinematics)
    }

    /// The edge at another radius of the same member.
    fn with_radius(&self, radius_m: f64) -> Corner<'a> {
        Corner { radius_m, ..*self }
    }

    /// True where the corner's circle crosses the line of action before the mate's base tangent point, where the mate
    /// has no conjugate flank.
    pub(super) fn passes_base_tangent(&self) -> bool {
        self.radius_m > self.line_of_action_m.hypot(self.corner.base_radius_m)
    }

    /// Largest radius of the corner, between the pitch circle and its own, at which it cuts at most `depth_m` deep into
    /// the mate's tooth.
    pub(super) fn radius_with_cut_m(&self, depth_m: f64) -> f64 {
        let pitch_m = self.corner.base_radius_m / self.working_pressure_angle_rad.cos();
        let (mut low, mut high) = (pitch_m.min(self.radius_m), self.radius_m);
        for _ in 0..RADIUS_STEPS {
            let mid = 0.5 * (low + high);
            if self.with_radius(mid).fillet_cut_m() <= depth_m {
                low = mid;
            } else {
                high = mid;
            }
        }
        low
    }

    /// Depth by which the corner would cut into the mate's tooth, as its cutter has left it, on the way from the line
    /// of action to the line of centres (positive: it cuts). Only a fillet that rises above the conjugate path can be
    /// in its way; a corner that passes the base tangent point meets what is left of the flank near the base circle.
    pub(super) fn fillet_cut_m(&self) -> f64 {
        let start = self.start_angle_rad();
        (1..=FILLET_SAMPLES)
            .map(|i| -self.at(-start * f64::from(i) / f64::from(FILLET_SAMPLES)).gap_m)
            .fold(0.0, f64::max)
    }
}

impl CornerKinematics {
    /// The corner contact of the pair with the gear turned by `gear_turn_rad` from the end of its path; arms of pinion
    /// and gear.
    fn contact(&self, gear_turn_rad: f64, [pinion_arm_m, gear_arm_m]: [f64; 2]) -> CornerContact {
        CornerContact {
            gap_m: self.gap_m,
            gear_turn_rad,
            flank_radius_m: self.flank_radius_m,
            theta_rad: self.theta_rad,
            pinion_arm_m,
            gear_arm_m,
        }
    }
}

/// Relative rounding of radii at the ends of a flank.
const ROUNDING: f64 = 1e-12;

/// Positions of the corner between the line of action and the line of centres at which its way is checked.
const FILLET_SAMPLES: u32 = 96;

/// Bisections for the radius of a corner that cuts to a given depth.
const RADIUS_STEPS: u32 = 40;

impl Pair {
    /// Contact `overrun_m >= 0` of roll before the path of contact starts: the gear's tip corner against the pinion's
    /// flank; where the path starts at the pinion's form circle instead, the first point of the pinion's involute
    /// against the gear's flank until the gear's tip takes over. `None` where the corner has no flank to meet.
    pub fn mesh_in_corner(&self, overrun_m: f64) -> Option<CornerContact> {
        let tip = Corner::mesh_in(self);
        let edge = Corner::new(self, &self.pinion, self.pinion.root_form_radius_m, &self.gear);
        let clipped_m = self.path_start_m - tip.start_roll_m();
        let turn_rad = overrun_m / self.gear.base_radius_m;
        let by_tip = tip
            .on_flank((overrun_m - clipped_m) / self.gear.base_radius_m, false)
            .map(|s| s.contact(turn_rad, [self.pinion.base_radius_m, s.arm_m]));
        if clipped_m <= ROUNDING * self.line_of_action_m {
            return by_tip;
        }
        let by_edge = edge
            .on_flank(-overrun_m / self.pinion.base_radius_m, true)
            .map(|s| s.contact(turn_rad, [s.arm_m, self.gear.base_radius_m]));
        nearer(by_tip, by_edge)
    }

    /// The same `overrun_m` after the end of the path: the pinion's tip corner against the gear's flank, or the first
    /// point of the gear's involute against the pinion's.
    pub fn mesh_out_corner(&self, overrun_m: f64) -> Option<CornerContact> {
        let tip = Corner::mesh_out(self);
        let edge = Corner::new(self, &self.gear, self.gear.root_form_radius_m, &self.pinion);
        let clipped_m = self.line_of_action_m - self.path_end_m - tip.start_roll_m();
        let turn_rad = overrun_m / self.gear.base_radius_m;
        let by_tip = tip
            .on_flank((overrun_m - clipped_m) / self.pinion.base_radius_m, false)
            .map(|s| s.contact(turn_rad, [s.arm_m, self.gear.base_radius_m]));
        if clipped_m <= ROUNDING * self.line_of_action_m {
            return by_tip;
        }
        let by_edge = edge
            .on_flank(-overrun_m / self.gear.base_radius_m, true)
            .map(|s| s.contact(turn_rad, [self.pinion.base_radius_m, s.arm_m]));
        nearer(by_tip, by_edge)
    }

    /// Kinematic gap of a contact outside the path of contact, `overrun_m >= 0` before its start: the gear's tip corner
    /// against the pinion flank, measured along the transverse base tangent of the pinion. The overrun is roll along
    /// the line of action: the gear is `overrun_m / r_b2` before the start of contact. `None` where the corner has no
    /// flank to meet.
    pub fn mesh_in_corner_gap_m(&self, overrun_m: f64) -> Option<f64> {
        self.mesh_in_corner(overrun_m).map(|corner| corner.gap_m)
    }

    /// The same after the end of the path: the pinion's tip corner against the gear flank.
    pub fn mesh_out_corner_gap_m(&self, overrun_m: f64) -> Option<f64> {
        self.mesh_out_corner(overrun_m).map(|corner| corner.gap_m)
    }
}

fn nearer(a: Option<CornerContact>, b: Option<CornerContact>) -> Option<CornerContact> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if a.gap_m <= b.gap_m { a } else { b }),
        (a, b) => a.or(b),
    }
}
