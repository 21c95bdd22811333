//! Errors of opening a database. Each message is one sentence with the path and a remedy.

use super::error::{
    SQLITE_BUSY, SQLITE_CANTOPEN, SQLITE_CORRUPT, SQLITE_LOCKED, SQLITE_NOTADB, SQLITE_READONLY, is_no_room,
    primary_code,
};
use std::io;
use std::path::{Path, PathBuf};

/// Failure to open a database; the file is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("the database {path} is not a file: name a file, for example {path}/herringbone.db", path = .0.display())]
    NotAFile(PathBuf),
    #[error("the directory of the database {path} does not exist: create it, or name another file", path = .0.display())]
    NoDirectory(PathBuf),
    #[error("the database {path} is in use by another herringbone: stop that one, or name another file", path = .0.display())]
    InUse(PathBuf),
    #[error(
        "the file system of {path} has no locks ({source}), so that two services could not be kept apart: put the \
         database on a local disk",
        path = .path.display()
    )]
    NoLocks { path: PathBuf, source: io::Error },
    #[error(
        "the database {path} is a link to {target}, which does not exist: put the file there (is its disk mounted?), \
         or remove the link",
        path = .path.display(), target = .target.display()
    )]
    BrokenLink { path: PathBuf, target: PathBuf },
    #[error(
        "the database {path} has {names} names (hard links), and its log is found under one of them only: keep the \
         name that has a file -wal beside it, or any one when none has, and remove the others (find -samefile)",
        path = .path.display()
    )]
    SeveralNames { path: PathBuf, names: u64 },
    #[error(
        "the database {path} is missing or empty, but its log {log} is there, with jobs that are in no other file: put \
         the database back under this name, or move the log away to begin with an empty one",
        path = .path.display(), log = .log.display()
    )]
    OrphanedLog { path: PathBuf, log: PathBuf },
    #[error("the database {path} is locked by another program: close it there, then start again", path = .0.display())]
    Locked(PathBuf),
    #[error("{path} cannot be written: give this user the right to write the database and its directory", path = .0.display())]
    ReadOnly(PathBuf),
    #[error("there is no room on the disk for the database {path}: make room, then start again", path = .0.display())]
    NoRoom(PathBuf),
    #[error("{path} is not an SQLite database: name another file, or move this one away", path = .0.display())]
    NotADatabase(PathBuf),
    #[error("{path} is a database of another program: name another file", path = .0.display())]
    Foreign(PathBuf),
    #[error(
        "the database {path} is damaged ({finding}): restore a backup, or save what can be read (docs/OPERATIONS.md)",
        path = .path.display()
    )]
    Damaged { path: PathBuf, finding: String },
    #[error(
        "the database {path} was written by a newer herringbone (schema {found}, this one knows up to {known}): start \
         that version, or restore the copy made before its upgrade",
        path = .path.display()
    )]
    Newer { path: PathBuf, found: i64, known: i64 },
    #[error(
        "the database {path} was made by another build of herringbone (its schema step {step} differs): start that \
         build, or name another file",
        path = .path.display()
    )]
    OtherBuild { path: PathBuf, step: i64 },
    #[error(
        "the upgrade of the database {path} to schema {to} failed and was taken back ({source}): start the version \
         that wrote it, and report this",
        path = .path.display()
    )]
    Upgrade { path: PathBuf, to: i64, source: Box<dyn std::error::Error + Send + Sync> },
    #[error("the database {path} cannot be opened: {source}", path = .path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("the database {path} cannot be opened: {source}", path = .path.display())]
    Database { path: PathBuf, source: sqlx::Error },
}

impl OpenError {
    /// The error of opening that an error of the file system amounts to.
    pub(super) fn of_file(path: &Path, source: io::Error) -> Self {
        let path = path.to_owned();
        match source.kind() {
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => Self::NoDirectory(path),
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => Self::ReadOnly(path),
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => Self::NoRoom(path),
            io::ErrorKind::IsADirectory => Self::NotAFile(path),
            _ => Self::File { path, source },
        }
    }

    /// The error of opening that an error of SQLite amounts to.
    pub(super) fn of_database(path: &Path, source: sqlx::Error) -> Self {
        let path = path.to_owned();
        if is_no_room(&source) {
            return Self::NoRoom(path);
        }
        match primary_code(&source) {
            Some(SQLITE_BUSY | SQLITE_LOCKED) => Self::Locked(path),
            Some(SQLITE_READONLY | SQLITE_CANTOPEN) => Self::ReadOnly(path),
            Some(SQLITE_NOTADB) => Self::NotADatabase(path),
            Some(SQLITE_CORRUPT) => Self::Damaged { path, finding: "its pages contradict each other".to_owned() },
            _ => Self::Database { path, source },
        }
    }
}
