//! The methods of herringbone.

use herringbone_physics::dynamics::{Integrator, Parameters, advance, advance_many};
use herringbone_physics::watch::Watch;

use super::{Method, Origin, RunResult, ladder};
use crate::case::ReferenceCase;

/// Integration of one motion.
struct SingleMethod {
    integrator: Integrator,
    /// Integrates both halves although they are equal: the mesh damping of the right one is larger by one unit in the
    /// last place, so that the pair is not symmetric.
    both_halves: bool,
}

/// Operating points in vector lanes: the case, and the same at speeds higher by one, two … per cent.
struct LaneMethod {
    points: usize,
}

pub fn all() -> Vec<Box<dyn Method>> {
    let mut out: Vec<Box<dyn Method>> = vec![Box::new(LaneMethod { points: 8 })];
    for (integrator, both_halves) in
        [(Integrator::Taylor, false), (Integrator::Taylor, true), (Integrator::RungeKutta, false)]
    {
        out.push(Box::new(SingleMethod { integrator, both_halves }));
    }
    out
}

impl Method for LaneMethod {
    fn name(&self) -> String {
        format!("herringbone Taylor, {} in lanes", self.points)
    }

    fn origin(&self) -> Origin {
        Origin::Own
    }

    fn tolerances(&self) -> Vec<f64> {
        ladder(3, 14)
    }

    fn points(&self) -> usize {
        self.points
    }

    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String> {
        let p = case.parameters();
        let faster = |i: usize| p.mesh_frequency_hz * (1.0 + 0.01 * i as f64);
        let points: Vec<Parameters> =
            (0..self.points).map(|i| Parameters { mesh_frequency_hz: faster(i), ..p.clone() }).collect();
        let starts = vec![case.start; self.points];
        let mut ends =
            advance_many(&points, &starts, periods, tolerance, &Watch::none()).map_err(|e| e.to_string())?.into_iter();
        let first = ends.next().ok_or("no points")?.map_err(|e| e.to_string())?;
        for other in ends {
            other.map_err(|e| e.to_string())?;
        }
        Ok(first.state.into())
    }
}

impl Method for SingleMethod {
    fn name(&self) -> String {
        let method = match self.integrator {
            Integrator::Taylor => "Taylor",
            Integrator::RungeKutta => "Runge–Kutta 4(5)",
        };
        format!("herringbone {method}{}", if self.both_halves { ", 12 coordinates" } else { "" })
    }

    fn origin(&self) -> Origin {
        Origin::Own
    }

    fn tolerances(&self) -> Vec<f64> {
        match self.integrator {
            Integrator::Taylor => ladder(3, 14),
            Integrator::RungeKutta => ladder(3, 11),
        }
    }

    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String> {
        let mut p = case.parameters();
        if self.both_halves {
            let damping = &mut p.halves[1].mesh_damping_n_s_per_m;
            *damping = damping.next_up();
        }
        let ends = advance(&p, &case.start, periods, self.integrator, tolerance, &Watch::none());
        ends.map(|r| r.state.into()).map_err(|e| e.to_string())
    }
}
