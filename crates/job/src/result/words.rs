//! The words of a result: fields with a fixed set of values. Those that repeat a choice of the document have its type.

use super::{Cell, CellKind, ToCell};
use crate::document::{ActsOn, Hand, ImpactSource, MeshStiffnessSource, Plane};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;

macro_rules! words {
    ($($(#[$attribute:meta])* $name:ident { $($(#[$of_variant:meta])* $variant:ident = $word:literal,)+ })+) => {$(
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$of_variant])* #[serde(rename = $word)] $variant,)+
        }

        impl $name {
            /// The word in the result.
            pub const fn as_str(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }
        }

        super::quantity::scalars! { Word: $name; }

        impl ToCell for Option<$name> {
            const KIND: CellKind = CellKind::Word;

            fn to_cell(&self) -> Cell<'_> {
                Cell::Word(self.map(|word| Cow::Borrowed(word.as_str())))
            }
        }
    )+};
}

words! {
    /// Origin of a spring of the equations of motion.
    SpringOrigin {
        /// Given by the document.
        #[default]
        Given = "given",
        /// Calculated from the gear body.
        Derived = "derived",
        /// Taken in proportion to the size of the pair.
        Assumed = "assumed",
    }

    /// State of contact over the record.
    ContactStateResult {
        /// The working flanks stay in contact.
        #[default]
        Continuous = "continuous",
        /// The teeth separate and come back to the same flanks.
        SingleSided = "single-sided",
        /// The teeth separate and reach the back flanks.
        DoubleSided = "double-sided",
        /// The teeth never touch.
        Apart = "apart",
    }

    /// Method by which the reported motion was found.
    MethodResult {
        /// As a periodic orbit.
        Periodic = "periodic",
        /// By integration in time.
        #[default]
        Integrate = "integrate",
    }

    /// Direction in which a continuation follows a branch.
    BranchDirection {
        #[default]
        Up = "up",
        Down = "down",
    }

    /// A difference between the motions of two branches.
    BranchDifference {
        /// RMS of the mesh acceleration.
        #[default]
        Rms = "rms",
        Regime = "regime",
        Contact = "contact",
    }

    /// What was taken from the store instead of being calculated.
    ReusedStage {
        /// The whole result.
        #[default]
        Result = "result",
        /// The contact analysis.
        Mesh = "mesh",
        /// The finite elements of the gears.
        FiniteElements = "finite_elements",
        /// Points of a sweep.
        Points = "points",
    }

    /// What an evaluation of an optimisation or a tolerance study is for.
    EvaluationPhase {
        /// The document as it was given.
        #[default]
        Input = "input",
        /// The first sample of a search, or the sample of a tolerance study.
        Sample = "sample",
        /// A run of the search's method.
        Search = "search",
        /// Neighbours of the best design on the grid.
        Polish = "polish",
        /// The grid point nearest to the best design, where the time was up.
        Nearest = "nearest",
        /// The best designs with the settings of the document.
        Confirm = "confirm",
        /// Candidates over the common sample of the tolerances.
        Robust = "robust",
        /// Designs of the search on the statistic over the tolerances, and their samples.
        RobustSearch = "robust_search",
        /// Input and winner over another sample.
        RobustConfirm = "robust_confirm",
        /// The best design with one variable at the end of its range of equally good values.
        Flatness = "flatness",
        /// The best design at neighbouring speeds.
        Speed = "speed",
        /// Samples of the sensitivity.
        Sensitivity = "sensitivity",
    }
}

/// How the motion repeats. In JSON a word: `period-1`, `period-2`, …, `quasi-periodic`, `chaotic`, `not-settled`,
/// `unstable`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RegimeResult {
    /// After so many mesh periods.
    Period(u64),
    QuasiPeriodic,
    Chaotic,
    /// The record ended before the motion had settled.
    NotSettled,
    /// The motion grows without bound.
    Unstable,
}

impl RegimeResult {
    const PERIOD: &'static str = "period-";

    /// The word in the result.
    pub fn as_str(self) -> Cow<'static, str> {
        match self {
            Self::Period(mesh_periods) => Cow::Owned(format!("{}{mesh_periods}", Self::PERIOD)),
            Self::QuasiPeriodic => Cow::Borrowed("quasi-periodic"),
            Self::Chaotic => Cow::Borrowed("chaotic"),
            Self::NotSettled => Cow::Borrowed("not-settled"),
            Self::Unstable => Cow::Borrowed("unstable"),
        }
    }

    /// The regime of a word of the result; `None` if it is none.
    pub fn parse(word: &str) -> Option<Self> {
        let others = [Self::QuasiPeriodic, Self::Chaotic, Self::NotSettled, Self::Unstable];
        match word.strip_prefix(Self::PERIOD) {
            Some(mesh_periods) => mesh_periods.parse().ok().map(Self::Period),
            None => others.into_iter().find(|regime| regime.as_str() == word),
        }
    }
}

impl Default for RegimeResult {
    fn default() -> Self {
        Self::Period(1)
    }
}

impl Serialize for RegimeResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.as_str())
    }
}

impl<'de> Deserialize<'de> for RegimeResult {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = Cow::<str>::deserialize(deserializer)?;
        Self::parse(&word).ok_or_else(|| D::Error::custom(format!("{word:?} is no regime")))
    }
}

super::quantity::scalars! { Word: ActsOn, Hand, ImpactSource, MeshStiffnessSource, Plane, RegimeResult; }

impl ToCell for Option<RegimeResult> {
    const KIND: CellKind = CellKind::Word;

    fn to_cell(&self) -> Cell<'_> {
        Cell::Word(self.map(RegimeResult::as_str))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{from_str, to_string};

    #[test]
    fn regimes_are_words_and_read_back() {
        for (regime, word) in [
            (RegimeResult::Period(1), "\"period-1\""),
            (RegimeResult::Period(12), "\"period-12\""),
            (RegimeResult::QuasiPeriodic, "\"quasi-periodic\""),
            (RegimeResult::Chaotic, "\"chaotic\""),
            (RegimeResult::NotSettled, "\"not-settled\""),
            (RegimeResult::Unstable, "\"unstable\""),
        ] {
            assert_eq!(to_string(&regime).expect("a word"), word);
            assert_eq!(from_str::<RegimeResult>(word).expect("a regime"), regime);
        }
        for word in ["\"period-\"", "\"period-x\"", "\"steady\"", "1"] {
            assert!(from_str::<RegimeResult>(word).is_err(), "{word}");
        }
    }

    #[test]
    fn a_word_is_the_same_in_json_and_in_columns() {
        let cell = |cell: Cell| match cell {
            Cell::Word(word) => word.as_ref().map(|word| format!("{word:?}")),
            _ => None,
        };
        let contact = ContactStateResult::DoubleSided;
        assert_eq!(to_string(&contact).ok(), cell(Some(contact).to_cell()));
        let source = ReusedStage::FiniteElements;
        assert_eq!(to_string(&source).ok(), cell(Some(source).to_cell()));
    }
}
