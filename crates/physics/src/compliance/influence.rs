//! Bulk flexibility of both members over the field of contact: the common input of the load distribution from every
//! fidelity.
//!
//! Forces and displacements are along the flank normal, at *path nodes* (roll coordinate x) and
//! *stations* along the face. The bulk part is smooth, so that few stations carry it and the contact lines may be cut
//! as finely as their ends and modifications need: the cost of a position grows linearly with its points.

use crate::numerics::interpolation::lagrange;
use crate::simd::vectorised;
use crate::watch::{Canceled, Meter, Watch};

/// Normal approach of both members per normal force. It depends on neither load, modification nor assembly.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Influence {
    path_nodes_m: Vec<f64>,
    stations_m: Vec<f64>,
    offsets: usize,
    /// Per offset, station of the response, place of the response: places times stations of the load.
    table: Vec<f64>,
}

/// Four neighbouring stations and their weights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stencil {
    /// First station.
    pub first: usize,
    /// Weights of the stations from the first on; they sum to one.
    pub weights: [f64; STENCIL],
}

/// Stations of a [`Stencil`].
pub(crate) const STENCIL: usize = 4;

impl Stencil {
    /// Last of its stations.
    pub(crate) fn last(&self) -> usize {
        self.first + STENCIL - 1
    }
}

/// Size of a table of so many places, stations and offsets.
pub(super) fn table_bytes(places: f64, stations: f64, offsets: f64) -> f64 {
    8.0 * (offsets + 1.0) * (places * stations).powi(2)
}

/// Extrapolation beyond the outermost places, as a part of the path.
const OVERHANG: f64 = 0.05;

/// One line of contact at the stations `first..first + count`.
#[derive(Debug, Clone, Default)]
pub(crate) struct LineWeights {
    /// Tooth pair: k + 1 entered before k.
    pub pair: i32,
    /// First station.
    pub first: usize,
    /// Number of stations.
    pub count: usize,
    /// Weights of the places, station by station for every place.
    weights: Vec<f64>,
}

impl Influence {
    /// Tabulates `entry(offset, (response station, place), (load station, place))`: both on one tooth pair (offset 0),
    /// or the response on the pair that entered `offset` pitches before the loaded one. Places and stations ascend; at
    /// least four stations. An entry takes some `entry_operations`.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(crate) fn new(
        path_nodes_m: Vec<f64>,
        stations_m: Vec<f64>,
        offsets: usize,
        (entry_operations, watch): (usize, Watch),
        mut entry: impl FnMut(usize, (usize, usize), (usize, usize)) -> f64,
    ) -> Result<Influence, Canceled> {
        let mut meter = Meter::new(watch);
        let (p, s) = (path_nodes_m.len(), stations_m.len());
        let mut table = Vec::with_capacity((offsets + 1) * s * s * p * p);
        for offset in 0..=offsets {
            for i in 0..s {
                for a in 0..p {
                    meter.count(p * s * entry_operations)?;
                    for b in 0..p {
                        table.extend((0..s).map(|j| entry(offset, (i, a), (j, b))));
                    }
                }
            }
        }
        Ok(Influence { path_nodes_m, stations_m, offsets, table })
    }

    /// Cost of [`Self::between`] and of writing its block into a large matrix, row by row and column by column, in
    /// multiplications.
    pub(crate) fn operations(&self, response: &LineWeights, load: &LineWeights) -> usize {
        let places = self.path_nodes_m.len();
        (places * (places + 1) + 16) * response.count * load.count + 512
    }

    /// No flexibility, over `stations_m`.
    pub(crate) fn rigid(path_node_m: f64, stations_m: Vec<f64>) -> Influence {
        let table = vec![0.0; stations_m.len() * stations_m.len()];
        Influence { path_nodes_m: vec![path_node_m], stations_m, offsets: 0, table }
    }

    /// Stations along the face, from the mesh-out end, ascending.
    pub(crate) fn stations_m(&self) -> &[f64] {
        &self.stations_m
    }

    /// Weights of the stations about `entry_m`.
    pub(crate) fn stencil(&self, entry_m: f64) -> Stencil {
        stencil(&self.stations_m, entry_m)
    }

    /// Sets `line` up for the pair `pair`, whose line of contact is at the roll coordinate `base_m + slope z`, over the
    /// stations `first..=last`.
    pub(crate) fn line(
        &self,
        line: &mut LineWeights,
        pair: i32,
        (base_m, slope): (f64, f64),
        (first, last): (usize, usize),
    ) {
        line.pair = pair;
        line.first = first;
        line.count = last + 1 - first;
        let (low, high) = (self.path_nodes_m[0], self.path_nodes_m[self.path_nodes_m.len() - 1]);
        let overhang = OVERHANG * (high - low);
        line.weights.clear();
        for a in 0..self.path_nodes_m.len() {
            line.weights.extend(self.stations_m[first..=last].iter().map(|z| {
                let x = (base_m + slope * z).clamp(low - overhang, high + overhang);
                lagrange(&self.path_nodes_m, a, x)
            }));
        }
    }

    /// Flexibility between the stations of two lines, `response` that of the pair that entered earlier (or the same):
    /// written to `out`, `response.count` rows of `load.count`. `scratch` is reused memory.
    pub(crate) fn between(
        &self,
        response: &LineWeights,
        load: &LineWeights,
        scratch: &mut Vec<f64>,
        out: &mut Vec<f64>,
    ) {
        let offset = (response.pair - load.pair) as usize;
        let p = self.path_nodes_m.len();
        let (rows, columns) = (response.count, load.count);
        out.clear();
        out.resize(rows * columns, 0.0);
        if offset > self.offsets {
            return;
        }
        scratch.clear();
        scratch.resize(p * columns, 0.0);
        vectorised(
            #[inline(always)]
            || self.contract(offset, response, load, scratch, out),
        );
    }

    #[inline(always)]
    fn contract(
        &self,
        offset: usize,
        response: &LineWeights,
        load: &LineWeights,
        scratch: &mut [f64],
        out: &mut [f64],
    ) {
        let (p, s) = (self.path_nodes_m.len(), self.stations_m.len());
        let (rows, columns) = (response.count, load.count);
        for i in 0..rows {
            scratch.fill(0.0);
            let from = (offset * s + response.first + i) * p * p * s;
            for a in 0..p {
                let weight = response.weights[a * rows + i];
                for b in 0..p {
                    let start = from + (a * p + b) * s + load.first;
                    let source = &self.table[start..start + columns];
                    let target = &mut scratch[b * columns..(b + 1) * columns];
                    target.iter_mut().zip(source).for_each(|(t, v)| *t += weight * v);
                }
            }
            let row = &mut out[i * columns..(i + 1) * columns];
            for (part, weights) in scratch.chunks_exact(columns).zip(load.weights.chunks_exact(columns)) {
                row.iter_mut().zip(part).zip(weights).for_each(|((t, v), w)| *t += w * v);
            }
        }
    }
}

/// Weights of the four `nodes` about `at`: cubic; linear beyond the outermost nodes. At least four nodes, ascending.
pub(super) fn stencil(nodes: &[f64], at: f64) -> Stencil {
    let last = nodes.len() - 1;
    let mut weights = [0.0; STENCIL];
    if at <= nodes[0] {
        let t = (at - nodes[0]) / (nodes[1] - nodes[0]);
        weights[0] = 1.0 - t;
        weights[1] = t;
        return Stencil { first: 0, weights };
    }
    if at >= nodes[last] {
        let t = (at - nodes[last]) / (nodes[last] - nodes[last - 1]);
        weights[STENCIL - 1] = 1.0 + t;
        weights[STENCIL - 2] = -t;
        return Stencil { first: last + 1 - STENCIL, weights };
    }
    let above = nodes.partition_point(|&s| s <= at);
    let first = above.saturating_sub(2).min(last + 1 - STENCIL);
    for (k, weight) in weights.iter_mut().enumerate() {
        *weight = lagrange(&nodes[first..first + STENCIL], k, at);
    }
    Stencil { first, weights }
}
