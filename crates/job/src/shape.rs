//! Axes and rows of a sweep: read from a stored document without the rest of it, and the job document of a single row.

use super::document::{JobDocument, JobKind};
use serde::Deserialize;
use serde::de::IgnoredAny;

impl JobDocument {
    /// The document of a response with the inputs of this sweep, without axes.
    pub fn without_sweep(&self) -> JobDocument {
        JobDocument {
            kind: JobKind::Response,
            axes: Vec::new(),
            continuation: None,
            record: Vec::new(),
            ..self.clone()
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

/// The members of a stored document that determine the rows of a sweep.
#[derive(Debug, Clone, Deserialize)]
pub struct SweepShape {
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
        serde_json::from_str(text)
    }

    /// Rows of the sweep: every point once for each direction of continuation.
    pub fn rows(&self) -> usize {
        let ways = if self.continuation.as_deref() == Some("both") { 2 } else { 1 };
        let length = |axis: &StoredAxis| axis.values.as_ref().map(Vec::len).or(axis.points).unwrap_or(0);
        ways * self.axes.iter().map(length).product::<usize>()
    }

    /// The inputs that vary.
    pub fn pointers(&self) -> Vec<String> {
        self.axes.iter().map(|axis| axis.pointer.clone()).collect()
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
