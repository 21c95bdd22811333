//! Errors of a result: of the solution of the equations, and of the model of the mesh.

use crate::document::{BodyInput, DesignInput, Elements, Fidelity, FlankInput, JobDocument, Ltca, MeshStiffness};
use crate::result::{Accuracy, JobResult, Mesh, ModelError, SweepResult};

/// Largest differences in the comparisons with references, in per cent.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bound {
    stiffness: f64,
    harmonic: f64,
    basis: &'static str,
}

/// The table of model errors. Each row rounds up the worst case of the comparison that its text names, and claims no
/// less than the uncertainty of the reference (1.5 % in stiffness, 3 % in the first harmonic). A row changes together
/// with the section it names.
mod measured {
    use super::Bound;

    const fn bound(stiffness: f64, harmonic: f64, basis: &'static str) -> Bound {
        Bound { stiffness, harmonic, basis }
    }

    pub(super) const ISO_6336: Bound = bound(
        70.0,
        120.0,
        "closed form of ISO 6336-1 method B, which knows neither hold nor modifications: worst of 16 cases (docs/BENCHMARKS.md, Contact: time against error)",
    );
    pub(super) const FE_COARSE: Bound = bound(
        1.5,
        4.5,
        "coarse finite elements: worst of 16 cases (docs/BENCHMARKS.md, Contact: time against error), references uncertain by 1.5 % and 3 %",
    );
    pub(super) const FE: Bound = bound(
        1.5,
        3.0,
        "finite elements: the references' own uncertainty; differences to them are within 0.5 % and 1.5 % (docs/BENCHMARKS.md, Contact: time against error)",
    );
    pub(super) const SPUR_RIM: Bound = bound(
        3.0,
        4.0,
        "analytic compliance, spur pairs held at the rim (docs/BENCHMARKS.md, Contact: time against error)",
    );
    pub(super) const SPUR_BORE: Bound = bound(
        2.0,
        4.0,
        "analytic compliance, spur pairs held at the bore (docs/BENCHMARKS.md, Contact: time against error)",
    );
    pub(super) const HELICAL_RIM: Bound = bound(
        3.0,
        20.0,
        "analytic compliance, helical pairs held at the rim (docs/BENCHMARKS.md, Contact: time against error; docs/VALIDATION.md, Not reached or doubtful: helical and short faces)",
    );
    pub(super) const HELICAL_BORE: Bound = bound(
        2.0,
        20.0,
        "analytic compliance, helical pairs held at the bore (docs/VALIDATION.md, Loaded pair 29/67 against finite elements; Not reached or doubtful: helical and short faces)",
    );
    /// Helix angle above which the next row applies.
    pub(super) const STEEP_HELIX_DEG: f64 = 35.0;
    pub(super) const STEEP: Bound = bound(
        4.0,
        25.0,
        "analytic compliance, helix angles above 35° (docs/VALIDATION.md, Not reached or doubtful: helical and short faces)",
    );
    /// Below so many teeth of either gear the first harmonic of helical pairs is that of the next row.
    pub(super) const FEW_TEETH: u32 = 17;
    pub(super) const FEW_TEETH_HARMONIC: (f64, &str) = (35.0, "; fewer than 17 teeth (the same section)");
    /// Error of the first harmonic with tip relief.
    pub(super) const RELIEVED_HARMONIC: (f64, &str) =
        (15.0, "; with tip relief at working load (docs/BENCHMARKS.md, Contact: time against error)");
    pub(super) const LIGHTLY_LOADED_HARMONIC: (f64, &str) = (
        23.0,
        "; with tip relief of more than three times the deflection (docs/VALIDATION.md, Not reached or doubtful: amplitude of the transmission error)",
    );
    /// Error of the stiffness of short helical faces, over (m_n/b) tan β: it is proportional to that, and envelops all
    /// cases of the section; from 17 teeth on, and below.
    pub(super) const SHORT_FACE: [f64; 2] = [23.5, 40.5];
    pub(super) const SHORT_FACE_BASIS: &str = "; a face this short for its helix angle is too stiff (docs/VALIDATION.md, Not reached or doubtful: helical and short faces)";
}

/// Tip relief over the elastic deflection from which on the load counts as light: the reference with 10 and 15 % had
/// 1.2 and 2.8, that with 23 % 14.
const LIGHT_LOAD: f64 = 3.0;

/// The accuracy of a point; `result` has the results of its other stages.
pub(super) fn of(document: &JobDocument, result: &JobResult) -> Accuracy {
    let mesh = result.mesh.as_ref();
    let numerical = match &result.response {
        Some(response) => Some(response.error_estimate),
        None => mesh.map(discretisation),
    };
    Accuracy { numerical, model: model(document, mesh) }
}

/// The accuracy of a sweep: the largest numerical error of its points, and the model's for its base document.
pub(super) fn of_sweep(document: &JobDocument, sweep: &SweepResult) -> Accuracy {
    let errors = sweep.points.iter().filter_map(|point| point.error_estimate).filter(|error| error.is_finite());
    Accuracy { numerical: errors.reduce(f64::max), model: model(document, None) }
}

/// Relative error of the contact analysis by its positions and slices; a closed form and a given curve have none.
fn discretisation(mesh: &Mesh) -> f64 {
    mesh.convergence.as_ref().map_or(0.0, |convergence| {
        0.01 * convergence.position_error_percent.unwrap_or(0.0).max(convergence.slice_error_percent)
    })
}

fn model(document: &JobDocument, mesh: Option<&Mesh>) -> ModelError {
    match &document.model.mesh_stiffness {
        MeshStiffness::Given(_) => ModelError {
            mesh_stiffness_percent: None,
            transmission_error_harmonic_percent: None,
            basis: "the mesh stiffness is given: how near it is to the gear's is not known here".to_owned(),
        },
        MeshStiffness::Iso6336 => model_error(measured::ISO_6336, ""),
        MeshStiffness::Ltca(ltca) => match ltca.fidelity {
            Fidelity::Fe => {
                model_error(if ltca.elements == Elements::Coarse { measured::FE_COARSE } else { measured::FE }, "")
            }
            Fidelity::Analytic => analytic(&document.design, ltca, mesh),
            Fidelity::Uniform => ModelError {
                mesh_stiffness_percent: None,
                transmission_error_harmonic_percent: None,
                basis: "a uniform elastic foundation along the contact lines is a model for comparisons; how near it is to the gear's teeth is not \
                        known here"
                    .to_owned(),
            },
        },
    }
}

fn model_error(bound: Bound, notes: &str) -> ModelError {
    ModelError {
        mesh_stiffness_percent: Some(bound.stiffness),
        transmission_error_harmonic_percent: Some(bound.harmonic),
        basis: format!("{}{notes}", bound.basis),
    }
}

fn analytic(design: &DesignInput, ltca: &Ltca, mesh: Option<&Mesh>) -> ModelError {
    let helix_deg = design.helix_angle_deg;
    let mut bound = match (helix_deg == 0.0, ltca.body) {
        (true, BodyInput::Rim) => measured::SPUR_RIM,
        (true, BodyInput::Bore) => measured::SPUR_BORE,
        (false, _) if helix_deg > measured::STEEP_HELIX_DEG => measured::STEEP,
        (false, BodyInput::Rim) => measured::HELICAL_RIM,
        (false, BodyInput::Bore) => measured::HELICAL_BORE,
    };
    let mut notes = String::new();
    let few = design.pinion.teeth.min(design.gear.teeth) < measured::FEW_TEETH;
    let shortness = design.normal_module_mm / design.face_width_mm * helix_deg.to_radians().tan();
    let short = measured::SHORT_FACE[usize::from(few)] * shortness;
    if short > bound.stiffness {
        bound.stiffness = (10.0 * short).ceil() / 10.0;
        notes += measured::SHORT_FACE_BASIS;
    }
    let relief_um = tip_relief_um(design);
    // Without a contact analysis (a sweep) the load is unknown, and the error of light loads applies.
    let deflection_um = mesh.map_or(0.0, |mesh| mesh.force_n / mesh.stiffness_mean_n_per_um);
    let lightly_loaded = relief_um > LIGHT_LOAD * deflection_um;
    let relief = if lightly_loaded { measured::LIGHTLY_LOADED_HARMONIC } else { measured::RELIEVED_HARMONIC };
    let relieved = (relief_um > 0.0).then_some(relief);
    for (harmonic, note) in
        [(few && helix_deg > 0.0).then_some(measured::FEW_TEETH_HARMONIC), relieved].into_iter().flatten()
    {
        if harmonic > bound.harmonic {
            bound.harmonic = harmonic;
            notes += note;
        }
    }
    model_error(bound, &notes)
}

/// Largest tip relief of any flank.
fn tip_relief_um(design: &DesignInput) -> f64 {
    let gears = [&design.pinion, &design.gear];
    let flanks = gears.into_iter().flat_map(|gear| {
        let both = [Some(&gear.flank), gear.left.as_ref(), gear.right.as_ref()];
        both.into_iter().flatten()
    });
    flanks.map(|flank: &FlankInput| flank.tip_relief.amount_um).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_value;
    use serde_json::{Value, json};

    /// The model error of Table 1's document with changes, at a deflection of `deflection_um`.
    fn model_of(deflection_um: Option<f64>, change: impl FnOnce(&mut Value)) -> ModelError {
        let path = format!("{}/../../examples/table1.json", env!("CARGO_MANIFEST_DIR"));
        let mut value: Value = serde_json::from_slice(&std::fs::read(path).expect("readable")).expect("JSON");
        change(&mut value);
        let mesh =
            deflection_um.map(|um| Mesh { force_n: 1300.0 * um, stiffness_mean_n_per_um: 1300.0, ..Mesh::default() });
        model(&parse_value(&value).expect("valid"), mesh.as_ref())
    }

    fn numbers(error: &ModelError) -> (Option<f64>, Option<f64>) {
        (error.mesh_stiffness_percent, error.transmission_error_harmonic_percent)
    }

    #[test]
    fn each_fidelity_has_its_own() {
        let of = |stiffness: Value| model_of(Some(6.0), |value| value["model"]["mesh_stiffness"] = stiffness);
        let given = of(json!({"source": "given", "mean_n_per_um": 900.0, "harmonics": []}));
        assert!(numbers(&given) == (None, None) && given.basis.contains("given"));
        let [iso, analytic, coarse, medium] = [
            json!({"source": "iso6336"}),
            json!({"source": "ltca"}),
            json!({"source": "ltca", "fidelity": "fe", "elements": "coarse"}),
            json!({"source": "ltca", "fidelity": "fe", "elements": "medium"}),
        ]
        .map(of);
        // Each better than the one before, in harmonics too.
        for (worse, better) in [(&iso, &analytic), (&analytic, &coarse), (&coarse, &medium)] {
            assert!(worse.mesh_stiffness_percent >= better.mesh_stiffness_percent, "{worse:?} {better:?}");
            assert!(worse.transmission_error_harmonic_percent > better.transmission_error_harmonic_percent);
        }
        assert_eq!(numbers(&analytic), (Some(3.0), Some(20.0)));
        // The error of the finite elements is not below the uncertainty of their reference.
        assert!(medium.mesh_stiffness_percent >= Some(1.5) && medium.transmission_error_harmonic_percent >= Some(3.0));
    }

    #[test]
    fn the_kind_of_pair_decides() {
        let spur = |value: &mut Value| value["design"]["helix_angle_deg"] = json!(0.0);
        let bore = |value: &mut Value| value["model"]["mesh_stiffness"]["body"] = json!("bore");
        assert_eq!(numbers(&model_of(Some(6.0), spur)), (Some(3.0), Some(4.0)));
        assert_eq!(numbers(&model_of(Some(6.0), bore)), (Some(2.0), Some(20.0)));
        let both = |value: &mut Value| {
            spur(value);
            bore(value);
        };
        assert_eq!(numbers(&model_of(Some(6.0), both)), (Some(2.0), Some(4.0)));
        let short = |helix_deg: f64, face_mm: f64| {
            model_of(Some(6.0), |value| {
                value["design"]["helix_angle_deg"] = json!(helix_deg);
                value["design"]["face_width_mm"] = json!(face_mm);
            })
        };
        // The shorter and the steeper, the worse; a spur face has no such error.
        let faces = [(0.0, 3.6), (10.0, 3.6), (20.0, 3.6), (40.0, 6.0), (40.0, 3.6)];
        let errors = faces.map(|(helix, face)| short(helix, face).mesh_stiffness_percent);
        assert!(errors.is_sorted() && errors[0] == Some(3.0) && errors[3] >= Some(19.0), "{errors:?}");
        let few = model_of(Some(6.0), |value| value["design"]["pinion"]["teeth"] = json!(16));
        assert_eq!(few.transmission_error_harmonic_percent, Some(35.0));
        assert!(short(20.0, 6.0).mesh_stiffness_percent >= Some(7.3) && short(20.0, 6.0).basis.contains("short faces"));
        assert_eq!(short(20.0, 60.0).mesh_stiffness_percent, Some(3.0));
    }

    /// On either gear, and on either half: the relief of one flank is enough.
    #[test]
    fn relief_at_light_load_is_told_apart() {
        for place in ["/design/pinion", "/design/gear"] {
            for half in [None, Some("left"), Some("right")] {
                let relieve = |value: &mut Value| {
                    let gear = value.pointer_mut(place).expect("a gear");
                    let relief = json!({"amount_um": 15.0, "length_mm": 6.0});
                    match half {
                        None => gear["tip_relief"] = relief,
                        Some(half) => gear[half] = json!({"tip_relief": relief}),
                    }
                };
                let at = |deflection_um| model_of(deflection_um, relieve).transmission_error_harmonic_percent;
                // Covered by the bound of all helical pairs.
                assert_eq!((at(Some(13.0)), at(Some(5.4))), (Some(20.0), Some(20.0)), "{place} {half:?}");
                assert_eq!((at(Some(1.1)), at(None)), (Some(23.0), Some(23.0)), "{place} {half:?}");
            }
        }
    }
}
