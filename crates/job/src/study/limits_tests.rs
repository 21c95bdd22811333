//! Tests of documents at the limits of geometry and compliance, through all stages.

use super::unchecked::{check, solve};
use super::{CheckedJob, Outcome, SolveContext};
use crate::drawing::Drawing;
use crate::result::JobResult;
use crate::{DocumentError, Violation, parse_value};
use serde_json::{Value, json};

/// A short document of one half's teeth; torque in N m.
fn design(
    kind: &str,
    module_mm: f64,
    angles_deg: [f64; 2],
    width_mm: f64,
    members: [Value; 2],
    torque_nm: f64,
) -> Value {
    let [pinion, gear] = members;
    json!({
        "kind": kind,
        "design": {
            "normal_module_mm": module_mm, "pressure_angle_deg": angles_deg[0], "pressure_angle_plane": "normal",
            "helix_angle_deg": angles_deg[1], "face_width_mm": width_mm, "gap_width_mm": 0, "pinion": pinion, "gear": gear,
        },
        "operation": {"pinion_speed_rpm": 1000, "pinion_torque_nm": torque_nm},
    })
}

/// z 6/12 at 45°: a transverse contact ratio of 0.892, an overlap ratio of 1.125.
fn six_teeth(kind: &str) -> Value {
    design(kind, 4.0, [20.0, 45.0], 20.0, [json!({"teeth": 6}), json!({"teeth": 12})], 50.0)
}

fn stub(kind: &str) -> Value {
    let side = |teeth: u32| json!({"teeth": teeth, "addendum": 0.45});
    design(kind, 4.0, [20.0, 25.0], 40.0, [side(20), side(60)], 200.0)
}

/// Rack teeth of 14.5°.
fn rack_145(kind: &str, teeth: [u32; 2]) -> Value {
    let side = |teeth: u32| json!({"teeth": teeth, "fillet_radius": 0.2, "dedendum": 1.157});
    design(kind, 25.4 / 12.0, [14.5, 0.0], 20.0, teeth.map(side), 10.0)
}

/// An ordinary rack, pinions that it undercuts.
fn small_pinion(kind: &str, teeth: [u32; 2], helix_deg: f64) -> Value {
    design(kind, 2.5, [20.0, helix_deg], 25.0, teeth.map(|teeth| json!({"teeth": teeth})), 10.0)
}

/// z 19/63 with shifts that 680 mm fit.
fn large(center_distance_mm: f64) -> Value {
    let side = |teeth: u32, x: f64| json!({"teeth": teeth, "profile_shift": x, "tip_alteration": -0.058625});
    let mut value = design("mesh", 16.0, [20.0, 7.0], 280.0, [side(19, 0.52), side(63, 0.789)], 60e3);
    value["design"]["center_distance_mm"] = json!(center_distance_mm);
    value
}

fn solved(value: &Value) -> JobResult {
    let document = parse_value(value).expect("valid");
    let Outcome { result, .. } = solve(&document, &SolveContext::none()).unwrap_or_else(|e| panic!("{e}: {value}"));
    result
}

fn refused(value: &Value) -> Vec<Violation> {
    match check(&parse_value(value).expect("valid")) {
        Err(DocumentError::Invalid(violations)) => violations,
        other => panic!("{:?}: {value}", other.map(|report| report.warnings)),
    }
}

fn codes(result: &JobResult) -> Vec<&str> {
    result.warnings.iter().map(|warning| warning.code.as_str()).collect()
}

/// Every stage has plausible numbers: stiffness and shares are positive, the loaded contact is at least as long as the
/// unloaded one.
fn plausible(value: &Value) -> JobResult {
    let result = solved(value);
    let mesh = result.mesh.as_ref().expect("a mesh");
    let geometry = result.geometry.as_ref().expect("geometry");
    assert!(
        mesh.stiffness_min_n_per_um > 0.0 && mesh.stiffness_max_n_per_um < 4.0 * mesh.stiffness_min_n_per_um,
        "{mesh:?}"
    );
    assert!(mesh.transmission_error_pp_um >= 0.0 && mesh.transmission_error_pp_um < mesh.transmission_error_mean_um);
    if let Some(ratio) = mesh.loaded_contact_ratio {
        assert!(ratio > 0.98 * geometry.total_contact_ratio && ratio < geometry.total_contact_ratio + 1.0, "{ratio}");
        let share = mesh.load_share_at_mesh_in.expect("a share");
        assert!(share > 0.0 && share < 1.0, "{share}");
    }
    let impact = result.impact.as_ref().expect("an impact");
    assert!(impact.force_n > 0.0 && impact.zhou2008_force_n.is_some_and(|force| impact.force_n < force), "{impact:?}");
    assert!(impact.velocity_m_s.is_some_and(|speed| speed > 0.0) && impact.duration_us > 0.0, "{impact:?}");
    result
}

/// A transverse contact ratio below 1 with overlap goes through every method, the response and the drawing.
#[test]
fn a_short_path_with_overlap_is_solved() {
    for base in [six_teeth, stub] {
        for source in [
            json!({"source": "ltca"}),
            json!({"source": "ltca", "corner_contact": false}),
            json!({"source": "ltca", "fidelity": "fe", "elements": "coarse"}),
            json!({"source": "iso6336"}),
        ] {
            let mut value = base("mesh");
            value["model"]["mesh_stiffness"] = source;
            let result = plausible(&value);
            assert!(codes(&result).contains(&"transverse-contact-ratio-below-one"), "{:?}", result.warnings);
            let geometry = result.geometry.as_ref().expect("geometry");
            assert!(geometry.transverse_contact_ratio < 1.0 && geometry.total_contact_ratio > 1.0);
        }
        let response = plausible(&base("response")).response.expect("a response");
        let rms = response.rms.mesh_circumferential_acceleration_m_s2;
        assert!(rms.left > 0.0 && rms.left < 1e4, "{rms:?}");
        let drawing = Drawing::of(&CheckedJob::new(parse_value(&base("mesh")).expect("valid")).expect("feasible"));
        let names: Vec<&str> = drawing.section.points.iter().map(|point| point.name.as_str()).collect();
        assert!(!names.contains(&"B") && names.contains(&"A") && names.contains(&"E"), "{names:?}");
        assert!(drawing.plane_of_action.left.contact_length_mm[0] > 0.0);
        assert!(!drawing.plane_of_action.left.lines.is_empty());
    }
}

/// Without overlap such a pair has no contact at some phases.
#[test]
fn a_spur_pair_with_a_short_path_is_refused() {
    let mut value = stub("mesh");
    value["design"]["helix_angle_deg"] = json!(0.0);
    let found = refused(&value);
    assert_eq!(
        (found[0].code.as_str(), found[0].pointer.as_str()),
        ("contact-ratio-below-one", "/design/pinion/addendum")
    );
}

/// Gears that a rack undercuts and whose mate's tip passes the base tangent point: solved, with a warning of undercut.
#[test]
fn undercut_gears_are_solved() {
    for value in [
        rack_145("response", [20, 63]),
        rack_145("mesh", [18, 63]),
        rack_145("mesh", [30, 200]),
        small_pinion("response", [12, 60], 0.0),
        small_pinion("mesh", [12, 12], 0.0),
        small_pinion("mesh", [13, 90], 0.0),
        small_pinion("mesh", [9, 60], 25.0),
    ] {
        let result = plausible(&value);
        assert!(codes(&result).contains(&"undercut"), "{:?}", result.warnings);
        let drawing = Drawing::of(&CheckedJob::new(parse_value(&value).expect("valid")).expect("feasible"));
        let [start, end] = drawing.plane_of_action.path_roll_mm;
        assert!(start >= 0.0 && start < end && drawing.margins.iter().all(|margin| margin.value.is_finite()));
        let t2 = drawing.section.points.last().expect("points");
        assert!(t2.name == "T2" && t2.roll_mm >= end);
    }
}

/// A centre distance in contradiction with the profile shifts is refused at its own field, with the distance that fits.
#[test]
fn a_foreign_centre_distance_is_named() {
    for (center_distance_mm, sum) in [(861.0, "20.3552"), (720.0, "4.6583"), (640.0, "-1.1327"), (600.0, "no sum fits")]
    {
        let found = refused(&large(center_distance_mm));
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].pointer, "/design/center_distance_mm");
        for part in ["680.0007 mm", "1.3090", &format!("{center_distance_mm:.4} mm"), sum] {
            assert!(found[0].detail.contains(part), "{part} is not in {:?}", found[0]);
        }
    }
    assert!(check(&parse_value(&large(680.5)).expect("valid")).is_ok());
}

/// The analytic compliance reports its error on short faces, and only there.
#[test]
fn short_faces_are_warned_of_with_the_size_of_the_error() {
    let ten = |helix_deg: f64, width_mm: f64| {
        design("mesh", 2.0, [20.0, helix_deg], width_mm, [json!({"teeth": 10}), json!({"teeth": 10})], 1.0)
    };
    let common = |helix_deg: f64, width_mm: f64| {
        design("mesh", 2.0, [20.0, helix_deg], width_mm, [json!({"teeth": 25}), json!({"teeth": 40})], 1.0)
    };
    let warning = |value: &Value| {
        let report = check(&parse_value(value).expect("valid")).unwrap_or_else(|e| panic!("{e:?}"));
        report.warnings.into_iter().find(|warning| warning.code == "short-face")
    };
    for (value, percent) in
        [(ten(40.0, 2.5), "19 %"), (ten(30.0, 2.0), "22 %"), (common(20.0, 2.0), "7 %"), (common(40.0, 2.0), "17 %")]
    {
        let found = warning(&value).unwrap_or_else(|| panic!("not warned: {value}"));
        assert_eq!(found.pointer, "/design/face_width_mm");
        assert!(found.detail.contains(percent) && found.detail.contains("too stiff"), "{found:?}");
        let mut elements = value.clone();
        elements["model"]["mesh_stiffness"] = json!({"source": "ltca", "fidelity": "fe"});
        assert!(warning(&elements).is_none());
        elements["model"]["mesh_stiffness"] = json!({"source": "iso6336"});
        assert!(warning(&elements).is_none());
    }
    assert!(warning(&common(0.0, 1.0)).is_some_and(|found| found.detail.contains("too soft")));
    for value in [common(40.0, 8.0), common(20.0, 5.0), common(0.0, 3.0), ten(40.0, 12.0)] {
        assert!(warning(&value).is_none(), "{value}");
    }
}
