//! The interface to the calculation.

use herringbone_job::DocumentError;
use herringbone_job::document::JobDocument;
use herringbone_job::study::{self, CheckedJob, Outcome, SolveContext, SolveError};

/// Checks and solves documents. Called on threads outside the async runtime; calls may take long and may panic.
pub trait Solver: Send + Sync + 'static {
    /// Checks a document, in milliseconds.
    ///
    /// # Errors
    /// The gear is infeasible or not supported.
    fn check(&self, document: JobDocument) -> Result<CheckedJob, DocumentError>;

    /// Hash of all inputs that determine the result.
    fn input_hash(&self, document: &JobDocument) -> String;

    /// Solves a job.
    ///
    /// # Errors
    /// [`SolveError`].
    fn solve(&self, job: &CheckedJob, context: &SolveContext) -> Result<Outcome, SolveError>;

    /// Version of the calculation; results and stages of other versions are not reused.
    fn version(&self) -> &'static str;
}

/// The calculation of the crate `herringbone-job`.
#[derive(Debug, Clone, Copy, Default)]
pub struct StudySolver;

impl Solver for StudySolver {
    fn check(&self, document: JobDocument) -> Result<CheckedJob, DocumentError> {
        CheckedJob::new(document)
    }

    fn input_hash(&self, document: &JobDocument) -> String {
        study::input_hash(document)
    }

    fn solve(&self, job: &CheckedJob, context: &SolveContext) -> Result<Outcome, SolveError> {
        study::solve(job, context)
    }

    fn version(&self) -> &'static str {
        study::SOLVER_VERSION
    }
}
