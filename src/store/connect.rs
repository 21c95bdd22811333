//! Opening the database: one connection that writes, several that read, write-ahead log.

use super::backup::{self, BackupError};
pub(super) use super::error::StoreError;
use super::error::Unavailable;
use super::examine::{OPEN_WAIT, examine, with_suffix};
use super::file::{DatabaseFile, LostFile};
use super::ids::IdGenerator;
use super::open_error::OpenError;
use super::queued_count::QueuedCount;
use super::retention::{RetentionConfig, SizeLimit};
use super::write_probe::WriteProbe;
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::sqlite::{
    SqliteAutoVacuum, SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{ConnectOptions, Connection, Sqlite, Transaction};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Mutex, Notify};

/// The migrations, embedded in the program.
pub(super) static MIGRATIONS: Migrator = sqlx::migrate!("./migrations");

/// Longest wait of a statement for a lock of another program.
const BUSY_WAIT: Duration = Duration::from_secs(10);
/// Longest wait for the connection that writes.
const WRITER_WAIT: Duration = Duration::from_secs(15);
/// Suffix of a copy made before an upgrade, followed by the schema to which that led.
const BEFORE_SCHEMA: &str = ".before-schema-";
/// Size to which the write-ahead log is cut after a checkpoint.
const LOG_BYTES: u64 = 64 << 20;

/// Settings of the database.
#[derive(Debug, Clone, clap::Args)]
pub struct StoreConfig {
    /// Database file; created when missing. One process at a time may use it.
    #[arg(long, env = "HERRINGBONE_DATABASE", value_name = "FILE", default_value = "herringbone.db")]
    pub database: PathBuf,

    /// Connections that read; writing has one of its own.
    #[arg(long, env = "HERRINGBONE_DATABASE_READERS", value_name = "N", default_value_t = 4,
          value_parser = clap::value_parser!(u32).range(1..=64))]
    pub database_readers: u32,

    /// Space for finished stages kept for reuse; the oldest go first. 0 keeps none.
    #[arg(long, env = "HERRINGBONE_STAGE_CACHE_MIB", value_name = "MIB", default_value_t = 256,
          value_parser = clap::value_parser!(u32).range(0..=1_048_576))]
    pub stage_cache_mib: u32,

    #[command(flatten)]
    pub retention: RetentionConfig,
}

impl StoreConfig {
    /// The default settings with this database file.
    pub fn at(database: impl Into<PathBuf>) -> Self {
        let (database, retention) = (database.into(), RetentionConfig::default());
        Self { database, database_readers: 2, stage_cache_mib: 256, retention }
    }
}

/// The open database. Cheap to clone.
#[derive(Clone)]
pub struct Store {
    pub(super) writer: SqlitePool,
    pub(super) reader: SqlitePool,
    pub(super) stage_cache_bytes: i64,
    pub(super) queued_count: QueuedCount,
    pub(super) ids: IdGenerator,
    pub(super) limit: Option<SizeLimit>,
    /// Notified when a job was refused for want of space.
    pub(super) space_needed: Arc<Notify>,
    /// The last write probe.
    pub(super) probe: Arc<Mutex<Option<WriteProbe>>>,
    /// Dropped after the connections, as it holds the lock.
    pub(super) file: Arc<DatabaseFile>,
}

impl Store {
    /// Opens the database, creates it when missing and applies pending migrations, before which an existing one is
    /// copied.
    ///
    /// # Errors
    /// [`OpenError`]; the database is then unchanged.
    pub async fn open(config: &StoreConfig) -> Result<Self, OpenError> {
        Self::open_with(config, &MIGRATIONS).await
    }

    pub(super) async fn open_with(config: &StoreConfig, migrations: &Migrator) -> Result<Self, OpenError> {
        let mut file = DatabaseFile::open(&config.database)?;
        let path = file.path();
        backup::remove_partial_copies(&with_suffix(path, BEFORE_SCHEMA));
        let found = examine(path, migrations).await?;
        let open_error = |error| OpenError::of_database(path, error);
        let limit = config.retention.limit(found.page_bytes);
        let options = SqliteConnectOptions::new()
            .filename(path)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(OPEN_WAIT)
            .pragma("journal_size_limit", LOG_BYTES.to_string());
        if let Some(to) = found.upgrade_to {
            copy_before_upgrade(path, to).await?;
        }
        if found.schema.is_none() || found.upgrade_to.is_some() {
            // Effective only before the first table is created.
            let new = found.schema.is_none().then_some(SqliteAutoVacuum::Incremental);
            let options = new.into_iter().fold(options.clone(), SqliteConnectOptions::auto_vacuum);
            upgrade(&options, migrations).await.map_err(|error| upgrade_error(path, migrations, error))?;
        }
        // A connection that is made later must not make a file either.
        let options = options.busy_timeout(BUSY_WAIT).create_if_missing(false);
        let permanent = || SqlitePoolOptions::new().idle_timeout(None).max_lifetime(None);
        // After a rollback by SQLite itself (a full disk at the commit), the driver still counts the transaction as
        // open; such a connection cannot write again and is not reused.
        let writer = permanent()
            .max_connections(1)
            .acquire_timeout(WRITER_WAIT)
            .before_acquire(|connection, _| Box::pin(async { Ok(!connection.is_in_transaction()) }));
        let writer = writer.connect_with(options.clone()).await.map_err(open_error)?;
        check_writable(&writer).await.map_err(open_error)?;
        // All are made at once: they go on reading the file when it is moved, and never open another one.
        let reader = permanent()
            .min_connections(config.database_readers)
            .max_connections(config.database_readers)
            .connect_with(options.read_only(true))
            .await
            .map_err(open_error)?;
        let stage_cache_bytes =
            (i64::from(config.stage_cache_mib) << 20).min(SizeLimit::stage_cache_bytes(limit.as_ref()));
        let queued_count = QueuedCount::read(&writer).await.map_err(open_error)?;
        let ids = IdGenerator::after_stored(&writer).await.map_err(open_error)?;
        file.add_log();
        Ok(Self {
            writer,
            reader,
            stage_cache_bytes,
            queued_count,
            ids,
            limit,
            space_needed: Arc::default(),
            probe: Arc::default(),
            file: Arc::new(file),
        })
    }

    /// Begins a transaction that may use the reserve above the size limit: it ends, cancels or deletes jobs, which must
    /// be possible in a full database.
    pub(super) async fn begin_with_reserve(&self) -> Result<Transaction<'static, Sqlite>, StoreError> {
        self.begin_within(self.limit.as_ref().map(|limit| limit.max_pages_with_reserve)).await
    }

    /// Begins a transaction that adds documents, rows or results, within the size limit.
    pub(super) async fn begin(&self) -> Result<Transaction<'static, Sqlite>, StoreError> {
        self.begin_within(self.limit.as_ref().map(|limit| limit.max_pages)).await
    }

    async fn begin_within(&self, max_pages: Option<u64>) -> Result<Transaction<'static, Sqlite>, StoreError> {
        self.check_file()?;
        let mut transaction = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        if let Some(max_pages) = max_pages {
            // The bound belongs to the connection and stays until the next transaction sets its own.
            let pragma = format!("PRAGMA max_page_count = {max_pages}");
            sqlx::query(sqlx::AssertSqlSafe(pragma)).execute(&mut *transaction).await?;
        }
        Ok(transaction)
    }

    /// Checks that the database file and its log are still found under their names. Nothing is written to files that
    /// have lost theirs: it would be gone with the process. The check costs microseconds.
    ///
    /// # Errors
    /// [`Unavailable::Lost`].
    pub fn check_file(&self) -> Result<(), StoreError> {
        let lost = |lost: LostFile| StoreError::Unavailable { cause: Unavailable::Lost, detail: lost.to_string() };
        self.file.check().map_err(lost)
    }

    /// Executes a trivial query.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn ping(&self) -> Result<(), StoreError> {
        sqlx::query("SELECT 1").execute(&self.reader).await?;
        Ok(())
    }

    /// Closes all connections.
    pub async fn close(&self) {
        self.reader.close().await;
        self.writer.close().await;
    }
}

/// Copies the database before an upgrade, as older versions of the service do not read the new schema. An earlier copy
/// is never overwritten: it is taken for this upgrade if it has the same jobs, else another name is found.
async fn copy_before_upgrade(path: &Path, to: i64) -> Result<(), OpenError> {
    let of_backup = |error| match error {
        BackupError::Database { source, .. } => OpenError::of_database(path, source),
        BackupError::File { path, source } => OpenError::of_file(&path, source),
        other => OpenError::Upgrade { path: path.to_owned(), to, source: Box::new(other) },
    };
    let mut copy = with_suffix(path, &format!("{BEFORE_SCHEMA}{to}"));
    let mut number = 1;
    while fs::symlink_metadata(&copy).is_ok() {
        if backup::has_same_jobs(path, &copy).await.map_err(of_backup)? {
            tracing::info!(copy = %copy.display(), "the copy of an interrupted upgrade of the database is kept");
            return Ok(());
        }
        number += 1;
        copy = with_suffix(path, &format!("{BEFORE_SCHEMA}{to}.{number}"));
    }
    let copied = backup::copy(path, &copy).await.map_err(of_backup)?;
    tracing::info!(copy = %copy.display(), bytes = copied.bytes, "copy made before the upgrade of the database");
    Ok(())
}

/// Applies the pending migrations in one transaction (each is a savepoint of it): a database never stays between two
/// schemas.
async fn upgrade(options: &SqliteConnectOptions, migrations: &Migrator) -> Result<(), MigrateError> {
    let mut connection = options.connect().await?;
    let mut transaction = connection.begin_with("BEGIN IMMEDIATE").await?;
    migrations.run(&mut *transaction).await?;
    transaction.commit().await?;
    Ok(connection.close().await?)
}

fn upgrade_error(path: &Path, migrations: &Migrator, error: MigrateError) -> OpenError {
    let to = migrations.iter().map(|step| step.version).max().unwrap_or_default();
    match error {
        MigrateError::Execute(source) => OpenError::of_database(path, source),
        MigrateError::ExecuteMigration(source, _) => match OpenError::of_database(path, source) {
            OpenError::Database { path, source } => OpenError::Upgrade { path, to, source: Box::new(source) },
            other => other,
        },
        other => OpenError::Upgrade { path: path.to_owned(), to, source: Box::new(other) },
    }
}

/// Checks at the start that the database can be written.
async fn check_writable(writer: &SqlitePool) -> Result<(), sqlx::Error> {
    writer.begin_with("BEGIN IMMEDIATE").await?.rollback().await
}
