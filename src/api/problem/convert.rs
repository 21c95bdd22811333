//! Conversions into problems from the errors of other modules.

use super::{Problem, ProblemCode};
use crate::store::{Failure, JobRecord};
use herringbone_exchange::{Refusal, RefusalKind};
use herringbone_job::study::SolveError;
use herringbone_job::{DocumentError, Violation};

impl From<DocumentError> for Problem {
    fn from(error: DocumentError) -> Self {
        let text = error.to_string();
        match error {
            DocumentError::Malformed { .. } => {
                let violation = Violation::new("", "malformed-json", text.as_str());
                Problem::new(ProblemCode::MalformedJson, text).with_errors(vec![violation])
            }
            DocumentError::Invalid(errors) => Problem::new(ProblemCode::InvalidDesign, text).with_errors(errors),
            DocumentError::Unsupported(errors) => {
                Problem::new(ProblemCode::UnsupportedDesign, text).with_errors(errors)
            }
        }
    }
}

impl From<Refusal> for Problem {
    fn from(refusal: Refusal) -> Self {
        let code = match refusal.kind {
            RefusalKind::Invalid => ProblemCode::InvalidDesign,
            RefusalKind::Unsupported => ProblemCode::UnsupportedDesign,
        };
        // It is not the document that is wrong: there is none yet.
        let title = match refusal.kind {
            RefusalKind::Invalid => "The file cannot be imported",
            RefusalKind::Unsupported => "The file has no pair that can be taken",
        };
        Problem { title: title.to_owned(), ..Problem::new(code, refusal.summary).with_errors(refusal.errors) }
    }
}

impl From<SolveError> for Problem {
    fn from(error: SolveError) -> Self {
        match error {
            SolveError::Document(error) => error.into(),
            SolveError::Canceled(canceled) => Problem::new(ProblemCode::SolveFailed, canceled.to_string()),
            SolveError::Failed { stage, code, detail, sim_time_s, step } => {
                let stage = Some(stage.as_str().to_owned());
                (&Failure { stage, sim_time_s, step, ..Failure::new(&code, detail) }).into()
            }
        }
    }
}

impl From<&Failure> for Problem {
    fn from(failure: &Failure) -> Self {
        let code = ProblemCode::from_name(&failure.code).unwrap_or(ProblemCode::SolveFailed);
        let mut errors = failure.errors.clone();
        if code.as_str() != failure.code {
            // A code outside the closed list is reported as a violation.
            errors.push(Violation::new("", &failure.code, failure.detail.as_str()));
        }
        Problem {
            stage: failure.stage.clone(),
            sim_time_s: failure.sim_time_s,
            step: failure.step,
            ..Problem::new(code, failure.detail.as_str()).with_errors(errors)
        }
    }
}

impl Problem {
    /// The `error` of a failed job.
    pub(in crate::api) fn of_job(job: &JobRecord) -> Option<Self> {
        let problem = Problem::from(job.error.as_ref()?);
        Some(Problem { request_id: job.request_id.clone(), ..problem })
    }
}
