//! Reuse of stored results for the same input.

use crate::store::{Completion, PointBatch, SampleBatch, Store, StoreError};
use herringbone_job::result::ReusedStage;
use serde_json::{Value, json};

/// The completion of a job from a stored result with this input and solver version, if there is one.
///
/// # Errors
/// The database cannot be read.
pub(super) async fn stored_completion(
    store: &Store,
    input_hash: &str,
    solver_version: &str,
) -> Result<Option<Completion>, StoreError> {
    let Some(stored) = store.reusable(input_hash, solver_version).await? else { return Ok(None) };
    Ok(Some(Completion {
        body: mark_as_reused(&stored.body),
        input_hash: input_hash.to_owned(),
        solver_version: solver_version.to_owned(),
        series: Vec::new(),
        samples: SampleBatch::default(),
        rows: stored.rows,
        unwritten: PointBatch::default(),
        reused_from: Some(stored.job),
    }))
}

/// Sets `numerics.reused` of a result to `["result"]`; all other values stay those of the calculation.
fn mark_as_reused(body: &str) -> String {
    let Ok(mut result) = serde_json::from_str::<Value>(body) else { return body.to_owned() };
    if let Some(numerics) = result.get_mut("numerics").and_then(Value::as_object_mut) {
        numerics.insert("reused".to_owned(), json!([ReusedStage::Result]));
    }
    result.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::JobResult;

    #[test]
    fn only_the_mark_changes() {
        let mut result = JobResult::default();
        result.numerics.steps = 17;
        let before = serde_json::to_string(&result).unwrap();
        let after: JobResult = serde_json::from_str(&mark_as_reused(&before)).unwrap();
        result.numerics.reused = vec![ReusedStage::Result];
        assert_eq!(after, result);
    }
}
