//! The range of an axis, its ticks and their labels.

/// A range, linear or logarithmic.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Value at the left or lower end.
    pub from: f64,
    /// Value at the right or upper end.
    pub to: f64,
    /// Whether equal distances are equal ratios.
    pub logarithmic: bool,
}

impl Scale {
    /// Equal distances are equal differences.
    pub fn linear(from: f64, to: f64) -> Self {
        Self { from, to, logarithmic: false }
    }

    /// Equal distances are equal ratios; both ends are positive.
    pub fn logarithmic(from: f64, to: f64) -> Self {
        Self { from, to, logarithmic: true }
    }

    /// A linear scale over all values: from zero, or symmetric about zero where some are negative.
    pub fn holding(values: impl Iterator<Item = f64> + Clone) -> Self {
        let most = values.clone().fold(1e-12, |most: f64, value| most.max(value.abs())) * 1.06;
        let least = values.fold(0.0, f64::min);
        Self::linear(if least < 0.0 { -most } else { 0.0 }, most)
    }

    /// Place of a value along the scale: 0 at its begin, 1 at its end.
    pub fn part(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }

    /// The value at a place along the scale: the inverse of [`Scale::part`].
    pub fn value(&self, part: f64) -> f64 {
        if self.logarithmic {
            self.from * (self.to / self.from).powf(part)
        } else {
            self.from + part * (self.to - self.from)
        }
    }

    /// The nearest value on the scale.
    pub fn clamp(&self, value: f64) -> f64 {
        value.max(self.from.min(self.to)).min(self.from.max(self.to))
    }

    /// Round values in the range, about four to a linear scale.
    pub(super) fn ticks(&self) -> Vec<f64> {
        if self.logarithmic {
            let decades = (self.to / self.from).log10();
            let steps: &[f64] = if decades > 2.5 {
                &[1.0]
            } else if decades > 1.2 {
                &[1.0, 3.0]
            } else {
                &[1.0, 2.0, 5.0]
            };
            let first = self.from.log10().floor() as i32;
            let all = (first..=first + 8).flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
            return all.filter(|tick| (self.from * 0.999..=self.to * 1.001).contains(tick)).collect();
        }
        let rough = (self.to - self.from).abs() / 4.5;
        let decade = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0]
            .map(|step| step * decade)
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        let first = (self.from / step - 1e-9).ceil() as i64;
        let last = (self.to / step + 1e-9).floor() as i64;
        (first..=last).map(|tick| tick as f64 * step).collect()
    }
}

/// A tick's number: up to three decimals, a true minus sign.
pub(super) fn tick_label(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.').replace('-', "−");
    if text == "−0" { "0".into() } else { text }
}

/// 10ⁿ as SVG text.
pub fn power_of_ten(exponent: i32) -> String {
    let exponent = exponent.to_string().replace('-', "−");
    format!("10<tspan dy=\"-5\" font-size=\"9.5\">{exponent}</tspan>")
}

/// 10ⁿ seconds in s, ms or µs.
pub fn time_label(exponent: i32) -> String {
    let (offset, unit) = match exponent {
        ..-3 => (6, "µs"),
        -3..0 => (3, "ms"),
        _ => (0, "s"),
    };
    let digits = (-(exponent + offset)).max(0) as usize;
    format!("{:.digits$}\u{202f}{unit}", 10f64.powi(exponent + offset))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(Scale::linear(0.0, 9.0).ticks(), [0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!(Scale::logarithmic(1.0, 300.0).ticks(), [1.0, 3.0, 10.0, 30.0, 100.0, 300.0]);
    }

    #[test]
    fn a_value_is_found_again_at_its_part() {
        for scale in [Scale::linear(-2.0, 7.0), Scale::logarithmic(1e-7, 1e2)] {
            for part in [0.0, 0.3, 1.0] {
                assert!((scale.part(scale.value(part)) - part).abs() < 1e-14);
            }
            assert_eq!(scale.clamp(1e9), scale.to);
            assert_eq!(scale.clamp(-1e9), scale.from);
        }
    }

    #[test]
    fn labels_have_units_and_a_true_minus() {
        let labels = [-7, -5, -4, -3, -1, 0, 2].map(time_label);
        assert_eq!(
            labels.map(|label| label.replace('\u{202f}', " ")),
            ["0.1 µs", "10 µs", "100 µs", "1 ms", "100 ms", "1 s", "100 s"]
        );
        assert_eq!([-1.5, -0.0001, 12.0].map(tick_label), ["−1.5", "0", "12"]);
    }
}
