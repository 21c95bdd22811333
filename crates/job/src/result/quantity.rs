//! The scalars of a result as a table: name, unit and meaning of each, from the declarations of the result's structs.
//! The headline table of the command line, the pages and the comparison of jobs are made from it.

use super::JobResult;
use crate::gear_data::GearData;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A number, word or flag of the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quantity {
    /// JSON pointer in the result; `{half}` in it stands for `left` and `right`.
    pub pointer: String,
    /// Name for people, in lower case.
    pub label: String,
    /// Symbol with its index after an underscore, that of ISO 21771 where there is one; else empty.
    pub symbol: &'static str,
    /// Unit in ASCII; empty where there is none.
    pub unit: &'static str,
    /// Meaning; empty where the label says it.
    pub help: &'static str,
    /// Section of `docs/theory` with formula, source, validity and validation: page and heading, `contact#line-load`.
    pub theory: &'static str,
    pub kind: QuantityKind,
    /// Place among the headline numbers of its block: smaller ones first, equal ones in the order of the table.
    #[serde(skip)]
    pub headline: Option<u8>,
    /// The value is a share of 1 that people read in per cent; `unit` is `%`.
    pub percent: bool,
    pub change: Change,
    pub lower_is_better: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum QuantityKind {
    Number,
    Word,
    Flag,
}

/// Form in which the difference of two values is displayed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// In per cent of the reference.
    Percent,
    /// In per cent of the reference and as a level in dB.
    Level,
    /// In percentage points.
    Points,
    /// In the unit of the quantity.
    Absolute,
    /// Words and flags have no difference.
    None,
}

/// Every scalar of a result, in the order of the result.
pub fn quantities() -> &'static [Quantity] {
    static QUANTITIES: LazyLock<Vec<Quantity>> = LazyLock::new(declared_by::<JobResult>);
    &QUANTITIES
}

/// Every scalar of the gear data, in their order.
pub fn gear_data_quantities() -> &'static [Quantity] {
    static QUANTITIES: LazyLock<Vec<Quantity>> = LazyLock::new(declared_by::<GearData>);
    &QUANTITIES
}

/// The scalars of an answer of type `T`, with pointers from its root.
fn declared_by<T: ResultFields>() -> Vec<Quantity> {
    let mut quantities = Vec::new();
    T::declare(&Place::ROOT, &mut quantities);
    quantities
}

impl Quantity {
    const HALF: &'static str = "{half}";

    /// Pointers and labels of the values: one, or one for each half.
    pub fn places(&self) -> Vec<(String, String)> {
        if !self.pointer.contains(Self::HALF) {
            return vec![(self.pointer.clone(), self.label.clone())];
        }
        let halves = ["left", "right"];
        halves.map(|half| (self.pointer.replace(Self::HALF, half), format!("{}, {half}", self.label))).into()
    }

    /// First segment of the pointer: `mesh`, `response`, …
    pub fn block(&self) -> &str {
        self.pointer.split('/').nth(1).unwrap_or_default()
    }
}

/// Declaration of a scalar field of the result, made by `#[derive(ResultFields)]`.
#[derive(Debug)]
pub(crate) struct Declaration {
    /// Name in JSON.
    pub name: &'static str,
    pub label: &'static str,
    /// The label was written, not made from the name: it qualifies those of the fields below.
    pub is_labelled: bool,
    pub symbol: &'static str,
    pub unit: &'static str,
    pub help: &'static str,
    /// None: that of the struct, or of the field above.
    pub theory: Option<&'static str>,
    pub headline: Option<u8>,
    pub percent: bool,
    /// None: by the unit.
    pub change: Option<Change>,
    pub lower_is_better: bool,
    /// The scalar has the declaration of the field that holds its struct.
    pub inherits: bool,
}

/// A place in the result with the declaration that holds there.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pointer: String,
    declaration: Option<&'static Declaration>,
    theory: &'static str,
    /// Labels of the fields above, inner ones first.
    qualifiers: Vec<&'static str>,
    /// Number of an item of a list, from 1; part of its label.
    item: Option<usize>,
}

impl Place {
    const ROOT: Self =
        Self { pointer: String::new(), declaration: None, theory: "", qualifiers: Vec::new(), item: None };

    /// The place of a field of the struct that stands here.
    pub(crate) fn field(&self, declaration: &'static Declaration) -> Self {
        let pointer = format!("{}/{}", self.pointer, declaration.name);
        if declaration.inherits {
            return Self { pointer, ..self.clone() };
        }
        let qualifier = self.declaration.filter(|above| above.is_labelled).map(|above| above.label);
        let qualifiers = qualifier.into_iter().chain(self.qualifiers.iter().copied()).collect();
        let theory = declaration.theory.unwrap_or(self.theory);
        Self { pointer, declaration: Some(declaration), theory, qualifiers, item: None }
    }

    /// Adds the first `items` of the list of numbers that stands here as scalars.
    pub(crate) fn declare_items(&self, items: usize, quantities: &mut Vec<Quantity>) {
        let item = |index| Self { pointer: format!("{}/{index}", self.pointer), item: Some(index + 1), ..self.clone() };
        quantities.extend((0..items).filter_map(|index| item(index).scalar(QuantityKind::Number)));
    }

    /// The place of a value of each half: `{half}` stands for both, under the declaration of the field that holds
    /// them.
    pub(crate) fn half(&self) -> Self {
        Self { pointer: format!("{}/{}", self.pointer, Quantity::HALF), ..self.clone() }
    }

    /// This place with the theory section of the struct that stands here.
    pub(crate) fn with_theory(&self, theory: &'static str) -> Self {
        Self { theory, ..self.clone() }
    }

    /// The scalar that stands here; none at the root.
    pub(crate) fn scalar(&self, kind: QuantityKind) -> Option<Quantity> {
        let declaration = self.declaration?;
        let unit = if declaration.percent { "%" } else { declaration.unit };
        let change = declaration.change.unwrap_or(match (kind, unit) {
            (QuantityKind::Word | QuantityKind::Flag, _) => Change::None,
            (QuantityKind::Number, "%") => Change::Points,
            (QuantityKind::Number, "deg") => Change::Absolute,
            (QuantityKind::Number, _) => Change::Percent,
        });
        let own =
            self.item.map_or_else(|| declaration.label.to_owned(), |item| format!("{} {item}", declaration.label));
        let labels: Vec<_> = std::iter::once(own.as_str()).chain(self.qualifiers.iter().copied()).collect();
        Some(Quantity {
            pointer: self.pointer.clone(),
            label: labels.join(", "),
            symbol: declaration.symbol,
            unit,
            help: declaration.help,
            theory: self.theory,
            kind,
            headline: declaration.headline,
            percent: declaration.percent,
            change,
            lower_is_better: declaration.lower_is_better,
        })
    }
}

/// A type in a result: a scalar, a struct of them (by the derive), or what holds none (lists and maps).
pub(crate) trait ResultFields {
    /// Adds the scalars at and below `place`.
    fn declare(place: &Place, quantities: &mut Vec<Quantity>);
}

/// A value that may be there or not: what an option holds, and anything else itself.
pub(crate) trait Optional {
    type Value;

    fn value(&self) -> Option<&Self::Value>;
}

impl<T: ResultFields> ResultFields for Option<T> {
    fn declare(place: &Place, quantities: &mut Vec<Quantity>) {
        T::declare(place, quantities);
    }
}

impl<T: Optional> Optional for Option<T> {
    type Value = T::Value;

    fn value(&self) -> Option<&T::Value> {
        self.as_ref().and_then(T::value)
    }
}

impl<T> ResultFields for Vec<T> {
    fn declare(_place: &Place, _quantities: &mut Vec<Quantity>) {}
}

impl<T> Optional for Vec<T> {
    type Value = Self;

    fn value(&self) -> Option<&Self> {
        Some(self)
    }
}

impl<K, V> ResultFields for BTreeMap<K, V> {
    fn declare(_place: &Place, _quantities: &mut Vec<Quantity>) {}
}

macro_rules! scalars {
    ($($kind:ident: $($scalar:ty),+;)+) => {$($(
        impl $crate::result::ResultFields for $scalar {
            fn declare(place: &$crate::result::Place, quantities: &mut Vec<$crate::result::Quantity>) {
                quantities.extend(place.scalar($crate::result::QuantityKind::$kind));
            }
        }

        impl $crate::result::Optional for $scalar {
            type Value = Self;

            fn value(&self) -> Option<&Self> {
                Some(self)
            }
        }
    )+)+};
}

pub(super) use scalars;

scalars! {
    Number: f64, u32, u64;
    Word: String;
    Flag: bool;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    fn of(pointer: &str) -> &'static Quantity {
        quantities().iter().find(|quantity| quantity.pointer == pointer).unwrap_or_else(|| panic!("no {pointer}"))
    }

    #[test]
    fn each_scalar_has_a_pointer_and_a_label_of_its_own() {
        let (mut pointers, mut labels) = (HashSet::new(), HashSet::new());
        for quantity in quantities() {
            assert!(pointers.insert(&quantity.pointer), "{quantity:?}");
            assert!(!quantity.label.is_empty() && labels.insert((quantity.block(), &quantity.label)), "{quantity:?}");
        }
        assert!(pointers.len() > 100, "{}", pointers.len());
    }

    #[test]
    fn labels_units_and_help_are_those_of_the_declaration() {
        let stiffness = of("/mesh/stiffness_mean_n_per_um");
        assert_eq!((stiffness.label.as_str(), stiffness.unit), ("mesh stiffness of one half, mean", "N/um"));
        // Without attributes: the words of the name and the doc comment.
        let overrun = of("/impact/equivalent_mass_kg");
        assert_eq!((overrun.unit, overrun.change), ("kg", Change::Percent));
        let frequency = of("/response/mesh_frequency_hz");
        assert_eq!((frequency.label.as_str(), frequency.unit), ("mesh frequency", "Hz"));
        assert!(of("/response/period_mesh_periods").help.starts_with("Mesh periods after which"));
        assert_eq!(of("/geometry/gear/tip_diameter_mm").label, "tip diameter, gear");
        let share = of("/mesh/load_share_at_mesh_in");
        assert_eq!((share.unit, share.percent, share.change), ("%", true, Change::Points));
    }

    #[test]
    fn halves_share_a_declaration_and_springs_have_that_of_their_field() {
        let force = of("/response/tooth_force_n/{half}/max");
        let places = [
            ("/response/tooth_force_n/left/max".to_owned(), "largest tooth force, left".to_owned()),
            ("/response/tooth_force_n/right/max".to_owned(), "largest tooth force, right".to_owned()),
        ];
        assert_eq!((force.unit, force.places().as_slice()), ("N", places.as_slice()));
        // Halves beside other fields of their block; what is declared once is not listed again.
        let load = of("/shafts/{half}/k_h_beta");
        assert_eq!((load.symbol, load.places()[1].0.as_str()), ("K_Hβ", "/shafts/right/k_h_beta"));
        assert!(quantities().iter().all(|quantity| !quantity.pointer.starts_with("/shafts/pinion/k_h_beta")));
        let spring = of("/supports/gear_axial_n_per_um/value");
        assert_eq!((spring.label.as_str(), spring.unit), ("axial support, gear", "N/um"));
        let origin = of("/supports/gear_axial_n_per_um/origin");
        assert_eq!((origin.label.as_str(), origin.kind), ("origin, axial support, gear", QuantityKind::Word));
    }
}
