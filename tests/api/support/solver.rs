//! A solver that does what a document's name says.

use super::Breakpoints;
use herringbone::job::DocumentError;
use herringbone::job::document::JobDocument;
use herringbone::job::result::JobResult;
use herringbone::study::{self, Channel, CheckReport, Outcome, SolveError, Stage, Surroundings};
use herringbone::watch::Canceled;
use herringbone::work::Solver;

/// Name of the document: `fail`, `fail oddly`, `panic`, `stage`; anything else succeeds. Every calculation passes the
/// breakpoint `solve`, and the one of its own name.
#[derive(Default)]
pub struct ScriptedSolver {
    pub breakpoints: Breakpoints,
}

impl Solver for ScriptedSolver {
    fn check(&self, document: &JobDocument) -> Result<CheckReport, DocumentError> {
        study::check(document)
    }

    fn input_hash(&self, document: &JobDocument) -> String {
        study::input_hash(document)
    }

    fn solve(&self, document: &JobDocument, surroundings: &Surroundings) -> Result<Outcome, SolveError> {
        let name = document.name.as_deref().unwrap_or("unnamed");
        (surroundings.progress)(Stage::Mesh, 0.25);
        for point in ["solve", name] {
            if !self.breakpoints.pass(point, surroundings.canceled) {
                return Err(SolveError::Canceled(Canceled));
            }
        }
        match name {
            "fail" => Err(SolveError::Failed {
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
            "stage" => Ok(with_stage(surroundings)),
            _ => Ok(outcome()),
        }
    }

    fn version(&self) -> &'static str {
        "scripted-1"
    }
}

/// Loads a stage if it is there, else saves it.
fn with_stage(surroundings: &Surroundings) -> Outcome {
    let mut outcome = outcome();
    match surroundings.stages.load("key") {
        Some(bytes) => {
            assert_eq!(bytes, b"stage");
            outcome.result.numerics.reused = vec!["mesh".into()];
        }
        None => surroundings.stages.save("key", Stage::Mesh, b"stage"),
    }
    outcome
}

/// Ten thousand samples of a sine with one spike.
fn outcome() -> Outcome {
    let mut values: Vec<f64> = (0..10_000).map(|index| (f64::from(index) * 0.01).sin()).collect();
    values[7_777] = 50.0;
    let channel = Channel {
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
