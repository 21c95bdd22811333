//! The tooth form against a brute-force cutter envelope.

use crate::gear::fixtures::{close, gear, pair, spec, undercut_pair};
use crate::gear::{GearSpec, Member, PairSpec};
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::{check, check_worst};

const FORM: &str = "Geometry: tooth form";

/// Half angle of the space at radius `r_m` left by the rack, from its profile alone: the rack rolls, and every point of
/// the tooth circle is tested against it. The space reaches as far as the rack ever reached.
fn envelope_half_angle(spec: &PairSpec, side: &GearSpec, r_m: f64) -> f64 {
    let m = spec.normal_module_m;
    let cos_beta = spec.helix_angle_rad.cos();
    let (sin_n, cos_n) = spec.normal_pressure_angle_rad.sin_cos();
    let tan_n = spec.normal_pressure_angle_rad.tan();
    let r = 0.5 * f64::from(side.teeth) * m / cos_beta;
    let rho = side.fillet_radius * m;
    let datum = side.profile_shift * m;
    let (depth_centre, offset_centre) = (
        side.dedendum * m - rho,
        std::f64::consts::FRAC_PI_4 * m - side.dedendum * m * tan_n - rho * (1.0 - sin_n) / cos_n,
    );
    // Half width of the rack tooth (transverse) at a depth below the datum line; none below its tip.
    let half_width = |depth: f64| -> Option<f64> {
        if depth > side.dedendum * m {
            return None;
        }
        let straight = std::f64::consts::FRAC_PI_4 * m - depth * tan_n;
        let below = depth - depth_centre;
        let normal =
            if below > rho * sin_n { offset_centre + (rho * rho - below * below).max(0.0).sqrt() } else { straight };
        Some(normal / cos_beta)
    };
    // A point of the blank at polar angle theta from the space centre is at, in rack coordinates when rolled by phi:
    // along = r_m sin(theta - phi) + r phi, height above the axis r_m cos(theta - phi).
    let removed_margin = |theta: f64, phi: f64| -> f64 {
        let (sin, cos) = (theta - phi).sin_cos();
        let depth = r + datum - r_m * cos;
        let along = r_m * sin + r * phi;
        match half_width(depth) {
            Some(width) => width - along,
            None => f64::NEG_INFINITY,
        }
    };
    // The most the rack ever reaches past the point: sampled, then refined round the best sample.
    let most = |theta: f64| {
        let (mut centre, mut span, mut best) = (0.0, 1.2, f64::NEG_INFINITY);
        for _ in 0..9 {
            let start = centre;
            for i in -60..=60 {
                let phi = start + span * f64::from(i) / 60.0;
                let margin = removed_margin(theta, phi);
                if margin > best {
                    best = margin;
                    centre = phi;
                }
            }
            span /= 12.0;
        }
        best
    };
    let (mut lo, mut hi) = (0.0, std::f64::consts::PI / f64::from(side.teeth) * 1.5);
    for _ in 0..60 {
        let mid = 0.5 * (lo + hi);
        if most(mid) > 0.0 {
            lo = mid;
        } else {
            hi = mid;
        }
    }
    std::f64::consts::PI / f64::from(side.teeth) - lo
}

/// Differences of the half thickness (of the arc, in modules) between root and tip.
fn off_envelope(spec: &PairSpec, side: &GearSpec, member: &Member) -> Vec<f64> {
    let differences = (1..=24).map(|i| {
        let r = member.root_radius_m + (member.tip_radius_m - member.root_radius_m) * f64::from(i) / 24.5;
        (member.half_angle_rad(r) - envelope_half_angle(spec, side, r)) * r / spec.normal_module_m
    });
    differences.collect()
}

#[test]
fn equals_the_envelope_of_the_cutter() {
    for beta in [0.0, 20.0, 24.43] {
        let mut errors = Vec::new();
        for (z, x) in [(17, 0.1), (29, 0.0), (44, -0.3), (25, 0.6), (90, 1.1)] {
            let s = spec(5.0, 20.0, beta, 40.0, gear(z, x), gear(67, 0.0));
            errors.extend(off_envelope(&s, &s.pinion, &pair(&s).pinion));
        }
        let quantity = format!("half thickness against the cutter's envelope, helix {beta}°, five gears, modules");
        check_worst(FORM, &quantity, errors, 1e-9);
    }
}

#[test]
fn undercut_equals_the_envelope_of_the_cutter() {
    let s = undercut_pair();
    let p = pair(&s);
    assert!(p.pinion.is_undercut());
    assert!(p.pinion.root_form_radius_m > p.pinion.base_radius_m);
    let errors = off_envelope(&s, &s.pinion, &p.pinion);
    check_worst(FORM, "half thickness against the cutter's envelope, undercut, modules", errors, 1e-9);
}

#[test]
fn fillet_joins_the_involute() {
    let errors = [(17, 24.43), (29, 30.0), (67, 0.0), (300, 12.0)].map(|(z, beta)| {
        let p = pair(&spec(4.0, 20.0, beta, 40.0, gear(z, 0.0), gear(67, 0.0)));
        let r = p.pinion.root_form_radius_m;
        let (below, above) = (p.pinion.half_angle_rad(r * (1.0 - 1e-13)), p.pinion.half_angle_rad(r));
        close(p.pinion.half_angle_rad(p.pinion.root_radius_m), p.pinion.root_half_angle_rad(), 1e-9);
        below - above
    });
    check_worst(FORM, "step of the half angle between fillet and involute, rad", errors, 1e-12);
}

#[test]
fn form_diameter_is_that_of_iso_21771() {
    let p = pair(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), gear(44, 0.0)));
    let (sin_n, sin_t) = (20.0_f64.to_radians().sin(), p.transverse_pressure_angle_rad.sin());
    let b = 6e-3 * (1.25 + 0.38 * (sin_n - 1.0));
    let d = 2.0 * p.gear.reference_radius_m;
    let expected = (d * sin_t - 2.0 * b / sin_t).hypot(2.0 * p.gear.base_radius_m);
    let got = 2.0 * p.gear.root_form_radius_m;
    check(FORM, "root form diameter by ISO 21771, mm", got * 1e3, expected * 1e3, Absolute(1e-12));
}

#[test]
fn thickness_at_the_reference_circle() {
    let p = pair(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.2), gear(44, 0.0)));
    let expected = 6e-3 * (std::f64::consts::FRAC_PI_2 + 2.0 * 0.2 * 20.0_f64.to_radians().tan());
    let got = p.pinion.normal_thickness_m(p.pinion.reference_radius_m);
    check(FORM, "normal thickness at the reference circle, mm", got * 1e3, expected * 1e3, Absolute(1e-12));
}

#[test]
fn least_shift_without_undercut() {
    let x_min = |beta| pair(&spec(6.0, 20.0, beta, 55.0, gear(17, 0.1), gear(44, 0.0))).pinion.undercut_profile_shift;
    check(FORM, "least profile shift without undercut, z 17, spur", x_min(0.0), 0.00566, Absolute(5e-6));
    check(FORM, "least profile shift without undercut, z 17, helix 20°", x_min(20.0), -0.18004, Absolute(5e-6));
}

#[test]
fn solid_discs() {
    let p = pair(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), gear(44, 0.0)));
    // The inertias of the worked example's two steel discs of 55 mm each.
    let topic = "Geometry: inertia of solid discs, worked example";
    check(topic, "pinion, kg m²", p.pinion.inertia_kg_m2(), 0.013354, Absolute(5e-7));
    check(topic, "gear, kg m²", p.gear.inertia_kg_m2(), 0.599267, Absolute(5e-7));
}
