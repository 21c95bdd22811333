use crate::{correlated, crowded_front, hypervolume, knee, normal_quantile, sobol_point};

#[test]
fn dominated_points_are_not_in_the_front() {
    let points: Vec<Vec<f64>> =
        [[1.0, 5.0], [2.0, 2.0], [2.0, 2.0], [3.0, 3.0], [5.0, 1.0], [1.0, 6.0]].iter().map(|p| p.to_vec()).collect();
    assert_eq!(crowded_front(&points, 50), [0, 1, 4]);
    let front: Vec<Vec<f64>> = [0, 1, 4].iter().map(|index: &usize| points[*index].clone()).collect();
    assert_eq!(knee(&front), Some(1));
    let curve: Vec<Vec<f64>> = (0..200).map(|i| f64::from(i) / 199.0).map(|x| vec![x, 1.0 - x]).collect();
    let thinned = crowded_front(&curve, 50);
    assert_eq!((thinned.len(), thinned[0], thinned[49]), (50, 0, 199));
    assert!(thinned.windows(2).all(|pair| pair[1] - pair[0] <= 16), "{thinned:?}");
}

#[test]
fn the_volume_of_gains_is_that_of_the_union_of_their_boxes() {
    let gains = |all: &[&[f64]]| hypervolume(&all.iter().map(|gain| gain.to_vec()).collect::<Vec<_>>());
    assert_eq!(gains(&[]), 0.0);
    assert!((gains(&[&[0.5, 0.2], &[0.3, 0.4], &[0.1, 0.1]]) - (0.5 * 0.2 + 0.3 * 0.2)).abs() < 1e-12);
    assert_eq!(gains(&[&[-0.5, 0.9]]), 0.0);
    // Three boxes: 0.1 + 0.1 + 0.1 less the intersections of pairs 3 x 0.05, and that of all three 0.05 twice counted.
    let three = gains(&[&[0.5, 0.5, 0.4], &[0.5, 0.4, 0.5], &[0.4, 0.5, 0.5]]);
    let exact = 3.0 * 0.1 - 3.0 * 0.4 * 0.4 * 0.5 + 0.4f64.powi(3);
    assert!((three - exact).abs() < 1e-12, "{three} {exact}");
}

#[test]
fn deviations_in_company_have_their_correlation() {
    for (count, correlation) in [(2, 0.7), (3, -0.4), (4, 1.0), (2, -1.0)] {
        let points: Vec<Vec<f64>> = (0..8192)
            .map(|index| correlated(&sobol_point(index, count, 3), correlation))
            .map(|point| point.into_iter().map(normal_quantile).collect())
            .collect();
        let mean = |of: &dyn Fn(&Vec<f64>) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
        for a in 0..count {
            assert!((mean(&|z| z[a] * z[a]) - 1.0).abs() < 0.02 && mean(&|z| z[a]).abs() < 0.01, "{count}");
            for b in 0..a {
                let found = mean(&|z| z[a] * z[b]);
                assert!((found - correlation).abs() < 0.02, "{count}: {found}, {correlation}");
            }
        }
    }
}
