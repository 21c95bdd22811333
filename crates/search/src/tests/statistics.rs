use super::functions::ishigami;
use crate::statistics::*;
use crate::*;

#[test]
fn intervals_are_those_of_the_tables() {
    // Wilson: 10 of 100 (Newcombe 1998).
    let [low, high] = wilson_interval(10, 100);
    assert!((low - 0.0552).abs() < 1e-4 && (high - 0.1744).abs() < 1e-4, "{low} {high}");
    assert_eq!(wilson_interval(0, 0), [0.0, 1.0]);
    // Ranks of P95 in 1000 values; 200 values have no upper bound of P99.
    let ranks = order_statistic_interval(1000, 0.95).unwrap();
    assert!(ranks.coverage >= 0.95 && ranks.high - ranks.low <= 28, "{ranks:?}");
    assert!((935..=938).contains(&ranks.low) && (962..=965).contains(&ranks.high), "{ranks:?}");
    assert_eq!(order_statistic_interval(200, 0.99), None);
    let sorted = [1.0, 2.0, 3.0, 4.0];
    assert_eq!([0.0, 0.5, 1.0].map(|part| percentile(&sorted, part)), [1.0, 2.5, 4.0]);
}

#[test]
fn f98_percentiles_of_a_linear_function_lie_in_their_intervals() {
    // A sum of normal inputs is normal.
    let weights = [1.0, -2.0, 0.5, 3.0];
    let deviation = weights.iter().map(|w: &f64| w * w).sum::<f64>().sqrt();
    for part in [0.5, 0.9, 0.95] {
        let exact = 10.0 + deviation * normal_quantile(part);
        let hits = (0..100u64)
            .filter(|seed| {
                let scrambles: Vec<Vec<f64>> = (0..8u64)
                    .map(|scramble| {
                        let seed = CounterRandom::new(*seed, &[9, scramble]).bits() as u32;
                        let value = |index| {
                            let point = sobol_point(index, 4, seed);
                            10.0 + point.iter().zip(weights).map(|(u, w)| w * normal_quantile(*u)).sum::<f64>()
                        };
                        let mut values: Vec<f64> = (0..128).map(value).collect();
                        values.sort_by(f64::total_cmp);
                        values
                    })
                    .collect();
                let mut all = scrambles.concat();
                all.sort_by(f64::total_cmp);
                let estimates: Vec<f64> = scrambles.iter().map(|values| percentile(values, part)).collect();
                let [low, high] = student_t_interval(percentile(&all, part), &estimates).unwrap();
                (low..=high).contains(&exact)
            })
            .count();
        println!("P{:.0}: {hits} of 100 intervals hold the value", 100.0 * part);
        assert!(hits >= 90, "{part}: {hits}");
    }
}

#[test]
fn f98_sensitivity_of_the_ishigami_function() {
    let n = 4096;
    let seed = CounterRandom::new(4, &[1]).bits() as u32;
    let points: Vec<Vec<f64>> = (0..n).map(|index| sobol_point(index, 6, seed)).collect();
    let (a, b): (Vec<_>, Vec<_>) = points.iter().map(|point| (point[..3].to_vec(), point[3..].to_vec())).unzip();
    let values = |points: &[Vec<f64>]| -> Vec<f64> { points.iter().map(|point| ishigami(point)).collect() };
    let mixed: Vec<Vec<f64>> = (0..3)
        .map(|input| {
            let mixed: Vec<Vec<f64>> = a
                .iter()
                .zip(&b)
                .map(|(a, b)| {
                    let mut point = a.clone();
                    point[input] = b[input];
                    point
                })
                .collect();
            values(&mixed)
        })
        .collect();
    let (first, total) = ([0.3139, 0.4424, 0.0], [0.5576, 0.4424, 0.2437]);
    let found = jansen(&values(&a), &values(&b), &mixed);
    println!("{found:?}");
    for input in 0..3 {
        assert!((found.first_order[input] - first[input]).abs() < 0.02, "{found:?}");
        assert!((found.total[input] - total[input]).abs() < 0.02, "{found:?}");
        let column: Vec<f64> = a.iter().map(|point| point[input]).collect();
        let by_bins = first_order_by_bins(&column, &values(&a), 16);
        println!("bins: {by_bins}");
        assert!((by_bins - first[input]).abs() < 0.05, "{input}: {by_bins}");
    }
}

#[test]
fn screening_finds_what_matters() {
    let function = |x: &[f64]| 3.0 * x[0] + x[1] * x[1] + 0.0 * x[2];
    let trajectories: Vec<_> = (0..12)
        .map(|number| {
            let (points, order) = morris_points(3, 1, number);
            let results = points.iter().map(|x| function(x)).collect();
            MorrisTrajectory { points, order, results }
        })
        .collect();
    let effects = morris_effects(3, &trajectories);
    assert!((effects[0].mean_magnitude - 3.0).abs() < 1e-9 && effects[0].deviation < 1e-9, "{effects:?}");
    assert!(effects[1].mean_magnitude > 0.5 && effects[1].deviation > 0.1 && effects[2].mean_magnitude == 0.0);
    let line: Vec<f64> = (0..50).map(f64::from).collect();
    let cubes: Vec<f64> = line.iter().map(|x| -x.powi(3)).collect();
    assert!((rank_correlation(&line, &cubes) + 1.0).abs() < 1e-12);
    assert_eq!(rank_correlation(&line, &vec![1.0; 50]), 0.0);
}
