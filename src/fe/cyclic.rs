//! From one condensed sector to the whole gear: all sectors are alike, so displacements are sums over circumferential
//! phases θ_n = 2πn/N (Thomas, Int. J. Numer. Methods Eng. 14 (1979) 81).

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, Mat, Par, c64};
use rayon::prelude::*;

use super::condense::{Condensed, factor};
use super::input::FeError;
use crate::watch::Watch;

/// The sector as its two cut faces see it: the first half of the unknowns is the face at the smaller angle.
struct Faces<'a> {
    sector: &'a Condensed,
    size: usize,
}

impl Faces<'_> {
    /// Complex compliance of the loads at `phase`.
    fn compliance(&self, phase: f64) -> Result<(Mat<f64>, Mat<f64>), FeError> {
        let n = self.size;
        let s = &self.sector.stiffness;
        let (sin, cos) = phase.sin_cos();
        let mut h = Mat::<c64>::zeros(n, n);
        for j in 0..n {
            for i in j..n {
                let (ahead, back) = (s[(i, n + j)], s[(n + i, j)]);
                h[(i, j)] = c64::new(s[(i, j)] + s[(n + i, n + j)] + cos * (ahead + back), sin * (ahead - back));
            }
        }
        let f = &self.sector.forces;
        let mut y =
            Mat::<c64>::from_fn(n, f.ncols(), |i, j| c64::new(f[(i, j)] + cos * f[(n + i, j)], -sin * f[(n + i, j)]));
        factor(h.as_mut(), "cut faces")?;
        solve_lower_triangular_in_place(h.as_ref(), y.as_mut(), Par::Seq);
        let real = Mat::<f64>::from_fn(n, f.ncols(), |i, j| y[(i, j)].re);
        let imaginary = Mat::<f64>::from_fn(n, f.ncols(), |i, j| y[(i, j)].im);
        let mut even = self.sector.compliance.clone();
        matmul(even.as_mut(), Accum::Add, real.transpose(), real.as_ref(), 1.0, Par::Seq);
        matmul(even.as_mut(), Accum::Add, imaginary.transpose(), imaginary.as_ref(), 1.0, Par::Seq);
        let mut odd = Mat::<f64>::zeros(f.ncols(), f.ncols());
        matmul(odd.as_mut(), Accum::Replace, real.transpose(), imaginary.as_ref(), 1.0, Par::Seq);
        matmul(odd.as_mut(), Accum::Add, imaginary.transpose(), real.as_ref(), -1.0, Par::Seq);
        Ok((even, odd))
    }
}

/// Displacement under load a of the sector m places ahead (growing angle) by load b, for m = 0..=offsets.
pub(super) fn expand(
    sector: &Condensed,
    teeth: u32,
    offsets: usize,
    watch: Watch,
    progress: (f64, f64),
) -> Result<Vec<Mat<f64>>, FeError> {
    let faces = Faces { sector, size: sector.stiffness.nrows() / 2 };
    let loads = sector.forces.ncols();
    let highest = teeth as usize / 2;
    let mut sums = vec![Mat::<f64>::zeros(loads, loads); offsets + 1];
    let all: Vec<usize> = (0..=highest).collect();
    // A few at a time: sums in a fixed order, whatever the threads.
    for some in all.chunks(8) {
        let fraction = some[0] as f64 / (highest + 1) as f64;
        watch.checkpoint(progress.0 + (progress.1 - progress.0) * fraction)?;
        let parts: Vec<(Mat<f64>, Mat<f64>)> = some
            .par_iter()
            .map(|&n| {
                let part = faces.compliance(2.0 * std::f64::consts::PI * n as f64 / f64::from(teeth))?;
                watch.checkpoint(progress.0 + (progress.1 - progress.0) * fraction)?;
                Ok(part)
            })
            .collect::<Result<_, FeError>>()?;
        for (&n, (even, odd)) in some.iter().zip(&parts) {
            // n and N - n are conjugate.
            let single = n == 0 || 2 * n == teeth as usize;
            let weight = if single { 1.0 } else { 2.0 } / f64::from(teeth);
            for (m, sum) in sums.iter_mut().enumerate() {
                let (sin, cos) =
                    (2.0 * std::f64::consts::PI * ((m * n) % teeth as usize) as f64 / f64::from(teeth)).sin_cos();
                for j in 0..loads {
                    for i in 0..loads {
                        sum[(i, j)] += weight * (cos * even[(i, j)] - sin * odd[(i, j)]);
                    }
                }
            }
        }
    }
    Ok(sums)
}
