use crate::*;

#[test]
fn quantiles_are_those_of_the_tables() {
    // Python's statistics.NormalDist and Abramowitz and Stegun, table 26.5.
    for (p, expected) in [
        (0.5, 0.0),
        (0.975, 1.959_963_984_540_054),
        (0.01, -2.326_347_874_040_841),
        (0.9, 1.281_551_565_544_6),
        (1e-9, -5.997_807_015_007_687),
        (1e-20, -9.262_340_089_798_408),
    ] {
        let found = normal_quantile(p);
        assert!((found - expected).abs() < 1e-12, "{p}: {found}");
    }
    assert!(normal_quantile(0.0) == f64::NEG_INFINITY && normal_quantile(1.0) == f64::INFINITY);
    assert!(normal_quantile(-0.1).is_nan() && normal_quantile(1.1).is_nan());
    for x in [-3.0, -0.5, 0.0, 1.7] {
        assert!((normal_quantile(normal_distribution(x)) - x).abs() < 1e-12);
    }
}

#[test]
fn counted_numbers_are_uniform_and_follow_from_their_place() {
    let numbers: Vec<f64> = (0..20_000).map(|index| CounterRandom::new(1, &[5, index]).uniform()).collect();
    let mean = statistics::mean(&numbers);
    let deviation = statistics::standard_deviation(&numbers);
    assert!((mean - 0.5).abs() < 0.01 && (deviation - 12.0f64.sqrt().recip()).abs() < 0.01, "{mean} {deviation}");
    let mut stream = CounterRandom::new(1, &[5, 3]);
    assert_eq!(stream.uniform(), numbers[3]);
    assert_ne!(CounterRandom::new(2, &[5, 3]).uniform(), numbers[3]);
    let mut counts = [0usize; 7];
    (0..7000).for_each(|_| counts[stream.below(7)] += 1);
    assert!(counts.iter().all(|count| (850..1150).contains(count)), "{counts:?}");
}

#[test]
fn sobol_points_fill_every_elementary_interval() {
    for seed in [0, 9] {
        for dimension in 0..12 {
            let mut counts = [0; 64];
            (0..128).for_each(|index| counts[(64.0 * sobol_point(index, 12, seed)[dimension]) as usize] += 1);
            assert!(counts.iter().all(|count| *count == 2), "{seed} {dimension}: {counts:?}");
        }
    }
    assert!(sobol_point(0, 3, 1) != sobol_point(0, 3, 2));
}
