//! Where torque enters or leaves a shaft, and the masses on it.

use super::super::model::Handle;
use super::super::pair::Pair;
use super::super::train::loads_of;
use super::outline::{Outline, sections};
use super::{Mounted, rounded};
use crate::draft::Draft;
use crate::unit::{Quantity, clean};
use serde_json::{Value, json};

/// Torsional stiffness from which on a coupling is rigid, N·m/rad.
const RIGID_NM_PER_RAD: f64 = 1e12;
/// Most further bodies of a shaft of the document.
const MAX_INERTIAS: usize = 32;

/// Writes the coupling of a shaft and its further bodies.
pub(super) fn write(pair: &Pair, draft: &mut Draft, mounted: &Mounted) {
    let (model, view) = (pair.model(), pair.view);
    let pointer = mounted.pointer("/coupling/position_mm");
    let length_mm = mounted.outline.end_mm - mounted.outline.start_mm;
    let place = |u_mm: f64| mounted.position_mm(u_mm).clamp(0.0, length_mm);
    let connection = model.connections(mounted.shaft).into_iter().find(|(connection, beyond)| {
        matches!(model.kind(*connection), "coupling") && matches!(model.kind(*beyond), "shaft" | "gear_casing")
    });
    let load = loads_of(view, mounted.shaft)
        .into_iter()
        .find(|load| view.flag(*load, "transmits_torque").unwrap_or(false) || view.has(*load, "torque_around_u_axis"));
    let by_load = load.and_then(|load| view.number(load, "u_coordinate_on_shaft", Quantity::Length));
    let by_coupling = connection.and_then(|(coupling, _)| {
        let is_inner =
            !model.related("side", mounted.shaft, "inner_part", "assembly").iter().all(|one| *one != coupling);
        let id = if is_inner { "u_coordinate_on_shaft_inner_side" } else { "u_coordinate_on_shaft_outer_side" };
        view.number(coupling, id, Quantity::Length)
    });
    let own = pair.gears(mounted.member);
    let other_gear = model.parts(mounted.shaft).into_iter().find(|part| {
        !own.contains(part)
            && matches!(model.kind(*part), "cylindrical_gear" | "bevel_gear" | "worm_wheel" | "worm_gear")
    });
    let by_gear = other_gear.and_then(|gear| view.number(gear, "u_coordinate_on_shaft", Quantity::Length));
    let found = [
        (by_load, "where the external load is"),
        (by_coupling, "where the coupling is"),
        (by_gear, "where the gear of another stage is: the torque enters or leaves there"),
    ];
    match found.into_iter().find_map(|(reading, why)| Some((reading?, why))) {
        Some((reading, why)) => draft.take(&pointer, place(reading.value), &[reading], why),
        None => {
            let (end_mm, name) = if mounted.member == 0 { (0.0, "left") } else { (length_mm, "right") };
            let why = format!("no load or coupling on the shaft in the file: the torque passes at its {name} end");
            draft.assume(&pointer, clean(end_mm), why);
        }
    }
    if let Some((coupling, beyond)) = connection {
        write_coupling(pair, draft, mounted, coupling, beyond);
    }
    write_bodies(pair, draft, mounted);
}

fn write_coupling(pair: &Pair, draft: &mut Draft, mounted: &Mounted, coupling: Handle, beyond: Handle) {
    let view = pair.view;
    if let Some(axial) =
        view.non_zero(coupling, "axial_stiffness", Quantity::LinearStiffness).filter(|one| one.value > 0.0)
    {
        let value = clean(axial.value * 1e-6);
        if value < 1e6 {
            draft.take(&mounted.pointer("/coupling/axial_n_per_um"), value, &[axial], "");
        } else {
            let amount = format!("{} {}", axial.file_value, axial.file_unit);
            draft.ignore(axial.from(), "as good as rigid: a coupling is left free along its axis", Some(amount));
        }
    }
    let torsion =
        view.non_zero(coupling, "rotational_stiffness", Quantity::AngularStiffness).filter(|one| one.value > 0.0);
    let Some(torsion) = torsion else { return };
    let value = clean(torsion.value * 1e-3);
    let (_, pieces) = sections(pair, beyond);
    let masses: f64 = pair
        .model()
        .parts(beyond)
        .into_iter()
        .filter(|part| pair.model().kind(*part) == "additional_mass")
        .filter_map(|mass| view.number(mass, "moment_of_inertia_u_axis", Quantity::Inertia))
        .map(|inertia| inertia.value)
        .sum();
    let inertia_kg_m2 = rounded(Outline::polar_inertia_kg_m2(&pieces, 7850.0) + masses);
    if value >= RIGID_NM_PER_RAD || inertia_kg_m2 < 1e-9 {
        let amount = format!("{} {}", torsion.file_value, torsion.file_unit);
        draft.ignore(torsion.from(), "rigid, or without a body beyond it", Some(amount));
        return;
    }
    draft.take(&mounted.pointer("/coupling/torsional_nm_per_rad"), value, &[torsion], "");
    let why = format!("sections and masses of {}, of steel", pair.model().label(beyond));
    draft.assume(&mounted.pointer("/coupling/inertia_kg_m2"), inertia_kg_m2, why);
}

/// Additional masses, and gears of other stages, as rigid bodies.
fn write_bodies(pair: &Pair, draft: &mut Draft, mounted: &Mounted) {
    let (model, view) = (pair.model(), pair.view);
    let own = pair.gears(mounted.member);
    let length_mm = mounted.outline.end_mm - mounted.outline.start_mm;
    let mut bodies: Vec<Value> = Vec::new();
    for part in model.parts(mounted.shaft) {
        let kind = model.kind(part);
        let is_gear = kind == "cylindrical_gear" && !own.contains(&part);
        if (kind != "additional_mass" && !is_gear) || bodies.len() == MAX_INERTIAS {
            continue;
        }
        let pointer = mounted.pointer(&format!("/inertias/{}", bodies.len()));
        let coordinate = view.number(part, "u_coordinate_on_shaft", Quantity::Length);
        let Some(coordinate) = coordinate else {
            draft.ignore(model.label(part), "has no u_coordinate_on_shaft", None);
            continue;
        };
        let position_mm = mounted.position_mm(coordinate.value).clamp(0.0, length_mm);
        if is_gear {
            let Some(body) = gear_body(pair, part, position_mm, mounted.outline.diameter_mm(coordinate.value)) else {
                continue;
            };
            draft.note_assumed(
                &pointer,
                body.clone(),
                format!(
                    "{}, a gear of another stage, as a disc of steel; its mesh is not calculated",
                    model.label(part)
                ),
            );
            bodies.push(body);
            continue;
        }
        let inertia = |id: &'static str| view.number(part, id, Quantity::Inertia).filter(|one| one.value >= 0.0);
        let mass = view.number(part, "mass_of_component", Quantity::Mass).filter(|one| one.value >= 0.0);
        let polar = inertia("moment_of_inertia_u_axis");
        let diametral = [inertia("moment_of_inertia_v_axis"), inertia("moment_of_inertia_w_axis")];
        let across: Vec<f64> = diametral.iter().flatten().map(|one| one.value).collect();
        let polar_value = polar.as_ref().map_or(0.0, |one| one.value);
        let mean = across.iter().sum::<f64>() / across.len().max(1) as f64;
        let body = json!({
            "position_mm": position_mm,
            "mass_kg": mass.as_ref().map_or(0.0, |one| one.value),
            "polar_inertia_kg_m2": polar_value,
            // No body has less about a diameter than half of that about its axis.
            "diametral_inertia_kg_m2": mean.max(0.5 * polar_value),
        });
        let readings: Vec<_> = [polar, mass].into_iter().flatten().chain(diametral.into_iter().flatten()).collect();
        let why = if mean < 0.5 * polar_value { "about a diameter: half of that about the axis" } else { "" };
        draft.note_taken(&pointer, body.clone(), &readings, why);
        bodies.push(body);
    }
    if !bodies.is_empty() {
        draft.set(&mounted.pointer("/inertias"), Value::Array(bodies));
    }
}

/// A gear of another stage as a disc between its shaft and its reference circle.
fn gear_body(pair: &Pair, gear: Handle, position_mm: f64, shaft_mm: f64) -> Option<Value> {
    let view = pair.view;
    let teeth = view.number(gear, "number_of_teeth", Quantity::Number)?.value.abs();
    let module_mm = view.number(gear, "normal_module", Quantity::Length)?.value;
    let angle_deg =
        view.number(gear, "helix_angle_reference_diameter", Quantity::Angle).map_or(0.0, |angle| angle.value);
    let width_mm = view.number(gear, "face_width", Quantity::Length)?.value;
    let [outer_m, inner_m, width_m] =
        [teeth * module_mm / angle_deg.to_radians().cos(), shaft_mm, width_mm].map(|mm| mm * 1e-3);
    let mass_kg = 7850.0 * std::f64::consts::FRAC_PI_4 * (outer_m * outer_m - inner_m * inner_m) * width_m;
    let squares = outer_m * outer_m + inner_m * inner_m;
    (mass_kg > 0.0 && mass_kg.is_finite()).then(|| {
        json!({
            "position_mm": position_mm, "mass_kg": rounded(mass_kg), "polar_inertia_kg_m2": rounded(mass_kg * squares / 8.0),
            "diametral_inertia_kg_m2": rounded(mass_kg * (squares / 16.0 + width_m * width_m / 12.0)),
        })
    })
}
