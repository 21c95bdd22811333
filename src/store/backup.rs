//! Copies of a database that is in use: a consistent snapshot, checked, and renamed to its target only when it is
//! complete.

use super::examine::{open_read_only, with_suffix};
use super::file::{self, FileId, JOURNAL, LOCK, SHM, WAL};
use super::open_error::OpenError;
use sqlx::{Connection, Row, SqliteConnection};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// Precedes the process id in the name of an unfinished copy.
const PARTIAL: &str = ".partial-";

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
    #[error("{path} belongs to the database: name another file", path = .0.display())]
    PartOfDatabase(PathBuf),
    #[error(
        "{path} is open in a herringbone under another name, beside which its log lies: the copy would lack what is in \
         the log; give that name with --database",
        path = .0.display()
    )]
    OpenElsewhere(PathBuf),
    #[error(transparent)]
    Unusable(OpenError),
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
    let database = &usable_source(database)?;
    refuse_own_file(database, target)?;
    if with_suffix(target, WAL).exists() || with_suffix(target, JOURNAL).exists() {
        return Err(BackupError::TargetInUse(target.to_owned()));
    }
    if target.exists() && !force {
        return Err(BackupError::Exists(target.to_owned()));
    }
    remove_partial_copies(target);
    copy(database, target).await
}

/// The file of a database that can be copied, without symbolic links: one whose log is found beside it.
fn usable_source(database: &Path) -> Result<PathBuf, BackupError> {
    let path = file::without_link(database).map_err(BackupError::Unusable)?;
    // SQLite would take the log of a missing or empty database for rubbish.
    file::refuse_orphaned_log(&path).map_err(BackupError::Unusable)?;
    let of_file = |source| BackupError::File { path: path.clone(), source };
    match fs::metadata(&path) {
        Ok(metadata) if metadata.is_file() => {
            file::refuse_several_names(&path, &metadata).map_err(BackupError::Unusable)?;
        }
        _ => return Err(BackupError::NoDatabase(path)),
    }
    if file::is_locked(&path).map_err(of_file)? && !with_suffix(&path, WAL).exists() {
        return Err(BackupError::OpenElsewhere(path));
    }
    Ok(path)
}

/// Refuses a target that is the database or a file beside it, under whatever name, existing or not.
fn refuse_own_file(database: &Path, target: &Path) -> Result<(), BackupError> {
    let target_id = FileId::at(target);
    let target_name = absolute(target);
    let is_target =
        |own: &Path| target_name == absolute(own) || target_id.is_some_and(|id| FileId::at(own) == Some(id));
    if is_target(database) {
        return Err(BackupError::SameFile(target.to_owned()));
    }
    if [WAL, SHM, JOURNAL, LOCK].iter().any(|suffix| is_target(&with_suffix(database, suffix))) {
        return Err(BackupError::PartOfDatabase(target.to_owned()));
    }
    Ok(())
}

/// The path with its directory resolved; the file need not exist.
fn absolute(path: &Path) -> PathBuf {
    let resolved = fs::canonicalize(directory(path)).map(|folder| folder.join(path.file_name().unwrap_or_default()));
    resolved.unwrap_or_else(|_| path.to_owned())
}

/// The directory of a file.
fn directory(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes the unfinished copies for this target, and for this target with a number, that killed processes left behind:
/// those that nobody has locked.
pub(super) fn remove_partial_copies(target: &Path) {
    let Some(name) = target.file_name() else { return };
    let Ok(entries) = fs::read_dir(directory(target)) else { return };
    for entry in entries.filter_map(Result::ok).filter(|entry| is_partial_of(&entry.file_name(), name)) {
        let path = entry.path();
        let file = OpenOptions::new().write(true).open(&path);
        if file.is_ok_and(|file| file::try_lock(&file).unwrap_or(false)) {
            let _ = fs::remove_file(with_suffix(&path, JOURNAL));
            if fs::remove_file(&path).is_ok() {
                tracing::info!(path = %path.display(), "unfinished copy removed");
            }
        }
    }
}

/// Whether a file is named `TARGET.partial-PID`, or so with a number behind `TARGET`.
fn is_partial_of(name: &OsStr, target: &OsStr) -> bool {
    let (Some(name), Some(target)) = (name.to_str(), target.to_str()) else { return false };
    let Some((number, process)) = name.strip_prefix(target).and_then(|rest| rest.rsplit_once(PARTIAL)) else {
        return false;
    };
    let is_digit = |byte: u8| byte.is_ascii_digit();
    number.bytes().all(|byte| is_digit(byte) || byte == b'.') && !process.is_empty() && process.bytes().all(is_digit)
}

/// Whether a copy has the same jobs in the same states as the database, as far as their numbers tell: every change of a
/// job increases its revision. A file that cannot be read as a database has not.
///
/// # Errors
/// The database cannot be read.
pub(super) async fn has_same_jobs(database: &Path, copy: &Path) -> Result<bool, BackupError> {
    let ours = job_marks(database).await.map_err(|source| of_database(database, source))?;
    Ok(job_marks(copy).await.is_ok_and(|theirs| theirs == ours))
}

/// Number, largest id and sum of revisions of the jobs, and number of events.
async fn job_marks(database: &Path) -> Result<(i64, Option<String>, Option<i64>, i64), sqlx::Error> {
    let mut connection = open_read_only(database).await?;
    let marks = sqlx::query_as("SELECT COUNT(*), MAX(id), SUM(revision), (SELECT COUNT(*) FROM job_events) FROM jobs");
    let marks = marks.fetch_one(&mut connection).await?;
    connection.close().await?;
    Ok(marks)
}

/// Copies as [`backup`] does, replacing a file at `target`.
///
/// # Errors
/// [`BackupError`].
pub(super) async fn copy(database: &Path, target: &Path) -> Result<BackupSummary, BackupError> {
    let partial = PartialFile(with_suffix(target, &format!("{PARTIAL}{}", std::process::id())));
    let of_file = |path: &Path, source| BackupError::File { path: path.to_owned(), source };
    // Created here, as the message of SQLite for a missing directory does not name it, and locked while it grows. Where
    // there are no locks, it is not.
    let locked = File::create(&partial.0).map_err(|source| of_file(target, source))?;
    let _ = file::try_lock(&locked);
    vacuum_into(database, &partial.0).await.map_err(|source| of_database(database, source))?;
    let jobs = verify_copy(database, &partial.0).await?;
    let file = File::open(&partial.0).map_err(|source| of_file(&partial.0, source))?;
    file.sync_all().map_err(|source| of_file(&partial.0, source))?;
    let bytes = file.metadata().map_err(|source| of_file(&partial.0, source))?.len();
    fs::rename(&partial.0, target).map_err(|source| of_file(target, source))?;
    let folder = directory(target);
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
