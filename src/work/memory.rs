//! The memory limit of a job.

use super::config::WorkConfig;
use herringbone_job::document::JobDocument;
use herringbone_job::study::demand;
use herringbone_job::{DocumentError, Violation};

/// The memory limit, and the number of threads on which the estimate depends.
#[derive(Debug, Clone, Copy)]
pub(super) struct MemoryLimit {
    limit_mib: u32,
    threads: usize,
}

impl MemoryLimit {
    pub(super) fn new(config: &WorkConfig) -> Self {
        Self { limit_mib: config.job_memory_mib, threads: config.thread_count() }
    }

    /// Checks the estimated memory of a document against the limit.
    ///
    /// # Errors
    /// [`DocumentError::Invalid`] with a pointer to the field that needs most of the memory.
    pub(super) fn check(&self, document: &JobDocument) -> Result<(), DocumentError> {
        let (demand, limit_mib) = (demand(document, self.threads), self.limit_mib);
        let total_mib = demand.total_mib();
        if total_mib <= f64::from(limit_mib) {
            return Ok(());
        }
        let detail =
            format!("needs about {total_mib:.0} MiB of memory; this service permits {limit_mib} MiB for one job");
        let violation = Violation::new(demand.largest(), "out-of-range", detail);
        Err(DocumentError::Invalid(vec![violation]))
    }
}
