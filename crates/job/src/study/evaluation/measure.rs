//! Quantities of an evaluation.

use crate::document::{HalvesInput, MarginInput, OverInput};
use crate::result::{Quantity, QuantityKind, quantities};
use herringbone_physics::gear::{MarginKind, Pair};
use serde_json::Value;

/// How far a document has to be solved for a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::study) enum Level {
    Geometry,
    Mesh,
    Response,
}

/// A quantity: where it comes from, and its name for people.
#[derive(Debug, Clone)]
pub(in crate::study) struct Measure {
    /// Pointer, or name of the margin.
    pub name: String,
    pub label: String,
    pub unit: &'static str,
    source: Source,
}

#[derive(Debug, Clone)]
enum Source {
    /// A number of the result, or one of each half.
    Numbers {
        pointers: Vec<String>,
        halves: HalvesInput,
    },
    /// 1 where the word at the pointer is this one, else 0.
    Word {
        pointer: String,
        word: String,
    },
    Margin(MarginInput),
}

/// Blocks of the result that measures may be of.
const BLOCKS: [&str; 5] = ["geometry", "mesh", "impact", "shafts", "response"];

/// The declared quantity at a pointer, and the pointers of its values.
fn locate(pointer: &str) -> Option<(&'static Quantity, Vec<String>)> {
    let of_both = format!("{pointer}/{{half}}");
    quantities().iter().filter(|quantity| BLOCKS.contains(&quantity.block())).find_map(|quantity| {
        let places: Vec<String> = quantity.places().into_iter().map(|(place, _)| place).collect();
        if quantity.pointer == pointer || quantity.pointer == of_both {
            return Some((quantity, places));
        }
        places.contains(&pointer.to_owned()).then(|| (quantity, vec![pointer.to_owned()]))
    })
}

/// Whether a quantity can be a measure: a number of a solved block.
pub fn is_measure(quantity: &Quantity) -> bool {
    quantity.kind == QuantityKind::Number && BLOCKS.contains(&quantity.block())
}

impl Measure {
    /// The number at a pointer of the result.
    ///
    /// # Errors
    /// What is wrong with the pointer.
    pub(in crate::study) fn number(pointer: &str, halves: HalvesInput) -> Result<Self, String> {
        let (quantity, pointers) = locate(pointer).ok_or_else(|| unknown(pointer))?;
        if quantity.kind != QuantityKind::Number {
            return Err(format!("\"{pointer}\" is not a number of the result"));
        }
        Ok(Self {
            name: pointer.to_owned(),
            label: quantity.label.clone(),
            unit: quantity.unit,
            source: Source::Numbers { pointers, halves },
        })
    }

    /// Whether the word at a pointer of the result is `word`.
    ///
    /// # Errors
    /// What is wrong with the pointer.
    pub(in crate::study) fn word(pointer: &str, word: &str) -> Result<Self, String> {
        let (quantity, pointers) = locate(pointer).ok_or_else(|| unknown(pointer))?;
        let [place] = pointers.as_slice() else { return Err(format!("\"{pointer}\" is of both halves")) };
        if quantity.kind != QuantityKind::Word {
            return Err(format!("\"{pointer}\" is not a word of the result; use at_least or at_most"));
        }
        Ok(Self {
            name: pointer.to_owned(),
            label: quantity.label.clone(),
            unit: "",
            source: Source::Word { pointer: place.clone(), word: word.to_owned() },
        })
    }

    /// The smaller margin of both gears.
    pub(in crate::study) fn margin(margin: MarginInput) -> Self {
        use crate::field::Words;
        let unit = match margin {
            MarginInput::TipThickness | MarginInput::TipClearance => "m_n",
            MarginInput::ProfileShift => "",
            MarginInput::ActiveProfile => "mm",
        };
        let name = margin.as_word().to_owned();
        Self { label: format!("margin {name}"), name, unit, source: Source::Margin(margin) }
    }

    pub(in crate::study) fn level(&self) -> Level {
        let pointer = match &self.source {
            Source::Margin(_) => return Level::Geometry,
            Source::Numbers { pointers, .. } => pointers.first().map_or("", String::as_str),
            Source::Word { pointer, .. } => pointer,
        };
        match pointer.split('/').nth(1) {
            Some("geometry") => Level::Geometry,
            Some("mesh" | "impact" | "shafts") => Level::Mesh,
            _ => Level::Response,
        }
    }

    /// The value in a result as JSON; that of a margin comes from the pair.
    ///
    /// # Errors
    /// The result has no such number.
    pub(in crate::study) fn value(&self, result: &Value, pair: &Pair) -> Result<f64, String> {
        match &self.source {
            Source::Margin(margin) => Ok(least_margin(pair, *margin)),
            Source::Word { pointer, word } => {
                let found = result.pointer(pointer).and_then(Value::as_str);
                found.map(|found| f64::from(u8::from(found == word))).ok_or_else(|| absent(pointer))
            }
            Source::Numbers { pointers, halves } => {
                let mut values = Vec::with_capacity(2);
                for pointer in pointers {
                    values.push(result.pointer(pointer).and_then(Value::as_f64).ok_or_else(|| absent(pointer))?);
                }
                let [left, right] = match values[..] {
                    [left, right] => [left, right],
                    _ => [values[0], values[0]],
                };
                Ok(match halves {
                    HalvesInput::Larger => left.max(right),
                    HalvesInput::Mean => 0.5 * (left + right),
                    HalvesInput::Left => left,
                    HalvesInput::Right => right,
                })
            }
        }
    }
}

fn unknown(pointer: &str) -> String {
    format!("\"{pointer}\" is no quantity of the result; GET /api/v1/kinds lists the measures")
}

fn absent(pointer: &str) -> String {
    format!("the result has no number at {pointer}")
}

fn least_margin(pair: &Pair, margin: MarginInput) -> f64 {
    let (kind, is_distance, factor) = match margin {
        MarginInput::TipThickness => (MarginKind::TipThickness, false, 1.0),
        MarginInput::TipClearance => (MarginKind::TipClearance, false, 1.0),
        MarginInput::ProfileShift => (MarginKind::ProfileShift, true, 1.0),
        // As a diameter, in mm.
        MarginInput::ActiveProfile => (MarginKind::ActiveProfileRadius, true, 2e3),
    };
    let of_kind = pair.margins().into_iter().filter(|found| found.kind == kind);
    let value = |found: herringbone_physics::gear::Margin| found.value - if is_distance { found.limit } else { 0.0 };
    factor * of_kind.map(value).fold(f64::INFINITY, f64::min)
}

/// Values at the operating points as one; worst: the largest.
pub(in crate::study) fn reduce(values: &[f64], over: OverInput, shares: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    match over {
        OverInput::Worst => values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        OverInput::Mean => values.iter().sum::<f64>() / count,
        OverInput::Rms => (values.iter().map(|value| value * value).sum::<f64>() / count).sqrt(),
        OverInput::Weighted => {
            let all: f64 = shares.iter().sum();
            let weight = |share: &f64| if all > 0.0 { share / all } else { 1.0 / count };
            values.iter().zip(shares).map(|(value, share)| value * weight(share)).sum()
        }
    }
}
