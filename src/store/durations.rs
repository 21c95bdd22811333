//! Measured durations of succeeded jobs.

use super::connect::{Store, StoreError};
use sqlx::Row;

/// Jobs among which similar ones are looked for: the newest of their kind.
const SEARCHED: u32 = 200;

/// What a job's duration depends on most: members of its stored document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CalculationClass {
    pub mesh_stiffness_source: Option<String>,
    pub fidelity: Option<String>,
    pub mesh_force: Option<String>,
    pub method: Option<String>,
}

/// Duration of a job, without the time in the queue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredDuration {
    pub wall_s: f64,
    /// Rows of a sweep, else 1.
    pub points: u64,
}

impl Store {
    /// Reads the durations of the newest succeeded jobs of a kind that were calculated by this version in the same way.
    /// Jobs that took a stored result are left out.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn durations(
        &self,
        kind: &str,
        class: &CalculationClass,
        solver_version: &str,
    ) -> Result<Vec<MeasuredDuration>, StoreError> {
        let rows = sqlx::query(
            "SELECT ended_at_us - started_at_us + computed_us AS wall_us, \
             (SELECT points_n FROM results WHERE results.job_id = newest.id) AS points_n \
             FROM (SELECT id, input, started_at_us, ended_at_us, computed_us, reused_from, solver_version FROM jobs \
                   WHERE state = 'succeeded' AND kind = $1 ORDER BY id DESC LIMIT $2) AS newest \
             WHERE reused_from IS NULL AND solver_version = $3 \
             AND json_extract(input, '$.model.mesh_stiffness.source') IS $4 \
             AND json_extract(input, '$.model.mesh_stiffness.fidelity') IS $5 \
             AND json_extract(input, '$.model.mesh_force') IS $6 \
             AND json_extract(input, '$.analysis.method') IS $7",
        )
        .bind(kind)
        .bind(SEARCHED)
        .bind(solver_version)
        .bind(&class.mesh_stiffness_source)
        .bind(&class.fidelity)
        .bind(&class.mesh_force)
        .bind(&class.method)
        .fetch_all(&self.reader)
        .await?;
        rows.iter()
            .map(|row| {
                let points = row.try_get::<Option<i64>, _>("points_n")?.map_or(1, i64::unsigned_abs).max(1);
                let wall_us = row.try_get::<Option<i64>, _>("wall_us")?.unwrap_or_default();
                Ok(MeasuredDuration { wall_s: wall_us.unsigned_abs() as f64 * 1e-6, points })
            })
            .collect()
    }
}
