//! Matrices of one Timoshenko beam element, from the exact static interpolation of the load-free element.

use crate::numerics::gauss::gauss_legendre_unit;
use crate::shafts::beam::BeamSection;

/// Displacements of both ends of an element.
pub(super) const ELEMENT_UNKNOWNS: usize = 12;

/// A beam element.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    pub(super) length_m: f64,
    pub(super) section: BeamSection,
}

/// Rows of deflection, section rotation and their moduli in one plane, over the deflection and the rotation of the
/// left, then of the right end.
struct PlaneRows {
    deflection: [f64; 4],
    rotation: [f64; 4],
}

/// Indices of the unknowns of the planes x–z (u_x, φ_y) and y–z (u_y, −φ_x), with their signs.
const PLANES: [[(usize, f64); 4]; 2] =
    [[(0, 1.0), (4, 1.0), (6, 1.0), (10, 1.0)], [(1, 1.0), (3, -1.0), (7, 1.0), (9, -1.0)]];

pub(super) type ElementMatrix = [[f64; ELEMENT_UNKNOWNS]; ELEMENT_UNKNOWNS];

impl Element {
    /// Φ = 12 EI/(κGA L²).
    fn shear_parameter(&self) -> f64 {
        12.0 * self.section.bending_n_m2 / (self.section.shear_n * self.length_m * self.length_m)
    }

    /// Interpolation in one plane at `xi` = 0 … 1 (Przemieniecki, Theory of Matrix Structural Analysis, 1968).
    fn plane_rows(&self, xi: f64) -> PlaneRows {
        let (l, phi) = (self.length_m, self.shear_parameter());
        let per = 1.0 / (1.0 + phi);
        let (xi2, xi3) = (xi * xi, xi * xi * xi);
        PlaneRows {
            deflection: [
                (1.0 - 3.0 * xi2 + 2.0 * xi3 + phi * (1.0 - xi)) * per,
                l * (xi - 2.0 * xi2 + xi3 + 0.5 * phi * (xi - xi2)) * per,
                (3.0 * xi2 - 2.0 * xi3 + phi * xi) * per,
                l * (xi3 - xi2 + 0.5 * phi * (xi2 - xi)) * per,
            ],
            rotation: [
                6.0 * (xi2 - xi) / l * per,
                (1.0 - 4.0 * xi + 3.0 * xi2 + phi * (1.0 - xi)) * per,
                6.0 * (xi - xi2) / l * per,
                (3.0 * xi2 - 2.0 * xi + phi * xi) * per,
            ],
        }
    }

    /// Rows of the six displacements of the section at `xi` = 0 … 1 over the unknowns of both ends.
    pub(super) fn interpolation(&self, xi: f64) -> [[f64; ELEMENT_UNKNOWNS]; 6] {
        let mut rows = [[0.0; ELEMENT_UNKNOWNS]; 6];
        let plane = self.plane_rows(xi);
        for (i, unknowns) in PLANES.iter().enumerate() {
            for (k, &(unknown, sign)) in unknowns.iter().enumerate() {
                rows[i][unknown] = sign * plane.deflection[k];
                // φ_y in the plane x–z, −φ_x in the plane y–z.
                let (row, row_sign) = [(4, 1.0), (3, -1.0)][i];
                rows[row][unknown] = row_sign * sign * plane.rotation[k];
            }
        }
        for (row, from) in [(2, 2), (5, 5)] {
            rows[row][from] = 1.0 - xi;
            rows[row][from + 6] = xi;
        }
        rows
    }

    /// Rounding of an eigenvalue of the system, rad²/s²: the largest eigenvalue of the element alone, of its tension,
    /// in units of the last place.
    pub(super) fn eigenvalue_rounding(&self) -> f64 {
        f64::EPSILON * 12.0 * self.section.axial_n / (self.section.mass_kg_per_m * self.length_m * self.length_m)
    }

    pub(super) fn stiffness(&self) -> ElementMatrix {
        let mut matrix = [[0.0; ELEMENT_UNKNOWNS]; ELEMENT_UNKNOWNS];
        let (l, phi) = (self.length_m, self.shear_parameter());
        let k = self.section.bending_n_m2 / ((1.0 + phi) * l * l * l);
        let bending = [
            [12.0, 6.0 * l, -12.0, 6.0 * l],
            [6.0 * l, (4.0 + phi) * l * l, -6.0 * l, (2.0 - phi) * l * l],
            [-12.0, -6.0 * l, 12.0, -6.0 * l],
            [6.0 * l, (2.0 - phi) * l * l, -6.0 * l, (4.0 + phi) * l * l],
        ];
        for unknowns in &PLANES {
            for (row, &(i, sign)) in bending.iter().zip(unknowns) {
                for (value, &(j, other)) in row.iter().zip(unknowns) {
                    matrix[i][j] = sign * other * k * value;
                }
            }
        }
        for (i, k) in [(2, self.section.axial_n / l), (5, self.section.torsion_n_m2 / l)] {
            matrix[i][i] = k;
            matrix[i + 6][i + 6] = k;
            matrix[i][i + 6] = -k;
            matrix[i + 6][i] = -k;
        }
        matrix
    }

    /// Consistent mass with rotary inertia.
    pub(super) fn mass(&self) -> ElementMatrix {
        let section = &self.section;
        let inertia = [
            section.mass_kg_per_m,
            section.mass_kg_per_m,
            section.mass_kg_per_m,
            section.diametral_kg_m,
            section.diametral_kg_m,
            section.polar_kg_m,
        ];
        self.integral(|rows, i, j| (0..6).map(|u| inertia[u] * rows[u][i] * rows[u][j]).sum())
    }

    /// Gyroscopic matrix per angular velocity of the shaft about z: ρJ φ̇_y on φ_x, −ρJ φ̇_x on φ_y.
    pub(super) fn gyroscopic(&self) -> ElementMatrix {
        let polar = self.section.polar_kg_m;
        self.integral(|rows, i, j| polar * (rows[3][i] * rows[4][j] - rows[4][i] * rows[3][j]))
    }

    /// Integral over the length of a form of the interpolation; exact for the products of two cubics.
    fn integral(&self, form: impl Fn(&[[f64; ELEMENT_UNKNOWNS]; 6], usize, usize) -> f64) -> ElementMatrix {
        let mut matrix = [[0.0; ELEMENT_UNKNOWNS]; ELEMENT_UNKNOWNS];
        for (xi, weight) in gauss_legendre_unit::<4>() {
            let rows = self.interpolation(xi);
            for (i, row) in matrix.iter_mut().enumerate() {
                for (j, value) in row.iter_mut().enumerate() {
                    *value += weight * self.length_m * form(&rows, i, j);
                }
            }
        }
        matrix
    }
}
