//! This crate.

use herringbone::dynamics::{Integrator, advance};
use herringbone::watch::Watch;

use super::{Method, Run, Whose, ladder};
use crate::case::Case;

struct Own {
    integrator: Integrator,
    /// Both halves solved although they are equal: the mesh damping of the right one is made greater by the last bit of the number, which
    /// is enough for the product to see two different halves.
    both_halves: bool,
}

pub fn all() -> Vec<Box<dyn Method>> {
    [(Integrator::Taylor, false), (Integrator::Taylor, true), (Integrator::RungeKutta, false)]
        .map(|(integrator, both_halves)| Box::new(Own { integrator, both_halves }) as Box<dyn Method>)
        .into()
}

impl Method for Own {
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
