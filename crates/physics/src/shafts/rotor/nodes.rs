//! Division of a shaft into elements.

use super::element::{ELEMENT_UNKNOWNS, Element};
use super::sparse::SparseRow;
use crate::shafts::beam::BeamSection;
use crate::shafts::error::{ShaftError, ShaftItem};
use crate::shafts::shaft::Shaft;

/// Length of the elements, m; longer ones only where the shaft would need more than [`ELEMENTS_PER_SHAFT`].
const ELEMENT_M: f64 = 5e-3;
/// Elements of a long uniform shaft.
const ELEMENTS_PER_SHAFT: f64 = 150.0;
/// Elements of a short uniform shaft.
const LEAST_ELEMENTS: f64 = 60.0;
/// Part of an element within which a bearing, body or mesh gets no node of its own; the interpolation is used there.
const NEAR_NODE: f64 = 0.05;
/// Largest number of elements of a shaft.
const MAX_ELEMENTS: usize = 2000;

/// A shaft divided into elements.
#[derive(Debug, Clone)]
pub(super) struct ShaftNodes {
    /// z of the nodes from the apex plane, m, ascending.
    pub(super) z_m: Vec<f64>,
    /// Elements between the nodes.
    pub(super) elements: Vec<Element>,
    /// First unknown of each node in the system.
    pub(super) unknowns: Vec<usize>,
}

impl ShaftNodes {
    /// Nodes at the ends of the segments and at `points_m` (z), and between them at most `element_m` apart.
    ///
    /// # Errors
    /// [`ShaftError::OutsideShaft`], [`ShaftError::TooLarge`].
    pub(super) fn new(
        shaft: &Shaft,
        points_m: &[(ShaftItem, f64)],
        element_m: Option<f64>,
    ) -> Result<ShaftNodes, ShaftError> {
        let length_m = shaft.length_m();
        let usual_m = ELEMENT_M.max(length_m / ELEMENTS_PER_SHAFT).min(length_m / LEAST_ELEMENTS);
        let element_m = element_m.unwrap_or(usual_m);
        let mut points = Vec::with_capacity(points_m.len());
        for &(item, z) in points_m {
            points.push(shaft.on_shaft(item, z + shaft.gear_position_m)?);
        }
        points.sort_by(f64::total_cmp);
        let mut z_m = vec![-shaft.gear_position_m];
        let mut elements = Vec::new();
        let mut from = 0.0;
        for segment in &shaft.segments {
            let section = BeamSection::new(segment, &shaft.material);
            let to = from + segment.length_m;
            let mut stops = vec![from];
            let near = NEAR_NODE * element_m.min(segment.length_m);
            for &point in points.iter().filter(|&&point| point > from + near && point < to - near) {
                if point > stops[stops.len() - 1] + near {
                    stops.push(point);
                }
            }
            stops.push(to);
            for pair in stops.windows(2) {
                let length = pair[1] - pair[0];
                let count = (length / element_m * (1.0 - 1e-9)).ceil().max(1.0);
                if elements.len() as f64 + count > MAX_ELEMENTS as f64 {
                    let needed = elements.len().saturating_add(count as usize);
                    return Err(ShaftError::TooLarge { elements: needed, limit: MAX_ELEMENTS });
                }
                for i in 1..=count as usize {
                    z_m.push(pair[0] + length * i as f64 / count - shaft.gear_position_m);
                    elements.push(Element { length_m: length / count, section });
                }
            }
            from = to;
        }
        Ok(ShaftNodes { z_m, elements, unknowns: Vec::new() })
    }

    /// Unknowns of an element, left end first.
    pub(super) fn element_unknowns(&self, element: usize) -> [usize; ELEMENT_UNKNOWNS] {
        std::array::from_fn(|i| if i < 6 { self.unknowns[element] + i } else { self.unknowns[element + 1] + i - 6 })
    }

    /// Rows of the six displacements of the section at `z_m`, which is on the shaft.
    pub(super) fn section(&self, z_m: f64) -> [SparseRow; 6] {
        let element = self.z_m.partition_point(|&z| z <= z_m).saturating_sub(1).min(self.elements.len() - 1);
        let length_m = self.elements[element].length_m;
        let mut xi = ((z_m - self.z_m[element]) / length_m).clamp(0.0, 1.0);
        // At a node the neighbours do not take part.
        if !(1e-9..=1.0 - 1e-9).contains(&xi) {
            xi = xi.round();
        }
        let rows = self.elements[element].interpolation(xi);
        let unknowns = self.element_unknowns(element);
        rows.map(|row| unknowns.iter().copied().zip(row).filter(|(_, value)| *value != 0.0).collect())
    }
}
