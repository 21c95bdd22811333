//! `GET /api/v1/jobs/{id}/tables`

use crate::api::problem::ApiError;
use crate::api::request::{JobPath, QueryParameters};
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use axum::extract::State;
use axum::response::Response;
use herringbone_exchange::lookup::{LookupForm, LookupQuantity, LookupTables};
use herringbone_exchange::lookup_grid::LookupGrids;
use herringbone_job::document::{Fidelity, JobDocument, JobKind, MeshStiffness};
use herringbone_job::result::JobResult;
use herringbone_job::study::{self, CheckedJob, SolveContext};
use tokio::sync::Semaphore;

/// Most torques of a table: each is a mesh that is calculated for the answer.
const MAX_TORQUES: usize = 64;
/// Answers of this kind that are calculated at the same time.
static AT_ONCE: Semaphore = Semaphore::const_new(1);
/// The input over which a sweep has tables.
const TORQUE: &str = "/operation/pinion_torque_nm";

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
        pinion in rad,\nin SI units; the first value again at the end of the period. Phase 0 is the theoretical start of contact of the left half.\n\nA sweep over \
        the torque of the pinion alone has stiffness and transmission error over angle and torque (2 to 64 torques, no finite elements): `grids` in JSON, \
        `CombiTable2Ds`, matrices with a row for each angle, Amesim's 2D; not Simpack.",
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
        (status = 404, description = "No such job, or it has no such table."),
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
    let document = herringbone_job::parse(input.as_bytes())?;
    if document.kind == JobKind::Sweep {
        let _place = AT_ONCE.acquire().await.map_err(ApiError::internal)?;
        let closing = state.jobs().closing().clone();
        let bytes = tokio::task::spawn_blocking(move || {
            let is_closing = || closing.is_cancelled();
            let grids = over_torque(&document, &is_closing).map_err(ApiError::not_found)?;
            let none = || ApiError::not_found("There is no such table over the torque.");
            grids.write(form, quantity).map_err(ApiError::internal)?.ok_or_else(none)
        });
        let bytes = bytes.await.map_err(ApiError::internal)??;
        return Ok(super::file_response(TextBody::new(bytes).into(), media_type, &format!("{id}-tables.{ending}")));
    }
    let stored = store.result(id).await?.ok_or_else(super::job_not_found)?;
    let bytes = tokio::task::spawn_blocking(move || {
        let result: JobResult = serde_json::from_str(&stored.body).map_err(ApiError::internal)?;
        let none = || ApiError::not_found("The job has no such curve over the mesh period.");
        let tables = LookupTables::new(&document, &result).ok_or_else(none)?;
        tables.write(form, quantity).map_err(ApiError::internal)?.ok_or_else(none)
    });
    let bytes = bytes.await.map_err(ApiError::internal)??;
    Ok(super::file_response(TextBody::new(bytes).into(), media_type, &format!("{id}-tables.{ending}")))
}

/// The tables of a sweep over the torque: the mesh at each of them, calculated, as a sweep keeps the numbers of its
/// points only.
///
/// # Errors
/// Why there are none.
fn over_torque(sweep: &JobDocument, is_closing: &(dyn Fn() -> bool + Sync)) -> Result<LookupGrids, String> {
    let is_over_torque = matches!(&*sweep.axes, [axis] if axis.pointers().eq([TORQUE]));
    let has_elements =
        matches!(&sweep.model.mesh_stiffness, MeshStiffness::Ltca(ltca) if ltca.fidelity == Fidelity::Fe);
    let points = sweep.axes.first().map_or(0, |axis| axis.len());
    if !is_over_torque || has_elements || !(2..=MAX_TORQUES).contains(&points) {
        return Err(format!(
            "A sweep has tables when its only axis is {TORQUE}, with 2 to {MAX_TORQUES} values, without finite elements."
        ));
    }
    let context = SolveContext { canceled: is_closing, ..SolveContext::none() };
    let mut tables = Vec::new();
    for position in 0..points {
        let Some(mut document) = sweep.of_row(position) else { continue };
        document.kind = JobKind::Mesh;
        // A torque at which there is no mesh has no table.
        let solved = CheckedJob::new(document.clone()).map_err(Into::into);
        let Ok(outcome) = solved.and_then(|job| study::solve(&job, &context)) else { continue };
        tables.extend(LookupTables::new(&document, &outcome.result));
    }
    LookupGrids::new(tables)
        .ok_or_else(|| "Fewer than two of the torques have a curve over the mesh period.".to_owned())
}
