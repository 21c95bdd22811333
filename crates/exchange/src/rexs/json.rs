//! REXS as JSON.

use super::model::{Attribute, Component, MAX_ARRAY, MAX_ELEMENTS, RawCase, RawModel, RawRelation, Value};
use super::xml::decoded;
use crate::refusal::{Refusal, short};
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, de};
use std::fmt;

/// Longest text of a value that is kept, bytes.
const MAX_TEXT: usize = 4096;

/// Reads a model.
///
/// # Errors
/// [`Refusal`] for text that is not JSON, or not a REXS model.
pub(super) fn read(text: &str) -> Result<RawModel, Refusal> {
    // Every element of a model has an id.
    if text.matches("\"id\"").count() > MAX_ELEMENTS {
        let detail = format!("has more than {MAX_ELEMENTS} components, attributes and relations");
        return Err(Refusal::unreadable("too-large", detail));
    }
    let file: File = serde_json::from_str(text).map_err(|error| {
        let kind = match error.classify() {
            serde_json::error::Category::Data => "is JSON, but not a REXS model",
            _ => "is not JSON, or not complete",
        };
        Refusal::unreadable("not-readable", format!("{kind}: {}", short(&error.to_string())))
    })?;
    let Some(model) = file.model else {
        return Err(Refusal::unreadable("not-rexs", "is JSON, but has no member \"model\": no REXS model"));
    };
    let cases = model.load_spectrum.0.into_iter().flat_map(|spectrum| spectrum.load_cases);
    Ok(RawModel {
        version: model.version.0,
        application: model.application.0,
        application_version: model.application_version.0,
        components: model.components.into_iter().map(JsonComponent::component).collect(),
        relations: model.relations.into_iter().map(JsonRelation::relation).collect(),
        cases: cases
            .map(|case| RawCase {
                id: case.id.0,
                components: case.components.into_iter().map(JsonComponent::component).collect(),
            })
            .collect(),
    })
}

#[derive(Deserialize)]
struct File {
    model: Option<JsonModel>,
}

#[derive(Deserialize)]
struct JsonModel {
    #[serde(default)]
    version: Text,
    #[serde(default, rename = "applicationId")]
    application: Text,
    #[serde(default, rename = "applicationVersion")]
    application_version: Text,
    #[serde(default)]
    relations: Vec<JsonRelation>,
    #[serde(default)]
    components: Vec<JsonComponent>,
    #[serde(default)]
    load_spectrum: OneOrMany<JsonSpectrum>,
}

#[derive(Deserialize)]
struct JsonRelation {
    id: Option<Id>,
    #[serde(rename = "type", default)]
    kind: Text,
    order: Option<Id>,
    #[serde(default)]
    refs: Vec<JsonRef>,
}

#[derive(Deserialize)]
struct JsonRef {
    id: Id,
    #[serde(default)]
    role: Text,
}

#[derive(Deserialize)]
struct JsonComponent {
    id: Id,
    #[serde(rename = "type", default)]
    kind: Text,
    name: Option<Text>,
    #[serde(default)]
    attributes: Vec<JsonAttribute>,
}

#[derive(Deserialize)]
struct JsonSpectrum {
    #[serde(default)]
    load_cases: Vec<JsonCase>,
}

#[derive(Deserialize)]
struct JsonCase {
    id: Id,
    #[serde(default)]
    components: Vec<JsonComponent>,
}

impl JsonRelation {
    fn relation(self) -> RawRelation {
        RawRelation {
            id: self.id.map(|id| id.0),
            kind: self.kind.0,
            order: self.order.map(|order| order.0),
            refs: self.refs.into_iter().map(|one| (one.role.0, one.id.0)).collect(),
        }
    }
}

impl JsonComponent {
    fn component(self) -> Component {
        let name = self.name.map(|name| name.0);
        let attributes = self.attributes.into_iter().filter_map(|attribute| attribute.0).collect();
        Component { id: self.id.0, kind: self.kind.0, name, attributes }
    }
}

/// A text; a number or null is taken as one.
#[derive(Default)]
struct Text(String);

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match AnyValue::deserialize(deserializer)?.0 {
            Some(Value::Text(text)) => Ok(Text(text)),
            Some(Value::Number(number)) => Ok(Text(number.to_string())),
            None => Ok(Text::default()),
            Some(_) => Err(de::Error::custom("a text is expected")),
        }
    }
}

/// An id: a whole number, also as a text.
struct Id(i64);

impl<'de> Deserialize<'de> for Id {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let whole = |number: f64| number.fract() == 0.0 && number.abs() < 9e15;
        match AnyValue::deserialize(deserializer)?.0 {
            Some(Value::Number(number)) if whole(number) => Ok(Id(number as i64)),
            Some(Value::Text(text)) => text.trim().parse().map(Id).map_err(de::Error::custom),
            _ => Err(de::Error::custom("an id is not a whole number")),
        }
    }
}

/// One object, or a list of them.
struct OneOrMany<T>(Vec<T>);

impl<T> Default for OneOrMany<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for OneOrMany<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Many<T>(std::marker::PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Many<T> {
            type Value = Vec<T>;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("an object or a list of them")
            }

            fn visit_unit<E>(self) -> Result<Vec<T>, E> {
                Ok(Vec::new())
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Vec<T>, A::Error> {
                let mut all = Vec::new();
                while let Some(item) = items.next_element()? {
                    all.push(item);
                }
                Ok(all)
            }

            fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<Vec<T>, A::Error> {
                Ok(vec![T::deserialize(de::value::MapAccessDeserializer::new(members))?])
            }
        }
        deserializer.deserialize_any(Many(std::marker::PhantomData)).map(Self)
    }
}

/// An attribute; none where its value is null.
struct JsonAttribute(Option<Attribute>);

impl<'de> Deserialize<'de> for JsonAttribute {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Members;
        impl<'de> Visitor<'de> for Members {
            type Value = Option<Attribute>;

            fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
                formatter.write_str("an attribute")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Option<Attribute>, A::Error> {
                let (mut id, mut unit, mut is_user_defined, mut value) = (Text::default(), None, false, None);
                while let Some(name) = members.next_key::<String>()? {
                    match name.as_str() {
                        "id" => id = members.next_value()?,
                        "unit" => unit = Some(members.next_value::<Text>()?.0),
                        "origin" => is_user_defined = members.next_value::<Text>()?.0 == "user_defined",
                        _ => {
                            let given = members.next_value::<AnyValue>()?.0;
                            value = value.or(given);
                        }
                    }
                }
                Ok(value.map(|value| Attribute { id: id.0, unit, value, is_user_defined }))
            }
        }
        deserializer.deserialize_map(Members).map(Self)
    }
}

/// Any JSON value of an attribute; none for null.
struct AnyValue(Option<Value>);

impl<'de> Deserialize<'de> for AnyValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ValueVisitor).map(Self)
    }
}

struct ValueVisitor;

impl<'de> Visitor<'de> for ValueVisitor {
    type Value = Option<Value>;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("the value of an attribute")
    }

    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Self::Value, E> {
        Ok(Some(Value::Flag(value)))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Self::Value, E> {
        Ok(Some(Value::Number(value as f64)))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Self::Value, E> {
        Ok(Some(Value::Number(value as f64)))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Self::Value, E> {
        Ok(Some(Value::Number(value)))
    }

    fn visit_str<E>(self, text: &str) -> Result<Self::Value, E> {
        let text = text.trim();
        Ok(match text.len() {
            0 => None,
            1..=MAX_TEXT => Some(Value::Text(text.to_owned())),
            _ => Some(Value::Other),
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Self::Value, A::Error> {
        let mut numbers = Some(Vec::new());
        loop {
            let Some(kept) = numbers.as_mut().filter(|kept| kept.len() < MAX_ARRAY) else {
                // The rest is read over.
                numbers = match items.next_element::<IgnoredAny>()? {
                    Some(_) => None,
                    None => break,
                };
                continue;
            };
            match items.next_element::<AnyValue>()? {
                Some(AnyValue(Some(Value::Number(number)))) => kept.push(number),
                Some(_) => numbers = None,
                None => break,
            }
        }
        Ok(Some(numbers.map_or(Value::Other, Value::Numbers)))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Self::Value, A::Error> {
        let (mut code, mut text) = (String::new(), String::new());
        while let Some(name) = members.next_key::<String>()? {
            match (name.as_str(), members.next_value::<AnyValue>()?.0) {
                ("code", Some(Value::Text(given))) => code = given,
                ("value", Some(Value::Text(given))) => text = given,
                _ => {}
            }
        }
        Ok(Some(decoded(&code, &text).map_or(Value::Other, Value::Numbers)))
    }
}
