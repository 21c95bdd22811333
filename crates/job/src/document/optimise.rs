//! The inputs of an optimisation: what varies, what is to be small, and what has to hold.

use super::evaluation::{HalvesInput, MAX_ALSO, MAX_EVALUATIONS, OverInput, POINTER_CHARS, require};
use super::{JobDocument, MAX_OPERATING_POINTS};
use crate::reader::ObjectPlace;
use herringbone_macros::{Input, Words};
use serde::Serialize;

/// Largest numbers of variables, objectives and constraints.
pub const MAX_VARIABLES: usize = 12;
pub const MAX_OBJECTIVES: usize = 3;
pub const MAX_CONSTRAINTS: usize = 32;
/// Best designs of a search that are evaluated once more with the settings of the document.
pub const CONFIRMED: usize = 10;
/// Neighbouring speeds at which the best design is evaluated.
pub const SPEED_STEPS: usize = 4;

/// An input that varies between two values.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct VariableInput {
    /// JSON pointer of the input that varies.
    #[input(max_chars = POINTER_CHARS)]
    pub pointer: String,
    /// JSON pointers of further inputs that take its value.
    #[input(max_items = MAX_ALSO)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<String>,
    /// Factors of the value for the inputs of also, such as -1 for the slope of the other half; 1 when null.
    #[input(min = -1e6, max = 1e6, min_items = 1, max_items = MAX_ALSO)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub also_factors: Option<Vec<f64>>,
    /// Least value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    pub from: f64,
    /// Greatest value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    pub to: f64,
    /// Distance of the values on which the result has to end, counted from the least one; any value when null. Whole numbers have 1.
    #[input(unit = "unit of the input", min = 1e-9, max = 1e12)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
}

/// What is to be done with the value of an objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum GoalInput {
    /// As small as possible.
    Minimise,
    /// As large as possible.
    Maximise,
    /// As near as possible to a value.
    Target,
}

/// What the value of an objective is divided by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum RelativeToInput {
    /// The value of the document as it is given, at the same operating point.
    Input,
}

/// A quantity that is to be small, large or near to a value.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct ObjectiveInput {
    /// JSON pointer of a number of the result, or of the values of both halves.
    #[input(max_chars = POINTER_CHARS)]
    pub measure: String,
    /// Value of a quantity of which each half has its own.
    #[input(default = HalvesInput::Larger)]
    pub halves: HalvesInput,
    /// Value over the operating points; worst: the largest, with maximise the smallest, with target the farthest one.
    #[input(default = OverInput::Worst)]
    pub over: OverInput,
    /// minimise, maximise, or as near as possible to target.
    #[input(default = GoalInput::Minimise)]
    pub goal: GoalInput,
    /// Value to come near to; with goal target only.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<f64>,
    /// input: at each operating point the measure is divided by its value for the document as it is given, so that no point counts more
    /// because its values are larger; the objective is a ratio then, 1 for the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_to: Option<RelativeToInput>,
}

/// Margin of the pair to what is warned of or refused; of both gears, the smaller one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum MarginInput {
    /// Normal thickness at the tip circle, in normal modules.
    #[words(rename = "tip-thickness")]
    TipThickness,
    /// Clearance between tip and root of the mate, in normal modules.
    #[words(rename = "tip-clearance")]
    TipClearance,
    /// Profile shift coefficient above that from which on the rack undercuts the tooth.
    #[words(rename = "profile-shift")]
    ProfileShift,
    /// Diameter at which the mate's tip ends the contact above the root form diameter, mm.
    #[words(rename = "active-profile")]
    ActiveProfile,
}

/// A condition that a design has to meet.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct ConstraintInput {
    /// JSON pointer of a number or word of the result; or margin.
    #[input(max_chars = POINTER_CHARS)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measure: Option<String>,
    /// A margin of the pair, instead of measure: the smaller one of both gears. tip-thickness and tip-clearance in normal modules,
    /// profile-shift above that of undercut, active-profile as a diameter above that of the root form, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub margin: Option<MarginInput>,
    /// Value of a quantity of which each half has its own.
    #[input(default = HalvesInput::Larger)]
    pub halves: HalvesInput,
    /// Least permitted value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// Greatest permitted value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
    /// Required word, such as continuous for /response/contact.
    #[input(max_chars = 40)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is: Option<String>,
    /// Operating points, from 0, at which it has to be met; all when null.
    #[input(min = 0.0, max = MAX_OPERATING_POINTS - 1, min_items = 1, max_items = MAX_OPERATING_POINTS)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<f64>>,
}

/// Effort of the search.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct BudgetInput {
    /// Most evaluations of the search; 300 + 150 for each variable when null, for each search where there are several objectives.
    #[input(min = 10, max = MAX_EVALUATIONS)]
    pub evaluations: Option<u32>,
    /// Spread of the search, as a part of the variables' ranges, at which it ends.
    #[input(min = 1e-12, max = 0.1, default = 1e-4)]
    pub accuracy: f64,
    /// Time after which the search ends with the best design so far; no limit when null. How far a search comes in a time depends on the
    /// machine and its load: rows and result of equal documents can differ.
    #[input(unit = "s", min = 1.0, max = 1e6)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seconds: Option<f64>,
}

/// Method of the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum SearchMethodInput {
    /// Nelder-Mead up to three variables, else CMA-ES.
    Auto,
    /// Evolution strategy with covariance matrix adaptation.
    #[words(rename = "cma_es", label = "CMA-ES")]
    CmaEs,
    /// Simplex search.
    #[words(label = "Nelder–Mead")]
    NelderMead,
}

/// Statistic of an objective over the sample of a tolerance study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum RobustMeasureInput {
    /// The mean.
    Mean,
    /// Percentiles.
    P50,
    P75,
    P90,
    P95,
    /// The largest value.
    Max,
}

/// Choice of the best design by its values over the tolerances.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct RobustInput {
    /// Statistic of the first objective by which the candidates are ranked.
    #[input(default = RobustMeasureInput::P90)]
    pub measure: RobustMeasureInput,
    /// Points of the common sample with which the candidates are compared.
    #[input(min = 8, max = 4096, default = 32)]
    pub samples: u32,
    /// Best designs of the search that are compared, each at least a twentieth of a range from the others.
    #[input(min = 1, max = 100, default = 10)]
    pub candidates: u32,
    /// Points of another sample for the numbers of the input and of the winner.
    #[input(min = 8, max = 8192, default = 256)]
    pub confirm_samples: u32,
    /// Whether a further search, on the statistic itself over the common sample, starts from the winner.
    #[input(default = false)]
    pub search: bool,
    /// Most designs of that search, each with the common sample; 40 + 20 for each variable when null.
    #[input(min = 10, max = 10_000)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub search_designs: Option<u32>,
}

pub(super) fn rules(document: &mut JobDocument, place: &ObjectPlace) {
    require(place, "variables", document.variables.is_empty(), "1 to 12 inputs that vary");
    require(place, "objectives", document.objectives.is_empty(), "1 to 3 quantities to be improved");
    document.method = document.method.or(Some(SearchMethodInput::Auto));
    let usual = 300 + 150 * document.variables.len() as u32;
    let searches = match document.objectives.len() {
        2 => 7,
        3 => 10,
        _ => 1,
    };
    let budget = document.budget.get_or_insert(BudgetInput { evaluations: None, accuracy: 1e-4, seconds: None });
    budget.evaluations = budget.evaluations.or(Some((usual * searches).min(MAX_EVALUATIONS)));
    if let Some(robust) = &mut document.robust {
        match (robust.search, robust.search_designs) {
            (true, None) => robust.search_designs = Some(40 + 20 * document.variables.len() as u32),
            (false, Some(_)) => place.conflict("robust/search_designs", "is given, but search is not true"),
            _ => {}
        }
        require(place, "tolerances", document.tolerances.is_empty(), "robust needs tolerances");
    }
    for (index, variable) in document.variables.iter().enumerate() {
        let at = |name: &str| format!("variables/{index}/{name}");
        let is_refused = ["from", "to", "step"].iter().any(|name| place.is_refused(&at(name)));
        if is_refused || !place.is_reading_object() {
            continue;
        }
        if variable.from >= variable.to {
            place.conflict(
                &at("to"),
                format!("is {}; it has to be above from, which is {}", variable.to, variable.from),
            );
        } else if variable.step.is_some_and(|step| step > variable.to - variable.from) {
            place.conflict(&at("step"), "is larger than the distance of from and to");
        }
        if variable.also_factors.as_ref().is_some_and(|factors| factors.len() != variable.also.len()) {
            place.conflict(
                &at("also_factors"),
                format!("needs a factor for each of the {} inputs of also", variable.also.len()),
            );
        }
    }
    for (index, objective) in document.objectives.iter().enumerate() {
        let at = |name: &str| format!("objectives/{index}/{name}");
        if objective.relative_to.is_some() && objective.goal == GoalInput::Target {
            place.conflict(&at("relative_to"), "is given, but a distance from a target has no sense as a ratio");
        }
        match (objective.goal, objective.target) {
            (GoalInput::Target, None) if !place.is_refused(&at("target")) => {
                place.missing(&at("target"), "is required for goal target: the value to come near to");
            }
            (GoalInput::Minimise | GoalInput::Maximise, Some(_)) => {
                place.conflict(&at("target"), "is given, but goal is not \"target\"");
            }
            (GoalInput::Maximise, None) if objective.over == OverInput::Rms => {
                place.conflict(&at("over"), "is rms, which has no sense with goal maximise; use mean or worst");
            }
            _ => {}
        }
    }
    constraint_rules(document, place);
}

fn constraint_rules(document: &JobDocument, place: &ObjectPlace) {
    let points = document.operating_points.len().max(1);
    for (index, constraint) in document.constraints.iter().enumerate() {
        let at = |name: &str| format!("constraints/{index}/{name}");
        let refused = ["measure", "margin", "at_least", "at_most", "is"].iter().any(|name| place.is_refused(&at(name)));
        if refused {
            continue;
        }
        match (&constraint.measure, constraint.margin) {
            (Some(_), Some(_)) => {
                place.conflict(&at("margin"), "is given together with measure; give one or the other");
            }
            (None, None) => place.missing(&at("measure"), "is required, unless margin is given"),
            _ => {}
        }
        let has_range = constraint.at_least.is_some() || constraint.at_most.is_some();
        if has_range == constraint.is.is_some() {
            let detail = "is required: at_least, at_most or both for a number, is for a word";
            place.conflict(&format!("constraints/{index}"), detail);
        }
        if let (Some(least), Some(most)) = (constraint.at_least, constraint.at_most)
            && least > most
        {
            place.conflict(&at("at_most"), format!("is {most}, below at_least, which is {least}"));
        }
        if constraint.margin.is_some() && constraint.is.is_some() {
            place.conflict(&at("is"), "is given, but a margin is a number");
        }
        for (item, point) in constraint.points.iter().flatten().enumerate() {
            if point.fract() != 0.0 || *point as usize >= points {
                let detail = format!("is {point}; permitted: whole numbers from 0 to {}", points - 1);
                place.conflict(&at(&format!("points/{item}")), detail);
            }
        }
    }
}
