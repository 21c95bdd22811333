//! Properties that hold at any parameters: scaling, mirror images, threads, drift along rigid-body modes, error
//! estimates.

use rayon::prelude::*;

use super::lyapunov::lyapunov_exponent;
use super::*;
use crate::dynamics::tests::reference::{parameters, reference};
use crate::dynamics::{DynamicModel, DynamicsError, Integrator, Motion, Parameters, Spring, Stiffness, Unobserved};
use crate::watch::Watch;
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::{check, check_worst};

const PROPERTIES: &str = "Response: properties";

fn auto(p: &Parameters, accuracy: f64) -> Response {
    let channels = ["s_left", "s_right"].map(|name| ChannelId::parse(name).unwrap()).to_vec();
    let analysis = Analysis { accuracy, channels, samples_per_mesh_period: 0, ..Analysis::default() };
    solve(p, &analysis, &Watch::none()).unwrap()
}

/// The four RMS accelerations: mesh left and right, pinion axial left and right.
fn accelerations(r: &Response) -> [f64; 4] {
    let (m, a) = (r.summary.rms.mesh_circumferential_acceleration_m_s2, r.summary.rms.pinion_axial_acceleration_m_s2);
    [m.left, m.right, a.left, a.right]
}

fn relative(a: [f64; 4], b: [f64; 4]) -> impl Iterator<Item = f64> {
    (0..4).map(move |i| a[i] / b[i] - 1.0)
}

/// A pair without symmetry: staggered halves, one with a stiffer support. (Case C then has a chaotic motion, of which
/// only bit-identical results can be compared.)
fn asymmetric(name: &str) -> Parameters {
    let mut p = parameters(name);
    p.halves[1].phase_shift_mesh_periods = 0.3;
    p.halves[0].gear_axial.stiffness *= 1.2;
    p
}

fn every_spring(p: &mut Parameters, change: impl Fn(&mut Spring)) {
    for h in &mut p.halves {
        [&mut h.pinion_lateral, &mut h.gear_lateral, &mut h.pinion_axial, &mut h.gear_axial]
            .into_iter()
            .for_each(&change);
    }
    let c = &mut p.couplings;
    [&mut c.pinion_axial, &mut c.gear_axial, &mut c.pinion_lateral, &mut c.gear_lateral].into_iter().for_each(&change);
    [&mut c.pinion_torsion, &mut c.gear_torsion].into_iter().for_each(&change);
}

/// Stiffnesses, torques and impacts doubled at √2 of the speed, dampers multiplied by √2: the same path, accelerations
/// doubled.
#[test]
fn doubled_stiffness_and_load_double_the_accelerations() {
    for (name, p) in [("A", parameters("A")), ("C", parameters("C")), ("A, asymmetric", asymmetric("A"))] {
        let root = 2f64.sqrt();
        let mut q = p.clone();
        q.mesh_frequency_hz *= root;
        every_spring(&mut q, |s| (s.stiffness, s.damping) = (s.stiffness * 2.0, s.damping * root));
        for h in &mut q.halves {
            h.pinion_torque_nm *= 2.0;
            h.mesh_damping_n_s_per_m *= root;
            if let Stiffness::Fourier { mean_n_per_m, .. } = &mut h.mesh_stiffness {
                *mean_n_per_m *= 2.0;
            }
            if let Some(crate::dynamics::ImpactExcitation::HalfSine { force_n, .. }) = &mut h.impact {
                *force_n *= 2.0;
            }
        }
        let (a, b) = (auto(&p, 1e-9), auto(&q, 1e-9));
        assert_eq!(a.summary.period_mesh_periods, b.summary.period_mesh_periods, "{name}");
        let quantity = format!("stiffness and load doubled, case {name}: RMS doubled");
        check_worst(PROPERTIES, &quantity, relative(accelerations(&b), accelerations(&a).map(|v| 2.0 * v)), 1e-9);
        let (s, t) = (a.summary.statistics["s_left"], b.summary.statistics["s_left"]);
        let quantity = format!("stiffness and load doubled, case {name}: the same s");
        check_worst(PROPERTIES, &quantity, [(s.min - t.min) / s.max, (s.max - t.max) / s.max], 1e-9);
    }
}

/// Torque and impact reversed: the mirrored motion on the back flanks.
#[test]
fn reversed_torque_mirrors_the_motion() {
    for (name, p) in [("A", parameters("A")), ("C", parameters("C")), ("C, asymmetric", asymmetric("C"))] {
        let mut q = p.clone();
        for h in &mut q.halves {
            h.pinion_torque_nm = -h.pinion_torque_nm;
            if let Some(crate::dynamics::ImpactExcitation::HalfSine { force_n, .. }) = &mut h.impact {
                *force_n = -*force_n;
            }
        }
        let (a, b) = (auto(&p, 1e-9), auto(&q, 1e-9));
        assert_eq!((a.summary.regime, a.summary.contact), (b.summary.regime, b.summary.contact), "{name}");
        let quantity = format!("torque reversed, case {name}: the same RMS");
        check_worst(PROPERTIES, &quantity, relative(accelerations(&b), accelerations(&a)), 1e-12);
        for half in ["s_left", "s_right"] {
            let (s, t) = (a.summary.statistics[half], b.summary.statistics[half]);
            let quantity = format!("torque reversed, case {name}: {half} reversed");
            check_worst(PROPERTIES, &quantity, [(s.min + t.max) / s.max, (s.max + t.min) / s.max], 1e-12);
        }
    }
}

/// The halves exchanged and the helix angle reversed: the results of the halves exchanged.
#[test]
fn mirrored_gears_give_the_mirrored_answer() {
    let p = asymmetric("A");
    let mut q = p.clone();
    q.halves.swap(0, 1);
    q.helix_angle_rad = -q.helix_angle_rad;
    let (a, b) = (auto(&p, 1e-9), auto(&q, 1e-9));
    assert_eq!((a.summary.regime, a.summary.contact), (b.summary.regime, b.summary.contact));
    let [l, r, al, ar] = accelerations(&b);
    let quantity = "halves exchanged, case A asymmetric: RMS exchanged";
    check_worst(PROPERTIES, quantity, relative([r, l, ar, al], accelerations(&a)), 1e-9);
}

/// A negligible difference of the halves makes twelve coordinates of six: the same states at the end of the period of
/// the motion.
#[test]
fn states_of_six_and_twelve_coordinates_agree() {
    for (name, speed) in [("A", 1.0), ("A", 0.7), ("C", 1.0)] {
        let mut p = parameters(name);
        p.mesh_frequency_hz *= speed;
        let mut q = p.clone();
        q.halves[1].gear_mass_kg *= 1.0 + 1e-13;
        let (six, twelve) = (auto(&p, 1e-9), auto(&q, 1e-9));
        assert_eq!((six.summary.degrees_of_freedom, twelve.summary.degrees_of_freedom), (6, 12));
        // Rigid rotations are arbitrary; the others are lengths and velocities of their kind.
        let kept = (0..24).filter(|c| !matches!(c % 6, 2 | 5));
        let scale = |c: usize| {
            let like = if c < 12 { 0..12 } else { 12..24 };
            like.filter(|c| !matches!(c % 6, 2 | 5)).fold(0.0f64, |m, c| m.max(six.final_state[c].abs()))
        };
        let errors = kept.map(|c| (six.final_state[c] - twelve.final_state[c]) / scale(c));
        let quantity = format!("states of six and twelve coordinates, case {name} at {speed} of the speed");
        check_worst(PROPERTIES, &quantity, errors, 1e-8);
    }
}

/// Equal input gives bit-identical results on any thread.
#[test]
fn threads_change_nothing() {
    let cases = || ["A", "C", "B"].map(|name| if name == "C" { asymmetric(name) } else { parameters(name) });
    let solved = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let all: Vec<Response> = pool.install(|| cases().par_iter().map(|p| auto(p, 1e-6)).collect());
        all
    };
    let here: Vec<Response> = cases().iter().map(|p| auto(p, 1e-6)).collect();
    for threads in [1, 2] {
        // Debug output has every digit of a number.
        assert_eq!(format!("{here:?}"), format!("{:?}", solved(threads)), "{threads}");
    }
}

/// Staggered halves set a floating pinion in motion along its screw mode, at a speed that does not decay: the rest is
/// periodic all the same.
#[test]
fn a_drifting_pinion_is_periodic() {
    for (name, stagger) in [("A", 0.25), ("A", 0.5)] {
        let mut p = parameters(name);
        p.halves[1].phase_shift_mesh_periods = stagger;
        let r = auto(&p, 1e-9);
        assert!(r.summary.period_mesh_periods.is_some(), "{name} {stagger}: {:?}", r.summary);
        assert!(r.summary.error_estimate <= 1e-9, "{name} {stagger}: {}", r.summary.error_estimate);
        // From rest the same motion drifts; integrated, it is found to be periodic too.
        let method = SolutionMethod::Integrate { mesh_periods: 1200, record_mesh_periods: 120 };
        let analysis = Analysis { method, accuracy: 1e-9, samples_per_mesh_period: 0, ..Analysis::default() };
        let followed = solve(&p, &analysis, &Watch::none()).unwrap();
        assert_eq!(followed.summary.period_mesh_periods, r.summary.period_mesh_periods, "{name} {stagger}");
        let quantity = format!("case {name}, halves staggered by {stagger}: RMS followed against solved for");
        check_worst(PROPERTIES, &quantity, relative(accelerations(&followed), accelerations(&r)), 1e-8);
    }
}

/// A mesh period that is long against all time constants of the pair: the orbit is found by integration and equals that
/// of a longer one.
#[test]
fn a_slow_speed_is_settled_by_integration() {
    let mut p = parameters("A");
    p.mesh_frequency_hz = 0.8;
    p.halves.iter_mut().for_each(|h| h.mesh_damping_n_s_per_m *= 20.0);
    every_spring(&mut p, |s| s.damping *= 20.0);
    p.damping_in_gap = false;
    let r = auto(&p, 1e-6);
    assert_eq!((r.summary.regime, r.summary.floquet_modulus), (Regime::Period1, None));
    let analysis = Analysis {
        method: SolutionMethod::Integrate { mesh_periods: 3, record_mesh_periods: 1 },
        accuracy: 1e-9,
        samples_per_mesh_period: 0,
        ..Analysis::default()
    };
    let followed = solve(&p, &analysis, &Watch::none()).unwrap();
    let errors: Vec<f64> = relative(accelerations(&followed), accelerations(&r)).collect();
    assert!(errors.iter().all(|e| e.abs() <= r.summary.error_estimate + followed.summary.error_estimate), "{errors:?}");
    check_worst(PROPERTIES, "0.8 mesh periods per second, transients decay within one: RMS", errors, 1e-6);
}

/// Largest Lyapunov exponents of case B per mesh period: symmetric, antisymmetric, and of all twelve coordinates. An
/// independent program states 0.27, 0.475 and 0.37. Averages over 4000 mesh periods of two runs that differ by rounding
/// alone were 0.470 and 0.440 (antisymmetric), 0.264 and 0.369 otherwise: the tolerance is four times that scatter at
/// twice the length.
#[test]
fn exponents_of_the_chaotic_case() {
    fn run<const D: usize>(against: bool, periods: u64) -> f64 {
        let model = DynamicModel::<D>::new(&parameters("B")).unwrap();
        let mut start: [f64; 24] = reference().cases["B"].initial_state.as_slice().try_into().unwrap();
        if D == 12 {
            start[0] += 5e-7;
        }
        let mut motion = Motion::new(&model, model.state_from(&start), Integrator::Taylor, 1e-10, u64::MAX);
        for _ in 0..300 {
            motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        }
        let of = if against { model.antisymmetric() } else { model.clone() };
        lyapunov_exponent(&mut motion, &of, periods, &Watch::none()).unwrap()
    }
    let topic = "Response: regime";
    let of = |what: &str| format!("Lyapunov exponent of case B over 8000 mesh periods, {what}");
    check(topic, &of("within the mirror symmetry"), run::<6>(false, 8000), 0.27, Absolute(0.06));
    check(topic, &of("against it"), run::<6>(true, 8000), 0.475, Absolute(0.06));
    check(topic, &of("all twelve coordinates"), run::<12>(false, 8000), 0.37, Absolute(0.06));
}

/// Motions other than those of the reference: speeds, starts, stagger, samples.
fn variants() -> Vec<(String, Parameters, Option<[f64; 24]>)> {
    let start = |name: &str| -> [f64; 24] { reference().cases[name].initial_state.as_slice().try_into().unwrap() };
    let mut out = Vec::new();
    for (name, speed) in [("A", 0.55), ("A", 1.7), ("C", 0.45), ("C", 1.3)] {
        let mut p = parameters(name);
        p.mesh_frequency_hz *= speed;
        out.push((format!("{name} at {speed} of the speed"), p, Some(start(name))));
    }
    let mut off = start("C");
    (off[0], off[1]) = (off[0] + 5e-7, off[1] + 3e-7);
    out.push(("C started off its symmetry".into(), parameters("C"), Some(off)));
    out.push(("A, asymmetric".into(), asymmetric("A"), None));
    out.push(("C, asymmetric".into(), asymmetric("C"), None));
    let mut sampled = parameters("C");
    for h in &mut sampled.halves {
        let values_n_per_m = (0..64).map(|i| h.mesh_stiffness.at(f64::from(i) / 64.0)).collect();
        h.mesh_stiffness = Stiffness::Samples { values_n_per_m };
    }
    out.push(("C with 64 samples".into(), sampled, Some(start("C"))));
    let mut apart = parameters("C");
    apart.damping_in_gap = false;
    out.push(("C without damping in the gap".into(), apart, Some(start("C"))));
    out
}

/// The estimate is never below the error, nor more than a hundred times above it (above rounding), on motions
/// integrated by either method.
#[test]
fn estimates_hold_off_the_reference_cases() {
    // RMS values of two runs in double precision agree no better than this.
    const FLOOR: f64 = 1e-12;
    let mut wrong = Vec::new();
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for (what, p, initial_state) in variants() {
        let run = |p: &Parameters, integrator, accuracy| {
            let analysis = Analysis {
                method: SolutionMethod::Integrate { mesh_periods: 60, record_mesh_periods: 20 },
                integrator,
                accuracy,
                initial_state,
                samples_per_mesh_period: 0,
                ..Analysis::default()
            };
            solve(p, &analysis, &Watch::none()).unwrap()
        };
        let mut twelve = p.clone();
        twelve.halves[1].gear_mass_kg *= 1.0 + 1e-13;
        let exact = accelerations(&run(&twelve, Integrator::Taylor, 1e-13));
        let methods = [
            (Integrator::Taylor, [1e-3, 1e-5, 1e-7, 1e-9].as_slice()),
            (Integrator::RungeKutta, [1e-2, 1e-3, 1e-4, 1e-6].as_slice()),
        ];
        for (integrator, accuracies) in methods {
            for &accuracy in accuracies {
                let r = run(&p, integrator, accuracy);
                let error = relative(accelerations(&r), exact).fold(0.0f64, |m, e| m.max(e.abs()));
                let estimate = r.summary.error_estimate;
                let line = format!(
                    "{what}, {integrator:?} {accuracy:.0e}: error {error:.1e}, estimate {estimate:.1e}, {:?}",
                    r.summary.regime
                );
                println!("{line}");
                if r.summary.regime == Regime::Chaotic {
                    continue;
                }
                below.push(error / estimate);
                above.push(estimate / error.max(FLOOR));
                if error > estimate.max(FLOOR) || estimate > 100.0 * error.max(FLOOR) {
                    wrong.push(line);
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let topic = "Response: error estimate";
    check_worst(topic, "error over estimate, motions off the reference cases", below, 1.0);
    check_worst(topic, "estimate over error, the same motions", above, 100.0);
}

/// Springs that cannot carry the load are an invalid parameter.
#[test]
fn a_load_beyond_the_springs_is_refused() {
    let mut p = parameters("A");
    p.halves.iter_mut().for_each(|h| h.pinion_lateral.stiffness = 1.0);
    let refused = solve(&p, &Analysis::default(), &Watch::none());
    assert!(matches!(refused, Err(DynamicsError::InvalidParameter { .. })), "{refused:?}");
}

/// No load, no backlash, at rest until the first pulse: the motion starts, and the load adds nothing to the motion of a
/// linear pair.
#[test]
fn an_unloaded_pair_moves_from_the_first_pulse_on() {
    let mut p = parameters("A");
    p.half_backlash_m = 0.0;
    for h in &mut p.halves {
        h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
    }
    let loaded = auto(&p, 1e-9);
    p.halves.iter_mut().for_each(|h| h.pinion_torque_nm = 0.0);
    let unloaded = auto(&p, 1e-9);
    let errors = relative(accelerations(&unloaded), accelerations(&loaded));
    check_worst(PROPERTIES, "constant stiffness, no backlash: RMS without load against RMS with load", errors, 1e-9);
}
