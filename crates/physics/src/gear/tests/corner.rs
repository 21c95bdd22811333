//! Corner contact against the tables of two independent derivations.

use crate::gear::fixtures::{close, gear, pair, source_pair, spec, undercut_pair, worked_pair};
use crate::gear::{CornerContact, Pair};
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::{check, check_worst};

/// Overrun with the given gap, by bisection.
fn at_gap(p: &Pair, gap_m: f64) -> CornerContact {
    let (mut lo, mut hi) = (0.0, 0.2 * p.base_pitch_m);
    for _ in 0..200 {
        let mid = 0.5 * (lo + hi);
        if p.mesh_in_corner_gap_m(mid).is_some_and(|gap| gap < gap_m) {
            lo = mid;
        } else {
            hi = mid;
        }
    }
    match p.mesh_in_corner(lo) {
        Some(corner) => corner,
        None => panic!("no corner contact"),
    }
}

/// Table 1 geometry at 2000 rpm: gap, turn of the gear, inclination, effective base radius, velocity.
#[test]
fn source_pair_table() {
    let p = pair(&source_pair(1.0));
    let speed = 2000.0 * std::f64::consts::PI / 30.0 * p.pinion.base_radius_m;
    for (gap_um, turn_deg, theta_deg, ratio, velocity) in [
        (5.0, 0.172, 2.533, 0.97635, 0.2607),
        (10.0, 0.246, 3.444, 0.96719, 0.3617),
        (20.0, 0.354, 4.650, 0.95453, 0.5013),
        (40.0, 0.508, 6.237, 0.93697, 0.6949),
    ] {
        let corner = at_gap(&p, gap_um * 1e-6);
        let topic = "Impact: corner contact, source pair at 2000 r/min";
        let of = |what: &str| format!("{what}, gap {gap_um} µm");
        let turn = corner.gear_turn_rad.to_degrees();
        check(topic, &of("turn of the gear before the path, deg"), turn, turn_deg, Absolute(5e-4));
        check(topic, &of("inclination θ, deg"), corner.theta_rad.to_degrees(), theta_deg, Absolute(5e-4));
        let actual = corner.gear_arm_m / p.gear.base_radius_m;
        check(topic, &of("r'_b2 / r_b2"), actual, ratio, Absolute(5e-6));
        check(topic, &of("impact velocity, m/s"), speed * (1.0 - actual), velocity, Absolute(5e-5));
    }
}

/// The worked example: z 17/44, m_n 6, helix 24.43 deg, normal pressure angle 20 deg, 3000 rpm.
#[test]
fn worked_example() {
    let p = pair(&worked_pair());
    let topic = "Geometry: worked example of the corner contact";
    check(topic, "centre distance, mm", p.center_distance_m * 1e3, 200.9957, Absolute(5e-5));
    let angle = p.working_pressure_angle_rad.to_degrees();
    check(topic, "working transverse pressure angle, deg", angle, 21.78965, Absolute(5e-6));
    check(topic, "base radius of the pinion, mm", p.pinion.base_radius_m * 1e3, 52.01307, Absolute(5e-6));
    check(topic, "base radius of the gear, mm", p.gear.base_radius_m * 1e3, 134.62206, Absolute(5e-6));
    check(topic, "tip radius of the gear, mm", p.gear.tip_radius_m * 1e3, 150.98051, Absolute(5e-6));
    check(topic, "transverse contact ratio", p.transverse_contact_ratio, 1.43124, Absolute(5e-6));
    let topic = "Impact: corner contact, worked example at 3000 r/min";
    let speed = 100.0 * std::f64::consts::PI * p.pinion.base_radius_m;
    for (gap_um, turn_rad, effective_mm, velocity_mm_s) in [
        (5.0, 0.00353, 131.8116, 341.13),
        (10.0, 0.00501, 130.6634, 480.50),
        (20.0, 0.00711, 129.0465, 676.76),
        (40.0, 0.01009, 126.7648, 953.71),
    ] {
        let corner = at_gap(&p, gap_um * 1e-6);
        let of = |what: &str| format!("{what}, gap {gap_um} µm");
        check(topic, &of("turn of the gear before the path, rad"), corner.gear_turn_rad, turn_rad, Absolute(5e-6));
        check(topic, &of("r'_b2, mm"), corner.gear_arm_m * 1e3, effective_mm, Absolute(5e-5));
        let velocity = speed * (1.0 - corner.gear_arm_m / p.gear.base_radius_m) * 1e3;
        check(topic, &of("impact velocity, mm/s"), velocity, velocity_mm_s, Absolute(5e-3));
    }
    let theta = at_gap(&p, 1e-5).theta_rad.to_degrees();
    check(topic, "inclination θ, deg, gap 10 µm", theta, 2.86237, Absolute(5e-6));
}

/// Near the path the gap is `kappa x² / 2` with `kappa = a sin(alpha_wt) rho_2A / (r_b2² rho_1A)`: 0.044969 / mm.
#[test]
fn starts_quadratically() {
    let p = pair(&worked_pair());
    let rho_1 = p.path_start_m;
    let rho_2 = p.line_of_action_m - rho_1;
    let kappa = p.line_of_action_m * rho_2 / (p.gear.base_radius_m.powi(2) * rho_1);
    let topic = "Impact: corner gap near the path of contact";
    check(topic, "curvature κ of the gap, 1/mm", kappa * 1e-3, 0.044969, Absolute(5e-7));
    let x = 1e-5;
    let gap = p.mesh_in_corner_gap_m(x).unwrap_or(f64::NAN);
    check(topic, "gap over κ x²/2 at x = 10 µm", gap / (0.5 * kappa * x * x), 1.0, Absolute(2e-3));
    close(p.mesh_in_corner_gap_m(0.0).unwrap_or(f64::NAN), 0.0, 1e-16);
}

/// The velocity the gap closes with is the derivative of the gap over time: `v_s = omega_1 r_b1 (1 - r'_b2 / r_b2)`.
#[test]
fn effective_radius_is_the_slope_of_the_gap() {
    let p = pair(&worked_pair());
    let errors = [2e-4, 5e-4, 1e-3].map(|x| {
        let h = 1e-7;
        let gap = |x| p.mesh_in_corner_gap_m(x).unwrap_or(f64::NAN);
        let slope = (gap(x + h) - gap(x - h)) / (2.0 * h);
        let corner = p.mesh_in_corner(x).unwrap_or(CornerContact { theta_rad: f64::NAN, ..at_gap(&p, 1e-6) });
        slope - (1.0 - corner.gear_arm_m / p.gear.base_radius_m)
    });
    check_worst(
        "Impact: corner gap near the path of contact",
        "closing speed against the slope of the gap",
        errors,
        1e-7,
    );
}

#[test]
fn mesh_out_mirrors_mesh_in() {
    let p = pair(&spec(4.0, 20.0, 12.0, 30.0, gear(31, 0.0), gear(31, 0.0)));
    let errors = [0.0, 1e-4, 1e-3, 2e-3].map(|x| {
        let (a, b) = (p.mesh_in_corner_gap_m(x), p.mesh_out_corner_gap_m(x));
        a.unwrap_or(f64::NAN) - b.unwrap_or(f64::NAN)
    });
    let topic = "Impact: corner gap near the path of contact";
    check_worst(topic, "mesh-out against mesh-in of equal gears, m", errors, 1e-15);
}

#[test]
fn no_flank_beyond_the_mates_tip() {
    let p = pair(&worked_pair());
    assert_eq!(p.mesh_in_corner_gap_m(0.5 * p.gear.base_radius_m), None);
}

/// Where undercut shortens the path, contact before it starts with the edge of the pinion's involute: the gap starts at
/// zero, grows without a step when the gear's tip takes over, and closes with the speed the arms give.
#[test]
fn undercut_edge_takes_the_tips_place() {
    let mut s = undercut_pair();
    s.gear.addendum = 0.82;
    s.pinion.teeth = 13;
    let p = pair(&s);
    assert!(p.path_start_m > p.line_of_action_m - p.gear.tip_roll_m() + 1e-6, "the path is not shortened");
    close(p.mesh_in_corner_gap_m(0.0).unwrap_or(f64::NAN), 0.0, 1e-15);
    let gap = |x: f64| p.mesh_in_corner_gap_m(x).unwrap_or(f64::NAN);
    let (ratio, h) = (f64::from(p.pinion.teeth) / f64::from(p.gear.teeth), 1e-8);
    let mut arms = std::collections::BTreeSet::new();
    for i in 1..400 {
        let x = 0.1 * p.base_pitch_m * f64::from(i) / 400.0;
        let Some(corner) = p.mesh_in_corner(x) else { panic!("no contact at {x}") };
        let closing = (corner.pinion_arm_m - corner.gear_arm_m * ratio) / p.pinion.base_radius_m;
        close((gap(x + h) - gap(x - h)) / (2.0 * h), closing, 0.02 * closing.abs() + 2e-6);
        arms.insert(corner.pinion_arm_m > p.pinion.base_radius_m);
    }
    assert_eq!(arms.len(), 2, "both kinds of contact should occur");
}
