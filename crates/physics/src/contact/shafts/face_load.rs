//! Load along the faces of both halves on elastic shafts.

use serde::{Deserialize, Serialize};

use super::flexibility::{ContactShafts, NODES};
use crate::contact::lines::ContactPoint;
use crate::contact::position::LoadedPosition;
use crate::gear::{Half, Pair};

/// Load along the face of one half, mean over all contact lines that pass a place during the mesh period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FaceLoad {
    /// Middles of equal strips of the face, from the inner end.
    pub strip_m: Vec<f64>,
    /// Normal force per length of contact line in every strip.
    pub line_load_n_per_m: Vec<f64>,
    /// The same at the inner and the outer end, extended from the three strips before.
    pub ends_n_per_m: [f64; 2],
    /// Middles of pieces of about 5 mm of the face, from the inner end.
    pub piece_m: Vec<f64>,
    /// Means over these pieces.
    pub piece_line_load_n_per_m: Vec<f64>,
    /// Force of the half over the mean length of its contact lines.
    pub mean_n_per_m: f64,
}

impl FaceLoad {
    /// Largest line load along the face, the ends included, over the mean: K_Hβ.
    pub fn k_h_beta(&self) -> f64 {
        self.over_mean(self.line_load_n_per_m.iter().chain(&self.ends_n_per_m).copied().fold(0.0, f64::max))
    }

    /// 1 without load.
    fn over_mean(&self, largest_n_per_m: f64) -> f64 {
        if self.mean_n_per_m > 0.0 { largest_n_per_m / self.mean_n_per_m } else { 1.0 }
    }

    /// Largest mean over 5 mm of the face over the mean.
    pub fn k_h_beta_5mm(&self) -> f64 {
        self.over_mean(self.piece_line_load_n_per_m.iter().copied().fold(0.0, f64::max))
    }

    /// Line load at a distance from the inner end, linear between strips and ends.
    pub fn at_n_per_m(&self, from_inner_m: f64) -> f64 {
        let width_m = 2.0 * self.strip_m[0] * self.strip_m.len() as f64;
        let [inner, outer] = self.ends_n_per_m;
        let places: Vec<f64> =
            std::iter::once(0.0).chain(self.strip_m.iter().copied()).chain(std::iter::once(width_m)).collect();
        let loads: Vec<f64> = std::iter::once(inner)
            .chain(self.line_load_n_per_m.iter().copied())
            .chain(std::iter::once(outer))
            .collect();
        crate::numerics::interpolation::linear(&places, &loads, from_inner_m)
    }
}

/// One half on the shafts, over the mesh period.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HalfOnShafts {
    /// Normal force, mean and difference of the extremes.
    pub normal_force_n: [f64; 2],
    /// Part of the normal force of both halves.
    pub share: f64,
    /// Axial force on the pinion, positive to the right.
    pub axial_force_on_pinion_n: f64,
    /// Load along the face.
    pub face: FaceLoad,
    /// Largest line load of a position over the mean line load, mean over the positions.
    pub peak_over_mean: f64,
    /// Centre of the load from the inner end.
    pub centroid_from_inner_m: f64,
    /// Force by approach (N/m), moment about the middle of the face by approach (N) and by tilt (N m) of the teeth on
    /// bodies that are held, along the flank normal, mean; distances from the mesh-out end.
    pub tooth_stiffness: [f64; 3],
    /// Centre of the load from the apex plane along the shafts.
    pub centroid_z_m: f64,
    /// Openings that the shafts cause, relative to the mid-face sections at the pitch point, mean.
    pub openings_m: Vec<f64>,
}

/// Length of the pieces of the face over which the line load is averaged.
const PIECE_M: f64 = 5e-3;
/// Loads of a half. `lengths` receives the length of the contact lines of all positions, and that without load.
pub(super) fn half_on_shafts(
    pair: &Pair,
    half: Half,
    shafts: &ContactShafts,
    positions: &[(f64, &LoadedPosition)],
    slices: usize,
    lengths: &mut [f64; 2],
) -> HalfOnShafts {
    let (width_m, cos) = (pair.spec.face_width_m, pair.base_helix_angle_rad.cos());
    let pieces = ((width_m / PIECE_M).round() as usize).max(1);
    let mut strips = Strips::new(width_m, slices);
    let mut of_pieces = Strips::new(width_m, pieces);
    let sliver_m = 0.5 * width_m / slices as f64;
    let (mut largest_n, mut least_n) = (f64::NEG_INFINITY, f64::INFINITY);
    let (mut sum, mut moment, mut peaks) = (0.0, 0.0, 0.0);
    for &(weight, position) in positions {
        let whole = position.forces_n.iter().sum::<f64>();
        (largest_n, least_n) = (largest_n.max(whole), least_n.min(whole));
        sum += weight * whole;
        let mut peak = 0.0f64;
        let mut rest = position.forces_n.as_slice();
        for line in position.points.chunk_by(|a, b| a.pair == b.pair) {
            let (forces, others) = rest.split_at(line.len());
            rest = others;
            for (i, (p, &f)) in line.iter().zip(forces).enumerate() {
                // entry_m is its own inverse.
                let from_inner_m = pair.entry_m(p.entry_m);
                let on_path = p.zone == 1;
                let length_m = if on_path { weight * p.width_m / cos } else { 0.0 };
                lengths[0] += length_m;
                if on_path && p.width_m >= sliver_m {
                    peak = peak.max(f * cos / p.width_m);
                }
                moment += weight * f * from_inner_m;
                let range = (from_inner_m - 0.5 * p.width_m, from_inner_m + 0.5 * p.width_m);
                let load = SegmentLoad::new(line, forces, i, pair);
                lengths[1] += length_m * (1.0 - load.loaded_part(p.width_m));
                for strips in [&mut strips, &mut of_pieces] {
                    strips.add_length(range, length_m);
                    strips.add_force(&load, weight);
                }
            }
        }
        peaks += weight * peak;
    }
    let mean_n_per_m = sum / lengths[0];
    // Without load every ratio to it is that of an even one.
    let over = |value: f64, mean: f64, even: f64| if sum > 0.0 { value / mean } else { even };
    let line_load_n_per_m = strips.line_loads();
    // A parabola through the middles of the three strips at the end; a load that vanishes there stays zero.
    let beyond = |strips: &mut dyn Iterator<Item = &f64>| match strips.take(3).collect::<Vec<_>>()[..] {
        [end, next, third] if *end > 0.0 => (1.875 * end - 1.25 * next + 0.375 * third).max(0.0),
        [end, ..] => *end,
        [] => 0.0,
    };
    let ends_n_per_m = [beyond(&mut line_load_n_per_m.iter()), beyond(&mut line_load_n_per_m.iter().rev())];
    let centroid_from_inner_m = over(moment, sum, 0.5 * width_m);
    HalfOnShafts {
        normal_force_n: [sum, largest_n - least_n],
        share: 0.0,
        axial_force_on_pinion_n: -shafts.frame.axial[half.index()] * sum,
        face: FaceLoad {
            strip_m: strips.middles_m(),
            ends_n_per_m,
            piece_m: of_pieces.middles_m(),
            piece_line_load_n_per_m: of_pieces.line_loads(),
            mean_n_per_m,
            line_load_n_per_m,
        },
        peak_over_mean: over(peaks, mean_n_per_m, 1.0),
        centroid_from_inner_m,
        centroid_z_m: shafts.frame.z_m(half, pair.entry_m(centroid_from_inner_m)),
        tooth_stiffness: [0.0; 3],
        openings_m: vec![0.0; NODES],
    }
}

/// Load of a segment of a contact line, linear over the part of the face that it loads.
///
/// The slope is that between the neighbours; a segment next to one without load, whose linear load would fall below
/// zero, carries a triangle on a part of its width.
struct SegmentLoad {
    range_m: (f64, f64),
    /// Force per width in the middle of the range, and its slope.
    middle_n_per_m: f64,
    slope_n_per_m2: f64,
}

impl SegmentLoad {
    /// Of point `i` of `line`, along the distance from the inner end.
    fn new(line: &[ContactPoint], forces_n: &[f64], i: usize, pair: &Pair) -> SegmentLoad {
        let place = |i: usize| pair.entry_m(line[i].entry_m);
        let load = |i: usize| forces_n[i] / line[i].width_m;
        let (at_m, width_m, own) = (place(i), line[i].width_m, load(i));
        let even = SegmentLoad {
            range_m: (at_m - 0.5 * width_m, at_m + 0.5 * width_m),
            middle_n_per_m: own,
            slope_n_per_m2: 0.0,
        };
        if own <= 0.0 {
            return even;
        }
        // Neighbours on the same part of the path that touch this segment.
        let beside = |j: Option<usize>| {
            j.filter(|&j| j < line.len() && line[j].zone == line[i].zone)
                .filter(|&j| (place(j) - at_m).abs() < 0.51 * (line[j].width_m + width_m))
        };
        let slope = |a: usize, b: usize| (load(b) - load(a)) / (place(b) - place(a));
        let loaded = |j: &usize| forces_n[*j] > 0.0;
        let (before, after) = (beside(i.checked_sub(1)), beside(Some(i + 1)));
        let at_border = [before, after].iter().flatten().any(|j| !loaded(j));
        let slope_n_per_m2 = match (before.filter(loaded), after.filter(loaded)) {
            (Some(before), Some(after)) => slope(before, after),
            (Some(j), None) | (None, Some(j)) => slope(j, i),
            (None, None) => return even,
        };
        let steepest = 2.0 * own / width_m;
        if slope_n_per_m2.abs() <= steepest {
            return SegmentLoad { slope_n_per_m2, ..even };
        }
        if !at_border {
            return SegmentLoad { slope_n_per_m2: steepest.copysign(slope_n_per_m2), ..even };
        }
        // A triangle of this slope with the whole force, at the end where the load is higher.
        let loaded_m = (2.0 * own * width_m / slope_n_per_m2.abs()).sqrt().min(width_m);
        let (low, high) = even.range_m;
        let range_m = if slope_n_per_m2 > 0.0 { (high - loaded_m, high) } else { (low, low + loaded_m) };
        let middle_n_per_m = own * width_m / loaded_m;
        SegmentLoad {
            range_m,
            middle_n_per_m,
            slope_n_per_m2: (2.0 * middle_n_per_m / loaded_m).copysign(slope_n_per_m2),
        }
    }

    /// Part of a segment of this width that is loaded.
    fn loaded_part(&self, width_m: f64) -> f64 {
        if self.middle_n_per_m > 0.0 { ((self.range_m.1 - self.range_m.0) / width_m).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Force between two places of the range.
    fn between_n(&self, low: f64, high: f64) -> f64 {
        let middle_m = 0.5 * (self.range_m.0 + self.range_m.1);
        (high - low) * (self.middle_n_per_m + self.slope_n_per_m2 * (0.5 * (low + high) - middle_m))
    }
}

/// Forces and lengths in equal strips of the face.
struct Strips {
    width_m: f64,
    force_n: Vec<f64>,
    length_m: Vec<f64>,
}

impl Strips {
    fn new(face_m: f64, count: usize) -> Strips {
        Strips { width_m: face_m / count as f64, force_n: vec![0.0; count], length_m: vec![0.0; count] }
    }

    /// Adds what a function that integrates to `of(from, to)` has within every strip between `from` and `to`.
    fn add(values: &mut [f64], width_m: f64, (from, to): (f64, f64), of: impl Fn(f64, f64) -> f64) {
        let last = values.len() - 1;
        let strip = |place: f64| ((place / width_m).max(0.0) as usize).min(last);
        // An end on the border of two strips belongs to the one between it and the other end.
        let (first, end) = (strip(from + 1e-9 * width_m), strip(to - 1e-9 * width_m));
        for (i, value) in values.iter_mut().enumerate().take(end.max(first) + 1).skip(first) {
            let low = if i == first { from } else { i as f64 * width_m };
            let high = if i >= end { to } else { (i + 1) as f64 * width_m };
            *value += of(low, high);
        }
    }

    /// Adds a length that is spread evenly over a range of the face.
    fn add_length(&mut self, (from, to): (f64, f64), length_m: f64) {
        let per_width = if to > from { length_m / (to - from) } else { 0.0 };
        Self::add(&mut self.length_m, self.width_m, (from, to), |low, high| per_width * (high - low));
    }

    fn add_force(&mut self, load: &SegmentLoad, weight: f64) {
        Self::add(&mut self.force_n, self.width_m, load.range_m, |low, high| weight * load.between_n(low, high));
    }

    fn middles_m(&self) -> Vec<f64> {
        (0..self.force_n.len()).map(|i| (i as f64 + 0.5) * self.width_m).collect()
    }

    fn line_loads(&self) -> Vec<f64> {
        self.force_n.iter().zip(&self.length_m).map(|(f, l)| if *l > 0.0 { f / l } else { 0.0 }).collect()
    }
}
