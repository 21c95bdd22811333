//! What is kept: jobs, their history, results, series and reusable stages, in SQLite. The only SQL.
//!
//! Invariant: every transition of a job is one guarded `UPDATE` (of a running job: fenced by its `attempt`) in one
//! transaction with its row in `job_events`. A terminal state is final; a result row exists exactly when the job
//! succeeded, an error exactly when it failed.

mod backup;
mod cancel;
mod connect;
mod error;
mod examine;
mod failure;
mod finish;
mod ids;
mod lifecycle;
mod list;
mod lookup;
mod open_error;
mod points;
mod probe;
mod record;
mod result;
mod retention;
mod run;
mod series;
mod stages;
mod submit;
mod usage;
mod waiting;

pub use backup::{Backup, BackupError, backup};
pub use cancel::{Cancellation, Deletion};
pub use connect::{Store, StoreConfig};
pub use error::{StoreError, Unavailable};
pub use failure::Failure;
pub use finish::Completion;
pub use lifecycle::{JobId, State};
pub use list::{JobFilter, JobPage};
pub use lookup::Counts;
pub use open_error::OpenError;
pub use points::{LineEndRow, PointBatch, PointRow, PointsDigest, PointsOfResult};
pub use record::JobRecord;
pub use result::{Reusable, StoredResult};
pub use retention::RetentionConfig;
pub use run::{Claim, Pause, Recovery, WorkClass};
pub use series::{PackedSeries, SeriesEntry};
pub use submit::{NewJob, Submission};
pub use usage::Usage;

#[cfg(test)]
mod tests;
