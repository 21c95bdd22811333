//! Documents with the contact in the equations of motion.

use super::unchecked::solve;
use super::{CheckedJob, SolveContext, mesh::MeshMemo, point};
use crate::parse_value;
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::{check, check_worst};
use herringbone_physics::response::{self, Analysis};
use herringbone_physics::watch::Watch;
use serde_json::{Value, json};

const TOPIC: &str = "Job: contact in the equations";

fn references() -> Vec<Value> {
    let file: Value = serde_json::from_str(include_str!("../../../../tests/data/dynamic_contact.json")).expect("JSON");
    file["cases"].as_array().expect("cases").clone()
}

/// One half in torsion with every slice of every tooth pair a spring of its own and the exact gaps of the tip corners,
/// by fixed small steps.
#[test]
fn motions_agree_with_a_model_that_keeps_every_slice() {
    for case in references() {
        let name = case["name"].as_str().expect("a name");
        let mut input = case["input"].clone();
        input["analysis"]["channels"] = json!(["a_x_left"]);
        input["analysis"]["samples_per_mesh_period"] = json!(1024);
        let outcome = solve(&parse_value(&input).expect("valid"), &SolveContext::none()).expect("solved");
        let (mesh, response) = (outcome.result.mesh.expect("mesh"), outcome.result.response.expect("response"));
        let expected = |pointer: &str| case["expected"].pointer(pointer).and_then(Value::as_f64).expect("a number");
        let agrees = |what: &str, got: f64, pointer: &str, within| {
            check(TOPIC, &format!("{name}: {what}"), got, expected(pointer), within);
        };
        let rms = response.rms.mesh_circumferential_acceleration_m_s2.left;
        let peak = outcome.series[0].values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        agrees("RMS, m/s2", rms, "/rms_acceleration_m_s2", Relative(0.004));
        agrees("peak, m/s2", peak, "/peak_acceleration_m_s2", Relative(0.006));
        agrees("dynamic factor", response.dynamic_factor.expect("loaded"), "/dynamic_factor", Absolute(0.012));
        agrees(
            "time without contact",
            1.0 - response.fraction_in_contact,
            "/fraction_without_contact",
            Absolute(0.002),
        );
        let mean = "/static/transmission_error_mean_um";
        agrees("transmission error, mean, um", mesh.transmission_error_mean_um, mean, Relative(0.001));
        let first = mesh.transmission_error_harmonics_um[0];
        agrees(
            "transmission error, first harmonic, um",
            first,
            "/static/transmission_error_harmonics_um/0",
            Relative(0.004),
        );
    }
}

fn table1(change: impl FnOnce(&mut Value)) -> Value {
    let mut value: Value = serde_json::from_str(include_str!("../../../../examples/table1.json")).expect("JSON");
    value["model"]["mesh_force"] = json!("contact");
    value["analysis"]["channels"] = json!([]);
    change(&mut value);
    value
}

/// The mean tooth force of any steady motion is the static force.
#[test]
fn the_mean_tooth_force_is_the_static_one() {
    let errors = [(800.0, 2000.0), (800.0, 6500.0), (40.0, 9000.0), (3000.0, 1200.0)].map(|(torque_nm, rpm)| {
        let value = table1(|v| v["operation"] = json!({"pinion_torque_nm": torque_nm, "pinion_speed_rpm": rpm}));
        let job = parse_value(&value).and_then(CheckedJob::new).expect("feasible");
        let staged = point::stage(&job, &SolveContext::none(), &MeshMemo::default()).expect("staged");
        let p = staged.parameters().expect("equations");
        let channels = vec![response::ChannelId::parse("f_n_left").expect("a channel")];
        let solved = response::solve(p, &Analysis { channels, ..Analysis::default() }, &Watch::none()).expect("solved");
        let mean = solved.summary.statistics["f_n_left"].mean;
        let expected = p.halves[0].pinion_torque_nm / p.pinion_radius_m / p.helix_angle_rad.cos();
        mean / expected - 1.0
    });
    check_worst(TOPIC, "mean tooth force over the static one", errors, 1e-9);
}

/// With rigid supports the twelve equations reduce to m_e x'' + c x' + F(x, φ) = F_bt, solved here by fixed steps.
#[test]
fn rigid_supports_leave_one_degree_of_freedom() {
    let errors = [2000.0, 5200.0].map(|rpm| {
        let value = table1(|v| {
            v["operation"]["pinion_speed_rpm"] = json!(rpm);
            for gear in ["pinion", "gear"] {
                v["design"][gear]["mass_kg"] = json!(1e6);
            }
            v["design"]["supports"] = json!({"pinion_lateral_n_per_um": 1e7, "gear_lateral_n_per_um": 1e7,
                "pinion_halves_axial_n_per_um": 1e7, "gear_axial_n_per_um": 1e7, "gear_halves_axial_n_per_um": 1e7});
        });
        let job = parse_value(&value).and_then(CheckedJob::new).expect("feasible");
        let staged = point::stage(&job, &SolveContext::none(), &MeshMemo::default()).expect("staged");
        let p = staged.parameters().expect("equations").clone();
        let solved = response::solve(&p, &Analysis::default(), &Watch::none()).expect("solved");
        let contact = p.halves[0].contact_force.clone().expect("a contact force");
        let (cos, b) = (p.helix_angle_rad.cos(), p.half_backlash_m);
        let m = p.equivalent_mass_kg(0);
        let c = p.halves[0].mesh_damping_n_s_per_m * cos * cos;
        let load = p.halves[0].pinion_torque_nm / p.pinion_radius_m;
        let period = p.mesh_period_s();
        let a = |phase: f64, x: f64, v: f64| {
            (load - c * v - cos * contact.force(cos * x, b, phase.fract(), phase.fract()).0) / m
        };
        const STEPS: usize = 4000;
        let h = period / STEPS as f64;
        let (mut x, mut v) = (contact.displacement_under(load / cos, b, 0.0) / cos, 0.0);
        let (mut sum, mut square) = (0.0, 0.0);
        for round in 0..120 {
            for i in 0..STEPS {
                let (from, mid, to) =
                    (i as f64 / STEPS as f64, (i as f64 + 0.5) / STEPS as f64, (i + 1) as f64 / STEPS as f64);
                let (k1, l1) = (v, a(from, x, v));
                let (k2, l2) = (v + 0.5 * h * l1, a(mid, x + 0.5 * h * k1, v + 0.5 * h * l1));
                let (k3, l3) = (v + 0.5 * h * l2, a(mid, x + 0.5 * h * k2, v + 0.5 * h * l2));
                let (k4, l4) = (v + h * l3, a(to, x + h * k3, v + h * l3));
                x += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
                v += h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4);
                if round == 119 {
                    let now = a(to, x, v);
                    sum += now;
                    square += now * now;
                }
            }
        }
        let rms = (square / STEPS as f64 - (sum / STEPS as f64).powi(2)).sqrt();
        solved.summary.rms.mesh_circumferential_acceleration_m_s2.left / rms - 1.0
    });
    check_worst(TOPIC, "RMS on rigid supports against one degree of freedom", errors, 2e-4);
}

#[test]
fn no_pulse_is_applied_where_the_contact_is_in_the_equations() {
    let rms = |impact: Value| {
        let value = table1(|v| v["model"]["impact"] = impact);
        let result = solve(&parse_value(&value).expect("valid"), &SolveContext::none()).expect("solved").result;
        (
            result.response.expect("response").rms.mesh_circumferential_acceleration_m_s2.left,
            result.impact.map(|i| i.force_n),
        )
    };
    let (with, reported) = rms(json!({"source": "corner_contact"}));
    let (without, none) = rms(json!({"source": "none"}));
    assert_eq!(with.to_bits(), without.to_bits());
    assert!(reported.is_some_and(|force_n| force_n > 1000.0) && none.is_none());
}

#[test]
fn the_default_is_contact_for_ltca_and_stiffness_for_the_others() {
    let default = |stiffness: Value| {
        let value = table1(|v| {
            v["model"] = json!({"mesh_stiffness": stiffness});
        });
        serde_json::to_value(parse_value(&value).expect("valid").model.mesh_force).expect("a word")
    };
    assert_eq!(default(json!({"source": "ltca"})), "contact");
    assert_eq!(default(json!({})), "contact");
    assert_eq!(default(json!({"source": "iso6336"})), "stiffness");
    assert_eq!(default(json!({"source": "given", "mean_n_per_um": 900.0})), "stiffness");
    for source in [json!({"source": "iso6336"}), json!({"source": "given", "mean_n_per_um": 900.0})] {
        let value = table1(|v| v["model"] = json!({"mesh_force": "contact", "mesh_stiffness": source}));
        let error = format!("{:?}", parse_value(&value).expect_err("refused"));
        assert!(error.contains("/model/mesh_force") && error.contains("ltca"), "{error}");
    }
}
