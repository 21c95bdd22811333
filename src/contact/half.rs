//! Loaded contact of one helix half, ready to be asked at any phase of the mesh period.

use super::flank::Flank;
use super::lines::CORNER_REACH;
use super::position::{Loaded, Solver, Trouble};
use super::settings::{ContactError, Settings};
use crate::gear::{Half, Pair};

/// The compliance of both members of one half. It does not depend on load, modification or assembly: both halves share
/// it.
#[derive(Debug, Clone, PartialEq)]
pub struct Compliance {
    flanks: [Flank; 2],
    slices: usize,
}

impl Compliance {
    /// Computes teeth and rings of both members.
    pub fn new(pair: &Pair, settings: &Settings) -> Compliance {
        let slices = settings.slice_count(pair);
        // Points lie within the path and, with corner contact, half a base pitch beyond either end.
        let reach = if settings.corner_contact { 2.0 * CORNER_REACH } else { 0.0 };
        let offsets = (pair.total_contact_ratio() + reach + 1e-6).floor() as usize;
        let (pinion, gear) = rayon::join(
            || Flank::new(pair, 1.0, settings.body, slices, offsets),
            || Flank::new(pair, -1.0, settings.body, slices, offsets),
        );
        Compliance { flanks: [pinion, gear], slices }
    }

    /// Number of width slices.
    pub fn slices(&self) -> usize {
        self.slices
    }
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
        let solver = Solver::new(pair, half, &compliance.flanks, compliance.slices, settings.corner_contact);
        HalfContact { pair, half, solver }
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
