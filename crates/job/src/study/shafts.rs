//! Shafts of a document in SI, and what is to be said of them before anything is solved.

use super::supports::{self, shown};
use crate::document::{
    BearingAtSpeedInput, BearingInput, DerivedShaftValue, DesignInput, GearInput, JobDocument, JobKind, MaterialInput,
    Plane, RigidBodyInput, ShaftInput,
};
use crate::violation::Violation;
use crate::warning::Warning;
use herringbone_physics::gear::Pair;
use herringbone_physics::shafts::{
    Bearing, Coupling, Machine, RigidBody, Shaft, ShaftMaterial, ShaftSegment, ShaftTrain,
};

/// Both shafts at the speed of the document; `None` without `design.shafts`.
pub(super) fn train(document: &JobDocument) -> Option<ShaftTrain> {
    let design = &document.design;
    let resolved = design.resolved_shafts()?;
    let pinion_rpm = document.operation.pinion_speed_rpm;
    let gear_rpm = pinion_rpm * f64::from(design.pinion.teeth) / f64::from(design.gear.teeth);
    Some(ShaftTrain {
        pinion: shaft(&resolved.pinion, material_of(design, &design.pinion), pinion_rpm),
        gear: shaft(&resolved.gear, material_of(design, &design.gear), gear_rpm),
    })
}

fn material_of<'a>(design: &'a DesignInput, gear: &'a GearInput) -> &'a MaterialInput {
    gear.material.as_ref().unwrap_or(&design.material)
}

fn shaft(shaft: &ShaftInput, material: &MaterialInput, speed_rpm: f64) -> Shaft {
    let segments = shaft.segments.iter().map(|segment| ShaftSegment {
        length_m: segment.length_mm * 1e-3,
        diameter_m: segment.diameter_mm * 1e-3,
        bore_m: segment.bore_mm * 1e-3,
    });
    let bodies = shaft.inertias.iter().map(|inertia| {
        let body = RigidBody {
            mass_kg: inertia.mass_kg,
            polar_inertia_kg_m2: inertia.polar_inertia_kg_m2,
            diametral_inertia_kg_m2: inertia.diametral_inertia_kg_m2,
        };
        (inertia.position_mm * 1e-3, body)
    });
    let coupling = &shaft.coupling;
    let machine = coupling.torsional_nm_per_rad.zip(coupling.inertia_kg_m2);
    Shaft {
        segments: segments.collect(),
        gear_position_m: shaft.gear_position_mm * 1e-3,
        bearings: shaft.bearings.iter().map(|given| bearing(given, speed_rpm)).collect(),
        coupling: Coupling {
            position_m: coupling.position_mm * 1e-3,
            axial_n_per_m: coupling.axial_n_per_um * 1e6,
            torsional: machine.map(|(torsional_nm_per_rad, inertia_kg_m2)| Machine {
                torsional_nm_per_rad,
                torsional_damping_nm_s_per_rad: coupling.torsional_damping_nms_per_rad,
                inertia_kg_m2,
            }),
        },
        half_body: shaft.half_body.as_ref().map(body),
        bodies: bodies.collect(),
        material: ShaftMaterial {
            youngs_modulus_pa: material.youngs_modulus_gpa * 1e9,
            poissons_ratio: material.poissons_ratio,
            density_kg_m3: material.density_kg_m3,
        },
    }
}

fn body(body: &RigidBodyInput) -> RigidBody {
    RigidBody {
        mass_kg: body.mass_kg,
        polar_inertia_kg_m2: body.polar_inertia_kg_m2,
        diametral_inertia_kg_m2: body.diametral_inertia_kg_m2,
    }
}

fn bearing(bearing: &BearingInput, speed_rpm: f64) -> Bearing {
    let (stiffness_n_per_um, damping_ns_per_m) = match bearing.speed_table.as_slice() {
        [] => {
            let [x, y] = bearing.given_radial_n_per_um().map(Option::unwrap_or_default);
            let damping = bearing.radial_damping_ns_per_m;
            ([[x, 0.0], [0.0, y]], [[damping, 0.0], [0.0, damping]])
        }
        rows => {
            let at = |of: fn(&BearingAtSpeedInput) -> [[f64; 2]; 2]| interpolated(rows, of, speed_rpm);
            (at(BearingAtSpeedInput::stiffness_n_per_um), at(BearingAtSpeedInput::damping_ns_per_m))
        }
    };
    Bearing {
        position_m: bearing.position_mm * 1e-3,
        radial_n_per_m: stiffness_n_per_um.map(|row| row.map(|value| value * 1e6)),
        radial_damping_n_s_per_m: damping_ns_per_m,
        axial_n_per_m: bearing.axial_n_per_um * 1e6,
        axial_damping_n_s_per_m: bearing.axial_damping_ns_per_m,
        tilting_nm_per_rad: bearing.tilting_nm_per_rad,
        tilting_damping_nm_s_per_rad: bearing.tilting_damping_nms_per_rad,
    }
}

/// A matrix of a bearing's table at a speed: linear between the speeds, constant beyond them. `rows` is not empty.
fn interpolated(
    rows: &[BearingAtSpeedInput],
    of: fn(&BearingAtSpeedInput) -> [[f64; 2]; 2],
    speed_rpm: f64,
) -> [[f64; 2]; 2] {
    let above = rows.partition_point(|row| row.speed_rpm <= speed_rpm);
    let (low, high) = (&rows[above.saturating_sub(1)], &rows[above.min(rows.len() - 1)]);
    let span = high.speed_rpm - low.speed_rpm;
    let part = if span > 0.0 { (speed_rpm - low.speed_rpm) / span } else { 0.0 };
    let (low, high) = (of(low), of(high));
    [0, 1].map(|row| [0, 1].map(|column| low[row][column] + part * (high[row][column] - low[row][column])))
}

/// Warnings of the shafts: what was assumed, what they replace.
pub(super) fn warnings(document: &JobDocument) -> Vec<Warning> {
    let Some(resolved) = document.design.resolved_shafts() else { return Vec::new() };
    let warning = |code: &str, pointer: &str, detail: String| Warning {
        code: code.to_owned(),
        pointer: pointer.to_owned(),
        detail,
    };
    let mut warnings = Vec::new();
    let swept = |value: &&DerivedShaftValue| !document.axes.iter().any(|axis| axis.pointer == value.pointer);
    let assumed: Vec<_> = resolved.assumed_bearings.iter().filter(swept).collect();
    if let Some(first) = assumed.first() {
        let value = |value: &&DerivedShaftValue| {
            let name = value.pointer.strip_prefix("/design/shafts/").unwrap_or(&value.pointer);
            let name = name.strip_prefix("arrangement/").unwrap_or(name);
            format!("{name} {}", shown(value.value))
        };
        let values = assumed.iter().map(value).collect::<Vec<_>>().join(", ");
        warnings.push(warning(
            "assumed-bearings",
            &first.pointer,
            format!(
                "not given; assumed after the size of the shafts (10 N/µm radially per mm of diameter, a third of it axially): {values} N/µm; \
                 real bearings differ by a factor of 2"
            ),
        ));
    }
    let given: Vec<_> = supports::given(&document.design.supports).collect();
    if let Some(first) = given.first() {
        warnings.push(warning(
            "shafts-replace-supports",
            &format!("/design/supports/{first}"),
            format!("is not used: design.shafts is given and replaces the supports ({})", given.join(", ")),
        ));
    }
    if document.kind != JobKind::Mesh && resolved.pinion.is_undamped() && resolved.gear.is_undamped() {
        warnings.push(warning(
            "undamped-bearings",
            "/design/shafts",
            "have no damping in any bearing (radial_damping_ns_per_m 0 N·s/m): modes that the mesh does not damp grow large at resonance"
                .to_owned(),
        ));
    }
    warnings
}

/// What contradicts the shafts of a document: equations in the pitch plane, places where they would touch.
pub(super) fn violations(document: &JobDocument, pair: &Pair) -> Vec<Violation> {
    let mut found = collisions(document, pair);
    if document.design.shafts.is_some() && document.model.plane == Plane::Pitch {
        let detail =
            "is pitch; with design.shafts the forces of the teeth act along their normals, in the base plane: base";
        found.push(Violation::new("/model/plane".to_owned(), "conflict", detail.to_owned()));
    }
    found
}

/// Places beside the faces at which the two shafts would run into each other.
fn collisions(document: &JobDocument, pair: &Pair) -> Vec<Violation> {
    let design = &document.design;
    let Some(resolved) = design.resolved_shafts() else { return Vec::new() };
    let widths = [&design.pinion, &design.gear].map(|gear| gear.face_width_mm.unwrap_or(design.face_width_mm));
    let widest_mm = widths[0].max(widths[1]);
    let middle_mm = 0.5 * (design.gap_width_mm + design.face_width_mm);
    let [inner_mm, outer_mm] = [(middle_mm - 0.5 * widest_mm).max(0.0), middle_mm + 0.5 * widest_mm];
    // Parts of the axis without teeth.
    let free_mm = [[f64::NEG_INFINITY, -outer_mm], [-inner_mm, inner_mm], [outer_mm, f64::INFINITY]];
    let center_distance_mm = pair.center_distance_m * 1e3;
    let mut found = Vec::new();
    for (index, (pinion_mm, pinion)) in resolved.pinion.places_mm().enumerate() {
        for (gear_mm, gear) in resolved.gear.places_mm() {
            let needed_mm = 0.5 * (pinion.diameter_mm + gear.diameter_mm);
            let start_mm =
                (pinion_mm[0] - resolved.pinion.gear_position_mm).max(gear_mm[0] - resolved.gear.gear_position_mm);
            let end_mm =
                (pinion_mm[1] - resolved.pinion.gear_position_mm).min(gear_mm[1] - resolved.gear.gear_position_mm);
            let meet = |free: &[f64; 2]| end_mm.min(free[1]) - start_mm.max(free[0]) > 1e-3;
            if needed_mm < center_distance_mm || !free_mm.iter().any(meet) {
                continue;
            }
            let pointer = match document.design.shafts.as_ref().is_some_and(|shafts| shafts.pinion.is_some()) {
                true => format!("/design/shafts/pinion/segments/{index}/diameter_mm"),
                false => "/design/shafts/arrangement/pinion_shaft_diameter_mm".to_owned(),
            };
            let detail = format!(
                "is {} mm: beside the faces, {start_mm:.1} to {end_mm:.1} mm from the middle of the gap, the gear's shaft of {} mm would \
                 touch it; the centre distance is {center_distance_mm:.3} mm, half of both diameters {needed_mm:.3} mm",
                pinion.diameter_mm, gear.diameter_mm
            );
            let largest_mm = 2.0 * center_distance_mm - gear.diameter_mm;
            found.push(Violation {
                maximum: Some(largest_mm),
                unit: Some("mm".to_owned()),
                ..Violation::new(pointer, "shafts-overlap", detail)
            });
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_value;
    use crate::study::unchecked::check;
    use serde_json::{Value, json};

    fn document(shafts: Value, change: impl FnOnce(&mut Value)) -> JobDocument {
        let mut value: Value = serde_json::from_str(include_str!("../../../../examples/contact.json")).unwrap();
        value["design"]["shafts"] = shafts;
        value["design"]["supports"] = json!({});
        change(&mut value);
        parse_value(&value).unwrap_or_else(|error| panic!("{error:#?}"))
    }

    fn arrangement() -> Value {
        json!({"arrangement": {"bearing_span_mm": 340.0, "pinion_shaft_diameter_mm": 80.0, "gear_shaft_diameter_mm": 110.0}})
    }

    fn codes(document: &JobDocument) -> Vec<String> {
        check(document).unwrap().warnings.into_iter().map(|warning| warning.code).collect()
    }

    #[test]
    fn shafts_are_in_si_and_of_the_members_material() {
        let document = document(arrangement(), |value| {
            value["design"]["gear"]["material"] = json!({"youngs_modulus_gpa": 170.0});
        });
        let train = train(&document).unwrap();
        assert!(train.pinion.floats_axially() && !train.gear.floats_axially());
        assert_eq!(train.pinion.material.youngs_modulus_pa, 206e9);
        assert_eq!(train.gear.material.youngs_modulus_pa, 170e9);
        let sections = train.pinion.bearing_sections_m();
        assert!((sections[0] + 0.17).abs() < 1e-12 && (sections[1] - 0.17).abs() < 1e-12, "{sections:?}");
        assert_eq!(train.pinion.bearings[0].radial_n_per_m, [[800e6, 0.0], [0.0, 800e6]]);
        assert!((train.pinion.bearings[0].radial_damping_n_s_per_m[0][0] - 8000.0).abs() < 1e-9);
        assert!(train.pinion.half_body.is_some() && train.pinion.coupling.torsional.is_none());
        for shaft in [&train.pinion, &train.gear] {
            shaft.validate().unwrap();
            shaft.flexibility(&[0.0], &[0.05]).unwrap();
        }
    }

    #[test]
    fn a_table_is_interpolated_at_the_speed_of_its_own_shaft() {
        let row = |speed: f64, stiffness: f64| {
            json!({"speed_rpm": speed, "stiffness_xx_n_per_um": stiffness, "stiffness_yy_n_per_um": 2.0 * stiffness,
                "stiffness_xy_n_per_um": 0.5 * stiffness, "stiffness_yx_n_per_um": -0.5 * stiffness,
                "damping_xx_ns_per_m": 1e3 * stiffness, "damping_yy_ns_per_m": 1e3})
        };
        let shaft = |span: f64| {
            json!({
                "gear_position_mm": 200.0, "segments": [{"length_mm": 400.0, "diameter_mm": 90.0}],
                "bearings": [
                    {"position_mm": 200.0 - span, "axial_n_per_um": 10.0, "speed_table": [row(1000.0, 100.0), row(3000.0, 300.0)]},
                    {"position_mm": 200.0 + span},
                ],
                "coupling": {"position_mm": 0.0, "torsional_nm_per_rad": 1e5, "torsional_damping_nms_per_rad": 3.0, "inertia_kg_m2": 2.0},
                "inertias": [{"position_mm": 10.0, "mass_kg": 1.0, "polar_inertia_kg_m2": 0.1, "diametral_inertia_kg_m2": 0.06}],
            })
        };
        for (pinion_rpm, pinion, gear) in [
            (2000.0, 200.0, 100.0),
            (4000.0, 300.0, 4000.0 * 17.0 / 44.0 * 0.1),
            (100.0, 100.0, 100.0),
            (3000.0, 300.0, 3000.0 * 17.0 / 44.0 * 0.1),
        ] {
            let document = document(json!({"pinion": shaft(150.0), "gear": shaft(150.0)}), |value| {
                value["operation"]["pinion_speed_rpm"] = json!(pinion_rpm);
            });
            let train = train(&document).unwrap();
            for (shaft, stiffness) in [(&train.pinion, pinion), (&train.gear, gear)] {
                let [[xx, xy], [yx, yy]] = shaft.bearings[0].radial_n_per_m;
                for (value, expected) in [(xx, 1.0), (xy, 0.5), (yx, -0.5), (yy, 2.0)] {
                    assert!((value / (expected * stiffness * 1e6) - 1.0).abs() < 1e-12, "{value} at {pinion_rpm}");
                }
                assert!((shaft.bearings[0].radial_damping_n_s_per_m[0][0] / (1e3 * stiffness) - 1.0).abs() < 1e-12);
            }
            let machine = train.pinion.coupling.torsional.unwrap();
            assert_eq!((machine.torsional_damping_nm_s_per_rad, machine.inertia_kg_m2), (3.0, 2.0));
            assert_eq!(train.gear.bodies[0].0, 0.01);
            // 10 N/µm per mm of the 90 mm at the bearing without stiffness.
            assert_eq!(train.gear.bearings[1].radial_n_per_m[0][0], 900e6);
        }
    }

    #[test]
    fn what_is_assumed_and_what_is_replaced_is_told() {
        let told = codes(&document(arrangement(), |_| {}));
        assert!(told.iter().any(|code| code == "assumed-bearings"), "{told:?}");
        for code in ["assumed-supports", "shafts-replace-supports", "undamped-bearings"] {
            assert!(told.iter().all(|told| told != code), "{told:?}");
        }
        let given = document(arrangement(), |value| {
            value["design"]["supports"]["gear_axial_n_per_um"] = json!(7.0);
            let arrangement = &mut value["design"]["shafts"]["arrangement"];
            arrangement["bearing_damping_ns_per_m"] = json!(0.0);
            for name in ["pinion_bearing_radial", "gear_bearing_radial", "gear_bearing_axial"] {
                arrangement[format!("{name}_n_per_um")] = json!(700.0);
            }
        });
        let told = codes(&given);
        assert!(told.iter().all(|code| code != "assumed-bearings"), "{told:?}");
        let report = check(&given).unwrap();
        let replaced = report.warnings.iter().find(|one| one.code == "shafts-replace-supports").unwrap();
        assert_eq!(replaced.pointer, "/design/supports/gear_axial_n_per_um");
        assert!(told.iter().any(|code| code == "undamped-bearings"), "{told:?}");
        assert!(report.supports.is_none());
    }

    #[test]
    fn shafts_that_would_touch_are_refused() {
        let thick = document(arrangement(), |value| {
            value["design"]["shafts"]["arrangement"]["gear_shaft_diameter_mm"] = json!(340.0);
        });
        match check(&thick) {
            Err(crate::DocumentError::Invalid(found)) => {
                assert!(found.iter().all(|one| one.code == "shafts-overlap"), "{found:?}");
                assert_eq!(found[0].pointer, "/design/shafts/arrangement/pinion_shaft_diameter_mm");
            }
            other => panic!("{other:?}"),
        }
        // A body a little wider than the root circle under the faces is no collision.
        let shafts = document(arrangement(), |_| {}).design.resolved_shafts().unwrap();
        let mut pinion = serde_json::to_value(&shafts.pinion).unwrap();
        pinion["segments"][1]["diameter_mm"] = json!(103.0);
        check(&document(json!({"pinion": pinion, "gear": shafts.gear}), |_| {})).unwrap();
    }

    #[test]
    fn values_of_the_arrangement_that_are_left_out_are_derived() {
        let report = check(&document(json!({"arrangement": {}}), |_| {})).unwrap();
        let of = |name: &str| {
            let pointer = format!("/design/shafts/arrangement/{name}");
            let found = report.derived.iter().find(|one| one.pointer == pointer);
            found.unwrap_or_else(|| panic!("no {name}")).value
        };
        // 0.8 of the root circle of 97.03 mm; both halves with the gap are 180 mm wide.
        assert_eq!((of("pinion_shaft_diameter_mm"), of("bearing_span_mm")), (77.62, 335.2));
        assert!(report.derived.iter().all(|one| !one.pointer.starts_with("/design/supports")));
    }
}
