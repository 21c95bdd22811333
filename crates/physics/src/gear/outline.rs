//! The pair as it is drawn: outlines of the teeth in the transverse section and their positions in mesh.
//!
//! The section is drawn with the pitch point at the origin, the pinion's centre below it and the gear's above, and the
//! pinion turning clockwise: points of contact run from the base tangent point T1 at the lower left to T2 at the upper
//! right.

use super::lines::ContactLine;
use super::member::Member;
use super::pair::Pair;

/// Points on each root arc (half a space), fillet, involute and on the tip arc.
const ROOT_POINTS: u32 = 3;
const FILLET_POINTS: u32 = 12;
const INVOLUTE_POINTS: u32 = 16;
const TIP_POINTS: u32 = 5;

impl Member {
    /// Outline of one tooth with half a space on either side, in coordinates of the body: origin on the axis, the
    /// tooth's centreline along the first coordinate, counter-clockwise. Copies turned by multiples of `2 pi / z` make
    /// the gear.
    pub fn outline_m(&self) -> Vec<[f64; 2]> {
        let fraction = |i: u32, n: u32| f64::from(i) / f64::from(n);
        let (root, join, tip) = (self.root_radius_m, self.root_form_radius_m, self.tip_radius_m);
        let (root_angle, tip_angle) = (self.root_half_angle_rad(), self.half_angle_rad(tip));
        let half_pitch = std::f64::consts::PI / f64::from(self.teeth);
        let (join_roll, tip_roll) = (self.root_form_roll_m(), self.tip_roll_m());
        // Radius and angle from the centreline, from the middle of the space to the tip corner.
        let mut flank: Vec<[f64; 2]> = (0..ROOT_POINTS)
            .map(|i| [root, half_pitch + (root_angle - half_pitch) * fraction(i, ROOT_POINTS)])
            .collect();
        flank.push([root, root_angle]);
        // The fillet is tangent to the root circle: its points stand closer there.
        flank.extend((1..FILLET_POINTS).map(|i| {
            let r = root + (join - root) * fraction(i, FILLET_POINTS).powi(2);
            [r, self.half_angle_rad(r)]
        }));
        flank.extend((0..=INVOLUTE_POINTS).map(|i| {
            let roll = join_roll + (tip_roll - join_roll) * fraction(i, INVOLUTE_POINTS);
            let r = roll.hypot(self.base_radius_m);
            [r, self.half_angle_rad(r)]
        }));
        let tip_arc = (1..TIP_POINTS).map(|i| [tip, tip_angle * (2.0 * fraction(i, TIP_POINTS) - 1.0)]);
        let polar = |[r, angle]: [f64; 2]| [r * angle.cos(), r * angle.sin()];
        let rising = flank.iter().map(|&[r, angle]| polar([r, -angle]));
        rising.chain(tip_arc.map(polar)).chain(flank.iter().rev().map(|&point| polar(point))).collect()
    }
}

impl Pair {
    /// Working pitch radii of pinion and gear.
    pub fn pitch_radii_m(&self) -> [f64; 2] {
        [&self.pinion, &self.gear].map(|member| member.base_radius_m / self.working_pressure_angle_rad.cos())
    }

    /// The point of the line of action at roll coordinate `x_m`, in the section as drawn.
    pub fn action_point_m(&self, x_m: f64) -> [f64; 2] {
        let (sin, cos) = self.working_pressure_angle_rad.sin_cos();
        let from_pitch_point = x_m - self.pitch_point_m();
        [from_pitch_point * cos, from_pitch_point * sin]
    }

    /// Polar angles, about their own axes, of the centrelines of the pinion's and the gear's tooth that touch at roll
    /// coordinate `x_m`. The pinion turns by `-x / r_b1`, the gear by `+x / r_b2`.
    pub fn tooth_angles_rad(&self, x_m: f64) -> [f64; 2] {
        // Polar angle of T1 about the pinion's axis; T2 lies opposite about the gear's.
        let tangent = std::f64::consts::FRAC_PI_2 + self.working_pressure_angle_rad;
        let angle = |member: &Member, tangent: f64, roll_m: f64| {
            tangent + member.base_half_angle_rad - roll_m / member.base_radius_m
        };
        [
            angle(&self.pinion, tangent, x_m),
            angle(&self.gear, tangent - std::f64::consts::PI, self.line_of_action_m - x_m),
        ]
    }

    /// Roll coordinates of the points B and D, between which one pair alone touches in a transverse section; none where
    /// two or more always do, and where the path is shorter than a base pitch, so that never more than one does.
    pub fn single_contact_m(&self) -> Option<[f64; 2]> {
        let single = [self.path_end_m - self.base_pitch_m, self.path_start_m + self.base_pitch_m];
        (single[0] >= self.path_start_m && single[0] <= single[1]).then_some(single)
    }

    /// Mesh position `x0` at a phase of the mesh period; at phase 0 a pair is at its first contact at the mesh-in end.
    pub fn position_m(&self, phase: f64) -> f64 {
        let slant = self.spec.face_width_m * self.base_helix_angle_rad.tan();
        self.path_start_m - slant + phase * self.base_pitch_m
    }

    /// Lines of contact over the whole face width, not cut to the path of contact, at mesh position `x0_m`: of every
    /// pair that touches somewhere while the mesh goes on by up to `travel_m`.
    pub fn whole_lines(&self, x0_m: f64, travel_m: f64) -> Vec<ContactLine> {
        let b = self.spec.face_width_m;
        let slant = b * self.base_helix_angle_rad.tan();
        let first = ((self.path_start_m - slant - x0_m - travel_m) / self.base_pitch_m).ceil();
        let last = ((self.path_end_m - x0_m) / self.base_pitch_m).floor();
        (first as i32..=last as i32)
            .map(|pair| {
                let foot = x0_m + f64::from(pair) * self.base_pitch_m;
                ContactLine { pair, entry_m: [0.0, b], x_m: [foot, foot + slant] }
            })
            .collect()
    }
}
