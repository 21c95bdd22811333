//! Cost and error of the finite elements at every resolution, against the stored reference of a z 29/67 pair.
//!
//! `scripts/tool fe_validation [coarse] [medium] [standard] [fine]`; `RAYON_NUM_THREADS=1` for the time on one core.

use std::sync::Mutex;
use std::time::Instant;

use herringbone_physics::fe::{FlankFlexibility, FlankFlexibilityInput};
use herringbone_physics::gear::MemberId;
use herringbone_physics::watch::Watch;
use herringbone_tools::arguments::{Arguments, RESOLUTIONS};
use herringbone_tools::{Failure, reference};
use serde_json::Value;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map(|all| all.iter().filter_map(Value::as_f64).collect()).unwrap_or_default()
}

fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().map(|all| all.iter().map(numbers).collect()).unwrap_or_default()
}

/// Mean over hats of a row (area-weighted), as a load or a response.
fn face_uniform(flank: &FlankFlexibility, values: &dyn Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    let z = flank.stations_m();
    let last = z.len() - 1;
    let width = z[last];
    let weights: Vec<f64> = (0..=last).map(|j| 0.5 * (z[(j + 1).min(last)] - z[j.saturating_sub(1)]) / width).collect();
    let count = flank.rolls_m().len();
    (0..count)
        .map(|a| {
            (0..count)
                .map(|b| {
                    let mut sum = 0.0;
                    for (i, wi) in weights.iter().enumerate() {
                        for (j, wj) in weights.iter().enumerate() {
                            sum += wi * wj * values(a * z.len() + i, b * z.len() + j);
                        }
                    }
                    sum
                })
                .collect()
        })
        .collect()
}

/// Mean and largest relative error (percent) with signs of the mean, over entries chosen by `pick`.
fn compare(label: &str, got: &dyn Fn(usize, usize) -> f64, expected: &[Vec<f64>], pick: &dyn Fn(usize, usize) -> bool) {
    let (mut sum, mut worst, mut count) = (0.0, 0.0_f64, 0);
    for (i, row) in expected.iter().enumerate() {
        for (j, &e) in row.iter().enumerate() {
            if pick(i, j) {
                let error = got(i, j) / e - 1.0;
                sum += error;
                if error.abs() > worst.abs() {
                    worst = error;
                }
                count += 1;
            }
        }
    }
    println!(
        "    {label:32} mean {:+.3} %  worst {:+.3} %  ({count})",
        100.0 * sum / f64::from(count.max(1)),
        100.0 * worst
    );
}

fn main() -> Result<(), Failure> {
    let pair = reference::pair(&reference::spec());
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/fe_tooth_29_67.json"))?;
    let reference: Value = serde_json::from_str(&text)?;
    let arguments = Arguments::of_process();
    for (name, resolution) in RESOLUTIONS {
        if !arguments.choose(name) {
            continue;
        }
        for (member, side, hold) in [("pinion", MemberId::Pinion, 25e-3), ("gear", MemberId::Gear, 60e-3)] {
            let input = FlankFlexibilityInput::new(&pair, side, hold, 4, resolution);
            let start = Instant::now();
            let last = Mutex::new((start, 0.0_f64));
            let progress = |_: f64| {
                if let Ok(mut last) = last.lock() {
                    last.1 = last.1.max(last.0.elapsed().as_secs_f64());
                    last.0 = Instant::now();
                }
            };
            let flank = FlankFlexibility::new(&input, Watch::new(&progress, &|| false))?;
            let pause = last.lock().map(|last| last.1).unwrap_or(f64::NAN);
            println!(
                "{name} {member}: {:.2} s, {} x {} nodes, at most {:.0} ms between checkpoints",
                start.elapsed().as_secs_f64(),
                flank.rolls_m().len(),
                flank.stations_m().len(),
                1e3 * pause
            );
            report(&flank, &reference[member], side);
        }
    }
    Ok(())
}

fn report(flank: &FlankFlexibility, reference: &Value, side: MemberId) {
    let n = flank.nodes();
    let value = |offset: usize, a: usize, b: usize| 1e6 * flank.total(offset, a, b).unwrap_or(f64::NAN);
    let half = |a: usize, b: usize| 1e6 * flank.half_space()[a * n + b];
    // The reference's next tooth lies on the side of the loaded flank: ahead of the pinion's, behind the gear's.
    let neighbour = |offset: usize, a: usize, b: usize| match side {
        MemberId::Pinion => value(offset, a, b),
        MemberId::Gear => value(offset, b, a),
    };
    let face = &reference["face_uniform"];
    let stations = flank.stations_m().len();
    let scale = (flank.rolls_m().len() - 1) as f64 / 10.0;
    if scale == 1.0 && stations == 21 {
        let points: Vec<(usize, usize)> = reference["points"]
            .as_array()
            .map(|all| {
                all.iter()
                    .map(|p| {
                        (p["i_profile"].as_u64().unwrap_or(0) as usize, p["j_axial"].as_u64().unwrap_or(0) as usize)
                    })
                    .collect()
            })
            .unwrap_or_default();
        let node = |k: usize| points[k].0 * stations + points[k].1;
        let inside = |k: usize| (1..10).contains(&points[k].0) && (1..20).contains(&points[k].1);
        let total = rows(&reference["same_tooth_total_um_per_N"]);
        let of = |i: usize, j: usize| value(0, node(i), node(j));
        compare("total, interior, loaded point", &of, &total, &|i, j| i == j && inside(i));
        compare("total, interior, others", &of, &total, &|i, j| i != j && inside(i) && inside(j));
        compare("total, borders, loaded point", &of, &total, &|i, j| i == j && !inside(i));
        compare("total, all others", &of, &total, &|i, j| i != j && !(inside(i) && inside(j)));
        compare("half-space", &|i, j| half(node(i), node(j)), &rows(&reference["half_space_um_per_N"]), &|_, _| true);
        compare(
            "next tooth",
            &|i, j| neighbour(1, node(i), node(j)),
            &rows(&reference["next_tooth_um_per_N"]),
            &|_, _| true,
        );
        compare(
            "second next tooth",
            &|i, j| neighbour(2, node(i), node(j)),
            &rows(&reference["second_next_tooth_um_per_N"]),
            &|_, _| true,
        );
    }
    // Rows of hats: on a coarser grid the neighbouring rows of the reference make up a wider hat, but only inside.
    if scale == 1.0 {
        let total = face_uniform(flank, &|a, b| value(0, a, b));
        compare("face-uniform total", &|i, j| total[i][j], &rows(&face["total_um_per_N"]), &|_, _| true);
        let bulk = face_uniform(flank, &|a, b| value(0, a, b) - half(a, b));
        compare("face-uniform bulk", &|i, j| bulk[i][j], &rows(&face["bulk_um_per_N"]), &|_, _| true);
        let next = face_uniform(flank, &|a, b| neighbour(1, a, b));
        compare("face-uniform next tooth", &|i, j| next[i][j], &rows(&face["next_tooth_um_per_N"]), &|_, _| true);
    } else {
        // Hats of twice the width are sums of the reference's: quarter, half, quarter (half, half at the ends).
        let weights = |i: usize| -> Vec<(usize, f64)> {
            let middle = 2 * i;
            if i == 0 {
                vec![(0, 0.5), (1, 0.5)]
            } else if middle == 10 {
                vec![(9, 0.5), (10, 0.5)]
            } else {
                vec![(middle - 1, 0.25), (middle, 0.5), (middle + 1, 0.25)]
            }
        };
        let wide = |fine: &[Vec<f64>]| -> Vec<Vec<f64>> {
            (0..6)
                .map(|i| {
                    (0..6)
                        .map(|j| {
                            weights(i)
                                .iter()
                                .map(|(a, wa)| weights(j).iter().map(|(b, wb)| wa * wb * fine[*a][*b]).sum::<f64>())
                                .sum()
                        })
                        .collect()
                })
                .collect()
        };
        let total = face_uniform(flank, &|a, b| value(0, a, b));
        compare(
            "face-uniform total (wide hats)",
            &|i, j| total[i][j],
            &wide(&rows(&face["total_um_per_N"])),
            &|_, _| true,
        );
        let bulk = face_uniform(flank, &|a, b| value(0, a, b) - half(a, b));
        compare("face-uniform bulk (wide hats)", &|i, j| bulk[i][j], &wide(&rows(&face["bulk_um_per_N"])), &|_, _| {
            true
        });
        let next = face_uniform(flank, &|a, b| neighbour(1, a, b));
        compare(
            "face-uniform next (wide hats)",
            &|i, j| next[i][j],
            &wide(&rows(&face["next_tooth_um_per_N"])),
            &|_, _| true,
        );
    }
}
