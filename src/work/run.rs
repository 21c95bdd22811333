//! One claimed job, from its document to what is written.

use super::recorder::Recorder;
use super::reuse::stored_completion;
use super::solver::Solver;
use super::stages::StoredStages;
use crate::job::document::JobDocument;
use crate::job::{self, DocumentError};
use crate::store::{Claim, Completion, Failure, JobRecord, PackedSeries, State, StoreError};
use crate::study::{SolveError, Stage, Surroundings};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::sync::{oneshot, watch};

/// Progress is written and told at most this often.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);

/// How a calculation ended.
enum Ending {
    Solved(Box<Completion>),
    Stopped,
    Failed(Failure),
}

/// Runs a job on the pool and records what becomes of it.
pub(super) async fn run(
    claim: Claim,
    recorder: &Recorder,
    solver: &Arc<dyn Solver>,
    pool: &rayon::ThreadPool,
    stop: &Arc<AtomicBool>,
) -> Result<(), StoreError> {
    let document = match job::parse(claim.input.as_bytes()) {
        Ok(document) => document,
        Err(error) => return failed(recorder, &claim.job, document_failure(error)).await,
    };
    // Stored under the version that solves now: the job may have waited through an upgrade.
    let input_hash = solver.input_hash(&document);
    let reusable = stored_completion(recorder.store(), &input_hash, solver.version()).await?;
    if let Some(completion) = reusable
        && recorder.succeed(&claim.job, &completion).await?
    {
        return Ok(());
    }
    match calculate(document, input_hash, &claim.job, recorder, solver, pool, stop).await? {
        Ending::Solved(completion) => {
            if !recorder.succeed(&claim.job, &completion).await? {
                tracing::warn!(job = %claim.job.id, attempt = claim.job.attempt, "a result came too late and was dropped");
            }
            Ok(())
        }
        Ending::Failed(failure) => failed(recorder, &claim.job, failure).await,
        Ending::Stopped => stopped(recorder, &claim.job, stop).await,
    }
}

async fn calculate(
    document: JobDocument,
    input_hash: String,
    job: &JobRecord,
    recorder: &Recorder,
    solver: &Arc<dyn Solver>,
    pool: &rayon::ThreadPool,
    stop: &Arc<AtomicBool>,
) -> Result<Ending, StoreError> {
    let (progress, mut progressed) = watch::channel((Stage::Geometry, 0.0));
    let (send, mut receive) = oneshot::channel();
    let stages = StoredStages {
        store: recorder.store().clone(),
        runtime: Handle::current(),
        solver_version: solver.version(),
        now: recorder.now(),
    };
    let (solver, stop) = (Arc::clone(solver), Arc::clone(stop));
    pool.spawn(move || {
        // A panic that leaves a closure of `spawn` would abort the process.
        let ending =
            catch_unwind(AssertUnwindSafe(|| solve(&document, input_hash, solver.as_ref(), &stages, &progress, &stop)));
        let _ = send.send(ending.unwrap_or_else(|panic| Ending::Failed(panic_failure(panic.as_ref()))));
    });
    let vanished = || Ending::Failed(internal("the calculation vanished"));
    loop {
        // The next word on progress may wait, the end may not; a short job writes none.
        tokio::select! {
            ending = &mut receive => return Ok(ending.unwrap_or_else(|_| vanished())),
            () = tokio::time::sleep(PROGRESS_EVERY) => {}
        }
        tokio::select! {
            ending = &mut receive => return Ok(ending.unwrap_or_else(|_| vanished())),
            Ok(()) = progressed.changed() => {
                let (stage, fraction) = *progressed.borrow_and_update();
                recorder.progress(job, stage.word(), fraction).await?;
            }
        }
    }
}

/// On a thread of the pool.
fn solve(
    document: &JobDocument,
    input_hash: String,
    solver: &dyn Solver,
    stages: &StoredStages,
    progress: &watch::Sender<(Stage, f64)>,
    stop: &AtomicBool,
) -> Ending {
    let started = Instant::now();
    let surroundings = Surroundings {
        stages,
        progress: &|stage, fraction| {
            progress.send_replace((stage, fraction));
        },
        canceled: &|| stop.load(Ordering::Relaxed),
        clock_ms: &|| started.elapsed().as_secs_f64() * 1e3,
    };
    let outcome = match solver.solve(document, &surroundings) {
        Ok(outcome) => outcome,
        Err(SolveError::Canceled(_)) => return Ending::Stopped,
        Err(error) => return Ending::Failed(failure_of(error)),
    };
    let packed: Result<Vec<_>, _> = outcome.series.iter().map(PackedSeries::pack).collect();
    match (serde_json::to_string(&outcome.result), packed) {
        (Ok(body), Ok(series)) => Ending::Solved(Box::new(Completion {
            body,
            input_hash,
            solver_version: solver.version().to_owned(),
            series,
            reused_from: None,
        })),
        (Err(error), _) => Ending::Failed(internal(&error.to_string())),
        (_, Err(error)) => Ending::Failed(internal(&error.to_string())),
    }
}

async fn stopped(recorder: &Recorder, job: &JobRecord, stop: &AtomicBool) -> Result<(), StoreError> {
    if !stop.load(Ordering::Relaxed) {
        return failed(recorder, job, internal("the calculation stopped although nobody asked")).await;
    }
    if let Some(State::Queued) = recorder.release(job).await? {
        tracing::info!(job = %job.id, "job stopped for the shutdown; it runs again after the restart");
    }
    Ok(())
}

async fn failed(recorder: &Recorder, job: &JobRecord, failure: Failure) -> Result<(), StoreError> {
    let request_id = job.request_id.as_deref().unwrap_or_default();
    tracing::warn!(job = %job.id, request_id, code = failure.code, detail = failure.detail, "job failed");
    recorder.fail(job, &public(failure)).await?;
    Ok(())
}

/// Details of internal failures stay in the log.
fn public(failure: Failure) -> Failure {
    if failure.code == "internal" {
        Failure::new("internal", "The calculation failed for a reason that lies in the service; it was logged.")
    } else {
        failure
    }
}

fn internal(detail: &str) -> Failure {
    Failure::new("internal", detail)
}

fn panic_failure(panic: &(dyn std::any::Any + Send)) -> Failure {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
    internal(&format!("panic: {}", text.unwrap_or_default()))
}

fn document_failure(error: DocumentError) -> Failure {
    let detail = error.to_string();
    match error {
        DocumentError::Malformed { .. } => internal(&format!("stored document: {detail}")),
        DocumentError::Invalid(errors) => Failure { errors, ..Failure::new("invalid-design", detail) },
        DocumentError::Unsupported(errors) => Failure { errors, ..Failure::new("unsupported-design", detail) },
    }
}

fn failure_of(error: SolveError) -> Failure {
    match error {
        SolveError::Document(error) => document_failure(error),
        SolveError::Failed { stage, code, detail, sim_time_s, step } => {
            Failure { stage: Some(stage.word().to_owned()), sim_time_s, step, ..Failure::new(&code, detail) }
        }
        SolveError::Canceled(_) => internal("canceled"),
    }
}
