//! `GET /api/v1/jobs/{id}/series`

use crate::api::config::LARGE_BODY_BYTES;
use crate::api::guarded_body::GuardedBody;
use crate::api::parquet;
use crate::api::problem::{ApiError, ProblemCode};
use crate::api::request::{JobPath, QueryParameters, TimeWindow, negotiate_form};
use crate::api::series_file::{SeriesFile, SeriesSource};
use crate::api::state::AppState;
use crate::store::SeriesEntry;
use axum::Json;
use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::VARY;
use axum::response::{IntoResponse, Response};
use futures_util::TryStreamExt;
use herringbone_exchange::arrays::ArrayForm;
use serde::Serialize;
use std::io;
use std::ops::Range;
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

/// List the recorded channels of a job, or read several of them in full as a file of arrays.
#[utoipa::path(
    get, path = "/jobs/{id}/series", tag = "results",
    description = "As `npz` or `mat`: the channels with all their samples, one array for each, the times `t_s` (with `t0_s` and `dt_s`), and \
        `channels`\nand `units`, the names and units of the arrays in their order. `numpy.load`, `scipy.io.loadmat`, MATLAB and Octave read them.\nAs \
        `parquet`, in programs built with that feature: a table with `t_s` and a column for each channel; `units`, `meanings`, `job_id`,\n\
        `solver_version`, `t0_s` and `dt_s` in its metadata.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("channels" = Option<Vec<String>>, Query, style = Form, explode = false, min_items = 1, description = "These channels, separated by \
            commas, in this order; all when left out.", example = json!(["a_x_left"])),
        ("format" = Option<String>, Query, pattern = "^(json|npz|mat|parquet)$", description = "`json` (the list; the default), `npz` (NumPy), \
            `mat` (MATLAB, version 5) or, in programs built with it, `parquet`. The same as the media type in `Accept`."),
        ("from" = Option<f64>, Query, description = "Of files: first time, in seconds; the start when left out"),
        ("to" = Option<f64>, Query, description = "Of files: last time, in seconds; the end when left out"),
    ),
    responses(
        (status = 200, description = "The channels, in the order in which they were recorded.", content(
            (SeriesList = "application/json"),
            (Vec<u8> = "application/x-npz"),
            (Vec<u8> = "application/x-matlab-data"),
            (Vec<u8> = "application/vnd.apache.parquet"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job or channel."),
        (status = 406, description = "None of these media types is accepted, or the program was built without the one that is."),
        (status = 409, description = "`result-not-ready` or `job-not-succeeded`."),
        (status = 503, description = "`too-many-large-answers` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn list_series(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    mut query: QueryParameters,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let form = negotiate_form(&headers, &mut query, &FORMS)?;
    let names = query.text("channels");
    let window = TimeWindow::read(&mut query);
    query.finish()?;
    let job = super::find_succeeded_job(&state, id).await?;
    let store = state.jobs().store();
    let mut entries = store.series_catalogue(id).await?;
    if let Some(names) = names {
        entries = chosen(&entries, &names)?;
    }
    if form == SeriesForm::List {
        let list = SeriesList { items: entries.into_iter().map(SeriesView::from).collect() };
        return Ok(([(VARY, "accept")], Json(list)).into_response());
    }
    let window = shared_window(&entries, &window)?;
    let n_values = window.len() as u64;
    let is_large = n_values * 8 * (entries.len() as u64 + 1) > LARGE_BODY_BYTES;
    let source = SeriesSource { store: store.clone(), id, entries, window };
    let SeriesForm::Arrays(form) = form else {
        let place = if is_large { Some(state.large_body_place().await?) } else { None };
        let body = parquet::series_body(source, &job, place).await?;
        return Ok(super::file_response(body, parquet::MEDIA_TYPE, &format!("{id}-series.{}", parquet::NAME)));
    };
    if n_values > form.max_values() {
        let detail = format!("A file of this form holds {} values of a channel at most.", form.max_values());
        return Err(ApiError::new(ProblemCode::NotAcceptable, detail));
    }
    let place = if is_large { Some(state.large_body_place().await?) } else { None };
    let file = SeriesFile { source, form };
    let body = Body::new(GuardedBody::new(
        Body::from_stream(file.pieces()?.map_err(|error| io::Error::other(format!("{error:?}")))),
        place,
    ));
    Ok(super::file_response(body, form.media_type(), &format!("{id}-series.{}", form.ending())))
}

/// The form of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SeriesForm {
    /// Descriptions of the channels, without samples.
    List,
    Arrays(ArrayForm),
    Parquet,
}

const FORMS: [(&str, &str, SeriesForm); 4] = [
    ("json", "application/json", SeriesForm::List),
    ("npz", "application/x-npz", SeriesForm::Arrays(ArrayForm::Npz)),
    ("mat", "application/x-matlab-data", SeriesForm::Arrays(ArrayForm::Mat)),
    (parquet::NAME, parquet::MEDIA_TYPE, SeriesForm::Parquet),
];

/// The channels of a list of names.
///
/// # Errors
/// 404 when one of them is not recorded.
fn chosen(entries: &[SeriesEntry], names: &str) -> Result<Vec<SeriesEntry>, ApiError> {
    let mut chosen: Vec<SeriesEntry> = Vec::new();
    for name in names.split(',').filter(|name| !name.is_empty()) {
        let entry = entries.iter().find(|entry| entry.channel == name);
        let entry = entry.ok_or_else(|| ApiError::not_found("The job has no such channel."))?;
        if !chosen.contains(entry) {
            chosen.push(entry.clone());
        }
    }
    Ok(chosen)
}

/// The indices of the samples in a time window, the same for all these channels.
///
/// # Errors
/// 409 when they do not share their times.
fn shared_window(entries: &[SeriesEntry], window: &TimeWindow) -> Result<Range<usize>, ApiError> {
    let Some(first) = entries.first() else { return Ok(0..0) };
    let times = |entry: &SeriesEntry| (entry.n, entry.t0_s.to_bits(), entry.dt_s.to_bits());
    if entries.iter().any(|entry| times(entry) != times(first)) {
        let detail = "These channels do not share their times: ask for them one by one.";
        return Err(ApiError::new(ProblemCode::NotAcceptable, detail));
    }
    Ok(window.indices(first))
}
