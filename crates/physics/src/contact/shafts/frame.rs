//! Directions and levers of the tooth forces in the coordinates of the shafts.
//!
//! Right-handed x, y, z: x from the axis of the pinion to that of the gear, z along the shafts from left to right, the
//! apex plane at z = 0. With the sense of rotation σ (+1: the pinion turns positively about z) the base tangent along
//! which the pinion pushes the gear is d = (sin α_wt, σ cos α_wt, 0), through T1 = r_b1 (cos α_wt, −σ sin α_wt, 0) and
//! T1 + x d, x the roll coordinate. The force on the gear is along the flank normal n = cos β_b d − σ H sin β_b e_z, H
//! = +1 for a right-hand and −1 for a left-hand half of the pinion.

use crate::gear::{Half, Pair, Rotation};

/// Hand of a helix.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hand {
    /// Left-hand.
    Left,
    /// Right-hand.
    Right,
}

/// Sense of rotation about z of a pinion that drives with its drive flanks, +1 or −1: with a right-hand right half the
/// apex leads when it turns negatively.
pub fn sense_of_rotation(left_half: Hand, rotation: Rotation) -> f64 {
    let leading = match left_half {
        Hand::Left => -1.0,
        Hand::Right => 1.0,
    };
    match rotation {
        Rotation::ApexLeading => leading,
        Rotation::ApexTrailing => -leading,
    }
}

/// Force and moment (F_x, F_y, F_z, M_x, M_y, M_z), or displacement and rotation, of a section.
pub(crate) type Section = [f64; 6];

/// Tooth forces of a pair in the coordinates of its shafts.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFrame {
    /// Direction d in which the pinion pushes the gear: x and y.
    along: [f64; 2],
    /// T1 from the axis of the pinion: x and y.
    tangent_point_m: [f64; 2],
    center_distance_m: f64,
    cos_base_helix: f64,
    /// Axial component of the flank normal of either half.
    pub(super) axial: [f64; 2],
    /// Distance of the inner end of the common face from the apex plane, and its width.
    pub(super) inner_m: f64,
    pub(super) width_m: f64,
    apex_leading: bool,
    pub(super) pitch_point_m: f64,
    pub(super) path_m: [f64; 2],
}

/// A member of the pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Body {
    Pinion,
    Gear,
}

impl Body {
    pub(crate) const BOTH: [Body; 2] = [Body::Pinion, Body::Gear];
}

impl MeshFrame {
    /// The frame of `pair`, whose pinion turns in the sense `sense` about z and has a left half of the hand
    /// `left_half`. With `coast`, `pair` is the [coast pair](Pair::coast) of those gears: the pinion pushes the gear
    /// against its sense of rotation.
    pub fn new(pair: &Pair, sense: f64, left_half: Hand, coast: bool) -> MeshFrame {
        let sense = if coast { -sense } else { sense };
        let (sin, cos) = pair.working_pressure_angle_rad.sin_cos();
        let base_m = pair.pinion.base_radius_m;
        let left = match left_half {
            Hand::Left => -1.0,
            Hand::Right => 1.0,
        };
        let axial = -sense * left * pair.base_helix_angle_rad.sin();
        MeshFrame {
            along: [sin, sense * cos],
            tangent_point_m: [base_m * cos, -sense * base_m * sin],
            center_distance_m: pair.center_distance_m,
            cos_base_helix: pair.base_helix_angle_rad.cos(),
            axial: [axial, -axial],
            inner_m: 0.5 * pair.spec.gap_width_m,
            width_m: pair.spec.face_width_m,
            apex_leading: pair.spec.rotation == Rotation::ApexLeading,
            pitch_point_m: pair.pitch_point_m(),
            path_m: [pair.path_start_m, pair.path_end_m],
        }
    }

    /// Place along the shafts of a point of a half at the axial distance `entry_m` from the mesh-out end.
    pub(crate) fn z_m(&self, half: Half, entry_m: f64) -> f64 {
        let from_inner_m = if self.apex_leading { self.width_m - entry_m } else { entry_m };
        match half {
            Half::Left => -(self.inner_m + from_inner_m),
            Half::Right => self.inner_m + from_inner_m,
        }
    }

    /// Left and right end of the common face of both halves, from left to right.
    pub(super) fn face_ends_m(&self) -> [f64; 4] {
        let outer_m = self.inner_m + self.width_m;
        [-outer_m, -self.inner_m, self.inner_m, outer_m]
    }

    /// Middle of the face of a half.
    pub(crate) fn mid_face_m(&self, half: Half) -> f64 {
        self.z_m(half, 0.5 * self.width_m)
    }

    /// Load on a section of `body` by a unit force along the flank normal on the gear at the roll coordinate `x_m`, as
    /// if it acted on either body: (n, r × n). The same vector times the displacement of the section is the
    /// displacement of the contact point along n.
    pub(crate) fn load(&self, body: Body, half: Half, x_m: f64) -> Section {
        let n = [self.along[0] * self.cos_base_helix, self.along[1] * self.cos_base_helix, self.axial[half.index()]];
        let from_axis_m = match body {
            Body::Pinion => 0.0,
            Body::Gear => self.center_distance_m,
        };
        let r = [
            self.tangent_point_m[0] + x_m * self.along[0] - from_axis_m,
            self.tangent_point_m[1] + x_m * self.along[1],
        ];
        [n[0], n[1], n[2], r[1] * n[2], -r[0] * n[2], r[0] * n[1] - r[1] * n[0]]
    }

    /// cos β_b.
    pub(super) fn cos_base_helix(&self) -> f64 {
        self.cos_base_helix
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gear::fixtures::{pair, source_pair};
    use herringbone_oracle::check_worst;

    /// The moments of a unit normal force about both axes are its transverse part on the base circles, whatever the
    /// place on the path; the axial parts of the halves are opposite.
    #[test]
    fn moments_are_those_on_the_base_circles() {
        let pair = pair(&source_pair(1.0));
        let cos = pair.base_helix_angle_rad.cos();
        let mut errors = Vec::new();
        for (sense, hand) in [(1.0, Hand::Left), (-1.0, Hand::Left), (1.0, Hand::Right)] {
            let frame = MeshFrame::new(&pair, sense, hand, false);
            for x_m in [pair.path_start_m, pair.pitch_point_m(), pair.path_end_m] {
                let of = |body| frame.load(body, Half::Left, x_m)[5] * sense / cos;
                errors.push(of(Body::Pinion) / pair.pinion.base_radius_m - 1.0);
                errors.push(of(Body::Gear) / pair.gear.base_radius_m + 1.0);
            }
            assert_eq!(frame.load(Body::Pinion, Half::Left, 0.0)[2], -frame.load(Body::Pinion, Half::Right, 0.0)[2]);
        }
        check_worst("Shafts: directions of the tooth forces", "moments about both axes", errors, 1e-12);
    }

    /// An apex that leads presses the pinion's halves together: the force on the left half of the pinion, −n, points to
    /// the right.
    #[test]
    fn a_leading_apex_presses_the_pinion_halves_together() {
        let pair = pair(&source_pair(1.0));
        for hand in [Hand::Left, Hand::Right] {
            let sense = sense_of_rotation(hand, Rotation::ApexLeading);
            let frame = MeshFrame::new(&pair, sense, hand, false);
            assert!(-frame.axial[0] > 0.0 && -frame.axial[1] < 0.0);
        }
    }
}
