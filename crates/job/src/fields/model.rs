//! Choices of the physical model: mesh stiffness and impact.

use super::{conflict, number};
use crate::document::*;
use crate::reader::Object;
use crate::violation::Violation;

pub(super) fn model(object: Object) -> ModelInput {
    let mesh_stiffness = mesh_stiffness(object.object("mesh_stiffness", false, "Where the mesh stiffness comes from."));
    let from_contact = matches!(mesh_stiffness, MeshStiffness::Ltca(_));
    let mesh_force = object.choice(
        "mesh_force",
        &[("stiffness", MeshForce::Stiffness), ("contact", MeshForce::Contact)],
        if from_contact { MeshForce::Contact } else { MeshForce::Stiffness },
        if from_contact { "contact" } else { "stiffness" },
        "What the equations contain of the mesh: contact (the force of the loaded contact over approach and phase, entry shock and loss of contact \
         included, no impact pulse; default with source ltca) or stiffness (the source's: k(t) over the backlash function, and the impact; \
         default with the other sources).",
    );
    if mesh_force == MeshForce::Contact && !from_contact {
        conflict(
            &object,
            "mesh_force",
            "is contact, which needs a loaded contact analysis: mesh_stiffness.source ltca; with given and iso6336 it is stiffness",
        );
    }
    let model = ModelInput {
        plane: object.choice(
            "plane",
            &[("base", Plane::Base), ("pitch", Plane::Pitch)],
            Plane::Base,
            "base",
            "Plane of the equations of motion: base (consistent) or pitch (the source to the letter).",
        ),
        mesh_damping_ratio: object
            .number("mesh_damping_ratio", number(0.0, 2.0, "1", Some(0.1), "Damping ratio of the mesh.")),
        damping_in_gap: object.boolean(
            "damping_in_gap",
            true,
            "Whether the mesh damper acts while the teeth are apart.",
        ),
        mesh_force,
        mesh_stiffness,
        impact: impact(object.object("impact", false, "Where the mesh-in impact comes from.")),
    };
    object.finish();
    model
}

fn mesh_stiffness(object: Object) -> MeshStiffness {
    let source = object.choice(
        "source",
        &[("ltca", 0), ("iso6336", 1), ("given", 2)],
        0,
        "ltca",
        "ltca (loaded tooth contact analysis), iso6336 (closed form) or given.",
    );
    let fidelity = object.choice(
        "fidelity",
        &[("analytic", Fidelity::Analytic), ("fe", Fidelity::Fe), ("uniform", Fidelity::Uniform)],
        Fidelity::Analytic,
        "analytic",
        "ltca: how the tooth and body compliance is found: analytic (milliseconds) or fe (finite elements of both gears, seconds; kept for the next job); uniform is a plain elastic foundation along the contact lines, for comparisons.",
    );
    let line_stiffness_n_per_mm_um = object.number(
        "line_stiffness_n_per_mm_um",
        number(
            0.01,
            1000.0,
            "N/(mm um)",
            Some(14.0),
            "ltca, uniform: normal force per length of contact line and approach along the flank normal.",
        ),
    );
    let elements = object.choice(
        "elements",
        &[
            ("coarse", Elements::Coarse),
            ("medium", Elements::Medium),
            ("standard", Elements::Standard),
            ("fine", Elements::Fine),
        ],
        Elements::Standard,
        "standard",
        "ltca, fe: how fine the finite elements are.",
    );
    let body = object.choice(
        "body",
        &[("rim", BodyInput::Rim), ("bore", BodyInput::Bore)],
        BodyInput::Rim,
        "rim",
        "ltca: where the gear bodies are held: 3 normal modules below the root circle, or at the bore.",
    );
    let corner_contact =
        object.boolean("corner_contact", true, "ltca: whether tip corners may touch outside the path of contact.");
    let law = object.choice(
        "law",
        &[
            ("transmission_error", StiffnessLaw::TransmissionError),
            ("secant", StiffnessLaw::Secant),
            ("tangent", StiffnessLaw::Tangent),
        ],
        StiffnessLaw::TransmissionError,
        "transmission_error",
        "ltca: stiffness curve of the equations of motion: mean of the tangent stiffness with the fluctuation of the loaded \
         transmission error, secant F/delta, or tangent dF/ddelta.",
    );
    let accuracy = object.number(
        "accuracy",
        number(1e-5, 0.1, "1", Some(2e-3), "ltca: positions are added until stiffness and transmission error between them agree with their interpolation to this part of their means."),
    );
    let positions = object
        .optional_integer(
            "positions",
            8,
            1024,
            "ltca: positions over one mesh period; as many as the accuracy needs when null.",
        )
        .map(|n| n as u32);
    let slices = object
        .optional_integer(
            "slices",
            5,
            200,
            "ltca: slices of the contact lines over the face width of one half; by face width and overlap when null.",
        )
        .map(|n| n as u32);
    let given = given_stiffness(&object, source == 2);
    object.finish();
    match source {
        0 => MeshStiffness::Ltca(Ltca {
            fidelity,
            line_stiffness_n_per_mm_um,
            elements,
            body,
            corner_contact,
            law,
            accuracy,
            positions,
            slices,
        }),
        1 => MeshStiffness::Iso6336,
        _ => MeshStiffness::Given(given),
    }
}

fn given_stiffness(object: &Object, wanted: bool) -> GivenStiffness {
    let stiffness = |help| number(1e-3, 1e7, "N/um", None, help);
    let mean = object.optional_number("mean_n_per_um", stiffness("given: mean stiffness of one half along s."));
    let harmonics = object
        .objects("harmonics", 0, 64, "given: harmonics of the mesh frequency; amplitudes are fractions of the mean.")
        .unwrap_or_default()
        .into_iter()
        .map(|item| {
            let harmonic = HarmonicInput {
                amplitude: item.number("amplitude", number(0.0, 1.0, "1", None, "Fraction of the mean.")),
                phase_rad: item.number(
                    "phase_rad",
                    number(-1000.0, 1000.0, "rad", Some(0.0), "Phase of the cosine at time zero."),
                ),
            };
            item.finish();
            harmonic
        })
        .collect::<Vec<_>>();
    let samples = object.numbers(
        "samples_n_per_um",
        2,
        4096,
        stiffness("given: stiffness at equal steps over one mesh period, interpolated by a periodic cubic."),
    );
    if wanted {
        match (mean, &samples) {
            (None, None) => object.reading().violate(Violation::new(
                object.pointer_to("mean_n_per_um"),
                "missing",
                "is required with source \"given\" (0.001 to 1e7 N/um), unless samples_n_per_um is given",
            )),
            (Some(_), Some(_)) => {
                conflict(object, "samples_n_per_um", "is given together with mean_n_per_um; give one")
            }
            _ => {}
        }
        let total: f64 = harmonics.iter().map(|harmonic| harmonic.amplitude).sum();
        if mean.is_some() && !object.reading().is_describing() && lowest_of(&harmonics) <= 0.0 {
            let detail = format!(
                "make the stiffness zero or negative somewhere in the mesh period (amplitudes sum to {total}); it must stay above 0 N/um"
            );
            conflict(object, "harmonics", &detail);
        }
    }
    match (mean, samples) {
        (None, Some(samples_n_per_um)) => GivenStiffness::Samples { samples_n_per_um },
        (mean, _) => GivenStiffness::Harmonics { mean_n_per_um: mean.unwrap_or(1.0), harmonics },
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

fn impact(object: Object) -> ImpactInput {
    let source = object.choice(
        "source",
        &[("corner_contact", 0), ("zhou2008", 1), ("none", 2), ("given", 3)],
        0,
        "corner_contact",
        "corner_contact (buffered by the pairs in mesh), zhou2008 (unbuffered), none or given.",
    );
    let acts_on = object.choice(
        "acts_on",
        &[("torsion", ActsOn::Torsion), ("all", ActsOn::All)],
        ActsOn::Torsion,
        "torsion",
        "What the impact moves: the torsional equations only (the source to the letter), or all: bending and axial motion too, as a normal force on the tooth does.",
    );
    let corner = CornerImpactInput {
        acts_on,
        duration: object.choice(
            "duration",
            &[("corner_to_start", ImpactDuration::CornerToStart), ("energy_balance", ImpactDuration::EnergyBalance)],
            ImpactDuration::CornerToStart,
            "corner_to_start",
            "Length of the pulse: from the corner contact to the theoretical start of contact, or half the period of the \
             equivalent mass on the impact's compliance.",
        ),
        base_pitch_error_um: object.number(
            "base_pitch_error_um",
            number(-100.0, 100.0, "um", Some(0.0), "Base pitch error of the entering pair; positive enters earlier."),
        ),
        start_mesh_periods: object.optional_number(
            "start_mesh_periods",
            number(-1.0, 1.0, "1", None, "Start of the pulse in mesh periods after the theoretical start of contact."),
        ),
    };
    let force = object.optional_number("force_n", number(0.0, 1e9, "N", None, "given: peak of the half sine."));
    let duration = object.optional_number(
        "duration_mesh_periods",
        number(1e-9, 1.0, "1", None, "given: length of the half sine in mesh periods."),
    );
    if source == 3 {
        for (name, value, range) in
            [("force_n", force, "0 to 1e9 N"), ("duration_mesh_periods", duration, "1e-9 to 1 mesh periods")]
        {
            if value.is_none() {
                object.reading().violate(Violation::new(
                    object.pointer_to(name),
                    "missing",
                    format!("is required with source \"given\": {range}"),
                ));
            }
        }
    }
    object.finish();
    match source {
        0 => ImpactInput::CornerContact(corner),
        1 => ImpactInput::Zhou2008(corner),
        2 => ImpactInput::None,
        _ => ImpactInput::Given(GivenImpactInput {
            acts_on,
            force_n: force.unwrap_or(0.0),
            duration_mesh_periods: duration.unwrap_or(1.0),
            start_mesh_periods: corner.start_mesh_periods.unwrap_or(0.0),
        }),
    }
}
