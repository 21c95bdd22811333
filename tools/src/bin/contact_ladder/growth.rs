//! Growth of the computing time with the numbers of slices and positions.

use herringbone_physics::compliance::{Compliance, Settings};
use herringbone_physics::contact::HalfContact;
use herringbone_physics::gear::Half;

use crate::cases::Case;
use crate::rungs::{force_bt_n, settings, solve};
use crate::tables::seconds;
use herringbone_physics::watch::Watch;
use herringbone_tools::Failure;
use herringbone_tools::stopwatch::median_time;

/// Settings of one line of a table.
type Line = (usize, Settings);

/// Both tables, on one case.
pub(crate) fn tables(case: &Case) -> Result<(), Failure> {
    let settings = settings(case);
    let slices = [16, 32, 64, 128, 256].map(|n| (n, Settings { slices: Some(n), positions: Some(64), ..settings }));
    table(case, "slices", &slices)?;
    let positions = [16, 32, 64, 128, 256, 512].map(|n| (n, Settings { positions: Some(n), ..settings }));
    table(case, "positions", &positions)
}

fn table(case: &Case, what: &str, lines: &[Line]) -> Result<(), Failure> {
    println!("| {what} | contact points | compliance | contact | contact, per point and position | mean stiffness |");
    println!("|---|---|---|---|---|---|");
    let mut places = Vec::new();
    let mut answers = Vec::new();
    for (count, settings) in lines {
        let (compliance, compliance_s) = median_time(5, || Compliance::analytic(&case.pair, settings, Watch::none()));
        let compliance = compliance?;
        let (cycle, contact_s) = median_time(5, || solve(case, settings, &compliance));
        let points = HalfContact::new(&case.pair, Half::Left, &compliance, settings, Watch::none())
            .at(0.5, force_bt_n(case))?
            .points
            .len();
        let positions = settings.positions.unwrap_or(1);
        places.push([(*count as f64).ln(), contact_s.ln()]);
        answers.push((
            *count,
            points,
            compliance_s,
            contact_s,
            contact_s / (points * positions) as f64,
            cycle?.stiffness.mean,
        ));
    }
    let finest = answers.last().map_or(f64::NAN, |a| a.5);
    for (count, points, compliance_s, contact_s, each_s, mean) in &answers {
        println!(
            "| {count} | {points} | {} | {} | {} | {:+.3} % |",
            seconds(*compliance_s),
            seconds(*contact_s),
            seconds(*each_s),
            100.0 * (mean / finest - 1.0)
        );
    }
    let steps: Vec<String> =
        places.windows(2).map(|w| format!("{:.2}", (w[1][1] - w[0][1]) / (w[1][0] - w[0][0]))).collect();
    println!("\nexponent of the contact's time: {:.2} over all; step by step {}\n", slope(&places), steps.join(", "));
    Ok(())
}

/// Least squares.
fn slope(places: &[[f64; 2]]) -> f64 {
    let n = places.len() as f64;
    let mean = |axis: usize| places.iter().map(|p| p[axis]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let products: f64 = places.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    products / places.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>()
}
