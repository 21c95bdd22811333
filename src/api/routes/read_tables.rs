//! `GET /api/v1/jobs/{id}/tables`

use crate::api::problem::ApiError;
use crate::api::request::{JobPath, QueryParameters};
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use axum::extract::State;
use axum::response::Response;
use herringbone_exchange::lookup::{LookupForm, LookupQuantity, LookupTables};
use herringbone_job::result::JobResult;

const FORMS: [(&str, (LookupForm, &str, &str)); 5] = [
    ("json", (LookupForm::Json, "application/json", "json")),
    ("modelica", (LookupForm::Modelica, "text/plain; charset=utf-8", "txt")),
    ("simulink", (LookupForm::Simulink, "application/x-matlab-data", "mat")),
    ("amesim", (LookupForm::Amesim, "text/plain; charset=utf-8", "data")),
    ("simpack", (LookupForm::Simpack, "text/plain; charset=utf-8", "txt")),
];

/// Read the mesh of a job as look-up tables for programs that simulate drive trains.
#[utoipa::path(
    get, path = "/jobs/{id}/tables", tag = "results",
    description = "Mesh stiffness and transmission error of one half over a mesh period, and the pulse of the impact, over the angle of the \
        pinion in rad,\nin SI units; the first value again at the end of the period. Phase 0 is the theoretical start of contact of the left half.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("format" = Option<String>, Query, pattern = "^(json|modelica|simulink|amesim|simpack)$", description = "`json` (the default), \
            `modelica` (text file of `CombiTable1Ds`), `simulink` (`.mat`), `amesim` (ASCII table) or `simpack` (pairs for an input function)."),
        ("quantity" = Option<String>, Query, pattern = "^(stiffness|transmission_error|impact_force)$", description = "What the table of \
            `amesim` or `simpack` holds: `stiffness` (the default), `transmission_error` or `impact_force`; the others have all of them."),
    ),
    responses(
        (status = 200, description = "The tables.", content(
            (serde_json::Value = "application/json"),
            (String = "text/plain"),
            (Vec<u8> = "application/x-matlab-data"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job, or it has no such curve: a sweep keeps the numbers of its points only."),
        (status = 409, description = "`result-not-ready` or `job-not-succeeded`."),
    )
)]
pub(super) async fn read_tables(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    mut query: QueryParameters,
) -> Result<Response, ApiError> {
    let (form, media_type, ending) = query.choice("format", &FORMS).unwrap_or(FORMS[0].1);
    let quantity = query.choice("quantity", &LookupQuantity::ALL).unwrap_or(LookupQuantity::Stiffness);
    query.finish()?;
    super::find_succeeded_job(&state, id).await?;
    let store = state.jobs().store();
    let input = store.input(id).await?.ok_or_else(super::job_not_found)?;
    let stored = store.result(id).await?.ok_or_else(super::job_not_found)?;
    let bytes = tokio::task::spawn_blocking(move || {
        let document = herringbone_job::parse(input.as_bytes())?;
        let result: JobResult = serde_json::from_str(&stored.body).map_err(ApiError::internal)?;
        let none = || ApiError::not_found("The job has no such curve over the mesh period.");
        let tables = LookupTables::new(&document, &result).ok_or_else(none)?;
        tables.write(form, quantity).map_err(ApiError::internal)?.ok_or_else(none)
    });
    let bytes = bytes.await.map_err(ApiError::internal)??;
    Ok(super::file_response(TextBody::new(bytes).into(), media_type, &format!("{id}-tables.{ending}")))
}
