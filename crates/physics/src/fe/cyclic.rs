//! From one condensed sector to the whole gear: all sectors are alike, so displacements are sums over circumferential
//! phases θ_n = 2πn/N (Thomas, Int. J. Numer. Methods Eng. 14 (1979) 81).

use faer::{Accum, Mat, c64};
use rayon::prelude::*;

use super::condense::{Condensed, factor_partly, product, solve_lower};
use super::input::FeError;
use crate::watch::Watch;

/// The sector condensed to its two cut faces: the first half of the unknowns is the face at the smaller angle.
struct CutFaces<'a> {
    sector: &'a Condensed,
    size: usize,
}

impl CutFaces<'_> {
    /// Complex compliance of the loads at `phase`.
    fn compliance(
        &self,
        phase: f64,
        checkpoint: &mut dyn FnMut() -> Result<(), FeError>,
    ) -> Result<PhaseCompliance, FeError> {
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
        factor_partly(h.as_mut(), Mat::zeros(0, 0).as_mut(), "cut faces", &mut |_| checkpoint())?;
        solve_lower(h.as_ref(), y.as_mut(), checkpoint)?;
        let real = Mat::<f64>::from_fn(n, f.ncols(), |i, j| y[(i, j)].re);
        let imaginary = Mat::<f64>::from_fn(n, f.ncols(), |i, j| y[(i, j)].im);
        let mut even = self.sector.compliance.clone();
        product(even.as_mut(), Accum::Add, real.transpose(), real.as_ref(), 1.0, checkpoint)?;
        product(even.as_mut(), Accum::Add, imaginary.transpose(), imaginary.as_ref(), 1.0, checkpoint)?;
        let mut odd = Mat::<f64>::zeros(f.ncols(), f.ncols());
        product(odd.as_mut(), Accum::Replace, real.transpose(), imaginary.as_ref(), 1.0, checkpoint)?;
        product(odd.as_mut(), Accum::Add, imaginary.transpose(), real.as_ref(), -1.0, checkpoint)?;
        Ok((even, odd))
    }
}

/// Even and odd part of the compliance at one phase.
type PhaseCompliance = (Mat<f64>, Mat<f64>);

/// Up to this many waves all are calculated.
const ALL: usize = 24;
/// Waves up to this number are always calculated: the blank responds to each differently.
const DIRECT: usize = 5;
/// Largest error at the next finer phases, as a part of the largest entry, at which interpolation stops refining. The
/// result uses the finer phases too, which about squares the error (geometric convergence).
const INTERPOLATION_ERROR: f64 = 5e-4;

/// Displacement under load a of the sector m places ahead (growing angle) by load b, for m = 0..=offsets.
///
/// Of many waves the high ones are interpolated in the logarithm of the phase (Chebyshev points, refined until the
/// error is below [`INTERPOLATION_ERROR`]).
pub(super) fn expand(
    sector: &Condensed,
    teeth: u32,
    offsets: usize,
    watch: Watch,
    progress: (f64, f64),
) -> Result<Vec<Mat<f64>>, FeError> {
    let faces = CutFaces { sector, size: sector.stiffness.nrows() / 2 };
    let loads = sector.forces.ncols();
    let highest = teeth as usize / 2;
    let direct = if highest <= ALL { highest } else { DIRECT };
    let step = 2.0 * std::f64::consts::PI / f64::from(teeth);
    let mut sums = vec![Mat::<f64>::zeros(loads, loads); offsets + 1];
    let at = |phases: &[f64], done: f64| -> Result<Vec<PhaseCompliance>, FeError> {
        let parts = phases.par_iter().map(|&phase| {
            faces.compliance(phase, &mut || Ok(watch.checkpoint(progress.0 + (progress.1 - progress.0) * done)?))
        });
        parts.collect()
    };
    // n and N - n are conjugate.
    let weight = |n: usize| if n == 0 || 2 * n == teeth as usize { 1.0 } else { 2.0 } / f64::from(teeth);
    let angle = |m: usize, n: usize| step * ((m * n) % teeth as usize) as f64;
    // A few at a time: sums in a fixed order, whatever the threads.
    let all: Vec<usize> = (0..=direct).collect();
    for some in all.chunks(8) {
        let phases: Vec<f64> = some.iter().map(|&n| step * n as f64).collect();
        let parts = at(&phases, 0.5 * some[0] as f64 / (direct + 1) as f64)?;
        for (&n, parts) in some.iter().zip(&parts) {
            for (m, sum) in sums.iter_mut().enumerate() {
                watch.checkpoint_quietly()?;
                let (sin, cos) = angle(m, n).sin_cos();
                add(sum, parts, weight(n) * cos, weight(n) * sin);
            }
        }
    }
    if direct == highest {
        return Ok(sums);
    }
    let range = ((step * (direct + 1) as f64).ln(), (step * highest as f64).ln());
    let phase = |x: f64| (range.0 + (range.1 - range.0) * 0.5 * (1.0 + x)).exp();
    let mut places: Vec<f64> = lobatto(4).collect();
    let mut parts = at(&places.iter().map(|&x| phase(x)).collect::<Vec<_>>(), 0.5)?;
    let mut count = 4;
    while count < 32 {
        count *= 2;
        let new: Vec<f64> = lobatto(count).skip(1).step_by(2).collect();
        let exact = at(&new.iter().map(|&x| phase(x)).collect::<Vec<_>>(), 0.5 + 0.1 * (count as f64).log2() - 0.2)?;
        let error = new
            .iter()
            .zip(&exact)
            .map(|(&x, exact)| {
                let weights = interpolation(&places, x);
                let mut guess = (Mat::<f64>::zeros(loads, loads), Mat::<f64>::zeros(loads, loads));
                for (part, w) in parts.iter().zip(weights) {
                    watch.checkpoint_quietly()?;
                    add(&mut guess.0, part, w, 0.0);
                    add(&mut guess.1, part, 0.0, -w);
                }
                let scale = largest(&exact.0);
                Ok(largest(&(&guess.0 - &exact.0)).max(largest(&(&guess.1 - &exact.1))) / scale)
            })
            .try_fold(0.0, |worst: f64, error: Result<f64, FeError>| Ok::<_, FeError>(worst.max(error?)))?;
        places.extend(new);
        parts.extend(exact);
        if error <= INTERPOLATION_ERROR {
            break;
        }
    }
    let mut shares = vec![vec![(0.0, 0.0); parts.len()]; offsets + 1];
    for n in direct + 1..=highest {
        let x = 2.0 * ((step * n as f64).ln() - range.0) / (range.1 - range.0) - 1.0;
        for (k, w) in interpolation(&places, x).into_iter().enumerate() {
            for (m, shares) in shares.iter_mut().enumerate() {
                let (sin, cos) = angle(m, n).sin_cos();
                shares[k].0 += w * weight(n) * cos;
                shares[k].1 += w * weight(n) * sin;
            }
        }
    }
    for (sum, shares) in sums.iter_mut().zip(&shares) {
        for (part, &(cos, sin)) in parts.iter().zip(shares) {
            watch.checkpoint_quietly()?;
            add(sum, part, cos, sin);
        }
    }
    Ok(sums)
}

/// Adds `cos · even - sin · odd`.
fn add(sum: &mut Mat<f64>, (even, odd): &PhaseCompliance, cos: f64, sin: f64) {
    for j in 0..sum.ncols() {
        let sources = even.col_as_slice(j).iter().zip(odd.col_as_slice(j));
        for (s, (e, o)) in sum.col_as_slice_mut(j).iter_mut().zip(sources) {
            *s += cos * e - sin * o;
        }
    }
}

fn largest(matrix: &Mat<f64>) -> f64 {
    (0..matrix.ncols()).flat_map(|j| matrix.col_as_slice(j)).fold(0.0, |most, v| most.max(v.abs()))
}

/// Chebyshev points with the ends, `count + 1` of them.
fn lobatto(count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |k| -(std::f64::consts::PI * k as f64 / count as f64).cos())
}

/// Lagrange weights of the values at `places` for `x` within [-1, 1].
fn interpolation(places: &[f64], x: f64) -> Vec<f64> {
    let product = |k: usize| {
        places.iter().enumerate().filter(|&(j, _)| j != k).map(|(_, &p)| (x - p) / (places[k] - p)).product()
    };
    (0..places.len()).map(product).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs, each to the ground and to its neighbour: an unloaded rim of known decay.
    fn chain(ground: f64, coupling: f64) -> Condensed {
        // Unknowns: one on either face. The load acts in the middle, which is tied to both faces.
        let faces = [[ground + coupling, -coupling], [-coupling, ground + coupling]];
        Condensed {
            stiffness: Mat::from_fn(2, 2, |i, j| faces[i][j]),
            forces: Mat::from_fn(2, 1, |_, _| 0.5),
            compliance: Mat::from_fn(1, 1, |_, _| 0.25),
        }
    }

    /// C(θ) = 1/4 + cos²(θ/2)/(2 g + 2 k (1 - cos θ)), summed wave by wave.
    fn expected(teeth: u32, m: usize, ground: f64, coupling: f64) -> f64 {
        (0..teeth)
            .map(|n| {
                let phase = 2.0 * std::f64::consts::PI * f64::from(n) / f64::from(teeth);
                let answer = 0.25 + (0.5 * phase).cos().powi(2) / (2.0 * ground + 2.0 * coupling * (1.0 - phase.cos()));
                answer * (m as f64 * phase).cos() / f64::from(teeth)
            })
            .sum()
    }

    #[test]
    fn waves_add_up_to_the_answer_of_a_chain() {
        for teeth in [5, 12, 29, 67, 150, 299] {
            let (ground, coupling) = (1.0, 3.0);
            let got = expand(&chain(ground, coupling), teeth, 3, Watch::none(), (0.0, 1.0)).unwrap();
            for (m, matrix) in got.iter().enumerate() {
                let error = matrix[(0, 0)] - expected(teeth, m, ground, coupling);
                assert!(error.abs() < 2e-6, "{teeth} teeth, {m}: {error:e}");
            }
        }
    }
}
