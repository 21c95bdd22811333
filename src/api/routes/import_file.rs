//! `POST /api/v1/import`

use crate::api::problem::ApiError;
use crate::api::request::{QueryParameters, read_file};
use crate::api::state::AppState;
use axum::Json;
use axum::extract::{Request, State};
use herringbone_exchange::{FaceWidth, Import, ImportOptions, PointChoice, import};
use herringbone_job::Violation;

/// Largest number of a pair or a load case: ids of stages are numbers too.
const MAX_NUMBER: u64 = 9_007_199_254_740_991;

/// Make a job document of a gear model of another program. Nothing is submitted.
#[utoipa::path(
    post, path = "/import", tag = "jobs",
    description = "The file is the body: a REXS model (1.0 to 2.0.0) as XML, JSON or zip, or a KISSsoft calculation of a gear \
        pair (`.Z12`), found by its contents. The answer has a \
        complete job document\nand a report: which fields were taken from where, which were assumed and why, what was ignored, \
        and how results in the file compare.",
    params(
        ("pair" = Option<u64>, Query, minimum = 1, description = "The pair: its number among those of the file, or the id of its \
            stage. Without it the only double-helical pair is taken."),
        ("mirror" = Option<bool>, Query, description = "Whether a single-helical stage is made into a symmetric double-helical \
            pair: each half a copy of it, the torque doubled."),
        ("gap_mm" = Option<f64>, Query, minimum = 0, maximum = 1000, description = "Gap of a mirrored pair; 30 mm when left out."),
        ("torque_nm" = Option<f64>, Query, description = "Torque of the whole pinion, in place of the file's."),
        ("point" = Option<String>, Query, description = "The load case of the document: its number, counted from 1 (the default), \
            or `heaviest`.", pattern = "^([1-9][0-9]*|heaviest)$"),
        ("face_width_is" = Option<String>, Query, description = "What the face width of a double-helical pair is in a `.Z12` file: `total` \
            (the default) or `half`.", pattern = "^(total|half)$"),
        ("format" = Option<String>, Query, description = "`auto` (the default), `rexs` or `z12`: the file is \
            recognised by its contents in any case.", pattern = "^(auto|rexs|z12)$"),
    ),
    request_body(
        description = "The file, at most 32 MiB; at most 64 MiB unpacked.",
        content(
            (serde_json::Value = "application/xml"),
            (serde_json::Value = "application/json"),
            (serde_json::Value = "application/zip"),
            (serde_json::Value = "application/octet-stream"),
        )
    ),
    responses(
        (status = 200, description = "The document and the report.", body = Import),
        (status = 400, description = "`invalid-parameter`."),
        (status = 413, description = "The file is larger than 32 MiB."),
        (status = 415, description = "The body is of another media type, or compressed."),
        (status = 422, description = "`invalid-design`: the file cannot be read, or lacks what a document needs. \
            `unsupported-design`: it has no double-helical pair, or several; `errors` lists the pairs."),
        (status = 503, description = "As many files are being imported as the service allows (`too-many-imports`)."),
    )
)]
pub(super) async fn import_file(
    State(state): State<AppState>,
    mut query: QueryParameters,
    request: Request,
) -> Result<Json<Import>, ApiError> {
    let options = options(&mut query);
    query.choice("format", &[("auto", ()), ("rexs", ()), ("z12", ())]);
    query.finish()?;
    let permit = state.import_permit().await?;
    let bytes = read_file(request, &state).await?;
    let imported = tokio::task::spawn_blocking(move || {
        let imported = import(&bytes, &options);
        drop(permit);
        imported
    });
    Ok(Json(imported.await.map_err(ApiError::internal)??))
}

fn options(query: &mut QueryParameters) -> ImportOptions {
    let flags = [("true", true), ("false", false)];
    let gap_width_mm = query.number("gap_mm", "mm");
    if let Some(gap_mm) = gap_width_mm.filter(|gap_mm| !(0.0..=1000.0).contains(gap_mm)) {
        let detail = format!("is {gap_mm} mm; permitted: 0 to 1000 mm");
        query.add_violation(Violation {
            minimum: Some(0.0),
            maximum: Some(1000.0),
            unit: Some("mm".to_owned()),
            ..Violation::new("/gap_mm", "out-of-range", detail)
        });
    }
    let point = match query.text("point") {
        None => PointChoice::First,
        Some(text) if text == "heaviest" => PointChoice::Heaviest,
        Some(text) => match text.parse() {
            Ok(number) if number > 0 && !text.starts_with(['+', '0']) => PointChoice::Number(number),
            _ => {
                let detail = "permitted: a number from 1, or heaviest";
                query.add_violation(Violation::new("/point", "not-one-of", detail));
                PointChoice::First
            }
        },
    };
    ImportOptions {
        pair: query.integer("pair", 1, MAX_NUMBER, true),
        mirror: query.choice("mirror", &flags).unwrap_or(false),
        gap_width_mm,
        torque_nm: query.number("torque_nm", "N m"),
        point,
        face_width: query
            .choice("face_width_is", &[("total", FaceWidth::Total), ("half", FaceWidth::Half)])
            .unwrap_or_default(),
    }
}
