//! Pairs of the tests of compliance and contact.

use crate::gear::{GearSpec, Pair, PairSpec};

pub(crate) fn member(teeth: u32, bore_radius_m: f64) -> GearSpec {
    GearSpec { bore_radius_m, ..GearSpec::plain(teeth) }
}

/// Module 4 mm, unmodified, without errors.
pub(crate) fn spec(teeth: [u32; 2], helix_deg: f64, face_width_m: f64) -> PairSpec {
    let bore = |z: u32| (0.2 * f64::from(z) * 4e-3).min(0.5 * f64::from(z) * 4e-3 - 3.5 * 4e-3).max(2e-3);
    let members = teeth.map(|z| member(z, bore(z)));
    let angles = [20f64.to_radians(), helix_deg.to_radians()];
    PairSpec { gap_width_m: 20e-3, ..PairSpec::plain(4e-3, angles, face_width_m, members) }
}

pub(crate) fn pair(spec: &PairSpec) -> Pair {
    Pair::new(spec).expect("a feasible pair").0
}
