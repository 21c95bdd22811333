//! The gear pair: teeth, flanks, supports, assembly errors.

use super::{conflict, number};
use crate::document::*;
use crate::reader::Object;
use crate::violation::Violation;

pub(super) fn design(object: Object) -> DesignInput {
    let of_both = material(object.object("material", false, "Material of both gears."), &STEEL);
    let pinion_hand = Hand::Left;
    let pinion = gear(object.object("pinion", true, "The driving gear."), pinion_hand, &of_both);
    let gear_hand = pinion.left_half_hand.opposite();
    let gear = gear(object.object("gear", true, "The driven gear."), gear_hand, &of_both);
    if pinion.left_half_hand == gear.left_half_hand {
        object.reading().violate(Violation::new(
            object.pointer_to("gear/left_half_hand"),
            "conflict",
            "is the same hand as the pinion's left half; mating halves of an external pair have opposite hands",
        ));
    }
    let design = DesignInput {
        normal_module_mm: object.number("normal_module_mm", number(0.1, 100.0, "mm", None, "Normal module m_n.")),
        pressure_angle_deg: object
            .number("pressure_angle_deg", number(10.0, 35.0, "deg", Some(20.0), "Pressure angle of the rack.")),
        pressure_angle_plane: object.choice(
            "pressure_angle_plane",
            &[("normal", PressureAnglePlane::Normal), ("transverse", PressureAnglePlane::Transverse)],
            PressureAnglePlane::Normal,
            "normal",
            "Section in which the pressure angle is given.",
        ),
        helix_angle_deg: object
            .number("helix_angle_deg", number(0.0, 50.0, "deg", None, "Helix angle at the reference circle.")),
        face_width_mm: object.number("face_width_mm", number(0.5, 2000.0, "mm", None, "Face width of one half.")),
        gap_width_mm: object
            .number("gap_width_mm", number(0.0, 1000.0, "mm", Some(30.0), "Width of the gap between the halves.")),
        center_distance_mm: object.optional_number(
            "center_distance_mm",
            number(1.0, 20_000.0, "mm", None, "Working centre distance; derived from the profile shifts when null."),
        ),
        backlash_um: object.optional_number(
            "backlash_um",
            number(
                0.0,
                5000.0,
                "um",
                Some(DEFAULT_BACKLASH_UM),
                "Total play along the direction of the mesh displacement s; the source's 2 um when it is not given.",
            ),
        ),
        half_stagger: object.number(
            "half_stagger",
            number(0.0, 1.0, "1", Some(0.0), "Stagger of the right half as a fraction of the transverse pitch."),
        ),
        material: of_both,
        supports: supports(object.object("supports", false, "Shafts and bearings, per half.")),
        assembly: assembly(object.object("assembly", false, "Assembly errors.")),
        pinion,
        gear,
    };
    widths(&object, &design);
    object.finish();
    design
}

/// What a gear is wider than the design on the side of the gap has to find room there.
fn widths(object: &Object, design: &DesignInput) {
    let widest_mm = design.face_width_mm + design.gap_width_mm;
    for (name, gear) in [("pinion", &design.pinion), ("gear", &design.gear)] {
        if let Some(width_mm) = gear.face_width_mm.filter(|width_mm| *width_mm > widest_mm) {
            let detail = format!(
                "is {width_mm} mm; its halves, centred on halves of {} mm (face_width_mm) that stand {} mm apart (gap_width_mm), \
                 would overlap above {widest_mm} mm",
                design.face_width_mm, design.gap_width_mm
            );
            conflict(object, &format!("{name}/face_width_mm"), &detail);
        }
    }
}

const STEEL: MaterialInput = MaterialInput { youngs_modulus_gpa: 206.0, poissons_ratio: 0.3, density_kg_m3: 7850.0 };

/// A material; what is left out comes from `base`.
fn material(object: Object, base: &MaterialInput) -> MaterialInput {
    let material = MaterialInput {
        youngs_modulus_gpa: object.number(
            "youngs_modulus_gpa",
            number(1.0, 1000.0, "GPa", Some(base.youngs_modulus_gpa), "Young's modulus."),
        ),
        poissons_ratio: object
            .number("poissons_ratio", number(0.0, 0.49, "1", Some(base.poissons_ratio), "Poisson's ratio.")),
        density_kg_m3: object
            .number("density_kg_m3", number(100.0, 30_000.0, "kg/m3", Some(base.density_kg_m3), "Density.")),
    };
    object.finish();
    material
}

/// Flank modifications of one half of `object`, where it gives any: what is left out is that of both.
fn half(object: &Object, name: &'static str, help: &'static str, both: &FlankInput) -> Option<FlankInput> {
    object.optional_object(name, help).map(|half| {
        let modification = flank(&half, Some(both));
        half.finish();
        modification
    })
}

const LEFT: &str = "Flank modifications of the left half where they differ.";
const RIGHT: &str = "Flank modifications of the right half where they differ.";

fn gear(object: Object, default_hand: Hand, of_both: &MaterialInput) -> GearInput {
    let default_word = if default_hand == Hand::Left { "left" } else { "right" };
    let flank = flank(&object, None);
    let left = half(&object, "left", LEFT, &flank);
    let right = half(&object, "right", RIGHT, &flank);
    let coast_help = "Flank modifications of the other flanks, in contact under negative torque, where they differ.";
    let coast = object.optional_object("coast", coast_help).map(|object| {
        let flank = self::flank(&object, Some(&flank));
        let (left, right) = (half(&object, "left", LEFT, &flank), half(&object, "right", RIGHT, &flank));
        object.finish();
        CoastInput { flank, left, right }
    });
    let gear = GearInput {
        teeth: object.integer("teeth", 5, 1000, None, "Number of teeth.") as u32,
        left_half_hand: object.choice(
            "left_half_hand",
            &[("left", Hand::Left), ("right", Hand::Right)],
            default_hand,
            default_word,
            "Hand of the left half's helix.",
        ),
        profile_shift: object
            .number("profile_shift", number(-2.0, 2.0, "1", Some(0.0), "Profile shift coefficient x.")),
        addendum: object.number(
            "addendum",
            number(0.3, 2.5, "1", Some(1.0), "Addendum of the rack, multiple of the normal module."),
        ),
        dedendum: object.number(
            "dedendum",
            number(0.3, 3.0, "1", Some(1.25), "Dedendum of the rack, multiple of the normal module."),
        ),
        fillet_radius: object.number(
            "fillet_radius",
            number(0.0, 1.0, "1", Some(0.38), "Root fillet radius of the rack, multiple of the normal module."),
        ),
        tip_alteration: object.number(
            "tip_alteration",
            number(-1.0, 0.5, "1", Some(0.0), "Tip alteration coefficient k; negative shortens the tooth."),
        ),
        bore_diameter_mm: object.optional_number(
            "bore_diameter_mm",
            number(0.0, 20_000.0, "mm", None, "Bore; 0.4 of the reference diameter when null."),
        ),
        mass_kg: object.optional_number(
            "mass_kg",
            number(1e-6, 1e6, "kg", None, "Mass of the whole gear; a solid disc of both halves when null."),
        ),
        inertia_kg_m2: object.optional_number(
            "inertia_kg_m2",
            number(
                1e-9,
                1e9,
                "kg m2",
                None,
                "Moment of inertia of the whole gear; a solid disc of both halves when null.",
            ),
        ),
        face_width_mm: object.optional_number(
            "face_width_mm",
            number(
                0.5,
                2000.0,
                "mm",
                None,
                "Face width of one half of this gear; the design's when null. What both gears have in common, centred, bears.",
            ),
        ),
        material: object
            .optional_object("material", "Material of this gear where it differs.")
            .map(|own| material(own, of_both)),
        flank,
        left,
        right,
        coast,
    };
    object.finish();
    gear
}

/// Flank modifications among the fields of `object`; what is left out comes from `base`, or is zero.
fn flank(object: &Object, base: Option<&FlankInput>) -> FlankInput {
    let default = |pick: fn(&FlankInput) -> f64| Some(base.map_or(0.0, pick));
    let tip = object.object("tip_relief", false, "Tip relief.");
    let base_shape = base.map_or(ReliefShape::Parabolic, |flank| flank.tip_relief.shape);
    let tip_relief = TipReliefInput {
        amount_um: tip
            .number("amount_um", number(0.0, 1000.0, "um", default(|f| f.tip_relief.amount_um), "Relief at the tip.")),
        length_mm: tip.number(
            "length_mm",
            number(
                0.0,
                500.0,
                "mm",
                default(|f| f.tip_relief.length_mm),
                "Roll length along the path of contact from the tip.",
            ),
        ),
        shape: tip.choice(
            "shape",
            &[("linear", ReliefShape::Linear), ("parabolic", ReliefShape::Parabolic)],
            base_shape,
            if base_shape == ReliefShape::Linear { "linear" } else { "parabolic" },
            "Course over the length.",
        ),
    };
    if tip_relief.amount_um > 0.0 && tip_relief.length_mm == 0.0 {
        conflict(&tip, "length_mm", "is 0 mm while amount_um is above 0; a relief needs a roll length above 0 mm");
    }
    tip.finish();
    let end = object.object("end_relief", false, "End relief at both ends of the face width.");
    let end_relief = EndReliefInput {
        amount_um: end
            .number("amount_um", number(0.0, 1000.0, "um", default(|f| f.end_relief.amount_um), "Relief at the ends.")),
        length_mm: end.number(
            "length_mm",
            number(0.0, 1000.0, "mm", default(|f| f.end_relief.length_mm), "Axial length of the relief."),
        ),
    };
    if end_relief.amount_um > 0.0 && end_relief.length_mm == 0.0 {
        conflict(&end, "length_mm", "is 0 mm while amount_um is above 0; a relief needs a length above 0 mm");
    }
    end.finish();
    FlankInput {
        tip_relief,
        lead_crowning_um: object.number(
            "lead_crowning_um",
            number(
                -500.0,
                1000.0,
                "um",
                default(|f| f.lead_crowning_um),
                "Crowning: zero at mid-width, this at both ends.",
            ),
        ),
        helix_slope_um: object.number(
            "helix_slope_um",
            number(
                -1000.0,
                1000.0,
                "um",
                default(|f| f.helix_slope_um),
                "Helix slope: zero at the inner end, this at the outer.",
            ),
        ),
        end_relief,
    }
}

fn supports(object: Object) -> SupportsInput {
    let spring = |name, help| object.optional_number(name, number(0.0, 1e7, "N/um", None, help));
    let torsion = |name, help| object.optional_number(name, number(0.0, 1e13, "N m/rad", None, help));
    let supports = SupportsInput {
        pinion_lateral_n_per_um: spring(
            "pinion_lateral_n_per_um",
            "Lateral support of each pinion half; scaled with the centre distance when null.",
        ),
        gear_lateral_n_per_um: spring(
            "gear_lateral_n_per_um",
            "Lateral support of each gear half; scaled with the centre distance when null.",
        ),
        pinion_halves_axial_n_per_um: spring(
            "pinion_halves_axial_n_per_um",
            "Axial spring between the pinion halves; that of the gear body when null.",
        ),
        gear_axial_n_per_um: spring(
            "gear_axial_n_per_um",
            "Axial support of each gear half; scaled with the centre distance when null.",
        ),
        gear_halves_axial_n_per_um: spring(
            "gear_halves_axial_n_per_um",
            "Axial spring between the gear halves; that of the gear body when null.",
        ),
        damping_ratio: object
            .number("damping_ratio", number(0.0, 2.0, "1", Some(0.03), "Damping ratio of supports and couplings.")),
        pinion_halves_torsional_nm_per_rad: torsion(
            "pinion_halves_torsional_nm_per_rad",
            "Torsional spring between the pinion halves; that of the gear body when null, 0 (none) in the source's model.",
        ),
        gear_halves_torsional_nm_per_rad: torsion(
            "gear_halves_torsional_nm_per_rad",
            "Torsional spring between the gear halves; that of the gear body when null, 0 (none) in the source's model.",
        ),
        pinion_halves_lateral_n_per_um: spring(
            "pinion_halves_lateral_n_per_um",
            "Lateral (bending) spring between the pinion halves; that of the gear body when null, 0 (none) in the source's model.",
        ),
        gear_halves_lateral_n_per_um: spring(
            "gear_halves_lateral_n_per_um",
            "Lateral (bending) spring between the gear halves; that of the gear body when null, 0 (none) in the source's model.",
        ),
    };
    object.finish();
    supports
}

fn assembly(object: Object) -> AssemblyInput {
    let error = |name, help| object.number(name, number(-2000.0, 2000.0, "um", Some(0.0), help));
    let assembly = AssemblyInput {
        center_distance_error_um: error("center_distance_error_um", "Added to the centre distance."),
        in_plane_misalignment_um: error(
            "in_plane_misalignment_um",
            "Linear gap over the face width of one half, in the plane of action of the drive flanks.",
        ),
        out_of_plane_misalignment_um: error(
            "out_of_plane_misalignment_um",
            "Linear deviation over the face width of one half, out of the plane of action of the drive flanks; positive turns the left half's \
             outer end away from the gear.",
        ),
        apex_offset_um: error("apex_offset_um", "Axial offset between the apexes of pinion and gear."),
    };
    object.finish();
    assembly
}
