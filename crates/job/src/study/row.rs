//! One row of a sweep: the job of a point, and the part of its solution that is stored in the row.

use super::axes;
use super::check::CheckedJob;
use super::mesh::MeshMemo;
use super::point::{self, Point, PointOptions};
use super::{SolveContext, SolveError, vibration};
use crate::DocumentError;
use crate::document::JobDocument;
use crate::result::SweepPoint;
use herringbone_physics::dynamics::{DynamicsError, Parameters};
use herringbone_physics::response::{self, Analysis, Response};
use herringbone_physics::watch::Watch;

/// A row with the state from which its neighbour continues.
#[derive(Default)]
pub(super) struct Solved {
    pub row: SweepPoint,
    /// State to continue a neighbour from.
    pub end_state: Option<Vec<f64>>,
}

/// The job of one point: `base` with the values of the axes assigned.
///
/// # Errors
/// [`SolveError::Document`] if the values contradict each other, or the pair is infeasible.
pub(super) fn job(
    base: &JobDocument,
    sweep: &JobDocument,
    values: &[f64],
    memo: &MeshMemo,
) -> Result<CheckedJob, SolveError> {
    let document = axes::at(base.clone(), sweep.axes.iter().zip(values.iter().copied()))?;
    Ok(CheckedJob::of_point(document, &memo.pairs)?)
}

/// Solves one point. `start`: a neighbour's end state. The row of a point that fails contains the error.
///
/// # Errors
/// [`SolveError::Canceled`].
pub(super) fn solve(
    base: &JobDocument,
    sweep: &JobDocument,
    values: Vec<f64>,
    start: Option<&[f64]>,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<Solved, SolveError> {
    let quiet = SolveContext { progress: &|_, _| {}, ..*context };
    let options = PointOptions { start, whole: false, record: &sweep.record };
    let solved = job(base, sweep, &values, memo).and_then(|job| point::solve(&job, &quiet, memo, &options));
    match solved {
        Ok(point) => Ok(of_point(values, point)),
        Err(error) => failed(values, error),
    }
}

/// Solves several points from their own starts, their motions side by side where they are integrated: as [`solve`] does
/// each.
///
/// # Errors
/// [`SolveError::Canceled`].
pub(super) fn solve_together(
    base: &JobDocument,
    sweep: &JobDocument,
    group: Vec<Vec<f64>>,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<Vec<Solved>, SolveError> {
    let quiet = SolveContext { progress: &|_, _| {}, ..*context };
    let options = PointOptions { start: None, whole: false, record: &sweep.record };
    let staged: Vec<_> = group
        .iter()
        .map(|values| {
            let job = job(base, sweep, values, memo)?;
            let staged = point::stage(&job, &quiet, memo)?;
            let train = staged.parameters().and_then(|parameters| parameters.train.as_deref());
            let analysis = vibration::analysis(job.document(), train, &options)?;
            Ok::<_, SolveError>((job, staged, analysis))
        })
        .collect();
    // Points with the same analysis are integrated together.
    let mut batches: Vec<(&Analysis, Vec<usize>, Vec<Parameters>)> = Vec::new();
    for (i, one) in staged.iter().enumerate() {
        let Ok((_, staged, analysis)) = one else { continue };
        let Some(parameters) = staged.parameters() else { continue };
        match batches.iter_mut().find(|(other, ..)| *other == analysis) {
            Some((_, places, points)) => {
                places.push(i);
                points.push(parameters.clone());
            }
            None => batches.push((analysis, vec![i], vec![parameters.clone()])),
        }
    }
    let mut responses: Vec<Option<Result<Response, DynamicsError>>> = group.iter().map(|_| None).collect();
    let watch = Watch::new(&|_| {}, context.canceled);
    for (analysis, places, points) in batches {
        for (i, response) in places.into_iter().zip(response::solve_many(&points, analysis, &watch)?) {
            responses[i] = Some(response);
        }
    }
    let solved = group.into_iter().zip(staged).zip(responses).map(|((values, staged), response)| {
        let point = staged.and_then(|(job, staged, _)| point::assemble(job.document(), staged, &options, response));
        match point {
            Ok(point) => Ok(of_point(values, point)),
            Err(error) => failed(values, error),
        }
    });
    solved.collect()
}

/// The row of a solved point.
pub(super) fn of_point(values: Vec<f64>, point: Point) -> Solved {
    let row = SweepPoint {
        poincare: point.poincare,
        acceleration_spectrum_m_s2: point.bands,
        ..SweepPoint::of_result(values, &point.result)
    };
    Solved { row, end_state: point.end_state }
}

/// The row of a point without a response.
///
/// # Errors
/// [`SolveError::Canceled`], which belongs to no row.
pub(super) fn failed(values: Vec<f64>, error: SolveError) -> Result<Solved, SolveError> {
    match error {
        SolveError::Canceled(canceled) => Err(canceled.into()),
        error => {
            let row = SweepPoint { values, error: Some(reason(&error)), ..SweepPoint::default() };
            Ok(Solved { row, ..Solved::default() })
        }
    }
}

/// Why a point failed, in a sentence.
pub(super) fn reason(error: &SolveError) -> String {
    match error {
        SolveError::Document(DocumentError::Invalid(violations) | DocumentError::Unsupported(violations)) => violations
            .iter()
            .map(|violation| format!("{} {}", violation.pointer, violation.detail))
            .collect::<Vec<_>>()
            .join("; "),
        other => other.to_string(),
    }
}
