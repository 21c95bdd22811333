//! Mean, standard deviation and percentiles.

/// Arithmetic mean; NaN without values.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation of the population from a sample (n − 1); 0 of fewer than two values.
pub fn standard_deviation(values: &[f64]) -> f64 {
    if values.len() < 2 {
        return 0.0;
    }
    let centre = mean(values);
    let squares: f64 = values.iter().map(|value| (value - centre).powi(2)).sum();
    (squares / (values.len() - 1) as f64).sqrt()
}

/// The value below which `part` of the values lie, between neighbours by their places (Hyndman and Fan 1996, type 7,
/// doi:10.1080/00031305.1996.10473566). `sorted`: ascending. NaN without values.
pub fn percentile(sorted: &[f64], part: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let place = part.clamp(0.0, 1.0) * last as f64;
    let (low, weight) = (place.floor() as usize, place.fract());
    let high = (low + 1).min(last);
    if weight == 0.0 { sorted[low] } else { sorted[low] + weight * (sorted[high] - sorted[low]) }
}
