//! The run of a tolerance study.

use super::earlier::Earlier;
use super::scatter::{Scatter, scrambles};
use super::statistics;
use crate::DocumentError;
use crate::document::{JobDocument, MORRIS_TRAJECTORIES, MeasureInput, SCRAMBLES, SamplingInput, SensitivityInput};
use crate::field::Words;
use crate::result::{EvaluationPhase, SweepPoint, ToleranceResult};
use crate::study::evaluation::{
    Evaluate, EvaluationSettings, EvaluationTask, Evaluator, Found, Inputs, Measure, Outcome, Rows, check_measure,
    check_pointers, reduce,
};
use crate::study::mesh::MeshMemo;
use crate::study::optimise::check_shafts;
use crate::study::points::StoredPoints;
use crate::study::{SolveContext, SolveError, axes};
use herringbone_search::statistics::morris_points;
use herringbone_search::{CounterRandom, sobol_point};
use std::ops::Range;

/// The quantities and inputs of a tolerance study, or of the tolerances of an optimisation.
pub(in crate::study) struct Quantities {
    pub measures: Vec<Measure>,
}

impl Quantities {
    /// Checks tolerances and measures.
    ///
    /// # Errors
    /// [`DocumentError::Invalid`] with every input and quantity that there is not.
    pub(in crate::study) fn new(document: &JobDocument) -> Result<Self, DocumentError> {
        let mut found = Found::new();
        let mut base = axes::base(document);
        let inputs: Vec<Inputs> = document.tolerances.iter().map(Inputs::of_tolerance).collect();
        check_pointers(document, &mut base, "tolerances", &inputs, &mut found);
        for (index, inputs) in inputs.iter().enumerate() {
            for (place, (pointer, _)) in inputs.pointers().enumerate() {
                let here = match place {
                    0 => format!("/tolerances/{index}/pointer"),
                    _ => format!("/tolerances/{index}/also/{}", place - 1),
                };
                let reason = match base.slot(pointer) {
                    Some(slot) if slot.is_whole_number() => "is a whole number, which does not scatter",
                    Some(slot) if slot.is_number() && slot.number().is_none() => {
                        "has no value in the document to which deviations could be added"
                    }
                    _ => continue,
                };
                found.push(crate::Violation::new(here, "conflict", format!("\"{pointer}\" {reason}")));
            }
        }
        let mut measures = Vec::new();
        for (index, MeasureInput { measure, halves, .. }) in document.measures.iter().enumerate() {
            let here = format!("/measures/{index}/measure");
            measures.extend(check_measure(measure, *halves, &here, &mut found));
        }
        check_shafts(document, &measures, &mut found);
        if found.is_empty() { Ok(Self { measures }) } else { Err(DocumentError::Invalid(found)) }
    }
}

/// The rows of a study by what they are for.
pub(super) struct Sampled<'a> {
    pub document: &'a JobDocument,
    pub measures: &'a [Measure],
    /// Points of the unit cube of the sample.
    pub points: Vec<Vec<f64>>,
    /// Values of each measure over the operating points, as one; of the document, the sample, and the sensitivity.
    pub nominal: Vec<Option<f64>>,
    pub sample: Vec<Vec<Option<f64>>>,
    pub further: Vec<Vec<Option<f64>>>,
    /// Points and orders of the trajectories of a screening.
    pub trajectories: Vec<(Vec<Vec<f64>>, Vec<usize>)>,
}

/// Solves a document of kind `tolerance`.
///
/// # Errors
/// [`SolveError::Canceled`]; [`SolveError::Document`] if the study is none.
pub(in crate::study) fn run(
    document: &JobDocument,
    stored: StoredPoints,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(ToleranceResult, bool), SolveError> {
    let quantities = Quantities::new(document)?;
    let evaluator = Evaluator::new(document, &quantities.measures, context, memo);
    let mut rows = Rows::new(stored, document.evaluations(), context);
    let earlier = Earlier::load(document, context);
    rows.know(earlier.rows.clone());
    let Evaluated { points, sample, further, trajectories, clipped } = evaluate_all(document, &evaluator, &mut rows)?;
    let shares = evaluator.shares();
    let of_row = |row: &SweepPoint| -> Vec<Option<f64>> {
        let value = |(index, measure): (usize, &MeasureInput)| {
            let measures = row.measures.as_ref()?;
            Some(reduce(&measures[index * shares.len()..(index + 1) * shares.len()], measure.over, &shares))
        };
        document.measures.iter().enumerate().map(value).collect()
    };
    let sampled = Sampled {
        document,
        measures: &quantities.measures,
        points,
        nominal: of_row(&rows.rows[0]),
        sample: rows.rows[sample.clone()].iter().map(of_row).collect(),
        further: rows.rows[further..].iter().map(of_row).collect(),
        trajectories,
    };
    let failed = rows.rows.iter().filter(|row| row.error.is_some()).count() as u32;
    let result = ToleranceResult {
        measures: (0..document.measures.len()).map(|index| statistics::scatter_of(&sampled, index)).collect(),
        sensitivity: statistics::sensitivity(&sampled),
        failed,
        clipped,
        points_reused: earlier.reused(&rows.rows[1..]),
        samples: sample.len() as u32,
        sampling: document.sampling.unwrap_or(SamplingInput::Sobol).as_word().to_owned(),
        seed: document.seed.unwrap_or(1),
        points: Vec::new(),
    };
    earlier.save(&rows.rows[1..], context);
    let has_reused = rows.has_reused || result.points_reused > 0;
    Ok((ToleranceResult { points: rows.rows, ..result }, has_reused))
}

/// Solves evaluations of a document of kind `tolerance` apart from the rest, by the positions of their rows, which go
/// to the point store of the context.
///
/// # Errors
/// [`SolveError::Canceled`]; [`SolveError::Document`] if the study is none.
pub(in crate::study) fn run_part(
    document: &JobDocument,
    positions: &[usize],
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(), SolveError> {
    let quantities = Quantities::new(document)?;
    let evaluator = Evaluator::new(document, &quantities.measures, context, memo);
    let mut rows = Rows::of_positions(positions, context);
    evaluate_all(document, &evaluator, &mut rows).map(drop)
}

/// What the rows of a study are for.
struct Evaluated {
    /// Points of the unit cube of the sample.
    points: Vec<Vec<f64>>,
    /// Rows of the sample, and the first one of those for the sensitivity.
    sample: Range<usize>,
    further: usize,
    trajectories: Vec<(Vec<Vec<f64>>, Vec<usize>)>,
    /// Values that stand at the end of the range of their field.
    clipped: u32,
}

/// Makes the evaluations of a study: the document, the sample, and those for the sensitivity.
fn evaluate_all(document: &JobDocument, evaluator: &Evaluator, rows: &mut Rows) -> Result<Evaluated, SolveError> {
    let scatter = &Scatter::new(document, &evaluator.base);
    let samples = Samples { evaluator, scatter };
    let mut clipped = 0;
    let mut evaluate = |points: &[Vec<f64>], phase: EvaluationPhase, rows: &mut Rows| {
        let task = |point: &Vec<f64>| {
            let (values, cut) = scatter.values(&mut evaluator.base.clone(), point);
            clipped += cut;
            let settings = EvaluationSettings::Own;
            EvaluationTask { settings, values, further: Vec::new(), phase, generation: None }
        };
        let tasks = points.iter().map(task).collect();
        rows.run(tasks, &samples)
    };
    let input = EvaluationTask {
        settings: EvaluationSettings::Input,
        values: scatter.inputs.iter().map(|i| i.value(&mut evaluator.base.clone()).unwrap_or_default()).collect(),
        further: Vec::new(),
        phase: EvaluationPhase::Input,
        generation: None,
    };
    rows.run(vec![input], &samples)?;

    let sensitivity = document.sensitivity.unwrap_or(SensitivityInput::FromSample);
    let inputs = scatter.len();
    let both = sample_points(document, if sensitivity == SensitivityInput::Jansen { 2 * inputs } else { inputs });
    let first: Vec<Vec<f64>> = both.iter().map(|point| scatter.in_company(point[..inputs].to_vec())).collect();
    let mut trajectories = Vec::new();
    let sample = match sensitivity {
        SensitivityInput::Morris => 0..0,
        _ => evaluate(&first, EvaluationPhase::Sample, rows)?,
    };
    let further = rows.len();
    match sensitivity {
        SensitivityInput::Jansen => {
            let second: Vec<Vec<f64>> = both.iter().map(|point| point[inputs..].to_vec()).collect();
            evaluate(&second, EvaluationPhase::Sensitivity, rows)?;
            for input in 0..inputs {
                let mixed = first.iter().zip(&second).map(|(a, b)| {
                    let mut point = a.clone();
                    point[input] = b[input];
                    point
                });
                evaluate(&mixed.collect::<Vec<_>>(), EvaluationPhase::Sensitivity, rows)?;
            }
        }
        SensitivityInput::Morris => {
            let seed = u64::from(document.seed.unwrap_or(1));
            for number in 0..MORRIS_TRAJECTORIES {
                let (points, order) = morris_points(inputs, seed, u64::from(number));
                // Between the quantiles 0.05 and 0.95: the ends of a distribution may be far away.
                let inner: Vec<Vec<f64>> =
                    points.iter().map(|point| point.iter().map(|part| 0.05 + 0.9 * part).collect()).collect();
                evaluate(&inner, EvaluationPhase::Sensitivity, rows)?;
                trajectories.push((points, order));
            }
        }
        SensitivityInput::FromSample | SensitivityInput::None => {}
    }
    Ok(Evaluated { points: first, sample, further, trajectories, clipped })
}

/// The document, and samples of its tolerances.
struct Samples<'a> {
    evaluator: &'a Evaluator<'a>,
    scatter: &'a Scatter<'a>,
}

impl Evaluate for Samples<'_> {
    fn outcome(&self, task: &EvaluationTask) -> Result<Outcome, SolveError> {
        let (evaluator, gate) = (self.evaluator, |_: &[Option<f64>]| 0.0);
        match task.settings {
            EvaluationSettings::Input => evaluator.evaluate(&evaluator.base, &[], &[], &gate),
            _ => evaluator.evaluate(&evaluator.base, &self.scatter.inputs, &task.values, &gate),
        }
    }

    fn complete(&self, _outcome: &Outcome, _row: &mut SweepPoint) {}
}

/// Points of the unit cube: those of the scrambled sequences by turns, so that the first half is a sample too.
fn sample_points(document: &JobDocument, dimensions: usize) -> Vec<Vec<f64>> {
    let seed = u64::from(document.seed.unwrap_or(1));
    let seeds = scrambles(seed, 10);
    let point = |index: u32| match document.sampling {
        Some(SamplingInput::Random) => {
            let mut random = CounterRandom::new(seed, &[11, u64::from(index)]);
            (0..dimensions).map(|_| random.uniform()).collect()
        }
        _ => sobol_point(index / SCRAMBLES, dimensions, seeds[(index % SCRAMBLES) as usize]),
    };
    (0..document.samples.unwrap_or_default()).map(point).collect()
}
