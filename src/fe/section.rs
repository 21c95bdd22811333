//! Mesh of the transverse section of one sector (tooth with half a space on either side, down to the held circle):
//! nine-node quadrilaterals on a logical grid of rows and columns.
//!
//! The tooth is cut into rows along circles about the axis. Where the fillet's surface leans by 45° the rows end: below
//! that point the surface is the upper border of the outermost columns, which run radially to the held circle like all
//! others. So no element has a flat or reentrant corner, however the fillet runs into the root circle.

use super::input::FeError;
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
    pub x_m: f64,
    pub y_m: f64,
    pub column: i32,
    pub row: i32,
}

/// Which border a node lies on.
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
    pub from_m: f64,
    pub to_m: f64,
    pub nodes: [usize; 3],
}

/// The mesh of one section.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Section {
    pub nodes: Vec<Node>,
    pub borders: Vec<Border>,
    /// Nodes in the order of the shape functions: `3 * (row 0..3 inwards) + (column 0..3)`.
    pub elements: Vec<[usize; 9]>,
    pub flank: Vec<FlankEdge>,
}

/// The involute flank by arc length from the form point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Involute {
    pub base_radius_m: f64,
    pub base_half_angle_rad: f64,
    pub form_roll_m: f64,
    pub length_m: f64,
}

impl Involute {
    pub fn new(member: &Member) -> Result<Involute, FeError> {
        let form_roll_m = member.root_form_roll_m();
        let tip_roll_m = member.tip_roll_m();
        let length_m = (tip_roll_m - form_roll_m) * (tip_roll_m + form_roll_m) / (2.0 * member.base_radius_m);
        if length_m.is_nan() || length_m <= 0.0 {
            return Err(FeError::Form { what: "the length of the usable flank", value_m: length_m });
        }
        Ok(Involute {
            base_radius_m: member.base_radius_m,
            base_half_angle_rad: member.base_half_angle_rad,
            form_roll_m,
            length_m,
        })
    }

    /// Roll length at arc length `s`: s = (ρ² - ρ_form²)/(2 r_b).
    pub fn roll_m(&self, s_m: f64) -> f64 {
        (self.form_roll_m * self.form_roll_m + 2.0 * self.base_radius_m * s_m).sqrt()
    }

    /// Point (x, y) of the loaded flank and the unit normal into the tooth, in the section.
    pub fn at(&self, s_m: f64) -> ([f64; 2], [f64; 2]) {
        let roll = self.roll_m(s_m);
        let angle = roll / self.base_radius_m;
        // The flank's point lies at the end of the tangent of length roll; its normal is the tangent's direction.
        let tangent_point = self.base_half_angle_rad - angle;
        // Angle from the tooth's centreline, growing towards the loaded flank: x = r sin, y = r cos.
        let (sin, cos) = tangent_point.sin_cos();
        let r = self.base_radius_m;
        ([r * sin + roll * cos, r * cos - roll * sin], [-cos, sin])
    }
}

/// Slope of the surface at which rows end and columns begin.
const TURN: f64 = 1.0;

impl SectionSizes {
    /// Rows in every cell of the profile, from the tip inwards.
    fn rows(&self, cells: usize) -> Vec<usize> {
        (0..cells).map(|i| if i == 0 || i + 1 == cells { self.rows_per_end_cell } else { self.rows_per_cell }).collect()
    }
}

impl Section {
    /// The mesh of `member` down to `hold_radius_m`, with rows at the profile nodes `profile_m` (arc lengths from 0 to the
    /// flank's length).
    pub fn new(
        member: &Member,
        involute: &Involute,
        normal_module_m: f64,
        hold_radius_m: f64,
        profile_m: &[f64],
        sizes: &SectionSizes,
    ) -> Result<Section, FeError> {
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
        let radii = row_radii_m(member, involute, turn, m, profile_m, sizes);
        let mut builder = Builder::new(member, sizes, radii.len() as i32 - 1);
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

/// Radius at which the fillet's surface leans by 45°; at most the form radius.
fn turning_radius_m(member: &Member, m: f64) -> f64 {
    let (root, form) = (member.root_radius_m, member.root_form_radius_m);
    // r dψ/dr rises from minus infinity at the root circle.
    let steep = |r: f64| {
        let h = (1e-5 * m).min(0.25 * (r - root));
        r * (member.half_angle_rad(r + h) - member.half_angle_rad(r - h)) / (2.0 * h) < -TURN
    };
    const STEPS: usize = 200;
    let at = |i: usize| {
        let t = i as f64 / STEPS as f64;
        root + (form - root) * t * t
    };
    for i in 1..=STEPS {
        let r = if i == STEPS { form - 1e-5 * m } else { at(i) };
        if !steep(r) {
            let (mut low, mut high) = (at(i - 1), r);
            for _ in 0..50 {
                let middle = 0.5 * (low + high);
                if middle > root && steep(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            return high;
        }
    }
    form
}

/// Radii of the rows of nodes from the tip to the turning point.
fn row_radii_m(
    member: &Member,
    involute: &Involute,
    turn: f64,
    m: f64,
    profile_m: &[f64],
    sizes: &SectionSizes,
) -> Vec<f64> {
    let rb = member.base_radius_m;
    let mut radii = Vec::new();
    for (cell, rows) in profile_m.windows(2).rev().zip(sizes.rows(profile_m.len() - 1)) {
        for i in 0..2 * rows {
            let s = cell[1] + (cell[0] - cell[1]) * i as f64 / (2 * rows) as f64;
            radii.push(involute.roll_m(s).hypot(rb));
        }
    }
    let form = member.root_form_radius_m;
    radii.push(form);
    if form - turn > 2e-3 * m {
        // Even in arc length along the fillet.
        const STEPS: usize = 400;
        let mut lengths = vec![0.0];
        let at = |i: usize| form + (turn - form) * i as f64 / STEPS as f64;
        for i in 1..=STEPS {
            let (r0, r1) = (at(i - 1), at(i));
            let across = 0.5 * (r0 + r1) * (member.half_angle_rad(r0) - member.half_angle_rad(r1));
            lengths.push(lengths[i - 1] + (r0 - r1).hypot(across));
        }
        let count = 2 * sizes.fillet_rows;
        for k in 1..count {
            let i = position(&lengths, lengths[STEPS] * k as f64 / count as f64);
            radii.push(form + (turn - form) * i / STEPS as f64);
        }
        radii.push(turn);
    }
    radii
}

/// Fractional index at which the rising `table` reaches `value`.
fn position(table: &[f64], value: f64) -> f64 {
    let i = table.partition_point(|&t| t < value).clamp(1, table.len() - 1);
    i as f64 - 1.0 + (value - table[i - 1]) / (table[i] - table[i - 1])
}

struct Builder<'a> {
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

impl<'a> Builder<'a> {
    fn new(member: &'a Member, sizes: &'a SectionSizes, turn_row: i32) -> Builder<'a> {
        let mut across = vec![-1.0];
        let total: f64 = sizes.columns.iter().sum();
        let mut sum = 0.0;
        for width in &sizes.columns {
            across.push(-1.0 + 2.0 * (sum + 0.5 * width) / total);
            sum += width;
            across.push(-1.0 + 2.0 * sum / total);
        }
        let land = 2 * sizes.land_columns as i32;
        Builder { member, sizes, across, turn_row, rim_rows: 0, land, nodes: Vec::new(), index: Default::default() }
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

    fn finish(self, profile_m: &[f64]) -> Section {
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
        Section { nodes: self.nodes, borders, elements, flank }
    }
}

/// Surface points (radius, angle) from just beyond the turning point to the middle of the space: rest of the fillet and
/// root land, even in arc length.
fn land_points(member: &Member, turn: f64, count: usize) -> Vec<(f64, f64)> {
    const STEPS: usize = 400;
    let root = member.root_radius_m;
    let end = std::f64::consts::PI / f64::from(member.teeth);
    let mut line = Vec::with_capacity(STEPS + 2);
    for i in 0..=STEPS {
        // Even steps near the root circle, which the fillet touches.
        let t = 1.0 - i as f64 / STEPS as f64;
        let r = root + (turn - root) * t * t;
        line.push((r, member.half_angle_rad(r)));
    }
    line.push((root, end));
    let mut lengths = vec![0.0];
    for pair in line.windows(2) {
        let across = 0.5 * (pair[0].0 + pair[1].0) * (pair[1].1 - pair[0].1);
        lengths.push(lengths[lengths.len() - 1] + (pair[1].0 - pair[0].0).hypot(across));
    }
    let total = lengths[lengths.len() - 1];
    (1..=count)
        .map(|k| {
            if k == count {
                return (root, end);
            }
            let at = position(&lengths, total * k as f64 / count as f64);
            let i = (at as usize).min(line.len() - 2);
            let t = at - i as f64;
            let (a, b) = (line[i], line[i + 1]);
            (a.0 + (b.0 - a.0) * t, a.1 + (b.1 - a.1) * t)
        })
        .collect()
}
