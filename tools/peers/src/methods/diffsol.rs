//! The crate `diffsol`: its explicit method (Tsitouras 5(4)) and its backward differentiation formulae.

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason, Vector};

use super::{Method, Origin, RunResult, ladder, straight_or_restarted};
use crate::case::{PhysicalState, ReferenceCase};
use crate::equations::{ScaledEquations, Y};

#[derive(Clone, Copy, PartialEq)]
enum DiffsolMethod {
    Tsitouras,
    Bdf,
}

struct Diffsol {
    kind: DiffsolMethod,
    restart: bool,
}

pub fn all() -> Vec<Box<dyn Method>> {
    [DiffsolMethod::Tsitouras, DiffsolMethod::Bdf]
        .into_iter()
        .flat_map(|kind| [false, true].map(|restart| Box::new(Diffsol { kind, restart }) as _))
        .collect()
}

fn array(slice: &[f64]) -> &Y {
    slice.try_into().expect("24 states")
}

/// Integrates to each of `ends` in turn.
fn follow<'a, E, S>(equations: &ScaledEquations, mut solver: S, ends: &[f64]) -> Result<PhysicalState, String>
where
    E: OdeEquations<T = f64> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    for &end in ends {
        solver.set_stop_time(end).map_err(|e| e.to_string())?;
        while !matches!(solver.step().map_err(|e| e.to_string())?, OdeSolverStopReason::TstopReached) {}
    }
    Ok(equations.physical(&solver.state().y.clone_as_vec()))
}

impl Method for Diffsol {
    fn name(&self) -> String {
        let kind = match self.kind {
            DiffsolMethod::Tsitouras => "TSIT45",
            DiffsolMethod::Bdf => "BDF",
        };
        straight_or_restarted(&format!("diffsol {kind}"), self.restart)
    }

    fn origin(&self) -> Origin {
        Origin::Peer
    }

    fn tolerances(&self) -> Vec<f64> {
        match self.kind {
            DiffsolMethod::Tsitouras => ladder(3, 10),
            DiffsolMethod::Bdf => ladder(3, 9),
        }
    }

    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String> {
        let equations = ScaledEquations::new(case);
        let ends: Vec<f64> = if self.restart { equations.edges(periods).collect() } else { vec![periods as f64] };
        let start = equations.scaled(&case.start);
        let problem = OdeBuilder::<NalgebraMat<f64>>::new()
            .rtol(tolerance)
            .atol([tolerance])
            .rhs_implicit(
                |y, _, t, dy| equations.derivative(t, array(y), dy.try_into().expect("24 states")),
                |y, _, t, d, out| equations.jacobian_product(t, array(y), array(d), out.try_into().expect("24 states")),
            )
            .init(|_, _, y| y.copy_from_slice(&start), 24)
            .build()
            .map_err(|e| e.to_string())?;
        let state = match self.kind {
            DiffsolMethod::Tsitouras => follow(&equations, problem.tsit45().map_err(|e| e.to_string())?, &ends),
            DiffsolMethod::Bdf => {
                follow(&equations, problem.bdf::<NalgebraLU<f64>>().map_err(|e| e.to_string())?, &ends)
            }
        };
        state.map(RunResult::from)
    }
}
