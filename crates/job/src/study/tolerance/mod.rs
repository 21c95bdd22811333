//! Tolerance studies: a sample of deviations, evaluated, and its statistics.

mod earlier;
mod run;
mod scatter;
mod statistics;

pub(super) use run::{Quantities, run, run_part};
pub(super) use scatter::{Scatter, scrambles};

use crate::result::ToleranceResult;
use crate::warning::Warning;

/// Warnings of a study: deviations that were cut at the range of a field, points that could not be evaluated.
pub(super) fn warnings(result: &ToleranceResult) -> Vec<Warning> {
    let warning =
        |code: &str, detail: String| Warning { code: code.to_owned(), pointer: "/tolerances".to_owned(), detail };
    let clipped = (result.clipped > 0).then(|| {
        let detail = format!("{} values were beyond the range of their field and stand at its end", result.clipped);
        warning("deviations-cut", detail)
    });
    let failed = (result.failed > 0)
        .then(|| warning("points-failed", format!("{} points could not be evaluated and are left out", result.failed)));
    clipped.into_iter().chain(failed).collect()
}
