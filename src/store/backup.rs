//! A copy of the database while it is in use: one moment of it, checked, under its name only when it is whole.

use super::examine::{beside, read_only};
use sqlx::{Connection, Row, SqliteConnection};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// A finished copy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Backup {
    pub bytes: u64,
    /// Jobs by state.
    pub jobs: BTreeMap<String, u64>,
}

/// Why there is no copy. What was at the target is still there.
#[derive(Debug, thiserror::Error)]
pub enum BackupError {
    #[error("there is no database {path}", path = .0.display())]
    NoDatabase(PathBuf),
    #[error("{path} is not a database of herringbone", path = .0.display())]
    NotOurs(PathBuf),
    #[error("{path} exists: name another file, or overwrite it with --force", path = .0.display())]
    Exists(PathBuf),
    #[error("{path} is the database itself", path = .0.display())]
    Itself(PathBuf),
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
pub async fn backup(database: &Path, target: &Path, force: bool) -> Result<Backup, BackupError> {
    if !database.is_file() {
        return Err(BackupError::NoDatabase(database.to_owned()));
    }
    if let (Ok(from), Ok(to)) = (database.canonicalize(), target.canonicalize())
        && from == to
    {
        return Err(BackupError::Itself(target.to_owned()));
    }
    if beside(target, "-wal").exists() || beside(target, "-journal").exists() {
        return Err(BackupError::TargetInUse(target.to_owned()));
    }
    if target.exists() && !force {
        return Err(BackupError::Exists(target.to_owned()));
    }
    copy(database, target).await
}

/// The same, over whatever is at `target`.
pub(super) async fn copy(database: &Path, target: &Path) -> Result<Backup, BackupError> {
    let partial = Partial(beside(target, &format!(".partial-{}", std::process::id())));
    let of_file = |path: &Path, source| BackupError::File { path: path.to_owned(), source };
    // The temporary file is made here: SQLite's words for a missing directory name none.
    File::create(&partial.0).map_err(|source| of_file(target, source))?;
    vacuum_into(database, &partial.0).await.map_err(|source| of_database(database, source))?;
    let jobs = verified(database, &partial.0).await?;
    let file = File::open(&partial.0).map_err(|source| of_file(&partial.0, source))?;
    file.sync_all().map_err(|source| of_file(&partial.0, source))?;
    let bytes = file.metadata().map_err(|source| of_file(&partial.0, source))?.len();
    fs::rename(&partial.0, target).map_err(|source| of_file(target, source))?;
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    File::open(folder).and_then(|folder| folder.sync_all()).map_err(|source| of_file(folder, source))?;
    Ok(Backup { bytes, jobs })
}

/// Removed when it is dropped before it got its name.
struct Partial(PathBuf);

impl Drop for Partial {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// `VACUUM INTO` reads one snapshot, however long it takes, and holds up nobody who writes meanwhile.
async fn vacuum_into(database: &Path, target: &Path) -> Result<(), sqlx::Error> {
    let mut connection = read_only(database).await?;
    let target = target.to_str().ok_or_else(|| sqlx::Error::Configuration("the path is not UTF-8".into()))?;
    sqlx::query("VACUUM INTO $1").bind(target).execute(&mut connection).await?;
    connection.close().await
}

async fn verified(database: &Path, copy: &Path) -> Result<BTreeMap<String, u64>, BackupError> {
    let mut connection = read_only(copy).await.map_err(|source| of_database(database, source))?;
    let finding = finding(&mut connection).await.map_err(|source| of_database(database, source))?;
    if let Some(finding) = finding {
        return Err(BackupError::Damaged { path: database.to_owned(), finding });
    }
    let jobs = counts(&mut connection).await.map_err(|_| BackupError::NotOurs(database.to_owned()))?;
    connection.close().await.map_err(|source| of_database(database, source))?;
    Ok(jobs)
}

async fn finding(connection: &mut SqliteConnection) -> Result<Option<String>, sqlx::Error> {
    let row = sqlx::query("PRAGMA integrity_check(1)").fetch_one(&mut *connection).await?;
    let answer: String = row.try_get(0)?;
    if answer != "ok" {
        return Ok(Some(answer.lines().next_back().unwrap_or_default().to_owned()));
    }
    let orphan = sqlx::query("PRAGMA foreign_key_check").fetch_optional(&mut *connection).await?;
    orphan.map(|row| Ok(format!("a row of {} without its job", row.try_get::<String, _>(0)?))).transpose()
}

async fn counts(connection: &mut SqliteConnection) -> Result<BTreeMap<String, u64>, sqlx::Error> {
    let rows = sqlx::query("SELECT state, COUNT(*) AS n FROM jobs GROUP BY state").fetch_all(connection).await?;
    rows.iter().map(|row| Ok((row.try_get("state")?, row.try_get::<i64, _>("n")?.unsigned_abs()))).collect()
}

fn of_database(path: &Path, source: sqlx::Error) -> BackupError {
    BackupError::Database { path: path.to_owned(), source }
}
