//! Content hashes: what a result, or a stage, depends on, and nothing else.

use super::SOLVER_VERSION;
use crate::job::document::{JobDocument, MeshStiffness};
use serde::Serialize;
use serde_json::json;
use sha2::{Digest, Sha256};

/// Hash of everything that decides a document's result (name and label do not), with the solver's version.
pub fn input_hash(document: &JobDocument) -> String {
    let unnamed = JobDocument { name: None, label: None, ..document.clone() };
    hash("result", &unnamed)
}

/// Hash of what the mesh stage depends on: the teeth, the torque and the contact model; not speed, supports, inertias
/// or analysis. `None` where the stiffness is not calculated from the teeth, so that there is nothing worth keeping.
pub fn mesh_hash(document: &JobDocument) -> Option<String> {
    let MeshStiffness::Ltca(ltca) = &document.model.mesh_stiffness else { return None };
    let design = &document.design;
    let member = |gear: &crate::job::document::Gear| {
        json!([
            gear.teeth,
            gear.profile_shift,
            gear.addendum,
            gear.dedendum,
            gear.fillet_radius,
            gear.tip_alteration,
            gear.bore_diameter_mm,
            gear.flank,
            gear.left,
            gear.right
        ])
    };
    let key = json!([
        design.normal_module_mm,
        design.pressure_angle_deg,
        design.pressure_angle_plane,
        design.helix_angle_deg,
        design.face_width_mm,
        design.center_distance_mm,
        design.half_stagger,
        design.material,
        member(&design.pinion),
        member(&design.gear),
        design.assembly,
        document.operation.rotation,
        document.operation.pinion_torque_nm,
        ltca
    ]);
    Some(hash("mesh", &key))
}

fn hash(stage: &str, value: &impl Serialize) -> String {
    let mut hasher = Sha256::new();
    hasher.update(stage);
    hasher.update([0]);
    hasher.update(SOLVER_VERSION);
    hasher.update([0]);
    // A document holds finite numbers and strings only, so writing it cannot fail.
    hasher.update(serde_json::to_vec(value).unwrap_or_default());
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
