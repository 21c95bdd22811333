//! The document and its report while they are made.

use crate::refusal::Refusal;
use crate::report::{
    Alternative, Assumed, Check, Ignored, Import, ImportSource, ImportWarning, ImportedPair, Offered, OperatingPoint,
    Taken,
};
use crate::unit::clean;
use herringbone_job::Violation;
use herringbone_job::unit::Unit;
use serde_json::{Map, Value, json};

/// A number as it stands in the file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reading {
    /// Value in the unit of its quantity.
    pub value: f64,
    /// Value and unit in the file.
    pub file_value: f64,
    pub file_unit: String,
    /// Type and id of the component: `cylindrical_gear[40]`.
    pub of: String,
    /// Id of the component.
    pub component: i64,
    pub attribute: &'static str,
    /// Whether the file has no unit, so that the format's was taken.
    pub unit_assumed: bool,
}

impl Reading {
    /// Component and attribute.
    pub(crate) fn from(&self) -> String {
        format!("{}.{}", self.of, self.attribute)
    }
}

/// The document and the lines of its report.
#[derive(Debug, Default)]
pub(crate) struct Draft {
    pub document: Value,
    pub taken: Vec<Taken>,
    pub assumed: Vec<Assumed>,
    pub ignored: Vec<Ignored>,
    pub offered: Vec<Offered>,
    pub checks: Vec<Check>,
    pub warnings: Vec<ImportWarning>,
    /// Reasons to refuse the file.
    pub errors: Vec<Violation>,
}

/// The unit of a field by its name.
fn unit_of(pointer: &str) -> Option<String> {
    let name = pointer.rsplit('/').next().unwrap_or_default();
    Unit::of_name(name).filter(|unit| !unit.text.is_empty()).map(|unit| unit.text.to_owned())
}

impl Draft {
    /// The import with `document`, the draft with every default filled in.
    pub(crate) fn into_import(
        self,
        source: ImportSource,
        (pair, alternatives): (ImportedPair, Vec<Alternative>),
        (document, operating_points): (Value, Vec<OperatingPoint>),
    ) -> Import {
        let Self { taken, assumed, ignored, offered, checks, warnings, .. } = self;
        Import {
            source,
            pair,
            alternatives,
            document,
            operating_points,
            taken,
            assumed,
            ignored,
            offered,
            checks,
            warnings,
        }
    }

    /// Refuses the file for the reasons found in a pair, such as `pair 1`.
    pub(crate) fn refused(self, pair: &str) -> Refusal {
        let summary = format!("The {pair} is not complete or contradicts itself: {} reason(s).", self.errors.len());
        Refusal::invalid(summary, self.errors)
    }

    /// Puts a value into the document.
    pub(crate) fn set(&mut self, pointer: &str, value: impl Into<Value>) {
        let mut place = &mut self.document;
        for step in pointer.split('/').skip(1) {
            let index = step.parse::<usize>().ok();
            if index.is_some_and(|index| place.as_array().is_some_and(|items| index < items.len())) {
                place = &mut place[index.unwrap_or(0)];
                continue;
            }
            if !place.is_object() {
                *place = Value::Object(Map::new());
            }
            place = &mut place[step];
        }
        *place = value.into();
    }

    /// Removes a member of the document, with what the report says of it.
    pub(crate) fn remove(&mut self, pointer: &str) {
        if let Some((parent, name)) = pointer.rsplit_once('/')
            && let Some(members) = self.document.pointer_mut(parent).and_then(Value::as_object_mut)
        {
            members.remove(name);
        }
        let inner = format!("{pointer}/");
        let is_other = |place: &str| place != pointer && !place.starts_with(&inner);
        self.taken.retain(|line| is_other(&line.pointer));
        self.assumed.retain(|line| is_other(&line.pointer));
    }

    /// A field from one reading or several; `why` where the value is not the one in the file.
    pub(crate) fn take(&mut self, pointer: &str, value: f64, readings: &[Reading], why: &str) {
        if !value.is_finite() {
            let froms: Vec<String> = readings.iter().map(Reading::from).collect();
            self.refuse(
                pointer,
                "out-of-range",
                format!("does not follow from {}: no finite number", froms.join(", ")),
            );
            return;
        }
        self.set(pointer, value);
        self.note_taken(pointer, value.into(), readings, why);
    }

    /// The line of a field that is in the document already.
    pub(crate) fn note_taken(&mut self, pointer: &str, value: Value, readings: &[Reading], why: &str) {
        let Some(first) = readings.first() else { return };
        let mut froms: Vec<String> = readings.iter().map(Reading::from).collect();
        froms.dedup();
        let mut why: Vec<String> = (!why.is_empty()).then(|| why.to_owned()).into_iter().collect();
        if readings.iter().any(|reading| reading.unit_assumed) {
            why.push(format!("no unit in the file: {}, the format's", first.file_unit));
        }
        self.taken.push(Taken {
            pointer: pointer.to_owned(),
            from: froms.join(", "),
            component: Some(first.component),
            attribute: Some(first.attribute.to_owned()),
            value,
            unit: unit_of(pointer),
            file_value: json!(first.file_value),
            file_unit: Some(first.file_unit.clone()).filter(|unit| !unit.is_empty()),
            why: (!why.is_empty()).then(|| why.join("; ")),
        });
    }

    /// A field whose value is a word, or that has no single reading.
    pub(crate) fn take_word(
        &mut self,
        pointer: &str,
        value: impl Into<Value>,
        from: &str,
        file_value: Value,
        why: &str,
    ) {
        let value = value.into();
        self.set(pointer, value.clone());
        self.taken.push(Taken {
            pointer: pointer.to_owned(),
            from: from.to_owned(),
            component: None,
            attribute: None,
            value,
            unit: unit_of(pointer),
            file_value,
            file_unit: None,
            why: Some(why.to_owned()).filter(|why| !why.is_empty()),
        });
    }

    /// A field that the file leaves open. Null leaves it to the service.
    pub(crate) fn assume(&mut self, pointer: &str, value: impl Into<Value>, why: impl Into<String>) {
        let value = value.into();
        self.set(pointer, value.clone());
        self.note_assumed(pointer, value, why);
    }

    /// The line of an assumed field that is in the document already.
    pub(crate) fn note_assumed(&mut self, pointer: &str, value: Value, why: impl Into<String>) {
        self.assumed.push(Assumed { pointer: pointer.to_owned(), value, unit: unit_of(pointer), why: why.into() });
    }

    pub(crate) fn ignore(&mut self, from: impl Into<String>, why: impl Into<String>, amount: Option<String>) {
        self.ignored.push(Ignored { from: from.into(), why: why.into(), amount });
    }

    pub(crate) fn offer(&mut self, pointer: &str, reading: &Reading, value: f64, why: impl Into<String>) {
        self.offered.push(Offered {
            pointer: pointer.to_owned(),
            from: reading.from(),
            value: clean(value),
            unit: unit_of(pointer),
            why: why.into(),
        });
    }

    /// A result of the file beside ours, both in the unit.
    pub(crate) fn check(&mut self, name: &str, reading: &Reading, ours: f64, unit: &str) {
        let file = reading.value;
        let agrees = (file - ours).abs() <= 1e-6 * ours.abs().max(1.0);
        if !agrees {
            let detail = format!("{name} is {file} {unit} in the file ({}), {ours:.6} {unit} here", reading.from());
            self.warn("check-differs", "", detail.replace("  ", " "));
        }
        self.checks.push(Check {
            name: name.to_owned(),
            from: reading.from(),
            file,
            ours,
            unit: Some(unit.to_owned()).filter(|unit| !unit.is_empty()),
            agrees,
        });
    }

    pub(crate) fn warn(&mut self, code: &str, pointer: &str, detail: impl Into<String>) {
        let warning = ImportWarning { code: code.to_owned(), pointer: pointer.to_owned(), detail: detail.into() };
        if !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }

    pub(crate) fn refuse(&mut self, pointer: &str, code: &str, detail: impl Into<String>) {
        self.errors.push(Violation::new(pointer, code, detail));
    }
}
