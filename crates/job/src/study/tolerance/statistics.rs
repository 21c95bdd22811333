//! Statistics of a sample.

use super::run::Sampled;
use super::scatter::halved_density;
use crate::document::{DistributionInput, SCRAMBLES, SamplingInput, SensitivityInput};
use crate::field::Words;
use crate::result::{BeyondLimit, HalfSample, Histogram, InputSensitivity, MeasureScatter, PercentileValue};
use herringbone_search::CounterRandom;
use herringbone_search::statistics::{
    MorrisTrajectory, first_order_by_bins, jansen, mean, morris_effects, order_statistic_interval, percentile,
    rank_correlation, standard_deviation, student_t_interval, wilson_interval,
};

const PERCENTILES: [(&str, f64); 8] = [
    ("p5", 0.05),
    ("p10", 0.1),
    ("p25", 0.25),
    ("p50", 0.5),
    ("p75", 0.75),
    ("p90", 0.9),
    ("p95", 0.95),
    ("p99", 0.99),
];
/// Bars of a histogram, and groups of values along an input.
const BARS: usize = 24;
const BINS: usize = 16;
/// Shuffled samples of which the noise of first-order shares is taken.
const SHUFFLES: u64 = 40;
/// Effective points from which on a weighted percentile is given.
const LEAST_EFFECTIVE: f64 = 100.0;

/// The scatter of a measure.
pub(super) fn scatter_of(sampled: &Sampled, index: usize) -> MeasureScatter {
    let (input, measure) = (&sampled.document.measures[index], &sampled.measures[index]);
    let all: Vec<(usize, f64)> =
        sampled.sample.iter().enumerate().filter_map(|(at, row)| Some((at, row[index]?))).collect();
    let values: Vec<f64> = all.iter().map(|(_, value)| *value).collect();
    let mut found = MeasureScatter {
        measure: measure.name.clone(),
        label: measure.label.clone(),
        unit: measure.unit.to_owned(),
        over: input.over.as_word().to_owned(),
        nominal: sampled.nominal[index],
        ..MeasureScatter::default()
    };
    if values.is_empty() {
        return found;
    }
    let sorted = sorted(&values);
    let is_random = sampled.document.sampling == Some(SamplingInput::Random);
    for (name, part) in PERCENTILES {
        let value = percentile(&sorted, part);
        let interval = match is_random {
            true => order_statistic_interval(sorted.len(), part)
                .map(|ranks| [sorted[ranks.low - 1], sorted[ranks.high - 1]]),
            false => by_scrambles(&all, value, part),
        };
        let [low, high] = interval.map_or([None; 2], |[low, high]| [Some(low), Some(high)]);
        found.percentiles.insert(name.to_owned(), PercentileValue { value, low, high });
    }
    (found.mean, found.std) = (Some(mean(&values)), Some(standard_deviation(&values)));
    found.histogram = Some(histogram(&sorted));
    found.beyond_limit = beyond_limit(sampled, index, &values);
    let half: Vec<f64> = all.iter().filter(|(at, _)| 2 * at < sampled.sample.len()).map(|(_, value)| *value).collect();
    let sorted_half = self::sorted(&half);
    found.convergence = (!half.is_empty()).then(|| HalfSample {
        samples: half.len() as u32,
        mean: mean(&half),
        p90: percentile(&sorted_half, 0.9),
    });
    // The first row is that of the document.
    found.worst_position =
        all.iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(at, _)| *at as u64 + 1);
    found
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The interval of a percentile by its values in the scrambled sequences.
fn by_scrambles(all: &[(usize, f64)], value: f64, part: f64) -> Option<[f64; 2]> {
    let of = |scramble: usize| {
        let own = all.iter().filter(|(at, _)| at % SCRAMBLES as usize == scramble).map(|(_, value)| *value);
        sorted(&own.collect::<Vec<_>>())
    };
    let estimates: Vec<f64> = (0..SCRAMBLES as usize).map(of).map(|own| percentile(&own, part)).collect();
    student_t_interval(value, &estimates).filter(|interval| interval.iter().all(|end| end.is_finite()))
}

fn histogram(sorted: &[f64]) -> Histogram {
    let (from, to) = (sorted[0], sorted[sorted.len() - 1]);
    let mut counts = vec![0; BARS];
    for value in sorted {
        let part = if to > from { (value - from) / (to - from) } else { 0.0 };
        counts[((part * BARS as f64) as usize).min(BARS - 1)] += 1;
    }
    Histogram { from, to, counts }
}

fn beyond_limit(sampled: &Sampled, index: usize, values: &[f64]) -> Option<BeyondLimit> {
    let name = &sampled.document.measures[index].measure;
    let limit = sampled.document.limits.iter().find(|limit| limit.measure == *name)?;
    let is_beyond = |value: &&f64| {
        limit.at_least.is_some_and(|least| **value < least) || limit.at_most.is_some_and(|most| **value > most)
    };
    let count = values.iter().filter(is_beyond).count();
    let [low, high] = wilson_interval(count, values.len());
    let share = count as f64 / values.len() as f64;
    Some(BeyondLimit { at_least: limit.at_least, at_most: limit.at_most, count: count as u32, share, low, high })
}

/// P90 of a measure with the tolerance of one input halved, by weighting the sample, and the number of points of an
/// unweighted sample that say as much; `None` below [`LEAST_EFFECTIVE`].
fn with_halved_tolerance(sampled: &Sampled, input: usize, solved: &[(&Vec<f64>, f64)]) -> Option<(f64, f64)> {
    let tolerance = &sampled.document.tolerances[input];
    // The weights are those of independent inputs.
    let is_in_company =
        sampled.document.correlations.iter().any(|company| company.pointers.contains(&tolerance.pointer));
    if is_in_company {
        return None;
    }
    let weight = |(point, value): &(&Vec<f64>, f64)| Some((*value, halved_density(tolerance, point[input])?));
    let mut weighted: Vec<(f64, f64)> = solved.iter().map(weight).collect::<Option<_>>()?;
    let (sum, squares) = weighted.iter().fold((0.0, 0.0), |(sum, squares), (_, w)| (sum + w, squares + w * w));
    let effective = if squares > 0.0 { sum * sum / squares } else { 0.0 };
    if effective < LEAST_EFFECTIVE {
        return None;
    }
    weighted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    let reached = weighted.iter().find(|(_, weight)| {
        below += weight;
        below >= 0.9 * sum
    });
    reached.map(|(value, _)| (*value, effective))
}

/// The influence of each input on each measure.
pub(super) fn sensitivity(sampled: &Sampled) -> Vec<InputSensitivity> {
    let document = sampled.document;
    let chosen = document.sensitivity.unwrap_or(SensitivityInput::FromSample);
    let mut found = Vec::new();
    if chosen == SensitivityInput::None {
        return found;
    }
    for index in 0..document.measures.len() {
        let of_measure = match chosen {
            SensitivityInput::Morris => by_screening(sampled, index),
            _ => by_sample(sampled, index),
        };
        let total = match chosen {
            SensitivityInput::Jansen => by_second_sample(sampled, index),
            _ => None,
        };
        for (input, mut one) in of_measure.into_iter().enumerate() {
            if let Some(total) = &total {
                (one.first_order, one.total) = (Some(total.first_order[input]), Some(total.total[input]));
                one.first_order_noise = None;
            }
            one.measure.clone_from(&sampled.measures[index].name);
            one.input.clone_from(&document.tolerances[input].pointer);
            found.push(one);
        }
    }
    found
}

fn by_sample(sampled: &Sampled, index: usize) -> Vec<InputSensitivity> {
    let solved: Vec<(&Vec<f64>, f64)> =
        sampled.points.iter().zip(&sampled.sample).filter_map(|(point, row)| Some((point, row[index]?))).collect();
    let values: Vec<f64> = solved.iter().map(|(_, value)| *value).collect();
    let count = values.len();
    let seed = u64::from(sampled.document.seed.unwrap_or(1));
    let shuffled = |number: u64| {
        let mut shuffled = values.clone();
        CounterRandom::new(seed, &[12, number]).shuffle(&mut shuffled);
        let places: Vec<f64> = (0..count).map(|place| place as f64).collect();
        first_order_by_bins(&places, &shuffled, BINS)
    };
    let noise = sorted(&(0..SHUFFLES).map(shuffled).collect::<Vec<_>>());
    let of_input = |input: usize| {
        let column: Vec<f64> = solved.iter().map(|(point, _)| point[input]).collect();
        let (halved_p90, halved_effective_samples) = with_halved_tolerance(sampled, input, &solved).unzip();
        InputSensitivity {
            halved_p90,
            halved_effective_samples,
            // In fixed values the order of the list has no meaning.
            rank_correlation: (sampled.document.tolerances[input].distribution != DistributionInput::FixedValues)
                .then(|| rank_correlation(&column, &values)),
            first_order: Some(first_order_by_bins(&column, &values, BINS)),
            rank_noise: (count > 1).then(|| 1.96 / ((count - 1) as f64).sqrt()),
            first_order_noise: Some(percentile(&noise, 0.95)),
            ..InputSensitivity::default()
        }
    };
    (0..sampled.document.tolerances.len()).map(of_input).collect()
}

/// Shares by a second sample; `None` where a point of it could not be evaluated.
fn by_second_sample(sampled: &Sampled, index: usize) -> Option<herringbone_search::statistics::SobolIndices> {
    let values = |rows: &[Vec<Option<f64>>]| rows.iter().map(|row| row[index]).collect::<Option<Vec<f64>>>();
    let first = values(&sampled.sample)?;
    let further = values(&sampled.further)?;
    let mut parts = further.chunks(first.len().max(1)).map(<[f64]>::to_vec);
    let second = parts.next()?;
    Some(jansen(&first, &second, &parts.collect::<Vec<_>>()))
}

fn by_screening(sampled: &Sampled, index: usize) -> Vec<InputSensitivity> {
    let inputs = sampled.document.tolerances.len();
    let runs = sampled.trajectories.iter().zip(sampled.further.chunks(inputs + 1));
    // A trajectory with a point that could not be evaluated is left out.
    let trajectories: Vec<_> = runs
        .filter_map(|((points, order), rows)| {
            let results: Option<Vec<f64>> = rows.iter().map(|row| row[index]).collect();
            Some(MorrisTrajectory { points: points.clone(), order: order.clone(), results: results? })
        })
        .collect();
    let effects = morris_effects(inputs, &trajectories);
    let of_input = |input: usize| InputSensitivity {
        effect: effects.get(input).map(|effect| effect.mean_magnitude).filter(|effect| effect.is_finite()),
        effect_deviation: effects.get(input).map(|effect| effect.deviation),
        ..InputSensitivity::default()
    };
    (0..inputs).map(of_input).collect()
}
