//! Distribution of one force over points of possible contact: non-negative forces, no penetration.
//!
//! ```text
//! P B Pᵀ f + K f + h(f) + g - d 1 >= 0,   f >= 0,   f ∘ (P B Pᵀ f + K f + h(f) + g - d 1) = 0,   1ᵀ f = F
//! ```
//!
//! (Conry and Seireg 1973 with a local term h.) B is the smooth flexibility of the bodies between the stations of the
//! contact lines, P interpolates it to the points, K couples the points of one line locally. Newton on the nonlinear
//! local approach within an active set, all changes of the set at once and warm-started; when that cycles, a careful
//! active-set method that never leaves f >= 0.

use super::system::{ContactProblem, LEAST_FORCE};
use crate::watch::{Canceled, Meter};

/// A converged distribution.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Distribution {
    /// Normal force of every point, N.
    pub forces: Vec<f64>,
    /// Approach d of the bodies.
    pub approach: f64,
    /// dF/dd at the solution, with the contact set as it is.
    pub stiffness: f64,
    /// Newton iterations.
    pub iterations: u32,
    /// Forces about which the last step was linearised.
    pub linearised_n: Vec<f64>,
}

/// Errors of a distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DistributionError {
    /// The iteration did not converge.
    NotConverged {
        /// Newton iterations.
        iterations: u32,
        /// Largest relative change of a force in the last iteration.
        change: f64,
    },
    Canceled(Canceled),
}

impl From<Canceled> for DistributionError {
    fn from(canceled: Canceled) -> Self {
        DistributionError::Canceled(canceled)
    }
}

const NEWTON_ITERATIONS: u32 = 30;
/// Change of a force, as a part of the whole, after which Newton's iteration ends: every step leaves at most a tenth of
/// the change before it. Coarser, the scatter of the table of the contact force excites high mesh orders.
const TOLERANCE: f64 = 1e-6;

/// Prescribed quantity of a distribution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Prescribed {
    /// The sum of the forces.
    Force(f64),
    /// The approach of the bodies, which has to be larger than the least gap; `expected_force` is the size of the
    /// forces to begin with and to measure changes by.
    Approach { approach: f64, expected_force: f64 },
}

/// Distributes the force over the points. `start` holds forces of a neighbouring state, zeros and all.
pub(super) fn distribute<P: ContactProblem>(
    system: &P,
    prescribed: Prescribed,
    start: &[f64],
    work: &mut P::Workspace,
    meter: &mut Meter,
) -> Result<Distribution, DistributionError> {
    let gaps: Vec<f64> = system.gaps().collect();
    let n = gaps.len();
    let total = match prescribed {
        Prescribed::Force(force) => force,
        Prescribed::Approach { expected_force, .. } => expected_force,
    };
    let mut forces = vec![0.0; n];
    let sum: f64 = start.iter().sum();
    if sum > 0.0 {
        forces.iter_mut().zip(start).for_each(|(f, s)| *f = s * total / sum);
    } else {
        forces.fill(total / n as f64);
    }
    // Number of times that a point has entered the active set; opening and index of points that enter it.
    let mut entries = vec![0u8; n];
    let mut entering: Vec<(f64, usize)> = Vec::new();
    let mut active = forces.iter().map(|&f| f > 0.0).collect::<Vec<_>>();
    // Approach and gaps count from the least gap: gaps far above the deflections would drown them in rounding.
    let datum = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    let above_datum = match prescribed {
        Prescribed::Force(_) => None,
        Prescribed::Approach { approach, .. } => Some(approach - datum),
    };
    let carriers = system.carriers();
    // Changes count as parts of what each of them carries.
    let of_carrier = total / carriers.len() as f64;
    let limit = NEWTON_ITERATIONS + 40 + 6 * n as u32;
    let mut change = f64::INFINITY;
    let mut linearised_n = vec![0.0; n];
    for iteration in 1..=limit {
        let primal = iteration > NEWTON_ITERATIONS;
        linearised_n.copy_from_slice(&forces);
        let step = system.newton((total, above_datum), datum, &forces, &active, work, meter)?;
        let Some((approach, stiffness)) = step else {
            return Err(DistributionError::NotConverged { iterations: iteration, change });
        };
        let new_forces = system.new_forces(work);
        let mut same = true;
        change = 0.0;
        let mut step = 1.0f64;
        if primal {
            for i in 0..n {
                if active[i] && new_forces[i] < 0.0 {
                    step = step.min(forces[i] / (forces[i] - new_forces[i]));
                }
            }
        }
        for i in 0..n {
            if !active[i] {
                continue;
            }
            let f = new_forces[i];
            let mut next = if step < 1.0 { forces[i] + step * (f - forces[i]) } else { f };
            if next <= 1e-14 * total && f <= 0.0 {
                next = 0.0;
                active[i] = false;
                same = false;
            }
            change = change.max((next - forces[i]).abs() / of_carrier);
            forces[i] = next;
        }
        // Everything let go at once: begin again from the point with the least gap.
        let mut let_go = false;
        for range in carriers.iter().filter(|range| !range.is_empty()) {
            if active[range.clone()].iter().all(|&m| !m) {
                let least = range.clone().min_by(|&a, &b| gaps[a].total_cmp(&gaps[b])).unwrap_or(range.start);
                active[least] = true;
                forces[least] = total;
                let_go = true;
            }
        }
        if let_go {
            continue;
        }
        if step < 1.0 || (primal && change > TOLERANCE) {
            continue;
        }
        // Points outside that would penetrate come in.
        let slack = 1e-10 * approach.abs().max(1e-30);
        entering.clear();
        system.displace(&forces, work, meter)?;
        for j in 0..n {
            if active[j] {
                continue;
            }
            let opening = system.deflection(j, &forces, work) + (gaps[j] - datum) - approach;
            // Approach under the least force that counts as contact.
            let least = system.local_approach(j, LEAST_FORCE * total / n as f64).0;
            if opening < -slack.max(least) {
                if !primal {
                    active[j] = true;
                    same = false;
                    // The force that takes the penetration up locally: where to linearise, not a part of the
                    // balance. One that has come in before and was let go again carries less than that.
                    let less = 0.1f64.powi(i32::from(entries[j]));
                    forces[j] = less * force_for(system, j, -opening, total / n as f64);
                    entries[j] = entries[j].saturating_add(1);
                } else {
                    entering.push((opening, j));
                }
            }
        }
        // Carefully: those that penetrate about as deep as the deepest.
        let deepest = entering.iter().fold(0.0f64, |deepest, e| deepest.min(e.0));
        for &(opening, j) in &entering {
            if opening <= 0.5 * deepest {
                active[j] = true;
                same = false;
            }
        }
        let rounding = 16.0 * f64::EPSILON * stiffness * approach.abs() / of_carrier;
        if same && change < TOLERANCE + rounding {
            let approach = approach + datum;
            return Ok(Distribution { forces, approach, stiffness, iterations: iteration, linearised_n });
        }
    }
    Err(DistributionError::NotConverged { iterations: limit, change })
}

/// Force up to `most` under which point `i` approaches by `approach`, to a factor of two.
fn force_for(problem: &impl ContactProblem, i: usize, approach: f64, most: f64) -> f64 {
    let mut force = most;
    for _ in 0..30 {
        if problem.local_approach(i, force).0 <= approach {
            break;
        }
        force *= 0.5;
    }
    force
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compliance::{STENCIL, Stencil};
    use crate::contact::system::{ContactSystem, LocalApproach, SystemWorkspace};
    use crate::watch::Watch;
    use herringbone_oracle::Tolerance::Relative;
    use herringbone_oracle::check;

    /// A uniform foundation of compliance `per_force` at every point.
    struct Winkler {
        per_force: f64,
    }

    impl LocalApproach for Winkler {
        fn approach(&self, _: usize, force: f64) -> (f64, f64) {
            (self.per_force * force, self.per_force)
        }
    }

    /// Uniform Winkler face, linear misalignment f_b over the width b, mean load w: K_Hβ = 1 + f_b c/(2w) while all of
    /// the face carries, √(2 f_b c / w) beyond (closed form). The bulk carries nothing, or half of the foundation's
    /// compliance as a diagonal bulk with a point at every station: both must give the closed form.
    #[test]
    fn misaligned_winkler_face_matches_the_closed_form() {
        let (c, width, total) = (17.0, 100.0, 30000.0);
        for (n, bulk_part, coupled) in [(400, 0.0, false), (400, 0.5, false), (400, 0.5, true)] {
            for misalignment in [5.0f64, 20.0, 60.0, 120.0] {
                let slice = width / n as f64;
                let local = Winkler { per_force: (1.0 - bulk_part) / (c * slice) };
                let mut bulk = vec![0.0; n * n];
                (0..n).for_each(|i| bulk[i * n + i] = bulk_part / (c * slice));
                let stencils: Vec<Stencil> = (0..n)
                    .map(|i| {
                        let first = i.min(n - STENCIL);
                        Stencil { first, weights: std::array::from_fn(|k| f64::from(first + k == i)) }
                    })
                    .collect();
                let gaps: Vec<f64> = (0..n).map(|i| misalignment * (i as f64 + 0.5) / n as f64).collect();
                let lines = [0..n / 4, n / 4..n];
                let coupling: Vec<Vec<f64>> =
                    if coupled { lines.iter().map(|l| vec![0.0; l.len() * l.len()]).collect() } else { Vec::new() };
                let system = ContactSystem {
                    gaps: &gaps,
                    stencils: &stencils,
                    stations: n,
                    bulk: &bulk,
                    lines: &lines,
                    coupling: &coupling,
                    local: &local,
                    modes: &[],
                };
                let mut meter = Meter::new(Watch::none());
                let got =
                    distribute(&system, Prescribed::Force(total), &[], &mut SystemWorkspace::default(), &mut meter)
                        .unwrap();
                let mean = total / width;
                // The largest load at the very edge, from the approach there.
                let factor = got.approach * c / mean;
                let exact = if misalignment * c <= 2.0 * mean {
                    1.0 + misalignment * c / (2.0 * mean)
                } else {
                    (2.0 * misalignment * c / mean).sqrt()
                };
                let solver = if coupled { "lines" } else { "points" };
                let quantity = format!("K_Hβ at a misalignment of {misalignment} µm, bulk part {bulk_part}, {solver}");
                check("Contact: misaligned uniform face (Winkler)", &quantity, factor, exact, Relative(1e-3));
                assert!((got.forces.iter().sum::<f64>() / total - 1.0).abs() < 1e-12);
                assert!(got.forces.iter().all(|&f| f >= 0.0));
            }
        }
    }
}
