//! The mesh stage: stiffness of both halves over the mesh period, and the quantities of the mesh used by the impact.

use super::compliance::{self, ComplianceMemo};
use super::equations::{MotionPlane, given_stiffness};
use super::hash::mesh_hash;
use super::mesh_force::{self, MeshForces};
use super::prepare::{Pairs, Prepared};
use super::recent::Recent;
use super::rotor::Rotor;
use super::shaft_contact::{self, MountedTrain, ShaftContact};
use super::{SolveContext, SolveError, Stage};
use crate::document::{
    BodyInput, Elements, Fidelity, JobDocument, JobKind, Ltca, MeshForce, MeshStiffness, MeshStiffnessSource,
    StiffnessLaw,
};
use crate::result::{ApexSensitivity, Convergence, FlankLoad, Mesh, MeshCurve, PerHalf, ReusedStage};
use herringbone_physics::compliance::{BodyHold, Settings};
use herringbone_physics::contact::{
    self, ContactError, ContactShafts, ForceTable, HalfCycle, LoadedContact, LoadedContactOnShafts, MESH_IN_PHASE,
};
use herringbone_physics::dynamics::Stiffness;
use herringbone_physics::fe::Resolution;
use herringbone_physics::gear::{Pair, PairSpec};
use herringbone_physics::iso6336::{Blank, MethodB};
use herringbone_physics::watch::Watch;
use serde::Serialize;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Positions of the closed-form and given curves over one mesh period.
const CLOSED_FORM_POSITIONS: usize = 128;

/// Outcome of the mesh stage for the later stages.
#[derive(Debug, Clone)]
pub(super) struct MeshStage {
    pub summary: Mesh,
    /// Stiffness along s of the plane in use, left and right.
    pub stiffness: [Stiffness; 2],
    /// Whether the right half's stiffness is already shifted by the stagger.
    pub stagger_included: bool,
    pub entry: [EntryState; 2],
    /// The mesh force over approach and phase, if the equations contain it.
    pub forces: Option<MeshForces>,
    /// The contact of both halves on their shafts.
    pub on_shafts: Option<ShaftContact>,
}

/// The mesh of one half at the entry of a pair. Stiffness and deflection along the transverse base tangent.
#[derive(Debug, Clone)]
pub(super) struct EntryState {
    /// Stiffness of the whole half, and the entering pair's load share, one twentieth of a base pitch after its start.
    pub stiffness_n_per_m: f64,
    pub load_share: f64,
    deflection: Deflection,
}

#[derive(Debug, Clone)]
enum Deflection {
    Constant(f64),
    Loaded(contact::EntryDeflection),
}

impl EntryState {
    /// Deflection of the pairs already in mesh when the entering pair stands `overrun_m` before its start.
    pub(super) fn deflection_m(&self, overrun_m: f64) -> f64 {
        match &self.deflection {
            Deflection::Constant(deflection_m) => *deflection_m,
            Deflection::Loaded(entry) => entry.deflection_before_entry_m(overrun_m),
        }
    }
}

/// All inputs of the contact analysis; their hash identifies its result.
#[derive(Debug, Serialize)]
pub(super) struct ContactCase<'a> {
    pub spec: &'a PairSpec,
    pub torque_nm: f64,
    pub half_stagger: f64,
    pub fidelity: Fidelity,
    pub line_stiffness_n_per_m2: f64,
    pub resolution: Resolution,
    pub settings: Settings,
    /// Shafts that both halves stand on.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mounted: Option<MountedTrain>,
}

pub(super) fn resolution(elements: Elements) -> Resolution {
    match elements {
        Elements::Coarse => Resolution::Coarse,
        Elements::Medium => Resolution::Medium,
        Elements::Standard => Resolution::Standard,
        Elements::Fine => Resolution::Fine,
    }
}

impl<'a> ContactCase<'a> {
    /// F_bt of one half.
    pub(super) fn half_force_n(&self, pair: &Pair) -> f64 {
        0.5 * self.torque_nm / pair.pinion.base_radius_m
    }

    pub(super) fn new(document: &JobDocument, ltca: &Ltca, prepared: &'a Prepared) -> Self {
        Self {
            spec: &prepared.pair.spec,
            torque_nm: prepared.contact_torque_nm,
            half_stagger: document.design.half_stagger,
            fidelity: ltca.fidelity,
            line_stiffness_n_per_m2: match ltca.fidelity {
                // N/(mm µm) over N/m².
                Fidelity::Uniform => ltca.line_stiffness_n_per_mm_um * 1e9,
                Fidelity::Analytic | Fidelity::Fe => 0.0,
            },
            resolution: resolution(ltca.elements),
            settings: Settings {
                positions: ltca.positions.map(|positions| positions as usize),
                accuracy: ltca.accuracy,
                slices: ltca.slices.map(|slices| slices as usize),
                body: match ltca.body {
                    BodyInput::Rim => BodyHold::Rim,
                    BodyInput::Bore => BodyHold::Bore,
                },
                corner_contact: ltca.corner_contact,
            },
            mounted: MountedTrain::of(document, &prepared.pair),
        }
    }
}

/// Contact analyses of one job and the compliances under them, so that the points of a sweep share them.
#[derive(Default)]
pub(super) struct MeshMemo {
    pub(super) pairs: Pairs,
    stages: Recent<MeshInputs, MeshStage>,
    contacts: Memo<LoadedContact>,
    pub(super) shaft_contacts: Memo<LoadedContactOnShafts>,
    pub(super) shafts: Memo<ContactShafts>,
    pub(super) rotors: Memo<Rotor>,
    pub(super) forces: Memo<Vec<ForceTable>>,
    pub(super) compliances: ComplianceMemo,
}

/// Largest number of outcomes kept.
pub(super) const KEPT: usize = 64;

/// Outcomes by the hash of their inputs.
pub(super) struct Memo<T>(Mutex<HashMap<String, Arc<T>>>);

impl<T> Default for Memo<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T> Memo<T> {
    pub(super) fn get(&self, key: &str) -> Option<Arc<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get(key).cloned()
    }

    pub(super) fn put(&self, key: String, outcome: Arc<T>) {
        let mut map = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // A sweep over the teeth does not use old entries again; one over the speed has a single entry.
        if map.len() >= KEPT {
            map.clear();
        }
        map.insert(key, outcome);
    }
}

/// All inputs of the mesh stage of a pair without shafts; not the speed, supports, inertias, backlash or analysis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MeshInputs {
    spec: PairSpec,
    contact_torque_nm: f64,
    half_force_n: f64,
    half_stagger: f64,
    plane: MotionPlane,
    mesh_stiffness: MeshStiffness,
    mesh_force: MeshForce,
    /// Whether equations of motion follow.
    vibrates: bool,
}

impl MeshInputs {
    /// `None` on shafts, which yield by their bearings, and those by the speed.
    fn new(document: &JobDocument, prepared: &Prepared, plane: &MotionPlane) -> Option<Self> {
        document.design.shafts.is_none().then(|| Self {
            spec: prepared.pair.spec,
            contact_torque_nm: prepared.contact_torque_nm,
            half_force_n: prepared.half_force_n,
            half_stagger: document.design.half_stagger,
            plane: *plane,
            mesh_stiffness: document.model.mesh_stiffness.clone(),
            mesh_force: document.model.mesh_force,
            vibrates: document.kind != JobKind::Mesh,
        })
    }
}

/// Runs the mesh stage, or takes it from a point with the same inputs. Also returns the parts that were not calculated
/// anew.
///
/// # Errors
/// [`SolveError`].
pub(super) fn run(
    document: &JobDocument,
    prepared: &Prepared,
    plane: &MotionPlane,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(Arc<MeshStage>, Vec<ReusedStage>), SolveError> {
    let inputs = MeshInputs::new(document, prepared, plane);
    if let Some(stage) = inputs.as_ref().and_then(|inputs| memo.stages.get(inputs)) {
        let of_contact = stage.summary.source == MeshStiffnessSource::Ltca;
        return Ok((stage, if of_contact { vec![ReusedStage::Mesh] } else { Vec::new() }));
    }
    let (stage, reused) = calculate(document, prepared, plane, context, memo)?;
    let stage = Arc::new(stage);
    if let Some(inputs) = inputs {
        memo.stages.put(inputs, stage.clone());
    }
    Ok((stage, reused))
}

fn calculate(
    document: &JobDocument,
    prepared: &Prepared,
    plane: &MotionPlane,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(MeshStage, Vec<ReusedStage>), SolveError> {
    match &document.model.mesh_stiffness {
        MeshStiffness::Ltca(ltca) => {
            let case = ContactCase::new(document, ltca, prepared);
            let (contact, on_shafts, reused) = match &case.mounted {
                None => {
                    let (contact, reused) = loaded_contact(&case, &prepared.pair, context, memo)?;
                    (contact, None, reused)
                }
                Some(mounted) => {
                    let (found, reused) = shaft_contact::find(&case, mounted, &prepared.pair, context, memo)?;
                    (Arc::new(found.loaded.contact.clone()), Some(found), reused)
                }
            };
            let mut stage = from_contact(&contact, ltca, prepared, plane);
            stage.on_shafts = on_shafts;
            if document.model.mesh_force == MeshForce::Contact && document.kind != JobKind::Mesh {
                let forces = mesh_force::run(&case, &prepared.pair, stage.on_shafts.as_ref(), plane, context, memo)?;
                stage.summary.contact_force = Some(forces.summary.clone());
                stage.stiffness = tangent_stiffness(&contact, plane);
                stage.stagger_included = false;
                stage.forces = Some(forces);
            }
            Ok((stage, reused))
        }
        MeshStiffness::Iso6336 => Ok((iso6336(prepared, plane)?, Vec::new())),
        MeshStiffness::Given(given) => {
            let stiffness = given_stiffness(given);
            let samples = stiffness.curve();
            let curve = |phase: f64| samples.at_n_per_m(phase) / plane.stiffness_factor;
            let mut stage = closed_form(MeshStiffnessSource::Given, prepared, curve);
            stage.stiffness = [stiffness.clone(), stiffness];
            Ok((stage, Vec::new()))
        }
    }
}

fn loaded_contact(
    case: &ContactCase,
    pair: &Pair,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(Arc<LoadedContact>, Vec<ReusedStage>), SolveError> {
    let key = mesh_hash(case);
    if let Some(contact) = memo.contacts.get(&key) {
        return Ok((contact, vec![ReusedStage::Mesh]));
    }
    let stored = context.stages.load(&key).and_then(|bytes| serde_json::from_slice::<LoadedContact>(&bytes).ok());
    let (contact, reused) = match stored {
        Some(contact) => (contact, vec![ReusedStage::Mesh]),
        None => {
            (context.progress)(Stage::Mesh, 0.0);
            let compliances = compliance::find(case, pair, context, &memo.compliances)?;
            let contact = solve_contact(case, pair, &compliances, context)?;
            context.stages.save(&key, Stage::Mesh, &serde_json::to_vec(&contact).unwrap_or_default());
            (contact, if compliances.elements_reused { vec![ReusedStage::FiniteElements] } else { Vec::new() })
        }
    };
    let contact = Arc::new(contact);
    memo.contacts.put(key, contact.clone());
    Ok((contact, reused))
}

fn solve_contact(
    case: &ContactCase,
    pair: &Pair,
    compliances: &compliance::Found,
    context: &SolveContext,
) -> Result<LoadedContact, SolveError> {
    let progress =
        |fraction: f64| (context.progress)(Stage::Mesh, compliances.done + (1.0 - compliances.done) * fraction);
    let watch = Watch::new(&progress, context.canceled);
    let (torque_nm, stagger) = (case.torque_nm, case.half_stagger);
    let solve = if torque_nm < 0.0 { contact::solve_coast_halves } else { contact::solve_pair_of_halves };
    solve(pair, torque_nm.abs(), stagger, &compliances.compliance, &case.settings, watch).map_err(contact_failed)
}

pub(super) fn contact_failed(error: ContactError) -> SolveError {
    match error {
        ContactError::Canceled(canceled) => canceled.into(),
        other => SolveError::failed(Stage::Mesh, contact_code(&other), &other),
    }
}

fn contact_code(error: &ContactError) -> &'static str {
    match error {
        ContactError::NotConverged { .. } | ContactError::HalvesNotBalanced { .. } => "not-converged",
        ContactError::NoContact { .. } => "no-contact",
        _ => "contact-failed",
    }
}

fn from_contact(contact: &LoadedContact, ltca: &Ltca, prepared: &Prepared, plane: &MotionPlane) -> MeshStage {
    let [left, right] = &contact.halves;
    // Along s, which is negative where the coast flanks carry.
    let sign = if prepared.half_force_n < 0.0 { -1.0 } else { 1.0 };
    let loaded = if prepared.half_force_n == 0.0 { 0.0 } else { sign };
    let both = |of: &dyn Fn(&HalfCycle) -> f64| 0.5 * (of(left) + of(right));
    let most = |of: &dyn Fn(&HalfCycle) -> f64| of(left).max(of(right));
    let transmission_error = contact::CurveStatistics::of(&contact.transmission_error_m);
    let pairs = || left.pairs_in_contact.iter().chain(&right.pairs_in_contact).copied();
    let curve = |half: &HalfCycle, shift: &dyn Fn(usize) -> f64| MeshCurve {
        phase: left.phase.clone(),
        stiffness_n_per_um: half.stiffness_n_per_m.iter().map(|k| k * 1e-6).collect(),
        transmission_error_um: (0..left.phase.len()).map(|i| sign * shift(i) * 1e6).collect(),
        load_share: vec![half.load_share.clone()],
        load_share_phase: half.load_share_phase.clone(),
        flank: Some(flank_load(half)),
    };
    let summary = Mesh {
        stiffness_mean_n_per_um: both(&|half| half.stiffness.mean) * 1e-6,
        stiffness_min_n_per_um: left.stiffness.min.min(right.stiffness.min) * 1e-6,
        stiffness_max_n_per_um: most(&|half| half.stiffness.max) * 1e-6,
        secant_stiffness_mean_n_per_um: both(&|half| half.secant_stiffness.mean) * 1e-6,
        transmission_error_mean_um: sign * transmission_error.mean * 1e6,
        transmission_error_pp_um: (transmission_error.max - transmission_error.min) * 1e6,
        load_share_at_mesh_in: Some(both(&|half| half.load_share_at_mesh_in)),
        loaded_contact_ratio: Some(both(&|half| half.loaded_contact_ratio)),
        transmission_error_harmonics_um: contact::harmonics(&contact.transmission_error_m)
            .iter()
            .map(|a| a * 1e6)
            .collect(),
        max_line_load_n_per_mm: Some(most(&|half| half.max_line_load_n_per_m) * 1e-3),
        max_line_load_interior_n_per_mm: Some(most(&|half| half.max_line_load_interior_n_per_m) * 1e-3),
        max_contact_pressure_mpa: Some(most(&|half| half.max_hertz_pressure_pa) * 1e-6),
        pairs_in_contact_min: pairs().min(),
        pairs_in_contact_max: pairs().max(),
        force_n: prepared.half_force_n,
        axial_force_n: PerHalf { left: loaded * contact.axial_force_n[0], right: loaded * contact.axial_force_n[1] },
        pinion_axial_shift_um: contact.axial_shift_m.iter().sum::<f64>() / contact.axial_shift_m.len() as f64 * 1e6,
        apex_sensitivity: (loaded != 0.0).then(|| apex_sensitivity(contact, prepared)),
        convergence: Some(Convergence {
            positions: left.positions.max(right.positions) as u32,
            position_error_percent: left
                .position_error
                .zip(right.position_error)
                .map(|(left, right)| 100.0 * left.max(right)),
            slices: left.slices as u32,
            slice_error_percent: 100.0 * most(&|half| half.slice_error),
        }),
        source: MeshStiffnessSource::Ltca,
        contact_force: None,
        curve: curve(left, &|i| left.transmission_error_m[i]),
        right_curve: (!contact.equal_halves).then(|| curve(right, &|i| right.transmission_error_m[i])),
    };
    let stiffness = |half: &HalfCycle| {
        let values = match ltca.law {
            StiffnessLaw::TransmissionError => {
                let force_n = half.force_bt_n.iter().sum::<f64>() / half.force_bt_n.len() as f64;
                contact::equivalent_stiffness(force_n, &half.transmission_error_m, half.stiffness.mean)
            }
            StiffnessLaw::Secant => half.secant_stiffness_n_per_m.clone(),
            StiffnessLaw::Tangent => half.stiffness_n_per_m.clone(),
        };
        Stiffness::Samples { values_n_per_m: values.into_iter().map(|k| k * plane.stiffness_factor).collect() }
    };
    let entry = |half: &HalfCycle| EntryState {
        stiffness_n_per_m: at_phase(&half.phase, &half.stiffness_n_per_m, MESH_IN_PHASE),
        load_share: half.load_share_at_mesh_in,
        deflection: Deflection::Loaded(half.entry.clone()),
    };
    MeshStage {
        summary,
        stiffness: [stiffness(left), stiffness(right)],
        stagger_included: true,
        entry: [entry(left), entry(right)],
        forces: None,
        on_shafts: None,
    }
}

/// dF/dδ of both halves along s, each over its own phase.
fn tangent_stiffness(contact: &LoadedContact, plane: &MotionPlane) -> [Stiffness; 2] {
    [&contact.halves[0], &contact.halves[1]].map(|half| {
        let values = half.stiffness_n_per_m.iter().map(|k| k * plane.stiffness_factor).collect();
        Stiffness::Samples { values_n_per_m: values }
    })
}

/// Both halves at one rotation, the axial shift u opening one by u tanβ_b and closing the other: k_L and k_R in series
/// move the load, their difference moves the common displacement.
fn apex_sensitivity(contact: &LoadedContact, prepared: &Prepared) -> ApexSensitivity {
    let [left, right] = &contact.halves;
    let tan = prepared.pair.base_helix_angle_rad.tan();
    let n = left.stiffness_n_per_m.len() as f64;
    let (mut moved, mut shifted) = (0.0, 0.0);
    for (kl, kr) in left.stiffness_n_per_m.iter().zip(&right.stiffness_n_per_m) {
        moved += 2.0 * kl * kr / (kl + kr) * tan / n;
        shifted += (kl - kr) / (kl + kr) * tan / n;
    }
    ApexSensitivity {
        load_split_percent_per_um: 100.0 * moved * 1e-6 / (2.0 * prepared.half_force_n),
        transmission_error_um_per_um: shifted,
    }
}

/// Linear interpolation of a periodic curve given at phases in [0, 1), in any rotation.
fn at_phase(phases: &[f64], values: &[f64], phase: f64) -> f64 {
    let step = 1.0 / phases.len() as f64;
    let position = (phase - phases[0]).rem_euclid(1.0) / step;
    let (index, part) = (position.floor() as usize, position.fract());
    let of = |i: usize| values[i % values.len()];
    of(index) + part * (of(index + 1) - of(index))
}

fn flank_load(half: &HalfCycle) -> FlankLoad {
    let map = &half.flank_map;
    let columns = map.face_m.len().max(1);
    FlankLoad {
        face_mm: map.face_m.iter().map(|y| y * 1e3).collect(),
        roll_mm: map.roll_m.iter().map(|x| x * 1e3).collect(),
        line_load_n_per_mm: map
            .line_load_n_per_m
            .chunks(columns)
            .map(|row| row.iter().map(|w| w * 1e-3).collect())
            .collect(),
    }
}

fn iso6336(prepared: &Prepared, plane: &MotionPlane) -> Result<MeshStage, SolveError> {
    let pair = &prepared.pair;
    let tangential_n = prepared.contact_torque_nm.abs() / 2.0 / pair.pinion.reference_radius_m;
    let method = MethodB::new(pair, &Blank::Solid, tangential_n)
        .map_err(|error| SolveError::failed(Stage::Mesh, "iso6336-failed", &error))?;
    let coast = (prepared.contact_torque_nm < 0.0).then(|| pair.coast());
    let curve = |phase: f64| match &coast {
        None => method.at_n_per_m(pair, foot_m(pair, phase)),
        Some(coast) => method.at_n_per_m(coast, foot_m(coast, pair.coast_phase(phase))),
    };
    let mut stage = closed_form(MeshStiffnessSource::Iso6336, prepared, curve);
    let samples = stage.summary.curve.stiffness_n_per_um.iter().map(|k| k * 1e6 * plane.stiffness_factor).collect();
    let stiffness = Stiffness::Samples { values_n_per_m: samples };
    stage.stiffness = [stiffness.clone(), stiffness];
    Ok(stage)
}

/// Position x0 of pair 0's line at a phase: at phase 0 it stands at the start of contact at the mesh-in end.
fn foot_m(pair: &Pair, phase: f64) -> f64 {
    pair.path_start_m - pair.spec.face_width_m * pair.base_helix_angle_rad.tan() + phase * pair.base_pitch_m
}

/// A stage from a stiffness curve k_bt(phase) alone: deflection F/k; the entering pair's share by the length of its
/// line of contact (uniform line load).
fn closed_form(source: MeshStiffnessSource, prepared: &Prepared, curve: impl Fn(f64) -> f64) -> MeshStage {
    let force_n = prepared.half_force_n;
    let phase: Vec<f64> = (0..CLOSED_FORM_POSITIONS).map(|i| i as f64 / CLOSED_FORM_POSITIONS as f64).collect();
    let stiffness: Vec<f64> = phase.iter().map(|&phase| curve(phase)).collect();
    let error: Vec<f64> = stiffness.iter().map(|k| force_n / k).collect();
    let (k, e) = (contact::CurveStatistics::of(&stiffness), contact::CurveStatistics::of(&error));
    let axial = force_n * prepared.pair.base_helix_angle_rad.tan();
    let lines = prepared.pair.contact_lines(foot_m(&prepared.pair, MESH_IN_PHASE));
    let total: f64 = lines.iter().map(herringbone_physics::gear::ContactLine::width_m).sum();
    let entering: f64 =
        lines.iter().filter(|line| line.pair == 0).map(herringbone_physics::gear::ContactLine::width_m).sum();
    let entry = EntryState {
        stiffness_n_per_m: curve(MESH_IN_PHASE),
        load_share: entering / total,
        deflection: Deflection::Constant(force_n / curve(0.0)),
    };
    let summary = Mesh {
        stiffness_mean_n_per_um: k.mean * 1e-6,
        stiffness_min_n_per_um: k.min * 1e-6,
        stiffness_max_n_per_um: k.max * 1e-6,
        secant_stiffness_mean_n_per_um: k.mean * 1e-6,
        transmission_error_mean_um: e.mean * 1e6,
        transmission_error_pp_um: (e.max - e.min) * 1e6,
        load_share_at_mesh_in: Some(entry.load_share),
        transmission_error_harmonics_um: contact::harmonics(&error).iter().map(|a| a * 1e6).collect(),
        force_n,
        axial_force_n: PerHalf { left: axial, right: axial },
        source,
        curve: MeshCurve {
            phase,
            stiffness_n_per_um: stiffness.iter().map(|k| k * 1e-6).collect(),
            transmission_error_um: error.iter().map(|e| e * 1e6).collect(),
            ..MeshCurve::default()
        },
        ..Mesh::default()
    };
    MeshStage {
        summary,
        stiffness: [Stiffness::Constant { mean_n_per_m: k.mean }, Stiffness::Constant { mean_n_per_m: k.mean }],
        stagger_included: false,
        entry: [entry.clone(), entry],
        forces: None,
        on_shafts: None,
    }
}
