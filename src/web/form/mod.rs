//! The design form, built from the job document's declarations and the sections in [`groups`].

mod field;
mod groups;

pub(super) use field::{Control, FormField};

use groups::{BlockPlan, GroupPlan, LayoutPlan};
use herringbone_job::schema::{FieldDescription, field_descriptions};
use serde_json::Value;
use std::sync::LazyLock;

/// A section of the form.
pub(super) struct Group {
    pub id: &'static str,
    pub title: &'static str,
    /// The title in the list of sections.
    pub short: &'static str,
    pub help: &'static str,
    pub open: bool,
    /// Summary in the heading while all fields have their defaults.
    pub nothing: &'static str,
    pub blocks: Vec<Block>,
}

/// Block of fields under a common (perhaps empty) title.
pub(super) struct Block {
    pub title: &'static str,
    pub folded: bool,
    pub layout: Layout,
}

pub(super) enum Layout {
    Fields(Vec<FormField>),
    Table { columns: Vec<&'static str>, rows: Vec<Row> },
}

/// Row of the form: the same field of several objects, with their common texts.
pub(super) struct Row {
    pub label: String,
    pub cells: Vec<FormField>,
}

impl Row {
    /// The first cell; its declaration is that of all cells.
    pub(super) fn first(&self) -> Option<&FormField> {
        self.cells.first()
    }
}

impl Block {
    /// All fields of the block.
    #[cfg(test)]
    fn fields(&self) -> Vec<&FormField> {
        match &self.layout {
            Layout::Fields(fields) => fields.iter().collect(),
            Layout::Table { rows, .. } => rows.iter().flat_map(|row| &row.cells).collect(),
        }
    }
}

/// The form's first contents: the example pair as it is calculated by default.
const EXAMPLE: &str = include_str!("../../../examples/contact.json");

static GROUPS: LazyLock<Vec<Group>> = LazyLock::new(|| plan(all_fields()));

static SWEEPABLE: LazyLock<Vec<String>> = LazyLock::new(|| {
    let numeric = |field: &&FormField| matches!(field.control, Control::Number | Control::Integer);
    let fixed = |field: &&FormField| !field.pointer.starts_with("/axes") && !field.pointer.starts_with("/analysis");
    all_fields().iter().filter(numeric).filter(fixed).map(|field| field.pointer.clone()).collect()
});

/// The sections of the form.
pub(super) fn groups() -> &'static [Group] {
    &GROUPS
}

/// Pointers of the numbers that a sweep can vary.
pub(super) fn sweepable_pointers() -> &'static [String] {
    &SWEEPABLE
}

/// Every field that can be filled in, in the order declared.
fn all_fields() -> Vec<FormField> {
    let example: Value = serde_json::from_str(EXAMPLE).unwrap_or_default();
    let mut fields = Vec::new();
    for description in field_descriptions() {
        if let Some(name) = description.pointer.strip_prefix("/axes/*") {
            // No axis is needed, so none of its fields is.
            let of_axis = |axis| FieldDescription {
                pointer: format!("/axes/{axis}{name}"),
                required: false,
                ..description.clone()
            };
            let axes = (0..groups::AXES).map(of_axis);
            fields.extend(axes.filter_map(|axis| FormField::new(&axis, example.pointer(&axis.pointer))));
        } else if description.pointer != "/axes"
            && !description.pointer.contains("/*")
            // Filled in by the interface, not by people.
            && !is_at_or_in(&description.pointer, "/sweep_point")
        {
            fields.extend(FormField::new(&description, example.pointer(&description.pointer)));
        }
    }
    fields
}

/// Assigns each field to the section of its declaration; unknown sections are appended at the end.
fn plan(mut fields: Vec<FormField>) -> Vec<Group> {
    let mut planned: Vec<Group> = groups::GROUPS.iter().map(|group| section(group, &mut fields)).collect();
    if !fields.is_empty() {
        let blocks = vec![Block { title: "", folded: false, layout: Layout::Fields(fields) }];
        planned.push(Group { id: "other", title: "Other", short: "Other", help: "", open: false, nothing: "", blocks });
    }
    planned
}

/// A section with its fields taken out of `fields`: each stands in the block whose object is nearest around it.
fn section(group: &GroupPlan, fields: &mut Vec<FormField>) -> Group {
    let mut objects: Vec<&str> = group.blocks.iter().flat_map(BlockPlan::objects).collect();
    objects.sort_by_key(|object| std::cmp::Reverse(object.len()));
    let nearest = |field: &FormField| objects.iter().find(|object| is_at_or_in(&field.pointer, object)).copied();
    let mut take = |object: &str| {
        let mut taken: Vec<FormField> =
            fields.extract_if(.., |field| field.group == group.id && nearest(field) == Some(object)).collect();
        taken.sort_by_key(|field| field.order);
        taken
    };
    let blocks = group.blocks.iter().map(|block| Block {
        title: block.title,
        folded: block.folded,
        layout: match block.layout {
            LayoutPlan::Fields(object) => Layout::Fields(take(object)),
            LayoutPlan::Table(columns) => {
                let taken = columns.iter().map(|(_, object)| take(object)).collect();
                Layout::Table { columns: columns.iter().map(|(title, _)| *title).collect(), rows: rows(taken, columns) }
            }
        },
    });
    Group {
        id: group.id,
        title: group.title,
        short: group.short,
        help: group.help,
        open: group.open,
        nothing: group.nothing,
        blocks: blocks.collect(),
    }
}

/// A row for each field of the first column's object.
fn rows(mut taken: Vec<Vec<FormField>>, columns: &[(&'static str, &str)]) -> Vec<Row> {
    let count = taken.first().map_or(0, Vec::len);
    let mut rows = Vec::with_capacity(count);
    for _ in 0..count {
        let cells: Vec<FormField> =
            taken.iter_mut().filter(|column| !column.is_empty()).map(|column| column.remove(0)).collect();
        let label = cells.first().map(|field| field.label.clone()).unwrap_or_default();
        let cells = cells
            .into_iter()
            .zip(columns)
            .map(|(cell, (column, _))| FormField {
                label: format!("{label}, {}", column.to_lowercase()),
                row: label.clone(),
                ..cell
            })
            .collect();
        rows.push(Row { label, cells });
    }
    rows
}

/// Whether `pointer` is `place` or lies in the object at `place`.
fn is_at_or_in(pointer: &str, place: &str) -> bool {
    pointer.strip_prefix(place).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_has_a_section_and_every_block_a_field() {
        let unplaced: Vec<_> = groups().iter().filter(|group| group.id == "other").collect();
        let names = unplaced.iter().flat_map(|group| &group.blocks).flat_map(Block::fields);
        assert_eq!(names.map(|field| field.pointer.as_str()).collect::<Vec<_>>(), Vec::<&str>::new());
        let mut placed = 0;
        for group in groups() {
            for block in &group.blocks {
                assert!(!block.fields().is_empty(), "nothing in {} / {}", group.title, block.title);
                placed += block.fields().len();
            }
        }
        let fields = all_fields();
        assert_eq!(placed, fields.len());
        for condition in fields.iter().filter_map(|field| field.condition.as_ref()) {
            let other = fields.iter().find(|field| field.pointer == condition.on);
            let Some(FormField { control: Control::Choice(choices), .. }) = other else { panic!("{}", condition.on) };
            for word in condition.values.split(' ') {
                assert!(choices.iter().any(|choice| choice.word == word), "{word} of {}", condition.on);
            }
        }
    }

    #[test]
    fn rows_have_the_same_field_of_every_object() {
        let blocks = groups().iter().flat_map(|group| &group.blocks);
        let mut seen = 0;
        for block in blocks {
            let Layout::Table { columns, rows } = &block.layout else { continue };
            for row in rows {
                assert_eq!(row.cells.len(), columns.len(), "{}", row.label);
                let name = |field: &FormField| field.pointer.rsplit('/').next().unwrap().to_owned();
                assert!(row.cells.iter().all(|cell| name(cell) == name(&row.cells[0])), "{}", row.label);
                seen += 1;
            }
        }
        assert!(seen > 20, "{seen} rows");
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
        herringbone_job::parse(EXAMPLE.as_bytes()).unwrap();
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
