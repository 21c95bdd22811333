//! Reduced trains: against the twelve equations, closed forms, and a direct solution in the frequency domain.

use std::sync::Arc;

use nalgebra::{Complex, DMatrix, DVector};

use super::contact_force::case as contact_case;
use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::response::{Analysis, ChannelId, Regime, Response, SolutionMethod, solve, solve_many};
use crate::watch::Watch;
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::{check, check_worst};

#[path = "../../../benches/train_cases.rs"]
pub(super) mod train_cases;

use train_cases::train_of;

const TOPIC: &str = "Dynamics: reduced trains";

fn start(name: &str) -> [f64; 24] {
    reference().cases[name].initial_state.as_slice().try_into().unwrap()
}

/// The pair as a train of its twelve degrees of freedom.
fn as_train(p: &Parameters) -> Parameters {
    Parameters { train: Some(Arc::new(train_of(p, 0, 0.0))), ..p.clone() }
}

/// The pair as a train with 28 further modes.
fn with_further_modes(p: &Parameters, gyroscopic: f64) -> Parameters {
    Parameters { train: Some(Arc::new(train_of(p, 28, gyroscopic))), ..p.clone() }
}

/// Differences of the displacements and velocities, relative to the largest of their kind (length or angle; rate).
fn differences(a: &[f64; 24], b: &[f64; 24]) -> Vec<f64> {
    let kind = |c: usize| usize::from(c % 3 == 2) + 2 * (c / 12);
    (0..24)
        .map(|c| {
            let largest = (0..24).filter(|k| kind(*k) == kind(c)).fold(0.0f64, |m, k| m.max(b[k].abs()));
            (a[c] - b[c]) / largest
        })
        .collect()
}

/// Variants of a case: as it is, staggered, without damping in the gap, torsionally coupled, an impact on all motions,
/// with a displacement excitation, supported axially.
fn variants(name: &str) -> Vec<(&'static str, Parameters)> {
    let p = parameters(name);
    let changed = |change: &dyn Fn(&mut Parameters)| {
        let mut q = p.clone();
        change(&mut q);
        q
    };
    vec![
        ("as it is", p.clone()),
        ("staggered", changed(&|q| q.halves[1].phase_shift_mesh_periods = 0.3)),
        ("no damping in the gap", changed(&|q| q.damping_in_gap = false)),
        (
            "coupled in torsion",
            changed(&|q| {
                q.couplings.pinion_torsion = Spring { stiffness: 2e6, damping: 20.0 };
                q.couplings.gear_torsion = Spring { stiffness: 8e6, damping: 50.0 };
                q.halves[1].phase_shift_mesh_periods = 0.2;
            }),
        ),
        ("impact on all motions", changed(&|q| q.impact_acts_on = ImpactActsOn::All)),
        (
            "displacement excitation",
            changed(&|q| {
                let harmonics = [(1.1e-6, 0.4), (0.3e-6, 2.0)];
                let harmonics = harmonics.map(|(amplitude, phase_rad)| Harmonic { amplitude, phase_rad });
                q.halves.iter_mut().for_each(|h| h.displacement_excitation = harmonics.to_vec());
            }),
        ),
        (
            "axial support",
            changed(&|q| q.halves.iter_mut().for_each(|h| h.pinion_axial = Spring::with_damping_ratio(1e8, 0.03, 6.0))),
        ),
    ]
}

#[test]
fn trajectories_are_those_of_the_twelve_equations() {
    for name in ["A", "B", "C"] {
        for (periods, limit) in [(1, 1e-10), (5, 1e-10), (20, 1e-9)] {
            // The chaotic motion of case B amplifies rounding.
            if name == "B" && periods > 5 {
                continue;
            }
            let (mut errors, mut coarse) = (Vec::new(), Vec::new());
            for (_, p) in variants(name) {
                let q = as_train(&p);
                let of = |p: &Parameters, integrator, tolerance| {
                    advance(p, &start(name), periods, integrator, tolerance, &Watch::none()).unwrap().state
                };
                let twelve = of(&p, Integrator::Taylor, 1e-14);
                errors.extend(differences(&of(&q, Integrator::Taylor, 1e-14), &twelve));
                if periods == 5 {
                    coarse.extend(differences(&of(&q, Integrator::RungeKutta, 1e-11), &twelve));
                }
            }
            let quantity =
                format!("case {name} and variants: states after {periods} mesh periods against twelve equations");
            check_worst(TOPIC, &quantity, errors, limit);
            if periods == 5 {
                check_worst(TOPIC, &format!("{quantity}, Runge–Kutta"), coarse, 1e-6);
            }
        }
    }
}

/// Solves in twelve coordinates also where six would do.
fn solve_in_twelve(p: &Parameters, analysis: &Analysis) -> Response {
    let mut p = p.clone();
    if p.is_symmetric() {
        p.halves[1].gear_mass_kg *= 1.0 + 1e-15;
    }
    assert!(!p.is_symmetric());
    solve(&p, analysis, &Watch::none()).unwrap()
}

#[test]
fn responses_are_those_of_the_twelve_equations() {
    let names = ["x_left", "a_x_right", "s_right", "v_theta_g_left", "f_n_left", "f_z_right", "tooth_force_right"];
    let (mut separated, mut compared) = (0, 0);
    for name in ["A", "C"] {
        let (mut values, mut all_multipliers, mut frequencies_hz) = (Vec::new(), Vec::new(), Vec::new());
        for (what, p) in variants(name) {
            let q = as_train(&p);
            let analysis = Analysis {
                accuracy: 1e-9,
                channels: names.iter().map(|n| ChannelId::parse(n).unwrap()).collect(),
                samples_per_mesh_period: 64,
                energy_balance: true,
                ..Analysis::default()
            };
            let (twelve, train) = (solve_in_twelve(&p, &analysis), solve(&q, &analysis, &Watch::none()).unwrap());
            let (a, b) = (&train.summary, &twelve.summary);
            assert_eq!((a.regime, a.period_mesh_periods, a.contact), (b.regime, b.period_mesh_periods, b.contact));
            separated += usize::from(a.contact_share.left < 1.0);
            if a.period_mesh_periods.is_none() {
                // A motion that does not repeat amplifies rounding: the means of its record agree within their scatter.
                let error = a.rms.mesh_circumferential_acceleration_m_s2.left
                    / b.rms.mesh_circumferential_acceleration_m_s2.left
                    - 1.0;
                let scatter = 5.0 * (a.error_estimate + b.error_estimate);
                println!("case {name}, {what}: {:?}, {error:.1e} of {scatter:.1e}", a.regime);
                assert!(error.abs() < scatter);
                continue;
            }
            compared += 1;
            let mut errors: Vec<f64> =
                b.rms.channels.iter().map(|(channel, rms)| a.rms.channels[channel] / rms - 1.0).collect();
            errors.extend([a.tooth_force.left.static_n / b.tooth_force.left.static_n - 1.0]);
            errors.extend([a.tooth_force.right.max_n / b.tooth_force.right.max_n - 1.0]);
            errors.extend([a.contact_share.left - b.contact_share.left]);
            values.extend(errors);
            for (one, other) in train.channels.iter().zip(&twelve.channels) {
                let size = other.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                // A motion of period n may be recorded from any of its n mesh periods.
                let from = |shift: usize| {
                    let shifted = one.values.iter().cycle().skip(64 * shift);
                    shifted.zip(&other.values).fold(0.0f64, |m, (a, b)| m.max((a - b).abs() / size))
                };
                let periods = one.values.len() / 64;
                let worst = (0..periods).map(from).fold(f64::INFINITY, f64::min);
                // Rigid rotations of both start at other angles.
                assert!(worst < 2e-7 || one.name.contains("theta"), "{name} {what} {}: {worst:.1e}", one.name);
            }
            let moduli = |r: &Response| {
                let all = r.summary.floquet_multipliers.clone().unwrap();
                let mut all: Vec<Complex<f64>> =
                    all.iter().map(|m| Complex::from_polar(m.modulus, m.angle_rad.abs())).collect();
                all.sort_by(|a, b| (b.norm(), b.re).partial_cmp(&(a.norm(), a.re)).unwrap());
                all
            };
            let (one, other) = (moduli(&train), moduli(&twelve));
            // A rigid-body mode that torsional springs couple is a coordinate among others in the twelve equations.
            let nearest = |m: &Complex<f64>| one.iter().fold(f64::INFINITY, |least, o| least.min((o - m).norm()));
            all_multipliers.extend(other.iter().filter(|m| m.norm() < 1.0 - 1e-6).map(nearest));
            assert!(a.energy_balance_residual.unwrap() < 1e-9, "{name} {what} {:?}", a.energy_balance_residual);
            assert_eq!(a.degrees_of_freedom, 12);
            let frequencies = NaturalModes::new(&q).unwrap().frequencies_hz;
            assert_eq!(a.natural_frequencies_hz, frequencies);
            frequencies_hz.extend(a.natural_frequencies_hz.iter().zip(&b.natural_frequencies_hz).map(|(a, b)| a - b));
        }
        let topic = format!("case {name} and variants against twelve equations");
        check_worst(TOPIC, &format!("{topic}: RMS values, forces, contact"), values, 1e-9);
        check_worst(TOPIC, &format!("{topic}: Floquet multipliers"), all_multipliers, 2e-9);
        check_worst(TOPIC, &format!("{topic}: natural frequencies, Hz"), frequencies_hz, 1e-9);
    }
    assert!(separated >= 6 && compared >= 12, "{separated} variants lose contact, {compared} of 14 are periodic");
}

/// Chaos over a short time, recorded: the same statistics and the same switches.
#[test]
fn an_integrated_record_is_that_of_the_twelve_equations() {
    for (name, periods) in [("B", 8), ("C", 60)] {
        let p = parameters(name);
        for integrator in [Integrator::Taylor, Integrator::RungeKutta] {
            let analysis = Analysis {
                method: SolutionMethod::Integrate { mesh_periods: periods, record_mesh_periods: periods },
                integrator,
                accuracy: 1e-10,
                initial_state: Some(start(name)),
                ..Analysis::default()
            };
            let (twelve, train) =
                (solve_in_twelve(&p, &analysis), solve(&as_train(&p), &analysis, &Watch::none()).unwrap());
            let limit = if integrator == Integrator::Taylor { 1e-9 } else { 1e-5 };
            let (a, b) = (&train.summary, &twelve.summary);
            let mut errors: Vec<f64> =
                b.rms.channels.iter().map(|(channel, rms)| a.rms.channels[channel] / rms - 1.0).collect();
            errors.extend([
                a.contact_share.left - b.contact_share.left,
                a.min_displacement_m / b.min_displacement_m - 1.0,
            ]);
            let quantity = format!("case {name}, {periods} periods recorded by {integrator:?}: RMS, contact");
            check_worst(TOPIC, &quantity, errors, limit);
        }
    }
}

/// Constant stiffness without backlash: the equations are linear, and the mesh forces, outputs and displacements at
/// each order of a displacement excitation follow from complex linear equations.
#[test]
fn a_linear_train_has_its_response_in_the_frequency_domain() {
    for (gyroscopic, cross) in [(0.0, 0.0), (0.03, 0.0), (0.03, 2e-3)] {
        let mut p = parameters("A");
        p.half_backlash_m = 0.0;
        let harmonics = [(1.0e-6, 0.3), (0.4e-6, 1.2), (0.2e-6, -2.0)]
            .map(|(amplitude, phase_rad)| Harmonic { amplitude, phase_rad });
        for h in &mut p.halves {
            h.impact = None;
            // Not the stiffness with which the train is closed.
            h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 7e8 };
            h.displacement_excitation = harmonics.to_vec();
        }
        p.halves[1].phase_shift_mesh_periods = 0.17;
        let mut closed = p.clone();
        closed.halves.iter_mut().for_each(|h| h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 });
        let mut train = train_of(&closed, 28, gyroscopic);
        let n = train.len();
        if cross > 0.0 {
            let l = &train.eigenvalues_rad2_s2;
            let skew = |r: usize, c: usize| {
                let size = cross * (l[r] * l[c]).sqrt() * ((r * 13 + c * 5) as f64 * 0.618).fract();
                if r < c { size } else { -0.7 * size }
            };
            train.cross_stiffness_per_s2 = Some((0..n * n).map(|at| skew(at / n, at % n)).collect());
        }
        let q = Parameters { train: Some(Arc::new(train.clone())), ..p.clone() };
        let f_n = ["f_n_left", "f_n_right"].map(|name| ChannelId::parse(name).unwrap());
        let analysis =
            Analysis { accuracy: 1e-10, channels: f_n.to_vec(), samples_per_mesh_period: 256, ..Analysis::default() };
        let response = solve(&q, &analysis, &Watch::none()).unwrap();
        assert_eq!((response.summary.regime, response.summary.degrees_of_freedom), (Regime::Period1, n as u32));
        let rows = train.mesh.each_ref().map(|row| DVector::from_row_slice(row));
        let mut errors = Vec::new();
        for (i, harmonic) in harmonics.iter().enumerate() {
            let omega = std::f64::consts::TAU * p.mesh_frequency_hz * (i + 1) as f64;
            let jw = Complex::new(0.0, omega);
            let mesh = [0, 1].map(|j| {
                let h = &p.halves[j];
                Complex::from(7e8) + jw * h.mesh_damping_n_s_per_m
            });
            let excitation = [0, 1].map(|j| {
                let shift = p.halves[j].phase_shift_mesh_periods * std::f64::consts::TAU * (i + 1) as f64;
                Complex::from_polar(harmonic.amplitude, harmonic.phase_rad - shift)
            });
            let cross = train.cross_stiffness_per_s2.as_ref();
            let system = DMatrix::from_fn(n, n, |r, c| {
                let mut value = jw * train.damping_per_s[r * n + c];
                value += cross.map_or(0.0, |k| k[r * n + c]);
                if r == c {
                    value += train.eigenvalues_rad2_s2[r] - omega * omega;
                }
                for j in 0..2 {
                    value += rows[j][r] * (mesh[j] - train.reference_stiffness_n_per_m[j]) * rows[j][c];
                }
                value
            });
            let load =
                DVector::from_fn(n, |r, _| (0..2).map(|j| rows[j][r] * mesh[j] * excitation[j]).sum::<Complex<f64>>());
            let motion = system.lu().solve(&load).unwrap();
            let along = |row: &[f64]| row.iter().zip(motion.iter()).map(|(a, b)| b * *a).sum::<Complex<f64>>();
            let found = |order: &crate::response::MeshOrder| Complex::from_polar(order.amplitude, order.phase_rad);
            let orders = response.tooth_force_orders.as_ref().unwrap();
            for (j, orders) in [&orders.left, &orders.right].into_iter().enumerate() {
                let expected = mesh[j] * (along(&train.mesh[j]) - excitation[j]);
                errors.push((found(&orders[i]) - expected).norm() / expected.norm());
            }
            let largest = response.outputs.iter().fold(0.0f64, |m, o| m.max(o.orders[i].amplitude));
            for (output, response) in train.outputs.iter().zip(&response.outputs) {
                let expected = along(&output.displacement) + jw * along(&output.velocity);
                errors.push((found(&response.orders[i]) - expected).norm() / largest);
                assert_eq!((&response.name, &response.unit), (&output.name, &output.unit));
            }
        }
        assert_eq!(errors.len(), 3 * 14);
        let quantity = format!(
            "forces at three orders of a displacement excitation, 40 modes, gyroscopic {gyroscopic}, cross stiffness {cross}"
        );
        check_worst(TOPIC, &quantity, errors, 1e-8);
        // Nothing but the excited orders, and the RMS is theirs.
        let output = &response.outputs[0];
        let power: f64 = output.orders.iter().map(|o| 0.5 * o.amplitude * o.amplitude).sum();
        check(
            TOPIC,
            &format!("RMS of a bearing force from its orders, {gyroscopic}, {cross}"),
            output.rms,
            power.sqrt(),
            Relative(1e-9),
        );
        assert!(output.orders[4].amplitude < 1e-9 * output.rms);
        // The mean force of the right bearing: statics.
        assert!(response.summary.tooth_force.left.static_n > 0.0);
    }
}

/// Tabulated contact force: states and steady motions of the twelve equations; with further modes the orbit by Newton's
/// method is the motion that is left after a long time.
#[test]
fn a_contact_force_acts_on_a_train_as_on_the_twelve_equations() {
    let (mut states, mut values) = (Vec::new(), Vec::new());
    for (load_nm, stagger) in [(400.0, 0.0), (400.0, 0.3), (4.0, 0.3)] {
        let (mut p, start) = contact_case(load_nm, 0.6e-6);
        p.halves[1].phase_shift_mesh_periods = stagger;
        let of = |p: &Parameters| advance(p, &start, 5, Integrator::Taylor, 1e-13, &Watch::none()).unwrap().state;
        states.extend(differences(&of(&as_train(&p)), &of(&p)));
        let analysis = Analysis { accuracy: 1e-9, ..Analysis::default() };
        let twelve = solve_in_twelve(&p, &analysis).summary;
        let train = solve(&as_train(&p), &analysis, &Watch::none()).unwrap().summary;
        assert_eq!((train.regime, train.contact), (twelve.regime, twelve.contact));
        if twelve.period_mesh_periods.is_some() {
            let channels = &twelve.rms.channels;
            values.extend(channels.iter().map(|(name, rms)| train.rms.channels[name] / rms - 1.0));
        }
    }
    assert!(values.len() >= 20, "{}", values.len());
    check_worst(TOPIC, "contact force: states after 5 mesh periods against twelve equations", states, 1e-9);
    check_worst(TOPIC, "contact force: RMS values against twelve equations", values, 1e-8);
    let (p, _) = contact_case(400.0, 0.6e-6);
    for gyroscopic in [0.0, 0.02] {
        let q = with_further_modes(&p, gyroscopic);
        let orbit = solve(&q, &Analysis::default(), &Watch::none()).unwrap().summary;
        assert_eq!((orbit.regime, orbit.method), (Regime::Period1, crate::response::AppliedMethod::Periodic));
        assert!(orbit.error_estimate < 1e-6 && orbit.floquet_modulus.unwrap() < 1.0, "{}", orbit.error_estimate);
        let method = SolutionMethod::Integrate { mesh_periods: 1200, record_mesh_periods: 2 };
        let late =
            solve(&q, &Analysis { method, accuracy: 1e-8, ..Analysis::default() }, &Watch::none()).unwrap().summary;
        let errors = late.rms.channels.iter().map(|(name, rms)| orbit.rms.channels[name] / rms - 1.0);
        let quantity =
            format!("contact force, 40 modes, gyroscopic {gyroscopic}: orbit against the motion after 1200 periods");
        check_worst(TOPIC, &quantity, errors, 1e-6);
    }
}

/// Two equal modes coupled by gyroscopic terms g and a cross stiffness k: with z = q_1 + i q_2 the motion is that of
/// z″ + (c − i g) z′ + (ω² − i k) z = 0, whose roots are the whirl frequencies and their damping.
#[test]
fn whirl_has_its_closed_form() {
    let (omega, g, c, k) = (2200.0f64, 900.0, 60.0, 8e4);
    let mut p = parameters("A");
    for h in &mut p.halves {
        h.impact = None;
        h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
    }
    p.half_backlash_m = 0.0;
    let mut train = train_of(&p, 0, 0.0);
    // Two further coordinates that the mesh does not move, whirling.
    let n = train.len();
    let m = n + 2;
    let mut damping = vec![0.0; m * m];
    let mut cross = vec![0.0; m * m];
    for r in 0..n {
        damping[r * m..r * m + n].copy_from_slice(&train.damping_per_s[r * n..(r + 1) * n]);
    }
    (damping[n * m + n], damping[(n + 1) * m + n + 1]) = (c, c);
    (damping[n * m + n + 1], damping[(n + 1) * m + n]) = (g, -g);
    (cross[n * m + n + 1], cross[(n + 1) * m + n]) = (k, -k);
    let longer = |row: &mut Vec<f64>| row.extend([0.0, 0.0]);
    train.eigenvalues_rad2_s2.extend([omega * omega; 2]);
    (train.damping_per_s, train.cross_stiffness_per_s2) = (damping, Some(cross));
    train.mesh.iter_mut().for_each(longer);
    train.displacements.iter_mut().for_each(longer);
    longer(&mut train.load_n);
    train.outputs.iter_mut().for_each(|o| {
        longer(&mut o.displacement);
        longer(&mut o.velocity);
    });
    let q = Parameters { train: Some(Arc::new(train)), ..p.clone() };
    let response = solve(&q, &Analysis { accuracy: 1e-9, ..Analysis::default() }, &Watch::none()).unwrap();
    let multipliers = response.summary.floquet_multipliers.unwrap();
    // μ² + (c − i g) μ + ω² − i k = 0 for z = q_1 + i q_2, as q_1″ = … − g q_2′ − k q_2.
    let b = Complex::new(c, -g);
    let root = (b * b - 4.0 * Complex::new(omega * omega, -k)).sqrt();
    for mu in [(-b + root) * 0.5, (-b - root) * 0.5] {
        let expected = (mu * p.mesh_period_s()).exp();
        let near = multipliers
            .iter()
            .map(|m| (Complex::from_polar(m.modulus, m.angle_rad) - expected).norm())
            .fold(f64::INFINITY, f64::min);
        let quantity = format!("multiplier of whirl at {:.1} Hz, distance", mu.im / std::f64::consts::TAU);
        check(TOPIC, &quantity, near, 0.0, Absolute(1e-9));
    }
}

/// All perturbations together against one after the other by Taylor series.
#[test]
fn perturbations_together_are_those_alone() {
    for (name, gyroscopic, gap) in [("A", 0.0, true), ("A", 0.05, true), ("C", 0.02, true), ("C", 0.02, false)] {
        let mut p = parameters(name);
        p.damping_in_gap = gap;
        let q = with_further_modes(&p, gyroscopic);
        let model = DynamicModel::<52>::new(&q).unwrap();
        let mut motion = Motion::new(&model, model.state_from(&start(name)), Integrator::Taylor, 1e-13, u64::MAX);
        for _ in 0..3 {
            motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        }
        let columns = Variation::unit_perturbations(&model);
        assert_eq!(columns.len(), 2 * model.active().count());
        for tolerance in [1e-6, 1e-9, 1e-13] {
            let mut motion = Motion::new(&model, motion.state, Integrator::Taylor, 1e-13, u64::MAX);
            let mut together = Variation::new(&model, columns.clone(), tolerance);
            let mut alone: Vec<_> =
                [0, 5, 17, 44, 61].map(|c| (c, Variation::new(&model, vec![columns[c]], 1e-14))).into();
            for _ in 0..2 {
                let mut all = Together(&mut together, &mut alone);
                motion.advance_period(&mut all, &Watch::none(), 0.0).unwrap();
            }
            let monodromy = together.monodromy();
            let active: Vec<usize> = model.active().collect();
            let n = active.len();
            let mut errors = Vec::new();
            for (c, variation) in &alone {
                let (x, v) = &variation.columns[0];
                let size = (0..n).fold(0.0f64, |m, r| m.max(x[active[r]].abs()).max(v[active[r]].abs()));
                for r in 0..n {
                    errors.push((monodromy[(r, *c)] - x[active[r]]) / size);
                    errors.push((monodromy[(r + n, *c)] - v[active[r]]) / size);
                }
            }
            let gap = if gap { "" } else { ", no damping in the gap" };
            let quantity =
                format!("40 modes, case {name}{gap}, gyroscopic {gyroscopic}: monodromy matrix at {tolerance:.0e}");
            check_worst(TOPIC, &quantity, errors, (30.0 * tolerance).max(1e-10));
        }
    }
}

struct Together<'a, 'm>(&'a mut Variation<'m, 52>, &'a mut Vec<(usize, Variation<'m, 52>)>);

impl Observer<52> for Together<'_, '_> {
    fn segment(&mut self, segment: &Segment<'_, 52>) {
        self.0.segment(segment);
        self.1.iter_mut().for_each(|(_, alone)| alone.segment(segment));
    }
}

/// The state of least energy from twelve displacements and velocities has exactly these; a larger set of displacements
/// than coordinates is met where it can be.
#[test]
fn a_start_has_the_twelve_displacements() {
    let case = parameters("C");
    let physical = advance(&case, &start("C"), 7, Integrator::Taylor, 1e-9, &Watch::none()).unwrap().state;
    let mut errors = Vec::new();
    for further in [0, 28, 80] {
        let p = parameters("C");
        let q = Parameters { train: Some(Arc::new(train_of(&p, further, 0.01))), ..p };
        let there_and_back = advance(&q, &physical, 0, Integrator::Taylor, 1e-9, &Watch::none()).unwrap();
        errors.extend(differences(&there_and_back.state, &physical));
        fn of<const D: usize>(q: &Parameters, physical: &[f64; 24]) -> [f64; 24] {
            let model = DynamicModel::<D>::new(q).unwrap();
            model.physical_state(&model.state_from(physical))
        }
        let through = match number_of_coordinates(&q, false) {
            52 => of::<52>(&q, &physical),
            76 => of::<76>(&q, &physical),
            _ => of::<100>(&q, &physical),
        };
        errors.extend(differences(&through, &physical));
    }
    check_worst(TOPIC, "displacements and velocities of the state of least energy", errors, 1e-9);
    // Of all states with these displacements it has the least energy: a displacement that keeps them adds energy.
    let p = parameters("C");
    let train = train_of(&p, 28, 0.0);
    let q = Parameters { train: Some(Arc::new(train.clone())), ..p };
    let model = DynamicModel::<52>::new(&q).unwrap();
    let state = model.state_from(&physical);
    let equations = model.train.as_ref().unwrap();
    let gradient = equations.stiffness_product(&state.x);
    let n = equations.elastic;
    let rows = DMatrix::from_fn(12, n + equations.rigid, |r, c| {
        equations.displacements[r][if c < n { c } else { 52 - MAX_RIGID_BODY_MODES + c - n }]
    });
    let gradient = DVector::from_fn(n + equations.rigid, |c, _| if c < n { gradient[c] } else { 0.0 });
    // The gradient of the energy is a combination of the rows.
    let fit = rows.transpose().svd(true, true).solve(&gradient, 1e-13).unwrap();
    let rest = (&gradient - rows.transpose() * fit).amax() / gradient.amax();
    check_worst(TOPIC, "gradient of the energy off the twelve displacements", [rest], 1e-8);
}

/// Order of convergence of both methods on 40 modes with gyroscopic terms, by halving fixed steps.
#[test]
fn fixed_steps_converge_with_their_order() {
    let mut p = parameters("A");
    p.halves.iter_mut().for_each(|h| h.impact = None);
    let q = with_further_modes(&p, 0.02);
    let model = DynamicModel::<52>::new(&q).unwrap();
    let from = model.state_from(&start("A"));
    let run = |motion: Motion<'_, 52>| {
        let mut motion = motion;
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        motion.state
    };
    let new = || Motion::new(&model, from, Integrator::Taylor, 1e-15, u64::MAX);
    let exact = run(new());
    let error = |state: MotionState<52>| (0..48).fold(0.0f64, |m, c| m.max((state.x[c] - exact.x[c]).abs()));
    for (order, parts) in [(6usize, 300.0), (10, 120.0)] {
        let at = |parts: f64| error(run(new().with_fixed_taylor(order, model.period_tau / parts)));
        let found = (at(parts) / at(2.0 * parts)).log2();
        // The displacements of a step have the order of the series, and their velocities one less.
        check(
            TOPIC,
            &format!("order of convergence, Taylor series of order {order}"),
            found,
            order as f64,
            Absolute(1.2),
        );
    }
    let at = |parts: f64| error(run(new().with_fixed_runge_kutta(model.period_tau / parts)));
    let found = (at(800.0) / at(1600.0)).log2();
    check(TOPIC, "order of convergence, Runge–Kutta", found, 4.0, Absolute(0.6));
}

/// Unloaded and without excitation: at rest with the flanks in touch, by every method; and not where it is held.
#[test]
fn an_unloaded_train_rests() {
    let mut p = parameters("C");
    p.halves.iter_mut().for_each(|h| (h.impact, h.pinion_torque_nm) = (None, 0.0));
    let q = with_further_modes(&p, 0.02);
    let integrate = SolutionMethod::Integrate { mesh_periods: 20, record_mesh_periods: 10 };
    let mut rests = Vec::new();
    for method in [SolutionMethod::Auto, SolutionMethod::Periodic, integrate] {
        let response = solve(&q, &Analysis { method, ..Analysis::default() }, &Watch::none()).unwrap();
        let s = response.summary;
        assert!(s.rms.channels.values().all(|rms| *rms < 1e-9), "{:?}", s.rms.channels);
        rests.push(s.min_displacement_m);
        assert_eq!((s.regime, s.dynamic_factor), (Regime::Period1, None));
    }
    let errors = rests.iter().map(|s| s / 2e-5 - 1.0);
    check_worst(TOPIC, "unloaded train at rest: s against half the backlash", errors, 1e-9);
    // A displacement excitation moves it.
    let mut moved = q.clone();
    moved.halves[0].displacement_excitation = vec![Harmonic { amplitude: 1e-6, phase_rad: 0.0 }];
    let method = SolutionMethod::Integrate { mesh_periods: 20, record_mesh_periods: 10 };
    let s = solve(&moved, &Analysis { method, ..Analysis::default() }, &Watch::none()).unwrap().summary;
    assert!(s.rms.mesh_circumferential_acceleration_m_s2.left > 1e-3);
}

/// Trains beside pairs, in one group: each as alone, to the last bit, from the end state of another too.
#[test]
fn many_points_with_trains_are_those_alone() {
    let p = parameters("C");
    let q = with_further_modes(&p, 0.02);
    let mut staggered = p.clone();
    staggered.halves[1].phase_shift_mesh_periods = 0.5;
    let points = [q.clone(), p.clone(), as_train(&staggered), staggered];
    let method = SolutionMethod::Integrate { mesh_periods: 30, record_mesh_periods: 10 };
    for method in [method, SolutionMethod::Auto] {
        let analysis = Analysis { method, ..Analysis::default() };
        let together = solve_many(&points, &analysis, &Watch::none()).unwrap();
        for (p, response) in points.iter().zip(&together) {
            assert_eq!(response, &solve(p, &analysis, &Watch::none()));
        }
        // From the twelve displacements and velocities at the end, and from all coordinates.
        let end = together[0].as_ref().unwrap();
        let next = Parameters { mesh_frequency_hz: 1.01 * q.mesh_frequency_hz, ..q.clone() };
        assert_eq!(end.final_modal_state.len(), 80);
        for modal in [None, Some(end.final_modal_state.clone())] {
            let continued =
                Analysis { initial_state: Some(end.final_state), initial_modal_state: modal, ..analysis.clone() };
            let response = solve(&next, &continued, &Watch::none()).unwrap();
            assert!(response.summary.rms.mesh_circumferential_acceleration_m_s2.left > 1.0);
        }
    }
    let starts = [start("C"); 4];
    let together = advance_many(&points, &starts, 3, 1e-9, &Watch::none()).unwrap();
    for (p, state) in points.iter().zip(together) {
        assert_eq!(state, advance(p, &starts[0], 3, Integrator::Taylor, 1e-9, &Watch::none()));
    }
}

/// A motion stopped and continued from all coordinates of the train is the motion without a stop.
#[test]
fn a_motion_goes_on_from_its_coordinates() {
    let q = with_further_modes(&parameters("C"), 0.02);
    let method = |mesh_periods| SolutionMethod::Integrate { mesh_periods, record_mesh_periods: 1 };
    let run = |mesh_periods, initial_modal_state| {
        let analysis =
            Analysis { method: method(mesh_periods), accuracy: 1e-11, initial_modal_state, ..Analysis::default() };
        solve(&q, &analysis, &Watch::none()).unwrap()
    };
    let stopped = run(4, Some(run(3, None).final_modal_state));
    let whole = run(7, None);
    let errors = differences(&stopped.final_state, &whole.final_state);
    check_worst(TOPIC, "motion stopped and continued from all coordinates", errors, 1e-9);
    let analysis = Analysis { initial_modal_state: Some(vec![0.0; 79]), ..Analysis::default() };
    assert!(matches!(solve(&q, &analysis, &Watch::none()), Err(DynamicsError::InvalidParameter { .. })));
}

#[test]
fn a_malformed_train_is_refused() {
    let p = parameters("A");
    let train = train_of(&p, 3, 0.0);
    assert_eq!(train.validate(), Ok(()));
    assert_eq!((train.len(), train.is_empty()), (15, false));
    let mut refused = 0;
    let mut refuse = |change: &dyn Fn(&mut ModalTrain)| {
        let mut bad = train.clone();
        change(&mut bad);
        let q = Parameters { train: Some(Arc::new(bad)), ..p.clone() };
        let error = solve(&q, &Analysis::default(), &Watch::none());
        assert!(matches!(error, Err(DynamicsError::InvalidParameter { .. })), "{refused}: {error:?}");
        refused += 1;
    };
    refuse(&|t| t.eigenvalues_rad2_s2.clear());
    refuse(&|t| t.eigenvalues_rad2_s2[4] = f64::NAN);
    refuse(&|t| t.eigenvalues_rad2_s2.fill(0.0));
    refuse(&|t| t.eigenvalues_rad2_s2[14] = -1e6);
    refuse(&|t| t.eigenvalues_rad2_s2[..5].fill(0.0));
    refuse(&|t| t.damping_per_s.truncate(3));
    refuse(&|t| t.damping_per_s[7] = f64::INFINITY);
    refuse(&|t| t.cross_stiffness_per_s2 = Some(vec![0.0; 7]));
    refuse(&|t| t.mesh[1].push(0.0));
    refuse(&|t| t.mesh[0].fill(0.0));
    refuse(&|t| t.reference_stiffness_n_per_m[0] = 0.0);
    refuse(&|t| t.load_n.clear());
    refuse(&|t| t.displacements[11][2] = f64::NAN);
    refuse(&|t| t.outputs[0].velocity = vec![1.0]);
    refuse(&|t| t.outputs[3].unit = "lbf".into());
    let long = train_of(&p, 97, 0.0);
    let q = Parameters { train: Some(Arc::new(long)), ..p.clone() };
    assert!(matches!(solve(&q, &Analysis::default(), &Watch::none()), Err(DynamicsError::InvalidParameter { .. })));
    assert_eq!(refused, 15);
}

/// Torques that do not balance accelerate the rigid-body mode.
#[test]
fn an_unbalanced_train_has_no_steady_state() {
    let p = parameters("A");
    let mut train = train_of(&p, 5, 0.0);
    let rigid = (0..train.len()).find(|&i| train.is_rigid_body_mode(i)).unwrap();
    train.load_n[rigid] += 1000.0;
    let q = Parameters { train: Some(Arc::new(train)), ..p };
    let refused = solve(&q, &Analysis::default(), &Watch::none());
    assert!(matches!(refused, Err(DynamicsError::Unbalanced { .. })), "{refused:?}");
}

/// A channel for every further quantity, by its name.
#[test]
fn outputs_are_channels() {
    let p = parameters("A");
    let train = train_of(&p, 5, 0.01);
    let q = Parameters { train: Some(Arc::new(train.clone())), ..p };
    let id = ChannelId::parse_with("bearing_2_y", Some(&train)).unwrap();
    assert_eq!(ChannelId::parse_with("bearing_2_y", None), None);
    assert_eq!(ChannelId::parse_with("s_left", Some(&train)), ChannelId::parse("s_left"));
    let analysis = Analysis { channels: vec![id], samples_per_mesh_period: 512, ..Analysis::default() };
    let response = solve(&q, &analysis, &Watch::none()).unwrap();
    let channel = &response.channels[0];
    assert_eq!((channel.name.as_str(), channel.unit.as_str(), channel.values.len()), ("bearing_2_y", "N", 512));
    let mean = channel.values.iter().sum::<f64>() / 512.0;
    let rms = (channel.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 512.0).sqrt();
    let output = &response.outputs[1];
    check(TOPIC, "mean of a bearing force, samples against integrals", output.mean, mean, Relative(1e-5));
    check(TOPIC, "RMS of a bearing force, samples against integrals", output.rms, rms, Relative(1e-4));
    let first: Complex<f64> = (0..512)
        .map(|i| Complex::from_polar(channel.values[i] / 256.0, -std::f64::consts::TAU * i as f64 / 512.0))
        .sum();
    check(
        TOPIC,
        "first order of a bearing force, samples against integrals",
        output.orders[0].amplitude,
        first.norm(),
        Relative(1e-4),
    );
    let phase = (output.orders[0].phase_rad - first.arg()).abs();
    check(TOPIC, "its phase, rad", phase, 0.0, Absolute(1e-4));
}
