//! The geared rotor: both shafts as beams with consistent mass, rigid bodies, bearings, machines and two mesh springs.
//!
//! ```text
//! M ü + (C + Ω G) u̇ + K u = Σ_h h_h (k_m e_h + c_m ė_h)
//! h = [n, r_p × n | −n, −r_g × n]     F = k_m (h·u − e) + c_m d/dt (h·u − e)
//! ```
//!
//! h is the row of a mesh spring over the six displacements of the pinion's and of the gear's section, n the normal of
//! the flanks (the direction of the force on the gear), r the levers to the pitch point, e a displacement excitation
//! along n, positive where material is removed. h·u > 0 closes the driving flanks.

mod eigen;
mod element;
mod modes;
mod nodes;
mod reduced;
mod reduction;
mod response;
mod sparse;
mod whirl;

pub use modes::{KineticShares, ModeRange, RotorMode, RotorModes, StrainShares};
pub use reduced::ReducedRotor;
pub use reduction::{ReductionReport, ReductionSettings, ReductionStep};
pub use response::{FrequencyResponse, Harmonics};
pub use whirl::DampedMode;

use element::Element;
use nodes::ShaftNodes;
use sparse::{SparseBuilder, SparseMatrix, SparseRow};

use super::error::{ShaftError, ShaftItem};
use super::shaft::{RigidBody, Shaft, ShaftTrain, not_negative, positive};
use crate::gear::{Half, MemberId, Pair, Rotation};

/// Sense of rotation of the pinion, seen along +z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotationSense {
    /// Right-handed about +z: σ = +1.
    Positive,
    /// Right-handed about −z: σ = −1.
    Negative,
}

impl RotationSense {
    /// The sense in which a pinion whose left half is left-handed (or right-handed) turns when its apex leads or
    /// trails: σ H = −1 for the right half if the apex leads, with H = +1 for a right-hand half.
    pub fn of(rotation: Rotation, left_half_is_left_handed: bool) -> RotationSense {
        match (rotation, left_half_is_left_handed) {
            (Rotation::ApexLeading, true) | (Rotation::ApexTrailing, false) => RotationSense::Negative,
            _ => RotationSense::Positive,
        }
    }

    /// σ: +1 or −1.
    pub fn sign(self) -> f64 {
        match self {
            RotationSense::Positive => 1.0,
            RotationSense::Negative => -1.0,
        }
    }
}

/// Mesh spring of one half along the flank normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshElement {
    /// Stiffness k_m, N/m.
    pub stiffness_n_per_m: f64,
    /// Damping c_m, N s/m.
    pub damping_n_s_per_m: f64,
    /// z of its section on both shafts, m, from the apex plane.
    pub position_m: f64,
    /// Stiffness against the relative tilt of the sections in the plane of action, about e_z × n, N m/rad; k_m b²/12
    /// for a stiffness that is distributed evenly over the face width b, 0 for a plain mesh spring.
    pub tilting_nm_per_rad: f64,
    /// Moment of the tooth forces about the section at no relative tilt, on the same axis, N m: constant, so that it
    /// loads the reduced train but has no part in modes and harmonic vibration. 0 for forces in the section.
    pub tilting_moment_nm: f64,
    /// Whether the coast flanks carry: their normal leans to the other side of the transverse base tangent, so that its
    /// component along the line of centres separates the axes too. The displacement of the mesh stays positive where it
    /// closes the drive flanks.
    pub on_coast_flanks: bool,
}

impl MeshElement {
    /// A plain mesh spring at mid-face.
    pub fn at_mid_face(pair: &Pair, half: Half, stiffness_n_per_m: f64, damping_n_s_per_m: f64) -> MeshElement {
        let position_m = mid_face_m(pair)[half.index()];
        MeshElement {
            stiffness_n_per_m,
            damping_n_s_per_m,
            position_m,
            tilting_nm_per_rad: 0.0,
            tilting_moment_nm: 0.0,
            on_coast_flanks: false,
        }
    }
}

/// z of the middle of the left and of the right face, m.
fn mid_face_m(pair: &Pair) -> [f64; 2] {
    let middle = 0.5 * (pair.spec.gap_width_m + pair.spec.face_width_m);
    [-middle, middle]
}

/// Geometry of the meshes.
#[derive(Debug, Clone, Copy)]
struct MeshGeometry {
    /// σ.
    sense: f64,
    /// n of the left and of the right half.
    normals: [[f64; 3]; 2],
    /// Transverse base tangent d, the direction in which the pinion pushes the gear.
    tangent: [f64; 3],
    /// Factor of u_z in the axial displacement of [`crate::dynamics`], −σ H of the left half.
    axial: f64,
    pitch_radii_m: [f64; 2],
    base_radii_m: [f64; 2],
    teeth_ratio: f64,
}

impl MeshGeometry {
    fn new(pair: &Pair, sense: RotationSense) -> MeshGeometry {
        let sense = sense.sign();
        let (alpha, beta) = (pair.working_pressure_angle_rad, pair.base_helix_angle_rad);
        // σ H of the right half.
        let hand = match pair.spec.rotation {
            Rotation::ApexLeading => -1.0,
            Rotation::ApexTrailing => 1.0,
        };
        let tangent = [alpha.sin(), sense * alpha.cos(), 0.0];
        let normal = |hand: f64| [tangent[0] * beta.cos(), tangent[1] * beta.cos(), -hand * beta.sin()];
        let base_radii_m = [pair.pinion.base_radius_m, pair.gear.base_radius_m];
        MeshGeometry {
            sense,
            normals: [normal(-hand), normal(hand)],
            tangent,
            axial: hand,
            pitch_radii_m: base_radii_m.map(|radius| radius / alpha.cos()),
            base_radii_m,
            teeth_ratio: f64::from(pair.pinion.teeth) / f64::from(pair.gear.teeth),
        }
    }
}

/// A mesh spring with its rows over all unknowns.
#[derive(Debug, Clone)]
struct Mesh {
    element: MeshElement,
    row: SparseRow,
    tilt: SparseRow,
}

/// A bearing with the rows of the displacements of its section.
#[derive(Debug, Clone)]
struct RotorBearing {
    section: [SparseRow; 6],
    stiffness: [[f64; 6]; 6],
    damping: [[f64; 6]; 6],
}

/// One shaft of the rotor.
#[derive(Debug, Clone)]
struct RotorShaft {
    nodes: ShaftNodes,
    bearings: Vec<RotorBearing>,
    /// Rows of the sections at mid-face of the left and the right half.
    mid_face: [[SparseRow; 6]; 2],
    /// Row of the rotation about z at the coupling, and of the axial displacement there.
    coupling: [SparseRow; 2],
    /// Unknown of the machine's rotation.
    machine: Option<usize>,
    /// Stiffness of the beams alone.
    beams: SparseMatrix,
}

/// Both shafts with their bodies, bearings, machines and mesh springs, as matrices. Unknowns: six displacements of each
/// node, and the rotation of each machine.
#[derive(Debug, Clone)]
pub struct GearedRotor {
    train: ShaftTrain,
    geometry: MeshGeometry,
    shafts: [RotorShaft; 2],
    meshes: [Mesh; 2],
    mass: SparseMatrix,
    /// Symmetric part of the stiffness with the mesh springs.
    stiffness: SparseMatrix,
    /// The same without the mesh springs; the meshes' tilting stiffness is in it.
    open_stiffness: SparseMatrix,
    /// Antisymmetric part of the bearings' stiffness.
    cross_stiffness: SparseMatrix,
    /// Dampers of bearings and couplings.
    damping: SparseMatrix,
    /// Gyroscopic matrix per angular velocity of the pinion about z.
    gyroscopic: SparseMatrix,
    /// Rounding of an eigenvalue, rad²/s²: that of the largest one that the beams can have.
    rounding: f64,
}

impl GearedRotor {
    /// The rotor of a train and its mesh springs (left, right). Both pairs of flanks are in contact; each mesh acts at
    /// the pitch point.
    ///
    /// # Errors
    /// As [`Shaft::validate`]; [`ShaftError::SingularSupport`], [`ShaftError::BothFloatAxially`],
    /// [`ShaftError::InvalidValue`], [`ShaftError::OutsideShaft`], [`ShaftError::TooLarge`].
    pub fn new(
        train: &ShaftTrain,
        pair: &Pair,
        sense: RotationSense,
        meshes: &[MeshElement; 2],
    ) -> Result<GearedRotor, ShaftError> {
        if train.pinion.floats_axially() && train.gear.floats_axially() {
            return Err(ShaftError::BothFloatAxially);
        }
        Self::with_element_length(train, pair, sense, meshes, None)
    }

    /// The rotor with elements of at most a given length, for studies of convergence; `None`: the usual length. Shafts
    /// may float axially.
    ///
    /// # Errors
    /// As [`GearedRotor::new`].
    pub fn with_element_length(
        train: &ShaftTrain,
        pair: &Pair,
        sense: RotationSense,
        meshes: &[MeshElement; 2],
        element_m: Option<f64>,
    ) -> Result<GearedRotor, ShaftError> {
        let geometry = MeshGeometry::new(pair, sense);
        let mid_face_m = mid_face_m(pair);
        for (i, mesh) in meshes.iter().enumerate() {
            not_negative(ShaftItem::Mesh(i), "stiffness_n_per_m", mesh.stiffness_n_per_m)?;
            not_negative(ShaftItem::Mesh(i), "damping_n_s_per_m", mesh.damping_n_s_per_m)?;
            not_negative(ShaftItem::Mesh(i), "tilting_nm_per_rad", mesh.tilting_nm_per_rad)?;
        }
        if let Some(length_m) = element_m {
            positive(ShaftItem::Section(0), "element length_m", length_m)?;
        }
        let shafts = [&train.pinion, &train.gear];
        let mut nodes = Vec::with_capacity(2);
        for shaft in shafts {
            shaft.validate()?;
            shaft.check_support()?;
            nodes.push(ShaftNodes::new(shaft, &points_of_interest(shaft, meshes, mid_face_m), element_m)?);
        }
        let rounding = nodes.iter().flat_map(|nodes| &nodes.elements).map(Element::eigenvalue_rounding);
        let rounding = rounding.fold(0.0, f64::max);
        let (size, machines) = number_unknowns(&mut nodes, shafts);

        let mut matrices = Builders::default();
        let mut built = Vec::with_capacity(2);
        for (member, ((shaft, nodes), machine)) in shafts.into_iter().zip(nodes).zip(machines).enumerate() {
            // Angular velocity per that of the pinion.
            let speed_ratio = if member == 0 { 1.0 } else { -geometry.teeth_ratio };
            built.push(matrices.add_shaft(shaft, nodes, machine, speed_ratio, mid_face_m, size));
        }
        let Ok::<[RotorShaft; 2], _>(shafts) = built.try_into() else {
            return Err(ShaftError::IllConditioned { reason: "two shafts are needed" });
        };
        let meshes = [0, 1].map(|half| Mesh::new(half, meshes[half], &geometry, &shafts));
        for mesh in &meshes {
            matrices.stiffness.add_outer(mesh.element.tilting_nm_per_rad, &mesh.tilt, &mesh.tilt);
        }
        let open_stiffness = matrices.stiffness.clone().build(size);
        for mesh in &meshes {
            matrices.stiffness.add_outer(mesh.element.stiffness_n_per_m, &mesh.row, &mesh.row);
        }
        Ok(GearedRotor {
            train: train.clone(),
            geometry,
            shafts,
            meshes,
            mass: matrices.mass.build(size),
            stiffness: matrices.stiffness.build(size),
            open_stiffness,
            cross_stiffness: matrices.cross_stiffness.build(size),
            damping: matrices.damping.build(size),
            gyroscopic: matrices.gyroscopic.build(size),
            rounding,
        })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.mass.size()
    }

    /// z of the nodes of a shaft, m, from the apex plane.
    pub fn stations_m(&self, member: MemberId) -> &[f64] {
        &self.shafts[member_index(member)].nodes.z_m
    }

    /// Rows of the displacements of a section over the unknowns.
    fn displacements_at_nodes(&self, member: usize, vector: &[f64]) -> Vec<[f64; 6]> {
        let unknowns = &self.shafts[member].nodes.unknowns;
        unknowns.iter().map(|&first| std::array::from_fn(|i| vector[first + i])).collect()
    }
}

fn member_index(member: MemberId) -> usize {
    match member {
        MemberId::Pinion => 0,
        MemberId::Gear => 1,
    }
}

/// Sections of a shaft that get a node, in z.
fn points_of_interest(shaft: &Shaft, meshes: &[MeshElement; 2], mid_face_m: [f64; 2]) -> Vec<(ShaftItem, f64)> {
    let z = |position_m: f64| position_m - shaft.gear_position_m;
    let mut points: Vec<_> =
        shaft.bearings.iter().enumerate().map(|(i, b)| (ShaftItem::Bearing(i), z(b.position_m))).collect();
    points.push((ShaftItem::Coupling, z(shaft.coupling.position_m)));
    points.extend(shaft.bodies.iter().enumerate().map(|(i, (position, _))| (ShaftItem::Body(i), z(*position))));
    points.extend(meshes.iter().enumerate().map(|(i, mesh)| (ShaftItem::Mesh(i), mesh.position_m)));
    points.extend(mid_face_m.map(|middle| (ShaftItem::Gear, middle)));
    points
}

/// Numbers the unknowns along z across both shafts, each machine after the node before its coupling, so that all
/// matrices have a narrow band. Returns their number and those of the machines.
fn number_unknowns(nodes: &mut [ShaftNodes], shafts: [&Shaft; 2]) -> (usize, [Option<usize>; 2]) {
    enum Owner {
        Node(usize, usize),
        Machine(usize),
    }
    let mut order = Vec::new();
    for (member, (shaft_nodes, shaft)) in nodes.iter_mut().zip(shafts).enumerate() {
        shaft_nodes.unknowns = vec![0; shaft_nodes.z_m.len()];
        order.extend(shaft_nodes.z_m.iter().enumerate().map(|(i, &z)| (z, Owner::Node(member, i))));
        if shaft.coupling.torsional.is_some() {
            order.push((shaft.coupling_section_m(), Owner::Machine(member)));
        }
    }
    // Stable: at equal z the pinion's nodes come first.
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut next = 0;
    let mut machines = [None; 2];
    for (_, owner) in order {
        match owner {
            Owner::Node(member, node) => {
                nodes[member].unknowns[node] = next;
                next += 6;
            }
            Owner::Machine(member) => {
                machines[member] = Some(next);
                next += 1;
            }
        }
    }
    (next, machines)
}

/// The matrices while they are assembled.
#[derive(Debug, Default)]
struct Builders {
    mass: SparseBuilder,
    stiffness: SparseBuilder,
    cross_stiffness: SparseBuilder,
    damping: SparseBuilder,
    gyroscopic: SparseBuilder,
}

impl Builders {
    fn add_shaft(
        &mut self,
        shaft: &Shaft,
        nodes: ShaftNodes,
        machine: Option<usize>,
        speed_ratio: f64,
        mid_face_m: [f64; 2],
        size: usize,
    ) -> RotorShaft {
        let mut beams = SparseBuilder::default();
        for (i, element) in nodes.elements.iter().enumerate() {
            let unknowns = nodes.element_unknowns(i);
            let (stiffness, mass, gyroscopic) = (element.stiffness(), element.mass(), element.gyroscopic());
            for (row, &a) in unknowns.iter().enumerate() {
                for (column, &b) in unknowns.iter().enumerate() {
                    beams.add(a, b, stiffness[row][column]);
                    self.stiffness.add(a, b, stiffness[row][column]);
                    self.mass.add(a, b, mass[row][column]);
                    self.gyroscopic.add(a, b, speed_ratio * gyroscopic[row][column]);
                }
            }
        }
        let z = |position_m: f64| position_m - shaft.gear_position_m;
        let bearings = shaft
            .bearings
            .iter()
            .map(|bearing| {
                let section = nodes.section(z(bearing.position_m));
                let (stiffness, damping) = (bearing.stiffness(), bearing.damping());
                for (i, row) in section.iter().enumerate() {
                    for (j, column) in section.iter().enumerate() {
                        let symmetric = 0.5 * (stiffness[i][j] + stiffness[j][i]);
                        self.stiffness.add_outer(symmetric, row, column);
                        self.cross_stiffness.add_outer(stiffness[i][j] - symmetric, row, column);
                        self.damping.add_outer(damping[i][j], row, column);
                    }
                }
                RotorBearing { section, stiffness, damping }
            })
            .collect();
        let mid_face = mid_face_m.map(|middle| nodes.section(middle));
        for section in &mid_face {
            shaft.half_body.iter().for_each(|body| self.add_body(section, body, speed_ratio));
        }
        for (position_m, body) in &shaft.bodies {
            self.add_body(&nodes.section(z(*position_m)), body, speed_ratio);
        }
        let [_, _, axial, _, _, rotation] = nodes.section(shaft.coupling_section_m());
        self.stiffness.add_outer(shaft.coupling.axial_n_per_m, &axial, &axial);
        if let (Some(unknown), Some(spring)) = (machine, &shaft.coupling.torsional) {
            self.mass.add(unknown, unknown, spring.inertia_kg_m2);
            let mut twist = rotation.clone();
            twist.push((unknown, -1.0));
            self.stiffness.add_outer(spring.torsional_nm_per_rad, &twist, &twist);
            self.damping.add_outer(spring.torsional_damping_nm_s_per_rad, &twist, &twist);
        }
        RotorShaft { nodes, bearings, mid_face, coupling: [rotation, axial], machine, beams: beams.build(size) }
    }

    fn add_body(&mut self, section: &[SparseRow; 6], body: &RigidBody, speed_ratio: f64) {
        let [x, y, z, about_x, about_y, about_z] = section;
        for row in [x, y, z] {
            self.mass.add_outer(body.mass_kg, row, row);
        }
        for row in [about_x, about_y] {
            self.mass.add_outer(body.diametral_inertia_kg_m2, row, row);
        }
        self.mass.add_outer(body.polar_inertia_kg_m2, about_z, about_z);
        let polar = speed_ratio * body.polar_inertia_kg_m2;
        self.gyroscopic.add_outer(polar, about_x, about_y);
        self.gyroscopic.add_outer(-polar, about_y, about_x);
    }
}

impl Mesh {
    fn new(half: usize, element: MeshElement, geometry: &MeshGeometry, shafts: &[RotorShaft; 2]) -> Mesh {
        let mut n = geometry.normals[half];
        if element.on_coast_flanks {
            n[0] = -n[0];
        }
        // e_x × n and e_z × n.
        let (moment, tilt) = ([0.0, -n[2], n[1]], [-n[1], n[0], 0.0]);
        let mut mesh = Mesh { element, row: SparseRow::new(), tilt: SparseRow::new() };
        for (member, shaft) in shafts.iter().enumerate() {
            let section = shaft.nodes.section(element.position_m);
            // r_p × n = r_1 e_x × n, and −r_g × n = r_2 e_x × n with r_g = −r_2 e_x.
            let sign = [1.0, -1.0][member];
            let radius = geometry.pitch_radii_m[member];
            for i in 0..3 {
                add(&mut mesh.row, sign * n[i], &section[i]);
                add(&mut mesh.row, radius * moment[i], &section[3 + i]);
                add(&mut mesh.tilt, sign * tilt[i], &section[3 + i]);
            }
        }
        mesh
    }
}

/// Adds a multiple of a sparse row.
fn add(row: &mut SparseRow, factor: f64, other: &[(usize, f64)]) {
    if factor == 0.0 {
        return;
    }
    for &(column, value) in other {
        match row.iter_mut().find(|(existing, _)| *existing == column) {
            Some((_, sum)) => *sum += factor * value,
            None => row.push((column, factor * value)),
        }
    }
}
