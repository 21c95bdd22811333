//! Tooth and body compliance against independent finite elements.
//!
//! Plane strain: whole gear of six-node triangles, bore clamped, C* = E b δ / F along the load line at the tooth
//! centreline. Three-dimensional: 20-node hexahedra of every tooth of a z 29/67 pair (module 4 mm, helix 30°, width 45
//! mm, bores held); there the half-space displacement under the load is taken out, and the half-space displacement at
//! the depth of the tooth centreline is added here, so that both mean the displacement of the centreline.

use std::f64::consts::PI;

use super::fixtures::{pair, spec};
use super::member::{BodyHold, MemberCompliance};
use crate::gear::Pair;
use crate::watch::Watch;
use herringbone_oracle::Tolerance::Relative;
use herringbone_oracle::{check, check_worst};

const E: f64 = 206e9;

const HELICAL: &str = "Contact: helical tooth against finite elements";

fn helical() -> Pair {
    let mut spec = spec([29, 67], 30.0, 45e-3);
    spec.pinion.bore_radius_m = 25e-3;
    spec.gear.bore_radius_m = 60e-3;
    pair(&spec)
}

/// A spur pinion of `z` teeth, held at root radius / `h`.
fn spur(z: u32, h: f64, width_modules: f64) -> Pair {
    shifted_spur(z, 0.0, h, width_modules)
}

/// The same with profile shift `x`.
fn shifted_spur(z: u32, x: f64, h: f64, width_modules: f64) -> Pair {
    let mut spec = spec([z, 67], 0.0, width_modules * 4e-3);
    spec.pinion.profile_shift = x;
    spec.pinion.bore_radius_m = (0.5 * f64::from(z) - 1.25 + x) * 4e-3 / h;
    pair(&spec)
}

fn roll_m(pair: &Pair, modules: f64) -> f64 {
    ((modules * 4e-3).powi(2) - pair.pinion.base_radius_m.powi(2)).sqrt()
}

#[test]
fn plane_teeth_are_within_nine_percent_of_finite_elements() {
    for (z, x, h, table) in [
        (17, 0.0, 1.4, [(8.0049, 3.3479), (8.5652, 4.8521), (9.3637, 10.5361)]),
        (17, 0.3, 2.0, [(8.0994, 3.1697), (8.8244, 4.8340), (9.6624, 10.0797)]),
        (25, 0.0, 1.4, [(11.8959, 2.6863), (12.5905, 4.7170), (13.3713, 10.2972)]),
        (25, 0.0, 2.0, [(11.8959, 3.6319), (12.5905, 5.7231), (13.3713, 11.4134)]),
        (43, 0.0, 1.4, [(20.8074, 2.4303), (21.6259, 4.8307), (22.3809, 10.3803)]),
        (43, 0.0, 2.0, [(20.8074, 3.3069), (21.6259, 5.7485), (22.3809, 11.3517)]),
    ] {
        // Near the tip of few teeth the model is 7 % too stiff.
        let limit = if z == 17 { 0.08 } else { 0.05 };
        let n = 32;
        let pair = shifted_spur(z, x, h, 24.0);
        let flank = MemberCompliance::new(&pair, 1.0, BodyHold::Bore, n, 1, Watch::none()).expect("not canceled");
        for (r, expected) in table {
            let w = flank.weights(roll_m(&pair, r));
            let middle = n / 2;
            let mean = (0..n).map(|j| flank.bulk.between(0, middle, j, &w, &w)).sum::<f64>() / n as f64;
            let got = E * mean * pair.spec.face_width_m;
            let topic = "Contact: plane tooth against finite elements";
            let shifted = if x == 0.0 { String::new() } else { format!(", x {x}") };
            check(topic, &format!("C*, z {z}{shifted}, h {h}, r {r} modules"), got, expected, Relative(limit));
        }
    }
}

#[test]
fn neighbouring_teeth_couple_as_in_finite_elements() {
    // One base pitch apart: low contact on one tooth, high on the next; the load on either.
    for (z, h, low, high, expected) in [
        (25, 1.4, 12.0751, 13.0786, [0.697, 0.653, 0.660, 0.694]),
        (25, 2.0, 12.0751, 13.0786, [1.578, 1.525, 1.525, 1.578]),
        (43, 1.4, 21.0409, 22.0485, [0.952, 0.878, 0.878, 0.952]),
    ] {
        let n = 32;
        let pair = spur(z, h, 24.0);
        let flank = MemberCompliance::new(&pair, 1.0, BodyHold::Bore, n, 1, Watch::none()).expect("not canceled");
        let (a, b) = (flank.weights(roll_m(&pair, low)), flank.weights(roll_m(&pair, high)));
        let sum = |wa, wb| {
            let line: f64 = (0..n).map(|j| flank.bulk.between(1, n / 2, j, wa, wb)).sum();
            E * pair.spec.face_width_m * line / n as f64
        };
        let got = sum(&b, &a);
        let mean = expected.iter().sum::<f64>() / 4.0;
        let topic = "Contact: neighbouring teeth against finite elements";
        check(topic, &format!("C* one base pitch away, z {z}, h {h}"), got, mean, Relative(0.08));
    }
}

#[test]
fn waves_along_the_face_decay_as_in_finite_elements() {
    let ks = [0.0, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5];
    for (r, table) in [
        (11.896, [2.6863, 2.6315, 2.4704, 2.1117, 1.7245, 1.1715, 0.7942, 0.4049]),
        (12.410, [4.0092, 3.9339, 3.7110, 3.1912, 2.5945, 1.7112, 1.1138, 0.5318]),
        (13.371, [10.2947, 10.1299, 9.6409, 8.4381, 6.9646, 4.6908, 3.1206, 1.5673]),
    ] {
        let pair = spur(25, 1.4, 24.0);
        let n = 96;
        let flank = MemberCompliance::new(&pair, 1.0, BodyHold::Bore, n, 1, Watch::none()).expect("not canceled");
        let w = flank.weights(roll_m(&pair, r));
        let mut errors = Vec::new();
        for (k, expected) in ks.into_iter().zip(table) {
            let wave = |j: usize| (k * 24.0 * (j as f64 - 48.0) / n as f64).cos();
            let sum: f64 = (0..n).map(|j| flank.bulk.between(0, 48, j, &w, &w) * wave(j)).sum();
            let got = E * sum * pair.spec.face_width_m / n as f64;
            errors.push((got - expected) / table[0]);
        }
        let quantity = format!("eight waves along the face, r {r} modules, of the plane value");
        check_worst("Contact: coupling along the face", &quantity, errors, 0.11);
    }
}

/// Half-space displacement at depth `h` of a unit point load at distance `d` along the contact line.
fn half_space(d: f64, h: f64) -> f64 {
    let r = d.hypot(h);
    1.3 / (2.0 * PI * E) * (1.4 / r + h * h / r.powi(3))
}

#[test]
fn helical_teeth_under_uniform_load_are_within_nine_percent_of_finite_elements() {
    // Roll length, own tooth without half-space part, next tooth; 1e-4 µm/N for the whole face.
    const TABLE: [[(f64, f64, f64); 5]; 2] = [
        [
            (18.4996, 3.0041, 2.7371),
            (23.204, 4.0496, 2.7641),
            (27.1039, 5.4543, 2.7731),
            (30.5093, 7.4502, 2.7637),
            (33.5709, 10.391, 2.7362),
        ],
        [
            (51.9739, 5.4851, 5.5565),
            (56.3764, 6.5374, 5.6926),
            (60.4591, 7.9658, 5.8112),
            (64.2831, 10.053, 5.9112),
            (67.8921, 13.242, 5.9926),
        ],
    ];
    let pair = helical();
    let n = 36;
    for (side, table) in [1.0, -1.0].into_iter().zip(TABLE) {
        let flank = MemberCompliance::new(&pair, side, BodyHold::Bore, n, 1, Watch::none()).expect("not canceled");
        for (roll, bulk, next) in table {
            let (at, w) = (flank.at(roll * 1e-3), flank.weights(roll * 1e-3));
            let mean = |offset: usize| {
                let sum: f64 = (0..n * n).map(|ij| flank.bulk.between(offset, ij / n, ij % n, &w, &w)).sum();
                sum / (n * n) as f64
            };
            let length = 45e-3 / pair.base_helix_angle_rad.cos();
            let points = 400;
            let below: f64 = (0..points)
                .map(|i| {
                    let d = length * f64::from(i) / f64::from(points);
                    let pairs = if i == 0 { points } else { 2 * (points - i) };
                    f64::from(pairs) * half_space(d, at.depth_m)
                })
                .sum::<f64>()
                / f64::from(points * points);
            let got = mean(0);
            let expected = bulk * 1e-10 + below;
            let member = if side > 0.0 { "pinion" } else { "gear" };
            let of = |what: &str| format!("{what}, {member}, roll {roll} mm, 1e-4 µm/N");
            check(HELICAL, &of("uniform load, own tooth"), got * 1e10, expected * 1e10, Relative(0.09));
            check(HELICAL, &of("uniform load, next tooth"), mean(1) * 1e10, next, Relative(0.06));
        }
    }
}

#[test]
fn helical_teeth_under_a_load_in_the_middle_are_within_twelve_percent_of_finite_elements() {
    // Member, roll length, own displacement without half-space part (1e-4 µm/N) of a triangular load 2 × 2.3196 mm
    // wide.
    const TABLE: [(usize, f64, f64); 10] = [
        (0, 20.984, 5.299),
        (0, 25.229, 8.295),
        (0, 28.857, 12.799),
        (0, 32.077, 20.264),
        (0, 35.002, 33.142),
        (1, 54.220, 7.044),
        (1, 58.453, 9.900),
        (1, 62.400, 14.318),
        (1, 66.112, 21.979),
        (1, 69.626, 36.072),
    ];
    let pair = helical();
    let (n, step, reach) = (90, 0.5e-3, 2.3196e-3);
    let flanks = [1.0, -1.0]
        .map(|side| MemberCompliance::new(&pair, side, BodyHold::Bore, n, 1, Watch::none()).expect("not canceled"));
    let hat: Vec<f64> = (0..n).map(|i| (1.0 - (((i as f64 + 0.5) * step - 22.5e-3) / reach).abs()).max(0.0)).collect();
    let sum: f64 = hat.iter().sum();
    for (member, roll, bulk) in TABLE {
        let flank = &flanks[member];
        let (at, w) = (flank.at(roll * 1e-3), flank.weights(roll * 1e-3));
        let (mut got, mut below) = (0.0, 0.0);
        for j in 0..n {
            for i in 0..n {
                let weight = hat[i] * hat[j] / (sum * sum);
                let d = (i as f64 - j as f64) * step / pair.base_helix_angle_rad.cos();
                got += weight * flank.bulk.between(0, i, j, &w, &w);
                below += weight * half_space(d, at.depth_m);
            }
        }
        let expected = bulk * 1e-10 + below;
        let of = format!("load in the middle, {}, roll {roll} mm, 1e-4 µm/N", ["pinion", "gear"][member]);
        check(HELICAL, &of, got * 1e10, expected * 1e10, Relative(0.12));
    }
}
