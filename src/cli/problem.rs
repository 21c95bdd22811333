//! Problems on standard error, in the form the service answers them.

use herringbone::api::Problem;

pub fn print(problem: &Problem) {
    match serde_json::to_string_pretty(problem) {
        Ok(text) => eprintln!("{text}"),
        Err(error) => eprintln!("{error}"),
    }
}
