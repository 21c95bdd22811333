//! Conversions of errors into the stored failure of a job.

use crate::store::Failure;
use herringbone_job::DocumentError;
use herringbone_job::study::SolveError;

/// The failure as it is stored: the detail of an internal one is replaced by a fixed text.
pub(super) fn public_failure(failure: Failure) -> Failure {
    if failure.code == "internal" {
        Failure::new("internal", "The calculation failed for a reason that lies in the service; it was logged.")
    } else {
        failure
    }
}

pub(super) fn internal_failure(detail: &str) -> Failure {
    Failure::new("internal", detail)
}

pub(super) fn panic_failure(panic: &(dyn std::any::Any + Send)) -> Failure {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    super::measure::record_panic();
    internal_failure(&format!("panic: {}", text.unwrap_or_default()))
}

pub(super) fn document_failure(error: DocumentError) -> Failure {
    let detail = error.to_string();
    match error {
        DocumentError::Malformed { .. } => internal_failure(&format!("stored document: {detail}")),
        DocumentError::Invalid(errors) => Failure { errors, ..Failure::new("invalid-design", detail) },
        DocumentError::Unsupported(errors) => Failure { errors, ..Failure::new("unsupported-design", detail) },
    }
}

pub(super) fn solve_failure(error: SolveError) -> Failure {
    match error {
        SolveError::Document(error) => document_failure(error),
        SolveError::Failed { stage, code, detail, sim_time_s, step } => {
            Failure { stage: Some(stage.as_str().to_owned()), sim_time_s, step, ..Failure::new(&code, detail) }
        }
        SolveError::Canceled(_) => internal_failure("canceled"),
    }
}
