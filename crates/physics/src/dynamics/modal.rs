//! Natural frequencies, mode shapes and static deflection with the mean mesh stiffness.

mod mode;
mod springs;

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::{Deserialize, Serialize};

use springs::{mesh_direction, spring_elements};

pub use mode::Mode;
pub use springs::SpringGroup;

use super::error::DynamicsError;
use super::modal_train::ModalTrain;
use super::model::DynamicModel;
use super::parameters::Parameters;
use super::trajectory::number_of_coordinates;
use crate::recent::Recent;

/// Natural frequencies and mode shapes of the undamped system with mean mesh stiffness and closed contact; of a train
/// with its reference mesh stiffnesses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NaturalModes {
    /// Ascending, Hz; 0 for rigid-body modes.
    pub frequencies_hz: Vec<f64>,
    /// One shape per frequency, in the order of displacements of [the module](crate::dynamics) (m, rad), normalised to
    /// φᵀ M φ = 1, with the largest displacement (of rotations: the arc) positive. For equal frequencies the basis is
    /// unique: rigid rotation first, then the directions of `preferred_directions` in turn.
    pub shapes: Vec<[f64; 12]>,
}

/// Squared frequency, relative to the largest, below which a mode is a rigid-body mode and within which frequencies are
/// equal: far above rounding (1e-15), far below any spring of practical stiffness.
pub(super) const RIGID_BODY_EIGENVALUE: f64 = 1e-12;

/// One value per displacement.
type DisplacementVector = [f64; 12];

/// All that the natural modes of a pair depend on.
#[derive(PartialEq)]
struct PairInputs {
    stiffness: DMatrix<f64>,
    masses: [f64; 12],
    radii_m: [f64; 2],
}

/// Modes kept by each thread.
const KEPT: usize = 8;

thread_local! {
    /// The modes of the last pairs, so that the points of a sweep over the speed share theirs.
    static MODES: RefCell<Recent<PairInputs, NaturalModes>> = const { RefCell::new(Recent::new(KEPT)) };
}

impl NaturalModes {
    /// Solves K φ = ω² M φ by the eigenvalues of M^-½ K M^-½.
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`].
    pub fn new(p: &Parameters) -> Result<Self, DynamicsError> {
        p.validate()?;
        if let Some(train) = &p.train {
            return Ok(Self::of_train(train));
        }
        let inputs = PairInputs {
            stiffness: stiffness_matrix(p),
            masses: masses(p),
            radii_m: [p.pinion_radius_m, p.gear_radius_m],
        };
        MODES.with(|known| {
            if let Some(modes) = known.borrow().get(&inputs) {
                return Ok(modes);
            }
            let modes = Self::of_pair(p, &inputs)?;
            known.borrow_mut().put(inputs, modes.clone());
            Ok(modes)
        })
    }

    fn of_pair(p: &Parameters, inputs: &PairInputs) -> Result<Self, DynamicsError> {
        let k = &inputs.stiffness;
        let root = inputs.masses.map(|m| 1.0 / m.sqrt());
        let scaled = DMatrix::from_fn(12, 12, |r, c| k[(r, c)] * root[r] * root[c]);
        let eigen = SymmetricEigen::try_new(scaled, f64::EPSILON, 10_000).ok_or(DynamicsError::InvalidParameter {
            name: "stiffness matrix",
            value: k.amax(),
            reason: "its eigenvalues cannot be computed",
        })?;
        let mut order: Vec<usize> = (0..12).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let largest = eigen.eigenvalues.amax();
        // All rigid-body modes form one group of equal frequencies.
        let squares: Vec<f64> = order
            .iter()
            .map(|&i| eigen.eigenvalues[i])
            .map(|l| if l > RIGID_BODY_EIGENVALUE * largest { l } else { 0.0 })
            .collect();
        let frequencies_hz = squares.iter().map(|l| l.sqrt() / std::f64::consts::TAU).collect();
        let vectors: Vec<DisplacementVector> =
            order.iter().map(|&i| std::array::from_fn(|c| eigen.eigenvectors[(c, i)])).collect();
        let directions = preferred_directions(p).map(|row| std::array::from_fn(|c| row[c] / root[c]));
        let mut shapes = Vec::with_capacity(12);
        let mut from = 0;
        while from < 12 {
            let group =
                squares[from..].iter().take_while(|l| **l - squares[from] <= RIGID_BODY_EIGENVALUE * largest).count();
            shapes.extend(canonical_basis(&vectors[from..from + group], &directions));
            from += group;
        }
        let shapes =
            shapes.into_iter().map(|v| with_positive_largest(p, std::array::from_fn(|c| v[c] * root[c]))).collect();
        Ok(Self { frequencies_hz, shapes })
    }

    /// The modes of a valid train closed with its reference mesh stiffnesses, as they move the twelve displacements.
    fn of_train(train: &ModalTrain) -> Self {
        let mut modes: Vec<(f64, [f64; 12])> = (0..train.len())
            .map(|i| {
                let square = if train.is_rigid_body_mode(i) { 0.0 } else { train.eigenvalues_rad2_s2[i] };
                (square.sqrt() / std::f64::consts::TAU, std::array::from_fn(|c| train.displacements[c][i]))
            })
            .collect();
        modes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (frequencies_hz, shapes) = modes.into_iter().unzip();
        Self { frequencies_hz, shapes }
    }

    /// Shapes of the rigid-body modes.
    pub fn rigid_body_modes(&self) -> impl Iterator<Item = &[f64; 12]> {
        self.shapes.iter().zip(&self.frequencies_hz).filter(|(_, f)| **f == 0.0).map(|(shape, _)| shape)
    }

    /// Deflection (m, rad) under the mean torques with the mean mesh stiffness, without impact, each half in contact on
    /// the flank loaded by its torque; no component along rigid-body modes.
    ///
    /// Of a train with a tabulated contact force: under that force at the start of the mesh period.
    pub fn static_deflection(&self, p: &Parameters) -> [f64; 12] {
        fn of_train<const D: usize>(p: &Parameters) -> [f64; 12] {
            let mean_n_per_m = [0, 1].map(|j| p.halves[j].mesh_stiffness.mean_n_per_m());
            DynamicModel::<D>::new(p)
                .map_or([0.0; 12], |model| model.physical_displacements(&model.static_state_of_train(mean_n_per_m).x))
        }
        if p.train.is_some() {
            return match number_of_coordinates(p, false) {
                52 => of_train::<52>(p),
                76 => of_train::<76>(p),
                _ => of_train::<100>(p),
            };
        }
        let mut force = torques(p);
        for j in 0..2 {
            let side = if p.halves[j].pinion_torque_nm < 0.0 { -1.0 } else { 1.0 };
            let preload = p.halves[j].mesh_stiffness.mean_n_per_m() * side * p.half_backlash_m;
            force += DVector::from_row_slice(&mesh_direction(p, j)) * preload;
        }
        let mut q = [0.0; 12];
        for (shape, f) in self.shapes.iter().zip(&self.frequencies_hz) {
            if *f > 0.0 {
                let omega = f * std::f64::consts::TAU;
                let amount = (0..12).map(|c| shape[c] * force[c]).sum::<f64>() / (omega * omega);
                for c in 0..12 {
                    q[c] += amount * shape[c];
                }
            }
        }
        q
    }
}

fn torques(p: &Parameters) -> DVector<f64> {
    let mut f = DVector::zeros(12);
    for (j, h) in p.halves.iter().enumerate() {
        f[6 * j + 2] = h.pinion_torque_nm;
        f[6 * j + 5] = -h.pinion_torque_nm * p.gear_radius_m / p.pinion_radius_m;
    }
    f
}

/// Directions for the basis of equal frequencies, in this order: rigid rotation of both halves alike and opposed, then
/// each displacement alike (as a mirror image) and opposed.
fn preferred_directions(p: &Parameters) -> [DisplacementVector; 14] {
    let rotation = |c: usize| match c {
        2 => 1.0 / p.pinion_radius_m,
        5 => 1.0 / p.gear_radius_m,
        _ => 0.0,
    };
    std::array::from_fn(|i| {
        let half = |c: usize| if i < 2 { rotation(c) } else { f64::from(u8::from(c == i / 2 - 1)) };
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        std::array::from_fn(|c| if c < 6 { half(c) } else { sign * mirrored(c) * half(c - 6) })
    })
}

/// −1 for the axial displacements, which change sign in the mirror image.
fn mirrored(c: usize) -> f64 {
    if c % 6 == 1 || c % 6 == 4 { -1.0 } else { 1.0 }
}

/// Orthonormal basis of the span of the orthonormal `vectors` that depends on that span alone: projections of
/// `directions` in turn, orthogonalised, dependent ones skipped.
fn canonical_basis(vectors: &[DisplacementVector], directions: &[DisplacementVector]) -> Vec<DisplacementVector> {
    // The directions span the whole space, so one of those left has at least a twelfth of its square in the rest of the
    // span.
    const INDEPENDENT: f64 = 1e-2;
    if vectors.len() == 1 {
        return vectors.to_vec();
    }
    let dot = |a: &DisplacementVector, b: &DisplacementVector| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<DisplacementVector> = Vec::with_capacity(vectors.len());
    for least in [INDEPENDENT, 1e-9] {
        for direction in directions {
            if basis.len() == vectors.len() {
                return basis;
            }
            let mut projection = [0.0; 12];
            for v in vectors {
                let amount = dot(v, direction);
                (0..12).for_each(|c| projection[c] += amount * v[c]);
            }
            for _ in 0..2 {
                for b in &basis {
                    let amount = dot(b, &projection);
                    (0..12).for_each(|c| projection[c] -= amount * b[c]);
                }
            }
            let square = dot(&projection, &projection);
            if square > least * dot(direction, direction) {
                basis.push(projection.map(|value| value / square.sqrt()));
            }
        }
    }
    // Reached only with numbers that are not finite.
    basis.extend_from_slice(&vectors[basis.len()..]);
    basis
}

/// Shape with the sign that makes its largest displacement (of rotations: the arc at the radius) positive; of equal
/// ones the first counts.
fn with_positive_largest(p: &Parameters, shape: DisplacementVector) -> DisplacementVector {
    const EQUAL: f64 = 1.0 - 1e-6;
    let arcs = arcs(p, &shape);
    let largest = arcs.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    let sign = arcs.iter().find(|a| a.abs() >= EQUAL * largest).map_or(1.0, |a| a.signum());
    shape.map(|value| sign * value)
}

/// Displacements with rotations as arcs at the radii of the reference plane, m.
fn arcs(p: &Parameters, shape: &DisplacementVector) -> DisplacementVector {
    std::array::from_fn(|c| match c % 6 {
        2 => shape[c] * p.pinion_radius_m,
        5 => shape[c] * p.gear_radius_m,
        _ => shape[c],
    })
}

fn masses(p: &Parameters) -> [f64; 12] {
    std::array::from_fn(|i| {
        let h = &p.halves[i / 6];
        match i % 6 {
            0 | 1 => h.pinion_mass_kg,
            2 => h.pinion_inertia_kg_m2,
            3 | 4 => h.gear_mass_kg,
            _ => h.gear_inertia_kg_m2,
        }
    })
}

fn stiffness_matrix(p: &Parameters) -> DMatrix<f64> {
    let mut k = DMatrix::zeros(12, 12);
    for element in spring_elements(p) {
        let row = &element.row;
        for c in (0..12).filter(|c| row[*c] != 0.0) {
            for r in 0..12 {
                k[(r, c)] += row[r] * row[c] * element.spring.stiffness;
            }
        }
    }
    k
}
