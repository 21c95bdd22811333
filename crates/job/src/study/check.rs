//! What can be said of a document without solving it.

mod drawing;

use super::axes::check_axes;
use super::prepare::{geometry, prepare};
use super::{CheckReport, demand, vibration};
use crate::DocumentError;
use crate::document::{JobDocument, Kind};

/// Checks that the gear of a document can exist and that everything it asks for can be computed: geometry and warnings.
///
/// # Errors
/// [`DocumentError::Invalid`] with every reason why it cannot; [`DocumentError::Unsupported`] for what this version does not
/// compute.
pub fn check(document: &JobDocument) -> Result<CheckReport, DocumentError> {
    let prepared = prepare(document)?;
    vibration::channels(document)?;
    if document.kind == Kind::Sweep {
        check_axes(document)?;
    }
    let memory_mib = demand(document, 1).total_mib();
    Ok(CheckReport {
        geometry: geometry(&prepared),
        supports: (document.kind != Kind::Mesh).then_some(prepared.supports),
        memory_mib,
        warnings: prepared.warnings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{arbitrary, parse_value};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

        /// Values at the ends of every range together: a gear that can exist, or reasons why not.
        #[test]
        fn any_valid_document_is_answered(value in arbitrary::documents()) {
            let document = parse_value(&value).expect("valid");
            match check(&document) {
                Ok(report) => prop_assert!(report.geometry.center_distance_mm.is_finite(), "{}", value),
                Err(DocumentError::Invalid(found) | DocumentError::Unsupported(found)) => prop_assert!(!found.is_empty()),
                Err(DocumentError::Malformed { detail, .. }) => prop_assert!(false, "{}", detail),
            }
        }
    }
}
