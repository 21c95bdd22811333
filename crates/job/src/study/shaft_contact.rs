//! The loaded contact of both halves on their shafts, and what a result says of it.

use super::compliance;
use super::hash::{mesh_hash, shaft_flexibility_hash};
use super::mesh::{ContactCase, MeshMemo, contact_failed};
use super::shafts;
use super::{SolveContext, SolveError, Stage};
use crate::document::{Hand, JobDocument, ShaftInput};
use crate::result::{
    AxialFloat, AxialFrictionResult, AxialLimit, BearingReaction, CouplingTransmissionError, FaceLoadAtTorque,
    HelixModificationResult, Iso6336FaceLoad, PerHalf, ReusedStage, ShaftDeflection, ShaftHalfResult,
    ShaftMemberResult, ShaftsResult,
};
use herringbone_physics::compliance::Compliance;
use herringbone_physics::contact::{
    self, AxialFreedom, ContactError, ContactShafts, CurveStatistics, HelixModification, LoadOnShafts,
    LoadedContactOnShafts, MeshFrame, evening_modification, load_on_shafts, sense_of_rotation, solve_on_shafts,
    with_helix_modification,
};
use herringbone_physics::gear::Pair;
use herringbone_physics::iso6336::{Blank, MethodB, PinionArrangement, PinionOnShaft};
use herringbone_physics::shafts::{ShaftError, ShaftTrain};
use herringbone_physics::watch::Watch;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::Arc;

/// Both shafts and how the pair stands on them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct MountedTrain {
    pub train: ShaftTrain,
    /// Sense of rotation of the pinion about z.
    pub sense: f64,
    left_half_is_left_hand: bool,
}

impl MountedTrain {
    /// The shafts of a document, if it has any.
    pub(super) fn of(document: &JobDocument, pair: &Pair) -> Option<Self> {
        let train = shafts::train(document)?;
        let hand = document.design.pinion.left_half_hand;
        let sense = sense_of_rotation(physical(hand), pair.spec.rotation);
        Some(Self { train, sense, left_half_is_left_hand: hand == Hand::Left })
    }

    fn left_half(&self) -> contact::Hand {
        if self.left_half_is_left_hand { contact::Hand::Left } else { contact::Hand::Right }
    }

    /// The frame of the flanks that carry a torque of this sign.
    pub(super) fn frame(&self, pair: &Pair, coast: bool) -> MeshFrame {
        if coast {
            MeshFrame::new(&pair.coast(), self.sense, self.left_half(), true)
        } else {
            MeshFrame::new(pair, self.sense, self.left_half(), false)
        }
    }
}

fn physical(hand: Hand) -> contact::Hand {
    match hand {
        Hand::Left => contact::Hand::Left,
        Hand::Right => contact::Hand::Right,
    }
}

/// The loaded contact on the shafts with what it was solved with.
#[derive(Debug, Clone)]
pub(super) struct ShaftContact {
    pub shafts: Arc<ContactShafts>,
    pub loaded: Arc<LoadedContactOnShafts>,
}

pub(super) fn shafts_failed(stage: Stage, error: ShaftError) -> SolveError {
    match error {
        ShaftError::Canceled(canceled) => canceled.into(),
        other => SolveError::failed(stage, "shafts-failed", &other),
    }
}

/// The flexibility of the shafts between the stations of the compliance, from the job's memo or computed.
fn contact_shafts(
    case: &ContactCase,
    mounted: &MountedTrain,
    pair: &Pair,
    compliance: &Compliance,
    memo: &MeshMemo,
) -> Result<Arc<ContactShafts>, SolveError> {
    let coast = case.torque_nm < 0.0;
    let key = shaft_flexibility_hash(case, coast);
    if let Some(shafts) = memo.shafts.get(&key) {
        return Ok(shafts);
    }
    let shafts = ContactShafts::new(&mounted.train, mounted.frame(pair, coast), compliance);
    let shafts = Arc::new(shafts.map_err(|error| shafts_failed(Stage::Mesh, error))?);
    memo.shafts.put(key, shafts.clone());
    Ok(shafts)
}

/// The contact of `case` on its shafts, from the job's memo or the store, else solved.
pub(super) fn find(
    case: &ContactCase,
    mounted: &MountedTrain,
    pair: &Pair,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(ShaftContact, Vec<ReusedStage>), SolveError> {
    let found = compliance::find(case, pair, context, &memo.compliances)?;
    let shafts = contact_shafts(case, mounted, pair, &found.compliance, memo)?;
    let key = mesh_hash(case);
    if let Some(loaded) = memo.shaft_contacts.get(&key) {
        return Ok((ShaftContact { shafts, loaded }, vec![ReusedStage::Mesh]));
    }
    let stored =
        context.stages.load(&key).and_then(|bytes| serde_json::from_slice::<LoadedContactOnShafts>(&bytes).ok());
    let (loaded, reused) = match stored {
        Some(loaded) => (loaded, vec![ReusedStage::Mesh]),
        None => {
            let progress = |fraction: f64| (context.progress)(Stage::Mesh, found.done + (1.0 - found.done) * fraction);
            let watch = Watch::new(&progress, context.canceled);
            let loads = (case.torque_nm.abs(), case.half_stagger, 0.0);
            let with = (&*found.compliance, &case.settings);
            let loaded =
                solve_on_shafts(pair, &shafts, loads, case.torque_nm < 0.0, with, watch).map_err(contact_failed)?;
            context.stages.save(&key, Stage::Mesh, &serde_json::to_vec(&loaded).unwrap_or_default());
            (loaded, if found.elements_reused { vec![ReusedStage::FiniteElements] } else { Vec::new() })
        }
    };
    let loaded = Arc::new(loaded);
    memo.shaft_contacts.put(key, loaded.clone());
    Ok((ShaftContact { shafts, loaded }, reused))
}

/// Torques, as parts of the document's, at which the face load factors are given beside it.
const TORQUE_PARTS: [f64; 5] = [0.25, 0.5, 0.75, 1.25, 1.5];
/// Positions over the mesh period of the contacts beside the document's own.
const POSITIONS: usize = 12;

/// The parts of the result that need further contacts: proposed helix modification, other torques, limits of the
/// coupling's friction.
///
/// # Errors
/// [`SolveError`].
pub(super) fn complete(
    document: &JobDocument,
    case: &ContactCase,
    pair: &Pair,
    (contact, result): (&ShaftContact, &mut ShaftsResult),
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(), SolveError> {
    let compliance = compliance::find(case, pair, context, &memo.compliances)?.compliance;
    let mut settings = case.settings;
    settings.positions = Some(settings.positions.unwrap_or(POSITIONS).min(POSITIONS));
    let coast = case.torque_nm < 0.0;
    let watch = || Watch::new(&|_| {}, context.canceled);
    let solve = |pair: &Pair, torque_nm: f64, axial_n: f64| {
        let loads = (torque_nm, case.half_stagger, axial_n);
        load_on_shafts(pair, &contact.shafts, loads, coast, (&compliance, &settings), watch())
    };
    let torque_nm = case.torque_nm.abs();
    let loads = (torque_nm, case.half_stagger, 0.0);
    let unmodified = &contact.loaded.load;
    let (proposed, _) =
        evening_modification(pair, &contact.shafts, loads, coast, unmodified, (&compliance, &settings), watch())
            .map_err(contact_failed)?;
    let modified_pair = with_helix_modification(pair, &proposed, coast);
    // At the document's torque with all positions, as for its own flanks.
    let modified =
        load_on_shafts(&modified_pair, &contact.shafts, loads, coast, (&compliance, &case.settings), watch())
            .map_err(contact_failed)?;
    let factors = |loaded: &LoadOnShafts| PerHalf {
        left: loaded.halves[0].face.k_h_beta_5mm(),
        right: loaded.halves[1].face.k_h_beta_5mm(),
    };
    let others: Result<Vec<FaceLoadAtTorque>, ContactError> = TORQUE_PARTS
        .par_iter()
        .map(|part| {
            Ok(FaceLoadAtTorque {
                pinion_torque_nm: part * case.torque_nm,
                k_h_beta_5mm: factors(&solve(pair, part * torque_nm, 0.0)?),
                k_h_beta_5mm_modified: factors(&solve(&modified_pair, part * torque_nm, 0.0)?),
            })
        })
        .collect();
    let mut at_torques = others.map_err(contact_failed)?;
    at_torques.push(FaceLoadAtTorque {
        pinion_torque_nm: case.torque_nm,
        k_h_beta_5mm: factors(unmodified),
        k_h_beta_5mm_modified: factors(&modified),
    });
    at_torques.sort_by(|a, b| a.pinion_torque_nm.abs().total_cmp(&b.pinion_torque_nm.abs()));
    result.at_torques = at_torques;
    for (h, half) in [&mut result.left, &mut result.right].into_iter().enumerate() {
        let HelixModification { slope_m, crowning_m } = proposed[h];
        half.helix_modification = Some(HelixModificationResult {
            slope_um: slope_m * 1e6,
            crowning_um: crowning_m * 1e6,
            k_h_beta: modified.halves[h].face.k_h_beta(),
            k_h_beta_5mm: modified.halves[h].face.k_h_beta_5mm(),
        });
    }
    result.axial_friction = friction(document, contact, |axial_n| solve(pair, torque_nm, axial_n))?;
    Ok(())
}

/// The limits of the friction in the coupling of the member that floats.
fn friction(
    document: &JobDocument,
    contact: &ShaftContact,
    solve: impl Fn(f64) -> Result<LoadOnShafts, ContactError>,
) -> Result<Option<AxialFrictionResult>, SolveError> {
    let Some(resolved) = document.design.resolved_shafts() else { return Ok(None) };
    let force_n = match contact.shafts.freedom() {
        AxialFreedom::None => 0.0,
        AxialFreedom::Pinion => resolved.pinion.coupling.axial_friction_n,
        AxialFreedom::Gear => resolved.gear.coupling.axial_friction_n,
    };
    if force_n <= 0.0 {
        return Ok(None);
    }
    let limit = |axial_n: f64| -> Result<AxialLimit, SolveError> {
        let loaded = solve(axial_n).map_err(contact_failed)?;
        let of = |value: &dyn Fn(usize) -> f64| PerHalf { left: value(0), right: value(1) };
        Ok(AxialLimit {
            share: of(&|h| loaded.halves[h].share),
            k_gamma: k_gamma(&loaded),
            pinion_axial_float_um: loaded.pinion_float_m * 1e6,
            k_h_beta: of(&|h| loaded.halves[h].face.k_h_beta()),
        })
    };
    Ok(Some(AxialFrictionResult { force_n, pushed_left: limit(-force_n)?, pushed_right: limit(force_n)? }))
}

/// Amplitudes of the first three harmonics, µm.
fn harmonics_um(values: &[f64]) -> Vec<f64> {
    contact::harmonics(values).into_iter().take(3).map(|amplitude| amplitude * 1e6).collect()
}

fn k_gamma(loaded: &LoadOnShafts) -> f64 {
    2.0 * loaded.halves.iter().map(|half| half.share).fold(0.0, f64::max)
}

/// The block `shafts` of a result, apart from what [`complete`] adds.
pub(super) fn result(document: &JobDocument, pair: &Pair, contact: &ShaftContact) -> ShaftsResult {
    let loaded = &contact.loaded;
    let between_couplings = CurveStatistics::of(&loaded.between_couplings_m);
    let float = CurveStatistics::of(&loaded.pinion_float_m);
    let resolved = document.design.resolved_shafts();
    let half = |h: usize| half_result(loaded, h, pair);
    let member = |member: usize, input: Option<&ShaftInput>| member_result(contact, member, input);
    ShaftsResult {
        line_load_mean_n_per_mm: loaded.load.line_load_n_per_m * 1e-3,
        contact_line_length_mean_mm: loaded.load.line_length_m * 1e3,
        transmission_error: CouplingTransmissionError {
            between_couplings_mean_um: between_couplings.mean * 1e6,
            between_couplings_pp_um: (between_couplings.max - between_couplings.min) * 1e6,
            harmonics_um: harmonics_um(&loaded.between_couplings_m),
        },
        pinion_axial_float_um: AxialFloat { mean: float.mean * 1e6, pp: (float.max - float.min) * 1e6 },
        open_fraction: loaded.load.open_fraction,
        k_gamma: k_gamma(&loaded.load),
        left: half(0),
        right: half(1),
        pinion: member(0, resolved.as_ref().map(|shafts| &shafts.pinion)),
        gear: member(1, resolved.as_ref().map(|shafts| &shafts.gear)),
        iso6336: resolved.as_ref().and_then(|shafts| standard_estimate(document, pair, &shafts.pinion)),
        ..ShaftsResult::default()
    }
}

fn half_result(loaded: &LoadedContactOnShafts, h: usize, pair: &Pair) -> ShaftHalfResult {
    let half = &loaded.load.halves[h];
    let approach = &loaded.contact.halves[h].transmission_error_m;
    let face = &half.face;
    let per_mm = |values: &[f64]| values.iter().map(|load| load * 1e-3).collect::<Vec<_>>();
    ShaftHalfResult {
        normal_force_mean_n: half.normal_force_n[0],
        normal_force_pp_n: half.normal_force_n[1],
        share: half.share,
        axial_force_on_pinion_n: half.axial_force_on_pinion_n,
        base_tangent_force_n: half.normal_force_n[0] * pair.base_helix_angle_rad.cos(),
        k_h_beta: face.k_h_beta(),
        k_h_beta_5mm: face.k_h_beta_5mm(),
        line_load_inner_end_n_per_mm: face.ends_n_per_m[0] * 1e-3,
        line_load_outer_end_n_per_mm: face.ends_n_per_m[1] * 1e-3,
        line_load_peak_over_mean: half.peak_over_mean,
        load_centroid_from_inner_end_mm: half.centroid_from_inner_m * 1e3,
        approach_mid_face_mean_um: CurveStatistics::of(approach).mean * 1e6,
        approach_mid_face_harmonics_um: harmonics_um(approach),
        station_from_inner_end_mm: face.piece_m.iter().map(|place| place * 1e3).collect(),
        line_load_n_per_mm: face.piece_m.iter().map(|&place| face.at_n_per_m(place) * 1e-3).collect(),
        line_load_5mm_means_n_per_mm: per_mm(&face.piece_line_load_n_per_m),
        helix_modification: None,
    }
}

/// Names of the face ends, in the order of the lists over them.
const FACE_ENDS: [&str; 4] = ["left_outer", "left_inner", "right_inner", "right_outer"];

fn member_result(contact: &ShaftContact, member: usize, input: Option<&ShaftInput>) -> ShaftMemberResult {
    let loaded = &contact.loaded;
    let state = &loaded.shafts[member];
    let of_halves = |value: &dyn Fn(usize) -> f64| PerHalf { left: value(0), right: value(1) };
    let at_ends = |c: usize| state.face_ends.iter().map(|section| section[c] * 1e6).collect::<Vec<_>>();
    let along = |c: usize| state.shape.iter().map(|section| section[c] * 1e6).collect::<Vec<_>>();
    let gear_position_mm = input.map_or(0.0, |shaft| shaft.gear_position_mm);
    let bearings = input.map_or(&[][..], |shaft| &shaft.bearings);
    let floating = [AxialFreedom::Pinion, AxialFreedom::Gear][member];
    ShaftMemberResult {
        k_h_beta: of_halves(&|h| loaded.load.halves[h].face.k_h_beta()),
        k_h_beta_5mm: of_halves(&|h| loaded.load.halves[h].face.k_h_beta_5mm()),
        floats_axially: contact.shafts.freedom() == floating,
        face_ends: FACE_ENDS.map(str::to_owned).to_vec(),
        x_um: at_ends(0),
        y_um: at_ends(1),
        z_um: at_ends(2),
        tilt_x_urad: at_ends(3),
        tilt_y_urad: at_ends(4),
        twist_from_coupling_urad: at_ends(5),
        bearings: bearings
            .iter()
            .zip(&state.bearings)
            .map(|(bearing, reaction)| BearingReaction {
                position_mm: bearing.position_mm,
                force_on_shaft_n: [reaction[0], reaction[1], reaction[2]],
                moment_on_shaft_nm: [reaction[3], reaction[4]],
            })
            .collect(),
        deflection: ShaftDeflection {
            station_mm: state.shape_at_m.iter().map(|place| place * 1e3 + gear_position_mm).collect(),
            x_um: along(0),
            y_um: along(1),
            z_um: along(2),
            twist_from_coupling_urad: along(5),
        },
    }
}

/// The estimate of ISO 6336-1 for the pinion's deformation, where its arrangement is one of the standard's.
fn standard_estimate(document: &JobDocument, pair: &Pair, shaft: &ShaftInput) -> Option<Iso6336FaceLoad> {
    let radial = shaft.bearings.iter().filter(|bearing| bearing.holds_radially() != [false; 2]);
    let positions: Vec<f64> = radial.map(|bearing| bearing.position_mm).collect();
    let left_mm = positions.iter().copied().fold(f64::INFINITY, f64::min);
    let right_mm = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let gear_mm = shaft.gear_position_mm;
    let from_left = shaft.coupling.position_mm < gear_mm;
    let offset_mm = gear_mm - 0.5 * (left_mm + right_mm);
    let between = gear_mm > left_mm && gear_mm < right_mm;
    let arrangement = if between {
        let towards = offset_mm == 0.0 || (offset_mm < 0.0) == from_left;
        if towards { PinionArrangement::TowardsTorque } else { PinionArrangement::AwayFromTorque }
    } else if (gear_mm > right_mm) == from_left && right_mm > left_mm {
        PinionArrangement::Overhung
    } else {
        return None;
    };
    // s: from the middle of the span, of an overhung pinion from the nearer bearing.
    let offset_mm = match arrangement {
        PinionArrangement::Overhung => (gear_mm - right_mm).max(left_mm - gear_mm),
        PinionArrangement::TowardsTorque | PinionArrangement::AwayFromTorque => offset_mm.abs(),
    };
    let half_mm = 0.5 * document.design.gap_width_mm + document.design.face_width_mm;
    let diameter_mm = bending_diameter_mm(shaft, (left_mm, right_mm), (gear_mm - half_mm, gear_mm + half_mm))?;
    let pinion = PinionOnShaft {
        reference_diameter_m: 2.0 * pair.pinion.reference_radius_m,
        shaft_diameter_m: diameter_mm * 1e-3,
        helix_width_m: pair.spec.face_width_m,
        bearing_span_m: (right_mm - left_mm) * 1e-3,
        offset_m: offset_mm * 1e-3,
        arrangement,
    };
    let torque_nm = document.operation.pinion_torque_nm.abs();
    let tangential_n = torque_nm / pair.pinion.reference_radius_m;
    let method = MethodB::new(pair, &Blank::Solid, 0.5 * tangential_n).ok()?;
    let line_load_n_per_m = tangential_n / (2.0 * pair.spec.face_width_m);
    let (word, figure) = match arrangement {
        PinionArrangement::TowardsTorque => ("between the bearings, towards the torque", "a"),
        PinionArrangement::AwayFromTorque => ("between the bearings, away from the torque", "b"),
        PinionArrangement::Overhung => ("overhung, torque through the bearings", "c"),
    };
    Some(Iso6336FaceLoad {
        f_sh_um: pinion.equivalent_misalignment_m(line_load_n_per_m) * 1e6,
        k_h_beta: pinion.k_h_beta(line_load_n_per_m, method.face_load_mesh_n_per_m2),
        k_prime: pinion.constant(),
        half: if from_left { "left" } else { "right" }.to_owned(),
        basis: format!(
            "arrangement {figure} ({word}), l = {:.1} mm, s = {:.1} mm, d_sh = {diameter_mm:.1} mm, d_1 = {:.1} mm",
            right_mm - left_mm,
            offset_mm,
            pinion.reference_diameter_m * 1e3
        ),
    })
}

/// Diameter of the solid shaft with the mean second moment of area between the bearings, the gear body left out.
fn bending_diameter_mm(shaft: &ShaftInput, span_mm: (f64, f64), body_mm: (f64, f64)) -> Option<f64> {
    let (mut length, mut sum, mut from) = (0.0, 0.0, 0.0);
    for segment in &shaft.segments {
        let to = from + segment.length_mm;
        let within = |low: f64, high: f64| (to.min(high) - f64::max(from, low)).max(0.0);
        let part = within(span_mm.0, body_mm.0.min(span_mm.1)) + within(body_mm.1.max(span_mm.0), span_mm.1);
        length += part;
        sum += part * (segment.diameter_mm.powi(4) - segment.bore_mm.powi(4));
        from = to;
    }
    (length > 0.0).then(|| (sum / length).powf(0.25))
}
