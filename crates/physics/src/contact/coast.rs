//! Loaded contact of the coast flanks: the contact of the mirrored pair ([`Pair::coast`]), run backwards.

use super::cycle::{HalfCycle, MESH_IN_PHASE};
use super::error::ContactError;
use super::halves::{LoadedContact, solve_from};
use crate::compliance::{Compliance, Settings};
use crate::gear::Pair;
use crate::numerics::interpolation;
use crate::watch::Watch;

/// Solves both halves of `pair` on its coast flanks under a torque of the magnitude `torque_nm` that the gear drives
/// the pinion with. `half_stagger` (part of a transverse pitch) advances the right half.
///
/// Everything is given over the phase of `pair` and in the order in which it happens: curves over the phase, a pair's
/// load share from its first theoretical contact (at the pinion's tip) on. Forces and deflections are those of the
/// flanks in contact, and positive. The axial shift is the real pinion's: positive where it closes the left half's
/// drive flanks and opens its coast flanks. The `entry` of each half is that of the mirrored pair: of the real gears it
/// is the exit.
pub fn solve_coast_halves(
    pair: &Pair,
    torque_nm: f64,
    half_stagger: f64,
    compliance: &Compliance,
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<LoadedContact, ContactError> {
    // The mirrored time runs backwards.
    let from = pair.coast_phase(0.0);
    let mut contact = solve_from(from, &pair.coast(), torque_nm, -half_stagger, compliance, settings, watch)?;
    let stagger = half_stagger - half_stagger.floor();
    let pitches = pair.total_contact_ratio();
    for (half, lead) in contact.halves.iter_mut().zip([0.0, stagger]) {
        half.run_backwards(lead, pitches);
    }
    backwards(&mut contact.transmission_error_m);
    backwards(&mut contact.axial_shift_m);
    contact.axial_shift_m.iter_mut().for_each(|shift| *shift = -*shift);
    Ok(contact)
}

/// A periodic list in the reverse order, its first value staying where it is.
pub(super) fn backwards<T>(values: &mut [T]) {
    if let Some(others) = values.get_mut(1..) {
        others.reverse();
    }
}

impl HalfCycle {
    /// Curves and path in the reverse order; the first position is at the phase `lead` of this half, and a pair's
    /// theoretical path of contact is `pitches` base pitches long.
    pub(super) fn run_backwards(&mut self, lead: f64, pitches: f64) {
        let count = self.phase.len() as f64;
        self.phase = (0..self.phase.len()).map(|i| (i as f64 / count + lead).fract()).collect();
        for curve in [
            &mut self.force_bt_n,
            &mut self.stiffness_n_per_m,
            &mut self.secant_stiffness_n_per_m,
            &mut self.transmission_error_m,
        ] {
            backwards(curve);
        }
        backwards(&mut self.pairs_in_contact);
        self.load_share.reverse();
        self.load_share_phase.reverse();
        self.load_share_phase.iter_mut().for_each(|path| *path = pitches - *path);
        self.load_share_at_mesh_in = interpolation::linear(&self.load_share_phase, &self.load_share, MESH_IN_PHASE);
        let [begins, ends] = self.load_begins_and_ends;
        self.load_begins_and_ends = [pitches - ends, pitches - begins];
    }
}
