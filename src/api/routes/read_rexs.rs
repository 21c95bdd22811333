//! `GET /api/v1/jobs/{id}/rexs`

use crate::api::problem::ApiError;
use crate::api::request::{JobPath, QueryParameters};
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use axum::body::Body;
use axum::extract::State;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use herringbone_exchange::{ExportForm, ExportOptions, export_rexs};
use herringbone_job::result::JobResult;
use jiff::Timestamp;
use jiff::tz::TimeZone;

/// Read the pair of a job as a REXS model, with its results where it has some.
#[utoipa::path(
    get, path = "/jobs/{id}/rexs", tag = "results",
    description = "Gear unit, shafts, gears, flanks with their modifications, tools and two stages of opposite helix; contact ratios, \
        mesh stiffness over\nthe mesh period, and what the format has no place for as attributes `custom_herringbone_…`. Of a \
        sweep: its base document.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("format" = Option<String>, Query, pattern = "^(xml|json)$", description = "`xml` (the default) or `json`."),
        ("version" = Option<String>, Query, pattern = "^1\\.7$", description = "Version of REXS: `1.7`."),
    ),
    responses(
        (status = 200, description = "The model.", content(
            (String = "application/xml"),
            (serde_json::Value = "application/json"),
        )),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job."),
        (status = 422, description = "`invalid-design` or `unsupported-design`: this version refuses the document of an earlier one."),
    )
)]
pub(super) async fn read_rexs(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    mut query: QueryParameters,
) -> Result<Response, ApiError> {
    let form =
        query.choice("format", &[("xml", ExportForm::Xml), ("json", ExportForm::Json)]).unwrap_or(ExportForm::Xml);
    query.choice("version", &[("1.7", ())]);
    query.finish()?;
    let store = state.jobs().store();
    let input = store.input(id).await?.ok_or_else(super::job_not_found)?;
    let result = store.result(id).await?.map(|stored| stored.body);
    let version = state.jobs().solver_version().to_owned();
    let text = tokio::task::spawn_blocking(move || {
        let document = herringbone_job::parse(input.as_bytes())?;
        let result: Option<JobResult> = result.and_then(|body| serde_json::from_str(&body).ok());
        let date = Timestamp::now().to_zoned(TimeZone::UTC).strftime("%Y-%m-%dT%H:%M:%S+00:00").to_string();
        let id = result.as_ref().map(|_| id.to_string());
        let options = ExportOptions {
            form,
            date: &date,
            application_version: &version,
            result: result.as_ref(),
            result_id: id.as_deref(),
        };
        export_rexs(&document, &options)
    });
    let text = text.await.map_err(ApiError::internal)??;
    let (media_type, ending) = match form {
        ExportForm::Xml => ("application/xml", "rexs"),
        ExportForm::Json => ("application/json", "rexsj"),
    };
    let disposition = format!("attachment; filename=\"herringbone-{id}.{ending}\"");
    let headers = [(CONTENT_TYPE, media_type.to_owned()), (CONTENT_DISPOSITION, disposition)];
    Ok((headers, Body::from(TextBody::new(text))).into_response())
}
