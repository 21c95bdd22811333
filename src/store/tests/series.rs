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

#[tokio::test]
async fn samples_come_back_bit_for_bit() {
    let Fixture { store, .. } = &fixture().await;
    let values = vec![1.0, -0.0, f64::MIN_POSITIVE, 1e308, f64::NAN, -3.25];
    let job = running(store, "a").await;
    let packed = PackedSeries::pack(&channel(values.clone())).unwrap();
    let completed = Completion { series: vec![packed], ..completion("a") };
    store.succeed(job.id, 1, &completed, at(2)).await.unwrap().unwrap();
    let entry = store.series_catalogue(job.id).await.unwrap().remove(0);
    assert_eq!((entry.n, entry.min, entry.max, entry.rms), (6, Some(-3.25), Some(1e308), Some(2.0)));
    let back = store.series(job.id, "a_x_left").await.unwrap().unwrap().unpack().unwrap();
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back), bits(&values));
    assert!(store.series(job.id, "other").await.unwrap().is_none());
}

#[tokio::test]
async fn a_reused_job_has_the_series_too() {
    let Fixture { store, .. } = &fixture().await;
    let source = running(store, "a").await;
    let completed = Completion { series: vec![PackedSeries::pack(&channel(vec![1.0])).unwrap()], ..completion("a") };
    store.succeed(source.id, 1, &completed, at(2)).await.unwrap().unwrap();
    let copy = running(store, "a").await;
    let reuse = Completion { reused_from: Some(source.id), ..completion("a") };
    store.succeed(copy.id, 1, &reuse, at(3)).await.unwrap().unwrap();
    store.delete(source.id).await.unwrap();
    assert_eq!(store.series(copy.id, "a_x_left").await.unwrap().unwrap().unpack().unwrap(), [1.0]);
}
