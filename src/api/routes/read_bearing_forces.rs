//! `GET /api/v1/jobs/{id}/bearing-forces`

use crate::api::bearing_forces::write_bearing_forces;
use crate::api::csv::Decimal;
use crate::api::problem::ApiError;
use crate::api::request::{JobPath, QueryParameters, negotiate_csv};
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};
use herringbone_job::result::BearingForceResult;
use serde::Deserialize;

/// What is read of a result.
#[derive(Deserialize)]
struct StoredResult {
    response: Option<StoredResponse>,
}

#[derive(Deserialize)]
struct StoredResponse {
    mesh_frequency_hz: f64,
    #[serde(default)]
    bearings: Vec<BearingForceResult>,
}

/// Read the forces that the bearings transmit, by mesh order, as CSV: for a model of the housing.
#[utoipa::path(
    get, path = "/jobs/{id}/bearing-forces", tag = "results",
    description = "A row for every bearing, axis and mesh order. The force of the bearing on its shaft is the sum of \
        `amplitude_n` cos(2π `frequency_hz` t + `phase_rad`) over the orders;\nthe housing feels the opposite. Order 0 is the mean, with its \
        sign and phase 0. Bearings count from 1 on each shaft, `position_mm` from its left end;\nx points from the pinion's axis to \
        the gear's, z along the shafts from left to right, y = z × x. At t = 0 a pair of the left half begins its contact.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("decimal" = Option<Decimal>, Query, description = "`point` (fields between commas; the default) or `comma` (decimal commas, \
            fields between semicolons, CR LF, byte order mark: for spreadsheets of such a locale). The same as \
            `Accept: text/csv; decimal=comma`."),
    ),
    responses(
        (status = 200, description = "The forces.", content((String = "text/csv",
            example = "shaft,bearing,position_mm,axis,mesh_order,frequency_hz,amplitude_n,phase_rad\npinion,1,120.0,y,1,566.7,43.4,0.31\n"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job, or it has no bearings: a job with `design.shafts` and a response has them."),
        (status = 406, description = "CSV is not accepted."),
        (status = 409, description = "`result-not-ready` or `job-not-succeeded`."),
    )
)]
pub(super) async fn read_bearing_forces(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    mut query: QueryParameters,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let decimal = negotiate_csv(&headers, &mut query)?;
    query.finish()?;
    super::find_succeeded_job(&state, id).await?;
    let stored = state.jobs().store().result(id).await?.ok_or_else(super::job_not_found)?;
    let text = tokio::task::spawn_blocking(move || table(&stored.body, decimal));
    let text = text.await.map_err(ApiError::internal)??;
    let fields = [(CONTENT_TYPE, "text/csv; charset=utf-8"), (VARY, "accept")];
    Ok((fields, Body::from(TextBody::new(text))).into_response())
}

fn table(body: &str, decimal: Decimal) -> Result<Vec<u8>, ApiError> {
    let result: StoredResult = serde_json::from_str(body).map_err(ApiError::internal)?;
    let response = result.response.filter(|response| !response.bearings.is_empty());
    let response = response.ok_or_else(|| ApiError::not_found("The job has no bearings."))?;
    write_bearing_forces(Vec::new(), &response.bearings, response.mesh_frequency_hz, decimal)
        .map_err(ApiError::internal)
}
