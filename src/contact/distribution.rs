//! Distribution of one force over points of possible contact: non-negative forces, no penetration.
//!
//! ```text
//! C f + h(f) + g - d 1 >= 0,   f >= 0,   f ∘ (C f + h(f) + g - d 1) = 0,   1ᵀ f = F
//! ```
//!
//! (Conry and Seireg 1973 with a local term h.) Newton on the nonlinear local approach within an active set, all changes of
//! the set at once and warm-started; when that cycles, a primal active-set method that never leaves f >= 0.

use super::linalg::{cholesky, cholesky_solve};

/// The points and their compliance. All quantities along the flank normal.
pub trait Problem {
    /// Number of points.
    fn len(&self) -> usize;
    /// Compliance matrix, symmetric, row-major.
    fn compliance(&self) -> &[f64];
    /// Initial gap of a point.
    fn gap(&self, i: usize) -> f64;
    /// Local approach of a point under a positive force and its derivative.
    fn local(&self, i: usize, force: f64) -> (f64, f64);
}

/// A converged distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    pub forces: Vec<f64>,
    /// Approach d of the bodies.
    pub approach: f64,
    /// dF/dd at the solution, with the contact set as it is.
    pub stiffness: f64,
    pub iterations: u32,
}

/// The iteration did not converge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stalled {
    pub iterations: u32,
    /// Largest relative change of a force in the last iteration.
    pub change: f64,
}

/// Reused memory of the solver.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    matrix: Vec<f64>,
    unit: Vec<f64>,
    rest: Vec<f64>,
    active: Vec<usize>,
    fresh: Vec<f64>,
    deflection: Vec<f64>,
}

const QUICK_ITERATIONS: u32 = 30;
const TOLERANCE: f64 = 1e-11;

/// Distributes `total` over the points. `start` holds forces of a neighbouring state, zeros and all.
pub fn distribute(
    problem: &impl Problem,
    total: f64,
    start: Option<&[f64]>,
    work: &mut Workspace,
) -> Result<Distribution, Stalled> {
    let n = problem.len();
    let mut forces = vec![0.0; n];
    match start {
        Some(start) if start.iter().any(|&f| f > 0.0) => {
            let sum: f64 = start.iter().sum();
            forces.iter_mut().zip(start).for_each(|(f, s)| *f = s * total / sum);
        }
        _ => forces.fill(total / n as f64),
    }
    let mut member = forces.iter().map(|&f| f > 0.0).collect::<Vec<_>>();
    // Approach and gaps count from the least gap: gaps far above the deflections would drown them in rounding.
    let datum = (0..n).map(|i| problem.gap(i)).fold(f64::INFINITY, f64::min);
    let limit = QUICK_ITERATIONS + 40 + 6 * n as u32;
    let mut change = f64::INFINITY;
    for iteration in 1..=limit {
        let careful = iteration > QUICK_ITERATIONS;
        work.active.clear();
        work.active.extend((0..n).filter(|&i| member[i]));
        let Some((approach, stiffness)) = newton(problem, total, datum, &forces, work) else {
            return Err(Stalled { iterations: iteration, change });
        };
        let mut same = true;
        change = 0.0;
        let mut step = 1.0f64;
        if careful {
            for (&i, &f) in work.active.iter().zip(&work.fresh) {
                if f < 0.0 {
                    step = step.min(forces[i] / (forces[i] - f));
                }
            }
        }
        for (&i, &f) in work.active.iter().zip(&work.fresh) {
            let mut next = if step < 1.0 { forces[i] + step * (f - forces[i]) } else { f };
            if next <= 1e-14 * total && f <= 0.0 {
                next = 0.0;
                member[i] = false;
                same = false;
            }
            change = change.max((next - forces[i]).abs() / total);
            forces[i] = next;
        }
        if work.active.iter().all(|&i| !member[i]) {
            // Everything let go at once: begin again from the point with the least gap.
            let least = (0..n).min_by(|&a, &b| problem.gap(a).total_cmp(&problem.gap(b))).unwrap_or(0);
            member[least] = true;
            forces[least] = total;
            continue;
        }
        if step < 1.0 || (careful && change > 1e-9) {
            continue;
        }
        // Points outside that would penetrate come in.
        work.deflection.clear();
        let c = problem.compliance();
        let mut worst = (0.0, usize::MAX);
        let slack = 1e-10 * approach.abs().max(1e-30);
        for j in 0..n {
            if member[j] {
                continue;
            }
            let row = &c[j * n..(j + 1) * n];
            let deflection: f64 = row.iter().zip(&forces).map(|(a, f)| a * f).sum();
            let opening = deflection + (problem.gap(j) - datum) - approach;
            if opening < -slack {
                if !careful {
                    member[j] = true;
                    same = false;
                } else if opening < worst.0 {
                    worst = (opening, j);
                }
            }
        }
        if worst.1 != usize::MAX {
            member[worst.1] = true;
            same = false;
        }
        let rounding = 16.0 * f64::EPSILON * stiffness * approach.abs() / total;
        if same && change < TOLERANCE + rounding {
            return Ok(Distribution { forces, approach: approach + datum, stiffness, iterations: iteration });
        }
    }
    Err(Stalled { iterations: limit, change })
}

/// One Newton step on the active points: their new forces into `work.fresh`; returns approach and stiffness.
fn newton(problem: &impl Problem, total: f64, datum: f64, forces: &[f64], work: &mut Workspace) -> Option<(f64, f64)> {
    let (n, m) = (problem.len(), work.active.len());
    let c = problem.compliance();
    let floor = 1e-9 * total / n as f64;
    work.matrix.clear();
    work.matrix.resize(m * m, 0.0);
    work.unit.clear();
    work.unit.resize(m, 1.0);
    work.rest.clear();
    for (row, &i) in work.active.iter().enumerate() {
        let target = &mut work.matrix[row * m..row * m + row + 1];
        let source = &c[i * n..(i + 1) * n];
        for (t, &j) in target.iter_mut().zip(&work.active) {
            *t = source[j];
        }
        let at = forces[i].max(floor);
        let (value, slope) = problem.local(i, at);
        target[row] += slope;
        work.rest.push(slope * at - value - (problem.gap(i) - datum));
    }
    if !cholesky(&mut work.matrix, m) {
        return None;
    }
    cholesky_solve(&work.matrix, &mut work.unit, m);
    cholesky_solve(&work.matrix, &mut work.rest, m);
    let stiffness: f64 = work.unit.iter().sum();
    let approach = (total - work.rest.iter().sum::<f64>()) / stiffness;
    if !approach.is_finite() {
        return None;
    }
    work.fresh.clear();
    work.fresh.extend(work.rest.iter().zip(&work.unit).map(|(r, u)| r + approach * u));
    Some((approach, stiffness))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::Tolerance::Relative;
    use crate::oracle::check;

    struct Winkler {
        compliance: Vec<f64>,
        gaps: Vec<f64>,
    }

    impl Problem for Winkler {
        fn len(&self) -> usize {
            self.gaps.len()
        }
        fn compliance(&self) -> &[f64] {
            &self.compliance
        }
        fn gap(&self, i: usize) -> f64 {
            self.gaps[i]
        }
        fn local(&self, _: usize, _: f64) -> (f64, f64) {
            (0.0, 0.0)
        }
    }

    /// Uniform Winkler face, linear misalignment f_b over the width b, mean load w: K_Hβ = 1 + f_b c/(2w) while all of
    /// the face carries, √(2 f_b c / w) beyond (closed form).
    #[test]
    fn misaligned_winkler_face_matches_the_closed_form() {
        let (c, width, total) = (17.0, 100.0, 30000.0);
        let n = 400;
        for misalignment in [5.0f64, 20.0, 60.0, 120.0] {
            let slice = width / n as f64;
            let mut compliance = vec![0.0; n * n];
            (0..n).for_each(|i| compliance[i * n + i] = 1.0 / (c * slice));
            let gaps = (0..n).map(|i| misalignment * (i as f64 + 0.5) / n as f64).collect();
            let problem = Winkler { compliance, gaps };
            let got = distribute(&problem, total, None, &mut Workspace::default()).unwrap();
            let mean = total / width;
            // The largest load at the very edge, from the approach there.
            let factor = got.approach * c / mean;
            let exact = if misalignment * c <= 2.0 * mean {
                1.0 + misalignment * c / (2.0 * mean)
            } else {
                (2.0 * misalignment * c / mean).sqrt()
            };
            let quantity = format!("K_Hβ at a misalignment of {misalignment} µm");
            check("Contact: misaligned uniform face (Winkler)", &quantity, factor, exact, Relative(1e-3));
            assert!((got.forces.iter().sum::<f64>() / total - 1.0).abs() < 1e-12);
            assert!(got.forces.iter().all(|&f| f >= 0.0));
        }
    }
}
