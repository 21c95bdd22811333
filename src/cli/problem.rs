//! Problems on standard error, as problem+json.

use herringbone::api::Problem;

/// Prints a problem as JSON on standard error.
pub(super) fn print(problem: &Problem) {
    match serde_json::to_string_pretty(problem) {
        Ok(text) => eprintln!("{text}"),
        Err(error) => eprintln!("{error}"),
    }
}
