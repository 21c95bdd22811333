//! Loaded contact of one helix half, ready to be asked at any phase of the mesh period.

use super::flank::Flank;
use super::influence::Influence;
use super::lines::CORNER_REACH;
use super::local::LocalModel;
use super::position::{Loaded, Solver, Trouble};
use super::settings::{ContactError, Settings};
use crate::gear::{Half, Pair};

/// The compliance of both members of one half. It does not depend on load, modification or assembly: both halves share
/// it.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    pub(super) influence: Influence,
    pub(super) local: LocalModel,
    slices: usize,
}

/// Points of the table of centreline depths.
const DEPTHS: usize = 33;

impl Compliance {
    /// Computes teeth and rings of both members.
    pub fn new(pair: &Pair, settings: &Settings) -> Compliance {
        let stations = settings.station_count(pair);
        let offsets = pair_offsets(pair, settings.corner_contact);
        let (pinion, gear) = rayon::join(
            || Flank::new(pair, 1.0, settings.body, stations, offsets),
            || Flank::new(pair, -1.0, settings.body, stations, offsets),
        );
        // Places of both members are Chebyshev nodes of the same path, run through in opposite directions.
        let places_m = pinion.places_m().to_vec();
        let last = places_m.len() - 1;
        let step = pair.spec.face_width_m / stations as f64;
        let stations_m = (0..stations).map(|i| (i as f64 + 0.5) * step).collect();
        let influence = Influence::new(places_m, stations_m, offsets, |offset, (i, a), (j, b)| {
            pinion.bulk.entry(offset, (i, a), (j, b)) + gear.bulk.entry(offset, (i, last - a), (j, last - b))
        });
        let depths = (0..DEPTHS)
            .map(|i| {
                let x = pair.path_start_m + (pair.path_end_m - pair.path_start_m) * i as f64 / (DEPTHS - 1) as f64;
                [pinion.at(x).depth_m, gear.at(pair.line_of_action_m - x).depth_m]
            })
            .collect();
        Compliance { influence, local: LocalModel::CenterlineDepth(depths), slices: settings.slice_count(pair) }
    }

    /// Number of width slices that the contact lines are cut into.
    pub fn slices(&self) -> usize {
        self.slices
    }
}

/// Tooth pairs that can be in contact at once lie up to this many pitches apart: points lie within the path and, with corner
/// contact, half a base pitch beyond either end.
pub fn pair_offsets(pair: &Pair, corner_contact: bool) -> usize {
    let reach = if corner_contact { 2.0 * CORNER_REACH } else { 0.0 };
    (pair.total_contact_ratio() + reach + 1e-6).floor() as usize
}

/// One half under one force.
pub struct HalfContact<'a> {
    pair: &'a Pair,
    half: Half,
    solver: Solver<'a>,
}

/// Pair number below which nothing is left out.
const ALL_PAIRS: i32 = i32::MIN;

impl<'a> HalfContact<'a> {
    /// The half `half` of `pair` with its compliance.
    pub fn new(pair: &'a Pair, half: Half, compliance: &'a Compliance, settings: &Settings) -> HalfContact<'a> {
        HalfContact { pair, half, solver: Solver::new(pair, half, compliance, settings.corner_contact) }
    }

    /// The loaded state when pair 0 stands `phase` base pitches after its first theoretical contact.
    pub fn at(&mut self, phase: f64, force_bt_n: f64) -> Result<Loaded, ContactError> {
        let half = self.half;
        self.solver.solve(phase, ALL_PAIRS, force_bt_n).map_err(|trouble| failed(trouble, half, phase))
    }

    /// The state of the pairs already in mesh when the entering pair stands `overrun_m` of roll before its theoretical start
    /// of contact and carries nothing.
    pub fn before_entry(&mut self, overrun_m: f64, force_bt_n: f64) -> Result<Loaded, ContactError> {
        let phase = -overrun_m / self.pair.base_pitch_m;
        let half = self.half;
        self.solver.solve(phase, 1, force_bt_n).map_err(|trouble| failed(trouble, half, phase))
    }
}

fn failed(trouble: Trouble, half: Half, phase: f64) -> ContactError {
    match trouble {
        Trouble::NoContact => ContactError::NoContact { half, phase },
        Trouble::Stalled(s) => ContactError::NotConverged { half, phase, iterations: s.iterations, change: s.change },
    }
}
