//! The shape of a stored sweep: its axes and how many rows it has, without reading the rest of its document.

use serde::Deserialize;
use serde::de::IgnoredAny;

/// What a document as it was accepted says of its rows.
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
    /// What is wrong with the text.
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
    use crate::job::parse;

    #[test]
    fn it_agrees_with_the_document() {
        let mut document: serde_json::Value =
            serde_json::from_str(include_str!("../../examples/speed_sweep.json")).unwrap();
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
