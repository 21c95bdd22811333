//! One field of the form, made from its declaration in the job document.

use herringbone_job::schema::{Condition, FieldDescription};
use herringbone_job::unit::Unit;
use serde_json::Value;

/// Kind of input control of a field, by which the page's script reads its value.
pub(crate) enum Control {
    Number,
    Integer,
    Boolean,
    Text {
        max_length: u64,
    },
    Choice(Vec<Choice>),
    /// Numbers or words, separated by spaces, commas or semicolons.
    List {
        of_numbers: bool,
    },
    /// A list of objects, written as JSON.
    Json,
    /// How many objects a list has, whose fields stand beside it ([`super::List`]).
    Count,
    /// Which of the objects in an object are given.
    Parts(Vec<Choice>),
}

/// An option of a [`Control::Choice`].
pub(crate) struct Choice {
    pub word: String,
    pub label: String,
    pub chosen: bool,
}

/// A field of the form with all its displayed texts.
pub(crate) struct FormField {
    pub id: String,
    pub pointer: String,
    pub label: String,
    /// Label of the row that the field shares with others; empty for a field in a row of its own.
    pub row: String,
    /// What the field is of, where its label does not say it: "bearing #1, pinion" with a mark for the number.
    pub context: String,
    /// Symbol of the quantity (letter and subscript), or empty.
    pub symbol: (&'static str, &'static str),
    pub help: String,
    /// Permitted range with unit, or empty.
    pub range: String,
    /// Displayed unit, or empty.
    pub unit: &'static str,
    pub control: Control,
    /// First contents of the input.
    pub value: String,
    /// Default value as text; empty when there is no fixed default.
    pub default: String,
    /// Shown in an empty input.
    pub placeholder: &'static str,
    pub required: bool,
    /// Shown only while another field has one of these values.
    pub condition: Option<Condition>,
    /// Section of the form.
    pub group: &'static str,
    /// Rank among the fields of a block, ascending.
    pub order: i32,
}

impl FormField {
    /// A field from its declaration; `None` for objects, whose fields have declarations of their own.
    pub(crate) fn new(description: &FieldDescription, example: Option<&Value>) -> Option<FormField> {
        let FieldDescription { pointer, schema, derived, .. } = description;
        let derived = *derived;
        let default = if derived.is_some() { String::new() } else { text(&schema["default"]) };
        let value = example.map(text).unwrap_or_else(|| default.clone());
        let unit = schema["x-unit"].as_str().or(schema["items"]["x-unit"].as_str()).and_then(Unit::named);
        let unit = unit.unwrap_or(Unit::ONE);
        let placeholder = match derived {
            Some(meaning) => meaning,
            None if schema["description"].as_str().is_some_and(|help| help.contains("when null")) => "derived",
            None => "",
        };
        Some(FormField {
            id: format!("field{}", pointer.replace('/', "-")),
            pointer: pointer.to_owned(),
            label: label(pointer, unit),
            row: String::new(),
            context: String::new(),
            symbol: description.symbol,
            help: help(schema),
            range: range(schema, unit),
            unit: unit.symbol,
            control: control(description, &value)?,
            value,
            default,
            placeholder,
            required: description.required,
            condition: description.condition.clone(),
            group: description.group,
            order: description.order,
        })
    }

    /// A field for which the schema of the document has no control: an object, a list of objects.
    pub(crate) fn bare(description: &FieldDescription) -> FormField {
        let FieldDescription { pointer, schema, .. } = description;
        FormField {
            id: format!("field{}", pointer.replace('/', "-")),
            pointer: pointer.to_owned(),
            label: label(pointer, Unit::ONE),
            row: String::new(),
            context: String::new(),
            symbol: description.symbol,
            help: help(schema),
            range: String::new(),
            unit: "",
            control: Control::Json,
            value: String::new(),
            default: String::new(),
            placeholder: "",
            // An empty list is said where its objects are missing.
            required: false,
            condition: None,
            group: description.group,
            order: description.order,
        }
    }

    /// Name of the control for the page's script.
    pub(crate) fn control_name(&self) -> &'static str {
        match self.control {
            Control::Number => "number",
            Control::Integer => "integer",
            Control::Boolean => "boolean",
            Control::Text { .. } => "text",
            Control::Choice(_) => "choice",
            Control::List { of_numbers: true } => "numbers",
            Control::List { of_numbers: false } => "words",
            Control::Json => "json",
            Control::Count => "list",
            Control::Parts(_) => "parts",
        }
    }

    /// Whether the page offers to restore the default.
    pub(crate) fn has_reset(&self) -> bool {
        !self.required && !matches!(self.control, Control::Count)
    }

    /// The label with what the field is of.
    pub(crate) fn full_label(&self) -> String {
        if self.context.is_empty() { self.label.clone() } else { format!("{}, {}", self.label, self.context) }
    }

    /// Identifier of what the items of a list share: that of the field, with a word in place of the item's number.
    pub(crate) fn shared_id(&self) -> String {
        self.id
            .rfind('*')
            .map_or_else(|| self.id.clone(), |place| format!("{}each{}", &self.id[..place], &self.id[place + 1..]))
    }

    /// The default as displayed text, with its unit; the page offers to restore it in a field that differs.
    pub(crate) fn default_text(&self) -> String {
        let default = match (&self.control, self.default.as_str()) {
            (Control::Choice(choices) | Control::Parts(choices), word) => {
                choices.iter().find(|choice| choice.word == word).map_or(String::new(), |choice| choice.label.clone())
            }
            (_, "") => return "empty".to_owned(),
            (_, text) => text.to_owned(),
        };
        format!("{default} {}", self.unit).trim_end().to_owned()
    }

    pub(crate) fn is_sweep_target(&self) -> bool {
        self.pointer.starts_with("/axes/") && self.pointer.ends_with("/pointer")
    }
}

fn control(description: &FieldDescription, value: &str) -> Option<Control> {
    let FieldDescription { schema, labels, derived, .. } = description;
    if let Some(words) = schema["enum"].as_array() {
        let word = |word: &Value| {
            let word = text(word);
            Choice { label: choice_label(labels, &word), chosen: word == value, word }
        };
        let derived = derived.map(|meaning| Choice { word: String::new(), label: meaning.to_owned(), chosen: true });
        let words = words.iter().filter(|word| !word.is_null()).map(word);
        return Some(Control::Choice(derived.into_iter().chain(words).collect()));
    }
    Some(match schema["type"].as_str()? {
        "number" => Control::Number,
        "integer" => Control::Integer,
        "boolean" => Control::Boolean,
        "string" => Control::Text { max_length: schema["maxLength"].as_u64().unwrap_or(1000) },
        "array" => match schema["items"]["type"].as_str() {
            Some("number") => Control::List { of_numbers: true },
            Some("string") => Control::List { of_numbers: false },
            _ => Control::Json,
        },
        _ => return None,
    })
}

/// The label of a word; the word itself if it has none.
fn choice_label(labels: &[(&str, &str)], word: &str) -> String {
    let own = labels.iter().find(|(name, _)| *name == word);
    own.map_or_else(|| word.replace('_', " "), |(_, label)| (*label).to_owned())
}

/// The text of a value in an input: numbers in their shortest form, empty for null.
fn text(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), number_text),
        other => other.to_string(),
    }
}

/// Shortest text of a number, with an exponent where it has many zeros.
fn number_text(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) { format!("{number:e}") } else { number.to_string() }
}

fn range(schema: &Value, unit: &Unit) -> String {
    let bounds = if schema["items"].is_object() { &schema["items"] } else { schema };
    // The range of an axis is that of the swept field, which the server checks.
    if unit.text == "unit of the input" {
        return String::new();
    }
    let (Some(minimum), Some(maximum)) = (bounds["minimum"].as_f64(), bounds["maximum"].as_f64()) else {
        return String::new();
    };
    format!("{} to {} {}", number_text(minimum), number_text(maximum), unit.symbol).trim_end().to_owned()
}

/// The field's help, with "empty" in place of the document's "null".
fn help(schema: &Value) -> String {
    schema["description"].as_str().unwrap_or_default().replace("when null", "when empty").replace("if null", "if empty")
}

/// Names of objects that are already part of the title of the section or block.
const SAID_BY_THE_SECTION: [&str; 16] = [
    "axes",
    "0",
    "1",
    "design",
    "pinion",
    "gear",
    "left",
    "right",
    "material",
    "supports",
    "shafts",
    "arrangement",
    "assembly",
    "operation",
    "model",
    "analysis",
];

/// Corrected spelling of words in field names, which are ASCII in lower case.
const SPELLINGS: [(&str, &str); 3] = [("youngs", "Young's"), ("poissons", "Poisson's"), ("center", "centre")];

/// "/design/pinion/tip_relief/amount_um" becomes "Tip relief, amount".
fn label(pointer: &str, unit: &Unit) -> String {
    let mut parts: Vec<String> = pointer
        .split('/')
        .filter(|part| !part.is_empty() && !SAID_BY_THE_SECTION.contains(part))
        .filter(|part| *part != "mesh_stiffness" && *part != "impact")
        .map(str::to_owned)
        .collect();
    if let Some(name) = parts.last_mut() {
        *name = name.strip_suffix(unit.suffix).unwrap_or(name).to_owned();
    }
    let words = parts.join(", ").replace('_', " ");
    let words = SPELLINGS.iter().fold(words, |words, (name, spelling)| words.replace(name, spelling));
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_words_without_the_unit() {
        let label = |pointer, unit| label(pointer, Unit::named(unit).unwrap());
        assert_eq!(label("/design/normal_module_mm", "mm"), "Normal module");
        assert_eq!(label("/design/pinion/tip_relief/amount_um", "um"), "Tip relief, amount");
        assert_eq!(label("/model/impact/force_n", "N"), "Force");
        assert_eq!(label("/design/gear/left_half_hand", "1"), "Left half hand");
    }

    #[test]
    fn words_have_the_labels_of_their_declaration() {
        assert_eq!(choice_label(&[("fe", "finite elements")], "fe"), "finite elements");
        assert_eq!(choice_label(&[], "apex_leading"), "apex leading");
    }

    #[test]
    fn numbers_are_written_as_people_write_them() {
        let written = [0.0, 17.0, 24.43, 1e-6, 200_000.0, 1e7, -0.5].map(number_text);
        assert_eq!(written, ["0", "17", "24.43", "1e-6", "200000", "1e7", "-0.5"]);
    }
}
