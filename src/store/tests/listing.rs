use super::super::connect::MIGRATIONS;
use super::*;
use sqlx::Row;
use sqlx::migrate::Migrator;

const NEWEST_FIRST: JobOrder = JobOrder { sort: JobSort::Submitted, descending: true };

/// All jobs of a list, read in pages of `limit`.
async fn pages(store: &Store, filter: &JobFilter, order: JobOrder, limit: u32) -> Vec<JobRecord> {
    let (mut seen, mut after) = (Vec::new(), None);
    loop {
        let page = store.list(filter, order, after.as_ref(), limit).await.unwrap();
        assert!(page.jobs.len() <= limit as usize);
        seen.extend(page.jobs);
        after = page.next;
        if after.is_none() {
            return seen;
        }
    }
}

async fn ids(store: &Store, filter: JobFilter) -> Vec<JobId> {
    let jobs = pages(store, &filter, NEWEST_FIRST, 10).await;
    assert_eq!(store.count(&filter).await.unwrap(), jobs.len() as u64, "{filter:?}");
    jobs.into_iter().map(|job| job.id).collect()
}

/// A job that succeeded with this result.
async fn with_result(store: &Store, name: Option<&str>, body: &str) -> JobRecord {
    let id = store.next_id();
    let job = NewJob { id, name: name.map(str::to_owned), ..new_job(body) };
    let completion = Completion { body: body.to_owned(), ..completion(body) };
    store.submit(job, None, 100, at(0)).await.unwrap();
    store.claim_next(WorkClass::Single, at(1)).await.unwrap().unwrap();
    store.succeed(id, 1, &completion, at(2)).await.unwrap().unwrap()
}

fn body(left: Option<f64>, right: Option<f64>, transmission_error: f64) -> String {
    serde_json::json!({
        "mesh": {"transmission_error_pp_um": transmission_error, "other": [1]},
        "response": {"dynamic_factor": null, "rms": {
            "channels": {}, "mesh_circumferential_acceleration_m_s2": {"left": left, "right": right},
        }},
    })
    .to_string()
}

#[tokio::test]
async fn newest_first_in_pages_without_gaps_or_repeats() {
    let Fixture { store, .. } = &fixture().await;
    let mut expected = Vec::new();
    for index in 0..7 {
        expected.push(queued(store, &index.to_string()).await.id);
    }
    expected.reverse();
    let seen: Vec<_> = pages(store, &JobFilter::default(), NEWEST_FIRST, 3).await.iter().map(|job| job.id).collect();
    assert_eq!(seen, expected);
}

#[tokio::test]
async fn filters() {
    let Fixture { store, .. } = &fixture().await;
    let labeled = NewJob { label: Some("x".into()), kind: "mesh", ..new_job("a") };
    let id = labeled.id;
    store.submit(labeled, None, 10, at(0)).await.unwrap();
    queued(store, "b").await;
    store.claim_next(WorkClass::Single, at(1)).await.unwrap().unwrap();
    let ids = async |filter: JobFilter| ids(store, filter).await;
    let states = |states: &[JobState]| JobFilter { states: states.to_vec(), ..JobFilter::default() };
    assert_eq!(ids(states(&[JobState::Running])).await, [id]);
    let all = ids(JobFilter::default()).await;
    assert_eq!(ids(states(&[JobState::Running, JobState::Queued, JobState::Running])).await, all);
    assert_eq!(ids(JobFilter { kind: Some("mesh".into()), ..JobFilter::default() }).await, [id]);
    assert_eq!(ids(JobFilter { label: Some("x".into()), ..JobFilter::default() }).await, [id]);
    assert!(ids(JobFilter { label: Some("' OR 1=1".into()), ..JobFilter::default() }).await.is_empty());
}

#[tokio::test]
async fn a_search_finds_parts_of_name_label_and_notes_in_any_case() {
    let Fixture { store, .. } = &fixture().await;
    let mut named = Vec::new();
    for name in ["Ölpumpe Ritzel 17", "ΣΟΦΟΣ [draft] 50 % *", "a-b?c"] {
        let id = store.next_id();
        store.submit(NewJob { id, name: Some(name.into()), ..new_job(name) }, None, 10, at(0)).await.unwrap();
        named.push(id);
    }
    let other = store.next_id();
    store
        .submit(NewJob { id: other, name: None, label: Some("Ritz-Carlton".into()), ..new_job("d") }, None, 10, at(0))
        .await
        .unwrap();
    let description =
        JobDescription { notes: Some(Some("first line\nwith ÄÖÜ".into())), ..JobDescription::default() };
    assert!(matches!(store.describe(named[2], &description).await.unwrap(), Described::Changed(_)));
    for (search, expected) in [
        ("ritz", vec![other, named[0]]),
        ("RITZEL 1", vec![named[0]]),
        ("ÖLPUMPE", vec![named[0]]),
        ("ölpumpe", vec![named[0]]),
        ("σοφος", vec![named[1]]),
        ("[DRAFT]", vec![named[1]]),
        ("50 %", vec![named[1]]),
        ("*", vec![named[1]]),
        ("?", vec![named[2]]),
        ("A-B", vec![named[2]]),
        ("line\nwith äöü", vec![named[2]]),
        ("_", vec![]),
        ("%' OR '1", vec![]),
    ] {
        let filter = JobFilter { search: Some(search.into()), ..JobFilter::default() };
        assert_eq!(ids(store, filter.clone()).await, expected, "{search}");
        let elsewhere = JobFilter { kind: Some("sweep".into()), states: vec![JobState::Failed], ..filter };
        assert!(ids(store, elsewhere).await.is_empty(), "{search}");
    }
}

#[tokio::test]
async fn the_time_of_submission_is_filtered() {
    let Fixture { store, .. } = &fixture().await;
    let mut all = Vec::new();
    for seconds in [10, 20, 30] {
        let id = store.next_id();
        store.submit(NewJob { id, ..new_job(&seconds.to_string()) }, None, 10, at(seconds)).await.unwrap();
        all.push(id);
    }
    let between =
        |from: Option<i64>, to: Option<i64>| JobFilter { from: from.map(at), to: to.map(at), ..JobFilter::default() };
    assert_eq!(ids(store, between(Some(20), None)).await, [all[2], all[1]]);
    assert_eq!(ids(store, between(None, Some(20))).await, [all[0]]);
    assert_eq!(ids(store, between(Some(20), Some(30))).await, [all[1]]);
}

#[tokio::test]
async fn every_order_pages_without_gaps_or_repeats_and_ends_with_those_without_a_value() {
    let Fixture { store, .. } = &fixture().await;
    for (index, name) in [Some("b"), None, Some("A"), Some("a"), Some("C"), None, Some("b")].into_iter().enumerate() {
        // Equal numbers, and none, occur too.
        let rms = [Some(3.0), None, Some(1.5), Some(3.0), None, Some(0.5), Some(2.0)][index];
        with_result(store, name, &body(rms, rms.map(|rms| rms / 2.0), index as f64)).await;
    }
    queued(store, "live").await;
    let count = store.count(&JobFilter::default()).await.unwrap() as usize;
    let sorts = [
        JobSort::Submitted,
        JobSort::Ended,
        JobSort::Name,
        JobSort::Label,
        JobSort::MeshAcceleration,
        JobSort::DynamicFactor,
        JobSort::TransmissionError,
    ];
    for order in sorts.into_iter().flat_map(|sort| [false, true].map(|descending| JobOrder { sort, descending })) {
        let whole = pages(store, &JobFilter::default(), order, 100).await;
        assert_eq!(whole.len(), count);
        for limit in [1, 2, 3] {
            assert_eq!(pages(store, &JobFilter::default(), order, limit).await, whole, "{order:?}, {limit}");
        }
    }
    let order = JobOrder { sort: JobSort::MeshAcceleration, descending: true };
    let numbers = async |order| -> Vec<_> {
        let jobs = pages(store, &JobFilter::default(), order, 2).await;
        jobs.iter().map(|job| job.headline.mesh_acceleration_rms_m_s2).collect()
    };
    let expected = [Some(3.0), Some(3.0), Some(2.0), Some(1.5), Some(0.5), None, None, None];
    assert_eq!(numbers(order).await, expected);
    let ascending = [Some(0.5), Some(1.5), Some(2.0), Some(3.0), Some(3.0), None, None, None];
    assert_eq!(numbers(JobOrder { descending: false, ..order }).await, ascending);
    let order = JobOrder { sort: JobSort::Name, descending: false };
    let names: Vec<_> = pages(store, &JobFilter::default(), order, 2)
        .await
        .into_iter()
        .map(|job| job.name.unwrap_or_default())
        .collect();
    assert_eq!(names, ["A", "a", "b", "b", "C", "name", "", ""]);
}

#[tokio::test]
async fn a_description_changes_nothing_else() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let input = store.input(job.id).await.unwrap();
    let description = JobDescription { name: Some(None), label: Some(Some("l".into())), notes: Some(Some("n".into())) };
    let Described::Changed(changed) = store.describe(job.id, &description).await.unwrap() else { panic!("no change") };
    let expected = JobRecord {
        name: None,
        label: Some("l".into()),
        notes: Some("n".into()),
        revision: job.revision + 1,
        ..job.clone()
    };
    assert_eq!(changed, expected);
    for same in [description, JobDescription::default()] {
        assert_eq!(store.describe(job.id, &same).await.unwrap(), Described::Unchanged(expected.clone()));
    }
    assert_eq!(store.input(job.id).await.unwrap(), input);
    // The run is not disturbed.
    let done = store.succeed(job.id, job.attempt, &completion("a"), at(9)).await.unwrap().expect("it still runs");
    assert_eq!((done.notes.as_deref(), done.name), (Some("n"), None));
    let nothing = store.describe(JobId::new(), &JobDescription::default()).await.unwrap();
    assert_eq!(nothing, Described::NotFound);
}

/// The numbers of results that were stored before jobs had them are those that a job gets today.
#[tokio::test]
async fn an_upgrade_takes_the_headline_numbers_out_of_stored_results() {
    let directory = tempfile::tempdir().unwrap();
    let config = StoreConfig::at(directory.path().join("jobs.db"));
    let before = MIGRATIONS.iter().filter(|step| step.version < 7).cloned().collect();
    let store = Store::open_with(&config, &Migrator::with_migrations(before)).await.unwrap();
    let bodies =
        [body(Some(1.5), Some(2.5), 0.25), body(Some(4.0), None, 1.0), "{\"sweep\":{\"points\":[]}}".to_owned()];
    let mut old = Vec::new();
    for body in &bodies {
        let id = insert_succeeded(&store, body).await;
        let insert =
            "INSERT INTO results (job_id, body, etag, input_hash, solver_version) VALUES ($1, $2, 'tag', $2, 'test-1')";
        sqlx::query(insert).bind(id.to_string()).bind(body).execute(&store.writer).await.unwrap();
        old.push(id);
    }
    store.close().await;
    drop(store);
    let store = Store::open(&config).await.unwrap();
    for (id, body) in old.into_iter().zip(&bodies) {
        let today = with_result(&store, None, body).await.headline;
        assert_eq!(store.job(id).await.unwrap().unwrap().headline, today, "{body}");
    }
    let order = JobOrder { sort: JobSort::MeshAcceleration, descending: true };
    let page = store.list(&JobFilter::default(), order, None, 1).await.unwrap();
    assert_eq!(page.jobs[0].headline.mesh_acceleration_rms_m_s2, Some(4.0));
}

/// Pages and counts read indexes, not the rows, which contain the documents.
#[tokio::test]
async fn lists_are_read_from_an_index() {
    let Fixture { store, .. } = &fixture().await;
    for (statement, index) in [
        (
            "SELECT id FROM jobs INDEXED BY jobs_listing WHERE name GLOB '*a*' ORDER BY name COLLATE NOCASE, id",
            "jobs_listing",
        ),
        (
            "SELECT COUNT(*) FROM jobs INDEXED BY jobs_listing WHERE state IN ('failed') AND submitted_at_us >= 0",
            "jobs_listing",
        ),
        ("SELECT id FROM jobs WHERE notes IS NOT NULL AND notes GLOB '*a*'", "jobs_with_notes"),
    ] {
        let plan = sqlx::query(sqlx::AssertSqlSafe(format!("EXPLAIN QUERY PLAN {statement}")));
        let rows = plan.fetch_all(&store.reader).await.unwrap();
        let steps: Vec<String> = rows.iter().map(|row| row.try_get("detail").unwrap()).collect();
        assert!(steps[0].contains(&format!("USING COVERING INDEX {index}")), "{steps:?}");
    }
}
