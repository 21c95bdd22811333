//! Flank modifications and assembly errors as gaps.

use crate::gear::fixtures::{close, pair, worked_pair};
use crate::gear::{EndRelief, FlankModification, Half, PairSpec, ReliefShape, TipRelief};
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::check;

fn with(change: impl Fn(&mut PairSpec)) -> crate::gear::Pair {
    let mut spec = worked_pair();
    change(&mut spec);
    pair(&spec)
}

#[test]
fn unmodified_pair_has_no_gap() {
    let p = pair(&worked_pair());
    for half in Half::BOTH {
        close(p.initial_gap_m(half, p.path_start_m, 0.01), 0.0, 0.0);
    }
}

#[test]
fn tip_relief_counts_from_its_start_along_the_path() {
    for (shape, middle) in [(ReliefShape::Linear, 10e-6), (ReliefShape::Parabolic, 5e-6)] {
        let relief = TipRelief { amount_m: 20e-6, length_m: 4e-3, shape };
        let p = with(|spec| spec.pinion.flanks[1].tip_relief = relief);
        let gap = |x| p.initial_gap_m(Half::Right, x, 0.02);
        close(gap(p.path_end_m), 20e-6, 1e-18);
        close(gap(p.path_end_m - 2e-3), middle, 1e-17);
        close(gap(p.path_end_m - 4e-3), 0.0, 1e-17);
        close(gap(p.path_start_m), 0.0, 0.0);
        close(gap(p.path_end_m + 1e-3), 20e-6, 1e-18);
        close(p.initial_gap_m(Half::Left, p.path_end_m, 0.02), 0.0, 0.0);
        let p = with(|spec| spec.gear.flanks[0].tip_relief = relief);
        close(p.initial_gap_m(Half::Left, p.path_start_m + 2e-3, 0.02), middle, 1e-17);
    }
}

#[test]
fn crowning_slope_and_end_relief_over_the_width() {
    let flank = |f: FlankModification| with(|spec| spec.pinion.flanks[0] = f);
    let at = |p: &crate::gear::Pair, y| p.initial_gap_m(Half::Left, p.pitch_point_m(), y);
    let b = worked_pair().face_width_m;
    let crowned = flank(FlankModification { lead_crowning_m: 8e-6, ..FlankModification::NONE });
    close(at(&crowned, 0.0), 8e-6, 1e-20);
    close(at(&crowned, 0.5 * b), 0.0, 1e-20);
    close(at(&crowned, 0.75 * b), 2e-6, 1e-20);
    let sloped = flank(FlankModification { helix_slope_m: 8e-6, ..FlankModification::NONE });
    close(at(&sloped, 0.0), 0.0, 0.0);
    close(at(&sloped, b), 8e-6, 1e-20);
    let relieved = flank(FlankModification {
        end_relief: EndRelief { amount_m: 8e-6, length_m: 0.01 },
        ..FlankModification::NONE
    });
    for end in [0.0, b] {
        close(at(&relieved, end), 8e-6, 1e-20);
        close(at(&relieved, (end - 0.005).abs()), 2e-6, 1e-19);
        close(at(&relieved, (end - 0.01).abs()), 0.0, 1e-20);
    }
}

#[test]
fn in_plane_misalignment_is_one_line_through_both_halves() {
    let b = worked_pair().face_width_m;
    for f in [12e-6, -12e-6] {
        let p = with(|spec| spec.assembly.in_plane_misalignment_m = f);
        let gap = |half, y| p.initial_gap_m(half, p.pitch_point_m(), y);
        close(gap(Half::Left, b) - gap(Half::Left, 0.0), f, 1e-20);
        // Outwards on the right is the other way along the shaft.
        close(gap(Half::Right, b) - gap(Half::Right, 0.0), -f, 1e-20);
        for half in Half::BOTH {
            close(gap(half, 0.0).min(gap(half, b)), 0.0, 1e-20);
        }
    }
}

#[test]
fn apex_offset_opens_one_half() {
    let p = with(|spec| spec.assembly.apex_offset_m = 10e-6);
    let shift = 10e-6 * p.base_helix_angle_rad.tan();
    close(p.initial_gap_m(Half::Left, p.pitch_point_m(), 0.01), shift, 1e-20);
    close(p.initial_gap_m(Half::Right, p.pitch_point_m(), 0.01), 0.0, 0.0);
}

/// The second-order gap of an axis offset across the line of action, against the exact length of the crossed belt.
#[test]
fn out_of_plane_misalignment_is_second_order() {
    let p = with(|spec| spec.assembly.out_of_plane_misalignment_m = 1e-3);
    let (y, b) = (0.03, p.spec.face_width_m);
    let e = 1e-3 * (y + 0.5 * p.spec.gap_width_m) / b;
    let sum = p.pinion.base_radius_m + p.gear.base_radius_m;
    let t = p.line_of_action_m;
    let a = t.hypot(sum + e);
    let belt = (a * a - sum * sum).sqrt();
    let turned = ((sum + e) / t).atan() - (sum / a).asin();
    let exact = belt - t - sum * turned;
    let gap = p.initial_gap_m(Half::Left, p.pitch_point_m(), y);
    let topic = "Geometry: out-of-plane misalignment";
    check(topic, "gap over that of the exact crossed belt", gap / exact, 1.0, Absolute(0.02));
}
