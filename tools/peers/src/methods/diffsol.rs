//! The crate `diffsol`: its explicit method (Tsitouras 5(4)) and its backward differentiation formulae.

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeEquations, OdeSolverMethod, OdeSolverStopReason, Vector};

use super::{Method, Run, Whose, ladder, straight_or_restarted};
use crate::case::{Case, SourceState};
use crate::equations::{Equations, Y};

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Tsitouras,
    Bdf,
}

struct Peer {
    kind: Kind,
    restart: bool,
}

pub fn all() -> Vec<Box<dyn Method>> {
    [Kind::Tsitouras, Kind::Bdf]
        .into_iter()
        .flat_map(|kind| [false, true].map(|restart| Box::new(Peer { kind, restart }) as _))
        .collect()
}

fn array(slice: &[f64]) -> &Y {
    slice.try_into().expect("24 states")
}

/// Steps to each end in turn.
fn follow<'a, E, S>(equations: &Equations, mut solver: S, ends: &[f64]) -> Result<SourceState, String>
where
    E: OdeEquations<T = f64> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    for &end in ends {
        solver.set_stop_time(end).map_err(|e| e.to_string())?;
        while !matches!(solver.step().map_err(|e| e.to_string())?, OdeSolverStopReason::TstopReached) {}
    }
    Ok(equations.source(&solver.state().y.clone_as_vec()))
}

impl Method for Peer {
    fn name(&self) -> String {
        let kind = match self.kind {
            Kind::Tsitouras => "TSIT45",
            Kind::Bdf => "BDF",
        };
        straight_or_restarted(&format!("diffsol {kind}"), self.restart)
    }

    fn whose(&self) -> Whose {
        Whose::Peer
    }

    fn tolerances(&self) -> Vec<f64> {
        match self.kind {
            Kind::Tsitouras => ladder(3, 10),
            Kind::Bdf => ladder(3, 9),
        }
    }

    fn run(&mut self, case: &Case, tolerance: f64, periods: u64) -> Result<Run, String> {
        let equations = Equations::new(case);
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
            Kind::Tsitouras => follow(&equations, problem.tsit45().map_err(|e| e.to_string())?, &ends),
            Kind::Bdf => follow(&equations, problem.bdf::<NalgebraLU<f64>>().map_err(|e| e.to_string())?, &ends),
        };
        state.map(Run::from)
    }
}
