//! The design form, built from the job document's declarations and the plan in [`groups`].

mod field;
mod groups;

pub use field::{Control, Field};

use crate::job::schema::field_descriptions;
use serde_json::Value;
use std::sync::LazyLock;

/// A section of the form.
pub struct Group {
    pub id: &'static str,
    pub title: &'static str,
    pub help: &'static str,
    pub open: bool,
    pub blocks: Vec<Block>,
}

/// Fields that stand together under a common (perhaps empty) title.
pub struct Block {
    pub title: &'static str,
    pub fields: Vec<Field>,
}

/// The form's first contents: the source paper's example.
const EXAMPLE: &str = include_str!("../../../examples/table1.json");

static GROUPS: LazyLock<Vec<Group>> = LazyLock::new(|| plan(all_fields()));

static SWEEPABLE: LazyLock<Vec<String>> = LazyLock::new(|| {
    let numeric = |field: &&Field| matches!(field.control, Control::Number | Control::Integer);
    let fixed = |field: &&Field| !field.pointer.starts_with("/axes") && !field.pointer.starts_with("/analysis");
    all_fields().iter().filter(numeric).filter(fixed).map(|field| field.pointer.clone()).collect()
});

/// The sections of the form.
pub fn groups() -> &'static [Group] {
    &GROUPS
}

/// Pointers of the numbers that a sweep can vary.
pub fn sweepable_pointers() -> &'static [String] {
    &SWEEPABLE
}

/// Every field that can be filled in, in the order declared.
fn all_fields() -> Vec<Field> {
    let example: Value = serde_json::from_str(EXAMPLE).unwrap_or_default();
    let mut fields = Vec::new();
    for description in field_descriptions() {
        let pointer = description.pointer.as_str();
        if let Some(name) = pointer.strip_prefix("/axes/*") {
            for axis in 0..groups::AXES {
                let pointer = format!("/axes/{axis}{name}");
                fields.extend(Field::new(&pointer, &description.schema, false, example.pointer(&pointer)));
            }
        } else if pointer != "/axes" && !pointer.contains("/*") {
            fields.extend(Field::new(pointer, &description.schema, description.required, example.pointer(pointer)));
        }
    }
    fields
}

/// Puts each field where the plan has it; what the plan does not know stands in a section of its own at the end.
fn plan(mut fields: Vec<Field>) -> Vec<Group> {
    let mut planned: Vec<Group> = groups::GROUPS
        .iter()
        .map(|group| Group {
            id: group.id,
            title: group.title,
            help: group.help,
            open: group.open,
            blocks: group
                .blocks
                .iter()
                .map(|block| Block { title: block.title, fields: take(&mut fields, block.pointers) })
                .collect(),
        })
        .collect();
    if !fields.is_empty() {
        let blocks = vec![Block { title: "", fields }];
        planned.push(Group { id: "other", title: "Other", help: "", open: false, blocks });
    }
    planned
}

fn take(fields: &mut Vec<Field>, pointers: &[&str]) -> Vec<Field> {
    let mut taken = Vec::new();
    for pointer in pointers {
        taken.extend(fields.extract_if(.., |field| is_at_or_in(&field.pointer, pointer)));
    }
    taken
}

/// Whether `pointer` is `place` or lies in the object at `place`.
fn is_at_or_in(pointer: &str, place: &str) -> bool {
    pointer.strip_prefix(place).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plan_places_every_field() {
        let unplaced: Vec<_> = groups().iter().filter(|group| group.id == "other").collect();
        let names = unplaced.iter().flat_map(|group| &group.blocks).flat_map(|block| &block.fields);
        assert_eq!(names.map(|field| field.pointer.as_str()).collect::<Vec<_>>(), Vec::<&str>::new());
    }

    #[test]
    fn the_plan_names_only_fields_that_exist() {
        for group in groups() {
            for block in &group.blocks {
                assert!(!block.fields.is_empty(), "nothing in {} / {}", group.title, block.title);
            }
        }
        let fields = all_fields();
        let exists = |place: &str| fields.iter().any(|field| is_at_or_in(&field.pointer, place));
        for plan in groups::GROUPS.iter().flat_map(|group| group.blocks).flat_map(|block| block.pointers) {
            assert!(exists(plan), "{plan}");
        }
        for condition in groups::CONDITIONS {
            assert!(exists(condition.pointer) && exists(condition.on), "{}", condition.pointer);
        }
        for (place, _) in groups::DERIVED {
            assert!(exists(place), "{place}");
        }
    }

    #[test]
    fn identifiers_are_unique() {
        let mut ids: Vec<_> = all_fields().into_iter().map(|field| field.id).collect();
        let count = ids.len();
        ids.sort();
        ids.dedup();
        assert_eq!(ids.len(), count);
    }

    #[test]
    fn the_example_is_a_job_document_and_stands_in_the_form() {
        crate::job::parse(EXAMPLE.as_bytes()).unwrap();
        let fields = all_fields();
        let value = |pointer: &str| fields.iter().find(|field| field.pointer == pointer).unwrap().value.clone();
        assert_eq!(value("/design/helix_angle_deg"), "24.43");
        assert_eq!(value("/design/pinion/teeth"), "17");
        assert_eq!(value("/analysis/accuracy"), "1e-6");
        assert_eq!(value("/design/pressure_angle_plane"), "transverse");
        // Not in the example: the declared default; derived: empty.
        assert_eq!(value("/design/gear/dedendum"), "1.25");
        assert_eq!(value("/design/gear/left_half_hand"), "");
        assert_eq!(value("/design/pinion/left/tip_relief/amount_um"), "");
        assert_eq!(value("/design/center_distance_mm"), "");
    }
}
