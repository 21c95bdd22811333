//! Confidence interval of the RMS values of a motion that does not repeat, by batch means.
//!
//! The mean squares of the mesh periods are a stationary, correlated sequence. It is divided into batches that are long
//! against the correlation time; the batch means are then nearly independent and normal, and Student's t distribution
//! gives the interval of the mean square and so of the RMS. Batch means: A. M. Law, W. D. Kelton, Simulation Modeling
//! and Analysis, McGraw-Hill. Truncation of the sum of autocorrelations: C. J. Geyer, Statistical Science 7 (1992)
//! 473–483, doi:10.1214/ss/1177011137.

use serde::{Deserialize, Serialize};

use super::channel::ChannelId;
use super::recorder::ChannelRecorder;
use super::report::solved_halves;
use super::statistics::MomentAccumulator;

/// Mean squares of the accelerations of every response, by mesh period.
pub(super) struct MeanSquares {
    tracks: Vec<(ChannelId, MomentAccumulator, Vec<f64>)>,
}

impl MeanSquares {
    pub(crate) fn new<const D: usize>(periods: u64) -> Self {
        let ids = solved_halves::<D>()
            .flat_map(|half| [ChannelId::mesh_acceleration(half), ChannelId::pinion_axial_acceleration(half)]);
        let room = periods.min(1 << 16) as usize;
        Self { tracks: ids.map(|id| (id, MomentAccumulator::new(true), Vec::with_capacity(room))).collect() }
    }

    /// Adds a mesh period; called at its end.
    pub(crate) fn push<const D: usize>(&mut self, recorder: &ChannelRecorder<D>) {
        for (id, snapshot, squares) in &mut self.tracks {
            if let Some(now) = recorder.accumulator(*id) {
                squares.push(now.square_since(snapshot));
                *snapshot = *now;
            }
        }
    }

    /// Mean squares of a channel so far.
    pub(crate) fn of(&self, channel: ChannelId) -> Option<&[f64]> {
        self.tracks.iter().find(|(id, ..)| *id == channel).map(|(_, _, squares)| squares.as_slice())
    }

    pub(crate) fn finish(self) -> Vec<(ChannelId, Vec<f64>)> {
        self.tracks.into_iter().map(|(id, _, squares)| (id, squares)).collect()
    }
}

/// A confidence interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ConfidenceInterval {
    /// Lower limit.
    pub low: f64,
    /// Upper limit.
    pub high: f64,
}

/// Length of a batch in correlation times: the common variance of neighbouring batches is then about a tenth.
const CORRELATIONS_PER_BATCH: f64 = 5.0;
/// Largest number of batches; more hardly reduce the quantile of Student's t distribution.
const MAX_BATCHES: usize = 30;
/// Smallest number of batches from which a variance is estimated.
const MIN_BATCHES: usize = 4;

/// 97.5 % quantiles of Student's t distribution for 3 … 29 degrees of freedom (standard tables).
const STUDENT_975: [f64; MAX_BATCHES - MIN_BATCHES + 1] = [
    3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101,
    2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045,
];

/// 95 % confidence interval of the RMS from the mean squares of the mesh periods of a record. None when the record is
/// too short for its correlation time.
pub(super) fn rms_interval_95(mean_squares: &[f64]) -> Option<ConfidenceInterval> {
    let n = mean_squares.len();
    let correlation = correlation_time(mean_squares);
    let length = n.div_ceil(MAX_BATCHES).max((CORRELATIONS_PER_BATCH * correlation).ceil() as usize);
    let batches = n / length.max(1);
    if batches < MIN_BATCHES {
        return None;
    }
    let mean = mean_squares.iter().sum::<f64>() / n as f64;
    let of_batches: Vec<f64> =
        mean_squares.chunks_exact(length).map(|batch| batch.iter().sum::<f64>() / length as f64).collect();
    let centre = of_batches.iter().sum::<f64>() / batches as f64;
    let scatter = of_batches.iter().map(|m| (m - centre).powi(2)).sum::<f64>() / (batches - 1) as f64;
    // The mean is that of the whole record, including the periods after the last batch.
    let error = (scatter * length as f64 / n as f64).sqrt();
    let reach = STUDENT_975[batches.min(MAX_BATCHES) - MIN_BATCHES] * error;
    let interval = ConfidenceInterval { low: (mean - reach).max(0.0).sqrt(), high: (mean + reach).sqrt() };
    interval.high.is_finite().then_some(interval)
}

/// Integrated autocorrelation time 1 + 2 Σ ρ_k of a sequence; the sum ends before the first pair of neighbours that is
/// not positive. At least 1.
fn correlation_time(values: &[f64]) -> f64 {
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n.max(1) as f64;
    let covariance =
        |lag: usize| values[..n - lag].iter().zip(&values[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    let variance = if n > 0 { covariance(0) } else { 0.0 };
    if variance <= 0.0 {
        return 1.0;
    }
    let mut sum = -variance;
    for lag in (0..n / 2).step_by(2) {
        let pair = covariance(lag) + covariance(lag + 1);
        if pair <= 0.0 {
            break;
        }
        sum += 2.0 * pair;
    }
    (sum / variance).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::reference::{parameters, reference};
    use crate::dynamics::{DynamicModel, Integrator, Motion, Unobserved};
    use crate::response::{Analysis, Regime, SolutionMethod, solve};
    use crate::watch::Watch;
    use rayon::prelude::*;

    /// Initial state of case B with a right half that differs from the mirror image by a few per cent, another for
    /// every `number`.
    fn start(number: usize) -> [f64; 24] {
        let mut start: [f64; 24] = reference().cases["B"].initial_state.as_slice().try_into().unwrap();
        for (c, value) in start[..12].iter_mut().enumerate() {
            // Golden-ratio fractions: spread evenly, never repeating.
            *value *= 1.0 + 0.05 * ((number * 12 + c + 1) as f64 * 0.618_033_988_749_895).fract();
        }
        start
    }

    /// Mean squares of x_left'' of 20 chaotic records from different starts, 3000 mesh periods each.
    fn records() -> Vec<Vec<f64>> {
        let model = DynamicModel::<12>::new(&parameters("B")).unwrap();
        (0..20)
            .into_par_iter()
            .map(|number| {
                let state = model.state_from(&start(number));
                let mut motion = Motion::new(&model, state, Integrator::Taylor, 1e-8, u64::MAX);
                for _ in 0..300 {
                    motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
                }
                let ids = [(ChannelId::mesh_acceleration(0), false), (ChannelId::pinion_axial_acceleration(0), false)];
                let mut recorder = ChannelRecorder::<12>::new(&model, &ids, &[], 0, 0);
                let mut squares = MeanSquares::new::<12>(3000);
                for _ in 0..3000 {
                    motion.advance_period(&mut recorder, &Watch::none(), 0.0).unwrap();
                    squares.push(&recorder);
                }
                squares.finish().swap_remove(0).1
            })
            .collect()
    }

    #[test]
    fn intervals_hold_the_rms_at_the_stated_rate() {
        let records = records();
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let (sum, count) = values.fold((0.0, 0usize), |(s, n), v| (s + v, n + 1));
            sum / count as f64
        };
        let truth = mean(&mut records.iter().flatten().copied()).sqrt();
        for (length, least) in [(3000, 0.85), (1000, 0.9), (300, 0.9), (100, 0.9)] {
            let pieces: Vec<&[f64]> = records.iter().flat_map(|r| r.chunks_exact(length)).collect();
            let intervals: Vec<ConfidenceInterval> = pieces.iter().filter_map(|piece| rms_interval_95(piece)).collect();
            let held = intervals.iter().filter(|i| i.low <= truth && truth <= i.high).count();
            let width = mean(&mut intervals.iter().map(|i| 0.5 * (i.high - i.low) / truth));
            let rate = held as f64 / intervals.len() as f64;
            println!(
                "{length} periods: {held} of {} hold {truth:.2}, {} say nothing; half width {:.2} % on average",
                intervals.len(),
                pieces.len() - intervals.len(),
                100.0 * width
            );
            assert!(rate >= least, "{length}: {rate}");
        }
    }

    /// The interval of a response from each of 20 starts against an independent solution: 120.85 ± 0.15 over 20000
    /// periods.
    #[test]
    fn responses_from_twenty_starts_hold_the_reference() {
        let held = (0..20).into_par_iter().filter(|&number| {
            let analysis = Analysis {
                method: SolutionMethod::Integrate { mesh_periods: 800, record_mesh_periods: 600 },
                initial_state: Some(start(number)),
                ..Analysis::default()
            };
            let summary = solve(&parameters("B"), &analysis, &Watch::none()).unwrap().summary;
            assert_eq!(summary.regime, Regime::Chaotic);
            let interval = summary.rms_interval_95.unwrap().mesh_circumferential_acceleration_m_s2.left;
            let rms = summary.rms.mesh_circumferential_acceleration_m_s2.left;
            assert!(interval.low < rms && rms < interval.high && interval.high - interval.low < 0.1 * rms);
            interval.low <= 121.0 && 120.7 <= interval.high
        });
        let held = held.count();
        println!("{held} of 20 hold the reference");
        // At 95 % fewer than 17 have a probability of 1/60.
        assert!(held >= 17, "{held}");
    }

    #[test]
    fn a_correlated_sequence_gets_wider_intervals_and_a_short_one_none() {
        // Moving averages of evenly spread numbers.
        let white: Vec<f64> = (0..4000).map(|i| (f64::from(i * i) * 0.618_033_988_749_895).fract()).collect();
        let slow: Vec<f64> = white.windows(40).map(|w| w.iter().sum::<f64>() / 40.0).collect();
        assert!(correlation_time(&white) < 2.0);
        let time = correlation_time(&slow);
        assert!((25.0..60.0).contains(&time), "{time}");
        let width = |v: &[f64]| rms_interval_95(v).map(|i| i.high - i.low);
        let (a, b) = (width(&white).unwrap(), width(&slow).unwrap());
        assert!((0.3..3.0).contains(&(b / a)), "the mean of both is known alike: {a} {b}");
        assert_eq!(width(&slow[..300]), None);
        assert_eq!(rms_interval_95(&[]), None);
    }
}
