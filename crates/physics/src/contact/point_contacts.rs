//! Local contact of the points of one position: indentation, gradual closing of their gaps, coupling along a line.

use super::lines::ContactPoint;
use super::system::LocalApproach;
use crate::compliance::{Indentation, LocalModel};
use crate::gear::Pair;
use crate::watch::{Canceled, Meter};

/// Local contact of the points of one position.
#[derive(Debug, Clone, Default)]
pub(super) struct PointContacts {
    contacts: Vec<PointContact>,
}

#[derive(Debug, Clone, Copy)]
struct PointContact {
    indentation: Indentation,
    /// Line load per force.
    per_force: f64,
    /// Difference of the normal gaps at the ends of the point's part of the line, and the force per approach at which
    /// it closes.
    spread_m: f64,
    closing_n_per_m: f64,
}

impl PointContacts {
    /// Sets up the contacts of `points` under the normal force `force_n` in all; `coupling` receives what couples the
    /// points of each of `lines`, nothing for plane strain.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(super) fn prepare(
        &mut self,
        pair: &Pair,
        model: &LocalModel,
        force_n: f64,
        (points, lines): (&[ContactPoint], &[std::ops::Range<usize>]),
        coupling: &mut Vec<Vec<f64>>,
        meter: &mut Meter,
    ) -> Result<(), Canceled> {
        let cos = pair.base_helix_angle_rad.cos();
        let length = points.iter().filter(|p| p.zone == 1).map(|p| p.width_m).sum::<f64>() / cos;
        let mean = force_n / length.max(1e-3 * pair.spec.face_width_m);
        self.contacts.clear();
        for p in points {
            let mut contact = PointContact {
                indentation: model.indentation(pair, p.x_m, p.width_m / cos),
                per_force: cos / p.width_m,
                spread_m: p.gap_spread_m * cos,
                closing_n_per_m: 1.0,
            };
            contact.closing_n_per_m = 1.0 / contact.full(mean / contact.per_force).1;
            self.contacts.push(contact);
        }
        coupling.clear();
        if *model == LocalModel::HalfSpace {
            // The band of the neighbours is that of the mean load: its width matters only where segments are as short
            // as it is wide.
            for line in lines {
                let (contacts, points) = (&self.contacts[line.clone()], &points[line.clone()]);
                coupling.push(half_space_coupling(contacts, points, cos, mean, meter)?);
            }
        }
        Ok(())
    }
}

/// Cost of the coupling of two points, in multiplications.
const KERNEL_OPERATIONS: usize = 100;

/// Displacement of every point of a line per force on every other (zero on the diagonal, whose part depends on the
/// load).
fn half_space_coupling(
    contacts: &[PointContact],
    points: &[ContactPoint],
    cos: f64,
    mean: f64,
    meter: &mut Meter,
) -> Result<Vec<f64>, Canceled> {
    let n = points.len();
    let mut matrix = vec![0.0; n * n];
    let middle = |i: usize| points[i].entry_m / cos;
    let ends = |i: usize| {
        let half = 0.5 * points[i].width_m / cos;
        (middle(i) - half, middle(i) + half)
    };
    for i in 0..n {
        meter.count(KERNEL_OPERATIONS * i)?;
        for j in 0..i {
            // The distances of unequal segments from each other's middles differ slightly: the mean keeps the symmetry.
            let shorter = points[i].width_m.min(points[j].width_m) / cos;
            let one = contacts[j].indentation.line.half_space_beside(middle(i), ends(j), mean, shorter);
            let other = contacts[i].indentation.line.half_space_beside(middle(j), ends(i), mean, shorter);
            let value = 0.5 * (one + other);
            matrix[i * n + j] = value;
            matrix[j * n + i] = value;
        }
    }
    Ok(matrix)
}

impl PointContact {
    /// Approach of a point that touches over its whole width, and its derivative.
    fn full(&self, force: f64) -> (f64, f64) {
        let (value, slope) = self.indentation.approach(force * self.per_force);
        (value, slope * self.per_force)
    }
}

impl LocalApproach for PointContacts {
    /// Counted from where the nearer end of the part of the line touches. As long as it touches over a part of its
    /// width only, a linear gap a over the width closes like a wedge pressed into an elastic layer: f = c p²/(2a), that
    /// is p = √(2 a f / c) up to f = c a / 2; what this is more than f/c comes on top of the full contact. So no point
    /// comes into contact with a jump of its stiffness.
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
