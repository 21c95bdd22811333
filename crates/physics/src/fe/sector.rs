//! One sector: its unknowns, its loads, the order of their elimination.

use super::condense::{Condensed, condense};
use super::dissection::Dissection;
use super::input::FeError;
use super::loads::{LoadGrid, Loads};
use super::operator::{ElasticBody, Operator};
use super::section::Border;
use super::spline::SplineSpace;
use super::surface::InvoluteFlank;
use crate::watch::Watch;

/// A sector before its inside is eliminated.
pub(super) struct Sector {
    operator: Operator,
    loads: Loads,
    load_count: usize,
    tree: Dissection,
    /// Points on the cut faces, from outside inwards: those at the smaller angle, then those at the larger.
    kept: Vec<usize>,
}

impl Sector {
    /// `levels` says which of `spaces` the line of every node carries; `cells` are the finest borders along the face.
    pub(super) fn new(
        body: &ElasticBody,
        spaces: Vec<SplineSpace>,
        levels: Vec<u8>,
        cells: &[f64],
        involute: &InvoluteFlank,
        grid: &LoadGrid,
    ) -> Sector {
        let section = body.section;
        let operator = Operator::new(body, spaces, levels);
        let loads = Loads::new(section, involute, grid, &operator, body.twist_per_m);
        let tree = Dissection::new(section, &operator, &cells[1..cells.len() - 1]);
        let face = |which: fn(Border) -> Option<usize>| {
            let borders = section.borders.iter().enumerate();
            let mut nodes: Vec<(usize, usize)> =
                borders.filter_map(|(node, &border)| Some((which(border)?, node))).collect();
            nodes.sort_unstable();
            nodes.into_iter().flat_map(|(_, node)| operator.line(node)).collect::<Vec<_>>()
        };
        let mut kept = face(|border| if let Border::Low(k) = border { Some(k) } else { None });
        kept.extend(face(|border| if let Border::High(k) = border { Some(k) } else { None }));
        Sector { operator, loads, load_count: grid.len(), tree, kept }
    }

    /// The sector condensed to its cut faces.
    pub(super) fn condense(&self, watch: Watch, progress: (f64, f64)) -> Result<Condensed, FeError> {
        condense(&self.operator, &self.loads, self.load_count, &self.tree, &self.kept, watch, progress)
    }
}
