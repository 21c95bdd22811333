//! Checks of the inputs and quantities that evaluations name.

use super::inputs::Inputs;
use super::measure::Measure;
use crate::Violation;
use crate::document::{HalvesInput, JobDocument};

/// Violations with their pointers.
pub(in crate::study) type Found = Vec<Violation>;

/// Parts of the document in which evaluations may set inputs.
const SETTABLE: [&str; 3] = ["/design/", "/operation/", "/model/"];

/// Checks that the inputs of a list (`variables`, `tolerances`) are numbers of the document, each once.
pub(in crate::study) fn check_pointers(
    document: &JobDocument,
    base: &mut JobDocument,
    list: &str,
    all: &[Inputs],
    found: &mut Found,
) {
    let mut taken: Vec<&str> = Vec::new();
    for (index, inputs) in all.iter().enumerate() {
        for (place, (pointer, _)) in inputs.pointers().enumerate() {
            let here = match place {
                0 => format!("/{list}/{index}/pointer"),
                _ => format!("/{list}/{index}/also/{}", place - 1),
            };
            let set_by_point = |pointer: &str| match pointer {
                "/operation/pinion_speed_rpm" => document.operating_points.iter().any(|p| p.pinion_speed_rpm.is_some()),
                "/operation/pinion_torque_nm" => document.operating_points.iter().any(|p| p.pinion_torque_nm.is_some()),
                _ => false,
            };
            let reason = match base.slot(pointer) {
                _ if taken.contains(&pointer) => "is named already",
                _ if set_by_point(pointer) => "is set by operating_points",
                Some(slot) if slot.is_number() && SETTABLE.iter().any(|part| pointer.starts_with(part)) => {
                    taken.push(pointer);
                    continue;
                }
                Some(_) => "is not a number of design, operation or model",
                None => "is not a field of the document",
            };
            found.push(Violation::new(here, "conflict", format!("\"{pointer}\" {reason}")));
        }
    }
}

/// The measure at a pointer; a violation at `here` if there is none.
pub(in crate::study) fn check_measure(
    pointer: &str,
    halves: HalvesInput,
    here: &str,
    found: &mut Found,
) -> Option<Measure> {
    match Measure::number(pointer, halves) {
        Ok(measure) => Some(measure),
        Err(detail) => {
            found.push(Violation::new(here, "conflict", detail));
            None
        }
    }
}
