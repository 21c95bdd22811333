//! The end faces of a tooth: compliance of the edge between flank and end face beyond that of half-space and plate.
//!
//! A contact near an end face lies on a wedge. An elastic wedge has no length of its own, so that its displacement at
//! the distance t from the edge under a point load at t' (both on one line across the edge), less that of the
//! half-space, is
//!
//! ```text
//! κ(φ) (1-ν²)/(πE) / (t + t')
//! ```
//!
//! with a factor κ that depends on the dihedral angle φ and, for t/t' between 1/7 and 7, within 20 % on nothing else.
//! The contact line of an involute helicoid is perpendicular to the edge, and φ = 90° ± β_b all along it. At the depth
//! h of the middle surface the plate takes over, which includes the end face: as for the half-space, where the
//! displacement at the depth h below a load is 1/ℓ instead of 1/t, ℓ = h 2(1-ν)/(3-2ν), what remains is 1/(t+t') -
//! 1/(t+t'+ℓ).

use std::f64::consts::PI;

/// κ at dihedral angles in degrees, for ν = 0.3, made by `scripts/wedge_kernel.py`: waves cos(ky) along the edge on a
/// section of 9-node finite elements, graded from 0.002/k to 14/k, less the same of the half-space, integrated over k;
/// mean of t/t' = 1.3 and 1.6. The mesh reproduces the half-space within 3 %.
const WEDGE: [(f64, f64); 17] = [
    (45.0, 31.3),
    (50.0, 21.7),
    (55.0, 15.3),
    (60.0, 11.0),
    (65.0, 8.05),
    (70.0, 5.92),
    (75.0, 4.38),
    (80.0, 3.25),
    (85.0, 2.41),
    (90.0, 1.78),
    (95.0, 1.31),
    (100.0, 0.965),
    (105.0, 0.700),
    (110.0, 0.504),
    (118.0, 0.288),
    (125.0, 0.171),
    (135.0, 0.077),
];

/// Both end faces of a tooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EndFaces {
    /// κ (1-ν²)/(πE) at the first and at the last slice.
    factors: [f64; 2],
    /// ℓ per depth.
    reach: f64,
    /// Length of a slice across the edge.
    slice_m: f64,
    /// Distance of the outermost slices from their end faces, along the same line.
    margin_m: f64,
    slices: usize,
}

/// κ(φ), logarithmically interpolated.
fn wedge_factor(degrees: f64) -> f64 {
    let i = WEDGE.partition_point(|w| w.0 < degrees).clamp(1, WEDGE.len() - 1);
    let ((x0, y0), (x1, y1)) = (WEDGE[i - 1], WEDGE[i]);
    let t = ((degrees - x0) / (x1 - x0)).clamp(0.0, 1.0);
    y0 * (y1 / y0).powf(t)
}

impl EndFaces {
    /// Ends of the pinion's (`side` +1) or gear's teeth, which extend by `margin_m` on both sides of the bearing part
    /// of `width_m`, which is cut into `slices`.
    pub(super) fn new(
        base_helix_angle_rad: f64,
        side: f64,
        (width_m, margin_m): (f64, f64),
        slices: usize,
        (youngs_pa, nu): (f64, f64),
    ) -> EndFaces {
        let lean = side * base_helix_angle_rad.to_degrees();
        EndFaces {
            factors: [90.0 + lean, 90.0 - lean].map(|angle| wedge_factor(angle) * (1.0 - nu * nu) / (PI * youngs_pa)),
            reach: 2.0 * (1.0 - nu) / (3.0 - 2.0 * nu),
            slice_m: width_m / slices as f64 / base_helix_angle_rad.cos(),
            margin_m: margin_m / base_helix_angle_rad.cos(),
            slices,
        }
    }

    /// Adds the mean displacement of every slice per force spread over every other, at places of the smaller depth
    /// `depth_m`, to a row-major matrix over the slices.
    pub(super) fn add(&self, matrix: &mut [f64], depth_m: f64) {
        let reach = depth_m * self.reach;
        // Twice integrated 1/x: x ln x - x.
        let twice = |x: f64| if x > 0.0 { x * x.ln() - x } else { 0.0 };
        let d = self.slice_m;
        let mean = |x: f64| (twice(x + 2.0 * d) - 2.0 * twice(x + d) + twice(x)) / (d * d);
        let n = self.slices;
        let by_sum: Vec<f64> = (0..2 * n - 1)
            .map(|s| s as f64 * d + 2.0 * self.margin_m)
            .map(|x| (mean(x) - mean(x + reach)).max(0.0))
            .collect();
        let [first, last] = self.factors;
        for (i, row) in matrix.chunks_exact_mut(n).enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value += first * by_sum[i + j] + last * by_sum[2 * (n - 1) - i - j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dense::cholesky_inlined;
    use herringbone_oracle::check_worst;

    #[test]
    fn slices_see_the_mean_of_the_kernel() {
        let ends = EndFaces::new(0.5, 1.0, (40.0, 0.0), 20, (1.0, 0.3));
        let (d, depth) = (ends.slice_m, 3.0);
        let mut matrix = vec![0.0; 400];
        ends.add(&mut matrix, depth);
        let mut errors = Vec::new();
        for (i, j) in [(19, 19), (19, 18), (17, 12), (0, 1)] {
            let n = 400;
            let sum = |end: usize| {
                let at = |slice: usize, k: usize| (slice.abs_diff(end) as f64 + (k as f64 + 0.5) / f64::from(n)) * d;
                let mut sum = 0.0;
                for k in 0..n as usize {
                    for l in 0..n as usize {
                        let x = at(i, k) + at(j, l);
                        sum += 1.0 / x - 1.0 / (x + depth * ends.reach);
                    }
                }
                sum / f64::from(n * n)
            };
            let expected = ends.factors[0] * sum(0) + ends.factors[1] * sum(19);
            errors.push(matrix[i * 20 + j] / expected - 1.0);
        }
        check_worst("Contact: end faces of a tooth", "slices against direct integration", errors, 2e-3);
    }

    #[test]
    fn places_of_different_depth_stay_positive() {
        let end = EndFaces::new(0.6, -1.0, (30.0, 0.0), 6, (1.0, 0.3));
        let depths = [1.0, 1.7, 2.5, 4.0];
        let n = 6 * depths.len();
        let mut matrix = vec![0.0; n * n];
        for a in 0..n {
            for b in 0..n {
                let mut slices = vec![0.0; 36];
                end.add(&mut slices, f64::min(depths[a % 4], depths[b % 4]));
                matrix[a * n + b] = slices[a / 4 * 6 + b / 4] + if a == b { 1e-9 } else { 0.0 };
            }
        }
        assert!(cholesky_inlined(&mut matrix, n));
    }
}
