//! `GET /api/v1/system`

use crate::api::config::{
    DEFAULT_PAGE, DEFAULT_POINTS, MAX_BODY_BYTES, MAX_PAGE, MAX_POINTS, MAX_RAW_POINTS, MAX_WAIT_S,
};
use crate::api::problem::ApiError;
use crate::api::state::AppState;
use crate::work::{Member, MemberChunk, Transport, WaitingWork};
use axum::Json;
use axum::extract::State;
use jiff::Timestamp;
use serde::Serialize;
use utoipa::ToSchema;

/// The service and what it does now.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = System)]
pub(super) struct SystemView {
    pub name: &'static str,
    pub version: &'static str,
    /// Results stored under another version are not reused.
    pub solver_version: &'static str,
    pub started_at: String,
    /// Time of this answer, by the clock of the service.
    pub now: String,
    pub shutting_down: bool,
    pub queue: QueueView,
    pub workers: WorkersView,
    /// Workers on other machines (`herringbone worker`).
    pub machines: Vec<MachineView>,
    /// What waits for workers on other machines, by their kind.
    pub waiting_work: Vec<WaitingWorkView>,
    pub limits: RequestLimits,
}

#[derive(Debug, Serialize, ToSchema)]
pub(super) struct QueueView {
    /// Jobs that wait.
    pub depth: u64,
    /// Jobs that may wait; further ones are answered with 503.
    pub capacity: u32,
    /// `local`: jobs run in this process; `nats`: workers on other machines compute them.
    pub transport: &'static str,
    /// Whether there is a connection to NATS; null without NATS.
    pub connected: Option<bool>,
    /// Silence of a worker after which its work is given to another, in seconds; null without NATS.
    pub ack_wait_s: Option<u64>,
}

#[derive(Debug, Serialize, ToSchema)]
pub(super) struct WorkersView {
    /// Jobs of one operating point that can run at once.
    pub total: usize,
    /// Those that run.
    pub busy: usize,
    /// Sweeps that can run at once, beside the others.
    pub sweeps_total: usize,
    /// Those that run.
    pub sweeps_busy: usize,
}

/// A worker on another machine, as it was heard of last.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Machine)]
pub(super) struct MachineView {
    pub id: String,
    pub host: String,
    pub version: String,
    /// It computes only work of the same version of the calculation.
    pub solver_version: String,
    /// Chunks that it computes at once.
    pub slots: u32,
    pub last_beat_at: String,
    /// Time since its last beat.
    pub silent_s: f64,
    /// Silent for so long that its work is for others.
    pub lost: bool,
    pub running: Vec<ChunkView>,
}

/// A part of a job that a worker computes.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Chunk)]
pub(super) struct ChunkView {
    /// Id of the job.
    pub job: String,
    pub chunk: u32,
    pub stage: String,
    /// Completed fraction of the chunk, 0 to 1.
    pub fraction: f64,
}

#[derive(Debug, Serialize, ToSchema)]
#[schema(as = WaitingWork)]
pub(super) struct WaitingWorkView {
    /// Version of the calculation, and the class of processors where results depend on it.
    pub solver: String,
    /// Chunks that no worker computes yet.
    pub chunks: usize,
    /// Slots of the workers that can take them; 0: there is no worker of this version.
    pub slots: usize,
}

/// Limits of requests.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Limits)]
pub(super) struct RequestLimits {
    pub max_body_bytes: usize,
    pub max_wait_s: u64,
    pub page_default: u32,
    pub page_max: u32,
    pub series_points_default: u64,
    pub series_points_max: u64,
    /// Samples per request with `method=none`.
    pub series_samples_max: u64,
}

impl MachineView {
    fn of(member: Member) -> Self {
        let chunk = |MemberChunk { job, chunk, stage, fraction }| ChunkView { job, chunk, stage, fraction };
        Self {
            id: member.id,
            host: member.host,
            version: member.version,
            solver_version: member.solver_version,
            slots: member.slots,
            last_beat_at: member.last_beat_at.to_string(),
            silent_s: member.silence.as_secs_f64(),
            lost: member.is_lost,
            running: member.running.into_iter().map(chunk).collect(),
        }
    }
}

/// Read version, queue, workers and limits.
#[utoipa::path(
    get, path = "/system", tag = "service",
    responses((status = 200, description = "The service and what it does now.", body = SystemView))
)]
pub(super) async fn read_system(State(state): State<AppState>) -> Result<Json<SystemView>, ApiError> {
    let jobs = state.jobs();
    let workers = jobs.workers();
    let (transport, connected, ack_wait_s) = match jobs.transport() {
        Transport::Local => ("local", None, None),
        Transport::Nats { is_connected, ack_wait } => ("nats", Some(is_connected), Some(ack_wait.as_secs())),
    };
    Ok(Json(SystemView {
        name: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        solver_version: jobs.solver_version(),
        started_at: state.started_at().to_string(),
        shutting_down: jobs.is_closing(),
        now: Timestamp::now().to_string(),
        queue: QueueView {
            depth: jobs.store().queued_count(),
            capacity: jobs.capacity(),
            transport,
            connected,
            ack_wait_s,
        },
        workers: WorkersView {
            total: workers.total,
            busy: workers.busy,
            sweeps_total: workers.sweeps_total,
            sweeps_busy: workers.sweeps_busy,
        },
        machines: jobs.members().into_iter().map(MachineView::of).collect(),
        waiting_work: jobs
            .waiting_work()
            .into_iter()
            .map(|WaitingWork { solver, chunks, slots }| WaitingWorkView { solver, chunks, slots })
            .collect(),
        limits: RequestLimits {
            max_body_bytes: MAX_BODY_BYTES,
            max_wait_s: MAX_WAIT_S,
            page_default: DEFAULT_PAGE,
            page_max: MAX_PAGE,
            series_points_default: DEFAULT_POINTS,
            series_points_max: MAX_POINTS,
            series_samples_max: MAX_RAW_POINTS,
        },
    }))
}
