//! The report of an import.

use serde::Serialize;
use serde_json::Value;
#[cfg(feature = "schema")]
use utoipa::ToSchema;

/// A job document made of a file, and what became of the file's contents. Nothing is submitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct Import {
    pub source: ImportSource,
    pub pair: ImportedPair,
    /// The other pairs and stages of the file, by the numbers that select them.
    pub alternatives: Vec<Alternative>,
    /// A complete job document, every default filled in.
    #[cfg_attr(feature = "schema", schema(value_type = Object))]
    pub document: Value,
    /// The operating points of the file: its load cases, or the one of the model itself.
    pub operating_points: Vec<OperatingPoint>,
    /// Fields of the document that were read in the file.
    pub taken: Vec<Taken>,
    /// Fields of the document that the file leaves open.
    pub assumed: Vec<Assumed>,
    /// Contents of the file that the document has no place for.
    pub ignored: Vec<Ignored>,
    /// Values of the file that fit a field of the document which was left as it is.
    pub offered: Vec<Offered>,
    /// Results in the file beside those of the document.
    pub checks: Vec<Check>,
    pub warnings: Vec<ImportWarning>,
}

/// The file.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct ImportSource {
    /// `rexs` or `z12`.
    pub format: String,
    /// Version of the format.
    pub version: String,
    /// The program that wrote the file, with its version.
    pub application: String,
    /// Name of the model in an archive.
    pub file: Option<String>,
    /// Hash of the bytes.
    pub sha256: String,
}

/// What a stage, or two of them, can be made into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub enum StageKind {
    /// Two stages of opposite hands.
    DoubleHelical,
    /// One stage, which can be mirrored.
    SingleHelical,
}

/// The pair of the document.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct ImportedPair {
    /// Its number in the file.
    pub number: usize,
    pub label: String,
    /// Ids of its stages, that of the left half first.
    pub stages: Vec<i64>,
    /// Whether it was made of one single-helical stage.
    pub mirrored: bool,
}

/// A pair of the file that was not chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct Alternative {
    /// Selects it with `pair`.
    pub number: usize,
    pub label: String,
    pub stages: Vec<i64>,
    pub kind: StageKind,
}

/// An operating point.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct OperatingPoint {
    /// Selects it with `point`.
    pub number: usize,
    /// Id of its load case.
    pub load_case: Option<i64>,
    pub pinion_speed_rpm: Option<f64>,
    /// Of the whole pinion.
    pub pinion_torque_nm: Option<f64>,
    /// Part of the time, 0 to 1.
    pub share: Option<f64>,
    /// Whether the document has it.
    pub chosen: bool,
}

/// A field of the document with its origin in the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct Taken {
    /// JSON pointer into the document.
    pub pointer: String,
    /// Component type, id and attribute: `cylindrical_gear[40].normal_module`; several separated by commas.
    pub from: String,
    /// Id of the component, of the first where there are several.
    pub component: Option<i64>,
    /// Attribute of the component.
    pub attribute: Option<String>,
    /// Value in the document.
    #[cfg_attr(feature = "schema", schema(value_type = Value))]
    pub value: Value,
    /// Unit of the value in the document.
    pub unit: Option<String>,
    /// Value in the file.
    #[cfg_attr(feature = "schema", schema(value_type = Value))]
    pub file_value: Value,
    /// Unit in the file.
    pub file_unit: Option<String>,
    /// How the one follows from the other, where they differ.
    pub why: Option<String>,
}

/// A field of the document that does not stand in the file.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct Assumed {
    /// JSON pointer into the document.
    pub pointer: String,
    /// Value in the document; null where the service derives it.
    #[cfg_attr(feature = "schema", schema(value_type = Value))]
    pub value: Value,
    pub unit: Option<String>,
    pub why: String,
}

/// Something in the file that was not used.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct Ignored {
    /// Component, or component and attribute.
    pub from: String,
    pub why: String,
    /// Its value with unit.
    pub amount: Option<String>,
}

/// A value for a field that was left at its default.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct Offered {
    /// JSON pointer into the document.
    pub pointer: String,
    pub from: String,
    pub value: f64,
    pub unit: Option<String>,
    pub why: String,
}

/// A result in the file and the same quantity of the document.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct Check {
    pub name: String,
    /// Component and attribute.
    pub from: String,
    pub file: f64,
    pub ours: f64,
    pub unit: Option<String>,
    /// Whether they agree to 1e-6 of the value, or to the digits that the file gives.
    pub agrees: bool,
}

/// Something to look at.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(ToSchema))]
pub struct ImportWarning {
    /// In kebab case.
    pub code: String,
    /// JSON pointer into the document; empty for the file as a whole.
    pub pointer: String,
    pub detail: String,
}
