//! Lines of contact: closed formulas against summation.

use crate::gear::Pair;
use crate::gear::fixtures::{close, gear, pair, spec};
use herringbone_oracle::check_worst;

const TOPIC: &str = "Geometry: length of the contact lines";

fn with_width(width_mm: f64) -> Pair {
    pair(&spec(6.0, 20.0, 24.43, width_mm, gear(17, 0.0), gear(44, 0.0)))
}

fn sampled_range(p: &Pair) -> [f64; 3] {
    let n = 4000;
    let lengths = (0..n).map(|i| p.contact_length_m(p.path_start_m + p.base_pitch_m * f64::from(i) / f64::from(n)));
    lengths.fold([f64::MAX, 0.0, 0.0], |[least, greatest, mean], l| {
        [least.min(l), greatest.max(l), mean + l / f64::from(n)]
    })
}

#[test]
fn least_greatest_and_mean_length() {
    let errors = [12.0, 20.0, 31.0, 45.0, 55.0, 75.0, 120.0].map(|width_mm| {
        let p = with_width(width_mm);
        let [least, greatest, mean] = sampled_range(&p);
        let unit = p.spec.face_width_m / p.base_helix_angle_rad.cos();
        let [closed_least, closed_greatest] = p.contact_length_range_m();
        [(least - closed_least) / unit, (greatest - closed_greatest) / unit, mean / unit - p.transverse_contact_ratio]
    });
    for (i, what) in ["least", "greatest", "mean"].into_iter().enumerate() {
        let quantity = format!("{what} over a period, unit b / cos β_b, seven widths");
        check_worst(TOPIC, &quantity, errors.iter().map(|e| e[i]), 5e-4);
    }
}

#[test]
fn whole_overlap_ratio_gives_constant_length() {
    let wide = with_width(55.0);
    let width_mm = 2.0 * 55.0 / wide.overlap_ratio;
    let p = with_width(width_mm);
    close(p.overlap_ratio, 2.0, 1e-12);
    let [least, greatest, _] = sampled_range(&p);
    check_worst(TOPIC, "greatest over least for an overlap ratio of 2", [greatest / least - 1.0], 1e-9);
}

#[test]
fn spur_lines_run_over_the_whole_width() {
    let p = pair(&spec(6.0, 20.0, 0.0, 50.0, gear(17, 0.0), gear(44, 0.0)));
    let [least, greatest, _] = sampled_range(&p);
    close(least, 0.05, 1e-15);
    close(greatest, 0.1, 1e-15);
    assert_eq!(p.contact_length_range_m(), [0.05, 0.1]);
}

#[test]
fn lines_lie_in_the_zone_of_contact() {
    let p = with_width(55.0);
    for i in -20..20 {
        for line in p.contact_lines(f64::from(i) * 0.37 * p.base_pitch_m) {
            for (entry, x) in line.entry_m.into_iter().zip(line.x_m) {
                assert!((-1e-12..=0.055 + 1e-12).contains(&entry));
                assert!(x >= p.path_start_m - 1e-12 && x <= p.path_end_m + 1e-12);
            }
        }
    }
}
