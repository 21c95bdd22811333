//! How much room the database takes, and giving back what it no longer needs.

use super::connect::{Store, StoreError};
use super::examine::beside;
use sqlx::{Row, SqliteConnection};
use std::time::Duration;

/// Pages given back in one go: 8 MB at the usual size, tens of milliseconds.
const GIVE_BACK_PAGES: u32 = 2000;
/// How long truncating the log waits for readers, while nobody can write.
const CHECKPOINT_WAIT: Duration = Duration::from_millis(200);

/// Room that the database takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Usage {
    /// Pages with content.
    pub used_bytes: u64,
    /// The file: pages with content and free ones. Young content may still be in the log.
    pub file_bytes: u64,
    /// The write-ahead log.
    pub log_bytes: u64,
}

impl Usage {
    /// Pages that hold nothing.
    pub fn free_bytes(&self) -> u64 {
        self.file_bytes - self.used_bytes
    }
}

impl Store {
    /// How much room the database takes now.
    pub async fn usage(&self) -> Result<Usage, StoreError> {
        let mut reader = self.reader.acquire().await?;
        let (pages, free, page_bytes) = page_numbers(&mut reader).await?;
        let log_bytes = std::fs::metadata(beside(&self.path, "-wal")).map_or(0, |log| log.len());
        let (file_bytes, used_bytes) = (pages * page_bytes, pages.saturating_sub(free) * page_bytes);
        Ok(Usage { used_bytes, file_bytes, log_bytes })
    }

    /// Shortens the file by its free pages and the log to nothing, in small steps. A file made without `auto_vacuum` keeps
    /// its length; its free pages are used again.
    pub async fn give_back(&self) -> Result<(), StoreError> {
        let mut last_free = u64::MAX;
        loop {
            let mut writer = self.writer.acquire().await?;
            let (_, free, _) = page_numbers(&mut writer).await?;
            if free == 0 || free >= last_free {
                break;
            }
            last_free = free;
            let statement = sqlx::AssertSqlSafe(format!("PRAGMA incremental_vacuum({GIVE_BACK_PAGES})"));
            sqlx::query(statement).execute(&mut *writer).await?;
        }
        self.truncate_log().await
    }

    async fn truncate_log(&self) -> Result<(), StoreError> {
        let mut writer = self.writer.acquire().await?;
        let before = sqlx::query("PRAGMA busy_timeout").fetch_one(&mut *writer).await?.try_get::<i64, _>(0)?;
        set_busy_timeout(&mut writer, i64::try_from(CHECKPOINT_WAIT.as_millis()).unwrap_or(before)).await?;
        // Busy is an answer, not an error: the rest stays for the next time.
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

/// Pages, free ones among them, and the size of one.
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
