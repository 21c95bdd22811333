//! The linearised load distribution of one position: one Newton step on the active set.
//!
//! With D the derivative of K f + h(f) on the active points and W = Pᵀ D⁻¹ P, every Newton step solves (I + W B) y =
//! Pᵀ D⁻¹ c between the stations of the contact lines only: its cost grows linearly with the points. The displacements
//! of the stations are a = B y, and D f = c − P a.

use std::ops::Range;

use crate::compliance::{STENCIL, Stencil};
use crate::numerics::dense::{Augmented, cholesky, cholesky_solve, combine_rows, dot, forward_solve, multiply_vectors};
use crate::simd::vectorised;
use crate::watch::{Canceled, Meter};

/// Approach of one point under its own force.
pub(super) trait LocalApproach {
    /// Local approach of point `i` under a positive force, and its derivative.
    fn approach(&self, i: usize, force: f64) -> (f64, f64);
}

/// A problem that [`distribute`](super::distribution::distribute) solves: points, and the linear system of a Newton
/// step.
pub(super) trait ContactProblem {
    /// Reused memory.
    type Workspace;

    /// Normal gap of every point before loading, m.
    fn gaps(&self) -> impl Iterator<Item = f64>;

    /// Ranges of points that cannot all be without force.
    fn carriers(&self) -> Vec<Range<usize>> {
        std::iter::once(0..self.gaps().count()).collect()
    }

    /// Local approach of point `i` under a positive force, and its derivative.
    fn local_approach(&self, i: usize, force: f64) -> (f64, f64);

    /// One Newton step on the active points: their [new forces](Self::new_forces); returns approach and stiffness.
    /// `total` is the sum of the forces (their size, where the approach above the datum is `prescribed` instead).
    /// `None` where the system is singular.
    ///
    /// # Errors
    /// [`Canceled`].
    fn newton(
        &self,
        prescribed: (f64, Option<f64>),
        datum: f64,
        forces: &[f64],
        active: &[bool],
        work: &mut Self::Workspace,
        meter: &mut Meter,
    ) -> Result<Option<(f64, f64)>, Canceled>;

    /// Forces after the step.
    fn new_forces<'w>(&self, work: &'w Self::Workspace) -> &'w [f64];

    /// Prepares [`Self::deflection`] under `forces`.
    ///
    /// # Errors
    /// [`Canceled`].
    fn displace(&self, forces: &[f64], work: &mut Self::Workspace, meter: &mut Meter) -> Result<(), Canceled>;

    /// Displacement of point `i` by the forces of all others, apart from its gap and the approach of the bodies.
    fn deflection(&self, i: usize, forces: &[f64], work: &Self::Workspace) -> f64;
}

/// The points and what couples them. All quantities along the flank normal.
pub(super) struct ContactSystem<'a, L: LocalApproach> {
    /// Normal gap of every point before loading, m.
    pub gaps: &'a [f64],
    /// Interpolation of every point between the stations of all lines.
    pub stencils: &'a [Stencil],
    /// Number of stations of all lines.
    pub stations: usize,
    /// Flexibility between the stations, row-major, symmetric.
    pub bulk: &'a [f64],
    /// Points of every line.
    pub lines: &'a [Range<usize>],
    /// Coupling of the points of a line beyond the bulk, row-major and line by line; empty when there is none.
    pub coupling: &'a [Vec<f64>],
    /// Local approach of the points.
    pub local: &'a L,
    /// Displacements of the points by unit displacements of bodies that they are fixed to, point by point; empty for
    /// one rigid body.
    pub modes: &'a [f64],
}

/// Reused memory of the solver.
#[derive(Debug, Clone, Default)]
pub(super) struct SystemWorkspace {
    slope: Vec<f64>,
    target: Vec<f64>,
    /// Forces after the step.
    pub new_forces: Vec<f64>,
    /// Forces per unit displacement of every mode, point by point.
    pub mode_forces: Vec<f64>,
    weight: Vec<f64>,
    matrix: Augmented,
    sides: Vec<f64>,
    block: Vec<f64>,
    columns: Vec<f64>,
    line_points: Vec<usize>,
    station_force: Vec<f64>,
    station_shift: Vec<f64>,
    /// Forces per unit of approach.
    pub unit: Vec<f64>,
}

/// Least force that counts as contact, as a part of the mean force of the points.
pub(super) const LEAST_FORCE: f64 = 1e-9;
/// Diagonals of W.
const BAND: usize = 2 * STENCIL - 1;
impl<L: LocalApproach> ContactSystem<'_, L> {
    /// Number of modes.
    fn mode_count(&self) -> usize {
        self.modes.len() / self.gaps.len().max(1)
    }

    /// Linearises the active points about `forces` and solves for their forces: those of no approach above the datum,
    /// into `work.new_forces`; those per unit of approach; and those per unit displacement of every mode, into
    /// `work.mode_forces`. Returns the sums of the second and the first. `None` where the system is singular. `total`
    /// is the size of the forces, over `all` points of the problem.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(super) fn linear_response(
        &self,
        (total, all): (f64, usize),
        datum: f64,
        forces: &[f64],
        active: &[bool],
        work: &mut SystemWorkspace,
        meter: &mut Meter,
    ) -> Result<Option<(f64, f64)>, Canceled> {
        meter.checkpoint()?;
        let (n, r) = (self.gaps.len(), self.stations);
        let floor = LEAST_FORCE * total / all as f64;
        work.slope.resize(n, 1.0);
        work.target.resize(n, 0.0);
        for i in 0..n {
            if active[i] {
                let at = forces[i].max(floor);
                let (value, slope) = self.local.approach(i, at);
                work.slope[i] = slope;
                work.target[i] = slope * at - value - (self.gaps[i] - datum);
            }
        }
        // Right-hand sides Pᵀ D⁻¹ 1, Pᵀ D⁻¹ c, and Pᵀ D⁻¹ of the modes.
        let modes = self.mode_count();
        work.sides.clear();
        work.sides.resize((2 + modes) * r, 0.0);
        work.matrix.resize(r, 2 + modes);
        if self.coupling.is_empty() {
            self.add_points(active, work, meter)?;
        } else if !self.add_lines(active, work, meter)? {
            return Ok(None);
        }
        let sides = 2 + modes;
        for i in 0..r {
            let (right, row) = work.matrix.row_mut(i);
            right.fill(0.0);
            right.iter_mut().zip(work.sides.chunks_exact(r)).for_each(|(right, side)| *right = side[i]);
            row[i] += 1.0;
        }
        if !work.matrix.solve(meter)? {
            return Ok(None);
        }
        for (side, out) in work.sides.chunks_exact_mut(r.max(1)).enumerate() {
            out.iter_mut().zip(work.matrix.solution(side)).for_each(|(out, value)| *out = value);
        }
        if sides > 3 {
            multiply_vectors(self.bulk, &mut work.sides, r, meter)?;
        } else {
            for side in work.sides.chunks_exact_mut(r.max(1)) {
                work.station_force.clear();
                work.station_force.extend_from_slice(side);
                multiply(self.bulk, &work.station_force, side, meter)?;
            }
        }
        work.new_forces.clear();
        work.new_forces.resize(n, 0.0);
        work.unit.clear();
        work.unit.resize(n, 0.0);
        work.mode_forces.clear();
        work.mode_forces.resize(n * modes, 0.0);
        Ok(Some(if self.coupling.is_empty() {
            self.forces_of_points(active, work)
        } else {
            self.forces_of_lines(active, work)
        }))
    }

    /// W B and the right-hand sides when D is diagonal: W is banded.
    fn add_points(&self, active: &[bool], work: &mut SystemWorkspace, meter: &mut Meter) -> Result<(), Canceled> {
        let r = self.stations;
        work.weight.clear();
        work.weight.resize(BAND * r, 0.0);
        for (i, stencil) in self.stencils.iter().enumerate() {
            if !active[i] {
                continue;
            }
            let inverse = 1.0 / work.slope[i];
            for (a, wa) in stencil.weights.iter().enumerate() {
                let row = stencil.first + a;
                let scaled = wa * inverse;
                work.sides[row] += scaled;
                work.sides[r + row] += scaled * work.target[i];
                for (k, mode) in self.modes_of(i).iter().enumerate() {
                    work.sides[(2 + k) * r + row] += scaled * mode;
                }
                // Row by row: W[row][column] is at [row][column - row + 3].
                let band = &mut work.weight[BAND * row + STENCIL - 1 - a..][..STENCIL];
                band.iter_mut().zip(stencil.weights).for_each(|(weight, wb)| *weight += scaled * wb);
            }
        }
        for (i, band) in work.weight.as_chunks::<BAND>().0.iter().enumerate() {
            meter.count(BAND * r)?;
            // Rows of the bulk that the band meets; beyond the ends its weights are zero.
            let rows: [&[f64]; BAND] = std::array::from_fn(|d| {
                let k = (i + d).saturating_sub(STENCIL - 1).min(r - 1);
                &self.bulk[k * r..(k + 1) * r]
            });
            combine_rows(band, &rows, work.matrix.row_mut(i).1);
        }
        Ok(())
    }

    fn forces_of_points(&self, active: &[bool], work: &mut SystemWorkspace) -> (f64, f64) {
        let r = self.stations;
        let (mut stiffness, mut rest) = (0.0, 0.0);
        for (i, stencil) in self.stencils.iter().enumerate() {
            if !active[i] {
                continue;
            }
            let unit = (1.0 - stencil.at(&work.sides[..r])) / work.slope[i];
            let new_forces = (work.target[i] - stencil.at(&work.sides[r..])) / work.slope[i];
            work.unit[i] = unit;
            work.new_forces[i] = new_forces;
            stiffness += unit;
            rest += new_forces;
            let modes = self.modes_of(i);
            for (k, mode) in modes.iter().enumerate() {
                let side = &work.sides[(2 + k) * r..(3 + k) * r];
                work.mode_forces[i * modes.len() + k] = (mode - stencil.at(side)) / work.slope[i];
            }
        }
        (stiffness, rest)
    }

    /// The same when the points of a line are coupled: D is a full block per line, factored in `work.block`;
    /// `work.columns` keeps L⁻¹ [1, c, modes, P]. `false` where a block is not positive definite.
    fn add_lines(&self, active: &[bool], work: &mut SystemWorkspace, meter: &mut Meter) -> Result<bool, Canceled> {
        let r = self.stations;
        work.block.clear();
        work.columns.clear();
        meter.zeros(&mut work.weight, r * r)?;
        for (line, range) in self.lines.iter().enumerate() {
            work.line_points.clear();
            work.line_points.extend(range.clone().filter(|&i| active[i]));
            let m = work.line_points.len();
            if m == 0 {
                continue;
            }
            let coupling = &self.coupling[line];
            let size = range.len();
            let start = work.block.len();
            for &i in &work.line_points {
                meter.count(m)?;
                let row = &coupling[(i - range.start) * size..(i - range.start + 1) * size];
                let from = work.block.len();
                work.block.extend(work.line_points.iter().map(|&j| row[j - range.start]));
                let own = from + work.line_points.iter().position(|&j| j == i).unwrap_or(0);
                work.block[own] += work.slope[i];
            }
            let block = &mut work.block[start..];
            if !cholesky(block, m, meter)? {
                return Ok(false);
            }
            let stations = self.span(&work.line_points);
            let width = stations.len();
            // Columns 1, c, the modes, P, one after the other.
            let sides = 2 + self.mode_count();
            let first = work.columns.len();
            work.columns.resize(first + (sides + width) * m, 0.0);
            let columns = &mut work.columns[first..];
            for (row, &i) in work.line_points.iter().enumerate() {
                columns[row] = 1.0;
                columns[m + row] = work.target[i];
                for (k, mode) in self.modes_of(i).iter().enumerate() {
                    columns[(2 + k) * m + row] = *mode;
                }
                for (k, w) in self.stencils[i].weights.iter().enumerate() {
                    columns[(sides + self.stencils[i].first + k - stations.start) * m + row] = *w;
                }
            }
            for column in columns.chunks_exact_mut(m) {
                meter.count(m * m / 2)?;
                forward_solve(block, column, m);
            }
            let column = |k: usize| &columns[k * m..(k + 1) * m];
            for a in 0..width {
                meter.count(a * m)?;
                let row = stations.start + a;
                for side in 0..sides {
                    work.sides[side * r + row] += dot(column(sides + a), column(side));
                }
                for b in 0..=a {
                    let value = dot(column(sides + a), column(sides + b));
                    work.weight[row * r + stations.start + b] += value;
                    if b != a {
                        work.weight[(stations.start + b) * r + row] += value;
                    }
                }
            }
        }
        // W B: W is a block for every line.
        let (weight, matrix) = (&work.weight, &mut work.matrix);
        vectorised(
            #[inline(always)]
            || {
                for (i, weights) in weight.chunks_exact(r.max(1)).enumerate() {
                    let (_, target) = matrix.row_mut(i);
                    target.fill(0.0);
                    for (weight, bulk) in weights.iter().zip(self.bulk.chunks_exact(r)) {
                        if *weight != 0.0 {
                            meter.count(r)?;
                            target.iter_mut().zip(bulk).for_each(|(t, b)| *t += weight * b);
                        }
                    }
                }
                Ok(true)
            },
        )
    }

    fn forces_of_lines(&self, active: &[bool], work: &mut SystemWorkspace) -> (f64, f64) {
        let r = self.stations;
        let (mut stiffness, mut rest) = (0.0, 0.0);
        let mut block_start = 0;
        for range in self.lines {
            work.line_points.clear();
            work.line_points.extend(range.clone().filter(|&i| active[i]));
            let m = work.line_points.len();
            if m == 0 {
                continue;
            }
            let block = &work.block[block_start..block_start + m * m];
            block_start += m * m;
            for (side, out) in [(0, &mut work.unit), (r, &mut work.new_forces)] {
                work.columns.clear();
                work.columns.extend(work.line_points.iter().map(|&i| {
                    let whole = if side == 0 { 1.0 } else { work.target[i] };
                    whole - self.stencils[i].at(&work.sides[side..side + r])
                }));
                cholesky_solve(block, &mut work.columns, m);
                for (&i, value) in work.line_points.iter().zip(&work.columns) {
                    out[i] = *value;
                }
            }
            let modes = self.mode_count();
            for k in 0..modes {
                let side = &work.sides[(2 + k) * r..(3 + k) * r];
                work.columns.clear();
                let of_point = |&i: &usize| self.modes[i * modes + k] - self.stencils[i].at(side);
                work.columns.extend(work.line_points.iter().map(of_point));
                cholesky_solve(block, &mut work.columns, m);
                for (&i, value) in work.line_points.iter().zip(&work.columns) {
                    work.mode_forces[i * modes + k] = *value;
                }
            }
            stiffness += work.line_points.iter().map(|&i| work.unit[i]).sum::<f64>();
            rest += work.line_points.iter().map(|&i| work.new_forces[i]).sum::<f64>();
        }
        (stiffness, rest)
    }

    /// Displacements of point `i` by the modes.
    fn modes_of(&self, i: usize) -> &[f64] {
        let modes = self.mode_count();
        &self.modes[i * modes..(i + 1) * modes]
    }

    /// Stations that the points `active` touch.
    fn span(&self, active: &[usize]) -> Range<usize> {
        let firsts = active.iter().map(|&i| self.stencils[i].first);
        let (low, high) = firsts.fold((usize::MAX, 0), |(l, h), s| (l.min(s), h.max(s + STENCIL)));
        low..high
    }

    /// Bulk displacement of the stations under `forces`, into `work.station_shift`.
    ///
    /// # Errors
    /// [`Canceled`].
    fn station_shifts(&self, forces: &[f64], work: &mut SystemWorkspace, meter: &mut Meter) -> Result<(), Canceled> {
        work.station_force.clear();
        work.station_force.resize(self.stations, 0.0);
        for (stencil, f) in self.stencils.iter().zip(forces) {
            for (k, w) in stencil.weights.iter().enumerate() {
                work.station_force[stencil.first + k] += w * f;
            }
        }
        work.station_shift.clear();
        work.station_shift.resize(self.stations, 0.0);
        multiply(self.bulk, &work.station_force, &mut work.station_shift, meter)
    }
}

impl<L: LocalApproach> ContactProblem for ContactSystem<'_, L> {
    type Workspace = SystemWorkspace;

    fn gaps(&self) -> impl Iterator<Item = f64> {
        self.gaps.iter().copied()
    }

    fn local_approach(&self, i: usize, force: f64) -> (f64, f64) {
        self.local.approach(i, force)
    }

    fn newton(
        &self,
        (total, prescribed): (f64, Option<f64>),
        datum: f64,
        forces: &[f64],
        active: &[bool],
        work: &mut SystemWorkspace,
        meter: &mut Meter,
    ) -> Result<Option<(f64, f64)>, Canceled> {
        let response = self.linear_response((total, self.gaps.len()), datum, forces, active, work, meter)?;
        let Some((stiffness, rest)) = response else { return Ok(None) };
        let approach = prescribed.unwrap_or_else(|| (total - rest) / stiffness);
        if !approach.is_finite() {
            return Ok(None);
        }
        for (f, u) in work.new_forces.iter_mut().zip(&work.unit) {
            *f += approach * u;
        }
        Ok(Some((approach, stiffness)))
    }

    fn new_forces<'w>(&self, work: &'w SystemWorkspace) -> &'w [f64] {
        &work.new_forces
    }

    fn displace(&self, forces: &[f64], work: &mut SystemWorkspace, meter: &mut Meter) -> Result<(), Canceled> {
        self.station_shifts(forces, work, meter)
    }

    fn deflection(&self, i: usize, forces: &[f64], work: &SystemWorkspace) -> f64 {
        let mut sum = self.stencils[i].at(&work.station_shift);
        if !self.coupling.is_empty() {
            let line = self.lines.partition_point(|range| range.end <= i);
            let range = &self.lines[line];
            let size = range.len();
            let row = &self.coupling[line][(i - range.start) * size..(i - range.start + 1) * size];
            sum += dot(row, &forces[range.clone()]);
        }
        sum
    }
}

impl Stencil {
    /// Interpolates values of the stations.
    fn at(&self, values: &[f64]) -> f64 {
        self.weights.iter().zip(&values[self.first..]).map(|(w, v)| w * v).sum()
    }
}

/// y = A x, A square and row-major.
fn multiply(a: &[f64], x: &[f64], y: &mut [f64], meter: &mut Meter) -> Result<(), Canceled> {
    vectorised(
        #[inline(always)]
        || {
            for (value, row) in y.iter_mut().zip(a.chunks_exact(x.len().max(1))) {
                meter.count(x.len())?;
                *value = dot(row, x);
            }
            Ok(())
        },
    )
}
