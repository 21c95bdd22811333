//! First contact of the entering pair, outside the path of contact.

use super::energy::ImpactError;
use crate::gear::{CornerContact, Half, Pair, Rotation};

/// The position D in which the entering pair first touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstContact {
    /// Roll along the line of action before the theoretical start of contact.
    pub overrun_m: f64,
    /// Turn of the gear from D to the theoretical start.
    pub gear_turn_rad: f64,
    /// Kinematic separation of the undeformed flanks at D.
    pub separation_m: f64,
    /// Gap of the modified and misaligned flanks at the entering end, less the base pitch error.
    pub flank_gap_m: f64,
    /// Composite deflection of the pairs already in mesh.
    pub deflection_m: f64,
    /// Kinematics of the corner.
    pub corner: CornerContact,
}

/// Relief and misalignment open the entering end further than the load closes it: the pair enters on its path, without
/// a shock by deflection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoEarlyContact {
    /// Gap of the modified and misaligned flanks at the entering end, less the base pitch error.
    pub flank_gap_m: f64,
    /// Composite deflection of the pairs in mesh at the theoretical start.
    pub deflection_m: f64,
}

/// First contact of the entering pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EntryContact {
    /// Before its path of contact, with a corner.
    Early(FirstContact),
    /// On its path of contact.
    OnPath(NoEarlyContact),
}

/// Positions tried between the theoretical start and the farthest possible first contact.
const SCAN_STEPS: u32 = 32;

/// Solves `S(overrun) + flank gap = deflection(overrun)` for the first contact D.
///
/// `S` is the exact corner separation (`Pair::mesh_in_corner`), the flank gap that of the gear's tip at the end of the
/// face where teeth enter, and `deflection` the approach of the pairs already in mesh, in m along the transverse base
/// tangent, when the entering pair is `overrun` (m of roll) before its theoretical start. `base_pitch_error_m` > 0
/// brings the entering pair earlier.
///
/// The separation grows from zero like the square of the overrun. The outermost crossing is sought from far outside
/// inwards, as the teeth come, and refined by bracketed regula falsi (Illinois) to rounding.
pub fn first_contact(
    pair: &Pair,
    half: Half,
    base_pitch_error_m: f64,
    deflection: impl Fn(f64) -> f64,
) -> Result<EntryContact, ImpactError> {
    let entering_y_m = match pair.spec.rotation {
        Rotation::ApexLeading => 0.0,
        Rotation::ApexTrailing => pair.spec.face_width_m,
    };
    let flank_gap =
        |overrun_m: f64| pair.initial_gap_m(half, pair.path_start_m - overrun_m, entering_y_m) - base_pitch_error_m;
    let position = |overrun_m: f64| -> Result<FirstContact, ImpactError> {
        let corner = pair.mesh_in_corner(overrun_m).ok_or(ImpactError::NoFlank { overrun_m })?;
        let here = FirstContact {
            overrun_m,
            gear_turn_rad: corner.gear_turn_rad,
            separation_m: corner.gap_m,
            flank_gap_m: flank_gap(overrun_m),
            deflection_m: deflection(overrun_m),
            corner,
        };
        if here.open_m().is_finite() { Ok(here) } else { Err(ImpactError::Deflection { overrun_m }) }
    };

    let start = position(0.0)?;
    if start.open_m() >= 0.0 {
        let none = NoEarlyContact { flank_gap_m: start.flank_gap_m, deflection_m: start.deflection_m };
        return Ok(EntryContact::OnPath(none));
    }
    let far = farthest(pair, &start, &position)?;
    let mut outer = far;
    let mut inner = start;
    for step in (1..SCAN_STEPS).rev() {
        let here = position(far.overrun_m * f64::from(step) / f64::from(SCAN_STEPS))?;
        if here.open_m() < 0.0 {
            inner = here;
            break;
        }
        outer = here;
    }
    refine(inner, outer, &position).map(EntryContact::Early)
}

impl FirstContact {
    /// Distance of the flanks (negative: they overlap).
    fn open_m(&self) -> f64 {
        self.separation_m + self.flank_gap_m - self.deflection_m
    }
}

/// A position certainly apart: as far open as the pair would overlap at its theoretical start.
fn farthest(
    pair: &Pair,
    start: &FirstContact,
    position: &impl Fn(f64) -> Result<FirstContact, ImpactError>,
) -> Result<FirstContact, ImpactError> {
    let mut overrun_m = 1e-3 * pair.base_pitch_m;
    while overrun_m < pair.base_pitch_m {
        let here = position(overrun_m)?;
        if here.open_m() > -start.open_m() {
            return Ok(here);
        }
        overrun_m *= 1.5;
    }
    Err(ImpactError::NoFlank { overrun_m })
}

fn refine(
    mut inner: FirstContact,
    mut outer: FirstContact,
    position: &impl Fn(f64) -> Result<FirstContact, ImpactError>,
) -> Result<FirstContact, ImpactError> {
    let (mut f_inner, mut f_outer) = (inner.open_m(), outer.open_m());
    let tolerance_m = 1e-14 * (1.0 + outer.overrun_m);
    let mut side = 0;
    for _ in 0..100 {
        let span = outer.overrun_m - inner.overrun_m;
        if f_outer == 0.0 || span <= tolerance_m {
            break;
        }
        let x = inner.overrun_m - f_inner * span / (f_outer - f_inner);
        let here = position(x)?;
        let f = here.open_m();
        if f >= 0.0 {
            outer = here;
            f_outer = f;
            if side == 1 {
                f_inner *= 0.5;
            }
            side = 1;
        } else {
            inner = here;
            f_inner = f;
            if side == -1 {
                f_outer *= 0.5;
            }
            side = -1;
        }
        if f.abs() <= 1e-9 * here.deflection_m.abs() {
            return Ok(here);
        }
    }
    Ok(if outer.open_m().abs() <= inner.open_m().abs() { outer } else { inner })
}
