//! The same input again: the stored result instead of a calculation.

use super::points::place_of_points;
use crate::store::{Completion, PointBatch, PointsOfResult, Store, StoreError};
use herringbone_job::result::ReusedStage;
use serde_json::{Value, json};

/// What would end a job with this input at once, if a result is stored.
pub(super) async fn stored_completion(
    store: &Store,
    input_hash: &str,
    solver_version: &str,
) -> Result<Option<Completion>, StoreError> {
    let Some(found) = store.reusable(input_hash, solver_version).await? else { return Ok(None) };
    let body = marked_as_reused(&found.body);
    // Written anew, the body has the place of its points elsewhere.
    let points = found.points.and_then(|points| Some(PointsOfResult { at: place_of_points(&body)?, ..points }));
    Ok(Some(Completion {
        body,
        input_hash: input_hash.to_owned(),
        solver_version: solver_version.to_owned(),
        series: Vec::new(),
        points,
        rows: PointBatch::default(),
        reused_from: Some(found.job),
    }))
}

/// The result with `numerics.reused` saying that nothing was computed; its other numbers stay those of the calculation.
fn marked_as_reused(body: &str) -> String {
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
        let after: JobResult = serde_json::from_str(&marked_as_reused(&before)).unwrap();
        result.numerics.reused = vec![ReusedStage::Result];
        assert_eq!(after, result);
    }
}
