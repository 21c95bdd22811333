//! One stiffness curve that carries both the loaded transmission error and the stiffness of the contact.

/// Stiffness k(φ) = F/(δ(φ) − c) with the constant c for which its mean is `mean_n_per_m`, N/m.
///
/// The equations of motion know no transmission-error excitation besides k(φ). With this curve their static
/// displacement is the loaded transmission error `transmission_error_m` but for the constant c, a rigid rotation that
/// excites nothing, and their natural frequencies are those of the tangent stiffness, whose mean is to be passed. (F/δ
/// itself would count the closing of a crowning or of a misalignment, which is such a rotation too, as softness.)
///
/// The mean grows monotonically from zero to infinity as c goes from −∞ to the least δ, so there is exactly one such c;
/// it is found by bisection on the least displacement min δ − c. Empty when the curve is empty, the force is not
/// positive, or the mean is not positive.
pub fn equivalent_stiffness(force_n: f64, transmission_error_m: &[f64], mean_n_per_m: f64) -> Vec<f64> {
    let least = transmission_error_m.iter().copied().fold(f64::INFINITY, f64::min);
    if !(least.is_finite() && force_n > 0.0 && mean_n_per_m > 0.0) {
        return Vec::new();
    }
    let curve = |displacement: f64| transmission_error_m.iter().map(move |d| force_n / (d - least + displacement));
    let mean = |displacement: f64| curve(displacement).sum::<f64>() / transmission_error_m.len() as f64;
    // Without fluctuation the least displacement is F/mean; with it, it is smaller, but no less than F/(n mean).
    let mut high = force_n / mean_n_per_m;
    let mut low = high / transmission_error_m.len() as f64;
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if mean(middle) > mean_n_per_m { low = middle } else { high = middle }
    }
    curve(0.5 * (low + high)).collect()
}

#[cfg(test)]
mod tests {
    use super::equivalent_stiffness;

    #[test]
    fn it_keeps_the_mean_stiffness_and_the_error_but_for_a_constant() {
        let error: Vec<f64> = (0..64).map(|i| 20e-6 + 3e-6 * (f64::from(i) * 0.3).sin()).collect();
        let curve = equivalent_stiffness(5000.0, &error, 9e8);
        let mean = curve.iter().sum::<f64>() / 64.0;
        assert!((mean / 9e8 - 1.0).abs() < 1e-12, "{mean}");
        let constant = error[0] - 5000.0 / curve[0];
        assert!(curve.iter().zip(&error).all(|(k, e)| (e - 5000.0 / k - constant).abs() < 1e-18));
    }

    #[test]
    fn a_constant_error_gives_a_constant_stiffness() {
        let curve = equivalent_stiffness(1.0, &[4e-6; 3], 2e8);
        assert!(curve.iter().all(|k| (k / 2e8 - 1.0).abs() < 1e-14));
    }

    #[test]
    fn nonsense_gives_nothing() {
        assert!(equivalent_stiffness(0.0, &[1e-6], 1e8).is_empty());
        assert!(equivalent_stiffness(1.0, &[], 1e8).is_empty());
        assert!(equivalent_stiffness(1.0, &[f64::NAN], 1e8).is_empty());
    }
}
