//! Properties that hold for every gear.

use std::sync::Mutex;

use crate::fe::condense::factor_partly;
use crate::fe::{FeError, FlankFlexibility, FlankFlexibilityInput, Resolution};
use crate::gear::{MemberId, Pair, fixtures};
use crate::watch::{Canceled, Watch};

fn small(teeth: u32, beta_deg: f64, side: MemberId, offsets: usize) -> FlankFlexibilityInput {
    let gear = fixtures::gear(teeth, 0.3);
    let (pair, _) = Pair::new(&fixtures::spec(3.0, 20.0, beta_deg, 24.0, gear, gear)).unwrap();
    let hold = pair.pinion.root_radius_m - 6e-3;
    FlankFlexibilityInput::new(&pair, side, hold, offsets, Resolution::Coarse)
}

fn solved(input: &FlankFlexibilityInput) -> FlankFlexibility {
    FlankFlexibility::new(input, Watch::none()).unwrap()
}

#[test]
fn influence_is_symmetric_and_positive() {
    let flank = solved(&small(20, 20.0, MemberId::Pinion, 0));
    let n = flank.nodes();
    let mut total = faer::Mat::<f64>::from_fn(n, n, |i, j| flank.total(0, i, j).unwrap());
    let largest = (0..n).map(|i| total[(i, i)]).fold(0.0, f64::max);
    for i in 0..n {
        for j in 0..i {
            assert!((total[(i, j)] - total[(j, i)]).abs() < 1e-12 * largest, "{i}, {j}");
        }
    }
    let positive = factor_partly(total.as_mut(), faer::Mat::zeros(0, 0).as_mut(), "influence", &mut |_| Ok(()));
    assert_eq!(positive, Ok(()));
}

#[test]
fn one_way_round_is_the_other_way_transposed() {
    let teeth = 12;
    let flank = solved(&small(teeth, 15.0, MemberId::Pinion, teeth as usize - 1));
    let n = flank.nodes();
    for m in 1..teeth as usize {
        let (ahead, behind) = (flank.bulk(m).unwrap(), flank.bulk(teeth as usize - m).unwrap());
        let largest = ahead.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        for a in 0..n {
            for b in 0..n {
                assert!((ahead[a * n + b] - behind[b * n + a]).abs() < 1e-10 * largest, "{m}: {a}, {b}");
            }
        }
    }
}

/// The two members of a 1:1 pair are mirror images: same teeth, opposite hand, the gear's flank seen from behind.
#[test]
fn equal_members_are_equal() {
    let (pinion, gear) = (solved(&small(16, 25.0, MemberId::Pinion, 1)), solved(&small(16, 25.0, MemberId::Gear, 1)));
    let n = pinion.nodes();
    let stations = pinion.stations_m().len();
    let mirrored = |k: usize| k - k % stations + stations - 1 - k % stations;
    for a in 0..n {
        for b in 0..n {
            let (one, other) =
                (pinion.bulk(0).unwrap()[a * n + b], gear.bulk(0).unwrap()[mirrored(a) * n + mirrored(b)]);
            assert!((one - other).abs() < 1e-8 * pinion.total(0, a, a).unwrap(), "{a}, {b}: {one:e}, {other:e}");
            let (ahead, behind) =
                (pinion.bulk(1).unwrap()[a * n + b], gear.bulk(1).unwrap()[mirrored(b) * n + mirrored(a)]);
            assert!((ahead - behind).abs() < 1e-8 * pinion.total(0, a, a).unwrap(), "{a}, {b}: {ahead:e}, {behind:e}");
        }
    }
}

#[test]
fn bytes_come_back_and_damage_is_noticed() {
    let flank = solved(&small(18, 0.0, MemberId::Gear, 1));
    let bytes = flank.to_bytes();
    assert_eq!(FlankFlexibility::from_bytes(&bytes).as_ref(), Ok(&flank));
    for at in [0, 4, 8, 12, 16, 40, bytes.len() / 2, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1;
        assert!(matches!(FlankFlexibility::from_bytes(&damaged), Err(FeError::Stored { .. })), "{at}");
    }
    for length in [0, 3, 19, 51, 60, bytes.len() - 8, bytes.len() - 1] {
        assert!(matches!(FlankFlexibility::from_bytes(&bytes[..length]), Err(FeError::Stored { .. })), "{length}");
    }
}

#[test]
fn results_do_not_depend_on_the_threads() {
    let input = small(30, 20.0, MemberId::Pinion, 2);
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let several = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
    assert_eq!(single.install(|| solved(&input)), several.install(|| solved(&input)));
}

#[test]
fn progress_is_reported_and_canceling_ends_the_work() {
    let seen = Mutex::new(Vec::new());
    let progress = |fraction: f64| seen.lock().unwrap().push(fraction);
    let input = small(16, 10.0, MemberId::Pinion, 1);
    assert!(FlankFlexibility::new(&input, Watch::new(&progress, &|| false)).is_ok());
    let seen = seen.into_inner().unwrap();
    assert!(seen.len() > 20 && seen.iter().all(|f| (0.0..=1.0).contains(f)));
    assert_eq!(seen.last(), Some(&1.0));
    for stop in [0, 3, seen.len() / 2, seen.len() - 2] {
        let left = std::sync::atomic::AtomicUsize::new(stop);
        let canceled = || {
            use std::sync::atomic::Ordering::Relaxed;
            left.fetch_update(Relaxed, Relaxed, |n| n.checked_sub(1)).is_err()
        };
        let result = FlankFlexibility::new(&input, Watch::new(&|_| {}, &canceled));
        assert_eq!(result, Err(FeError::Canceled(Canceled)), "after {stop}");
    }
}

/// The face-uniform bulk of a coarser mesh approaches that of a finer one.
#[test]
fn a_finer_mesh_changes_little() {
    let mean = |resolution| {
        let gear = fixtures::gear(20, 0.0);
        let (pair, _) = Pair::new(&fixtures::spec(3.0, 20.0, 20.0, 24.0, gear, gear)).unwrap();
        let hold = pair.pinion.root_radius_m - 9e-3;
        let flank = solved(&FlankFlexibilityInput::new(&pair, MemberId::Pinion, hold, 1, resolution));
        let n = flank.nodes();
        let stations = flank.stations_m();
        let last = stations.len() - 1;
        let profile = flank.profile_m().len();
        // Areas of the hats, so that all loads are the same uniform pressure.
        let weight = |k: usize| {
            let (i, j) = (k / (last + 1), k % (last + 1));
            let end = if i == 0 || i == profile - 1 { 0.5 } else { 1.0 };
            let width = 0.5 * (stations[(j + 1).min(last)] - stations[j.saturating_sub(1)]) / stations[last];
            end * width / (profile - 1) as f64
        };
        [0, 1].map(|offset| {
            let bulk = flank.bulk(offset).unwrap();
            (0..n)
                .flat_map(|a| (0..n).map(move |b| (a, b)))
                .map(|(a, b)| weight(a) * weight(b) * bulk[a * n + b])
                .sum::<f64>()
        })
    };
    let (coarse, medium) = (mean(Resolution::Coarse), mean(Resolution::Medium));
    for offset in 0..2 {
        let change = medium[offset] / coarse[offset] - 1.0;
        assert!((0.0..0.012).contains(&change), "offset {offset}: {change}");
    }
}
