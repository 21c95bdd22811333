//! Estimate of the peak memory of a document's calculation, made before it starts.
//!
//! Upper estimates from the sizes that grow with the input, without the constant part of every job (a few tens of MiB).
//! `scripts/memory` compares them with the measured peak of runs.

use crate::document::{Axis, Elements, Fidelity, JobDocument, JobKind, MeshStiffness};

const MIB: f64 = 1_048_576.0;
/// Size of a sample of a channel.
const SAMPLE_BYTES: f64 = 8.0;
/// Copies of each channel in memory: the samples, and their copy during compression.
const PER_CHANNEL: f64 = 2.0;
/// Memory of a spectrum in channels: the channel, its window, its transform and the plan of the transform.
const SPECTRUM_CHANNELS: f64 = 5.0;
/// Memory of a row of a sweep: its numbers and its JSON text.
const ROW_BYTES: f64 = 2048.0;
/// Memory of a row with Poincaré points or a spectrum.
const RECORDED_ROW_BYTES: f64 = 32_768.0;

/// Peak memory of a calculation, MiB, by its cause.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Demand {
    /// Recorded channels.
    pub series_mib: f64,
    /// Finite elements of a gear; of several gears at once in a sweep over the design.
    pub finite_elements_mib: f64,
    /// Rows of a sweep.
    pub rows_mib: f64,
}

impl Demand {
    pub fn total_mib(&self) -> f64 {
        self.series_mib + self.finite_elements_mib + self.rows_mib
    }

    /// JSON pointer of the field of the document that causes the largest part.
    pub fn largest(&self) -> &'static str {
        let parts = [
            (self.series_mib, "/analysis/samples_per_mesh_period"),
            (self.finite_elements_mib, "/model/mesh_stiffness/elements"),
            (self.rows_mib, "/axes"),
        ];
        parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or("", |(_, pointer)| pointer)
    }
}

/// Peak memory of a checked document solved on `threads` threads.
pub fn demand(document: &JobDocument, threads: usize) -> Demand {
    let is_sweep = document.kind == JobKind::Sweep;
    let series_mib = match document.kind {
        JobKind::Response => {
            let channels = super::vibration::channels(document).map_or(0, |channels| channels.len());
            let analysis = &document.analysis;
            let samples = f64::from(analysis.record_mesh_periods) * f64::from(analysis.samples_per_mesh_period);
            (PER_CHANNEL * channels as f64 + SPECTRUM_CHANNELS) * samples * SAMPLE_BYTES / MIB
        }
        JobKind::Mesh | JobKind::Sweep => 0.0,
    };
    let over_design =
        is_sweep && document.axes.iter().flat_map(Axis::pointers).any(|pointer| pointer.starts_with("/design"));
    let gears_at_once = if over_design { threads.min(document.sweep_points()).max(1) } else { 1 };
    let row_bytes = if document.record.is_empty() { ROW_BYTES } else { RECORDED_ROW_BYTES };
    Demand {
        series_mib,
        finite_elements_mib: gears_at_once as f64 * finite_elements_mib(document),
        rows_mib: document.sweep_points() as f64 * row_bytes / MIB,
    }
}

/// Peak of the elimination and of the teeth's coupling, MiB at a face 12.5 modules wide, and the width in modules from
/// which on the number of load cells along the face stays the same. Measured (`scripts/memory`).
const FINITE_ELEMENTS: [(Elements, f64, f64); 4] = [
    (Elements::Coarse, 60.0, 73.0),
    (Elements::Medium, 270.0, 36.5),
    (Elements::Standard, 500.0, 36.5),
    (Elements::Fine, 1200.0, 36.5),
];
const MEASURED_WIDTH: f64 = 12.5;
/// Growth with the width in modules below and above that width: an upper estimate.
const EXPONENTS: (f64, f64) = (1.35, 0.5);

fn finite_elements_mib(document: &JobDocument) -> f64 {
    let MeshStiffness::Ltca(ltca) = &document.model.mesh_stiffness else { return 0.0 };
    let found = FINITE_ELEMENTS.iter().find(|(elements, ..)| *elements == ltca.elements);
    let Some((_, measured_mib, full_width)) = found.filter(|_| ltca.fidelity == Fidelity::Fe) else { return 0.0 };
    let width = widest(document) / document.design.normal_module_mm;
    let below = (width.clamp(4.0, *full_width) / MEASURED_WIDTH).powf(EXPONENTS.0);
    let above = (width / full_width).max(1.0).powf(EXPONENTS.1);
    measured_mib * below * above
}

/// Face width of the widest point, mm.
fn widest(document: &JobDocument) -> f64 {
    let is_width = |pointer: &str| pointer.starts_with("/design") && pointer.ends_with("/face_width_mm");
    let swept = document.axes.iter().filter(|axis| axis.pointers().any(is_width));
    let values = swept.flat_map(|axis: &Axis| (0..axis.len()).map(|index| axis.value(index)));
    let design = &document.design;
    let own = [design.pinion.face_width_mm, design.gear.face_width_mm].into_iter().flatten();
    values.chain(own).fold(design.face_width_mm, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_value;
    use serde_json::{Value, json};

    fn demand_of(change: impl FnOnce(&mut Value)) -> Demand {
        let path = format!("{}/../../examples/table1.json", env!("CARGO_MANIFEST_DIR"));
        let mut value: Value = serde_json::from_slice(&std::fs::read(path).expect("readable")).expect("JSON");
        change(&mut value);
        demand(&parse_value(&value).expect("valid"), 2)
    }

    #[test]
    fn an_ordinary_job_asks_for_next_to_nothing() {
        assert!(demand_of(|_| ()).total_mib() < 50.0);
    }

    #[test]
    fn long_records_fine_elements_and_large_sweeps_say_where_they_ask() {
        let record = demand_of(|value| {
            value["analysis"] = json!({"method": "integrate", "mesh_periods": 10_000, "record_mesh_periods": 10_000,
                "samples_per_mesh_period": 400});
        });
        assert!(record.total_mib() > 2000.0 && record.largest() == "/analysis/samples_per_mesh_period", "{record:?}");
        let elements = |value: &mut Value| {
            value["kind"] = json!("mesh");
            value["model"]["mesh_stiffness"] = json!({"source": "ltca", "fidelity": "fe", "elements": "fine"});
        };
        let fine = demand_of(elements);
        assert!(fine.total_mib() > 1000.0 && fine.largest() == "/model/mesh_stiffness/elements", "{fine:?}");
        let swept = demand_of(|value| {
            elements(value);
            value["kind"] = json!("sweep");
            value["axes"] = json!([{"pointer": "/design/face_width_mm", "values": [75.0, 150.0]}]);
        });
        assert!(swept.finite_elements_mib > 4.0 * fine.finite_elements_mib, "twice the width, two at once: {swept:?}");
        let rows = demand_of(|value| {
            value["kind"] = json!("sweep");
            value["axes"] =
                json!([{"pointer": "/operation/pinion_speed_rpm", "from": 100, "to": 9000, "points": 100_000}]);
        });
        assert!(rows.total_mib() > 100.0 && rows.largest() == "/axes", "{rows:?}");
    }
}
