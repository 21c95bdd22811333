//! The linearised load distribution of both halves on elastic shafts.
//!
//! Within each half the shafts are part of the flexibility between the stations; what couples the halves is of low
//! rank: the openings q at a few nodes of each half by the forces p = Vᵀ f at the nodes of the other one, the common
//! approach, and the axial shift of the member that floats. Each half answers with A⁻¹ [c, V]; the small dense system
//! of p closes the step.

use std::ops::Range;

use super::flexibility::{ContactShafts, NODES};
use crate::contact::point_contacts::PointContacts;
use crate::contact::system::{ContactProblem, ContactSystem, LocalApproach, SystemWorkspace};
use crate::numerics::dense::lu_solve;
use crate::watch::{Canceled, Meter};

/// Both halves at one position.
pub(super) struct HalvesOnShafts<'a> {
    pub(super) halves: [ContactSystem<'a, PointContacts>; 2],
    pub(super) shafts: &'a ContactShafts,
    /// Σ n_z f over both halves, where a member floats.
    pub(super) axial_n: f64,
    /// Whether a member floats and the helix makes the halves share by that.
    pub(super) floats: bool,
}

/// Reused memory.
#[derive(Debug, Clone, Default)]
pub(super) struct HalvesWorkspace {
    halves: [SystemWorkspace; 2],
    new_forces: Vec<f64>,
    /// Shift of the floating member, in the direction in which the pinion's closes the contact by n_z times it.
    pub(super) shift: f64,
    /// Openings at the nodes of either half by the forces on the other.
    openings: [[f64; NODES]; 2],
}

/// p of both halves.
const BOTH: usize = 2 * NODES;

impl HalvesOnShafts<'_> {
    fn counts(&self) -> [usize; 2] {
        [self.halves[0].gaps.len(), self.halves[1].gaps.len()]
    }

    /// Half of a point, and its index there.
    fn place(&self, i: usize) -> (usize, usize) {
        let left = self.halves[0].gaps.len();
        if i < left { (0, i) } else { (1, i - left) }
    }

    /// Openings at the nodes of a half by forces at the nodes of the other one.
    fn openings_across(&self, half: usize, other: &[f64]) -> [f64; NODES] {
        let table = &self.shafts.across[half];
        std::array::from_fn(|k| table[k * NODES..(k + 1) * NODES].iter().zip(other).map(|(g, p)| g * p).sum())
    }
}

/// Vᵀ f.
fn node_forces(modes: &[f64], forces: &[f64]) -> [f64; NODES] {
    let mut sum = [0.0; NODES];
    for (row, f) in modes.chunks_exact(NODES).zip(forces) {
        for (s, v) in sum.iter_mut().zip(row) {
            *s += v * f;
        }
    }
    sum
}

impl ContactProblem for HalvesOnShafts<'_> {
    type Workspace = HalvesWorkspace;

    fn gaps(&self) -> impl Iterator<Item = f64> {
        self.halves.iter().flat_map(|half| half.gaps.iter().copied())
    }

    /// A half of a floating member cannot be without force while the other one carries.
    fn carriers(&self) -> Vec<Range<usize>> {
        let [left, right] = self.counts();
        if self.floats { vec![0..left, left..left + right] } else { std::iter::once(0..left + right).collect() }
    }

    fn local_approach(&self, i: usize, force: f64) -> (f64, f64) {
        let (half, i) = self.place(i);
        self.halves[half].local.approach(i, force)
    }

    fn newton(
        &self,
        (total, prescribed): (f64, Option<f64>),
        datum: f64,
        forces: &[f64],
        active: &[bool],
        work: &mut HalvesWorkspace,
        meter: &mut Meter,
    ) -> Result<Option<(f64, f64)>, Canceled> {
        let [left, right] = self.counts();
        let ranges = [0..left, left..left + right];
        // (I + X G) p = y + s_L X_L 1 + s_R X_R 1 with X = Vᵀ A⁻¹ V and y = Vᵀ A⁻¹ c of either half; the right-hand
        // sides are y, the approach's and the shift's.
        let mut matrix = vec![0.0; BOTH * BOTH];
        let mut sides = vec![0.0; 3 * BOTH];
        for (h, range) in ranges.iter().enumerate() {
            let system = &self.halves[h];
            let own = &mut work.halves[h];
            let (forces, active) = (&forces[range.clone()], &active[range.clone()]);
            if system.linear_response((total, left + right), datum, forces, active, own, meter)?.is_none() {
                return Ok(None);
            }
            let mut response = [[0.0; NODES]; NODES];
            for ((row, columns), f) in
                system.modes.chunks_exact(NODES).zip(own.mode_forces.chunks_exact(NODES)).zip(&own.new_forces)
            {
                for (k, v) in row.iter().enumerate() {
                    sides[h * NODES + k] += v * f;
                    for (x, c) in response[k].iter_mut().zip(columns) {
                        *x += v * c;
                    }
                }
            }
            let across = &self.shafts.across[h];
            for (k, row) in response.iter().enumerate() {
                let at = h * NODES + k;
                matrix[at * BOTH + at] += 1.0;
                let by_approach: f64 = row.iter().sum();
                sides[BOTH + at] = by_approach;
                sides[2 * BOTH + at] = self.shafts.frame.axial[h] * by_approach;
                for (m, x) in row.iter().enumerate() {
                    for l in 0..NODES {
                        matrix[at * BOTH + (1 - h) * NODES + l] += x * across[m * NODES + l];
                    }
                }
            }
        }
        if !lu_solve(&mut matrix, &mut sides, BOTH, meter)? {
            return Ok(None);
        }
        // Sum of the forces, and of their axial components, of every side.
        let sum = |side: usize, weights: [f64; 2]| -> f64 {
            let side = &sides[side * BOTH..(side + 1) * BOTH];
            side.chunks_exact(NODES).zip(weights).map(|(p, w)| w * p.iter().sum::<f64>()).sum()
        };
        let of_all = [0, 1, 2].map(|side| sum(side, [1.0; 2]));
        let axial = [0, 1, 2].map(|side| sum(side, self.shafts.frame.axial));
        // shift = by_shift[0] + by_shift[1] approach.
        let by_shift =
            if self.floats { [(self.axial_n - axial[0]) / axial[2], -axial[1] / axial[2]] } else { [0.0; 2] };
        let stiffness = of_all[1] + by_shift[1] * of_all[2];
        let approach = prescribed.unwrap_or_else(|| (total - of_all[0] - by_shift[0] * of_all[2]) / stiffness);
        let shift = by_shift[0] + by_shift[1] * approach;
        if !(approach.is_finite() && shift.is_finite()) {
            return Ok(None);
        }
        work.shift = shift;
        let p: Vec<f64> =
            (0..BOTH).map(|i| sides[i] + approach * sides[BOTH + i] + shift * sides[2 * BOTH + i]).collect();
        work.new_forces.clear();
        for h in 0..2 {
            let openings = self.openings_across(h, &p[(1 - h) * NODES..(2 - h) * NODES]);
            let closing = approach + self.shafts.frame.axial[h] * shift;
            let by_node = openings.map(|opening| closing - opening);
            let own = &work.halves[h];
            work.new_forces.extend(
                own.new_forces
                    .iter()
                    .zip(own.mode_forces.chunks_exact(NODES))
                    .map(|(f, columns)| f + columns.iter().zip(&by_node).map(|(c, s)| c * s).sum::<f64>()),
            );
        }
        Ok(Some((approach, stiffness)))
    }

    fn new_forces<'w>(&self, work: &'w HalvesWorkspace) -> &'w [f64] {
        &work.new_forces
    }

    fn displace(&self, forces: &[f64], work: &mut HalvesWorkspace, meter: &mut Meter) -> Result<(), Canceled> {
        let (left, right) = forces.split_at(self.halves[0].gaps.len());
        let p = [node_forces(self.halves[0].modes, left), node_forces(self.halves[1].modes, right)];
        for (h, own) in [left, right].into_iter().enumerate() {
            self.halves[h].displace(own, &mut work.halves[h], meter)?;
            work.openings[h] = self.openings_across(h, &p[1 - h]);
        }
        Ok(())
    }

    fn deflection(&self, i: usize, forces: &[f64], work: &HalvesWorkspace) -> f64 {
        let (h, own) = self.place(i);
        let (left, right) = forces.split_at(self.halves[0].gaps.len());
        let modes = &self.halves[h].modes[own * NODES..(own + 1) * NODES];
        let across: f64 = modes.iter().zip(&work.openings[h]).map(|(v, q)| v * q).sum();
        let within = self.halves[h].deflection(own, [left, right][h], &work.halves[h]);
        within + across - self.shafts.frame.axial[h] * work.shift
    }
}
