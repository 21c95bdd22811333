use super::*;

#[tokio::test]
async fn newest_first_in_pages_without_gaps_or_repeats() {
    let Fixture { store, .. } = &fixture().await;
    let mut ids = Vec::new();
    for index in 0..7 {
        ids.push(queued(store, &index.to_string()).await.id);
    }
    ids.reverse();
    let mut seen = Vec::new();
    let mut before = None;
    loop {
        let page = store.list(&JobFilter::default(), before, 3).await.unwrap();
        seen.extend(page.jobs.iter().map(|job| job.id));
        before = page.jobs.last().map(|job| job.id);
        if !page.more {
            break;
        }
    }
    assert_eq!(seen, ids);
}

#[tokio::test]
async fn filters() {
    let Fixture { store, .. } = &fixture().await;
    let labeled = NewJob { label: Some("x".into()), kind: "mesh", ..new_job("a") };
    let id = labeled.id;
    store.submit(labeled, None, 10, at(0)).await.unwrap();
    queued(store, "b").await;
    store.claim_next(WorkClass::Single, at(1)).await.unwrap().unwrap();
    let ids = async |filter: JobFilter| -> Vec<JobId> {
        store.list(&filter, None, 10).await.unwrap().jobs.into_iter().map(|job| job.id).collect()
    };
    let states = |states: &[JobState]| JobFilter { states: states.to_vec(), ..JobFilter::default() };
    assert_eq!(ids(states(&[JobState::Running])).await, [id]);
    let all = ids(JobFilter::default()).await;
    assert_eq!(ids(states(&[JobState::Running, JobState::Queued, JobState::Running])).await, all);
    assert_eq!(ids(JobFilter { kind: Some("mesh".into()), ..JobFilter::default() }).await, [id]);
    assert_eq!(ids(JobFilter { label: Some("x".into()), ..JobFilter::default() }).await, [id]);
    assert!(ids(JobFilter { label: Some("' OR 1=1".into()), ..JobFilter::default() }).await.is_empty());
}
