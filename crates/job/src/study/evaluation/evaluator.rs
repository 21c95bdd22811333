//! One evaluation: a document at all operating points.

use super::inputs::{Inputs, put_point, with_values};
use super::measure::{Level, Measure};
use super::shortfall::shortfall;
use crate::document::{Fidelity, JobDocument, JobKind, MeshForce, MeshStiffness, OperatingPointInput};
use crate::result::{JobResult, MeshCurve, SweepPoint};
use crate::study::check::CheckedJob;
use crate::study::mesh::MeshMemo;
use crate::study::point::{self, PointOptions};
use crate::study::prepare::geometry;
use crate::study::{NoStageStore, SolveContext, SolveError, axes, row};
use crate::{DocumentError, Violation};
use rayon::prelude::*;
use serde_json::Value;

/// What came out of an evaluation.
#[derive(Debug, Clone, Default)]
pub(in crate::study) struct Outcome {
    /// Values measure after measure, in each the operating points; `None` where the design was not solved.
    pub measures: Option<Vec<f64>>,
    /// Violation of a design that was not solved.
    pub violation: f64,
    pub error: Option<String>,
    /// The numbers of the first operating point.
    pub row: SweepPoint,
}

/// Evaluates documents at the operating points of a job.
pub(in crate::study) struct Evaluator<'a> {
    /// The document of an evaluation before values are put in.
    pub base: JobDocument,
    points: Vec<OperatingPointInput>,
    pub measures: &'a [Measure],
    level: Level,
    context: &'a SolveContext<'a>,
    memo: &'a MeshMemo,
}

/// Positions of the contact analysis during a search, instead of as many as an accuracy asks for: those make small
/// steps.
pub(in crate::study) const SEARCH_POSITIONS: u32 = 32;
/// Accuracy of the contact during a search: the tables of the mesh force take less than half of the time of the usual
/// accuracy and move accelerations by about one per cent.
pub(in crate::study) const SEARCH_ACCURACY: f64 = 0.01;

impl<'a> Evaluator<'a> {
    pub(in crate::study) fn new(
        job: &JobDocument,
        measures: &'a [Measure],
        context: &'a SolveContext<'a>,
        memo: &'a MeshMemo,
    ) -> Self {
        let level = measures.iter().map(Measure::level).max().unwrap_or(Level::Geometry);
        let mut base = axes::base(job);
        if level < Level::Response {
            base.kind = JobKind::Mesh;
        }
        let mut points = job.operating_points.clone();
        if points.is_empty() {
            points.push(OperatingPointInput { pinion_speed_rpm: None, pinion_torque_nm: None, share: 1.0 });
        }
        Self { base, points, measures, level, context, memo }
    }

    /// The base with fixed positions of the contact analysis, and coarser tables of the mesh force; `None` where that
    /// changes nothing.
    pub(in crate::study) fn coarse_base(&self) -> Option<JobDocument> {
        let mut base = self.base.clone();
        let has_tables = self.level == Level::Response && base.model.mesh_force == MeshForce::Contact;
        // Bodies displaced by shafts have coarser tables already.
        let is_alone = base.design.shafts.is_none();
        let MeshStiffness::Ltca(ltca) = &mut base.model.mesh_stiffness else { return None };
        if self.level > Level::Geometry && ltca.positions.is_none() {
            ltca.positions = Some(SEARCH_POSITIONS);
        }
        if has_tables && is_alone {
            ltca.accuracy = ltca.accuracy.max(SEARCH_ACCURACY);
        }
        (base.model != self.base.model).then_some(base)
    }

    /// The same at other speeds: those of all operating points times a factor.
    pub(in crate::study) fn at_speeds(&self, factor: f64) -> Self {
        let scaled = |point: &OperatingPointInput| OperatingPointInput {
            pinion_speed_rpm: point.pinion_speed_rpm.map(|speed_rpm| factor * speed_rpm),
            ..point.clone()
        };
        let mut base = self.base.clone();
        base.operation.pinion_speed_rpm *= factor;
        Self { base, points: self.points.iter().map(scaled).collect(), ..*self }
    }

    /// The operating points: speed in r/min and torque in N m of each.
    pub(in crate::study) fn operating_points(&self) -> Vec<[f64; 2]> {
        let operation = &self.base.operation;
        let of = |point: &OperatingPointInput| {
            let speed_rpm = point.pinion_speed_rpm.unwrap_or(operation.pinion_speed_rpm);
            [speed_rpm, point.pinion_torque_nm.unwrap_or(operation.pinion_torque_nm)]
        };
        self.points.iter().map(of).collect()
    }

    pub(in crate::study) fn shares(&self) -> Vec<f64> {
        self.points.iter().map(|point| point.share).collect()
    }

    /// Evaluates `base` with values put in. `gate`: violation by the quantities of the geometry, which stand at their
    /// places among the measures; a design that has one is not solved.
    ///
    /// # Errors
    /// [`SolveError::Canceled`].
    pub(in crate::study) fn evaluate(
        &self,
        base: &JobDocument,
        inputs: &[Inputs],
        values: &[f64],
        gate: &(dyn Fn(&[Option<f64>]) -> f64 + Sync),
    ) -> Result<Outcome, SolveError> {
        if (self.context.canceled)() {
            return Err(SolveError::Canceled(herringbone_physics::watch::Canceled));
        }
        let failed = |error: &SolveError, violation: f64| {
            let error = Some(row::reason(error));
            Outcome { violation, error, ..Outcome::default() }
        };
        let jobs = match self.jobs(base, inputs, values) {
            Ok(jobs) => jobs,
            // Worse than a pair that exists, and the worse the farther it is from one.
            Err((error, missing)) => return Ok(failed(&error.into(), 2.0 + missing)),
        };
        let count = self.points.len();
        let mut found: Vec<Option<f64>> = vec![None; self.measures.len() * count];
        for (at, job) in jobs.iter().enumerate() {
            let known = JobResult { geometry: Some(geometry(job.prepared())), ..JobResult::default() };
            if let Err(error) = self.read(&known, job, at, Level::Geometry, &mut found) {
                return Ok(Outcome { violation: 1.0, error: Some(error), ..Outcome::default() });
            }
        }
        let violation = gate(&found);
        if violation > 0.0 {
            return Ok(Outcome { violation: 1.0 + violation, ..Outcome::default() });
        }
        let mut first = SweepPoint::default();
        if self.level == Level::Geometry {
            let known = JobResult { geometry: Some(geometry(jobs[0].prepared())), ..JobResult::default() };
            first = SweepPoint::of_result(values.to_vec(), &known);
        } else {
            for (at, result) in self.solve(&jobs)?.into_iter().enumerate() {
                let result = match result {
                    Ok(result) => result,
                    Err(error) => return Ok(failed(&error, 1.0)),
                };
                if at == 0 {
                    first = SweepPoint::of_result(values.to_vec(), &result);
                }
                if let Err(error) = self.read(&result, &jobs[at], at, Level::Response, &mut found) {
                    return Ok(Outcome { violation: 1.0, error: Some(error), row: first, ..Outcome::default() });
                }
            }
        }
        let measures: Option<Vec<f64>> = found.into_iter().collect();
        Ok(Outcome { measures, violation: 0.0, error: None, row: first })
    }

    /// The jobs of all operating points; or what is wrong with the document, and how far it is from one that exists.
    fn jobs(
        &self,
        base: &JobDocument,
        inputs: &[Inputs],
        values: &[f64],
    ) -> Result<Vec<CheckedJob>, (DocumentError, f64)> {
        let document = with_values(base.clone(), inputs, values).map_err(|error| {
            let missing = count(&error);
            (error, missing)
        })?;
        let at_point = |point: &OperatingPointInput| {
            let mut document = document.clone();
            put_point(&mut document, point);
            let missing = |error: DocumentError| {
                let missing = shortfall(&document).unwrap_or_else(|| count(&error));
                (error, missing)
            };
            CheckedJob::of_point(document.clone(), &self.memo.pairs).map_err(missing)
        };
        self.points.iter().map(at_point).collect()
    }

    /// Solves the jobs of all operating points. Those of the same torque share their contact and follow each other.
    fn solve(&self, jobs: &[CheckedJob]) -> Result<Vec<Result<JobResult, SolveError>>, SolveError> {
        let has_elements = matches!(&self.base.model.mesh_stiffness,
            MeshStiffness::Ltca(ltca) if ltca.fidelity == Fidelity::Fe);
        // The contact of a design is not needed again; finite elements are.
        let stages = if has_elements { self.context.stages } else { &NoStageStore };
        let context = SolveContext { progress: &|_, _| {}, stages, ..*self.context };
        let mut groups: Vec<(f64, Vec<usize>)> = Vec::new();
        for (at, job) in jobs.iter().enumerate() {
            let torque_nm = job.document().operation.pinion_torque_nm;
            match groups.iter_mut().find(|(other, _)| *other == torque_nm) {
                Some((_, members)) => members.push(at),
                None => groups.push((torque_nm, vec![at])),
            }
        }
        let options = PointOptions { start: None, whole: false, record: &[] };
        let solved: Vec<Vec<(usize, Result<JobResult, SolveError>)>> = groups
            .par_iter()
            .map(|(_, members)| {
                let solve = |at: &usize| {
                    let solved = point::solve(&jobs[*at], &context, self.memo, &options);
                    (*at, solved.map(|point| point.result))
                };
                members.iter().map(solve).collect()
            })
            .collect();
        let mut solved: Vec<_> = solved.into_iter().flatten().collect();
        solved.sort_by_key(|(at, _)| *at);
        if solved.iter().any(|(_, result)| matches!(result, Err(SolveError::Canceled(_)))) {
            return Err(SolveError::Canceled(herringbone_physics::watch::Canceled));
        }
        Ok(solved.into_iter().map(|(_, result)| result).collect())
    }

    /// Reads the measures up to a level out of the result of an operating point.
    fn read(
        &self,
        result: &JobResult,
        job: &CheckedJob,
        point: usize,
        upto: Level,
        found: &mut [Option<f64>],
    ) -> Result<(), String> {
        let wanted = |measure: &Measure| measure.level() <= upto;
        if !self.measures.iter().any(wanted) {
            return Ok(());
        }
        let value = scalars(result);
        for (index, measure) in self.measures.iter().enumerate().filter(|(_, measure)| wanted(measure)) {
            let number = measure.value(&value, &job.prepared().pair)?;
            if !number.is_finite() {
                return Err(format!("{} is not finite", measure.name));
            }
            found[index * self.points.len() + point] = Some(number);
        }
        Ok(())
    }
}

/// The blocks of a result that hold measures, without its curves.
fn scalars(result: &JobResult) -> Value {
    let mut mesh = result.mesh.clone();
    if let Some(mesh) = &mut mesh {
        mesh.curve = MeshCurve::default();
        mesh.right_curve = None;
    }
    let blocks = JobResult {
        geometry: result.geometry.clone(),
        mesh,
        impact: result.impact.clone(),
        shafts: result.shafts.clone(),
        response: result.response.clone(),
        ..JobResult::default()
    };
    serde_json::to_value(blocks).unwrap_or_default()
}

/// Number of things wrong with a document: how far it is from one that exists.
fn count(error: &DocumentError) -> f64 {
    match error {
        DocumentError::Invalid(found) | DocumentError::Unsupported(found) => {
            let listed: &Vec<Violation> = found;
            listed.len() as f64
        }
        DocumentError::Malformed { .. } => 1.0,
    }
}
