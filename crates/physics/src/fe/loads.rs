//! Unit forces spread as hats over the loaded flank, and the same hats as weights of the displacement.

use super::operator::Operator;
use super::section::{SectionMesh, edge_shapes};
use super::surface::InvoluteFlank;
use crate::numerics::gauss::{gauss_legendre, on_interval};

/// The load grid: hats bilinear in the arc length of the involute and in the axial place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LoadGrid {
    /// Nodes along the profile: arc length from the form point.
    pub profile_m: Vec<f64>,
    /// Nodes along the face.
    pub stations_m: Vec<f64>,
}

impl LoadGrid {
    /// Number of hats.
    pub(super) fn len(&self) -> usize {
        self.profile_m.len() * self.stations_m.len()
    }
}

/// Integrals of hats on a line of nodes.
pub(super) fn hat_lengths(nodes: &[f64]) -> Vec<f64> {
    let last = nodes.len() - 1;
    (0..nodes.len()).map(|i| 0.5 * (nodes[(i + 1).min(last)] - nodes[i.saturating_sub(1)])).collect()
}

/// Nodal forces of every hat: a section part times a part along the face.
pub(super) struct Loads {
    stations: usize,
    /// By node: profile hat and force (radial, tangential, axial) per axial length.
    section: Vec<Vec<(usize, [f64; 3])>>,
    /// By level and function: station and integral of the hats over its length.
    along: Vec<Vec<Vec<(usize, f64)>>>,
}

impl Loads {
    /// Unit normal forces into the tooth. `twist_per_m` as in [`super::operator::ElasticBody`].
    pub(super) fn new(
        section: &SectionMesh,
        involute: &InvoluteFlank,
        grid: &LoadGrid,
        operator: &Operator,
        twist_per_m: f64,
    ) -> Loads {
        let lengths = hat_lengths(&grid.profile_m);
        let widths = hat_lengths(&grid.stations_m);
        let mut at_node = vec![Vec::new(); section.nodes.len()];
        let rule = gauss_legendre(5);
        // The flank is a helicoid: normal to it is the transverse normal with an axial part of r_b times the twist.
        let axial = twist_per_m * involute.base_radius_m;
        let scale = 1.0 / axial.hypot(1.0);
        for edge in &section.flank {
            for (hat, &at) in grid.profile_m.iter().enumerate() {
                let before = grid.profile_m[hat.saturating_sub(1)];
                let after = grid.profile_m[(hat + 1).min(grid.profile_m.len() - 1)];
                let mut forces = [[0.0; 3]; 3];
                for (from, to) in [(before, at), (at, after)] {
                    let (low, high) = (from.max(edge.from_m), to.min(edge.to_m));
                    if high - low <= 1e-9 * involute.length_m {
                        continue;
                    }
                    for (s, weight) in on_interval(&rule, low, high) {
                        let value = 1.0 - (s - at).abs() / (to - from);
                        let n = edge_shapes(2.0 * (s - edge.from_m) / (edge.to_m - edge.from_m) - 1.0);
                        let (_, normal) = involute.at(s);
                        for (force, n) in forces.iter_mut().zip(n) {
                            let part = weight * value * n * scale / lengths[hat];
                            force[0] += part * normal[0];
                            force[1] += part * normal[1];
                            force[2] += part * axial;
                        }
                    }
                }
                for (&node, force) in edge.nodes.iter().zip(&forces) {
                    if force.iter().all(|&f| f == 0.0) {
                        continue;
                    }
                    let place = &section.nodes[node];
                    let r = place.x_m.hypot(place.y_m);
                    let (s, c) = (place.x_m / r, place.y_m / r);
                    let polar = [s * force[0] + c * force[1], c * force[0] - s * force[1], force[2]];
                    at_node[node].push((hat, polar));
                }
            }
        }
        let along = operator
            .spaces()
            .iter()
            .map(|space| {
                let mut table = space.hat_integrals(&grid.stations_m);
                for row in &mut table {
                    for (station, value) in row.iter_mut() {
                        *value /= widths[*station];
                    }
                }
                table
            })
            .collect();
        Loads { stations: grid.stations_m.len(), section: at_node, along }
    }

    /// True where the line of `node` is loaded.
    pub(super) fn touches(&self, node: usize) -> bool {
        !self.section[node].is_empty()
    }

    /// Calls `add` with the index of every hat (`profile * stations + station`) that loads function `function` on
    /// `node`'s line, and the force.
    pub(super) fn for_each(
        &self,
        operator: &Operator,
        node: usize,
        function: usize,
        mut add: impl FnMut(usize, [f64; 3]),
    ) {
        for (hat, force) in &self.section[node] {
            for &(station, along) in &self.along[operator.level(node)][function] {
                add(hat * self.stations + station, force.map(|f| f * along));
            }
        }
    }
}
