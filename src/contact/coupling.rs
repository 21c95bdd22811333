//! Coupling of one tooth along the face: a Winkler foundation with a shear layer, free at both ends.
//!
//! Plane tooth deflections vary along the face as C₀/(1 + k²λ²) (k the axial wave number), the transform of
//! C₀/(2λ) e^{-|z|/λ}: a foundation of compliance C₀ per length whose neighbouring slices are joined by springs λ²/(C₀ dz).
//! As a chain of springs it is positive definite for any course of C₀ and λ along the face, and a uniform load on a uniform
//! tooth deflects by exactly C₀ w, ends included.

/// The chain of slices, ready to spread loads.
#[derive(Debug, Clone, Default)]
pub struct ToothChain {
    pivots: Vec<f64>,
    off: Vec<f64>,
    diagonal: Vec<f64>,
}

impl ToothChain {
    /// Prepares slices of width `step_m` of unit compliance with their decay lengths.
    pub fn prepare(&mut self, step_m: f64, slices: impl Iterator<Item = f64>) {
        self.off.clear();
        self.diagonal.clear();
        let mut previous: Option<f64> = None;
        for decay in slices {
            let decay2 = decay * decay;
            let mut d = step_m;
            if let Some(p) = previous {
                let joint = 0.5 * (p + decay2) / step_m;
                if let Some(last) = self.diagonal.last_mut() {
                    *last += joint;
                }
                self.off.push(-joint);
                d += joint;
            }
            self.diagonal.push(d);
            previous = Some(decay2);
        }
        // LDLᵀ of the tridiagonal matrix.
        self.pivots.clear();
        for i in 0..self.diagonal.len() {
            let d = if i == 0 {
                self.diagonal[0]
            } else {
                self.diagonal[i] - self.off[i - 1] * self.off[i - 1] / self.pivots[i - 1]
            };
            self.pivots.push(d);
        }
    }

    /// Spreads slice forces along the face: the reactions of the foundation to them.
    pub fn spread(&self, step_m: f64, values: &mut [f64]) {
        let n = self.pivots.len();
        for i in 1..n {
            values[i] -= self.off[i - 1] / self.pivots[i - 1] * values[i - 1];
        }
        for (value, pivot) in values.iter_mut().zip(&self.pivots) {
            *value *= step_m / pivot;
        }
        for i in (0..n.saturating_sub(1)).rev() {
            values[i] -= self.off[i] / self.pivots[i] * values[i + 1];
        }
    }
}

/// The same coupling between places of different compliance and decay length of one tooth: every cosine wave along the
/// face couples two places by the geometric mean of their own answers, so that all places together stay positive
/// definite.
pub struct ToothModes<const P: usize> {
    /// Sum over the waves by the difference or (plus one) the sum of two slice numbers.
    table: Vec<[[f64; P]; P]>,
}

impl<const P: usize> ToothModes<P> {
    /// `slices` slices of width `step_m`; `places` are (compliance per length, decay length).
    pub fn new(step_m: f64, slices: usize, places: &[(f64, f64); P]) -> ToothModes<P> {
        let n = slices as f64;
        let mut table = vec![[[0.0; P]; P]; 2 * slices];
        for m in 0..slices {
            let half = (0.5 * std::f64::consts::PI * m as f64 / n).sin();
            let waves = 4.0 * half * half / step_m;
            let root = places.map(|(c, decay)| (c / (step_m + decay * decay * waves)).sqrt());
            let norm = if m == 0 { 0.5 } else { 1.0 } / n;
            for (distance, entry) in table.iter_mut().enumerate() {
                let wave = norm * (std::f64::consts::PI * (m * distance) as f64 / n).cos();
                for a in 0..P {
                    for b in 0..P {
                        entry[a][b] += wave * root[a] * root[b];
                    }
                }
            }
        }
        ToothModes { table }
    }

    /// Adds the displacements of slice `i` at all places per force at slice `j` at all places, row by row.
    pub fn add(&self, i: usize, j: usize, entry: &mut [f64]) {
        for a in 0..P {
            for b in 0..P {
                entry[a * P + b] += self.table[i.abs_diff(j)][a][b] + self.table[i + j + 1][a][b];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::check_worst;

    #[test]
    fn uniform_load_gives_the_plane_deflection_and_points_the_exponential() {
        let (n, width, decay) = (200, 40.0, 1.5);
        let step = width / n as f64;
        let own = ToothModes::new(step, n, &[(3.0, decay)]);
        let mut sum = vec![0.0; n];
        let mut errors = Vec::new();
        for j in 0..n {
            for (i, total) in sum.iter_mut().enumerate() {
                let mut value = [0.0];
                own.add(i, j, &mut value);
                *total += value[0] * step;
                if j == n / 2 {
                    let z = (i as f64 - j as f64).abs() * step;
                    errors.push(value[0] - 3.0 / (2.0 * decay) * (-z / decay).exp());
                }
            }
        }
        let topic = "Contact: coupling along the face";
        check_worst(topic, "point load against the exponential, of a peak of 1", errors, 5e-3);
        check_worst(topic, "uniform load against the plane deflection of 3", sum.iter().map(|s| s - 3.0), 1e-9);
    }
}
