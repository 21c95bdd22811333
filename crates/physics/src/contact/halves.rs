//! Both halves of the herringbone pair.
//!
//! The pinion floats axially: statically the axial forces of its halves balance, F_bt,L tanβ_b = F_bt,R tanβ_b, so each
//! half carries T/2 exactly, and different halves differ in deflection. The pinion then shifts by u, which closes the
//! left mesh by u tanβ_b and opens the right one: δ_L = δ + u tanβ_b, δ_R = δ - u tanβ_b. u is positive in the
//! direction in which the left half's z_p enters its mesh displacement with +sinβ_b. Without helix nothing balances:
//! the halves then share the torque at equal deflection.

use serde::{Deserialize, Serialize};

use super::cycle::{CURVE_POSITIONS, CycleBuilder, HalfCycle};
use super::error::ContactError;
use super::half::HalfContact;
use super::refine::refine;
use crate::compliance::{Compliance, Settings};
use crate::gear::{Half, Pair};
use crate::watch::Watch;

/// Loaded contact of both halves over one mesh period of the left half.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadedContact {
    /// Left and right half. Curves of the right half are over the left half's positions: their `phase` is the right
    /// half's own, which `half_stagger` advances.
    pub halves: [HalfCycle; 2],
    /// True where both halves are the same (and were solved once).
    pub equal_halves: bool,
    /// Mean of both transmission errors at every position.
    pub transmission_error_m: Vec<f64>,
    /// Axial shift of the pinion at every position.
    pub axial_shift_m: Vec<f64>,
    /// Axial force of each half (magnitude; the halves push against each other), mean over the period.
    pub axial_force_n: [f64; 2],
    /// Slices of the contact lines over the face width of a half.
    pub slices: usize,
}

/// Part of the force that the less loaded of two spur halves keeps at least, so that its stiffness stays defined when
/// the other one could carry everything.
pub(super) const LEAST_PART: f64 = 1e-6;

/// Helix angles below this leave no axial coupling.
const SPUR: f64 = 1e-4;

/// Solves one half under `force_bt_n` over the mesh period with its compliance.
pub fn solve_half(
    pair: &Pair,
    half: Half,
    force_bt_n: f64,
    compliance: &Compliance,
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<HalfCycle, ContactError> {
    check(force_bt_n * pair.pinion.base_radius_m, settings)?;
    watch.checkpoint(0.0)?;
    let mut progress = |fraction: f64| watch.checkpoint(fraction).map_err(ContactError::from);
    let mut contact = HalfContact::new(pair, half, compliance, settings, watch);
    solve_period(&mut contact, pair, compliance, 0.0, force_bt_n, settings, &mut progress)
}

/// Solves both halves of `pair` under the pinion's whole torque. `half_stagger` (part of a transverse pitch) advances
/// the right half.
pub fn solve_pair_of_halves(
    pair: &Pair,
    torque_nm: f64,
    half_stagger: f64,
    compliance: &Compliance,
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<LoadedContact, ContactError> {
    solve_from(0.0, pair, torque_nm, half_stagger, compliance, settings, watch)
}

/// The same with the curves of the left half from the phase `from`, in [0, 1), on.
pub(super) fn solve_from(
    from: f64,
    pair: &Pair,
    torque_nm: f64,
    half_stagger: f64,
    compliance: &Compliance,
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<LoadedContact, ContactError> {
    check(torque_nm, settings)?;
    watch.checkpoint(0.0)?;
    let force = 0.5 * torque_nm / pair.pinion.base_radius_m;
    let stagger = half_stagger - half_stagger.floor();
    let right_from = (from + stagger).fract();
    let same_gaps = same_gaps(pair);
    let tan = pair.base_helix_angle_rad.tan();
    let halves = if same_gaps && stagger == 0.0 {
        let mut progress = |fraction: f64| watch.checkpoint(fraction).map_err(ContactError::from);
        let mut contact = HalfContact::new(pair, Half::Left, compliance, settings, watch);
        let left = solve_period(&mut contact, pair, compliance, from, force, settings, &mut progress)?;
        [left.clone(), left]
    } else if pair.spec.helix_angle_rad.abs() > SPUR {
        let mut first = |fraction: f64| watch.checkpoint(0.5 * fraction).map_err(ContactError::from);
        let mut contact = HalfContact::new(pair, Half::Left, compliance, settings, watch);
        let left = solve_period(&mut contact, pair, compliance, from, force, settings, &mut first)?;
        let mut second = |fraction: f64| watch.checkpoint(0.5 + 0.5 * fraction).map_err(ContactError::from);
        let mut contact = HalfContact::new(pair, Half::Right, compliance, settings, watch);
        let right = solve_period(&mut contact, pair, compliance, right_from, force, settings, &mut second)?;
        [left, right]
    } else {
        share_torque(pair, compliance, [from, right_from], 2.0 * force, settings, watch)?
    };
    let [left, right] = &halves;
    let both = || left.transmission_error_m.iter().zip(&right.transmission_error_m);
    let axial = |half: &HalfCycle| half.force_bt_n.iter().sum::<f64>() / half.force_bt_n.len() as f64 * tan;
    Ok(LoadedContact {
        equal_halves: same_gaps && stagger == 0.0,
        transmission_error_m: both().map(|(l, r)| 0.5 * (l + r)).collect(),
        axial_shift_m: both().map(|(l, r)| if tan > SPUR { (l - r) / (2.0 * tan) } else { 0.0 }).collect(),
        axial_force_n: [axial(left), axial(right)],
        slices: compliance.slices(),
        halves,
    })
}

fn check(torque_nm: f64, settings: &Settings) -> Result<(), ContactError> {
    if !(torque_nm > 0.0 && torque_nm.is_finite()) {
        return Err(ContactError::Torque { torque_nm });
    }
    if let Some(positions) = settings.positions.filter(|&n| n < 2) {
        return Err(ContactError::Positions { positions });
    }
    Ok(())
}

/// True where the initial gaps of both halves are the same everywhere (sampled on a grid finer than any modification
/// needs).
pub fn same_gaps(pair: &Pair) -> bool {
    const GRID: usize = 16;
    (0..=GRID).all(|i| {
        (0..=GRID).all(|j| {
            let x = pair.path_start_m + (pair.path_end_m - pair.path_start_m) * i as f64 / GRID as f64;
            let y = pair.spec.face_width_m * j as f64 / GRID as f64;
            pair.initial_gap_m(Half::Left, x, y) == pair.initial_gap_m(Half::Right, x, y)
        })
    }) && pair.spec.pinion.flanks[0] == pair.spec.pinion.flanks[1]
        && pair.spec.gear.flanks[0] == pair.spec.gear.flanks[1]
}

fn solve_period(
    contact: &mut HalfContact<'_>,
    pair: &Pair,
    compliance: &Compliance,
    from: f64,
    force: f64,
    settings: &Settings,
    progress: &mut dyn FnMut(f64) -> Result<(), ContactError>,
) -> Result<HalfCycle, ContactError> {
    let builder = match settings.positions {
        Some(count) => {
            let mut states = Vec::with_capacity(count);
            for i in 0..count {
                let position = i as f64 / count as f64;
                let phase = (position + from).fract();
                states.push((phase, contact.at(phase, force)?));
                progress(position)?;
            }
            CycleBuilder::at_positions(
                pair,
                compliance.slices(),
                states.into_iter().map(|(p, s)| (p, force, s)).collect(),
            )
        }
        None => {
            let mut solved = 0.0;
            let positions = refine(pair, settings.accuracy, |phase, near| {
                solved += 1.0;
                progress(solved / (solved + 32.0))?;
                contact.at_near(phase, force, near)
            })?;
            CycleBuilder::refined(pair, compliance.slices(), positions, force, from)
        }
    };
    builder.finish(contact, &|_| force)
}

/// Halves without axial coupling: equal deflection, found by Newton on the split of the force. The halves' curves start
/// at the phases `from`.
fn share_torque(
    pair: &Pair,
    compliance: &Compliance,
    from: [f64; 2],
    total: f64,
    settings: &Settings,
    watch: Watch<'_>,
) -> Result<[HalfCycle; 2], ContactError> {
    let mut contacts = Half::BOTH.map(|half| HalfContact::new(pair, half, compliance, settings, watch));
    let count = settings.positions.unwrap_or(CURVE_POSITIONS);
    let mut states = [(); 2].map(|()| Vec::with_capacity(count));
    let mut left_part: f64 = 0.5;
    let mut forces = Vec::with_capacity(count);
    for i in 0..count {
        let position = i as f64 / count as f64;
        watch.checkpoint(position)?;
        let phases = from.map(|from| (position + from).fract());
        let (mut low, mut high) = (LEAST_PART, 1.0 - LEAST_PART);
        left_part = left_part.clamp(low, high);
        let mut difference = f64::INFINITY;
        for _ in 0..60 {
            let left = contacts[0].at(phases[0], left_part * total)?;
            let right = contacts[1].at(phases[1], (1.0 - left_part) * total)?;
            let gap = right.approach_m - left.approach_m;
            difference = gap.abs() / (left.approach_m.abs() + right.approach_m.abs());
            // One half may carry all of it: the other's gap is then larger than the deflection.
            if difference < 1e-10 || high - low < 1e-12 {
                states[0].push((phases[0], left_part * total, left));
                states[1].push((phases[1], (1.0 - left_part) * total, right));
                difference = 0.0;
                break;
            }
            if gap > 0.0 {
                low = left_part;
            } else {
                high = left_part;
            }
            let (kl, kr) = (left.stiffness_n_per_m, right.stiffness_n_per_m);
            let newton = left_part + gap * kl * kr / (kl + kr) / total;
            left_part = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        }
        if difference > 0.0 {
            return Err(ContactError::HalvesNotBalanced { phase: position, difference });
        }
        forces.push(left_part);
    }
    let part = |position: f64| forces[(position.rem_euclid(1.0) * forces.len() as f64).round() as usize % forces.len()];
    let [left_contact, right_contact] = &mut contacts;
    let [left, right] = states.map(|states| CycleBuilder::at_positions(pair, compliance.slices(), states));
    Ok([
        left.finish(left_contact, &|phase| part(phase - from[0]) * total)?,
        right.finish(right_contact, &|phase| (1.0 - part(phase - from[1])) * total)?,
    ])
}
