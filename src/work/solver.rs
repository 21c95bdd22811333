//! What a job is given to: the study room, or a double in tests.

use herringbone_job::DocumentError;
use herringbone_job::document::JobDocument;
use herringbone_job::study::{self, CheckedJob, Outcome, SolveContext, SolveError};

/// Checks and solves documents. Called on plain threads; may take long and may panic.
pub trait Solver: Send + Sync + 'static {
    /// Checks a document, in milliseconds.
    ///
    /// # Errors
    /// Why the gear cannot exist or is not supported.
    fn check(&self, document: JobDocument) -> Result<CheckedJob, DocumentError>;

    /// Content hash of everything that decides the result.
    fn input_hash(&self, document: &JobDocument) -> String;

    /// Solves a job.
    ///
    /// # Errors
    /// Why there is no result.
    fn solve(&self, job: &CheckedJob, context: &SolveContext) -> Result<Outcome, SolveError>;

    /// Results and stages stored under another version are not reused.
    fn version(&self) -> &'static str;
}

/// The study room.
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
