//! `GET /api/v1/jobs/{id}/series`

use crate::api::problem::ApiError;
use crate::api::request::JobPath;
use crate::api::state::AppState;
use crate::store::SeriesEntry;
use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

/// The recorded channels of a job.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct SeriesList {
    pub items: Vec<SeriesView>,
}

/// A recorded channel.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Series)]
pub(super) struct SeriesView {
    #[schema(example = "a_x_left")]
    pub name: String,
    pub quantity: String,
    pub unit: String,
    /// Number of samples.
    pub n: u64,
    /// Time of the first and of the last sample, in seconds.
    pub t0: f64,
    pub t_end: f64,
    /// Time between samples, in seconds.
    pub dt: f64,
    pub min: Option<f64>,
    pub max: Option<f64>,
    /// Exact root mean square over the recorded time; the mean removed, except of accelerations.
    pub rms: Option<f64>,
}

impl From<SeriesEntry> for SeriesView {
    fn from(entry: SeriesEntry) -> Self {
        Self {
            name: entry.channel,
            quantity: entry.quantity,
            unit: entry.unit,
            n: entry.n,
            t0: entry.t0_s,
            t_end: entry.t0_s + entry.n.saturating_sub(1) as f64 * entry.dt_s,
            dt: entry.dt_s,
            min: entry.min,
            max: entry.max,
            rms: entry.rms,
        }
    }
}

/// List the recorded channels of a job.
#[utoipa::path(
    get, path = "/jobs/{id}/series", tag = "results",
    params(("id" = String, Path, format = "uuid", description = "Id of the job")),
    responses(
        (status = 200, description = "The channels, in the order in which they were recorded.", body = SeriesList),
        (status = 404, description = "No such job."),
        (status = 409, description = "`result-not-ready` or `job-not-succeeded`."),
    )
)]
pub(super) async fn list_series(
    State(state): State<AppState>,
    JobPath(id): JobPath,
) -> Result<Json<SeriesList>, ApiError> {
    super::find_succeeded_job(&state, id).await?;
    let entries = state.jobs().store().series_catalogue(id).await?;
    Ok(Json(SeriesList { items: entries.into_iter().map(SeriesView::from).collect() }))
}
