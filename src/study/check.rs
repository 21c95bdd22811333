//! What can be said of a document without solving it.

use super::axes::check_axes;
use super::prepare::{geometry, prepare};
use super::{CheckReport, demand, vibration};
use crate::job::DocumentError;
use crate::job::document::{JobDocument, Kind};

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
    Ok(CheckReport { geometry: geometry(&prepared), memory_mib, warnings: prepared.warnings })
}
