//! A REXS model as it stands in the file: components, relations, load cases.

use crate::refusal::{Refusal, short};
use herringbone_job::Violation;
use std::collections::HashMap;

/// Most components, attributes, relations and references together.
pub(super) const MAX_ELEMENTS: usize = 500_000;
/// Longest array whose numbers are kept: vectors have three.
pub(super) const MAX_ARRAY: usize = 16;
/// Most duplicates or dangling references that are named.
const MAX_NAMED: usize = 20;

/// Value of an attribute.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Flag(bool),
    /// Text as it stands in the file; in XML also that of numbers and flags.
    Text(String),
    Numbers(Vec<f64>),
    /// A long array, a matrix, or something else that no rule reads.
    Other,
}

/// An attribute with the text of its unit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Attribute {
    pub id: String,
    pub unit: Option<String>,
    pub value: Value,
    /// Whether `origin` says that a person entered it.
    pub is_user_defined: bool,
}

/// A component.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Component {
    pub id: i64,
    /// Its type as it stands in the file.
    pub kind: String,
    pub name: Option<String>,
    pub attributes: Vec<Attribute>,
}

/// A relation as read: roles with the ids of components.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RawRelation {
    pub id: Option<i64>,
    pub kind: String,
    pub order: Option<i64>,
    pub refs: Vec<(String, i64)>,
}

/// Attributes that hold in one case of the load spectrum.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RawCase {
    pub id: i64,
    pub components: Vec<Component>,
}

/// The contents of a file before its references are resolved.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RawModel {
    pub version: String,
    pub application: String,
    pub application_version: String,
    pub components: Vec<Component>,
    pub relations: Vec<RawRelation>,
    pub cases: Vec<RawCase>,
}

/// Index of a component in its model.
pub(super) type Handle = usize;

/// A relation between components.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Relation {
    pub kind: String,
    pub order: Option<i64>,
    pub refs: Vec<(String, Handle)>,
}

impl Relation {
    /// The component in a role.
    pub(super) fn role(&self, role: &str) -> Option<Handle> {
        self.refs.iter().find(|(name, _)| name == role).map(|(_, handle)| *handle)
    }
}

/// A load case: attributes by component.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LoadCase {
    pub id: i64,
    pub attributes: HashMap<Handle, Vec<Attribute>>,
}

/// A model whose references are resolved.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Model {
    pub version: String,
    pub application: String,
    pub components: Vec<Component>,
    pub relations: Vec<Relation>,
    pub cases: Vec<LoadCase>,
    /// References to components that are not there.
    pub dangling: Vec<String>,
    /// Relations of each component.
    by_component: Vec<Vec<usize>>,
}

/// The name of a component type in version 1.7.
fn current_kind(kind: &str) -> &str {
    match kind {
        "flank_geometry" => "cylindrical_gear_flank",
        "stage_gear_data" => "cylindrical_stage_gear_data",
        other => other,
    }
}

impl Model {
    /// Resolves the references.
    ///
    /// # Errors
    /// [`Refusal`] without components, or when two components have one id.
    pub(super) fn new(raw: RawModel) -> Result<Model, Refusal> {
        if raw.components.is_empty() {
            return Err(Refusal::unreadable("no-components", "is a REXS model without components"));
        }
        let mut index = HashMap::with_capacity(raw.components.len());
        let mut doubles = Vec::new();
        for (handle, component) in raw.components.iter().enumerate() {
            if let Some(first) = index.insert(component.id, handle) {
                let kinds = [&raw.components[first], component].map(|one: &Component| short(&one.kind));
                let detail = format!(
                    "has two components with the id {}: {} and {}; relations to it have no meaning",
                    component.id, kinds[0], kinds[1]
                );
                doubles.push(Violation::new("", "duplicate-id", detail));
            }
        }
        if !doubles.is_empty() {
            let summary = format!("The file has {} component id(s) that are given twice.", doubles.len());
            doubles.truncate(MAX_NAMED);
            return Err(Refusal::invalid(summary, doubles));
        }
        let mut dangling = Vec::new();
        let mut by_component = vec![Vec::new(); raw.components.len()];
        let mut relations = Vec::with_capacity(raw.relations.len());
        for relation in raw.relations {
            let resolve = |(role, id): (String, i64)| match index.get(&id) {
                Some(handle) => Some((role, *handle)),
                None => {
                    if dangling.len() < MAX_NAMED {
                        let number = relation.id.map(|id| id.to_string()).unwrap_or_default();
                        dangling.push(format!("relation[{number}] ({}): component {id}", short(&relation.kind)));
                    }
                    None
                }
            };
            let refs: Vec<_> = relation.refs.into_iter().filter_map(resolve).collect();
            for (_, handle) in &refs {
                let own: &mut Vec<usize> = &mut by_component[*handle];
                if own.last() != Some(&relations.len()) {
                    own.push(relations.len());
                }
            }
            relations.push(Relation { kind: relation.kind, order: relation.order, refs });
        }
        let mut cases = Vec::new();
        for case in raw.cases {
            let mut attributes: HashMap<Handle, Vec<Attribute>> = HashMap::new();
            for component in case.components {
                match index.get(&component.id) {
                    Some(handle) => attributes.entry(*handle).or_default().extend(component.attributes),
                    None if dangling.len() < MAX_NAMED => {
                        dangling.push(format!("load_case[{}]: component {}", case.id, component.id));
                    }
                    None => {}
                }
            }
            cases.push(LoadCase { id: case.id, attributes });
        }
        let application = [raw.application, raw.application_version].map(|text| short(text.trim()));
        Ok(Model {
            version: short(raw.version.trim()),
            application: application.join(" ").trim().to_owned(),
            components: raw.components,
            relations,
            cases,
            dangling,
            by_component,
        })
    }

    /// Major and minor version; `None` where there is no number.
    pub(super) fn version_number(&self) -> Option<(u32, u32)> {
        let mut parts = self.version.split('.');
        let major = parts.next()?.trim().parse().ok()?;
        Some((major, parts.next().and_then(|minor| minor.trim().parse().ok()).unwrap_or(0)))
    }

    /// The type of a component by its name of version 1.7.
    pub(super) fn kind(&self, handle: Handle) -> &str {
        current_kind(&self.components[handle].kind)
    }

    /// Type and id of a component: `cylindrical_gear[40]`.
    pub(super) fn label(&self, handle: Handle) -> String {
        let component = &self.components[handle];
        format!("{}[{}]", short(&component.kind), component.id)
    }

    /// Its name, else type and id.
    pub(super) fn name(&self, handle: Handle) -> String {
        match self.components[handle].name.as_deref().map(str::trim).filter(|name| !name.is_empty()) {
            Some(name) => short(name),
            None => self.label(handle),
        }
    }

    /// Id of a component in the file.
    pub(super) fn id(&self, handle: Handle) -> i64 {
        self.components[handle].id
    }

    /// All components of a type.
    pub(super) fn of_kind<'m>(&'m self, kind: &'m str) -> impl Iterator<Item = Handle> + 'm {
        (0..self.components.len()).filter(move |handle| self.kind(*handle) == kind)
    }

    /// Relations of a component.
    pub(super) fn relations_of(&self, handle: Handle) -> impl Iterator<Item = &Relation> {
        self.by_component[handle].iter().map(|number| &self.relations[*number])
    }

    /// Components in one role of the relations of a type that have a component in another role.
    pub(super) fn related(&self, kind: &str, handle: Handle, role: &str, other: &str) -> Vec<Handle> {
        self.relations_of(handle)
            .filter(|relation| relation.kind == kind && relation.role(role) == Some(handle))
            .filter_map(|relation| relation.role(other))
            .collect()
    }

    /// Parts of an assembly.
    pub(super) fn parts(&self, handle: Handle) -> Vec<Handle> {
        let mut parts = self.related("assembly", handle, "assembly", "part");
        parts.extend(self.related("ordered_assembly", handle, "assembly", "part"));
        parts
    }

    /// The shaft of a gear: by its assembly, else by a connection (key, fit, coupling).
    pub(super) fn shaft_of(&self, gear: Handle) -> Option<Handle> {
        let is_shaft = |handle: &Handle| self.kind(*handle) == "shaft";
        let assemblies = ["assembly", "ordered_assembly"];
        assemblies
            .iter()
            .flat_map(|kind| self.related(kind, gear, "part", "assembly"))
            .find(is_shaft)
            .or_else(|| self.connections(gear).into_iter().map(|(_, other)| other).find(is_shaft))
    }

    /// What a component is connected to by couplings, keys and fits: the connection, and the component beyond.
    pub(super) fn connections(&self, handle: Handle) -> Vec<(Handle, Handle)> {
        let mut found = Vec::new();
        for relation in self.relations_of(handle) {
            let Some(connection) = relation.role("assembly") else { continue };
            if !is_connection(self.kind(connection)) {
                continue;
            }
            for (one, other) in [("inner_part", "outer_part"), ("side_1", "side_2")] {
                for (near, far) in [(one, other), (other, one)] {
                    if let (Some(near), Some(far)) = (relation.role(near), relation.role(far))
                        && near == handle
                        && far != handle
                    {
                        found.push((connection, far));
                    }
                }
            }
        }
        found
    }
}

/// Whether a component ties two others together so that they turn as one.
fn is_connection(kind: &str) -> bool {
    matches!(
        kind,
        "coupling"
            | "cylindrical_interference_fit"
            | "tapered_interference_fit"
            | "feather_key_connection"
            | "involute_spline_connection"
    )
}
