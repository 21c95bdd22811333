//! The inputs varied by a sweep, and the documents of its points.

use crate::document::{Axis, JobDocument};
use crate::{DocumentError, Violation};

/// Checks the axes: each pointer must be that of a number of the document, and each value within its range.
///
/// # Errors
/// [`DocumentError::Invalid`] with pointers into `/axes`.
pub(super) fn check_axes(document: &JobDocument) -> Result<(), DocumentError> {
    let mut base = base(document);
    let mut violations = Vec::new();
    let mut taken: Vec<(&str, usize)> = Vec::new();
    for (index, axis) in document.axes.iter().enumerate() {
        let before = violations.len();
        for (place, pointer) in axis.pointers().enumerate() {
            let here = match place {
                0 => format!("/axes/{index}/pointer"),
                _ => format!("/axes/{index}/also/{}", place - 1),
            };
            if let Some((_, other)) = taken.iter().find(|(known, _)| *known == pointer) {
                let whose = if *other == index { "this axis varies already" } else { "the first axis varies already" };
                violations.push(Violation::new(here, "conflict", format!("is the same input that {whose}")));
                continue;
            }
            taken.push((pointer, index));
            let reason = match base.slot(pointer) {
                Some(slot) if slot.is_number() => continue,
                Some(_) => "is not a number; a sweep varies one number",
                None => "is not a field of the document",
            };
            violations.push(Violation::new(here, "conflict", format!("\"{pointer}\" {reason}")));
        }
        if violations.len() > before {
            continue;
        }
        // Ranges are intervals, so the extremes stand for all values; of whole numbers every value has to be one.
        let whole = axis.pointers().any(|pointer| base.slot(pointer).is_some_and(|slot| slot.is_whole_number()));
        let values = axis.values();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let fractional = values.iter().copied().find(|number| whole && number.fract() != 0.0);
        for number in [Some(least), Some(greatest), fractional].into_iter().flatten() {
            if let Err(DocumentError::Invalid(found)) = at(base.clone(), [(axis, number)]) {
                violations.extend(found.into_iter().map(|violation| Violation {
                    detail: format!("at {} = {number}: {}", place(axis, &violation.pointer), violation.detail),
                    pointer: format!("/axes/{index}"),
                    ..violation
                }));
                break;
            }
        }
    }
    if violations.is_empty() { Ok(()) } else { Err(DocumentError::Invalid(violations)) }
}

/// JSON pointer of the input of an axis to which a violation at `pointer` belongs; the first input if it belongs to
/// none.
fn place<'a>(axis: &'a Axis, pointer: &str) -> &'a str {
    axis.pointers().find(|own| *own == pointer).unwrap_or(&axis.pointer)
}

/// The document of one point, before the values of the axes are assigned.
pub(super) fn base(document: &JobDocument) -> JobDocument {
    let mut base = document.without_sweep();
    // Series are not kept for the points of a sweep.
    base.analysis.channels = Some(Vec::new());
    base
}

/// `base` with the values of some axes assigned.
///
/// # Errors
/// [`DocumentError::Invalid`] for values out of range or in contradiction with each other.
pub(super) fn at<'a>(
    mut base: JobDocument,
    values: impl IntoIterator<Item = (&'a Axis, f64)>,
) -> Result<JobDocument, DocumentError> {
    let mut violations = Vec::new();
    for (axis, number) in values {
        for pointer in axis.pointers() {
            let set = base.slot(pointer).map(|slot| slot.set(number));
            violations.extend(set.and_then(Result::err).map(|v| Violation { pointer: pointer.to_owned(), ..*v }));
        }
    }
    base.checked(violations)
}
