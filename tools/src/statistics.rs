//! Summary statistics of measurements.

/// The middle value of the sorted ones (the upper one of two); NaN when there are none.
pub fn median(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Root mean square.
pub fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count)).sqrt()
}

/// The value of the largest magnitude, with its sign; NaN when there are none.
pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.reduce(|largest, value| if value.abs() > largest.abs() { value } else { largest }).unwrap_or(f64::NAN)
}
