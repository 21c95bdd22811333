//! Measured order of convergence of each method.

use super::reference::parameters;
use crate::dynamics::*;
use crate::oracle::Tolerance::Absolute;
use crate::oracle::check;
use crate::watch::Watch;

/// Case A without impact: smooth, contact kept.
fn smooth() -> Model<6> {
    let mut p = parameters("A");
    p.halves.iter_mut().for_each(|h| h.impact = None);
    Model::new(&p).unwrap()
}

fn start(model: &Model<6>) -> State<6> {
    let modes = NaturalModes::new(&parameters("A")).unwrap();
    let mut at_rest = [0.0; 24];
    at_rest[..12].copy_from_slice(&modes.static_deflection(&parameters("A")));
    model.state_from(&at_rest)
}

fn end(mut motion: Motion<'_, 6>) -> State<6> {
    for _ in 0..3 {
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
    }
    motion.state
}

/// Slope of log error over log step between two steps.
fn order(model: &Model<6>, with: impl Fn(Motion<'_, 6>, f64) -> Motion<'_, 6>, steps: [u32; 2]) -> f64 {
    let motion = |tolerance| Motion::new(model, start(model), Integrator::Taylor, tolerance, u64::MAX);
    let exact = end(motion(1e-15));
    let error = |per_period: u32| {
        let d = difference(&end(with(motion(1.0), model.period_tau / f64::from(per_period))), &exact);
        d.0.iter().chain(&d.1).fold(0.0f64, |m, c| m.max(c.abs()))
    };
    (error(steps[0]) / error(steps[1])).ln() / (f64::from(steps[1]) / f64::from(steps[0])).ln()
}

#[test]
fn runge_kutta_is_of_fourth_order() {
    let p = order(&smooth(), |m, h| m.with_fixed_runge_kutta(h), [100, 200]);
    check("Dynamics: order of convergence", "Runge–Kutta", p, 4.0, Absolute(0.3));
}

#[test]
fn taylor_has_the_order_it_says() {
    // Displacements are carried to the power n of the step, velocities to n − 1: the method's order is n − 1.
    for (n, steps) in [(6, [40, 80]), (10, [30, 60]), (14, [24, 36])] {
        let p = order(&smooth(), |m, h| m.with_fixed_taylor(n, h), steps);
        let quantity = format!("Taylor series of degree {n}");
        check("Dynamics: order of convergence", &quantity, p, n as f64 - 1.0, Absolute(0.3));
    }
}

/// Lost efficiency fails here: steps for twenty periods of the reference cases at the tolerance of the default accuracy.
#[test]
fn steps_are_as_counted() {
    for (name, most) in [("A", 300), ("B", 300), ("C", 340)] {
        let model = Model::<6>::new(&parameters(name)).unwrap();
        let case = &super::reference::reference().cases[name];
        let state = model.state_from(case.initial_state.as_slice().try_into().unwrap());
        let mut motion = Motion::new(&model, state, Integrator::Taylor, 5e-8, u64::MAX);
        for _ in 0..20 {
            motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        }
        assert!(motion.numerics.steps <= most, "{name}: {:?}", motion.numerics);
    }
}
