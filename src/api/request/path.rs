//! Jobs and channels named in the path. A name that cannot exist is not found, like one that does not.

use crate::api::problem::Refusal;
use crate::store::JobId;
use axum::extract::{FromRequestParts, RawPathParams};
use axum::http::request::Parts;

/// `{id}`.
#[derive(Debug, Clone, Copy)]
pub struct JobPath(pub JobId);

/// `{id}` and `{channel}`.
#[derive(Debug, Clone)]
pub struct ChannelPath(pub JobId, pub String);

/// `{id}` and `{position}`.
#[derive(Debug, Clone, Copy)]
pub struct PointPath(pub JobId, pub usize);

impl<S: Send + Sync> FromRequestParts<S> for JobPath {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Refusal> {
        let word = named(parts, state, "id").await?;
        word.parse().map(Self).map_err(|_| Refusal::not_found("There is no such job."))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for ChannelPath {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Refusal> {
        let JobPath(id) = JobPath::from_request_parts(parts, state).await?;
        Ok(Self(id, named(parts, state, "channel").await?))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for PointPath {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Self, Refusal> {
        let JobPath(id) = JobPath::from_request_parts(parts, state).await?;
        let word = named(parts, state, "position").await?;
        let position = word.parse().map_err(|_| Refusal::not_found("There is no such point."))?;
        Ok(Self(id, position))
    }
}

async fn named<S: Send + Sync>(parts: &mut Parts, state: &S, name: &str) -> Result<String, Refusal> {
    let parameters = RawPathParams::from_request_parts(parts, state)
        .await
        .map_err(|_| Refusal::not_found("There is nothing at this path."))?;
    let found = parameters.iter().find(|(key, _)| *key == name).map(|(_, value)| value.to_owned());
    found.ok_or_else(|| Refusal::not_found("There is nothing at this path."))
}
