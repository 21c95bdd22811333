//! Confidence intervals, 95 %.

use super::{mean, standard_deviation};

/// Two-sided 97.5 % points of Student's t distribution for 1 to 10 degrees of freedom, and of the normal distribution.
const STUDENT_T: [f64; 10] = [12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281];
const NORMAL: f64 = 1.959_963_984_540_054;

/// Interval around `value` by the scatter of independent estimates of it, of which `value` is the pooled one; `None` of
/// fewer than two. More than eleven estimates are taken as normal.
pub fn student_t_interval(value: f64, estimates: &[f64]) -> Option<[f64; 2]> {
    let freedom = estimates.len().checked_sub(1).filter(|freedom| *freedom > 0)?;
    let t = STUDENT_T.get(freedom - 1).copied().unwrap_or(NORMAL);
    let half = t * standard_deviation(estimates) / (estimates.len() as f64).sqrt();
    // The pooled value and the mean of the estimates differ by their bias.
    let bias = (mean(estimates) - value).abs();
    Some([value - half - bias, value + half + bias])
}

/// Interval of a share that was found `count` times in `all` (Wilson 1927, doi:10.1080/01621459.1927.10502953).
pub fn wilson_interval(count: usize, all: usize) -> [f64; 2] {
    if all == 0 {
        return [0.0, 1.0];
    }
    let (n, share, z2) = (all as f64, count as f64 / all as f64, NORMAL * NORMAL);
    let centre = (share + 0.5 * z2 / n) / (1.0 + z2 / n);
    let half = NORMAL / (1.0 + z2 / n) * (share * (1.0 - share) / n + 0.25 * z2 / (n * n)).sqrt();
    [(centre - half).max(0.0), (centre + half).min(1.0)]
}

/// Ranks, from 1, of the values of a random sample between which a percentile of the population lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankInterval {
    pub low: usize,
    pub high: usize,
    /// Probability that it lies there, at least 0.95.
    pub coverage: f64,
}

/// The narrowest interval of ranks about the percentile `part` with a coverage of at least 95 %, by the binomial
/// distribution (David and Nagaraja, Order statistics, 3rd ed., 7.1). `None` where the sample is too small.
pub fn order_statistic_interval(count: usize, part: f64) -> Option<RankInterval> {
    let distribution = binomial_distribution(count, part);
    // P(X_(l) <= x_p < X_(u)) = F(u − 1) − F(l − 1).
    let below = |rank: usize| if rank == 0 { 0.0 } else { distribution[rank - 1] };
    let mut best: Option<RankInterval> = None;
    let mut high = 2;
    for low in 1..=count {
        high = high.max(low + 1);
        while high <= count && below(high) - below(low) < 0.95 {
            high += 1;
        }
        if high > count {
            break;
        }
        let found = RankInterval { low, high, coverage: below(high) - below(low) };
        let is_better = |best: &RankInterval| {
            let (width, width_of_best) = (high - low, best.high - best.low);
            width < width_of_best || (width == width_of_best && found.coverage > best.coverage)
        };
        if best.as_ref().is_none_or(is_better) {
            best = Some(found);
        }
    }
    best
}

/// Distribution function of the binomial distribution at 0, 1, …, `count`.
fn binomial_distribution(count: usize, part: f64) -> Vec<f64> {
    let (log_part, log_rest) = (part.ln(), (1.0 - part).ln());
    let (mut log_choices, mut sum) = (0.0, 0.0);
    let mut distribution = Vec::with_capacity(count + 1);
    for k in 0..=count {
        if k > 0 {
            log_choices += ((count - k + 1) as f64).ln() - (k as f64).ln();
        }
        sum += (log_choices + k as f64 * log_part + (count - k) as f64 * log_rest).exp();
        distribution.push(sum);
    }
    distribution
}
