//! The inputs of a tolerance study: how inputs scatter, and of what the scatter is wanted.

use super::JobDocument;
use super::evaluation::{HalvesInput, MAX_ALSO, OverInput, POINTER_CHARS, require};
use crate::reader::ObjectPlace;
use herringbone_macros::{Input, Words};
use serde::Serialize;

/// Largest numbers of tolerances, measures and limits.
pub const MAX_TOLERANCES: usize = 24;
pub const MAX_MEASURES: usize = 16;
/// Largest number of sample points, and of scrambled sequences that they are made of.
pub const MAX_SAMPLES: u32 = 65_536;
pub const SCRAMBLES: u32 = 8;

/// Distribution of a deviation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum DistributionInput {
    /// Normal, about mean, with tolerance / sigmas as standard deviation.
    Normal,
    /// Uniform, from mean - minus to mean + plus.
    Uniform,
    /// Triangular, from mean - minus to mean + plus, most frequent at mean.
    Triangular,
    /// Magnitude of a normal deviation, above mean.
    HalfNormal,
    /// One of given values.
    FixedValues,
}

/// Whether both halves deviate together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum HalvesScatterInput {
    /// Both halves have one deviation.
    Together,
    /// Each half has its own deviation.
    Independent,
}

/// The scatter of an input about its value in the document.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct ToleranceInput {
    /// JSON pointer of the input that scatters.
    #[input(max_chars = POINTER_CHARS)]
    pub pointer: String,
    /// JSON pointers of further inputs with the same deviation.
    #[input(max_items = MAX_ALSO)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<String>,
    /// Factors of the deviation for the inputs of also; 1 when null.
    #[input(min = -1e6, max = 1e6, min_items = 1, max_items = MAX_ALSO)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub also_factors: Option<Vec<f64>>,
    /// independent: the left and the right half deviate each for itself. For the modifications of flanks, of which each half can have its
    /// own; the document as it is solved has a tolerance for each half in place of this one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub halves: Option<HalvesScatterInput>,
    /// Distribution of the deviation, which is added to the value of the document.
    #[input(default = DistributionInput::Normal)]
    pub distribution: DistributionInput,
    /// Mean of the deviation (half_normal: its least value; triangular: its most frequent one).
    #[input(unit = "unit of the input", min = -1e9, max = 1e9, default = 0.0)]
    pub mean: f64,
    /// normal, half_normal: so many standard deviations as sigmas says.
    #[input(unit = "unit of the input", min = 0.0, max = 1e9)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// normal, half_normal: instead of tolerance, the tolerance class of ISO 1328-1:2013 for a helix slope or a pitch error.
    #[input(min = 1, max = 11)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iso1328_class: Option<u32>,
    /// normal, half_normal: standard deviations in the tolerance.
    #[input(min = 0.1, max = 10.0, default = 3.0)]
    pub sigmas: f64,
    /// normal, half_normal: whether nothing lies beyond the tolerance.
    #[input(default = true)]
    pub cut: bool,
    /// uniform, triangular: greatest deviation above the mean.
    #[input(unit = "unit of the input", min = 0.0, max = 1e9)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plus: Option<f64>,
    /// uniform, triangular: greatest deviation below the mean; as plus when null.
    #[input(unit = "unit of the input", min = 0.0, max = 1e9)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub minus: Option<f64>,
    /// fixed_values: the deviations, each as likely as the others.
    #[input(unit = "unit of the input", min = -1e9, max = 1e9, min_items = 1, max_items = 10_000)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub values: Option<Vec<f64>>,
}

/// Inputs that deviate in company.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct CorrelationInput {
    /// The inputs, by the pointers of their tolerances; one with independent halves stands for both.
    #[input(min_items = 1, max_items = MAX_TOLERANCES)]
    pub pointers: Vec<String>,
    /// Correlation of each with each other one, of normal deviations; other distributions have it by their normal scores. At least
    /// -1 / (number of inputs - 1).
    #[input(min = -1.0, max = 1.0)]
    pub correlation: f64,
}

/// A quantity of which the scatter is wanted.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct MeasureInput {
    /// JSON pointer of a number of the result, or of the values of both halves.
    #[input(max_chars = POINTER_CHARS)]
    pub measure: String,
    /// Value of a quantity of which each half has its own.
    #[input(default = HalvesInput::Larger)]
    pub halves: HalvesInput,
    /// Value over the operating points; worst: the largest.
    #[input(default = OverInput::Worst)]
    pub over: OverInput,
}

/// A limit of one of the measures.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct LimitInput {
    /// The measure, as it stands in measures.
    #[input(max_chars = POINTER_CHARS)]
    pub measure: String,
    /// Least permitted value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// Greatest permitted value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_most: Option<f64>,
}

/// Points of the sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum SamplingInput {
    /// Eight scrambled Sobol sequences.
    Sobol,
    /// Independent random points.
    Random,
}

/// What is found out about the influence of single inputs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum SensitivityInput {
    /// Rank correlations and first-order shares, from the sample itself.
    FromSample,
    /// Also total shares: as many further evaluations as samples for each input and once more.
    Jansen,
    /// Elementary effects: twelve trajectories, without a sample.
    Morris,
    /// Nothing.
    None,
}

/// Trajectories of a screening.
pub const MORRIS_TRAJECTORIES: u32 = 12;

pub(super) fn rules(document: &mut JobDocument, place: &ObjectPlace) {
    require(place, "tolerances", document.tolerances.is_empty(), "1 to 24 inputs that scatter");
    require(place, "measures", document.measures.is_empty(), "1 to 16 quantities of which the scatter is wanted");
    document.samples = document.samples.or(Some(1024));
    document.sampling = document.sampling.or(Some(SamplingInput::Sobol));
    document.sensitivity = document.sensitivity.or(Some(SensitivityInput::FromSample));
    let samples = document.samples.unwrap_or_default();
    if document.sampling == Some(SamplingInput::Sobol)
        && !(samples.is_multiple_of(SCRAMBLES) && (samples / SCRAMBLES).is_power_of_two())
        && !place.is_refused("samples")
    {
        place.conflict(
            "samples",
            format!("is {samples}; with sampling sobol it is 8 times a power of two: 128, 256, …, 65536"),
        );
    }
    let needs_independence = [Some(SensitivityInput::Jansen), Some(SensitivityInput::Morris)];
    if needs_independence.contains(&document.sensitivity) && !document.correlations.is_empty() {
        place.conflict("sensitivity", "needs independent inputs, but correlations are given; use from_sample or none");
    }
    if document.sensitivity == Some(SensitivityInput::Jansen) && document.sampling == Some(SamplingInput::Random) {
        place.conflict("sensitivity", "is jansen, which needs sampling sobol");
    }
    let evaluations = document.evaluations();
    if evaluations > u64::from(super::MAX_EVALUATIONS) {
        let detail = format!("lead to {evaluations} evaluations; permitted: at most {}", super::MAX_EVALUATIONS);
        place.conflict("samples", detail);
    }
    for (index, limit) in document.limits.iter().enumerate() {
        if !document.measures.iter().any(|measure| measure.measure == limit.measure) {
            place.conflict(&format!("limits/{index}/measure"), "is none of measures");
        }
        if limit.at_least.is_none() && limit.at_most.is_none() {
            place.conflict(&format!("limits/{index}"), "needs at_least, at_most or both");
        }
    }
}

/// Tolerance of a gear of class 5 at the pointer of a helix slope or of a pitch error, µm (ISO 1328-1:2013, 5.3: f_HβT and
/// f_pT without their rounding); `None` for another input. Diameter and face width are those of one half.
fn class_5_um(document: &JobDocument, pointer: &str) -> Option<f64> {
    let design = &document.design;
    let gear = if pointer.starts_with("/design/gear/") { &design.gear } else { &design.pinion };
    let module_mm = design.normal_module_mm;
    let diameter_mm = f64::from(gear.teeth) * module_mm / design.helix_angle_deg.to_radians().cos();
    let width_mm = gear.face_width_mm.unwrap_or(design.face_width_mm);
    match pointer.rsplit('/').next()? {
        "helix_slope_um" => Some(0.05 * diameter_mm.sqrt() + 0.35 * width_mm.sqrt() + 4.0),
        "base_pitch_error_um" => Some(0.001 * diameter_mm + 0.4 * module_mm + 5.0),
        _ => None,
    }
}

/// Fills in the tolerances that are given by a class of ISO 1328-1.
pub(super) fn fill_classes(document: &mut JobDocument, place: &ObjectPlace) {
    for index in 0..document.tolerances.len() {
        let Some(class) = document.tolerances[index].iso1328_class else { continue };
        let found = class_5_um(document, &document.tolerances[index].pointer);
        let at = |name: &str| format!("tolerances/{index}/{name}");
        let tolerance = &mut document.tolerances[index];
        let Some(class_5_um) = found else {
            place.conflict(
                &at("iso1328_class"),
                "has a tolerance for helix_slope_um and base_pitch_error_um only; give tolerance",
            );
            continue;
        };
        // A factor of the root of 2 from class to class; two digits after the point, as a document states it.
        let tolerance_um = (class_5_um * 2.0f64.powf(0.5 * (f64::from(class) - 5.0)) * 100.0).round() / 100.0;
        match tolerance.tolerance {
            // As it was filled in when the document was read first.
            Some(given) if given == tolerance_um => {}
            Some(_) => place.conflict(&at("tolerance"), "is given together with iso1328_class; give one or the other"),
            None => tolerance.tolerance = Some(tolerance_um),
        }
    }
}

/// The rules of a list of tolerances.
pub(super) fn tolerance_rules(document: &JobDocument, place: &ObjectPlace) {
    use DistributionInput::{FixedValues, HalfNormal, Normal, Triangular, Uniform};
    for (index, tolerance) in document.tolerances.iter().enumerate() {
        let at = |name: &str| format!("tolerances/{index}/{name}");
        let of = |name: &str, is_given: bool, kinds: &[DistributionInput]| {
            let belongs = kinds.contains(&tolerance.distribution);
            if is_given && !belongs {
                place.conflict(&at(name), "is given, but has no meaning with this distribution");
            }
            if !is_given && belongs && name != "minus" && !place.is_refused(&at(name)) {
                place.missing(&at(name), "is required with this distribution");
            }
        };
        if tolerance.iso1328_class.is_none() || tolerance.tolerance.is_some() {
            of("tolerance", tolerance.tolerance.is_some(), &[Normal, HalfNormal]);
        }
        of("plus", tolerance.plus.is_some(), &[Uniform, Triangular]);
        of("minus", tolerance.minus.is_some(), &[Uniform, Triangular]);
        of("values", tolerance.values.is_some(), &[FixedValues]);
        if tolerance.also_factors.as_ref().is_some_and(|factors| factors.len() != tolerance.also.len()) {
            let detail = format!("needs a factor for each of the {} inputs of also", tolerance.also.len());
            place.conflict(&at("also_factors"), detail);
        }
    }
}

impl JobDocument {
    /// Evaluations of an optimisation (at most) or of a tolerance study; 0 of other kinds.
    pub fn evaluations(&self) -> u64 {
        let inputs = self.tolerances.len() as u64;
        match self.kind {
            super::JobKind::Optimise => {
                let search = u64::from(self.budget.as_ref().and_then(|budget| budget.evaluations).unwrap_or_default());
                // The input, the best ones with the settings of the document, and the samples.
                let robust = self.robust.as_ref().map_or(0, |robust| {
                    let designs = robust.search_designs.unwrap_or_default();
                    u64::from(robust.samples) * (u64::from(robust.candidates) + u64::from(designs))
                        + u64::from(designs)
                        + 3 * u64::from(robust.confirm_samples)
                });
                // Two for the range of each variable, and the neighbours in speed.
                let further = 2 * self.variables.len() as u64 + super::SPEED_STEPS as u64;
                1 + search + super::CONFIRMED as u64 + robust + further
            }
            super::JobKind::Tolerance => {
                let samples = u64::from(self.samples.unwrap_or_default());
                1 + match self.sensitivity {
                    Some(SensitivityInput::Jansen) => samples * (inputs + 2),
                    Some(SensitivityInput::Morris) => u64::from(MORRIS_TRAJECTORIES) * (inputs + 1),
                    _ => samples,
                }
            }
            _ => 0,
        }
    }
}
