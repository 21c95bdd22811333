//! The calculations that users wait for, each solved once from its document. `scripts/instructions` counts their
//! instructions, one test at a time.

use herringbone_job::parse_value;
use herringbone_job::result::{ContactStateResult, SweepPoint};
use herringbone_job::study::{self, CheckedJob, Outcome, SolveContext};
use serde_json::{Value, json};

const TABLE1: &str = include_str!("../../../examples/table1.json");
const CONTACT: &str = include_str!("../../../examples/contact.json");
const GIVEN: &str = include_str!("../../../examples/given_stiffness.json");
const SHAFTS: &str = include_str!("../../../examples/shafts.json");

/// An example with changes, without series.
fn job(text: &str, change: impl FnOnce(&mut Value)) -> CheckedJob {
    let mut value: Value = serde_json::from_str(text).expect("JSON");
    value["analysis"]["channels"] = json!([]);
    change(&mut value);
    parse_value(&value).and_then(CheckedJob::new).expect("a pair that can run")
}

fn solved(job: &CheckedJob) -> Outcome {
    study::solve(job, &SolveContext::none()).expect("solved")
}

fn over_speed(value: &mut Value, speeds_rpm: [f64; 2], points: usize) {
    value["kind"] = json!("sweep");
    let [from, to] = speeds_rpm;
    value["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": from, "to": to, "points": points}]);
}

/// The rows of a sweep, none of which failed.
fn rows(job: &CheckedJob) -> Vec<SweepPoint> {
    let rows = solved(job).result.sweep.expect("a sweep").points;
    assert!(rows.iter().all(|row| row.error.is_none() && row.regime.is_some()));
    rows
}

/// Reference case A (contact kept) or C (contact lost and closed) of tests/data/dynamics_reference.json as a sweep: the
/// pair and its supports are those of examples/given_stiffness.json.
fn reference_case(value: &mut Value, keeps_contact: bool, points: usize) {
    let (torque_nm, backlash_um, damping, amplitude) =
        if keeps_contact { (800.0, 2.0, 0.1, 0.12) } else { (80.0, 40.0, 0.03, 0.24) };
    value["operation"]["pinion_torque_nm"] = json!(torque_nm);
    value["design"]["backlash_um"] = json!(backlash_um);
    value["model"]["mesh_damping_ratio"] = json!(damping);
    let harmonics = [(1.0, 0.3), (0.05 / 0.12, 1.1), (0.25, 2.0), (0.125, 0.7)];
    let harmonics = harmonics.map(|(a, phase_rad)| json!({"amplitude": a * amplitude, "phase_rad": phase_rad}));
    value["model"]["mesh_stiffness"]["harmonics"] = json!(harmonics);
    value["analysis"] = json!({"accuracy": 1e-6, "channels": []});
    if !keeps_contact {
        let integrated = json!({"method": "integrate", "mesh_periods": 60, "record_mesh_periods": 30});
        value["analysis"]
            .as_object_mut()
            .expect("an object")
            .extend(integrated.as_object().expect("an object").clone());
    }
    over_speed(value, [500.0, 6000.0], points);
}

/// Geometry, feasibility and warnings, 20 times.
#[test]
fn check() {
    let document = job(TABLE1, |_| {}).into_document();
    for _ in 0..20 {
        let report = CheckedJob::new(document.clone()).expect("feasible").report();
        assert!(report.geometry.total_contact_ratio > 1.0);
    }
}

#[test]
fn mesh() {
    let outcome = solved(&job(TABLE1, |value| value["kind"] = json!("mesh")));
    assert!(outcome.result.mesh.expect("a mesh").stiffness_mean_n_per_um > 0.0);
}

#[test]
fn mesh_on_shafts() {
    let outcome = solved(&job(SHAFTS, |value| {
        value["kind"] = json!("mesh");
        value["model"]["mesh_stiffness"]["positions"] = json!(16);
    }));
    assert!(outcome.result.shafts.is_some());
}

/// Contact, impact and motion with the stiffness of the contact.
#[test]
fn response() {
    let outcome = solved(&job(TABLE1, |value| value["model"]["mesh_force"] = json!("stiffness")));
    assert!(outcome.result.response.expect("a response").rms.mesh_circumferential_acceleration_m_s2.left > 0.0);
}

/// The contact in the equations.
#[test]
fn response_contact() {
    let outcome = solved(&job(CONTACT, |value| value["model"]["mesh_force"] = json!("contact")));
    assert!(outcome.result.mesh.expect("a mesh").contact_force.is_some());
}

/// Five times.
#[test]
fn response_iso6336() {
    let job = job(TABLE1, |value| value["model"]["mesh_stiffness"] = json!({"source": "iso6336"}));
    (0..5).for_each(|_| assert!(solved(&job).result.response.is_some()));
}

#[test]
fn sweep_linear() {
    let rows = rows(&job(GIVEN, |value| reference_case(value, true, 100)));
    assert!(rows.iter().all(|row| row.contact == Some(ContactStateResult::Continuous)));
}

#[test]
fn sweep_separating() {
    let rows = rows(&job(GIVEN, |value| reference_case(value, false, 8)));
    assert!(rows.iter().any(|row| row.contact == Some(ContactStateResult::SingleSided)));
}

#[test]
fn sweep_contact() {
    let rows = rows(&job(CONTACT, |value| {
        value["model"]["mesh_force"] = json!("contact");
        over_speed(value, [500.0, 12_000.0], 20);
    }));
    assert_eq!(rows.len(), 20);
}

/// With staggered halves, whose twelve coordinates are solved together.
#[test]
fn sweep_staggered() {
    let rows = rows(&job(GIVEN, |value| {
        value["design"]["half_stagger"] = json!(0.5);
        reference_case(value, true, 50);
    }));
    assert!(rows.iter().all(|row| row.contact == Some(ContactStateResult::Continuous)));
}
