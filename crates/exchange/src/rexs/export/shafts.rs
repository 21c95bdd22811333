//! Shafts with sections, bearings, loads and masses.

use super::model::{Model, Typed};
use super::{BODIES_INCLUDED, CASING, GEAR_UNIT, LOADS, MATERIALS, MEMBERS, SHAFTS, Source, flag};
use herringbone_job::document::{BearingInput, ShaftInput};

/// Middle between the halves from the origin of a member's shaft.
pub(super) fn middle_mm(source: &Source, member: usize) -> f64 {
    let resolved = source.document.design.resolved_shafts();
    match resolved.map(|shafts| [shafts.pinion, shafts.gear]) {
        Some(shafts) => shafts[member].gear_position_mm,
        None => 0.5 * plain_length_mm(source),
    }
}

/// Length of a shaft that the document does not have: the halves, the gap, and a width on each side.
fn plain_length_mm(source: &Source) -> f64 {
    let design = &source.document.design;
    let width_mm = source.width_mm(0).max(source.width_mm(1)).max(design.face_width_mm);
    design.gap_width_mm + 4.0 * width_mm
}

/// Writes both shafts.
pub(super) fn write(source: &Source, model: &mut Model) {
    let design = &source.document.design;
    let operation = &source.document.operation;
    let given = design.resolved_shafts().map(|shafts| [shafts.pinion, shafts.gear]);
    for member in [0, 1] {
        let v_mm = if member == 0 { 0.0 } else { source.geometry.center_distance_mm };
        let id = SHAFTS[member];
        let ratio = -f64::from(design.pinion.teeth) / f64::from(design.gear.teeth);
        let speed_rpm = operation.pinion_speed_rpm * source.turning * if member == 0 { 1.0 } else { ratio };
        let shaft = model.add(id, "shaft", format!("{} shaft", MEMBERS[member]));
        shaft.place([-middle_mm(source, member), v_mm, 0.0], [0.0, 0.0, 1.0]);
        shaft.set("defines_speed", "none", flag(member == 0));
        match member {
            0 => shaft.number("rotational_speed", "1 / min", speed_rpm),
            _ => shaft.result("rotational_speed", "1 / min", Typed::Float(speed_rpm)),
        };
        if given.is_some() {
            shaft.set(BODIES_INCLUDED, "none", flag(true));
        }
        model.relate("assembly", &[("assembly", GEAR_UNIT), ("part", id)]);
        let material = if model.kind(MATERIALS[member]) == "material" { MATERIALS[member] } else { MATERIALS[0] };
        model.relate("reference", &[("origin", id), ("referenced", material)]);
        let load_mm = match &given {
            Some(shafts) => mounted(model, &shafts[member], member),
            None => plain(source, model, member),
        };
        let load = model.add(LOADS[member], "external_load", if member == 0 { "Input" } else { "Output" });
        load.number("u_coordinate_on_shaft", "mm", load_mm).set("transmits_torque", "none", flag(true)).set(
            "defines_torque",
            "none",
            flag(member == 0),
        );
        if member == 0 {
            load.number("torque_around_u_axis", "N m", operation.pinion_torque_nm * source.turning);
        }
        model.relate("assembly", &[("assembly", id), ("part", LOADS[member])]);
    }
}

fn section(model: &mut Model, member: usize, index: i64, start_mm: f64, [length_mm, outer_mm, inner_mm]: [f64; 3]) {
    let id = 200 + 100 * member as i64 + index;
    model
        .add(id, "shaft_section", format!("Section {}", index + 1))
        .number("u_coordinate_on_shaft", "mm", start_mm)
        .number("length", "mm", length_mm)
        .number("outer_diameter_begin", "mm", outer_mm)
        .number("outer_diameter_end", "mm", outer_mm)
        .number("inner_diameter_begin", "mm", inner_mm)
        .number("inner_diameter_end", "mm", inner_mm);
    model.relate("assembly", &[("assembly", SHAFTS[member]), ("part", id)]);
}

/// One section through the bore; the place of the load.
fn plain(source: &Source, model: &mut Model, member: usize) -> f64 {
    let bore_mm = [&source.geometry.pinion, &source.geometry.gear][member].bore_diameter_mm;
    let length_mm = plain_length_mm(source);
    if bore_mm > 0.0 {
        section(model, member, 0, 0.0, [length_mm, bore_mm, 0.0]);
    }
    if member == 0 { 0.0 } else { length_mm }
}

/// The sections, bearings and masses of a document's shaft; the place of the load.
fn mounted(model: &mut Model, shaft: &ShaftInput, member: usize) -> f64 {
    let mut start_mm = 0.0;
    for (index, segment) in shaft.segments.iter().enumerate() {
        section(model, member, index as i64, start_mm, [segment.length_mm, segment.diameter_mm, segment.bore_mm]);
        start_mm += segment.length_mm;
    }
    for (index, bearing) in shaft.bearings.iter().enumerate() {
        write_bearing(model, bearing, member, index as i64);
    }
    for (index, body) in shaft.inertias.iter().enumerate() {
        let id = 600 + 50 * member as i64 + index as i64;
        model
            .add(id, "additional_mass", format!("Body {}", index + 1))
            .number("u_coordinate_on_shaft", "mm", body.position_mm)
            .number("mass_of_component", "kg", body.mass_kg)
            .number("moment_of_inertia_u_axis", "kg m^2", body.polar_inertia_kg_m2)
            .number("moment_of_inertia_v_axis", "kg m^2", body.diametral_inertia_kg_m2)
            .number("moment_of_inertia_w_axis", "kg m^2", body.diametral_inertia_kg_m2);
        model.relate("assembly", &[("assembly", SHAFTS[member]), ("part", id)]);
    }
    shaft.coupling.position_mm
}

fn write_bearing(model: &mut Model, bearing: &BearingInput, member: usize, index: i64) {
    let id = 100 + 50 * member as i64 + index;
    let own = [bearing.radial_x_n_per_um, bearing.radial_y_n_per_um].map(|own| own.or(bearing.radial_n_per_um));
    let radial = match own {
        [Some(x), Some(y)] => Some(if x == y { x } else { 0.5 * (x + y) }),
        _ => bearing.radial_n_per_um,
    };
    let axial = bearing.axial_n_per_um;
    let component = model.add(id, "concept_bearing", format!("{} bearing {}", MEMBERS[member], index + 1));
    component
        .number("u_coordinate_on_shaft_inner_side", "mm", bearing.position_mm)
        .number("u_coordinate_on_shaft_outer_side", "mm", bearing.position_mm)
        .set("radial_force_absorption", "none", flag(radial != Some(0.0)))
        .set(
            "axial_force_absorption",
            "none",
            Typed::Word(if axial > 0.0 { "both_directions" } else { "no_direction" }),
        );
    if let Some(radial) = radial.filter(|radial| *radial > 0.0) {
        component.number("radial_stiffness", "N / m", radial * 1e6);
    }
    if axial > 0.0 {
        component.number("axial_stiffness", "N / m", axial * 1e6);
    }
    if bearing.tilting_nm_per_rad > 0.0 {
        component.number("bending_stiffness", "N mm / rad", bearing.tilting_nm_per_rad * 1e3);
    }
    model.relate("side", &[("assembly", id), ("inner_part", SHAFTS[member]), ("outer_part", CASING)]);
}
