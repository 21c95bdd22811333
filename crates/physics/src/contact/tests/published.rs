//! Published loads, pressures and stiffnesses of single pairs.

use super::pair;
use crate::compliance::LineContact;
use crate::compliance::{BodyHold, Compliance, Settings};
use crate::contact::{HalfContact, solve_pair_of_halves};
use crate::gear::{GearSpec, Half, Material, Pair, PairSpec};
use crate::watch::Watch;
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::check;

fn published(module_m: f64, helix_deg: f64, width_m: f64, [pinion, gear]: [(u32, f64, f64); 2]) -> Pair {
    let member = |(teeth, profile_shift, bore_radius_m): (u32, f64, f64)| GearSpec {
        profile_shift,
        bore_radius_m,
        ..GearSpec::plain(teeth)
    };
    let angles = [20f64.to_radians(), helix_deg.to_radians()];
    pair(&PairSpec { gap_width_m: 20e-3, ..PairSpec::plain(module_m, angles, width_m, [member(pinion), member(gear)]) })
}

/// Normal forces along all lines at one position: their sum, N.
fn normal_force_n(pair: &Pair, force_n: f64) -> f64 {
    let settings = Settings { positions: Some(8), slices: Some(12), ..Settings::default() };
    let compliance = Compliance::analytic(pair, &settings, Watch::none()).expect("not canceled");
    HalfContact::new(pair, Half::Left, &compliance, &settings, Watch::none())
        .at(0.3, force_n)
        .unwrap()
        .forces_n
        .iter()
        .sum()
}

/// RIKOR test 001 (FVA 30): forces of one helix under 8962.5 N m. Pressure angle and helix are inferred from them; the
/// profile shift, not stated, does not enter the forces.
#[test]
fn rikor_001_forces() {
    let topic = "Contact: RIKOR 001, forces";
    let p = published(8e-3, 11.0, 127e-3, [(14, 0.4, 20e-3), (59, 0.0, 80e-3)]);
    let torque_nm = 1.5 * 5975.0;
    let force_n = torque_nm / p.pinion.base_radius_m;
    check(topic, "force along the base tangent, N", force_n, 167_555.8, Absolute(0.1));
    check(topic, "the same over the width, N/mm", force_n / p.spec.face_width_m / 1e3, 1319.34, Absolute(5e-3));
    check(topic, "sum of the normal forces, N", normal_force_n(&p, force_n), 170_316.0, Absolute(0.5));
    let settings = Settings { positions: Some(8), slices: Some(12), ..Settings::default() };
    let compliance = Compliance::analytic(&p, &settings, Watch::none()).expect("not canceled");
    let both = solve_pair_of_halves(&p, 2.0 * torque_nm, 0.0, &compliance, &settings, Watch::none()).unwrap();
    check(topic, "axial force, N", both.axial_force_n[0], 30_538.0, Absolute(0.5));
}

/// FZG test gears: forces, and the pressure with all of the load on one line at the pitch point.
#[test]
fn fzg_loads() {
    let topic = "Contact: FZG loads";
    let c = published(4.5e-3, 0.0, 14e-3, [(16, 0.1817, 10e-3), (24, 0.1715, 10e-3)]);
    let force_n = 200.0 / c.pinion.base_radius_m;
    check(topic, "type C at 200 N m, force along the base tangent, N", force_n, 5912.1, Absolute(0.05));
    let radii = [c.pitch_point_m(), c.line_of_action_m - c.pitch_point_m()];
    let relative_m = radii[0] * radii[1] / c.line_of_action_m;
    let line = LineContact::new([&Material::STEEL; 2], relative_m, [4.5e-3; 2]);
    let w = force_n / c.spec.face_width_m;
    check(topic, "type C, pressure at the pitch point, MPa", line.pressure_pa(w) / 1e6, 1347.3, Absolute(0.3));
    check(topic, "type C, half width of the band, µm", line.half_width_m(w) * 1e6, 199.567, Absolute(0.05));
    let h = published(3.5e-3, 15.0, 23e-3, [(20, 0.1809, 10e-3), (30, 0.0891, 10e-3)]);
    let normal = normal_force_n(&h, 100.0 / h.pinion.base_radius_m);
    check(topic, "H501 at 100 N m, sum of the normal forces, N", normal, 3040.5, Absolute(0.05));
}

/// ROSS, spur pair z 62/62, m 2 mm, b 20 mm, bores 35 mm: stiffness at the start of contact by another law (potential
/// energy method), which has no load; here under 100 N/mm. The tolerance is the difference between the laws as it was
/// found, for both ways of holding the bodies; see docs/VALIDATION.md.
#[test]
fn ross_spur_pair_lies_between_rim_and_bore() {
    let topic = "Contact: ROSS spur pair, another law";
    let p = published(2e-3, 0.0, 20e-3, [(62, 0.0, 17.5e-3), (62, 0.0, 17.5e-3)]);
    check(topic, "transverse contact ratio", p.transverse_contact_ratio, 1.789_779_866_833_0, Absolute(5e-13));
    let stiffness = |body| {
        let settings = Settings { body, positions: Some(8), corner_contact: false, ..Settings::default() };
        let compliance = Compliance::analytic(&p, &settings, Watch::none()).expect("not canceled");
        let mut contact = HalfContact::new(&p, Half::Left, &compliance, &settings, Watch::none());
        contact.at(0.0, 100e3 * p.spec.face_width_m).unwrap().stiffness_n_per_m / 1e6
    };
    let reference = 396.622_921;
    let [rim, bore] = [BodyHold::Rim, BodyHold::Bore].map(stiffness);
    check(topic, "start of contact, held at the rim, N/µm", rim, reference, Relative(0.55));
    check(topic, "start of contact, held at the bores, N/µm", bore, reference, Relative(0.28));
    assert!(bore < reference && reference < rim);
}
