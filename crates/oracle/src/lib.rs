//! Checks against reference values that also say what they measured: each prints one line, from which
//! `scripts/validation` writes the table of docs/VALIDATION.md.

/// How far a value may be from its reference.
#[derive(Debug, Clone, Copy)]
pub enum Tolerance {
    /// |got − expected| / |expected|.
    Relative(f64),
    /// |got − expected|, in the value's unit.
    Absolute(f64),
}

/// Fails unless `got` is within `tolerance` of `expected`; prints `oracle|topic|quantity|expected|got|error|tolerance`.
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

/// Fails unless the largest of `errors` is within `limit`; prints one line for all of them.
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
