//! The numbers of a result and of gear data: label, symbol, unit and meaning, from their declarations.

use super::anchor;
use herringbone_job::result::{Quantity, SweepPoint, gear_data_quantities, quantities};
use herringbone_job::unit::typographic;

pub(super) const TITLE: &str = "Numbers of a result";

/// The numbers of one block of the result.
pub(super) struct Block {
    pub id: &'static str,
    pub title: &'static str,
    pub about: &'static str,
    pub numbers: Vec<Number>,
}

/// A number, word or flag.
pub(super) struct Number {
    pub anchor: String,
    pub pointer: String,
    pub label: String,
    /// Letter and index.
    pub symbol: (&'static str, &'static str),
    pub unit: &'static str,
    pub help: &'static str,
    /// Address of the theory section below `/help`.
    pub theory: String,
    /// Columns of a sweep's rows that hold it.
    pub columns: Vec<&'static str>,
}

/// Blocks of a result in the order of the job's page: name in JSON, title and subject.
const BLOCKS: &[(&str, &str, &str)] = &[
    ("geometry", "Geometry", "Of one half, ISO 21771-1."),
    ("mesh", "Mesh", "The loaded contact of one half over a mesh period."),
    ("shafts", "Shafts and bearings", "Both halves together on their elastic shafts."),
    ("impact", "Mesh-in impact", "At the tip corner of the entering pair."),
    ("response", "Vibration", "The steady motion of both halves."),
    ("supports", "Supports and couplings", "Springs of the equations of motion."),
    ("accuracy", "Accuracy", "What is known of the errors."),
    ("numerics", "Computing effort", "What the calculation took."),
    ("sweep", "Sweep", "What a sweep found besides its rows."),
];

/// All blocks, the gear data last.
pub(super) fn blocks() -> Vec<Block> {
    let block = |&(id, title, about): &(&'static str, &'static str, &'static str)| {
        let of_block = quantities().iter().filter(|quantity| quantity.block() == id);
        Block { id, title, about, numbers: of_block.map(|quantity| Number::new("", quantity)).collect() }
    };
    let gear_data = Block {
        id: "gear-data",
        title: "Gear data",
        about: "Of the report and of GET /api/v1/jobs/{id}/gear-data.",
        numbers: gear_data_quantities().iter().map(|quantity| Number::new("gear-data", quantity)).collect(),
    };
    let all = BLOCKS.iter().map(block).chain([gear_data]);
    all.filter(|block| !block.numbers.is_empty()).collect()
}

impl Number {
    /// `place` distinguishes the anchors of gear data from those of a result.
    fn new(place: &str, quantity: &'static Quantity) -> Self {
        let mut label = quantity.label.clone();
        if let Some(first) = label.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        let is_of = |from: &Option<&str>| place.is_empty() && *from == Some(quantity.pointer.as_str());
        Self {
            anchor: anchor(&format!("{place}{}", quantity.pointer)),
            pointer: quantity.pointer.clone(),
            label,
            symbol: quantity.symbol.split_once('_').unwrap_or((quantity.symbol, "")),
            unit: typographic(quantity.unit),
            help: quantity.help,
            theory: format!("theory/{}", quantity.theory),
            columns: SweepPoint::COLUMNS
                .iter()
                .filter(|column| is_of(&column.quantity))
                .map(|column| column.name)
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_number_is_told_once() {
        let mut anchors = HashSet::new();
        let mut count = 0;
        for number in blocks().iter().flat_map(|block| &block.numbers) {
            assert!(anchors.insert(number.anchor.clone()), "{}", number.anchor);
            count += 1;
        }
        assert_eq!(count, quantities().len() + gear_data_quantities().len());
    }
}
