//! Materials, stages, gears, flanks, tools and flank modifications.

use super::model::{Model, Relation, Typed};
use super::{GEAR_UNIT, GEARS, HALVES, MATERIALS, MEMBERS, SHAFTS, STAGE_DATA, STAGES, Source, flag, turned};
use herringbone_job::document::{FlankInput, GearInput, MaterialInput, ReliefShapeInput};

/// The materials: one, or one for each gear.
pub(super) fn materials(source: &Source, model: &mut Model) {
    let design = &source.document.design;
    let own = [&design.pinion, &design.gear].map(|gear| gear.material.as_ref().unwrap_or(&design.material));
    let mut write = |id: i64, name: &str, material: &MaterialInput| {
        model
            .add(id, "material", name)
            .number("elastic_modulus", "N / mm^2", material.youngs_modulus_gpa * 1e3)
            .number("poisson_ratio", "none", material.poissons_ratio)
            .number("density", "kg / dm^3", material.density_kg_m3 * 1e-3);
    };
    write(MATERIALS[0], "Material", own[0]);
    if own[0] != own[1] {
        write(MATERIALS[1], "Material of the gear", own[1]);
    }
}

/// The flanks of a member's half: drive, and coast where it differs.
fn flanks(gear: &GearInput, half: usize) -> [&FlankInput; 2] {
    let drive = [&gear.left, &gear.right][half].as_ref().unwrap_or(&gear.flank);
    let coast = gear.coast.as_ref().map(|coast| [&coast.left, &coast.right][half].as_ref().unwrap_or(&coast.flank));
    [drive, coast.unwrap_or(drive)]
}

/// Writes stages and gears.
pub(super) fn write(source: &Source, model: &mut Model) {
    let design = &source.document.design;
    let center_mm = source.geometry.center_distance_mm;
    for half in [0, 1] {
        let stage = model.add(STAGES[half], "cylindrical_stage", format!("Mesh, {}", HALVES[half]));
        stage
            .number("center_distance", "mm", center_mm)
            .number("rotating_angle_around_neg_u_axis", "deg", 0.0)
            .set(
                "flag_designation_addendum_modification",
                "none",
                Typed::Word("entry_of_addendum_modification_coefficient"),
            )
            .number("common_face_width", "mm", source.width_mm(0).min(source.width_mm(1)));
        if let Some(backlash_um) = design.backlash_um {
            stage.number("minimum_normal_backlash", "mm", backlash_um * 1e-3);
            stage.number("maximum_normal_backlash", "mm", backlash_um * 1e-3);
        }
        model.relate("assembly", &[("assembly", GEAR_UNIT), ("part", STAGES[half])]);
        for member in [0, 1] {
            gear(source, model, member, half);
        }
        model.relate("stage", &[("stage", STAGES[half]), ("gear_1", GEARS[0][half]), ("gear_2", GEARS[1][half])]);
    }
}

fn gear(source: &Source, model: &mut Model, member: usize, half: usize) {
    let design = &source.document.design;
    let given = [&design.pinion, &design.gear][member];
    let of = [&source.geometry.pinion, &source.geometry.gear][member];
    let id = GEARS[member][half];
    let u_mm = super::shafts::middle_mm(source, member) + source.middle_mm(half);
    let global_mm = source.middle_mm(half);
    let v_mm = if member == 0 { 0.0 } else { source.geometry.center_distance_mm };
    let pitch_rad = std::f64::consts::TAU / f64::from(given.teeth);
    let angle_rad = if member == 0 && half == 1 { design.half_stagger * pitch_rad } else { 0.0 };
    let component = model.add(id, "cylindrical_gear", format!("{}, {}", MEMBERS[member], HALVES[half]));
    component
        .place([global_mm, v_mm, 0.0], turned(angle_rad))
        .number("u_coordinate_on_shaft", "mm", u_mm)
        .set("number_of_teeth", "none", Typed::Integer(given.teeth.into()))
        .number("normal_module", "mm", design.normal_module_mm)
        .number("helix_angle_reference_diameter", "deg", source.helix_deg(member, half))
        .number("face_width", "mm", source.width_mm(member))
        .number("tip_diameter", "mm", of.tip_diameter_mm)
        .set("datum_face_orientation", "none", Typed::Word("negative"));
    if let Some(bore_mm) = given.bore_diameter_mm {
        component.number("inner_diameter", "mm", bore_mm);
    }
    if let Some(mass_kg) = given.mass_kg {
        component.number("mass_of_component", "kg", 0.5 * mass_kg);
    }
    component.result("root_diameter", "mm", Typed::Float(of.root_diameter_mm));
    component.result("reference_circle_diameter", "mm", Typed::Float(of.reference_diameter_mm));
    component.result("base_circle_diameter", "mm", Typed::Float(of.base_diameter_mm));
    model.relate("assembly", &[("assembly", SHAFTS[member]), ("part", id)]);
    let material = if model.kind(MATERIALS[member]) == "material" { MATERIALS[member] } else { MATERIALS[0] };
    model.relate("reference", &[("origin", id), ("referenced", material)]);

    let sides = [id * 10, id * 10 + 1];
    // Seen from the datum face, at the lower end, a pinion that turns about +u drives with its right flanks.
    let drives_right = source.turning * if source.document.operation.pinion_torque_nm < 0.0 { -1.0 } else { 1.0 } > 0.0;
    let [drive, coast] = flanks(given, half);
    for (index, (flank, side)) in sides.into_iter().zip(["left", "right"]).enumerate() {
        // `drive` is the flank under positive torque.
        let of_positive = (source.turning > 0.0) == (side == "right");
        let modification = if of_positive { drive } else { coast };
        model
            .add(flank, "cylindrical_gear_flank", format!("{side} flank"))
            .number("normal_pressure_angle", "deg", source.normal_pressure_angle_deg)
            .number("addendum_modification_coefficient", "none", given.profile_shift);
        modifications(source, model, modification, flank, 1000 + id * 100 + 10 * index as i64, member);
        let (tool, settings) = (20_000 + flank, 30_000 + flank);
        model
            .add(tool, "rack_shaped_tool", "basic rack")
            .number("normal_module", "mm", design.normal_module_mm)
            .number("normal_pressure_angle", "deg", source.normal_pressure_angle_deg)
            .number("addendum_coefficient_reference_profile", "none", given.dedendum)
            .number("dedendum_coefficient_reference_profile", "none", given.addendum)
            .number("tip_radius_factor", "none", given.fillet_radius);
        model.add(settings, "cylindrical_gear_manufacturing_settings", "generation");
        model.relations.push(Relation {
            kind: "manufacturing_step",
            order: Some(1),
            refs: vec![("workpiece", flank), ("tool", tool), ("manufacturing_settings", settings)],
        });
    }
    model.relate("flank", &[("gear", id), ("left", sides[0]), ("right", sides[1])]);
    let data = STAGE_DATA[half][member];
    let pinion_drives = source.document.operation.pinion_torque_nm >= 0.0;
    model
        .add(data, "cylindrical_stage_gear_data", format!("{} in its mesh, {}", MEMBERS[member], HALVES[half]))
        .result("is_driving_gear", "none", flag((member == 0) == pinion_drives))
        .result("loaded_tooth_flank", "none", Typed::Word(if drives_right { "right" } else { "left" }));
    model.relate("stage_gear_data", &[("stage", STAGES[half]), ("gear", id), ("stage_gear_data", data)]);
}

fn modifications(source: &Source, model: &mut Model, flank: &FlankInput, of: i64, first: i64, member: usize) {
    let mm = |um: f64| um * 1e-3;
    let mut next = first;
    let mut refer = |model: &mut Model, kind: &'static str, name: &str| {
        let id = next;
        next += 1;
        model.add(id, kind, name);
        model.relate("reference", &[("origin", of), ("referenced", id)]);
        model.components.len() - 1
    };
    let half_width_mm = 0.5 * source.width_mm(member);
    if flank.tip_relief.amount_um != 0.0 {
        let at = refer(model, "tip_relief", "tip relief");
        let shape = match flank.tip_relief.shape {
            ReliefShapeInput::Linear => "linear",
            ReliefShapeInput::Parabolic => "parabolic",
        };
        model.components[at]
            .number("tip_relief_depth", "mm", mm(flank.tip_relief.amount_um))
            .number("tip_relief_datum_length", "mm", flank.tip_relief.length_mm)
            .set("shape_of_relief", "none", Typed::Word(shape));
    }
    if flank.lead_crowning_um != 0.0 {
        let at = refer(model, "helix_crowning", "lead crowning");
        model.components[at]
            .number("helix_crowning_amount_datum_face", "mm", mm(flank.lead_crowning_um))
            .number("helix_crowning_amount_non_datum_face", "mm", mm(flank.lead_crowning_um))
            .number("coordinate_where_helix_crowning_is_specified_datum_face", "mm", -half_width_mm)
            .number("coordinate_where_helix_crowning_is_specified_non_datum_face", "mm", half_width_mm)
            .set("shape_of_helix_crowning", "none", Typed::Word("parabolic"));
    }
    if flank.helix_slope_um != 0.0 {
        let at = refer(model, "helix_slope", "helix slope, material removed at the outer end");
        model.components[at].number("helix_slope", "mm", mm(flank.helix_slope_um));
    }
    if flank.end_relief.amount_um != 0.0 {
        let at = refer(model, "end_relief_datum_face", "end relief");
        model.components[at].number("end_relief_depth_datum_face", "mm", mm(flank.end_relief.amount_um)).number(
            "end_relief_length_datum_face",
            "mm",
            flank.end_relief.length_mm,
        );
        let at = refer(model, "end_relief_non_datum_face", "end relief");
        model.components[at].number("end_relief_depth_non_datum_face", "mm", mm(flank.end_relief.amount_um)).number(
            "end_relief_length_non_datum_face",
            "mm",
            flank.end_relief.length_mm,
        );
    }
}
