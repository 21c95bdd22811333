use super::*;

#[tokio::test]
async fn the_oldest_stages_go_first() {
    let directory = tempfile::tempdir().unwrap();
    let config = StoreConfig { stage_cache_mib: 1, ..StoreConfig::at(directory.path().join("jobs.db")) };
    let store = Store::open(&config).await.unwrap();
    let bytes = vec![7; 600 << 10];
    store.save_stage("old", "mesh", "test-1", &bytes, at(1)).await.unwrap();
    assert_eq!(store.stage("old").await.unwrap().unwrap().len(), bytes.len());
    store.save_stage("new", "mesh", "test-1", &bytes, at(2)).await.unwrap();
    assert!(store.stage("old").await.unwrap().is_none());
    assert!(store.stage("new").await.unwrap().is_some());
    store.save_stage("huge", "mesh", "test-1", &vec![0; 2 << 20], at(3)).await.unwrap();
    assert!(store.stage("huge").await.unwrap().is_none());
    assert!(store.stage("new").await.unwrap().is_some());
}
