//! The attributes of a model, as they hold in one load case.

use super::model::{Attribute, Handle, Model, Value};
use crate::draft::Reading;
use crate::refusal::short;
use crate::unit::{Quantity, clean};
use std::cell::RefCell;
use std::collections::{BTreeMap, HashSet};

/// Largest size of a number: placeholders go to 1e23, and what is calculated from it stays finite.
const LARGEST: f64 = 1e30;
/// Largest coordinate of a vector, mm.
const LARGEST_MM: f64 = 1e9;

/// Attributes of a model, in a load case where there is one. It notes which were read.
#[derive(Debug)]
pub(super) struct View<'m> {
    pub model: &'m Model,
    /// Index of the load case.
    pub case: Option<usize>,
    used: RefCell<HashSet<(Handle, String)>>,
    /// Attributes that could not be read, with the reason.
    unreadable: RefCell<BTreeMap<(Handle, String), String>>,
}

impl<'m> View<'m> {
    pub(super) fn new(model: &'m Model, case: Option<usize>) -> Self {
        Self { model, case, used: RefCell::default(), unreadable: RefCell::default() }
    }

    /// The same model in another load case.
    pub(super) fn in_case(&self, case: usize) -> View<'m> {
        View::new(self.model, Some(case))
    }

    /// An attribute: of the load case, else of the component; of several values the one that a person entered.
    fn find(&self, of: Handle, id: &str) -> Option<&'m Attribute> {
        let of_case = self.case.and_then(|case| self.model.cases[case].attributes.get(&of));
        let lists = [of_case, Some(&self.model.components[of].attributes)];
        lists.into_iter().flatten().find_map(|list| {
            let mut all = list.iter().filter(|attribute| attribute.id == id);
            let first = all.next()?;
            Some(if first.is_user_defined { first } else { all.find(|one| one.is_user_defined).unwrap_or(first) })
        })
    }

    fn attribute(&self, of: Handle, id: &str) -> Option<&'m Attribute> {
        let found = self.find(of, id)?;
        self.used.borrow_mut().insert((of, id.to_owned()));
        Some(found)
    }

    /// Whether the file has an attribute.
    pub(super) fn has(&self, of: Handle, id: &str) -> bool {
        self.find(of, id).is_some()
    }

    /// A number in the unit of its quantity; `None` where it is missing or cannot be read, which is noted.
    pub(super) fn number(&self, of: Handle, id: &'static str, quantity: Quantity) -> Option<Reading> {
        let attribute = self.attribute(of, id)?;
        let refuse = |reason: String| {
            self.unreadable.borrow_mut().insert((of, id.to_owned()), reason);
            None
        };
        let value = match &attribute.value {
            Value::Number(number) => *number,
            Value::Text(text) => match text.parse() {
                Ok(number) => number,
                Err(_) => return refuse(format!("is \"{}\", not a number", short(text))),
            },
            Value::Flag(_) | Value::Numbers(_) | Value::Other => return refuse("is not a number".to_owned()),
        };
        if !value.is_finite() {
            return refuse(format!("is {value}, not a finite number"));
        }
        let unit = attribute.unit.as_deref().unwrap_or_default().trim();
        let unit_assumed = quantity != Quantity::Number && matches!(unit, "" | "none");
        let factor = match (quantity, unit) {
            (Quantity::Number, "") => 1.0,
            // A number may be a percentage of one.
            (_, _) if unit_assumed => 1.0,
            _ => match quantity.factor(unit) {
                Some(factor) => factor,
                None => {
                    let known = quantity.names();
                    return refuse(format!("is in the unit \"{}\"; units that are read: {known}", short(unit)));
                }
            },
        };
        let converted = if factor == 1.0 { value } else { clean(value * factor) };
        if converted.abs() > LARGEST {
            return refuse(format!("is {value} {}, which is out of range", short(unit)));
        }
        let file_unit = if unit_assumed { quantity.unit() } else { unit };
        Some(Reading {
            value: converted,
            file_value: value,
            file_unit: if file_unit == "none" { String::new() } else { file_unit.to_owned() },
            of: self.model.label(of),
            component: self.model.id(of),
            attribute: id,
            unit_assumed,
        })
    }

    /// A number that is not zero: zero is a placeholder there.
    pub(super) fn non_zero(&self, of: Handle, id: &'static str, quantity: Quantity) -> Option<Reading> {
        self.number(of, id, quantity).filter(|reading| reading.value != 0.0)
    }

    pub(super) fn flag(&self, of: Handle, id: &str) -> Option<bool> {
        match &self.attribute(of, id)?.value {
            Value::Flag(flag) => Some(*flag),
            Value::Number(number) => Some(*number != 0.0),
            Value::Text(text) => match text.to_ascii_lowercase().as_str() {
                "true" | "1" => Some(true),
                "false" | "0" => Some(false),
                _ => None,
            },
            Value::Numbers(_) | Value::Other => None,
        }
    }

    /// A word of a list, in lower case.
    pub(super) fn word(&self, of: Handle, id: &str) -> Option<String> {
        match &self.attribute(of, id)?.value {
            Value::Text(text) => Some(text.to_ascii_lowercase()),
            _ => None,
        }
    }

    /// The component that an attribute refers to.
    pub(super) fn reference(&self, of: Handle, id: &str) -> Option<i64> {
        match &self.attribute(of, id)?.value {
            Value::Number(number) => Some(*number as i64),
            Value::Text(text) => text.parse().ok(),
            _ => None,
        }
    }

    /// A vector of three lengths, mm, or of a direction.
    pub(super) fn vector(&self, of: Handle, id: &str) -> Option<[f64; 3]> {
        let attribute = self.attribute(of, id)?;
        let unit = attribute.unit.as_deref().unwrap_or_default().trim();
        let factor = if matches!(unit, "" | "none") { Some(1.0) } else { Quantity::Length.factor(unit) };
        let Some(factor) = factor else {
            let reason =
                format!("is in the unit \"{}\"; units that are read: {}", short(unit), Quantity::Length.names());
            self.unreadable.borrow_mut().insert((of, id.to_owned()), reason);
            return None;
        };
        let Value::Numbers(numbers) = &attribute.value else { return None };
        let vector: [f64; 3] = numbers.as_slice().try_into().ok()?;
        let vector = vector.map(|number| number * factor);
        vector.iter().all(|number| number.abs() <= LARGEST_MM).then_some(vector)
    }

    /// A direction of length 1.
    pub(super) fn direction(&self, of: Handle, id: &str) -> Option<[f64; 3]> {
        let vector = self.vector(of, id)?;
        let length = dot(vector, vector).sqrt();
        (length > 1e-9).then(|| vector.map(|number| number / length))
    }

    pub(super) fn was_read(&self, of: Handle, id: &str) -> bool {
        self.used.borrow().contains(&(of, id.to_owned()))
    }

    /// Why an attribute could not be read.
    pub(super) fn reason(&self, of: Handle, id: &str) -> Option<String> {
        self.unreadable.borrow().get(&(of, id.to_owned())).cloned()
    }

    /// Components with attributes that could not be read, with the reasons.
    pub(super) fn unreadable(&self) -> Vec<(Handle, String, String)> {
        self.unreadable.borrow().iter().map(|((of, id), reason)| (*of, id.clone(), reason.clone())).collect()
    }
}

pub(super) fn dot(one: [f64; 3], other: [f64; 3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

pub(super) fn difference(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    [one[0] - other[0], one[1] - other[1], one[2] - other[2]]
}
