//! Tests of documents through all stages.

mod members;
mod sides;

use super::unchecked::{check, solve};
use super::*;
use crate::document::JobDocument;
use crate::parse_value;
use crate::result::{
    BranchDifference, BranchDirection, ContactStateResult, RegimeResult, ReusedStage, SpringOrigin, SweepPoint,
    SweepResult,
};
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::{check as check_value, check_worst};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

fn example(name: &str) -> Value {
    let path = format!("{}/../../examples/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_slice(&std::fs::read(path).expect("readable")).expect("JSON")
}

fn document(value: &Value) -> JobDocument {
    parse_value(value).expect("valid")
}

#[test]
fn table1_has_the_contact_ratios_of_its_geometry() {
    let report = check(&document(&example("table1"))).expect("feasible");
    let geometry = &report.geometry;
    let topic = "Job: example documents";
    let ratio = geometry.transverse_contact_ratio;
    check_value(topic, "table1, transverse contact ratio", ratio, 1.4968, Absolute(5e-5));
    check_value(topic, "table1, overlap ratio", geometry.overlap_ratio, 1.6456, Absolute(5e-5));
    check_value(topic, "table1, mesh frequency, Hz", geometry.mesh_frequency_hz, 566.6667, Absolute(1e-3));
    assert_eq!(geometry.pinion.inertia_kg_m2, 0.065);
}

#[test]
fn the_variants_of_table2_reach_their_contact_ratios() {
    for (name, ratio) in [
        ("table2_2_72", 2.72),
        ("table2_2_91", 2.91),
        ("table2_3_30", 3.30),
        ("table2_3_68", 3.68),
        ("table2_4_07", 4.07),
    ] {
        let report = check(&document(&example(name))).expect("feasible");
        let got = report.geometry.total_contact_ratio;
        check_value("Job: example documents", &format!("{name}, total contact ratio"), got, ratio, Absolute(5e-4));
    }
}

/// Reduction of the impact force by the pairs in mesh against the two columns of the source's Table 2 (9.255 and 8.896
/// kN, …): it decreases with the contact ratio. The bound is the difference reached, 2 percentage points.
#[test]
fn the_buffering_of_table2_falls_with_the_contact_ratio() {
    let printed = [
        ("table2_2_72", 9.255, 8.896),
        ("table2_2_91", 8.661, 8.378),
        ("table2_3_30", 6.593, 6.469),
        ("table2_3_68", 5.180, 5.121),
        ("table2_4_07", 2.107, 2.096),
    ];
    let reductions = printed.map(|(name, unbuffered, buffered)| {
        let mut value = example(name);
        value["kind"] = json!("mesh");
        let impact = solved(&value).result.impact.expect("an impact");
        let expected = 100.0 * (1.0 - buffered / unbuffered);
        let got = impact.reduction_percent.expect("a calculated impact");
        check_value("Job: impact reduced by the pairs in mesh", &format!("{name}, %"), got, expected, Absolute(2.0));
        got
    });
    assert!(reductions.windows(2).all(|two| two[0] > two[1]), "{reductions:?}");
}

#[test]
fn an_impossible_gear_is_refused_with_its_field() {
    let mut value = example("table1");
    value["design"]["pinion"]["profile_shift"] = json!(1.9);
    let Err(DocumentError::Invalid(violations)) = check(&document(&value)) else { panic!("refused") };
    assert!(violations.iter().all(|v| v.pointer.starts_with("/design/")), "{violations:?}");
    assert!(violations.iter().any(|v| v.code == "pointed-tip"), "{violations:?}");
}

fn contact_key(document: &JobDocument) -> String {
    let prepared = prepare::prepare(document).expect("feasible");
    let crate::document::MeshStiffness::Ltca(ltca) = &document.model.mesh_stiffness else { panic!("no contact") };
    hash::mesh_hash(&mesh::ContactCase::new(document, ltca, &prepared))
}

#[test]
fn a_hash_depends_on_what_decides_and_on_nothing_else() {
    let base = document(&example("table1"));
    let mut renamed = base.clone();
    renamed.name = Some("another name".into());
    assert_eq!(input_hash(&base), input_hash(&renamed));
    let mut faster = base.clone();
    faster.operation.pinion_speed_rpm += 1.0;
    assert_ne!(input_hash(&base), input_hash(&faster));
    assert_eq!(contact_key(&base), contact_key(&faster));
    let mut loaded = base.clone();
    loaded.operation.pinion_torque_nm += 1.0;
    assert_ne!(contact_key(&base), contact_key(&loaded));
    // The gap between the halves enters through an axis that is out of the plane of action.
    let mut wider = base.clone();
    wider.design.gap_width_mm += 10.0;
    assert_ne!(contact_key(&base), contact_key(&wider));
}

fn solved(value: &Value) -> Outcome {
    let context = SolveContext::none();
    solve(&document(value), &context).expect("solved")
}

/// Table 1 without excitation.
fn still() -> Value {
    let mut value = example("table1");
    value["model"]["impact"] = json!({"source": "none"});
    value["model"]["mesh_stiffness"] = json!({"source": "given", "mean_n_per_um": 900.0, "harmonics": []});
    value["design"]["backlash_um"] = json!(0.0);
    value
}

#[test]
fn constant_stiffness_without_backlash_gives_the_static_deflection() {
    let result = solved(&still()).result;
    let response = result.response.expect("a response");
    // F_n = T/2 / (r_b1 cos β_b), s = F_n / k.
    let geometry = result.geometry.expect("geometry");
    let radius_m = geometry.pinion.base_diameter_mm * 0.5e-3;
    let normal_n = 400.0 / radius_m / geometry.base_helix_angle_deg.to_radians().cos();
    let expected_um = normal_n / 900.0;
    let quantity = "static deflection of table1 at 900 N/µm, µm";
    check_value("Job: balances", quantity, response.min_displacement_um, expected_um, Relative(1e-9));
    assert!(response.rms.mesh_circumferential_acceleration_m_s2.left < 1e-6);
}

#[test]
fn both_planes_have_the_same_torsional_stiffness() {
    let frequency = |plane: &str| {
        let mut value = example("table1");
        value["kind"] = json!("response");
        value["model"]["plane"] = json!(plane);
        value["model"]["mesh_stiffness"] = json!({"source": "iso6336"});
        // With rigid supports only torsion is free.
        for (name, stiffness) in value["design"]["supports"].as_object_mut().expect("supports") {
            if name != "damping_ratio" {
                *stiffness = json!(1e7);
            }
        }
        let frequencies = solved(&value).result.response.expect("a response").natural_frequencies_hz;
        // The mesh on the inertias: the lowest above the free motions.
        frequencies.into_iter().find(|hz| *hz > 1.0).expect("a mode")
    };
    let (base, pitch) = (frequency("base"), frequency("pitch"));
    check_value(
        "Job: balances",
        "torsional frequency, pitch plane against base plane, Hz",
        pitch,
        base,
        Relative(2e-3),
    );
}

#[test]
fn a_sweep_over_speed_equals_its_points_and_shares_the_contact() {
    let mut value = example("table1");
    value["kind"] = json!("sweep");
    value["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1500.0, 2000.0]}]);
    let sweep = solved(&value).result.sweep.expect("a sweep");
    assert_eq!(sweep.points.len(), 2);
    let single = solved(&example("table1")).result.response.expect("a response");
    let row = &sweep.points[1];
    assert_eq!(row.values, [2000.0]);
    assert_eq!(row.mesh_circumferential_acceleration_rms_m_s2, Some(single.rms.mesh_circumferential_acceleration_m_s2));
}

/// Points of a sweep integrated side by side in lanes have the same rows, bit by bit, as points solved one by one.
#[test]
fn integrated_points_of_a_sweep_are_the_points_alone() {
    let mut value = example("given_stiffness");
    value["analysis"]["method"] = json!("integrate");
    value["analysis"]["mesh_periods"] = json!(40);
    value["analysis"]["record_mesh_periods"] = json!(20);
    let mut sweep = value.clone();
    sweep["kind"] = json!("sweep");
    sweep["axes"] = json!([
        {"pointer": "/operation/pinion_speed_rpm", "from": 1500.0, "to": 4000.0, "points": 6},
        {"pointer": "/operation/pinion_torque_nm", "values": [60.0, 800.0]},
    ]);
    let points = solved(&sweep).result.sweep.expect("a sweep").points;
    assert_eq!(points.len(), 12);
    for row in points {
        value["operation"]["pinion_speed_rpm"] = json!(row.values[0]);
        value["operation"]["pinion_torque_nm"] = json!(row.values[1]);
        let alone = solved(&value).result.response.expect("a response");
        let rms = row.mesh_circumferential_acceleration_rms_m_s2.expect("a response");
        assert_eq!(rms.left.to_bits(), alone.rms.mesh_circumferential_acceleration_m_s2.left.to_bits());
        assert_eq!(row.min_displacement_um, Some(alone.min_displacement_um));
        assert_eq!((row.regime, row.contact), (Some(alone.regime), Some(alone.contact)));
    }
}

#[test]
fn a_sweep_that_leaves_the_range_is_refused_and_one_that_meets_an_impossible_gear_says_so() {
    let mut value = example("table1");
    value["kind"] = json!("sweep");
    value["axes"] = json!([{"pointer": "/design/helix_angle_deg", "from": 10.0, "to": 80.0, "points": 3}]);
    let Err(DocumentError::Invalid(violations)) = check(&document(&value)) else { panic!("refused") };
    assert_eq!(violations[0].pointer, "/axes/0");
    value["axes"] = json!([{"pointer": "/design/pinion/addendum", "values": [1.0, 2.4]}]);
    let points = solved(&value).result.sweep.expect("a sweep").points;
    assert!(points[0].error.is_none());
    assert!(points[1].error.as_ref().is_some_and(|reason| reason.contains("/design/pinion/addendum")));
}

#[test]
fn a_canceled_job_stops() {
    let context = SolveContext { canceled: &|| true, ..SolveContext::none() };
    let outcome = solve(&document(&example("table1")), &context);
    assert!(matches!(outcome, Err(SolveError::Canceled(_))));
}

#[derive(Default)]
struct Memory(Mutex<HashMap<String, Vec<u8>>>);
impl StageStore for Memory {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        self.0.lock().expect("unpoisoned").get(key).cloned()
    }
    fn save(&self, key: &str, _stage: Stage, bytes: &[u8]) {
        self.0.lock().expect("unpoisoned").insert(key.to_owned(), bytes.to_vec());
    }
}

#[test]
fn the_contact_analysis_is_kept_and_taken_again() {
    let memory = Memory::default();
    let context = SolveContext { stages: &memory, ..SolveContext::none() };
    let first = solve(&document(&example("table1")), &context).expect("solved").result;
    let mut faster = example("table1");
    faster["operation"]["pinion_speed_rpm"] = json!(2500.0);
    let second = solve(&document(&faster), &context).expect("solved").result;
    assert_eq!((first.numerics.reused.len(), second.numerics.reused), (0, vec![ReusedStage::Mesh]));
    assert_eq!(first.mesh, second.mesh);
}

#[test]
fn finite_elements_are_solved_once_per_gear() {
    let memory = Memory::default();
    let context = SolveContext { stages: &memory, ..SolveContext::none() };
    let mut value = example("table1");
    value["kind"] = json!("mesh");
    value["design"]["face_width_mm"] = json!(30.0);
    value["model"]["mesh_stiffness"] = json!({"source": "ltca", "fidelity": "fe", "elements": "coarse"});
    let mut solve_at = |torque_nm: f64| {
        value["operation"]["pinion_torque_nm"] = json!(torque_nm);
        solve(&document(&value), &context).expect("solved").result
    };
    let (first, second) = (solve_at(800.0), solve_at(400.0));
    assert_eq!((first.numerics.reused.len(), &second.numerics.reused), (0, &vec![ReusedStage::FiniteElements]));
    value["model"]["mesh_stiffness"] = json!({"source": "ltca"});
    let analytic = solve(&document(&value), &context).expect("solved").result;
    let mean = |result: &JobResult| result.mesh.as_ref().map_or(0.0, |m| m.stiffness_mean_n_per_um);
    let ratio = mean(&analytic) / mean(&second);
    check_value("Job: fidelities", "narrow source pair, mean stiffness, analytic over fe", ratio, 1.0, Absolute(0.05));
}

#[test]
fn staggering_the_halves_shifts_the_right_one_by_its_part_of_the_period() {
    let mut value = example("table1");
    value["design"]["half_stagger"] = json!(0.5);
    let result = solved(&value).result;
    let mesh = result.mesh.expect("a mesh");
    let right = mesh.right_curve.expect("the halves differ in phase");
    let n = mesh.curve.stiffness_n_per_um.len();
    let errors = (0..n).map(|i| {
        let left = mesh.curve.stiffness_n_per_um[(i + n / 2) % n];
        right.stiffness_n_per_um[i] / left - 1.0
    });
    check_worst("Job: balances", "stiffness of a half staggered by half a period", errors, 1e-6);
    let rms = result.response.expect("a response").rms.mesh_circumferential_acceleration_m_s2;
    check_worst(
        "Job: balances",
        "RMS of x'' of staggered halves, one over the other",
        [rms.left / rms.right - 1.0],
        1e-5,
    );
}

#[test]
fn reference_case_c_repeats_every_second_period() {
    let result = solved(&example("given_stiffness")).result;
    let response = result.response.expect("a response");
    assert_eq!(response.regime, RegimeResult::Period(2));
    assert_eq!(response.contact, ContactStateResult::SingleSided);
    // Event-exact reference: 95.76514756474366 m/s² over mesh periods 200 to 300.
    let rms = response.rms.mesh_circumferential_acceleration_m_s2.left;
    let topic = "Job: example documents";
    check_value(topic, "given_stiffness, RMS of x_left'', m/s²", rms, 95.765_147_564_743_66, Relative(1e-6));
}

#[test]
fn a_response_says_how_it_repeats_and_how_well_it_is_balanced() {
    let mut value = example("given_stiffness");
    value["analysis"] = json!({"method": "periodic"});
    let response = solved(&value).result.response.expect("a response");
    assert_eq!((response.regime, response.period_mesh_periods), (RegimeResult::Period(2), Some(2)));
    let multipliers = response.floquet_multipliers.expect("found by the periodic method");
    // Ten coordinates without the free rotations, displacements and velocities, less the free screw motion's two.
    assert_eq!(multipliers.len(), 18);
    assert!(multipliers.windows(2).all(|two| two[0].modulus >= two[1].modulus) && multipliers[0].modulus < 1.0);
    let per_mesh_period = response.floquet_modulus_per_mesh_period.expect("likewise");
    assert!((multipliers[0].modulus.sqrt() / per_mesh_period - 1.0).abs() < 1e-12);
    assert_eq!((response.lyapunov_per_mesh_period, response.confidence_interval_95), (None, None));
    let share = response.contact_share;
    assert!(
        share.left == share.right && (0.5..1.0).contains(&share.left) && share.left == response.fraction_in_contact
    );
    let frequencies: Vec<f64> = response.natural_modes.iter().map(|mode| mode.frequency_hz).collect();
    assert_eq!(frequencies, response.natural_frequencies_hz);
    assert!(response.natural_modes.iter().any(|mode| mode.name == "mesh mode, meshes in phase"));
    check_worst("Job: balances", "energy of given_stiffness over its period", response.energy_balance_residual, 1e-8);
}

#[test]
fn a_chaotic_response_has_an_interval_and_no_multipliers() {
    let mut value = example("given_stiffness");
    value["operation"]["pinion_torque_nm"] = json!(40.0);
    value["analysis"] = json!({});
    let response = solved(&value).result.response.expect("a response");
    assert_eq!((response.regime, response.period_mesh_periods), (RegimeResult::Chaotic, None));
    assert!(response.floquet_multipliers.is_none() && response.floquet_modulus_per_mesh_period.is_none());
    assert!(response.lyapunov_per_mesh_period.is_some_and(|exponent| exponent > 0.2));
    let interval = response.confidence_interval_95.expect("a long record").mesh_circumferential_acceleration_m_s2.left;
    let rms = response.rms.mesh_circumferential_acceleration_m_s2.left;
    assert!(interval.low < rms && rms < interval.high && interval.high / interval.low < 1.04, "{rms} {interval:?}");
    // Balanced step by step, although no trajectory of chaos is followed for long.
    assert!(response.energy_balance_residual.is_some_and(|residual| residual < 1e-8));
}

/// A motion that repeatedly returns close to an earlier state exhausts the limit of Newton's method: it is then
/// classified as a motion that does not repeat, not as an error.
#[test]
fn a_motion_that_is_too_dear_to_close_is_told_as_one_that_does_not_repeat() {
    let mut value = example("table1");
    value["design"]["face_width_mm"] = json!(90.0);
    value["operation"]["pinion_torque_nm"] = json!(11.878);
    value["model"]["impact"]["base_pitch_error_um"] = json!(8.0);
    let response = solved(&value).result.response.expect("a response");
    assert_eq!(response.contact, ContactStateResult::DoubleSided);
    println!("exponent {:?}", response.lyapunov_per_mesh_period);
    assert!(matches!(response.regime, RegimeResult::QuasiPeriodic | RegimeResult::Chaotic), "{:?}", response.regime);
}

/// Event-exact references over the first twenty mesh periods from the static deflection, through the document: the mean
/// of an acceleration over a transient counts.
#[test]
fn the_first_twenty_periods_of_the_reference_cases() {
    for (torque_nm, backlash_um, damping, amplitude, expected) in [
        (800.0, 2.0, 0.1, 0.12, 88.210_182_452_240_15),
        (40.0, 40.0, 0.03, 0.24, 113.431_531_238_139_42),
        (80.0, 40.0, 0.03, 0.24, 118.844_515_553_357_06),
    ] {
        let mut value = example("given_stiffness");
        value["design"]["backlash_um"] = json!(backlash_um);
        value["operation"]["pinion_torque_nm"] = json!(torque_nm);
        value["model"]["mesh_damping_ratio"] = json!(damping);
        let parts = [(1.0, 0.3), (0.05 / 0.12, 1.1), (0.25, 2.0), (0.125, 0.7)];
        value["model"]["mesh_stiffness"]["harmonics"] =
            parts.iter().map(|(a, phase)| json!({"amplitude": a * amplitude, "phase_rad": phase})).collect();
        value["analysis"] =
            json!({"method": "integrate", "accuracy": 1e-10, "mesh_periods": 20, "record_mesh_periods": 20});
        let response = solved(&value).result.response.expect("a response");
        let rms = response.rms.mesh_circumferential_acceleration_m_s2.left;
        check_value(
            "Job: reference cases from rest",
            &format!("RMS over 20 mesh periods at {torque_nm} N m, m/s²"),
            rms,
            expected,
            Relative(2e-8),
        );
    }
}

/// Primary resonance with loss of contact (backlash 40 µm, mesh damping ratio 0.03): two motions at the same speed,
/// found by coming from below and from above, each branch with its jump.
#[test]
fn continuation_finds_both_branches_of_the_resonance_and_their_jumps() {
    let mut value = example("given_stiffness");
    value["kind"] = json!("sweep");
    value["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 8500, "to": 9600, "points": 12}]);
    value["analysis"] = json!({"accuracy": 1e-5});
    value["operation"]["pinion_torque_nm"] = json!(200.0);
    value["model"]["impact"] = json!({"source": "none"});
    value["continuation"] = json!("both");
    let sweep = solved(&value).result.sweep.expect("a sweep");
    let (up, down) = sweep.points.split_at(12);
    assert!(up.iter().all(|row| row.branch == Some(BranchDirection::Up)));
    assert!(down.iter().all(|row| row.branch == Some(BranchDirection::Down)));
    let rms = |row: &SweepPoint| row.mesh_circumferential_acceleration_rms_m_s2.expect("a response").left;
    // Far from the jumps there is one motion; between them, at 9100 r/min, the upper one is more than twice as strong.
    let topic = "Job: continuation";
    for (at, rpm) in [(0, 8500), (3, 8800), (10, 9500), (11, 9600)] {
        let error = rms(&up[at]) / rms(&down[at]) - 1.0;
        check_worst(topic, &format!("both branches at {rpm} r/min, RMS of x_left''"), [error], 1e-5);
    }
    assert_eq!(
        (up[6].values[0], up[6].contact, down[6].contact),
        (9100.0, Some(ContactStateResult::Continuous), Some(ContactStateResult::SingleSided))
    );
    assert!(rms(&down[6]) > 2.0 * rms(&up[6]), "{} and {}", rms(&down[6]), rms(&up[6]));
    assert!(sweep.points.iter().all(|row| row.regime == Some(RegimeResult::Period(1))));
    let hysteresis = sweep.hysteresis.expect("both directions");
    assert_eq!(hysteresis.len(), 1);
    assert_eq!((hysteresis[0].from, hysteresis[0].to), (8900.0, 9300.0));
    assert!(hysteresis[0].differ.contains(&BranchDifference::Rms) && hysteresis[0].largest_rms_ratio > 2.0);
    let jumps: Vec<_> = sweep.jumps.expect("a continuation").into_iter().map(|j| (j.branch, j.from, j.to)).collect();
    assert_eq!(jumps, [(BranchDirection::Up, 9300.0, 9400.0), (BranchDirection::Down, 8900.0, 8800.0)]);
    // The branch from below is the one found by following the motion for long at each speed.
    value["analysis"] =
        json!({"accuracy": 1e-5, "method": "integrate", "mesh_periods": 400, "record_mesh_periods": 50});
    value["continuation"] = json!("up");
    let followed = solved(&value).result.sweep.expect("a sweep");
    let errors = up.iter().zip(&followed.points).map(|(a, b)| rms(a) / rms(b) - 1.0);
    check_worst(topic, "steady motions found from the neighbour's end, against 400 mesh periods each", errors, 1e-4);
    assert_eq!((followed.hysteresis, followed.jumps.map(|jumps| jumps.len())), (None, Some(1)));
}

/// From one motion to two, to chaos and back over the torque, with the amplitudes at quarters of the mesh order.
#[test]
fn rows_carry_what_is_asked_for() {
    let mut value = example("given_stiffness");
    value["kind"] = json!("sweep");
    value["axes"] = json!([{"pointer": "/operation/pinion_torque_nm", "values": [40.0, 80.0, 800.0]}]);
    value["analysis"] = json!({"accuracy": 1e-5});
    let plain = solved(&value).result.sweep.expect("a sweep");
    assert!(plain.points.iter().all(|row| row.poincare.is_none() && row.acceleration_spectrum_m_s2.is_none()));
    assert!(plain.spectrum_mesh_orders.is_none() && plain.campbell.is_empty() && plain.jumps.is_none());
    value["record"] = json!(["poincare", "spectrum"]);
    let sweep = solved(&value).result.sweep.expect("a sweep");
    let orders = sweep.spectrum_mesh_orders.expect("asked for");
    assert_eq!((orders.len(), orders[0], orders[79]), (80, 0.25, 20.0));
    let regimes = [(RegimeResult::Chaotic, 200), (RegimeResult::Period(2), 2), (RegimeResult::Period(1), 1)];
    for (row, (regime, points)) in sweep.points.iter().zip(regimes) {
        let poincare = row.poincare.as_ref().expect("asked for");
        assert_eq!((row.regime, poincare.x_left_m.len()), (Some(regime), points));
        assert_eq!(poincare.v_x_left_m_s.len(), points);
        let bands = row.acceleration_spectrum_m_s2.as_ref().expect("asked for");
        let power: f64 = bands.iter().map(|a| 0.5 * a * a).sum();
        let rms = row.mesh_circumferential_acceleration_rms_m_s2.expect("a response").left;
        let quantity = format!("power of the row's spectrum against its RMS, {}", regime.as_str());
        check_value("Job: sweeps", &quantity, power.sqrt(), rms, Relative(0.01));
        // A motion of one period has whole orders only, one of two the halves too.
        let besides = |per_order: f64| {
            let between = orders.iter().zip(bands).filter(|(order, _)| (*order * per_order).fract() != 0.0);
            between.map(|(_, a)| 0.5 * a * a).sum::<f64>().sqrt() / rms
        };
        let least = match regime {
            RegimeResult::Period(1) => besides(1.0) < 1e-9,
            RegimeResult::Period(2) => besides(2.0) < 1e-9 && besides(1.0) > 0.1,
            _ => besides(2.0) > 0.1,
        };
        assert!(least, "{regime:?}: {} {}", besides(1.0), besides(2.0));
    }
    let plainly = |mut row: SweepPoint| {
        (row.poincare, row.acceleration_spectrum_m_s2) = (None, None);
        row
    };
    assert!(sweep.points.into_iter().map(plainly).eq(plain.points), "recording changes nothing else");
}

#[test]
fn a_speed_sweep_has_its_campbell_diagram() {
    let mut value = example("given_stiffness");
    value["kind"] = json!("sweep");
    value["analysis"] = json!({"accuracy": 1e-3});
    value["axes"] = json!([
        {"pointer": "/design/supports/gear_axial_n_per_um", "values": [200.0, 300.0]},
        {"pointer": "/operation/pinion_speed_rpm", "from": 2000, "to": 12000, "points": 2},
    ]);
    let campbell = solved(&value).result.sweep.expect("a sweep").campbell;
    assert_eq!(campbell.iter().map(|c| c.other_axis_value).collect::<Vec<_>>(), [Some(200.0), Some(300.0)]);
    let diagram = &campbell[0];
    let teeth = value["design"]["pinion"]["teeth"].as_f64().expect("a number");
    assert_eq!(diagram.mesh_frequency_hz, [2000.0 * teeth / 60.0, 12000.0 * teeth / 60.0]);
    // Every meeting of an order with a natural frequency in the range of speeds, and no other.
    let mut expected = 0;
    for (mode, natural) in diagram.natural_modes.iter().enumerate() {
        for order in diagram.mesh_orders.iter().filter(|_| natural.frequency_hz > 0.0) {
            let rpm = natural.frequency_hz / f64::from(*order) / teeth * 60.0;
            if (2000.0..=12000.0).contains(&rpm) {
                expected += 1;
                let same = |c: &&crate::result::CampbellCrossing| (c.mode as usize, c.mesh_order) == (mode, *order);
                let found = diagram.crossings.iter().find(same).expect("a crossing");
                assert!(
                    (found.pinion_speed_rpm / rpm - 1.0).abs() < 1e-12 && found.frequency_hz == natural.frequency_hz
                );
                assert!((0.0..=1.0).contains(&found.mesh_strain_energy));
            }
        }
    }
    assert!(expected == diagram.crossings.len() && expected > 3, "{expected}");
    assert!(diagram.crossings.windows(2).all(|two| two[0].pinion_speed_rpm <= two[1].pinion_speed_rpm));
    // The first order meets the mesh mode near the resonance of the other test.
    let mesh = diagram
        .crossings
        .iter()
        .filter(|c| c.mesh_order == 1)
        .max_by(|a, b| a.mesh_strain_energy.total_cmp(&b.mesh_strain_energy));
    assert!(
        mesh.is_some_and(|c| c.mesh_strain_energy > 0.5 && (8500.0..11000.0).contains(&c.pinion_speed_rpm)),
        "{mesh:?}"
    );
    // Stiffer gear bearings: another diagram.
    assert_ne!(campbell[1].crossings, diagram.crossings);
}

#[test]
fn progress_is_that_of_the_whole_job_and_never_goes_back() {
    use std::sync::Mutex;

    for kind in ["mesh", "response"] {
        let mut value = example("table1");
        value["kind"] = json!(kind);
        let reported = Mutex::new(Vec::new());
        let progress = |_: Stage, fraction: f64| reported.lock().expect("unpoisoned").push(fraction);
        let context = SolveContext { progress: &progress, ..SolveContext::none() };
        solve(&document(&value), &context).expect("solved");
        let reported = reported.into_inner().expect("unpoisoned");
        assert!(reported.windows(2).all(|pair| pair[0] <= pair[1]), "{kind}: {reported:?}");
        assert!(
            reported[0] < 0.05 && reported.iter().all(|fraction| (0.0..=1.0).contains(fraction)),
            "{kind}: {reported:?}"
        );
    }
}

#[test]
fn the_progress_of_finite_elements_follows_their_work() {
    let mut value = example("table1");
    value["model"]["mesh_stiffness"] = json!({"source": "ltca", "fidelity": "fe", "elements": "coarse"});
    let reported = Mutex::new(Vec::new());
    let progress = |stage: Stage, fraction: f64| reported.lock().expect("unpoisoned").push((stage, fraction));
    let context = SolveContext { progress: &progress, ..SolveContext::none() };
    solve(&document(&value), &context).expect("solved");
    let reported = reported.into_inner().expect("unpoisoned");
    // Nearly all of the time is that of the elements.
    let (_, at_impact) = reported.iter().find(|(stage, _)| *stage == Stage::Impact).expect("an impact");
    assert!(*at_impact > 0.9, "{at_impact}");
    let mut furthest = 0.0f64;
    let mut largest_step = 0.0f64;
    for (_, fraction) in &reported {
        largest_step = largest_step.max(fraction - furthest);
        furthest = furthest.max(*fraction);
    }
    assert!(reported.len() > 20 && largest_step < 0.2, "{} reports, the largest step {largest_step}", reported.len());
}

/// Store of points that cancels the calculation after a number of them.
#[derive(Default)]
struct Points {
    kept: Mutex<StoredPoints>,
    saved: AtomicUsize,
}
impl PointStore for Points {
    fn load(&self) -> StoredPoints {
        // As a store would: rows go through JSON.
        let mut kept = self.kept.lock().expect("unpoisoned").clone();
        for row in kept.rows.values_mut() {
            *row = serde_json::from_str(&serde_json::to_string(row).expect("written")).expect("read");
        }
        kept
    }
    fn save(&self, position: usize, row: &SweepPoint, end: Option<&LineEnd>) {
        let mut kept = self.kept.lock().expect("unpoisoned");
        assert!(kept.rows.insert(position, row.clone()).is_none(), "point {position} was solved twice");
        if let Some(end) = end {
            kept.ends.insert(end.line, end.clone());
        }
        self.saved.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn a_sweep_that_was_stopped_goes_on_where_it_was() {
    let axes = json!([
        {"pointer": "/operation/pinion_speed_rpm", "values": [2000.0, 4000.0, 3000.0, 5000.0]},
        {"pointer": "/design/backlash_um", "values": [2.0, 30.0]},
    ]);
    for (continuation, method) in [("none", "auto"), ("none", "integrate"), ("both", "auto")] {
        let mut value = example("table1");
        value["kind"] = json!("sweep");
        value["axes"] = axes.clone();
        value["continuation"] = json!(continuation);
        value["analysis"] = json!({"method": method, "mesh_periods": 40, "record_mesh_periods": 10});
        value["model"]["mesh_stiffness"] =
            json!({"source": "given", "mean_n_per_um": 900.0, "harmonics": [{"amplitude": 0.2}]});
        value["model"]["impact"] = json!({"source": "none"});
        let document = document(&value);
        let whole = solve(&document, &SolveContext::none()).expect("solved").result;
        let points = Points::default();
        let mut runs = 0;
        let pieced = loop {
            let (before, limit) = (points.saved.load(Ordering::Relaxed), 1 + runs % 3);
            let canceled = || points.saved.load(Ordering::Relaxed) >= before + limit;
            runs += 1;
            match solve(&document, &SolveContext { points: &points, canceled: &canceled, ..SolveContext::none() }) {
                Ok(outcome) => break outcome.result,
                Err(SolveError::Canceled(_)) => assert!(runs < 40, "no run gets further"),
                Err(error) => panic!("{error}"),
            }
        };
        assert!(runs > 2, "{continuation}: {runs} run(s)");
        assert_eq!(pieced.numerics.reused, [ReusedStage::Points]);
        let (pieced, whole) = (pieced.sweep.expect("a sweep"), whole.sweep.expect("a sweep"));
        for (pieced, whole) in pieced.points.iter().zip(&whole.points) {
            // The largest force is looked for between the steps, which neighbours in a group may set.
            let difference = pieced.dynamic_factor.unwrap_or(0.0) - whole.dynamic_factor.unwrap_or(0.0);
            assert!(difference.abs() < 1e-9, "{continuation}, {method}: {difference}");
            assert_eq!(&SweepPoint { dynamic_factor: whole.dynamic_factor, ..pieced.clone() }, whole, "{continuation}");
        }
        let rest = |sweep| SweepResult { points: Vec::new(), ..sweep };
        assert!(rest(pieced) == rest(whole), "{continuation}, {method}: the rows are alike, but not the rest");
    }
}

/// The source's pair with a given stiffness of one harmonic and no impact. `supports`: the member of the document.
fn one_harmonic(supports: Value, rpm: f64, stagger: f64) -> Value {
    let mut value = example("table1");
    value["design"]["supports"] = supports;
    value["design"]["half_stagger"] = json!(stagger);
    value["operation"]["pinion_speed_rpm"] = json!(rpm);
    value["model"]["mesh_stiffness"] =
        json!({"source": "given", "mean_n_per_um": 1300.0, "harmonics": [{"amplitude": 0.05}]});
    value["model"]["impact"] = json!({"source": "none"});
    value
}

/// Amplitude at mesh order 1 of the sum of channels with weights.
fn first_order(outcome: &Outcome, weights: &[(&str, f64)]) -> f64 {
    let channel = |name: &str| outcome.series.iter().find(|channel| channel.name == name).expect("a channel");
    let frequency_hz = outcome.result.response.as_ref().expect("a response").mesh_frequency_hz;
    let first = channel(weights[0].0);
    let (mut re, mut im, mut count) = (0.0, 0.0, 0.0);
    for i in 0..first.values.len() {
        let value: f64 = weights.iter().map(|(name, weight)| weight * channel(name).values[i]).sum();
        let angle = std::f64::consts::TAU * frequency_hz * first.dt_s * i as f64;
        re += value * angle.cos();
        im -= value * angle.sin();
        count += 1.0;
    }
    2.0 * f64::hypot(re, im) / count
}

/// Couplings so stiff that the halves of a gear are one rigid body.
fn rigid_body() -> Value {
    let halves = ["pinion", "gear"].map(|gear| {
        [("axial_n_per_um", 1e6), ("lateral_n_per_um", 1e6), ("torsional_nm_per_rad", 1e11)]
            .map(|(of, value)| (format!("{gear}_halves_{of}"), json!(value)))
    });
    Value::Object(halves.into_iter().flatten().collect())
}

/// Staggered by half a pitch the excitations of the halves oppose each other at the first order: on one body the
/// torsional motion loses it and the axial one gains it. In the source's model each half turns by itself, and keeps it.
#[test]
fn stagger_on_one_body_moves_the_first_order_from_torsion_to_the_axis() {
    const RESONANCE_RPM: f64 = 12_100.0;
    let x_mean: &[_] = &[("a_x_left", 0.5), ("a_x_right", 0.5)];
    let axial: &[_] = &[("a_z_p_left", 0.5), ("a_z_p_right", 0.5)];
    let orders = |supports: &Value, rpm: f64, of: &[(&str, f64)]| {
        [0.0, 0.5].map(|stagger| first_order(&solved(&one_harmonic(supports.clone(), rpm, stagger)), of))
    };
    let topic = "Job: one body";
    for (body, supports) in [("derived", json!({})), ("rigid", rigid_body())] {
        for (rpm, bound) in [(1000.0, 0.06), (RESONANCE_RPM, 0.01)] {
            let [aligned, staggered] = orders(&supports, rpm, x_mean);
            let quantity = format!("{body} body, {rpm} r/min: order 1 of the mean x'', stagger 0.5 over 0");
            check_worst(topic, &quantity, [staggered / aligned], bound);
            let [before, after] = orders(&supports, rpm, axial);
            assert!(after > 1000.0 * before, "{body}, {rpm} r/min: axial {before} to {after}");
        }
        let [aligned, staggered] = orders(&supports, 1000.0, &[("a_x_left", 1.0)]);
        let quantity = format!("{body} body, 1000 r/min: order 1 of the left half's own x'', stagger 0.5 over 0");
        check_worst(topic, &quantity, [staggered / aligned], 0.06);
    }
    // Rigid, at resonance: the left half's own motion too.
    let [aligned, staggered] = orders(&rigid_body(), RESONANCE_RPM, &[("a_x_left", 1.0)]);
    check_worst(
        topic,
        "rigid body, resonance: order 1 of the left half's own x'', stagger 0.5 over 0",
        [staggered / aligned],
        0.01,
    );
    // Free halves: the opposite of the result with a common body.
    let free = example("table1")["design"]["supports"].clone();
    for rpm in [1000.0, RESONANCE_RPM] {
        let [aligned, staggered] = orders(&free, rpm, &[("a_x_left", 1.0)]);
        assert!(staggered > 0.5 * aligned, "free halves, {rpm} r/min: {aligned} to {staggered}");
    }
}

/// A document with the ISO stiffness, which is fast to compute.
fn without_supports() -> Value {
    let mut value = example("table1");
    value["design"]["supports"] = Value::Null;
    value["model"]["mesh_stiffness"] = json!({"source": "iso6336"});
    value
}

fn about_supports(result: &JobResult) -> Option<&Warning> {
    result.warnings.iter().find(|warning| warning.code == "assumed-supports")
}

#[test]
fn supports_that_were_not_given_are_said_with_their_values() {
    let value = without_supports();
    let result = solved(&value).result;
    let warning = about_supports(&result).expect("a warning");
    assert_eq!(warning.pointer, "/design/supports");
    for said in
        ["pinion_lateral_n_per_um 600.4", "gear_axial_n_per_um 200.1", "gear_halves_torsional_nm_per_rad 4.081e8"]
    {
        assert!(warning.detail.contains(said), "{said}: {}", warning.detail);
    }
    let used = result.supports.expect("a response");
    assert_eq!(
        (used.gear_axial_n_per_um.origin, used.gear_halves_axial_n_per_um.origin),
        (SpringOrigin::Assumed, SpringOrigin::Derived)
    );
    // The accepted document keeps them as null.
    let accepted = serde_json::to_value(document(&value)).expect("JSON");
    assert!(accepted["design"]["supports"]["gear_halves_axial_n_per_um"].is_null());
    assert_eq!(accepted["design"]["supports"]["damping_ratio"], json!(0.03));
    // With the same values given: the same motion, and no warning.
    let mut given = value.clone();
    given["design"]["supports"] = json!({});
    for (name, spring) in supports::named(&used) {
        given["design"]["supports"][name] = json!(spring.value);
    }
    let again = solved(&given).result;
    assert_eq!(about_supports(&again), None);
    assert_eq!(again.response, result.response);
    assert!(
        supports::named(&again.supports.expect("a response"))
            .iter()
            .all(|(_, spring)| spring.origin == SpringOrigin::Given)
    );
    // With one of them given the warning lists the others.
    let mut some = value.clone();
    some["design"]["supports"] = json!({"gear_axial_n_per_um": 0.0});
    let some = solved(&some).result;
    assert!(about_supports(&some).is_some_and(|warning| !warning.detail.contains("gear_axial_n_per_um")));
    assert_eq!(some.supports.expect("a response").gear_axial_n_per_um.value, 0.0);
    // Without equations of motion nothing is assumed.
    let mut mesh = value;
    mesh["kind"] = json!("mesh");
    let mesh = solved(&mesh).result;
    assert_eq!((about_supports(&mesh), &mesh.supports), (None, &None));
}

#[test]
fn a_sweep_varies_a_support_that_was_not_given() {
    let mut value = without_supports();
    value["kind"] = json!("sweep");
    value["axes"] = json!([{"pointer": "/design/supports/gear_halves_torsional_nm_per_rad", "values": [0.0, 1e9]},
        {"pointer": "/design/gap_width_mm", "values": [10.0, 60.0]}]);
    value["design"]["half_stagger"] = json!(0.3);
    let result = solved(&value).result;
    let warning = about_supports(&result).expect("a warning");
    assert!(
        !warning.detail.contains("gear_halves_torsional") && warning.detail.contains("pinion_halves_torsional"),
        "{}",
        warning.detail
    );
    assert!(warning.detail.contains("each point has its own"));
    let rms = |point: &SweepPoint| point.mesh_circumferential_acceleration_rms_m_s2.expect("a response").left;
    let points = result.sweep.expect("a sweep").points;
    let values: Vec<f64> = points.iter().map(rms).collect();
    assert!(values.windows(2).all(|two| (two[0] / two[1] - 1.0).abs() > 1e-6), "{values:?}");
    let largest = points.iter().filter_map(|point| point.error_estimate).fold(0.0, f64::max);
    assert_eq!(result.accuracy.expect("said").numerical, Some(largest));
}

#[test]
fn a_result_says_both_its_errors() {
    let result = solved(&example("table1")).result;
    let (accuracy, response) = (result.accuracy.expect("said"), result.response.expect("a response"));
    assert_eq!(accuracy.numerical, Some(response.error_estimate));
    assert!(accuracy.model.mesh_stiffness_percent.is_some() && accuracy.model.basis.contains("docs/"));
    let mut mesh = example("table1");
    mesh["kind"] = json!("mesh");
    let result = solved(&mesh).result;
    let (numerical, found) = (result.accuracy.expect("said").numerical, result.mesh.and_then(|mesh| mesh.convergence));
    let found = found.expect("a contact analysis");
    let largest = found.position_error_percent.expect("chosen").max(found.slice_error_percent);
    assert!(largest > 0.0 && numerical == Some(0.01 * largest), "{numerical:?} {found:?}");
    let written = serde_json::to_value(solved(&example("given_stiffness")).result).expect("JSON");
    assert!(
        written["accuracy"]["model"]["mesh_stiffness_percent"].is_null()
            && written["accuracy"]["numerical"].is_number()
    );
    assert!(written["accuracy"]["model"]["basis"].as_str().is_some_and(|basis| basis.contains("given")));
}

/// The model error in a result is at least the difference from finite elements, also on short and steep faces and with
/// few teeth.
#[test]
fn the_model_error_that_is_said_is_not_below_the_error() {
    let pairs = [
        ([25, 40], 0.0, 1.25),
        ([25, 40], 20.0, 1.25),
        ([25, 40], 20.0, 5.0),
        ([17, 44], 30.0, 0.6),
        ([17, 44], 45.0, 1.0),
        ([17, 44], 45.0, 4.0),
        ([10, 10], 30.0, 1.0),
        ([10, 10], 40.0, 1.25),
        ([10, 10], 40.0, 3.0),
    ];
    for (teeth, helix_deg, modules) in pairs {
        let of = |stiffness: Value| {
            let value = json!({
                "kind": "mesh",
                "design": {"normal_module_mm": 2.0, "helix_angle_deg": helix_deg, "face_width_mm": 2.0 * modules,
                    "gap_width_mm": 0.0, "pinion": {"teeth": teeth[0]}, "gear": {"teeth": teeth[1]}},
                // 1.6 N m on 10 teeth per module of face.
                "operation": {"pinion_speed_rpm": 1000.0, "pinion_torque_nm": 0.16 * modules * f64::from(teeth[0])},
                "model": {"mesh_stiffness": stiffness},
            });
            let result = solved(&value).result;
            let mesh = result.mesh.expect("a mesh");
            (
                mesh.stiffness_mean_n_per_um,
                mesh.transmission_error_harmonics_um[0],
                result.accuracy.expect("said").model,
            )
        };
        let (stiffness, harmonic, said) = of(json!({"source": "ltca"}));
        let (fe_stiffness, fe_harmonic, fe_said) =
            of(json!({"source": "ltca", "fidelity": "fe", "elements": "coarse"}));
        let topic = "Job: model error of the analytic compliance, said and found";
        let pair = format!("z {}/{}, helix {helix_deg}°, face {modules} modules", teeth[0], teeth[1]);
        let bound = |analytic: Option<f64>, fe: Option<f64>| 0.01 * (analytic.expect("said") + fe.expect("said"));
        check_worst(
            topic,
            &format!("{pair}: mean stiffness"),
            [stiffness / fe_stiffness - 1.0],
            bound(said.mesh_stiffness_percent, fe_said.mesh_stiffness_percent),
        );
        let said = bound(said.transmission_error_harmonic_percent, fe_said.transmission_error_harmonic_percent);
        check_worst(topic, &format!("{pair}: first harmonic"), [harmonic / fe_harmonic - 1.0], said);
    }
}

fn warned(result: &JobResult, code: &str, pointer: &str) -> bool {
    result.warnings.iter().any(|w| w.code == code && w.pointer == pointer)
}

/// Impacts of the source's model up to several times the load: every force on the tooth counts, on either kind of
/// reaction.
#[test]
fn the_dynamic_factor_counts_the_impact() {
    for (rpm, acts_on) in
        [(2000, "torsion"), (2000, "all"), (9000, "torsion"), (20_000, "torsion"), (20_000, "all"), (30_000, "torsion")]
    {
        let mut value = example("table1");
        value["operation"]["pinion_speed_rpm"] = json!(rpm);
        value["model"]["impact"] = json!({"source": "corner_contact", "acts_on": acts_on});
        let result = solved(&value).result;
        let impact = result.impact.expect("an impact");
        assert_eq!((impact.applied, impact.acts_on.as_str()), (true, acts_on));
        let response = result.response.expect("a response");
        let factor = response.dynamic_factor.expect("a torque");
        let force = response.tooth_force_n.left;
        println!("{rpm} r/min, {acts_on}: impact {:.0} N, factor {factor:.4}, {force:?}", impact.force_n);
        assert!(factor >= 1.0 && force.max >= force.static_n * (1.0 - 1e-9) && force.min <= force.static_n);
        let largest = [response.tooth_force_n.left, response.tooth_force_n.right].map(|f| f.max / f.static_n);
        assert_eq!(factor, largest[0].max(largest[1]).max(1.0));
    }
}

/// A record that ends while the start decays, from rest in the middle of the backlash: not settled, with a warning;
/// long after, it is.
#[test]
fn a_record_that_ends_before_the_motion_is_not_settled() {
    let case = |periods: u32, record: u32, rpm: f64, ratio: f64| {
        let mut value = example("given_stiffness");
        value["operation"]["pinion_torque_nm"] = json!(800.0);
        value["operation"]["pinion_speed_rpm"] = json!(rpm);
        value["model"]["impact"] = json!({"source": "none"});
        value["model"]["mesh_damping_ratio"] = json!(ratio);
        value["analysis"] = json!({
            "method": "integrate", "mesh_periods": periods, "record_mesh_periods": record, "initial_state": vec![0.0; 24]
        });
        solved(&value).result
    };
    for (periods, record, rpm, ratio) in [
        (45, 40, 2000.0, 0.03),
        (30, 20, 2000.0, 0.03),
        (45, 40, 3500.0, 0.03),
        (60, 30, 2000.0, 0.01),
        (80, 60, 5000.0, 0.005),
    ] {
        let result = case(periods, record, rpm, ratio);
        let regime = result.response.as_ref().expect("a response").regime;
        assert_eq!(regime, RegimeResult::NotSettled, "{periods}, {record}, {rpm}, {ratio}");
        assert!(warned(&result, "not-settled", "/analysis/mesh_periods"));
        let long = case(3000, 20, rpm, ratio);
        let regime = long.response.as_ref().expect("a response").regime;
        assert!(matches!(regime, RegimeResult::Period(_)), "{rpm}, {ratio}: {regime:?}");
        assert!(!warned(&long, "not-settled", "/analysis/mesh_periods"));
    }
}

/// Without torque and impact the pair rests, by every method and stiffness, and no accuracy is missed.
#[test]
fn an_unloaded_pair_is_at_rest_without_an_alarm() {
    let samples = json!({"source": "given", "samples_n_per_um": [800.0, 950.0, 1010.0, 900.0]});
    for method in [
        json!({"method": "integrate", "mesh_periods": 300, "record_mesh_periods": 100}),
        json!({}),
        json!({"method": "periodic"}),
    ] {
        for (stiffness, backlash_um) in
            [(None, json!(40.0)), (Some(&samples), json!(0.0)), (Some(&samples), Value::Null)]
        {
            let mut value = example("given_stiffness");
            value["operation"]["pinion_torque_nm"] = json!(0.0);
            value["model"]["impact"] = json!({"source": "none"});
            value["design"]["backlash_um"] = backlash_um;
            value["analysis"] = method.clone();
            if let Some(stiffness) = stiffness {
                value["model"]["mesh_stiffness"] = stiffness.clone();
            }
            let result = solved(&value).result;
            let response = result.response.as_ref().expect("a response");
            let expected = (RegimeResult::Period(1), ContactStateResult::Continuous);
            assert_eq!((response.regime, response.contact), expected, "{method}");
            assert_eq!((response.error_estimate, response.dynamic_factor), (0.0, None));
            assert_eq!(response.rms.mesh_circumferential_acceleration_m_s2, Default::default());
            assert_eq!(response.tooth_force_n, Default::default());
            assert!(!warned(&result, "accuracy-not-reached", "/analysis/accuracy"), "{:?}", result.warnings);
        }
    }
}

/// Parametric instability at a mesh frequency of twice the mesh mode, with low damping and no backlash: the growth is
/// reported, with its rate, by every method and in the row of a sweep.
#[test]
fn parametric_instability_is_told() {
    let mut value = example("given_stiffness");
    value["model"]["impact"] = json!({"source": "none"});
    value["model"]["mesh_damping_ratio"] = json!(0.001);
    value["design"]["supports"]["damping_ratio"] = json!(0.001);
    value["design"]["backlash_um"] = json!(0.0);
    let modes = solved(&value).result.response.expect("a response").natural_modes;
    let mesh = modes.iter().filter(|mode| mode.name == "mesh mode, meshes in phase").map(|mode| mode.frequency_hz);
    let rpm = 2.0 * mesh.fold(0.0, f64::max) / 17.0 * 60.0;
    value["operation"]["pinion_speed_rpm"] = json!(rpm);
    for analysis in [json!({}), json!({"method": "integrate", "mesh_periods": 200, "record_mesh_periods": 50})] {
        value["analysis"] = analysis;
        let result = solved(&value).result;
        let response = result.response.as_ref().expect("a response");
        assert_eq!(response.regime, RegimeResult::Unstable);
        assert!(response.lyapunov_per_mesh_period.expect("a rate") > 0.0 && response.confidence_interval_95.is_none());
        let warning = result.warnings.iter().find(|w| w.code == "unstable").expect("a warning");
        assert!(
            warning.pointer == "/operation/pinion_speed_rpm" && warning.detail.contains("growth rate"),
            "{warning:?}"
        );
        assert!(!warned(&result, "accuracy-not-reached", "/analysis/accuracy"));
    }
    value["analysis"] = json!({});
    value["kind"] = json!("sweep");
    value["axes"] = json!([{"pointer": "/model/mesh_damping_ratio", "values": [0.001, 0.2]}]);
    let points = solved(&value).result.sweep.expect("a sweep").points;
    let regimes: Vec<_> = points.iter().map(|point| point.regime).collect();
    assert_eq!(regimes, [Some(RegimeResult::Unstable), Some(RegimeResult::Period(1))]);
    assert!(points[1].tooth_force_max_n.is_some_and(|force| force.left > 0.0));
}
