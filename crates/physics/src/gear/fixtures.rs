//! Pairs that several tests use.

use crate::gear::{GearSpec, Pair, PairSpec};

/// A plain gear with a profile shift.
pub(crate) fn gear(teeth: u32, profile_shift: f64) -> GearSpec {
    GearSpec { profile_shift, ..GearSpec::plain(teeth) }
}

/// A pair from mm and degrees, gap 30 mm.
pub(crate) fn spec(
    module_mm: f64,
    alpha_n_deg: f64,
    beta_deg: f64,
    width_mm: f64,
    pinion: GearSpec,
    gear: GearSpec,
) -> PairSpec {
    let angles = [alpha_n_deg.to_radians(), beta_deg.to_radians()];
    PairSpec { gap_width_m: 0.03, ..PairSpec::plain(module_mm * 1e-3, angles, width_mm * 1e-3, [pinion, gear]) }
}

/// Table 1 of the source paper: z 17/44, m_n 6 mm, transverse pressure angle 20 deg, helix 24.43 deg, b 75 mm per half.
pub(crate) fn source_pair(addendum: f64) -> PairSpec {
    let beta: f64 = 24.43_f64.to_radians();
    let alpha_n = (20.0_f64.to_radians().tan() * beta.cos()).atan();
    let with = |teeth| GearSpec { addendum, dedendum: addendum + 0.25, fillet_radius: 0.2, ..gear(teeth, 0.0) };
    spec(6.0, alpha_n.to_degrees(), 24.43, 75.0, with(17), with(44))
}

/// The worked example of the corner formulas: z 17/44, m_n 6, helix 24.43 deg, normal pressure angle 20 deg, b 55.
pub(crate) fn worked_pair() -> PairSpec {
    spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), gear(44, 0.0))
}

/// A pinion of 15 teeth that the rack undercuts, and a gear short enough to stay clear of its base circle.
pub(crate) fn undercut_pair() -> PairSpec {
    let short = GearSpec { addendum: 0.8, ..gear(67, 0.0) };
    spec(5.0, 20.0, 5.0, 40.0, gear(15, 0.0), short)
}

/// The feasible pair of a specification.
pub(crate) fn pair(spec: &PairSpec) -> Pair {
    match Pair::new(spec) {
        Ok((pair, _)) => pair,
        Err(reasons) => panic!("{reasons:#?}"),
    }
}

/// Asserts a value within a tolerance.
#[track_caller]
pub(crate) fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} within {tolerance}");
}
