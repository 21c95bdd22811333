//! Linear part of the equations of motion of a reduced drive train, in scaled time.
//!
//! Coordinates 0, 1, … are the elastic modes of the [`ModalTrain`], the last ones its rigid-body modes; those between
//! are not in use and stay zero.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};

use super::equations::{PER_HALF, is_rigid_rotation};
use super::lanes::Real;
use super::modal_train::{LinearOutput, MAX_RIGID_BODY_MODES, ModalTrain};
use super::train_modes::TrainModes;

/// Sizes of the coordinate vectors of trains.
const TRAIN_SIZES: [usize; 3] = [52, 76, 100];

/// Smallest of the [`TRAIN_SIZES`] that holds a train.
pub(crate) fn train_size(train: &ModalTrain) -> usize {
    let elastic = (0..train.len()).filter(|&i| !train.is_rigid_body_mode(i)).count();
    TRAIN_SIZES.into_iter().find(|d| elastic + MAX_RIGID_BODY_MODES <= *d).unwrap_or(TRAIN_SIZES[2])
}

/// One value per coordinate.
type Row<const D: usize> = [f64; D];

/// A further quantity of a train, of coordinates and of their velocities in scaled time.
#[derive(Debug, Clone)]
pub(crate) struct OutputRows<const D: usize> {
    pub displacement: Row<D>,
    pub velocity: Row<D>,
}

/// Columns of a matrix that acts on coordinates or velocities beside its diagonal, four at a time.
#[derive(Debug, Clone)]
struct Columns<const D: usize>(Vec<([usize; 4], [Row<D>; 4])>);

impl<const D: usize> Columns<D> {
    /// The columns of `matrix` with entries off the diagonal; the diagonal itself is left out.
    fn new(matrix: impl Fn(usize, usize) -> f64) -> Self {
        let column = |c: usize| -> Row<D> { std::array::from_fn(|r| if r == c { 0.0 } else { matrix(r, c) }) };
        let filled: Vec<(usize, Row<D>)> =
            (0..D).map(|c| (c, column(c))).filter(|(_, column)| column.iter().any(|v| *v != 0.0)).collect();
        let four = |some: &[(usize, Row<D>)]| {
            let at = |i: usize| some.get(i).map_or((0, [0.0; D]), |(c, column)| (*c, *column));
            (std::array::from_fn(|i| at(i).0), std::array::from_fn(|i| at(i).1))
        };
        Self(filled.chunks(4).map(four).collect())
    }

    /// `out` −= matrix · `values`.
    #[inline(always)]
    fn subtract_product<R: Real>(&self, values: &[R; D], out: &mut [R; D]) {
        for (sources, columns) in &self.0 {
            let [f0, f1, f2, f3] = [values[sources[0]], values[sources[1]], values[sources[2]], values[sources[3]]];
            let [c0, c1, c2, c3] = columns;
            for r in 0..D {
                let left = R::splat(c0[r]) * f0 + R::splat(c1[r]) * f1;
                let right = R::splat(c2[r]) * f2 + R::splat(c3[r]) * f3;
                out[r] -= left + right;
            }
        }
    }
}

/// The equations q″ = load − stiffness q − damping q′ − cross q − Σ_j mesh_j/ω² (F_j − k_ref,j s_j) in scaled time, ω
/// being its reference frequency.
#[derive(Debug, Clone)]
pub(crate) struct TrainEquations<const D: usize> {
    /// Number of elastic modes and of rigid-body modes.
    pub elastic: usize,
    pub rigid: usize,
    /// Coordinate of each mode of the [`ModalTrain`].
    pub places: Vec<usize>,
    /// λ/ω² and diagonal of the damping matrix over ω.
    stiffness: Row<D>,
    damping: Row<D>,
    off_diagonal_damping: Columns<D>,
    off_diagonal_cross: Columns<D>,
    /// Rows of s.
    pub mesh: [Row<D>; 2],
    /// mesh/ω²: acceleration per normal force that opens the mesh, negative.
    pub mesh_acceleration: [Row<D>; 2],
    /// k_ref, N/m.
    pub reference_stiffness: [f64; 2],
    /// Acceleration per tangential force of a torsional impact.
    pub(super) torsion_acceleration: [Row<D>; 2],
    load: Row<D>,
    /// Rows of the twelve displacements (m, rad), and of x of each half.
    pub displacements: [Row<D>; 12],
    pub mesh_x: [Row<D>; 2],
    pub outputs: Vec<OutputRows<D>>,
    /// Coordinates of least energy of twelve displacements (m, rad), and velocities of least kinetic energy.
    from_displacements: Vec<[f64; 12]>,
    from_velocities: Vec<[f64; 12]>,
    /// Static displacements s per load and per normal force: see [`TrainEquations::static_state`].
    statics: Statics<D>,
    modes: OnceLock<Option<TrainModes>>,
}

/// Static solution of the train closed with its reference stiffnesses.
#[derive(Debug, Clone)]
struct Statics<const D: usize> {
    /// Coordinates under the load alone, and per normal force that opens each mesh, negative.
    load: Row<D>,
    opening: [Row<D>; 2],
}

impl<const D: usize> TrainEquations<D> {
    pub(crate) fn new(train: &ModalTrain, radii_m: [f64; 2], omega_ref: f64) -> Self {
        let n = train.len();
        let (rigid, elastic): (Vec<usize>, Vec<usize>) = (0..n).partition(|&i| train.is_rigid_body_mode(i));
        // Mode of each coordinate.
        let mut modes: [Option<usize>; D] = [None; D];
        let mut places = vec![0; n];
        let elastic_places = elastic.iter().zip(0..);
        for (i, c) in elastic_places.chain(rigid.iter().zip(D - MAX_RIGID_BODY_MODES..)) {
            (modes[c], places[*i]) = (Some(*i), c);
        }
        let row = |values: &[f64], factor: f64| -> Row<D> {
            std::array::from_fn(|c| modes[c].and_then(|i| values.get(i)).map_or(0.0, |v| v * factor))
        };
        let square = 1.0 / (omega_ref * omega_ref);
        let entry = |matrix: &[f64], r: usize, c: usize| match (modes[r], modes[c]) {
            (Some(r), Some(c)) => matrix[r * n + c],
            _ => 0.0,
        };
        let cross = train.cross_stiffness_per_s2.as_deref();
        let cross = |r: usize, c: usize| cross.map_or(0.0, |matrix| entry(matrix, r, c) * square);
        let mut stiffness = row(&train.eigenvalues_rad2_s2, square);
        for c in 0..D {
            // The eigenvalue of a rigid-body mode is rounding.
            stiffness[c] = if is_rigid_rotation(D, c) { 0.0 } else { stiffness[c] } + cross(c, c);
        }
        let damping = |r: usize, c: usize| entry(&train.damping_per_s, r, c) / omega_ref;
        let mesh = train.mesh.each_ref().map(|m| row(m, 1.0));
        let displacements: [Row<D>; 12] = std::array::from_fn(|i| row(&train.displacements[i], 1.0));
        let [radius_p, radius_g] = radii_m;
        let half = |j: usize| &displacements[PER_HALF * j..PER_HALF * (j + 1)];
        let arcs =
            [0, 1].map(|j| -> Row<D> { std::array::from_fn(|c| radius_p * half(j)[2][c] - radius_g * half(j)[5][c]) });
        let mesh_x = [0, 1].map(|j| -> Row<D> { std::array::from_fn(|c| half(j)[0][c] - half(j)[3][c] + arcs[j][c]) });
        let output = |o: &LinearOutput| OutputRows {
            displacement: row(&o.displacement, 1.0),
            velocity: row(&o.velocity, omega_ref),
        };
        let load = row(&train.load_n, square);
        let mesh_acceleration = mesh.map(|m| m.map(|v| v * square));
        let off_diagonal_cross = Columns::new(cross);
        let statics = Statics::new(elastic.len(), (&stiffness, cross), &load, &mesh_acceleration);
        let (from_displacements, from_velocities) = inverse_displacements(&displacements, &stiffness, radii_m);
        Self {
            elastic: elastic.len(),
            rigid: rigid.len(),
            places,
            stiffness,
            damping: std::array::from_fn(|c| damping(c, c)),
            off_diagonal_damping: Columns::new(damping),
            off_diagonal_cross,
            mesh,
            mesh_acceleration,
            reference_stiffness: train.reference_stiffness_n_per_m,
            torsion_acceleration: arcs.map(|a| a.map(|v| v * square)),
            load,
            displacements,
            mesh_x,
            outputs: train.outputs.iter().map(output).collect(),
            from_displacements,
            from_velocities,
            statics,
            modes: OnceLock::new(),
        }
    }

    /// Complex modes with the mesh dampers (of each mesh in scaled time, N/m), the same at every call; None where the
    /// eigenvectors are nearly dependent.
    pub(super) fn modes(&self, mesh_damping: [f64; 2]) -> Option<&TrainModes> {
        self.modes.get_or_init(|| TrainModes::new(self, mesh_damping)).as_ref()
    }

    /// Accelerations in scaled time from the normal forces less k_ref s, the tangential forces of torsional impacts,
    /// and `loads` times the load. Linear and homogeneous in all of them.
    #[inline(always)]
    pub(super) fn acceleration<R: Real>(
        &self,
        (x, v): (&[R; D], &[R; D]),
        normal: [R; 2],
        along: Option<[R; 2]>,
        loads: R,
    ) -> [R; D] {
        let mut a = [R::splat(0.0); D];
        for c in 0..D {
            let springs = R::splat(self.stiffness[c]) * x[c] + R::splat(self.damping[c]) * v[c];
            let meshes =
                R::splat(self.mesh_acceleration[0][c]) * normal[0] + R::splat(self.mesh_acceleration[1][c]) * normal[1];
            a[c] = R::splat(self.load[c]) * loads - springs - meshes;
        }
        if let Some(along) = along {
            for c in 0..D {
                a[c] += R::splat(self.torsion_acceleration[0][c]) * along[0]
                    + R::splat(self.torsion_acceleration[1][c]) * along[1];
            }
        }
        self.off_diagonal_damping.subtract_product(v, &mut a);
        self.off_diagonal_cross.subtract_product(x, &mut a);
        a
    }

    /// Product of the damping matrix in scaled time with velocities.
    pub(super) fn damping_product(&self, v: &Row<D>) -> Row<D> {
        let mut out: Row<D> = std::array::from_fn(|c| -self.damping[c] * v[c]);
        self.off_diagonal_damping.subtract_product(v, &mut out);
        out.map(|a| -a)
    }

    /// Product of the stiffness matrix in scaled time, closed with the reference stiffnesses, with coordinates.
    pub(super) fn stiffness_product(&self, x: &Row<D>) -> Row<D> {
        let mut out: Row<D> = std::array::from_fn(|c| -self.stiffness[c] * x[c]);
        self.off_diagonal_cross.subtract_product(x, &mut out);
        out.map(|a| -a)
    }

    /// Twelve displacements (m, rad) of coordinates.
    pub(crate) fn physical_displacements(&self, x: &Row<D>) -> [f64; 12] {
        self.displacements.each_ref().map(|row| dot(row, x))
    }

    /// Coordinates of least potential energy ½ Σ λ q² that have these twelve displacements (m, rad).
    pub(crate) fn coordinates(&self, displacements: &[f64]) -> Row<D> {
        product(&self.from_displacements, displacements)
    }

    /// Velocities of least kinetic energy that move the twelve displacements at these rates.
    pub(crate) fn velocities(&self, rates: &[f64]) -> Row<D> {
        product(&self.from_velocities, rates)
    }

    /// Normal forces of both meshes under the load, closed with the reference stiffnesses, N.
    pub(crate) fn static_forces_n(&self) -> [f64; 2] {
        [0, 1].map(|j| self.reference_stiffness[j] * dot(&self.mesh[j], &self.statics.load))
    }

    /// Coordinates under the load alone, closed with the reference stiffnesses.
    pub(super) fn static_load_state(&self) -> &Row<D> {
        &self.statics.load
    }

    /// Coordinates at rest under the load with a normal force of each mesh that is a function of its s: `law(j, s)` is
    /// force (N) and stiffness (N/m). `start`: displacements s from which Newton's method starts; kept where it does
    /// not converge.
    pub(crate) fn static_state(&self, start: [f64; 2], law: impl Fn(usize, f64) -> (f64, f64)) -> Row<D> {
        const MAX_ITERATIONS: usize = 50;
        // s = s_load + Σ_k G_jk (k_ref s_k − F_k).
        let free = [0, 1].map(|j| dot(&self.mesh[j], &self.statics.load));
        let g = [0, 1].map(|j| [0, 1].map(|k| dot(&self.mesh[j], &self.statics.opening[k])));
        let excess = |s: [f64; 2]| [0, 1].map(|j| self.reference_stiffness[j] * s[j] - law(j, s[j]).0);
        let defect = |s: [f64; 2]| {
            let f = excess(s);
            [0, 1].map(|j| s[j] - free[j] - g[j][0] * f[0] - g[j][1] * f[1])
        };
        let size = |r: [f64; 2]| r[0].abs().max(r[1].abs());
        let mut s = start;
        let mut r = defect(s);
        for _ in 0..MAX_ITERATIONS {
            let slope = [0, 1].map(|k| self.reference_stiffness[k] - law(k, s[k]).1);
            let j = |row: usize, k: usize| f64::from(u8::from(row == k)) - g[row][k] * slope[k];
            let (a, b, c, d) = (j(0, 0), j(0, 1), j(1, 0), j(1, 1));
            let determinant = a * d - b * c;
            let step = [(d * r[0] - b * r[1]) / determinant, (a * r[1] - c * r[0]) / determinant];
            if !step.iter().all(|v| v.is_finite()) {
                break;
            }
            // Halved until the defect falls: the law has bends at first contact.
            let next = (0..20).map(|i| 0.5f64.powi(i)).find_map(|part| {
                let next = [s[0] - part * step[0], s[1] - part * step[1]];
                (size(defect(next)) < size(r)).then_some(next)
            });
            let Some(next) = next else { break };
            s = next;
            r = defect(s);
            if size(r) <= 1e-15 * size(s) {
                break;
            }
        }
        let f = excess(s);
        std::array::from_fn(|c| {
            self.statics.load[c] + self.statics.opening[0][c] * f[0] + self.statics.opening[1][c] * f[1]
        })
    }
}

impl<const D: usize> Statics<D> {
    fn new(
        elastic: usize,
        (stiffness, cross): (&Row<D>, impl Fn(usize, usize) -> f64),
        load: &Row<D>,
        mesh_acceleration: &[Row<D>; 2],
    ) -> Self {
        let coupled = (0..elastic).any(|r| (0..elastic).any(|c| r != c && cross(r, c) != 0.0));
        let solve = |force: &Row<D>| -> Row<D> {
            if coupled {
                let matrix = DMatrix::from_fn(elastic, elastic, |r, c| if r == c { stiffness[c] } else { cross(r, c) });
                let solution = matrix.lu().solve(&DVector::from_row_slice(&force[..elastic]));
                std::array::from_fn(|c| solution.as_ref().and_then(|s| s.get(c)).copied().unwrap_or(0.0))
            } else {
                std::array::from_fn(|c| if c < elastic { force[c] / stiffness[c] } else { 0.0 })
            }
        };
        Self { load: solve(load), opening: mesh_acceleration.each_ref().map(solve) }
    }
}

/// Matrices from twelve displacements to the coordinates of least potential energy, and from twelve rates to the
/// velocities of least kinetic energy. Displacements that no coordinates have are met in the sense of least squares,
/// rotations counted as arcs.
fn inverse_displacements<const D: usize>(
    displacements: &[Row<D>; 12],
    stiffness: &Row<D>,
    [radius_p, radius_g]: [f64; 2],
) -> (Vec<[f64; 12]>, Vec<[f64; 12]>) {
    /// Singular values below this part of the largest count as zero.
    const SINGULAR: f64 = 1e-10;
    let scale = |r: usize| match r % PER_HALF {
        2 => radius_p,
        5 => radius_g,
        _ => 1.0,
    };
    let rows = DMatrix::from_fn(12, D, |r, c| displacements[r][c] * scale(r));
    let pseudo_inverse = |matrix: DMatrix<f64>| {
        let (r, c) = matrix.shape();
        let largest = matrix.amax().max(f64::MIN_POSITIVE);
        matrix.pseudo_inverse(SINGULAR * largest).unwrap_or_else(|_| DMatrix::zeros(c, r))
    };
    let rigid = DMatrix::from_fn(12, MAX_RIGID_BODY_MODES, |r, c| rows[(r, D - MAX_RIGID_BODY_MODES + c)]);
    let from_rigid = pseudo_inverse(rigid.clone());
    // Rigid-body modes cost no energy: they take what they can of the displacements, elastic modes the rest.
    let rest = DMatrix::identity(12, 12) - &rigid * &from_rigid;
    let elastic = D - MAX_RIGID_BODY_MODES;
    let root = |c: usize| if stiffness[c] > 0.0 { 1.0 / stiffness[c].sqrt() } else { 0.0 };
    let weighted = &rest * DMatrix::from_fn(12, elastic, |r, c| rows[(r, c)] * root(c));
    let of_elastic = pseudo_inverse(weighted) * &rest;
    let of_elastic = DMatrix::from_fn(elastic, 12, |r, c| of_elastic[(r, c)] * root(r));
    let remainder = DMatrix::identity(12, 12) - rows.columns(0, elastic) * &of_elastic;
    let of_rigid = from_rigid * remainder;
    let position = |r: usize, c: usize| {
        let value = if r < elastic { of_elastic[(r, c)] } else { of_rigid[(r - elastic, c)] };
        value * scale(c)
    };
    let of_rates = pseudo_inverse(rows.clone());
    let table = |f: &dyn Fn(usize, usize) -> f64| (0..D).map(|r| std::array::from_fn(|c| f(r, c))).collect();
    (table(&position), table(&|r, c| of_rates[(r, c)] * scale(c)))
}

fn product<const D: usize>(matrix: &[[f64; 12]], values: &[f64]) -> Row<D> {
    std::array::from_fn(|c| matrix[c].iter().zip(values).map(|(m, v)| m * v).sum())
}

/// Scalar product in four partial sums.
#[inline(always)]
pub(crate) fn dot<const D: usize, R: Real>(row: &[f64; D], x: &[R; D]) -> R {
    let mut sums = [R::splat(0.0); 4];
    for (row, x) in row.chunks_exact(4).zip(x.chunks_exact(4)) {
        for k in 0..4 {
            sums[k] += R::splat(row[k]) * x[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}
