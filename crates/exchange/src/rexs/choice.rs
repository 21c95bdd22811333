//! The choice of a pair.

use super::model::Model;
use super::stages::{Candidate, Stages};
use crate::ImportOptions;
use crate::refusal::Refusal;
use crate::report::{Alternative, StageKind};
use herringbone_job::Violation;
use std::collections::BTreeSet;

/// Most stages that are named in a refusal.
const MAX_NAMED: usize = 30;

/// The chosen pair, with its number.
#[derive(Debug)]
pub(super) struct Choice {
    pub number: usize,
    pub candidate: Candidate,
    pub mirrored: bool,
    /// Why the choice is not what was asked for.
    pub note: Option<&'static str>,
}

/// Chooses a pair of a model.
///
/// # Errors
/// [`Refusal`] with all pairs and stages, where none can be taken without asking.
pub(super) fn choose(model: &Model, stages: &Stages, options: &ImportOptions) -> Result<Choice, Refusal> {
    let candidates = &stages.candidates;
    if candidates.is_empty() {
        return Err(none(model, stages));
    }
    let doubles = candidates.iter().filter(|one| one.kind == StageKind::DoubleHelical).count();
    let singles = candidates.len() - doubles;
    let index = match options.pair {
        Some(number) => chosen(model, stages, number)?,
        None if doubles == 1 => 0,
        None if doubles == 0 && singles == 1 && options.mirror => 0,
        None if doubles == 0 && !options.mirror => {
            let kinds: BTreeSet<_> = candidates.iter().map(|one| one.halves[0].kind_of_teeth()).collect();
            let kinds = Vec::from_iter(kinds).join(" and ");
            let summary =
                format!("The file has {kinds} stages only; mirror makes a double-helical pair of one of them.");
            return Err(Refusal::unsupported(summary, listed(model, stages, "single-helical")));
        }
        None => {
            let what = if doubles == 0 { "stages" } else { "double-helical pairs" };
            let summary = format!("The file has several {what}: choose one by its number (pair).");
            return Err(Refusal::unsupported(summary, listed(model, stages, "choose-pair")));
        }
    };
    let candidate = candidates[index].clone();
    let mirrored = candidate.kind == StageKind::SingleHelical;
    if mirrored && !options.mirror {
        let kind = candidate.halves[0].kind_of_teeth();
        let detail = format!(
            "{}: a {kind} stage; mirror makes a double-helical pair of it, each half a copy of the stage",
            candidate.halves[0].describe(model)
        );
        let error = Violation::new(format!("/pair/{}", index + 1), "single-helical", detail);
        return Err(Refusal::unsupported(format!("The chosen stage is {kind}."), vec![error]));
    }
    let note =
        (options.mirror && !mirrored).then_some("is double-helical as it stands in the file: nothing was mirrored");
    Ok(Choice { number: index + 1, candidate, mirrored, note })
}

/// The candidate with a number, or with the id of a stage.
fn chosen(model: &Model, stages: &Stages, number: u64) -> Result<usize, Refusal> {
    let most = stages.candidates.len();
    if let Some(index) = usize::try_from(number).ok().filter(|number| (1..=most).contains(number)) {
        return Ok(index - 1);
    }
    let has_stage = |candidate: &Candidate| candidate.ids(model).iter().any(|id| u64::try_from(*id) == Ok(number));
    stages.candidates.iter().position(has_stage).ok_or_else(|| {
        let detail =
            format!("is {number}; the file has {most} pair(s) and stage(s): 1 to {most}, or the id of a stage");
        let mut errors = vec![Violation::new("/pair", "out-of-range", detail)];
        errors.extend(listed(model, stages, "choose-pair"));
        Refusal::invalid("There is no such pair in the file.", errors)
    })
}

/// What there is to choose from, and why other stages are not.
fn listed(model: &Model, stages: &Stages, code: &str) -> Vec<Violation> {
    let mut errors: Vec<_> = stages
        .candidates
        .iter()
        .enumerate()
        .map(|(index, candidate)| {
            let ids = candidate.ids(model).iter().map(i64::to_string).collect::<Vec<_>>().join(" and ");
            let kind = match candidate.kind {
                StageKind::DoubleHelical => "double-helical",
                StageKind::SingleHelical => candidate.halves[0].kind_of_teeth(),
            };
            let text = candidate.halves.iter().map(|half| half.describe(model)).collect::<Vec<_>>().join(" + ");
            let detail = format!("pair {}: {text} (stage {ids}), {kind}", index + 1);
            Violation::new(format!("/pair/{}", index + 1), code, detail)
        })
        .collect();
    errors.extend(reasons(stages));
    errors.truncate(MAX_NAMED);
    errors
}

fn reasons(stages: &Stages) -> impl Iterator<Item = Violation> + '_ {
    stages.reasons.iter().map(|(name, reason)| Violation::new("/pair", "unsupported-stage", format!("{name} {reason}")))
}

/// Refusal of a model without a pair.
fn none(model: &Model, stages: &Stages) -> Refusal {
    let mut errors: Vec<_> = reasons(stages).collect();
    let others = ["planetary_stage", "bevel_stage", "worm_stage", "hypoid_stage"];
    for kind in others {
        for stage in model.of_kind(kind).take(5) {
            let detail = format!("{} is a {}, which is not calculated", model.name(stage), kind.replace('_', " "));
            errors.push(Violation::new("/pair", "unsupported-stage", detail));
        }
    }
    errors.truncate(MAX_NAMED);
    let has_cylindrical = model.of_kind("cylindrical_stage").next().is_some();
    let summary = match (errors.is_empty(), has_cylindrical) {
        (true, _) => "The file has no gear stage.",
        (false, true) => "The file has no stage of two external cylindrical gears that can be taken.",
        (false, false) => "The file has no cylindrical stage.",
    };
    if errors.is_empty() {
        let detail = "has no cylindrical_stage: nothing to make a double-helical pair of";
        errors.push(Violation::new("/pair", "no-cylindrical-stage", detail));
    }
    Refusal::unsupported(summary, errors)
}

/// The pairs that were not chosen.
pub(super) fn alternatives(model: &Model, stages: &Stages, chosen: usize) -> Vec<Alternative> {
    let numbered = stages.candidates.iter().enumerate().map(|(index, candidate)| (index + 1, candidate));
    numbered
        .filter(|(number, _)| *number != chosen)
        .map(|(number, candidate)| Alternative {
            number,
            label: candidate.label(model),
            stages: candidate.ids(model),
            kind: candidate.kind,
        })
        .collect()
}
