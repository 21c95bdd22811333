//! Flank modifications and assembly errors as initial gaps, in the transverse plane along the base tangent.

use super::pair::Pair;
use super::spec::{EndRelief, FlankModification, Half, ReliefShape, TipRelief};

impl TipRelief {
    /// Amount removed where the roll length still to go to the tip is `to_tip_m`; beyond the tip its full amount.
    fn at_m(&self, to_tip_m: f64) -> f64 {
        if self.length_m <= 0.0 {
            return 0.0;
        }
        let u = (1.0 - to_tip_m / self.length_m).clamp(0.0, 1.0);
        match self.shape {
            ReliefShape::Linear => self.amount_m * u,
            ReliefShape::Parabolic => self.amount_m * u * u,
        }
    }
}

impl EndRelief {
    /// Amount removed at axial station `y_m` of a half of width `face_width_m`.
    fn at_m(&self, y_m: f64, face_width_m: f64) -> f64 {
        if self.length_m <= 0.0 {
            return 0.0;
        }
        let from = |distance_m: f64| {
            let u = (1.0 - distance_m / self.length_m).clamp(0.0, 1.0);
            self.amount_m * u * u
        };
        from(y_m) + from(face_width_m - y_m)
    }
}

impl FlankModification {
    /// Amount removed at a point of the flank: roll length to go to the tip, axial station from the inner end.
    pub fn removed_m(&self, to_tip_m: f64, y_m: f64, face_width_m: f64) -> f64 {
        let across = 2.0 * y_m / face_width_m - 1.0;
        self.tip_relief.at_m(to_tip_m)
            + self.lead_crowning_m * across * across
            + self.helix_slope_m * y_m / face_width_m
            + self.end_relief.at_m(y_m, face_width_m)
    }
}

impl Pair {
    /// Initial gap between the flanks at a point of the plane of action, in the transverse plane along the base
    /// tangent: flank modifications of both members and the assembly errors, before load and apart from corner gaps.
    ///
    /// Assembly errors enter as follows.
    /// - Centre-distance error: no gap (an involute); it is in the geometry of the pair.
    /// - In-plane misalignment `f` (gap over one face width `b`): a tilt of the pinion's shaft in the plane of action
    ///   is one straight line through both halves. `f > 0`: left `f y/b`, right `f (1 - y/b)`; `f < 0`: left `|f| (1 -
    ///   y/b)`, right `|f| y/b`. What the line has risen from one half to the other is a constant per half, which the
    ///   floating pinion takes up axially.
    /// - Out-of-plane misalignment: an offset `e` of the axis across the line of action leaves an involute pair in
    ///   contact to first order. The second order is `e² / (2 T1T2)`, from the length of the crossed belt round the
    ///   base
    ///   circles; `e = f (y + gap/2) / b`, measured from the middle of the gap.
    /// - Apex offset `dz`: the flanks of the two hands shift against each other by `dz tan(beta_b)` along the
    ///   transverse base tangent: a gap on the left half for `dz > 0`, on the right for `dz < 0`. A pinion that floats
    ///   axially takes it up.
    pub fn initial_gap_m(&self, half: Half, x_m: f64, y_m: f64) -> f64 {
        let b = self.spec.face_width_m;
        let i = half.index();
        // Stations of a wider member are counted from its own inner end.
        let [pinion_y_m, gear_y_m] = [&self.pinion, &self.gear].map(|member| y_m + 0.5 * (member.face_width_m - b));
        let pinion_to_tip_m = self.pinion.tip_roll_m() - x_m;
        let pinion = self.spec.pinion.flanks[i].removed_m(pinion_to_tip_m, pinion_y_m, self.pinion.face_width_m);
        let gear_to_tip_m = self.gear.tip_roll_m() - (self.line_of_action_m - x_m);
        let gear = self.spec.gear.flanks[i].removed_m(gear_to_tip_m, gear_y_m, self.gear.face_width_m);
        pinion + gear + self.assembly_gap_m(half, y_m)
    }

    fn assembly_gap_m(&self, half: Half, y_m: f64) -> f64 {
        let assembly = &self.spec.assembly;
        let b = self.spec.face_width_m;
        let f = assembly.in_plane_misalignment_m;
        let outwards = (half == Half::Left) == (f >= 0.0);
        let in_plane = f.abs() * if outwards { y_m / b } else { 1.0 - y_m / b };
        let e = assembly.out_of_plane_misalignment_m * (y_m + 0.5 * self.spec.gap_width_m) / b;
        let out_of_plane = e * e / (2.0 * self.line_of_action_m);
        let shift = assembly.apex_offset_m * self.base_helix_angle_rad.tan();
        let apex = match half {
            Half::Left => shift.max(0.0),
            Half::Right => (-shift).max(0.0),
        };
        in_plane + out_of_plane + apex
    }
}
