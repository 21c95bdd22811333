use super::*;
use herringbone_job::study::RecordedChannel;

fn channel(values: Vec<f64>) -> RecordedChannel {
    RecordedChannel {
        name: "a_x_left".into(),
        quantity: "acceleration".into(),
        unit: "m/s2".into(),
        t0_s: 0.5,
        dt_s: 1e-5,
        rms: 2.0,
        values,
    }
}

fn packed(values: Vec<f64>) -> PackedSeries {
    PackedSeries::pack(&channel(values), &|| false).expect("packs").expect("not stopped")
}

/// The completion with these channels, all of whose samples it holds.
fn with_series(series: Vec<PackedSeries>, hash: &str) -> Completion {
    let (series, mut batches) = SampleBatch::split(series);
    assert_eq!(batches.len(), 1, "few samples");
    Completion { series, samples: batches.remove(0), ..completion(hash) }
}

/// Samples that do not compress.
fn noise(n: u64) -> Vec<f64> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from_bits(state >> 12 | 0x3ff0_0000_0000_0000)
    };
    (0..n).map(|_| next()).collect()
}

async fn number(store: &Store, sql: &'static str) -> i64 {
    sqlx::query_as::<_, (i64,)>(sql).fetch_one(&store.reader).await.expect("answers").0
}

const SAMPLES: &str = "SELECT COUNT(*) FROM series_samples";
const DATASETS: &str = "SELECT COUNT(*) FROM datasets";

#[tokio::test]
async fn samples_come_back_bit_for_bit() {
    let Fixture { store, .. } = &fixture().await;
    let values = vec![1.0, -0.0, f64::MIN_POSITIVE, 1e308, f64::NAN, -3.25];
    let job = running(store, "a").await;
    let completed = with_series(vec![packed(values.clone())], "a");
    store.succeed(job.id, 1, &completed, at(2)).await.unwrap().unwrap();
    let entry = store.series_catalogue(job.id).await.unwrap().remove(0);
    assert_eq!((entry.n, entry.min, entry.max, entry.rms), (6, Some(-3.25), Some(1e308), Some(2.0)));
    let back = store.series(job.id, "a_x_left").await.unwrap().unwrap().unpack().unwrap();
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back), bits(&values));
    assert!(store.series(job.id, "other").await.unwrap().is_none());
}

#[tokio::test]
async fn a_channel_without_samples_is_stored() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    store.succeed(job.id, 1, &with_series(vec![packed(Vec::new())], "a"), at(2)).await.unwrap().unwrap();
    assert_eq!(store.series(job.id, "a_x_left").await.unwrap().unwrap().unpack().unwrap(), [0.0; 0]);
}

#[test]
fn packing_stops_between_two_parts() {
    let left = std::cell::Cell::new(2);
    let is_stopped = || left.replace(left.get() - 1) == 0;
    let long = channel(vec![1.5; 1_000_000]);
    assert_eq!(PackedSeries::pack(&long, &is_stopped).unwrap(), None);
    assert_eq!(left.get(), -1, "asked before each of the first three parts");
}

/// A reused result takes no room, and stays whole whichever of the jobs is deleted first.
#[tokio::test]
async fn jobs_share_what_one_of_them_recorded() {
    for deleted_first in ["source", "copy"] {
        let Fixture { store, .. } = &fixture().await;
        let source = running(store, "a").await;
        let values = noise(100_000);
        let completed = with_series(vec![packed(values.clone())], "a");
        store.succeed(source.id, 1, &completed, at(2)).await.unwrap().unwrap();
        let before = store.usage().await.unwrap().used_bytes;
        let reuse = Completion { reused_from: Some(source.id), ..completion("a") };
        let mut copies = Vec::new();
        for _ in 0..3 {
            match store.submit(new_job("a"), Some(reuse.clone()), 0, at(3)).await.unwrap() {
                Submission::Accepted(job) => copies.push(job.id),
                other => panic!("{other:?}"),
            }
        }
        let after = store.usage().await.unwrap().used_bytes;
        assert!(before > 600_000 && after - before < 100_000, "{before} bytes, then {after}");
        // One that reuses a reused result, claimed from the queue.
        let last = running(store, "a").await;
        let reuse = Completion { reused_from: Some(copies[0]), ..completion("a") };
        store.succeed(last.id, 1, &reuse, at(4)).await.unwrap().unwrap();
        copies.push(last.id);
        let all =
            if deleted_first == "source" { [vec![source.id], copies] } else { [copies, vec![source.id]] }.concat();
        for (index, id) in all.iter().enumerate() {
            for left in &all[index..] {
                let series = store.series(*left, "a_x_left").await.unwrap().expect("whole");
                assert!(series.unpack().unwrap() == values, "{deleted_first}, {index} deleted");
                assert_eq!(store.series_catalogue(*left).await.unwrap().len(), 1);
            }
            assert_eq!(store.delete(*id).await.unwrap(), Deletion::Deleted);
        }
        assert_eq!((number(store, SAMPLES).await, number(store, DATASETS).await), (0, 0));
    }
}

fn rows(n: u64) -> PointBatch {
    let row = |position| PointRow { position, body: format!("{{\"x\":{position}}}") };
    PointBatch { solver_version: "test-1".into(), rows: (0..n).map(row).collect(), ..PointBatch::default() }
}

#[tokio::test]
async fn jobs_share_the_rows_of_a_sweep_also_with_rows_of_their_own() {
    let Fixture { store, .. } = &fixture().await;
    let sweep = |hash: &str| NewJob { kind: "sweep", ..new_job(hash) };
    let claim = async || {
        store.submit(sweep("a"), None, 10, at(0)).await.unwrap();
        store.claim_next(WorkClass::Sweep, at(1)).await.unwrap().unwrap().job
    };
    let (source, twin) = (claim().await, claim().await);
    // Both ran; the twin was at its second row when the other had all.
    store.progress(twin.id, 1, "response", 0.1, &rows(2)).await.unwrap().unwrap();
    let summary = Some(RowsSummary { count: 5, digest: "digest".into() });
    let completed = Completion { unwritten: rows(5), rows: summary.clone(), ..completion("a") };
    store.succeed(source.id, 1, &completed, at(2)).await.unwrap().unwrap();
    assert_eq!(number(store, "SELECT COUNT(*) FROM sweep_points").await, 7);
    let reuse = Completion { reused_from: Some(source.id), rows: summary, ..completion("a") };
    store.succeed(twin.id, 1, &reuse, at(3)).await.unwrap().unwrap();
    assert_eq!(number(store, "SELECT COUNT(*) FROM sweep_points").await, 5);
    store.delete(source.id).await.unwrap();
    assert_eq!(store.points(twin.id, 0, 9, 9).await.unwrap(), rows(5).rows);
    assert_eq!(store.point_count(twin.id).await.unwrap(), 5);
    assert_eq!(store.delete_ended_before(at(1000), 9).await.unwrap(), 1);
    assert_eq!(number(store, "SELECT COUNT(*) FROM sweep_points").await, 0);
}

/// Samples that are stored before the result do not count without it, and are gone when the job ends otherwise.
#[tokio::test]
async fn samples_of_a_job_that_does_not_succeed_are_deleted() {
    let Fixture { store, directory } = fixture().await;
    let (entries, batches) = SampleBatch::split(vec![packed(noise(1_000_000)), packed(vec![1.0])]);
    assert!(batches.len() > 3 && entries.len() == 2, "{} batches", batches.len());
    let ends = ["is canceled", "fails", "is released", "is lost"];
    for end in ends {
        let job = running(&store, end).await;
        for batch in &batches[..2] {
            assert!(store.save_samples(job.id, 1, batch).await.unwrap());
            assert!(store.save_samples(job.id, 1, batch).await.unwrap(), "written again after an unknown outcome");
        }
        assert!(!store.save_samples(job.id, 2, &batches[2]).await.unwrap(), "another attempt");
        assert!(number(&store, SAMPLES).await > 1);
        assert!(store.series_catalogue(job.id).await.unwrap().is_empty());
        assert!(store.series(job.id, "a_x_left").await.unwrap().is_none());
        let release = async || {
            store.release(job.id, 1, ReleaseReason::Shutdown, std::time::Duration::ZERO, at(2)).await.unwrap().unwrap()
        };
        match end {
            "is canceled" => {
                store.cancel(job.id, at(2)).await.unwrap();
                assert!(!store.save_samples(job.id, 1, &batches[2]).await.unwrap(), "it is to be canceled");
                assert!(store.succeed(job.id, 1, &completion(end), at(2)).await.unwrap().is_none());
                assert_eq!(release().await.state, JobState::Canceled);
            }
            "fails" => drop(store.fail(job.id, 1, &Failure::new("diverged", ""), at(2)).await.unwrap().unwrap()),
            "is released" => {
                release().await;
                store.cancel(job.id, at(3)).await.unwrap();
            }
            _ => break,
        }
        assert_eq!(number(&store, SAMPLES).await, 0, "{end}");
    }
    assert!(number(&store, SAMPLES).await > 0, "the process dies between two batches");
    let path = directory.path().join("jobs.db");
    store.close().await;
    drop(store);
    let store = Store::open(&StoreConfig::at(&path)).await.unwrap();
    assert_eq!(store.recover(3, false, at(5)).await.unwrap().requeued, 1);
    assert_eq!(number(&store, SAMPLES).await, 0);
    // The next attempt stores all of it.
    let again = store.claim_next(WorkClass::Single, at(6)).await.unwrap().unwrap().job;
    let (last, first) = batches.split_last().unwrap();
    for batch in first {
        assert!(store.save_samples(again.id, 2, batch).await.unwrap());
    }
    let mut entries = entries;
    entries[1].channel = "other".into();
    let completed = Completion { series: entries, samples: last.clone(), ..completion("is lost") };
    store.succeed(again.id, 2, &completed, at(7)).await.unwrap().unwrap();
    assert!(store.series(again.id, "a_x_left").await.unwrap().unwrap().unpack().unwrap() == noise(1_000_000));
    assert_eq!(store.series(again.id, "other").await.unwrap().unwrap().unpack().unwrap(), [1.0]);
}
