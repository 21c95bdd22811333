//! The headline numbers of a result as a text table.

use herringbone_job::result::{Accuracy, JobResult, OptimiseResult, Quantity, ToleranceResult, quantities};
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
    if let Some(optimise) = &result.optimise {
        write_optimisation(out, optimise)?;
    }
    if let Some(tolerance) = &result.tolerance {
        write_tolerance(out, tolerance)?;
    }
    if let Some(accuracy) = &result.accuracy {
        write_accuracy(out, accuracy)?;
    }
    for warning in &result.warnings {
        writeln!(out, "warning ({}): {} {}", warning.code, warning.pointer, warning.detail)?;
    }
    Ok(())
}

fn write_optimisation(out: &mut impl Write, result: &OptimiseResult) -> Result<()> {
    writeln!(out, "{:<46} {}", "optimisation", result.verdict)?;
    let text = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.5}"));
    for objective in &result.objectives {
        let (input, best) = (text(objective.input), text(objective.best));
        let gain = objective.gain_percent.map_or(String::new(), |gain| format!(" ({gain:.1} % better)"));
        writeln!(out, "{:<46} {input} -> {best} {}{gain}", objective.label, objective.unit)?;
    }
    for (pointer, value) in result.best.iter().flat_map(|best| &best.values) {
        let input = text(result.input.values.get(pointer).copied().flatten());
        writeln!(out, "{pointer:<46} {input} -> {value:.5}")?;
    }
    for limit in &result.active {
        let (what, at) = (limit.pointer.as_ref().or(limit.constraint.as_ref()), limit.at.as_deref());
        writeln!(out, "{:<46} {} ({})", "limited by", what.map_or("", String::as_str), at.unwrap_or("constraint"))?;
    }
    let numerics = &result.numerics;
    writeln!(out, "{:<46} {} ({}, by {})", "evaluations", numerics.evaluations, numerics.method, numerics.stopped_by)
}

fn write_tolerance(out: &mut impl Write, result: &ToleranceResult) -> Result<()> {
    for measure in &result.measures {
        let nominal = measure.nominal.map_or("-".to_owned(), |value| format!("{value:.5}"));
        write!(out, "{:<46} nominal {nominal}", measure.label)?;
        for name in ["p50", "p90", "p95"] {
            if let Some(percentile) = measure.percentiles.get(name) {
                write!(out, ", {} {:.5}", name.to_uppercase(), percentile.value)?;
            }
        }
        writeln!(out, " {}", measure.unit)?;
        if let Some(beyond) = &measure.beyond_limit {
            let [share, low, high] = [beyond.share, beyond.low, beyond.high].map(|share| 100.0 * share);
            writeln!(out, "{:<46} {share:.1} % ({low:.1} to {high:.1} %)", "beyond the limit")?;
        }
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
