//! Broyden's method on top of an approximate Newton step.

use super::variation::Perturbation;

/// Steps of a search so far. Of a Newton step with an approximate derivative it makes the step with that derivative
/// corrected by Broyden's rank-one updates (C. T. Kelley, Iterative Methods for Linear and Nonlinear Equations, SIAM
/// 1995, section 7.3, DOI 10.1137/1.9781611970944).
#[derive(Debug, Clone)]
pub(crate) struct BroydenSteps<const D: usize> {
    /// The steps taken, and the squares of their norms.
    steps: Vec<(Perturbation<D>, f64)>,
}

fn dot<const D: usize>(a: &Perturbation<D>, b: &Perturbation<D>) -> f64 {
    let of = |a: &[f64; D], b: &[f64; D]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    of(&a.0, &b.0) + of(&a.1, &b.1)
}

fn add<const D: usize>(a: &mut Perturbation<D>, factor: f64, b: &Perturbation<D>) {
    a.0.iter_mut().zip(&b.0).for_each(|(a, b)| *a += factor * b);
    a.1.iter_mut().zip(&b.1).for_each(|(a, b)| *a += factor * b);
}

impl<const D: usize> BroydenSteps<D> {
    pub(crate) fn new() -> Self {
        Self { steps: Vec::new() }
    }

    /// Forgets the steps, after a change of the approximate derivative.
    pub(crate) fn clear(&mut self) {
        self.steps.clear();
    }

    /// The next step where `newton` is the one with the approximate derivative.
    pub(crate) fn step(&mut self, newton: Perturbation<D>) -> Perturbation<D> {
        let mut step = newton;
        for pair in self.steps.windows(2) {
            let ((last, square), (next, _)) = (&pair[0], &pair[1]);
            let factor = dot(last, &step) / square;
            add(&mut step, factor, next);
        }
        if let Some((last, square)) = self.steps.last() {
            let part = 1.0 - dot(last, &step) / square;
            // A step that the secants would lengthen without bound is taken as it is.
            const LEAST: f64 = 0.1;
            if part > LEAST {
                step.0.iter_mut().chain(&mut step.1).for_each(|value| *value /= part);
            }
        }
        let square = dot(&step, &step);
        if square > 0.0 && square.is_finite() {
            self.steps.push((step, square));
        }
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::check_worst;

    /// On a linear system of size n Broyden's method ends after at most 2n steps (D. M. Gay, SIAM J. Numer. Anal. 16
    /// (1979) 623, DOI 10.1137/0716047), where steps with the approximate derivative alone converge linearly.
    #[test]
    fn a_linear_system_is_solved_in_twice_its_size() {
        let matrix = [[1.0, 0.3, 0.0], [-0.2, 1.1, 0.25], [0.1, 0.0, 0.8]];
        let right = [1.0, -2.0, 0.5];
        // f(x) = right − matrix x, the approximate derivative −1.
        let defect = |x: &[f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| right[i] - (0..3).map(|j| matrix[i][j] * x[j]).sum::<f64>())
        };
        let size = |f: [f64; 3]| f.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        let mut x = [0.0; 3];
        let mut plain = [0.0; 3];
        let mut steps = BroydenSteps::<3>::new();
        for _ in 0..6 {
            let (step, _) = steps.step((defect(&x), [0.0; 3]));
            x = std::array::from_fn(|i| x[i] + step[i]);
            let step = defect(&plain);
            plain = std::array::from_fn(|i| plain[i] + step[i]);
        }
        check_worst("Response: Broyden's method", "defect of a linear system", [size(defect(&x))], 1e-12);
        assert!(size(defect(&plain)) > 1e-4);
    }
}
