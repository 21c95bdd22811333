//! Opening the database: one writer connection, read-only readers, WAL.

use super::waiting::Waiting;
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqliteJournalMode, SqlitePool, SqlitePoolOptions, SqliteSynchronous};
use sqlx::{Sqlite, Transaction};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// The migrations, embedded.
pub(super) static MIGRATIONS: Migrator = sqlx::migrate!("./migrations");

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
}

impl StoreConfig {
    pub fn at(database: impl Into<PathBuf>) -> Self {
        Self { database: database.into(), database_readers: 2, stage_cache_mib: 256 }
    }
}

/// Why the store could not answer.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("database: {0}")]
    Database(#[from] sqlx::Error),
    #[error("database migration: {0}")]
    Migration(#[from] sqlx::migrate::MigrateError),
    #[error("the database {path} is in use by another process", path = .0.display())]
    InUse(PathBuf),
    #[error("lock file {path}: {source}", path = .path.display())]
    Lock { path: PathBuf, source: std::io::Error },
    #[error("stored {what} cannot be read: {detail}")]
    Corrupt { what: &'static str, detail: String },
}

/// The open database. Cheap to clone.
#[derive(Clone)]
pub struct Store {
    pub(super) writer: SqlitePool,
    pub(super) reader: SqlitePool,
    pub(super) stage_cache_bytes: i64,
    pub(super) waiting: Waiting,
    _lock: Arc<File>,
}

impl Store {
    /// Opens the database, creates it when missing and applies the migrations.
    ///
    /// # Errors
    /// [`StoreError::InUse`] when another process has it open.
    pub async fn open(config: &StoreConfig) -> Result<Self, StoreError> {
        let lock = lock(&config.database)?;
        let options = SqliteConnectOptions::new()
            .filename(&config.database)
            .create_if_missing(true)
            .journal_mode(SqliteJournalMode::Wal)
            .synchronous(SqliteSynchronous::Full)
            .foreign_keys(true)
            .busy_timeout(Duration::from_secs(10));
        let writer = SqlitePoolOptions::new().max_connections(1).connect_with(options.clone()).await?;
        MIGRATIONS.run(&writer).await?;
        let reader = SqlitePoolOptions::new()
            .max_connections(config.database_readers)
            .connect_with(options.read_only(true).create_if_missing(false))
            .await?;
        let stage_cache_bytes = i64::from(config.stage_cache_mib) << 20;
        let waiting = Waiting::counted(&writer).await?;
        Ok(Self { writer, reader, stage_cache_bytes, waiting, _lock: Arc::new(lock) })
    }

    /// Begins a transaction that writes.
    pub(super) async fn write(&self) -> Result<Transaction<'static, Sqlite>, StoreError> {
        Ok(self.writer.begin_with("BEGIN IMMEDIATE").await?)
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
fn lock(database: &Path) -> Result<File, StoreError> {
    let mut name = database.as_os_str().to_owned();
    name.push(".lock");
    let path = PathBuf::from(name);
    let file = File::create(&path).map_err(|source| StoreError::Lock { path: path.clone(), source })?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(std::fs::TryLockError::WouldBlock) => Err(StoreError::InUse(database.to_owned())),
        Err(std::fs::TryLockError::Error(source)) => Err(StoreError::Lock { path, source }),
    }
}
