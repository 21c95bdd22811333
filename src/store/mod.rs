//! The database (SQLite): jobs, their history, results, series and reusable stages. No other module contains SQL.
//!
//! Invariant: every transition of a job is one guarded `UPDATE` (of a running job: fenced by its `attempt`) in one
//! transaction with its row in `job_events`. A terminal state is final; a result row exists exactly when the job
//! succeeded, an error exactly when it failed.

mod backup;
mod cancel;
mod chunk_results;
mod chunks;
mod connect;
mod dataset;
mod describe;
mod durations;
mod error;
mod examine;
mod failure;
mod file;
mod finish;
mod headline;
mod ids;
mod lifecycle;
mod list;
mod lookup;
mod open_error;
mod points;
mod queued_count;
mod record;
mod result;
mod retention;
mod run;
mod series;
mod stages;
mod submit;
mod usage;
mod webhooks;
mod write_probe;

pub use backup::{BackupError, BackupSummary, backup};
pub use cancel::{Cancellation, Deletion};
pub use chunk_results::{ChunkContent, ChunkOutcome, ChunkResult, DropReason};
pub use chunks::{ChunkClass, ChunkKey, ChunkPart, ChunkRecord, ChunkState};
pub use connect::{Store, StoreConfig};
pub use describe::{Described, JobDescription};
pub use durations::{CalculationClass, MeasuredDuration};
pub use error::{StoreError, Unavailable};
pub use failure::Failure;
pub use finish::Completion;
pub use headline::Headline;
pub use lifecycle::{JobId, JobState};
pub use list::{JobFilter, JobListPage, JobOrder, JobSort, ListPlace, SortValue};
pub use lookup::JobCounts;
pub use open_error::OpenError;
pub use points::{EndStateRow, LineEndRow, PointBatch, PointRow, PointsDigest, RowsSummary};
pub use record::JobRecord;
pub use result::{ResultSummary, ReusableResult, StoredResult};
pub use retention::RetentionConfig;
pub use run::{Claim, Recovery, ReleaseReason, WorkClass};
pub use series::{PackedSeries, SampleBatch, SeriesEntry};
pub use submit::{NewJob, Submission};
pub use usage::DatabaseUsage;
pub use webhooks::{Delivery, DeliveryState, DeliveryTry};

#[cfg(test)]
mod tests;
