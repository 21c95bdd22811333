//! Documents of real jobs: cheap ones, and ones that compute until they are canceled. `examples/load` submits them too.

use serde_json::{Value, json};
use std::sync::atomic::{AtomicU32, Ordering};

/// A response with given stiffness, directly periodic, hardly a series: milliseconds. Each one differs in speed, so
/// that no result is reused by chance.
pub(crate) fn response() -> Value {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let speed_rpm = 1000.0 + 0.01 * f64::from(COUNT.fetch_add(1, Ordering::Relaxed));
    json!({
        "kind": "response",
        "design": {
            "normal_module_mm": 6.0, "pressure_angle_deg": 20.0, "pressure_angle_plane": "transverse",
            "helix_angle_deg": 24.43, "face_width_mm": 75.0,
            "pinion": {"teeth": 17, "bore_diameter_mm": 50.0}, "gear": {"teeth": 44, "bore_diameter_mm": 120.0},
            // No stiff couplings: cheap.
            "supports": {
                "pinion_lateral_n_per_um": 600.0, "gear_lateral_n_per_um": 600.0, "gear_axial_n_per_um": 200.0,
                "pinion_halves_axial_n_per_um": 300.0, "gear_halves_axial_n_per_um": 300.0,
                "pinion_halves_lateral_n_per_um": 0.0, "gear_halves_lateral_n_per_um": 0.0,
                "pinion_halves_torsional_nm_per_rad": 0.0, "gear_halves_torsional_nm_per_rad": 0.0,
            },
        },
        "operation": {"pinion_speed_rpm": speed_rpm, "pinion_torque_nm": 800.0},
        "model": {
            "mesh_stiffness": {"source": "given", "mean_n_per_um": 900.0, "harmonics": [{"amplitude": 0.1}]},
            "impact": {"source": "none"},
        },
        "analysis": {"record_mesh_periods": 1, "samples_per_mesh_period": 8, "channels": ["a_x_left"]},
    })
}

/// As [`response`], up to the mesh.
pub(crate) fn mesh() -> Value {
    let mut document = response();
    document["kind"] = json!("mesh");
    document
}

/// As [`response`], over so many speeds.
pub(crate) fn sweep(points: u32) -> Value {
    let mut document = response();
    document["kind"] = json!("sweep");
    document["operation"]["pinion_torque_nm"] = document["operation"]["pinion_speed_rpm"].take();
    document["operation"]["pinion_speed_rpm"] = json!(2000.0);
    document["axes"] = json!([
        {"pointer": "/operation/pinion_speed_rpm", "from": 1000.0, "to": 5000.0, "points": points}
    ]);
    document
}

/// As [`response`], integrated over so many mesh periods.
pub(crate) fn integration(mesh_periods: u32) -> Value {
    let mut document = response();
    document["analysis"]["method"] = json!("integrate");
    document["analysis"]["mesh_periods"] = json!(mesh_periods);
    document
}

/// Finite elements of both gears, as fine as there are.
pub(crate) fn elements() -> Value {
    let mut document = mesh();
    document["model"]["mesh_stiffness"] = json!({"source": "ltca", "fidelity": "fe", "elements": "fine"});
    document
}

/// A face hundreds of pitches wide: so many lines of contact at once that one position of the mesh takes seconds.
pub(crate) fn wide_contact(face_width_mm: f64) -> Value {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let torque_nm = 1.0 + 1e-3 * f64::from(COUNT.fetch_add(1, Ordering::Relaxed));
    json!({
        "kind": "mesh",
        "design": {
            "normal_module_mm": 0.1, "helix_angle_deg": 45.0, "face_width_mm": face_width_mm,
            "pinion": {"teeth": 30}, "gear": {"teeth": 60},
        },
        "operation": {"pinion_speed_rpm": 1000.0, "pinion_torque_nm": torque_nm},
        "model": {"mesh_stiffness": {"source": "ltca"}},
    })
}

/// Many wide teeth in mesh, finely sliced.
pub(crate) fn contact() -> Value {
    let mut document = mesh();
    document["design"] = json!({
        "normal_module_mm": 6.0, "pressure_angle_deg": 17.5, "helix_angle_deg": 35.0, "face_width_mm": 800.0,
        "pinion": {"teeth": 100, "addendum": 1.2, "dedendum": 1.5, "bore_diameter_mm": 100.0},
        "gear": {"teeth": 300, "addendum": 1.2, "dedendum": 1.5, "bore_diameter_mm": 300.0},
    });
    document["operation"]["pinion_torque_nm"] = json!(50_000.0);
    document["model"]["mesh_stiffness"] = json!({"source": "ltca", "positions": 1024, "slices": 200});
    document
}
