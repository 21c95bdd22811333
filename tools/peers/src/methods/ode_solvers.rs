//! The crate `ode_solvers`: Dormand and Prince's 5(4), and their 8(5,3) with time as a state.
//!
//! `Dop853` (0.6.2) is wrong for equations that depend on time, as the test below shows: its table of nodes has 0 where
//! the twelfth has to be 1. With time as a 25th state of derivative 1 the nodes do not matter, so it is used in that
//! way.

use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, Dopri5, SVector, System};

use super::{Method, Origin, RunResult, ladder, straight_or_restarted};
use crate::case::ReferenceCase;
use crate::equations::ScaledEquations;

#[derive(Clone, Copy, PartialEq)]
enum Pair {
    Dopri5,
    Dop853,
}

struct OdeSolvers {
    pair: Pair,
    restart: bool,
}

pub fn all() -> Vec<Box<dyn Method>> {
    [Pair::Dopri5, Pair::Dop853]
        .into_iter()
        .flat_map(|pair| [false, true].map(|restart| Box::new(OdeSolvers { pair, restart }) as _))
        .collect()
}

struct Rhs<'a>(&'a ScaledEquations);

impl System<f64, SVector<f64, 24>> for Rhs<'_> {
    fn system(&self, t: f64, y: &SVector<f64, 24>, dy: &mut SVector<f64, 24>) {
        self.0.derivative(t, &y.data.0[0], &mut dy.data.0[0]);
    }
}

/// The last state is time.
struct WithTime<'a>(&'a ScaledEquations);

impl System<f64, SVector<f64, 25>> for WithTime<'_> {
    fn system(&self, _: f64, y: &SVector<f64, 25>, dy: &mut SVector<f64, 25>) {
        if let (Some((y, &[t])), Some((dy, [dt]))) =
            (y.data.0[0].split_first_chunk(), dy.data.0[0].split_first_chunk_mut())
        {
            self.0.derivative(t, y, dy);
            *dt = 1.0;
        }
    }
}

/// Integrates to each of `ends` with the defaults of a solver except for the first step, which is the last one before
/// the restart. Sparse output: each step once, none interpolated. (A macro, because the solvers share no trait.)
macro_rules! follow {
    ($solver:ident, $rhs:expr, $y:expr, $ends:expr, $tolerance:expr, [$beta:expr, $least:expr, $most:expr]) => {{
        let (mut y, mut from, mut h) = ($y, 0.0, 0.0);
        for &end in $ends {
            let span = end - from;
            let first = f64::min(h, span);
            let mut solver = $solver::from_param(
                $rhs,
                from,
                end,
                span,
                y,
                $tolerance,
                $tolerance,
                0.9,
                $beta,
                $least,
                $most,
                span,
                first,
                u32::MAX,
                1000,
                OutputType::Sparse,
            );
            solver.integrate().map_err(|e| e.to_string())?;
            y = *solver.y_out().last().ok_or("no output")?;
            // The last step was shortened by the end.
            h = solver.x_out().windows(2).rev().take(2).map(|t| t[1] - t[0]).fold(0.0, f64::max);
            from = end;
        }
        y
    }};
}

impl Method for OdeSolvers {
    fn name(&self) -> String {
        let name = match self.pair {
            Pair::Dopri5 => "ode_solvers Dopri5",
            Pair::Dop853 => "ode_solvers Dop853 (time as a state)",
        };
        straight_or_restarted(name, self.restart)
    }

    fn origin(&self) -> Origin {
        Origin::Peer
    }

    fn tolerances(&self) -> Vec<f64> {
        ladder(3, 11)
    }

    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String> {
        let equations = ScaledEquations::new(case);
        let ends: Vec<f64> = if self.restart { equations.edges(periods).collect() } else { vec![periods as f64] };
        let start = SVector::from(equations.scaled(&case.start));
        let state = match self.pair {
            Pair::Dopri5 => {
                let y = follow!(Dopri5, Rhs(&equations), start, &ends, tolerance, [0.04, 0.2, 10.0]);
                equations.physical(y.as_slice())
            }
            Pair::Dop853 => {
                let start = start.push(0.0);
                let y = follow!(Dop853, WithTime(&equations), start, &ends, tolerance, [0.0, 0.333, 6.0]);
                equations.physical(y.as_slice())
            }
        };
        Ok(state.into())
    }
}

#[cfg(test)]
mod tests {
    use ode_solvers::dop_shared::OutputType;
    use ode_solvers::{Dop853, Dopri5, SVector, System};

    /// y' = cos t − y from 0: y = (cos t + sin t − exp(−t))/2.
    struct Driven;

    impl System<f64, SVector<f64, 1>> for Driven {
        fn system(&self, t: f64, y: &SVector<f64, 1>, dy: &mut SVector<f64, 1>) {
            dy[0] = t.cos() - y[0];
        }
    }

    /// The reason for time as a state; when this fails, `Dop853` may be used as `Dopri5` is.
    #[test]
    fn dop853_is_wrong_when_time_matters() {
        let (start, tolerance) = (SVector::<f64, 1>::zeros(), 1e-10);
        let error = |y: &[SVector<f64, 1>]| {
            let exact = 0.5 * (2f64.cos() + 2f64.sin() - (-2f64).exp());
            (y.last().expect("output")[0] - exact).abs()
        };
        let mut dopri5 = Dopri5::new(Driven, 0.0, 2.0, 2.0, start, tolerance, tolerance);
        dopri5.set_output(OutputType::Sparse);
        dopri5.integrate().expect("it ends");
        assert!(error(dopri5.y_out()) < 1e-8, "{:e}", error(dopri5.y_out()));
        let mut dop853 = Dop853::new(Driven, 0.0, 2.0, 2.0, start, tolerance, tolerance);
        dop853.set_output(OutputType::Sparse);
        let ended = dop853.integrate().is_ok();
        assert!(!ended || error(dop853.y_out()) > 1e-6, "{:e}", error(dop853.y_out()));
        println!("Dop853: ended {ended}, error {:e}", error(dop853.y_out()));
    }
}
