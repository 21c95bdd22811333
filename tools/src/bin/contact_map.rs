//! The source's pair with the contact in the equations over torque and speed, unrelieved and relieved: the RMS of the
//! mesh acceleration as a map, and whether it is smooth.
//!
//! `scripts/tool contact_map [TORQUES SPEEDS]`
//!
//! Prints a coarse table of each map and the largest departures from smoothness: of ln RMS at a point from the mean of
//! its neighbours along the torque and the speed, and the regimes that occur. A jump of one point by itself would stand
//! out.

use herringbone_job::parse_value;
use herringbone_job::result::SweepPoint;
use herringbone_job::study::{self, CheckedJob, SolveContext};
use herringbone_tools::Failure;
use herringbone_tools::arguments::Arguments;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::Instant;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let (torques, speeds) = (arguments.number(0)?.unwrap_or(27), arguments.number(1)?.unwrap_or(116));
    for (name, relief_um) in [("unrelieved", 0.0), ("relieved, 15 um parabolic over 6 mm", 15.0)] {
        let mut value: Value = serde_json::from_str(include_str!("../../../examples/contact.json"))?;
        value["kind"] = json!("sweep");
        for gear in ["pinion", "gear"] {
            value["design"][gear]["tip_relief"] =
                json!({"amount_um": relief_um, "length_mm": 6.0, "shape": "parabolic"});
        }
        value["axes"] = json!([
            {"pointer": "/operation/pinion_torque_nm", "from": 10.0, "to": 4000.0, "points": torques, "spacing": "logarithmic"},
            {"pointer": "/operation/pinion_speed_rpm", "from": 500.0, "to": 12000.0, "points": speeds},
        ]);
        let job = parse_value(&value).and_then(CheckedJob::new).map_err(|e| format!("{e:?}"))?;
        let started = Instant::now();
        let outcome = study::solve(&job, &SolveContext::none())?;
        let seconds = started.elapsed().as_secs_f64();
        let points = outcome.result.sweep.ok_or("no sweep")?.points;
        report(name, &points, torques, speeds, seconds);
    }
    Ok(())
}

fn report(name: &str, points: &[SweepPoint], torques: usize, speeds: usize, seconds: f64) {
    println!("\n{name}: {} points in {seconds:.1} s", points.len());
    let value = |p: &SweepPoint| p.mesh_circumferential_acceleration_rms_m_s2.as_ref().map_or(f64::NAN, |r| r.left);
    let mut by_place: BTreeMap<(u64, u64), &SweepPoint> = BTreeMap::new();
    for p in points {
        by_place.insert((p.values[0].to_bits(), p.values[1].to_bits()), p);
    }
    let grid: Vec<&SweepPoint> = by_place.into_values().collect();
    let at = |t: usize, s: usize| grid[t * speeds + s];
    print!("{:>9}", "N m");
    let columns: Vec<usize> = (0..speeds).step_by(speeds.div_ceil(12)).collect();
    columns.iter().for_each(|&s| print!("{:>9.0}", at(0, s).values[1]));
    println!("  r/min; RMS in m/s2");
    for t in (0..torques).step_by(torques.div_ceil(9)) {
        print!("{:>9.1}", at(t, 0).values[0]);
        columns.iter().for_each(|&s| print!("{:>9.3}", value(at(t, s))));
        println!();
    }
    let log = |t: usize, s: usize| value(at(t, s)).ln();
    let mut worst = [(0.0f64, 0, 0); 2];
    for t in 0..torques {
        for s in 0..speeds {
            let along = [
                (t > 0 && t + 1 < torques).then(|| log(t, s) - 0.5 * (log(t - 1, s) + log(t + 1, s))),
                (s > 0 && s + 1 < speeds).then(|| log(t, s) - 0.5 * (log(t, s - 1) + log(t, s + 1))),
            ];
            for (worst, departure) in worst.iter_mut().zip(along) {
                if let Some(d) = departure.map(f64::abs).filter(|d| d.is_nan() || *d > worst.0) {
                    *worst = (d, t, s);
                }
            }
        }
    }
    for (along, (d, t, s)) in ["torque", "speed"].into_iter().zip(worst) {
        let p = at(t, s);
        println!(
            "largest departure of ln RMS from its neighbours along the {along}: {d:.3} at {:.1} N m, {:.0} r/min",
            p.values[0], p.values[1]
        );
    }
    let mut regimes: BTreeMap<String, usize> = BTreeMap::new();
    for p in &grid {
        let regime = p.regime.map(herringbone_job::result::RegimeResult::as_str).unwrap_or_default();
        let contact = p.contact.map(herringbone_job::result::ContactStateResult::as_str).unwrap_or_default();
        *regimes.entry(format!("{regime}, {contact}{}", p.error.as_deref().unwrap_or_default())).or_default() += 1;
    }
    println!("motions: {regimes:?}");
}
