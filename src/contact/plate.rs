//! How a tooth spreads a load along the face: the tooth as a clamped plate of variable thickness.
//!
//! A line load cos(ky) at some height of the tooth bends, twists and shears the whole tooth, the part above the load
//! included. Mindlin's plate (shear factor 5/6), deflection w cos(ky), rotations θ_x cos(ky), θ_y sin(ky), in quadratic
//! elements over the height, gives the deflection at the load and the force and moment that reach the root. Their decrease
//! from k = 0 to one finite k defines decay lengths λ by 1/(1 + k²λ²).

use super::linalg::{cholesky, cholesky_solve, dot};

/// Decay lengths of one load height.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    /// Of the deflection at the load.
    pub deflection_m: f64,
    /// Of the force at the root.
    pub force_m: f64,
    /// Of the moment at the root.
    pub moment_m: f64,
}

/// Elements over the height of the tooth.
const ELEMENTS: usize = 8;
/// Nodes without the clamped one, and their unknowns w, θ_x, θ_y.
const NODES: usize = 2 * ELEMENTS;
const SIZE: usize = 3 * NODES;
const GAUSS: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];
/// Wave number at which the decay is measured, per normal module: half a wave over six modules, the length over which
/// teeth spread loads.
const WAVE_PER_MODULE: f64 = 0.5;

/// A tooth of height `height_m` whose thickness in the normal section is `thickness(above root)`.
pub struct Plate<'a> {
    pub height_m: f64,
    pub nu: f64,
    pub normal_module_m: f64,
    pub thickness: &'a dyn Fn(f64) -> f64,
}

/// Stiffness of the free unknowns and the rows of the clamped node, at one wave number.
struct System {
    factor: Vec<f64>,
    /// Reactions w and θ_x of the root per displacement of the first element's free unknowns.
    root: [[f64; 6]; 2],
}

impl Plate<'_> {
    /// Decay lengths for loads at `heights_m` above the root.
    pub fn spreads(&self, heights_m: &[f64]) -> Vec<Spread> {
        let wave = WAVE_PER_MODULE / self.normal_module_m;
        let systems = [self.system(0.0), self.system(wave)];
        let decay = |still: f64, waving: f64| {
            if still * waving > 0.0 { (still / waving - 1.0).max(0.0).sqrt() / wave } else { 0.0 }
        };
        heights_m
            .iter()
            .map(|&u| {
                let u = u.clamp(0.02 * self.height_m, self.height_m);
                let [still, waving] = [systems[0].answer(u / self.height_m), systems[1].answer(u / self.height_m)];
                Spread {
                    deflection_m: decay(still[0], waving[0]),
                    force_m: decay(still[1], waving[1]),
                    moment_m: decay(still[2], waving[2]),
                }
            })
            .collect()
    }

    fn system(&self, k: f64) -> System {
        let length = self.height_m / ELEMENTS as f64;
        let nu = self.nu;
        let shear = 5.0 / 6.0 / (2.0 * (1.0 + nu));
        let mut matrix = vec![0.0; SIZE * SIZE];
        let mut root = [[0.0; 6]; 2];
        for element in 0..ELEMENTS {
            for xi in GAUSS {
                let x = (element as f64 + 0.5 * (1.0 + xi)) * length;
                let s = (self.thickness)(x);
                let weight = 0.5 * length;
                let bend = weight * s.powi(3) / (12.0 * (1.0 - nu * nu));
                let slide = weight * s * shear;
                let n = [0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)];
                let d = [(xi - 0.5), -2.0 * xi, (xi + 0.5)].map(|v| v * 2.0 / length);
                // Rows: κ_x, κ_y, κ_xy, γ_x, γ_y over (w, θ_x, θ_y) of three nodes.
                let mut b = [[0.0; 9]; 5];
                for a in 0..3 {
                    b[0][3 * a + 1] = d[a];
                    b[1][3 * a + 2] = k * n[a];
                    b[2][3 * a + 1] = -k * n[a];
                    b[2][3 * a + 2] = d[a];
                    b[3][3 * a] = d[a];
                    b[3][3 * a + 1] = -n[a];
                    b[4][3 * a] = -k * n[a];
                    b[4][3 * a + 2] = -n[a];
                }
                for i in 0..9 {
                    for j in 0..9 {
                        let value = bend
                            * (b[0][i] * b[0][j]
                                + b[1][i] * b[1][j]
                                + nu * (b[0][i] * b[1][j] + b[1][i] * b[0][j])
                                + 0.5 * (1.0 - nu) * b[2][i] * b[2][j])
                            + slide * (b[3][i] * b[3][j] + b[4][i] * b[4][j]);
                        let (gi, gj) = (6 * element + i, 6 * element + j);
                        if gi >= 3 && gj >= 3 {
                            matrix[(gi - 3) * SIZE + gj - 3] += value;
                        } else if gi < 2 && gj >= 3 {
                            root[gi][gj - 3] += value;
                        }
                    }
                }
            }
        }
        cholesky(&mut matrix, SIZE);
        System { factor: matrix, root }
    }
}

impl System {
    /// Deflection at the load, force and moment at the root, for a unit load at the fraction `t` of the height.
    fn answer(&self, t: f64) -> [f64; 3] {
        let position = t * ELEMENTS as f64;
        let element = (position as usize).min(ELEMENTS - 1);
        let xi = 2.0 * (position - element as f64) - 1.0;
        let n = [0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)];
        let mut load = [0.0; SIZE];
        for (a, value) in n.iter().enumerate() {
            let dof = 6 * element + 3 * a;
            if dof >= 3 {
                load[dof - 3] = *value;
            }
        }
        let mut solution = load;
        cholesky_solve(&self.factor, &mut solution, SIZE);
        // What the load puts straight on the clamped node counts as reaction too.
        let direct = if element == 0 { n[0] } else { 0.0 };
        [dot(&solution, &load), direct - dot(&self.root[0], &solution[..6]), -dot(&self.root[1], &solution[..6])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::check_worst;

    #[test]
    fn the_whole_load_and_its_moment_reach_the_root_when_still() {
        let plate = Plate { height_m: 2.0, nu: 0.3, normal_module_m: 1.0, thickness: &|_| 0.1 };
        let [deflection, force, moment] = plate.system(0.0).answer(0.7);
        let (u, d) = (1.4f64, 1e-3 / (12.0 * 0.91));
        let topic = "Contact: tooth as a plate, gear body as a ring";
        check_worst(topic, "load and moment at the root of a still plate", [force - 1.0, moment.abs() / u - 1.0], 1e-6);
        // A thin strip: u³/(3D) and a little shear; quadratic elements with the load inside one are 1 % soft at most.
        check_worst(
            topic,
            "deflection of a thin strip against u³/(3D)",
            [deflection / (u.powi(3) / (3.0 * d)) - 1.0],
            0.02,
        );
    }
}
