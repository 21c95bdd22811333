//! Which failures of the database pass: it may be asked again.

use super::connect::StoreError;

/// Primary result codes of SQLite: busy, locked, out of memory, read-only, I/O error, full, cannot open.
const PASSING: [i32; 7] = [5, 6, 7, 8, 10, 13, 14];

impl StoreError {
    /// Whether the same request can succeed later: no room on the disk, a failing or read-only file system, a lock held by
    /// someone else. Nothing was changed.
    pub fn is_unavailable(&self) -> bool {
        match self {
            StoreError::Database(sqlx::Error::Database(error)) => {
                // Extended codes hold the primary one in their lowest byte.
                let code = error.code().and_then(|code| code.parse::<i32>().ok());
                code.is_some_and(|code| PASSING.contains(&(code & 0xff)))
            }
            StoreError::Database(sqlx::Error::PoolTimedOut | sqlx::Error::Io(_)) => true,
            _ => false,
        }
    }
}
