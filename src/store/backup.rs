//! Copies of a database that is in use: a consistent snapshot, checked, and renamed to its target only when it is
//! complete.

use super::examine::{open_read_only, with_suffix};
use sqlx::{Connection, Row, SqliteConnection};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Size and content of a finished copy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BackupSummary {
    pub bytes: u64,
    /// Number of jobs by state.
    pub jobs: BTreeMap<String, u64>,
}

/// Failure to copy a database. A file at the target is then unchanged.
#[derive(Debug, thiserror::Error)]
pub enum BackupError {
    #[error("there is no database {path}", path = .0.display())]
    NoDatabase(PathBuf),
    #[error("{path} is not a database of herringbone", path = .0.display())]
    NotOurs(PathBuf),
    #[error("{path} exists: name another file, or overwrite it with --force", path = .0.display())]
    Exists(PathBuf),
    #[error("{path} is the database itself", path = .0.display())]
    SameFile(PathBuf),
    #[error("{path} is a database in use, or was not closed: its log {path}-wal would spoil the copy", path = .0.display())]
    TargetInUse(PathBuf),
    #[error("the copy is not sound ({finding}): the database {path} is damaged, or the disk", path = .path.display())]
    Damaged { path: PathBuf, finding: String },
    #[error("{path}: {source}", path = .path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("{path} was not copied: {source}", path = .path.display())]
    Database { path: PathBuf, source: sqlx::Error },
}

/// Copies the database at `database` to the file `target`, also while a service writes to it.
///
/// # Errors
/// [`BackupError`].
pub async fn backup(database: &Path, target: &Path, force: bool) -> Result<BackupSummary, BackupError> {
    if !database.is_file() {
        return Err(BackupError::NoDatabase(database.to_owned()));
    }
    if let (Ok(from), Ok(to)) = (database.canonicalize(), target.canonicalize())
        && from == to
    {
        return Err(BackupError::SameFile(target.to_owned()));
    }
    if with_suffix(target, "-wal").exists() || with_suffix(target, "-journal").exists() {
        return Err(BackupError::TargetInUse(target.to_owned()));
    }
    if target.exists() && !force {
        return Err(BackupError::Exists(target.to_owned()));
    }
    copy(database, target).await
}

/// Copies as [`backup`] does, replacing a file at `target`.
///
/// # Errors
/// [`BackupError`].
pub(super) async fn copy(database: &Path, target: &Path) -> Result<BackupSummary, BackupError> {
    let partial = PartialFile(with_suffix(target, &format!(".partial-{}", std::process::id())));
    let of_file = |path: &Path, source| BackupError::File { path: path.to_owned(), source };
    // Created here, as the message of SQLite for a missing directory does not name it.
    File::create(&partial.0).map_err(|source| of_file(target, source))?;
    vacuum_into(database, &partial.0).await.map_err(|source| of_database(database, source))?;
    let jobs = verify_copy(database, &partial.0).await?;
    let file = File::open(&partial.0).map_err(|source| of_file(&partial.0, source))?;
    file.sync_all().map_err(|source| of_file(&partial.0, source))?;
    let bytes = file.metadata().map_err(|source| of_file(&partial.0, source))?.len();
    fs::rename(&partial.0, target).map_err(|source| of_file(target, source))?;
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    File::open(folder).and_then(|folder| folder.sync_all()).map_err(|source| of_file(folder, source))?;
    Ok(BackupSummary { bytes, jobs })
}

/// The path of an unfinished copy, removed when dropped.
struct PartialFile(PathBuf);

impl Drop for PartialFile {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Copies with `VACUUM INTO`, which reads one snapshot and does not block writers.
async fn vacuum_into(database: &Path, target: &Path) -> Result<(), sqlx::Error> {
    let mut connection = open_read_only(database).await?;
    let target = target.to_str().ok_or_else(|| sqlx::Error::Configuration("the path is not UTF-8".into()))?;
    sqlx::query("VACUUM INTO $1").bind(target).execute(&mut connection).await?;
    connection.close().await
}

/// Checks the integrity of a copy and counts its jobs.
async fn verify_copy(database: &Path, copy: &Path) -> Result<BTreeMap<String, u64>, BackupError> {
    let mut connection = open_read_only(copy).await.map_err(|source| of_database(database, source))?;
    let finding = integrity_error(&mut connection).await.map_err(|source| of_database(database, source))?;
    if let Some(finding) = finding {
        return Err(BackupError::Damaged { path: database.to_owned(), finding });
    }
    let jobs = count_jobs(&mut connection).await.map_err(|_| BackupError::NotOurs(database.to_owned()))?;
    connection.close().await.map_err(|source| of_database(database, source))?;
    Ok(jobs)
}

/// The first error of SQLite's integrity check, or of the foreign keys; `None` for a sound database.
async fn integrity_error(connection: &mut SqliteConnection) -> Result<Option<String>, sqlx::Error> {
    let row = sqlx::query("PRAGMA integrity_check(1)").fetch_one(&mut *connection).await?;
    let answer: String = row.try_get(0)?;
    if answer != "ok" {
        return Ok(Some(answer.lines().next_back().unwrap_or_default().to_owned()));
    }
    let orphan = sqlx::query("PRAGMA foreign_key_check").fetch_optional(&mut *connection).await?;
    orphan.map(|row| Ok(format!("a row of {} without its job", row.try_get::<String, _>(0)?))).transpose()
}

async fn count_jobs(connection: &mut SqliteConnection) -> Result<BTreeMap<String, u64>, sqlx::Error> {
    let rows = sqlx::query("SELECT state, COUNT(*) AS n FROM jobs GROUP BY state").fetch_all(connection).await?;
    rows.iter().map(|row| Ok((row.try_get("state")?, row.try_get::<i64, _>("n")?.unsigned_abs()))).collect()
}

fn of_database(path: &Path, source: sqlx::Error) -> BackupError {
    BackupError::Database { path: path.to_owned(), source }
}
