//! Random valid job documents for tests, over the full range of every field. They are generated from the declarations
//! of the fields: a new field needs an entry here only if a rule between fields could refuse its values.

use super::schema::job_document_schema;
use proptest::prelude::*;
use proptest::sample::select;
use serde_json::{Map, Value, json};

/// JSON of a valid job document. Whether the gear can exist is another matter.
pub(crate) fn documents() -> BoxedStrategy<Value> {
    let any = of_schema(&job_document_schema()).prop_map(|mut document| {
        reconcile(&mut document);
        document
    });
    any.boxed()
}

/// Strategy for the values that a JSON Schema permits. The ends of a range are as frequent as the values between them.
fn of_schema(schema: &Value) -> BoxedStrategy<Value> {
    let word = schema["type"].as_str().or_else(|| schema["type"][0].as_str()).unwrap_or_default();
    let bound = |name: &str| schema[name].as_f64().unwrap_or_default();
    let (min, max) = (bound("minimum"), bound("maximum"));
    if let Value::Array(words) = &schema["enum"] {
        return select(words.clone()).boxed();
    }
    match word {
        "object" => of_object(schema),
        "number" => prop_oneof![
            Just(min),
            Just(max),
            (0.0..=1.0f64).prop_map(move |part| (min + part * (max - min)).clamp(min, max)),
            // As many small values as large ones.
            (0.0..=1.0f64).prop_map(move |part| (min + (max - min) * 10f64.powf(-12.0 * part)).clamp(min, max)),
        ]
        .prop_map(|number| json!(number))
        .boxed(),
        "integer" => prop_oneof![Just(min as u64), Just(max as u64), min as u64..=max as u64]
            .prop_map(|number| json!(number))
            .boxed(),
        "boolean" => any::<bool>().prop_map(Value::Bool).boxed(),
        "string" => {
            let most = schema["maxLength"].as_u64().unwrap_or(20) as usize;
            let letter = any::<char>().prop_map(|letter| if letter.is_control() { '·' } else { letter });
            let length = prop_oneof![5 => 0..=most.min(20), 1 => Just(most)];
            length
                .prop_flat_map(move |length| proptest::collection::vec(letter.clone(), length))
                .prop_map(|letters| Value::String(letters.into_iter().collect()))
                .boxed()
        }
        "array" => {
            let least = schema["minItems"].as_u64().unwrap_or(0) as usize;
            let most = (schema["maxItems"].as_u64().unwrap_or(8) as usize).min(least + 6);
            proptest::collection::vec(of_schema(&schema["items"]), least..=most).prop_map(Value::Array).boxed()
        }
        other => panic!("fields of type {other:?} are not known here"),
    }
}

/// Objects with every required member and about half of the optional ones, a few of which are null.
fn of_object(schema: &Value) -> BoxedStrategy<Value> {
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    let fields = schema["properties"].as_object().into_iter().flatten().map(|(name, field)| {
        let value = of_schema(field);
        let entry = match required.contains(&json!(name)) {
            true => value.prop_map(Some).boxed(),
            false => prop_oneof![8 => value.prop_map(Some), 1 => Just(Some(Value::Null)), 9 => Just(None)].boxed(),
        };
        (Just(name.clone()), entry)
    });
    fields
        .collect::<Vec<_>>()
        .prop_map(|fields| {
            Value::Object(fields.into_iter().filter_map(|(name, value)| Some((name, value?))).collect::<Map<_, _>>())
        })
        .boxed()
}

/// Changes the values that the rules between fields forbid.
fn reconcile(document: &mut Value) {
    let is_sweep = document["kind"] == "sweep";
    axes(document, is_sweep);
    evaluations(document);
    // The excess of a gear's face width over that of the design has to fit into the gap.
    let of = |name: &str, default: f64| document["design"][name].as_f64().unwrap_or(default);
    let widest_mm = of("face_width_mm", 0.5) + of("gap_width_mm", 30.0);
    for gear in ["pinion", "gear"] {
        let gear = &mut document["design"][gear];
        if let Some(width_mm) = gear["face_width_mm"].as_f64() {
            gear["face_width_mm"] = json!(width_mm.min(widest_mm));
        }
        // Mating halves have opposite hands; left out, they do.
        gear.as_object_mut().map(|gear| gear.remove("left_half_hand"));
        reliefs(gear);
        for half in ["left", "right"] {
            if gear[half].is_object() {
                reliefs(&mut gear[half]);
            }
        }
        if gear["coast"].is_object() {
            let coast = &mut gear["coast"];
            reliefs(coast);
            for half in ["left", "right"] {
                if coast[half].is_object() {
                    reliefs(&mut coast[half]);
                }
            }
        }
    }
    if document["design"]["shafts"].is_object() {
        shafts(document);
    }
    if let Some(analysis) = document.get_mut("analysis").filter(|analysis| analysis.is_object()) {
        periods(analysis);
    }
    if let Some(model) = document.get_mut("model").filter(|model| model.is_object()) {
        given(model);
    }
}

fn axes(document: &mut Value, is_sweep: bool) {
    let Some(fields) = document.as_object_mut() else { return };
    if !is_sweep {
        ["axes", "continuation", "record"].iter().for_each(|name| drop(fields.remove(*name)));
        return;
    }
    fields.remove("sweep_point");
    let one = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 300, "to": 6000}]);
    let axes = fields.entry("axes").or_insert(Value::Null);
    if !axes.is_array() {
        *axes = one;
    }
    for axis in axes.as_array_mut().into_iter().flatten() {
        // Within the point limits of two axes and of rows with Poincaré points or spectra.
        axis["points"] = json!(axis["points"].as_u64().unwrap_or(50).min(70));
        if axis["values"].is_array() {
            axis["from"] = Value::Null;
            axis["to"] = Value::Null;
        } else {
            let or = |value: &Value, other: f64| json!(value.as_f64().unwrap_or(other));
            (axis["from"], axis["to"]) = (or(&axis["from"], 1.0), or(&axis["to"], 2.0));
            if [&axis["from"], &axis["to"]].iter().any(|end| end.as_f64().is_some_and(|end| end <= 0.0)) {
                axis["spacing"] = json!("linear");
            }
        }
    }
}

/// Jobs of many evaluations: lists of their own, as rules between fields want them.
fn evaluations(document: &mut Value) {
    let kind = document["kind"].as_str().unwrap_or("response").to_owned();
    let Some(fields) = document.as_object_mut() else { return };
    let all = [
        "operating_points",
        "variables",
        "objectives",
        "constraints",
        "robust",
        "budget",
        "method",
        "tolerances",
        "correlations",
        "measures",
        "limits",
        "samples",
        "sampling",
        "sensitivity",
        "seed",
    ];
    let own: &[&str] = match kind.as_str() {
        "optimise" => &["operating_points", "budget", "method", "seed"],
        "tolerance" => &["operating_points", "seed"],
        _ => &[],
    };
    all.iter().filter(|name| !own.contains(name)).for_each(|name| drop(fields.remove(*name)));
    let measure = json!({"measure": "/mesh/transmission_error_pp_um"});
    match kind.as_str() {
        "optimise" => {
            let pointer = "/design/pinion/lead_crowning_um";
            fields.insert("variables".to_owned(), json!([{"pointer": pointer, "from": 0, "to": 20}]));
            fields.insert("objectives".to_owned(), json!([measure]));
            fields.insert("constraints".to_owned(), json!([{"margin": "tip-thickness", "at_least": 0.2}]));
        }
        "tolerance" => {
            let pointer = "/design/pinion/helix_slope_um";
            fields.insert("tolerances".to_owned(), json!([{"pointer": pointer, "tolerance": 5}]));
            fields.insert("measures".to_owned(), json!([measure]));
        }
        _ => return,
    }
    fields.remove("sweep_point");
}

/// Shafts that carry their gears: the places follow from the faces, the other numbers stay as they are where they can.
fn shafts(document: &mut Value) {
    let design = &mut document["design"];
    let of = |object: &Value, name: &str, default: f64| object[name].as_f64().unwrap_or(default);
    let width_mm = of(design, "face_width_mm", 0.5);
    let gap_mm = of(design, "gap_width_mm", 30.0);
    let module_mm = of(design, "normal_module_mm", 0.1);
    let cos_helix = of(design, "helix_angle_deg", 0.0).to_radians().cos();
    let mut widest_mm: f64 = 0.0;
    for name in ["pinion", "gear"] {
        let gear = &design[name];
        let outer_mm = 0.5 * (gap_mm + width_mm + of(gear, "face_width_mm", width_mm));
        let height = of(gear, "addendum", 1.0) + of(gear, "profile_shift", 0.0) + of(gear, "tip_alteration", 0.0);
        let tip_mm = module_mm * (of(gear, "teeth", 5.0) / cos_helix + 2.0 * height);
        widest_mm = widest_mm.max(outer_mm);
        if design["shafts"][name].is_object() {
            shaft(&mut design["shafts"][name], outer_mm, tip_mm);
        }
    }
    let shafts = &mut design["shafts"];
    let is_given = shafts["pinion"].is_object() && shafts["gear"].is_object();
    if !is_given && !shafts["arrangement"].is_object() {
        shafts["arrangement"] = json!({});
    }
    if let Some(span_mm) = shafts["arrangement"]["bearing_span_mm"].as_f64() {
        shafts["arrangement"]["bearing_span_mm"] = json!(span_mm.max(2.0 * widest_mm));
    }
    if shafts["gear"].is_object() {
        let bearing = &mut shafts["gear"]["bearings"][0];
        bearing["axial_n_per_um"] = json!(bearing["axial_n_per_um"].as_f64().unwrap_or(1.0).max(1.0));
    }
    if document["model"]["mesh_stiffness"]["body"] == "bore" {
        document["model"]["mesh_stiffness"]["body"] = json!("rim");
    }
}

fn shaft(shaft: &mut Value, outer_mm: f64, tip_mm: f64) {
    let number = |value: &Value, default: f64| value.as_f64().unwrap_or(default);
    let mut segments: Vec<Value> = shaft["segments"].as_array().cloned().unwrap_or_default();
    // No more than positions can reach.
    segments.resize(3, segments[0].clone());
    let body = 1;
    let mut position_mm = 0.0;
    for (index, segment) in segments.iter_mut().enumerate() {
        let mut diameter_mm = number(&segment["diameter_mm"], 1.0);
        if index == body {
            diameter_mm = diameter_mm.min(tip_mm).max(0.5);
            segment["length_mm"] = json!(2.0 * outer_mm + 0.2);
            shaft["gear_position_mm"] = json!(position_mm + outer_mm + 0.1);
        }
        segment["diameter_mm"] = json!(diameter_mm);
        segment["bore_mm"] = json!(number(&segment["bore_mm"], 0.0).min(0.5 * diameter_mm));
        position_mm += number(&segment["length_mm"], 1.0);
    }
    let length_mm = position_mm;
    let beside_mm = [number(&shaft["gear_position_mm"], 0.0) - outer_mm, length_mm - 2.0 * outer_mm];
    let beside_mm = [beside_mm[0], beside_mm[1] - beside_mm[0]];
    shaft["segments"] = json!(segments);
    let bearings = shaft["bearings"].as_array_mut().expect("a required list");
    let count = bearings.len() as f64;
    for (index, bearing) in bearings.iter_mut().enumerate() {
        let part = (index as f64 + 1.0) / (count + 1.0);
        bearing["position_mm"] = match index % 2 {
            0 => json!(part * beside_mm[0]),
            _ => json!(length_mm - part * beside_mm[1]),
        };
        bearing["tilting_nm_per_rad"] = json!(number(&bearing["tilting_nm_per_rad"], 1.0).max(1.0));
        let radial = ["radial_n_per_um", "radial_x_n_per_um", "radial_y_n_per_um"];
        if bearing["speed_table"].as_array().is_some_and(|rows| !rows.is_empty()) {
            for name in radial.into_iter().chain(["radial_damping_ns_per_m"]) {
                bearing[name] = Value::Null;
            }
            bearing["speed_table"].as_array_mut().into_iter().flatten().enumerate().for_each(speed_row);
        } else {
            for name in radial {
                if let Some(stiffness) = bearing[name].as_f64() {
                    bearing[name] = json!(stiffness.max(1e-3));
                }
            }
        }
    }
    let coupling = &mut shaft["coupling"];
    coupling["position_mm"] = json!(number(&coupling["position_mm"], 0.0) / 50_000.0 * length_mm);
    if coupling["torsional_nm_per_rad"].is_null() || coupling["inertia_kg_m2"].is_null() {
        for name in ["torsional_nm_per_rad", "inertia_kg_m2", "torsional_damping_nms_per_rad"] {
            coupling[name] = Value::Null;
        }
    }
    if shaft["half_body"].is_object() {
        inertias(&mut shaft["half_body"]);
    }
    for inertia in shaft.get_mut("inertias").and_then(Value::as_array_mut).into_iter().flatten() {
        inertia["position_mm"] = json!(number(&inertia["position_mm"], 0.0) / 50_000.0 * length_mm);
        inertias(inertia);
    }
}

fn inertias(body: &mut Value) {
    let of = |name: &str| body[name].as_f64().unwrap_or_default();
    body["diametral_inertia_kg_m2"] = json!(of("diametral_inertia_kg_m2").max(0.5 * of("polar_inertia_kg_m2")));
}

/// A row of a bearing's table with ascending speed, stable and dissipative.
fn speed_row((index, row): (usize, &mut Value)) {
    row["speed_rpm"] = json!(100.0 * index as f64);
    for (kind, unit, largest) in [("stiffness", "n_per_um", 1e7), ("damping", "ns_per_m", 1e12)] {
        let name = |axes: &str| format!("{kind}_{axes}_{unit}");
        let main = ["xx", "yy"].map(|axes| row[name(axes)].as_f64().unwrap_or_default().max(1.0));
        let bound = 0.9 * main[0].min(main[1]);
        for (axes, value) in ["xx", "yy"].into_iter().zip(main) {
            row[name(axes)] = json!(value);
        }
        for axes in ["xy", "yx"] {
            let value = row[name(axes)].as_f64().unwrap_or_default();
            row[name(axes)] = json!(value / largest * bound);
        }
    }
}

/// Gives every relief a positive length.
fn reliefs(flank: &mut Value) {
    for name in ["tip_relief", "end_relief"] {
        if flank[name].is_object() {
            let length_mm = flank[name]["length_mm"].as_f64().unwrap_or_default();
            flank[name]["length_mm"] = json!(length_mm.max(1e-3));
        }
    }
}

fn periods(analysis: &mut Value) {
    let of = |value: &Value, default: u64| value.as_u64().unwrap_or(default);
    let recorded = of(&analysis["record_mesh_periods"], 100).min(of(&analysis["mesh_periods"], 300));
    analysis["record_mesh_periods"] = json!(recorded);
    let samples = of(&analysis["samples_per_mesh_period"], 256).min(4_000_000 / recorded);
    analysis["samples_per_mesh_period"] = json!(samples);
}

fn given(model: &mut Value) {
    let source = model["mesh_stiffness"]["source"].as_str().unwrap_or("ltca").to_owned();
    if source != "ltca" && model["mesh_force"] == "contact" {
        model["mesh_force"] = json!("stiffness");
    }
    if source == "ltca" && model["excitation_um"].is_object() {
        model["mesh_force"] = json!("stiffness");
    }
    let stiffness = &mut model["mesh_stiffness"];
    if stiffness["source"] == "given" {
        match stiffness["samples_n_per_um"].is_array() {
            true => stiffness["mean_n_per_um"] = Value::Null,
            false => stiffness["mean_n_per_um"] = json!(stiffness["mean_n_per_um"].as_f64().unwrap_or(900.0)),
        }
        for harmonic in stiffness["harmonics"].as_array_mut().into_iter().flatten() {
            harmonic["amplitude"] = json!(harmonic["amplitude"].as_f64().unwrap_or_default() / 65.0);
        }
    }
    let impact = &mut model["impact"];
    if impact["source"] == "given" {
        for (name, default) in [("force_n", 3000.0), ("duration_mesh_periods", 0.1)] {
            impact[name] = json!(impact[name].as_f64().unwrap_or(default));
        }
    }
}

/// JSON pointer and value of every member of a document.
fn pointers(document: &Value) -> Vec<(String, Value)> {
    let mut places = Vec::new();
    let mut open = vec![(String::new(), document)];
    while let Some((pointer, value)) = open.pop() {
        match value {
            Value::Object(members) => {
                open.extend(members.iter().map(|(name, value)| (format!("{pointer}/{name}"), value)));
            }
            Value::Array(items) => {
                open.extend(items.iter().enumerate().map(|(index, value)| (format!("{pointer}/{index}"), value)));
            }
            _ => {}
        }
        places.push((pointer, value.clone()));
    }
    places
}

/// Whether numbers are declared at a pointer.
fn is_number(pointer: &str) -> bool {
    let fields = super::schema::field_descriptions();
    // The items of a list have the declaration of all of them.
    let is_index = |step: &str| !step.is_empty() && step.bytes().all(|digit| digit.is_ascii_digit());
    let steps = pointer.split('/').map(|step| if is_index(step) { "*" } else { step });
    let pointer = steps.collect::<Vec<_>>().join("/");
    let field = fields.iter().find(|field| field.pointer == pointer);
    field.is_some_and(|field| field.schema["type"] == "number" || field.schema["type"] == "integer")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, ..ProptestConfig::default() })]

    /// Parse, fill in, write out, parse: the same document, and the same text when written again.
    #[test]
    fn a_valid_document_written_out_reads_back_as_itself(value in documents()) {
        let text = value.to_string();
        let document = super::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error:?}: {text}"));
        let written = serde_json::to_string(&document).expect("numbers and texts");
        let again = super::parse(written.as_bytes()).unwrap_or_else(|error| panic!("{error:?}: {written}"));
        prop_assert_eq!(&again, &document);
        prop_assert_eq!(serde_json::to_string(&again).expect("numbers and texts"), written);
    }

    /// Reading fills in defaults and changes no given value.
    #[test]
    fn what_is_given_is_kept(value in documents()) {
        let written = serde_json::to_value(super::parse_value(&value).expect("valid")).expect("numbers and texts");
        for pointer in ["/name", "/design/normal_module_mm", "/design/gear/tip_relief/amount_um", "/operation/pinion_torque_nm",
                        "/design/supports/gear_axial_n_per_um", "/design/shafts/arrangement/bearing_span_mm",
                        "/design/shafts/pinion/bearings/0/axial_n_per_um", "/design/shafts/gear/coupling/axial_friction_n",
                        "/model/mesh_damping_ns_per_m", "/model/excitation_um/left", "/analysis/accuracy", "/axes/0/pointer"] {
            if let Some(given) = value.pointer(pointer).filter(|given| !given.is_null()) {
                prop_assert_eq!(written.pointer(pointer), Some(given), "{}", pointer);
            }
        }
    }

    /// Assigning a number by its slot is equivalent to reading the document with that number: the same document, or the
    /// same violations. Slots exist exactly for the values of the serialized document.
    #[test]
    fn what_is_set_is_what_would_be_read(value in documents(), place in any::<prop::sample::Index>(), part in 0.0..=1.0f64, whole: bool) {
        let document = super::parse_value(&value).expect("valid").without_sweep();
        let written = serde_json::to_value(&document).expect("numbers and texts");
        let places = pointers(&written);
        for (pointer, value) in &places {
            let slot = document.clone().slot(pointer).map(|slot| slot.is_number());
            prop_assert_eq!(slot, Some(value.is_number() || value.is_null() && is_number(pointer)), "{}", pointer);
        }
        for pointer in ["/axes", "/design/pinon", "/design/pinion/teeth/0", "design", "/analysis/initial_state/24"] {
            prop_assert!(document.clone().slot(pointer).is_none(), "{}", pointer);
        }
        let numbers: Vec<_> = places
            .iter()
            .filter(|(pointer, _)| document.clone().slot(pointer).unwrap().is_number())
            .collect();
        let (pointer, old) = numbers[place.index(numbers.len())];
        // From a tenth below to a tenth above the largest range, whole or not; else near the old value.
        let scale = old.as_f64().unwrap_or(1.0).abs().max(0.5);
        let number = (part - 0.1) * 1.2 * scale * 4.0;
        let number = if whole { number.round() } else { number };
        let mut changed = document.clone();
        let refused = changed.slot(pointer).unwrap().set(number).err();
        let refused = refused.map(|violation| super::Violation { pointer: pointer.clone(), ..*violation });
        let is_refused = refused.is_some();
        let set = changed.checked(refused.into_iter().collect());
        let mut value = written;
        *value.pointer_mut(pointer).unwrap() = json!(number);
        match (set, super::parse_value(&value)) {
            (Ok(set), Ok(read)) => prop_assert_eq!(set, read, "{} = {}", pointer, number),
            (Err(super::DocumentError::Invalid(set)), Err(super::DocumentError::Invalid(mut read))) => {
                // The reader goes on with a default in place of a number that it refuses, which may break rules.
                read.retain(|violation| {
                    !is_refused || violation.pointer == *pointer && violation.code != "conflict"
                });
                prop_assert_eq!(set, read, "{} = {}", pointer, number);
            }
            (set, read) => prop_assert!(false, "{} = {}: {:?} but {:?}", pointer, number, set, read),
        }
    }

    /// Bytes that nearly are a document: refused or read, never a panic.
    #[test]
    fn a_document_with_one_byte_changed_is_read_or_refused(value in documents(), place in any::<prop::sample::Index>(), byte: u8) {
        let mut bytes = value.to_string().into_bytes();
        let index = place.index(bytes.len());
        bytes[index] = byte;
        let _ = super::parse(&bytes);
    }

    #[test]
    fn bytes_of_any_kind_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = super::parse(&bytes);
    }
}
