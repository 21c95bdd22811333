//! Evolution strategy with adaptation of the covariance matrix.

use crate::random::CounterRandom;
use crate::score::{Score, ranking};
use nalgebra::{DMatrix, DVector};

/// CMA-ES (Hansen 2016, The CMA evolution strategy: a tutorial, arXiv:1604.00772, default constants, with negative
/// weights) on the unit cube.
///
/// Outside of the cube the function is mirrored at its faces: candidates are evaluated at the mirror point, the
/// distribution is not cut. Only the order of the scores matters.
#[derive(Debug, Clone)]
pub struct CmaEs {
    constants: Constants,
    seed: u64,
    run: u64,
    generation: u64,
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    /// Eigenvectors of the covariance, and the roots of its eigenvalues.
    basis: DMatrix<f64>,
    axes: DVector<f64>,
    path_sigma: DVector<f64>,
    path_covariance: DVector<f64>,
    /// Steps of the candidates that were asked for, in units of sigma.
    steps: Vec<DVector<f64>>,
}

#[derive(Debug, Clone)]
struct Constants {
    n: f64,
    /// Of the candidates from the best to the worst; the second half is negative.
    weights: Vec<f64>,
    parents: usize,
    mu_eff: f64,
    c_c: f64,
    c_sigma: f64,
    c_1: f64,
    c_mu: f64,
    damping: f64,
    /// Expected length of a standard normal vector.
    chi: f64,
}

impl Constants {
    fn new(dimensions: usize, candidates: usize) -> Self {
        let n = dimensions as f64;
        let raw: Vec<f64> =
            (1..=candidates).map(|i| (0.5 * (candidates as f64 + 1.0)).ln() - (i as f64).ln()).collect();
        let parents = candidates / 2;
        let (better, worse) = raw.split_at(parents);
        let effective = |weights: &[f64]| {
            let (sum, squares) = weights.iter().fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
            if squares > 0.0 { sum * sum / squares } else { 0.0 }
        };
        let (mu_eff, mu_eff_negative) = (effective(better), effective(worse));
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu = (1.0 - c_1).min(2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0).powi(2) + mu_eff));
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let most_negative =
            (1.0 + c_1 / c_mu).min(1.0 + 2.0 * mu_eff_negative / (mu_eff + 2.0)).min((1.0 - c_1 - c_mu) / (n * c_mu));
        let positive: f64 = better.iter().sum();
        let negative: f64 = worse.iter().map(|weight| -weight).sum();
        let scale = |weight: &f64| if *weight >= 0.0 { weight / positive } else { most_negative * weight / negative };
        Self {
            n,
            weights: raw.iter().map(scale).collect(),
            parents,
            mu_eff,
            c_c: (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n),
            c_sigma,
            c_1,
            c_mu,
            damping: 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma,
            chi: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
        }
    }
}

/// A coordinate mirrored into \[0, 1\].
pub(crate) fn mirrored(coordinate: f64) -> f64 {
    if !coordinate.is_finite() {
        return 0.5;
    }
    let folded = coordinate.rem_euclid(2.0);
    if folded > 1.0 { 2.0 - folded } else { folded }
}

/// Widest distribution in the unit cube.
const WIDEST: f64 = 0.5;

impl CmaEs {
    /// A search from `start` with the standard deviation `sigma` in every direction. `run` distinguishes searches of
    /// the same seed.
    pub fn new(start: &[f64], sigma: f64, candidates: usize, seed: u64, run: u64) -> Self {
        let n = start.len();
        Self {
            constants: Constants::new(n, candidates.max(4)),
            seed,
            run,
            generation: 0,
            mean: DVector::from_column_slice(start),
            sigma,
            covariance: DMatrix::identity(n, n),
            basis: DMatrix::identity(n, n),
            axes: DVector::from_element(n, 1.0),
            path_sigma: DVector::zeros(n),
            path_covariance: DVector::zeros(n),
            steps: Vec::new(),
        }
    }

    /// Number of candidates of a generation by the number of variables: 4 + ⌊3 ln n⌋, at least 8.
    pub fn usual_candidates(dimensions: usize) -> usize {
        (4 + (3.0 * (dimensions as f64).ln()).floor() as usize).max(8)
    }

    /// Number of candidates of a generation.
    pub fn candidates(&self) -> usize {
        self.constants.weights.len()
    }

    /// Generations that were told.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Largest standard deviation of a direction.
    pub fn spread(&self) -> f64 {
        self.sigma * self.axes.max()
    }

    /// Mean of the distribution, mirrored into the cube.
    pub fn mean(&self) -> Vec<f64> {
        self.mean.iter().map(|value| mirrored(*value)).collect()
    }

    /// The candidates of the next generation.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        let n = self.mean.len();
        let step = |index: usize| {
            let mut random = CounterRandom::new(self.seed, &[self.run, self.generation, index as u64]);
            let scaled = DVector::from_fn(n, |axis, _| self.axes[axis] * random.normal());
            &self.basis * scaled
        };
        self.steps = (0..self.candidates()).map(step).collect();
        let point = |step: &DVector<f64>| (&self.mean + step * self.sigma).iter().map(|x| mirrored(*x)).collect();
        self.steps.iter().map(point).collect()
    }

    /// Adapts the distribution to the scores of the candidates, in the order of [`CmaEs::ask`].
    pub fn tell(&mut self, scores: &[Score]) {
        if self.steps.len() != scores.len() || scores.is_empty() {
            return;
        }
        let steps = std::mem::take(&mut self.steps);
        let order = ranking(scores);
        let Constants { n, weights, parents, mu_eff, c_c, c_sigma, c_1, c_mu, damping, chi } = &self.constants;
        let ranked = || order.iter().zip(weights).map(|(index, weight)| (&steps[*index], *weight));
        let zero = DVector::zeros(self.mean.len());
        let shift = ranked().take(*parents).fold(zero, |sum, (step, weight)| sum + step * weight);
        self.mean += &shift * self.sigma;
        let whiten = |step: &DVector<f64>| {
            let mut along = self.basis.tr_mul(step);
            along.iter_mut().zip(self.axes.iter()).for_each(|(part, axis)| *part /= axis);
            along
        };
        // Lengths are the same before and after the rotation back, the path itself needs it.
        let whitened = &self.basis * whiten(&shift);
        self.path_sigma *= 1.0 - c_sigma;
        self.path_sigma += whitened * (c_sigma * (2.0 - c_sigma) * mu_eff).sqrt();
        let length = self.path_sigma.norm();
        let settled = (1.0 - (1.0 - c_sigma).powf(2.0 * (self.generation as f64 + 1.0))).sqrt();
        let is_short = length / settled < (1.4 + 2.0 / (n + 1.0)) * chi;
        self.path_covariance *= 1.0 - c_c;
        if is_short {
            self.path_covariance += &shift * (c_c * (2.0 - c_c) * mu_eff).sqrt();
        }
        let stalled = if is_short { 0.0 } else { c_1 * c_c * (2.0 - c_c) };
        let sum: f64 = weights.iter().sum();
        self.covariance *= 1.0 + stalled - c_1 - c_mu * sum;
        self.covariance.ger(*c_1, &self.path_covariance, &self.path_covariance, 1.0);
        for (step, weight) in ranked() {
            let factor = if weight >= 0.0 { 1.0 } else { n / whiten(step).norm_squared().max(f64::MIN_POSITIVE) };
            self.covariance.ger(c_mu * weight * factor, step, step, 1.0);
        }
        self.sigma *= ((c_sigma / damping) * (length / chi - 1.0)).min(1.0).exp();
        self.generation += 1;
        self.decompose();
    }

    fn decompose(&mut self) {
        let symmetric = (&self.covariance + self.covariance.transpose()) * 0.5;
        let eigen = symmetric.clone().symmetric_eigen();
        let is_sound = eigen.eigenvalues.iter().all(|value| value.is_finite() && *value > 0.0);
        if !is_sound || !self.sigma.is_finite() {
            // Rounding took the matrix' definiteness: the shape is learnt anew.
            let n = self.mean.len();
            self.covariance = DMatrix::identity(n, n);
            self.basis = DMatrix::identity(n, n);
            self.axes = DVector::from_element(n, 1.0);
            self.path_covariance.fill(0.0);
            self.sigma = if self.sigma.is_finite() { self.sigma } else { WIDEST };
            return;
        }
        self.covariance = symmetric;
        self.axes = eigen.eigenvalues.map(f64::sqrt);
        self.basis = eigen.eigenvectors;
        self.sigma = self.sigma.min(WIDEST / self.axes.max());
        self.mean.iter_mut().for_each(|value| *value = mirrored(*value));
    }
}
