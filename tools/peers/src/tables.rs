//! Markdown tables of the results.

use std::fmt::Write;

use crate::case::ReferenceCase;
use crate::measure::{Ladder, PERIODS, error_periods};
use crate::methods::Origin;

/// Error at which times are compared.
const COMPARED: f64 = 1e-6;

/// Suffix of the name of a method that is restarted at the edges of the impact.
pub const RESTARTED: &str = ", restarted";

/// Ladders of a case; of methods that were run both ways the faster one at the compared error only.
pub fn better<'a>(case: &ReferenceCase, ladders: &'a [Ladder]) -> Vec<&'a Ladder> {
    let of_case = || ladders.iter().filter(|l| l.case == case.name);
    let time = |l: &Ladder| l.seconds_at(COMPARED).unwrap_or(f64::INFINITY);
    let other = |l: &Ladder| match l.name.strip_suffix(RESTARTED) {
        Some(straight) => of_case().find(|o| o.name == straight),
        None => of_case().find(|o| o.name.strip_suffix(RESTARTED) == Some(&l.name)),
    };
    // Of two that do not reach it, the restarted one.
    let keep = |l: &&Ladder| match other(l) {
        None => true,
        Some(o) if time(l) == time(o) => l.name.ends_with(RESTARTED),
        Some(o) => time(l) < time(o),
    };
    of_case().filter(keep).collect()
}

/// The fastest method at the compared error.
fn fastest<'a>(ladders: &[&'a Ladder], of: impl Fn(&Ladder) -> bool) -> Option<(&'a Ladder, f64)> {
    let times = ladders.iter().filter(|l| of(l)).filter_map(|l| l.seconds_at(COMPARED).map(|t| (*l, t)));
    times.min_by(|a, b| a.1.total_cmp(&b.1))
}

const OURS: &str = "herringbone Taylor";
const OURS_IN_LANES: &str = "herringbone Taylor, 8 in lanes";
const OURS_WITH_BOTH_HALVES: &str = "herringbone Taylor, 12 coordinates";

pub fn all(cases: &[ReferenceCase], ladders: &[Ladder]) -> String {
    let kept: Vec<Vec<&Ladder>> = cases.iter().map(|case| better(case, ladders)).collect();
    let mut out = format!(
        "Time per mesh period at a relative error of {COMPARED:.0e} (r: restarted at the edges of the impact):\n\n| method |"
    );
    for case in cases {
        let _ = write!(out, " {}, after {} periods |", case.name, error_periods(case));
    }
    let _ = writeln!(out, "\n|---|{}", "---|".repeat(cases.len()));
    let plain = |l: &Ladder| l.name.trim_end_matches(RESTARTED).to_owned();
    for name in kept[0].iter().map(|l| plain(l)) {
        let _ = write!(out, "| {name} |");
        for kept in &kept {
            let ladder = kept.iter().find(|l| plain(l) == name);
            let _ = match ladder.and_then(|l| l.seconds_at(COMPARED).map(|t| (l, t))) {
                Some((l, t)) => write!(out, " {}{} |", time(t), if l.name.ends_with(RESTARTED) { " r" } else { "" }),
                None => write!(out, " not reached |"),
            };
        }
        out.push('\n');
    }
    out.push_str("\nThat time over the time of herringbone Taylor:\n\n| |");
    for case in cases {
        let _ = write!(out, " {} |", case.name);
    }
    let _ = writeln!(out, "\n|---|{}", "---|".repeat(cases.len()));
    type Which = fn(&Ladder) -> bool;
    let ratios: [(&str, &str, Which); 6] = [
        ("heyoka, 8 side by side, ours in lanes", OURS_IN_LANES, |l| l.origin == Origin::Peer && l.points > 1),
        ("the best other program, one motion", OURS, |l| l.origin == Origin::Peer && l.points == 1),
        ("the best with all 24 states, ours with 12 coordinates", OURS_WITH_BOTH_HALVES, |l| {
            l.origin == Origin::Peer && !l.name.starts_with("heyoka")
        }),
        ("SciPy DOP853 as it is called", OURS, |l| l.name == "SciPy DOP853"),
        ("SciPy DOP853, restarted", OURS, |l| l.name.strip_suffix(RESTARTED) == Some("SciPy DOP853")),
        ("the best of SciPy", OURS, |l| l.origin == Origin::Scipy),
    ];
    for (what, ours, of) in ratios {
        let _ = write!(out, "| {what} |");
        for case in cases {
            let of_case: Vec<&Ladder> = ladders.iter().filter(|l| l.case == case.name).collect();
            let _ = match (fastest(&of_case, |l| l.name == ours), fastest(&of_case, of)) {
                (Some((_, own)), Some((peer, t))) => {
                    let digits = if t < 100.0 * own { 1 } else { 0 };
                    write!(out, " {:.digits$} ({}) |", t / own, plain(peer))
                }
                _ => write!(out, " not reached |"),
            };
        }
        out.push('\n');
    }
    out.push_str("\nEvery rung:\n");
    for case in cases {
        let _ = writeln!(
            out,
            "\n| case {}: method | tolerance | error after {} periods | error after {PERIODS} periods | time per mesh period |\n|---|---|---|---|---|",
            case.name,
            error_periods(case)
        );
        for ladder in ladders.iter().filter(|l| l.case == case.name) {
            for r in &ladder.rungs {
                let _ = writeln!(
                    out,
                    "| {} | {:.1e} | {:.1e} | {:.1e} | {} |",
                    ladder.name,
                    r.tolerance,
                    r.error,
                    r.late_error,
                    time(r.seconds)
                );
            }
        }
    }
    out
}

/// Three digits, in µs.
fn time(seconds: f64) -> String {
    let micro = seconds * 1e6;
    let digits = (2 - micro.log10().floor() as i32).clamp(0, 2) as usize;
    let rounded = format!("{micro:.digits$}");
    match rounded.split_once('.') {
        None if rounded.len() > 4 => format!("{} {} µs", &rounded[..rounded.len() - 3], &rounded[rounded.len() - 3..]),
        _ => format!("{rounded} µs"),
    }
}
