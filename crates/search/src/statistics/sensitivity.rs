//! Which input a result depends on.

use super::{mean, standard_deviation};
use crate::random::CounterRandom;

/// Spearman's rank correlation; 0 where one of the two does not vary.
pub fn rank_correlation(x: &[f64], y: &[f64]) -> f64 {
    let (x, y) = (ranks(x), ranks(y));
    let (mean_x, mean_y) = (mean(&x), mean(&y));
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(&y) {
        let (dx, dy) = (x - mean_x, y - mean_y);
        xy += dx * dy;
        xx += dx * dx;
        yy += dy * dy;
    }
    if xx > 0.0 && yy > 0.0 { xy / (xx * yy).sqrt() } else { 0.0 }
}

/// Ranks from 1; equal values have the mean of theirs.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut place = 0;
    for equal in order.chunk_by(|a, b| values[*a] == values[*b]) {
        let rank = place as f64 + 0.5 * (equal.len() as f64 + 1.0);
        equal.iter().for_each(|index| ranks[*index] = rank);
        place += equal.len();
    }
    ranks
}

/// Share of the variance of `y` that `x` explains alone: the variance of the means of `bins` groups of equal size along
/// `x`, without the part that the scatter within the groups gives them. Not below 0.
pub fn first_order_by_bins(x: &[f64], y: &[f64], bins: usize) -> f64 {
    let variance = standard_deviation(y).powi(2);
    if variance == 0.0 || y.len() < 2 * bins {
        return 0.0;
    }
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|a, b| x[*a].total_cmp(&x[*b]));
    let whole = mean(y);
    let (mut between, mut noise) = (0.0, 0.0);
    for bin in 0..bins {
        let members = &order[bin * order.len() / bins..(bin + 1) * order.len() / bins];
        let values: Vec<f64> = members.iter().map(|index| y[*index]).collect();
        let weight = values.len() as f64 / y.len() as f64;
        between += weight * (mean(&values) - whole).powi(2);
        noise += weight * standard_deviation(&values).powi(2) / values.len() as f64;
    }
    ((between - noise) / variance).max(0.0)
}

/// Shares of the variance by input.
#[derive(Debug, Clone, PartialEq)]
pub struct SobolIndices {
    /// By the input alone.
    pub first_order: Vec<f64>,
    /// By the input with all its interactions.
    pub total: Vec<f64>,
}

/// Sobol indices by the estimators of Jansen (1999, doi:10.1016/S0010-4655(98)00154-4). `a`, `b`: results of two
/// independent samples; `mixed`: for each input the results of the first sample with this input from the second.
pub fn jansen(a: &[f64], b: &[f64], mixed: &[Vec<f64>]) -> SobolIndices {
    let all: Vec<f64> = a.iter().chain(b).copied().collect();
    let variance = standard_deviation(&all).powi(2);
    let half_mean_square = |x: &[f64], y: &[f64]| {
        let squares: f64 = x.iter().zip(y).map(|(x, y)| (x - y).powi(2)).sum();
        0.5 * squares / x.len().max(1) as f64
    };
    let share = |part: f64| if variance > 0.0 { part / variance } else { 0.0 };
    SobolIndices {
        first_order: mixed.iter().map(|of| share(variance - half_mean_square(b, of))).collect(),
        total: mixed.iter().map(|of| share(half_mean_square(a, of))).collect(),
    }
}

/// Elementary effects of an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Morris {
    /// Mean of their magnitudes.
    pub mean_magnitude: f64,
    /// Standard deviation: interactions and curvature.
    pub deviation: f64,
}

/// An evaluated trajectory: its points, the input that changes before each but the first, the result at each.
#[derive(Debug, Clone)]
pub struct MorrisTrajectory {
    pub points: Vec<Vec<f64>>,
    pub order: Vec<usize>,
    pub results: Vec<f64>,
}

/// Levels of the grid of [`morris_points`], and the step between two points of a trajectory.
const LEVELS: usize = 4;
const STEP: f64 = LEVELS as f64 / (2.0 * (LEVELS as f64 - 1.0));

/// The d + 1 points of a trajectory through the unit cube on which one input after the other takes one step (Morris
/// 1991, doi:10.1080/00401706.1991.10484804), and the input that changes before each point but the first.
pub fn morris_points(dimensions: usize, seed: u64, trajectory: u64) -> (Vec<Vec<f64>>, Vec<usize>) {
    let mut random = CounterRandom::new(seed, &[3, trajectory]);
    let lower = LEVELS / 2;
    let mut point: Vec<f64> = (0..dimensions).map(|_| random.below(lower) as f64 / (LEVELS as f64 - 1.0)).collect();
    // Half of the inputs step down.
    let rises: Vec<bool> = (0..dimensions).map(|_| random.below(2) == 0).collect();
    point.iter_mut().zip(&rises).filter(|(_, rises)| !**rises).for_each(|(x, _)| *x += STEP);
    let mut order: Vec<usize> = (0..dimensions).collect();
    random.shuffle(&mut order);
    let mut points = vec![point.clone()];
    for input in &order {
        point[*input] += if rises[*input] { STEP } else { -STEP };
        points.push(point.clone());
    }
    (points, order)
}

/// Elementary effects of each input, in result per unit of the cube, from the results along trajectories.
pub fn morris_effects(dimensions: usize, trajectories: &[MorrisTrajectory]) -> Vec<Morris> {
    let mut effects = vec![Vec::new(); dimensions];
    for MorrisTrajectory { points, order, results } in trajectories {
        for (place, input) in order.iter().enumerate() {
            let step = points[place + 1][*input] - points[place][*input];
            effects[*input].push((results[place + 1] - results[place]) / step);
        }
    }
    let of = |effects: &Vec<f64>| Morris {
        mean_magnitude: mean(&effects.iter().map(|effect| effect.abs()).collect::<Vec<_>>()),
        deviation: standard_deviation(effects),
    };
    effects.iter().map(of).collect()
}
