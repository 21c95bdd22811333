//! REXS: the exchange format for gear units of the FVA (Forschungsvereinigung Antriebstechnik), versions 1.0 to 2.0.0.

mod center;
mod choice;
mod export;
mod flanks;
mod geometry;
mod json;
mod leftover;
mod model;
mod operation;
mod pair;
mod position;
mod shafts;
mod stages;
mod tools;
mod tooth;
mod train;
mod view;
mod xml;

use crate::ImportOptions;
use crate::container::{ModelFile, Syntax};
use crate::draft::{Draft, Reading};
use crate::refusal::{Refusal, short};
use crate::report::{Import, ImportSource, ImportedPair};
use crate::unit::{Quantity, clean};
pub(crate) use center::SAME_DISTANCE_MM;
pub use export::{ExportForm, ExportOptions, export_rexs};
pub(crate) use geometry::{Basic, DEFAULT_GAP_MM};
use herringbone_job::document::JobDocument;
use herringbone_job::study::{CheckReport, CheckedJob};
use herringbone_job::{DocumentError, Violation};
use model::Model;
use pair::{MEMBERS, Pair};
use serde_json::Value;
use train::Train;
use view::{View, difference, dot};

/// Newest version whose ids are known.
const NEWEST: (u32, u32) = (2, 0);

/// Makes a document of a model.
///
/// # Errors
/// [`Refusal`] with every reason found.
pub(crate) fn import(file: &ModelFile, options: &ImportOptions) -> Result<Import, Refusal> {
    let raw = match file.syntax {
        Syntax::Xml => xml::read(&file.text)?,
        Syntax::Json => json::read(&file.text)?,
    };
    let model = Model::new(raw)?;
    let count = model.of_kind("cylindrical_stage").count();
    if count > stages::MAX_STAGES {
        let detail = format!("has {count} cylindrical stages; permitted: {}", stages::MAX_STAGES);
        return Err(Refusal::unreadable("too-large", detail));
    }
    let plain = View::new(&model, None);
    let found = stages::find(&plain);
    let choice = choice::choose(&model, &found, options)?;
    let halves = choice.candidate.halves.clone();
    let train = Train::of(&Pair { view: &plain, halves: halves.clone(), mirrored: choice.mirrored });
    let case = operation::chosen_case(
        &Pair { view: &plain, halves: halves.clone(), mirrored: choice.mirrored },
        &train,
        options.point,
    )
    .map_err(|detail| {
        Refusal::invalid("There is no such operating point.", vec![Violation::new("/point", "out-of-range", detail)])
    })?;
    let view = View::new(&model, case);
    let pair = Pair { view: &view, halves, mirrored: choice.mirrored };

    let mut draft = Draft::default();
    of_file(&model, file, &mut draft);
    let label = choice.candidate.label(&model);
    if let Some(note) = choice.note {
        draft.warn("not-mirrored", "", format!("{label} {note}"));
    }
    if choice.mirrored {
        let kind = pair.halves[0].kind_of_teeth();
        let detail = format!("{label} is {kind}: each half is a copy of the stage, and the torque is doubled");
        draft.warn("mirrored", "", detail);
    }
    draft.set("/name", label.chars().take(herringbone_job::document::MAX_NAME_CHARS).collect::<String>());
    let basic = geometry::write(&pair, &mut draft, options.gap_width_mm);
    let mut operating_points = Vec::new();
    if let Some(basic) = &basic {
        let teeth = tooth::write(&pair, &mut draft, basic);
        flanks::write(&pair, &mut draft, basic, &teeth);
        stagger(&pair, &mut draft);
        operating_points = operation::write(&pair, &mut draft, basic, &train, options);
        shafts::write(&pair, &mut draft, basic, &teeth);
    }
    if !draft.errors.is_empty() {
        return Err(draft.refused(&format!("pair {label}")));
    }
    let document = finish(&pair, &mut draft)?;
    leftover::report(&view, &mut draft);
    let source = ImportSource {
        format: "rexs".to_owned(),
        version: model.version.clone(),
        application: model.application.clone(),
        ..ImportSource::default()
    };
    let stages = choice.candidate.ids(&model);
    let pair = ImportedPair { number: choice.number, label, stages, mirrored: choice.mirrored };
    let alternatives = choice::alternatives(&model, &found, choice.number);
    Ok(draft.into_import(source, (pair, alternatives), (document, operating_points)))
}

/// Warnings of the file as a whole.
fn of_file(model: &Model, file: &ModelFile, draft: &mut Draft) {
    match model.version_number() {
        Some(version) if version > NEWEST => {
            draft.warn(
                "newer-version",
                "",
                format!("REXS {}: newer than the versions known, 1.0 to 2.0.0", model.version),
            );
        }
        Some(_) => {}
        None => draft.warn("no-version", "", "the file does not say its version of REXS: read as 1.7"),
    }
    if !model.dangling.is_empty() {
        let detail = format!("relations lead to components that are not there: {}", model.dangling.join("; "));
        draft.warn("dangling-reference", "", detail);
    }
    for other in &file.others {
        draft.ignore(short(other), "another file of the archive", None);
    }
    let external = (0..model.components.len())
        .find(|handle| model.components[*handle].attributes.iter().any(|attribute| attribute.id == "data_source"));
    if let Some(handle) = external {
        let detail =
            format!("{} refers to data outside of the model (data_source), which is not followed", model.label(handle));
        draft.warn("external-source", "", detail);
    }
}

/// Stagger of the halves by the axes through their first teeth.
fn stagger(pair: &Pair, draft: &mut Draft) {
    let pointer = "/design/half_stagger";
    let default = [0.0, 0.0, 1.0];
    let axes: Vec<_> = pair.gears(0).into_iter().map(|gear| pair.view.direction(gear, "w_axis_vector")).collect();
    let [Some(left), Some(right)] = axes.as_slice() else {
        draft.assume(
            pointer,
            0.0,
            if pair.mirrored { "halves mirrored at the gap" } else { "no axes of the gears in the file" },
        );
        return;
    };
    if *left == default && *right == default {
        draft.assume(pointer, 0.0, "the axes of the gears have their default, which says nothing of the teeth");
        return;
    }
    let axis = pair.view.direction(pair.shaft(0), "u_axis_vector").unwrap_or([1.0, 0.0, 0.0]);
    let across = |vector: [f64; 3]| {
        let along = dot(vector, axis);
        difference(vector, axis.map(|number| number * along))
    };
    let (left, right) = (across(*left), across(*right));
    let cross = [
        left[1] * right[2] - left[2] * right[1],
        left[2] * right[0] - left[0] * right[2],
        left[0] * right[1] - left[1] * right[0],
    ];
    let angle_rad = dot(cross, axis).atan2(dot(left, right));
    let fraction = (angle_rad / std::f64::consts::TAU * pair.teeth(0)).rem_euclid(1.0);
    let fraction = if !(1e-9..=1.0 - 1e-9).contains(&fraction) { 0.0 } else { clean(fraction) };
    let gears: Vec<_> =
        pair.gears(0).into_iter().map(|gear| format!("{}.w_axis_vector", pair.model().label(gear))).collect();
    let why = "angle between the first teeth of the pinion's halves over the pitch angle";
    draft.take_word(pointer, fraction, &gears.join(", "), angle_rad.to_degrees().into(), why);
}

/// Reads the document as the service does, and compares it with the results in the file.
fn finish(pair: &Pair, draft: &mut Draft) -> Result<Value, Refusal> {
    let mut document = parsed(draft)?;
    let mut report = checked(&document, draft);
    if report.is_none() && document.design.shafts.is_some() {
        // Checked again without shafts that do not fit.
        document = parsed(draft)?;
        report = checked(&document, draft);
    }
    if let Some(report) = &report {
        if document.design.shafts.is_none() && add_masses(pair, draft, report) {
            document = parsed(draft)?;
        }
        compare(pair, draft, report);
    }
    serde_json::to_value(&document).map_err(|error| {
        Refusal::invalid("The document cannot be written.", vec![Violation::new("", "conflict", error.to_string())])
    })
}

fn of_shafts(violation: &Violation) -> bool {
    violation.pointer.starts_with(shafts::SHAFTS)
}

/// Takes shafts that the document cannot have out again.
fn drop_shafts(draft: &mut Draft, violations: &[Violation]) {
    for violation in violations.iter().filter(|one| of_shafts(one)) {
        let detail = format!("shafts and bearings are not taken: {} {}", violation.pointer, violation.detail);
        draft.warn("shafts-not-taken", shafts::SHAFTS, detail);
    }
    draft.remove(shafts::SHAFTS);
}

/// The document, without its shafts where these are not valid.
///
/// # Errors
/// [`Refusal`] with the fields out of range and where they stand in the file.
pub(crate) fn parsed(draft: &mut Draft) -> Result<JobDocument, Refusal> {
    loop {
        let violations = match herringbone_job::parse_value(&draft.document) {
            Ok(document) => return Ok(document),
            Err(DocumentError::Invalid(violations) | DocumentError::Unsupported(violations)) => violations,
            Err(error @ DocumentError::Malformed { .. }) => vec![Violation::new("", "conflict", error.to_string())],
        };
        if draft.document.pointer(shafts::SHAFTS).is_some() && violations.iter().any(of_shafts) {
            drop_shafts(draft, &violations);
            continue;
        }
        let origin = |violation: &Violation| {
            let line = draft.taken.iter().find(|line| violation.pointer == line.pointer)?;
            Some(format!("{} (from {})", violation.detail, line.from))
        };
        let errors: Vec<_> = violations
            .iter()
            .map(|violation| Violation {
                detail: origin(violation).unwrap_or(violation.detail.clone()),
                ..violation.clone()
            })
            .collect();
        return Err(Refusal::invalid(format!("{} value(s) of the file are out of range.", errors.len()), errors));
    }
}

/// What the service says of the document; `None` where it cannot be solved as it is, with the reasons as warnings.
pub(crate) fn checked(document: &JobDocument, draft: &mut Draft) -> Option<CheckReport> {
    let violations = match CheckedJob::new(document.clone()) {
        Ok(job) => return Some(job.report()),
        Err(DocumentError::Invalid(violations) | DocumentError::Unsupported(violations)) => violations,
        Err(DocumentError::Malformed { .. }) => Vec::new(),
    };
    if document.design.shafts.is_some() && violations.iter().all(of_shafts) {
        drop_shafts(draft, &violations);
        return None;
    }
    for violation in violations {
        let detail = format!("the document cannot be solved as it is: {}", violation.detail);
        draft.warn(&violation.code, &violation.pointer, detail);
    }
    None
}

/// Adds the moments of inertia of additional masses to those of the discs.
fn add_masses(pair: &Pair, draft: &mut Draft, report: &CheckReport) -> bool {
    if pair.mirrored {
        return false;
    }
    let mut added = false;
    for (member, name) in MEMBERS.into_iter().enumerate() {
        let model = pair.model();
        let masses = model.parts(pair.shaft(member)).into_iter().filter(|part| model.kind(*part) == "additional_mass");
        let readings: Vec<Reading> = masses
            .filter_map(|mass| pair.view.non_zero(mass, "moment_of_inertia_u_axis", Quantity::Inertia))
            .filter(|reading| reading.value > 0.0)
            .collect();
        if readings.is_empty() {
            continue;
        }
        let disc_kg_m2 = [&report.geometry.pinion, &report.geometry.gear][member].inertia_kg_m2;
        let sum = disc_kg_m2 + readings.iter().map(|reading| reading.value).sum::<f64>();
        let pointer = format!("/design/{name}/inertia_kg_m2");
        draft.take(&pointer, clean(sum), &readings, "additional masses and the gear as a solid disc");
        added = true;
    }
    added
}

/// Compares results in the file with those of the document.
fn compare(pair: &Pair, draft: &mut Draft, report: &CheckReport) {
    let geometry = &report.geometry;
    let ratios = [
        ("transverse contact ratio", "radial_contact_ratio", geometry.transverse_contact_ratio),
        ("overlap ratio", "overlap_contact_ratio", geometry.overlap_ratio),
        ("total contact ratio", "total_contact_ratio", geometry.total_contact_ratio),
    ];
    for stage in pair.stages() {
        for (name, id, ours) in ratios {
            if let Some(reading) = pair.view.non_zero(stage, id, Quantity::Number) {
                draft.check(name, &reading, ours, "");
            }
        }
    }
    for (member, of) in [&geometry.pinion, &geometry.gear].into_iter().enumerate() {
        let diameters = [
            ("reference diameter", "reference_circle_diameter", of.reference_diameter_mm),
            ("base diameter", "base_circle_diameter", of.base_diameter_mm),
        ];
        for gear in pair.gears(member) {
            for (name, id, ours) in diameters {
                if let Some(reading) = pair.view.non_zero(gear, id, Quantity::Length) {
                    draft.check(&format!("{name}, {}", MEMBERS[member]), &reading, ours, "mm");
                }
            }
        }
    }
}
