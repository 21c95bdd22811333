//! Taking up jobs: from the queue, as many as can be computed soon, and those of an earlier process.

use super::active::{ActiveJob, OpenChunk};
use super::evaluations::WorkersOfSearch;
use super::names::{depends_on_processor, is_of_version, processor_class, solver_of, solver_of_class};
use super::plan::SweepPlan;
use super::shared::Shared;
use crate::store::{ChunkState, Claim, ReleaseReason, StoreError, WorkClass};
use crate::work::estimate::estimate;
use crate::work::failure::{document_failure, public_failure};
use crate::work::job_run::retry;
use crate::work::measure;
use crate::work::reuse::stored_completion;
use crate::work::running_points::EvaluateElsewhere;
use crate::work::stop_signal::StopReason;
use herringbone_job::document::{JobDocument, JobKind, MethodInput};
use herringbone_job::study::SweepOrder;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tracing::Instrument;

/// Time of a point of a sweep, or of an evaluation, below which sending it costs more than computing it.
pub(super) const WORTH_SENDING_S: f64 = 2e-3;
/// Periods of integration above which a job of one operating point is worth sending.
const WORTH_SENDING_PERIODS: u32 = 10_000;
/// Time of the jobs that wait above which anything is sent.
const LONG_WAIT_S: f64 = 30.0;
/// Chunks of jobs of one operating point that are out at once, by slot, and the least number.
const SINGLES_BY_SLOT: usize = 4;
pub(super) const LEAST_WINDOW: usize = 2;

/// Claims queued jobs while there is room for them.
pub(super) async fn admit(shared: &Arc<Shared>) -> Result<(), StoreError> {
    for class in [WorkClass::Single, WorkClass::Sweep] {
        while !shared.closing().is_cancelled() && has_room(shared, class) {
            let Some(claim) = shared.recorder().claim_next(class).await? else { break };
            let span = measure::span(&claim.job);
            take_up(shared, claim, class).instrument(span).await;
        }
    }
    Ok(())
}

fn has_room(shared: &Shared, class: WorkClass) -> bool {
    if shared.local_places.available_permits() > 0 {
        return true;
    }
    if !shared.nats.is_up() {
        return false;
    }
    let (state, now) = (shared.state(), Instant::now());
    let (slots, _) = state.members.totals(now);
    let (singles, of_sweeps) = state.open_soon();
    match class {
        WorkClass::Single => singles < (SINGLES_BY_SLOT * slots).max(LEAST_WINDOW),
        WorkClass::Sweep => {
            let is_sweep = |job: &&ActiveJob| job.class == WorkClass::Sweep && !job.runs_here();
            let sweeps = state.jobs.values().filter(is_sweep).count() + state.finishing;
            sweeps < shared.work.sweep_workers as usize || of_sweeps < 2 * slots
        }
    }
}

/// Takes up a claimed job: to be computed here, or by workers.
async fn take_up(shared: &Arc<Shared>, claim: Claim, class: WorkClass) {
    let document = match herringbone_job::parse(claim.input.as_bytes()) {
        Ok(document) => document,
        Err(error) => {
            let failure = public_failure(document_failure(error));
            tracing::warn!(code = failure.code, detail = failure.detail, "job failed");
            until_stored(shared, || shared.recorder().fail(&claim.job, &failure)).await;
            return;
        }
    };
    if document.kind == JobKind::Optimise {
        // Each batch of a search follows from the one before: the search runs in this process.
        let place = Arc::clone(&shared.local_places).try_acquire_owned().ok();
        let workers = Arc::new(WorkersOfSearch::new(shared, claim.clone(), &document));
        return run_here(shared, claim, class, false, place, Some(workers));
    }
    if is_for_here(shared, class, &document).await
        && let Ok(place) = Arc::clone(&shared.local_places).try_acquire_owned()
    {
        return run_here(shared, claim, class, false, Some(place), None);
    }
    let (store, version) = (shared.store(), shared.solver.version());
    let input_hash = shared.solver.input_hash(&document);
    let Some(reusable) = until_stored(shared, || stored_completion(store, &input_hash, version)).await else { return };
    if let Some(completion) = reusable
        && until_stored(shared, || shared.recorder().succeed(&claim.job, &completion)).await.unwrap_or(true)
    {
        return;
    }
    let (id, attempt) = (claim.job.id, claim.job.attempt);
    let (plan, stored) = match class {
        WorkClass::Single => (None, 0),
        WorkClass::Sweep => {
            let collected = until_stored(shared, || store.collect_points(id, attempt, &input_hash, version)).await;
            let Some(((), rest)) = collected.zip(until_stored(shared, || rest_of(shared, &claim, &document)).await)
            else {
                return;
            };
            (Some(rest.0), rest.1)
        }
    };
    tracing::info!("job started");
    let solver = solver_for(shared, &document);
    shared.state().insert(ActiveJob::new(claim, solver, plan, stored, Instant::now()));
    // A cancellation that came before it was known here.
    let job = until_stored(shared, || shared.store().job(id)).await.flatten();
    if job.is_some_and(|job| job.cancel_requested_at.is_some())
        && let Some(active) = shared.state().jobs.get_mut(&id)
    {
        active.stop = Some(StopReason::Cancel);
    }
}

/// The plan of a sweep, and the number of its rows that are stored.
async fn rest_of(shared: &Shared, claim: &Claim, document: &JobDocument) -> Result<(SweepPlan, u64), StoreError> {
    let stored = shared.store().point_positions(claim.job.id).await?;
    let ends = shared.store().line_ends(claim.job.id).await?;
    Ok((SweepPlan::new(SweepOrder::of(document), &stored, ends), stored.len() as u64))
}

/// Which workers can compute a job.
fn solver_for(shared: &Shared, document: &JobDocument) -> String {
    let version = shared.solver.version();
    if !depends_on_processor(document) {
        return solver_of(version);
    }
    let largest = shared.state().members.largest_class(&solver_of(version), Instant::now());
    largest.unwrap_or_else(|| solver_of_class(version, processor_class()))
}

/// Whether a job is better computed in this process.
async fn is_for_here(shared: &Shared, class: WorkClass, document: &JobDocument) -> bool {
    if shared.local_places.available_permits() == 0 {
        return false;
    }
    if shared.state().members.totals(Instant::now()).0 == 0 {
        return true;
    }
    let estimate = estimate(shared.store(), document, shared.solver.version()).await.ok();
    let wall_s = estimate.as_ref().and_then(|estimate| estimate.wall_s).map(|[median, ..]| median);
    let places = f64::from(shared.config.local_workers.max(1));
    let wait_s = shared.store().queued_count() as f64 * wall_s.unwrap_or(1.0) / places;
    // An evaluation has several operating points.
    let rows =
        |points: usize| if document.kind == JobKind::Tolerance { document.evaluations() as usize } else { points };
    let point_s = wall_s.zip(estimate).map(|(wall_s, estimate)| wall_s / rows(estimate.points).max(1) as f64);
    !is_worth_sending(class, document, point_s, wait_s)
}

/// Whether computing a job elsewhere is worth sending it and its results. `point_s`: measured time of a point;
/// `wait_s`: time that the jobs which wait would take here.
fn is_worth_sending(class: WorkClass, document: &JobDocument, point_s: Option<f64>, wait_s: f64) -> bool {
    let is_long = match class {
        WorkClass::Sweep => point_s.is_none_or(|seconds| seconds >= WORTH_SENDING_S),
        WorkClass::Single => {
            let analysis = &document.analysis;
            let is_integrated = document.kind == JobKind::Response && analysis.method == MethodInput::Integrate;
            depends_on_processor(document) || (is_integrated && analysis.mesh_periods > WORTH_SENDING_PERIODS)
        }
    };
    is_long || wait_s > LONG_WAIT_S
}

/// Runs a job in this process. `workers`: those that make the evaluations of an optimisation.
pub(super) fn run_here(
    shared: &Arc<Shared>,
    claim: Claim,
    class: WorkClass,
    rows_are_own: bool,
    place: Option<tokio::sync::OwnedSemaphorePermit>,
    workers: Option<Arc<WorkersOfSearch>>,
) {
    let (task, span) = (Arc::clone(shared), measure::span(&claim.job));
    let run = async move {
        let id = claim.job.id;
        let is_search = workers.is_some();
        let elsewhere = workers.map(|workers| workers as Arc<dyn EvaluateElsewhere>);
        task.runner.run_job(claim, class, &task.local_pool, rows_are_own, elsewhere).await;
        let has_open_chunks = is_search && task.state().remove(id).is_some_and(|job| !job.open.is_empty());
        if has_open_chunks {
            task.broadcast_stop(id).await;
        }
        drop(place);
        if rows_are_own || class == WorkClass::Sweep {
            let mut state = task.state();
            state.finishing = state.finishing.saturating_sub(1);
        }
        task.wake.notify_one();
    };
    if rows_are_own || class == WorkClass::Sweep {
        shared.state().finishing += 1;
    }
    shared.tasks.spawn(run.instrument(span));
}

/// Takes up the jobs that workers computed for an earlier process. They go on in the same attempt, so that results that
/// wait are stored.
///
/// # Errors
/// The database cannot be read.
pub(super) async fn resume(shared: &Arc<Shared>) -> Result<(), StoreError> {
    let now = Instant::now();
    let last = shared.store().last_chunk_sequence().await?;
    shared.state().last_sequence = last;
    for claim in shared.store().distributed_jobs().await? {
        let Ok(document) = herringbone_job::parse(claim.input.as_bytes()) else { continue };
        if document.kind == JobKind::Optimise {
            // The search goes through its rows again, and takes those that are stored.
            shared.recorder().release(&claim.job, ReleaseReason::Shutdown, Duration::ZERO).await?;
            continue;
        }
        let (plan, stored) = match WorkClass::of_kind(&claim.job.kind) {
            WorkClass::Single => (None, 0),
            WorkClass::Sweep => {
                let (plan, stored) = rest_of(shared, &claim, &document).await?;
                (Some(plan), stored)
            }
        };
        let chunks = shared.store().chunks(claim.job.id, claim.job.attempt).await?;
        if chunks.iter().any(|chunk| !is_of_version(&chunk.solver, shared.solver.version())) {
            // Rows of two versions are never mixed: it begins again.
            shared.recorder().release(&claim.job, ReleaseReason::Shutdown, Duration::ZERO).await?;
            tracing::info!(job = %claim.job.id, "job of another version begins again");
            continue;
        }
        let solver = chunks.first().map_or_else(|| solver_for(shared, &document), |chunk| chunk.solver.clone());
        let mut job = ActiveJob::new(claim, solver, plan, stored, now);
        // As many rows as the chunks that are stored have: none is of an earlier attempt.
        let mut own = 0;
        for record in chunks {
            job.next_chunk = job.next_chunk.max(record.key.chunk + 1);
            let Some(plan) = &mut job.plan else {
                job.open.insert(record.key.chunk, OpenChunk::of(&record, now));
                continue;
            };
            own += plan.positions(&record.part).iter().map(|[from, to]| to - from).sum::<u64>();
            if record.state != ChunkState::Stored {
                plan.resume(record.class, &record.part);
                job.open.insert(record.key.chunk, OpenChunk::of(&record, now));
            }
        }
        job.rows_are_own = own + job.plan.as_ref().map_or(0, SweepPlan::remaining) == job.points;
        tracing::info!(job = %job.job.id, chunks = job.open.len(), "job of an earlier run goes on");
        shared.state().insert(job);
    }
    Ok(())
}

/// Retries an operation of the database until it succeeds; `None` when the service closes before that.
pub(super) async fn until_stored<T, F>(shared: &Shared, attempt: impl FnMut() -> F) -> Option<T>
where
    F: Future<Output = Result<T, StoreError>>,
{
    retry(attempt, shared.closing().cancelled()).await
}

/// Longest time for which a sweep that has to make way waits for its chunks.
pub(super) const LAST_CHUNKS: Duration = Duration::from_secs(10);

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn document(change: impl Fn(&mut Value)) -> JobDocument {
        let mut document: Value = serde_json::from_str(include_str!("../../../examples/speed_sweep.json")).unwrap();
        change(&mut document);
        herringbone_job::parse(document.to_string().as_bytes()).unwrap()
    }

    #[test]
    fn what_is_sent_is_decided_by_measured_cost() {
        let sweep = document(|_| {});
        let sent = |point_s, wait_s| is_worth_sending(WorkClass::Sweep, &sweep, point_s, wait_s);
        assert!(sent(None, 0.0) && sent(Some(2e-3), 0.0) && sent(Some(1e-4), 31.0));
        assert!(!sent(Some(1e-4), 30.0));
        let single = |method: &str, periods: u32, fidelity: &str| {
            let document = document(|document| {
                document["kind"] = "response".into();
                document.as_object_mut().unwrap().remove("axes");
                document["analysis"] = json!({"method": method, "mesh_periods": periods});
                document["model"]["mesh_stiffness"] = json!({"source": "ltca", "fidelity": fidelity});
            });
            is_worth_sending(WorkClass::Single, &document, Some(0.1), 0.0)
        };
        assert!(!single("integrate", 10_000, "analytic") && single("integrate", 10_001, "analytic"));
        assert!(single("auto", 100, "fe") && !single("auto", 20_000, "analytic"));
    }
}
