//! The impact against a worked example, its small-deflection limit, and its edge cases.

use super::*;
use crate::gear::fixtures::{close, gear, pair, source_pair, spec, worked_pair};
use crate::gear::{Half, Pair, ReliefShape, TipRelief};
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::{check, check_worst};
use std::f64::consts::PI;

/// The worked example: 3000 rpm, K L = 1.4e8 N/m, K (1 - L) = 1.12e9 N/m, steel discs of 2 x 55 mm.
fn worked_conditions() -> MeshInConditions {
    MeshInConditions {
        half: Half::Left,
        pinion_speed_rad_s: 100.0 * PI,
        inertia: Inertia { pinion_kg_m2: 0.013354, gear_kg_m2: 0.599267 },
        mesh_stiffness_n_per_m: 1.26e9,
        load_share: 1.0 / 9.0,
        base_pitch_error_m: 0.0,
    }
}

fn solved(p: &Pair, entry: &MeshInConditions, deflection_m: f64) -> MeshInImpact {
    match mesh_in(p, entry, |_| deflection_m) {
        Ok(impact) => impact,
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn worked_example() {
    let p = pair(&worked_pair());
    let impact = solved(&p, &worked_conditions(), 1e-5);
    let topic = "Impact: mesh-in impact, worked example";
    check(topic, "inclination θ, deg", impact.theta_rad.to_degrees(), 2.86237, Absolute(5e-6));
    check(topic, "equivalent mass, kg", impact.equivalent_mass_kg, 4.32750, Absolute(2e-4));
    check(topic, "force without the other pairs, N", impact.zhou2008_force_n, 11827.0, Absolute(0.2));
    check(topic, "force, N", impact.force_n, 11152.1, Absolute(0.2));
    check(topic, "duration by the energy balance, µs", impact.duration_s * 1e6, 585.8, Absolute(0.05));
    check(topic, "impact velocity, mm/s", impact.velocity_m_s * 1e3, 480.50, Absolute(5e-3));
    check(topic, "turn of the gear before the path, rad", impact.delta_phi2_rad, 0.00501, Absolute(5e-6));
    let effective = impact.effective_gear_base_radius_m * 1e3;
    check(topic, "r'_b2, mm", effective, 130.6634, Absolute(5e-5));
    close(impact.single_pair_stiffness_n_per_m, 1.4e8, 1.0);
    close(impact.other_pairs_stiffness_n_per_m, 1.12e9, 1.0);
    close(impact.lead_s, impact.overrun_m / (100.0 * PI * p.pinion.base_radius_m), 1e-18);
    let expected = 100.0 * (1.0 - 11152.1 / 11827.0);
    check(topic, "reduction by the other pairs' give, %", impact.reduction_percent, expected, Absolute(1e-3));
}

/// Velocities of the source pair at 2000 rpm.
#[test]
fn source_pair_velocities() {
    let p = pair(&source_pair(1.0));
    let entry = MeshInConditions { pinion_speed_rad_s: 2000.0 * PI / 30.0, ..worked_conditions() };
    for (deflection_um, velocity, theta_deg) in
        [(5.0, 0.2607, 2.533), (10.0, 0.3617, 3.444), (20.0, 0.5013, 4.650), (40.0, 0.6949, 6.237)]
    {
        let impact = solved(&p, &entry, deflection_um * 1e-6);
        let topic = "Impact: solved first contact, source pair at 2000 r/min";
        let of = |what: &str| format!("{what}, deflection {deflection_um} µm");
        check(topic, &of("impact velocity, m/s"), impact.velocity_m_s, velocity, Absolute(5e-5));
        check(topic, &of("inclination θ, deg"), impact.theta_rad.to_degrees(), theta_deg, Absolute(5e-4));
    }
}

/// Largest force and duration of the collision of two gears that turn freely about their axes and meet with a spring
/// between them, along a line of action with these arms (m) about both axes: integrated step by step (classical
/// Runge–Kutta), without the closed form.
fn collision(entry: &MeshInConditions, arms_m: [f64; 2], gear_speed_rad_s: f64, stiffness_n_per_m: f64) -> (f64, f64) {
    let inertia = [entry.inertia.pinion_kg_m2, entry.inertia.gear_kg_m2];
    // Angles and speeds of pinion and gear.
    let rate = |y: [f64; 4]| {
        let force = stiffness_n_per_m * (arms_m[0] * y[0] - arms_m[1] * y[1]);
        [y[2], y[3], -force * arms_m[0] / inertia[0], force * arms_m[1] / inertia[1]]
    };
    let step_s = 1e-8;
    let mut y = [0.0, 0.0, entry.pinion_speed_rad_s, gear_speed_rad_s];
    let (mut largest, mut before) = (0.0f64, 0.0);
    for i in 1..10_000_000 {
        let along = |k: [f64; 4], h: f64| std::array::from_fn(|j| y[j] + h * k[j]);
        let k1 = rate(y);
        let k2 = rate(along(k1, 0.5 * step_s));
        let k3 = rate(along(k2, 0.5 * step_s));
        let k4 = rate(along(k3, step_s));
        y = std::array::from_fn(|j| y[j] + step_s / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]));
        let force = stiffness_n_per_m * (arms_m[0] * y[0] - arms_m[1] * y[1]);
        if force <= 0.0 {
            return (largest, step_s * (f64::from(i) - force / (force - before)));
        }
        largest = largest.max(force);
        before = force;
    }
    panic!("the gears do not part")
}

/// Force and duration are those of a collision that is integrated step by step, with the other pairs in series and with
/// them rigid.
#[test]
fn the_force_is_that_of_an_integrated_collision() {
    let p = pair(&worked_pair());
    let errors = [0.01, 0.076, 0.5, 0.9].map(|share| {
        let entry = MeshInConditions { load_share: share, ..worked_conditions() };
        let impact = solved(&p, &entry, 1e-5);
        let arms_m = [p.pinion.base_radius_m, impact.effective_gear_base_radius_m];
        let gear_speed = entry.pinion_speed_rad_s * f64::from(p.pinion.teeth) / f64::from(p.gear.teeth);
        let single = entry.mesh_stiffness_n_per_m * share;
        let others = entry.mesh_stiffness_n_per_m * (1.0 - share) / impact.theta_rad.cos().powi(2);
        let (force, duration) = collision(&entry, arms_m, gear_speed, single * others / (single + others));
        let (rigid, _) = collision(&entry, arms_m, gear_speed, single);
        [impact.force_n / force - 1.0, impact.zhou2008_force_n / rigid - 1.0, impact.duration_s / duration - 1.0]
    });
    let topic = "Impact: balances and limits";
    check_worst(topic, "force against a collision integrated step by step", errors.map(|e| e[0]), 1e-6);
    check_worst(topic, "the same with the other pairs rigid", errors.map(|e| e[1]), 1e-6);
    check_worst(topic, "duration against the same collision", errors.map(|e| e[2]), 1e-6);
}

/// `v_s -> omega_1 r_b1 sqrt(2 kappa delta)` for small deflections.
#[test]
fn small_deflection_limit() {
    let p = pair(&worked_pair());
    let rho_1 = p.path_start_m;
    let kappa = p.line_of_action_m * (p.line_of_action_m - rho_1) / (p.gear.base_radius_m.powi(2) * rho_1);
    let errors = [1e-9, 1e-8, 1e-7].map(|delta| {
        let expected = 100.0 * PI * p.pinion.base_radius_m * (2.0 * kappa * delta).sqrt();
        let error = solved(&p, &worked_conditions(), delta).velocity_m_s / expected - 1.0;
        assert!(error.abs() < 0.006 * (delta / 1e-7).sqrt(), "{delta}: {error}");
        error
    });
    let quantity = "velocity against ω r_b1 √(2 κ δ), δ of 1 to 100 nm";
    check_worst("Impact: balances and limits", quantity, errors, 0.006);
}

#[test]
fn relief_delays_and_prevents_the_impact() {
    let relieved = |amount_m| {
        let mut spec = worked_pair();
        spec.gear.flanks[0].tip_relief = TipRelief { amount_m, length_m: 3e-3, shape: ReliefShape::Linear };
        pair(&spec)
    };
    let full = solved(&pair(&worked_pair()), &worked_conditions(), 4e-6);
    let less = solved(&relieved(6e-6), &worked_conditions(), 1e-5);
    // Six of ten micrometres are relieved: what is left is the impact of four.
    let topic = "Impact: balances and limits";
    check(
        topic,
        "6 µm of relief against 6 µm less deflection, forces",
        less.force_n / full.force_n,
        1.0,
        Absolute(1e-6),
    );
    let none = solved(&relieved(12e-6), &worked_conditions(), 1e-5);
    assert_eq!(none.force_n, 0.0);
    let reason = none.none_because;
    assert!(reason.is_some_and(|r| r.flank_gap_m > r.deflection_m), "{reason:?}");
    // The right half is not relieved.
    let right = solved(&relieved(12e-6), &MeshInConditions { half: Half::Right, ..worked_conditions() }, 1e-5);
    assert!(right.none_because.is_none());
}

#[test]
fn pitch_error_acts_as_deflection() {
    let p = pair(&worked_pair());
    let entry = MeshInConditions { base_pitch_error_m: 5e-6, ..worked_conditions() };
    let ratio = solved(&p, &entry, 5e-6).force_n / solved(&p, &worked_conditions(), 1e-5).force_n;
    let topic = "Impact: balances and limits";
    check(topic, "5 µm of pitch error against 5 µm more deflection, forces", ratio, 1.0, Absolute(1e-6));
}

/// A deflection that changes with the overrun is solved together with it.
#[test]
fn deflection_may_depend_on_the_overrun() -> Result<(), ImpactError> {
    let p = pair(&worked_pair());
    let law = |x: f64| 1e-5 * (1.0 + 0.2 * (x / 1e-4).sin());
    match first_contact(&p, Half::Left, 0.0, law)? {
        EntryContact::Early(contact) => {
            let error = contact.separation_m - law(contact.overrun_m);
            let topic = "Impact: balances and limits";
            check_worst(topic, "gap at first contact against a deflection that varies, m", [error], 1e-13);
            // Nothing touches further out.
            for i in 1..1000 {
                let x = contact.overrun_m * (1.0 + f64::from(i) * 1e-3);
                assert!(p.mesh_in_corner_gap_m(x).is_some_and(|gap| gap > law(x)));
            }
        }
        EntryContact::OnPath(none) => panic!("{none:?}"),
    }
    Ok(())
}

#[test]
fn standing_gears_and_unloaded_pairs_do_not_strike() {
    let p = pair(&worked_pair());
    let standing = solved(&p, &MeshInConditions { pinion_speed_rad_s: 0.0, ..worked_conditions() }, 1e-5);
    close(standing.force_n, 0.0, 0.0);
    let unloaded = solved(&p, &MeshInConditions { load_share: 0.0, ..worked_conditions() }, 1e-5);
    close(unloaded.force_n, 0.0, 0.0);
}

#[test]
fn refuses_what_has_no_meaning() {
    let p = pair(&worked_pair());
    let refused = |entry: MeshInConditions, deflection: f64| mesh_in(&p, &entry, |_| deflection).err();
    assert!(refused(MeshInConditions { load_share: 1.0, ..worked_conditions() }, 1e-5).is_some());
    assert!(refused(MeshInConditions { mesh_stiffness_n_per_m: 0.0, ..worked_conditions() }, 1e-5).is_some());
    assert!(matches!(refused(worked_conditions(), f64::NAN), Some(ImpactError::Deflection { .. })));
    assert!(matches!(refused(worked_conditions(), 0.1), Some(ImpactError::NoFlank { .. })));
}

/// Over a grid of pairs, deflections and shares: finite and ordered, or a typed error.
#[test]
fn finite_over_many_pairs() {
    let mut solved = 0;
    for z in [12, 17, 25, 60, 150] {
        for beta in [0.0, 12.0, 30.0] {
            for shift in [0.0, 0.3] {
                let spec = spec(4.0, 20.0, beta, 40.0, gear(z, shift), gear(71, 0.0));
                let Ok((p, _)) = Pair::new(&spec) else { continue };
                for (deflection, share) in [(1e-9, 0.9), (3e-6, 0.05), (4e-5, 0.001), (2e-4, 0.5)] {
                    let entry = MeshInConditions { load_share: share, ..worked_conditions() };
                    let Ok(impact) = mesh_in(&p, &entry, |_| deflection) else { continue };
                    solved += 1;
                    assert!(impact.force_n > 0.0 && impact.force_n < impact.zhou2008_force_n);
                    assert!(impact.velocity_m_s > 0.0 && impact.duration_s > 0.0 && impact.duration_s.is_finite());
                    assert!(impact.effective_gear_base_radius_m < p.gear.base_radius_m * (1.0 + 1e-12));
                }
            }
        }
    }
    assert!(solved > 60, "only {solved} solved");
}
