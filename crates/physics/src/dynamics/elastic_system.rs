//! The linear part of a model closed with reference mesh stiffnesses, without its rigid-body modes, for harmonic
//! balance.

use std::any::Any;
use std::cell::RefCell;
use std::sync::{Arc, OnceLock};

use nalgebra::Complex;

use super::complex_modes::{ComplexModes, Pole};
use super::equations::{HalfEquations, PER_HALF, ZP};
use super::model::{DynamicModel, MotionState};
use super::rigid_body::RigidBodyModes;
use super::variation::Perturbation;
use crate::recent::Recent;

type C64 = Complex<f64>;

/// Coordinates q, their complex modes, and the rows and columns of the meshes in them. Time is the model's scaled time;
/// lists over halves have an entry for each solved half, lists over modes one for each pole.
pub(crate) struct ElasticSystem<const D: usize> {
    pub modes: Arc<ComplexModes>,
    pub poles: Vec<Pole>,
    /// k_ref, N/m.
    pub reference_stiffness: [f64; 2],
    /// Rates of the components per normal force of each mesh, and per tangential force of a torsional impact of each
    /// half.
    pub normal: Vec<Vec<C64>>,
    pub torsional: Vec<Vec<C64>>,
    /// Factors of the components in s of each mesh times rates, row by row: of the normal forces, then of the torsional
    /// impacts.
    pub residues: Vec<Vec<C64>>,
    /// Rows of x, and of the axial displacement of each half of the pinion.
    pub mesh_x: Vec<Vec<f64>>,
    pub axial: Vec<Vec<f64>>,
    /// Coordinates, and displacements s of each mesh (m), under the load alone.
    pub under_load: Vec<f64>,
    pub static_s_m: Vec<f64>,
    pub has_rigid_body_modes: bool,
    /// None for a train, whose first coordinates are q.
    basis: Option<Basis<D>>,
    antisymmetric: Antisymmetric<D>,
    largest_gain: OnceLock<f64>,
}

/// Solver coordinates per coordinate q, and their masses.
struct Basis<const D: usize> {
    columns: Vec<[f64; D]>,
    masses: [f64; D],
}

/// Antisymmetric perturbations of the system.
enum Antisymmetric<const D: usize> {
    /// The system has both kinds of perturbations, or is that of the antisymmetric ones.
    Included,
    /// Those of a mirror-symmetric pair.
    Apart(Arc<ElasticSystem<D>>),
    /// Those of a mirror-symmetric pair, whose modes are nearly dependent.
    Unknown,
}

/// Rows and columns of a system in its coordinates.
struct Rows {
    s: Vec<Vec<f64>>,
    mesh_x: Vec<Vec<f64>>,
    axial: Vec<Vec<f64>>,
    /// Accelerations per normal force of each mesh, and per tangential force of a torsional impact of each half.
    normal: Vec<Vec<f64>>,
    torsional: Vec<Vec<f64>>,
}

/// What the system of a pair depends on: number of coordinates, equations, reference stiffnesses and frequency.
#[derive(PartialEq)]
struct PairInputs {
    coordinates: usize,
    halves: [HalfEquations<f64>; 2],
    cos: f64,
    parity: f64,
    couples_rotations: bool,
    reference_stiffness: [f64; 2],
    omega_ref: f64,
}

/// Systems kept by each thread.
const KEPT: usize = 8;

thread_local! {
    /// The systems of the last pairs, so that the points of a sweep over the speed share theirs.
    static SYSTEMS: RefCell<Recent<PairInputs, Arc<dyn Any + Send + Sync>>> = const { RefCell::new(Recent::new(KEPT)) };
}

impl<const D: usize> ElasticSystem<D> {
    /// The system of a model; None where its complex modes are nearly dependent. `mean_stiffness_n_per_m`: reference
    /// stiffnesses of a pair; a train has its own.
    pub(super) fn find(model: &DynamicModel<D>, mean_stiffness_n_per_m: [f64; 2]) -> Option<Arc<Self>> {
        if DynamicModel::<D>::IS_TRAIN {
            return Self::of_train(model).map(Arc::new);
        }
        let inputs = PairInputs {
            coordinates: D,
            halves: model.halves,
            cos: model.cos,
            parity: model.parity(),
            couples_rotations: model.couples_rotations(),
            reference_stiffness: mean_stiffness_n_per_m,
            omega_ref: model.omega_ref,
        };
        SYSTEMS.with(|systems| {
            let known = systems.borrow().get(&inputs);
            if let Some(system) = known.and_then(|system| system.downcast::<Self>().ok()) {
                return Some(system);
            }
            let system = Arc::new(Self::of_pair(model, mean_stiffness_n_per_m)?);
            systems.borrow_mut().put(inputs, system.clone());
            Some(system)
        })
    }

    fn of_train(model: &DynamicModel<D>) -> Option<Self> {
        let train = model.train.as_deref()?;
        let n = train.elastic;
        let part = |row: &[f64; D]| row[..n].to_vec();
        let rows = Rows {
            s: train.mesh.iter().map(part).collect(),
            mesh_x: train.mesh_x.iter().map(part).collect(),
            axial: [1, 7].map(|row| part(&train.displacements[row])).to_vec(),
            normal: train.mesh_acceleration.iter().map(|a| part(&a.map(|a| -a))).collect(),
            torsional: train.torsion_acceleration.iter().map(part).collect(),
        };
        let modes = model.train_modes()?.complex().clone();
        Some(Self::new(modes, rows, train.reference_stiffness, part(train.static_load_state()), (None, train.rigid)))
    }

    fn of_pair(model: &DynamicModel<D>, reference_stiffness: [f64; 2]) -> Option<Self> {
        let halves = DynamicModel::<D>::HALVES;
        let masses = model.masses_kg();
        let basis = complement_of_rigid_body_modes(model)?;
        let project = |a: &[f64; D]| -> Vec<f64> {
            basis.iter().map(|column| (0..D).map(|c| column[c] * masses[c] * a[c]).sum()).collect()
        };
        let zero = [0.0; D];
        // By displacements, velocities, normal and tangential forces.
        let accelerations = |x: &[f64; D], v: &[f64; D], force: &dyn Fn(usize) -> f64, along: &dyn Fn(usize) -> f64| {
            let mut a = [0.0; D];
            for j in 0..halves {
                a[j * PER_HALF..][..PER_HALF].copy_from_slice(&model.half_acceleration(j, x, v, force(j), along(j)));
            }
            a
        };
        let none = |_: usize| 0.0;
        let modes = ComplexModes::new(basis.len(), |c| {
            let column = &basis[c];
            let springs = accelerations(column, &zero, &|j| reference_stiffness[j] * model.s(j, column), &none);
            let dampers = accelerations(&zero, column, &|j| model.halves[j].cm * model.s(j, column), &none);
            [springs, dampers].map(|a| project(&a.map(|a| -a)))
        })?;
        let row = |value: &dyn Fn(usize, &[f64; D]) -> f64| -> Vec<Vec<f64>> {
            (0..halves).map(|j| basis.iter().map(|column| value(j, column)).collect()).collect()
        };
        let unit = |j: usize| move |other: usize| f64::from(u8::from(other == j));
        let rows = Rows {
            s: row(&|j, column| model.s(j, column)),
            mesh_x: row(&|j, column| model.mesh_x(j, column)),
            axial: row(&|j, column| column[j * PER_HALF + ZP]),
            normal: (0..halves).map(|j| project(&accelerations(&zero, &zero, &unit(j), &none))).collect(),
            torsional: (0..halves).map(|j| project(&accelerations(&zero, &zero, &none, &unit(j)))).collect(),
        };
        let load = project(&accelerations(&zero, &zero, &none, &|j| model.halves[j].load));
        let at_rest = modes.excitation(&load).into_iter().zip(modes.poles());
        let components: Vec<C64> = at_rest.map(|(rate, pole)| -rate / pole.value).collect();
        let under_load = modes.state(&components).as_slice()[..basis.len()].to_vec();
        let rigid = model.active().count() - basis.len();
        let basis = (Some(Basis { columns: basis, masses }), rigid);
        let mut system = Self::new(Arc::new(modes), rows, reference_stiffness, under_load, basis);
        if D == PER_HALF && model.parity() > 0.0 {
            let other = Self::of_pair(&model.antisymmetric(), reference_stiffness);
            system.antisymmetric = other.map_or(Antisymmetric::Unknown, |other| Antisymmetric::Apart(Arc::new(other)));
        }
        Some(system)
    }

    fn new(
        modes: Arc<ComplexModes>,
        rows: Rows,
        reference_stiffness: [f64; 2],
        under_load: Vec<f64>,
        (basis, rigid): (Option<Basis<D>>, usize),
    ) -> Self {
        let excitation =
            |rows: &[Vec<f64>]| -> Vec<Vec<C64>> { rows.iter().map(|row| modes.excitation(row)).collect() };
        let (normal, torsional) = (excitation(&rows.normal), excitation(&rows.torsional));
        let s: Vec<Vec<C64>> = rows.s.iter().map(|row| modes.observation(row)).collect();
        let static_s_m = rows.s.iter().map(|row| row.iter().zip(&under_load).map(|(row, q)| row * q).sum()).collect();
        Self {
            poles: modes.poles(),
            reference_stiffness,
            residues: residues(&s, &normal).into_iter().chain(residues(&s, &torsional)).collect(),
            normal,
            torsional,
            mesh_x: rows.mesh_x,
            axial: rows.axial,
            under_load,
            static_s_m,
            has_rigid_body_modes: rigid > 0,
            basis,
            antisymmetric: Antisymmetric::Included,
            largest_gain: OnceLock::new(),
            modes,
        }
    }

    pub(super) fn halves(&self) -> usize {
        self.normal.len()
    }

    /// Frequency response at `omega` from products of observations with rates.
    pub(super) fn response(&self, omega: f64, residues: &[Vec<C64>], out: &mut [C64]) {
        out.fill(C64::ZERO);
        for (m, pole) in self.poles.iter().enumerate() {
            let up = (C64::new(0.0, omega) - pole.value).inv();
            let (up, down) = if pole.paired {
                (0.5 * up, 0.5 * (C64::new(0.0, omega) - pole.value.conj()).inv())
            } else {
                (up, C64::ZERO)
            };
            for (sum, residue) in out.iter_mut().zip(residues) {
                let residue = residue[m];
                *sum += residue * up + residue.conj() * down;
            }
        }
    }

    /// Largest singular value of the frequency response of every s to the normal forces, m/N, antisymmetric
    /// perturbations included; sampled about the poles, where the response has its largest values.
    pub(super) fn largest_gain_m_per_n(&self) -> f64 {
        let own = *self.largest_gain.get_or_init(|| {
            let gain = |omega: f64| {
                let mut g = [C64::ZERO; 4];
                let meshes = &self.residues[..self.residues.len() / 2];
                self.response(omega, meshes, &mut g[..meshes.len()]);
                let squares: f64 = g.iter().map(|g| g.norm_sqr()).sum();
                let determinant = (g[0] * g[3] - g[1] * g[2]).norm_sqr();
                (0.5 * (squares + (squares * squares - 4.0 * determinant).max(0.0).sqrt())).sqrt()
            };
            let about = |pole: &Pole| [-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| pole.value.im + part * pole.value.re);
            std::iter::once(0.0).chain(self.poles.iter().flat_map(about)).map(gain).fold(0.0, f64::max)
        });
        match &self.antisymmetric {
            Antisymmetric::Included => own,
            Antisymmetric::Apart(other) => own.max(other.largest_gain_m_per_n()),
            Antisymmetric::Unknown => f64::INFINITY,
        }
    }

    /// Solver coordinates and their velocities of coordinates q and theirs.
    pub(super) fn to_solver(&self, displacements: &[f64], velocities: &[f64]) -> Perturbation<D> {
        let (mut x, mut v) = ([0.0; D], [0.0; D]);
        let Some(Basis { columns: basis, .. }) = &self.basis else {
            x[..displacements.len()].copy_from_slice(displacements);
            v[..velocities.len()].copy_from_slice(velocities);
            return (x, v);
        };
        for (column, (q, rate)) in basis.iter().zip(displacements.iter().zip(velocities)) {
            for c in 0..D {
                x[c] += column[c] * q;
                v[c] += column[c] * rate;
            }
        }
        (x, v)
    }

    /// Puts displacements and velocities without rigid-body motion in place of those of a state, whose rigid-body modes
    /// of a train stay.
    pub(super) fn replace_elastic(&self, state: &mut MotionState<D>, (x, v): Perturbation<D>) {
        if self.basis.is_some() {
            (state.x, state.v) = (x, v);
            return;
        }
        let n = self.modes.coordinates();
        state.x[..n].copy_from_slice(&x[..n]);
        state.v[..n].copy_from_slice(&v[..n]);
    }

    /// Components of a perturbation in the complex modes; rigid-body motion has none.
    pub(super) fn components(&self, perturbation: &Perturbation<D>) -> Vec<C64> {
        let n = self.modes.coordinates();
        let Some(Basis { columns: basis, masses }) = &self.basis else {
            return self.modes.components(&perturbation.0[..n], &perturbation.1[..n]);
        };
        let project = |values: &[f64; D]| -> Vec<f64> {
            basis.iter().map(|column| (0..D).map(|c| column[c] * masses[c] * values[c]).sum()).collect()
        };
        self.modes.components(&project(&perturbation.0), &project(&perturbation.1))
    }
}

/// Basis, orthonormal with the masses as weights, of the motions of the active coordinates without rigid-body modes.
fn complement_of_rigid_body_modes<const D: usize>(model: &DynamicModel<D>) -> Option<Vec<[f64; D]>> {
    /// Part of the square of a direction outside the basis so far above which it is a new one.
    const INDEPENDENT: f64 = 1e-6;
    let masses = model.masses_kg();
    let rigid_body = RigidBodyModes::new(model).ok()?;
    let active: Vec<usize> = model.active().collect();
    let wanted = active.len().checked_sub(rigid_body.count())?;
    let unit = |c: usize| {
        let mut unit = [0.0; D];
        unit[c] = 1.0 / masses[c].sqrt();
        unit
    };
    if rigid_body.count() == 0 {
        return Some(active.into_iter().map(unit).collect());
    }
    let product = |a: &[f64; D], b: &[f64; D]| (0..D).map(|c| a[c] * masses[c] * b[c]).sum::<f64>();
    let mut basis: Vec<[f64; D]> = Vec::with_capacity(wanted);
    for c in active {
        let mut direction = rigid_body.project_out_of(unit(c));
        for _ in 0..2 {
            direction = rigid_body.project_out_of(direction);
            for column in &basis {
                let along = product(column, &direction);
                (0..D).for_each(|c| direction[c] -= along * column[c]);
            }
        }
        let square = product(&direction, &direction);
        if square > INDEPENDENT {
            basis.push(direction.map(|value| value / square.sqrt()));
        }
    }
    (basis.len() == wanted).then_some(basis)
}

/// Products of observations with excitations, by component: row by row.
pub(super) fn residues(observed: &[Vec<C64>], excited: &[Vec<C64>]) -> Vec<Vec<C64>> {
    let product = |a: &[C64], b: &[C64]| a.iter().zip(b).map(|(a, b)| a * b).collect();
    observed.iter().flat_map(|row| excited.iter().map(|column| product(row, column))).collect()
}
