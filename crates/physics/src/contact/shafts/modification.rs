//! The helix modification that evens the load along the faces at one torque: helix slope and crowning of each half of
//! the pinion.

use super::cycle::{LoadOnShafts, load_on_shafts};
use super::flexibility::ContactShafts;
use crate::compliance::{Compliance, Settings};
use crate::contact::ContactError;
use crate::gear::{Half, Pair, PairSpec};
use crate::numerics::dense::solve_dense;
use crate::watch::Watch;

/// Amounts of a half of the pinion along the base tangent, as [`FlankModification`](crate::gear::FlankModification)
/// counts them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HelixModification {
    /// Helix slope: zero at the inner end, this at the outer.
    pub slope_m: f64,
    /// Crowning: zero at mid-width, this at both ends.
    pub crowning_m: f64,
}

/// Steps of the iteration: one by the deflection of the shafts, the others by what is left of the unevenness.
const STEPS: usize = 8;
/// Face load factor over 5 mm below which the load is even.
const EVEN: f64 = 1.01;
/// Change of the worst face load factor of a step below which the iteration ends.
const SETTLED: f64 = 2e-3;

/// The modification of either half of the pinion, in place of slope and crowning of `pair`, under which the load along
/// the faces is as even as slope and crowning can make it, and the contact with it. `coast`: of the coast flanks.
///
/// The first step takes up the opening of the flanks by the shafts under load; the next ones the unevenness that is
/// left, by the stiffness of the teeth. Fitted over the face by least squares. `unmodified` is the load with slope and
/// crowning of `pair`.
///
/// # Errors
/// [`ContactError`].
pub fn evening_modification(
    pair: &Pair,
    shafts: &ContactShafts,
    loads: (f64, f64, f64),
    coast: bool,
    unmodified: &LoadOnShafts,
    (compliance, settings): (&Compliance, &Settings),
    watch: Watch<'_>,
) -> Result<([HelixModification; 2], LoadOnShafts), ContactError> {
    let quiet = Watch::new(&|_| {}, watch.canceled());
    let solve = |modification: &[HelixModification; 2]| {
        let modified = with_helix_modification(pair, modification, coast);
        load_on_shafts(&modified, shafts, loads, coast, (compliance, settings), quiet)
    };
    let mut modification = helix_modification(pair, coast);
    let mut solved = unmodified.clone();
    let worst = |solved: &LoadOnShafts| solved.halves.iter().map(|half| half.face.k_h_beta_5mm()).fold(0.0, f64::max);
    let mut best = (worst(&solved), modification, solved.clone());
    let mut last = f64::INFINITY;
    for step in 0..STEPS {
        for half in Half::BOTH {
            let h = half.index();
            let [slope_m, crowning_m] = amounts(pair, shafts, &solved, half, step == 0);
            // The openings of the shafts do not contain what the flanks have already.
            let before = if step == 0 { HelixModification::default() } else { modification[h] };
            modification[h] =
                HelixModification { slope_m: before.slope_m + slope_m, crowning_m: before.crowning_m + crowning_m };
        }
        solved = solve(&modification)?;
        let factor = worst(&solved);
        if factor < best.0 {
            best = (factor, modification, solved.clone());
        }
        if factor < EVEN || (last - factor).abs() < SETTLED {
            break;
        }
        last = factor;
    }
    Ok((best.1, best.2))
}

/// Slope and crowning of either half of the pinion.
pub fn helix_modification(pair: &Pair, coast: bool) -> [HelixModification; 2] {
    let pinion = &pair.spec.pinion;
    let flanks = if coast { pinion.coast_flanks.unwrap_or(pinion.flanks) } else { pinion.flanks };
    flanks.map(|flank| HelixModification { slope_m: flank.helix_slope_m, crowning_m: flank.lead_crowning_m })
}

/// The pair with this slope and crowning of the pinion's drive flanks, or of its coast flanks.
pub fn with_helix_modification(pair: &Pair, modification: &[HelixModification; 2], coast: bool) -> Pair {
    let mut pinion = pair.spec.pinion;
    let mut flanks = if coast { pinion.coast_flanks.unwrap_or(pinion.flanks) } else { pinion.flanks };
    for (flank, own) in flanks.iter_mut().zip(modification) {
        flank.helix_slope_m = own.slope_m;
        flank.lead_crowning_m = own.crowning_m;
    }
    if coast {
        pinion.coast_flanks = Some(flanks);
    } else {
        pinion.flanks = flanks;
    }
    Pair { spec: PairSpec { pinion, ..pair.spec }, ..pair.clone() }
}

/// Slope and crowning that make up the difference of the openings of the shafts along the face (`of_shafts`), or of the
/// line load over the stiffness of the teeth per length of contact line.
fn amounts(pair: &Pair, shafts: &ContactShafts, solved: &LoadOnShafts, half: Half, of_shafts: bool) -> [f64; 2] {
    let own = &solved.halves[half.index()];
    let cos = pair.base_helix_angle_rad.cos();
    let field = solved.displacement_field(shafts, half);
    let middle_m = 0.5 * (pair.path_start_m + pair.path_end_m);
    let line_stiffness = own.tooth_stiffness[0] / solved.line_length_m;
    let width_m = pair.pinion.face_width_m;
    let margin_m = 0.5 * (width_m - pair.spec.face_width_m);
    let mut normal = [0.0; 9];
    let mut right = [0.0; 3];
    for (&from_inner_m, &load) in own.face.strip_m.iter().zip(&own.face.line_load_n_per_m) {
        let removed_m = if of_shafts {
            -field.at(pair.entry_m(from_inner_m), middle_m)
        } else if line_stiffness > 0.0 {
            (load - own.face.mean_n_per_m) / line_stiffness
        } else {
            0.0
        } / cos;
        let place = (from_inner_m + margin_m) / width_m;
        let basis = [1.0, place, (2.0 * place - 1.0).powi(2)];
        for (i, b) in basis.iter().enumerate() {
            right[i] += b * removed_m;
            for (j, c) in basis.iter().enumerate() {
                normal[3 * i + j] += b * c;
            }
        }
    }
    solve_dense(&mut normal, &mut right, 3);
    if right.iter().all(|value| value.is_finite()) { [right[1], right[2]] } else { [0.0; 2] }
}
