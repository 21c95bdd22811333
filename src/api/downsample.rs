//! Downsampling of series for plots.

use minmaxlttb::{LttbBuilder, LttbMethod, Point};

/// How points are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, utoipa::ToSchema)]
#[schema(as = Method, rename_all = "lowercase")]
pub(super) enum DownsampleMethod {
    /// Smallest and largest of each of equal stretches, and both ends: every spike stays.
    MinMax,
    /// Largest triangle three buckets over preselected extremes (MinMaxLTTB, arXiv 2305.00332).
    Lttb,
    /// Every sample.
    None,
}

impl DownsampleMethod {
    pub(super) const ALL: [(&'static str, DownsampleMethod); 3] =
        [("minmax", DownsampleMethod::MinMax), ("lttb", DownsampleMethod::Lttb), ("none", DownsampleMethod::None)];

    pub(super) fn as_str(self) -> &'static str {
        Self::ALL.iter().find(|(_, method)| *method == self).map_or("none", |(name, _)| name)
    }
}

/// Ratio of preselected to returned points; 4 is the value recommended with the method.
const PRESELECTION_RATIO: usize = 4;

/// Selects at most `max_points` (4 or more) of the values. Returns their indices, ascending, and the method applied; no
/// indices and [`DownsampleMethod::None`] when all values are selected.
pub(super) fn downsample(
    values: &[f64],
    max_points: usize,
    method: DownsampleMethod,
) -> (Vec<usize>, DownsampleMethod) {
    if method == DownsampleMethod::None || values.len() <= max_points {
        return (Vec::new(), DownsampleMethod::None);
    }
    match method {
        DownsampleMethod::Lttb => {
            (lttb(values, max_points).unwrap_or_else(|| min_max(values, max_points)), DownsampleMethod::Lttb)
        }
        _ => (min_max(values, max_points), DownsampleMethod::MinMax),
    }
}

fn min_max(values: &[f64], max_points: usize) -> Vec<usize> {
    let last = values.len() - 1;
    let buckets = (max_points - 2) / 2;
    let inner = last - 1;
    let mut selected = vec![0];
    for bucket in 0..buckets {
        let start = 1 + bucket * inner / buckets;
        let end = 1 + (bucket + 1) * inner / buckets;
        let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
        if let (Some(low), Some(high)) = ((start..end).min_by(by_value), (start..end).max_by(by_value)) {
            selected.extend([low.min(high), low.max(high)]);
        }
    }
    selected.push(last);
    selected.dedup();
    selected
}

/// `None` when the library reports an error, which indices as strictly increasing times do not cause.
fn lttb(values: &[f64], max_points: usize) -> Option<Vec<usize>> {
    let points: Vec<Point> = values.iter().enumerate().map(|(index, y)| Point::new(index as f64, *y)).collect();
    let method = LttbBuilder::new().method(LttbMethod::MinMax).ratio(PRESELECTION_RATIO).threshold(max_points).build();
    let selected = method.downsample(&points).ok()?;
    Some(selected.iter().map(|point| point.x() as usize).collect())
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
            for requested in [DownsampleMethod::MinMax, DownsampleMethod::Lttb] {
                let (indices, applied) = downsample(&values, max_points, requested);
                if values.len() <= max_points {
                    prop_assert_eq!((indices, applied), (Vec::new(), DownsampleMethod::None));
                    continue;
                }
                prop_assert_eq!(applied, requested);
                prop_assert!(indices.len() <= max_points);
                prop_assert!(indices.windows(2).all(|pair| pair[0] < pair[1]));
                prop_assert_eq!((indices[0], indices[indices.len() - 1]), (0, values.len() - 1));
                if applied == DownsampleMethod::MinMax {
                    let extreme = |pick: fn(f64, f64) -> f64, of: &mut dyn Iterator<Item = f64>| of.reduce(pick);
                    for pick in [f64::min as fn(f64, f64) -> f64, f64::max] {
                        let all = extreme(pick, &mut values.iter().copied());
                        let few = extreme(pick, &mut indices.iter().map(|index| values[*index]));
                        prop_assert_eq!(all, few);
                    }
                }
            }
            let all = downsample(&values, 4, DownsampleMethod::None);
            prop_assert_eq!(all, (Vec::new(), DownsampleMethod::None));
        }
    }
}
