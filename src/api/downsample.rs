//! Fewer points of a series for the eye: what a plot of all of them would show.

use minmaxlttb::{LttbBuilder, LttbMethod, Point};

/// How points are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, utoipa::ToSchema)]
#[schema(rename_all = "lowercase")]
pub enum Method {
    /// Smallest and largest of each of equal stretches, and both ends: every spike stays.
    MinMax,
    /// Largest triangle three buckets over preselected extremes (MinMaxLTTB, arXiv 2305.00332).
    Lttb,
    /// Every sample.
    None,
}

impl Method {
    pub const ALL: [(&'static str, Method); 3] =
        [("minmax", Method::MinMax), ("lttb", Method::Lttb), ("none", Method::None)];

    pub fn word(self) -> &'static str {
        Self::ALL.iter().find(|(_, method)| *method == self).map_or("none", |(word, _)| word)
    }
}

/// Ratio of preselected to returned points; 4 is the value recommended with the method.
const PRESELECTION_RATIO: usize = 4;

/// Indices of at most `max_points` (4 or more) of the values, ascending, and the method that chose them: `None` where all
/// of them fit.
pub fn downsample(values: &[f64], max_points: usize, method: Method) -> (Vec<usize>, Method) {
    if method == Method::None || values.len() <= max_points {
        return ((0..values.len()).collect(), Method::None);
    }
    match method {
        Method::Lttb => (lttb(values, max_points).unwrap_or_else(|| min_max(values, max_points)), Method::Lttb),
        _ => (min_max(values, max_points), Method::MinMax),
    }
}

fn min_max(values: &[f64], max_points: usize) -> Vec<usize> {
    let last = values.len() - 1;
    let buckets = (max_points - 2) / 2;
    let inner = last - 1;
    let mut chosen = vec![0];
    for bucket in 0..buckets {
        let start = 1 + bucket * inner / buckets;
        let end = 1 + (bucket + 1) * inner / buckets;
        let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        if let (Some(low), Some(high)) = ((start..end).min_by(by_value), (start..end).max_by(by_value)) {
            chosen.extend([low.min(high), low.max(high)]);
        }
    }
    chosen.push(last);
    chosen.dedup();
    chosen
}

/// `None` when the method does not apply (it needs strictly increasing times; indices are).
fn lttb(values: &[f64], max_points: usize) -> Option<Vec<usize>> {
    let points: Vec<Point> = values.iter().enumerate().map(|(index, y)| Point::new(index as f64, *y)).collect();
    let method = LttbBuilder::new().method(LttbMethod::MinMax).ratio(PRESELECTION_RATIO).threshold(max_points).build();
    let chosen = method.downsample(&points).ok()?;
    Some(chosen.iter().map(|point| point.x() as usize).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn few_ascending_points_with_both_ends_and_every_extreme(
            values in prop::collection::vec(-1e3..1e3f64, 1..3000), max_points in 4..500usize,
        ) {
            for wanted in [Method::MinMax, Method::Lttb] {
                let (indices, applied) = downsample(&values, max_points, wanted);
                prop_assert!(indices.len() <= max_points);
                prop_assert!(indices.windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert_eq!((indices[0], indices[indices.len() - 1]), (0, values.len() - 1));
                if applied == Method::MinMax {
                    let extreme = |pick: fn(f64, f64) -> f64, of: &mut dyn Iterator<Item = f64>| of.reduce(pick);
                    for pick in [f64::min as fn(f64, f64) -> f64, f64::max] {
                        let all = extreme(pick, &mut values.iter().copied());
                        let few = extreme(pick, &mut indices.iter().map(|index| values[*index]));
                        prop_assert_eq!(all, few);
                    }
                }
            }
            prop_assert_eq!(downsample(&values, 4, Method::None).0.len(), values.len());
        }
    }
}
