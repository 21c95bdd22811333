//! `GET /api/v1/jobs/{id}/series/{channel}`

use crate::api::config::{DEFAULT_POINTS, MAX_POINTS, MAX_RAW_POINTS, MIN_POINTS};
use crate::api::csv::{CsvField, CsvWriter, Decimal};
use crate::api::downsample::{DownsampleMethod, downsample};
use crate::api::guarded_body::GuardedBody;
use crate::api::problem::ApiError;
use crate::api::request::{ChannelPath, QueryParameters, negotiate_table};
use crate::api::state::AppState;
use crate::store::PackedSeries;
use axum::body::Body;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};
use herringbone_job::Violation;
use serde::Serialize;
use utoipa::ToSchema;

/// Samples of a channel.
#[derive(Debug, Serialize, ToSchema)]
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
    )
)]
pub(super) async fn read_series(
    State(state): State<AppState>,
    ChannelPath(id, channel): ChannelPath,
    mut query: QueryParameters,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let csv_decimal = negotiate_table(&headers, &mut query)?;
    let request = SeriesRequest::read(query)?;
    super::find_succeeded_job(&state, id).await?;
    let permit = state.series_permit().await;
    let packed = state.jobs().store().series(id, &channel).await?;
    let packed = packed.ok_or_else(|| ApiError::not_found("The job has no such channel."))?;
    let encoded = tokio::task::spawn_blocking(move || request.select(&packed)?.encode(csv_decimal));
    let body = Body::from(encoded.await.map_err(ApiError::internal)??);
    let content_type = if csv_decimal.is_some() { "text/csv; charset=utf-8" } else { "application/json" };
    let headers = [(CONTENT_TYPE, content_type), (VARY, "accept")];
    Ok((headers, Body::new(GuardedBody::new(body, permit))).into_response())
}

/// The time window and downsampling of a request.
struct SeriesRequest {
    from_s: f64,
    to_s: f64,
    max_points: usize,
    method: DownsampleMethod,
}

impl SeriesRequest {
    fn read(mut query: QueryParameters) -> Result<Self, ApiError> {
        let from_s = query.number("from", "s").unwrap_or(f64::NEG_INFINITY);
        let to_s = query.number("to", "s").unwrap_or(f64::INFINITY);
        let max_points = query.integer("max_points", MIN_POINTS, MAX_POINTS, false);
        let method = query.choice("method", &DownsampleMethod::ALL).unwrap_or(DownsampleMethod::MinMax);
        if from_s > to_s {
            query.add_violation(Violation::new("/to", "conflict", "lies before from"));
        }
        if method == DownsampleMethod::None && max_points.is_some() {
            query.add_violation(Violation::new("/max_points", "conflict", "cannot be given with method=none"));
        }
        query.finish()?;
        Ok(Self { from_s, to_s, max_points: max_points.unwrap_or(DEFAULT_POINTS) as usize, method })
    }

    /// The samples in the window, downsampled.
    fn select(&self, packed: &PackedSeries) -> Result<SeriesData, ApiError> {
        let entry = &packed.entry;
        let values = packed.unpack()?;
        let time = |index: usize| entry.t0_s + index as f64 * entry.dt_s;
        let indices: Vec<usize> = (0..values.len()).collect();
        let start = indices.partition_point(|index| time(*index) < self.from_s);
        let end = indices.partition_point(|index| time(*index) <= self.to_s).max(start);
        let window = &values[start..end];
        if self.method == DownsampleMethod::None && window.len() as u64 > MAX_RAW_POINTS {
            return Err(too_many_samples(window.len()));
        }
        let (selected, method) = downsample(window, self.max_points, self.method);
        Ok(SeriesData {
            channel: entry.channel.clone(),
            quantity: entry.quantity.clone(),
            unit: entry.unit.clone(),
            t: selected.iter().map(|index| time(start + index)).collect(),
            y: selected.iter().map(|index| window[*index]).collect(),
            n_source: window.len(),
            n_returned: selected.len(),
            n_not_finite: selected.iter().filter(|index| !window[**index].is_finite()).count(),
            method: method.as_str().to_owned(),
        })
    }
}

impl SeriesData {
    /// The response body: CSV with this decimal sign, or JSON.
    fn encode(&self, csv_decimal: Option<Decimal>) -> Result<Vec<u8>, ApiError> {
        match csv_decimal {
            Some(decimal) => csv(self, decimal).map_err(ApiError::internal),
            None => serde_json::to_vec(self).map_err(ApiError::internal),
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

fn csv(data: &SeriesData, decimal: Decimal) -> std::io::Result<Vec<u8>> {
    let mut writer = CsvWriter::with_mark(Vec::with_capacity(data.t.len() * 40), decimal)?;
    writer.write_record(["t_s", "value"].map(CsvField::Text))?;
    for (t, y) in data.t.iter().zip(&data.y) {
        writer.write_record([CsvField::Number(*t), CsvField::Number(*y)])?;
    }
    writer.into_inner()
}
