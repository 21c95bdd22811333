//! The job document: what goes in. Names and units are the public contract; every default is filled in, so that a
//! document written out again says everything that was used.

use super::grid;
use serde::Serialize;

/// How much a job computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Kind))]
pub enum JobKind {
    /// Geometry, loaded contact and impact.
    Mesh,
    /// One operating point up to its vibration response.
    Response,
    /// A response over the values of one or two inputs.
    Sweep,
}

impl JobKind {
    pub const ALL: [(&'static str, JobKind); 3] =
        [("mesh", JobKind::Mesh), ("response", JobKind::Response), ("sweep", JobKind::Sweep)];

    pub fn as_str(self) -> &'static str {
        Self::ALL.iter().find(|(_, kind)| *kind == self).map_or("response", |(word, _)| word)
    }
}

/// A job document with every default filled in and every value within its range.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JobDocument {
    pub kind: JobKind,
    pub name: Option<String>,
    pub label: Option<String>,
    pub design: DesignInput,
    pub operation: OperationInput,
    pub model: ModelInput,
    pub analysis: AnalysisInput,
    /// Only for sweeps.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<Axis>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub continuation: Option<Continuation>,
    /// What the rows of a sweep carry beside their numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub record: Vec<Recorded>,
}

impl JobDocument {
    /// Rows of the sweep: every point once for each direction of continuation.
    pub fn sweep_points(&self) -> usize {
        let ways = if self.continuation == Some(Continuation::Both) { 2 } else { 1 };
        ways * self.axes.iter().map(Axis::len).product::<usize>()
    }
}

/// Play along s where none is given: what the source states.
pub const DEFAULT_BACKLASH_UM: f64 = 2.0;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DesignInput {
    pub normal_module_mm: f64,
    pub pressure_angle_deg: f64,
    pub pressure_angle_plane: PressureAnglePlane,
    pub helix_angle_deg: f64,
    pub face_width_mm: f64,
    pub gap_width_mm: f64,
    pub center_distance_mm: Option<f64>,
    /// Total play along s; [`DEFAULT_BACKLASH_UM`] when null.
    pub backlash_um: Option<f64>,
    pub half_stagger: f64,
    pub material: MaterialInput,
    pub pinion: GearInput,
    pub gear: GearInput,
    pub supports: SupportsInput,
    pub assembly: AssemblyInput,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum PressureAnglePlane {
    Normal,
    Transverse,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MaterialInput {
    pub youngs_modulus_gpa: f64,
    pub poissons_ratio: f64,
    pub density_kg_m3: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Hand {
    Left,
    Right,
}

impl Hand {
    pub fn opposite(self) -> Hand {
        match self {
            Hand::Left => Hand::Right,
            Hand::Right => Hand::Left,
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GearInput {
    pub teeth: u32,
    pub left_half_hand: Hand,
    pub profile_shift: f64,
    pub addendum: f64,
    pub dedendum: f64,
    pub fillet_radius: f64,
    pub tip_alteration: f64,
    pub bore_diameter_mm: Option<f64>,
    pub mass_kg: Option<f64>,
    pub inertia_kg_m2: Option<f64>,
    /// Face width of one half of this gear; the design's when null.
    pub face_width_mm: Option<f64>,
    /// Material of this gear where it differs from the design's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialInput>,
    #[serde(flatten)]
    pub flank: FlankInput,
    /// Modifications of one half where they differ from those of both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<FlankInput>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<FlankInput>,
    /// Modifications of the other flanks, those in contact under negative torque, where they differ.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coast: Option<CoastInput>,
}

/// Flank modifications of the flanks that are in contact while the pinion is driven.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoastInput {
    #[serde(flatten)]
    pub flank: FlankInput,
    /// Modifications of one half where they differ from those of both.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub left: Option<FlankInput>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub right: Option<FlankInput>,
}

/// Flank modifications: material removed, measured in the transverse plane along the base tangent.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlankInput {
    pub tip_relief: TipReliefInput,
    pub lead_crowning_um: f64,
    pub helix_slope_um: f64,
    pub end_relief: EndReliefInput,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TipReliefInput {
    pub amount_um: f64,
    pub length_mm: f64,
    pub shape: ReliefShape,
}

pub use herringbone_physics::gear::{ReliefShape, Rotation};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EndReliefInput {
    pub amount_um: f64,
    pub length_mm: f64,
}

/// Shafts and bearings, per half. What is null is derived (`study::supports`), and zero is not there.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SupportsInput {
    pub pinion_lateral_n_per_um: Option<f64>,
    pub gear_lateral_n_per_um: Option<f64>,
    pub pinion_halves_axial_n_per_um: Option<f64>,
    pub gear_axial_n_per_um: Option<f64>,
    pub gear_halves_axial_n_per_um: Option<f64>,
    pub damping_ratio: f64,
    pub pinion_halves_torsional_nm_per_rad: Option<f64>,
    pub gear_halves_torsional_nm_per_rad: Option<f64>,
    pub pinion_halves_lateral_n_per_um: Option<f64>,
    pub gear_halves_lateral_n_per_um: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AssemblyInput {
    pub center_distance_error_um: f64,
    pub in_plane_misalignment_um: f64,
    pub out_of_plane_misalignment_um: f64,
    pub apex_offset_um: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OperationInput {
    pub pinion_speed_rpm: f64,
    pub pinion_torque_nm: f64,
    pub rotation: Rotation,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelInput {
    pub plane: Plane,
    pub mesh_damping_ratio: f64,
    pub damping_in_gap: bool,
    pub mesh_force: MeshForce,
    pub mesh_stiffness: MeshStiffness,
    pub impact: ImpactInput,
}

/// What the equations of motion contain of the mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MeshForce {
    /// k_m(t) f(s) with the backlash function, and an impact pulse: the source's equations.
    Stiffness,
    /// The force of the loaded contact as a function of approach and phase; no pulse.
    Contact,
}

/// Plane in which the equations of motion are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Plane {
    Base,
    Pitch,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "source", rename_all = "snake_case")]
pub enum MeshStiffness {
    Ltca(Ltca),
    Iso6336,
    Given(GivenStiffness),
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ltca {
    pub fidelity: Fidelity,
    /// Fidelity `uniform`: normal force per length of contact line and approach.
    pub line_stiffness_n_per_mm_um: f64,
    /// How fine the finite elements of fidelity `fe` are.
    pub elements: Elements,
    pub body: BodyInput,
    pub corner_contact: bool,
    pub law: StiffnessLaw,
    /// Agreement of stiffness and transmission error between chosen positions, as a part of their means.
    pub accuracy: f64,
    /// Positions over one mesh period; chosen from the accuracy when null.
    pub positions: Option<u32>,
    /// Slices over the face width of one half; chosen from the geometry when null.
    pub slices: Option<u32>,
}

/// Which stiffness of the loaded contact enters the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StiffnessLaw {
    /// F/(δ − c), c a constant: the static displacement of the equations is the loaded transmission error but for a constant
    /// (a rigid rotation), and the mean is that of the tangent stiffness.
    TransmissionError,
    /// F/δ.
    Secant,
    /// dF/dδ at the working load: right for small vibrations about it.
    Tangent,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Fidelity {
    Analytic,
    Fe,
    /// Contact lines as a uniform elastic foundation: a plain model for comparisons.
    Uniform,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Elements {
    Coarse,
    Medium,
    Standard,
    Fine,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyInput {
    Rim,
    Bore,
}

/// A given mesh stiffness of one half: Fourier series or samples over one mesh period.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum GivenStiffness {
    Harmonics { mean_n_per_um: f64, harmonics: Vec<HarmonicInput> },
    Samples { samples_n_per_um: Vec<f64> },
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HarmonicInput {
    /// Amplitude as a fraction of the mean.
    pub amplitude: f64,
    pub phase_rad: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "source", rename_all = "snake_case")]
pub enum ImpactInput {
    CornerContact(CornerImpactInput),
    Zhou2008(CornerImpactInput),
    None,
    Given(GivenImpactInput),
}

impl ImpactInput {
    /// What the impact moves.
    pub fn acts_on(&self) -> ActsOn {
        match self {
            ImpactInput::CornerContact(corner) | ImpactInput::Zhou2008(corner) => corner.acts_on,
            ImpactInput::Given(given) => given.acts_on,
            ImpactInput::None => ActsOn::Torsion,
        }
    }
}

/// Which motions the impact moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ActsOn {
    /// The torsional equations only, as the source prints them.
    Torsion,
    /// Bending and axial motion too, as a normal force on the tooth does.
    All,
}

impl ActsOn {
    pub fn as_str(self) -> &'static str {
        match self {
            ActsOn::Torsion => "torsion",
            ActsOn::All => "all",
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CornerImpactInput {
    pub acts_on: ActsOn,
    pub duration: ImpactDuration,
    /// Start of the pulse after the theoretical start of contact; when the pair enters (the corner contact) if null.
    pub start_mesh_periods: Option<f64>,
    pub base_pitch_error_um: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ImpactDuration {
    /// Half the period of the equivalent mass on the compliance of the impact.
    EnergyBalance,
    /// From the first corner contact to the theoretical start of contact.
    CornerToStart,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GivenImpactInput {
    pub acts_on: ActsOn,
    pub force_n: f64,
    pub duration_mesh_periods: f64,
    pub start_mesh_periods: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AnalysisInput {
    pub accuracy: f64,
    pub method: MethodInput,
    pub integrator: IntegratorInput,
    pub mesh_periods: u32,
    pub record_mesh_periods: u32,
    pub samples_per_mesh_period: u32,
    /// Channels to record beside those that are always there; all when null.
    pub channels: Option<Vec<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_state: Option<Vec<f64>>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MethodInput {
    Auto,
    Periodic,
    Integrate,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum IntegratorInput {
    /// Event-exact Taylor series on the piecewise-linear equations.
    Taylor,
    /// Variable-step fourth-order Runge–Kutta, as the source paper used.
    #[serde(rename = "runge_kutta_4")]
    RungeKutta4,
}

/// One swept input: where it stands in the document, and the values it takes, in the order in which they are solved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    pub pointer: String,
    /// Further inputs that take the same value.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<String>,
    #[serde(flatten)]
    pub points: AxisPoints,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AxisPoints {
    Range { from: f64, to: f64, points: u32, spacing: Spacing },
    Values { values: Vec<f64> },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    Linear,
    Logarithmic,
}

impl Axis {
    /// Every input that takes the axis' value.
    pub fn pointers(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.pointer).chain(&self.also).map(String::as_str)
    }

    pub fn len(&self) -> usize {
        match &self.points {
            AxisPoints::Range { points, .. } => *points as usize,
            AxisPoints::Values { values } => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at position `index`; both ends of a range, and round values between them, are met exactly.
    pub fn value(&self, index: usize) -> f64 {
        match &self.points {
            AxisPoints::Values { values } => values[index],
            AxisPoints::Range { from, to, points, spacing } => {
                grid::value(*from, *to, *points as usize, *spacing, index)
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Continuation {
    None,
    Up,
    Down,
    /// Up and then down, and where the two differ.
    Both,
}

/// What a row of a sweep can carry beside its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Recorded {
    /// The motion at the starts of mesh periods.
    Poincare,
    /// Amplitudes at the mesh orders.
    Spectrum,
}

impl Recorded {
    pub const ALL: [(&'static str, Recorded); 2] = [("poincare", Recorded::Poincare), ("spectrum", Recorded::Spectrum)];
}
