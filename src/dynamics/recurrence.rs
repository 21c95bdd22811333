//! The recurrence that gives the Taylor coefficients of the motion between two events.

use super::excitation::{Coefficients, MAX_ORDER};
use super::model::{Contact, Model, PER_HALF};

impl<const D: usize> Model<D> {
    /// Taylor coefficients of the motion up to `order` in scaled time, from `rows[0]`, `rows[1]` (x and dx/dτ) and the
    /// excitation in `work`. `loads` false gives the variation about a motion with the same contacts.
    #[inline(always)]
    pub fn taylor(&self, contact: [Contact; 2], order: usize, loads: bool, work: &mut TaylorWork<D>) {
        let TaylorWork { rows, s, force, excitation } = work;
        for j in 0..Self::HALVES {
            s[j][0] = self.s(j, &rows[0]);
            s[j][1] = self.s(j, &rows[1]);
        }
        for n in 0..order - 1 {
            let n1 = (n + 1) as f64;
            let x = rows[n];
            let v = rows[n + 1].map(|c| c * n1);
            let scale = 1.0 / (n1 * (n1 + 1.0));
            for j in 0..Self::HALVES {
                let h = &self.halves[j];
                let mut f = if contact[j] != 0 || self.damping_in_gap { h.cm * n1 * s[j][n + 1] } else { 0.0 };
                if contact[j] != 0 {
                    let degree = excitation.degree[j].min(n);
                    let k = &excitation.backwards[j][MAX_ORDER - degree..];
                    f += dot(k, &s[j][n - degree..=n]);
                    if loads && n <= excitation.degree[j] {
                        f -= excitation.stiffness[j][n] * f64::from(contact[j]) * self.b;
                    }
                }
                force[j][n] = f;
                let mut along = 0.0;
                if loads {
                    if excitation.pushed[j] {
                        along -= excitation.impact[j][n];
                    }
                    if n == 0 {
                        along += h.load;
                    }
                }
                let a = self.half_acceleration(j, &x, &v, f, along);
                let i = j * PER_HALF;
                for c in 0..PER_HALF {
                    rows[n + 2][i + c] = a[c] * scale;
                }
            }
            for j in 0..Self::HALVES {
                s[j][n + 2] = self.s(j, &rows[n + 2]);
            }
        }
    }
}

/// Σ a_i b_i with four partial sums, which the processor adds side by side.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a4.zip(b4) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

/// Taylor coefficients of the excitations over one step.
struct TaylorExcitation {
    stiffness: [Coefficients; 2],
    /// The stiffness again, highest order first, so that a convolution is a dot product.
    backwards: [Coefficients; 2],
    degree: [usize; 2],
    impact: [Coefficients; 2],
    pushed: [bool; 2],
}

/// Working memory of a Taylor step: coefficients of every coordinate, of s and of F_n.
pub(crate) struct TaylorWork<const D: usize> {
    pub rows: [[f64; D]; MAX_ORDER + 1],
    pub s: [Coefficients; 2],
    pub force: [Coefficients; 2],
    excitation: TaylorExcitation,
}

impl<const D: usize> TaylorWork<D> {
    pub fn new() -> Box<Self> {
        const ZERO: Coefficients = [0.0; MAX_ORDER + 1];
        let excitation = TaylorExcitation {
            stiffness: [ZERO; 2],
            backwards: [ZERO; 2],
            degree: [0; 2],
            impact: [ZERO; 2],
            pushed: [false; 2],
        };
        Box::new(Self { rows: [[0.0; D]; MAX_ORDER + 1], s: [ZERO; 2], force: [ZERO; 2], excitation })
    }

    /// Sets the excitation about `phase`; `inside` is a phase in the interior of the smooth stretch.
    pub fn excite(&mut self, model: &Model<D>, phase: f64, inside: f64, order: usize) {
        let e = &mut self.excitation;
        for (j, h) in model.halves.iter().enumerate() {
            e.degree[j] = h.stiffness.fill(phase, inside, order, &mut e.stiffness[j]);
            for n in 0..=e.degree[j] {
                e.backwards[j][MAX_ORDER - n] = e.stiffness[j][n];
            }
            e.pushed[j] = h.impact.fill(phase, inside, order, &mut e.impact[j]);
        }
    }
}
