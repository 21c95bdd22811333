//! The half-space part of the flank's own compliance: Boussinesq's kernel between the same hats at the points of the
//! helicoid.
//!
//! Distances on a helicoid depend on the two arc lengths and on the difference of the axial places alone, so the axial
//! integrals are those of the hats' correlation, a cubic between breaks. Near pairs of points take `w = w0 + δ
//! sinh(t)`, which takes the peak of 1/r away; the logarithm that is left in the arc length is met by squared
//! abscissas.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::loads::{LoadGrid, hat_lengths};
use super::surface::InvoluteFlank;
use crate::numerics::gauss::{gauss_legendre, on_interval};
use crate::watch::{Canceled, Watch};

/// Two cells along the face at a given distance.
struct Strip {
    /// Lengths of the two cells and start of the first from the start of the second.
    lengths: (f64, f64),
    shift: f64,
    /// All pairs of cells that look like this.
    cells: Vec<(usize, usize)>,
    /// Axial distance, correlations of the four pairs of hat halves times weight, sine and cosine of the twist: for
    /// points that are not close.
    far: Vec<(f64, [f64; 4], f64, f64)>,
    near: bool,
}

/// Correlation of the two linear shapes on a cell of each strip at axial distance `t` of the places from the starts.
fn correlation(lengths: (f64, f64), t: f64) -> [f64; 4] {
    let (from, to) = (t.max(0.0), lengths.0.min(lengths.1 + t));
    let mut out = [0.0; 4];
    if to > from {
        // Two points are exact for the product of two straight lines.
        let offset = 0.5 * (to - from) / 3f64.sqrt();
        let middle = 0.5 * (from + to);
        for z in [middle - offset, middle + offset] {
            let (u, v) = (z / lengths.0, (z - t) / lengths.1);
            let weight = 0.5 * (to - from);
            for (o, f) in out.iter_mut().zip([(1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v]) {
                *o += weight * f;
            }
        }
    }
    out
}

impl Strip {
    fn pieces(&self) -> impl Iterator<Item = (f64, f64)> {
        let (p, q) = self.lengths;
        let breaks = [-q, (p - q).min(0.0), (p - q).max(0.0), p];
        (0..3).map(move |i| (breaks[i], breaks[i + 1])).filter(move |(a, b)| b - a > 1e-9 * (p + q))
    }
}

fn strips(stations: &[f64], twist_per_m: f64) -> Vec<Strip> {
    let count = stations.len() - 1;
    let unit = (stations[count] - stations[0]) * 1e-9;
    let rounded = |value: f64| (value / unit).round() as i64;
    let mut found: BTreeMap<(i64, i64, i64), Strip> = BTreeMap::new();
    let longest = stations.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    let rule = gauss_legendre(5);
    for p in 0..count {
        for q in 0..count {
            let lengths = (stations[p + 1] - stations[p], stations[q + 1] - stations[q]);
            let shift = stations[p] - stations[q];
            found
                .entry((rounded(lengths.0), rounded(lengths.1), rounded(shift)))
                .or_insert_with(|| {
                    let near = shift - lengths.1 < 1.1 * longest && shift + lengths.0 > -1.1 * longest;
                    let mut strip = Strip { lengths, shift, cells: Vec::new(), far: Vec::new(), near };
                    let mut far = Vec::new();
                    for (a, b) in strip.pieces() {
                        for (t, weight) in on_interval(&rule, a, b) {
                            let (sin, cos) = (twist_per_m * (shift + t)).sin_cos();
                            far.push((shift + t, correlation(lengths, t).map(|c| c * weight), sin, cos));
                        }
                    }
                    strip.far = far;
                    strip
                })
                .cells
                .push((p, q));
        }
    }
    found.into_values().collect()
}

/// The distance between point `a` of the section at axial place w and point `b` at 0.
struct Distance {
    a: [f64; 2],
    b: [f64; 2],
    twist_per_m: f64,
}

impl Distance {
    fn squared(&self, w: f64, sin: f64, cos: f64) -> f64 {
        // Angles grow from y to x.
        let x = self.a[0] * cos + self.a[1] * sin - self.b[0];
        let y = self.a[1] * cos - self.a[0] * sin - self.b[1];
        x * x + y * y + w * w
    }

    /// Place and value of the least distance, and half the second derivative of its square there.
    fn least(&self) -> (f64, f64, f64) {
        let [ax, ay] = self.a;
        let [bx, by] = self.b;
        let tau = self.twist_per_m;
        let mut w = 0.0_f64;
        let mut bend = 1.0;
        for _ in 0..4 {
            let (sin, cos) = (tau * w).sin_cos();
            // r² = const + w² - 2 (b · turned a).
            let across = bx * (ay * cos - ax * sin) + by * (-ax * cos - ay * sin);
            let along = bx * (ax * cos + ay * sin) + by * (ay * cos - ax * sin);
            bend = 1.0 + tau * tau * along;
            w -= (w - tau * across) / bend;
        }
        let (sin, cos) = (tau * w).sin_cos();
        (w, self.squared(w, sin, cos).sqrt(), bend.max(0.1))
    }
}

/// Points along the face on either side of a break in the sinh variable.
const NEAR_POINTS: usize = 16;

/// Half-space compliance between all hats of `grid`, row-major; node index `profile * stations + station`.
pub(super) fn half_space(
    involute: &InvoluteFlank,
    grid: &LoadGrid,
    twist_per_m: f64,
    (youngs_pa, nu): (f64, f64),
    watch: Watch,
    progress: (f64, f64),
) -> Result<Vec<f64>, Canceled> {
    let strips = strips(&grid.stations_m, twist_per_m);
    let near_rule = gauss_legendre(NEAR_POINTS);
    let profile = &grid.profile_m;
    let rows = profile.len();
    let (inner, outer) = (gauss_legendre(6), gauss_legendre(8));
    let plain = gauss_legendre(4);
    let stations = grid.stations_m.len();
    let size = grid.len();
    let pairs: Vec<(usize, usize)> = (0..rows - 1).flat_map(|i| (i..rows - 1).map(move |j| (i, j))).collect();
    let blocks = pairs
        .par_iter()
        .map(|&(i, j)| {
            watch.checkpoint(progress.0 + (progress.1 - progress.0) * i as f64 / rows as f64)?;
            let (a0, a1) = (profile[i], profile[i + 1]);
            let (b0, b1) = (profile[j], profile[j + 1]);
            let mut points: Vec<(f64, f64, f64)> = Vec::new();
            if i == j {
                for (s, ws) in on_interval(&outer, a0, a1) {
                    for (v, wv) in on_interval(&inner, 0.0, 1.0) {
                        points.push((s, s - (s - a0) * v * v, ws * wv * 2.0 * v * (s - a0)));
                        points.push((s, s + (a1 - s) * v * v, ws * wv * 2.0 * v * (a1 - s)));
                    }
                }
            } else if j == i + 1 {
                for (u, wu) in on_interval(&inner, 0.0, 1.0) {
                    for (v, wv) in on_interval(&inner, 0.0, 1.0) {
                        let (la, lb) = (a1 - a0, b1 - b0);
                        points.push((a1 - la * u * u, b0 + lb * v * v, wu * wv * 4.0 * u * v * la * lb));
                    }
                }
            } else {
                for (s, ws) in on_interval(&plain, a0, a1) {
                    for (t, wt) in on_interval(&plain, b0, b1) {
                        points.push((s, t, ws * wt));
                    }
                }
            }
            let mut sums = vec![[0.0; 16]; strips.len()];
            for &(s, t, weight) in &points {
                let distance = Distance { a: involute.at(s).0, b: involute.at(t).0, twist_per_m };
                let (u, v) = ((s - a0) / (a1 - a0), (t - b0) / (b1 - b0));
                let along_profile = [(1.0 - u) * (1.0 - v), (1.0 - u) * v, u * (1.0 - v), u * v].map(|f| f * weight);
                for (strip, sum) in strips.iter().zip(&mut sums) {
                    let axial = strip.integrate(&distance, &near_rule);
                    for (k, f) in along_profile.iter().enumerate() {
                        for (l, g) in axial.iter().enumerate() {
                            sum[4 * k + l] += f * g;
                        }
                    }
                }
            }
            Ok(sums)
        })
        .collect::<Result<Vec<_>, Canceled>>()?;
    let mut matrix = vec![0.0; size * size];
    for (&(i, j), sums) in pairs.iter().zip(&blocks) {
        for (strip, sum) in strips.iter().zip(sums) {
            for &(p, q) in &strip.cells {
                for k in 0..4 {
                    let (row, other) = (i + k / 2, j + k % 2);
                    for l in 0..4 {
                        let a = row * stations + p + l / 2;
                        let b = other * stations + q + l % 2;
                        matrix[a * size + b] += sum[4 * k + l];
                        if i != j {
                            matrix[b * size + a] += sum[4 * k + l];
                        }
                    }
                }
            }
        }
    }
    let factor = (1.0 - nu * nu) / (std::f64::consts::PI * youngs_pa);
    let (lengths, widths) = (hat_lengths(profile), hat_lengths(&grid.stations_m));
    let areas: Vec<f64> = lengths.iter().flat_map(|l| widths.iter().map(move |w| l * w)).collect();
    for a in 0..size {
        for b in 0..=a {
            // The rule for a cell with itself is not symmetric.
            let value = 0.5 * factor * (matrix[a * size + b] + matrix[b * size + a]) / (areas[a] * areas[b]);
            matrix[a * size + b] = value;
            matrix[b * size + a] = value;
        }
    }
    Ok(matrix)
}

impl Strip {
    fn integrate(&self, distance: &Distance, near_rule: &[(f64, f64)]) -> [f64; 4] {
        let mut out = [0.0; 4];
        if !self.near {
            for &(w, correlation, sin, cos) in &self.far {
                let inverse = 1.0 / distance.squared(w, sin, cos).sqrt();
                for (o, c) in out.iter_mut().zip(correlation) {
                    *o += c * inverse;
                }
            }
            return out;
        }
        let (w0, least, bend) = distance.least();
        let scale = least / bend.sqrt();
        for (from, to) in self.pieces() {
            let (from, to) = (from + self.shift, to + self.shift);
            let middle = w0.clamp(from, to);
            for (a, b) in [(from, middle), (middle, to)] {
                if b - a <= 1e-12 * (to - from) {
                    continue;
                }
                let (ta, tb) = (((a - w0) / scale).asinh(), ((b - w0) / scale).asinh());
                for (t, weight) in on_interval(near_rule, ta, tb) {
                    let grown = t.exp();
                    let w = w0 + 0.5 * scale * (grown - 1.0 / grown);
                    let (sin, cos) = (distance.twist_per_m * w).sin_cos();
                    let factor = 0.5 * weight * scale * (grown + 1.0 / grown) / distance.squared(w, sin, cos).sqrt();
                    for (o, c) in out.iter_mut().zip(correlation(self.lengths, w - self.shift)) {
                        *o += c * factor;
                    }
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::spline::graded_cells;
    use herringbone_oracle::{Tolerance, check};

    /// A flank so large that it is flat: uniform pressure on a rectangle, mean displacement in closed form (the mean
    /// inverse distance of two points of a rectangle).
    #[test]
    fn uniform_pressure_on_a_rectangle() {
        let (length, width) = (8e-3_f64, 20e-3_f64);
        let involute =
            InvoluteFlank { base_radius_m: 1e3, base_half_angle_rad: 0.1, form_roll_m: 1e3, length_m: length };
        let grid = LoadGrid {
            profile_m: (0..=5).map(|i| length * f64::from(i) / 5.0).collect(),
            stations_m: graded_cells(width, 7),
        };
        let (youngs, nu) = (2.1e11, 0.3);
        let matrix = half_space(&involute, &grid, 0.0, (youngs, nu), Watch::none(), (0.0, 0.0)).unwrap_or_default();
        let (lengths, widths) = (hat_lengths(&grid.profile_m), hat_lengths(&grid.stations_m));
        let n = grid.len();
        let weight = |k: usize| lengths[k / widths.len()] * widths[k % widths.len()] / (length * width);
        let mut mean = 0.0;
        for a in 0..n {
            for b in 0..n {
                mean += weight(a) * weight(b) * matrix[a * n + b];
            }
        }
        let (l, w) = (length, width);
        let integral = 2.0
            * (l * l * w * (w / l).asinh()
                + l * w * w * (l / w).asinh()
                + (l.powi(3) + w.powi(3) - l.hypot(w).powi(3)) / 3.0);
        let expected = (1.0 - nu * nu) / (std::f64::consts::PI * youngs) * integral / (l * w).powi(2);
        check(
            "Elements: half-space under a rectangle",
            "mean under a rectangle, m/N",
            mean,
            expected,
            Tolerance::Relative(3e-4),
        );
    }
}
