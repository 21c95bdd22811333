//! The rungs: every way to the mesh stiffness, on every case, with its times and errors.

use std::collections::hash_map::{DefaultHasher, Entry, HashMap};
use std::hash::{Hash, Hasher};
use std::path::Path;

use herringbone_physics::compliance::{Compliance, Settings};
use herringbone_physics::contact::{HalfCycle, harmonics, solve_half};
use herringbone_physics::fe::{FlankFlexibility, FlankFlexibilityInput, Resolution};
use herringbone_physics::gear::Half;
use herringbone_physics::iso6336::{Blank, MethodB, course};
use herringbone_physics::watch::Watch;

use crate::cases::{Case, Reference};
use herringbone_tools::Failure;
use herringbone_tools::stopwatch::{Stopwatch, median_time};

/// A way to the stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rung {
    Iso6336,
    /// Number among [`ANALYTIC`].
    Analytic(usize),
    Elements(Resolution),
}

/// Analytic rungs: name, slices, positions, accuracy of chosen positions.
pub(crate) const ANALYTIC: [(&str, Option<usize>, Option<usize>, f64); 5] = [
    ("analytic, 12 slices, 16 positions", Some(12), Some(16), 2e-3),
    ("analytic, 24 slices, accuracy 1 %", Some(24), None, 1e-2),
    ("analytic, default slices, 64 positions", None, Some(64), 2e-3),
    ("analytic, default slices, accuracy 0.2 % (default)", None, None, 2e-3),
    ("analytic, 120 slices, accuracy 0.02 %", Some(120), None, 2e-4),
];

pub(crate) const ELEMENTS: [Resolution; 3] = [Resolution::Coarse, Resolution::Medium, Resolution::Standard];

/// Every rung in the order of the tables.
pub(crate) fn all() -> impl Iterator<Item = Rung> {
    std::iter::once(Rung::Iso6336).chain((0..ANALYTIC.len()).map(Rung::Analytic)).chain(ELEMENTS.map(Rung::Elements))
}

impl Rung {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Rung::Iso6336 => "ISO 6336-1 method B",
            Rung::Analytic(i) => ANALYTIC[i].0,
            Rung::Elements(Resolution::Coarse) => "fe coarse",
            Rung::Elements(Resolution::Medium) => "fe medium",
            Rung::Elements(Resolution::Standard) => "fe standard",
            Rung::Elements(Resolution::Fine) => "fe fine",
        }
    }
}

/// Times and errors of one rung on one case.
pub(crate) struct Answer {
    pub rung: Rung,
    /// Number of the case.
    pub case: usize,
    /// Computing time of one half without and with a stored compliance of the teeth (with finite elements: of both
    /// gears).
    pub cold_s: f64,
    pub stored_s: f64,
    /// Errors relative to the reference.
    pub tangent: f64,
    pub secant: f64,
    pub first_harmonic: f64,
    /// Largest difference of the load shares; not a number where the rung has none.
    pub share: f64,
}

/// Finite elements of both gears, with the time they took where they were solved.
type Solved = ([FlankFlexibility; 2], f64);

/// Times and errors of all rungs on all cases.
pub(crate) fn answers(cases: &[Case], keep: Option<&Path>) -> Result<Vec<Answer>, Failure> {
    let mut elements: HashMap<String, Solved> = HashMap::new();
    let mut answers = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        eprintln!("{}, {}, {:?}", case.teeth, case.variant, case.hold);
        let own = match &case.published {
            Some(_) => None,
            None => Some(reference(case, &mut elements, keep)?),
        };
        let reference = case.published.as_ref().or(own.as_ref()).expect("one of them");
        answers.push(iso6336(number, case, reference)?);
        for (i, &(_, slices, positions, accuracy)) in ANALYTIC.iter().enumerate() {
            let settings = Settings { slices, positions, accuracy, ..settings(case) };
            let (cycle, cold_s) =
                median_time(5, || solve(case, &settings, &Compliance::analytic(&case.pair, &settings, Watch::none())?));
            let compliance = Compliance::analytic(&case.pair, &settings, Watch::none())?;
            let (_, stored_s) = median_time(5, || solve(case, &settings, &compliance));
            answers.push(compare(Rung::Analytic(i), number, [cold_s, stored_s], &cycle?, reference));
        }
        for resolution in ELEMENTS {
            let (flanks, solved_s) = solved(case, resolution, &mut elements, None)?;
            let settings = settings(case);
            let (cycle, stored_s) = median_time(5, || {
                solve(
                    case,
                    &settings,
                    &Compliance::finite_elements(&case.pair, &settings, [&flanks[0], &flanks[1]], Watch::none())?,
                )
            });
            answers.push(compare(
                Rung::Elements(resolution),
                number,
                [solved_s + stored_s, stored_s],
                &cycle?,
                reference,
            ));
        }
    }
    Ok(answers)
}

pub(crate) fn settings(case: &Case) -> Settings {
    Settings { body: case.hold, corner_contact: case.corner_contact, ..Settings::default() }
}

pub(crate) fn force_bt_n(case: &Case) -> f64 {
    case.torque_nm / case.pair.pinion.base_radius_m
}

pub(crate) fn solve(
    case: &Case,
    settings: &Settings,
    compliance: &Compliance,
) -> Result<HalfCycle, herringbone_physics::contact::ContactError> {
    solve_half(&case.pair, Half::Left, force_bt_n(case), compliance, settings, Watch::none())
}

/// Reference by fine finite elements at 128 positions, with the default slices: the separation of a segment's
/// half-space from its neighbours' is less accurate for segments as short as the width of the contact band. The tangent
/// stiffness is the difference quotient over 2 % of load.
fn reference(case: &Case, elements: &mut HashMap<String, Solved>, keep: Option<&Path>) -> Result<Reference, Failure> {
    let (flanks, _) = solved(case, Resolution::Fine, elements, keep)?;
    let settings = Settings { positions: Some(128), ..settings(case) };
    let compliance = Compliance::finite_elements(&case.pair, &settings, [&flanks[0], &flanks[1]], Watch::none())?;
    let at = |part: f64| solve(&Case { torque_nm: part * case.torque_nm, ..case.clone() }, &settings, &compliance);
    let [below, cycle, above] = [at(0.99)?, at(1.0)?, at(1.01)?];
    let steps = above.transmission_error_m.iter().zip(&below.transmission_error_m).map(|(a, b)| a - b);
    let tangents = steps.map(|step| 0.02 * force_bt_n(case) / step);
    let end = case.pair.total_contact_ratio();
    let places = (1..).map(|i| 0.25 * f64::from(i)).take_while(|p| *p < end - 0.05);
    Ok(Reference {
        tangent_n_per_m: tangents.sum::<f64>() / cycle.transmission_error_m.len() as f64,
        secant_n_per_m: cycle.secant_stiffness.mean,
        first_harmonic_m: cycle.transmission_error_harmonics_m[0],
        shares: [0.05, 0.1].into_iter().chain(places).map(|p| (p, share_at(&cycle, p))).collect(),
    })
}

/// Finite elements of both gears, solved once; with corner contact, so that all variants share them.
fn solved<'a>(
    case: &Case,
    resolution: Resolution,
    elements: &'a mut HashMap<String, Solved>,
    keep: Option<&Path>,
) -> Result<&'a Solved, Failure> {
    let settings = Settings { corner_contact: true, ..settings(case) };
    let inputs = Compliance::finite_element_inputs(&case.pair, &settings, resolution);
    match elements.entry(serde_json::to_string(&inputs.each_ref().map(FlankFlexibilityInput::key))?) {
        Entry::Occupied(found) => Ok(found.into_mut()),
        Entry::Vacant(vacant) => {
            let watch = Stopwatch::start();
            let [pinion, gear] = inputs.each_ref().map(|input| flank(input, keep));
            let solved = ([pinion?, gear?], watch.seconds());
            eprintln!("  {resolution:?}: {:.2} s", solved.1);
            Ok(vacant.insert(solved))
        }
    }
}

/// One gear, from the folder if it is there.
fn flank(input: &FlankFlexibilityInput, keep: Option<&Path>) -> Result<FlankFlexibility, Failure> {
    let Some(folder) = keep else { return Ok(FlankFlexibility::new(input, Watch::none())?) };
    let mut hasher = DefaultHasher::new();
    serde_json::to_string(input.key())?.hash(&mut hasher);
    let path = folder.join(format!("{:016x}", hasher.finish()));
    if let Ok(bytes) = std::fs::read(&path) {
        return Ok(FlankFlexibility::from_bytes(&bytes)?);
    }
    let flank = FlankFlexibility::new(input, Watch::none())?;
    std::fs::create_dir_all(folder)?;
    std::fs::write(path, flank.to_bytes())?;
    Ok(flank)
}

/// ISO 6336-1 method B with its stiffness over the mesh period; it considers neither modifications nor the fixed
/// surface.
fn iso6336(number: usize, case: &Case, reference: &Reference) -> Result<Answer, Failure> {
    const POSITIONS: usize = 64;
    let pair = &case.pair;
    let reference_radius = 0.5 * f64::from(pair.pinion.teeth) * pair.transverse_module_m;
    let method = || MethodB::new(pair, &Blank::Solid, case.torque_nm / reference_radius);
    let (method, time_s) = median_time(5, method);
    let mean = method?.mean_n_per_m(pair);
    let error: Vec<f64> = (0..POSITIONS)
        .map(|i| {
            let x0 = pair.path_start_m + pair.base_pitch_m * i as f64 / POSITIONS as f64;
            force_bt_n(case) / (mean * course(pair, x0))
        })
        .collect();
    Ok(Answer {
        rung: Rung::Iso6336,
        case: number,
        cold_s: time_s,
        stored_s: time_s,
        tangent: mean / reference.tangent_n_per_m - 1.0,
        secant: mean / reference.secant_n_per_m - 1.0,
        first_harmonic: harmonics(&error)[0] / reference.first_harmonic_m - 1.0,
        share: f64::NAN,
    })
}

fn compare(rung: Rung, case: usize, [cold_s, stored_s]: [f64; 2], cycle: &HalfCycle, reference: &Reference) -> Answer {
    let differences = reference.shares.iter().map(|&(at, share)| share_at(cycle, at) - share);
    Answer {
        rung,
        case,
        cold_s,
        stored_s,
        tangent: cycle.stiffness.mean / reference.tangent_n_per_m - 1.0,
        secant: cycle.secant_stiffness.mean / reference.secant_n_per_m - 1.0,
        first_harmonic: cycle.transmission_error_harmonics_m[0] / reference.first_harmonic_m - 1.0,
        share: differences.fold(0.0, |worst: f64, d| if d.abs() > worst.abs() { d } else { worst }),
    }
}

/// Part of the force on a pair, between the solved positions.
fn share_at(cycle: &HalfCycle, at: f64) -> f64 {
    let (path, share) = (&cycle.load_share_phase, &cycle.load_share);
    let i = path.partition_point(|&p| p <= at).clamp(1, path.len() - 1);
    let t = ((at - path[i - 1]) / (path[i] - path[i - 1])).clamp(0.0, 1.0);
    share[i - 1] + t * (share[i] - share[i - 1])
}
