//! Published pairs, to their printed digits.

use crate::gear::fixtures::{close, gear, pair, source_pair, spec};
use crate::gear::{GearSpec, PairSpec};
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::check;

/// ISO/TR 6336-30, annex A, example 1 (the standard states x1 = 0.14522; the reference contact ratio was calculated
/// with x1 = 0.145, which moves the pinion's tip by 2 um).
#[test]
fn iso_tr_6336_30_example_1() {
    let rack = |teeth, x| GearSpec { dedendum: 1.4, fillet_radius: 0.39, ..gear(teeth, x) };
    let with = |x1| {
        let free = spec(8.0, 20.0, 15.8, 100.0, rack(17, x1), rack(103, 0.0));
        pair(&PairSpec { center_distance_m: Some(0.5), ..free })
    };
    let topic = "Geometry: ISO/TR 6336-30, example 1";
    let p = with(0.14522);
    let reference = p.pinion.reference_radius_m + p.gear.reference_radius_m;
    check(topic, "reference centre distance, mm", reference * 1e3, 498.84746, Absolute(5e-6));
    let angle = p.working_pressure_angle_rad.to_degrees();
    check(topic, "working transverse pressure angle, deg", angle, 21.066100, Absolute(5e-7));
    let [z1, z2] = p.virtual_teeth();
    check(topic, "virtual teeth, pinion", z1, 18.9051, Absolute(5e-5));
    check(topic, "virtual teeth, gear", z2, 114.5428, Absolute(5e-5));
    check(topic, "overlap ratio", p.overlap_ratio, 1.08337, Absolute(5e-6));
    let ratio = with(0.145).transverse_contact_ratio;
    check(topic, "transverse contact ratio with x1 = 0.145", ratio, 1.54934, Absolute(5e-6));
    // The centre distance is the one that belongs to the profile shift.
    check(topic, "backlash at the stated centre distance, µm", p.geometric_backlash_m * 1e6, 0.0, Absolute(0.1));
}

/// FZG test gear type C, a = 91.5 mm.
#[test]
fn fzg_c14() {
    let base = spec(4.5, 20.0, 0.0, 14.0, gear(16, 0.1817), gear(24, 0.1715));
    let free = pair(&base);
    let topic = "Geometry: FZG type C";
    check(topic, "centre distance, mm", free.center_distance_m * 1e3, 91.500, Absolute(1e-3));
    let p = free;
    check(topic, "transverse contact ratio", p.transverse_contact_ratio, 1.4624, Absolute(5e-5));
    let mm = |x: f64| (x - p.path_start_m) * 1e3;
    check(topic, "path of contact AE, mm", mm(p.path_end_m), 19.428, Absolute(5e-4));
    check(topic, "AB, mm", mm(p.path_end_m - p.base_pitch_m), 6.143, Absolute(5e-4));
    check(topic, "AC, mm", mm(p.pitch_point_m()), 9.676, Absolute(5e-4));
    check(topic, "AD, mm", mm(p.path_start_m + p.base_pitch_m), 13.285, Absolute(5e-4));
    check(topic, "line of action T1T2, mm", p.line_of_action_m * 1e3, 34.925, Absolute(1e-3));
}

/// FZG helical test gear H501: tip shortened to the basic clearance.
#[test]
fn fzg_h501() {
    let base = spec(3.5, 20.0, 15.0, 23.0, gear(20, 0.1809), gear(30, 0.0891));
    let free = pair(&base);
    let reference = free.pinion.reference_radius_m + free.gear.reference_radius_m;
    let k = (free.center_distance_m - reference) / base.normal_module_m - (0.1809 + 0.0891);
    let topic = "Geometry: FZG H501";
    check(topic, "tip alteration factor", k, -0.00897, Absolute(5e-6));
    let short = |g: GearSpec| GearSpec { tip_alteration: k, ..g };
    let p = pair(&PairSpec { pinion: short(base.pinion), gear: short(base.gear), ..base });
    check(topic, "tip radius of the pinion, mm", p.pinion.tip_radius_m * 1e3, 40.336, Absolute(5e-4));
    check(topic, "tip radius of the gear, mm", p.gear.tip_radius_m * 1e3, 58.132, Absolute(5e-4));
    check(topic, "transverse contact ratio", p.transverse_contact_ratio, 1.4600, Absolute(5e-5));
    check(topic, "overlap ratio", p.overlap_ratio, 0.5414, Absolute(5e-5));
    check(topic, "path of contact AE, mm", (p.path_end_m - p.path_start_m) * 1e3, 15.552, Absolute(5e-4));
}

/// RIKOR test 001: base diameter and base helix angle, z 14/59, m_n 8, helix 11 deg.
#[test]
fn rikor_001_base_circle() {
    let shifted = |teeth, x| gear(teeth, x);
    let p = pair(&spec(8.0, 20.0, 11.0, 127.0, shifted(14, 0.4), shifted(59, 0.0)));
    let topic = "Geometry: RIKOR 001, base circle";
    check(topic, "base diameter of the pinion, mm", 2e3 * p.pinion.base_radius_m, 106.9793, Absolute(5e-5));
    check(topic, "base helix angle, deg", p.base_helix_angle_rad.to_degrees(), 10.3291, Absolute(5e-5));
}

/// The reference pair z 29/67 of the finite-element comparison.
#[test]
fn pair_29_67() {
    let p = pair(&spec(4.0, 20.0, 30.0, 45.0, gear(29, 0.0), gear(67, 0.0)));
    let topic = "Geometry: pair 29/67 of the finite elements";
    check(topic, "centre distance, mm", p.center_distance_m * 1e3, 221.7025, Absolute(5e-5));
    let angle = p.transverse_pressure_angle_rad.to_degrees();
    check(topic, "transverse pressure angle, deg", angle, 22.79588, Absolute(5e-6));
    check(topic, "base helix angle, deg", p.base_helix_angle_rad.to_degrees(), 28.02432, Absolute(5e-6));
    check(topic, "transverse base pitch, mm", p.base_pitch_m * 1e3, 13.3770, Absolute(5e-5));
    check(topic, "transverse contact ratio", p.transverse_contact_ratio, 1.40012, Absolute(5e-6));
    check(topic, "overlap ratio", p.overlap_ratio, 1.79049, Absolute(5e-6));
}

/// Contact ratios of the source paper's Table 1 and of tooth heights near it.
#[test]
fn source_contact_ratios() {
    let p = pair(&source_pair(1.0));
    let topic = "Geometry: source pair, contact ratios";
    check(topic, "overlap ratio", p.overlap_ratio, 1.6456, Absolute(5e-5));
    check(topic, "transverse contact ratio", p.transverse_contact_ratio, 1.4968, Absolute(5e-5));
    for (addendum, total) in [(0.69, 2.72), (1.12, 3.30)] {
        let got = pair(&source_pair(addendum)).total_contact_ratio();
        check(topic, &format!("total contact ratio with an addendum of {addendum}"), got, total, Absolute(0.01));
    }
}

/// A centre-distance error shortens the path of contact and opens the flanks: exact values and first order.
#[test]
fn center_distance_error() {
    let base = spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), gear(44, 0.0));
    let nominal = pair(&base);
    let mut moved = base;
    moved.assembly.center_distance_error_m = 1e-5;
    let p = pair(&moved);
    let sin = nominal.working_pressure_angle_rad.sin();
    let topic = "Geometry: centre distance error of 10 µm, first order";
    let change = p.transverse_contact_ratio - nominal.transverse_contact_ratio;
    let expected = -1e-5 / (nominal.base_pitch_m * sin);
    check(topic, "change of the transverse contact ratio", change, expected, Absolute(2e-6));
    check(topic, "backlash, µm", p.geometric_backlash_m * 1e6, 20.0 * sin, Absolute(2e-2));
    close(nominal.geometric_backlash_m, 0.0, 1e-15);
}
