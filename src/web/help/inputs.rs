//! The inputs of a job document: label, symbol, range, unit, default and meaning, from their declarations.

use super::super::form::{self, Block as FormBlock, FormField, Layout, List};
use super::anchor;

pub(super) const TITLE: &str = "Inputs";

/// The inputs of a section of the form.
pub(super) struct Block {
    pub id: &'static str,
    pub title: &'static str,
    pub about: &'static str,
    pub inputs: Vec<Input>,
}

/// An input; the same field of pinion and gear, or of several flanks, is told once.
pub(super) struct Input {
    pub anchor: String,
    pub pointer: String,
    pub label: String,
    pub symbol: (&'static str, &'static str),
    pub range: String,
    pub default: String,
    pub help: String,
}

/// All inputs by the sections of the form.
pub(super) fn blocks() -> Vec<Block> {
    let sections = form::groups().iter();
    sections
        .map(|group| Block {
            id: group.id,
            title: group.title,
            about: group.help,
            inputs: group.blocks.iter().flat_map(inputs_of).filter(|input| !is_told_of_the_pinion(input)).collect(),
        })
        .collect()
}

/// Both shafts have the same fields.
fn is_told_of_the_pinion(input: &Input) -> bool {
    input.pointer.starts_with("/design/shafts/gear/")
}

fn inputs_of(block: &FormBlock) -> Vec<Input> {
    match &block.layout {
        Layout::Fields(fields) => fields.iter().map(|field| Input::new(field, &field.full_label())).collect(),
        Layout::Table { rows, .. } => {
            rows.iter().filter_map(|row| Some(Input::new(row.first()?, &row.label))).collect()
        }
        Layout::List(list) => of_list(list),
    }
}

/// The fields of the objects of a list, and of the lists in them.
fn of_list(list: &List) -> Vec<Input> {
    let own = list.fields.iter().map(|field| Input::new(field, &format!("{} of a {}", field.label, list.item)));
    own.chain(list.lists.iter().flat_map(of_list)).collect()
}

impl Input {
    fn new(field: &FormField, label: &str) -> Self {
        Self {
            anchor: anchor(&field.pointer),
            pointer: field.pointer.clone(),
            label: label.to_owned(),
            symbol: field.symbol,
            range: field.range.clone(),
            default: if field.required { "required".to_owned() } else { field.default_text().to_owned() },
            help: field.help.clone(),
        }
    }
}
