//! This crate.

use herringbone_physics::dynamics::{Integrator, Parameters, advance, advance_many};
use herringbone_physics::watch::Watch;

use super::{Method, Run, Whose, ladder};
use crate::case::Case;

/// One motion.
struct Alone {
    integrator: Integrator,
    /// Both halves solved although they are equal: the mesh damping of the right one is made greater by the last bit of the number, which
    /// is enough for the product to see two different halves.
    both_halves: bool,
}

/// Operating points side by side: the case, and the same at speeds higher by one, two … per cent.
struct Lanes {
    points: usize,
}

pub fn all() -> Vec<Box<dyn Method>> {
    let mut out: Vec<Box<dyn Method>> = vec![Box::new(Lanes { points: 8 })];
    for (integrator, both_halves) in
        [(Integrator::Taylor, false), (Integrator::Taylor, true), (Integrator::RungeKutta, false)]
    {
        out.push(Box::new(Alone { integrator, both_halves }));
    }
    out
}

impl Method for Lanes {
    fn name(&self) -> String {
        format!("herringbone Taylor, {} in lanes", self.points)
    }

    fn whose(&self) -> Whose {
        Whose::Own
    }

    fn tolerances(&self) -> Vec<f64> {
        ladder(3, 14)
    }

    fn points(&self) -> usize {
        self.points
    }

    fn run(&mut self, case: &Case, tolerance: f64, periods: u64) -> Result<Run, String> {
        let p = case.parameters();
        let faster = |i: usize| p.mesh_frequency_hz * (1.0 + 0.01 * i as f64);
        let points: Vec<Parameters> =
            (0..self.points).map(|i| Parameters { mesh_frequency_hz: faster(i), ..p.clone() }).collect();
        let starts = vec![case.start; self.points];
        let mut reached =
            advance_many(&points, &starts, periods, tolerance, &Watch::none()).map_err(|e| e.to_string())?.into_iter();
        let first = reached.next().ok_or("no points")?.map_err(|e| e.to_string())?;
        for other in reached {
            other.map_err(|e| e.to_string())?;
        }
        Ok(first.state.into())
    }
}

impl Method for Alone {
    fn name(&self) -> String {
        let method = match self.integrator {
            Integrator::Taylor => "Taylor",
            Integrator::RungeKutta => "Runge–Kutta 4(5)",
        };
        format!("herringbone {method}{}", if self.both_halves { ", 12 coordinates" } else { "" })
    }

    fn whose(&self) -> Whose {
        Whose::Own
    }

    fn tolerances(&self) -> Vec<f64> {
        match self.integrator {
            Integrator::Taylor => ladder(3, 14),
            Integrator::RungeKutta => ladder(3, 11),
        }
    }

    fn run(&mut self, case: &Case, tolerance: f64, periods: u64) -> Result<Run, String> {
        let mut p = case.parameters();
        if self.both_halves {
            let damping = &mut p.halves[1].mesh_damping_n_s_per_m;
            *damping = damping.next_up();
        }
        let reached = advance(&p, &case.start, periods, self.integrator, tolerance, &Watch::none());
        reached.map(|r| r.state.into()).map_err(|e| e.to_string())
    }
}
