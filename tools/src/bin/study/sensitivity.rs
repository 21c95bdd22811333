//! Sensitivity of the results to the inputs that the source does not report.

use crate::Study;
use crate::ask::{Outcome, number};
use crate::documents::{contact, table1, with};
use crate::page::{change, sig};
use crate::table3::rms;
use serde_json::{Value, json};

/// One assumption: its name, its value, and its changed values (one for each of two columns, or a single one).
struct Assumption {
    name: &'static str,
    stated: String,
    changes: Vec<(String, Vec<(&'static str, Value)>)>,
}

fn halved_and_doubled(name: &'static str, pointer: &'static str, value: f64, unit: &str) -> Assumption {
    let changed = |factor: f64| (format!("{} {unit}", sig(value * factor, 3)), vec![(pointer, json!(value * factor))]);
    Assumption { name, stated: format!("{} {unit}", sig(value, 3)), changes: vec![changed(0.5), changed(2.0)] }
}

/// The pulse of the base document with another length, force kept.
fn pulse(base: &Value, factor: f64) -> Outcome<(String, Vec<(&'static str, Value)>)> {
    let us = number(base, "/impact/duration_us")? * factor;
    let part = us * 1e-6 * number(base, "/geometry/mesh_frequency_hz")?;
    let impact = json!({"source": "given", "force_n": number(base, "/impact/force_n")?, "duration_mesh_periods": part,
        "start_mesh_periods": number(base, "/impact/start_mesh_periods")?});
    Ok((format!("{} µs", sig(us, 3)), vec![("/model/impact", impact)]))
}

/// An assumption with one change.
fn one(name: &'static str, stated: &str, to: &str, changes: Vec<(&'static str, Value)>) -> Assumption {
    Assumption { name, stated: stated.into(), changes: vec![(to.into(), changes)] }
}

fn inertias() -> Assumption {
    Assumption {
        name: "inertias",
        stated: "printed, whole gears".into(),
        changes: vec![
            (
                "printed for one half (doubled)".into(),
                vec![("/design/pinion/inertia_kg_m2", json!(0.13)), ("/design/gear/inertia_kg_m2", json!(7.4))],
            ),
            (
                "solid discs of 2 × 75 mm".into(),
                vec![("/design/pinion/inertia_kg_m2", Value::Null), ("/design/gear/inertia_kg_m2", Value::Null)],
            ),
        ],
    }
}

fn torque_side() -> Assumption {
    one(
        "torque of 800 N·m acts on",
        "pinion",
        "gear (pinion 309 N·m)",
        vec![("/operation/pinion_torque_nm", json!(800.0 * 17.0 / 44.0))],
    )
}

fn face_width() -> Assumption {
    one("face width of 75 mm is", "one half's", "both halves'", vec![("/design/face_width_mm", json!(37.5))])
}

fn pressure_angle_plane() -> Assumption {
    one(
        "pressure angle of 20° is",
        "transverse (as printed)",
        "normal",
        vec![("/design/pressure_angle_plane", json!("normal"))],
    )
}

fn plane_of_motion() -> Assumption {
    one("plane of the equations", "base", "pitch (as printed)", vec![("/model/plane", json!("pitch"))])
}

/// Assumptions of the loaded contact and the assembly.
fn contact_details() -> [Assumption; 4] {
    [
        one("gear bodies held", "at the rim", "at the bores", vec![("/model/mesh_stiffness/body", json!("bore"))]),
        one(
            "contact beyond the path of contact",
            "tip corners may touch",
            "not",
            vec![("/model/mesh_stiffness/corner_contact", json!(false))],
        ),
        one(
            "misalignment in the plane of action",
            "0",
            "12 µm over a half",
            vec![("/design/assembly/in_plane_misalignment_um", json!(12.0))],
        ),
        one("centre distance", "exact", "+50 µm", vec![("/design/assembly/center_distance_error_um", json!(50.0))]),
    ]
}

fn assumptions(base: &Value) -> Outcome<Vec<Assumption>> {
    let mass = |gear: &str| number(base, &format!("/geometry/{gear}/mass_kg"));
    let us = number(base, "/impact/duration_us")?;
    let mut assumptions = vec![
        Assumption {
            name: "length of the pulse",
            stated: format!("{} µs, first touch to theoretical start", sig(us, 3)),
            changes: vec![pulse(base, 0.5)?, pulse(base, 2.0)?],
        },
        one(
            "length of the pulse",
            "the same",
            &format!("{} µs, energy balance", sig(number(base, "/impact/energy_balance_duration_us")?, 4)),
            vec![("/model/impact/duration", json!("energy_balance"))],
        ),
        one("impact", "buffered", "by Zhou", vec![("/model/impact", json!({"source": "zhou2008"}))]),
        one("impact", "buffered", "none", vec![("/model/impact", json!({"source": "none"}))]),
        one(
            "base pitch error of the entering pair",
            "0",
            "8 µm, a single pitch deviation of class 5 (ISO 1328-1)",
            vec![("/model/impact/base_pitch_error_um", json!(8.0))],
        ),
        torque_side(),
        inertias(),
        face_width(),
        pressure_angle_plane(),
        halved_and_doubled("mesh damping ratio (0.1 printed)", "/model/mesh_damping_ratio", 0.1, ""),
        halved_and_doubled("support damping ratio", "/design/supports/damping_ratio", 0.03, ""),
        halved_and_doubled("pinion's lateral support", "/design/supports/pinion_lateral_n_per_um", 600.0, "N/µm"),
        halved_and_doubled("gear's lateral support", "/design/supports/gear_lateral_n_per_um", 600.0, "N/µm"),
        halved_and_doubled(
            "axial spring between the pinion's halves",
            "/design/supports/pinion_halves_axial_n_per_um",
            300.0,
            "N/µm",
        ),
        halved_and_doubled("gear's axial support", "/design/supports/gear_axial_n_per_um", 200.0, "N/µm"),
        halved_and_doubled(
            "axial spring between the gear's halves",
            "/design/supports/gear_halves_axial_n_per_um",
            300.0,
            "N/µm",
        ),
        halved_and_doubled("pinion's mass (disc)", "/design/pinion/mass_kg", mass("pinion")?, "kg"),
        halved_and_doubled("gear's mass (disc)", "/design/gear/mass_kg", mass("gear")?, "kg"),
        plane_of_motion(),
        halved_and_doubled("backlash (2 µm printed)", "/design/backlash_um", 2.0, "µm"),
        one("damping while apart", "acts (as printed)", "does not", vec![("/model/damping_in_gap", json!(false))]),
        one(
            "mesh stiffness",
            "loaded contact, analytic",
            "finite elements",
            vec![("/model/mesh_stiffness/fidelity", json!("fe"))],
        ),
        one(
            "mesh stiffness",
            "loaded contact, analytic",
            "ISO 6336-1",
            vec![("/model/mesh_stiffness", json!({"source": "iso6336"}))],
        ),
        one(
            "stiffness in the equations",
            "mean tangent, course of the transmission error",
            "secant F/δ",
            vec![("/model/mesh_stiffness/law", json!("secant"))],
        ),
    ];
    assumptions.extend(contact_details());
    Ok(assumptions)
}

/// Impact (N, none where there is none), both RMS accelerations, dynamic factor.
fn headline(result: &Value) -> Outcome<[Option<f64>; 4]> {
    let [x, z] = rms(result)?;
    let force = if result["impact"]["source"] == "zhou2008" { "/impact/zhou2008_force_n" } else { "/impact/force_n" };
    Ok([number(result, force).ok(), Some(x), Some(z), Some(number(result, "/response/dynamic_factor")?)])
}

pub(crate) fn write(study: &mut Study) -> Outcome<()> {
    let document = table1()?;
    let base = study.bench.result(&document)?;
    let [force, x, z, factor] = headline(&base)?;
    study.page.say(format!(
        "## What the source does not report\n\nSupports, masses, the pulse, the torque's gear and more are not printed, or can be read in two ways. Each line changes one of them on `examples/table1.json` (ε 3.14; impact {} kN, \
         circumferential {} m/s², axial {} m/s², dynamic factor {}); changes in per cent, for the dynamic factor its new value. None was chosen by looking at the tables: supports are those of this project's reference cases, masses solid discs.",
        sig(force.unwrap_or(0.0) / 1e3, 3), sig(x.unwrap_or(0.0), 3), sig(z.unwrap_or(0.0), 3), sig(factor.unwrap_or(0.0), 3)
    ));
    let (rows, largest) = vary(study, &document, &base, assumptions(&base)?)?;
    study.page.table(
        "assumption | stated | changed to | impact, % | circumferential RMS, % | axial RMS, % | dynamic factor",
        &rows,
    );
    let of = |name: &str| {
        largest.iter().filter(|(.., found)| found == name).map(|(x, ..)| x.max(1.0 / x)).fold(1.0, f64::max)
    };
    let axial = |names: &[&str]| {
        largest
            .iter()
            .filter(|(.., found)| names.contains(&found.as_str()))
            .map(|(_, z, _)| z.max(1.0 / z))
            .fold(1.0, f64::max)
    };
    let masses = ["pinion's mass (disc)", "gear's mass (disc)"];
    let supports = [
        "pinion's lateral support",
        "gear's lateral support",
        "axial spring between the pinion's halves",
        "gear's axial support",
        "axial spring between the gear's halves",
    ];
    let support_x = supports.iter().map(|name| of(name)).fold(1.0, f64::max);
    study.page.claim(
        of("length of the pulse") > 3.0 && of("impact") > 5.0 && support_x < 1.2 && axial(&supports) > 1.2 && of("backlash (2 µm printed)") < 1.0001,
        format!(
            "The circumferential level hangs on the impact: on its length (up to a factor of {}), on being there at all ({}), on the inertias and on errors that add to the deflection. Supports, halved or doubled, move it by {} % at most, but the axial level by up to a factor of {}, the masses by {}: \
             that one cannot be predicted without bearings and bodies. The backlash changes nothing as long as contact is kept: the equations then only see the distance from the flank. \
             No single line comes near the printed levels, but the torque on the gear instead of the pinion halves them.",
            sig(of("length of the pulse"), 2), sig(of("impact"), 2), sig(100.0 * (support_x - 1.0), 1), sig(axial(&supports), 2), sig(axial(&masses), 2)
        ),
    );
    Ok(())
}

/// Ratio of both RMS values to those of the base document, and the assumption's name.
type Ratios = Vec<(f64, f64, String)>;

/// A row for every change of every assumption: assumed value, changed value, changes of the four headline numbers.
fn vary(
    study: &mut Study,
    document: &Value,
    base: &Value,
    assumptions: Vec<Assumption>,
) -> Outcome<(Vec<Vec<String>>, Ratios)> {
    let base_numbers = headline(base)?;
    let (mut rows, mut ratios) = (Vec::new(), Vec::new());
    for assumption in assumptions {
        for (to, changes) in &assumption.changes {
            let result = study.bench.result(&with(document, changes))?;
            let numbers = headline(&result)?;
            let cell = |index: usize| match (numbers[index], base_numbers[index]) {
                (Some(value), Some(from)) => change(value, from),
                _ => "–".into(),
            };
            let contact = result["response"]["contact"].as_str().unwrap_or_default();
            let kept = if contact == "continuous" { String::new() } else { format!(", {contact}") };
            rows.push(vec![
                assumption.name.into(),
                assumption.stated.clone(),
                to.clone(),
                cell(0),
                cell(1),
                cell(2),
                format!("{}{kept}", sig(numbers[3].unwrap_or(0.0), 3)),
            ]);
            let ratio = |index: usize| numbers[index].unwrap_or(1.0) / base_numbers[index].unwrap_or(1.0);
            ratios.push((ratio(1), ratio(2), assumption.name.into()));
        }
    }
    Ok((rows, ratios))
}

/// Assumptions of the result with the contact in the equations.
fn assumptions_of_contact(base: &Value) -> Outcome<Vec<Assumption>> {
    let mass = |gear: &str| number(base, &format!("/geometry/{gear}/mass_kg"));
    let spring = |name: &str| number(base, &format!("/supports/{name}/value"));
    let couplings = [
        "/design/supports/pinion_halves_axial_n_per_um",
        "/design/supports/gear_halves_axial_n_per_um",
        "/design/supports/pinion_halves_lateral_n_per_um",
        "/design/supports/gear_halves_lateral_n_per_um",
        "/design/supports/pinion_halves_torsional_nm_per_rad",
        "/design/supports/gear_halves_torsional_nm_per_rad",
    ];
    let body = |factor: f64| -> Outcome<Vec<(&'static str, Value)>> {
        let changed = |pointer: &'static str| {
            let name = pointer.rsplit('/').next().unwrap_or_default();
            Ok((pointer, json!(factor * spring(name)?)))
        };
        couplings.into_iter().map(changed).collect()
    };
    let [pinion, gear, axial] =
        [spring("pinion_lateral_n_per_um")?, spring("gear_lateral_n_per_um")?, spring("gear_axial_n_per_um")?];
    let mut assumptions = vec![
        Assumption {
            name: "couplings between the halves",
            stated: "of the gear bodies".into(),
            changes: vec![("halved".into(), body(0.5)?), ("doubled".into(), body(2.0)?)],
        },
        one(
            "couplings between the halves",
            "of the gear bodies",
            "the source's: 300 N/µm axially, nothing else",
            couplings
                .into_iter()
                .map(|pointer| (pointer, json!(if pointer.contains("axial") { 300.0 } else { 0.0 })))
                .collect(),
        ),
        halved_and_doubled("pinion's lateral support", "/design/supports/pinion_lateral_n_per_um", pinion, "N/µm"),
        halved_and_doubled("gear's lateral support", "/design/supports/gear_lateral_n_per_um", gear, "N/µm"),
        halved_and_doubled("gear's axial support", "/design/supports/gear_axial_n_per_um", axial, "N/µm"),
        halved_and_doubled("support damping ratio", "/design/supports/damping_ratio", 0.03, ""),
        halved_and_doubled("mesh damping ratio (0.1 printed)", "/model/mesh_damping_ratio", 0.1, ""),
        halved_and_doubled("pinion's mass (disc)", "/design/pinion/mass_kg", mass("pinion")?, "kg"),
        halved_and_doubled("gear's mass (disc)", "/design/gear/mass_kg", mass("gear")?, "kg"),
        inertias(),
        torque_side(),
        face_width(),
        pressure_angle_plane(),
        plane_of_motion(),
        one(
            "backlash (2 µm printed)",
            "2.00 µm",
            "200 µm, usual in practice",
            vec![("/design/backlash_um", json!(200.0))],
        ),
        one("loaded contact", "analytic", "finite elements", vec![("/model/mesh_stiffness/fidelity", json!("fe"))]),
    ];
    assumptions.extend(contact_details());
    Ok(assumptions)
}

/// Writes the sensitivities with the contact in the equations.
pub(crate) fn write_contact(study: &mut Study) -> Outcome<()> {
    let document = contact()?;
    let base = study.bench.result(&document)?;
    let [_, x, z, factor] = headline(&base)?.map(|value| value.unwrap_or(0.0));
    study.page.say(format!(
        "### What that answer rests on\n\nEach line changes one thing on `examples/contact.json` (circumferential {} m/s², axial {} m/s², dynamic factor {}); changes in per cent, for the dynamic factor its new value.",
        sig(x, 3), sig(z, 3), sig(factor, 3)
    ));
    let (rows, largest) = vary(study, &document, &base, assumptions_of_contact(&base)?)?;
    let rows: Vec<_> = rows
        .into_iter()
        .map(|mut row| {
            row.remove(3);
            row
        })
        .collect();
    study
        .page
        .table("assumption | stated | changed to | circumferential RMS, % | axial RMS, % | dynamic factor", &rows);
    let of = |names: &[&str], axial: bool| {
        let named = largest.iter().filter(|(.., found)| names.contains(&found.as_str()));
        named.map(|(x, z, _)| if axial { *z } else { *x }).map(|v| v.max(1.0 / v)).fold(1.0, f64::max)
    };
    let supports = ["pinion's lateral support", "gear's lateral support", "gear's axial support"];
    let couplings = ["couplings between the halves"];
    let damping = of(&["mesh damping ratio (0.1 printed)"], false);
    let inertia = of(&["inertias"], false);
    study.page.claim(
        of(&supports, false) < 1.3 && of(&couplings, true) > 1.3 && of(&["backlash (2 µm printed)"], false) < 1.0001 && damping > 1.1,
        format!(
            "Supports that were assumed, halved or doubled, move the circumferential RMS by {} % at most, the axial one by {} %; the couplings of the bodies the axial one by up to a factor of {}. The mesh's damping counts ({} for half or double), the inertias ({}), whether 75 mm is one half's face or both halves' ({}), \
             and above all misalignment, which sets the halves against each other: along the axis by a factor of {}. The dynamic factor hardly moves. So the axial level still depends on what the drawing of the body says and on how well the axes are aligned; the circumferential level is known to some tens of per cent.",
            sig(100.0 * (of(&supports, false) - 1.0), 2), sig(100.0 * (of(&supports, true) - 1.0), 2), sig(of(&couplings, true), 2), sig(damping, 2), sig(inertia, 2),
            sig(of(&["face width of 75 mm is"], false), 2), sig(of(&["misalignment in the plane of action"], true), 2)
        ),
    );
    Ok(())
}
