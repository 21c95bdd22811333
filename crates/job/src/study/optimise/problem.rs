//! An optimisation as a problem of numbers: variables, objectives, violations.

use crate::document::{ConstraintInput, GoalInput, JobDocument, ObjectiveInput, VariableInput};
use crate::study::axes;
use crate::study::evaluation::{Found, Inputs, Measure, check_measure, check_pointers, reduce};
use crate::{DocumentError, Violation};
use std::sync::OnceLock;

/// The problem of a document of kind `optimise`.
pub(in crate::study) struct Problem<'a> {
    pub inputs: Vec<Inputs<'a>>,
    pub variables: &'a [VariableInput],
    /// Whether a variable is a whole number.
    whole: Vec<bool>,
    /// Of the objectives, then of the constraints.
    pub measures: Vec<Measure>,
    pub objectives: &'a [ObjectiveInput],
    pub constraints: &'a [ConstraintInput],
    /// Number of operating points, and their shares.
    points: usize,
    shares: Vec<f64>,
    /// Measures of the document as it is given, once they are known.
    reference: OnceLock<Vec<f64>>,
}

impl<'a> Problem<'a> {
    /// The problem of a document.
    ///
    /// # Errors
    /// [`DocumentError::Invalid`] with every variable and quantity that there is not.
    pub(in crate::study) fn new(document: &'a JobDocument) -> Result<Self, DocumentError> {
        let mut found = Found::new();
        let mut base = axes::base(document);
        let inputs: Vec<Inputs> = document.variables.iter().map(Inputs::of_variable).collect();
        check_pointers(document, &mut base, "variables", &inputs, &mut found);
        if found.is_empty() {
            check_ranges(document, &base, &inputs, &mut found);
        }
        let mut measures = Vec::new();
        for (index, objective) in document.objectives.iter().enumerate() {
            let here = format!("/objectives/{index}/measure");
            measures.extend(check_measure(&objective.measure, objective.halves, &here, &mut found));
        }
        for (index, constraint) in document.constraints.iter().enumerate() {
            let here = format!("/constraints/{index}/measure");
            match (&constraint.measure, constraint.margin, &constraint.is) {
                (_, Some(margin), _) => measures.push(Measure::margin(margin)),
                (Some(pointer), None, Some(word)) => match Measure::word(pointer, word) {
                    Ok(measure) => measures.push(measure),
                    Err(detail) => found.push(Violation::new(here, "conflict", detail)),
                },
                (Some(pointer), None, None) => {
                    measures.extend(check_measure(pointer, constraint.halves, &here, &mut found));
                }
                (None, None, _) => {}
            }
        }
        check_shafts(document, &measures, &mut found);
        if !found.is_empty() {
            return Err(DocumentError::Invalid(found));
        }
        let shares = document.operating_points.iter().map(|point| point.share).collect::<Vec<_>>();
        Ok(Self {
            whole: inputs.iter().map(|inputs| inputs.is_whole(&mut base)).collect(),
            inputs,
            variables: &document.variables,
            measures,
            objectives: &document.objectives,
            constraints: &document.constraints,
            points: shares.len().max(1),
            shares: if shares.is_empty() { vec![1.0] } else { shares },
            reference: OnceLock::new(),
        })
    }

    /// Takes the measures of the document as it is given, to which objectives may be relative.
    ///
    /// # Errors
    /// Index of an objective that is relative to a value which there is not, or which is 0, and why.
    pub(in crate::study) fn relate_to(&self, input: Option<&Vec<f64>>) -> Result<(), (usize, String)> {
        for (index, _) in self.objectives.iter().enumerate().filter(|(_, one)| one.relative_to.is_some()) {
            let Some(measures) = input else {
                return Err((index, "the document itself could not be evaluated".to_owned()));
            };
            if let Some(at) = self.of_measure(measures, index).iter().position(|value| *value == 0.0) {
                return Err((index, format!("its value for the document itself is 0 at operating point {at}")));
            }
        }
        if let Some(measures) = input {
            self.reference.get_or_init(|| measures.clone());
        }
        Ok(())
    }

    /// Values of an objective's measure at the operating points; relative to those of the document if it is so.
    fn values_of(&self, measures: &[f64], index: usize) -> Vec<f64> {
        let values = self.of_measure(measures, index);
        if self.objectives[index].relative_to.is_none() {
            return values.to_vec();
        }
        let reference = self.of_measure(self.reference.get().map_or(measures, Vec::as_slice), index);
        values.iter().zip(reference).map(|(value, own)| value / own.abs()).collect()
    }

    /// Values of the variables at a point of the unit cube, with twelve digits.
    pub(in crate::study) fn values(&self, point: &[f64]) -> Vec<f64> {
        let value = |(index, part): (usize, &f64)| {
            let VariableInput { from, to, .. } = self.variables[index];
            let value = if *part >= 1.0 { to } else { from + part * (to - from) };
            if self.whole[index] { value.round() } else { twelve_digits(value).clamp(from, to) }
        };
        point.iter().enumerate().map(value).collect()
    }

    /// The point of the unit cube nearest to values.
    pub(in crate::study) fn point(&self, values: &[f64]) -> Vec<f64> {
        let part = |(value, variable): (&f64, &VariableInput)| {
            ((value - variable.from) / (variable.to - variable.from)).clamp(0.0, 1.0)
        };
        values.iter().zip(self.variables).map(part).collect()
    }

    /// Distance of the points of each variable's grid in the unit cube; 0 without one.
    pub(in crate::study) fn steps(&self) -> Vec<f64> {
        let step = |(variable, whole): (&VariableInput, &bool)| {
            let step = variable.step.or(whole.then_some(1.0)).unwrap_or(0.0);
            step / (variable.to - variable.from)
        };
        self.variables.iter().zip(&self.whole).map(step).collect()
    }

    /// Whether values are within the bounds and on the grid.
    pub(in crate::study) fn is_permitted(&self, values: &[f64]) -> bool {
        values.iter().zip(self.variables).all(|(value, variable)| {
            let is_within = (variable.from..=variable.to).contains(value);
            let is_on_grid = variable.step.is_none_or(|step| {
                let places = (value - variable.from) / step;
                (places - places.round()).abs() < 1e-6
            });
            is_within && is_on_grid
        })
    }

    /// Values of a measure at the operating points.
    pub(in crate::study) fn of_measure<'m>(&self, measures: &'m [f64], index: usize) -> &'m [f64] {
        &measures[index * self.points..(index + 1) * self.points]
    }

    /// The values of the objectives, as they are shown: of goal target the distance from it.
    pub(in crate::study) fn objectives_of(&self, measures: &[f64]) -> Vec<f64> {
        let value = |(index, objective): (usize, &ObjectiveInput)| {
            let values = self.values_of(measures, index);
            match objective.goal {
                GoalInput::Minimise => reduce(&values, objective.over, &self.shares),
                GoalInput::Maximise => {
                    let negative: Vec<f64> = values.iter().map(|value| -value).collect();
                    -reduce(&negative, objective.over, &self.shares)
                }
                GoalInput::Target => {
                    let target = objective.target.unwrap_or_default();
                    let distances: Vec<f64> = values.iter().map(|value| (value - target).abs()).collect();
                    reduce(&distances, objective.over, &self.shares)
                }
            }
        };
        self.objectives.iter().enumerate().map(value).collect()
    }

    /// Objectives that are all to be made small.
    pub(in crate::study) fn oriented(&self, objectives: &[f64]) -> Vec<f64> {
        let sign = |objective: &ObjectiveInput| if objective.goal == GoalInput::Maximise { -1.0 } else { 1.0 };
        objectives.iter().zip(self.objectives).map(|(value, objective)| sign(objective) * value).collect()
    }

    /// Sum of the normalised violations of the constraints of which the quantities are known.
    pub(in crate::study) fn violation(&self, measures: &[Option<f64>]) -> f64 {
        let first = self.objectives.len();
        let of = |(index, constraint): (usize, &ConstraintInput)| -> f64 {
            let at = (first + index) * self.points;
            let values = &measures[at..at + self.points];
            let counts = |point: usize| {
                constraint.points.as_ref().is_none_or(|points| points.iter().any(|one| *one as usize == point))
            };
            let of_point = |value: f64| violation_of(constraint, value);
            let known = values.iter().enumerate().filter(|(point, _)| counts(*point)).filter_map(|(_, value)| *value);
            known.map(of_point).sum()
        };
        self.constraints.iter().enumerate().map(of).sum()
    }
}

/// Distance of a value from its limits in units of the limit; 0 if it meets them.
fn violation_of(constraint: &ConstraintInput, value: f64) -> f64 {
    if constraint.is.is_some() {
        return 1.0 - value;
    }
    let normalised = |excess: f64, limit: f64| (excess / if limit == 0.0 { 1.0 } else { limit.abs() }).max(0.0);
    let below = constraint.at_least.map_or(0.0, |limit| normalised(limit - value, limit));
    let above = constraint.at_most.map_or(0.0, |limit| normalised(value - limit, limit));
    below + above
}

fn twelve_digits(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Checks that the ends of the variables' ranges are within those of the fields.
fn check_ranges(document: &JobDocument, base: &JobDocument, inputs: &[Inputs], found: &mut Found) {
    for (index, (variable, inputs)) in document.variables.iter().zip(inputs).enumerate() {
        let mut base = base.clone();
        let whole = inputs.pointers().any(|(pointer, _)| base.slot(pointer).is_some_and(|slot| slot.is_whole_number()));
        for (name, value) in [("from", Some(variable.from)), ("to", Some(variable.to)), ("step", variable.step)] {
            let Some(value) = value else { continue };
            let here = format!("/variables/{index}/{name}");
            if whole && value.fract() != 0.0 {
                found.push(Violation::new(here, "wrong-type", format!("is {value}; the input is a whole number")));
                continue;
            }
            if name == "step" {
                continue;
            }
            let mut violations = Vec::new();
            inputs.put(&mut base.clone(), value, &mut violations);
            found.extend(violations.into_iter().take(1).map(|violation| Violation {
                detail: format!("at {} {}", violation.pointer, violation.detail),
                pointer: here.clone(),
                ..violation
            }));
        }
    }
}

/// Measures of shafts need shafts.
pub(in crate::study) fn check_shafts(document: &JobDocument, measures: &[Measure], found: &mut Found) {
    if document.design.shafts.is_some() {
        return;
    }
    for measure in measures.iter().filter(|measure| measure.name.starts_with("/shafts/")) {
        let detail = format!("is needed: \"{}\" is a quantity of the shafts", measure.name);
        found.push(Violation::new("/design/shafts", "missing", detail));
    }
}
