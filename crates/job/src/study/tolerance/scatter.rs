//! How inputs scatter.

use crate::document::{CorrelationInput, DistributionInput, JobDocument, SCRAMBLES, ToleranceInput};
use crate::study::evaluation::Inputs;
use herringbone_search::{CounterRandom, correlated, normal_distribution, normal_quantile};

/// The inputs that scatter, with the distributions of their deviations.
pub(in crate::study) struct Scatter<'a> {
    pub inputs: Vec<Inputs<'a>>,
    distributions: Vec<Distribution<'a>>,
    ranges: Vec<[f64; 2]>,
    /// Inputs that deviate in company, and their correlation.
    companies: Vec<(Vec<usize>, f64)>,
}

struct Distribution<'a> {
    tolerance: &'a ToleranceInput,
    /// Probability below the cut of a normal distribution.
    cut: f64,
}

impl<'a> Scatter<'a> {
    /// The tolerances of a document; `base` has their inputs.
    pub(in crate::study) fn new(document: &'a JobDocument, base: &JobDocument) -> Self {
        let mut base = base.clone();
        let inputs: Vec<Inputs> = document.tolerances.iter().map(Inputs::of_tolerance).collect();
        let mut range = |inputs: &Inputs| {
            let range = base.slot(inputs.pointer).and_then(|slot| slot.range());
            range.unwrap_or([f64::NEG_INFINITY, f64::INFINITY])
        };
        let distribution = |tolerance: &'a ToleranceInput| Distribution {
            tolerance,
            cut: if tolerance.cut { normal_distribution(-tolerance.sigmas) } else { 0.0 },
        };
        let company = |correlation: &CorrelationInput| {
            let place = |pointer: &String| document.tolerances.iter().position(|one| one.pointer == *pointer);
            (correlation.pointers.iter().filter_map(place).collect(), correlation.correlation)
        };
        Self {
            companies: document.correlations.iter().map(company).collect(),
            ranges: inputs.iter().map(&mut range).collect(),
            distributions: document.tolerances.iter().map(distribution).collect(),
            inputs,
        }
    }

    pub(in crate::study) fn len(&self) -> usize {
        self.inputs.len()
    }

    /// A point of the unit cube with independent coordinates as one with those of the inputs in company.
    pub(in crate::study) fn in_company(&self, mut point: Vec<f64>) -> Vec<f64> {
        for (members, correlation) in &self.companies {
            let own: Vec<f64> = members.iter().map(|member| point[*member]).collect();
            members.iter().zip(correlated(&own, *correlation)).for_each(|(member, part)| point[*member] = part);
        }
        point
    }

    /// Values of the inputs of `document` with the deviations at a point of the unit cube, within the ranges of their
    /// fields, and how many were cut there.
    pub(in crate::study) fn values(&self, document: &mut JobDocument, point: &[f64]) -> (Vec<f64>, u32) {
        let mut clipped = 0;
        let mut value = |index: usize| {
            let own = self.inputs[index].value(document).unwrap_or_default();
            let wanted = own + self.distributions[index].deviation(point[index]);
            let [least, most] = self.ranges[index];
            let value = wanted.clamp(least, most);
            clipped += u32::from(value != wanted);
            value
        };
        let values = (0..self.len()).map(&mut value).collect();
        (values, clipped)
    }
}

impl Distribution<'_> {
    /// The deviation below which the part `part` of the distribution lies.
    fn deviation(&self, part: f64) -> f64 {
        let t = self.tolerance;
        let deviation = t.tolerance.unwrap_or_default() / t.sigmas;
        let plus = t.plus.unwrap_or_default();
        let minus = t.minus.unwrap_or(plus);
        t.mean
            + match t.distribution {
                DistributionInput::Normal => deviation * normal_quantile(self.cut + part * (1.0 - 2.0 * self.cut)),
                DistributionInput::HalfNormal => deviation * normal_quantile(0.5 + part * (0.5 - self.cut)),
                DistributionInput::Uniform => part * (plus + minus) - minus,
                DistributionInput::Triangular if plus + minus == 0.0 => 0.0,
                DistributionInput::Triangular if part * (plus + minus) < minus => {
                    (part * minus * (plus + minus)).sqrt() - minus
                }
                DistributionInput::Triangular => plus - ((1.0 - part) * plus * (plus + minus)).sqrt(),
                DistributionInput::FixedValues => {
                    let values = t.values.as_deref().unwrap_or_default();
                    let index = ((part * values.len() as f64) as usize).min(values.len().saturating_sub(1));
                    values.get(index).copied().unwrap_or_default()
                }
            }
    }
}

/// Density of a deviation with half its tolerance over that of the deviation itself, at the part `part` of its
/// distribution; `None` of distributions for which it is not known.
pub(super) fn halved_density(tolerance: &ToleranceInput, part: f64) -> Option<f64> {
    let cut = if tolerance.cut { normal_distribution(-tolerance.sigmas) } else { 0.0 };
    // Half the deviation at the same density of the tail: 2 exp(-(2 z)²/2 + z²/2).
    let of_normal = |quantile: f64| 2.0 * (-1.5 * quantile * quantile).exp();
    match tolerance.distribution {
        DistributionInput::Normal => Some(of_normal(normal_quantile(cut + part * (1.0 - 2.0 * cut)))),
        DistributionInput::HalfNormal => Some(of_normal(normal_quantile(0.5 + part * (0.5 - cut)))),
        DistributionInput::Uniform => {
            let plus = tolerance.plus.unwrap_or_default();
            let minus = tolerance.minus.unwrap_or(plus);
            let deviation = part * (plus + minus) - minus;
            Some(if (-0.5 * minus..=0.5 * plus).contains(&deviation) { 2.0 } else { 0.0 })
        }
        DistributionInput::Triangular | DistributionInput::FixedValues => None,
    }
}

/// Seeds of the scrambled sequences of a sample.
pub(in crate::study) fn scrambles(seed: u64, sample: u64) -> [u32; SCRAMBLES as usize] {
    std::array::from_fn(|scramble| CounterRandom::new(seed, &[sample, scramble as u64]).bits() as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::DistributionInput::{FixedValues, HalfNormal, Normal, Triangular, Uniform};

    fn tolerance(distribution: DistributionInput) -> ToleranceInput {
        ToleranceInput {
            pointer: String::new(),
            also: Vec::new(),
            also_factors: None,
            halves: None,
            distribution,
            mean: 1.0,
            tolerance: Some(3.0),
            iso1328_class: None,
            sigmas: 3.0,
            cut: true,
            plus: Some(2.0),
            minus: Some(1.0),
            values: Some(vec![5.0, 7.0]),
        }
    }

    /// Weighted by the density of the halved tolerance, deviations have half their standard deviation.
    #[test]
    fn weights_halve_the_scatter() {
        for distribution in [Normal, HalfNormal, Uniform] {
            let tolerance = ToleranceInput { cut: false, minus: Some(2.0), ..tolerance(distribution) };
            let of = Distribution { tolerance: &tolerance, cut: 0.0 };
            let (mut plain, mut halved, mut sum) = (0.0, 0.0, 0.0);
            let count = 20_000;
            for index in 0..count {
                let part = (f64::from(index) + 0.5) / f64::from(count);
                let weight = halved_density(&tolerance, part).expect("known");
                let square = (of.deviation(part) - 1.0).powi(2);
                (plain, halved, sum) = (plain + square, halved + weight * square, sum + weight);
            }
            assert!((sum / f64::from(count) - 1.0).abs() < 0.01, "{distribution:?}: {sum}");
            assert!((halved / sum / (plain / f64::from(count)) - 0.25).abs() < 0.01, "{distribution:?}");
        }
    }

    /// Means of many deviations against closed forms, and the ends of the distributions.
    #[test]
    fn distributions_have_their_means_and_ends() {
        let half_normal = (2.0 / std::f64::consts::PI).sqrt();
        for (distribution, mean, ends) in [
            (Normal, 1.0, [-2.0, 4.0]),
            (HalfNormal, 1.0 + half_normal, [1.0, 4.0]),
            (Uniform, 1.5, [0.0, 3.0]),
            (Triangular, 1.0 + (2.0 - 1.0) / 3.0, [0.0, 3.0]),
            (FixedValues, 7.0, [6.0, 8.0]),
        ] {
            let tolerance = tolerance(distribution);
            let of = Distribution { tolerance: &tolerance, cut: normal_distribution(-3.0) };
            let count = 20_000;
            let values: Vec<f64> = (0..count).map(|i| of.deviation((f64::from(i) + 0.5) / f64::from(count))).collect();
            let found = values.iter().sum::<f64>() / f64::from(count);
            assert!((found - mean).abs() < 0.01, "{distribution:?}: {found}");
            assert!((values[0] - ends[0]).abs() < 0.02 && (values[count as usize - 1] - ends[1]).abs() < 0.02);
            assert!(values.windows(2).all(|pair| pair[0] <= pair[1]), "{distribution:?}");
        }
    }
}
