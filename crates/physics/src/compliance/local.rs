//! Local indentation at a point of a contact line: what it adds to the bulk flexibility.

use super::hertz::LineContact;
use crate::gear::Pair;

/// Separation of the local part of the compliance from the bulk.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum LocalModel {
    /// Plane-strain indentation down to the centrelines of both teeth: the bulk is the displacement of the centrelines.
    /// Depths of both members at equally spaced roll coordinates from the start to the end of the path.
    CenterlineDepth(Vec<[f64; 2]>),
    /// Surface displacement of two half-spaces: the bulk has the half-space part taken out.
    HalfSpace,
    /// A uniform elastic foundation along the flank normal: force per length of contact line and approach.
    Foundation { line_stiffness_n_per_m2: f64 },
}

/// Local approach of both flanks over the line load, for a segment of a contact line that touches over its whole width.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Indentation {
    /// Hertzian contact at the segment.
    pub line: LineContact,
    law: IndentationLaw,
}

#[derive(Debug, Clone, Copy)]
enum IndentationLaw {
    /// Hertzian in plane strain.
    PlaneStrain,
    /// Hertzian on a half-space, for a segment of this length.
    HalfSpace { length_m: f64 },
    /// Proportional to the line load.
    Foundation { line_stiffness_n_per_m2: f64 },
}

impl Indentation {
    /// Approach under the line load `w` (N/m), m, and its derivative.
    pub(crate) fn approach(&self, w: f64) -> (f64, f64) {
        match self.law {
            IndentationLaw::PlaneStrain => self.line.approach(w),
            IndentationLaw::HalfSpace { length_m } => self.line.half_space_approach(w, length_m),
            IndentationLaw::Foundation { line_stiffness_n_per_m2: c } => (w / c, 1.0 / c),
        }
    }
}

/// Segments on a half-space are kept this many times as long as the band of a line under twice the mean load is wide:
/// the neighbours' bands are held while the load varies, which makes the tangent stiffness of shorter ones too small (2
/// % at half this length).
const LENGTH_PER_BAND: f64 = 2.0;

impl LocalModel {
    /// Least axial width of a segment under the normal force `force_n` in all; 0 when there is none.
    pub(crate) fn least_width_m(&self, pair: &Pair, force_n: f64) -> f64 {
        match self {
            LocalModel::CenterlineDepth(_) | LocalModel::Foundation { .. } => 0.0,
            LocalModel::HalfSpace => {
                let line = line_contact(pair, pair.pitch_point_m(), [0.0; 2]);
                let band = 2.0 * line.half_width_m(2.0 * force_n / pair.mean_contact_length_m());
                LENGTH_PER_BAND * band * pair.base_helix_angle_rad.cos()
            }
        }
    }

    /// Indentation of a segment of length `length_m` at roll coordinate `x_m`, or at the end of the path beyond it.
    pub(crate) fn indentation(&self, pair: &Pair, x_m: f64, length_m: f64) -> Indentation {
        let (start, end) = (pair.path_start_m, pair.path_end_m);
        let x = x_m.clamp(start, end);
        let depths_m = match self {
            LocalModel::CenterlineDepth(depths) => interpolated(depths, (x - start) / (end - start)),
            LocalModel::HalfSpace | LocalModel::Foundation { .. } => [0.0; 2],
        };
        let law = match *self {
            LocalModel::CenterlineDepth(_) => IndentationLaw::PlaneStrain,
            LocalModel::HalfSpace => IndentationLaw::HalfSpace { length_m },
            LocalModel::Foundation { line_stiffness_n_per_m2 } => {
                IndentationLaw::Foundation { line_stiffness_n_per_m2 }
            }
        };
        Indentation { line: line_contact(pair, x, depths_m), law }
    }
}

/// Smallest radius of curvature, in normal modules: near the base circle the flank's vanishes.
const SMALLEST_RADIUS: f64 = 1e-3;

/// Contact of both flanks at roll coordinate `x_m`, with the depths to which the indentation of pinion and gear is
/// counted.
pub(crate) fn line_contact(pair: &Pair, x_m: f64, depths_m: [f64; 2]) -> LineContact {
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
