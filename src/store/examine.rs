//! Examination of a database file before it is opened for writing; reads only.

use super::error::{SQLITE_INTERRUPT, primary_code};
use super::file::WAL;
use super::open_error::OpenError;
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection, Row};
use std::fs::{self, File, OpenOptions};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Longest wait for a lock of another program while opening.
pub(super) const OPEN_WAIT: Duration = Duration::from_secs(2);
/// Longest duration of the check after an unclean end; before an upgrade the check is not limited.
const CHECK_LIMIT: Duration = Duration::from_secs(30);
/// Virtual machine instructions of SQLite between two checks of that duration.
const CHECK_EVERY: i32 = 100_000;
/// Page size of new files (the default of SQLite).
const NEW_PAGE_BYTES: u64 = 4096;
/// Length of the header of an SQLite file (sqlite.org/fileformat.html, 1.3).
const HEADER_BYTES: usize = 100;

/// Page size and schema of a database file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Examination {
    pub page_bytes: u64,
    /// Newest schema in the file; `None` for a new or empty one.
    pub schema: Option<i64>,
    /// Newest schema that this program knows, when the file has an older one.
    pub upgrade_to: Option<i64>,
}

impl Examination {
    const NEW: Examination = Examination { page_bytes: NEW_PAGE_BYTES, schema: None, upgrade_to: None };
}

/// Examines a database file without changing it.
///
/// # Errors
/// The file cannot be used: it is no database of this service, damaged, or of an unknown schema.
pub(super) async fn examine(path: &Path, migrations: &Migrator) -> Result<Examination, OpenError> {
    let Some(length) = writable_length(path)? else { return Ok(Examination::NEW) };
    let mut header = Vec::with_capacity(HEADER_BYTES);
    let file = File::open(path).map_err(|error| OpenError::of_file(path, error))?;
    file.take(HEADER_BYTES as u64).read_to_end(&mut header).map_err(|error| OpenError::of_file(path, error))?;
    let Some(header) = Header::parse(&header) else { return Err(OpenError::NotADatabase(path.to_owned())) };
    let has_log = fs::metadata(with_suffix(path, WAL)).is_ok_and(|wal| wal.len() > 0);
    // Pages that the file lacks may be in the write-ahead log.
    if !has_log && length < header.bytes() {
        let finding = format!("{length} bytes instead of {}", header.bytes());
        return Err(OpenError::Damaged { path: path.to_owned(), finding });
    }
    let open_error = |error| OpenError::of_database(path, error);
    let mut database = open_read_only(path).await.map_err(open_error)?;
    let examination = read_schema(&mut database, path, migrations).await?;
    if has_log || examination.upgrade_to.is_some() {
        let limit = (examination.upgrade_to.is_none()).then_some(CHECK_LIMIT);
        check(&mut database, path, length, limit).await?;
    }
    database.close().await.map_err(open_error)?;
    Ok(Examination { page_bytes: header.page_bytes, ..examination })
}

/// The length of the file, `None` for a missing or empty one. Checks that it may be written without writing.
fn writable_length(path: &Path) -> Result<Option<u64>, OpenError> {
    match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => return Err(OpenError::NotAFile(path.to_owned())),
        Ok(_) => {}
        // The lock file in the same directory exists, so the directory does.
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(OpenError::of_file(path, error)),
    }
    let file = OpenOptions::new().write(true).open(path).map_err(|error| OpenError::of_file(path, error))?;
    let length = file.metadata().map_err(|error| OpenError::of_file(path, error))?.len();
    Ok((length > 0).then_some(length))
}

/// The header of an SQLite file.
struct Header {
    page_bytes: u64,
    pages: u64,
}

impl Header {
    fn parse(bytes: &[u8]) -> Option<Self> {
        let bytes: &[u8; HEADER_BYTES] = bytes.try_into().ok()?;
        let number = |at: usize| u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        let page_bytes = match u16::from_be_bytes([bytes[16], bytes[17]]) {
            1 => 65_536,
            size => u64::from(size),
        };
        // The number of pages is valid if it was written together with the change counter.
        let pages = if number(24) == number(92) { u64::from(number(28)) } else { 0 };
        (bytes.starts_with(b"SQLite format 3\0") && page_bytes >= 512).then_some(Self { page_bytes, pages })
    }

    fn bytes(&self) -> u64 {
        self.pages * self.page_bytes
    }
}

/// Opens a connection of its own that cannot write.
pub(super) async fn open_read_only(path: &Path) -> Result<SqliteConnection, sqlx::Error> {
    SqliteConnectOptions::new().filename(path).read_only(true).busy_timeout(OPEN_WAIT).connect().await
}

/// Reads the migrations applied to a database.
async fn read_schema(
    database: &mut SqliteConnection,
    path: &Path,
    migrations: &Migrator,
) -> Result<Examination, OpenError> {
    let open_error = |error| OpenError::of_database(path, error);
    let tables = sqlx::query("SELECT name FROM sqlite_schema WHERE type = 'table'").fetch_all(&mut *database).await;
    let tables = tables.map_err(open_error)?;
    if tables.is_empty() {
        return Ok(Examination::NEW);
    }
    let has = |table: &str| tables.iter().any(|row| row.try_get("name").is_ok_and(|name: String| name == table));
    if !has("_sqlx_migrations") {
        return Err(OpenError::Foreign(path.to_owned()));
    }
    let applied = sqlx::query("SELECT version, checksum, success FROM _sqlx_migrations ORDER BY version");
    let applied = applied.fetch_all(&mut *database).await.map_err(open_error)?;
    // Other programs record migrations in the same table. A file without any is one whose creation was interrupted.
    if !applied.is_empty() && !has("jobs") {
        return Err(OpenError::Foreign(path.to_owned()));
    }
    let known = migrations.iter().map(|step| step.version).max().unwrap_or_default();
    let mut schema = None;
    for row in &applied {
        let step: i64 = row.try_get("version").map_err(open_error)?;
        let checksum: Vec<u8> = row.try_get("checksum").map_err(open_error)?;
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
    Ok(Examination { schema, upgrade_to: pending.then_some(known), ..Examination::NEW })
}

/// Runs `PRAGMA quick_check`: every page is read, indexes are not compared with their tables.
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

/// The path with a suffix appended to the file name.
pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(suffix);
    PathBuf::from(name)
}
