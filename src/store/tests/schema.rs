use super::super::connect::MIGRATIONS;
use super::*;

#[test]
fn every_migration_file_is_embedded() {
    let files = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/migrations"))
        .expect("migrations folder")
        .filter_map(Result::ok)
        .filter(|entry| entry.path().extension().is_some_and(|extension| extension == "sql"))
        .count();
    assert_eq!(MIGRATIONS.iter().count(), files, "a migration without a numeric prefix is skipped silently");
}

#[tokio::test]
async fn the_database_runs_as_configured() {
    let fixture = fixture().await;
    let pragma = async |name: &'static str| -> String {
        let row: (String,) = sqlx::query_as(name).fetch_one(&fixture.store.writer).await.expect("pragma answers");
        row.0
    };
    assert_eq!(pragma("SELECT journal_mode FROM pragma_journal_mode").await, "wal");
    assert_eq!(pragma("SELECT CAST(synchronous AS TEXT) FROM pragma_synchronous").await, "2");
    assert_eq!(pragma("SELECT CAST(foreign_keys AS TEXT) FROM pragma_foreign_keys").await, "1");
    assert_eq!(pragma("SELECT CAST(auto_vacuum AS TEXT) FROM pragma_auto_vacuum").await, "2", "deletes give room back");
    let refused = sqlx::query("DELETE FROM jobs").execute(&fixture.store.reader).await;
    assert!(refused.is_err(), "readers must not write");
}

#[tokio::test]
async fn a_second_process_is_refused() {
    let fixture = fixture().await;
    let second = Store::open(&StoreConfig::at(fixture.directory.path().join("jobs.db"))).await;
    assert!(matches!(second, Err(OpenError::InUse(_))));
}
