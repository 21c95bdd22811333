//! The surface of the tooth: where rows and columns of elements meet it.

use super::input::FeError;
use crate::gear::Member;

/// The involute flank by arc length from the form point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct InvoluteFlank {
    /// Base radius.
    pub base_radius_m: f64,
    /// Half angle of the tooth at the base circle.
    pub base_half_angle_rad: f64,
    /// Roll length at the form point.
    pub form_roll_m: f64,
    /// Arc length from the form point to the tip.
    pub length_m: f64,
}

impl InvoluteFlank {
    /// The flank of a member.
    pub(super) fn new(member: &Member) -> Result<InvoluteFlank, FeError> {
        let form_roll_m = member.root_form_roll_m();
        let tip_roll_m = member.tip_roll_m();
        let length_m = (tip_roll_m - form_roll_m) * (tip_roll_m + form_roll_m) / (2.0 * member.base_radius_m);
        if length_m.is_nan() || length_m <= 0.0 {
            return Err(FeError::Form { what: "the length of the usable flank", value_m: length_m });
        }
        Ok(InvoluteFlank {
            base_radius_m: member.base_radius_m,
            base_half_angle_rad: member.base_half_angle_rad,
            form_roll_m,
            length_m,
        })
    }

    /// Roll length at arc length `s`: s = (ρ² - ρ_form²)/(2 r_b).
    pub(super) fn roll_m(&self, s_m: f64) -> f64 {
        (self.form_roll_m * self.form_roll_m + 2.0 * self.base_radius_m * s_m).sqrt()
    }

    /// Point (x, y) of the loaded flank and the unit normal into the tooth, in the section.
    pub(super) fn at(&self, s_m: f64) -> ([f64; 2], [f64; 2]) {
        let roll = self.roll_m(s_m);
        let angle = roll / self.base_radius_m;
        // The flank's point lies at the end of the tangent of length roll; its normal is the tangent's direction.
        let tangent_point = self.base_half_angle_rad - angle;
        // Angle from the tooth's centreline, growing towards the loaded flank: x = r sin, y = r cos.
        let (sin, cos) = tangent_point.sin_cos();
        let r = self.base_radius_m;
        ([r * sin + roll * cos, r * cos - roll * sin], [-cos, sin])
    }
}

/// Slope of the surface at which rows end and columns begin.
const TURN: f64 = 1.0;

/// Radius at which the fillet's surface leans by 45°; at most the form radius.
pub(super) fn turning_radius_m(member: &Member, m: f64) -> f64 {
    let (root, form) = (member.root_radius_m, member.root_form_radius_m);
    // r dψ/dr rises from minus infinity at the root circle.
    let steep = |r: f64| {
        let h = (1e-5 * m).min(0.25 * (r - root));
        r * (member.half_angle_rad(r + h) - member.half_angle_rad(r - h)) / (2.0 * h) < -TURN
    };
    const STEPS: usize = 200;
    let at = |i: usize| {
        let t = i as f64 / STEPS as f64;
        root + (form - root) * t * t
    };
    for i in 1..=STEPS {
        let r = if i == STEPS { form - 1e-5 * m } else { at(i) };
        if !steep(r) {
            let (mut low, mut high) = (at(i - 1), r);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if middle > root && steep(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            return high;
        }
    }
    form
}

/// Radii of the rows of nodes from the tip to the turning point.
pub(super) fn row_radii_m(
    member: &Member,
    involute: &InvoluteFlank,
    turn: f64,
    m: f64,
    profile_m: &[f64],
    rows_per_cell: &[usize],
    fillet_rows: usize,
) -> Vec<f64> {
    let rb = member.base_radius_m;
    let mut radii = Vec::new();
    for (cell, rows) in profile_m.windows(2).rev().zip(rows_per_cell) {
        for i in 0..2 * rows {
            let s = cell[1] + (cell[0] - cell[1]) * i as f64 / (2 * rows) as f64;
            radii.push(involute.roll_m(s).hypot(rb));
        }
    }
    let form = member.root_form_radius_m;
    radii.push(form);
    if form - turn > 2e-3 * m {
        // Even in arc length along the fillet.
        const STEPS: usize = 400;
        let mut lengths = vec![0.0];
        let at = |i: usize| form + (turn - form) * i as f64 / STEPS as f64;
        for i in 1..=STEPS {
            let (r0, r1) = (at(i - 1), at(i));
            let across = 0.5 * (r0 + r1) * (member.half_angle_rad(r0) - member.half_angle_rad(r1));
            lengths.push(lengths[i - 1] + (r0 - r1).hypot(across));
        }
        let count = 2 * fillet_rows;
        for k in 1..count {
            let i = position(&lengths, lengths[STEPS] * k as f64 / count as f64);
            radii.push(form + (turn - form) * i / STEPS as f64);
        }
        radii.push(turn);
    }
    radii
}

/// Fractional index at which the rising `table` reaches `value`.
fn position(table: &[f64], value: f64) -> f64 {
    let i = table.partition_point(|&t| t < value).clamp(1, table.len() - 1);
    i as f64 - 1.0 + (value - table[i - 1]) / (table[i] - table[i - 1])
}

/// Surface points (radius, angle) from just beyond the turning point to the middle of the space: rest of the fillet and
/// root land, even in arc length.
pub(super) fn land_points(member: &Member, turn: f64, count: usize) -> Vec<(f64, f64)> {
    const STEPS: usize = 400;
    let root = member.root_radius_m;
    let end = std::f64::consts::PI / f64::from(member.teeth);
    let mut line = Vec::with_capacity(STEPS + 2);
    for i in 0..=STEPS {
        // Even steps near the root circle, which the fillet touches.
        let t = 1.0 - i as f64 / STEPS as f64;
        let r = root + (turn - root) * t * t;
        line.push((r, member.half_angle_rad(r)));
    }
    line.push((root, end));
    let mut lengths = vec![0.0];
    for pair in line.windows(2) {
        let across = 0.5 * (pair[0].0 + pair[1].0) * (pair[1].1 - pair[0].1);
        lengths.push(lengths[lengths.len() - 1] + (pair[1].0 - pair[0].0).hypot(across));
    }
    let total = lengths[lengths.len() - 1];
    (1..=count)
        .map(|k| {
            if k == count {
                return (root, end);
            }
            let at = position(&lengths, total * k as f64 / count as f64);
            let i = (at as usize).min(line.len() - 2);
            let t = at - i as f64;
            let (a, b) = (line[i], line[i + 1]);
            (a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t)
        })
        .collect()
}
