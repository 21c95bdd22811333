//! What lies at the path, before anything there is changed: reads only.

use super::error::{SQLITE_INTERRUPT, primary_code};
use super::open_error::OpenError;
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection, Row};
use std::fs::{self, File, OpenOptions};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// How long an opening waits for a lock of another program.
pub(super) const OPEN_WAIT: Duration = Duration::from_secs(2);
/// How long the check after an unclean end may take; an upgrade waits for the whole check.
const CHECK_LIMIT: Duration = Duration::from_secs(30);
/// Steps of SQLite's machine between two looks at the clock.
const CHECK_EVERY: i32 = 100_000;
/// Page size of new files, SQLite's default.
const NEW_PAGE_BYTES: u64 = 4096;
/// Length of the header of an SQLite file (sqlite.org/fileformat.html, 1.3).
const HEADER_BYTES: usize = 100;

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Found {
    pub page_bytes: u64,
    /// Newest schema in the file; `None` for a new or empty one.
    pub schema: Option<i64>,
    /// Newest schema that this program knows, when the file has an older one.
    pub upgrade_to: Option<i64>,
}

impl Found {
    const NOTHING: Found = Found { page_bytes: NEW_PAGE_BYTES, schema: None, upgrade_to: None };
}

/// Looks at the file without changing it.
///
/// # Errors
/// Why it must not be used.
pub(super) async fn examine(path: &Path, migrations: &Migrator) -> Result<Found, OpenError> {
    let Some(length) = writable_length(path)? else { return Ok(Found::NOTHING) };
    let mut header = Vec::with_capacity(HEADER_BYTES);
    let file = File::open(path).map_err(|error| OpenError::of_file(path, error))?;
    file.take(HEADER_BYTES as u64).read_to_end(&mut header).map_err(|error| OpenError::of_file(path, error))?;
    let Some(header) = Header::read(&header) else { return Err(OpenError::NotADatabase(path.to_owned())) };
    let left_open = fs::metadata(beside(path, "-wal")).is_ok_and(|wal| wal.len() > 0);
    // With a log beside it, pages may still be there that the file lacks.
    if !left_open && length < header.bytes() {
        let finding = format!("{length} bytes instead of {}", header.bytes());
        return Err(OpenError::Damaged { path: path.to_owned(), finding });
    }
    let wrong = |error| OpenError::of_database(path, error);
    let mut database = read_only(path).await.map_err(wrong)?;
    let found = schema_of(&mut database, path, migrations).await?;
    if left_open || found.upgrade_to.is_some() {
        let limit = (found.upgrade_to.is_none()).then_some(CHECK_LIMIT);
        check(&mut database, path, length, limit).await?;
    }
    database.close().await.map_err(wrong)?;
    Ok(Found { page_bytes: header.page_bytes, ..found })
}

/// The file's length, if it has one; that it may be written is tried without writing.
fn writable_length(path: &Path) -> Result<Option<u64>, OpenError> {
    match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => return Err(OpenError::NotAFile(path.to_owned())),
        Ok(_) => {}
        // The lock file beside it was there: the directory exists.
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(OpenError::of_file(path, error)),
    }
    let file = OpenOptions::new().write(true).open(path).map_err(|error| OpenError::of_file(path, error))?;
    let length = file.metadata().map_err(|error| OpenError::of_file(path, error))?.len();
    Ok((length > 0).then_some(length))
}

struct Header {
    page_bytes: u64,
    pages: u64,
}

impl Header {
    fn read(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; HEADER_BYTES] = bytes.try_into().ok()?;
        let number = |at: usize| u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let page_bytes = match u16::from_be_bytes([bytes[16], bytes[17]]) {
            1 => 65_536,
            size => u64::from(size),
        };
        // The number of pages holds when it was written together with the change counter.
        let pages = if number(24) == number(92) { u64::from(number(28)) } else { 0 };
        (bytes.starts_with(b"SQLite format 3\0") && page_bytes >= 512).then_some(Self { page_bytes, pages })
    }

    fn bytes(&self) -> u64 {
        self.pages * self.page_bytes
    }
}

/// A connection that cannot write, beside those of the service.
pub(super) async fn read_only(path: &Path) -> Result<SqliteConnection, sqlx::Error> {
    SqliteConnectOptions::new().filename(path).read_only(true).busy_timeout(OPEN_WAIT).connect().await
}

async fn schema_of(database: &mut SqliteConnection, path: &Path, migrations: &Migrator) -> Result<Found, OpenError> {
    let wrong = |error| OpenError::of_database(path, error);
    let tables = sqlx::query("SELECT name FROM sqlite_schema WHERE type = 'table'").fetch_all(&mut *database).await;
    let tables = tables.map_err(wrong)?;
    if tables.is_empty() {
        return Ok(Found::NOTHING);
    }
    let has = |table: &str| tables.iter().any(|row| row.try_get("name").is_ok_and(|name: String| name == table));
    if !has("_sqlx_migrations") {
        return Err(OpenError::Foreign(path.to_owned()));
    }
    let applied = sqlx::query("SELECT version, checksum, success FROM _sqlx_migrations ORDER BY version");
    let applied = applied.fetch_all(&mut *database).await.map_err(wrong)?;
    // Other programs count their migrations in the same way. A file without any step is one whose making was interrupted.
    if !applied.is_empty() && !has("jobs") {
        return Err(OpenError::Foreign(path.to_owned()));
    }
    let known = migrations.iter().map(|step| step.version).max().unwrap_or_default();
    let mut schema = None;
    for row in &applied {
        let step: i64 = row.try_get("version").map_err(wrong)?;
        let checksum: Vec<u8> = row.try_get("checksum").map_err(wrong)?;
        match migrations.iter().find(|ours| ours.version == step) {
            Some(ours) if *ours.checksum == *checksum => schema = Some(step),
            None if step > known => {
                let found = applied.iter().filter_map(|row| row.try_get("version").ok()).max().unwrap_or(step);
                return Err(OpenError::Newer { path: path.to_owned(), found, known });
            }
            _ => return Err(OpenError::OtherBuild { path: path.to_owned(), step }),
        }
    }
    let pending = applied.len() < migrations.iter().count() && schema.is_some();
    Ok(Found { schema, upgrade_to: pending.then_some(known), ..Found::NOTHING })
}

/// `PRAGMA quick_check`: every page is read, indexes are not compared with their tables.
async fn check(
    database: &mut SqliteConnection,
    path: &Path,
    length: u64,
    limit: Option<Duration>,
) -> Result<(), OpenError> {
    let started = Instant::now();
    let size_mb = length / 1_000_000;
    tracing::info!(path = %path.display(), size_mb, "checking the database");
    if let Some(limit) = limit {
        let mut handle = database.lock_handle().await.map_err(|error| OpenError::of_database(path, error))?;
        handle.set_progress_handler(CHECK_EVERY, move || started.elapsed() < limit);
    }
    let answer = sqlx::query("PRAGMA quick_check(1)").fetch_one(&mut *database).await;
    let duration_ms = started.elapsed().as_secs_f64() * 1e3;
    match answer.and_then(|row| row.try_get::<String, _>(0)) {
        Ok(answer) if answer == "ok" => {
            tracing::info!(path = %path.display(), size_mb, duration_ms, "the database is sound");
            Ok(())
        }
        Ok(finding) => {
            let finding = finding.lines().next_back().unwrap_or_default().to_owned();
            Err(OpenError::Damaged { path: path.to_owned(), finding })
        }
        Err(error) if limit.is_some() && primary_code(&error) == Some(SQLITE_INTERRUPT) => {
            tracing::warn!(path = %path.display(), size_mb, duration_ms, "the check of the database was cut short");
            Ok(())
        }
        Err(error) => Err(OpenError::of_database(path, error)),
    }
}

/// The path with more at its end, as SQLite names its own.
pub(super) fn beside(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}
