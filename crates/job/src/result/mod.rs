//! The result document: what comes out. Names and units are the public contract; stages that did not run are null.
//!
//! A scalar is declared once, as a field of these structs with its `#[scalar(…)]` attribute: see `ResultFields`.

mod accuracy;
mod geometry;
mod impact;
mod mesh;
mod numerics;
mod optimise;
mod quantity;
mod response;
mod rotor;
mod shafts;
mod supports;
mod sweep;
mod sweep_column;
mod tolerance;
mod words;

pub use accuracy::{Accuracy, ModelError};
pub use geometry::{GearGeometry, Geometry};
pub use impact::ImpactResult;
pub use mesh::{ApexSensitivity, ContactForceTable, Convergence, FlankLoad, Mesh, MeshCurve};
pub use numerics::{NotFinite, NumericsResult, WallMs};
pub use optimise::{
    ActiveLimit, BestDesign, ConstraintResult, Flatness, FrontDesign, InputDesign, ObjectiveResult, OptimiseResult,
    PointGain, RobustCandidate, RobustResult, RobustSearch, RobustStatistics, SearchHistory, SearchNumerics,
    SpeedNeighbour,
};
pub use quantity::{Change, Quantity, QuantityKind, gear_data_quantities, quantities};
pub use response::{
    FloquetMultiplier, IntervalPerHalf, IntervalResult, NaturalMode, Poincare, ResponseResult, RmsIntervalsResult,
    RmsResult, SpectrumResult, ToothForceResult, ToothForces,
};
pub use rotor::{
    BearingForceResult, BearingForces, DirectionForce, ForceOrders, MidFaceShape, RotorMode, RotorResult, ShaftShape,
    ShapeAlongShafts, ToothForceOrders,
};
pub use shafts::{
    AxialFloat, AxialFrictionResult, AxialLimit, BearingReaction, CouplingTransmissionError, FaceLoadAtTorque,
    HelixModificationResult, Iso6336FaceLoad, ShaftDeflection, ShaftHalfResult, ShaftMemberResult, ShaftsResult,
};
pub use supports::{SpringValue, SupportsResult};
pub use sweep::{Campbell, CampbellCrossing, Hysteresis, Jump, SweepAxis, SweepPoint, SweepResult};
pub use sweep_column::{Cell, CellKind, Column};
pub use tolerance::{
    BeyondLimit, HalfSample, Histogram, InputSensitivity, MeasureScatter, PercentileValue, ToleranceResult,
};
pub use words::{
    BranchDifference, BranchDirection, ContactStateResult, EvaluationPhase, MethodResult, RegimeResult, ReusedStage,
    SpringOrigin,
};

pub(crate) use herringbone_macros::{ResultFields, SweepColumns};
pub(crate) use quantity::{Declaration, Optional, Place, ResultFields};
pub(crate) use sweep_column::ToCell;

use crate::warning::Warning;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct JobResult {
    pub geometry: Option<Geometry>,
    pub mesh: Option<Mesh>,
    /// Both halves together on their shafts; absent without `design.shafts`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub shafts: Option<ShaftsResult>,
    pub impact: Option<ImpactResult>,
    pub response: Option<ResponseResult>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub sweep: Option<SweepResult>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[scalar(skip)]
    pub optimise: Option<OptimiseResult>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[scalar(skip)]
    pub tolerance: Option<ToleranceResult>,
    pub numerics: NumericsResult,
    /// Springs of the equations of motion; null for a job without a response.
    #[serde(default)]
    pub supports: Option<SupportsResult>,
    /// How far the numbers may be off: from the solution of their own equations, and from a gear pair.
    #[serde(default)]
    pub accuracy: Option<Accuracy>,
    #[cfg_attr(feature = "schema", schema(value_type = Vec<WarningEntry>))]
    pub warnings: Vec<Warning>,
}

/// A warning: what an engineer should know, and which field it is about.
#[cfg(feature = "schema")]
#[derive(utoipa::ToSchema)]
pub struct WarningEntry {
    pub code: String,
    pub detail: String,
    pub pointer: String,
}

/// Two values, one per helix half.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(halves)]
pub struct PerHalf {
    pub left: f64,
    pub right: f64,
}

impl JobResult {
    /// The rows of a sweep, of an optimisation or of a tolerance study.
    pub fn rows_mut(&mut self) -> Option<&mut Vec<SweepPoint>> {
        let sweep = self.sweep.as_mut().map(|sweep| &mut sweep.points);
        let optimise = self.optimise.as_mut().map(|optimise| &mut optimise.points);
        let tolerance = self.tolerance.as_mut().map(|tolerance| &mut tolerance.points);
        sweep.or(optimise).or(tolerance)
    }
}
