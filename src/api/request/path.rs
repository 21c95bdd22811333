//! Extractors of path parameters. Malformed values are answered with 404, like those that do not exist.

use crate::api::problem::ApiError;
use crate::store::JobId;
use axum::extract::{FromRequestParts, RawPathParams};
use axum::http::request::Parts;

/// `{id}` of a job.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JobPath(pub JobId);

/// `{id}` and `{channel}`.
#[derive(Debug, Clone)]
pub(crate) struct ChannelPath(pub JobId, pub String);

/// `{id}` and `{position}`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointPath(pub JobId, pub usize);

impl<S: Send + Sync> FromRequestParts<S> for JobPath {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let text = path_parameter(parts, state, "id").await?;
        text.parse().map(Self).map_err(|_| ApiError::not_found("There is no such job."))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for ChannelPath {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let JobPath(id) = JobPath::from_request_parts(parts, state).await?;
        Ok(Self(id, path_parameter(parts, state, "channel").await?))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for PointPath {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, ApiError> {
        let JobPath(id) = JobPath::from_request_parts(parts, state).await?;
        let text = path_parameter(parts, state, "position").await?;
        let position = text.parse().map_err(|_| ApiError::not_found("There is no such point."))?;
        Ok(Self(id, position))
    }
}

async fn path_parameter<S: Send + Sync>(parts: &mut Parts, state: &S, name: &str) -> Result<String, ApiError> {
    let parameters = RawPathParams::from_request_parts(parts, state)
        .await
        .map_err(|_| ApiError::not_found("There is nothing at this path."))?;
    let value = parameters.iter().find(|(key, _)| *key == name).map(|(_, value)| value.to_owned());
    value.ok_or_else(|| ApiError::not_found("There is nothing at this path."))
}
