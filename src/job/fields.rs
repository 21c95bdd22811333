//! The declaration of every field of the job document: name, range, unit, default, help. Read once to parse a
//! document, once over nothing to publish its schema.

use super::document::*;
use super::reader::{Number, Object, Reading};
use super::violation::{DocumentError, Violation};
use serde_json::Value;

/// Largest number of points of a sweep.
pub const MAX_SWEEP_POINTS: usize = 100_000;
/// Largest number of samples per recorded channel.
pub const MAX_SERIES_SAMPLES: u64 = 4_000_000;

const fn number(min: f64, max: f64, unit: &'static str, default: Option<f64>, help: &'static str) -> Number {
    Number { min, max, unit, default, help }
}

/// Parses the bytes of a job document; finds every violation in one pass.
///
/// # Errors
/// [`DocumentError::Malformed`] when the bytes are not JSON, [`DocumentError::Invalid`] with all violations otherwise.
/// Whether the gear can exist is not checked here (see `study::prepare`).
pub fn parse(bytes: &[u8]) -> Result<JobDocument, DocumentError> {
    let value: Value = serde_json::from_slice(bytes).map_err(|error| DocumentError::Malformed {
        detail: malformed_text(&error),
        line: error.line(),
        column: error.column(),
    })?;
    parse_value(&value)
}

/// As [`parse`], from JSON that is already read.
pub fn parse_value(value: &Value) -> Result<JobDocument, DocumentError> {
    let reading = Reading::read();
    let document = read(reading.root(value));
    let violations = reading.violations();
    if violations.is_empty() { Ok(document) } else { Err(DocumentError::Invalid(violations)) }
}

fn malformed_text(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rfind(" at line ") {
        Some(end) => text[..end].to_owned(),
        None => text,
    }
}

/// Reads the whole document (or, with [`Reading::describe`], declares all of its fields).
pub fn read(root: Object) -> JobDocument {
    let kind = root.choice("kind", &Kind::ALL, Kind::Response, "response", "What to compute: mesh, response or sweep.");
    let name = root.text("name", 200, "A name for people.");
    let label = root.text("label", 100, "A label to find jobs by.");
    let design = design(root.object("design", true, "The gear pair."));
    let operation = operation(root.object("operation", true, "The operating point."));
    let model = model(root.object("model", false, "Choices of the physical model."));
    let analysis = analysis(root.object("analysis", false, "Accuracy and method."));
    let axes = axes(&root, kind);
    let continuation = continuation(&root, kind);
    root.finish();
    JobDocument { kind, name, label, design, operation, model, analysis, axes, continuation }
}

fn design(object: Object) -> Design {
    let pinion_hand = Hand::Left;
    let pinion = gear(object.object("pinion", true, "The driving gear."), pinion_hand);
    let gear_hand = pinion.left_half_hand.opposite();
    let gear = gear(object.object("gear", true, "The driven gear."), gear_hand);
    if pinion.left_half_hand == gear.left_half_hand {
        object.reading().violate(Violation::new(
            object.pointer_to("gear/left_half_hand"),
            "conflict",
            "is the same hand as the pinion's left half; mating halves of an external pair have opposite hands",
        ));
    }
    let design = Design {
        normal_module_mm: object.number("normal_module_mm", number(0.1, 100.0, "mm", None, "Normal module m_n.")),
        pressure_angle_deg: object
            .number("pressure_angle_deg", number(10.0, 35.0, "deg", Some(20.0), "Pressure angle of the rack.")),
        pressure_angle_plane: object.choice(
            "pressure_angle_plane",
            &[("normal", PressureAnglePlane::Normal), ("transverse", PressureAnglePlane::Transverse)],
            PressureAnglePlane::Normal,
            "normal",
            "Section in which the pressure angle is given.",
        ),
        helix_angle_deg: object
            .number("helix_angle_deg", number(0.0, 50.0, "deg", None, "Helix angle at the reference circle.")),
        face_width_mm: object.number("face_width_mm", number(0.5, 2000.0, "mm", None, "Face width of one half.")),
        gap_width_mm: object
            .number("gap_width_mm", number(0.0, 1000.0, "mm", Some(30.0), "Width of the gap between the halves.")),
        center_distance_mm: object.optional_number(
            "center_distance_mm",
            number(1.0, 20_000.0, "mm", None, "Working centre distance; derived from the profile shifts when null."),
        ),
        backlash_um: object.number(
            "backlash_um",
            number(0.0, 1000.0, "um", Some(2.0), "Total play along the direction of the mesh displacement s."),
        ),
        half_stagger: object.number(
            "half_stagger",
            number(0.0, 1.0, "1", Some(0.0), "Stagger of the right half as a fraction of the transverse pitch."),
        ),
        material: material(object.object("material", false, "Material of both gears.")),
        supports: supports(object.object("supports", false, "Shafts and bearings, per half.")),
        assembly: assembly(object.object("assembly", false, "Assembly errors.")),
        pinion,
        gear,
    };
    object.finish();
    design
}

fn material(object: Object) -> Material {
    let material = Material {
        youngs_modulus_gpa: object
            .number("youngs_modulus_gpa", number(1.0, 1000.0, "GPa", Some(206.0), "Young's modulus.")),
        poissons_ratio: object.number("poissons_ratio", number(0.0, 0.49, "1", Some(0.3), "Poisson's ratio.")),
        density_kg_m3: object.number("density_kg_m3", number(100.0, 30_000.0, "kg/m3", Some(7850.0), "Density.")),
    };
    object.finish();
    material
}

fn gear(object: Object, default_hand: Hand) -> Gear {
    let default_word = if default_hand == Hand::Left { "left" } else { "right" };
    let flank = flank(&object, None);
    let side = |name: &'static str, help| {
        object.optional_object(name, help).map(|half| {
            let modification = self::flank(&half, Some(&flank));
            half.finish();
            modification
        })
    };
    let left = side("left", "Flank modifications of the left half where they differ.");
    let right = side("right", "Flank modifications of the right half where they differ.");
    let gear = Gear {
        teeth: object.integer("teeth", 5, 1000, None, "Number of teeth.") as u32,
        left_half_hand: object.choice(
            "left_half_hand",
            &[("left", Hand::Left), ("right", Hand::Right)],
            default_hand,
            default_word,
            "Hand of the left half's helix.",
        ),
        profile_shift: object
            .number("profile_shift", number(-2.0, 2.0, "1", Some(0.0), "Profile shift coefficient x.")),
        addendum: object.number(
            "addendum",
            number(0.3, 2.5, "1", Some(1.0), "Addendum of the rack, multiple of the normal module."),
        ),
        dedendum: object.number(
            "dedendum",
            number(0.3, 3.0, "1", Some(1.25), "Dedendum of the rack, multiple of the normal module."),
        ),
        fillet_radius: object.number(
            "fillet_radius",
            number(0.0, 1.0, "1", Some(0.38), "Root fillet radius of the rack, multiple of the normal module."),
        ),
        tip_alteration: object.number(
            "tip_alteration",
            number(-1.0, 0.5, "1", Some(0.0), "Tip alteration coefficient k; negative shortens the tooth."),
        ),
        bore_diameter_mm: object.optional_number(
            "bore_diameter_mm",
            number(0.0, 20_000.0, "mm", None, "Bore; 0.4 of the reference diameter when null."),
        ),
        mass_kg: object.optional_number(
            "mass_kg",
            number(1e-6, 1e6, "kg", None, "Mass of the whole gear; a solid disc of both halves when null."),
        ),
        inertia_kg_m2: object.optional_number(
            "inertia_kg_m2",
            number(
                1e-9,
                1e9,
                "kg m2",
                None,
                "Moment of inertia of the whole gear; a solid disc of both halves when null.",
            ),
        ),
        flank,
        left,
        right,
    };
    object.finish();
    gear
}

/// Flank modifications among the fields of `object`; what is left out comes from `base`, or is zero.
fn flank(object: &Object, base: Option<&Flank>) -> Flank {
    let default = |pick: fn(&Flank) -> f64| Some(base.map_or(0.0, pick));
    let tip = object.object("tip_relief", false, "Tip relief.");
    let base_shape = base.map_or(ReliefShape::Parabolic, |flank| flank.tip_relief.shape);
    let tip_relief = TipRelief {
        amount_um: tip
            .number("amount_um", number(0.0, 1000.0, "um", default(|f| f.tip_relief.amount_um), "Relief at the tip.")),
        length_mm: tip.number(
            "length_mm",
            number(
                0.0,
                500.0,
                "mm",
                default(|f| f.tip_relief.length_mm),
                "Roll length along the path of contact from the tip.",
            ),
        ),
        shape: tip.choice(
            "shape",
            &[("linear", ReliefShape::Linear), ("parabolic", ReliefShape::Parabolic)],
            base_shape,
            if base_shape == ReliefShape::Linear { "linear" } else { "parabolic" },
            "Course over the length.",
        ),
    };
    if tip_relief.amount_um > 0.0 && tip_relief.length_mm == 0.0 {
        conflict(&tip, "length_mm", "is 0 mm while amount_um is above 0; a relief needs a roll length above 0 mm");
    }
    tip.finish();
    let end = object.object("end_relief", false, "End relief at both ends of the face width.");
    let end_relief = EndRelief {
        amount_um: end
            .number("amount_um", number(0.0, 1000.0, "um", default(|f| f.end_relief.amount_um), "Relief at the ends.")),
        length_mm: end.number(
            "length_mm",
            number(0.0, 1000.0, "mm", default(|f| f.end_relief.length_mm), "Axial length of the relief."),
        ),
    };
    if end_relief.amount_um > 0.0 && end_relief.length_mm == 0.0 {
        conflict(&end, "length_mm", "is 0 mm while amount_um is above 0; a relief needs a length above 0 mm");
    }
    end.finish();
    Flank {
        tip_relief,
        lead_crowning_um: object.number(
            "lead_crowning_um",
            number(
                -500.0,
                1000.0,
                "um",
                default(|f| f.lead_crowning_um),
                "Crowning: zero at mid-width, this at both ends.",
            ),
        ),
        helix_slope_um: object.number(
            "helix_slope_um",
            number(
                -1000.0,
                1000.0,
                "um",
                default(|f| f.helix_slope_um),
                "Helix slope: zero at the inner end, this at the outer.",
            ),
        ),
        end_relief,
    }
}

fn conflict(object: &Object, name: &str, detail: &str) {
    object.reading().violate(Violation::new(object.pointer_to(name), "conflict", detail));
}

fn supports(object: Object) -> Supports {
    let spring = |name, default, help| object.number(name, number(0.0, 1e7, "N/um", Some(default), help));
    let torsion = |name, help| object.number(name, number(0.0, 1e13, "N m/rad", Some(0.0), help));
    let supports = Supports {
        pinion_lateral_n_per_um: spring("pinion_lateral_n_per_um", 600.0, "Lateral support of each pinion half."),
        gear_lateral_n_per_um: spring("gear_lateral_n_per_um", 600.0, "Lateral support of each gear half."),
        pinion_halves_axial_n_per_um: spring(
            "pinion_halves_axial_n_per_um",
            300.0,
            "Axial spring between the pinion halves.",
        ),
        gear_axial_n_per_um: spring("gear_axial_n_per_um", 200.0, "Axial support of each gear half."),
        gear_halves_axial_n_per_um: spring(
            "gear_halves_axial_n_per_um",
            300.0,
            "Axial spring between the gear halves.",
        ),
        damping_ratio: object
            .number("damping_ratio", number(0.0, 2.0, "1", Some(0.03), "Damping ratio of supports and couplings.")),
        pinion_halves_torsional_nm_per_rad: torsion(
            "pinion_halves_torsional_nm_per_rad",
            "Torsional spring between the pinion halves; none in the source's model.",
        ),
        gear_halves_torsional_nm_per_rad: torsion(
            "gear_halves_torsional_nm_per_rad",
            "Torsional spring between the gear halves; none in the source's model.",
        ),
        pinion_halves_lateral_n_per_um: spring(
            "pinion_halves_lateral_n_per_um",
            0.0,
            "Lateral (bending) spring between the pinion halves; none in the source's model.",
        ),
        gear_halves_lateral_n_per_um: spring(
            "gear_halves_lateral_n_per_um",
            0.0,
            "Lateral (bending) spring between the gear halves; none in the source's model.",
        ),
    };
    object.finish();
    supports
}

fn assembly(object: Object) -> Assembly {
    let error = |name, help| object.number(name, number(-2000.0, 2000.0, "um", Some(0.0), help));
    let assembly = Assembly {
        center_distance_error_um: error("center_distance_error_um", "Added to the centre distance."),
        in_plane_misalignment_um: error(
            "in_plane_misalignment_um",
            "Linear gap over the face width of one half, in the plane of action.",
        ),
        out_of_plane_misalignment_um: error(
            "out_of_plane_misalignment_um",
            "Linear deviation over the face width of one half, out of the plane of action.",
        ),
        apex_offset_um: error("apex_offset_um", "Axial offset between the apexes of pinion and gear."),
    };
    object.finish();
    assembly
}

fn operation(object: Object) -> Operation {
    let operation = Operation {
        pinion_speed_rpm: object
            .number("pinion_speed_rpm", number(0.1, 200_000.0, "r/min", None, "Speed of the pinion.")),
        pinion_torque_nm: object
            .number("pinion_torque_nm", number(-1e7, 1e7, "N m", None, "Torque of the whole pinion (both halves).")),
        rotation: object.choice(
            "rotation",
            &[("apex_leading", Rotation::ApexLeading), ("apex_trailing", Rotation::ApexTrailing)],
            Rotation::ApexLeading,
            "apex_leading",
            "Which ends of the teeth enter the mesh first: the inner (apex_leading) or the outer ones.",
        ),
    };
    object.finish();
    operation
}

fn model(object: Object) -> Model {
    let model = Model {
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
        mesh_stiffness: mesh_stiffness(object.object("mesh_stiffness", false, "Where the mesh stiffness comes from.")),
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
        &[("analytic", Fidelity::Analytic), ("fe", Fidelity::Fe)],
        Fidelity::Analytic,
        "analytic",
        "ltca: how the tooth and body compliance is found.",
    );
    let body = object.choice(
        "body",
        &[("rim", Body::Rim), ("bore", Body::Bore)],
        Body::Rim,
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
    let positions =
        object.optional_integer("positions", 8, 1024, "ltca: positions over one mesh period.").map(|n| n as u32);
    let slices =
        object.optional_integer("slices", 5, 200, "ltca: slices over the face width of one half.").map(|n| n as u32);
    let given = given_stiffness(&object, source == 2);
    object.finish();
    match source {
        0 => MeshStiffness::Ltca(Ltca { fidelity, body, corner_contact, law, positions, slices }),
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
            let harmonic = Harmonic {
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
                "is required with source \"given\" (0.001 to 10000000 N/um), unless samples_n_per_um is given",
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
fn lowest_of(harmonics: &[Harmonic]) -> f64 {
    let total: f64 = harmonics.iter().map(|harmonic| harmonic.amplitude).sum();
    if total < 1.0 {
        return 1.0 - total;
    }
    (0..4096)
        .map(|step| {
            let angle = std::f64::consts::TAU * f64::from(step) / 4096.0;
            let term = |(index, h): (usize, &Harmonic)| h.amplitude * ((index + 1) as f64 * angle + h.phase_rad).cos();
            1.0 + harmonics.iter().enumerate().map(term).sum::<f64>()
        })
        .fold(f64::INFINITY, f64::min)
}

fn impact(object: Object) -> Impact {
    let source = object.choice(
        "source",
        &[("corner_contact", 0), ("zhou2008", 1), ("none", 2), ("given", 3)],
        0,
        "corner_contact",
        "corner_contact (buffered by the pairs in mesh), zhou2008 (unbuffered), none or given.",
    );
    let corner = CornerImpact {
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
            [("force_n", force, "0 to 1000000000 N"), ("duration_mesh_periods", duration, "1e-9 to 1 mesh periods")]
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
        0 => Impact::CornerContact(corner),
        1 => Impact::Zhou2008(corner),
        2 => Impact::None,
        _ => Impact::Given(GivenImpact {
            force_n: force.unwrap_or(0.0),
            duration_mesh_periods: duration.unwrap_or(1.0),
            start_mesh_periods: corner.start_mesh_periods.unwrap_or(0.0),
        }),
    }
}

fn analysis(object: Object) -> Analysis {
    let analysis = Analysis {
        accuracy: object.number(
            "accuracy",
            number(
                1e-12,
                1e-2,
                "1",
                Some(1e-6),
                "Relative error of the reported RMS values that the solver has to reach.",
            ),
        ),
        method: object.choice(
            "method",
            &[("auto", Method::Auto), ("periodic", Method::Periodic), ("integrate", Method::Integrate)],
            Method::Auto,
            "auto",
            "auto (the cheapest that is right), periodic, or integrate from the initial state.",
        ),
        integrator: object.choice(
            "integrator",
            &[("taylor", Integrator::Taylor), ("runge_kutta_4", Integrator::RungeKutta4)],
            Integrator::Taylor,
            "taylor",
            "Time integration: event-exact Taylor series, or the variable-step fourth-order Runge-Kutta of the source.",
        ),
        mesh_periods: object.integer("mesh_periods", 1, 10_000_000, Some(300), "Mesh periods to integrate.") as u32,
        record_mesh_periods: object.integer(
            "record_mesh_periods",
            1,
            100_000,
            Some(100),
            "Last mesh periods of them that are recorded.",
        ) as u32,
        samples_per_mesh_period: object.integer(
            "samples_per_mesh_period",
            8,
            4096,
            Some(256),
            "Samples per mesh period of each series.",
        ) as u32,
        channels: object.texts("channels", 64, "Channels to record as series, such as a_x_left; all when null."),
        initial_state: object.numbers(
            "initial_state",
            24,
            24,
            number(-1e6, 1e6, "SI", None, "12 displacements in the source's order (m, rad), then 12 velocities."),
        ),
    };
    if analysis.record_mesh_periods > analysis.mesh_periods && object.has("record_mesh_periods") {
        let detail = format!(
            "is {}; permitted: 1 to mesh_periods, which is {}",
            analysis.record_mesh_periods, analysis.mesh_periods
        );
        object.reading().violate(Violation::new(object.pointer_to("record_mesh_periods"), "conflict", detail));
    }
    let samples = u64::from(analysis.record_mesh_periods) * u64::from(analysis.samples_per_mesh_period);
    if samples > MAX_SERIES_SAMPLES {
        let detail = format!(
            "times record_mesh_periods gives {samples} samples per channel; permitted: at most {MAX_SERIES_SAMPLES}"
        );
        object.reading().violate(Violation::new(object.pointer_to("samples_per_mesh_period"), "conflict", detail));
    }
    if analysis.initial_state.is_some() && analysis.method != Method::Integrate {
        conflict(&object, "initial_state", "needs method \"integrate\"");
    }
    object.finish();
    Analysis { record_mesh_periods: analysis.record_mesh_periods.min(analysis.mesh_periods), ..analysis }
}

fn axes(root: &Object, kind: Kind) -> Vec<Axis> {
    let help = "sweep: one or two inputs to vary.";
    let Some(objects) = root.objects("axes", 1, 2, help) else {
        if kind == Kind::Sweep && !root.has("axes") {
            root.reading().violate(Violation::new("/axes", "missing", "is required for a sweep: one or two axes"));
        }
        return Vec::new();
    };
    if kind != Kind::Sweep {
        conflict(root, "axes", "is given, but kind is not \"sweep\"");
    }
    let axes: Vec<Axis> = objects.into_iter().map(axis).collect();
    let points: usize = axes.iter().map(Axis::len).product();
    if points > MAX_SWEEP_POINTS {
        let detail = format!("have {points} points together; permitted: at most {MAX_SWEEP_POINTS}");
        conflict(root, "axes", &detail);
    }
    axes
}

fn axis(object: Object) -> Axis {
    let any = |help| number(-1e12, 1e12, "unit of the input", None, help);
    let pointer = object.text("pointer", 200, "JSON pointer of the input that varies.");
    let from = object.optional_number("from", any("First value."));
    let to = object.optional_number("to", any("Last value."));
    let points = object.integer("points", 1, MAX_SWEEP_POINTS as u64, Some(50), "Number of values.") as u32;
    let spacing = object.choice(
        "spacing",
        &[("linear", Spacing::Linear), ("logarithmic", Spacing::Logarithmic)],
        Spacing::Linear,
        "linear",
        "Spacing of the values.",
    );
    let values = object.numbers("values", 1, MAX_SWEEP_POINTS, any("The values, instead of from, to and points."));
    if pointer.is_none() && !object.has("pointer") {
        object.reading().violate(Violation::new(
            object.pointer_to("pointer"),
            "missing",
            "is required: a JSON pointer",
        ));
    }
    let points = match (values, from, to) {
        (Some(values), None, None) => AxisPoints::Values { values },
        (Some(values), ..) => {
            conflict(&object, "values", "is given together with from or to; give one or the other");
            AxisPoints::Values { values }
        }
        (None, Some(from), Some(to)) => {
            if spacing == Spacing::Logarithmic && (from <= 0.0 || to <= 0.0) {
                conflict(&object, "spacing", "is logarithmic, which needs from and to above 0");
            }
            AxisPoints::Range { from, to, points, spacing }
        }
        (None, from, _) => {
            let name = if from.is_none() { "from" } else { "to" };
            if !object.has("values") && !object.has(name) {
                object.reading().violate(Violation::new(
                    object.pointer_to(name),
                    "missing",
                    "is required, unless values is given: -1000000000000 to 1000000000000, in the unit of the input",
                ));
            }
            AxisPoints::Values { values: vec![0.0] }
        }
    };
    object.finish();
    Axis { pointer: pointer.unwrap_or_default(), points }
}

fn continuation(root: &Object, kind: Kind) -> Option<Continuation> {
    let value = root.choice(
        "continuation",
        &[("none", Continuation::None), ("up", Continuation::Up), ("down", Continuation::Down)],
        Continuation::None,
        "none",
        "sweep: whether a point starts cold or from its neighbour below (up) or above (down).",
    );
    if kind != Kind::Sweep && root.has("continuation") {
        conflict(root, "continuation", "is given, but kind is not \"sweep\"");
    }
    (kind == Kind::Sweep).then_some(value)
}
