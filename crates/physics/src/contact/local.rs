//! What a point of contact adds to the bulk flexibility by its own indentation.

use super::hertz::LineContact;
use super::lines::Point;
use super::system::Local;
use crate::gear::Pair;

/// How the local part is told from the bulk.
#[derive(Debug, Clone, PartialEq)]
pub enum LocalModel {
    /// Plane-strain indentation down to the centrelines of both teeth: the bulk is the displacement of the centrelines. Depths of
    /// both members at equally spaced roll coordinates from the start to the end of the path.
    CenterlineDepth(Vec<[f64; 2]>),
    /// Surface displacement of two half-spaces: the bulk has the half-space part taken out.
    HalfSpace,
    /// A uniform elastic foundation along the flank normal: force per length of contact line and approach.
    Foundation { line_stiffness_n_per_m2: f64 },
}

/// Local contact of the points of one position.
#[derive(Debug, Clone, Default)]
pub struct LocalContacts {
    contacts: Vec<Contact>,
}

#[derive(Debug, Clone, Copy)]
struct Contact {
    line: LineContact,
    /// Line load per force.
    per_force: f64,
    indentation: Indentation,
    /// Difference of the normal gaps at the ends of the point's part of the line, and the force per approach at which it closes.
    spread_m: f64,
    closing_n_per_m: f64,
}

/// Approach of a point that touches over its whole width, over its line load.
#[derive(Debug, Clone, Copy)]
enum Indentation {
    /// Hertzian in plane strain.
    PlaneStrain,
    /// Hertzian on a half-space, for a segment of this length.
    HalfSpace { length_m: f64 },
    /// Proportional to the line load.
    Foundation { line_stiffness_n_per_m2: f64 },
}

/// Segments on a half-space are kept this many times as long as the band of a line under twice the mean load is wide: the neighbours' bands
/// are held while the load varies, which makes the tangent stiffness of shorter ones too small (2 % at half this length).
const LENGTH_PER_BAND: f64 = 2.0;

impl LocalModel {
    /// Least axial width of a segment under the normal force `force_n` in all; 0 when there is none.
    pub fn least_width_m(&self, pair: &Pair, force_n: f64) -> f64 {
        match self {
            LocalModel::CenterlineDepth(_) | LocalModel::Foundation { .. } => 0.0,
            LocalModel::HalfSpace => {
                let line = line_contact(pair, pair.pitch_point_m(), [0.0; 2]);
                let band = 2.0 * line.half_width_m(2.0 * force_n / pair.mean_contact_length_m());
                LENGTH_PER_BAND * band * pair.base_helix_angle_rad.cos()
            }
        }
    }
}

/// Smallest radius of curvature, in normal modules: near the base circle the flank's vanishes.
const SMALLEST_RADIUS: f64 = 1e-3;

impl LocalContacts {
    /// Sets up the contacts of `points` under the normal force `force_n` in all; `coupling` receives what couples the points of each of
    /// `lines`, nothing for plane strain.
    pub fn prepare(
        &mut self,
        pair: &Pair,
        model: &LocalModel,
        force_n: f64,
        points: &[Point],
        lines: &[std::ops::Range<usize>],
        coupling: &mut Vec<Vec<f64>>,
    ) {
        let cos = pair.base_helix_angle_rad.cos();
        let (start, end) = (pair.path_start_m, pair.path_end_m);
        let length = points.iter().filter(|p| p.zone == 1).map(|p| p.width_m).sum::<f64>() / cos;
        let mean = force_n / length.max(1e-3 * pair.spec.face_width_m);
        self.contacts.clear();
        for p in points {
            let x = p.x_m.clamp(start, end);
            let depths_m = match model {
                LocalModel::CenterlineDepth(depths) => interpolated(depths, (x - start) / (end - start)),
                LocalModel::HalfSpace | LocalModel::Foundation { .. } => [0.0; 2],
            };
            let line = line_contact(pair, x, depths_m);
            let indentation = match *model {
                LocalModel::CenterlineDepth(_) => Indentation::PlaneStrain,
                LocalModel::HalfSpace => Indentation::HalfSpace { length_m: p.width_m / cos },
                LocalModel::Foundation { line_stiffness_n_per_m2 } => {
                    Indentation::Foundation { line_stiffness_n_per_m2 }
                }
            };
            let mut contact = Contact {
                line,
                per_force: cos / p.width_m,
                indentation,
                spread_m: p.gap_spread_m * cos,
                closing_n_per_m: 1.0,
            };
            contact.closing_n_per_m = 1.0 / contact.full(mean / contact.per_force).1;
            self.contacts.push(contact);
        }
        coupling.clear();
        if *model == LocalModel::HalfSpace {
            // Neighbours see a band of the mean load: its width matters only where segments are as short as it is wide.
            coupling.extend(
                lines
                    .iter()
                    .map(|line| half_space_coupling(&self.contacts[line.clone()], &points[line.clone()], cos, mean)),
            );
        }
    }
}

/// Contact of both flanks at roll coordinate `x_m`, with the depths to which the indentation of pinion and gear is counted.
pub fn line_contact(pair: &Pair, x_m: f64, depths_m: [f64; 2]) -> LineContact {
    LineContact::new([&pair.pinion.material, &pair.gear.material], relative_radius_m(pair, x_m), depths_m)
}

/// Relative radius of curvature in the normal section at roll coordinate `x_m`.
fn relative_radius_m(pair: &Pair, x_m: f64) -> f64 {
    let cos = pair.base_helix_angle_rad.cos();
    let radius = x_m * (pair.line_of_action_m - x_m) / pair.line_of_action_m / cos;
    radius.max(SMALLEST_RADIUS * pair.spec.normal_module_m)
}

fn interpolated(table: &[[f64; 2]], part: f64) -> [f64; 2] {
    let last = table.len() - 1;
    let position = (part * last as f64).clamp(0.0, last as f64);
    let i = (position as usize).min(last - 1);
    let t = position - i as f64;
    std::array::from_fn(|k| table[i][k] + t * (table[i + 1][k] - table[i][k]))
}

/// Displacement of every point of a line per force on every other (zero on the diagonal, whose part depends on the load).
fn half_space_coupling(contacts: &[Contact], points: &[Point], cos: f64, mean: f64) -> Vec<f64> {
    let n = points.len();
    let mut matrix = vec![0.0; n * n];
    let middle = |i: usize| points[i].entry_m / cos;
    let ends = |i: usize| {
        let half = 0.5 * points[i].width_m / cos;
        (middle(i) - half, middle(i) + half)
    };
    for i in 0..n {
        for j in 0..i {
            // Unequal segments see each other's middles at slightly different distances: the mean keeps the symmetry.
            let shorter = points[i].width_m.min(points[j].width_m) / cos;
            let one = contacts[j].line.half_space_beside(middle(i), ends(j), mean, shorter);
            let other = contacts[i].line.half_space_beside(middle(j), ends(i), mean, shorter);
            let value = 0.5 * (one + other);
            matrix[i * n + j] = value;
            matrix[j * n + i] = value;
        }
    }
    matrix
}

impl Contact {
    /// Approach of a point that touches over its whole width, and its derivative.
    fn full(&self, force: f64) -> (f64, f64) {
        let w = force * self.per_force;
        let (value, slope) = match self.indentation {
            Indentation::PlaneStrain => self.line.approach(w),
            Indentation::HalfSpace { length_m } => self.line.half_space_approach(w, length_m),
            Indentation::Foundation { line_stiffness_n_per_m2: c } => (w / c, 1.0 / c),
        };
        (value, slope * self.per_force)
    }
}

impl Local for LocalContacts {
    /// Counted from where the nearer end of the part of the line touches. As long as it touches over a part of its width only, a linear gap a
    /// over the width closes like a wedge pressed into an elastic layer: f = c p²/(2a), that is p = √(2 a f / c) up to f = c a / 2; what this is more than
    /// f/c comes on top of the full contact. So no point comes into contact with a jump of its stiffness.
    fn approach(&self, i: usize, force: f64) -> (f64, f64) {
        let contact = &self.contacts[i];
        let (value, slope) = contact.full(force);
        let (a, c) = (contact.spread_m, contact.closing_n_per_m);
        if force >= 0.5 * c * a {
            return (value + 0.5 * a, slope);
        }
        let wedge = (2.0 * a * force / c).sqrt();
        (value + wedge - force / c, slope + 0.5 * wedge / force - 1.0 / c)
    }
}
