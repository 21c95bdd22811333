//! The half sine against quadrature.

use super::*;

fn pulse(duration_s: f64) -> HalfSine {
    match HalfSine::new(7.0, duration_s, 0.3) {
        Some(pulse) => pulse,
        None => panic!("no pulse"),
    }
}

#[test]
fn rises_to_its_force_and_ends() {
    let p = pulse(0.4);
    close(p.at_n(0.5), 7.0, 1e-15);
    close(p.at_n(0.2), 0.0, 0.0);
    close(p.at_n(0.8), 0.0, 0.0);
    close(p.periodic_n(2.5, 1.0), 7.0, 1e-14);
    assert_eq!(p.kinks_s(0.5), [0.3, 0.7 - 0.5]);
}

#[test]
fn mean_and_harmonics_equal_quadrature() {
    // Shorter than the period, resonant with a harmonic (q = pi/2), and longer than the period.
    let (mut means, mut waves) = (Vec::new(), Vec::new());
    for duration in [0.08, 0.5, 1.7] {
        let p = pulse(duration);
        let samples = 200_000;
        let sum = |weight: &dyn Fn(f64) -> f64| {
            (0..samples)
                .map(|i| (f64::from(i) + 0.5) / f64::from(samples))
                .map(|t| p.periodic_n(t, 1.0) * weight(t))
                .sum::<f64>()
                / f64::from(samples)
        };
        means.push(sum(&|_| 1.0) - p.mean_n(1.0));
        for n in [1, 2, 5] {
            let w = 2.0 * PI * f64::from(n);
            let (a, b) = p.harmonic_n(n, 1.0);
            waves.push(2.0 * sum(&|t| (w * t).cos()) - a);
            waves.push(2.0 * sum(&|t| (w * t).sin()) - b);
        }
    }
    let topic = "Impact: half sine pulse of 7 N against quadrature";
    check_worst(topic, "mean, N", means, 1e-8);
    check_worst(topic, "harmonics 1, 2 and 5, N", waves, 1e-7);
}

#[test]
fn has_no_pulse_without_duration() {
    assert_eq!(HalfSine::new(1.0, 0.0, 0.0), None);
    assert_eq!(HalfSine::new(1.0, f64::NAN, 0.0), None);
}
