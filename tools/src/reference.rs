//! The helical pair z 29/67 whose finite elements, made by another program, are stored under `tests/data/`.

use herringbone_physics::gear::{GearSpec, Pair, PairSpec};

/// m_n 4 mm, β 30°, b 45 mm, bores of 50 and 120 mm, flanks unmodified.
pub fn spec() -> PairSpec {
    let member = |teeth, bore_radius_m| GearSpec { bore_radius_m, ..GearSpec::plain(teeth) };
    let angles = [20f64.to_radians(), 30f64.to_radians()];
    PairSpec::plain(4e-3, angles, 45e-3, [member(29, 25e-3), member(67, 60e-3)])
}

/// The pair of a specification close to [`spec`].
///
/// # Panics
/// If it cannot run.
pub fn pair(spec: &PairSpec) -> Pair {
    match Pair::new(spec) {
        Ok((pair, _)) => pair,
        Err(reasons) => panic!("the reference pair cannot run: {reasons:?}"),
    }
}
