//! Reduction of the geared rotor to modal coordinates, with an estimate of its error.
//!
//! The basis is made of the natural modes (meshes closed) below a frequency, and of the residual flexibility of both
//! mesh springs, and of the bearings if that is needed: what the modes left out give under a static force there. So the
//! reduced rotor is statically exact at the meshes. The residual vectors are made M-orthogonal to the modes and
//! diagonalised among themselves (Craig, Structural Dynamics, 1981, chapter 19: residual attachment modes).

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector, Matrix2};

use super::eigen::{Eigenmodes, count_below, symmetric_eigen};
use super::modes::{RotorModes, limit_of};
use super::reduced::{Projection, Receptance, ReducedBearing, ReducedRotor};
use super::sparse::{SparseRow, dot};
use super::whirl::projected;
use super::{GearedRotor, RotorBearing};
use crate::dynamics::LinearOutput;
use crate::shafts::error::ShaftError;
use crate::watch::Watch;

/// Highest frequencies of the modes that are tried, over the end of the frequency range.
const CUTS: [f64; 6] = [1.0, 1.25, 1.5, 2.0, 2.5, 3.0];
/// Number of frequencies at which the error is measured, equally spaced up to the end of the range.
const CHECKED: usize = 8;
/// Loss factor that is added to the stiffness of both models while they are compared: without it the comparison at a
/// frequency close to a resonance is one of the resonances.
pub(super) const LOSS_FACTOR: f64 = 0.02;
/// Number of bases, of those that are tried in turn, for which the modes are calculated together.
const AHEAD: usize = 8;
/// Norm of a residual vector, over that before the modes are taken out, below which it is rounding.
const NEGLIGIBLE: f64 = 1e-6;

/// How far a rotor is reduced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReductionSettings {
    /// End of the frequency range of interest, Hz.
    pub up_to_hz: f64,
    /// Permitted relative error, see [`ReductionReport::estimated_error`].
    pub accuracy: f64,
    /// Largest number of coordinates.
    pub most_coordinates: usize,
    /// Speed of the pinion, rad/s, sign about z, at which the error is estimated.
    pub pinion_speed_rad_s: f64,
}

/// One size of the basis that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReductionStep {
    /// Number of modes.
    pub modes: usize,
    /// Number of residual vectors.
    pub residual_vectors: usize,
    /// Estimated relative error.
    pub error: f64,
}

/// What a reduction kept and how accurate it is.
#[derive(Debug, Clone, PartialEq)]
pub struct ReductionReport {
    /// Number of natural modes kept, rigid-body modes included.
    pub modes: usize,
    /// Number of residual vectors.
    pub residual_vectors: usize,
    /// Frequency of the highest mode kept, Hz.
    pub highest_mode_hz: f64,
    /// Highest frequency of a coordinate, Hz: of a residual vector.
    pub highest_coordinate_hz: f64,
    /// Estimated relative error up to the end of the range: the largest difference of the reduced from the full model
    /// in the receptances of the meshes, open and closed, and in the bearing forces per mesh force, each over the norm
    /// of all of its kind at that frequency, at some frequencies, with a loss factor of 2 %.
    pub estimated_error: f64,
    /// The sizes that were tried.
    pub steps: Vec<ReductionStep>,
}

impl GearedRotor {
    /// Reduces the rotor to the first basis whose estimated error is below `settings.accuracy`, of increasing numbers
    /// of modes, each with the residual vectors of the meshes, then with those of the bearings too; or to the best one
    /// within `settings.most_coordinates`. The report tells the error that is left.
    ///
    /// # Errors
    /// [`ShaftError::InvalidRange`], [`ShaftError::NegativeStiffness`], [`ShaftError::IllConditioned`],
    /// [`ShaftError::ModesNotConverged`], [`ShaftError::Canceled`].
    pub fn reduce(&self, settings: &ReductionSettings, watch: Watch<'_>) -> Result<ReducedRotor, ShaftError> {
        let limit = limit_of(settings.up_to_hz)?;
        let flexibility = self.flexibility(limit)?;
        let inputs = [self.meshes.len(), flexibility.ncols()];
        let most = |inputs: usize| settings.most_coordinates.saturating_sub(inputs).clamp(1, self.unknowns());
        let below = CUTS.map(|cut| count_below(&self.stiffness, &self.mass, limit * cut * cut).max(1));
        let mut sizes: Vec<(usize, usize)> =
            below.iter().flat_map(|&modes| inputs.map(|inputs| (modes.min(most(inputs)), inputs))).collect();
        sizes.dedup();
        let omegas: Vec<f64> = (1..=CHECKED).map(|i| TAU * settings.up_to_hz * i as f64 / CHECKED as f64).collect();
        let mut exact = Vec::with_capacity(omegas.len());
        for &omega in &omegas {
            watch.checkpoint_quietly()?;
            exact.push(self.receptance(omega, settings.pinion_speed_rad_s)?);
        }
        let mut steps: Vec<ReductionStep> = Vec::new();
        let mut modes = Eigenmodes { eigenvalues: Vec::new(), vectors: DMatrix::zeros(self.unknowns(), 0) };
        let mut best: Option<(Projection, ReductionReport)> = None;
        for (place, &(size, inputs)) in sizes.iter().enumerate() {
            watch.checkpoint_quietly()?;
            if modes.eigenvalues.len() < size {
                // The next sizes are likely to be needed too: their modes cost less together.
                let ahead = sizes[place..].iter().take(AHEAD).map(|(modes, _)| *modes).max().unwrap_or(size);
                modes = self.eigenmodes(limit, ahead, watch)?;
            }
            let projection = self.projection(&modes, size, &flexibility.columns(0, inputs).into_owned())?;
            watch.checkpoint_quietly()?;
            let errors = omegas.iter().zip(&exact);
            let error = errors
                .map(|(&omega, exact)| projection.error(exact, omega, settings.pinion_speed_rad_s))
                .fold(0.0, |worst: f64, error| if error.is_nan() { f64::INFINITY } else { worst.max(error) });
            let residual_vectors = projection.coordinates() - size;
            steps.push(ReductionStep { modes: size, residual_vectors, error });
            if error < best.as_ref().map_or(f64::INFINITY, |(_, report)| report.estimated_error) {
                let report = projection.report(size, error);
                best = Some((projection, report));
            }
            if error <= settings.accuracy {
                break;
            }
        }
        let Some((projection, mut report)) = best else {
            return Err(ShaftError::IllConditioned { reason: "no reduction of the rotor has a finite error" });
        };
        report.steps = steps;
        let kept = Eigenmodes {
            eigenvalues: modes.eigenvalues[..report.modes].to_vec(),
            vectors: modes.vectors.columns(0, report.modes).into_owned(),
        };
        Ok(self.reduced(self.described(kept), report, projection))
    }

    /// Displacements under unit forces of the meshes and, behind them, of the bearings, in columns: (K + αM)⁻¹ with a
    /// shift α, whose effect on the modes of high frequency is corrected to α²/ω⁴.
    fn flexibility(&self, limit: f64) -> Result<DMatrix<f64>, ShaftError> {
        let mut rows: Vec<&SparseRow> = self.meshes.iter().map(|mesh| &mesh.row).collect();
        for bearing in self.shafts.iter().flat_map(|shaft| &shaft.bearings) {
            let acts = |i: usize| bearing.stiffness[i].iter().chain(&bearing.damping[i]).any(|&value| value != 0.0);
            rows.extend((0..6).filter(|&i| acts(i)).map(|i| &bearing.section[i]));
        }
        let mut forces = vec![0.0; self.unknowns() * rows.len()];
        for (column, row) in rows.iter().enumerate() {
            row.iter().for_each(|&(unknown, value)| forces[unknown * rows.len() + column] += value);
        }
        let shifted = self.shifted_stiffness(limit)?;
        shifted.solve(&mut forces, rows.len());
        let mut correction = vec![0.0; forces.len()];
        self.mass.multiply(&forces, rows.len(), &mut correction);
        shifted.solve(&mut correction, rows.len());
        forces.iter_mut().zip(&correction).for_each(|(u, c)| *u += shifted.shift() * c);
        Ok(DMatrix::from_row_slice(self.unknowns(), rows.len(), &forces))
    }

    /// The rotor projected on the lowest `size` of the modes and the residual vectors of the flexibility.
    fn projection(
        &self,
        modes: &Eigenmodes,
        size: usize,
        flexibility: &DMatrix<f64>,
    ) -> Result<Projection, ShaftError> {
        let kept = modes.vectors.columns(0, size).into_owned();
        let residual = self.residual_vectors(&kept, flexibility);
        let stiffness = projected(&self.stiffness, &residual);
        let Some(eigen) = symmetric_eigen((&stiffness + stiffness.transpose()) * 0.5) else {
            return Err(ShaftError::IllConditioned { reason: "the residual flexibility is not finite" });
        };
        let residual = residual * &eigen.eigenvectors;
        let mut vectors = DMatrix::zeros(self.unknowns(), size + residual.ncols());
        vectors.columns_mut(0, size).copy_from(&kept);
        vectors.columns_mut(size, residual.ncols()).copy_from(&residual);
        let mut eigenvalues = modes.eigenvalues[..size].to_vec();
        eigenvalues.extend(eigen.eigenvalues.iter());
        Ok(Projection {
            damping: projected(&self.damping, &vectors),
            gyroscopic: projected(&self.gyroscopic, &vectors),
            cross_stiffness: projected(&self.cross_stiffness, &vectors),
            mesh: self.meshes.each_ref().map(|mesh| projected_row(&mesh.row, &vectors)),
            mesh_stiffness_n_per_m: self.meshes.each_ref().map(|mesh| mesh.element.stiffness_n_per_m),
            mesh_damping_n_s_per_m: self.meshes.each_ref().map(|mesh| mesh.element.damping_n_s_per_m),
            bearings: [0, 1].map(|member| {
                self.shafts[member].bearings.iter().map(|bearing| ReducedBearing::new(bearing, &vectors)).collect()
            }),
            eigenvalues,
            vectors,
        })
    }

    fn reduced(&self, modes: RotorModes, report: ReductionReport, projection: Projection) -> ReducedRotor {
        ReducedRotor {
            modes,
            report,
            load_per_nm: projected_row(&self.torque_row(), &projection.vectors),
            tilting_load: self.meshes.iter().fold(DVector::zeros(projection.coordinates()), |sum, mesh| {
                sum - projected_row(&mesh.tilt, &projection.vectors) * mesh.element.tilting_moment_nm
            }),
            displacements: self.physical_rows().map(|row| projected_row(&row, &projection.vectors).as_slice().to_vec()),
            outputs: self.outputs(&projection),
            projection,
        }
    }

    /// The flexibility without its part in the modes, M-orthonormal.
    fn residual_vectors(&self, modes: &DMatrix<f64>, flexibility: &DMatrix<f64>) -> DMatrix<f64> {
        let weigh = |vector: &DVector<f64>| DVector::from_vec(self.mass.times(vector.as_slice()));
        let mut kept: Vec<DVector<f64>> = Vec::new();
        for column in flexibility.column_iter() {
            let mut vector = column.into_owned();
            let before = vector.dot(&weigh(&vector)).sqrt();
            for _ in 0..2 {
                let weighted = weigh(&vector);
                vector -= modes * modes.tr_mul(&weighted);
                for other in &kept {
                    let weighted = weigh(&vector);
                    vector -= other * other.dot(&weighted);
                }
            }
            let norm = vector.dot(&weigh(&vector)).sqrt();
            if norm > NEGLIGIBLE * before {
                kept.push(vector / norm);
            }
        }
        DMatrix::from_fn(self.unknowns(), kept.len(), |i, j| kept[j][i])
    }

    /// Generalised force per driving torque on the pinion, balanced by the torque on the gear: at the machines, or at
    /// the couplings where there are none.
    fn torque_row(&self) -> SparseRow {
        let mut row = SparseRow::new();
        for (shaft, torque) in self.shafts.iter().zip([1.0, 1.0 / self.geometry.teeth_ratio]) {
            match shaft.machine {
                Some(unknown) => row.push((unknown, self.geometry.sense * torque)),
                None => super::add(&mut row, self.geometry.sense * torque, &shaft.coupling[0]),
            }
        }
        row
    }

    /// Rows of y, z and θ of pinion and gear at the mid-face sections of the left, then of the right half, with the
    /// signs of [`crate::dynamics`]: y along the base tangent, z so that the left half's axial force on the pinion is
    /// negative, θ positive in the sense in which each turns.
    fn physical_rows(&self) -> [SparseRow; 12] {
        let geometry = &self.geometry;
        std::array::from_fn(|i| {
            let (half, member, quantity) = (i / 6, i / 3 % 2, i % 3);
            let section = &self.shafts[member].mid_face[half];
            let mut row = SparseRow::new();
            match quantity {
                0 => (0..2).for_each(|axis| super::add(&mut row, geometry.tangent[axis], &section[axis])),
                1 => super::add(&mut row, geometry.axial, &section[2]),
                _ => super::add(&mut row, [1.0, -1.0][member] * geometry.sense, &section[5]),
            }
            row
        })
    }

    /// Forces of the bearings and couplings on the shafts that are not zero.
    fn outputs(&self, projection: &Projection) -> Vec<LinearOutput> {
        let mut outputs = Vec::new();
        let mut add = |name: String, unit: &str, displacement: Vec<f64>, velocity: Vec<f64>| {
            if displacement.iter().chain(&velocity).any(|&value| value != 0.0) {
                let velocity = if velocity.iter().all(|&value| value == 0.0) { Vec::new() } else { velocity };
                outputs.push(LinearOutput { name, unit: unit.to_owned(), displacement, velocity });
            }
        };
        for (member, name) in ["pinion", "gear"].into_iter().enumerate() {
            for (number, bearing) in projection.bearings[member].iter().enumerate() {
                for (i, quantity) in ["f_x", "f_y", "f_z", "m_x", "m_y"].into_iter().enumerate() {
                    let rows = [&bearing.displacement, &bearing.velocity].map(|m| m.row(i).iter().copied().collect());
                    let [displacement, velocity] = rows;
                    let unit = if i < 3 { "N" } else { "N m" };
                    add(format!("{quantity}_{name}_bearing_{}", number + 1), unit, displacement, velocity);
                }
            }
            let shaft = &self.shafts[member];
            let input = [&self.train.pinion, &self.train.gear][member].coupling;
            let [rotation, axial] = &shaft.coupling;
            if let (Some(unknown), Some(spring)) = (shaft.machine, input.torsional) {
                let mut twist = rotation.clone();
                twist.push((unknown, -1.0));
                let twist = projected_row(&twist, &projection.vectors);
                let rows = [spring.torsional_nm_per_rad, spring.torsional_damping_nm_s_per_rad];
                let [displacement, velocity] = rows.map(|factor| (&twist * -factor).as_slice().to_vec());
                add(format!("m_z_{name}_coupling"), "N m", displacement, velocity);
            }
            let axial = projected_row(axial, &projection.vectors) * -input.axial_n_per_m;
            add(format!("f_z_{name}_coupling"), "N", axial.as_slice().to_vec(), Vec::new());
        }
        outputs
    }

    /// Receptances of the full model with open meshes.
    fn receptance(&self, omega: f64, pinion_speed_rad_s: f64) -> Result<Receptance, ShaftError> {
        let mut band = self.dynamic_stiffness(omega, pinion_speed_rad_s, None);
        band.add(Complex::new(0.0, LOSS_FACTOR), &self.open_stiffness);
        let count = self.meshes.len();
        let mut motion = vec![Complex::new(0.0, 0.0); self.unknowns() * count];
        for (column, mesh) in self.meshes.iter().enumerate() {
            mesh.row.iter().for_each(|&(unknown, h)| motion[unknown * count + column] += h);
        }
        if !band.solve(&mut motion, count) {
            return Err(ShaftError::IllConditioned { reason: "the dynamic stiffness of the shafts is singular" });
        }
        let column = |j: usize| -> Vec<Complex<f64>> { motion.iter().skip(j).step_by(count).copied().collect() };
        let columns = [column(0), column(1)];
        let meshes =
            Matrix2::from_fn(|i, j| self.meshes[i].row.iter().map(|&(unknown, h)| columns[j][unknown] * h).sum());
        let all: Vec<&RotorBearing> = self.shafts.iter().flat_map(|shaft| &shaft.bearings).collect();
        let forces = columns.each_ref().map(|motion| {
            all.iter().flat_map(|bearing| bearing.force(motion, omega).into_iter().take(3)).collect::<Vec<_>>()
        });
        Ok(Receptance { meshes, bearings: DMatrix::from_fn(3 * all.len(), count, |i, j| forces[j][i]) })
    }
}

/// A row over the unknowns as one over the vectors of a basis.
pub(super) fn projected_row(row: &[(usize, f64)], vectors: &DMatrix<f64>) -> DVector<f64> {
    DVector::from_iterator(vectors.ncols(), vectors.column_iter().map(|vector| dot(row, vector.as_slice())))
}
