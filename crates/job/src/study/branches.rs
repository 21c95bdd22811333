//! Branches of a continuation: jumps along a branch, and intervals in which the two directions find different motions.

use crate::document::Axis;
use crate::result::{BranchDifference, BranchDirection, Hysteresis, Jump, SweepPoint};

/// Relative difference of two RMS values above which two motions are different ones.
const DIFFERENT: f64 = 0.01;
/// The same if regime or contact differ too: smaller differences are those of motions on the border between two
/// regimes.
const DIFFERENT_WORDS: f64 = 1e-3;
/// Least relative change between neighbours that counts as a jump, and its least ratio to the adjacent changes.
const JUMP: f64 = 0.1;
const STANDS_OUT: f64 = 3.0;
/// Multiple of the sum of both errors below which a difference is not significant.
const ERRORS: f64 = 3.0;
/// RMS acceleration below which a motion counts as rest, m/s².
const STILL_M_S2: f64 = 1e-9;

/// Positions on an axis from its least value up, or from its greatest down.
pub(super) fn order(axis: &Axis, direction: BranchDirection) -> Vec<usize> {
    let values = axis.values();
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    if direction == BranchDirection::Down {
        order.reverse();
    }
    order
}

/// The jumps of a branch between neighbours; `line` in the order of the axis.
pub(super) fn jumps(
    axis: &Axis,
    direction: BranchDirection,
    second_axis_value: Option<f64>,
    line: &[SweepPoint],
) -> Vec<Jump> {
    let order = order(axis, direction);
    let changes: Vec<Option<f64>> = order.windows(2).map(|two| change(&line[two[0]], &line[two[1]])).collect();
    let mut jumps = Vec::new();
    for (at, two) in order.windows(2).enumerate() {
        let (before, after) = (&line[two[0]], &line[two[1]]);
        let beside = |other: Option<usize>| other.and_then(|i| *changes.get(i)?).unwrap_or(0.0);
        let usual = beside(at.checked_sub(1)).max(beside(Some(at + 1)));
        let (Some(change), Some(rms_before), Some(rms_after)) = (changes[at], rms(before), rms(after)) else {
            continue;
        };
        if change > JUMP.max(uncertainty(before, after)) && change > STANDS_OUT * usual {
            jumps.push(Jump {
                branch: direction,
                second_axis_value,
                from: axis.value(two[0]),
                to: axis.value(two[1]),
                rms_before_m_s2: rms_before,
                rms_after_m_s2: rms_after,
            });
        }
    }
    jumps
}

/// The intervals in which the branches of a line differ; both in the order of the axis.
pub(super) fn hysteresis(
    axis: &Axis,
    second_axis_value: Option<f64>,
    up: &[SweepPoint],
    down: &[SweepPoint],
) -> Vec<Hysteresis> {
    let mut intervals: Vec<Hysteresis> = Vec::new();
    let mut open = false;
    for at in order(axis, BranchDirection::Up) {
        let differ = differences(&up[at], &down[at]);
        if differ.is_empty() {
            open = false;
            continue;
        }
        let value = axis.value(at);
        if !open {
            let largest_rms_ratio = 1.0;
            intervals.push(Hysteresis {
                second_axis_value,
                from: value,
                to: value,
                differ: Vec::new(),
                largest_rms_ratio,
            });
        }
        open = true;
        if let Some(interval) = intervals.last_mut() {
            interval.to = value;
            let ratio = change(&up[at], &down[at]).map_or(1.0, f64::exp);
            interval.largest_rms_ratio = interval.largest_rms_ratio.max(ratio);
            for difference in differ {
                if !interval.differ.contains(&difference) {
                    interval.differ.push(difference);
                }
            }
        }
    }
    intervals
}

/// What differs between the motions of two points; nothing where one has no motion.
pub(super) fn differences(a: &SweepPoint, b: &SweepPoint) -> Vec<BranchDifference> {
    let Some(change) = change(a, b) else { return Vec::new() };
    let uncertain = uncertainty(a, b);
    let mut differ = Vec::new();
    if change > DIFFERENT.max(uncertain) {
        differ.push(BranchDifference::Rms);
    }
    if change > DIFFERENT_WORDS.max(uncertain) {
        if a.regime != b.regime {
            differ.push(BranchDifference::Regime);
        }
        if a.contact != b.contact {
            differ.push(BranchDifference::Contact);
        }
    }
    differ
}

fn uncertainty(a: &SweepPoint, b: &SweepPoint) -> f64 {
    ERRORS * (a.error_estimate.unwrap_or(0.0) + b.error_estimate.unwrap_or(0.0))
}

/// |ln| of the ratio of the mesh accelerations; `None` if one is unknown.
fn change(a: &SweepPoint, b: &SweepPoint) -> Option<f64> {
    let (a, b) = (rms(a)?, rms(b)?);
    Some(if a.max(b) < STILL_M_S2 { 0.0 } else { (a.max(STILL_M_S2) / b.max(STILL_M_S2)).ln().abs() })
}

/// RMS of the circumferential acceleration over both meshes.
fn rms(row: &SweepPoint) -> Option<f64> {
    let halves = row.mesh_circumferential_acceleration_rms_m_s2?;
    Some((0.5 * (halves.left * halves.left + halves.right * halves.right)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::AxisPoints;
    use crate::result::PerHalf;

    fn axis(values: &[f64]) -> Axis {
        Axis { pointer: "/x".into(), also: Vec::new(), points: AxisPoints::Values { values: values.to_vec() } }
    }

    fn line(rms: &[f64]) -> Vec<SweepPoint> {
        let solved = |rms: &f64| {
            let halves = PerHalf { left: *rms, right: *rms };
            let response = (*rms > 0.0).then_some(halves);
            SweepPoint {
                mesh_circumferential_acceleration_rms_m_s2: response,
                error_estimate: Some(1e-6),
                ..SweepPoint::default()
            }
        };
        rms.iter().map(solved).collect()
    }

    #[test]
    fn a_jump_stands_out_and_a_steep_slope_does_not() {
        let axis = axis(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let jumping = jumps(&axis, BranchDirection::Up, None, &line(&[10.0, 11.0, 12.0, 30.0, 29.0, 28.0]));
        assert_eq!(jumping.len(), 1);
        assert_eq!((jumping[0].from, jumping[0].to, jumping[0].rms_after_m_s2), (3.0, 4.0, 30.0));
        assert_eq!(jumps(&axis, BranchDirection::Up, None, &line(&[10.0, 13.0, 18.0, 26.0, 36.0, 48.0])), []);
        // Downwards the same place is met from above; a point without a response is no jump.
        let jumping = jumps(&axis, BranchDirection::Down, Some(7.0), &line(&[10.0, 11.0, 12.0, 30.0, 29.0, 28.0]));
        assert_eq!((jumping[0].from, jumping[0].to, jumping[0].second_axis_value), (4.0, 3.0, Some(7.0)));
        assert_eq!(jumps(&axis, BranchDirection::Up, None, &line(&[10.0, 11.0, 0.0, 30.0, 29.0, 28.0])), []);
    }

    #[test]
    fn branches_differ_where_their_motions_do() {
        let axis = axis(&[4.0, 3.0, 2.0, 1.0]);
        let (up, down) = (line(&[5.0, 5.0, 2.0, 1.0]), line(&[5.0, 10.0, 4.0, 1.001]));
        let intervals = hysteresis(&axis, None, &up, &down);
        assert_eq!(intervals.len(), 1);
        assert_eq!(
            (intervals[0].from, intervals[0].to, intervals[0].differ.as_slice()),
            (2.0, 3.0, [BranchDifference::Rms].as_slice())
        );
        assert!((intervals[0].largest_rms_ratio - 2.0).abs() < 1e-12);
        // Means of a finite record scatter by their errors.
        let mut noisy = up.clone();
        noisy[1].mesh_circumferential_acceleration_rms_m_s2 = Some(PerHalf { left: 5.2, right: 5.2 });
        noisy[1].error_estimate = Some(0.02);
        assert_eq!(hysteresis(&axis, None, &up, &noisy), []);
    }
}
