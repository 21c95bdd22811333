//! The database alone: time of a commit, and growth of the times of claims, lists and submissions with the number of
//! queued jobs.

use crate::documents;
use crate::times::Times;
use herringbone::store::{
    JobFilter, JobId, JobOrder, JobSort, JobState, ListPlace, NewJob, SortValue, Store, StoreConfig, Submission,
    WorkClass,
};
use herringbone_tools::Failure;
use jiff::Timestamp;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqliteSynchronous};
use sqlx::{ConnectOptions, Connection, SqliteConnection};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

pub(crate) const MANY: u32 = 100_000;
const CAPACITY: u32 = 1_000_000;

#[tokio::main]
pub(crate) async fn commits() -> Result<(), Failure> {
    println!("| submission at the store, one after the other | per second | median / longest |\n|---|---|---|");
    let directory = tempfile::tempdir_in(".")?;
    let database = directory.path().join("store.db");
    let store = Store::open(&StoreConfig::at(&database)).await?;
    let mut times = Times::of(500, async || submit(&store).await).await;
    store.close().await;
    println!("| `Store::submit` (synchronous FULL) | {:.0} | {} |", 1e3 / times.mean_ms(), times.told());
    for level in [SqliteSynchronous::Full, SqliteSynchronous::Normal, SqliteSynchronous::Off] {
        let name = format!("{level:?}").to_uppercase();
        let options = SqliteConnectOptions::new().filename(&database).journal_mode(SqliteJournalMode::Wal);
        let mut connection = options.synchronous(level).busy_timeout(Duration::from_secs(5)).connect().await?;
        let mut times = Times::default();
        for _ in 0..500 {
            let began = Instant::now();
            insert(&mut connection).await?;
            times.add(began.elapsed());
        }
        connection.close().await?;
        println!("| the same rows, synchronous {name} | {:.0} | {} |", 1e3 / times.mean_ms(), times.told());
    }
    Ok(())
}

/// The two rows of a submission, without the checks of `Store::submit`.
async fn insert(connection: &mut SqliteConnection) -> Result<(), sqlx::Error> {
    let job = new_job();
    let mut transaction = connection.begin_with("BEGIN IMMEDIATE").await?;
    sqlx::query(
        "INSERT INTO jobs (id, kind, state, revision, attempt, input, input_hash, solver_version, submitted_at_us) \
         VALUES ($1, $2, 'queued', 1, 0, $3, $4, $5, 0)",
    )
    .bind(job.id.to_string())
    .bind(job.kind)
    .bind(job.input)
    .bind(job.input_hash)
    .bind(job.solver_version)
    .execute(&mut *transaction)
    .await?;
    sqlx::query("INSERT INTO job_events (job_id, revision, at_us, state, attempt) VALUES ($1, 1, 0, 'queued', 0)")
        .bind(job.id.to_string())
        .execute(&mut *transaction)
        .await?;
    transaction.commit().await
}

/// Every hundredth is a sweep, every fiftieth has a rare label.
fn new_job() -> NewJob {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let n = COUNT.fetch_add(1, Ordering::Relaxed);
    let document = if n % 100 == 99 { documents::sweep(2) } else { documents::response() };
    NewJob {
        id: JobId::new(),
        kind: if n % 100 == 99 { "sweep" } else { "response" },
        name: None,
        label: Some(if n % 50 == 49 { "rare" } else { "usual" }.to_owned()),
        input: document.to_string(),
        input_hash: format!("{n:064x}"),
        solver_version: "load",
        request_id: Some(JobId::new().to_string()),
        traceparent: None,
        idempotency: None,
    }
}

async fn submit(store: &Store) {
    let submission = store.submit(new_job(), None, CAPACITY, Timestamp::now()).await;
    assert!(matches!(submission, Ok(Submission::Accepted(_))), "{submission:?}");
}

/// Writes so many jobs that wait; in memory, where a commit costs no wait, and then as a file at the path.
pub(crate) async fn fill(database: &Path, jobs: u32) -> Result<Duration, Failure> {
    let fast = tempfile::tempdir_in("/dev/shm")?;
    let file = fast.path().join("fill.db");
    let store = Store::open(&StoreConfig::at(&file)).await?;
    let began = Instant::now();
    for _ in 0..jobs {
        submit(&store).await;
    }
    let took = began.elapsed();
    store.close().await;
    std::fs::copy(&file, database)?;
    Ok(took)
}

#[tokio::main]
pub(crate) async fn many_jobs() -> Result<(), Failure> {
    println!("| with so many jobs waiting (median / longest of 50) | 100 | 100 000 |\n|---|---|---|");
    let directory = tempfile::tempdir_in(".")?;
    let mut columns = Vec::new();
    for jobs in [100, MANY] {
        let database = directory.path().join(format!("{jobs}.db"));
        fill(&database, jobs).await?;
        let store = Store::open(&StoreConfig::at(&database)).await?;
        columns.push(rows(&store).await?);
        store.close().await;
    }
    for (few, many) in columns[0].iter().zip(&columns[1]) {
        println!("| {} | {} | {} |", few.0, few.1, many.1);
    }
    Ok(())
}

async fn rows(store: &Store) -> Result<Vec<(&'static str, String)>, Failure> {
    let mut rows = Vec::new();
    let everything = JobFilter::default();
    let states = |states: &[JobState]| JobFilter { states: states.to_vec(), ..JobFilter::default() };
    let live = states(&[JobState::Queued, JobState::Running]);
    let kind = JobFilter { kind: Some("sweep".to_owned()), ..JobFilter::default() };
    let usual = JobFilter { label: Some("usual".to_owned()), ..JobFilter::default() };
    let rare = JobFilter { label: Some("rare".to_owned()), ..JobFilter::default() };
    let several = JobFilter { label: Some("usual".to_owned()), kind: Some("response".to_owned()), ..live.clone() };
    let search = |text: &str| JobFilter { search: Some(text.to_owned()), ..JobFilter::default() };
    let newest_first = JobOrder::default();
    let by_name = JobOrder { sort: JobSort::Name, descending: false };
    let oldest = oldest(store).await?;
    for (name, filter, order, after) in [
        ("page of the list, first", &everything, newest_first, None),
        ("… the last, by its cursor", &everything, newest_first, Some(&oldest)),
        ("… of a state", &states(&[JobState::Queued]), newest_first, None),
        ("… of a state that no job has", &states(&[JobState::Failed]), newest_first, None),
        ("… of two states", &live, newest_first, None),
        ("… of a kind (1 of 100)", &kind, newest_first, None),
        ("… of a label (1 of 50)", &rare, newest_first, None),
        ("… of a label (49 of 50), last page", &usual, newest_first, Some(&oldest)),
        ("… of states, kind and label", &several, newest_first, None),
        ("… sorted by name", &everything, by_name, None),
        ("… searched for what many have", &search("USUAL"), newest_first, None),
        ("… searched for what none has", &search("nothing"), newest_first, None),
    ] {
        let mut times = Times::of(50, async || assert!(store.list(filter, order, after, 50).await.is_ok())).await;
        rows.push((name, times.told()));
    }
    for (name, filter) in [("jobs counted", &everything), ("jobs counted, by a search", &search("nothing"))] {
        rows.push((name, Times::of(50, async || assert!(store.count(filter).await.is_ok())).await.told()));
    }
    let mut counts = Times::of(50, async || assert!(store.counts().await.is_ok())).await;
    rows.push(("jobs counted by state (`/metrics`)", counts.told()));
    rows.push(("submission", Times::of(50, async || submit(store).await).await.told()));
    for (name, class) in [("claim of a single job", WorkClass::Single), ("claim of a sweep", WorkClass::Sweep)] {
        let mut times = Times::default();
        for _ in 0..50 {
            let began = Instant::now();
            if store.claim_next(class, Timestamp::now()).await?.is_some() {
                times.add(began.elapsed());
            }
        }
        rows.push((name, times.told()));
    }
    Ok(rows)
}

/// The place of the fiftieth job from the end of the list.
async fn oldest(store: &Store) -> Result<ListPlace, Failure> {
    let order = JobOrder { descending: false, ..JobOrder::default() };
    let page = store.list(&JobFilter::default(), order, None, 51).await?;
    let id = page.jobs.last().map_or_else(JobId::new, |job| job.id);
    Ok(ListPlace { id, value: SortValue::None })
}
