//! Natural modes of the geared rotor at rest.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::eigen::{Eigenmodes, ShiftedStiffness, count_below};
use super::sparse::{SparseRow, dot};
use super::{GearedRotor, RotorBearing};
use crate::shafts::error::ShaftError;
use crate::watch::Watch;

/// Eigenvalue over the limit of the range below which a mode is a rigid-body mode.
const RIGID_BODY: f64 = 1e-9;

/// The same over the rounding of the eigenvalues.
const RIGID_BODY_OVER_ROUNDING: f64 = 20.0;

/// Which modes are calculated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeRange {
    /// All modes below this frequency, Hz.
    pub up_to_hz: f64,
    /// At most this number, rigid-body modes included.
    pub most: usize,
}

/// Shares of the strain energy of a mode; they add up to 1. All 0 for a rigid-body mode.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StrainShares {
    /// Mesh springs of the left and the right half, their tilting stiffness included.
    pub meshes: [f64; 2],
    /// Each bearing of the pinion's and of the gear's shaft.
    pub bearings: [Vec<f64>; 2],
    /// Beams of the pinion's and of the gear's shaft.
    pub shafts: [f64; 2],
    /// Couplings of the pinion and of the gear: torsional and axial springs.
    pub couplings: [f64; 2],
}

impl StrainShares {
    /// Share of all bearings.
    pub fn all_bearings(&self) -> f64 {
        self.bearings.iter().flatten().sum()
    }
}

/// Shares of the kinetic energy of a mode.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct KineticShares {
    /// Motion along x and y and rotation about them. With `axial` and `torsion` it adds up to 1.
    pub lateral: f64,
    /// Motion along z.
    pub axial: f64,
    /// Rotation about z, the machines' included.
    pub torsion: f64,
    /// The pinion's shaft with its bodies. With `gear_shaft` and `machines` it adds up to 1.
    pub pinion_shaft: f64,
    /// The gear's shaft with its bodies.
    pub gear_shaft: f64,
    /// The machines.
    pub machines: f64,
}

/// A natural mode of the undamped rotor at rest. The largest displacement or arc r_b φ of the mid-face sections is 1 m.
#[derive(Debug, Clone, PartialEq)]
pub struct RotorMode {
    /// Natural frequency, Hz; 0 for a rigid-body mode.
    pub frequency_hz: f64,
    /// Shares of the strain energy.
    pub strain: StrainShares,
    /// Shares of the kinetic energy.
    pub kinetic: KineticShares,
    /// u_x, u_y, u_z, r_b φ_x, r_b φ_y, r_b φ_z (m) of the sections at mid-face: pinion left, pinion right, gear left,
    /// gear right; r_b is the member's base radius.
    pub mid_face: [[f64; 6]; 4],
    /// Displacements (m, rad) along the pinion's and the gear's shaft, at the sections of
    /// [`GearedRotor::stations_m`].
    pub shafts: [Vec<[f64; 6]>; 2],
    /// Rotation of the machines at the couplings of the pinion and the gear, rad.
    pub machines: [Option<f64>; 2],
}

/// Natural modes with their vectors.
#[derive(Debug, Clone)]
pub struct RotorModes {
    /// By ascending frequency.
    pub modes: Vec<RotorMode>,
    /// ω² (rad²/s²), 0 for rigid-body modes.
    pub(super) eigenvalues: Vec<f64>,
    /// Columns: displacements of all unknowns, of unit modal mass.
    pub(super) vectors: DMatrix<f64>,
}

impl RotorModes {
    /// Number of rigid-body modes.
    pub fn rigid_body_modes(&self) -> usize {
        self.eigenvalues.iter().filter(|&&eigenvalue| eigenvalue == 0.0).count()
    }

    /// Natural frequencies without those of the rigid-body modes, ascending, Hz.
    pub fn natural_frequencies_hz(&self) -> Vec<f64> {
        self.eigenvalues.iter().filter(|&&l| l > 0.0).map(|l| l.sqrt() / TAU).collect()
    }
}

impl GearedRotor {
    /// Natural modes of the undamped rotor at rest, by ascending frequency. Of unsymmetric bearings the symmetric part
    /// counts.
    ///
    /// # Errors
    /// [`ShaftError::InvalidValue`] for a range that is not positive, [`ShaftError::NegativeStiffness`],
    /// [`ShaftError::IllConditioned`], [`ShaftError::ModesNotConverged`].
    pub fn modes(&self, range: ModeRange) -> Result<RotorModes, ShaftError> {
        let limit = limit_of(range.up_to_hz)?;
        let wanted = count_below(&self.stiffness, &self.mass, limit).min(range.most);
        Ok(self.described(self.eigenmodes(limit, wanted, Watch::none())?))
    }

    /// The lowest modes with their shares and shapes.
    pub(super) fn described(&self, modes: Eigenmodes) -> RotorModes {
        let Eigenmodes { eigenvalues, vectors } = modes;
        let modes = (0..eigenvalues.len()).map(|i| self.mode(eigenvalues[i], vectors.column(i).as_slice())).collect();
        RotorModes { modes, eigenvalues, vectors }
    }

    /// The `wanted` lowest modes, of which most are below the eigenvalue `limit`; 0 for rigid-body modes.
    pub(super) fn eigenmodes(&self, limit: f64, wanted: usize, watch: Watch<'_>) -> Result<Eigenmodes, ShaftError> {
        let mut modes = self.shifted_stiffness(limit)?.lowest_modes(wanted, watch)?;
        let rigid = (RIGID_BODY * limit).max(RIGID_BODY_OVER_ROUNDING * self.rounding);
        if let Some(&lowest) = modes.eigenvalues.first().filter(|&&lowest| lowest < -rigid) {
            return Err(self.negative(lowest));
        }
        modes.eigenvalues.iter_mut().filter(|l| **l < rigid).for_each(|l| *l = 0.0);
        if modes.eigenvalues.iter().filter(|l| **l == 0.0).count() == 1 {
            self.insert_free_rotation(&mut modes.vectors);
        }
        Ok(modes)
    }

    /// Puts the free rotation of the train, known exactly, in the place of the first mode, and makes the others
    /// orthogonal to it: they are but for rounding.
    fn insert_free_rotation(&self, vectors: &mut DMatrix<f64>) {
        let mut rotation = DVector::zeros(self.unknowns());
        for (member, shaft) in self.shafts.iter().enumerate() {
            let angle = [1.0, -1.0][member] * self.geometry.sense / self.geometry.base_radii_m[member];
            let unknowns = shaft.nodes.unknowns.iter().map(|first| first + 5);
            unknowns.chain(shaft.machine).for_each(|unknown| rotation[unknown] = angle);
        }
        let mut momentum = DVector::from_vec(self.mass.times(rotation.as_slice()));
        let norm = rotation.dot(&momentum).sqrt();
        rotation /= norm;
        momentum /= norm;
        for (i, mut vector) in vectors.column_iter_mut().enumerate() {
            if i == 0 {
                vector.copy_from(&rotation);
            } else {
                let part = vector.dot(&momentum);
                vector.axpy(-part, &rotation, 1.0);
            }
        }
    }

    /// The stiffness shifted for modes below the eigenvalue `limit`.
    pub(super) fn shifted_stiffness(&self, limit: f64) -> Result<ShiftedStiffness<'_>, ShaftError> {
        ShiftedStiffness::new(&self.stiffness, &self.mass, limit, self.rounding).map_err(|shift| self.negative(-shift))
    }

    /// The reason of a negative eigenvalue: bearings, or rounding.
    fn negative(&self, eigenvalue_rad2_s2: f64) -> ShaftError {
        let bearings = self.shafts.iter().flat_map(|shaft| &shaft.bearings);
        let indefinite = bearings.into_iter().any(|bearing| {
            let cross = 0.5 * (bearing.stiffness[0][1] + bearing.stiffness[1][0]);
            bearing.stiffness[0][0] * bearing.stiffness[1][1] < cross * cross
        });
        if indefinite {
            return ShaftError::NegativeStiffness { eigenvalue_rad2_s2 };
        }
        ShaftError::IllConditioned { reason: "stiffnesses or masses are too far apart for natural modes" }
    }

    fn mode(&self, eigenvalue: f64, vector: &[f64]) -> RotorMode {
        let mid_face = self.mid_face_arcs(vector);
        let largest = mid_face.iter().flatten().fold(0.0f64, |l, &u| if u.abs() > l.abs() { u } else { l });
        let scale = if largest == 0.0 { 0.0 } else { 1.0 / largest };
        let shafts = [0, 1].map(|member| {
            let mut shape = self.displacements_at_nodes(member, vector);
            shape.iter_mut().flatten().for_each(|u| *u *= scale);
            shape
        });
        RotorMode {
            frequency_hz: eigenvalue.sqrt() / TAU,
            strain: if eigenvalue == 0.0 { self.no_strain() } else { self.strain_shares(vector) },
            kinetic: self.kinetic_shares(vector),
            mid_face: mid_face.map(|section| section.map(|u| u * scale)),
            shafts,
            machines: [0, 1].map(|member| self.shafts[member].machine.map(|unknown| vector[unknown] * scale)),
        }
    }

    /// u_x, u_y, u_z and the arcs r_b φ of the sections at mid-face.
    fn mid_face_arcs(&self, vector: &[f64]) -> [[f64; 6]; 4] {
        std::array::from_fn(|i| {
            let (member, half) = (i / 2, i % 2);
            let section = &self.shafts[member].mid_face[half];
            std::array::from_fn(|u| {
                let arc = if u < 3 { 1.0 } else { self.geometry.base_radii_m[member] };
                arc * dot(&section[u], vector)
            })
        })
    }

    fn no_strain(&self) -> StrainShares {
        let bearings = [0, 1].map(|member| vec![0.0; self.shafts[member].bearings.len()]);
        StrainShares { bearings, ..StrainShares::default() }
    }

    fn strain_shares(&self, vector: &[f64]) -> StrainShares {
        let square = |row: &SparseRow| dot(row, vector).powi(2);
        let mut shares = StrainShares {
            meshes: [0, 1].map(|half| {
                let mesh = &self.meshes[half];
                mesh.element.stiffness_n_per_m * square(&mesh.row)
                    + mesh.element.tilting_nm_per_rad * square(&mesh.tilt)
            }),
            bearings: [0, 1].map(|m| self.shafts[m].bearings.iter().map(|b| b.doubled_strain_energy(vector)).collect()),
            shafts: [0, 1].map(|member| self.shafts[member].beams.quadratic(vector)),
            couplings: [0, 1].map(|member| {
                let (shaft, input) = (&self.shafts[member], [&self.train.pinion, &self.train.gear][member]);
                let [rotation, axial] = &shaft.coupling;
                let torsion = shaft.machine.zip(input.coupling.torsional).map_or(0.0, |(unknown, spring)| {
                    spring.torsional_nm_per_rad * (dot(rotation, vector) - vector[unknown]).powi(2)
                });
                torsion + input.coupling.axial_n_per_m * square(axial)
            }),
        };
        let parts = || shares.meshes.iter().chain(&shares.shafts).chain(&shares.couplings);
        let total: f64 = parts().sum::<f64>() + shares.all_bearings();
        let all = shares.meshes.iter_mut().chain(&mut shares.shafts).chain(&mut shares.couplings);
        all.chain(shares.bearings.iter_mut().flatten()).for_each(|share| *share /= total);
        shares
    }

    fn kinetic_shares(&self, vector: &[f64]) -> KineticShares {
        let momentum = self.mass.times(vector);
        let energy = |unknown: usize| vector[unknown] * momentum[unknown];
        let mut shares = KineticShares::default();
        for (member, shaft) in self.shafts.iter().enumerate() {
            let of_shaft = if member == 0 { &mut shares.pinion_shaft } else { &mut shares.gear_shaft };
            for &first in &shaft.nodes.unknowns {
                let kinds = [0, 1, 3, 4].map(|i| energy(first + i)).iter().sum::<f64>();
                let (axial, torsion) = (energy(first + 2), energy(first + 5));
                shares.lateral += kinds;
                shares.axial += axial;
                shares.torsion += torsion;
                *of_shaft += kinds + axial + torsion;
            }
            if let Some(unknown) = shaft.machine {
                shares.torsion += energy(unknown);
                shares.machines += energy(unknown);
            }
        }
        shares
    }
}

impl RotorBearing {
    /// uᵀ K u of the symmetric part of the stiffness.
    fn doubled_strain_energy(&self, vector: &[f64]) -> f64 {
        let u: [f64; 6] = std::array::from_fn(|i| dot(&self.section[i], vector));
        self.stiffness
            .iter()
            .zip(&u)
            .map(|(row, u_i)| row.iter().zip(&u).map(|(k, u_j)| u_i * k * u_j).sum::<f64>())
            .sum()
    }
}

/// Limit of the eigenvalues of a frequency range, rad²/s².
pub(super) fn limit_of(up_to_hz: f64) -> Result<f64, ShaftError> {
    let limit = (TAU * up_to_hz).powi(2);
    if up_to_hz > 0.0 && limit.is_finite() && limit > 0.0 {
        return Ok(limit);
    }
    Err(ShaftError::InvalidRange { quantity: "up_to_hz", value: up_to_hz })
}
