//! `GET /api/v1/webhooks/deliveries`

use crate::api::problem::ApiError;
use crate::api::request::QueryParameters;
use crate::api::state::AppState;
use crate::store::{Delivery, DeliveryState};
use crate::webhook::origin;
use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

/// What webhooks told, or are to tell.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct DeliveryList {
    pub items: Vec<DeliveryView>,
}

/// The end of a job that an address is told of.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = WebhookDelivery)]
pub(super) struct DeliveryView {
    /// The header `webhook-id` of every try.
    pub id: String,
    #[schema(example = "job.succeeded")]
    pub event: String,
    pub job: String,
    /// Scheme and host; the path may be a secret of the receiver.
    #[schema(example = "https://hooks.example/…")]
    pub address: String,
    /// `waiting`, `delivered` or `failed`.
    pub state: String,
    /// Time of the event.
    pub at: String,
    /// Number of tries made.
    pub tries: u32,
    pub last_try_at: Option<String>,
    /// Time of the next try, while it waits.
    pub next_try_at: Option<String>,
    /// HTTP status of the last answer.
    pub last_status: Option<u16>,
    /// Why the last try was no success.
    pub last_error: Option<String>,
}

impl From<Delivery> for DeliveryView {
    fn from(delivery: Delivery) -> Self {
        let waits = delivery.state == DeliveryState::Waiting;
        Self {
            event: format!("job.{}", delivery.job_state.as_str()),
            job: delivery.job.to_string(),
            address: origin(&delivery.url),
            state: delivery.state.as_str().to_owned(),
            at: delivery.at.to_string(),
            tries: delivery.tries,
            last_try_at: delivery.last_try.map(|time| time.to_string()),
            next_try_at: waits.then(|| delivery.due_at.to_string()),
            last_status: delivery.last_status,
            last_error: delivery.last_error,
            id: delivery.id,
        }
    }
}

/// List what webhooks told last, or are to tell: a hundred entries at most, the newest first.
#[utoipa::path(
    get, path = "/webhooks/deliveries", tag = "service",
    responses(
        (status = 200, description = "The deliveries; none where no webhook is configured.", body = DeliveryList),
        (status = 400, description = "`invalid-parameter`."),
    )
)]
pub(super) async fn list_deliveries(
    State(state): State<AppState>,
    query: QueryParameters,
) -> Result<Json<DeliveryList>, ApiError> {
    query.finish()?;
    let deliveries = state.jobs().store().deliveries().await?;
    Ok(Json(DeliveryList { items: deliveries.into_iter().map(DeliveryView::from).collect() }))
}
