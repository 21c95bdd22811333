//! Flexibility of both shafts under the tooth forces of both halves, as the load distribution uses it.
//!
//! The displacement of the contact points of one half by forces on the same half is tabulated between the stations of
//! the contact lines, like that of the teeth. By forces on the other half it is smooth: a uniform shaft without load
//! bends as a cubic, twists and stretches linearly, so that four nodes along the face and two along the path carry it
//! exactly. Steps of a shaft within the face are followed to a polynomial of that order.

use nalgebra::DMatrix;

use super::frame::{Body, MeshFrame, Section};
use crate::compliance::Compliance;
use crate::gear::Half;
use crate::numerics::dense::dot;
use crate::shafts::{ShaftError, ShaftTrain};

/// Nodes along the face for what comes from the other half, and along the path.
const FACE_NODES: usize = 4;
const PATH_NODES: usize = 2;
/// Nodes of a half.
pub(crate) const NODES: usize = FACE_NODES * PATH_NODES;
/// Sections of each shaft between its ends at which the deflected shape is given.
const SHAPE_SECTIONS: usize = 41;

/// Displacement of the contact points of a half along the flank normal as a function of their place: polynomials
/// through nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplacementField {
    grid: NodeGrid,
    /// Opening at every node: path node by path node for every node along the face.
    pub(super) opening_m: [f64; NODES],
}

impl DisplacementField {
    /// Opening along the flank normal at a point.
    pub(crate) fn at(&self, entry_m: f64, x_m: f64) -> f64 {
        self.grid.weights(entry_m, x_m).iter().zip(&self.opening_m).map(|(w, v)| w * v).sum()
    }
}

/// Nodes along the face (distance from the mesh-out end) and along the path.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct NodeGrid {
    face: Nodes<FACE_NODES>,
    path: Nodes<PATH_NODES>,
}

/// Nodes of Lagrange polynomials.
#[derive(Debug, Clone, PartialEq)]
struct Nodes<const N: usize> {
    at_m: [f64; N],
    /// 1/Π (a_k − a_i) over the other nodes i.
    factor: [f64; N],
}

impl<const N: usize> Nodes<N> {
    fn new(at_m: [f64; N]) -> Self {
        let others = |k: usize| (0..N).filter(move |&i| i != k);
        let factor = std::array::from_fn(|k| 1.0 / others(k).map(|i| at_m[k] - at_m[i]).product::<f64>());
        Self { at_m, factor }
    }

    /// The polynomials at a place: each 1 at its node, 0 at the others.
    fn polynomials(&self, place_m: f64) -> [f64; N] {
        let distance_m: [f64; N] = std::array::from_fn(|i| place_m - self.at_m[i]);
        std::array::from_fn(|k| (0..N).filter(|&i| i != k).fold(self.factor[k], |value, i| value * distance_m[i]))
    }
}

impl NodeGrid {
    fn new(width_m: f64, path_m: [f64; 2]) -> NodeGrid {
        let chebyshev = |i: usize| {
            let angle = std::f64::consts::PI * (2 * i + 1) as f64 / (2 * FACE_NODES) as f64;
            0.5 * width_m * (1.0 - angle.cos())
        };
        NodeGrid { face: Nodes::new(std::array::from_fn(chebyshev)), path: Nodes::new(path_m) }
    }

    /// Weights of the nodes at a point; they sum to one.
    pub(super) fn weights(&self, entry_m: f64, x_m: f64) -> [f64; NODES] {
        let (face, path) = (self.face.polynomials(entry_m), self.path.polynomials(x_m));
        std::array::from_fn(|k| face[k / PATH_NODES] * path[k % PATH_NODES])
    }

    /// Place of a node.
    fn node(&self, k: usize) -> (f64, f64) {
        (self.face.at_m[k / PATH_NODES], self.path.at_m[k % PATH_NODES])
    }
}

/// Flexibility of the shafts between points of one half.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HalfFlexibility {
    stations: usize,
    /// Opening at a station per force at a station, row by row: constant, times the load's x, times the response's x,
    /// times both.
    table: Vec<[f64; 4]>,
}

impl HalfFlexibility {
    /// Opening at a station and roll coordinate per force at another.
    #[inline]
    pub(crate) fn between(&self, (i, x_m): (usize, f64), (j, load_x_m): (usize, f64)) -> f64 {
        let c = &self.table[i * self.stations + j];
        c[0] + load_x_m * c[1] + x_m * (c[2] + load_x_m * c[3])
    }
}

/// Sections of one shaft whose displacements are reported, and their flexibilities.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ShaftSections {
    /// Six rows per section: face ends, mid-faces, apex plane, bearings, shape; six columns per loaded section.
    flexibility: DMatrix<f64>,
    bearings: usize,
    /// Places of the sections of the deflected shape, from the apex plane.
    pub(super) shape_m: Vec<f64>,
}

/// Reported sections before the bearings: four face ends, two mid-faces, the apex plane.
const NAMED_SECTIONS: usize = 7;
const MID_FACES_FROM: usize = 4;
const APEX_SECTION: usize = 6;

/// Displacements of the reported sections of one shaft.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SectionDisplacements {
    pub(super) face_ends: [Section; 4],
    pub(super) mid_faces: [Section; 2],
    pub(super) apex: Section,
    pub(super) bearings: Vec<Section>,
    pub(super) shape: Vec<Section>,
}

/// Forces of the contact points of both halves at the stations: of every half and station the normal force and its
/// first moment over x.
pub(super) type StationLoads = [Vec<[f64; 2]>; 2];

/// What a position needs of the displaced shafts.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Openings {
    /// Of the mid-face section of either half at the pitch point, along the flank normal.
    pub(super) mid_face_m: [f64; 2],
    /// At the nodes of either half.
    pub(super) nodes_m: [[f64; NODES]; 2],
    /// Axial displacement of the pinion at the apex plane.
    pub(super) apex_m: f64,
}

/// Axial freedom of the members.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxialFreedom {
    /// Both shafts are held axially.
    None,
    /// The pinion floats.
    Pinion,
    /// The gear floats.
    Gear,
}

/// Both shafts as the loaded contact of both halves uses them. Depends on the shafts, the frame and the stations of the
/// compliance, not on load or flank modifications.
#[derive(Debug, Clone)]
pub struct ContactShafts {
    pub(super) frame: MeshFrame,
    pub(super) train: ShaftTrain,
    pub(super) freedom: AxialFreedom,
    pub(super) halves: [HalfFlexibility; 2],
    /// Opening at the nodes of a half per force at the nodes of the other one: `[response half]`, NODES × NODES.
    pub(super) across: [Vec<f64>; 2],
    pub(super) grid: NodeGrid,
    sections: [ShaftSections; 2],
    /// [`Openings`] per force and per moment at the stations of both halves, row by row: mid-face and nodes of the left
    /// half, of the right half, apex.
    openings: Vec<f64>,
    stations: usize,
}

/// Rows of the openings of a half.
const HALF_ROWS: usize = 1 + NODES;

impl ContactShafts {
    /// The flexibility of `train` in `frame` between the stations of `compliance`.
    ///
    /// # Errors
    /// [`ShaftError`] of either shaft, or if both members are free to move axially.
    pub fn new(train: &ShaftTrain, frame: MeshFrame, compliance: &Compliance) -> Result<ContactShafts, ShaftError> {
        let freedom = match (train.pinion.floats_axially(), train.gear.floats_axially()) {
            (true, true) => return Err(ShaftError::BothFloatAxially),
            (true, false) => AxialFreedom::Pinion,
            (false, true) => AxialFreedom::Gear,
            (false, false) => AxialFreedom::None,
        };
        let stations_m = compliance.influence.stations_m().to_vec();
        let grid = NodeGrid::new(frame.width_m, frame.path_m);
        let count = stations_m.len();
        let of_halves = |places: &[f64]| -> Vec<f64> {
            let of = |half| places.iter().map(move |&entry_m| (half, entry_m));
            of(Half::Left).chain(of(Half::Right)).map(|(half, entry_m)| frame.z_m(half, entry_m)).collect()
        };
        // Loaded sections: stations of left and right half, nodes of left and right half.
        let mut loaded_m = of_halves(&stations_m);
        loaded_m.extend(of_halves(&grid.face.at_m));
        let mut reported_m = frame.face_ends_m().to_vec();
        reported_m.extend(Half::BOTH.map(|half| frame.mid_face_m(half)));
        reported_m.push(0.0);
        let mut flexibilities = Vec::with_capacity(2);
        let mut sections = Vec::with_capacity(2);
        for shaft in [&train.pinion, &train.gear] {
            let length_m: f64 = shaft.segments.iter().map(|segment| segment.length_m).sum();
            let shape_m: Vec<f64> = (0..SHAPE_SECTIONS)
                .map(|i| length_m * i as f64 / (SHAPE_SECTIONS - 1) as f64 - shaft.gear_position_m)
                .collect();
            let mut outputs_m = loaded_m.clone();
            outputs_m.extend(&reported_m);
            outputs_m.extend(shaft.bearings.iter().map(|bearing| bearing.position_m - shaft.gear_position_m));
            outputs_m.extend(&shape_m);
            let all = shaft.flexibility(&outputs_m, &loaded_m)?;
            let (from, columns) = (6 * loaded_m.len(), 12 * count);
            let flexibility = all.view((from, 0), (all.nrows() - from, columns)).into_owned();
            sections.push(ShaftSections { flexibility, bearings: shaft.bearings.len(), shape_m });
            flexibilities.push(all);
        }
        let [pinion, gear] = [flexibilities.remove(0), flexibilities.remove(0)];
        // Opening at section `i` per force at section `j` of the loaded ones, in both bodies: rows of the response
        // without and with x, by loads without and with x.
        let entry = |(half, i): (Half, usize), (load_half, j): (Half, usize)| -> [f64; 4] {
            let mut out = [0.0; 4];
            for (body, all) in Body::BOTH.into_iter().zip([&pinion, &gear]) {
                let parts = |half| {
                    let constant = frame.load(body, half, 0.0);
                    let at_one = frame.load(body, half, 1.0);
                    [constant, std::array::from_fn(|c| at_one[c] - constant[c])]
                };
                let (rows, loads): ([Section; 2], [Section; 2]) = (parts(half), parts(load_half));
                for (a, row) in rows.iter().enumerate() {
                    for (b, load) in loads.iter().enumerate() {
                        let mut sum = 0.0;
                        for (r, weight) in row.iter().enumerate() {
                            for (c, force) in load.iter().enumerate() {
                                sum += weight * all[(6 * i + r, 6 * j + c)] * force;
                            }
                        }
                        out[2 * a + b] += sum;
                    }
                }
            }
            out
        };
        let halves = Half::BOTH.map(|half| {
            let first = half.index() * count;
            let mut table = Vec::with_capacity(count * count);
            for i in 0..count {
                table.extend((0..count).map(|j| entry((half, first + i), (half, first + j))));
            }
            HalfFlexibility { stations: count, table }
        });
        let across = Half::BOTH.map(|half| {
            let other = if half == Half::Left { Half::Right } else { Half::Left };
            let nodes_of = |half: Half| 2 * count + half.index() * FACE_NODES;
            let mut table = Vec::with_capacity(NODES * NODES);
            for k in 0..NODES {
                let (_, x_m) = grid.node(k);
                for l in 0..NODES {
                    let (_, load_x_m) = grid.node(l);
                    let response = (half, nodes_of(half) + k / PATH_NODES);
                    let c = entry(response, (other, nodes_of(other) + l / PATH_NODES));
                    table.push(c[0] + load_x_m * c[1] + x_m * (c[2] + load_x_m * c[3]));
                }
            }
            table
        });
        let mid_face = |half: Half| 2 * (count + FACE_NODES) + MID_FACES_FROM + half.index();
        let mut openings = Vec::with_capacity((2 * HALF_ROWS + 1) * 4 * count);
        let loads = || (0..2 * count).map(|j| (if j < count { Half::Left } else { Half::Right }, j));
        let mut add = |half: Half, section: usize, x_m: f64| {
            for load in loads() {
                let c = entry((half, section), load);
                openings.extend([c[0] + x_m * c[2], c[1] + x_m * c[3]]);
            }
        };
        for half in Half::BOTH {
            add(half, mid_face(half), frame.pitch_point_m);
            for k in 0..NODES {
                let (_, x_m) = grid.node(k);
                add(half, 2 * count + half.index() * FACE_NODES + k / PATH_NODES, x_m);
            }
        }
        let apex = 6 * (2 * (count + FACE_NODES) + APEX_SECTION) + 2;
        for (half, j) in loads() {
            let [constant, at_one] = [0.0, 1.0].map(|x_m| frame.load(Body::Pinion, half, x_m));
            let by = |force: &dyn Fn(usize) -> f64| (0..6).map(|c| -pinion[(apex, 6 * j + c)] * force(c)).sum::<f64>();
            openings.extend([by(&|c| constant[c]), by(&|c| at_one[c] - constant[c])]);
        }
        let [pinion_sections, gear_sections] = [sections.remove(0), sections.remove(0)];
        Ok(ContactShafts {
            frame,
            train: train.clone(),
            freedom,
            halves,
            across,
            grid,
            sections: [pinion_sections, gear_sections],
            openings,
            stations: count,
        })
    }

    /// The member that is free to move axially.
    pub fn freedom(&self) -> AxialFreedom {
        self.freedom
    }

    /// Displacements of the sections of both shafts. `float_m` is the axial shift of the member that floats.
    pub(super) fn displacements(&self, loads: &StationLoads, float_m: f64) -> [SectionDisplacements; 2] {
        let count = self.stations;
        Body::BOTH.map(|body| {
            let sign = if body == Body::Pinion { -1.0 } else { 1.0 };
            let mut forces = nalgebra::DVector::zeros(12 * count);
            for half in Half::BOTH {
                let constant = self.frame.load(body, half, 0.0);
                let at_one = self.frame.load(body, half, 1.0);
                for (j, [force, moment]) in loads[half.index()].iter().enumerate() {
                    for c in 0..6 {
                        forces[6 * (half.index() * count + j) + c] +=
                            sign * (constant[c] * force + (at_one[c] - constant[c]) * moment);
                    }
                }
            }
            let sections = &self.sections[body as usize];
            let all = &sections.flexibility * forces;
            let shift = match (body, self.freedom) {
                (Body::Pinion, AxialFreedom::Pinion) | (Body::Gear, AxialFreedom::Gear) => float_m,
                _ => 0.0,
            };
            let section =
                |i: usize| -> Section { std::array::from_fn(|c| all[6 * i + c] + if c == 2 { shift } else { 0.0 }) };
            let shape_from = NAMED_SECTIONS + sections.bearings;
            SectionDisplacements {
                face_ends: std::array::from_fn(section),
                mid_faces: std::array::from_fn(|i| section(MID_FACES_FROM + i)),
                apex: section(APEX_SECTION),
                bearings: (NAMED_SECTIONS..shape_from).map(section).collect(),
                shape: (shape_from..shape_from + sections.shape_m.len()).map(section).collect(),
            }
        })
    }

    /// Openings under the same loads.
    pub(super) fn openings(&self, loads: &StationLoads, float_m: f64) -> Openings {
        let forces: Vec<f64> = loads.iter().flatten().flatten().copied().collect();
        let row = |i: usize| dot(&self.openings[i * forces.len()..(i + 1) * forces.len()], &forces);
        let (closing_m, apex_m) = match self.freedom {
            AxialFreedom::None => (0.0, 0.0),
            AxialFreedom::Pinion => (float_m, float_m),
            AxialFreedom::Gear => (-float_m, 0.0),
        };
        let of = |h: usize, i: usize| row(h * HALF_ROWS + i) - self.frame.axial[h] * closing_m;
        Openings {
            mid_face_m: [0, 1].map(|h| of(h, 0)),
            nodes_m: [0, 1].map(|h| std::array::from_fn(|k| of(h, 1 + k))),
            apex_m: row(2 * HALF_ROWS) + apex_m,
        }
    }

    /// The field that takes these values at the nodes.
    pub(super) fn field(&self, opening_m: [f64; NODES]) -> DisplacementField {
        DisplacementField { grid: self.grid.clone(), opening_m }
    }

    /// Places of the sections of the deflected shape of pinion and gear, from the apex plane.
    pub(super) fn shape_m(&self) -> [&[f64]; 2] {
        [&self.sections[0].shape_m, &self.sections[1].shape_m]
    }
}
