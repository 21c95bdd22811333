//! One field of the form, made from its declaration in the job document's schema.

use super::groups::{CONDITIONS, Condition, DERIVED};
use super::is_at_or_in;
use super::symbols::symbol;
use serde_json::Value;

/// What kind of input a field has; the page's script reads its value back accordingly.
pub enum Control {
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
}

/// An option of a [`Control::Choice`].
pub struct Choice {
    pub word: String,
    pub label: String,
    pub chosen: bool,
}

/// A field: all its texts as they stand on the page.
pub struct Field {
    pub id: String,
    pub pointer: String,
    pub label: String,
    /// Label of the row that the field shares with others; empty where it stands alone.
    pub row: String,
    /// Letter and subscript of the quantity, or empty.
    pub symbol: (&'static str, &'static str),
    pub help: String,
    /// Permitted range with unit, or empty.
    pub range: String,
    /// Unit for people, or empty.
    pub unit: &'static str,
    pub control: Control,
    /// First contents of the input.
    pub value: String,
    /// What leaving the field out means; empty when it has no fixed default.
    pub default: String,
    /// Shown in an empty input.
    pub placeholder: &'static str,
    pub required: bool,
    /// Shown only while another field has one of these values.
    pub condition: Option<&'static Condition>,
}

impl Field {
    /// A field from its schema; nothing for objects, whose fields are declared on their own.
    pub fn new(pointer: &str, schema: &Value, required: bool, example: Option<&Value>) -> Option<Field> {
        let derived = DERIVED.iter().find(|(place, _)| is_at_or_in(pointer, place)).map(|(_, meaning)| *meaning);
        let default = if derived.is_some() { String::new() } else { text(&schema["default"]) };
        let value = example.map(text).unwrap_or_else(|| default.clone());
        let declared_unit = schema["x-unit"].as_str().or(schema["items"]["x-unit"].as_str()).unwrap_or("1");
        let placeholder = match derived {
            Some(meaning) => meaning,
            None if schema["description"].as_str().is_some_and(|help| help.contains("when null")) => "derived",
            None => "",
        };
        Some(Field {
            id: format!("field{}", pointer.replace('/', "-")),
            pointer: pointer.to_owned(),
            label: label(pointer, declared_unit),
            row: String::new(),
            symbol: symbol(pointer),
            help: help(schema),
            range: range(schema, declared_unit),
            unit: shown_unit(declared_unit),
            control: control(pointer, schema, &value, derived)?,
            value,
            default,
            placeholder,
            required,
            condition: CONDITIONS.iter().find(|condition| is_at_or_in(pointer, condition.pointer)),
        })
    }

    /// Name of the control for the page's script.
    pub fn control_name(&self) -> &'static str {
        match self.control {
            Control::Number => "number",
            Control::Integer => "integer",
            Control::Boolean => "boolean",
            Control::Text { .. } => "text",
            Control::Choice(_) => "choice",
            Control::List { of_numbers: true } => "numbers",
            Control::List { of_numbers: false } => "words",
            Control::Json => "json",
        }
    }

    /// Where a field differs from this, the page offers to put it back; in words for people.
    pub fn default_text(&self) -> String {
        let default = match (&self.control, self.default.as_str()) {
            (Control::Choice(choices), word) => {
                choices.iter().find(|choice| choice.word == word).map_or(String::new(), |choice| choice.label.clone())
            }
            (_, "") => return "empty".to_owned(),
            (_, text) => text.to_owned(),
        };
        format!("{default} {}", self.unit).trim_end().to_owned()
    }

    pub fn is_sweep_target(&self) -> bool {
        self.pointer.starts_with("/axes/") && self.pointer.ends_with("/pointer")
    }
}

fn control(pointer: &str, schema: &Value, value: &str, derived: Option<&str>) -> Option<Control> {
    if let Some(words) = schema["enum"].as_array() {
        let word = |word: &Value| {
            let word = text(word);
            Choice { label: choice_label(pointer, &word), chosen: word == value, word }
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

/// Words of the document that people would say otherwise: end of the field's pointer, word, label.
const CHOICES: [(&str, &str, &str); 15] = [
    ("/kind", "mesh", "mesh (contact, impact)"),
    ("/kind", "response", "response (one point)"),
    ("/kind", "sweep", "sweep (over inputs)"),
    ("/mesh_stiffness/source", "ltca", "loaded tooth contact"),
    ("/mesh_stiffness/source", "iso6336", "ISO 6336-1, closed form"),
    ("/mesh_stiffness/fidelity", "fe", "finite elements"),
    ("/mesh_stiffness/fidelity", "uniform", "uniform foundation"),
    ("/mesh_force", "contact", "loaded contact"),
    ("/mesh_force", "stiffness", "stiffness and impact (the source's)"),
    ("/mesh_stiffness/law", "secant", "secant F/δ"),
    ("/mesh_stiffness/law", "tangent", "tangent dF/dδ"),
    ("/impact/source", "zhou2008", "Zhou (2008), unbuffered"),
    ("/plane", "base", "base (consistent)"),
    ("/plane", "pitch", "pitch (the source's)"),
    ("/integrator", "runge_kutta_4", "Runge–Kutta 4"),
];

fn choice_label(pointer: &str, word: &str) -> String {
    let found = CHOICES.iter().find(|(end, name, _)| pointer.ends_with(end) && *name == word);
    found.map_or_else(|| word.replace('_', " "), |(.., label)| (*label).to_owned())
}

/// The text of a value as it stands in an input: numbers as people write them, nothing for null.
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

fn range(schema: &Value, unit: &str) -> String {
    let bounds = if schema["items"].is_object() { &schema["items"] } else { schema };
    // The axes of a sweep take what the swept field takes, which the server says.
    if unit == "unit of the input" {
        return String::new();
    }
    let (Some(minimum), Some(maximum)) = (bounds["minimum"].as_f64(), bounds["maximum"].as_f64()) else {
        return String::new();
    };
    format!("{} to {} {}", number_text(minimum), number_text(maximum), shown_unit(unit)).trim_end().to_owned()
}

/// The field's help; what the document calls null is an empty input here.
fn help(schema: &Value) -> String {
    schema["description"].as_str().unwrap_or_default().replace("when null", "when empty").replace("if null", "if empty")
}

/// Names of objects that the section or block already says.
const SAID_BY_THE_SECTION: [&str; 14] = [
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
    "assembly",
    "operation",
    "model",
    "analysis",
];

/// Words that field names cannot spell.
const SPELLINGS: [(&str, &str); 3] = [("youngs", "Young's"), ("poissons", "Poisson's"), ("center", "centre")];

/// "/design/pinion/tip_relief/amount_um" becomes "Tip relief, amount".
fn label(pointer: &str, unit: &str) -> String {
    let mut parts: Vec<String> = pointer
        .split('/')
        .filter(|part| !part.is_empty() && !SAID_BY_THE_SECTION.contains(part))
        .filter(|part| *part != "mesh_stiffness" && *part != "impact")
        .map(str::to_owned)
        .collect();
    if let Some(name) = parts.last_mut() {
        *name = name.strip_suffix(unit_suffix(unit)).unwrap_or(name).to_owned();
    }
    let words = parts.join(", ").replace('_', " ");
    let words = SPELLINGS.iter().fold(words, |words, (name, spelling)| words.replace(name, spelling));
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// Declared unit, how field names end with it, how people write it.
const UNITS: [(&str, &str, &str); 17] = [
    ("1", "", ""),
    ("mm", "_mm", "mm"),
    ("um", "_um", "µm"),
    ("deg", "_deg", "°"),
    ("rad", "_rad", "rad"),
    ("GPa", "_gpa", "GPa"),
    ("kg/m3", "_kg_m3", "kg/m³"),
    ("kg", "_kg", "kg"),
    ("kg m2", "_kg_m2", "kg·m²"),
    ("N", "_n", "N"),
    ("N/um", "_n_per_um", "N/µm"),
    ("N/(mm um)", "_n_per_mm_um", "N/(mm·µm)"),
    ("N m", "_nm", "N·m"),
    ("N m/rad", "_nm_per_rad", "N·m/rad"),
    ("r/min", "_rpm", "r/min"),
    ("SI", "", "SI units"),
    ("unit of the input", "", "in its unit"),
];

fn unit_suffix(unit: &str) -> &'static str {
    UNITS.iter().find(|(declared, ..)| *declared == unit).map_or("", |(_, suffix, _)| suffix)
}

fn shown_unit(unit: &str) -> &'static str {
    UNITS.iter().find(|(declared, ..)| *declared == unit).map_or("", |(.., shown)| shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::schema::field_descriptions;

    #[test]
    fn labels_are_words_without_the_unit() {
        assert_eq!(label("/design/normal_module_mm", "mm"), "Normal module");
        assert_eq!(label("/design/pinion/tip_relief/amount_um", "um"), "Tip relief, amount");
        assert_eq!(label("/model/impact/force_n", "N"), "Force");
        assert_eq!(label("/design/gear/left_half_hand", "1"), "Left half hand");
    }

    #[test]
    fn labels_of_choices_belong_to_words_of_fields() {
        for (end, word, _) in CHOICES {
            let fields = field_descriptions();
            let mut schemas = fields.iter().filter(|field| field.pointer.ends_with(end)).map(|field| &field.schema);
            let has =
                |schema: &Value| schema["enum"].as_array().is_some_and(|words| words.iter().any(|known| known == word));
            assert!(schemas.any(has), "{word} of {end}");
        }
        assert_eq!(choice_label("/analysis/method", "auto"), "auto");
    }

    #[test]
    fn every_declared_unit_is_known_and_ends_the_name() {
        for field in field_descriptions() {
            let Some(unit) = field.schema["x-unit"].as_str() else { continue };
            let known = UNITS.iter().find(|(declared, ..)| *declared == unit);
            let (_, suffix, _) = known.unwrap_or_else(|| panic!("{unit} of {}", field.pointer));
            assert!(field.pointer.ends_with(suffix), "{} in {unit}", field.pointer);
        }
    }

    #[test]
    fn numbers_are_written_as_people_write_them() {
        let written = [0.0, 17.0, 24.43, 1e-6, 200_000.0, 1e7, -0.5].map(number_text);
        assert_eq!(written, ["0", "17", "24.43", "1e-6", "200000", "1e7", "-0.5"]);
    }
}
