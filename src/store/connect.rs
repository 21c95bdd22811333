//! Opening the database: one writer connection, read-only readers, WAL.

use super::backup;
pub use super::error::StoreError;
use super::examine::{OPEN_WAIT, beside, examine};
use super::ids::Ids;
use super::open_error::OpenError;
use super::probe::Probe;
use super::retention::{Limit, RetentionConfig};
use super::waiting::Waiting;
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

/// The migrations, embedded.
pub(super) static MIGRATIONS: Migrator = sqlx::migrate!("./migrations");

/// How long a statement waits for a lock of another program.
const BUSY_WAIT: Duration = Duration::from_secs(10);
/// How long a caller waits for the one connection that writes.
const WRITER_WAIT: Duration = Duration::from_secs(15);
/// The log keeps this much room after its content has gone into the file.
const LOG_BYTES: u64 = 64 << 20;

/// Where the data is kept.
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
    pub(super) waiting: Waiting,
    pub(super) ids: Ids,
    pub(super) limit: Option<Limit>,
    pub(super) path: Arc<Path>,
    pub(super) pressed: Arc<Notify>,
    pub(super) probe: Arc<Mutex<Option<Probe>>>,
    _lock: Arc<File>,
}

impl Store {
    /// Opens the database, creates it when missing and applies the migrations; an existing one is copied before.
    ///
    /// # Errors
    /// Why it was not opened; it is then as it was before.
    pub async fn open(config: &StoreConfig) -> Result<Self, OpenError> {
        Self::open_with(config, &MIGRATIONS).await
    }

    pub(super) async fn open_with(config: &StoreConfig, migrations: &Migrator) -> Result<Self, OpenError> {
        let path = config.database.as_path();
        let lock = lock(path)?;
        let found = examine(path, migrations).await?;
        let wrong = |error| OpenError::of_database(path, error);
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
            keep_copy(path, to).await?;
        }
        if found.schema.is_none() || found.upgrade_to.is_some() {
            // Only heeded before the first table; on an existing file it would be one more write.
            let new = found.schema.is_none().then_some(SqliteAutoVacuum::Incremental);
            let options = new.into_iter().fold(options.clone(), SqliteConnectOptions::auto_vacuum);
            let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.map_err(wrong)?;
            let applied = migrations.run(&pool).await;
            pool.close().await;
            applied.map_err(|error| not_upgraded(path, migrations, error))?;
        }
        let options = options.busy_timeout(BUSY_WAIT);
        let lasting = || SqlitePoolOptions::new().idle_timeout(None).max_lifetime(None);
        // Where SQLite rolls back by itself (a full disk at the commit), the driver goes on counting the transaction: such a
        // connection would never write again.
        let writer = lasting()
            .max_connections(1)
            .acquire_timeout(WRITER_WAIT)
            .before_acquire(|connection, _| Box::pin(async { Ok(!connection.is_in_transaction()) }));
        let writer = writer.connect_with(options.clone()).await.map_err(wrong)?;
        try_to_write(&writer).await.map_err(wrong)?;
        let reader = lasting()
            .max_connections(config.database_readers)
            .connect_with(options.read_only(true).create_if_missing(false))
            .await
            .map_err(wrong)?;
        let stage_cache_bytes = (i64::from(config.stage_cache_mib) << 20).min(Limit::stages(limit.as_ref()));
        let waiting = Waiting::counted(&writer).await.map_err(wrong)?;
        let ids = Ids::after_stored(&writer).await.map_err(wrong)?;
        Ok(Self {
            writer,
            reader,
            stage_cache_bytes,
            waiting,
            ids,
            limit,
            path: path.into(),
            pressed: Arc::default(),
            probe: Arc::default(),
            _lock: Arc::new(lock),
        })
    }

    /// Begins a transaction that changes what is there, and may do so when there is no room for [`Store::write_more`]:
    /// nothing could be canceled or deleted otherwise.
    pub(super) async fn write(&self) -> Result<Transaction<'static, Sqlite>, StoreError> {
        self.write_up_to(self.limit.as_ref().map(|limit| limit.max_pages_in_need)).await
    }

    /// Begins a transaction that adds documents, rows or results.
    pub(super) async fn write_more(&self) -> Result<Transaction<'static, Sqlite>, StoreError> {
        self.write_up_to(self.limit.as_ref().map(|limit| limit.max_pages)).await
    }

    async fn write_up_to(&self, max_pages: Option<u64>) -> Result<Transaction<'static, Sqlite>, StoreError> {
        let mut transaction = self.writer.begin_with("BEGIN IMMEDIATE").await?;
        if let Some(max_pages) = max_pages {
            // The bound is the connection's and stays until the next transaction sets its own.
            let pragma = format!("PRAGMA max_page_count = {max_pages}");
            sqlx::query(sqlx::AssertSqlSafe(pragma)).execute(&mut *transaction).await?;
        }
        Ok(transaction)
    }

    /// Whether the database answers.
    pub async fn ping(&self) -> Result<(), StoreError> {
        sqlx::query("SELECT 1").execute(&self.reader).await?;
        Ok(())
    }

    /// Closes every connection; what was committed is on disk.
    pub async fn close(&self) {
        self.reader.close().await;
        self.writer.close().await;
    }
}

/// Two processes on one database would each take the other's running jobs for lost ones.
fn lock(database: &Path) -> Result<File, OpenError> {
    let path = beside(database, ".lock");
    if database.is_dir() {
        return Err(OpenError::NotAFile(database.to_owned()));
    }
    // A missing directory is the database's, a forbidden file may be the lock's alone.
    let wrong = |error: std::io::Error| match OpenError::of_file(&path, error) {
        OpenError::NoDirectory(_) => OpenError::NoDirectory(database.to_owned()),
        other => other,
    };
    let file = OpenOptions::new().write(true).create(true).truncate(false).open(&path).map_err(wrong)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(std::fs::TryLockError::WouldBlock) => Err(OpenError::InUse(database.to_owned())),
        Err(std::fs::TryLockError::Error(source)) => Err(OpenError::of_file(&path, source)),
    }
}

/// The way back: an older herringbone does not read the new schema.
async fn keep_copy(path: &Path, to: i64) -> Result<(), OpenError> {
    let copy = beside(path, &format!(".before-schema-{to}"));
    let copied = backup::copy(path, &copy).await.map_err(|error| match error {
        backup::BackupError::Database { source, .. } => OpenError::of_database(path, source),
        backup::BackupError::File { path, source } => OpenError::of_file(&path, source),
        other => OpenError::Upgrade { path: path.to_owned(), to, source: Box::new(other) },
    })?;
    tracing::info!(copy = %copy.display(), bytes = copied.bytes, "copy made before the upgrade of the database");
    Ok(())
}

fn not_upgraded(path: &Path, migrations: &Migrator, error: MigrateError) -> OpenError {
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

/// A file that may not be written, or is locked by another program, stops the start instead of the first job.
async fn try_to_write(writer: &SqlitePool) -> Result<(), sqlx::Error> {
    writer.begin_with("BEGIN IMMEDIATE").await?.rollback().await
}
