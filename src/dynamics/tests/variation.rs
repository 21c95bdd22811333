//! Deviations: the linear map against differences of motions.

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::oracle::Tolerance::Absolute;
use crate::oracle::{check, check_worst};
use crate::watch::Watch;

fn limits<'a>(watch: &'a Watch<'static>) -> Limits<'a> {
    Limits { tolerance: 1e-13, max_steps: u64::MAX, watch }
}

fn advance<const D: usize>(model: &Model<D>, mut state: State<D>, periods: u64) -> State<D> {
    for j in 0..Model::<D>::HALVES {
        state.contact[j] = model.contact_of(model.s(j, &state.x));
    }
    let mut motion = Motion::new(model, state, Integrator::Taylor, 1e-14, u64::MAX);
    for _ in 0..periods {
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
    }
    motion.state
}

fn check_map<const D: usize>(p: &Parameters, name: &str) {
    let watch = Watch::none();
    let model = Model::<D>::new(p).unwrap();
    let start = model.state_from(reference().cases[name].initial_state.as_slice().try_into().unwrap());
    let start = State { period: 0, ..advance(&model, start, 40) };
    let shooting = Shooting::new(&model, [9e8; 2], limits(&watch)).unwrap();
    let map = shooting.map(&model, start, 2).unwrap();
    let active: Vec<usize> = model.active().collect();
    let n = active.len();
    let mut errors = Vec::new();
    for column in 0..2 * n {
        let step = 1e-11;
        let moved = |sign: f64| {
            let mut s = start;
            if column < n {
                s.x[active[column]] += sign * step;
            } else {
                s.v[active[column - n]] += sign * step;
            }
            advance(&model, s, 2)
        };
        let (plus, minus) = (moved(1.0), moved(-1.0));
        let scale = map.map.column(column).amax();
        for row in 0..2 * n {
            let slope = if row < n {
                plus.x[active[row]] - minus.x[active[row]]
            } else {
                plus.v[active[row - n]] - minus.v[active[row - n]]
            } / (2.0 * step);
            errors.push((slope - map.map[(row, column)]) / scale);
        }
    }
    let gap = if p.damping_in_gap { "" } else { ", no damping in the gap" };
    let quantity = format!("map over two periods against differences, case {name}, {D} coordinates{gap}");
    check_worst("Dynamics: deviations and multipliers", &quantity, errors, 1e-3);
}

#[test]
fn the_map_is_the_derivative_of_the_motion() {
    for name in ["A", "C"] {
        let mut p = parameters(name);
        check_map::<6>(&p, name);
        check_map::<12>(&p, name);
        p.damping_in_gap = false;
        check_map::<6>(&p, name);
    }
}

/// Slowest decay per mesh period from an independent solution of case A: 0.891.
#[test]
fn the_slowest_multiplier_of_case_a() {
    let watch = Watch::none();
    let model = Model::<12>::new(&parameters("A")).unwrap();
    let start = model.state_from(reference().cases["A"].initial_state.as_slice().try_into().unwrap());
    let shooting = Shooting::new(&model, [9e8; 2], limits(&watch)).unwrap();
    let map = shooting.map(&model, start, 1).unwrap();
    let slowest = shooting.multipliers(&map.map)[0].norm();
    let topic = "Dynamics: deviations and multipliers";
    check(topic, "slowest multiplier of case A, twelve coordinates", slowest, 0.891, Absolute(5e-4));
}
