use super::super::connect::MIGRATIONS;
use super::*;
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection};

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

/// A database as a version of the service with this schema created it.
async fn database_of_schema(schema: i64, config: &StoreConfig) -> SqliteConnection {
    let options = SqliteConnectOptions::new().filename(&config.database).create_if_missing(true);
    let mut connection = options.connect().await.expect("created");
    let steps = MIGRATIONS.iter().filter(|step| step.version <= schema).cloned().collect();
    Migrator::with_migrations(steps).run(&mut connection).await.expect("migrated");
    connection
}

/// A sweep in this state, with the columns that every schema has.
async fn insert_job(connection: &mut SqliteConnection, id: &str, state: &str, reused_from: Option<&str>) {
    let insert = "INSERT INTO jobs (id, kind, state, revision, attempt, input_hash, solver_version, submitted_at_us, \
                  ended_at_us, reused_from, input, error) \
                  VALUES ($1, 'sweep', $2, 1, 1, 'a', 'test-1', 0, $3, $4, '{}', $5)";
    let ended = (state != "queued").then_some(1);
    let error = (state == "failed").then_some("{\"code\":\"diverged\",\"detail\":\"\"}");
    let insert = sqlx::query(insert).bind(id).bind(state).bind(ended).bind(reused_from).bind(error);
    insert.execute(connection).await.expect("inserted");
}

/// A result stored before rows were found by name has a byte offset in a column of its own, which an upgrade drops.
#[tokio::test]
async fn results_of_a_database_with_row_offsets_are_read_after_the_upgrade() {
    let directory = tempfile::tempdir().unwrap();
    let config = StoreConfig::at(directory.path().join("jobs.db"));
    let mut before = database_of_schema(4, &config).await;
    let id = JobId::new();
    insert_job(&mut before, &id.to_string(), "succeeded", None).await;
    let body = "{\"sweep\":{\"points\":[]}}";
    let insert = "INSERT INTO results (job_id, body, etag, input_hash, solver_version, points_at, points_n, points_digest) \
                  VALUES ($1, $2, 'tag', 'a', 'test-1', 20, 2, 'digest')";
    sqlx::query(insert).bind(id.to_string()).bind(body).execute(&mut before).await.unwrap();
    before.close().await.unwrap();
    let store = Store::open(&config).await.unwrap();
    let rows = Some(RowsSummary { count: 2, digest: "digest".into() });
    let expected = StoredResult { body: body.into(), etag: "tag".into(), rows };
    assert_eq!(store.result(id).await.unwrap(), Some(expected));
}

/// A database in which every job had series and rows of its own, copied where a result was reused.
#[tokio::test]
async fn series_and_rows_of_a_database_with_copies_are_shared_after_the_upgrade() {
    let directory = tempfile::tempdir().unwrap();
    let config = StoreConfig::at(directory.path().join("jobs.db"));
    let mut before = database_of_schema(5, &config).await;
    let ids: Vec<String> = (0..6).map(|_| JobId::new().to_string()).collect();
    // A result and two that reused it, one after the other; one whose source is gone; a failed sweep; one that waits.
    let gone = JobId::new().to_string();
    let jobs = [
        ("succeeded", None),
        ("succeeded", Some(&ids[0])),
        ("succeeded", Some(&ids[1])),
        ("succeeded", Some(&gone)),
        ("failed", None),
        ("queued", None),
    ];
    let samples = zstd::bulk::compress(&2.5f64.to_le_bytes(), 3).unwrap();
    for (id, (state, source)) in ids.iter().zip(jobs) {
        insert_job(&mut before, id, state, source.map(String::as_str)).await;
        if state == "succeeded" {
            let insert = "INSERT INTO results (job_id, body, etag, input_hash, solver_version) \
                          VALUES ($1, '{}', 'tag', 'a', 'test-1')";
            sqlx::query(insert).bind(id).execute(&mut before).await.unwrap();
            let insert = "INSERT INTO series (job_id, position, channel, quantity, unit, n, t0_s, dt_s, min, max, rms, samples) \
                          VALUES ($1, 0, 'a_x_left', 'acceleration', 'm/s2', 1, 0.5, 0.1, 2.5, 2.5, NULL, $2)";
            sqlx::query(insert).bind(id).bind(&samples).execute(&mut before).await.unwrap();
        }
        if state != "queued" {
            let insert = "INSERT INTO sweep_points (job_id, position, solver_version, body) \
                          SELECT $1, value, 'test-1', '{\"x\":' || value || '}' FROM json_each('[0, 1, 2]')";
            sqlx::query(insert).bind(id).execute(&mut before).await.unwrap();
        }
    }
    before.close().await.unwrap();
    let store = Store::open(&config).await.unwrap();
    let ids: Vec<JobId> = ids.iter().map(|id| id.parse().unwrap()).collect();
    let series = async |id: JobId| store.series(id, "a_x_left").await.unwrap().map(|series| series.unpack().unwrap());
    for (index, id) in ids.iter().enumerate() {
        assert_eq!(store.point_count(*id).await.unwrap(), if index == 5 { 0 } else { 3 }, "{index}");
        assert_eq!(series(*id).await, (index < 4).then(|| vec![2.5]), "{index}");
    }
    let counts = "SELECT (SELECT COUNT(*) FROM datasets), (SELECT COUNT(*) FROM sweep_points), \
                  (SELECT COUNT(*) FROM results WHERE dataset_id IS NULL)";
    let counts: (i64, i64, i64) = sqlx::query_as(counts).fetch_one(&store.reader).await.unwrap();
    assert_eq!(counts, (3, 9, 0), "one dataset for three jobs that share it, and two");
    // The failed sweep is gone on with from its rows.
    let claim = store.claim_next(WorkClass::Sweep, at(1)).await.unwrap().unwrap().job;
    assert_eq!(store.resume_points(claim.id, claim.attempt, "a", "test-1").await.unwrap().rows.len(), 3);
    store.delete(ids[0]).await.unwrap();
    store.delete(ids[1]).await.unwrap();
    assert_eq!(series(ids[2]).await, Some(vec![2.5]));
    store.delete(ids[2]).await.unwrap();
    let broken = sqlx::query("PRAGMA foreign_key_check").fetch_optional(&store.reader).await.unwrap();
    assert!(broken.is_none());
}
