//! Measured order of convergence of each method.

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::watch::Watch;
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::check;

/// Case A without impact: smooth, contact kept.
fn smooth() -> DynamicModel<6> {
    let mut p = parameters("A");
    p.halves.iter_mut().for_each(|h| h.impact = None);
    DynamicModel::new(&p).unwrap()
}

fn start(model: &DynamicModel<6>) -> MotionState<6> {
    let modes = NaturalModes::new(&parameters("A")).unwrap();
    let mut at_rest = [0.0; 24];
    at_rest[..12].copy_from_slice(&modes.static_deflection(&parameters("A")));
    model.state_from(&at_rest)
}

/// Case C from the reference's start: loss of contact, contact again, and both edges of the impact.
fn switching() -> (DynamicModel<6>, MotionState<6>) {
    let model = DynamicModel::new(&parameters("C")).unwrap();
    let state = model.state_from(reference().cases["C"].initial_state.as_slice().try_into().unwrap());
    (model, state)
}

fn end(mut motion: Motion<'_, 6>) -> (MotionState<6>, bool) {
    for _ in 0..3 {
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
    }
    (motion.state, motion.contact_changed)
}

/// Slope of log error over log step, by least squares over the numbers of steps per mesh period; and whether contact
/// changed.
fn order(
    model: &DynamicModel<6>,
    start: MotionState<6>,
    with: impl Fn(Motion<'_, 6>, f64) -> Motion<'_, 6>,
    steps: &[u32],
) -> (f64, bool) {
    let motion = |tolerance| Motion::new(model, start, Integrator::Taylor, tolerance, u64::MAX);
    let (exact, changed) = end(motion(1e-15));
    let points: Vec<[f64; 2]> = steps
        .iter()
        .map(|&per_period| {
            let h = model.period_tau / f64::from(per_period);
            let d = state_difference(&end(with(motion(1.0), h)).0, &exact);
            [h.ln(), d.0.iter().chain(&d.1).fold(0.0f64, |m, c| m.max(c.abs())).ln()]
        })
        .collect();
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p[0]), mean(&|p| p[1]));
    (mean(&|p| (p[0] - x) * (p[1] - y)) / mean(&|p| (p[0] - x).powi(2)), changed)
}

const TOPIC: &str = "Dynamics: order of convergence";

#[test]
fn runge_kutta_is_of_fourth_order() {
    let model = smooth();
    let (p, changed) = order(&model, start(&model), |m, h| m.with_fixed_runge_kutta(h), &[100, 200]);
    assert!(!changed);
    check(TOPIC, "Runge–Kutta", p, 4.0, Absolute(0.3));
}

#[test]
fn taylor_has_the_order_it_says() {
    // Displacements have the power n of the step, velocities n − 1: the order of the method is n − 1.
    let model = smooth();
    for (n, steps) in [(6, [40, 80]), (10, [30, 60]), (14, [24, 36])] {
        let (p, changed) = order(&model, start(&model), |m, h| m.with_fixed_taylor(n, h), &steps);
        assert!(!changed);
        check(TOPIC, &format!("Taylor series of degree {n}"), p, n as f64 - 1.0, Absolute(0.3));
    }
}

/// 48 numbers of steps per mesh period from `first` to about `last`, in equal ratios: the position of contact changes
/// within a step is random, which many step lengths average.
fn many(first: f64, last: f64) -> Vec<u32> {
    (0..48).map(|i| (first * (last / first).powf(f64::from(i) / 47.0)) as u32).collect()
}

/// Changes of contact are located and the series restarted there, without a loss of order.
#[test]
fn taylor_keeps_its_order_over_changes_of_contact() {
    let (model, start) = switching();
    for (n, [first, last]) in [(6, [40.0, 240.0]), (10, [20.0, 100.0]), (14, [12.0, 36.0])] {
        let (p, changed) = order(&model, start, |m, h| m.with_fixed_taylor(n, h), &many(first, last));
        assert!(changed);
        let quantity = format!("Taylor series of degree {n}, over changes of contact");
        check(TOPIC, &quantity, p, n as f64 - 1.0, Absolute(0.5));
    }
}

/// Changes of contact are not located: the force has a kink within a step, so the local error there, and with it the
/// error of the whole, is of second order in the step.
#[test]
fn runge_kutta_loses_its_order_over_changes_of_contact() {
    let (model, start) = switching();
    let (p, changed) = order(&model, start, |m, h| m.with_fixed_runge_kutta(h), &many(200.0, 2000.0));
    assert!(changed);
    check(TOPIC, "Runge–Kutta, over changes of contact", p, 2.0, Absolute(0.4));
}

/// Work over twenty periods of the reference cases, six coordinates: steps, rejected steps, evaluations of the mesh
/// forces. Any change of efficiency fails here. `HERRINGBONE_SNAPSHOT=1 cargo test -p herringbone-physics --lib counted
/// -- --nocapture` prints the table as it is now.
const COUNTED: [(&str, Integrator, f64, [u64; 3]); 12] = [
    ("A", Integrator::Taylor, 5e-8, [282, 0, 4706]),
    ("B", Integrator::Taylor, 5e-8, [253, 0, 4117]),
    ("C", Integrator::Taylor, 5e-8, [320, 0, 5354]),
    ("A", Integrator::Taylor, 1e-12, [407, 0, 7713]),
    ("B", Integrator::Taylor, 1e-12, [351, 0, 6541]),
    ("C", Integrator::Taylor, 1e-12, [447, 0, 8415]),
    ("A", Integrator::RungeKutta, 5e-8, [3356, 24, 20256]),
    ("B", Integrator::RungeKutta, 5e-8, [3459, 471, 23109]),
    ("C", Integrator::RungeKutta, 5e-8, [3818, 532, 25568]),
    ("A", Integrator::RungeKutta, 1e-12, [30383, 20, 182398]),
    ("B", Integrator::RungeKutta, 1e-12, [29971, 899, 184321]),
    ("C", Integrator::RungeKutta, 1e-12, [33098, 1025, 203713]),
];

#[test]
fn work_is_as_counted() {
    let print = std::env::var_os("HERRINGBONE_SNAPSHOT").is_some();
    let mut other = Vec::new();
    for (name, integrator, tolerance, expected) in COUNTED {
        let model = DynamicModel::<6>::new(&parameters(name)).unwrap();
        let state = model.state_from(reference().cases[name].initial_state.as_slice().try_into().unwrap());
        let mut motion = Motion::new(&model, state, integrator, tolerance, u64::MAX);
        for _ in 0..20 {
            motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        }
        let StepCounts { steps, rejected_steps, force_evaluations } = motion.counts;
        let found = [steps, rejected_steps, force_evaluations];
        if print {
            println!("    ({name:?}, Integrator::{integrator:?}, {tolerance:e}, {found:?}),");
        } else if found != expected {
            other.push(format!("{name}, {integrator:?}, {tolerance:e}: {found:?} instead of {expected:?}"));
        }
    }
    assert!(other.is_empty(), "{}", other.join("\n"));
}
