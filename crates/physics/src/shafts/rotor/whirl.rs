//! Whirl: natural frequencies of the turning rotor.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix};

use super::GearedRotor;
use super::eigen::symmetric_eigen;
use super::modes::RotorModes;
use super::sparse::SparseMatrix;
use crate::numerics::eigen::eigenvalues;
use crate::shafts::error::ShaftError;

/// A natural motion of the damped, turning rotor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DampedMode {
    /// Frequency of the damped vibration, Hz.
    pub frequency_hz: f64,
    /// Damping ratio; negative: the motion grows.
    pub damping_ratio: f64,
}

impl GearedRotor {
    /// Natural frequencies of the undamped rotor with gyroscopic terms at a speed of the pinion (rad/s, sign about z),
    /// ascending, Hz, rigid-body modes left out. The turning rotor is projected on the modes at rest: accurate up to
    /// about half of their highest frequency.
    ///
    /// # Errors
    /// [`ShaftError::IllConditioned`] when the eigenvalues cannot be found.
    ///
    /// With q = q̂ e^{iωt} and p = Λ^½ q/ω the equations ω² q = iωΩG q + Λ q become a Hermitian problem.
    pub fn whirl_frequencies_hz(&self, modes: &RotorModes, pinion_speed_rad_s: f64) -> Result<Vec<f64>, ShaftError> {
        let n = modes.eigenvalues.len();
        if n == 0 {
            return Ok(Vec::new());
        }
        let gyroscopic = projected(&self.gyroscopic, &modes.vectors) * pinion_speed_rad_s;
        let mut matrix = DMatrix::<Complex<f64>>::zeros(2 * n, 2 * n);
        for i in 0..n {
            for j in 0..n {
                // Antisymmetric but for rounding.
                matrix[(i, j)] = Complex::new(0.0, 0.5 * (gyroscopic[(i, j)] - gyroscopic[(j, i)]));
            }
            let root = Complex::new(modes.eigenvalues[i].sqrt(), 0.0);
            matrix[(i, n + i)] = root;
            matrix[(n + i, i)] = root;
        }
        let Some(eigen) = symmetric_eigen(matrix) else {
            return Err(ShaftError::IllConditioned { reason: "the whirl frequencies cannot be found" });
        };
        let mut frequencies: Vec<f64> = eigen.eigenvalues.iter().map(|w| w / TAU).collect();
        frequencies.sort_by(f64::total_cmp);
        // They come in pairs of opposite sign; of the rigid-body modes as zeros.
        let elastic = n - modes.rigid_body_modes();
        Ok(frequencies.split_off(2 * n - elastic))
    }

    /// Natural motions of the damped rotor with gyroscopic terms and unsymmetric bearings at a speed of the pinion
    /// (rad/s, sign about z), by ascending frequency; the meshes' dampers included, overdamped motions left out.
    ///
    /// # Errors
    /// [`ShaftError::IllConditioned`] when the eigenvalues cannot be found.
    pub fn damped_modes(&self, modes: &RotorModes, pinion_speed_rad_s: f64) -> Result<Vec<DampedMode>, ShaftError> {
        let n = modes.eigenvalues.len();
        if n == 0 {
            return Ok(Vec::new());
        }
        let scale = modes.eigenvalues.iter().fold(0.0f64, |m, l| m.max(*l)).sqrt().max(1.0);
        let mut damping =
            projected(&self.damping, &modes.vectors) + projected(&self.gyroscopic, &modes.vectors) * pinion_speed_rad_s;
        for mesh in &self.meshes {
            let row = super::reduction::projected_row(&mesh.row, &modes.vectors);
            damping += &row * row.transpose() * mesh.element.damping_n_s_per_m;
        }
        let mut stiffness = projected(&self.cross_stiffness, &modes.vectors);
        (0..n).for_each(|i| stiffness[(i, i)] += modes.eigenvalues[i]);
        // In time scaled by the highest frequency.
        let mut state = DMatrix::zeros(2 * n, 2 * n);
        state.view_mut((n, 0), (n, n)).copy_from(&(stiffness * (-1.0 / (scale * scale))));
        state.view_mut((n, n), (n, n)).copy_from(&(damping * (-1.0 / scale)));
        (0..n).for_each(|i| state[(i, n + i)] = 1.0);
        if !state.iter().all(|value| value.is_finite()) {
            return Err(ShaftError::IllConditioned { reason: "the damping or the speed is too large" });
        }
        let Some(values) = eigenvalues(state) else {
            return Err(ShaftError::IllConditioned { reason: "the eigenvalues of the damped rotor do not converge" });
        };
        let mut found: Vec<DampedMode> = values
            .iter()
            .filter(|value| value.im > 1e-7 * value.norm().max(1e-3))
            .map(|value| DampedMode { frequency_hz: value.im * scale / TAU, damping_ratio: -value.re / value.norm() })
            .collect();
        found.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
        Ok(found)
    }
}

/// Vᵀ A V.
pub(super) fn projected(matrix: &SparseMatrix, vectors: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_zero() {
        return DMatrix::zeros(vectors.ncols(), vectors.ncols());
    }
    let mut image = DMatrix::zeros(vectors.nrows(), vectors.ncols());
    for (vector, mut image) in vectors.column_iter().zip(image.column_iter_mut()) {
        image.copy_from_slice(&matrix.times(vector.as_slice()));
    }
    vectors.tr_mul(&image)
}
