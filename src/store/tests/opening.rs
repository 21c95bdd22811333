//! Every error of opening a database: its message, and that the file is unchanged.

use super::super::connect::MIGRATIONS;
use super::*;
use sqlx::migrate::{Migration, MigrationType, Migrator};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{AssertSqlSafe, ConnectOptions, Connection, SqlSafeStr, SqliteConnection};
use std::fs;
use std::path::{Path, PathBuf};

async fn refused(path: &Path) -> OpenError {
    Store::open(&StoreConfig::at(path)).await.err().expect("not opened")
}

/// The error of an opening that must leave the file as it is.
async fn refused_unchanged(path: &Path) -> OpenError {
    let before = fs::read(path).expect("readable");
    let error = refused(path).await;
    assert!(fs::read(path).expect("readable") == before, "the file was changed");
    let text = error.to_string();
    assert!(text.contains(&path.display().to_string()) && text.contains(": "), "{text}");
    error
}

/// A database with a job, closed.
async fn closed() -> (TempDir, PathBuf) {
    let Fixture { store, directory } = fixture().await;
    let job = running(&store, "a").await;
    store.succeed(job.id, 1, &completion("a"), at(2)).await.expect("succeeds");
    store.close().await;
    let path = directory.path().join("jobs.db");
    (directory, path)
}

async fn raw_connection(path: &Path) -> SqliteConnection {
    SqliteConnectOptions::new().filename(path).create_if_missing(true).connect().await.expect("opens")
}

async fn run(path: &Path, sql: &'static str) {
    let mut connection = raw_connection(path).await;
    sqlx::query(sql).execute(&mut connection).await.expect("runs");
    connection.close().await.expect("closes");
}

/// The migrations and one more.
fn with_a_step(sql: &'static str) -> Migrator {
    let version = MIGRATIONS.iter().map(|step| step.version).max().expect("migrations") + 1;
    let sql = AssertSqlSafe(sql).into_sql_str();
    let step = Migration::new(version, "step".into(), MigrationType::Simple, sql, false);
    Migrator::with_migrations(MIGRATIONS.iter().cloned().chain([step]).collect())
}

#[tokio::test]
async fn a_closed_database_is_one_file_and_opens_again() {
    let (directory, path) = closed().await;
    let mut names: Vec<_> = fs::read_dir(directory.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["jobs.db", "jobs.db.lock"]);
    let store = Store::open(&StoreConfig::at(&path)).await.unwrap();
    assert_eq!(store.counts().await.unwrap().succeeded, 1);
}

#[tokio::test]
async fn a_directory_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    assert!(matches!(refused(directory.path()).await, OpenError::NotAFile(_)));
    assert!(matches!(refused(Path::new("/dev/null")).await, OpenError::NotAFile(_)));
}

#[tokio::test]
async fn a_missing_directory_is_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("no/such/jobs.db");
    assert!(matches!(refused(&path).await, OpenError::NoDirectory(named) if named == path));
    assert!(!directory.path().join("no").exists());
    let below_a_file = directory.path().join("file/jobs.db");
    fs::write(directory.path().join("file"), "").unwrap();
    assert!(matches!(refused(&below_a_file).await, OpenError::NoDirectory(_)));
}

#[tokio::test]
async fn a_file_that_is_no_database_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("jobs.db");
    for content in [&b"not a database"[..], &[0; 5000], b"SQLite format 3\0"] {
        fs::write(&path, content).unwrap();
        assert!(matches!(refused_unchanged(&path).await, OpenError::NotADatabase(_)), "{} bytes", content.len());
    }
}

#[tokio::test]
async fn an_empty_file_becomes_a_database() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("jobs.db");
    fs::write(&path, "").unwrap();
    assert!(Store::open(&StoreConfig::at(&path)).await.is_ok());
}

#[tokio::test]
async fn the_database_of_another_program_is_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("cookies.db");
    run(&path, "CREATE TABLE cookies (name TEXT)").await;
    assert!(matches!(refused_unchanged(&path).await, OpenError::Foreign(_)));
    // One that counts its migrations in the same way.
    run(&path, HISTORY).await;
    run(&path, "INSERT INTO _sqlx_migrations VALUES (20240101, 'cookies', 0, TRUE, x'00', 0)").await;
    assert!(matches!(refused_unchanged(&path).await, OpenError::Foreign(_)));
}

const HISTORY: &str = "CREATE TABLE _sqlx_migrations (version BIGINT PRIMARY KEY, description TEXT NOT NULL, \
                       installed_on TIMESTAMP NOT NULL DEFAULT CURRENT_TIMESTAMP, success BOOLEAN NOT NULL, \
                       checksum BLOB NOT NULL, execution_time BIGINT NOT NULL)";

#[tokio::test]
async fn a_database_whose_creation_was_interrupted_is_created() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("jobs.db");
    run(&path, HISTORY).await;
    let store = Store::open(&StoreConfig::at(&path)).await.unwrap();
    queued(&store, "a").await;
}

#[tokio::test]
async fn a_file_cut_off_is_damaged() {
    let (_directory, path) = closed().await;
    let whole = fs::read(&path).unwrap();
    for length in [whole.len() - 1, whole.len() / 2 / 4096 * 4096, 4096, 200] {
        fs::write(&path, &whole[..length]).unwrap();
        let error = refused_unchanged(&path).await;
        assert!(matches!(error, OpenError::Damaged { .. }), "{length} bytes: {error}");
    }
    fs::write(&path, &whole[..50]).unwrap();
    assert!(matches!(refused_unchanged(&path).await, OpenError::NotADatabase(_)));
}

/// Every page but the first is overwritten in turn: after an unclean end the start notices, whatever it was.
#[tokio::test]
async fn an_overwritten_page_is_reported_after_an_unclean_end() {
    let (directory, path) = closed().await;
    let whole = fs::read(&path).unwrap();
    // A log without valid content, as a killed process may leave it.
    let log = directory.path().join("jobs.db-wal");
    let mut noticed = 0;
    for page in 1..whole.len() / 4096 {
        let mut damaged = whole.clone();
        damaged[page * 4096..(page + 1) * 4096].fill(0xa5);
        fs::write(&path, &damaged).unwrap();
        fs::write(&log, "left").unwrap();
        let error = refused_unchanged(&path).await;
        assert!(matches!(error, OpenError::Damaged { .. }), "page {page}: {error}");
        noticed += 1;
    }
    assert!(noticed > 10, "{noticed} pages");
    fs::write(&path, &whole).unwrap();
    fs::write(&log, "left").unwrap();
    assert!(Store::open(&StoreConfig::at(&path)).await.is_ok(), "a sound one opens");
}

#[tokio::test]
async fn a_newer_schema_is_refused_with_both_numbers() {
    let (_directory, path) = closed().await;
    let store = Store::open_with(&StoreConfig::at(&path), &with_a_step("CREATE TABLE later (a)")).await.unwrap();
    store.close().await;
    drop(store);
    let known = MIGRATIONS.iter().map(|step| step.version).max().unwrap();
    let error = refused_unchanged(&path).await;
    assert!(
        matches!(error, OpenError::Newer { found, known: ours, .. } if (found, ours) == (known + 1, known)),
        "{error}"
    );
}

#[tokio::test]
async fn a_changed_step_is_another_build() {
    let (_directory, path) = closed().await;
    run(&path, "UPDATE _sqlx_migrations SET checksum = x'00' WHERE version = 1").await;
    assert!(matches!(refused_unchanged(&path).await, OpenError::OtherBuild { step: 1, .. }));
}

#[tokio::test]
async fn an_upgrade_copies_the_database_before() {
    let (directory, path) = closed().await;
    let steps = with_a_step("ALTER TABLE jobs RENAME COLUMN label TO tag");
    let version = steps.iter().map(|step| step.version).max().unwrap();
    let store = Store::open_with(&StoreConfig::at(&path), &steps).await.unwrap();
    store.close().await;
    drop(store);
    // The copy replaces the file.
    let copy = directory.path().join(format!("jobs.db.before-schema-{version}"));
    fs::rename(&copy, &path).unwrap();
    let store = Store::open(&StoreConfig::at(&path)).await.unwrap();
    assert_eq!(store.counts().await.unwrap().succeeded, 1);
    let new = directory.path().join("new.db");
    drop(Store::open_with(&StoreConfig::at(&new), &steps).await.unwrap());
    assert!(!directory.path().join(format!("new.db.before-schema-{version}")).exists(), "there was nothing to copy");
}

#[tokio::test]
async fn an_upgrade_that_fails_is_rolled_back() {
    let (_directory, path) = closed().await;
    let steps = with_a_step("CREATE TABLE later (a); INSERT INTO nowhere VALUES (1)");
    let error = Store::open_with(&StoreConfig::at(&path), &steps).await.err().expect("not opened");
    assert!(matches!(error, OpenError::Upgrade { .. }), "{error}");
    let store = Store::open(&StoreConfig::at(&path)).await.unwrap();
    let later = sqlx::query("SELECT 1 FROM sqlite_schema WHERE name = 'later'");
    assert!(later.fetch_optional(&store.reader).await.unwrap().is_none());
}

#[tokio::test]
async fn a_damaged_file_is_not_upgraded() {
    let (_directory, path) = closed().await;
    let mut damaged = fs::read(&path).unwrap();
    let page = damaged.len() / 4096 - 1;
    damaged[page * 4096..].fill(0xa5);
    fs::write(&path, &damaged).unwrap();
    let error = Store::open_with(&StoreConfig::at(&path), &with_a_step("CREATE TABLE later (a)")).await.err();
    assert!(matches!(error, Some(OpenError::Damaged { .. })), "{error:?}");
    assert!(fs::read(&path).unwrap() == damaged);
}

#[tokio::test]
async fn a_lock_of_another_program_is_reported() {
    let (_directory, path) = closed().await;
    let mut other = raw_connection(&path).await;
    sqlx::query("BEGIN IMMEDIATE").execute(&mut other).await.unwrap();
    assert!(matches!(refused(&path).await, OpenError::Locked(_)), "while it writes");
    sqlx::query("ROLLBACK").execute(&mut other).await.unwrap();
    other.close().await.unwrap();
    let mut exclusive = raw_connection(&path).await;
    sqlx::query("PRAGMA locking_mode = EXCLUSIVE").execute(&mut exclusive).await.unwrap();
    sqlx::query("BEGIN EXCLUSIVE").execute(&mut exclusive).await.unwrap();
    assert!(matches!(refused(&path).await, OpenError::Locked(_)), "while it holds an exclusive lock");
    drop(exclusive);
}

#[tokio::test]
async fn a_lock_of_another_program_while_serving_is_storage_unavailable() {
    let Fixture { store, directory } = fixture().await;
    sqlx::query("PRAGMA busy_timeout = 50").execute(&store.writer).await.unwrap();
    let mut other = raw_connection(&directory.path().join("jobs.db")).await;
    sqlx::query("BEGIN IMMEDIATE").execute(&mut other).await.unwrap();
    let error = store.submit(new_job("a"), None, 10, at(0)).await.expect_err("refused");
    assert_eq!(error.unavailable(), Some(Unavailable::Busy));
    assert_eq!(store.writable().await.err().and_then(|error| error.unavailable()), Some(Unavailable::Busy));
    sqlx::query("ROLLBACK").execute(&mut other).await.unwrap();
    queued(&store, "a").await;
}

/// As with a full disk at a commit: SQLite has rolled back by itself, and the driver's own rollback fails.
#[tokio::test]
async fn a_transaction_that_sqlite_ended_by_itself_does_not_affect_later_ones() {
    let Fixture { store, directory: _directory } = fixture().await;
    for _ in 0..3 {
        let mut transaction = store.begin_with_reserve().await.unwrap();
        sqlx::query("ROLLBACK").execute(&mut *transaction).await.unwrap();
        drop(transaction);
        queued(&store, "a").await;
    }
    store.writable().await.unwrap();
}
