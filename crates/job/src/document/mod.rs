//! The job document: the input of a job. Names and units are the public contract. Every default is filled in, so that a
//! serialized document states all inputs of the calculation.
//!
//! Each field is declared here, once: see `crate::field`. The doc comments' first paragraphs are the help texts of
//! schema and form.

mod analysis;
mod arrangement;
mod design;
mod evaluation;
mod halves;
mod model;
mod optimise;
mod shafts;
#[cfg(test)]
mod shafts_tests;
mod sweep;
mod sweep_point;
mod tolerance;

pub use analysis::{AnalysisInput, IntegratorInput, MAX_SERIES_SAMPLES, MethodInput};
pub use arrangement::{ArrangementInput, DerivedShaftValue, Mounting, ResolvedShafts, ShaftEnd};
pub use design::{
    AssemblyInput, CoastInput, DEFAULT_BACKLASH_UM, DesignInput, EndReliefInput, FlankInput, GearInput, Hand,
    MaterialInput, PressureAnglePlane, ReliefShapeInput, SupportsInput, TipReliefInput,
};
pub use evaluation::{HalvesInput, MAX_EVALUATIONS, MAX_OPERATING_POINTS, OperatingPointInput, OverInput};
pub use model::{
    ActsOn, BodyInput, CornerImpactInput, Elements, ExcitationInput, Fidelity, GivenImpactInput, GivenStiffness,
    HarmonicInput, ImpactDuration, ImpactInput, ImpactSource, Ltca, MeshForce, MeshStiffness, MeshStiffnessSource,
    ModelInput, Plane, StiffnessLaw,
};
pub use optimise::{
    BudgetInput, CONFIRMED, ConstraintInput, GoalInput, MAX_CONSTRAINTS, MAX_OBJECTIVES, MAX_VARIABLES, MarginInput,
    ObjectiveInput, RelativeToInput, RobustInput, RobustMeasureInput, SPEED_STEPS, SearchMethodInput, VariableInput,
};
pub use shafts::{
    BearingAtSpeedInput, BearingInput, CouplingInput, RigidBodyInput, ShaftInertiaInput, ShaftInput, ShaftSegmentInput,
    ShaftsInput,
};
pub use sweep::{Axis, AxisPoints, Continuation, MAX_SWEEP_POINTS, Recorded, Spacing};
pub use sweep_point::SweepPointInput;
pub use tolerance::{
    CorrelationInput, DistributionInput, HalvesScatterInput, LimitInput, MAX_MEASURES, MAX_SAMPLES, MAX_TOLERANCES,
    MORRIS_TRAJECTORIES, MeasureInput, SCRAMBLES, SamplingInput, SensitivityInput, ToleranceInput,
};

use super::field::{Input, Slot};
use super::json;
use super::reader::{ObjectPlace, Reading};
use super::violation::{DocumentError, Violation};
use herringbone_macros::{Input, Words};
use serde::Serialize;
use serde_json::Value;

/// Longest name and longest label of a job.
pub const MAX_NAME_CHARS: usize = 200;
pub const MAX_LABEL_CHARS: usize = 100;

/// How much a job computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Words)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Kind, rename_all = "snake_case"))]
pub enum JobKind {
    /// Geometry, loaded contact and impact.
    #[words(label = "mesh (contact, impact)")]
    Mesh,
    /// One operating point up to its vibration response.
    #[words(label = "response (one point)")]
    Response,
    /// A response over the values of one or two inputs.
    #[words(label = "sweep (over inputs)")]
    Sweep,
    /// The values of some inputs for which results are best.
    #[words(label = "optimise (search for a design)")]
    Optimise,
    /// The scatter of results by that of inputs.
    #[words(label = "tolerance (scatter)")]
    Tolerance,
}

/// A job document with every default filled in and every value within its range.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "job", rules = document_rules)]
pub struct JobDocument {
    /// What to compute: mesh, response, sweep, optimise or tolerance.
    #[input(default = JobKind::Response)]
    pub kind: JobKind,
    /// A name for people.
    #[input(max_chars = MAX_NAME_CHARS)]
    pub name: Option<String>,
    /// A label to find jobs by.
    #[input(max_chars = MAX_LABEL_CHARS)]
    pub label: Option<String>,
    /// The gear pair.
    #[input(required)]
    pub design: DesignInput,
    /// The operating point.
    #[input(required)]
    pub operation: OperationInput,
    /// Choices of the physical model.
    pub model: ModelInput,
    /// Accuracy and method.
    pub analysis: AnalysisInput,
    /// sweep: one or two inputs to vary.
    #[input(min_items = 1, max_items = 2, group = "sweep", when = "kind = sweep")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<Axis>,
    /// sweep: whether a point starts cold, or from the end of its neighbour below (up) or above (down) along the first axis; both: up,
    /// then down, and where they differ. The steady motion is found from there; with method integrate, by analysis.mesh_periods.
    #[input(default = Continuation::None, group = "sweep", when = "kind = sweep")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuation: Option<Continuation>,
    /// sweep: what every row carries beside its numbers: poincare (mesh displacement and velocity at the starts of the last mesh
    /// periods), spectrum (amplitudes at the mesh orders 1/4 to 20).
    #[input(group = "sweep", when = "kind = sweep")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub record: Vec<Recorded>,
    /// optimise, tolerance: operating points of every evaluation; that of operation when left out.
    #[input(min_items = 1, max_items = MAX_OPERATING_POINTS, group = "evaluations", when = "kind = optimise tolerance")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub operating_points: Vec<OperatingPointInput>,
    /// optimise: inputs that vary.
    #[input(min_items = 1, max_items = MAX_VARIABLES, group = "evaluations", when = "kind = optimise")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<VariableInput>,
    /// optimise: quantities to be improved; of several, the designs none of which is better in all of them are found.
    #[input(min_items = 1, max_items = MAX_OBJECTIVES, group = "evaluations", when = "kind = optimise")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub objectives: Vec<ObjectiveInput>,
    /// optimise: conditions that a design has to meet.
    #[input(min_items = 1, max_items = MAX_CONSTRAINTS, group = "evaluations", when = "kind = optimise")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub constraints: Vec<ConstraintInput>,
    /// optimise: the best designs of the search are compared by their values over the tolerances.
    #[input(group = "evaluations", when = "kind = optimise")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robust: Option<RobustInput>,
    /// optimise: effort of the search.
    #[input(group = "evaluations", when = "kind = optimise")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub budget: Option<BudgetInput>,
    /// optimise: method of the search.
    #[input(default = SearchMethodInput::Auto, group = "evaluations", when = "kind = optimise")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<SearchMethodInput>,
    /// tolerance, and optimise with robust: how inputs scatter.
    #[input(min_items = 1, max_items = MAX_TOLERANCES, group = "evaluations", when = "kind = optimise tolerance")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tolerances: Vec<ToleranceInput>,
    /// tolerance, and optimise with robust: inputs of tolerances that deviate in company.
    #[input(min_items = 1, max_items = MAX_TOLERANCES, group = "evaluations", when = "kind = optimise tolerance")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub correlations: Vec<CorrelationInput>,
    /// tolerance: quantities of which the scatter is wanted.
    #[input(min_items = 1, max_items = MAX_MEASURES, group = "evaluations", when = "kind = tolerance")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measures: Vec<MeasureInput>,
    /// tolerance: limits of measures, of which the share beyond is counted.
    #[input(min_items = 1, max_items = MAX_MEASURES, group = "evaluations", when = "kind = tolerance")]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<LimitInput>,
    /// tolerance: points of the sample.
    #[input(min = 16, max = MAX_SAMPLES, default = 1024, group = "evaluations", when = "kind = tolerance")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples: Option<u32>,
    /// tolerance: scrambled Sobol points, or random ones.
    #[input(default = SamplingInput::Sobol, group = "evaluations", when = "kind = tolerance")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampling: Option<SamplingInput>,
    /// tolerance: what is found out about the influence of single inputs.
    #[input(default = SensitivityInput::FromSample, group = "evaluations", when = "kind = tolerance")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<SensitivityInput>,
    /// optimise, tolerance: seed of the random numbers.
    #[input(min = 0, max = u32::MAX, default = 1, group = "evaluations", when = "kind = optimise tolerance")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// response: the point of a sweep that this job repeats. The interface fills it in where it gives the document of a point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweep_point: Option<SweepPointInput>,
}

fn document_rules(document: &mut JobDocument, place: &ObjectPlace) {
    sweep::of_sweeps_only(document, place);
    evaluation::of_some_kinds_only(document, place);
    tolerance::fill_classes(document, place);
    tolerance::tolerance_rules(document, place);
    halves::correlation_rules(document, place);
    halves::separate(document, place);
    let MeshStiffness::Ltca(ltca) = &document.model.mesh_stiffness else { return };
    if document.design.shafts.is_some() && ltca.body == BodyInput::Bore && ltca.fidelity != Fidelity::Uniform {
        place.conflict(
            "model/mesh_stiffness/body",
            "is bore, while design.shafts is given: the body between rim and bore is part of the shaft and would yield twice; use rim",
        );
    }
}

/// The operating point.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "operation")]
pub struct OperationInput {
    /// Speed of the pinion.
    #[input(unit = "r/min", min = 0.1, max = 200_000.0, symbol = "n_1")]
    pub pinion_speed_rpm: f64,
    /// Torque of the whole pinion (both halves); negative: the gear drives, on the coast flanks.
    #[input(unit = "N m", min = -1e7, max = 1e7, symbol = "T_1")]
    pub pinion_torque_nm: f64,
    /// Which ends of the teeth enter the mesh first: the inner (apex_leading) or the outer ones.
    #[input(default = RotationInput::ApexLeading)]
    pub rotation: RotationInput,
}

/// Sense of rotation, by the ends of the teeth that enter the mesh first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum RotationInput {
    /// The inner ends, at the gap.
    ApexLeading,
    /// The outer ends.
    ApexTrailing,
}

/// Parses the bytes of a job document (UTF-8, with or without a byte order mark); finds every violation in one pass.
///
/// # Errors
/// [`DocumentError::Malformed`] when the bytes are not JSON in UTF-8 or repeat a member, [`DocumentError::Invalid`] with all violations otherwise.
/// Whether the gear can exist is not checked here (see [`crate::study::CheckedJob`]).
pub fn parse(bytes: &[u8]) -> Result<JobDocument, DocumentError> {
    parse_value(&parse_json(bytes)?)
}

/// Parses JSON (UTF-8, with or without a byte order mark).
///
/// # Errors
/// [`DocumentError::Malformed`] when the bytes are not JSON in UTF-8 or repeat a member.
pub fn parse_json(bytes: &[u8]) -> Result<Value, DocumentError> {
    json::read(bytes).map_err(|json::NotJson { detail, line, column }| DocumentError::Malformed {
        detail,
        line,
        column,
    })
}

/// As [`parse`], from JSON that is already read.
pub fn parse_value(value: &Value) -> Result<JobDocument, DocumentError> {
    let reading = Reading::read();
    let document = read(&reading, value);
    let violations = reading.violations();
    if violations.is_empty() { Ok(document) } else { Err(DocumentError::Invalid(violations)) }
}

/// Reads the whole document (or, with [`Reading::describe`], declares all of its fields).
pub(crate) fn read(reading: &Reading, value: &Value) -> JobDocument {
    let root = reading.root(value);
    let document = <JobDocument as Input>::read(&root, None);
    root.finish();
    document
}

impl JobDocument {
    /// Rows of the sweep: every point once for each direction of continuation.
    pub fn sweep_points(&self) -> usize {
        let ways = if self.continuation == Some(Continuation::Both) { 2 } else { 1 };
        ways * self.axes.iter().map(Axis::len).product::<usize>()
    }

    /// The field at a JSON pointer.
    pub(crate) fn slot(&mut self, pointer: &str) -> Option<Slot<'_>> {
        if pointer.is_empty() { Some(Slot::Other) } else { Input::slot(self, pointer) }
    }

    /// Checks the rules between fields, after numbers were put in by [`Self::slot`].
    ///
    /// # Errors
    /// [`DocumentError::Invalid`] with `violations` (those of the numbers) and all that were found.
    pub(crate) fn checked(mut self, mut violations: Vec<Violation>) -> Result<Self, DocumentError> {
        let reading = Reading::read();
        Input::check(&mut self, &ObjectPlace::root(&reading));
        violations.extend(reading.violations());
        if violations.is_empty() { Ok(self) } else { Err(DocumentError::Invalid(violations)) }
    }
}
