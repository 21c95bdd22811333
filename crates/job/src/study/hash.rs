//! Content hashes of exactly those inputs on which a result or a stage depends.

use super::SOLVER_VERSION;
use super::compliance::bare;
use super::mesh::ContactCase;
use crate::document::JobDocument;
use herringbone_physics::fe::FlankKey;
use serde::Serialize;
use sha2::{Digest, Sha256};

/// Hash of all inputs of a document's result (not name and label) and of the solver's version.
pub fn input_hash(document: &JobDocument) -> String {
    let unnamed = JobDocument { name: None, label: None, ..document.clone() };
    hash("result", &unnamed)
}

/// Hash of the inputs of a row of a tolerance study: those of the document without its sample and what is made of it.
pub(super) fn rows_hash(document: &JobDocument) -> String {
    let mut rows = JobDocument { name: None, label: None, limits: Vec::new(), ..document.clone() };
    (rows.samples, rows.sampling, rows.sensitivity, rows.seed) = (None, None, None, None);
    hash("tolerance-rows", &rows)
}

/// Hash of a contact analysis: the teeth with their errors, the torque and the choices of the model; not speed,
/// supports, inertias or the analysis of the response.
pub(super) fn mesh_hash(case: &ContactCase) -> String {
    hash("mesh", case)
}

/// Hash of the contact force over approach and phase, on the flanks that carry the torque or on the `idle` ones: of the
/// same inputs as [`mesh_hash`].
pub(super) fn force_hash(case: &ContactCase, idle: bool) -> String {
    hash("mesh-force", &(case, idle))
}

/// Hash of the inputs of the teeth's compliance: those of [`mesh_hash`] without load, modifications and misalignments.
pub(super) fn compliance_hash(case: &ContactCase) -> String {
    let teeth = (bare(case), &case.settings, case.fidelity, case.line_stiffness_n_per_m2, case.resolution);
    match &case.mounted {
        None => hash("compliance", &teeth),
        Some(_) => hash("compliance-on-shafts", &teeth),
    }
}

/// Hash of the flexibility of the shafts between the stations of the compliance, under the flanks that carry.
pub(super) fn shaft_flexibility_hash(case: &ContactCase, coast: bool) -> String {
    hash("shaft-flexibility", &(compliance_hash(case), &case.mounted, case.spec.rotation, case.spec.gap_width_m, coast))
}

/// Hash of the inputs of a reduced rotor.
pub(super) fn rotor_hash(inputs: &impl Serialize) -> String {
    hash("rotor", inputs)
}

/// Hash of the finite elements of one gear.
pub(super) fn flank_hash(key: &FlankKey) -> String {
    hash("flank", key)
}

fn hash(stage: &str, value: &impl Serialize) -> String {
    let mut hasher = Sha256::new();
    hasher.update(stage);
    hasher.update([0]);
    hasher.update(SOLVER_VERSION);
    hasher.update([0]);
    // A document holds finite numbers and strings only, so writing it cannot fail.
    hasher.update(serde_json::to_vec(value).unwrap_or_default());
    hex::encode(hasher.finalize())
}
