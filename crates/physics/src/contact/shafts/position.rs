//! One position of both halves on elastic shafts.

use super::flexibility::{ContactShafts, NODES, StationLoads};
use super::system::{HalvesOnShafts, HalvesWorkspace};
use super::{Mount, SPUR};
use crate::compliance::{Compliance, Settings};
use crate::contact::ContactError;
use crate::contact::distribution::{Prescribed, distribute};
use crate::contact::half::to_contact_error;
use crate::contact::position::{LoadedPosition, PositionError, PositionSolver};
use crate::contact::refine::PositionState;
use crate::gear::{Half, Pair};
use crate::watch::{Meter, Watch};

/// Loaded state of both halves at one position.
#[derive(Debug, Clone)]
pub(super) struct JointPosition {
    /// Points and forces of either half. Approach: of the mid-face sections. Stiffness: of the teeth alone at this
    /// contact, the bodies held in their displaced shape.
    pub halves: [LoadedPosition; 2],
    /// Approach between the couplings, along the base tangent.
    pub approach_m: f64,
    /// Loads at the stations, and axial shift of the member that floats.
    pub loads: StationLoads,
    pub float_m: f64,
    /// Axial displacement of the pinion at the apex plane.
    pub apex_m: f64,
    /// Openings by the shafts at the nodes of either half, relative to the mid-face section at the pitch point.
    pub openings_m: [[f64; NODES]; 2],
    /// Force and moment of the teeth of either half by unit approach and unit tilt about the middle of the face, along
    /// the flank normal: N/m, N, N m.
    pub tilting: [[f64; 3]; 2],
}

impl PositionState for JointPosition {
    fn stiffness_and_error(&self) -> impl Iterator<Item = [f64; 2]> {
        self.halves.iter().map(|half| [half.stiffness_n_per_m, half.approach_m])
    }
}

/// Solves positions of both halves one after the other.
pub(super) struct JointSolver<'a> {
    shafts: &'a ContactShafts,
    halves: [PositionSolver<'a>; 2],
    floats: bool,
    corner_contact: bool,
    work: HalvesWorkspace,
    corner_gap_m: f64,
    watch: Watch<'a>,
}

impl<'a> JointSolver<'a> {
    pub(super) fn new(
        pair: &'a Pair,
        shafts: &'a ContactShafts,
        compliance: &'a Compliance,
        settings: &Settings,
        watch: Watch<'a>,
    ) -> JointSolver<'a> {
        let solver = |half: Half| {
            let mount = Mount::Shafts(&shafts.halves[half.index()]);
            PositionSolver::new(pair, half, compliance, settings.corner_contact, mount, watch)
        };
        JointSolver {
            shafts,
            halves: Half::BOTH.map(solver),
            floats: shafts.freedom != super::AxialFreedom::None && pair.spec.helix_angle_rad.abs() > SPUR,
            corner_contact: settings.corner_contact,
            work: HalvesWorkspace::default(),
            corner_gap_m: 0.0,
            watch,
        }
    }

    /// Takes `state` as the neighbour to start from.
    pub(super) fn start_from(&mut self, state: &JointPosition) {
        for (solver, half) in self.halves.iter_mut().zip(&state.halves) {
            solver.start_from(half);
        }
    }

    /// Distributes the force `force_bt_n` of both halves together; pair 0 of either half is at its phase. `axial_n`:
    /// Σ n_z f that the coupling of the floating member holds.
    pub(super) fn solve(
        &mut self,
        phases: [f64; 2],
        force_bt_n: f64,
        axial_n: f64,
    ) -> Result<JointPosition, ContactError> {
        let phase = phases[0];
        let failed = |error: PositionError| to_contact_error(error, Half::Left, phase);
        let cos = self.shafts.frame.cos_base_helix();
        for _ in 0..12 {
            let corner_gap_m = if self.corner_contact { self.corner_gap_m } else { 0.0 };
            for half in Half::BOTH {
                let solver = &mut self.halves[half.index()];
                let grid = &self.shafts.grid;
                solver
                    .prepare(phases[half.index()], 0.5 * force_bt_n, corner_gap_m, |entry_m, x_m| {
                        grid.weights(entry_m, x_m)
                    })
                    .map_err(|error| to_contact_error(error, half, phases[half.index()]))?;
            }
            let start: Vec<f64> =
                self.halves.iter().flat_map(|solver| solver.expected_forces().iter().copied()).collect();
            let system = HalvesOnShafts {
                halves: [self.halves[0].mounted_system(), self.halves[1].mounted_system()],
                shafts: self.shafts,
                axial_n,
                floats: self.floats,
            };
            let meter = &mut Meter::new(self.watch);
            let prescribed = Prescribed::Force(force_bt_n / cos);
            let solved = distribute(&system, prescribed, &start, &mut self.work, meter)
                .map_err(|error| failed(PositionError::Distribution(error)))?;
            let left = system.halves[0].gaps.len();
            let (left_forces, right_forces) = solved.forces.split_at(left);
            let forces = [left_forces.to_vec(), right_forces.to_vec()];
            let shift_m = self.work.shift;
            let loads = [0, 1].map(|h| self.halves[h].station_loads(&forces[h]));
            let float_m = match self.shafts.freedom {
                super::AxialFreedom::Gear => -shift_m,
                _ => shift_m,
            };
            let displaced = self.shafts.openings(&loads, float_m);
            // Approach of the mid-face sections, and openings relative to them. The shift is in the openings.
            let approach = solved.approach;
            let mid_m = displaced.mid_face_m.map(|opening| approach - opening);
            let mut openings_m = displaced.nodes_m;
            let lowest_m = openings_m.iter().flatten().copied().fold(f64::INFINITY, f64::min);
            let highest_m = (approach - lowest_m) / cos;
            for (nodes, mid_face) in openings_m.iter_mut().zip(displaced.mid_face_m) {
                nodes.iter_mut().for_each(|node| *node -= mid_face);
            }
            for (solver, own) in self.halves.iter_mut().zip(&forces) {
                solver.store(own);
            }
            if self.corner_contact && highest_m > self.corner_gap_m {
                self.corner_gap_m = 1.25 * highest_m;
                continue;
            }
            let mut tilting = [[0.0; 3]; 2];
            let linearised_n = [&solved.linearised_n[..left], &solved.linearised_n[left..]];
            for half in Half::BOTH {
                let h = half.index();
                let of_teeth = self.halves[h].tooth_stiffness(solved.forces.len(), force_bt_n / cos, linearised_n[h]);
                tilting[h] = of_teeth.map_err(|error| to_contact_error(error, half, phases[h]))?;
            }
            let mut forces = forces.into_iter();
            let halves = [0, 1].map(|h| LoadedPosition {
                points: self.halves[h].points().to_vec(),
                forces_n: forces.next().unwrap_or_default(),
                approach_m: mid_m[h] / cos,
                stiffness_n_per_m: tilting[h][0] * cos * cos,
                iterations: solved.iterations,
            });
            let apex_m = displaced.apex_m;
            let approach_m = approach / cos;
            return Ok(JointPosition { halves, approach_m, loads, float_m, apex_m, openings_m, tilting });
        }
        Err(failed(PositionError::NoContact))
    }
}
