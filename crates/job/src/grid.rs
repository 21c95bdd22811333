//! Linear and logarithmic grids. Both ends and the round values between them are exact: a grid from 1 to 1000 in
//! decades contains 10 and 100, one from 0.1 to 1 in tenths contains 0.3.

use super::document::Spacing;

/// Whole numbers up to this are exact as 64-bit floats.
const EXACT: f64 = 9_007_199_254_740_992.0;
/// Significant decimal digits up to which a value of a logarithmic grid counts as round.
const ROUND_DIGITS: usize = 12;

/// The values of a grid of `count` points.
pub fn values(from: f64, to: f64, count: usize, spacing: Spacing) -> Vec<f64> {
    let last = count.saturating_sub(1);
    match spacing {
        Spacing::Linear => {
            let ends = DecimalEnds::new(from, to, last as f64);
            (0..count)
                .map(|index| at(from, to, (index, last), |from, to| linear(&ends, from, to, index, last)))
                .collect()
        }
        Spacing::Logarithmic => (0..count).map(|index| value(from, to, count, spacing, index)).collect(),
    }
}

/// The value at position `index` of a grid of `count` points. A logarithmic grid needs both ends above 0.
pub fn value(from: f64, to: f64, count: usize, spacing: Spacing, index: usize) -> f64 {
    let last = count.saturating_sub(1);
    at(from, to, (index, last), |from, to| match spacing {
        Spacing::Linear => linear(&DecimalEnds::new(from, to, last as f64), from, to, index, last),
        Spacing::Logarithmic => logarithmic(from, to, index as f64 / last as f64),
    })
}

/// An end of a grid, or what is `between` them.
fn at(from: f64, to: f64, (index, last): (usize, usize), between: impl FnOnce(f64, f64) -> f64) -> f64 {
    match index {
        0 => from,
        _ if index >= last => to,
        _ => between(from, to),
    }
}

/// With both ends as whole multiples of the same power of ten, as they are written, the value is a quotient of two
/// whole numbers: one division, so the float nearest to the decimal value. Ends with too many digits for that are
/// interpolated in floating point.
fn linear(ends: &Option<DecimalEnds>, from: f64, to: f64, index: usize, last: usize) -> f64 {
    let (index, last) = (index as f64, last as f64);
    let exact = ends.as_ref().and_then(|ends| ends.value(index, last));
    exact.unwrap_or_else(|| from + (to - from) * (index / last))
}

/// Ends of a grid as whole multiples of a power of ten.
struct DecimalEnds {
    from: f64,
    to: f64,
    exponent: i32,
    divisor: f64,
}

impl DecimalEnds {
    /// None of ends with too many digits. `last`: index of the last value.
    fn new(from: f64, to: f64, last: f64) -> Option<Self> {
        let (a, b) = (decimal(from)?, decimal(to)?);
        let exponent = a.1.min(b.1);
        let whole = |(digits, own): (f64, i32)| digits * 10f64.powi(own - exponent);
        let (from, to) = (whole(a), whole(b));
        let divisor = last * 10f64.powi((-exponent).max(0));
        let fits = from.abs().max(to.abs()) * last <= EXACT && divisor <= EXACT && exponent <= 15;
        fits.then_some(Self { from, to, exponent, divisor })
    }

    fn value(&self, index: f64, last: f64) -> Option<f64> {
        let sum = self.from * (last - index) + self.to * index;
        let scaled = sum * 10f64.powi(self.exponent.max(0));
        (scaled.abs() <= EXACT).then_some(scaled / self.divisor)
    }
}

/// A number as its shortest decimal digits, a whole number, and the power of ten they are multiples of.
fn decimal(value: f64) -> Option<(f64, i32)> {
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e')?;
    let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let digits: f64 = digits.replace('.', "").parse().ok()?;
    let exponent: i32 = exponent.parse().ok()?;
    // Zero is a multiple of any power.
    (digits.abs() <= EXACT).then_some((digits, if digits == 0.0 { 0 } else { exponent - decimals as i32 }))
}

/// Equal ratios. A value within the rounding errors of the power of a round one is that one.
fn logarithmic(from: f64, to: f64, fraction: f64) -> f64 {
    let ratio = to / from;
    let (value, size) = if ratio.is_normal() {
        (from * ratio.powf(fraction), ratio.ln().abs())
    } else {
        (from.powf(1.0 - fraction) * to.powf(fraction), from.ln().abs() + to.ln().abs())
    };
    let round = format!("{value:.*e}", ROUND_DIGITS - 1).parse().unwrap_or(value);
    // The error of the exponent is multiplied by the logarithm of the ratio.
    if f64::abs(round - value) <= f64::EPSILON * (3.0 + size) * value { round } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rstest::rstest;

    /// `0.1 0.2 0.3`: the numbers parsed from text.
    fn numbers(text: &str) -> Vec<f64> {
        text.split_whitespace().map(|word| word.parse().unwrap()).collect()
    }

    #[rstest]
    #[case(1.0, 1000.0, "1 10 100 1000")]
    #[case(1000.0, 1.0, "1000 100 10 1")]
    #[case(0.001, 1000.0, "0.001 0.01 0.1 1 10 100 1000")]
    #[case(1e-6, 1e-2, "1e-6 1e-5 1e-4 1e-3 1e-2")]
    #[case(0.9, 9000.0, "0.9 9 90 900 9000")]
    #[case(0.3, 300.0, "0.3 3 30 300")]
    #[case(2.5, 2500.0, "2.5 25 250 2500")]
    #[case(1.0, 1024.0, "1 2 4 8 16 32 64 128 256 512 1024")]
    #[case(3.0, 48.0, "3 6 12 24 48")]
    #[case(0.7, 700000.0, "0.7 7 70 700 7000 70000 700000")]
    #[case(1e-300, 1e12, "1e-300 1e-196 1e-92 1e12")]
    fn f13_a_logarithmic_grid_meets_its_ends_and_round_values(
        #[case] from: f64,
        #[case] to: f64,
        #[case] expected: &str,
    ) {
        let expected = numbers(expected);
        assert_eq!(values(from, to, expected.len(), Spacing::Logarithmic), expected);
    }

    #[rstest]
    #[case(0.1, 1.0, "0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1.0")]
    #[case(0.0, 1.0, "0 0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1")]
    #[case(-0.3, 0.3, "-0.3 -0.2 -0.1 0 0.1 0.2 0.3")]
    #[case(
        0.7,
        1.2,
        "0.7 0.72 0.74 0.76 0.78 0.8 0.82 0.84 0.86 0.88 0.9 0.92 0.94 0.96 0.98 1 1.02 1.04 1.06 1.08 1.1 1.12 1.14 1.16 1.18 1.2"
    )]
    #[case(1.1, 0.6, "1.1 1 0.9 0.8 0.7 0.6")]
    #[case(1e-6, 7e-6, "1e-6 2e-6 3e-6 4e-6 5e-6 6e-6 7e-6")]
    #[case(500.0, 501.0, "500 500.1 500.2 500.3 500.4 500.5 500.6 500.7 500.8 500.9 501")]
    #[case(1e12, 4e12, "1e12 2e12 3e12 4e12")]
    #[case(0.0, 1.0, "0 0.3333333333333333 0.6666666666666666 1")]
    #[case(24.43, 24.43, "24.43 24.43 24.43")]
    fn f13_a_linear_grid_meets_its_ends_and_round_values(#[case] from: f64, #[case] to: f64, #[case] expected: &str) {
        let expected = numbers(expected);
        assert_eq!(values(from, to, expected.len(), Spacing::Linear), expected);
    }

    #[test]
    fn one_point_is_the_first_end() {
        assert_eq!(values(3.0, 5.0, 1, Spacing::Linear), [3.0]);
        assert_eq!(values(3.0, 5.0, 2, Spacing::Logarithmic), [3.0, 5.0]);
    }

    proptest! {
        /// For any ends, the values are finite, between the ends, ordered, and close to plain interpolation.
        #[test]
        fn a_grid_runs_from_end_to_end(
            from in prop_oneof![-1e12f64..1e12, -10.0f64..10.0, Just(0.0)],
            to in prop_oneof![-1e12f64..1e12, -10.0f64..10.0, Just(5e-324)],
            count in 2usize..200,
        ) {
            let grid = values(from, to, count, Spacing::Linear);
            prop_assert_eq!((grid[0], grid[count - 1]), (from, to));
            let size = from.abs().max(to.abs());
            for (index, value) in grid.iter().enumerate() {
                let plain = from + (to - from) * (index as f64 / (count - 1) as f64);
                prop_assert!((value - plain).abs() <= 4.0 * f64::EPSILON * size, "{} {}", value, plain);
            }
            let (from, to) = (from.abs().max(1e-300), to.abs().max(1e-300));
            let grid = values(from, to, count, Spacing::Logarithmic);
            for (index, value) in grid.iter().enumerate() {
                let part = index as f64 / (count - 1) as f64;
                let plain = from.ln() * (1.0 - part) + to.ln() * part;
                prop_assert!(value.is_finite() && (value.ln() - plain).abs() <= 1e-12, "{} {}", value, plain);
            }
        }

        /// A grid in steps of a decimal is those decimals.
        #[test]
        fn a_grid_of_decimal_steps_has_those_decimals(first in -5000i64..5000, step in 1i64..500, count in 2usize..300, places in 0i32..6) {
            let written = |index: usize| format!("{}e-{places}", first + step * index as i64).parse::<f64>().unwrap();
            let expected: Vec<f64> = (0..count).map(written).collect();
            prop_assert_eq!(values(written(0), written(count - 1), count, Spacing::Linear), expected);
        }
    }
}
