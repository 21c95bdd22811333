//! The headline numbers of a result as a text table.

use herringbone_job::result::{Accuracy, JobResult, Quantity, quantities};
use serde_json::Value;
use std::io::{Result, Write};

/// Writes one line for each number that the fields of the result declare as a headline: name, value, unit.
///
/// # Errors
/// Those of `out`.
pub(super) fn write(out: &mut impl Write, result: &JobResult) -> Result<()> {
    let value = serde_json::to_value(result)?;
    for quantity in headlines() {
        for (pointer, label) in quantity.places() {
            if let Some(number) = value.pointer(&pointer).and_then(Value::as_f64) {
                let number = if quantity.percent { 100.0 * number } else { number };
                writeln!(out, "{label:<46} {number:>12.5} {}", quantity.unit)?;
            } else if let Some(entry) = result.numerics.not_finite.iter().find(|entry| entry.pointer == pointer) {
                writeln!(out, "{label:<46} {}", entry.reason)?;
            }
        }
    }
    if let Some(response) = &result.response {
        let (regime, contact) = (response.regime.as_str(), response.contact.as_str());
        writeln!(out, "{:<46} {regime}, {contact} contact ({})", "motion", response.method.as_str())?;
    }
    if let Some(sweep) = &result.sweep {
        let failed = sweep.points.iter().filter(|point| point.error.is_some()).count();
        writeln!(out, "{:<46} {} points, {failed} without a response", "sweep", sweep.points.len())?;
    }
    if let Some(accuracy) = &result.accuracy {
        write_accuracy(out, accuracy)?;
    }
    for warning in &result.warnings {
        writeln!(out, "warning ({}): {} {}", warning.code, warning.pointer, warning.detail)?;
    }
    Ok(())
}

/// Block after block, in each by rank.
fn headlines() -> Vec<&'static Quantity> {
    let mut headlines: Vec<_> = quantities().iter().filter(|quantity| quantity.headline.is_some()).collect();
    for block in headlines.chunk_by_mut(|a, b| a.block() == b.block()) {
        block.sort_by_key(|quantity| quantity.headline);
    }
    headlines
}

fn write_accuracy(out: &mut impl Write, accuracy: &Accuracy) -> Result<()> {
    let model = &accuracy.model;
    let percent = |value: Option<f64>| value.map_or("unknown".to_owned(), |value| format!("{value} %"));
    let stiffness = percent(model.mesh_stiffness_percent);
    let harmonic = percent(model.transmission_error_harmonic_percent);
    let name = "error of the model";
    writeln!(out, "{name:<46} mesh stiffness {stiffness}, transmission error's first harmonic {harmonic}")?;
    if let Some(numerical) = accuracy.numerical {
        writeln!(out, "{:<46} {numerical:.1e}", "numerical error, relative")?;
    }
    Ok(())
}
