//! Points of possible contact at one position: every tooth pair cut into the width slices, with the parts of a slice
//! before, on and after the path of contact kept apart.

use crate::compliance::CORNER_REACH;
use crate::gear::{Half, Pair};

/// Part of one slice of one tooth pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint {
    /// Tooth pair: k + 1 entered before k.
    pub pair: i32,
    /// Slice of the face width, counted from the mesh-out end.
    pub slice: usize,
    /// 0 before the path (gear tip corner), 1 on it, 2 after it (pinion tip corner).
    pub zone: u8,
    /// Index of the part of the slice beyond the path, 0 on the path.
    pub part: u8,
    /// Roll coordinate of its middle.
    pub x_m: f64,
    /// Axial distance of its middle from the mesh-out end.
    pub entry_m: f64,
    /// Axial length of the part.
    pub width_m: f64,
    /// Mean gap of the part, in the transverse plane along the base tangent.
    pub gap_m: f64,
    /// Twice what the mean gap is more than the least one: the difference between both ends of a linear gap.
    pub gap_spread_m: f64,
}

/// Most parts of a slice beyond the path.
pub(super) const MOST_PARTS_PER_SLICE: f64 = 8.0;

/// Range of the pairs that are considered, and of the contact beyond the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PairRange {
    /// Lowest pair to be considered.
    pub lowest_pair: i32,
    /// Corner contacts with a kinematic gap up to this are considered; zero: the path only.
    pub corner_gap_m: f64,
    /// Least width of a part of a slice beyond the path.
    pub least_part_m: f64,
}

/// Roll coordinate of pair 0 at entry 0 when pair 0 is `phase` base pitches after its first theoretical contact.
pub(super) fn reference_roll_m(pair: &Pair, phase: f64) -> f64 {
    pair.path_start_m + phase * pair.base_pitch_m - pair.spec.face_width_m * pair.base_helix_angle_rad.tan()
}

/// Collects the points of `half` into `out`. `displacement_m` is the opening of the flanks along the base tangent by
/// displaced bodies, at a distance from the mesh-out end and a roll coordinate.
pub(super) fn collect(
    pair: &Pair,
    corners: &CornerGaps,
    half: Half,
    (phase, slices): (f64, usize),
    reach: &PairRange,
    displacement_m: impl Fn(f64, f64) -> f64,
    out: &mut Vec<ContactPoint>,
) {
    out.clear();
    let b = pair.spec.face_width_m;
    let step = b / slices as f64;
    let slope = pair.base_helix_angle_rad.tan();
    let x0 = reference_roll_m(pair, phase);
    let (start, end) = (pair.path_start_m, pair.path_end_m);
    let over = if reach.corner_gap_m > 0.0 { CORNER_REACH * pair.base_pitch_m } else { 0.0 };
    let first = (((start - over - x0 - b * slope) / pair.base_pitch_m).floor() as i32).max(reach.lowest_pair);
    let last = ((end + over - x0) / pair.base_pitch_m).ceil() as i32;
    for k in first..=last {
        let base = x0 + k as f64 * pair.base_pitch_m;
        for slice in 0..slices {
            let (e0, e1) = (slice as f64 * step, (slice + 1) as f64 * step);
            let (xa, xb) = (base + e0 * slope, base + e1 * slope);
            let zones = [(f64::NEG_INFINITY, start), (start, end), (end, f64::INFINITY)];
            for (zone, (from, to)) in zones.into_iter().enumerate() {
                if zone != 1 && over == 0.0 {
                    continue;
                }
                let (low, high) = (xa.max(from), xb.min(to));
                let share = if xb > xa {
                    (high - low) / (xb - xa)
                } else if xa >= from && xa < to {
                    1.0
                } else {
                    0.0
                };
                if share < 1e-7 {
                    continue;
                }
                // The corner gap grows with the square of the overrun: a slice there is looked at in parts.
                let parts = if zone != 1 && slope > 0.0 {
                    (share * step / reach.least_part_m).clamp(1.0, MOST_PARTS_PER_SLICE) as u8
                } else {
                    1
                };
                for part in 0..parts {
                    let at = |place: f64| {
                        let x = low + (high - low) * (f64::from(part) + place) / f64::from(parts);
                        let entry = if slope > 0.0 { (x - base) / slope } else { e0 + (e1 - e0) * place };
                        (x, entry)
                    };
                    let gap_at = |(x, entry): (f64, f64)| {
                        let corner = match zone {
                            0 => corners.mesh_in.at(start - x)?,
                            2 => corners.mesh_out.at(x - end)?,
                            _ => 0.0,
                        };
                        // entry_m is its own inverse.
                        let modified = pair.initial_gap_m(half, x.clamp(start, end), pair.entry_m(entry));
                        Some((corner, corner.max(0.0) + modified + displacement_m(entry, x)))
                    };
                    let (x, entry) = at(0.5);
                    let Some((corner, gap)) = gap_at((x, entry)) else { continue };
                    if corner > reach.corner_gap_m {
                        continue;
                    }
                    // Mean over the part (Simpson) and least of three.
                    let ends = gap_at(at(0.0)).zip(gap_at(at(1.0))).map_or([gap; 2], |(a, b)| [a.1, b.1]);
                    let mean = (ends[0] + 4.0 * gap + ends[1]) / 6.0;
                    let least = gap.min(ends[0]).min(ends[1]);
                    out.push(ContactPoint {
                        pair: k,
                        slice,
                        zone: zone as u8,
                        part,
                        x_m: x,
                        entry_m: entry,
                        width_m: share * step / f64::from(parts),
                        gap_m: mean,
                        gap_spread_m: 2.0 * (mean - least).max(0.0),
                    });
                }
            }
        }
    }
}

/// Kinematic gaps of both corners over the overrun, tabulated once: their exact formulas take a good part of a
/// position's time.
#[derive(Debug, Clone, Default)]
pub(super) struct CornerGaps {
    /// Corner of the gear's tip, before the path.
    pub mesh_in: CornerGap,
    /// Corner of the pinion's tip, after the path.
    pub mesh_out: CornerGap,
}

/// Gap of one corner: linear interpolation of what multiplies the square of the overrun.
#[derive(Debug, Clone, Default)]
pub(super) struct CornerGap {
    step_m: f64,
    per_square: Vec<f64>,
}

/// Intervals of the table over [`CORNER_REACH`].
const CORNER_TABLE: usize = 128;

impl CornerGaps {
    /// Tables up to [`CORNER_REACH`].
    pub(super) fn new(pair: &Pair) -> CornerGaps {
        let step_m = CORNER_REACH * pair.base_pitch_m / CORNER_TABLE as f64;
        let table = |gap: fn(&Pair, f64) -> Option<f64>| {
            let at = |i: usize| gap(pair, i as f64 * step_m).map(|gap| gap / (i as f64 * step_m).powi(2));
            let mut per_square: Vec<f64> = (1..=CORNER_TABLE).map_while(at).collect();
            if let [first, second, ..] = per_square[..] {
                per_square.insert(0, (2.0 * first - second).max(0.0));
            }
            CornerGap { step_m, per_square }
        };
        CornerGaps { mesh_in: table(Pair::mesh_in_corner_gap_m), mesh_out: table(Pair::mesh_out_corner_gap_m) }
    }
}

impl CornerGap {
    /// Gap at an overrun; `None` where the corner has no flank to meet.
    pub(super) fn at(&self, overrun_m: f64) -> Option<f64> {
        let position = (overrun_m / self.step_m).max(0.0);
        let i = position as usize;
        let (low, high) = (*self.per_square.get(i)?, *self.per_square.get(i + 1)?);
        Some((low + (high - low) * (position - i as f64)) * overrun_m * overrun_m)
    }
}
