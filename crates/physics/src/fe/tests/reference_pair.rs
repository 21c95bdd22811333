//! Both members of the z 29/67 pair, held at their bores, against an independent finite-element program with 20-node
//! hexahedra (tests/data/fe_tooth_29_67.json, whose stated uncertainty is 0.3 % inside, 1 to 1.5 % on borders, 0.5 %
//! for the neighbours). The resolution is `Medium`: its own error at a loaded point is up to 2 %.

use serde_json::Value;

use crate::fe::{FlankFlexibility, FlankFlexibilityInput, Resolution};
use crate::gear::{MemberId, Pair, fixtures};
use crate::watch::Watch;
use herringbone_oracle::check_worst;

fn rows(value: &Value) -> Vec<Vec<f64>> {
    let row = |row: &Value| row.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    value.as_array().unwrap().iter().map(row).collect()
}

/// Means over the face of load rows, area-weighted.
fn face_means(stations: &[f64], profile: usize, value: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    let last = stations.len() - 1;
    let weight =
        |j: usize| 0.5 * (stations[(j + 1).min(last)] - stations[j.saturating_sub(1)]) / (stations[last] - stations[0]);
    let mean = |a: usize, b: usize| -> f64 {
        (0..=last)
            .flat_map(|i| (0..=last).map(move |j| (i, j)))
            .map(|(i, j)| weight(i) * weight(j) * value(a * (last + 1) + i, b * (last + 1) + j))
            .sum()
    };
    (0..profile).map(|a| (0..profile).map(|b| mean(a, b)).collect()).collect()
}

fn member(name: &str, side: MemberId, hold_radius_m: f64) {
    let reference: Value = serde_json::from_str(include_str!("../../../../../tests/data/fe_tooth_29_67.json")).unwrap();
    let reference = &reference[name];
    let (pinion, gear) = (fixtures::gear(29, 0.0), fixtures::gear(67, 0.0));
    let (pair, _) = Pair::new(&fixtures::spec(4.0, 20.0, 30.0, 45.0, pinion, gear)).unwrap();
    let input = FlankFlexibilityInput::new(&pair, side, hold_radius_m, 2, Resolution::Medium);
    let flank = FlankFlexibility::new(&input, Watch::none()).unwrap();
    let nodes = flank.nodes();
    let stations = flank.stations_m().len();
    assert_eq!((flank.rolls_m().len(), stations), (11, 21));
    let topic = format!("Elements: flank flexibility, {name} of the 29/67 pair");

    let total = |offset: usize, a: usize, b: usize| 1e6 * flank.total(offset, a, b).unwrap();
    // The reference's next tooth lies on the side of the loaded flank: ahead on the pinion, behind on the gear.
    let neighbour = |offset: usize, a: usize, b: usize| match side {
        MemberId::Pinion => total(offset, a, b),
        MemberId::Gear => total(offset, b, a),
    };
    let points: Vec<[usize; 2]> = reference["points"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| ["i_profile", "j_axial"].map(|key| p[key].as_u64().unwrap() as usize))
        .collect();
    let node = |k: usize| points[k][0] * stations + points[k][1];
    let inside = |k: usize| (1..10).contains(&points[k][0]) && (1..20).contains(&points[k][1]);
    let errors = |expected: &Value, got: &dyn Fn(usize, usize) -> f64, pick: &dyn Fn(usize, usize) -> bool| {
        let mut errors = Vec::new();
        for (i, row) in rows(expected).iter().enumerate() {
            for (j, e) in row.iter().enumerate() {
                if pick(i, j) {
                    errors.push(got(i, j) / e - 1.0);
                }
            }
        }
        errors
    };
    let same = &reference["same_tooth_total_um_per_N"];
    let of = |i: usize, j: usize| total(0, node(i), node(j));
    check_worst(&topic, "loaded points inside", errors(same, &of, &|i, j| i == j && inside(i)), 0.022);
    check_worst(&topic, "between points inside", errors(same, &of, &|i, j| i != j && inside(i) && inside(j)), 0.012);
    check_worst(&topic, "all points of the tooth", errors(same, &of, &|_, _| true), 0.035);
    let half = |i: usize, j: usize| 1e6 * flank.half_space()[node(i) * nodes + node(j)];
    let expected = &reference["half_space_um_per_N"];
    check_worst(&topic, "half-space part", errors(expected, &half, &|_, _| true), 0.002);
    for (offset, key) in [(1, "next_tooth_um_per_N"), (2, "second_next_tooth_um_per_N")] {
        let of = |i: usize, j: usize| neighbour(offset, node(i), node(j));
        check_worst(&topic, key, errors(&reference[key], &of, &|_, _| true), 0.008);
    }
    let face = &reference["face_uniform"];
    let bulk = flank.bulk(0).unwrap();
    let means = face_means(flank.stations_m(), 11, |a, b| 1e6 * bulk[a * nodes + b]);
    let of = |i: usize, j: usize| means[i][j];
    check_worst(&topic, "bulk, means over the face", errors(&face["bulk_um_per_N"], &of, &|_, _| true), 0.009);
    let means = face_means(flank.stations_m(), 11, |a, b| neighbour(1, a, b));
    let of = |i: usize, j: usize| means[i][j];
    check_worst(
        &topic,
        "next tooth, means over the face",
        errors(&face["next_tooth_um_per_N"], &of, &|_, _| true),
        0.004,
    );
}

#[test]
fn pinion() {
    member("pinion", MemberId::Pinion, 25e-3);
}

#[test]
fn gear() {
    member("gear", MemberId::Gear, 60e-3);
}
