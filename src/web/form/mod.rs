//! The design form, built from the job document's declarations and the sections in [`groups`].

mod field;
mod groups;

pub(super) use field::{Control, FormField};

use field::Choice;
use groups::{BlockPlan, GroupPlan, LayoutPlan, ListPlan};
use herringbone_job::schema::{Condition, FieldDescription, field_descriptions};
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
    List(Box<List>),
}

/// The objects of a list, as many as one wants. The page's script makes an object of the fields, with its number in
/// place of the first `*` of identifiers and pointers and of the mark in texts.
pub(super) struct List {
    /// The number of objects.
    pub count: FormField,
    /// What stands for the number of an object in texts.
    pub mark: &'static str,
    /// What one of them is called.
    pub item: &'static str,
    pub as_blocks: bool,
    /// Fields of one object.
    pub fields: Vec<FormField>,
    /// Lists in one object.
    pub lists: Vec<List>,
}

impl List {
    /// All fields of the list and those of one of its objects.
    #[cfg(test)]
    fn all_fields(&self) -> Vec<&FormField> {
        let inner = self.lists.iter().flat_map(List::all_fields);
        std::iter::once(&self.count).chain(&self.fields).chain(inner).collect()
    }
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
            Layout::List(list) => list.all_fields(),
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

/// Every field that can be filled in, in the order declared, but those of lists.
fn all_fields() -> Vec<FormField> {
    let example: Value = serde_json::from_str(EXAMPLE).unwrap_or_default();
    let mut fields = Vec::new();
    // Jobs of many evaluations are given as JSON.
    for description in field_descriptions().into_iter().filter(|description| description.group != "evaluations") {
        if let Some(name) = description.pointer.strip_prefix("/axes/*") {
            // No axis is needed, so none of its fields is.
            let of_axis = |axis| FieldDescription {
                pointer: format!("/axes/{axis}{name}"),
                required: false,
                ..description.clone()
            };
            let axes = (0..groups::AXES).map(of_axis);
            fields.extend(axes.filter_map(|axis| FormField::new(&axis, example.pointer(&axis.pointer))));
        } else if description.pointer == groups::SHAFTS {
            fields.push(shaft_choice(&description));
        } else if is_list_of_shafts(&description) {
            // Its fields are those of a block.
        } else if is_at_or_in(&description.pointer, groups::SHAFTS) {
            fields.extend(of_shafts(&description, &example));
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

/// The choice of which shafts are given.
fn shaft_choice(description: &FieldDescription) -> FormField {
    let choices = groups::SHAFT_CHOICES.map(|(word, label)| Choice {
        word: word.to_owned(),
        label: label.to_owned(),
        chosen: word.is_empty(),
    });
    FormField { label: "Shafts".to_owned(), control: Control::Parts(choices.into()), ..FormField::bare(description) }
}

fn is_list_of_shafts(description: &FieldDescription) -> bool {
    is_at_or_in(&description.pointer, groups::SHAFTS)
        && (description.pointer.contains("/*") || description.schema["items"]["type"] == "object")
}

/// A field in an object of the shafts: in use while its object is chosen.
fn of_shafts(description: &FieldDescription, example: &Value) -> Option<FormField> {
    let field = FormField::new(description, example.pointer(&description.pointer))?;
    let (_, values) = groups::SHAFT_PARTS.iter().find(|(object, _)| is_at_or_in(&description.pointer, object))?;
    let condition = field.condition.or(Some(Condition { on: groups::SHAFTS.to_owned(), values }));
    let context = ["pinion", "gear"].into_iter().find(|name| {
        let object = format!("{}/{name}", groups::SHAFTS);
        is_at_or_in(&description.pointer, &object)
    });
    // Of a body that may be left out, nothing is required.
    let required = field.required && !description.pointer.contains("/half_body/");
    Some(FormField { condition, context: context.unwrap_or_default().to_owned(), required, ..field })
}

/// A list with the fields of one of its objects.
fn list_at(plan: &ListPlan) -> Option<List> {
    let descriptions = field_descriptions();
    list_of(&descriptions, plan, plan.of, "#1")
}

fn list_of(descriptions: &[FieldDescription], plan: &ListPlan<&str>, of: &str, mark: &'static str) -> Option<List> {
    let (example, ListPlan { pointer, item, as_blocks, .. }) = (Value::Null, *plan);
    let own = descriptions.iter().find(|description| description.pointer == pointer)?;
    let in_item = |description: &&FieldDescription| {
        let rest = description.pointer.strip_prefix(pointer).and_then(|rest| rest.strip_prefix("/*/"));
        rest.is_some_and(|rest| !rest.contains('/'))
    };
    let (mut fields, mut lists) = (Vec::new(), Vec::new());
    for description in descriptions.iter().filter(in_item) {
        if description.schema["items"]["type"] == "object" {
            let inner =
                ListPlan { pointer: description.pointer.as_str(), item: groups::INNER_ITEM, of: "", as_blocks: false };
            lists.extend(list_of(descriptions, &inner, &format!("{item} {mark}, {of}"), "#2"));
        } else if let Some(field) = of_shafts(description, &example) {
            // The pointer has the names of the list and of the objects around it too.
            let name = field.label.rsplit(", ").next().unwrap_or_default().to_owned();
            let label = name.chars().next().map(|first| first.to_uppercase().chain(name.chars().skip(1)).collect());
            let row = if as_blocks { String::new() } else { label.clone().unwrap_or_default() };
            fields.push(FormField {
                label: label.unwrap_or_default(),
                row,
                context: format!("{item} {mark}, {of}"),
                ..field
            });
        }
    }
    let count = FormField::bare(own);
    let (_, values) = groups::SHAFT_PARTS.iter().find(|(object, _)| is_at_or_in(pointer, object))?;
    let count = FormField {
        label: format!("Number of {}", plural(item)),
        context: of.to_owned(),
        control: Control::Count,
        value: "0".to_owned(),
        condition: Some(Condition { on: groups::SHAFTS.to_owned(), values }),
        ..count
    };
    Some(List { count, mark, item, as_blocks, fields, lists })
}

fn plural(item: &str) -> String {
    item.strip_suffix('y').map_or_else(|| format!("{item}s"), |stem| format!("{stem}ies"))
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
            LayoutPlan::List(ref plan) => {
                list_at(plan).map_or_else(|| Layout::Fields(Vec::new()), |list| Layout::List(Box::new(list)))
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
        let (mut placed, mut of_lists) = (0, 0);
        for group in groups() {
            for block in &group.blocks {
                assert!(!block.fields().is_empty(), "nothing in {} / {}", group.title, block.title);
                match block.layout {
                    Layout::List(_) => of_lists += block.fields().len(),
                    _ => placed += block.fields().len(),
                }
            }
        }
        let fields = all_fields();
        assert_eq!(placed, fields.len());
        // Segments, bearings with their tables, bodies: every field of their objects, and their numbers.
        let of_items = field_descriptions()
            .iter()
            .filter(|one| one.pointer.starts_with("/design/shafts/") && is_list_of_shafts(one))
            .count();
        assert_eq!((of_lists, of_items > 50), (of_items, true));
        for condition in fields.iter().filter_map(|field| field.condition.as_ref()) {
            let other = fields.iter().find(|field| field.pointer == condition.on);
            let Some(FormField { control: Control::Choice(choices) | Control::Parts(choices), .. }) = other else {
                panic!("{}", condition.on)
            };
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
