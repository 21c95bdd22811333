use super::super::connect::MIGRATIONS;
use super::*;
use sqlx::migrate::Migrator;

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

/// A result stored before rows were found by name has a byte offset in a column of its own, which an upgrade drops.
#[tokio::test]
async fn results_of_a_database_with_row_offsets_are_read_after_the_upgrade() {
    let directory = tempfile::tempdir().unwrap();
    let config = StoreConfig::at(directory.path().join("jobs.db"));
    let before = MIGRATIONS.iter().filter(|step| step.version < 5).cloned().collect();
    let store = Store::open_with(&config, &Migrator::with_migrations(before)).await.unwrap();
    let id = insert_succeeded(&store, "a").await;
    let body = "{\"sweep\":{\"points\":[]}}";
    let insert = "INSERT INTO results (job_id, body, etag, input_hash, solver_version, points_at, points_n, points_digest) \
                  VALUES ($1, $2, 'tag', 'a', 'test-1', 20, 2, 'digest')";
    sqlx::query(insert).bind(id.to_string()).bind(body).execute(&store.writer).await.unwrap();
    store.close().await;
    drop(store);
    let store = Store::open(&config).await.unwrap();
    let rows = Some(RowsSummary { count: 2, digest: "digest".into() });
    let expected = StoredResult { body: body.into(), etag: "tag".into(), rows };
    assert_eq!(store.result(id).await.unwrap(), Some(expected));
}
