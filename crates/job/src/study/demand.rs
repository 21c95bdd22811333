//! Estimate of the peak memory of a document's calculation, made before it starts.
//!
//! Upper estimates from the sizes that grow with the input, without the constant part of every job (a few tens of MiB).
//! `scripts/memory` compares them with the measured peak of runs.

use super::evaluation::Inputs;
use super::mesh;
use crate::document::{Axis, Elements, Fidelity, FlankInput, JobDocument, JobKind, Ltca, MeshForce, MeshStiffness};
use herringbone_physics::contact::{ComplianceModel, ContactSizes};

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
    /// Compliance of the teeth in mesh, and the positions of the loaded contact analysis; of several pairs at once in a
    /// sweep over the contact.
    pub contact_mib: f64,
    /// Rows of a sweep.
    pub rows_mib: f64,
}

impl Demand {
    pub fn total_mib(&self) -> f64 {
        self.series_mib + self.finite_elements_mib + self.contact_mib + self.rows_mib
    }

    /// JSON pointer of the field of the document that causes the largest part.
    pub fn largest(&self) -> &'static str {
        let parts = [
            (self.series_mib, "/analysis/samples_per_mesh_period"),
            (self.finite_elements_mib, "/model/mesh_stiffness/elements"),
            (self.contact_mib, "/design/face_width_mm"),
            (self.rows_mib, "/axes"),
        ];
        parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or("", |(_, pointer)| pointer)
    }
}

/// Peak memory of a checked document solved on `threads` threads.
pub fn demand(document: &JobDocument, threads: usize) -> Demand {
    let series_mib = match document.kind {
        JobKind::Response => {
            let channels = super::vibration::channels(document, None).map_or(0, |channels| channels.len())
                + super::rotor::channel_names(document).len();
            let analysis = &document.analysis;
            let samples = f64::from(analysis.record_mesh_periods) * f64::from(analysis.samples_per_mesh_period);
            (PER_CHANNEL * channels as f64 + SPECTRUM_CHANNELS) * samples * SAMPLE_BYTES / MIB
        }
        JobKind::Mesh | JobKind::Sweep | JobKind::Optimise | JobKind::Tolerance => 0.0,
    };
    let over_design = varied(document).any(|(pointer, _)| pointer.starts_with("/design"));
    let gears_at_once = if over_design { threads.min(rows(document)).max(1) } else { 1 };
    let row_bytes = if document.record.is_empty() { ROW_BYTES } else { RECORDED_ROW_BYTES };
    Demand {
        series_mib,
        finite_elements_mib: gears_at_once as f64 * finite_elements_mib(document),
        contact_mib: contact_mib(document, threads),
        rows_mib: rows(document) as f64 * row_bytes / MIB,
    }
}

/// Rows of a document with rows, else the sweep's number of points.
fn rows(document: &JobDocument) -> usize {
    match document.kind {
        JobKind::Optimise | JobKind::Tolerance => usize::try_from(document.evaluations()).unwrap_or(usize::MAX),
        JobKind::Mesh | JobKind::Response | JobKind::Sweep => document.sweep_points(),
    }
}

/// Every input that varies over the rows, with its extreme values: those of axes and variables. Deviations are small.
fn varied(document: &JobDocument) -> impl Iterator<Item = (&str, Vec<f64>)> {
    let of_axis = |axis: &Axis| axis.values();
    let axes = document.axes.iter().flat_map(move |axis| axis.pointers().map(move |pointer| (pointer, of_axis(axis))));
    let variables = document.variables.iter().flat_map(|variable| {
        let ends = [variable.from, variable.to];
        Inputs::of_variable(variable)
            .pointers()
            .map(move |(pointer, factor)| (pointer, ends.map(|end| factor * end).to_vec()))
            .collect::<Vec<_>>()
    });
    let tolerances = document.tolerances.iter().flat_map(|tolerance| {
        Inputs::of_tolerance(tolerance).pointers().map(|(pointer, _)| (pointer, Vec::new())).collect::<Vec<_>>()
    });
    axes.chain(variables).chain(tolerances)
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

/// Values of a field of the design or of the contact analysis over the rows, on top of its own.
fn values<'a>(document: &'a JobDocument, name: &'a str) -> impl Iterator<Item = f64> + 'a {
    let is_field = move |pointer: &str| pointer.rsplit('/').next() == Some(name);
    varied(document).filter(move |(pointer, _)| is_field(pointer)).flat_map(|(_, values)| values)
}

/// Face width of the widest point, mm.
fn widest(document: &JobDocument) -> f64 {
    let design = &document.design;
    let own = [design.pinion.face_width_mm, design.gear.face_width_mm].into_iter().flatten();
    values(document, "face_width_mm").chain(own).fold(design.face_width_mm, f64::max)
}

/// Compliances and contacts that a sweep keeps.
const KEPT: (f64, f64) = (super::compliance::KEPT as f64, mesh::KEPT as f64);

/// Memory of the loaded contact analyses.
///
/// Per compliance T = 8 (K + 1) (4 S)² bytes, S stations along the face and K + 1 pairs of teeth in mesh, three times
/// while it is made; per position two matrices over the stations of all lines; per mesh period the points of its
/// positions ([`ContactSizes`]).
fn contact_mib(document: &JobDocument, threads: usize) -> f64 {
    let MeshStiffness::Ltca(ltca) = &document.model.mesh_stiffness else { return 0.0 };
    let memory = contact_sizes(document, ltca).memory();
    let tabulates = document.model.mesh_force == MeshForce::Contact && document.kind != JobKind::Mesh;
    // A force table is solved on all threads. A thread that waits for the others takes up another point of a sweep.
    let solvers = if tabulates { threads.max(1) as f64 } else { 1.0 };
    let states = memory.states + memory.path;
    let swept = varied(document).any(|(pointer, _)| depends_on(pointer));
    let bytes = if swept {
        let points = rows(document) as f64;
        let at_once = (2.0 * threads as f64).min(points).max(1.0);
        at_once * (memory.compliance_peak + memory.position + states)
            + KEPT.0.min(points) * memory.compliance
            + KEPT.1.min(points) * memory.path
    } else {
        memory.compliance_peak.max(memory.compliance + solvers * memory.position + states)
    };
    bytes / MIB
}

/// True for the fields on which the loaded contact depends.
fn depends_on(pointer: &str) -> bool {
    ["/design", "/operation/pinion_torque_nm", "/model/mesh_stiffness"].iter().any(|part| pointer.starts_with(part))
}

/// Sizes of the loaded contact analysis, the largest over the points of a sweep.
fn contact_sizes(document: &JobDocument, ltca: &Ltca) -> ContactSizes {
    let design = &document.design;
    let gears = [&design.pinion, &design.gear];
    let least = |name, own: f64| values(document, name).fold(own, f64::min);
    let most = |name, own: f64| values(document, name).fold(own, f64::max);
    let count = |name, own: Option<u32>| {
        values(document, name).map(|value| value as usize).chain(own.map(|own| own as usize)).max()
    };
    let magnitude = |name, own: [f64; 2]| values(document, name).chain(own).fold(0.0f64, |most, v| most.max(v.abs()));
    let normal_module_mm = least("normal_module_mm", design.normal_module_mm);
    let helix_angle_rad = most("helix_angle_deg", design.helix_angle_deg).to_radians();
    // The path of contact of a rack's addendum, on a tooth as high as the rack and its shifts let it be.
    let addendum = magnitude("addendum", gears.map(|gear| gear.addendum));
    let shift = magnitude("profile_shift", gears.map(|gear| gear.profile_shift));
    let alteration = magnitude("tip_alteration", gears.map(|gear| gear.tip_alteration));
    let dedendum = magnitude("dedendum", gears.map(|gear| gear.dedendum));
    let pressure_angle_rad = least("pressure_angle_deg", design.pressure_angle_deg).to_radians();
    // The normal pressure angle is never larger than the transverse one.
    let normal_rad = (pressure_angle_rad.tan() * helix_angle_rad.cos()).atan();
    let height = addendum + shift + alteration;
    let transverse_contact_ratio = 2.0 * height / (std::f64::consts::PI * normal_rad.sin() * normal_rad.cos());
    ContactSizes {
        face_modules: widest(document) / normal_module_mm,
        helix_angle_rad,
        transverse_contact_ratio,
        gaps_per_deflection: gaps_per_deflection(document),
        slices: count("slices", ltca.slices),
        positions: count("positions", ltca.positions),
        corner_contact: ltca.corner_contact,
        tooth_height_modules: addendum + dedendum + alteration,
        compliance: match ltca.fidelity {
            Fidelity::Analytic => ComplianceModel::Analytic,
            Fidelity::Fe => ComplianceModel::FiniteElements(mesh::resolution(ltca.elements)),
            Fidelity::Uniform => ComplianceModel::Uniform,
        },
    }
}

/// Stiffness of a pair of teeth per face width and Young's modulus (ISO 6336-1: 14 N/(mm um) for steel).
const PAIR_STIFFNESS: f64 = 14e9 / 206e9;

/// Gaps that the load may have to close (modifications, assembly errors) over the deflection of a pair of teeth under
/// it; unbounded in a sweep over what either depends on.
fn gaps_per_deflection(document: &JobDocument) -> f64 {
    if varied(document).any(|(pointer, _)| depends_on(pointer)) {
        return f64::INFINITY;
    }
    let design = &document.design;
    let of_flank = |flank: &FlankInput| {
        flank.tip_relief.amount_um
            + flank.lead_crowning_um.abs()
            + flank.helix_slope_um.abs()
            + flank.end_relief.amount_um
    };
    let of_gear = |gear: &crate::document::GearInput| {
        let coast = gear.coast.iter().flat_map(|coast| [Some(&coast.flank), coast.left.as_ref(), coast.right.as_ref()]);
        let flanks = [Some(&gear.flank), gear.left.as_ref(), gear.right.as_ref()].into_iter().chain(coast).flatten();
        flanks.map(of_flank).fold(0.0, f64::max)
    };
    let assembly = &design.assembly;
    let errors_um = assembly.in_plane_misalignment_um.abs()
        + assembly.out_of_plane_misalignment_um.abs()
        + assembly.apex_offset_um.abs();
    let gaps_m = 1e-6 * (of_gear(&design.pinion) + of_gear(&design.gear) + errors_um);
    if gaps_m == 0.0 {
        return 0.0;
    }
    let members = [&design.pinion, &design.gear].map(|gear| gear.material.as_ref().unwrap_or(&design.material));
    let stiffest_pa = members.iter().fold(0.0f64, |most, material| most.max(1e9 * material.youngs_modulus_gpa));
    // At the reference circle; at the base circle, which is smaller, the force is larger.
    let radius_m =
        5e-4 * design.normal_module_mm * f64::from(design.pinion.teeth) / design.helix_angle_deg.to_radians().cos();
    let force_n = 0.5 * document.operation.pinion_torque_nm.abs() / radius_m;
    let deflection_m = force_n / (PAIR_STIFFNESS * stiffest_pa * 1e-3 * widest(document));
    gaps_m / deflection_m
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

    #[test]
    fn contact_over_many_pitches_says_that_the_face_asks() {
        let wide = |face_width_mm: f64| {
            move |value: &mut Value| {
                value["kind"] = json!("mesh");
                value["model"] = json!({"mesh_stiffness": {"source": "ltca"}});
                value["design"]["normal_module_mm"] = json!(0.1);
                value["design"]["helix_angle_deg"] = json!(45.0);
                value["design"]["face_width_mm"] = json!(face_width_mm);
            }
        };
        // The peak of this one was measured: 1125 MB.
        let found = demand_of(wide(500.0));
        assert!(found.total_mib() > 1073.0 && found.largest() == "/design/face_width_mm", "{found:?}");
        assert!(demand_of(wide(2000.0)).total_mib() > 4.0 * found.total_mib());
        let sweep = |pointer: &'static str| {
            demand_of(move |value| {
                wide(50.0)(value);
                value["kind"] = json!("sweep");
                value["axes"] = json!([{"pointer": pointer, "from": 10.0, "to": 500.0, "points": 20}]);
            })
        };
        // The widest point counts, several at once; the speed does not change the contact.
        assert!(sweep("/design/face_width_mm").contact_mib > 2.0 * found.contact_mib);
        assert!(sweep("/operation/pinion_speed_rpm").contact_mib < 0.5 * found.contact_mib);
        let given = demand_of(|value| {
            wide(500.0)(value);
            value["model"] = json!({"mesh_stiffness": {"source": "given", "mean_n_per_um": 900.0}});
        });
        assert_eq!(given.contact_mib, 0.0);
    }
}
