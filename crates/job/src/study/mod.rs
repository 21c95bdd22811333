//! The calculation of a job: the stages and their order, and the reuse of stored stages. The only module that converts
//! between documents and physics.

mod accuracy;
mod axes;
pub(crate) mod bounds;
mod branches;
mod campbell;
mod check;
mod compliance;
mod demand;
mod derived;
mod equations;
mod evaluation;
mod gear_findings;
mod hash;
mod impact;
mod mesh;
mod mesh_force;
mod optimise;
mod part;
mod point;
mod points;
pub(crate) mod prepare;
mod recent;
mod repeat;
mod response_result;
mod rotor;
mod row;
mod shaft_contact;
mod shafts;
mod supports;
mod sweep;
mod tolerance;
mod vibration;

use crate::DocumentError;
use crate::document::{JobKind, ShaftInput};
use crate::result::{Geometry, JobResult, ReusedStage};
use crate::warning::Warning;

use herringbone_physics::watch::Canceled;
use mesh::MeshMemo;
use point::PointOptions;
use serde::{Deserialize, Serialize};

pub use check::CheckedJob;
pub use demand::{Demand, demand};
pub use derived::DerivedValue;
pub use evaluation::{EvaluationBatch, EvaluationSettings, EvaluationTask, document_at, document_of_input, is_measure};
pub use hash::input_hash;
pub use part::{SweepOrder, SweepPart, solve_part};
pub use points::{LineEnd, NoPointStore, PointStore, StoredPoints};
pub use repeat::{PointStart, point_document};
pub use sweep::continued_from;
pub use vibration::is_channel;

/// Version of the calculation: results and stages stored under another version are not reused.
pub const SOLVER_VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "-11");

/// Stages in the order they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    Geometry,
    Mesh,
    Impact,
    Response,
    Sweep,
    Evaluations,
}

impl Stage {
    pub fn as_str(self) -> &'static str {
        match self {
            Stage::Geometry => "geometry",
            Stage::Mesh => "mesh",
            Stage::Impact => "impact",
            Stage::Response => "response",
            Stage::Sweep => "sweep",
            Stage::Evaluations => "evaluations",
        }
    }
}

/// Store of finished stages for reuse. Keys are content hashes that include [`SOLVER_VERSION`].
pub trait StageStore: Sync {
    fn load(&self, key: &str) -> Option<Vec<u8>>;
    fn save(&self, key: &str, stage: Stage, bytes: &[u8]);
}

/// A store that keeps nothing.
pub struct NoStageStore;

impl StageStore for NoStageStore {
    fn load(&self, _key: &str) -> Option<Vec<u8>> {
        None
    }

    fn save(&self, _key: &str, _stage: Stage, _bytes: &[u8]) {}
}

/// Services that a solve uses besides its document: stored stages and points, progress, cancellation, a clock.
pub struct SolveContext<'a> {
    /// Results of stages, stored for reuse.
    pub stages: &'a dyn StageStore,
    /// Solved points of this sweep.
    pub points: &'a dyn PointStore,
    /// Receives (stage, fraction of the whole job done).
    pub progress: &'a (dyn Fn(Stage, f64) + Sync),
    /// Whether the solve is to stop; called at every checkpoint.
    pub canceled: &'a (dyn Fn() -> bool + Sync),
    /// Milliseconds since an arbitrary start; the physics itself has no clock.
    pub clock_ms: &'a (dyn Fn() -> f64 + Sync),
}

impl SolveContext<'static> {
    /// A context without storage, progress reports and cancellation, with a constant clock.
    pub fn none() -> Self {
        Self {
            stages: &NoStageStore,
            points: &NoPointStore,
            progress: &|_, _| {},
            canceled: &|| false,
            clock_ms: &|| 0.0,
        }
    }
}

/// A recorded, uniformly sampled channel.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedChannel {
    pub name: String,
    pub quantity: String,
    pub unit: String,
    pub t0_s: f64,
    pub dt_s: f64,
    /// Exact root mean square over the recorded time; the mean removed, except of accelerations.
    pub rms: f64,
    pub values: Vec<f64>,
}

/// Result and recorded channels of a solved job.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    pub result: JobResult,
    pub series: Vec<RecordedChannel>,
}

/// Failure to solve a valid job.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    #[error(transparent)]
    Canceled(#[from] Canceled),
    /// A point of a sweep whose values contradict each other, or whose pair is infeasible.
    #[error(transparent)]
    Document(#[from] DocumentError),
    /// A stage failed. Failures are deterministic and not retried.
    #[error("{stage:?}: {detail}")]
    Failed {
        stage: Stage,
        /// Code of the problem: `not-converged`, `diverged`, `step-size-too-small`, …
        code: String,
        detail: String,
        sim_time_s: Option<f64>,
        step: Option<u64>,
    },
}

/// Geometry and warnings of a document, in milliseconds and without solving anything.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CheckReport {
    pub geometry: Geometry,
    /// Springs of the equations of motion; null for a job without a response.
    pub supports: Option<crate::result::SupportsResult>,
    /// Memory that the calculation takes at most (an estimate).
    pub memory_mib: f64,
    #[cfg_attr(feature = "schema", schema(value_type = Vec<crate::result::WarningEntry>))]
    pub warnings: Vec<Warning>,
    /// Values that the rest of the document gives to fields which can be left out.
    pub derived: Vec<DerivedValue>,
    /// Both shafts as they are solved, as a document gives them: bearings with their stiffness, derived shafts in full;
    /// absent without `design.shafts`.
    #[cfg_attr(feature = "schema", schema(value_type = Option<Object>))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shafts: Option<SolvedShafts>,
}

/// Both shafts, as members of `design.shafts`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SolvedShafts {
    pub pinion: ShaftInput,
    pub gear: ShaftInput,
}

impl SolveError {
    fn failed(stage: Stage, code: &str, error: &dyn std::error::Error) -> Self {
        SolveError::Failed { stage, code: code.to_owned(), detail: error.to_string(), sim_time_s: None, step: None }
    }
}

/// Solves a job: the stages of its kind, or every point of a sweep.
///
/// # Errors
/// [`SolveError`].
pub fn solve(job: &CheckedJob, context: &SolveContext) -> Result<Outcome, SolveError> {
    let document = job.document();
    let memo = MeshMemo::default();
    if matches!(document.kind, JobKind::Mesh | JobKind::Response) {
        let mut point = point::solve(job, context, &memo, &PointOptions::WHOLE)?;
        point.result.warnings.extend(repeat::warnings(document, &point.result));
        return Ok(Outcome { result: point.result, series: point.series });
    }
    let started_ms = (context.clock_ms)();
    let stored = context.points.load();
    let mut has_reused = !stored.rows.is_empty();
    let report = job.report();
    let mut result = JobResult {
        geometry: Some(report.geometry),
        supports: report.supports,
        warnings: report.warnings,
        ..JobResult::default()
    };
    match document.kind {
        JobKind::Optimise => {
            let (optimised, reused) = optimise::run(document, stored, context, &memo)?;
            has_reused = reused;
            result.warnings.extend(optimise::warnings(&optimised));
            result.optimise = Some(optimised);
        }
        JobKind::Tolerance => {
            let (studied, reused) = tolerance::run(document, stored, context, &memo)?;
            has_reused = reused;
            result.warnings.extend(tolerance::warnings(&studied));
            result.tolerance = Some(studied);
        }
        JobKind::Mesh | JobKind::Response | JobKind::Sweep => {
            let sweep = sweep::run(document, stored, context, &memo)?;
            result.accuracy = Some(accuracy::of_sweep(document, &sweep));
            result.sweep = Some(sweep);
        }
    }
    result.numerics.reused = if has_reused { vec![ReusedStage::Points] } else { Vec::new() };
    result.numerics.solver_version = SOLVER_VERSION.to_owned();
    result.numerics.wall_ms.response = (context.clock_ms)() - started_ms;
    Ok(Outcome { result, series: Vec::new() })
}

/// Documents that tests check and solve in one go.
#[cfg(test)]
mod unchecked {
    use super::{CheckReport, CheckedJob, Outcome, SolveContext, SolveError};
    use crate::DocumentError;
    use crate::document::JobDocument;

    pub(super) fn check(document: &JobDocument) -> Result<CheckReport, DocumentError> {
        CheckedJob::new(document.clone()).map(|job| job.report())
    }

    pub(super) fn solve(document: &JobDocument, context: &SolveContext) -> Result<Outcome, SolveError> {
        super::solve(&CheckedJob::new(document.clone())?, context)
    }
}

#[cfg(test)]
mod acceptance_tests;
#[cfg(test)]
mod contact_tests;
#[cfg(test)]
mod evaluation_tests;
#[cfg(test)]
mod further_evaluation_tests;
#[cfg(test)]
mod limits_tests;
#[cfg(test)]
mod shaft_tests;
#[cfg(test)]
mod tests;
