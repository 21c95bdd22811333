//! Fields of the job document: their declarations, and the types that a field can have.
//!
//! A field is declared once, as a field of a struct with `#[derive(Input)]`; `herringbone_macros::Input` lists the
//! attributes. The reader, the JSON Schema, the form, the hints, the axes of sweeps and the random documents of tests
//! follow from it. A closed list of words is an enum with `#[derive(Words)]`. A type whose JSON is of another shape
//! than the type implements [`Input`] itself, out of derived parts.

use super::path::{index, split_first};
use super::reader::{Object, ObjectPlace, Reading, not_whole, out_of_range};
use super::unit::Unit;
use super::violation::Violation;
use serde_json::{Map, Value};

/// Declaration of a field of the job document, without its type and its default.
#[derive(Debug)]
pub(crate) struct Declared {
    pub name: &'static str,
    /// Help text: the first paragraph of the field's doc comment.
    pub help: &'static str,
    /// Whether an object is required. Values are required if they have no default.
    pub required: bool,
    /// Permitted range of a number, or of the numbers of a list, in `unit`.
    pub min: f64,
    pub max: f64,
    pub unit: &'static Unit,
    /// Permitted number of items of a list.
    pub min_items: usize,
    pub max_items: usize,
    /// Largest number of characters of a text.
    pub max_chars: usize,
    /// Whether an empty field is omitted when the document is serialized.
    pub omitted: bool,
    pub form: FormPlace,
}

/// Position of a field in the form. The position of an object applies to the fields in it, unless they declare their
/// own.
#[derive(Debug)]
pub(crate) struct FormPlace {
    /// Section of the form; empty: that of the object.
    pub group: &'static str,
    /// Rank among the fields of a block, ascending.
    pub order: i32,
    /// Symbol of the quantity: letter and subscript.
    pub symbol: (&'static str, &'static str),
    /// Description of a default that depends on other fields.
    pub derived: Option<&'static str>,
    /// Descriptions of such defaults of single fields of an object: name and text.
    pub derived_in: &'static [(&'static str, &'static str)],
    /// A field of the same object (or, with a slash, of an object in it) and its values, separated by spaces, for which
    /// this one matters.
    pub when: Option<(&'static str, &'static str)>,
}

impl Declared {
    /// A position with nothing declared.
    pub(crate) const NOTHING: Declared = Declared {
        name: "",
        help: "",
        required: false,
        min: 0.0,
        max: 0.0,
        unit: Unit::ONE,
        min_items: 0,
        max_items: 0,
        max_chars: 0,
        omitted: false,
        form: FormPlace { group: "", order: 0, symbol: ("", ""), derived: None, derived_in: &[], when: None },
    };
}

/// An object of the document.
pub(crate) trait Input: Sized {
    /// Reads the members of `object`, and checks the rules between them. A member that is left out takes its value in
    /// `base`, without a base its declared default. Members that are not declared are not reported.
    fn read(object: &Object, base: Option<&Self>) -> Self;

    /// Checks the rules between fields, of this object and of those in it.
    fn check(&mut self, place: &ObjectPlace);

    /// The slot at `pointer` relative to this object; `None` if the document has no field there.
    fn slot(&mut self, pointer: &str) -> Option<Slot<'_>>;

    /// The value of an object with every field left out; required numbers take their smallest permitted value.
    fn defaults() -> Self {
        Self::read(&Reading::fill().root(&Value::Object(Map::new())), None)
    }
}

/// A type that a field can have.
pub(crate) trait Field: Sized {
    /// Reads the field `declared` of `object`. `default`: the value of an absent field; `None`: the field is required.
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self;

    /// Checks the rules between fields inside this one.
    fn check(&mut self, _declared: &'static Declared, _place: &ObjectPlace) {}

    /// The slot at `pointer` relative to this field.
    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>>;
}

/// A closed list of words, as an enum. `#[derive(Words)]` implements it.
pub(crate) trait Words: Copy + PartialEq + 'static {
    /// Every word with its value.
    const WORDS: &'static [(&'static str, Self)];
    /// Labels shown in the form, for the words that have one.
    const LABELS: &'static [(&'static str, &'static str)];

    fn as_word(self) -> &'static str;

    fn words() -> Vec<&'static str> {
        Self::WORDS.iter().map(|(word, _)| *word).collect()
    }

    fn of_word(word: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(known, _)| *known == word).map(|(_, value)| *value)
    }
}

/// Typed access to the value at a JSON pointer of a document.
pub(crate) enum Slot<'a> {
    Number(&'a mut f64, &'static Declared),
    OptionalNumber(&'a mut Option<f64>, &'static Declared),
    Whole(&'a mut u32, &'static Declared),
    OptionalWhole(&'a mut Option<u32>, &'static Declared),
    /// A value that is not a number.
    Other,
}

impl Slot<'_> {
    pub(crate) fn is_number(&self) -> bool {
        !matches!(self, Slot::Other)
    }

    pub(crate) fn is_whole_number(&self) -> bool {
        matches!(self, Slot::Whole(..) | Slot::OptionalWhole(..))
    }

    /// The number that stands here; none of another value, or where there is none.
    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Slot::Number(number, _) => Some(**number),
            Slot::OptionalNumber(number, _) => **number,
            Slot::Whole(number, _) => Some(f64::from(**number)),
            Slot::OptionalWhole(number, _) => number.map(f64::from),
            Slot::Other => None,
        }
    }

    /// Permitted range of a number.
    pub(crate) fn range(&self) -> Option<[f64; 2]> {
        match self {
            Slot::Number(_, declared)
            | Slot::OptionalNumber(_, declared)
            | Slot::Whole(_, declared)
            | Slot::OptionalWhole(_, declared) => Some([declared.min, declared.max]),
            Slot::Other => None,
        }
    }

    /// Assigns a number.
    ///
    /// # Errors
    /// The violation, without its pointer, if the number is out of range or is not an integer where one is required.
    /// The document is then unchanged.
    pub(crate) fn set(self, number: f64) -> Result<(), Box<Violation>> {
        let declared = match &self {
            Slot::Number(_, declared) | Slot::OptionalNumber(_, declared) => declared,
            Slot::Whole(_, declared) | Slot::OptionalWhole(_, declared) => {
                if let Some(fractional) = serde_json::Number::from_f64(number).filter(|_| number.fract() != 0.0) {
                    return Err(Box::new(not_whole(&fractional, declared)));
                }
                declared
            }
            Slot::Other => return Err(Box::new(Violation::new("", "conflict", "is not a number"))),
        };
        if let Some(violation) = out_of_range(number, declared) {
            return Err(Box::new(violation));
        }
        match self {
            Slot::Number(slot, _) => *slot = number,
            Slot::OptionalNumber(slot, _) => *slot = Some(number),
            Slot::Whole(slot, _) => *slot = number as u32,
            Slot::OptionalWhole(slot, _) => *slot = Some(number as u32),
            Slot::Other => {}
        }
        Ok(())
    }
}

/// The slot of a value that has no members.
fn leaf<'a>(pointer: &str, slot: Slot<'a>) -> Option<Slot<'a>> {
    pointer.is_empty().then_some(slot)
}

impl Field for f64 {
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self {
        object.number(declared, default.copied())
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        leaf(pointer, Slot::Number(self, declared))
    }
}

impl Field for Option<f64> {
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self {
        object.optional_number(declared, default.copied().flatten())
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        leaf(pointer, Slot::OptionalNumber(self, declared))
    }
}

impl Field for u32 {
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self {
        object.integer(declared, default.copied())
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        leaf(pointer, Slot::Whole(self, declared))
    }
}

impl Field for Option<u32> {
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self {
        object.optional_integer(declared, default.copied().flatten())
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        leaf(pointer, Slot::OptionalWhole(self, declared))
    }
}

impl Field for bool {
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self {
        object.boolean(declared, default.copied().unwrap_or_default())
    }

    fn slot(&mut self, _declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        leaf(pointer, Slot::Other)
    }
}

impl Field for String {
    fn read(object: &Object, declared: &'static Declared, _default: Option<&Self>) -> Self {
        object.required_text(declared)
    }

    fn slot(&mut self, _declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        leaf(pointer, Slot::Other)
    }
}

impl Field for Option<String> {
    fn read(object: &Object, declared: &'static Declared, _default: Option<&Self>) -> Self {
        object.text(declared)
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        leaf(pointer, Slot::Other).filter(|_| self.is_some() || !declared.omitted)
    }
}

impl Field for Vec<String> {
    fn read(object: &Object, declared: &'static Declared, _default: Option<&Self>) -> Self {
        object.texts(declared).unwrap_or_default()
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        text_slot(self, declared, pointer)
    }
}

impl Field for Option<Vec<String>> {
    fn read(object: &Object, declared: &'static Declared, _default: Option<&Self>) -> Self {
        object.texts(declared)
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        match self {
            Some(texts) => text_slot(texts, declared, pointer),
            None => leaf(pointer, Slot::Other).filter(|_| !declared.omitted),
        }
    }
}

fn text_slot<'a>(texts: &[String], declared: &Declared, pointer: &str) -> Option<Slot<'a>> {
    match split_first(pointer) {
        None => leaf(pointer, Slot::Other).filter(|_| !texts.is_empty() || !declared.omitted),
        Some((item, rest)) => texts.get(index(item)?).and_then(|_| leaf(rest, Slot::Other)),
    }
}

impl Field for Option<Vec<f64>> {
    fn read(object: &Object, declared: &'static Declared, _default: Option<&Self>) -> Self {
        object.numbers(declared)
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        match self {
            Some(numbers) => number_slot(numbers, declared, pointer),
            None => leaf(pointer, Slot::Other).filter(|_| !declared.omitted),
        }
    }
}

/// A list of numbers, or a number of it.
pub(crate) fn number_slot<'a>(numbers: &'a mut [f64], declared: &'static Declared, pointer: &str) -> Option<Slot<'a>> {
    match split_first(pointer) {
        None => leaf(pointer, Slot::Other),
        Some((item, rest)) => leaf(rest, Slot::Number(numbers.get_mut(index(item)?)?, declared)),
    }
}

impl<T: Input> Field for T {
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self {
        let nested = object.object(declared);
        let value = <T as Input>::read(&nested, default);
        nested.finish();
        value
    }

    fn check(&mut self, declared: &'static Declared, place: &ObjectPlace) {
        Input::check(self, &place.member(declared.name));
    }

    fn slot(&mut self, _declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        if pointer.is_empty() { Some(Slot::Other) } else { Input::slot(self, pointer) }
    }
}

/// An object that is absent when it is left out; its base is that of its fields when it is given.
impl<T: Input> Field for Option<T> {
    fn read(object: &Object, declared: &'static Declared, default: Option<&Self>) -> Self {
        let nested = object.optional_object(declared)?;
        let value = <T as Input>::read(&nested, default.and_then(Option::as_ref));
        nested.finish();
        Some(value)
    }

    fn check(&mut self, declared: &'static Declared, place: &ObjectPlace) {
        if let Some(value) = self {
            Field::check(value, declared, place);
        }
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        match self {
            Some(value) => Field::slot(value, declared, pointer),
            None => leaf(pointer, Slot::Other).filter(|_| !declared.omitted),
        }
    }
}

/// A list of objects; empty when it is left out.
impl<T: Input> Field for Vec<T> {
    fn read(object: &Object, declared: &'static Declared, _default: Option<&Self>) -> Self {
        let items = object.objects(declared).unwrap_or_default().into_iter().map(|item| {
            let value = <T as Input>::read(&item, None);
            item.finish();
            value
        });
        items.collect()
    }

    fn check(&mut self, declared: &'static Declared, place: &ObjectPlace) {
        for (index, item) in self.iter_mut().enumerate() {
            Input::check(item, &place.item(declared.name, index));
        }
    }

    fn slot(&mut self, declared: &'static Declared, pointer: &str) -> Option<Slot<'_>> {
        match split_first(pointer) {
            None => leaf(pointer, Slot::Other).filter(|_| !self.is_empty() || !declared.omitted),
            Some((item, rest)) => Field::slot(self.get_mut(index(item)?)?, declared, rest),
        }
    }
}
