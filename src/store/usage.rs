//! The size of the database, and returning free space to the file system.

use super::connect::{Store, StoreError};
use super::examine::with_suffix;
use super::file::WAL;
use sqlx::{Row, SqliteConnection};
use std::time::Duration;

/// Pages returned in one statement (8 MB at the default page size, tens of milliseconds).
const VACUUM_PAGES: u32 = 2000;
/// Longest wait for readers when the log is truncated; writers are blocked meanwhile.
const CHECKPOINT_WAIT: Duration = Duration::from_millis(200);

/// The size of the database, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DatabaseUsage {
    /// Pages with content.
    pub used_bytes: u64,
    /// The file: pages with content and free pages. Recent content may still be in the log.
    pub file_bytes: u64,
    /// The write-ahead log.
    pub log_bytes: u64,
}

impl DatabaseUsage {
    /// Free pages of the file.
    pub fn free_bytes(&self) -> u64 {
        self.file_bytes - self.used_bytes
    }
}

impl Store {
    /// Reads the size of the database.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn usage(&self) -> Result<DatabaseUsage, StoreError> {
        let mut reader = self.reader.acquire().await?;
        let (pages, free, page_bytes) = page_numbers(&mut reader).await?;
        let log_bytes = std::fs::metadata(with_suffix(self.file.path(), WAL)).map_or(0, |log| log.len());
        let (file_bytes, used_bytes) = (pages * page_bytes, pages.saturating_sub(free) * page_bytes);
        Ok(DatabaseUsage { used_bytes, file_bytes, log_bytes })
    }

    /// Shortens the file by its free pages, in small steps, and truncates the log. A file created without `auto_vacuum`
    /// keeps its length; its free pages are reused.
    ///
    /// # Errors
    /// The database cannot be written, or its file was moved or deleted.
    pub async fn release_space(&self) -> Result<(), StoreError> {
        self.check_file()?;
        let mut last_free = u64::MAX;
        loop {
            let mut writer = self.writer.acquire().await?;
            let (_, free, _) = page_numbers(&mut writer).await?;
            if free == 0 || free >= last_free {
                break;
            }
            last_free = free;
            let statement = sqlx::AssertSqlSafe(format!("PRAGMA incremental_vacuum({VACUUM_PAGES})"));
            sqlx::query(statement).execute(&mut *writer).await?;
        }
        self.truncate_log().await
    }

    async fn truncate_log(&self) -> Result<(), StoreError> {
        let mut writer = self.writer.acquire().await?;
        let before = sqlx::query("PRAGMA busy_timeout").fetch_one(&mut *writer).await?.try_get::<i64, _>(0)?;
        set_busy_timeout(&mut writer, i64::try_from(CHECKPOINT_WAIT.as_millis()).unwrap_or(before)).await?;
        // A busy checkpoint is not an error: the rest is left for the next time.
        let done = sqlx::query("PRAGMA wal_checkpoint(TRUNCATE)").execute(&mut *writer).await;
        set_busy_timeout(&mut writer, before).await?;
        done?;
        Ok(())
    }
}

async fn set_busy_timeout(connection: &mut SqliteConnection, milliseconds: i64) -> Result<(), StoreError> {
    let statement = sqlx::AssertSqlSafe(format!("PRAGMA busy_timeout = {milliseconds}"));
    sqlx::query(statement).execute(connection).await?;
    Ok(())
}

/// Number of pages, number of free pages, and the size of a page in bytes.
async fn page_numbers(connection: &mut SqliteConnection) -> Result<(u64, u64, u64), StoreError> {
    let row = sqlx::query(
        "SELECT (SELECT page_count FROM pragma_page_count), (SELECT freelist_count FROM pragma_freelist_count), \
         (SELECT page_size FROM pragma_page_size)",
    )
    .fetch_one(connection)
    .await?;
    let number = |index: usize| row.try_get::<i64, _>(index).map(i64::unsigned_abs);
    Ok((number(0)?, number(1)?, number(2)?))
}
