use super::*;
use proptest::prelude::*;
use std::time::Duration;

#[derive(Debug, Clone, Copy)]
enum Step {
    Claim,
    Progress(i64),
    Succeed(i64),
    Fail(i64),
    Release(i64),
    Cancel,
    Recover,
}

fn step() -> impl Strategy<Value = Step> {
    prop_oneof![
        3 => Just(Step::Claim),
        1 => (1..4i64).prop_map(Step::Progress),
        1 => (1..4i64).prop_map(Step::Succeed),
        1 => (1..4i64).prop_map(Step::Fail),
        2 => (1..4i64).prop_map(Step::Release),
        1 => Just(Step::Cancel),
        1 => Just(Step::Recover),
    ]
}

async fn apply(store: &Store, id: JobId, step: Step) {
    let failure = Failure::new("diverged", "");
    match step {
        Step::Claim => drop(store.claim_next(WorkClass::Single, at(1)).await.unwrap()),
        Step::Progress(attempt) => {
            drop(store.progress(id, attempt, "mesh", 0.5, &PointBatch::default()).await.unwrap());
        }
        Step::Succeed(attempt) => drop(store.succeed(id, attempt, &completion("a"), at(1)).await.unwrap()),
        Step::Fail(attempt) => drop(store.fail(id, attempt, &failure, at(1)).await.unwrap()),
        Step::Release(attempt) => {
            drop(store.release(id, attempt, ReleaseReason::Shutdown, Duration::ZERO, at(1)).await.unwrap());
        }
        Step::Cancel => drop(store.cancel(id, at(1)).await.unwrap()),
        Step::Recover => drop(store.recover(3, false, at(1)).await.unwrap()),
    }
}

fn is_permitted(from: JobState, to: JobState) -> bool {
    use JobState::*;
    matches!((from, to), (Queued, Running | Canceled) | (Running, Succeeded | Failed | Canceled | Queued))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Random operations in random order cause permitted transitions only, and the stored data match the state.
    #[test]
    fn only_permitted_transitions(steps in prop::collection::vec(step(), 1..12)) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let Fixture { store, directory: _directory } = &fixture().await;
            let id = queued(store, "a").await.id;
            for step in steps {
                apply(store, id, step).await;
            }
            let job = store.job(id).await.unwrap().unwrap();
            let history = store.history(id).await.unwrap();
            assert_eq!(history[0], (1, JobState::Queued));
            assert!(history.windows(2).all(|pair| is_permitted(pair[0].1, pair[1].1)), "{history:?}");
            assert_eq!(history.last().unwrap().1, job.state);
            assert!(history.last().unwrap().0 <= job.revision);
            assert_eq!(store.result(id).await.unwrap().is_some(), job.state == JobState::Succeeded);
            assert_eq!(job.error.is_some(), job.state == JobState::Failed);
        });
    }
}
