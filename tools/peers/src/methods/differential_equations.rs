//! The crate `differential-equations`: DOP853, Dormand and Prince's 5(4) and Verner's pairs.

use differential_equations::control::ControlFlag;
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ExplicitRungeKutta;
use differential_equations::ode::{ODE, OrdinaryNumericalMethod, solve_ode};
use differential_equations::solout::Solout;
use differential_equations::solution::Solution;

use super::{Method, Origin, RunResult, ladder, straight_or_restarted};
use crate::case::{PhysicalState, ReferenceCase};
use crate::equations::{ScaledEquations, Y};

#[derive(Clone, Copy, PartialEq)]
enum Pair {
    Dop853,
    Dopri5,
    Verner6,
    Verner7,
    Verner8,
    Verner9,
}

struct DifferentialEquations {
    pair: Pair,
    restart: bool,
}

pub fn all() -> Vec<Box<dyn Method>> {
    let pairs = [Pair::Dop853, Pair::Dopri5, Pair::Verner6, Pair::Verner7, Pair::Verner8, Pair::Verner9];
    pairs
        .into_iter()
        .flat_map(|pair| [false, true].map(|restart| Box::new(DifferentialEquations { pair, restart }) as _))
        .collect()
}

struct Rhs<'a>(&'a ScaledEquations);

impl ODE<f64, Y> for Rhs<'_> {
    fn diff(&self, t: f64, y: &Y, dy: &mut Y) {
        self.0.derivative(t, y, dy);
    }
}

/// No output: the last state is that of the solver.
struct Nothing;

impl Solout<f64, Y> for Nothing {
    fn solout<I>(&mut self, _: f64, _: f64, _: &Y, _: &Y, _: &mut I, _: &mut Solution<f64, Y>) -> ControlFlag<f64, Y>
    where
        I: Interpolation<f64, Y> + ?Sized,
    {
        ControlFlag::Continue
    }
}

fn follow<S>(
    equations: &ScaledEquations,
    start: &PhysicalState,
    ends: &[f64],
    make: impl Fn(f64) -> S,
) -> Result<PhysicalState, String>
where
    S: OrdinaryNumericalMethod<f64, Y> + Interpolation<f64, Y>,
{
    let mut y = equations.scaled(start);
    let (mut from, mut h) = (0.0, 0.0);
    for &end in ends {
        let mut solver = make(f64::min(h, end - from));
        solve_ode(&mut solver, &Rhs(equations), from, end, &y, &mut Nothing).map_err(|e| format!("{e:?}"))?;
        y = *solver.y();
        // The next step of the solver; the last one was shortened by the end.
        h = solver.h().max(solver.t() - solver.t_prev());
        from = end;
    }
    Ok(equations.physical(&y))
}

impl Method for DifferentialEquations {
    fn name(&self) -> String {
        let pair = match self.pair {
            Pair::Dop853 => "DOP853",
            Pair::Dopri5 => "DOPRI5",
            Pair::Verner6 => "Verner 6(5)",
            Pair::Verner7 => "Verner 7(6)",
            Pair::Verner8 => "Verner 8(7)",
            Pair::Verner9 => "Verner 9(8)",
        };
        straight_or_restarted(&format!("differential-equations {pair}"), self.restart)
    }

    fn origin(&self) -> Origin {
        Origin::Peer
    }

    fn tolerances(&self) -> Vec<f64> {
        ladder(3, 12)
    }

    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String> {
        let equations = ScaledEquations::new(case);
        let ends: Vec<f64> = if self.restart { equations.edges(periods).collect() } else { vec![periods as f64] };
        macro_rules! run {
            ($method:ident) => {
                follow(&equations, &case.start, &ends, |h0| {
                    ExplicitRungeKutta::$method().rtol(tolerance).atol(tolerance).h0(h0).max_steps(usize::MAX)
                })
            };
        }
        let state = match self.pair {
            Pair::Dop853 => run!(dop853),
            Pair::Dopri5 => run!(dopri5),
            Pair::Verner6 => run!(rkv655e),
            Pair::Verner7 => run!(rkv766e),
            Pair::Verner8 => run!(rkv877e),
            Pair::Verner9 => run!(rkv988e),
        };
        state.map(RunResult::from)
    }
}
