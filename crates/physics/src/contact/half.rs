//! Loaded contact of one helix half at any phase of the mesh period.

use super::distribution::DistributionError;
use super::error::ContactError;
use super::position::{ForceCurve, LoadedPosition, PositionError, PositionSolver};
use super::shafts::{DisplacementField, Mount};
use crate::compliance::{Compliance, Settings};
use crate::gear::{Half, Pair};
use crate::watch::Watch;

/// One half under one force.
pub struct HalfContact<'a> {
    pair: &'a Pair,
    half: Half,
    solver: PositionSolver<'a>,
}

/// Pair number below which nothing is left out.
const ALL_PAIRS: i32 = i32::MIN;

impl<'a> HalfContact<'a> {
    /// The half `half` of `pair` with its compliance. Every solution passes the checkpoints of `watch` quietly.
    pub fn new(
        pair: &'a Pair,
        half: Half,
        compliance: &'a Compliance,
        settings: &Settings,
        watch: Watch<'a>,
    ) -> HalfContact<'a> {
        Self::mounted(pair, half, compliance, settings, Mount::Rigid, watch)
    }

    /// The same with the bodies displaced by `field` from where they stand without load, and held there.
    pub fn displaced(
        pair: &'a Pair,
        half: Half,
        compliance: &'a Compliance,
        settings: &Settings,
        field: &'a DisplacementField,
        watch: Watch<'a>,
    ) -> HalfContact<'a> {
        Self::mounted(pair, half, compliance, settings, Mount::Displaced(field), watch)
    }

    fn mounted(
        pair: &'a Pair,
        half: Half,
        compliance: &'a Compliance,
        settings: &Settings,
        mount: Mount<'a>,
        watch: Watch<'a>,
    ) -> HalfContact<'a> {
        let corner_contact = settings.corner_contact;
        HalfContact { pair, half, solver: PositionSolver::new(pair, half, compliance, corner_contact, mount, watch) }
    }

    /// The watch whose checkpoints are passed.
    pub(super) fn watch(&self) -> Watch<'a> {
        self.solver.watch()
    }

    /// The loaded state when pair 0 is `phase` base pitches after its first theoretical contact.
    pub fn at(&mut self, phase: f64, force_bt_n: f64) -> Result<LoadedPosition, ContactError> {
        let half = self.half;
        self.solver.solve(phase, ALL_PAIRS, force_bt_n).map_err(|error| to_contact_error(error, half, phase))
    }

    /// The same, starting from the state of a neighbouring position.
    pub fn at_near(
        &mut self,
        phase: f64,
        force_bt_n: f64,
        near: Option<&LoadedPosition>,
    ) -> Result<LoadedPosition, ContactError> {
        if let Some(state) = near {
            self.solver.start_from(state);
        }
        self.at(phase, force_bt_n)
    }

    /// Force and stiffness at `approaches_m` above the free position (ascending, above 0) when pair 0 is `phase` base
    /// pitches after its first theoretical contact. The lines of contact are cut for the load `force_bt_n`.
    pub fn force_curve(
        &mut self,
        phase: f64,
        force_bt_n: f64,
        approaches_m: &[f64],
    ) -> Result<ForceCurve, ContactError> {
        let half = self.half;
        self.solver.force_curve(phase, force_bt_n, approaches_m).map_err(|error| to_contact_error(error, half, phase))
    }

    /// Cuts the contact lines into `slices` from here on.
    pub fn set_slices(&mut self, slices: usize) {
        self.solver.set_slices(slices);
    }

    /// The state of the pairs already in mesh when the entering pair is `overrun_m` of roll before its theoretical
    /// start of contact and carries nothing.
    pub fn before_entry(&mut self, overrun_m: f64, force_bt_n: f64) -> Result<LoadedPosition, ContactError> {
        let phase = -overrun_m / self.pair.base_pitch_m;
        let half = self.half;
        self.solver.solve(phase, 1, force_bt_n).map_err(|error| to_contact_error(error, half, phase))
    }
}

pub(super) fn to_contact_error(error: PositionError, half: Half, phase: f64) -> ContactError {
    match error {
        PositionError::NoContact => ContactError::NoContact { half, phase },
        PositionError::Distribution(DistributionError::NotConverged { iterations, change }) => {
            ContactError::NotConverged { half, phase, iterations, change }
        }
        PositionError::Distribution(DistributionError::Canceled(canceled)) => canceled.into(),
    }
}
