//! `GET /api/v1/jobs/{id}/series/{channel}.wav`

use crate::api::problem::ApiError;
use crate::api::request::{QueryParameters, TimeWindow, negotiate};
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use crate::store::JobId;
use axum::body::Body;
use axum::http::HeaderMap;
use axum::response::Response;
use herringbone_exchange::sound::Sound;

/// The ending of the path.
pub(super) const ENDING: &str = ".wav";
const MEDIA_TYPE: &str = "audio/wav";
const DEFAULT_SECONDS: f64 = 5.0;
const DEFAULT_RATE_HZ: u64 = 48_000;

/// Hear a recorded acceleration: the record, repeated, as a WAV file.
#[utoipa::path(
    get, path = "/api/v1/jobs/{id}/series/{channel}.wav", tag = "results",
    description = "The record is a whole number of mesh periods and is repeated as often as the sound is long. Its mean is taken off, \
        and what lies above\nnine tenths of half the sampling rate. The file's comment has the value of the full scale: with the same \
        `full_scale`, sounds of several\njobs can be compared.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("channel" = String, Path, description = "Name of an acceleration from the list of series", example = "a_x_left"),
        ("seconds" = Option<f64>, Query, minimum = 0.1, maximum = 30, description = "Length of the sound; 5 when left out"),
        ("rate_hz" = Option<u64>, Query, minimum = 8000, maximum = 96_000, description = "Sampling rate; 48000 when left out"),
        ("full_scale" = Option<f64>, Query, minimum = 1e-9, maximum = 1e12, description = "Acceleration at full scale, in the unit of the \
            channel; larger ones are clipped. When left out, the greatest has four fifths of the scale."),
        ("from" = Option<f64>, Query, description = "First time of the record, in seconds; the start when left out"),
        ("to" = Option<f64>, Query, description = "Last time of the record, in seconds; the end when left out"),
    ),
    responses(
        (status = 200, description = "The sound: 16 bits, one channel.", body = Vec<u8>, content_type = "audio/wav"),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job or channel, or the channel is no acceleration."),
        (status = 406, description = "`audio/wav` is not accepted."),
        (status = 409, description = "`result-not-ready` or `job-not-succeeded`."),
        (status = 503, description = "`too-many-large-answers` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(in crate::api) async fn read_sound(
    state: AppState,
    id: JobId,
    channel: &str,
    mut query: QueryParameters,
    headers: &HeaderMap,
) -> Result<Response, ApiError> {
    negotiate(headers, &[MEDIA_TYPE])?;
    let seconds = query.number_within("seconds", "s", 0.1..=30.0).unwrap_or(DEFAULT_SECONDS);
    let rate_hz = query.integer("rate_hz", 8000, 96_000, false).unwrap_or(DEFAULT_RATE_HZ) as u32;
    let full_scale = query.number_within("full_scale", "the unit of the channel", 1e-9..=1e12);
    let window = TimeWindow::read(&mut query);
    query.finish()?;
    super::find_succeeded_job(&state, id).await?;
    let store = state.jobs().store();
    let no_channel = || ApiError::not_found("The job has no such channel.");
    let entries = store.series_catalogue(id).await?;
    let entry = entries.into_iter().find(|entry| entry.channel == channel).ok_or_else(no_channel)?;
    if !entry.quantity.contains("acceleration") {
        return Err(ApiError::not_found(format!("There is no sound of {channel}: it is no acceleration.")));
    }
    let place = state.large_body_place().await?;
    let permit = state.large_read_permit().await?;
    let packed = store.series(id, channel).await?.ok_or_else(no_channel)?;
    let comment = format!("{channel} of job {id}, the record repeated");
    let window = window.indices(&entry);
    let file = tokio::task::spawn_blocking(move || {
        let values = packed.unpack()?;
        let sound = Sound {
            values: values.get(window).unwrap_or_default(),
            dt_s: entry.dt_s,
            seconds,
            rate_hz,
            full_scale,
            unit: &entry.unit,
            comment: &comment,
        };
        let file = sound.to_wav();
        drop(permit);
        Ok::<_, ApiError>(file)
    });
    let file = file.await.map_err(ApiError::internal)??;
    let body = Body::new(crate::api::guarded_body::GuardedBody::new(TextBody::new(file).into(), place));
    Ok(super::file_response(body, MEDIA_TYPE, &format!("{id}-{channel}.wav")))
}
