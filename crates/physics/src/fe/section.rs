//! Mesh of the transverse section of one sector (tooth with half a space on either side, down to the held circle):
//! nine-node quadrilaterals on a logical grid of rows and columns.
//!
//! The tooth is cut into rows along circles about the axis. Where the fillet's surface leans by 45° the rows end: below
//! that point the surface is the upper border of the outermost columns, which run radially to the held circle like all
//! others. So no element has a flat or reentrant corner, however the fillet runs into the root circle.

use super::input::FeError;
use super::surface::{InvoluteFlank, land_points, row_radii_m, turning_radius_m};
use crate::gear::Member;

/// Element sizes, in normal modules unless said otherwise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SectionSizes {
    /// Rows between two profile nodes of the load grid.
    pub rows_per_cell: usize,
    /// Rows in the first and the last cell of the profile, whose outer hats are half as wide.
    pub rows_per_end_cell: usize,
    /// Rows in the fillet above the 45° point.
    pub fillet_rows: usize,
    /// Column widths over the tooth from the unloaded to the loaded flank, as parts that add up to one.
    pub columns: Vec<f64>,
    /// Columns from the 45° point to the middle of the space.
    pub land_columns: usize,
    /// Thickness of the first row of the rim.
    pub first_rim_row: f64,
    /// Thickness of the row at the held circle.
    pub held_row: f64,
    /// Growth of the rim's rows from both ends.
    pub growth: f64,
}

/// A node: section coordinates with the tooth's centreline along y, and its place on the logical grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    /// Across the tooth, positive towards the loaded flank.
    pub x_m: f64,
    /// Along the centreline of the tooth, outwards.
    pub y_m: f64,
    /// Column of the logical grid.
    pub column: i32,
    /// Row of the logical grid, inwards.
    pub row: i32,
}

/// Border that a node lies on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Border {
    Inside,
    /// Held.
    Held,
    /// Cut face at the smaller angle, `n`-th from outside.
    Low(usize),
    /// Cut face at the larger angle (the side of the loaded flank).
    High(usize),
}

/// An edge of an element on the loaded flank: arc length from the form point at its ends, its three nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FlankEdge {
    /// Arc length at the inner end.
    pub from_m: f64,
    /// Arc length at the outer end.
    pub to_m: f64,
    /// Nodes.
    pub nodes: [usize; 3],
}

/// The mesh of one section.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SectionMesh {
    /// Nodes.
    pub nodes: Vec<Node>,
    /// Border of every node.
    pub borders: Vec<Border>,
    /// Nodes in the order of the shape functions: `3 * (row 0..3 inwards) + (column 0..3)`.
    pub elements: Vec<[usize; 9]>,
    /// Edges on the loaded flank.
    pub flank: Vec<FlankEdge>,
}

impl SectionSizes {
    /// Rows in every cell of the profile, from the tip inwards.
    fn rows(&self, cells: usize) -> Vec<usize> {
        (0..cells).map(|i| if i == 0 || i + 1 == cells { self.rows_per_end_cell } else { self.rows_per_cell }).collect()
    }
}

impl SectionMesh {
    /// The mesh of `member` down to `hold_radius_m`, with rows at the profile nodes `profile_m` (arc lengths from 0 to
    /// the flank's length).
    pub(super) fn new(
        member: &Member,
        involute: &InvoluteFlank,
        normal_module_m: f64,
        hold_radius_m: f64,
        profile_m: &[f64],
        sizes: &SectionSizes,
    ) -> Result<SectionMesh, FeError> {
        let m = normal_module_m;
        let root = member.root_radius_m;
        if !(hold_radius_m > 0.0 && hold_radius_m <= root - 0.05 * m) {
            return Err(FeError::NoRim { hold_radius_m, root_radius_m: root });
        }
        let tip_land = member.transverse_thickness_m(member.tip_radius_m);
        if tip_land.is_nan() || tip_land <= 1e-3 * m {
            return Err(FeError::Form { what: "the tooth thickness at the tip", value_m: tip_land });
        }
        let turn = turning_radius_m(member, m);
        let radii = {
            let rows = sizes.rows(profile_m.len() - 1);
            row_radii_m(member, involute, turn, m, profile_m, &rows, sizes.fillet_rows)
        };
        let mut builder = SectionBuilder::new(member, sizes, radii.len() as i32 - 1);
        builder.tooth(&radii);
        builder.rim(turn, hold_radius_m, m);
        let section = builder.finish(profile_m);
        section.check()?;
        Ok(section)
    }

    /// Fails on a degenerate element.
    fn check(&self) -> Result<(), FeError> {
        for (index, element) in self.elements.iter().enumerate() {
            let corners = [-1.0, -0.7746, 0.0, 0.7746, 1.0];
            let mut least = f64::INFINITY;
            let mut mean = 0.0;
            for &v in &corners {
                for &u in &corners {
                    let jacobian = self.jacobian(element, u, v);
                    least = least.min(jacobian);
                    mean += jacobian / 25.0;
                }
            }
            let ratio = least / mean;
            if !(mean > 0.0 && ratio > 1e-3) {
                return Err(FeError::Mesh { element: index, jacobian: ratio });
            }
        }
        Ok(())
    }

    fn jacobian(&self, element: &[usize; 9], u: f64, v: f64) -> f64 {
        let (_, du, dv) = shapes(u, v);
        let mut j = [0.0; 4];
        for (k, &node) in element.iter().enumerate() {
            let node = &self.nodes[node];
            j[0] += du[k] * node.x_m;
            j[1] += du[k] * node.y_m;
            j[2] += dv[k] * node.x_m;
            j[3] += dv[k] * node.y_m;
        }
        j[0] * j[3] - j[1] * j[2]
    }
}

fn quadratic(u: f64) -> ([f64; 3], [f64; 3]) {
    ([0.5 * u * (u - 1.0), 1.0 - u * u, 0.5 * u * (u + 1.0)], [u - 0.5, -2.0 * u, u + 0.5])
}

/// Quadratic shape functions of an edge at `u` in [-1, 1].
pub(super) fn edge_shapes(u: f64) -> [f64; 3] {
    quadratic(u).0
}

/// Biquadratic shape functions and their derivatives by `u` (along the columns' order) and `v` (outwards).
pub(super) fn shapes(u: f64, v: f64) -> ([f64; 9], [f64; 9], [f64; 9]) {
    let (fu, gu) = quadratic(u);
    // Rows run inwards, v outwards.
    let (fv, gv) = quadratic(-v);
    let mut out = ([0.0; 9], [0.0; 9], [0.0; 9]);
    for i in 0..3 {
        for j in 0..3 {
            out.0[3 * i + j] = fv[i] * fu[j];
            out.1[3 * i + j] = fv[i] * gu[j];
            out.2[3 * i + j] = -gv[i] * fu[j];
        }
    }
    out
}

struct SectionBuilder<'a> {
    member: &'a Member,
    sizes: &'a SectionSizes,
    /// Places of the columns of nodes on the tooth, -1 to 1.
    across: Vec<f64>,
    /// Logical row of the turning point.
    turn_row: i32,
    rim_rows: i32,
    land: i32,
    nodes: Vec<Node>,
    index: std::collections::HashMap<(i32, i32), usize>,
}

impl<'a> SectionBuilder<'a> {
    fn new(member: &'a Member, sizes: &'a SectionSizes, turn_row: i32) -> SectionBuilder<'a> {
        let mut across = vec![-1.0];
        let total: f64 = sizes.columns.iter().sum();
        let mut sum = 0.0;
        for width in &sizes.columns {
            across.push(-1.0 + 2.0 * (sum + 0.5 * width) / total);
            sum += width;
            across.push(-1.0 + 2.0 * sum / total);
        }
        let land = 2 * sizes.land_columns as i32;
        SectionBuilder {
            member,
            sizes,
            across,
            turn_row,
            rim_rows: 0,
            land,
            nodes: Vec::new(),
            index: Default::default(),
        }
    }

    fn add(&mut self, column: i32, row: i32, r: f64, angle: f64) {
        let (sin, cos) = angle.sin_cos();
        self.index.insert((column, row), self.nodes.len());
        self.nodes.push(Node { x_m: r * sin, y_m: r * cos, column, row });
    }

    /// Tooth columns carry the numbers `land ..= land + tooth`.
    fn tooth(&mut self, radii: &[f64]) {
        for (row, &r) in radii.iter().enumerate() {
            let half = self.member.half_angle_rad(r);
            for i in 0..self.across.len() {
                self.add(self.land + i as i32, row as i32, r, self.across[i] * half);
            }
        }
    }

    fn rim(&mut self, turn: f64, hold: f64, m: f64) {
        let depth = self.member.root_radius_m - hold;
        // Thin rows at both ends: the surface above, the held edge (a singular line on the end faces) below.
        let (mut above, mut below) = (vec![self.sizes.first_rim_row * m], Vec::new());
        let mut next = (above[0] * self.sizes.growth, self.sizes.held_row * m);
        while above.iter().sum::<f64>() + below.iter().sum::<f64>() < 0.9 * depth {
            let (rows, height) = if next.1 < next.0 { (&mut below, &mut next.1) } else { (&mut above, &mut next.0) };
            rows.push(*height);
            *height *= self.sizes.growth;
        }
        let heights: Vec<f64> = above.into_iter().chain(below.into_iter().rev()).collect();
        let total: f64 = heights.iter().sum();
        let mut parts = vec![0.0];
        let mut sum = 0.0;
        for height in &heights {
            parts.push((sum + 0.5 * height) / total);
            sum += height;
            parts.push(sum / total);
        }
        self.rim_rows = parts.len() as i32 - 1;
        // Upper border, from the low to the high cut face.
        let surface = land_points(self.member, turn, self.land as usize);
        let half = self.member.half_angle_rad(turn);
        let mut top: Vec<(f64, f64)> = surface.iter().rev().map(|&(r, angle)| (r, -angle)).collect();
        top.extend(self.across.iter().map(|a| (turn, a * half)));
        top.extend(surface.iter().copied());
        let tooth = self.land..=self.land + self.across.len() as i32 - 1;
        for (row, part) in parts.iter().enumerate() {
            for (column, &(r, angle)) in top.iter().enumerate() {
                let column = column as i32;
                if row == 0 && tooth.contains(&column) {
                    continue;
                }
                self.add(column, self.turn_row + row as i32, r + (hold - r) * part, angle);
            }
        }
    }

    fn finish(self, profile_m: &[f64]) -> SectionMesh {
        let last_row = self.turn_row + self.rim_rows;
        let high = 2 * self.land + self.across.len() as i32 - 1;
        let borders = self
            .nodes
            .iter()
            .map(|node| {
                let down = (node.row - self.turn_row).max(0) as usize;
                match node {
                    node if node.row == last_row => Border::Held,
                    node if node.column == 0 => Border::Low(down),
                    node if node.column == high => Border::High(down),
                    _ => Border::Inside,
                }
            })
            .collect();
        let mut elements = Vec::new();
        for row in (0..last_row).step_by(2) {
            for column in (0..high).step_by(2) {
                let nodes: Option<Vec<usize>> =
                    (0..9).map(|k| self.index.get(&(column + k % 3, row + k / 3)).copied()).collect();
                if let Some(nodes) = nodes {
                    let mut element = [0; 9];
                    element.copy_from_slice(&nodes);
                    elements.push(element);
                }
            }
        }
        let loaded = self.land + self.across.len() as i32 - 1;
        let mut flank = Vec::new();
        let mut row = 0;
        for (cell, rows) in profile_m.windows(2).rev().zip(self.sizes.rows(profile_m.len() - 1)) {
            for part in 0..rows {
                let at = |k: usize| cell[1] + (cell[0] - cell[1]) * k as f64 / rows as f64;
                let nodes = [2, 1, 0].map(|k| self.index[&(loaded, row + k)]);
                flank.push(FlankEdge { from_m: at(part + 1), to_m: at(part), nodes });
                row += 2;
            }
        }
        SectionMesh { nodes: self.nodes, borders, elements, flank }
    }
}
