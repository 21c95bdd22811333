//! One position of the mesh: the points, their flexibility, the distribution of the force.

use std::ops::Range;

use super::distribution::{Distribution, DistributionError, Prescribed, distribute};
use super::lines::{ContactPoint, CornerGaps, PairRange, collect, reference_roll_m};
use super::point_contacts::PointContacts;
use super::shafts::{HalfFlexibility, Mount};
use super::system::{ContactSystem, SystemWorkspace};
use crate::compliance::{CORNER_REACH, Compliance, LineWeights, Stencil};
use crate::gear::{Half, Pair};
use crate::watch::{Canceled, Meter, Watch};

/// The loaded points of one position.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedPosition {
    /// Points of possible contact, line by line.
    pub points: Vec<ContactPoint>,
    /// Normal forces.
    pub forces_n: Vec<f64>,
    /// Loaded transmission error, along the transverse base tangent.
    pub approach_m: f64,
    /// dF_bt/dδ.
    pub stiffness_n_per_m: f64,
    /// Newton iterations.
    pub iterations: u32,
}

impl LoadedPosition {
    /// Force of pair `k` as a part of all forces; 0 without load.
    pub fn share(&self, k: i32) -> f64 {
        let of_pair: f64 = self.points.iter().zip(&self.forces_n).filter(|(p, _)| p.pair == k).map(|(_, f)| f).sum();
        let all: f64 = self.forces_n.iter().sum();
        if all > 0.0 { of_pair / all } else { 0.0 }
    }

    /// [`Self::share`] of the pairs `low` to `high`, which are all that have points.
    pub(super) fn shares(&self, low: i32, high: i32) -> Vec<f64> {
        let all: f64 = self.forces_n.iter().sum();
        if all <= 0.0 {
            return vec![0.0; (high - low + 1) as usize];
        }
        let mut shares = vec![std::iter::empty::<f64>().sum::<f64>() / all; (high - low + 1) as usize];
        let mut forces = self.forces_n.as_slice();
        for line in self.points.chunk_by(|a, b| a.pair == b.pair) {
            let (own, others) = forces.split_at(line.len());
            forces = others;
            shares[(line[0].pair - low) as usize] = own.iter().sum::<f64>() / all;
        }
        shares
    }
}

/// Force over approach at one position. Along the transverse base tangent.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceCurve {
    /// Approach at which the first point touches.
    pub free_m: f64,
    /// F_bt and dF_bt/dδ at every approach above the free one.
    pub samples: Vec<(f64, f64)>,
}

/// Errors of one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum PositionError {
    NoContact,
    Distribution(DistributionError),
}

impl From<DistributionError> for PositionError {
    fn from(error: DistributionError) -> Self {
        PositionError::Distribution(error)
    }
}

impl From<Canceled> for PositionError {
    fn from(canceled: Canceled) -> Self {
        PositionError::Distribution(canceled.into())
    }
}

/// Solves positions one after the other, each from the one before.
pub(super) struct PositionSolver<'a> {
    pair: &'a Pair,
    half: Half,
    compliance: &'a Compliance,
    slices: usize,
    corner_contact: bool,
    corners: CornerGaps,
    points: Vec<ContactPoint>,
    /// Place of a point and its force per face width at the position before, ascending.
    previous: Vec<(PointKey, f64)>,
    start: Vec<f64>,
    /// Points of every line.
    lines: Vec<Range<usize>>,
    weights: Vec<LineWeights>,
    gaps: Vec<f64>,
    stencils: Vec<Stencil>,
    bulk: Vec<f64>,
    mounted_bulk: Vec<f64>,
    modes: Vec<f64>,
    block: Vec<f64>,
    scratch: Vec<f64>,
    local: PointContacts,
    coupling: Vec<Vec<f64>>,
    work: SystemWorkspace,
    mount: Mount<'a>,
    watch: Watch<'a>,
    /// Largest corner gap that was worth looking at so far.
    corner_gap_m: f64,
    /// Axial width of a corner contact under the force it was found for.
    corner_width: Option<(f64, f64)>,
}

/// Parts of a corner contact.
pub(super) const PARTS_PER_CORNER_WIDTH: f64 = 12.0;
/// Stiffness per face width by which the deflection is estimated that decides the width of a corner contact, as a part
/// of Young's modulus: 14 N/(mm µm) for steel (ISO 6336-1).
const PAIR_STIFFNESS: f64 = 14e9 / 206e9;

/// Pair, slice, zone and part of a point.
type PointKey = (i32, usize, u8, u8);

impl<'a> PositionSolver<'a> {
    /// A solver for one half.
    pub(super) fn new(
        pair: &'a Pair,
        half: Half,
        compliance: &'a Compliance,
        corner_contact: bool,
        mount: Mount<'a>,
        watch: Watch<'a>,
    ) -> PositionSolver<'a> {
        PositionSolver {
            pair,
            half,
            compliance,
            slices: compliance.slices(),
            corner_contact,
            corners: if corner_contact { CornerGaps::new(pair) } else { CornerGaps::default() },
            points: Vec::new(),
            previous: Vec::new(),
            start: Vec::new(),
            lines: Vec::new(),
            weights: Vec::new(),
            gaps: Vec::new(),
            stencils: Vec::new(),
            bulk: Vec::new(),
            mounted_bulk: Vec::new(),
            modes: Vec::new(),
            block: Vec::new(),
            scratch: Vec::new(),
            local: PointContacts::default(),
            coupling: Vec::new(),
            work: SystemWorkspace::default(),
            mount,
            watch,
            corner_gap_m: 0.0,
            corner_width: None,
        }
    }

    /// Axial width over which the mesh-in corner's gap grows to the deflection of a pair under the whole force. It
    /// depends on nothing else, so that every position is cut alike whatever was solved before.
    fn corner_width_m(&mut self, force_bt_n: f64) -> f64 {
        if let Some((force, width_m)) = self.corner_width
            && force == force_bt_n
        {
            return width_m;
        }
        let stiffness = PAIR_STIFFNESS * self.pair.reduced_youngs_modulus_pa() * self.pair.spec.face_width_m;
        let gap_m = force_bt_n / stiffness;
        let (mut low, mut high) = (0.0, CORNER_REACH * self.pair.base_pitch_m);
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            let inside = self.corners.mesh_in.at(middle).is_some_and(|gap| gap < gap_m);
            if inside { low = middle } else { high = middle }
        }
        let width_m = high / self.pair.base_helix_angle_rad.tan().max(1e-6);
        self.corner_width = Some((force_bt_n, width_m));
        width_m
    }

    /// Most slices of the contact lines, and the least width of a part of a slice beyond the path, under a force.
    fn segmentation(&mut self, force_bt_n: f64) -> (usize, f64) {
        let cos = self.pair.base_helix_angle_rad.cos();
        let least_m = self.compliance.local.least_width_m(self.pair, force_bt_n / cos);
        let most = (self.pair.spec.face_width_m / least_m).clamp(4.0, 1e6) as usize;
        (most, least_m.max(self.corner_width_m(force_bt_n) / PARTS_PER_CORNER_WIDTH))
    }

    /// Collects the points of possible contact, with the gaps of the displaced bodies.
    fn collect_points(&mut self, phase: f64, most: usize, reach: &PairRange) -> Result<(), Canceled> {
        self.watch.checkpoint_quietly()?;
        let (pair, corners, points) = (self.pair, &self.corners, &mut self.points);
        let cut = (phase, self.slices.min(most));
        match self.mount {
            Mount::Displaced(field) => {
                let cos = pair.base_helix_angle_rad.cos();
                collect(pair, corners, self.half, cut, reach, |entry_m, x_m| field.at(entry_m, x_m) / cos, points);
            }
            Mount::Rigid | Mount::Shafts(_) => collect(pair, corners, self.half, cut, reach, |_, _| 0.0, points),
        }
        Ok(())
    }

    /// The watch whose checkpoints are passed.
    pub(super) fn watch(&self) -> Watch<'a> {
        self.watch
    }

    /// Cuts the contact lines into `slices` from here on.
    pub(super) fn set_slices(&mut self, slices: usize) {
        self.slices = slices.max(2);
        self.previous.clear();
    }

    /// Takes `state` as the neighbour to start from.
    pub(super) fn start_from(&mut self, state: &LoadedPosition) {
        store_forces(&mut self.previous, &state.points, &state.forces_n);
    }

    /// Distributes `force_bt_n` at `phase`. Pairs below `lowest_pair` stay out.
    pub(super) fn solve(
        &mut self,
        phase: f64,
        lowest_pair: i32,
        force_bt_n: f64,
    ) -> Result<LoadedPosition, PositionError> {
        let cos = self.pair.base_helix_angle_rad.cos();
        let (most, least_part_m) = self.segmentation(force_bt_n);
        for _ in 0..8 {
            let corner_gap_m = if self.corner_contact { self.corner_gap_m } else { 0.0 };
            let reach = PairRange { lowest_pair, corner_gap_m, least_part_m };
            self.collect_points(phase, most, &reach)?;
            if self.points.is_empty() {
                return Err(PositionError::NoContact);
            }
            self.assemble(phase, force_bt_n / cos)?;
            self.start_from_previous();
            let solved = self.distribute(Prescribed::Force(force_bt_n / cos))?;
            let approach_m = solved.approach / cos;
            store_forces(&mut self.previous, &self.points, &solved.forces);
            if self.corner_contact && approach_m > self.corner_gap_m {
                self.corner_gap_m = 1.25 * approach_m;
                continue;
            }
            return Ok(LoadedPosition {
                points: self.points.clone(),
                forces_n: solved.forces,
                approach_m,
                stiffness_n_per_m: solved.stiffness * cos * cos,
                iterations: solved.iterations,
            });
        }
        Err(PositionError::NoContact)
    }

    /// Forces at prescribed approaches: F_bt and dF_bt/dδ at `approaches_m` above the free position (the least
    /// gap of any point), which ascend from above 0. The lines are cut as finely as `force_bt_n`, the force at the
    /// usual approach, needs. Depends on nothing that was solved before.
    pub(super) fn force_curve(
        &mut self,
        phase: f64,
        force_bt_n: f64,
        approaches_m: &[f64],
    ) -> Result<ForceCurve, PositionError> {
        let cos = self.pair.base_helix_angle_rad.cos();
        let (most, least_part_m) = self.segmentation(force_bt_n);
        let highest_m = approaches_m.last().copied().unwrap_or(0.0);
        let mut corner_gap_m = if self.corner_contact { highest_m } else { 0.0 };
        let free_m = loop {
            let reach = PairRange { lowest_pair: i32::MIN, corner_gap_m, least_part_m };
            self.collect_points(phase, most, &reach)?;
            let free_m = self.points.iter().map(|p| p.gap_m - 0.5 * p.gap_spread_m).fold(f64::INFINITY, f64::min);
            if !free_m.is_finite() {
                return Err(PositionError::NoContact);
            }
            if !self.corner_contact || free_m + highest_m <= corner_gap_m {
                break free_m;
            }
            corner_gap_m = 1.01 * (free_m + highest_m);
        };
        self.assemble(phase, force_bt_n / cos)?;
        let stiffness = PAIR_STIFFNESS * self.pair.reduced_youngs_modulus_pa() * self.pair.spec.face_width_m;
        let mut expected_force = stiffness * highest_m;
        let mut samples = vec![(0.0, 0.0); approaches_m.len()];
        self.start.clear();
        self.start.resize(self.points.len(), 0.0);
        let mut above: Option<(f64, f64, f64)> = None;
        let mut lower = approaches_m.iter().rev().skip(1);
        for (sample, &approach_m) in samples.iter_mut().zip(approaches_m).rev() {
            if let Some((higher_m, force, stiffness)) = above {
                expected_force = (force - stiffness * (higher_m - approach_m)).max(0.2 * force * approach_m / higher_m);
            }
            if expected_force <= 0.0 {
                break;
            }
            let approach = (free_m + approach_m) * cos;
            let solved = self.distribute(Prescribed::Approach { approach, expected_force })?;
            let force = solved.forces.iter().sum::<f64>();
            *sample = (force * cos, solved.stiffness * cos * cos);
            above = Some((approach_m, force, solved.stiffness * cos));
            self.start = solved.forces;
            // The next, lower level begins with the forces by the tangent.
            if let Some(next_m) = lower.next() {
                let change = (approach_m - next_m) * cos;
                let tangent = self.start.iter_mut().zip(&self.work.unit);
                tangent.for_each(|(force, unit)| *force = (*force - change * unit).max(0.0));
            }
        }
        Ok(ForceCurve { free_m, samples })
    }

    /// Collects and assembles the points of a position on elastic shafts, with their displacements by unit openings at
    /// the nodes, and expects the forces of the position before.
    pub(super) fn prepare<const N: usize>(
        &mut self,
        phase: f64,
        force_bt_n: f64,
        corner_gap_m: f64,
        node_weights: impl Fn(f64, f64) -> [f64; N],
    ) -> Result<(), PositionError> {
        let cos = self.pair.base_helix_angle_rad.cos();
        let (most, least_part_m) = self.segmentation(force_bt_n);
        let reach = PairRange { lowest_pair: i32::MIN, corner_gap_m, least_part_m };
        self.collect_points(phase, most, &reach)?;
        if self.points.is_empty() {
            return Err(PositionError::NoContact);
        }
        self.assemble(phase, force_bt_n / cos)?;
        self.modes.clear();
        self.modes.extend(self.points.iter().flat_map(|p| node_weights(p.entry_m, p.x_m)));
        self.start_from_previous();
        Ok(())
    }

    /// The points of the assembled position.
    pub(super) fn points(&self) -> &[ContactPoint] {
        &self.points
    }

    /// Forces that the assembled points are expected to carry.
    pub(super) fn expected_forces(&self) -> &[f64] {
        &self.start
    }

    /// The assembled points on elastic shafts.
    pub(super) fn mounted_system(&self) -> ContactSystem<'_, PointContacts> {
        self.system(&self.mounted_bulk, &self.modes)
    }

    /// Keeps the solved forces for the next position.
    pub(super) fn store(&mut self, forces_n: &[f64]) {
        store_forces(&mut self.previous, &self.points, forces_n);
    }

    /// Forces of the points at the stations of the whole face, each with its first moment over x.
    pub(super) fn station_loads(&self, forces_n: &[f64]) -> Vec<[f64; 2]> {
        let influence = &self.compliance.influence;
        let mut loads = vec![[0.0; 2]; influence.stations_m().len()];
        for (p, f) in self.points.iter().zip(forces_n) {
            let stencil = influence.stencil(p.entry_m);
            for (load, w) in loads[stencil.first..].iter_mut().zip(stencil.weights) {
                load[0] += w * f;
                load[1] += w * f * p.x_m;
            }
        }
        loads
    }

    /// Stiffness of the loaded teeth on bodies that are held, along the flank normal: force by approach, moment about
    /// the middle of the face by approach (force by tilt), moment by tilt; `total` and `all` are force and points of
    /// the whole problem.
    pub(super) fn tooth_stiffness(
        &mut self,
        all: usize,
        total: f64,
        forces_n: &[f64],
    ) -> Result<[f64; 3], PositionError> {
        let middle_m = 0.5 * self.pair.spec.face_width_m;
        let arms: Vec<f64> = self.points.iter().map(|p| p.entry_m - middle_m).collect();
        let active: Vec<bool> = forces_n.iter().map(|f| *f > 0.0).collect();
        let mut work = std::mem::take(&mut self.work);
        let system = self.system(&self.bulk, &arms);
        let meter = &mut Meter::new(self.watch);
        let response = system.linear_response((total, all), 0.0, forces_n, &active, &mut work, meter);
        let out = match response? {
            None => [0.0; 3],
            Some((stiffness, _)) => {
                let moment = |by: &mut dyn Iterator<Item = f64>| by.zip(&arms).map(|(f, a)| f * a).sum::<f64>();
                let coupled = work.mode_forces.iter().sum();
                [stiffness, coupled, moment(&mut work.mode_forces.iter().copied())]
            }
        };
        self.work = work;
        Ok(out)
    }

    /// Expects the forces of the position before.
    fn start_from_previous(&mut self) {
        // Both lists ascend. What comes onto the path is expected to carry like the rest of its line.
        self.start.clear();
        let mut before = self.previous.iter().peekable();
        let mut beside = 0.0;
        for p in &self.points {
            let key = point_key(p);
            while let Some((_, load)) = before.next_if(|(other, _)| *other < key) {
                beside = *load;
            }
            let same = before.next_if(|(other, _)| *other == key).map(|(_, load)| *load);
            let expected = same.unwrap_or(if p.zone == 1 { beside } else { 0.0 });
            self.start.push(expected * p.width_m);
            beside = expected;
        }
    }

    fn distribute(&mut self, prescribed: Prescribed) -> Result<Distribution, DistributionError> {
        let mut work = std::mem::take(&mut self.work);
        let meter = &mut Meter::new(self.watch);
        let solved = distribute(&self.system(&self.bulk, &[]), prescribed, &self.start, &mut work, meter);
        self.work = work;
        solved
    }

    /// The assembled points on bodies of the flexibility `bulk` between the stations.
    fn system<'s>(&'s self, bulk: &'s [f64], modes: &'s [f64]) -> ContactSystem<'s, PointContacts> {
        ContactSystem {
            gaps: &self.gaps,
            stencils: &self.stencils,
            stations: self.weights.iter().map(|w| w.count).sum(),
            bulk,
            lines: &self.lines,
            coupling: &self.coupling,
            local: &self.local,
            modes,
        }
    }

    /// Lines, gaps, bulk flexibility and local contacts of the current points.
    fn assemble(&mut self, phase: f64, force_n: f64) -> Result<(), Canceled> {
        let mut meter = Meter::new(self.watch);
        let pair = self.pair;
        let influence = &self.compliance.influence;
        let cos = pair.base_helix_angle_rad.cos();
        let slope = pair.base_helix_angle_rad.tan();
        let x0 = reference_roll_m(pair, phase);
        self.gaps.clear();
        // From where the nearer end of a point's part touches.
        self.gaps.extend(self.points.iter().map(|p| (p.gap_m - 0.5 * p.gap_spread_m) * cos));
        self.lines.clear();
        self.stencils.clear();
        let (mut from, mut stations) = (0, 0);
        while from < self.points.len() {
            let k = self.points[from].pair;
            let to = from + self.points[from..].iter().take_while(|p| p.pair == k).count();
            self.stencils.extend(self.points[from..to].iter().map(|p| influence.stencil(p.entry_m)));
            let own = &mut self.stencils[from..];
            let (low, high) = own.iter().fold((usize::MAX, 0), |(l, h), s| (l.min(s.first), h.max(s.last())));
            own.iter_mut().for_each(|s| s.first = s.first - low + stations);
            let line = self.lines.len();
            if self.weights.len() == line {
                self.weights.push(LineWeights::default());
            }
            let base = x0 + f64::from(k) * pair.base_pitch_m;
            influence.line(&mut self.weights[line], k, (base, slope), (low, high));
            self.lines.push(from..to);
            stations += high + 1 - low;
            from = to;
        }
        self.weights.truncate(self.lines.len());
        meter.zeros(&mut self.bulk, stations * stations)?;
        let (mut row, n) = (0, stations);
        for (p, response) in self.weights.iter().enumerate() {
            let mut column = 0;
            for load in &self.weights[..=p] {
                meter.count(influence.operations(response, load))?;
                // Lines come in the order of the pairs, so that the first is never the later one.
                influence.between(response, load, &mut self.scratch, &mut self.block);
                for (i, values) in self.block.chunks_exact(load.count).enumerate() {
                    let start = (row + i) * n + column;
                    self.bulk[start..start + load.count].copy_from_slice(values);
                    if column != row {
                        for (j, value) in values.iter().enumerate() {
                            self.bulk[(column + j) * n + row + i] = *value;
                        }
                    }
                }
                column += load.count;
            }
            row += response.count;
        }
        if let Mount::Shafts(shafts) = self.mount {
            self.add_shafts(shafts, (x0, slope), &mut meter)?;
        }
        let model = &self.compliance.local;
        self.local.prepare(pair, model, force_n, (&self.points, &self.lines), &mut self.coupling, &mut meter)
    }
}

impl PositionSolver<'_> {
    /// The bulk flexibility with that of the shafts within the half; the line of pair 0 is at `x0 + slope z`.
    fn add_shafts(
        &mut self,
        shafts: &HalfFlexibility,
        (x0, slope): (f64, f64),
        meter: &mut Meter,
    ) -> Result<(), Canceled> {
        self.mounted_bulk.clear();
        self.mounted_bulk.extend_from_slice(&self.bulk);
        let stations_m = self.compliance.influence.stations_m();
        let places: Vec<(usize, f64)> = self
            .weights
            .iter()
            .flat_map(|line| {
                let base = x0 + f64::from(line.pair) * self.pair.base_pitch_m;
                (line.first..line.first + line.count).map(move |i| (i, base + slope * stations_m[i]))
            })
            .collect();
        for (row, place) in self.mounted_bulk.chunks_exact_mut(places.len().max(1)).zip(&places) {
            meter.count(4 * places.len())?;
            for (value, load) in row.iter_mut().zip(&places) {
                *value += shafts.between(*place, *load);
            }
        }
        Ok(())
    }
}

fn point_key(p: &ContactPoint) -> PointKey {
    (p.pair, p.slice, p.zone, p.part)
}

/// Keeps the force of every point per face width: parts of slices change their width from one position to the next.
fn store_forces(previous: &mut Vec<(PointKey, f64)>, points: &[ContactPoint], forces_n: &[f64]) {
    previous.clear();
    previous.extend(points.iter().zip(forces_n).map(|(p, f)| (point_key(p), f / p.width_m)));
}
