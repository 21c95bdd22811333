//! Conversion of a document to physics in SI: the pair, its inertias and its operating point, with their feasibility.

use super::recent::Recent;
use super::{bounds, gear_findings, shafts, supports};
use crate::DocumentError;
use crate::document::{self as doc, JobDocument, PressureAnglePlane};
use crate::result::{GearGeometry, Geometry, SupportsResult};
use crate::warning::Warning;
use herringbone_physics::gear::{self, Pair, PairSpec};
use herringbone_physics::{compliance, contact};
use std::sync::Arc;

/// Default bore as a fraction of the reference diameter, where none is given.
pub(super) const DEFAULT_BORE_FRACTION: f64 = 0.4;

/// A document with a feasible pair: geometry, inertias and operating point in SI.
#[derive(Debug, Clone)]
pub(crate) struct Prepared {
    pub pair: Pair,
    pub warnings: Vec<Warning>,
    /// Whole-gear masses and moments of inertia (both halves), pinion and gear.
    pub mass_kg: [f64; 2],
    pub inertia_kg_m2: [f64; 2],
    /// Supports and couplings of the equations of motion.
    pub supports: SupportsResult,
    pub mesh_frequency_hz: f64,
    pub pinion_speed_rad_s: f64,
    /// Base-tangent force of one half, T/2 / r_b1; negative on the coast flanks.
    pub half_force_n: f64,
    /// Torque for which the contact is solved: that of the document, or a light one where it is zero.
    pub contact_torque_nm: f64,
}

/// Line load for which the contact is solved where the torque is zero, N/m of face width: 1 N/mm, about a hundredth of
/// a micrometre to a tenth of deflection.
const LIGHT_LINE_LOAD_N_PER_M: f64 = 1e3;

/// Derives all quantities of the pair that are known without solving.
///
/// # Errors
/// [`DocumentError::Invalid`] with every infeasibility of the pair, or of its shafts.
pub(crate) fn prepare(document: &JobDocument) -> Result<Prepared, DocumentError> {
    prepare_with(document, &Pairs::default())
}

/// Pairs by their specification, with their warnings.
pub(super) type Pairs = Recent<PairSpec, (Pair, Vec<gear::Warning>)>;

/// As [`prepare`], with the pairs that other points of the job have.
///
/// # Errors
/// As [`prepare`].
pub(super) fn prepare_with(document: &JobDocument, pairs: &Pairs) -> Result<Prepared, DocumentError> {
    let mut warnings = Vec::new();
    let spec = pair_spec(document, &mut warnings);
    let found = match pairs.get(&spec) {
        Some(found) => found,
        None => {
            let found = Pair::new(&spec)
                .map_err(|reasons| DocumentError::Invalid(reasons.iter().map(gear_findings::violation).collect()))?;
            let found = Arc::new(found);
            pairs.put(spec, found.clone());
            found
        }
    };
    let (pair, pair_warnings) = (found.0.clone(), &found.1);
    warnings.extend(pair_warnings.iter().map(gear_findings::warning));
    warnings.extend(held_elsewhere(document, &pair));
    warnings.extend(short_face(document, &pair));
    let supports = supports::used(&document.design.supports, &pair);
    warnings.extend(supports::assumed(document, &supports));
    let collisions = shafts::violations(document, &pair);
    if !collisions.is_empty() {
        return Err(DocumentError::Invalid(collisions));
    }
    warnings.extend(shafts::warnings(document));
    let design = &document.design;
    let [pinion_disc, gear_disc] = [&pair.pinion, &pair.gear].map(|member| (member.mass_kg(), member.inertia_kg_m2()));
    let torque_nm = document.operation.pinion_torque_nm;
    let mut contact_torque_nm = torque_nm;
    if torque_nm == 0.0 && !matches!(document.model.mesh_stiffness, doc::MeshStiffness::Given(_)) {
        contact_torque_nm = 2.0 * LIGHT_LINE_LOAD_N_PER_M * pair.spec.face_width_m * pair.pinion.base_radius_m;
        warnings.push(Warning {
            code: "no-load".to_owned(),
            pointer: "/operation/pinion_torque_nm".to_owned(),
            detail: format!(
                "is 0 N m: nothing is loaded and the gears are at rest between their flanks; the mesh is that of a light load of {contact_torque_nm:.3} N m, assumed ({} N/mm of face width)",
                LIGHT_LINE_LOAD_N_PER_M * 1e-3
            ),
        });
    }
    let speed_rad_s = document.operation.pinion_speed_rpm * std::f64::consts::TAU / 60.0;
    let prepared = Prepared {
        mass_kg: [design.pinion.mass_kg.unwrap_or(pinion_disc.0), design.gear.mass_kg.unwrap_or(gear_disc.0)],
        inertia_kg_m2: [
            design.pinion.inertia_kg_m2.unwrap_or(pinion_disc.1),
            design.gear.inertia_kg_m2.unwrap_or(gear_disc.1),
        ],
        supports,
        mesh_frequency_hz: document.operation.pinion_speed_rpm / 60.0 * f64::from(pair.pinion.teeth),
        pinion_speed_rad_s: speed_rad_s,
        half_force_n: torque_nm / 2.0 / pair.pinion.base_radius_m,
        contact_torque_nm,
        pair,
        warnings,
    };
    let bounds = bounds::of_document(document, &prepared, [pinion_disc, gear_disc]);
    Ok(Prepared { warnings: prepared.warnings.iter().cloned().chain(bounds).collect(), ..prepared })
}

/// Why the pair of a document cannot exist; nothing of one that does.
pub(super) fn infeasibilities(document: &JobDocument) -> Vec<gear::Infeasibility> {
    Pair::new(&pair_spec(document, &mut Vec::new())).err().unwrap_or_default()
}

fn pair_spec(document: &JobDocument, warnings: &mut Vec<Warning>) -> PairSpec {
    let design = &document.design;
    let helix_angle_rad = design.helix_angle_deg.to_radians();
    let pressure_angle_rad = design.pressure_angle_deg.to_radians();
    // The common part of both face widths is in contact; the middles of the halves are those of the design.
    let common_mm = [&design.pinion, &design.gear]
        .map(|gear| gear.face_width_mm.unwrap_or(design.face_width_mm))
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    let gap_mm = if common_mm == design.face_width_mm {
        design.gap_width_mm
    } else {
        design.gap_width_mm + design.face_width_mm - common_mm
    };
    PairSpec {
        normal_module_m: design.normal_module_mm * 1e-3,
        normal_pressure_angle_rad: match design.pressure_angle_plane {
            PressureAnglePlane::Normal => pressure_angle_rad,
            PressureAnglePlane::Transverse => (pressure_angle_rad.tan() * helix_angle_rad.cos()).atan(),
        },
        helix_angle_rad,
        face_width_m: common_mm * 1e-3,
        gap_width_m: gap_mm * 1e-3,
        center_distance_m: design.center_distance_mm.map(|mm| mm * 1e-3),
        material: material(&design.material),
        rotation: match document.operation.rotation {
            doc::RotationInput::ApexLeading => gear::Rotation::ApexLeading,
            doc::RotationInput::ApexTrailing => gear::Rotation::ApexTrailing,
        },
        pinion: gear_spec(design, &design.pinion, "/design/pinion", warnings),
        gear: gear_spec(design, &design.gear, "/design/gear", warnings),
        assembly: gear::Assembly {
            center_distance_error_m: design.assembly.center_distance_error_um * 1e-6,
            in_plane_misalignment_m: design.assembly.in_plane_misalignment_um * 1e-6,
            out_of_plane_misalignment_m: design.assembly.out_of_plane_misalignment_um * 1e-6,
            apex_offset_m: design.assembly.apex_offset_um * 1e-6,
        },
    }
}

/// Bore of a gear for which none is given.
pub(super) fn default_bore_mm(design: &doc::DesignInput, gear: &doc::GearInput) -> f64 {
    let reference_mm = design.normal_module_mm * f64::from(gear.teeth) / design.helix_angle_deg.to_radians().cos();
    DEFAULT_BORE_FRACTION * reference_mm
}

fn gear_spec(
    design: &doc::DesignInput,
    gear: &doc::GearInput,
    pointer: &str,
    warnings: &mut Vec<Warning>,
) -> gear::GearSpec {
    let bore_diameter_mm = gear.bore_diameter_mm.unwrap_or_else(|| {
        let assumed_mm = default_bore_mm(design, gear);
        warnings.push(Warning {
            code: "bore-assumed".to_owned(),
            pointer: format!("{pointer}/bore_diameter_mm"),
            detail: format!(
                "not given: {assumed_mm:.1} mm assumed ({DEFAULT_BORE_FRACTION} of the reference diameter)"
            ),
        });
        assumed_mm
    });
    let flanks = |both: &doc::FlankInput, [left, right]: [&Option<doc::FlankInput>; 2]| {
        [left.as_ref().unwrap_or(both), right.as_ref().unwrap_or(both)].map(flank)
    };
    gear::GearSpec {
        teeth: gear.teeth,
        profile_shift: gear.profile_shift,
        addendum: gear.addendum,
        dedendum: gear.dedendum,
        fillet_radius: gear.fillet_radius,
        tip_alteration: gear.tip_alteration,
        bore_radius_m: bore_diameter_mm * 0.5e-3,
        material: gear.material.as_ref().map(material),
        face_width_m: Some(gear.face_width_mm.unwrap_or(design.face_width_mm) * 1e-3),
        flanks: flanks(&gear.flank, [&gear.left, &gear.right]),
        coast_flanks: gear.coast.as_ref().map(|coast| flanks(&coast.flank, [&coast.left, &coast.right])),
    }
}

fn material(material: &doc::MaterialInput) -> gear::Material {
    gear::Material {
        youngs_modulus_pa: material.youngs_modulus_gpa * 1e9,
        poissons_ratio: material.poissons_ratio,
        density_kg_m3: material.density_kg_m3,
    }
}

fn flank(flank: &doc::FlankInput) -> gear::FlankModification {
    gear::FlankModification {
        tip_relief: gear::TipRelief {
            amount_m: flank.tip_relief.amount_um * 1e-6,
            length_m: flank.tip_relief.length_mm * 1e-3,
            shape: match flank.tip_relief.shape {
                doc::ReliefShapeInput::Linear => gear::ReliefShape::Linear,
                doc::ReliefShapeInput::Parabolic => gear::ReliefShape::Parabolic,
            },
        },
        lead_crowning_m: flank.lead_crowning_um * 1e-6,
        helix_slope_m: flank.helix_slope_um * 1e-6,
        end_relief: gear::EndRelief {
            amount_m: flank.end_relief.amount_um * 1e-6,
            length_m: flank.end_relief.length_mm * 1e-3,
        },
    }
}

/// Warning of a bore that is too small against the root circle to be the fixed surface of the body.
fn held_elsewhere(document: &JobDocument, pair: &Pair) -> Vec<Warning> {
    let doc::MeshStiffness::Ltca(doc::Ltca { body: doc::BodyInput::Bore, .. }) = &document.model.mesh_stiffness else {
        return Vec::new();
    };
    [("pinion", &pair.pinion), ("gear", &pair.gear)]
        .into_iter()
        .filter_map(|(name, member)| {
            let held_m = compliance::hold_radius_m(member, compliance::BodyHold::Bore, pair.spec.normal_module_m);
            (held_m > member.bore_radius_m * (1.0 + 1e-9)).then(|| Warning {
                code: "held-above-bore".to_owned(),
                pointer: format!("/design/{name}/bore_diameter_mm"),
                detail: format!(
                    "is {:.1} mm; a bore this small against the root circle counts as shaft, and the body is held at {:.1} mm diameter",
                    member.bore_radius_m * 2e3,
                    held_m * 2e3
                ),
            })
        })
        .collect()
}

/// Warning of the known error of the analytic compliance on short faces.
fn short_face(document: &JobDocument, pair: &Pair) -> Option<Warning> {
    let doc::MeshStiffness::Ltca(doc::Ltca { fidelity: doc::Fidelity::Analytic, .. }) = &document.model.mesh_stiffness
    else {
        return None;
    };
    let excess = contact::stiffness_excess(pair);
    let modules = pair.spec.face_width_m / pair.spec.normal_module_m;
    (excess.abs() > contact::SHORT_FACE_NOTICE).then(|| Warning {
        code: "short-face".to_owned(),
        pointer: "/design/face_width_mm".to_owned(),
        detail: format!(
            "is {:.2} mm, {modules:.2} normal modules, at a helix angle of {:.1}°: the analytic mesh stiffness is about {:.0} % too {} against finite elements, more than {:.0} %; fidelity `fe` does not have this error",
            pair.spec.face_width_m * 1e3,
            pair.spec.helix_angle_rad.to_degrees(),
            excess.abs() * 100.0,
            if excess > 0.0 { "stiff" } else { "soft" },
            contact::SHORT_FACE_NOTICE * 100.0
        ),
    })
}

/// The geometry block of the result.
pub(crate) fn geometry(prepared: &Prepared) -> Geometry {
    let pair = &prepared.pair;
    let member = |member: &gear::Member, index: usize| GearGeometry {
        reference_diameter_mm: member.reference_radius_m * 2e3,
        base_diameter_mm: member.base_radius_m * 2e3,
        tip_diameter_mm: member.tip_radius_m * 2e3,
        root_diameter_mm: member.root_radius_m * 2e3,
        root_form_diameter_mm: member.root_form_radius_m * 2e3,
        tip_thickness_normal_mm: member.normal_thickness_m(member.tip_radius_m) * 1e3,
        bore_diameter_mm: member.bore_radius_m * 2e3,
        face_width_mm: Some(member.face_width_m * 1e3),
        mass_kg: prepared.mass_kg[index],
        inertia_kg_m2: prepared.inertia_kg_m2[index],
    };
    Geometry {
        transverse_contact_ratio: pair.transverse_contact_ratio,
        overlap_ratio: pair.overlap_ratio,
        total_contact_ratio: pair.transverse_contact_ratio + pair.overlap_ratio,
        working_pressure_angle_deg: pair.working_pressure_angle_rad.to_degrees(),
        center_distance_mm: pair.center_distance_m * 1e3,
        mesh_frequency_hz: prepared.mesh_frequency_hz,
        transverse_pressure_angle_deg: pair.transverse_pressure_angle_rad.to_degrees(),
        normal_pressure_angle_deg: pair.spec.normal_pressure_angle_rad.to_degrees(),
        base_helix_angle_deg: pair.base_helix_angle_rad.to_degrees(),
        transverse_base_pitch_mm: pair.base_pitch_m * 1e3,
        path_of_contact_mm: (pair.path_end_m - pair.path_start_m) * 1e3,
        face_width_mm: Some(pair.spec.face_width_m * 1e3),
        gap_width_mm: Some(pair.spec.gap_width_m * 1e3),
        pinion: member(&pair.pinion, 0),
        gear: member(&pair.gear, 1),
    }
}
