//! Checks of tests against reference values. Each prints one line with what it measured, from which
//! `scripts/validation` writes the tables of docs/validation/tables.

/// The permitted distance of a value from its reference.
#[derive(Debug, Clone, Copy)]
pub enum Tolerance {
    /// |got − expected| / |expected|.
    Relative(f64),
    /// |got − expected|, in the value's unit.
    Absolute(f64),
}

/// Fails unless `got` is within `tolerance` of `expected`. Prints `oracle|topic|quantity|expected|got|error|tolerance`.
///
/// A topic is an area and a family, `Contact: FZG loads`: one file of tables for each area, one table for each family.
/// The quantity, with its unit, is unique within the topic.
///
/// # Panics
/// If the value is not within the tolerance.
#[track_caller]
pub fn check(topic: &str, quantity: &str, got: f64, expected: f64, tolerance: Tolerance) {
    let (error, limit, kind) = match tolerance {
        Tolerance::Relative(limit) => (((got - expected) / expected).abs(), limit, "rel"),
        Tolerance::Absolute(limit) => ((got - expected).abs(), limit, "abs"),
    };
    let allowed = if kind == "rel" { limit * expected.abs() } else { limit };
    let stated = format!("{expected}");
    let decimals = stated.split_once('.').map_or(0, |(_, after)| after.len());
    // One digit beyond the tolerance's, and all that are stated; a calculated reference has many more than it needs.
    let mut digits = (1.0 - allowed.log10().floor()).clamp(0.0, 15.0) as usize;
    if stated.len() <= 12 {
        digits = digits.max(decimals);
    }
    let reference = if decimals > digits { format!("{expected:.digits$}") } else { stated };
    println!("oracle|{topic}|{quantity}|{reference}|{got:.digits$}|{error:.1e} {kind}|{limit:.1e} {kind}");
    assert!(error <= limit, "{topic}, {quantity}: {got} instead of {expected}, off by {error:e}, allowed {limit:e}");
}

/// Fails unless the magnitude of every error is within `limit`. Prints one line with their number and the largest.
///
/// # Panics
/// If an error is beyond the limit or NaN, or there are none.
#[track_caller]
pub fn check_worst(topic: &str, quantity: &str, errors: impl IntoIterator<Item = f64>, limit: f64) {
    let (mut worst, mut count) = (0.0_f64, 0);
    for error in errors {
        assert!(!error.is_nan(), "{topic}, {quantity}: an error is not a number");
        (worst, count) = (worst.max(error.abs()), count + 1);
    }
    assert!(count > 0, "{topic}, {quantity}: nothing was compared");
    println!("oracle|{topic}|{quantity}|{count} value{}||{worst:.1e}|{limit:.1e}", if count == 1 { "" } else { "s" });
    assert!(worst <= limit, "{topic}, {quantity}: worst error {worst:e}, allowed {limit:e}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_within_the_tolerance_pass() {
        check("Oracle: itself", "relative", 99.0, 100.0, Tolerance::Relative(0.011));
        check("Oracle: itself", "absolute", -1.0, 0.0, Tolerance::Absolute(1.0));
        check_worst("Oracle: itself", "several", [0.1, -0.2], 0.2);
    }

    #[test]
    #[should_panic(expected = "99 instead of 100")]
    fn a_value_beyond_the_tolerance_fails() {
        check("Oracle: itself", "relative", 99.0, 100.0, Tolerance::Relative(0.009));
    }

    #[test]
    #[should_panic(expected = "NaN instead of 1")]
    fn a_value_that_is_not_a_number_fails() {
        check("Oracle: itself", "absolute", f64::NAN, 1.0, Tolerance::Absolute(1.0));
    }

    #[test]
    #[should_panic(expected = "worst error 2e-1")]
    fn a_negative_error_counts_by_its_magnitude() {
        check_worst("Oracle: itself", "several", [0.1, -0.2], 0.1);
    }

    #[test]
    #[should_panic(expected = "not a number")]
    fn an_error_that_is_not_a_number_fails() {
        check_worst("Oracle: itself", "several", [0.0, f64::NAN], 0.1);
    }

    #[test]
    #[should_panic(expected = "nothing was compared")]
    fn no_errors_at_all_fail() {
        check_worst("Oracle: itself", "several", [], 0.1);
    }
}
