//! A model to be written: components with typed attributes, and relations.

/// Value of an attribute, with its type in the format.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Typed {
    Float(f64),
    Integer(i64),
    Flag(bool),
    Word(&'static str),
    Text(String),
    Reference(i64),
    Floats(Vec<f64>),
}

/// An attribute; `calculated` where it is a result.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Written {
    pub id: String,
    pub unit: &'static str,
    pub value: Typed,
    pub calculated: bool,
}

/// A component.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Component {
    pub id: i64,
    pub kind: &'static str,
    pub name: String,
    pub attributes: Vec<Written>,
}

impl Component {
    /// An input.
    pub(super) fn set(&mut self, id: &str, unit: &'static str, value: Typed) -> &mut Self {
        self.attributes.push(Written { id: id.to_owned(), unit, value, calculated: false });
        self
    }

    /// A result.
    pub(super) fn result(&mut self, id: &str, unit: &'static str, value: Typed) -> &mut Self {
        self.attributes.push(Written { id: id.to_owned(), unit, value, calculated: true });
        self
    }

    /// A number that is given.
    pub(super) fn number(&mut self, id: &str, unit: &'static str, value: f64) -> &mut Self {
        self.set(id, unit, Typed::Float(value))
    }

    /// Place and axes, relative to the gear unit.
    pub(super) fn place(&mut self, support_mm: [f64; 3], w_axis: [f64; 3]) -> &mut Self {
        self.set("reference_component_for_position", "none", Typed::Reference(super::GEAR_UNIT))
            .set("support_vector", "mm", Typed::Floats(support_mm.to_vec()))
            .set("u_axis_vector", "mm", Typed::Floats(vec![1.0, 0.0, 0.0]))
            .set("w_axis_vector", "mm", Typed::Floats(w_axis.to_vec()))
    }
}

/// A relation: type, order, roles with ids.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Relation {
    pub kind: &'static str,
    pub order: Option<i64>,
    pub refs: Vec<(&'static str, i64)>,
}

/// A model.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Model {
    pub components: Vec<Component>,
    pub relations: Vec<Relation>,
}

impl Model {
    /// Adds a component.
    pub(super) fn add(&mut self, id: i64, kind: &'static str, name: impl Into<String>) -> &mut Component {
        let index = self.components.len();
        self.components.push(Component { id, kind, name: name.into(), attributes: Vec::new() });
        &mut self.components[index]
    }

    pub(super) fn relate(&mut self, kind: &'static str, refs: &[(&'static str, i64)]) {
        self.relations.push(Relation { kind, order: None, refs: refs.to_vec() });
    }

    /// Type of a component.
    pub(super) fn kind(&self, id: i64) -> &'static str {
        self.components.iter().find(|component| component.id == id).map_or("", |component| component.kind)
    }
}
