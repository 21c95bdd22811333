//! Checked jobs: documents that can be solved, with the geometry, supports and warnings known without solving.

mod drawing;

use super::axes::check_axes;
use super::prepare::{Pairs, Prepared, geometry, prepare, prepare_with};
use super::{CheckReport, SolvedShafts, demand, derived, optimise, repeat, tolerance, vibration};
use crate::DocumentError;
use crate::document::{JobDocument, JobKind, ResolvedShafts};

/// A job document that can be solved: its pair is feasible and every requested calculation is supported. The pair and
/// the quantities that follow from it without solving are derived once, here.
#[derive(Debug, Clone)]
pub struct CheckedJob {
    document: JobDocument,
    prepared: Prepared,
}

impl CheckedJob {
    /// Checks a document.
    ///
    /// # Errors
    /// [`DocumentError::Invalid`] with every infeasibility and contradiction; [`DocumentError::Unsupported`] for a
    /// calculation that this version does not support.
    pub fn new(document: JobDocument) -> Result<Self, DocumentError> {
        let prepared = prepare(&document)?;
        let job = Self { document, prepared };
        vibration::channels(&job.document, None)?;
        match job.document.kind {
            JobKind::Mesh | JobKind::Response => {}
            JobKind::Sweep => check_axes(&job.document)?,
            JobKind::Optimise => {
                optimise::Problem::new(&job.document)?;
                tolerance::Quantities::new(&job.document)?;
            }
            JobKind::Tolerance => {
                tolerance::Quantities::new(&job.document)?;
            }
        }
        Ok(job)
    }

    /// Checks a point of a checked sweep: only the feasibility of the pair. `pairs`: those of the other points.
    ///
    /// # Errors
    /// [`DocumentError::Invalid`] with every infeasibility of the pair.
    pub(super) fn of_point(document: JobDocument, pairs: &Pairs) -> Result<Self, DocumentError> {
        let prepared = prepare_with(&document, pairs)?;
        Ok(Self { document, prepared })
    }

    pub fn document(&self) -> &JobDocument {
        &self.document
    }

    pub fn into_document(self) -> JobDocument {
        self.document
    }

    pub(super) fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Geometry, supports and warnings.
    pub fn report(&self) -> CheckReport {
        CheckReport {
            geometry: geometry(&self.prepared),
            supports: (self.document.kind != JobKind::Mesh && self.document.design.shafts.is_none())
                .then(|| self.prepared.supports.clone()),
            memory_mib: demand(&self.document, 1).total_mib(),
            warnings: self.prepared.warnings.iter().cloned().chain(repeat::changed_inputs(&self.document)).collect(),
            derived: derived::values(&self.document, &self.prepared),
            shafts: self
                .document
                .design
                .resolved_shafts()
                .map(|ResolvedShafts { pinion, gear, .. }| SolvedShafts { pinion, gear }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{arbitrary, parse_value};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

        /// Values at the ends of every range in combination: a feasible pair, or its infeasibilities.
        #[test]
        fn any_valid_document_is_answered(value in arbitrary::documents()) {
            match CheckedJob::new(parse_value(&value).expect("valid")) {
                Ok(job) => prop_assert!(job.report().geometry.center_distance_mm.is_finite(), "{}", value),
                Err(DocumentError::Invalid(found) | DocumentError::Unsupported(found)) => prop_assert!(!found.is_empty()),
                Err(DocumentError::Malformed { detail, .. }) => prop_assert!(false, "{}", detail),
            }
        }
    }
}
