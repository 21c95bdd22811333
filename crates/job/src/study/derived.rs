//! Values that the rest of a document gives to fields which can be left out: geometry, masses, springs.

use super::bounds::least_backlash_mm;
use super::prepare::{DEFAULT_BORE_FRACTION, Prepared, default_bore_mm};
use super::supports;
use crate::document::{JobDocument, JobKind, SupportsInput};
use crate::field::Input;
use crate::result::SpringOrigin;
use crate::unit::Unit;
use herringbone_physics::gear::{Pair, PairSpec};
use serde::Serialize;

/// The value that the rest of the document gives to a field, whether the document has one of its own there or not.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DerivedValue {
    /// JSON pointer to the field of the document.
    pub pointer: String,
    pub value: f64,
    /// Unit of the field, as in its name.
    pub unit: &'static str,
    /// Origin of the value, in a few words.
    pub basis: String,
    /// Whether the field has this value when it is null. Otherwise the value is a recommendation for this size of gear.
    pub is_default: bool,
}

/// Every derived value of a document, in the order of the form.
pub(super) fn values(document: &JobDocument, prepared: &Prepared) -> Vec<DerivedValue> {
    let mut found = Vec::new();
    let mut add = |pointer: String, value: f64, basis: String, is_default: bool| {
        let unit = Unit::of_name(&pointer).unwrap_or(Unit::ONE).text;
        found.push(DerivedValue { pointer, value, unit, basis, is_default });
    };
    let (design, pair) = (&document.design, &prepared.pair);
    if let Some(value) = center_distance_mm(document, pair) {
        add("/design/center_distance_mm".to_owned(), value, "from the profile shifts".to_owned(), true);
    }
    let vibrates = document.kind != JobKind::Mesh;
    if vibrates {
        let least_um = 1e3 * least_backlash_mm(pair.center_distance_m * 1e3, design.normal_module_mm);
        let basis = "least normal backlash of practice for this size, ISO/TR 10064-2".to_owned();
        add("/design/backlash_um".to_owned(), least_um.round(), basis, false);
    }
    for (name, gear, member) in [("pinion", &design.pinion, &pair.pinion), ("gear", &design.gear, &pair.gear)] {
        let at = |field: &str| format!("/design/{name}/{field}");
        let basis = format!("{DEFAULT_BORE_FRACTION} × reference ø");
        add(at("bore_diameter_mm"), default_bore_mm(design, gear), basis, true);
        add(at("mass_kg"), member.mass_kg(), "as solid discs".to_owned(), true);
        add(at("inertia_kg_m2"), member.inertia_kg_m2(), "as solid discs".to_owned(), true);
        add(at("face_width_mm"), design.face_width_mm, "face width of the pair".to_owned(), true);
    }
    if let Some(shafts) = design.resolved_shafts() {
        for value in shafts.derived {
            add(value.pointer, value.value, value.basis.to_owned(), true);
        }
    } else if vibrates {
        for (name, spring) in supports::named(&supports::used(&SupportsInput::defaults(), pair)) {
            let basis = match spring.origin {
                SpringOrigin::Derived => "from the body of the gear",
                SpringOrigin::Assumed | SpringOrigin::Given => "assumed after the size of the pair",
            };
            add(format!("/design/supports/{name}"), spring.value, basis.to_owned(), true);
        }
    }
    found
}

/// Centre distance of the profile shifts; none where they give no pair that can run.
fn center_distance_mm(document: &JobDocument, pair: &Pair) -> Option<f64> {
    let without_error = |pair: &Pair| (pair.center_distance_m - pair.spec.assembly.center_distance_error_m) * 1e3;
    if document.design.center_distance_mm.is_none() {
        return Some(without_error(pair));
    }
    let fitting = Pair::new(&PairSpec { center_distance_m: None, ..pair.spec }).ok()?;
    Some(without_error(&fitting.0))
}

#[cfg(test)]
mod tests {
    use crate::schema::field_descriptions;
    use crate::study::unchecked::check;
    use crate::{document::JobDocument, parse_value};
    use serde_json::{Value, json};

    fn document(change: impl FnOnce(&mut Value)) -> JobDocument {
        let mut value: Value = serde_json::from_str(include_str!("../../../../examples/contact.json")).unwrap();
        change(&mut value);
        parse_value(&value).unwrap()
    }

    fn derived(document: &JobDocument, pointer: &str) -> f64 {
        let report = check(document).unwrap();
        report.derived.iter().find(|one| one.pointer == pointer).unwrap_or_else(|| panic!("{pointer}")).value
    }

    /// What a document says in a field changes nothing in the derived value of the field itself.
    #[test]
    fn a_derived_value_is_that_of_the_field_left_out() {
        let left_out = document(|value| {
            for gear in ["pinion", "gear"] {
                value["design"][gear].as_object_mut().unwrap().remove("bore_diameter_mm");
                value["design"][gear].as_object_mut().unwrap().remove("inertia_kg_m2");
            }
        });
        let report = check(&left_out).unwrap();
        let geometry = &report.geometry;
        for (pointer, expected) in [
            ("/design/center_distance_mm", geometry.center_distance_mm),
            ("/design/pinion/bore_diameter_mm", geometry.pinion.bore_diameter_mm),
            ("/design/gear/mass_kg", geometry.gear.mass_kg),
            ("/design/gear/inertia_kg_m2", geometry.gear.inertia_kg_m2),
            ("/design/pinion/face_width_mm", geometry.face_width_mm.unwrap()),
            ("/design/supports/gear_axial_n_per_um", report.supports.as_ref().unwrap().gear_axial_n_per_um.value),
        ] {
            let found = derived(&left_out, pointer);
            assert!((found / expected - 1.0).abs() < 1e-12, "{pointer}: {found} for {expected}");
        }
        let bores = document(|value| {
            value["design"]["pinion"]["bore_diameter_mm"] = json!(geometry.pinion.bore_diameter_mm);
            value["design"]["gear"]["bore_diameter_mm"] = json!(geometry.gear.bore_diameter_mm);
            value["design"]["gear"]["inertia_kg_m2"] = json!(99.0);
            value["design"]["supports"]["gear_axial_n_per_um"] = json!(7.0);
            value["design"]["center_distance_mm"] = json!(202.0);
            value["design"]["assembly"] = json!({"center_distance_error_um": 25.0});
        });
        for pointer in ["/design/gear/bore_diameter_mm", "/design/gear/inertia_kg_m2", "/design/center_distance_mm"] {
            let (given, expected) = (derived(&bores, pointer), derived(&left_out, pointer));
            assert!((given / expected - 1.0).abs() < 1e-9, "{pointer}: {given} for {expected}");
        }
    }

    #[test]
    fn every_derived_value_is_of_an_optional_number_with_its_unit() {
        let fields = field_descriptions();
        let report = check(&document(|_| {})).unwrap();
        assert_eq!(report.derived.len(), 19);
        for one in &report.derived {
            let field = fields.iter().find(|field| field.pointer == one.pointer).unwrap();
            assert!(!field.required && field.schema["type"] == "number", "{}", one.pointer);
            assert_eq!(field.schema["x-unit"], one.unit, "{}", one.pointer);
            assert!(one.value.is_finite() && !one.basis.is_empty(), "{one:?}");
        }
        let mesh = check(&document(|value| value["kind"] = json!("mesh"))).unwrap();
        assert!(mesh.derived.iter().all(|one| !one.pointer.contains("supports")));
    }
}
