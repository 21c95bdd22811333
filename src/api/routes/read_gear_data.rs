//! `GET /api/v1/jobs/{id}/gear-data`

use crate::api::problem::ApiError;
use crate::api::request::JobPath;
use crate::api::state::AppState;
use axum::Json;
use axum::extract::State;
use herringbone_job::gear_data::GearData;

/// Read the gear data of a job's pair in the terms of ISO 21771-1.
///
/// Calculated from the job's document by this version; the job need not have a result.
#[utoipa::path(
    get, path = "/jobs/{id}/gear-data", tag = "jobs",
    params(("id" = String, Path, format = "uuid", description = "Id of the job")),
    responses(
        (status = 200, description = "The gear data; of a sweep those of its base document.", body = GearData),
        (status = 404, description = "No such job."),
        (status = 422, description = "`invalid-design` or `unsupported-design`: this version refuses the document of an earlier one."),
    )
)]
pub(super) async fn read_gear_data(
    State(state): State<AppState>,
    JobPath(id): JobPath,
) -> Result<Json<GearData>, ApiError> {
    let input = state.jobs().store().input(id).await?.ok_or_else(super::job_not_found)?;
    let data = tokio::task::spawn_blocking(move || GearData::of_stored(&input)).await;
    Ok(Json(data.map_err(ApiError::internal)??))
}
