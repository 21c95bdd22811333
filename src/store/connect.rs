//! Opening the database: one connection that writes, several that read, write-ahead log.

use super::backup;
pub(super) use super::error::StoreError;
use super::examine::{OPEN_WAIT, examine, with_suffix};
use super::ids::IdGenerator;
use super::open_error::OpenError;
use super::queued_count::QueuedCount;
use super::retention::{RetentionConfig, SizeLimit};
use super::write_probe::WriteProbe;
use sqlx::migrate::{MigrateError, Migrator};
use sqlx::sqlite::{
    SqliteAutoVacuum, SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous,
};
use sqlx::{Connection, Sqlite, Transaction};
use std::fs::{File, OpenOptions};
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
    pub(super) path: Arc<Path>,
    /// Notified when a job was refused for want of space.
    pub(super) space_needed: Arc<Notify>,
    /// The last write probe.
    pub(super) probe: Arc<Mutex<Option<WriteProbe>>>,
    _lock: Arc<File>,
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
        let path = config.database.as_path();
        let lock = lock(path)?;
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
            let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.map_err(open_error)?;
            let applied = migrations.run(&pool).await;
            pool.close().await;
            applied.map_err(|error| upgrade_error(path, migrations, error))?;
        }
        let options = options.busy_timeout(BUSY_WAIT);
        let permanent = || SqlitePoolOptions::new().idle_timeout(None).max_lifetime(None);
        // After a rollback by SQLite itself (a full disk at the commit), the driver still counts the transaction as
        // open; such a connection cannot write again and is not reused.
        let writer = permanent()
            .max_connections(1)
            .acquire_timeout(WRITER_WAIT)
            .before_acquire(|connection, _| Box::pin(async { Ok(!connection.is_in_transaction()) }));
        let writer = writer.connect_with(options.clone()).await.map_err(open_error)?;
        check_writable(&writer).await.map_err(open_error)?;
        let reader = permanent()
            .max_connections(config.database_readers)
            .connect_with(options.read_only(true).create_if_missing(false))
            .await
            .map_err(open_error)?;
        let stage_cache_bytes =
            (i64::from(config.stage_cache_mib) << 20).min(SizeLimit::stage_cache_bytes(limit.as_ref()));
        let queued_count = QueuedCount::read(&writer).await.map_err(open_error)?;
        let ids = IdGenerator::after_stored(&writer).await.map_err(open_error)?;
        Ok(Self {
            writer,
            reader,
            stage_cache_bytes,
            queued_count,
            ids,
            limit,
            path: path.into(),
            space_needed: Arc::default(),
            probe: Arc::default(),
            _lock: Arc::new(lock),
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
        let mut transaction = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        if let Some(max_pages) = max_pages {
            // The bound belongs to the connection and stays until the next transaction sets its own.
            let pragma = format!("PRAGMA max_page_count = {max_pages}");
            sqlx::query(sqlx::AssertSqlSafe(pragma)).execute(&mut *transaction).await?;
        }
        Ok(transaction)
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

/// Locks the database against other processes of the service, each of which would treat the others' running jobs as
/// lost.
fn lock(database: &Path) -> Result<File, OpenError> {
    let path = with_suffix(database, ".lock");
    if database.is_dir() {
        return Err(OpenError::NotAFile(database.to_owned()));
    }
    // The error about a missing directory names the database, others the lock file.
    let lock_error = |error: std::io::Error| match OpenError::of_file(&path, error) {
        OpenError::NoDirectory(_) => OpenError::NoDirectory(database.to_owned()),
        other => other,
    };
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(&path).map_err(lock_error)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(std::fs::TryLockError::WouldBlock) => Err(OpenError::InUse(database.to_owned())),
        Err(std::fs::TryLockError::Error(source)) => Err(OpenError::of_file(&path, source)),
    }
}

/// Copies the database before an upgrade, as older versions of the service do not read the new schema.
async fn copy_before_upgrade(path: &Path, to: i64) -> Result<(), OpenError> {
    let copy = with_suffix(path, &format!(".before-schema-{to}"));
    let copied = backup::copy(path, &copy).await.map_err(|error| match error {
        backup::BackupError::Database { source, .. } => OpenError::of_database(path, source),
        backup::BackupError::File { path, source } => OpenError::of_file(&path, source),
        other => OpenError::Upgrade { path: path.to_owned(), to, source: Box::new(other) },
    })?;
    tracing::info!(copy = %copy.display(), bytes = copied.bytes, "copy made before the upgrade of the database");
    Ok(())
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
