//! What the file has and no rule has read.

use super::model::{Attribute, Handle, Value};
use super::view::View;
use crate::draft::Draft;
use crate::refusal::short;
use std::collections::{BTreeMap, HashSet};

/// Most lines of single attributes.
const MAX_LINES: usize = 400;

/// Attributes without a meaning of their own: places and axes that were read where they are needed, data of documents.
const SILENT: [&str; 8] = [
    "support_vector",
    "u_axis_vector",
    "w_axis_vector",
    "reference_component_for_position",
    "display_color",
    "modification_date",
    "version",
    "defines_speed",
];

/// Adds to the report what was not read: attributes of components that were used, and other components by type.
pub(super) fn report(view: &View, draft: &mut Draft) {
    let model = view.model;
    for (of, id, reason) in view.unreadable() {
        let from = format!("{}.{}", model.label(of), short(&id));
        draft.warn("unreadable-attribute", "", format!("{from} {reason}"));
        draft.ignore(from, reason, None);
    }
    let mentioned: HashSet<String> = draft.ignored.iter().map(|line| line.from.clone()).collect();
    let mut lines = 0;
    let mut further = 0;
    let mut others: BTreeMap<String, Vec<Handle>> = BTreeMap::new();
    for handle in 0..model.components.len() {
        let own = &model.components[handle].attributes;
        let of_case = view.case.and_then(|case| model.cases[case].attributes.get(&handle));
        let is_used = own.iter().chain(of_case.into_iter().flatten()).any(|one| view.was_read(handle, &one.id));
        if !is_used {
            if own.iter().any(|one| !SILENT.contains(&one.id.as_str())) && !mentioned.contains(&model.label(handle)) {
                others.entry(short(&model.components[handle].kind)).or_default().push(handle);
            }
            continue;
        }
        for attribute in own.iter().chain(of_case.into_iter().flatten()) {
            if view.was_read(handle, &attribute.id) || SILENT.contains(&attribute.id.as_str()) {
                continue;
            }
            let from = format!("{}.{}", model.label(handle), short(&attribute.id));
            if mentioned.contains(&from) {
                continue;
            }
            if lines == MAX_LINES {
                further += 1;
                continue;
            }
            lines += 1;
            let why = match attribute.id.starts_with("custom_") {
                true => "another program's",
                false => "the document has no place for it",
            };
            draft.ignore(from, why, amount(attribute));
        }
    }
    if further > 0 {
        draft.ignore(format!("{further} further attributes"), "the document has no place for them", None);
    }
    for (kind, handles) in others {
        let from = match handles.as_slice() {
            [one] => model.label(*one),
            several => format!("{kind} ({} components)", several.len()),
        };
        let why = if kind.starts_with("custom_") {
            "another program's"
        } else {
            "not part of the pair, or without a place in the document"
        };
        draft.ignore(from, why, None);
    }
}

/// Value and unit of an attribute, for people.
fn amount(attribute: &Attribute) -> Option<String> {
    let value = match &attribute.value {
        Value::Number(number) => number.to_string(),
        Value::Flag(flag) => flag.to_string(),
        Value::Text(text) => text.parse().map_or_else(|_| short(text), |number: f64| number.to_string()),
        Value::Numbers(_) | Value::Other => return None,
    };
    let unit = attribute.unit.as_deref().map(short).filter(|unit| unit != "none").unwrap_or_default();
    Some(format!("{value} {unit}").trim_end().to_owned())
}
