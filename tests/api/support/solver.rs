//! A solver that does what a document's name says.

use super::Breakpoints;
use herringbone::work::Solver;
use herringbone_job::DocumentError;
use herringbone_job::document::{Continuation, JobDocument, JobKind};
use herringbone_job::result::{
    BearingForceResult, BearingForces, DirectionForce, JobResult, Mesh, PerHalf, ResponseResult, ReusedStage,
    SweepPoint, SweepResult,
};
use herringbone_job::study::{self, CheckedJob, LineEnd, Outcome, RecordedChannel, SolveContext, SolveError, Stage};
use herringbone_physics::watch::Canceled;

/// Name of the document: `fail`, `failing`, `fail oddly`, `panic`, `stage`, `not finite`, `large`, `numbers`,
/// `bearings`; anything else succeeds. Every calculation passes the breakpoint `solve`, and the one of its own name;
/// `at its end` passes only its own, past which it does not notice a cancel.
#[derive(Default)]
pub(crate) struct ScriptedSolver {
    pub breakpoints: Breakpoints,
}

impl Solver for ScriptedSolver {
    fn check(&self, document: JobDocument) -> Result<CheckedJob, DocumentError> {
        CheckedJob::new(document)
    }

    fn input_hash(&self, document: &JobDocument) -> String {
        study::input_hash(document)
    }

    fn solve(&self, job: &CheckedJob, context: &SolveContext) -> Result<Outcome, SolveError> {
        let document = job.document();
        let name = document.name.as_deref().unwrap_or("unnamed");
        (context.progress)(Stage::Mesh, 0.25);
        if name == "at its end" {
            self.breakpoints.pass(name, &|| false);
            return Ok(outcome());
        }
        for point in ["solve", name] {
            if !self.breakpoints.pass(point, context.canceled) {
                return Err(SolveError::Canceled(Canceled));
            }
        }
        match name {
            "fail" | "failing" => Err(SolveError::Failed {
                stage: Stage::Response,
                code: "diverged".into(),
                detail: "the motion left 1 m".into(),
                sim_time_s: Some(0.125),
                step: Some(42),
            }),
            "fail oddly" => Err(SolveError::Failed {
                stage: Stage::Mesh,
                code: "singular-matrix".into(),
                detail: "pivot 0".into(),
                sim_time_s: None,
                step: None,
            }),
            "panic" => panic!("secret detail"),
            "stage" => Ok(with_stage(context)),
            "not finite" if document.kind != JobKind::Sweep => {
                let mut outcome = outcome();
                outcome.result.numerics.wall_ms.mesh = f64::NAN;
                outcome.series[0].values[1] = f64::NAN;
                Ok(outcome)
            }
            _ if document.kind == JobKind::Sweep => self.sweep(document, context),
            "large" => Ok(large()),
            "numbers" => Ok(with_numbers()),
            "bearings" => Ok(with_bearings()),
            _ => Ok(outcome()),
        }
    }

    fn version(&self) -> &'static str {
        "scripted-1"
    }
}

impl ScriptedSolver {
    /// One point after the other, from those that are kept on; each passes the breakpoint `point N`.
    fn sweep(&self, document: &JobDocument, context: &SolveContext) -> Result<Outcome, SolveError> {
        let mut rows = context.points.load().rows;
        let reused = if rows.is_empty() { Vec::new() } else { vec![ReusedStage::Points] };
        let axis = &document.axes[0];
        for position in 0..axis.len() {
            if rows.contains_key(&position) {
                continue;
            }
            if !self.breakpoints.pass(&format!("point {position}"), context.canceled) {
                return Err(SolveError::Canceled(Canceled));
            }
            let not_finite = document.name.as_deref() == Some("not finite");
            let is_large = document.name.as_deref() == Some("large");
            let row = SweepPoint {
                values: vec![axis.value(position)],
                dynamic_factor: not_finite.then_some(f64::INFINITY),
                error: (!not_finite).then(|| "no \"response\", scripted".repeat(if is_large { 80 } else { 1 })),
                ..SweepPoint::default()
            };
            // With continuation, all numbers of the state at the end of a point are its position.
            let end = LineEnd { line: 0, position, state: Some(vec![position as f64; 24]) };
            let continued = document.continuation == Some(Continuation::Up);
            context.points.save(position, &row, continued.then_some(&end));
            rows.insert(position, row);
        }
        let mut result = JobResult::default();
        result.numerics.reused = reused;
        let points = (0..axis.len()).filter_map(|position| rows.remove(&position)).collect();
        result.sweep = Some(SweepResult { points, ..SweepResult::default() });
        Ok(Outcome { result, series: Vec::new() })
    }
}

/// A result with forces in the bearings.
fn with_bearings() -> Outcome {
    let mut outcome = outcome();
    let along = |mean| DirectionForce { mean, rms: 2.0, amplitudes: vec![2.5, 0.5], phases_rad: vec![0.25, -3.0] };
    let bearing = |shaft: &str, index: u32| BearingForceResult {
        shaft: shaft.to_owned(),
        index,
        position_mm: 120.5,
        force_n: BearingForces { x: along(100.0), y: along(-7000.5), z: DirectionForce::default() },
    };
    outcome.result.response = Some(ResponseResult {
        mesh_frequency_hz: 425.0,
        bearings: vec![bearing("pinion", 0), bearing("pinion", 1), bearing("gear", 0)],
        ..ResponseResult::default()
    });
    outcome
}

/// A result with the numbers that lists show.
fn with_numbers() -> Outcome {
    let mut outcome = outcome();
    let mut response = ResponseResult { dynamic_factor: Some(1.25), ..ResponseResult::default() };
    response.rms.mesh_circumferential_acceleration_m_s2 = PerHalf { left: 50.25, right: 52.5 };
    outcome.result.response = Some(response);
    outcome.result.mesh = Some(Mesh { transmission_error_pp_um: 0.75, ..Mesh::default() });
    outcome
}

/// Loads a stage if it is there, else saves it.
fn with_stage(context: &SolveContext) -> Outcome {
    let mut outcome = outcome();
    match context.stages.load("key") {
        Some(bytes) => {
            assert_eq!(bytes, b"stage");
            outcome.result.numerics.reused = vec![ReusedStage::Mesh];
        }
        None => context.stages.save("key", Stage::Mesh, b"stage"),
    }
    outcome
}

/// A million samples, and a result of ten megabytes.
fn large() -> Outcome {
    let mut outcome = outcome();
    let values = &mut outcome.series[0].values;
    *values = (0..1_000_000).map(|index| (f64::from(index) * 0.618).fract()).collect();
    outcome.result.numerics.solver_version = "scripted-1 ".repeat(1_000_000);
    outcome
}

/// Ten thousand samples of a sine with one spike.
fn outcome() -> Outcome {
    let mut values: Vec<f64> = (0..10_000).map(|index| (f64::from(index) * 0.01).sin()).collect();
    values[7_777] = 50.0;
    let channel = RecordedChannel {
        name: "a_x_left".into(),
        quantity: "acceleration".into(),
        unit: "m/s2".into(),
        t0_s: 0.5,
        dt_s: 1e-4,
        rms: 0.75,
        values,
    };
    Outcome { result: JobResult::default(), series: vec![channel] }
}
