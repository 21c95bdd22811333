//! The inputs that an evaluation sets.

use crate::document::{JobDocument, JobKind, OperatingPointInput, ToleranceInput, VariableInput};
use crate::{DocumentError, Violation};

/// An input with those that move with it.
#[derive(Debug, Clone)]
pub(in crate::study) struct Inputs<'a> {
    pub pointer: &'a str,
    /// Further inputs, each with its factor.
    also: Vec<(&'a str, f64)>,
    /// Whether the others keep their distance from the document's values, times the factor, instead of taking the
    /// value.
    deviates: bool,
}

impl<'a> Inputs<'a> {
    fn new(pointer: &'a str, also: &'a [String], factors: Option<&Vec<f64>>, deviates: bool) -> Self {
        let factor = |index: usize| factors.and_then(|factors| factors.get(index)).copied().unwrap_or(1.0);
        let also = also.iter().enumerate().map(|(index, pointer)| (pointer.as_str(), factor(index))).collect();
        Self { pointer, also, deviates }
    }

    pub(in crate::study) fn of_variable(variable: &'a VariableInput) -> Self {
        Self::new(&variable.pointer, &variable.also, variable.also_factors.as_ref(), false)
    }

    pub(in crate::study) fn of_tolerance(tolerance: &'a ToleranceInput) -> Self {
        Self::new(&tolerance.pointer, &tolerance.also, tolerance.also_factors.as_ref(), true)
    }

    /// Every input with its factor, and 1 for the first one.
    pub(in crate::study) fn pointers(&self) -> impl Iterator<Item = (&'a str, f64)> {
        std::iter::once((self.pointer, 1.0)).chain(self.also.iter().copied())
    }

    /// The value of the first input in a document.
    pub(in crate::study) fn value(&self, document: &mut JobDocument) -> Option<f64> {
        document.slot(self.pointer)?.number()
    }

    /// Whether the first input is a whole number.
    pub(in crate::study) fn is_whole(&self, document: &mut JobDocument) -> bool {
        document.slot(self.pointer).is_some_and(|slot| slot.is_whole_number())
    }

    /// Puts a value into a document. Values beyond the range of a field are refused, or cut where inputs deviate.
    pub(in crate::study) fn put(&self, document: &mut JobDocument, value: f64, violations: &mut Vec<Violation>) {
        let own = self.value(document).unwrap_or_default();
        for (pointer, factor) in self.pointers() {
            let Some(slot) = document.slot(pointer) else { continue };
            let number = match self.deviates {
                _ if pointer == self.pointer => value,
                true => slot.number().unwrap_or_default() + factor * (value - own),
                false => factor * value,
            };
            let number = match (self.deviates, slot.range()) {
                (true, Some([least, most])) => number.clamp(least, most),
                _ => number,
            };
            let refused = slot.set(number).err();
            violations.extend(refused.map(|violation| Violation { pointer: pointer.to_owned(), ..*violation }));
        }
    }
}

/// The inputs that the evaluations of a job set.
pub(in crate::study) fn inputs(document: &JobDocument) -> Vec<Inputs<'_>> {
    match document.kind {
        JobKind::Optimise => document.variables.iter().map(Inputs::of_variable).collect(),
        JobKind::Tolerance => document.tolerances.iter().map(Inputs::of_tolerance).collect(),
        _ => Vec::new(),
    }
}

/// `base` with values put in.
///
/// # Errors
/// [`DocumentError::Invalid`] for values out of range or in contradiction with each other.
pub(in crate::study) fn with_values(
    mut base: JobDocument,
    inputs: &[Inputs],
    values: &[f64],
) -> Result<JobDocument, DocumentError> {
    let mut violations = Vec::new();
    for (inputs, value) in inputs.iter().zip(values) {
        inputs.put(&mut base, *value, &mut violations);
    }
    base.checked(violations)
}

/// Puts an operating point into a document.
pub(in crate::study) fn put_point(document: &mut JobDocument, point: &OperatingPointInput) {
    let operation = &mut document.operation;
    operation.pinion_speed_rpm = point.pinion_speed_rpm.unwrap_or(operation.pinion_speed_rpm);
    operation.pinion_torque_nm = point.pinion_torque_nm.unwrap_or(operation.pinion_torque_nm);
}

/// The document of a row of an optimisation or tolerance study as a response of its own, at the first operating point;
/// `values`: those of the row. `None` if they do not fit.
pub fn document_at(job: &JobDocument, values: &[f64]) -> Option<JobDocument> {
    let inputs = inputs(job);
    if inputs.len() != values.len() {
        return None;
    }
    let document = with_values(job.without_sweep(), &inputs, values).ok()?;
    Some(at_first_point(job, document))
}

/// The document of the first row, which is that of the job without values put in.
pub fn document_of_input(job: &JobDocument) -> Option<JobDocument> {
    matches!(job.kind, JobKind::Optimise | JobKind::Tolerance).then(|| at_first_point(job, job.without_sweep()))
}

fn at_first_point(job: &JobDocument, mut document: JobDocument) -> JobDocument {
    if let Some(point) = job.operating_points.first() {
        put_point(&mut document, point);
    }
    document
}
