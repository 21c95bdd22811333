//! Statistics of samples.

mod intervals;
mod percentiles;
mod sensitivity;

pub use intervals::{RankInterval, order_statistic_interval, student_t_interval, wilson_interval};
pub use percentiles::{mean, percentile, standard_deviation};
pub use sensitivity::{
    Morris, MorrisTrajectory, SobolIndices, first_order_by_bins, jansen, morris_effects, morris_points,
    rank_correlation,
};
