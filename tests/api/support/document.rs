//! Job documents to submit.

use serde_json::{Value, json};
use std::sync::atomic::{AtomicU32, Ordering};

/// A valid document; each one differs in speed, so that no result is reused by chance.
pub fn document() -> Value {
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
pub fn scripted(script: &str) -> Value {
    let mut document = document();
    document["name"] = json!(script);
    document
}
