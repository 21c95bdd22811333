//! Axes and rows of a sweep: read from a stored document without the rest of it, and the job document of a single row.

use super::document::{JobDocument, JobKind};
use super::field::Words;
use super::result::{Cell, SweepPoint};
use serde::Deserialize;
use serde::de::IgnoredAny;

impl JobDocument {
    /// The document of a response with the inputs of this job: without axes, variables and tolerances.
    pub fn without_sweep(&self) -> JobDocument {
        JobDocument {
            name: self.name.clone(),
            label: self.label.clone(),
            model: self.model.clone(),
            analysis: self.analysis.clone(),
            kind: JobKind::Response,
            axes: Vec::new(),
            continuation: None,
            record: Vec::new(),
            operating_points: Vec::new(),
            variables: Vec::new(),
            objectives: Vec::new(),
            constraints: Vec::new(),
            robust: None,
            budget: None,
            method: None,
            tolerances: Vec::new(),
            measures: Vec::new(),
            correlations: Vec::new(),
            limits: Vec::new(),
            samples: None,
            sampling: None,
            sensitivity: None,
            seed: None,
            sweep_point: self.sweep_point.clone(),
            design: self.design.clone(),
            operation: self.operation.clone(),
        }
    }

    /// The document of a row of this sweep as a job of its own: a response with the values of the axes put in. None
    /// where the sweep has no such row.
    pub fn of_row(&self, position: usize) -> Option<JobDocument> {
        if position >= self.sweep_points() {
            return None;
        }
        let mut document = self.without_sweep();
        let mut place = position;
        for axis in &self.axes {
            for pointer in axis.pointers() {
                document.slot(pointer)?.set(axis.value(place % axis.len())).ok()?;
            }
            place /= axis.len();
        }
        Some(document)
    }
}

/// What a stored document says of the rows of its job.
#[derive(Debug, Clone)]
pub struct SweepShape {
    rows: usize,
    pointers: Vec<String>,
    further: Vec<String>,
    /// Number of objectives; `None` of anything but an optimisation.
    objectives: Option<usize>,
}

/// The members of a stored document that determine the rows of a sweep.
#[derive(Debug, Clone, Deserialize)]
struct StoredSweep {
    kind: String,
    #[serde(default)]
    axes: Vec<StoredAxis>,
    #[serde(default)]
    continuation: Option<String>,
}

#[derive(Debug, Clone, Deserialize)]
struct StoredAxis {
    pointer: String,
    points: Option<usize>,
    values: Option<Vec<IgnoredAny>>,
}

impl SweepShape {
    /// Reads a document that was accepted before.
    ///
    /// # Errors
    /// The error of the parser, if the text is not such a document.
    pub fn of_stored(text: &str) -> Result<Self, serde_json::Error> {
        let stored: StoredSweep = serde_json::from_str(text)?;
        if stored.kind != JobKind::Sweep.as_str() {
            let document = super::parse(text.as_bytes()).map_err(serde::de::Error::custom)?;
            return Ok(Self::of_evaluations(&document));
        }
        let ways = if stored.continuation.as_deref() == Some("both") { 2 } else { 1 };
        let length = |axis: &StoredAxis| axis.values.as_ref().map(Vec::len).or(axis.points).unwrap_or(0);
        Ok(Self {
            rows: ways * stored.axes.iter().map(length).product::<usize>(),
            pointers: stored.axes.into_iter().map(|axis| axis.pointer).collect(),
            further: Vec::new(),
            objectives: None,
        })
    }

    fn of_evaluations(document: &JobDocument) -> Self {
        let variables = document.variables.iter().map(|variable| &variable.pointer);
        let of_optimisation = document.kind == JobKind::Optimise;
        let pointers: Vec<String> = match of_optimisation {
            true => variables.cloned().collect(),
            false => document.tolerances.iter().map(|tolerance| tolerance.pointer.clone()).collect(),
        };
        let mut further = vec!["phase".to_owned()];
        let mut measures: Vec<String> = document.measures.iter().map(|measure| measure.measure.clone()).collect();
        if of_optimisation {
            further.extend(["generation", "violation"].map(str::to_owned));
            further.extend((1..=document.objectives.len()).map(|number| format!("objective_{number}")));
            measures.extend(document.objectives.iter().map(|objective| objective.measure.clone()));
            measures.extend(document.constraints.iter().map(|constraint| {
                let margin = constraint.margin.map(|margin| margin.as_word().to_owned());
                constraint.measure.clone().or(margin).unwrap_or_default()
            }));
        }
        let points = document.operating_points.len().max(1);
        for measure in measures {
            further.extend((0..points).map(|point| format!("{measure} at {point}")));
        }
        let rows = usize::try_from(document.evaluations()).unwrap_or(usize::MAX);
        Self { rows, pointers, further, objectives: of_optimisation.then_some(document.objectives.len()) }
    }

    /// Rows: every point of a sweep once for each direction of continuation, evaluations of other jobs (of an
    /// optimisation at most so many).
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The inputs that vary.
    pub fn pointers(&self) -> &[String] {
        &self.pointers
    }

    /// Names of the further cells of a row, as [`SweepShape::cells`] gives them; none of a sweep.
    pub fn further(&self) -> &[String] {
        &self.further
    }

    /// The cells of [`SweepShape::further`] of a row.
    pub fn cells(&self, row: &SweepPoint) -> Vec<Cell<'static>> {
        if self.further.is_empty() {
            return Vec::new();
        }
        let mut cells = vec![Cell::Word(row.phase.map(|phase| phase.as_str().into()))];
        if let Some(count) = self.objectives {
            cells.extend([Cell::Number(row.generation.map(f64::from)), Cell::Number(row.violation)]);
            let objectives = row.objectives.as_deref().unwrap_or_default();
            cells.extend((0..count).map(|index| Cell::Number(objectives.get(index).copied())));
        }
        let measures = row.measures.as_deref().unwrap_or_default();
        let left = self.further.len() - cells.len();
        cells.extend((0..left).map(|index| Cell::Number(measures.get(index).copied())));
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse;

    #[test]
    fn it_agrees_with_the_document() {
        let mut document: serde_json::Value =
            serde_json::from_str(include_str!("../../../examples/speed_sweep.json")).unwrap();
        let values = serde_json::json!({"pointer": "/operation/pinion_torque_nm", "values": [100.0, 200.0, 300.0]});
        document["axes"].as_array_mut().unwrap().push(values);
        for continuation in ["none", "up", "down", "both"] {
            document["continuation"] = continuation.into();
            let accepted = parse(document.to_string().as_bytes()).unwrap();
            let shape = SweepShape::of_stored(&serde_json::to_string(&accepted).unwrap()).unwrap();
            assert_eq!(shape.rows(), accepted.sweep_points(), "{continuation}");
            assert_eq!(shape.pointers(), ["/operation/pinion_speed_rpm", "/operation/pinion_torque_nm"]);
        }
    }
}
