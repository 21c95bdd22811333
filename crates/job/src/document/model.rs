//! Choices of the physical model: mesh stiffness and impact.
//!
//! [`MeshStiffness`] and [`ImpactInput`] are enums whose variants share one JSON object. Their members are declared in
//! structs of all members, from which the variant that `source` names is taken.

use crate::field::{Field, Input, Slot, number_slot};
use crate::path::split_first;
use crate::reader::{Object, ObjectPlace};
use herringbone_macros::{Input, Words};
use serde::Serialize;

/// Choices of the physical model.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "model", rules = model_rules)]
pub struct ModelInput {
    /// Plane of the equations of motion: base (consistent) or pitch (the source to the letter).
    #[input(default = Plane::Base)]
    pub plane: Plane,
    /// Damping ratio of the mesh.
    #[input(min = 0.0, max = 2.0, default = 0.1, symbol = "ζ_m")]
    pub mesh_damping_ratio: f64,
    /// Damping of the mesh of each half, along the flank normal; from the damping ratio when null.
    #[input(unit = "N s/m", min = 0.0, max = 1e12, symbol = "c_m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh_damping_ns_per_m: Option<f64>,
    /// Whether the mesh damper acts while the teeth are apart.
    #[input(default = true)]
    pub damping_in_gap: bool,
    /// What the equations contain of the mesh: contact (the force of the loaded contact over approach and phase, entry shock and loss of
    /// contact included, no impact pulse; default with source ltca) or stiffness (the source's: k(t) over the backlash function, and the
    /// impact; default with the other sources).
    #[input(first = 1, default = MeshForce::of_source(&mesh_stiffness), when = "mesh_stiffness/source = ltca")]
    pub mesh_force: MeshForce,
    /// Where the mesh stiffness comes from.
    #[input(first)]
    pub mesh_stiffness: MeshStiffness,
    /// Where the mesh-in impact comes from.
    pub impact: ImpactInput,
    /// Amplitude of a displacement excitation e cos(2 pi f_m t) of each mesh at the mesh frequency, along the flank
    /// normal; none when null.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub excitation_um: Option<ExcitationInput>,
}

/// A displacement excitation of each half; positive: a gap, material removed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Input)]
pub struct ExcitationInput {
    /// Amplitude in the left half; needs mesh_force stiffness.
    #[input(object_unit = "um", min = -1000.0, max = 1000.0, default = 0.0)]
    pub left: f64,
    /// Amplitude in the right half; needs mesh_force stiffness.
    #[input(object_unit = "um", min = -1000.0, max = 1000.0, default = 0.0)]
    pub right: f64,
}

fn model_rules(model: &mut ModelInput, place: &ObjectPlace) {
    if model.mesh_force == MeshForce::Contact && !matches!(model.mesh_stiffness, MeshStiffness::Ltca(_)) {
        place.conflict(
            "mesh_force",
            "is contact, which needs a loaded contact analysis: mesh_stiffness.source ltca; with given and iso6336 it is stiffness",
        );
    }
    if model.mesh_force == MeshForce::Contact && model.excitation_um.is_some() {
        place.conflict(
            "excitation_um",
            "is given with mesh_force contact, whose transmission error follows from the flanks; permitted with mesh_force stiffness",
        );
    }
}

/// The mesh in the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum MeshForce {
    /// k_m(t) f(s) with the backlash function, and an impact pulse: the source's equations.
    #[words(label = "stiffness and impact (the source's)")]
    Stiffness,
    /// The force of the loaded contact as a function of approach and phase; no pulse.
    #[words(label = "loaded contact")]
    Contact,
}

impl MeshForce {
    /// The default.
    fn of_source(stiffness: &MeshStiffness) -> Self {
        match stiffness {
            MeshStiffness::Ltca(_) => MeshForce::Contact,
            MeshStiffness::Iso6336 | MeshStiffness::Given(_) => MeshForce::Stiffness,
        }
    }
}

/// Plane in which the equations of motion are written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Words)]
pub enum Plane {
    #[default]
    /// The base plane, in which the contact acts.
    #[words(label = "base (consistent)")]
    Base,
    /// The pitch plane, as in the source.
    #[words(label = "pitch (the source's)")]
    Pitch,
}

/// Source of the mesh stiffness.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "source", rename_all = "snake_case")]
pub enum MeshStiffness {
    /// Loaded tooth contact analysis.
    Ltca(Ltca),
    /// The closed form of ISO 6336-1.
    Iso6336,
    /// A given curve.
    Given(GivenStiffness),
}

/// The members of the JSON object of [`MeshStiffness`].
#[derive(Input)]
struct MeshStiffnessMembers {
    /// ltca (loaded tooth contact analysis), iso6336 (closed form) or given.
    #[input(default = MeshStiffnessSource::Ltca)]
    source: MeshStiffnessSource,
    #[input(flatten)]
    ltca: Ltca,
    #[input(flatten)]
    given: GivenStiffnessMembers,
}

/// Origin of the mesh stiffness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Words)]
pub enum MeshStiffnessSource {
    #[default]
    #[words(label = "loaded tooth contact")]
    Ltca,
    #[words(label = "ISO 6336-1, closed form")]
    Iso6336,
    Given,
}

impl Input for MeshStiffness {
    fn read(object: &Object, _base: Option<&Self>) -> Self {
        let MeshStiffnessMembers { source, ltca, given } = Input::read(object, None);
        match source {
            MeshStiffnessSource::Ltca => MeshStiffness::Ltca(ltca),
            MeshStiffnessSource::Iso6336 => MeshStiffness::Iso6336,
            MeshStiffnessSource::Given => MeshStiffness::Given(given.given(&object.place())),
        }
    }

    fn check(&mut self, place: &ObjectPlace) {
        if let MeshStiffness::Given(GivenStiffness::Harmonics { harmonics, .. }) = self {
            stays_positive(harmonics, place);
        }
    }

    fn slot(&mut self, pointer: &str) -> Option<Slot<'_>> {
        type Members = GivenStiffnessMembers;
        match (self, split_first(pointer)?) {
            (_, ("source", "")) => Some(Slot::Other),
            (MeshStiffness::Ltca(ltca), _) => Input::slot(ltca, pointer),
            (MeshStiffness::Given(GivenStiffness::Harmonics { mean_n_per_um, .. }), ("mean_n_per_um", rest)) => {
                Field::slot(mean_n_per_um, Members::MEAN_N_PER_UM, rest)
            }
            (MeshStiffness::Given(GivenStiffness::Harmonics { harmonics, .. }), ("harmonics", rest)) => {
                Field::slot(harmonics, Members::HARMONICS, rest)
            }
            (MeshStiffness::Given(GivenStiffness::Samples { samples_n_per_um }), ("samples_n_per_um", rest)) => {
                number_slot(samples_n_per_um, Members::SAMPLES_N_PER_UM, rest)
            }
            _ => None,
        }
    }
}

/// Loaded tooth contact analysis.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct Ltca {
    /// ltca: how the tooth and body compliance is found: analytic (milliseconds) or fe (finite elements of both gears, seconds; kept for
    /// the next job); uniform is a plain elastic foundation along the contact lines, for comparisons.
    #[input(default = Fidelity::Analytic, when = "source = ltca")]
    pub fidelity: Fidelity,
    /// ltca, uniform: normal force per length of contact line and approach along the flank normal.
    #[input(unit = "N/(mm um)", min = 0.01, max = 1000.0, default = 14.0, when = "fidelity = uniform")]
    pub line_stiffness_n_per_mm_um: f64,
    /// ltca, fe: how fine the finite elements are.
    #[input(default = Elements::Standard, when = "fidelity = fe")]
    pub elements: Elements,
    /// ltca: where the gear bodies are held: 3 normal modules below the root circle, or at the bore.
    #[input(default = BodyInput::Rim, when = "source = ltca")]
    pub body: BodyInput,
    /// ltca: whether tip corners may touch outside the path of contact.
    #[input(default = true, when = "source = ltca")]
    pub corner_contact: bool,
    /// ltca: stiffness curve of the equations of motion: mean of the tangent stiffness with the fluctuation of the loaded transmission
    /// error, secant F/delta, or tangent dF/ddelta.
    #[input(default = StiffnessLaw::TransmissionError, when = "source = ltca")]
    pub law: StiffnessLaw,
    /// ltca: positions are added until stiffness and transmission error between them agree with their interpolation to this part of their
    /// means.
    #[input(min = 1e-5, max = 0.1, default = 2e-3, when = "source = ltca")]
    pub accuracy: f64,
    /// ltca: positions over one mesh period; as many as the accuracy needs when null.
    #[input(min = 8, max = 1024, when = "source = ltca")]
    pub positions: Option<u32>,
    /// ltca: slices of the contact lines over the face width of one half; by face width and overlap when null.
    #[input(min = 5, max = 200, when = "source = ltca")]
    pub slices: Option<u32>,
}

/// Stiffness of the loaded contact that enters the equations of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum StiffnessLaw {
    /// F/(δ − c), c a constant: the static displacement of the equations is the loaded transmission error but for a constant
    /// (a rigid rotation), and the mean is that of the tangent stiffness.
    TransmissionError,
    /// F/δ.
    #[words(label = "secant F/δ")]
    Secant,
    /// dF/dδ at the working load: right for small vibrations about it.
    #[words(label = "tangent dF/dδ")]
    Tangent,
}

/// Method for the compliance of teeth and bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum Fidelity {
    /// Plates on an elastic ring.
    Analytic,
    /// Finite elements of both gears.
    #[words(label = "finite elements")]
    Fe,
    /// Contact lines as a uniform elastic foundation: a plain model for comparisons.
    #[words(label = "uniform foundation")]
    Uniform,
}

/// Fineness of the finite elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum Elements {
    Coarse,
    Medium,
    Standard,
    Fine,
}

/// Radius at which the gear bodies are held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum BodyInput {
    /// Three normal modules below the root circle.
    Rim,
    /// At the bore.
    Bore,
}

/// A given mesh stiffness of one half: Fourier series or samples over one mesh period.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum GivenStiffness {
    Harmonics { mean_n_per_um: f64, harmonics: Vec<HarmonicInput> },
    Samples { samples_n_per_um: Vec<f64> },
}

/// The members of [`GivenStiffness`].
#[derive(Input)]
struct GivenStiffnessMembers {
    /// given: mean stiffness of one half along s.
    #[input(unit = "N/um", min = 1e-3, max = 1e7, when = "source = given")]
    mean_n_per_um: Option<f64>,
    /// given: harmonics of the mesh frequency; amplitudes are fractions of the mean.
    #[input(max_items = 64, when = "source = given")]
    harmonics: Vec<HarmonicInput>,
    /// given: stiffness at equal steps over one mesh period, interpolated by a periodic cubic.
    #[input(unit = "N/um", min = 1e-3, max = 1e7, min_items = 2, max_items = 4096, when = "source = given")]
    samples_n_per_um: Option<Vec<f64>>,
}

impl GivenStiffnessMembers {
    /// The stiffness that is given, with the rules that hold where it has to be.
    fn given(self, place: &ObjectPlace) -> GivenStiffness {
        let Self { mean_n_per_um, harmonics, samples_n_per_um } = self;
        match (mean_n_per_um, &samples_n_per_um) {
            (None, None) => place.missing(
                "mean_n_per_um",
                "is required with source \"given\" (0.001 to 1e7 N/um), unless samples_n_per_um is given",
            ),
            (Some(_), Some(_)) => {
                place.conflict("samples_n_per_um", "is given together with mean_n_per_um; give one");
            }
            _ => {}
        }
        if mean_n_per_um.is_some() {
            stays_positive(&harmonics, place);
        }
        match (mean_n_per_um, samples_n_per_um) {
            (None, Some(samples_n_per_um)) => GivenStiffness::Samples { samples_n_per_um },
            (mean, _) => GivenStiffness::Harmonics { mean_n_per_um: mean.unwrap_or(1.0), harmonics },
        }
    }
}

/// The rule that a stiffness of these harmonics is above zero everywhere.
fn stays_positive(harmonics: &[HarmonicInput], place: &ObjectPlace) {
    if place.is_read() && lowest_of(harmonics) <= 0.0 {
        let total: f64 = harmonics.iter().map(|harmonic| harmonic.amplitude).sum();
        let detail = format!(
            "make the stiffness zero or negative somewhere in the mesh period (amplitudes sum to {total}); it must stay above 0 N/um"
        );
        place.conflict("harmonics", detail);
    }
}

/// Smallest value of 1 + Σ a_i cos(iφ + φ_i), bounded below by a fine sampling.
fn lowest_of(harmonics: &[HarmonicInput]) -> f64 {
    let total: f64 = harmonics.iter().map(|harmonic| harmonic.amplitude).sum();
    if total < 1.0 {
        return 1.0 - total;
    }
    (0..4096)
        .map(|step| {
            let angle = std::f64::consts::TAU * f64::from(step) / 4096.0;
            let term =
                |(index, h): (usize, &HarmonicInput)| h.amplitude * ((index + 1) as f64 * angle + h.phase_rad).cos();
            1.0 + harmonics.iter().enumerate().map(term).sum::<f64>()
        })
        .fold(f64::INFINITY, f64::min)
}

/// One harmonic of a given mesh stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Input)]
pub struct HarmonicInput {
    /// Fraction of the mean.
    #[input(min = 0.0, max = 1.0)]
    pub amplitude: f64,
    /// Phase of the cosine at time zero.
    #[input(unit = "rad", min = -1000.0, max = 1000.0, default = 0.0)]
    pub phase_rad: f64,
}

/// Source of the mesh-in impact.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "source", rename_all = "snake_case")]
pub enum ImpactInput {
    /// From the corner contact, buffered by the pairs in mesh.
    CornerContact(CornerImpactInput),
    /// From the corner contact, unbuffered.
    Zhou2008(CornerImpactInput),
    /// No impact.
    None,
    /// A given half sine.
    Given(GivenImpactInput),
}

impl ImpactInput {
    /// The motions that the impact acts on.
    pub fn acts_on(&self) -> ActsOn {
        match self {
            ImpactInput::CornerContact(corner) | ImpactInput::Zhou2008(corner) => corner.acts_on,
            ImpactInput::Given(given) => given.acts_on,
            ImpactInput::None => ActsOn::Torsion,
        }
    }
}

/// The members of the JSON object of [`ImpactInput`].
#[derive(Input)]
struct ImpactMembers {
    /// corner_contact (buffered by the pairs in mesh), zhou2008 (unbuffered), none or given.
    #[input(default = ImpactSource::CornerContact)]
    source: ImpactSource,
    /// What the impact moves: the torsional equations only (the source to the letter), or all: bending and axial motion too, as a normal
    /// force on the tooth does.
    #[input(default = ActsOn::Torsion, when = "source = corner_contact zhou2008 given")]
    acts_on: ActsOn,
    /// Length of the pulse: from the corner contact to the theoretical start of contact, or half the period of the equivalent mass on the
    /// impact's compliance.
    #[input(default = ImpactDuration::CornerToStart, when = "source = corner_contact zhou2008")]
    duration: ImpactDuration,
    /// Base pitch error of the entering pair; positive enters earlier.
    #[input(unit = "um", min = -100.0, max = 100.0, default = 0.0, when = "source = corner_contact zhou2008")]
    base_pitch_error_um: f64,
    /// Start of the pulse in mesh periods after the theoretical start of contact.
    #[input(min = -1.0, max = 1.0, when = "source = corner_contact zhou2008 given")]
    start_mesh_periods: Option<f64>,
    /// given: peak of the half sine.
    #[input(unit = "N", min = 0.0, max = 1e9, when = "source = given")]
    force_n: Option<f64>,
    /// given: length of the half sine in mesh periods.
    #[input(min = 1e-9, max = 1.0, when = "source = given")]
    duration_mesh_periods: Option<f64>,
}

/// Law of the mesh-in impact.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Words)]
pub enum ImpactSource {
    #[default]
    CornerContact,
    #[words(label = "Zhou (2008), unbuffered")]
    Zhou2008,
    None,
    Given,
}

impl Input for ImpactInput {
    fn read(object: &Object, _base: Option<&Self>) -> Self {
        let members: ImpactMembers = Input::read(object, None);
        let ImpactMembers { acts_on, duration, base_pitch_error_um, start_mesh_periods, .. } = members;
        let corner = CornerImpactInput { acts_on, duration, start_mesh_periods, base_pitch_error_um };
        match members.source {
            ImpactSource::CornerContact => ImpactInput::CornerContact(corner),
            ImpactSource::Zhou2008 => ImpactInput::Zhou2008(corner),
            ImpactSource::None => ImpactInput::None,
            ImpactSource::Given => {
                let needed = [
                    ("force_n", members.force_n, "0 to 1e9 N"),
                    ("duration_mesh_periods", members.duration_mesh_periods, "1e-9 to 1 mesh periods"),
                ];
                for (name, _, range) in needed.iter().filter(|(_, value, _)| value.is_none()) {
                    object.place().missing(name, format!("is required with source \"given\": {range}"));
                }
                ImpactInput::Given(GivenImpactInput {
                    acts_on,
                    force_n: members.force_n.unwrap_or(0.0),
                    duration_mesh_periods: members.duration_mesh_periods.unwrap_or(1.0),
                    start_mesh_periods: start_mesh_periods.unwrap_or(0.0),
                })
            }
        }
    }

    fn check(&mut self, _place: &ObjectPlace) {}

    fn slot(&mut self, pointer: &str) -> Option<Slot<'_>> {
        type Members = ImpactMembers;
        let (name, rest) = split_first(pointer)?;
        match (self, name) {
            (_, "source")
            | (ImpactInput::CornerContact(_) | ImpactInput::Zhou2008(_) | ImpactInput::Given(_), "acts_on")
            | (ImpactInput::CornerContact(_) | ImpactInput::Zhou2008(_), "duration") => {
                rest.is_empty().then_some(Slot::Other)
            }
            (ImpactInput::CornerContact(corner) | ImpactInput::Zhou2008(corner), "start_mesh_periods") => {
                Field::slot(&mut corner.start_mesh_periods, Members::START_MESH_PERIODS, rest)
            }
            (ImpactInput::CornerContact(corner) | ImpactInput::Zhou2008(corner), "base_pitch_error_um") => {
                Field::slot(&mut corner.base_pitch_error_um, Members::BASE_PITCH_ERROR_UM, rest)
            }
            (ImpactInput::Given(given), "start_mesh_periods") => {
                Field::slot(&mut given.start_mesh_periods, Members::START_MESH_PERIODS, rest)
            }
            (ImpactInput::Given(given), "force_n") => Field::slot(&mut given.force_n, Members::FORCE_N, rest),
            (ImpactInput::Given(given), "duration_mesh_periods") => {
                Field::slot(&mut given.duration_mesh_periods, Members::DURATION_MESH_PERIODS, rest)
            }
            _ => None,
        }
    }
}

/// Motions that an impact acts on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Words)]
pub enum ActsOn {
    #[default]
    /// The torsional equations only, as the source prints them.
    Torsion,
    /// Bending and axial motion too, as a normal force on the tooth does.
    All,
}

/// An impact that is calculated from the corner contact.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CornerImpactInput {
    pub acts_on: ActsOn,
    pub duration: ImpactDuration,
    /// Start of the pulse after the theoretical start of contact; when the pair enters (the corner contact) if null.
    pub start_mesh_periods: Option<f64>,
    pub base_pitch_error_um: f64,
}

/// Length of the pulse of an impact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum ImpactDuration {
    /// From the first corner contact to the theoretical start of contact.
    CornerToStart,
    /// Half the period of the equivalent mass on the compliance of the impact.
    EnergyBalance,
}

/// A given half sine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GivenImpactInput {
    pub acts_on: ActsOn,
    pub force_n: f64,
    pub duration_mesh_periods: f64,
    pub start_mesh_periods: f64,
}
