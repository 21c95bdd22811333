//! The flexibility of one loaded flank.

use super::cyclic::expand;
use super::half_space::half_space;
use super::input::{FeError, FlankFlexibilityInput};
use super::loads::LoadGrid;
use super::operator::ElasticBody;
use super::section::{Border, SectionMesh};
use super::sector::Sector;
use super::sizes::Sizes;
use super::spline::{SplineSpace, graded_cells};
use super::surface::InvoluteFlank;
use crate::watch::Watch;

/// Bulk influence between the points of one flank and those of the teeth ahead of it.
///
/// Nodes are the hats of a load grid, bilinear in the arc length of the transverse involute and in the axial place;
/// node `profile * stations + station`. Values are mean normal displacements under the hat of the response node (into
/// the tooth) per unit normal force spread as the hat of the load node: Galerkin means, symmetric.
#[derive(Debug, Clone, PartialEq)]
pub struct FlankFlexibility {
    pub(super) rolls_m: Vec<f64>,
    pub(super) profile_m: Vec<f64>,
    pub(super) stations_m: Vec<f64>,
    /// One matrix per offset, row-major; half-space part subtracted at offset 0.
    pub(super) bulk: Vec<Vec<f64>>,
    pub(super) half_space: Vec<f64>,
}

/// Parts of the work by time, for the progress.
const ELIMINATED: f64 = 0.92;
const EXPANDED: f64 = 0.99;

impl FlankFlexibility {
    /// Solves the elements.
    ///
    /// # Errors
    /// [`FeError::Canceled`] when the watch says so; a tooth form that cannot be meshed; a singular matrix.
    pub fn new(input: &FlankFlexibilityInput, watch: Watch) -> Result<FlankFlexibility, FeError> {
        FlankFlexibility::with_sizes(input, &Sizes::new(input.key().resolution), watch)
    }

    fn with_sizes(input: &FlankFlexibilityInput, sizes: &Sizes, watch: Watch) -> Result<FlankFlexibility, FeError> {
        watch.checkpoint(0.0)?;
        let key = input.key();
        let involute = InvoluteFlank::new(input.member())?;
        let m = key.normal_module_m;
        let (profile_cells, station_cells) = sizes.load_cells(involute.length_m / m, key.face_width_m / m);
        let grid = LoadGrid {
            profile_m: (0..=profile_cells).map(|i| involute.length_m * i as f64 / profile_cells as f64).collect(),
            stations_m: graded_cells(key.face_width_m, station_cells),
        };
        let section =
            SectionMesh::new(input.member(), &involute, m, key.hold_radius_m, &grid.profile_m, &sizes.section)?;
        let cell = key.face_width_m / station_cells as f64 / sizes.splines_per_cell as f64;
        let fine = subdivided(&grid.stations_m, sizes.splines_per_cell);
        let mut spaces = vec![SplineSpace::cubic(fine.clone())];
        let mut count = fine.len() - 1;
        while count > 3 {
            count = (count / 2).max(3);
            spaces.push(SplineSpace::cubic(graded_cells(key.face_width_m, count)));
        }
        let levels = levels(&section, spaces.len(), cell, sizes.reach);
        let body = ElasticBody {
            section: &section,
            youngs_pa: key.youngs_modulus_pa,
            nu: key.poissons_ratio,
            twist_per_m: input.twist_per_m(),
        };
        let sector = Sector::new(&body, spaces, levels, &fine, &involute, &grid);
        let condensed = sector.condense(watch, (0.0, ELIMINATED))?;
        let total = expand(&condensed, key.teeth, key.offsets, watch, (ELIMINATED, EXPANDED))?;
        let half_space =
            half_space(&involute, &grid, body.twist_per_m, (body.youngs_pa, body.nu), watch, (EXPANDED, 1.0))?;
        let n = grid.len();
        let mut bulk: Vec<Vec<f64>> = Vec::with_capacity(total.len());
        for matrix in total {
            watch.checkpoint_quietly()?;
            bulk.push((0..n * n).map(|k| matrix[(k / n, k % n)]).collect());
        }
        for (b, h) in bulk[0].iter_mut().zip(&half_space) {
            *b -= h;
        }
        if key.side == crate::gear::MemberId::Gear {
            // The sector's angle grows towards the loaded flank, which on the gear is towards the teeth behind.
            for matrix in &mut bulk[1..] {
                watch.checkpoint_quietly()?;
                transpose(matrix, n);
            }
        }
        watch.checkpoint(1.0)?;
        Ok(FlankFlexibility {
            rolls_m: grid.profile_m.iter().map(|&s| involute.roll_m(s)).collect(),
            profile_m: grid.profile_m,
            stations_m: grid.stations_m,
            bulk,
            half_space,
        })
    }

    /// Roll lengths of the profile nodes on this member, from the form point to the tip.
    pub fn rolls_m(&self) -> &[f64] {
        &self.rolls_m
    }

    /// Arc lengths of the profile nodes from the form point, `(ρ² - ρ_form²)/(2 r_b)`: the hats are linear in these.
    pub fn profile_m(&self) -> &[f64] {
        &self.profile_m
    }

    /// Axial places of the stations, entry coordinate: 0 at the mesh-out end, face width at the mesh-in end.
    pub fn stations_m(&self) -> &[f64] {
        &self.stations_m
    }

    /// Highest offset there is.
    pub fn offsets(&self) -> usize {
        self.bulk.len() - 1
    }

    /// Number of nodes: profile nodes times stations.
    pub fn nodes(&self) -> usize {
        self.rolls_m.len() * self.stations_m.len()
    }

    /// Influence of a load on tooth 0 on the tooth that entered the mesh `offset` pitches earlier, without the
    /// half-space part (offset 0): `[response * nodes + load]`. The way back is the transpose. `None` beyond the
    /// highest offset.
    pub fn bulk(&self, offset: usize) -> Option<&[f64]> {
        self.bulk.get(offset).map(Vec::as_slice)
    }

    /// The half-space part that was subtracted.
    pub fn half_space(&self) -> &[f64] {
        &self.half_space
    }

    /// One value of the whole influence, half-space part included.
    pub fn total(&self, offset: usize, response: usize, load: usize) -> Option<f64> {
        let n = self.nodes();
        let index = (response < n && load < n).then_some(response * n + load)?;
        let bulk = self.bulk.get(offset)?[index];
        Some(if offset == 0 { bulk + self.half_space[index] } else { bulk })
    }
}

fn transpose(matrix: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..i {
            matrix.swap(i * n + j, j * n + i);
        }
    }
}

fn subdivided(borders: &[f64], parts: usize) -> Vec<f64> {
    let mut out = vec![borders[0]];
    for cell in borders.windows(2) {
        out.extend((1..=parts).map(|k| cell[0] + (cell[1] - cell[0]) * k as f64 / parts as f64));
    }
    out
}

/// Space of every node's line: cells double while they stay below `reach` times the distance from the loaded flank.
fn levels(section: &SectionMesh, spaces: usize, cell: f64, reach: f64) -> Vec<u8> {
    let flank: Vec<(f64, f64)> = section
        .flank
        .iter()
        .flat_map(|edge| edge.nodes)
        .map(|node| (section.nodes[node].x_m, section.nodes[node].y_m))
        .collect();
    let distance = |x: f64, y: f64| flank.iter().map(|p| (p.0 - x).hypot(p.1 - y)).fold(f64::INFINITY, f64::min);
    section
        .nodes
        .iter()
        .zip(&section.borders)
        .map(|(node, border)| {
            let mut d = distance(node.x_m, node.y_m);
            if !matches!(border, Border::Inside | Border::Held) {
                // Both cut faces alike.
                d = d.min(distance(-node.x_m, node.y_m));
            }
            let mut level = 0;
            while level + 1 < spaces && cell * f64::from(1_u32 << (level + 1)) <= reach * d {
                level += 1;
            }
            level as u8
        })
        .collect()
}
