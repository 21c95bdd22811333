//! `GET /api/v1/jobs/{id}/series/{channel}`

use crate::api::config::{DEFAULT_POINTS, MAX_POINTS, MAX_RAW_POINTS, MIN_POINTS};
use crate::api::csv::{Decimal, Field};
use crate::api::downsample::{Method, downsample};
use crate::api::held::Held;
use crate::api::problem::Refusal;
use crate::api::request::{ChannelPath, Parameters, json_or_csv};
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
pub struct SeriesData {
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
        ("method" = Option<Method>, Query, description = "`minmax` (default): smallest and largest of equal stretches; \
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
pub async fn read_series(
    State(state): State<AppState>,
    ChannelPath(id, channel): ChannelPath,
    mut query: Parameters,
    headers: HeaderMap,
) -> Result<Response, Refusal> {
    let as_csv = json_or_csv(&headers, &mut query)?;
    let request = SeriesRequest::read(query)?;
    super::succeeded(&state, id).await?;
    let place = state.series_place().await;
    let packed = state.jobs().store().series(id, &channel).await?;
    let packed = packed.ok_or_else(|| Refusal::not_found("The job has no such channel."))?;
    let written = tokio::task::spawn_blocking(move || request.answer(&packed)?.written(as_csv));
    let body = Body::from(written.await.map_err(Refusal::internal)??);
    let content_type = if as_csv.is_some() { "text/csv; charset=utf-8" } else { "application/json" };
    let headers = [(CONTENT_TYPE, content_type), (VARY, "accept")];
    Ok((headers, Body::new(Held::new(body, place))).into_response())
}

/// Which samples are wanted.
struct SeriesRequest {
    from_s: f64,
    to_s: f64,
    max_points: usize,
    method: Method,
}

impl SeriesRequest {
    fn read(mut query: Parameters) -> Result<Self, Refusal> {
        let from_s = query.number("from", "s").unwrap_or(f64::NEG_INFINITY);
        let to_s = query.number("to", "s").unwrap_or(f64::INFINITY);
        let max_points = query.whole("max_points", MIN_POINTS, MAX_POINTS, false);
        let method = query.choice("method", &Method::ALL).unwrap_or(Method::MinMax);
        if from_s > to_s {
            query.violate(Violation::new("/to", "conflict", "lies before from"));
        }
        if method == Method::None && max_points.is_some() {
            query.violate(Violation::new("/max_points", "conflict", "cannot be given with method=none"));
        }
        query.finish()?;
        Ok(Self { from_s, to_s, max_points: max_points.unwrap_or(DEFAULT_POINTS) as usize, method })
    }

    fn answer(&self, packed: &PackedSeries) -> Result<SeriesData, Refusal> {
        let entry = &packed.entry;
        let values = packed.unpack()?;
        let time = |index: usize| entry.t0_s + index as f64 * entry.dt_s;
        let indices: Vec<usize> = (0..values.len()).collect();
        let start = indices.partition_point(|index| time(*index) < self.from_s);
        let end = indices.partition_point(|index| time(*index) <= self.to_s).max(start);
        let window = &values[start..end];
        if self.method == Method::None && window.len() as u64 > MAX_RAW_POINTS {
            return Err(too_many(window.len()));
        }
        let (chosen, method) = downsample(window, self.max_points, self.method);
        Ok(SeriesData {
            channel: entry.channel.clone(),
            quantity: entry.quantity.clone(),
            unit: entry.unit.clone(),
            t: chosen.iter().map(|index| time(start + index)).collect(),
            y: chosen.iter().map(|index| window[*index]).collect(),
            n_source: window.len(),
            n_returned: chosen.len(),
            n_not_finite: chosen.iter().filter(|index| !window[**index].is_finite()).count(),
            method: method.word().to_owned(),
        })
    }
}

impl SeriesData {
    fn written(&self, as_csv: Option<Decimal>) -> Result<Vec<u8>, Refusal> {
        match as_csv {
            Some(decimal) => Ok(csv(self, decimal).into_bytes()),
            None => serde_json::to_vec(self).map_err(Refusal::internal),
        }
    }
}

fn too_many(n: usize) -> Refusal {
    use crate::api::problem::{Problem, ProblemCode};
    let detail = format!("has {n} samples between from and to; permitted with method=none: at most {MAX_RAW_POINTS}");
    let violation = Violation {
        maximum: Some(MAX_RAW_POINTS as f64),
        ..Violation::new("/method", "out-of-range", detail.as_str())
    };
    Problem::new(ProblemCode::InvalidParameter, detail).with_errors(vec![violation]).into()
}

fn csv(data: &SeriesData, decimal: Decimal) -> String {
    let mut text = String::with_capacity(data.t.len() * 40);
    text.push_str(decimal.start());
    decimal.push_line(&mut text, ["t_s", "value"].map(Field::Text));
    for (t, y) in data.t.iter().zip(&data.y) {
        decimal.push_line(&mut text, [Field::Number(*t), Field::Number(*y)]);
    }
    text
}
