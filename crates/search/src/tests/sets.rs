use crate::{crowded_front, knee};

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
