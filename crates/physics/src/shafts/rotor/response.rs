//! Forced vibration of the full model under displacement excitations of the meshes.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::sparse::{ComplexBand, SparseMatrix};
use super::{GearedRotor, RotorBearing};
use crate::shafts::error::ShaftError;

/// A harmonic displacement excitation of both meshes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Harmonics {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Complex amplitudes of e of the left and the right half along the flank normal, m; positive = gap.
    pub excitation_m: [Complex<f64>; 2],
    /// Speed of the pinion for the gyroscopic terms, rad/s, sign about z; 0 leaves them out.
    pub pinion_speed_rad_s: f64,
}

impl Harmonics {
    /// Angular frequency, rad/s.
    pub(super) fn omega(&self) -> Result<f64, ShaftError> {
        let omega = TAU * self.frequency_hz;
        if omega > 0.0 && omega.is_finite() {
            return Ok(omega);
        }
        Err(ShaftError::InvalidRange { quantity: "frequency_hz", value: self.frequency_hz })
    }
}

/// Steady harmonic vibration: complex amplitudes X of x(t) = Re(X e^{iωt}).
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponse {
    /// Mesh forces of the left and the right half, N.
    pub mesh_force_n: [Complex<f64>; 2],
    /// Forces (N) and moments (N m) of each bearing on the pinion's and on the gear's shaft, dampers included.
    pub bearings: [Vec<[Complex<f64>; 6]>; 2],
}

impl GearedRotor {
    /// Response to a harmonic displacement excitation by direct solution of the full model, meshes closed.
    ///
    /// # Errors
    /// [`ShaftError::InvalidRange`]; [`ShaftError::IllConditioned`] at the frequency of an undamped mode.
    pub fn frequency_response(&self, excitation: &Harmonics) -> Result<FrequencyResponse, ShaftError> {
        let omega = excitation.omega()?;
        let impedance = self
            .meshes
            .each_ref()
            .map(|mesh| Complex::new(mesh.element.stiffness_n_per_m, omega * mesh.element.damping_n_s_per_m));
        let mut forces = vec![Complex::new(0.0, 0.0); self.unknowns()];
        for ((mesh, k), e) in self.meshes.iter().zip(impedance).zip(excitation.excitation_m) {
            for &(unknown, h) in &mesh.row {
                forces[unknown] += k * e * h;
            }
        }
        let dynamic = self.dynamic_stiffness(omega, excitation.pinion_speed_rad_s, Some(impedance));
        if !dynamic.solve(&mut forces, 1) {
            return Err(ShaftError::IllConditioned { reason: "the excitation meets an undamped natural frequency" });
        }
        let mesh_force_n = [0, 1].map(|half| {
            let row = &self.meshes[half].row;
            let approach: Complex<f64> = row.iter().map(|&(unknown, h)| forces[unknown] * h).sum();
            impedance[half] * (approach - excitation.excitation_m[half])
        });
        let bearings = [0, 1]
            .map(|member| self.shafts[member].bearings.iter().map(|bearing| bearing.force(&forces, omega)).collect());
        Ok(FrequencyResponse { mesh_force_n, bearings })
    }

    /// K + iω(C + ΩG) − ω²M, with the meshes of the given impedances or without them.
    pub(super) fn dynamic_stiffness(
        &self,
        omega: f64,
        pinion_speed_rad_s: f64,
        meshes: Option<[Complex<f64>; 2]>,
    ) -> ComplexBand {
        let mut rows = [const { None }; 2];
        if meshes.is_some() {
            rows = self.meshes.each_ref().map(|mesh| Some(outer(&mesh.row, self.unknowns())));
        }
        let matrices = [&self.mass, &self.stiffness, &self.cross_stiffness, &self.damping, &self.gyroscopic];
        let half = matrices.iter().map(|matrix| matrix.bandwidth()).max().unwrap_or(0);
        let mut band = ComplexBand::new(self.unknowns(), half);
        let real = |value: f64| Complex::new(value, 0.0);
        band.add(real(1.0), &self.open_stiffness);
        band.add(real(1.0), &self.cross_stiffness);
        band.add(real(-omega * omega), &self.mass);
        band.add(Complex::new(0.0, omega), &self.damping);
        band.add(Complex::new(0.0, omega * pinion_speed_rad_s), &self.gyroscopic);
        for (row, impedance) in rows.iter().flatten().zip(meshes.into_iter().flatten()) {
            band.add(impedance, row);
        }
        band
    }
}

/// rowᵀ row.
fn outer(row: &[(usize, f64)], size: usize) -> SparseMatrix {
    let mut builder = super::sparse::SparseBuilder::default();
    builder.add_outer(1.0, row, row);
    builder.build(size)
}

impl RotorBearing {
    /// Force and moment on the shaft of a harmonic motion.
    pub(super) fn force(&self, motion: &[Complex<f64>], omega: f64) -> [Complex<f64>; 6] {
        let u: [Complex<f64>; 6] =
            std::array::from_fn(|i| self.section[i].iter().map(|&(unknown, w)| motion[unknown] * w).sum());
        std::array::from_fn(|i| {
            -(0..6).map(|j| Complex::new(self.stiffness[i][j], omega * self.damping[i][j]) * u[j]).sum::<Complex<f64>>()
        })
    }
}
