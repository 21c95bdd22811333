//! The time that a job will take, from measured durations of similar jobs.

use crate::store::{CalculationClass, MeasuredDuration, Store, StoreError};
use herringbone_job::document::{JobDocument, JobKind};
use serde_json::Value;

/// Measured durations of similar jobs, scaled to the points of this one.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Median, shortest and longest duration of the similar jobs; none without such jobs.
    pub wall_s: Option<[f64; 3]>,
    /// Number of similar jobs.
    pub jobs: usize,
    /// Kind of the similar jobs.
    pub kind: &'static str,
    /// Points of this job.
    pub points: usize,
}

/// Estimates the duration of a job by jobs of the same kind and calculation; of a sweep without such, by single
/// operating points.
///
/// # Errors
/// The database cannot be read.
pub(super) async fn estimate(
    store: &Store,
    document: &JobDocument,
    solver_version: &str,
) -> Result<Estimate, StoreError> {
    let class = class_of(&serde_json::to_value(document).unwrap_or_default());
    let points = match document.kind {
        JobKind::Mesh | JobKind::Response => 1,
        JobKind::Sweep => document.sweep_points().max(1),
        JobKind::Optimise | JobKind::Tolerance => {
            let evaluations = usize::try_from(document.evaluations()).unwrap_or(usize::MAX);
            evaluations.saturating_mul(document.operating_points.len().max(1))
        }
    };
    let mut kind = document.kind;
    // Rows of evaluations have several operating points, and an unknown number of them was solved.
    let is_measured = matches!(kind, JobKind::Mesh | JobKind::Response | JobKind::Sweep);
    let mut measured = match is_measured {
        true => store.durations(kind.as_str(), &class, solver_version).await?,
        false => Vec::new(),
    };
    if measured.is_empty() && !matches!(kind, JobKind::Mesh | JobKind::Response) {
        kind = JobKind::Response;
        measured = store.durations(kind.as_str(), &class, solver_version).await?;
    }
    Ok(Estimate { wall_s: scaled(&measured, points), jobs: measured.len(), kind: kind.as_str(), points })
}

fn class_of(document: &Value) -> CalculationClass {
    let word = |pointer: &str| document.pointer(pointer).and_then(Value::as_str).map(str::to_owned);
    CalculationClass {
        mesh_stiffness_source: word("/model/mesh_stiffness/source"),
        fidelity: word("/model/mesh_stiffness/fidelity"),
        mesh_force: word("/model/mesh_force"),
        method: word("/analysis/method"),
    }
}

/// Median, shortest and longest duration of `points` points.
fn scaled(measured: &[MeasuredDuration], points: usize) -> Option<[f64; 3]> {
    let mut per_point: Vec<f64> = measured.iter().map(|one| one.wall_s / one.points as f64).collect();
    per_point.sort_by(f64::total_cmp);
    let (shortest, longest) = (per_point.first()?, per_point.last()?);
    let median = 0.5 * (per_point[(per_point.len() - 1) / 2] + per_point[per_point.len() / 2]);
    Some([median, *shortest, *longest].map(|wall_s| wall_s * points as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_scaled_by_points() {
        let jobs =
            [(8.0, 4), (1.0, 1), (30.0, 10), (0.5, 1)].map(|(wall_s, points)| MeasuredDuration { wall_s, points });
        assert_eq!(scaled(&jobs, 10), Some([15.0, 5.0, 30.0]));
        assert_eq!(scaled(&jobs[..1], 1), Some([2.0, 2.0, 2.0]));
        assert_eq!(scaled(&[], 3), None);
    }

    #[test]
    fn the_class_is_read_from_the_document_as_it_is_stored() {
        let document = herringbone_job::parse(include_bytes!("../../examples/contact.json")).unwrap();
        let class = class_of(&serde_json::to_value(&document).unwrap());
        let word = |text: &str| Some(text.to_owned());
        let (source, fidelity) = (word("ltca"), word("analytic"));
        assert_eq!((class.mesh_stiffness_source, class.fidelity), (source, fidelity));
        assert_eq!((class.mesh_force, class.method), (word("contact"), word("auto")));
    }
}
