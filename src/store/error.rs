//! Errors of the open database.

use std::fmt;

/// Failure of an operation on the database.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("database: {0}")]
    Database(sqlx::Error),
    #[error("{cause}: {detail}")]
    Unavailable { cause: Unavailable, detail: String },
    #[error("the database has reached its size limit: {used_mb} MB used, new jobs up to {limit_mb} MB")]
    LimitReached { used_mb: u64, limit_mb: u64 },
    #[error("stored {what} cannot be read: {detail}")]
    Corrupt { what: &'static str, detail: String },
}

/// A temporary cause outside the service.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unavailable {
    /// The disk is full, or the database's limit is reached.
    Full,
    /// Another program holds the database.
    Busy,
    /// The disk did not read or write.
    Disk,
    /// The file or its directory may not be written.
    ReadOnly,
    /// There was not enough memory.
    Memory,
    /// The file, or its log, was moved or deleted.
    Lost,
}

impl fmt::Display for Unavailable {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Unavailable::Full => "the disk or the database is full",
            Unavailable::Busy => "the database is locked by another program",
            Unavailable::Disk => "the disk failed to read or write",
            Unavailable::ReadOnly => "the database may not be written",
            Unavailable::Memory => "there is not enough memory",
            Unavailable::Lost => "a file of the database was moved or deleted",
        })
    }
}

impl StoreError {
    /// The temporary cause, if there is one.
    pub fn unavailable(&self) -> Option<Unavailable> {
        match self {
            StoreError::Unavailable { cause, .. } => Some(*cause),
            StoreError::LimitReached { .. } => Some(Unavailable::Full),
            StoreError::Database(_) | StoreError::Corrupt { .. } => None,
        }
    }
}

impl From<sqlx::Error> for StoreError {
    fn from(source: sqlx::Error) -> Self {
        match temporary_cause(&source) {
            Some(cause) => StoreError::Unavailable { cause, detail: source.to_string() },
            None => StoreError::Database(source),
        }
    }
}

fn temporary_cause(error: &sqlx::Error) -> Option<Unavailable> {
    match error {
        // The holder of the connection that writes waits for another program.
        sqlx::Error::PoolTimedOut => return Some(Unavailable::Busy),
        sqlx::Error::Io(_) => return Some(Unavailable::Disk),
        _ => {}
    }
    if is_no_room(error) {
        return Some(Unavailable::Full);
    }
    match primary_code(error)? {
        SQLITE_BUSY | SQLITE_LOCKED => Some(Unavailable::Busy),
        SQLITE_NOMEM => Some(Unavailable::Memory),
        SQLITE_READONLY => Some(Unavailable::ReadOnly),
        SQLITE_IOERR | SQLITE_CANTOPEN => Some(Unavailable::Disk),
        _ => None,
    }
}

// Primary result codes (sqlite.org/rescode.html).
pub(super) const SQLITE_BUSY: i32 = 5;
pub(super) const SQLITE_LOCKED: i32 = 6;
const SQLITE_NOMEM: i32 = 7;
pub(super) const SQLITE_READONLY: i32 = 8;
pub(super) const SQLITE_INTERRUPT: i32 = 9;
pub(super) const SQLITE_IOERR: i32 = 10;
pub(super) const SQLITE_CORRUPT: i32 = 11;
const SQLITE_FULL: i32 = 13;
pub(super) const SQLITE_CANTOPEN: i32 = 14;
pub(super) const SQLITE_NOTADB: i32 = 26;

/// The index of the write-ahead log could not be extended.
const SQLITE_IOERR_SHMSIZE: i32 = SQLITE_IOERR | 19 << 8;

/// The primary result code of SQLite.
pub(super) fn primary_code(error: &sqlx::Error) -> Option<i32> {
    extended_code(error).map(|code| code & 0xff)
}

/// Whether an error of SQLite means that the disk is full, or the database by its limit.
pub(super) fn is_no_room(error: &sqlx::Error) -> bool {
    extended_code(error).is_some_and(|code| code & 0xff == SQLITE_FULL || code == SQLITE_IOERR_SHMSIZE)
}

fn extended_code(error: &sqlx::Error) -> Option<i32> {
    error.as_database_error()?.code()?.parse().ok()
}
