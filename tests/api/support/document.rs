//! Job documents to submit.

use serde_json::{Value, json};
use std::sync::atomic::{AtomicU32, Ordering};

/// A valid document; each one differs in speed, so that no result is reused by chance.
pub(crate) fn document() -> Value {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let speed_rpm = 1000.0 + f64::from(COUNT.fetch_add(1, Ordering::Relaxed));
    json!({
        "kind": "response",
        "design": {
            "normal_module_mm": 6.0, "pressure_angle_deg": 20.0, "pressure_angle_plane": "transverse",
            "helix_angle_deg": 24.43, "face_width_mm": 75.0,
            "pinion": {"teeth": 17, "bore_diameter_mm": 50.0}, "gear": {"teeth": 44, "bore_diameter_mm": 120.0},
        },
        "operation": {"pinion_speed_rpm": speed_rpm, "pinion_torque_nm": 800.0},
    })
}

/// A valid document whose name tells the scripted solver what to do.
pub(crate) fn scripted(script: &str) -> Value {
    let mut document = document();
    document["name"] = json!(script);
    document
}

/// A valid sweep over so many speeds whose name tells the scripted solver what to do.
pub(crate) fn sweep(script: &str, points: u32) -> Value {
    let mut document = scripted(script);
    let torque_nm = document["operation"]["pinion_speed_rpm"].clone();
    document["kind"] = json!("sweep");
    document["operation"] = json!({"pinion_speed_rpm": 2000.0, "pinion_torque_nm": torque_nm});
    let to = 1000.0 + f64::from(points.max(2));
    document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 1000.0, "to": to, "points": points}]);
    document
}
