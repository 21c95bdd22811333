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
    with_steps(&[sql])
}

/// The migrations and more of them.
fn with_steps(steps: &[&'static str]) -> Migrator {
    let last = MIGRATIONS.iter().map(|step| step.version).max().expect("migrations");
    let steps = (last + 1..).zip(steps).map(|(version, sql)| {
        Migration::new(version, "step".into(), MigrationType::Simple, AssertSqlSafe(*sql).into_sql_str(), false)
    });
    Migrator::with_migrations(MIGRATIONS.iter().cloned().chain(steps).collect())
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

/// The database was moved away after an unclean end; its log holds jobs that are nowhere else.
#[tokio::test]
async fn a_log_without_its_database_is_left_alone() {
    let Fixture { store, directory } = fixture().await;
    queued(&store, "a").await;
    let (path, wal) = (store.file.path().to_owned(), directory.path().join("jobs.db-wal"));
    let (database, log) = (fs::read(&path).unwrap(), fs::read(&wal).unwrap());
    store.close().await;
    drop(store);
    assert!(log.len() > 4096);
    for left in [None, Some(&b""[..])] {
        fs::remove_file(&path).unwrap();
        left.into_iter().for_each(|bytes| fs::write(&path, bytes).unwrap());
        fs::write(&wal, &log).unwrap();
        let error = refused(&path).await;
        assert!(matches!(&error, OpenError::OrphanedLog { log, .. } if *log == wal), "{error}");
        assert!(error.to_string().contains("put the database back"), "{error}");
        let target = directory.path().join("copy.db");
        let error = backup(&path, &target, true).await.expect_err("not copied");
        assert!(matches!(error, BackupError::Unusable(OpenError::OrphanedLog { .. })), "{error}");
        assert!(fs::read(&wal).unwrap() == log, "the log is as it was");
        assert_eq!(path.exists(), left.is_some());
        fs::write(&path, &database).unwrap();
    }
    // Put back, it is whole.
    assert_eq!(Store::open(&StoreConfig::at(&path)).await.unwrap().counts().await.unwrap().queued, 1);
}

/// A rollback journal: of a database that is gone it is kept, of an interrupted creation it is not in the way.
#[tokio::test]
async fn a_journal_without_its_database_is_left_alone() {
    let directory = tempfile::tempdir().unwrap();
    let (path, journal) = (directory.path().join("jobs.db"), directory.path().join("jobs.db-journal"));
    let mut header = [0; 512];
    header[..8].copy_from_slice(b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7");
    header[16..20].copy_from_slice(&7u32.to_be_bytes());
    fs::write(&journal, header).unwrap();
    assert!(matches!(refused(&path).await, OpenError::OrphanedLog { log, .. } if log == journal));
    assert_eq!(fs::read(&journal).unwrap(), header);
    header[16..20].fill(0);
    fs::write(&journal, header).unwrap();
    assert!(Store::open(&StoreConfig::at(&path)).await.is_ok());
}

#[tokio::test]
async fn a_database_has_one_user_whatever_it_is_called() {
    let Fixture { store, directory } = fixture().await;
    queued(&store, "a").await;
    let path = store.file.path().to_owned();
    let (symbolic, hard) = (directory.path().join("symbolic.db"), directory.path().join("hard.db"));
    std::os::unix::fs::symlink(&path, &symbolic).unwrap();
    assert!(matches!(refused(&symbolic).await, OpenError::InUse(_)));
    fs::hard_link(&path, &hard).unwrap();
    assert!(matches!(refused(&hard).await, OpenError::InUse(_)));
    // A copy under the other name would lack what is in the log.
    let target = directory.path().join("copy.db");
    assert!(backup(&hard, &target, false).await.is_err());
    fs::remove_file(&hard).unwrap();
    assert_eq!(backup(&symbolic, &target, false).await.unwrap().jobs["queued"], 1);
    store.close().await;
    drop(store);
    // Not open: with a symbolic link the log lies beside the file, with a hard link beside either name.
    fs::hard_link(&path, &hard).unwrap();
    for name in [&path, &hard] {
        assert!(matches!(refused(name).await, OpenError::SeveralNames { names: 2, .. }));
        let error = backup(name, &target, true).await.expect_err("not copied");
        assert!(matches!(error, BackupError::Unusable(OpenError::SeveralNames { .. })), "{error}");
    }
    fs::remove_file(&path).unwrap();
    assert!(matches!(refused(&symbolic).await, OpenError::BrokenLink { .. }), "nothing is made behind a broken link");
    fs::rename(&hard, &path).unwrap();
    let store = Store::open(&StoreConfig::at(&symbolic)).await.unwrap();
    assert_eq!((store.counts().await.unwrap().queued, store.file.path()), (1, &*path));
    assert!(store.usage().await.unwrap().log_bytes > 0 || directory.path().join("jobs.db-wal").exists());
}

#[tokio::test]
async fn nothing_is_written_to_a_file_without_its_name() {
    let Fixture { store, directory } = fixture().await;
    let job = running(&store, "a").await;
    let (path, away) = (store.file.path().to_owned(), directory.path().join("away"));
    for name in ["jobs.db", "jobs.db-wal", "jobs.db-shm"].map(|name| directory.path().join(name)) {
        fs::rename(&name, &away).unwrap();
        let lost = |error: Option<StoreError>| error.and_then(|error| error.unavailable());
        assert_eq!(lost(store.admit().await.err()), Some(Unavailable::Lost), "{}", name.display());
        assert_eq!(lost(store.writable().await.err()), Some(Unavailable::Lost));
        assert_eq!(lost(store.submit(new_job("b"), None, 10, at(0)).await.err()), Some(Unavailable::Lost));
        assert_eq!(lost(store.succeed(job.id, 1, &completion("a"), at(2)).await.err()), Some(Unavailable::Lost));
        assert_eq!(store.job(job.id).await.unwrap().unwrap().state, JobState::Running, "reading goes on");
        // Another file under the name is no better.
        fs::write(&name, "another").unwrap();
        let error = store.check_file().expect_err("lost").to_string();
        assert!(error.contains(&*name.to_string_lossy()), "{error}");
        fs::rename(&away, &name).unwrap();
        store.writable().await.unwrap();
    }
    assert!(store.succeed(job.id, 1, &completion("a"), at(2)).await.unwrap().is_some());
    store.close().await;
    drop(store);
    assert_eq!(Store::open(&StoreConfig::at(&path)).await.unwrap().counts().await.unwrap().succeeded, 1);
}

/// The file may be replaced while the service runs; a connection that is made then must not read or write the other.
#[tokio::test]
async fn another_file_under_the_name_is_never_opened() {
    let Fixture { store, directory } = fixture().await;
    let job = queued(&store, "a").await;
    let path = store.file.path().to_owned();
    fs::rename(&path, directory.path().join("away")).unwrap();
    fs::write(&path, "another").unwrap();
    let reads: Vec<_> = (0..8).map(|_| store.job(job.id)).collect();
    for read in futures_util::future::join_all(reads).await {
        assert_eq!(read.unwrap(), Some(job.clone()));
    }
    assert!(store.release_space().await.is_err());
    assert_eq!(fs::read(&path).unwrap(), b"another");
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
    // What free pages contain does not matter.
    run(&path, "PRAGMA incremental_vacuum").await;
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

/// An upgrade of two steps of which the second fails: nothing of it stays, and the copy made before it is not replaced
/// by the next attempt.
#[tokio::test]
async fn an_upgrade_of_several_steps_is_made_whole_or_not_at_all() {
    let (directory, path) = closed().await;
    let first = with_a_step("CREATE TABLE later (a)");
    let failing = with_steps(&["CREATE TABLE later (a)", "INSERT INTO nowhere VALUES (1)"]);
    let error = Store::open_with(&StoreConfig::at(&path), &failing).await.err().expect("not opened");
    assert!(matches!(error, OpenError::Upgrade { .. }), "{error}");
    let target = failing.iter().map(|step| step.version).max().unwrap();
    let copy = directory.path().join(format!("jobs.db.before-schema-{target}"));
    let kept = fs::read(&copy).unwrap();
    drop(Store::open(&StoreConfig::at(&path)).await.expect("the schema is that of before"));
    // The same upgrade in one step less, then all of it, as by a release that mends the step.
    let mended = with_steps(&["CREATE TABLE later (a)", "CREATE TABLE latest (a)"]);
    Store::open_with(&StoreConfig::at(&path), &mended).await.unwrap().close().await;
    assert!(fs::read(&copy).unwrap() == kept, "the copy of the first attempt is kept");
    fs::copy(&copy, &path).unwrap();
    // Back to the version of before, one more job, and another upgrade: the first copy has not that job.
    let store = Store::open(&StoreConfig::at(&path)).await.unwrap();
    queued(&store, "later").await;
    store.close().await;
    drop(store);
    Store::open_with(&StoreConfig::at(&path), &mended).await.unwrap().close().await;
    assert!(fs::read(&copy).unwrap() == kept, "no copy is overwritten");
    let second = directory.path().join(format!("jobs.db.before-schema-{target}.2"));
    fs::rename(&second, &path).unwrap();
    assert_eq!(Store::open(&StoreConfig::at(&path)).await.unwrap().counts().await.unwrap().queued, 1);
    assert_eq!(first.iter().count() + 1, mended.iter().count());
}

/// What an earlier version, which committed each step of its own, left between two steps.
#[tokio::test]
async fn the_copy_of_an_upgrade_that_stopped_between_two_steps_is_kept() {
    let (directory, path) = closed().await;
    let all = with_steps(&["CREATE TABLE later (a)", "CREATE TABLE latest (a)"]);
    let target = all.iter().map(|step| step.version).max().unwrap();
    let copy = directory.path().join(format!("jobs.db.before-schema-{target}"));
    fs::copy(&path, &copy).unwrap();
    Store::open_with(&StoreConfig::at(&path), &with_a_step("CREATE TABLE later (a)")).await.unwrap().close().await;
    let kept = fs::read(&copy).unwrap();
    Store::open_with(&StoreConfig::at(&path), &all).await.unwrap().close().await;
    assert!(fs::read(&copy).unwrap() == kept);
    fs::rename(&copy, &path).unwrap();
    assert_eq!(Store::open(&StoreConfig::at(&path)).await.unwrap().counts().await.unwrap().succeeded, 1);
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
