//! `GET /api/v1/jobs/{id}/series/{channel}`

use crate::api::config::{DEFAULT_POINTS, LARGE_BODY_BYTES, MAX_POINTS, MAX_RAW_POINTS, MIN_POINTS};
use crate::api::csv::Decimal;
use crate::api::downsample::DownsampleMethod;
use crate::api::guarded_body::GuardedBody;
use crate::api::problem::ApiError;
use crate::api::request::{ChannelPath, QueryParameters, TimeWindow, negotiate_table};
use crate::api::routes::read_sound;
use crate::api::samples::Samples;
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use crate::store::SeriesEntry;
use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use herringbone_job::Violation;
use std::ops::Range;
use utoipa::ToSchema;

/// An estimate of the text of a sample: time and value.
const SAMPLE_BYTES: u64 = 40;

/// Samples of a channel.
#[derive(ToSchema)]
#[expect(dead_code, reason = "only for the description: the answer is written by `Samples`")]
pub(super) struct SeriesData {
    pub channel: String,
    pub quantity: String,
    pub unit: String,
    /// Times in seconds.
    pub t: Vec<f64>,
    /// Values, one per time.
    pub y: Vec<f64>,
    /// Samples recorded between `from` and `to`.
    pub n_source: usize,
    pub n_returned: usize,
    /// Returned values that are null because they are not finite: the motion left the range of a double.
    pub n_not_finite: usize,
    /// How points were chosen; `none` when all of them are here.
    pub method: String,
}

/// Read a recorded channel, downsampled for plots or in full.
#[utoipa::path(
    get, path = "/jobs/{id}/series/{channel}", tag = "results",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("channel" = String, Path, description = "Name from the list of series"),
        ("from" = Option<f64>, Query, description = "First time, in seconds; the start when left out"),
        ("to" = Option<f64>, Query, description = "Last time, in seconds; the end when left out"),
        ("max_points" = Option<u64>, Query, description = "Points returned at most, 4 to 100000; 2000 when left out. Not \
            with `method=none`.", minimum = 4, maximum = 100_000, example = 2000),
        ("method" = Option<DownsampleMethod>, Query, description = "`minmax` (default): smallest and largest of equal stretches; \
            `lttb`: largest triangle three buckets; `none`: every sample, up to 1000000"),
        ("decimal" = Option<Decimal>, Query, description = "Answer with CSV: `point` (fields between commas, the default of `text/csv`) or \
            `comma` (decimal commas, fields between semicolons, CR LF, byte order mark: for spreadsheets of such a locale). The \
            same as `Accept: text/csv; decimal=comma`."),
    ),
    responses(
        (status = 200, description = "The samples.", content(
            (SeriesData = "application/json"),
            (String = "text/csv", example = "t_s,value\n0,1.5\n"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job or channel."),
        (status = 406, description = "Neither JSON nor CSV is accepted."),
        (status = 409, description = "`result-not-ready` or `job-not-succeeded`."),
        (status = 503, description = "`too-many-large-answers` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn read_series(
    State(state): State<AppState>,
    ChannelPath(id, channel): ChannelPath,
    mut query: QueryParameters,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    if let Some(channel) = channel.strip_suffix(read_sound::ENDING) {
        // The router has no patterns for parts of a segment.
        return read_sound::read_sound(state, id, channel, query, &headers).await;
    }
    let csv_decimal = negotiate_table(&headers, &mut query)?;
    let request = SeriesRequest::read(query)?;
    super::find_succeeded_job(&state, id).await?;
    let store = state.jobs().store();
    let catalogue = store.series_catalogue(id).await?;
    let no_channel = || ApiError::not_found("The job has no such channel.");
    let entry = catalogue.into_iter().find(|entry| entry.channel == channel).ok_or_else(no_channel)?;
    let (window, n_returned) = request.extent(&entry)?;
    let is_large = n_returned as u64 * SAMPLE_BYTES > LARGE_BODY_BYTES;
    let place = if is_large { Some(state.large_body_place().await?) } else { None };
    let permit = state.large_read_permit().await?;
    let packed = store.series(id, &channel).await?.ok_or_else(no_channel)?;
    let samples = tokio::task::spawn_blocking(move || {
        let samples = Samples::select(&packed, window, request.max_points, request.method);
        drop((packed, permit));
        samples
    });
    let pieces = samples.await.map_err(ApiError::internal)??.encode(csv_decimal).map_err(ApiError::internal)?;
    let body = match place {
        Some(place) => Body::new(GuardedBody::new(Body::from_stream(stream::iter(pieces)), place)),
        None => {
            let text: Vec<_> = pieces.collect::<Result<_, _>>().map_err(ApiError::internal)?;
            TextBody::new(text.concat()).into()
        }
    };
    let content_type = if csv_decimal.is_some() { "text/csv; charset=utf-8" } else { "application/json" };
    Ok(([(CONTENT_TYPE, content_type), (VARY, "accept")], body).into_response())
}

/// The time window and downsampling of a request.
struct SeriesRequest {
    window: TimeWindow,
    max_points: usize,
    method: DownsampleMethod,
}

impl SeriesRequest {
    fn read(mut query: QueryParameters) -> Result<Self, ApiError> {
        let window = TimeWindow::read(&mut query);
        let max_points = query.integer("max_points", MIN_POINTS, MAX_POINTS, false);
        let method = query.choice("method", &DownsampleMethod::ALL).unwrap_or(DownsampleMethod::MinMax);
        if method == DownsampleMethod::None && max_points.is_some() {
            query.add_violation(Violation::new("/max_points", "conflict", "cannot be given with method=none"));
        }
        query.finish()?;
        Ok(Self { window, max_points: max_points.unwrap_or(DEFAULT_POINTS) as usize, method })
    }

    /// The indices of the samples in the time window, and an upper bound on the number of those returned.
    ///
    /// # Errors
    /// There are more of them than may be returned without downsampling.
    fn extent(&self, entry: &SeriesEntry) -> Result<(Range<usize>, usize), ApiError> {
        let window = self.window.indices(entry);
        let n_source = window.len();
        match self.method {
            DownsampleMethod::None if n_source as u64 > MAX_RAW_POINTS => Err(too_many_samples(n_source)),
            DownsampleMethod::None => Ok((window, n_source)),
            DownsampleMethod::MinMax | DownsampleMethod::Lttb => Ok((window, n_source.min(self.max_points))),
        }
    }
}

fn too_many_samples(n: usize) -> ApiError {
    use crate::api::problem::{Problem, ProblemCode};
    let detail = format!("has {n} samples between from and to; permitted with method=none: at most {MAX_RAW_POINTS}");
    let violation = Violation {
        maximum: Some(MAX_RAW_POINTS as f64),
        ..Violation::new("/method", "out-of-range", detail.as_str())
    };
    Problem::new(ProblemCode::InvalidParameter, detail).with_errors(vec![violation]).into()
}
