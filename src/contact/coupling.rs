//! Coupling of one tooth along the face: a Winkler foundation with a shear layer, free at both ends.
//!
//! Plane tooth deflections vary along the face as C₀/(1 + k²λ²) (k the axial wave number), the transform of
//! C₀/(2λ) e^{-|z|/λ}: a foundation of compliance C₀ per length whose neighbouring slices are joined by springs λ²/(C₀ dz).
//! As a chain of springs it is positive definite for any course of C₀ and λ along the face, and a uniform load on a uniform
//! tooth deflects by exactly C₀ w, ends included.

/// Influence of the slices of one tooth on each other: the inverse of the chain.
#[derive(Debug, Clone, Default)]
pub struct ToothChain {
    scale: Vec<f64>,
    pivots: Vec<f64>,
    off: Vec<f64>,
    diagonal: Vec<f64>,
}

impl ToothChain {
    /// Prepares slices of width `step_m` with (compliance per length, decay length) each.
    pub fn prepare(&mut self, step_m: f64, slices: impl Iterator<Item = (f64, f64)>) {
        self.scale.clear();
        self.off.clear();
        self.diagonal.clear();
        let mut previous: Option<f64> = None;
        for (compliance, decay) in slices {
            let decay2 = decay * decay;
            self.scale.push(compliance.sqrt());
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

    /// Spreads slice forces along the face: the reactions of the foundation to them. Only for chains of unit compliance.
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

    /// Displacement of every slice per unit force on slice `j`.
    pub fn column(&self, j: usize, out: &mut [f64]) {
        let n = self.pivots.len();
        out[..n].fill(0.0);
        out[j] = self.scale[j];
        for i in j + 1..n {
            out[i] = -self.off[i - 1] / self.pivots[i - 1] * out[i - 1];
        }
        for (value, pivot) in out.iter_mut().zip(&self.pivots) {
            *value /= pivot;
        }
        for i in (0..n.saturating_sub(1)).rev() {
            out[i] -= self.off[i] / self.pivots[i] * out[i + 1];
        }
        for (value, scale) in out.iter_mut().zip(&self.scale) {
            *value *= scale;
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
        let mut chain = ToothChain::default();
        chain.prepare(step, (0..n).map(|_| (3.0, decay)));
        let mut column = vec![0.0; n];
        let mut sum = vec![0.0; n];
        let mut errors = Vec::new();
        for j in 0..n {
            chain.column(j, &mut column);
            for (s, c) in sum.iter_mut().zip(&column) {
                *s += c * step;
            }
            if j == n / 2 {
                for (i, value) in column.iter().enumerate() {
                    let z = (i as f64 - j as f64).abs() * step;
                    let exact = 3.0 / (2.0 * decay) * (-z / decay).exp();
                    errors.push(value - exact);
                }
            }
        }
        let topic = "Contact: coupling along the face";
        check_worst(topic, "point load against the exponential, of a peak of 1", errors, 5e-3);
        check_worst(topic, "uniform load against the plane deflection of 3", sum.iter().map(|s| s - 3.0), 1e-9);
    }
}
