//! Stress test of the vibration with random pairs over and beyond all admissible ranges. Each must end within a bounded
//! time, in finite numbers or in an error that names its reason; where the response states an accuracy, an independent
//! integration of the reported motion must agree with it.
//!
//! `scripts/tool dynamics_stress [CASES [SEED [FIRST [usual|extreme|both [contact]]]]]`
//!
//! Two populations take turns: `usual` pairs (what an engineer would build, at speeds that are run) and `extreme` ones
//! (stiffness 1e3 … 1e13 N/m, damping ratios 0 … 2, backlash 0 … 1 mm, 1 … 100 000 r/min, mass and inertia ratios 1e-6
//! … 1e6, pulses 1e-6 … 1 mesh period long, torque of either sign or none). A case depends on seed and number alone: `1
//! SEED N` repeats it and prints its parameters. With `contact` the mesh forces are those of a loaded contact over
//! approach and phase (soft at the beginning, with a free position that varies), without impacts.

use std::collections::BTreeMap;

use herringbone_physics::dynamics::{
    ContactForce, Couplings, DynamicsError, FlankForce, HalfParameters, Harmonic, ImpactActsOn, ImpactExcitation,
    Integrator, Parameters, Spring, Stiffness, equivalent_mass_kg, mesh_damping_n_s_per_m,
};
use herringbone_physics::response::{Analysis, Response, SolutionMethod, solve};
use herringbone_physics::watch::Watch;
use herringbone_tools::Failure;
use herringbone_tools::arguments::Arguments;
use herringbone_tools::random::Random;
use herringbone_tools::stopwatch::Stopwatch;

/// Ranges of the parameters of a population.
struct Ranges {
    name: &'static str,
    mesh_n_per_m: (f64, f64),
    support_n_per_m: (f64, f64),
    damping_ratio: (f64, f64),
    half_backlash_m: (f64, f64),
    pinion_rpm: (f64, f64),
    pinion_mass_kg: (f64, f64),
    mass_ratio: (f64, f64),
    inertia_ratio: (f64, f64),
    torque_nm: (f64, f64),
    /// Impact over the static force.
    impact_ratio: (f64, f64),
    pulse_mesh_periods: (f64, f64),
}

const USUAL: Ranges = Ranges {
    name: "usual",
    mesh_n_per_m: (1e8, 5e9),
    support_n_per_m: (1e7, 3e9),
    damping_ratio: (0.01, 0.15),
    half_backlash_m: (1e-6, 2e-4),
    pinion_rpm: (100.0, 20e3),
    pinion_mass_kg: (1.0, 200.0),
    mass_ratio: (1.0, 30.0),
    inertia_ratio: (1.0, 300.0),
    torque_nm: (1.0, 2e4),
    impact_ratio: (0.01, 30.0),
    pulse_mesh_periods: (0.01, 0.3),
};

const EXTREME: Ranges = Ranges {
    name: "extreme",
    mesh_n_per_m: (1e3, 1e13),
    support_n_per_m: (1e3, 1e13),
    damping_ratio: (0.0, 2.0),
    half_backlash_m: (1e-9, 0.5e-3),
    pinion_rpm: (1.0, 100e3),
    pinion_mass_kg: (0.1, 1e3),
    mass_ratio: (1e-6, 1e6),
    inertia_ratio: (1e-6, 1e6),
    torque_nm: (1e-3, 1e6),
    impact_ratio: (1e-3, 1e2),
    pulse_mesh_periods: (1e-6, 1.0),
};

/// Parameters of a case and their description.
struct StressCase {
    parameters: Parameters,
    description: String,
}

fn case(r: &mut Random, of: &Ranges) -> StressCase {
    let log = |r: &mut Random, range: (f64, f64)| r.log(range.0, range.1);
    let teeth = r.between(10.0, 100.0).floor();
    let rpm = log(r, of.pinion_rpm);
    let pinion_radius_m = r.log(0.01, 1.0);
    let gear_radius_m = pinion_radius_m * r.log(0.5, 10.0);
    let helix_angle_rad = if r.chance(0.1) { 0.0 } else { r.between(0.0, 45f64.to_radians()) };
    let pinion_mass_kg = log(r, of.pinion_mass_kg);
    let gear_mass_kg = pinion_mass_kg * log(r, of.mass_ratio);
    let pinion_inertia_kg_m2 = pinion_mass_kg * pinion_radius_m * pinion_radius_m * r.log(0.3, 1.0);
    let gear_inertia_kg_m2 = pinion_inertia_kg_m2 * log(r, of.inertia_ratio);
    let mean_n_per_m = log(r, of.mesh_n_per_m);
    let zeta_mesh = if r.chance(0.05) { 0.0 } else { r.between(of.damping_ratio.0, of.damping_ratio.1) };
    let zeta = if r.chance(0.05) { 0.0 } else { r.between(of.damping_ratio.0, of.damping_ratio.1) };
    let half_backlash_m = if r.chance(0.1) { 0.0 } else { log(r, of.half_backlash_m) };
    let extreme = of.mass_ratio.0 < 1.0;
    let torque = log(r, of.torque_nm)
        * match r.unit() {
            u if u < if extreme { 0.15 } else { 0.03 } => 0.0,
            u if u < if extreme { 0.35 } else { 0.10 } => -1.0,
            _ => 1.0,
        };
    let count = r.between(0.0, 7.0) as usize;
    // A Fourier series that goes below zero is not refused, so it is tried too.
    let largest = if extreme { 0.6 } else { 0.4 / (count.max(1) as f64) };
    let harmonics: Vec<Harmonic> =
        (0..count).map(|_| Harmonic { amplitude: r.between(0.0, largest), phase_rad: r.between(-3.2, 3.2) }).collect();
    let fourier = Stiffness::Fourier { mean_n_per_m, harmonics };
    let (kind, mesh_stiffness) = match r.unit() {
        u if u < 0.15 => ("constant", Stiffness::Constant { mean_n_per_m }),
        u if u < 0.45 => {
            let n = r.log(4.0, 256.0) as usize;
            let values_n_per_m = (0..n).map(|i| fourier.at(i as f64 / n as f64).max(0.0)).collect();
            ("samples", Stiffness::Samples { values_n_per_m })
        }
        _ => ("Fourier", fourier),
    };
    let static_n = if torque == 0.0 { log(r, of.torque_nm) } else { torque.abs() } / pinion_radius_m;
    let impact = (!r.chance(0.1)).then(|| ImpactExcitation::HalfSine {
        force_n: static_n * log(r, of.impact_ratio) * if r.chance(0.1) { -1.0 } else { 1.0 },
        duration_mesh_periods: log(r, of.pulse_mesh_periods),
        start_mesh_periods: r.unit(),
    });
    let stagger = if r.chance(0.4) { r.unit() } else { 0.0 };
    let spring = |r: &mut Random, mass: f64| Spring::with_damping_ratio(log(r, of.support_n_per_m), zeta, mass);
    let m_e = equivalent_mass_kg(pinion_radius_m, pinion_inertia_kg_m2, gear_radius_m, gear_inertia_kg_m2);
    let half = HalfParameters {
        pinion_mass_kg,
        pinion_inertia_kg_m2,
        gear_mass_kg,
        gear_inertia_kg_m2,
        pinion_torque_nm: torque,
        pinion_lateral: spring(r, pinion_mass_kg),
        gear_lateral: spring(r, gear_mass_kg),
        pinion_axial: if r.chance(0.2) { spring(r, pinion_mass_kg) } else { Spring::default() },
        gear_axial: spring(r, gear_mass_kg),
        mesh_damping_n_s_per_m: mesh_damping_n_s_per_m(zeta_mesh, mesh_stiffness.mean_n_per_m(), m_e),
        contact_force: None,
        mesh_stiffness,
        impact,
        displacement_excitation: Vec::new(),
        phase_shift_mesh_periods: 0.0,
    };
    let torsional = |r: &mut Random, inertia: f64, radius: f64| {
        if r.chance(0.3) {
            Spring::with_damping_ratio(log(r, of.support_n_per_m) * radius * radius, zeta, inertia)
        } else {
            Spring::default()
        }
    };
    let couplings = Couplings {
        pinion_axial: spring(r, pinion_mass_kg),
        gear_axial: spring(r, gear_mass_kg),
        pinion_lateral: if r.chance(0.3) { spring(r, pinion_mass_kg) } else { Spring::default() },
        gear_lateral: if r.chance(0.3) { spring(r, gear_mass_kg) } else { Spring::default() },
        pinion_torsion: torsional(r, pinion_inertia_kg_m2, pinion_radius_m),
        gear_torsion: torsional(r, gear_inertia_kg_m2, gear_radius_m),
    };
    let mut right = half.clone();
    right.phase_shift_mesh_periods = stagger;
    if r.chance(0.1) {
        right.gear_mass_kg *= 1.01;
    }
    let damping_in_gap = r.chance(0.5);
    let mut parameters = Parameters {
        mesh_frequency_hz: rpm / 60.0 * teeth,
        pinion_radius_m,
        gear_radius_m,
        helix_angle_rad,
        half_backlash_m,
        damping_in_gap,
        impact_acts_on: ImpactActsOn::Torsion,
        halves: [half, right],
        couplings,
        train: None,
    };
    parameters.balance_axially();
    let description = format!(
        "{rpm:.3e} r/min, z {teeth}, k_m {mean_n_per_m:.2e} N/m ({kind}), zeta_m {zeta_mesh:.3}, zeta {zeta:.3}, b {half_backlash_m:.2e} m, T {torque:.2e} N m, \
         masses {pinion_mass_kg:.2e}/{gear_mass_kg:.2e} kg, inertias {pinion_inertia_kg_m2:.2e}/{gear_inertia_kg_m2:.2e} kg m2, stagger {stagger:.2}, \
         damping in gap {damping_in_gap}"
    );
    StressCase { parameters, description }
}

/// Puts contact forces in place of the stiffness: F = k(φ) e²/(e + c) beyond a free position that varies with the
/// phase, on knots and levels as a contact analysis leaves them.
fn with_contact(p: &mut Parameters, r: &mut Random, of: &Ranges) -> Result<(), DynamicsError> {
    let knots: Vec<f64> = {
        let n = r.between(8.0, 160.0) as usize;
        (0..n).map(|i| (i as f64 + r.between(0.05, 0.95)) / n as f64).collect()
    };
    let static_n = |h: &HalfParameters| (h.pinion_torque_nm.abs() / p.pinion_radius_m).max(of.torque_nm.0);
    let working_m = static_n(&p.halves[0]) / p.halves[0].mesh_stiffness.mean_n_per_m();
    let onset_m = if r.chance(0.3) { 0.0 } else { working_m * r.log(0.01, 3.0) };
    let free_m = if r.chance(0.3) { 0.0 } else { working_m * r.log(1e-3, 2.0) };
    let levels = r.between(4.0, 20.0) as usize;
    let top_m = working_m * r.between(2.0, 6.0);
    let level_m: Vec<f64> = (0..=levels).map(|i| top_m * (i as f64 / levels as f64).powf(1.4)).collect();
    let flank = |stiffness: &Stiffness, shift: f64| {
        let k = |phase: f64| stiffness.at(phase + shift).max(1e-3 * stiffness.mean_n_per_m());
        // Slopes over the phase by differences: continuous, as accurate as a table is.
        let per_phase = |phase: f64| (k(phase + 1e-4) - k(phase - 1e-4)) / 2e-4;
        let shape = |e: f64| match onset_m {
            0.0 => (e, 1.0),
            _ if e == 0.0 => (0.0, 0.0),
            c => (e * e / (e + c), e * (e + 2.0 * c) / (e + c).powi(2)),
        };
        let node = |e: f64, phase: f64| {
            let (f, slope) = shape(e);
            [k(phase) * f, k(phase) * slope, per_phase(phase) * f, per_phase(phase) * slope]
        };
        let turn = std::f64::consts::TAU;
        FlankForce {
            nodes: level_m.iter().map(|&e| knots.iter().map(|&phase| node(e, phase)).collect()).collect(),
            free_m: knots
                .iter()
                .map(|phase| [free_m * (turn * phase).cos(), -free_m * turn * (turn * phase).sin()])
                .collect(),
            level_m: level_m.clone(),
        }
    };
    let stiffness = p.halves[0].mesh_stiffness.clone();
    let force =
        std::sync::Arc::new(ContactForce::new(knots.clone(), [&flank(&stiffness, 0.0), &flank(&stiffness, r.unit())])?);
    for h in &mut p.halves {
        h.contact_force = Some(force.clone());
        h.impact = None;
    }
    p.balance_axially();
    Ok(())
}

/// Processor time after which a solve is canceled and counted as one that does not end, s.
const TIME_LIMIT_S: f64 = 60.0;
/// Requested accuracy.
const ACCURACY: f64 = 1e-6;

/// Regime and contact state, or the name of the error.
fn outcome(result: &Result<Response, DynamicsError>) -> String {
    match result {
        Ok(r) => format!(
            "{}, {}",
            serde_json::to_value(r.summary.regime).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default(),
            serde_json::to_value(r.summary.contact)
                .ok()
                .and_then(|v| v.as_str().map(str::to_owned))
                .unwrap_or_default()
        ),
        Err(DynamicsError::Canceled(_)) => "did not end".into(),
        Err(error) => {
            let text = format!("{error:?}");
            format!("error: {}", text.split([' ', '(', '{']).next().unwrap_or("?"))
        }
    }
}

/// Whether a response has numbers that are not finite.
fn not_finite(r: &Response) -> bool {
    let s = &r.summary;
    let mut numbers = s.rms.channels.values().chain(&s.dynamic_factor).chain([&s.min_displacement_m]);
    !numbers.all(|v| v.is_finite()) || !r.final_state.iter().all(|v| v.is_finite()) || s.error_estimate.is_nan()
}

/// The reported motion integrated once more from where it ended, by Runge–Kutta (by Taylor series where rounding makes
/// that too coarse): the largest difference of the RMS accelerations relative to the largest of them, beyond the
/// integration's own error. None where there is nothing to compare or the integration cannot be afforded.
fn independent(p: &Parameters, r: &Response) -> Option<f64> {
    let periods = r.summary.period_mesh_periods?;
    let analysis = Analysis {
        method: SolutionMethod::Integrate { mesh_periods: periods, record_mesh_periods: periods },
        accuracy: 1e-7,
        initial_state: Some(r.final_state),
        samples_per_mesh_period: 0,
        max_steps: 2_000_000,
        ..Analysis::default()
    };
    let by = |integrator| solve(p, &Analysis { integrator, ..analysis.clone() }, &Watch::none()).ok();
    let again = by(Integrator::RungeKutta)
        .filter(|r| r.summary.error_estimate < 1e-5)
        .or_else(|| by(Integrator::Taylor).filter(|r| r.summary.error_estimate < 1e-5))?;
    let of = |r: &Response| {
        let (m, a) =
            (r.summary.rms.mesh_circumferential_acceleration_m_s2, r.summary.rms.pinion_axial_acceleration_m_s2);
        [m.left, m.right, a.left, a.right]
    };
    let (a, b) = (of(r), of(&again));
    // Acceleration of the free mesh by the forces: far below it an acceleration is rounding.
    let possible = p.halves.iter().enumerate().fold(0.0f64, |m, (j, h)| {
        let impact_n = match h.impact {
            Some(ImpactExcitation::HalfSine { force_n, .. }) => force_n.abs(),
            _ => 0.0,
        };
        m.max((h.pinion_torque_nm.abs() / p.pinion_radius_m + impact_n) / p.equivalent_mass_kg(j))
    });
    let largest = a.iter().fold(0.0f64, |m, v| m.max(*v));
    if possible == 0.0 || largest < 1e-9 * possible {
        return None;
    }
    let own = again.summary.error_estimate;
    Some(a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs() / largest.max(f64::MIN_POSITIVE))) - own)
}

#[derive(Default)]
struct Table {
    counts: BTreeMap<String, (u32, f64)>,
    compared: u32,
    inaccurate: u32,
    wrong: u32,
    bad: u32,
    worst_s: f64,
    most_steps: u64,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let number = |place: usize, default: u64| arguments.number(place).map(|given| given.unwrap_or(default));
    let (requested, seed, first) = (number(0, 200)?, number(1, 1)?, number(2, 0)?);
    let only = arguments.word(3);
    let contact = arguments.word(4) == Some("contact");
    let mut tables: [Table; 2] = Default::default();
    let mut slowest: Vec<(f64, String)> = Vec::new();
    for number in first..first + requested {
        let population = (number % 2) as usize;
        let ranges = [&USUAL, &EXTREME][population];
        if only.is_some_and(|name| name != "both" && name != ranges.name) {
            continue;
        }
        let mut random = Random::new(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ number);
        let mut case = case(&mut random, ranges);
        if contact && let Err(error) = with_contact(&mut case.parameters, &mut random, ranges) {
            println!("case {number}: {error}");
            continue;
        }
        if requested == 1 {
            println!("{:#?}", case.parameters);
        }
        let stopwatch = Stopwatch::start();
        let canceled = || stopwatch.seconds() > TIME_LIMIT_S;
        let watch = Watch::new(&|_| {}, &canceled);
        let analysis = Analysis { accuracy: ACCURACY, samples_per_mesh_period: 0, ..Analysis::default() };
        let result = solve(&case.parameters, &analysis, &watch);
        let time_s = stopwatch.seconds();
        let table = &mut tables[population];
        let name = outcome(&result);
        let entry = table.counts.entry(name.clone()).or_default();
        *entry = (entry.0 + 1, entry.1.max(time_s));
        table.worst_s = table.worst_s.max(time_s);
        let line = format!("case {number} ({}): {name}, {time_s:.2} s: {}", ranges.name, case.description);
        let mut remarks = Vec::new();
        match &result {
            Ok(r) => {
                table.most_steps = table.most_steps.max(r.summary.counts.steps);
                if not_finite(r) {
                    table.bad += 1;
                    remarks.push(format!("NOT FINITE: {:?}", r.summary));
                }
                if r.summary.period_mesh_periods.is_some() {
                    if r.summary.error_estimate > ACCURACY {
                        table.inaccurate += 1;
                        remarks.push(format!("accuracy not reached: {:.1e}", r.summary.error_estimate));
                    }
                    if let Some(difference) = independent(&case.parameters, r) {
                        table.compared += 1;
                        if difference > r.summary.error_estimate + 1e-8 {
                            table.wrong += 1;
                            remarks.push(format!(
                                "DISAGREES: an independent integration differs by {difference:.1e} beyond its own error, estimate {:.1e}",
                                r.summary.error_estimate
                            ));
                        }
                    }
                }
                if requested == 1 {
                    println!("{:#?}", r.summary);
                }
            }
            Err(DynamicsError::Canceled(_)) => remarks.push("DID NOT END".into()),
            Err(error) if requested == 1 => println!("{error}"),
            Err(error @ DynamicsError::StepSizeTooSmall { .. } | error @ DynamicsError::Diverged { .. }) => {
                remarks.push(error.to_string());
            }
            Err(_) => {}
        }
        if !remarks.is_empty() {
            println!("{line}\n  {}", remarks.join("\n  "));
        }
        slowest.push((time_s, line));
    }
    for (table, ranges) in tables.iter().zip([&USUAL, &EXTREME]) {
        let total: u32 = table.counts.values().map(|c| c.0).sum();
        println!("\n{} pairs: {total}", ranges.name);
        println!("| outcome | cases | longest, s |\n|---|---|---|");
        for (name, (count, longest_s)) in &table.counts {
            println!("| {name} | {count} | {longest_s:.2} |");
        }
        println!(
            "longest {:.1} s; most steps {}; {} not finite; {} periodic answers compared, {} disagree; {} of an estimate above {ACCURACY:.0e}",
            table.worst_s, table.most_steps, table.bad, table.compared, table.wrong, table.inaccurate
        );
    }
    slowest.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("\nslowest:");
    for (_, line) in slowest.iter().take(8) {
        println!("  {line}");
    }
    Ok(())
}
