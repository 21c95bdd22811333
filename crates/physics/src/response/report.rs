//! Assembly of a response from a recorded motion.

use std::collections::BTreeMap;

use super::analysis::{
    Analysis, AppliedMethod, ContactState, Halves, Multiplier, OutputResponse, PoincarePoint, Regime, Response, Rms,
    RmsIntervals, Summary, ToothForce,
};
use super::channel::{Channel, ChannelId};
use super::confidence::rms_interval_95;
use super::poincare::PoincareSection;
use super::recorder::ChannelRecorder;
use crate::dynamics::{DynamicModel, LinearOutput, MotionState, NaturalModes, PER_HALF, Parameters, StepCounts};

/// Parameters, settings and natural modes of the analysis.
pub(super) struct ReportInput<'a> {
    pub p: &'a Parameters,
    pub analysis: &'a Analysis,
    pub modes: &'a NaturalModes,
}

/// Properties of the recorded motion that are not in its record.
pub(super) struct MotionAssessment {
    pub regime: Regime,
    pub period: Option<u64>,
    pub floquet: Option<f64>,
    /// Over the period of the motion, largest first.
    pub multipliers: Option<Vec<Multiplier>>,
    pub lyapunov: Option<f64>,
    pub method: AppliedMethod,
    pub error_estimate: f64,
    pub energy_residual: Option<f64>,
    /// Time of the first recorded value, s.
    pub t0_s: f64,
    pub counts: StepCounts,
}

/// Record of a motion without its channels.
pub(super) struct RecordedMotion<const D: usize> {
    pub recent: PoincareSection<D>,
    pub points: Vec<PoincarePoint>,
    pub last: MotionState<D>,
    pub counts: StepCounts,
    pub batch_error: f64,
    /// Mean squares of the accelerations of every response, by mesh period.
    pub mean_squares: Vec<(ChannelId, Vec<f64>)>,
}

/// Assembles the response.
pub(super) fn assemble_response<const D: usize>(
    input: &ReportInput<'_>,
    model: &DynamicModel<D>,
    mut recorder: ChannelRecorder<D>,
    record: RecordedMotion<D>,
    assessment: MotionAssessment,
) -> Response {
    let recorded = record.points.len() as u64;
    let last = record.last;
    let right = if D > PER_HALF { 1 } else { 0 };
    let rms_of = |id: ChannelId| recorder.accumulator(id).map_or(0.0, |g| g.mean_and_square().1.sqrt());
    let both = |id: fn(u8) -> ChannelId| Halves { left: rms_of(id(0)), right: rms_of(id(right)) };
    let mesh = both(ChannelId::mesh_acceleration);
    let axial = both(ChannelId::pinion_axial_acceleration);
    let train = input.p.train.as_deref();
    let name = |id: ChannelId| id.name_with(train);
    let mut channels: BTreeMap<String, f64> = recorder.all().map(|(id, g, _)| (name(id), g.finish().rms)).collect();
    for (half, m, a) in [(0, mesh.left, axial.left), (1, mesh.right, axial.right)] {
        channels.insert(ChannelId::mesh_acceleration(half).name(), m);
        channels.insert(ChannelId::pinion_axial_acceleration(half).name(), a);
    }
    let statistics = input
        .analysis
        .channels
        .iter()
        .filter_map(|id| recorder.accumulator(*id).map(|g| (name(*id), g.finish())))
        .collect();
    let mut min_displacement_m = f64::INFINITY;
    for half in solved_halves::<D>() {
        if let Some(s) = recorder.accumulator(ChannelId::s(half)) {
            min_displacement_m = min_displacement_m.min(s.finish().min);
        }
    }
    let tooth_force = |half: u8| {
        let static_n = model.halves[usize::from(half)].load / model.cos;
        let (max_n, min_n) = recorder.accumulator(ChannelId::tooth_force(half)).map_or((static_n, static_n), |f| {
            let f = f.finish();
            (f.max, f.min)
        });
        ToothForce { static_n, max_n, min_n }
    };
    let tooth_force = Halves { left: tooth_force(0), right: tooth_force(right) };
    let shares = recorder.contact_shares();
    let output = |(id, output): (ChannelId, &LinearOutput)| {
        let statistics = recorder.accumulator(id)?.finish();
        Some(OutputResponse {
            name: output.name.clone(),
            unit: output.unit.clone(),
            mean: statistics.mean,
            rms: statistics.rms,
            orders: recorder.orders(id)?,
        })
    };
    let outputs = train
        .map_or_else(Vec::new, |train| ChannelId::outputs_of(train).zip(&train.outputs).filter_map(output).collect());
    let orders = |half: u8| recorder.orders(ChannelId::tooth_force(half));
    let tooth_force_orders = orders(0).zip(orders(1)).map(|(left, right)| Halves { left, right });
    let dt_s = input.p.mesh_period_s() / input.analysis.samples_per_mesh_period.max(1) as f64;
    let mut samples = recorder.take_samples();
    let series = input
        .analysis
        .channels
        .iter()
        .filter_map(|id| {
            let at = samples.iter().position(|(other, _)| other == id)?;
            let (id, values) = samples.swap_remove(at);
            let quantity = id.quantity_with(train);
            Some(Channel {
                name: name(id),
                quantity,
                unit: quantity.unit().into(),
                t0_s: assessment.t0_s,
                dt_s,
                values,
            })
        })
        .collect();
    let final_state = model.physical_state(&last);
    let final_modal_state = model.modal_state(&last);
    let interval = |id: ChannelId| {
        let (_, squares) = record.mean_squares.iter().find(|(other, _)| *other == id)?;
        rms_interval_95(squares)
    };
    let intervals = |id: fn(u8) -> ChannelId| Some(Halves { left: interval(id(0))?, right: interval(id(right))? });
    let rms_interval_95 = || {
        Some(RmsIntervals {
            mesh_circumferential_acceleration_m_s2: intervals(ChannelId::mesh_acceleration)?,
            pinion_axial_acceleration_m_s2: intervals(ChannelId::pinion_axial_acceleration)?,
        })
    };
    let summary = Summary {
        rms: Rms { mesh_circumferential_acceleration_m_s2: mesh, pinion_axial_acceleration_m_s2: axial, channels },
        statistics,
        dynamic_factor: dynamic_factor(&tooth_force),
        tooth_force,
        regime: assessment.regime,
        period_mesh_periods: assessment.period,
        contact: contact_state(&shares),
        contact_share: Halves { left: 1.0 - shares[0][1], right: 1.0 - shares[1][1] },
        min_displacement_m,
        natural_frequencies_hz: input.modes.frequencies_hz.clone(),
        error_estimate: assessment.error_estimate,
        method: assessment.method,
        floquet_modulus: assessment.floquet,
        floquet_multipliers: assessment.multipliers,
        lyapunov_per_mesh_period: assessment.lyapunov,
        rms_interval_95: if matches!(assessment.regime, Regime::QuasiPeriodic | Regime::Chaotic) {
            rms_interval_95()
        } else {
            None
        },
        energy_balance_residual: assessment.energy_residual,
        recorded_mesh_periods: recorded,
        degrees_of_freedom: model.degrees_of_freedom() as u32,
        damping_in_gap: input.p.damping_in_gap,
        counts: assessment.counts,
    };
    Response {
        summary,
        channels: series,
        outputs,
        tooth_force_orders,
        poincare: record.points,
        final_state,
        final_modal_state,
    }
}

/// Largest tooth force of a half over its static one, see [`Summary::dynamic_factor`].
fn dynamic_factor(tooth_force: &Halves<ToothForce>) -> Option<f64> {
    let of = |f: ToothForce| (f.static_n != 0.0).then(|| f.max_n.abs().max(f.min_n.abs()) / f.static_n.abs());
    [tooth_force.left, tooth_force.right].into_iter().filter_map(of).reduce(f64::max).map(|factor| factor.max(1.0))
}

/// Indices of the solved halves: the left one alone when the other is its mirror image.
pub(super) fn solved_halves<const D: usize>() -> std::ops::Range<u8> {
    0..crate::dynamics::solved_halves(D) as u8
}

fn contact_state(shares: &[[f64; 3]; 2]) -> ContactState {
    let touched = |j: usize, side: usize| shares[j][side] > 0.0;
    if (0..2).all(|j| !touched(j, 0) && !touched(j, 2)) {
        ContactState::Apart
    } else if (0..2).any(|j| touched(j, 0) && touched(j, 2)) {
        ContactState::DoubleSided
    } else if (0..2).any(|j| touched(j, 1)) {
        ContactState::SingleSided
    } else {
        ContactState::Continuous
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::reference::parameters;
    use crate::dynamics::{ImpactActsOn, ImpactExcitation, Integrator, Spring};
    use crate::response::{SolutionMethod, solve};
    use crate::watch::Watch;
    use herringbone_oracle::Tolerance::Relative;
    use herringbone_oracle::{check, check_worst};

    fn multipliers(p: &Parameters) -> Vec<Multiplier> {
        let analysis = Analysis { accuracy: 1e-9, ..Analysis::default() };
        solve(p, &analysis, &Watch::none()).unwrap().summary.floquet_multipliers.unwrap()
    }

    /// Liouville's formula: the product of all multipliers is exp(−T tr(M⁻¹ C)). The undamped screw mode has the
    /// multiplier 1 and is left out.
    #[test]
    fn the_product_of_the_multipliers_is_that_of_the_dampers() {
        for (case, periods) in [("A", 1.0), ("C", 2.0)] {
            let p = parameters(case);
            let (sin, cos) = p.helix_angle_rad.sin_cos();
            let rate: f64 = (0..2)
                .map(|j| {
                    let h = &p.halves[j];
                    let lateral = 1.0 / h.pinion_mass_kg + 1.0 / h.gear_mass_kg;
                    let mesh = cos * cos * (lateral + 1.0 / p.equivalent_mass_kg(j)) + sin * sin * lateral;
                    h.mesh_damping_n_s_per_m * mesh
                        + (h.pinion_lateral.damping + h.pinion_axial.damping + p.couplings.pinion_axial.damping)
                            / h.pinion_mass_kg
                        + (h.gear_lateral.damping + h.gear_axial.damping + p.couplings.gear_axial.damping)
                            / h.gear_mass_kg
                })
                .sum();
            let expected = -rate * periods * p.mesh_period_s();
            let found = multipliers(&p);
            assert_eq!(found.len(), 18);
            let got: f64 = found.iter().map(|m| m.modulus.ln()).sum();
            let quantity = format!("case {case}, logarithm of the product of all multipliers");
            check("Response: regime", &quantity, got, expected, Relative(1e-6));
        }
    }

    /// Reference motions at other speeds, loads and pulses, staggered, with an impact on torsion or on all motions.
    fn various() -> Vec<Parameters> {
        let mut out = Vec::new();
        for (i, case) in ["A", "C"].into_iter().cycle().take(40).enumerate() {
            let mut p = parameters(case);
            // Golden-ratio fractions: spread evenly, never repeating.
            let spread = |k: usize| ((i * 5 + k + 1) as f64 * 0.618_033_988_749_895).fract();
            p.mesh_frequency_hz *= 0.3 * 30f64.powf(spread(0));
            p.impact_acts_on = if i % 3 == 0 { ImpactActsOn::All } else { ImpactActsOn::Torsion };
            for h in &mut p.halves {
                h.pinion_torque_nm *= 0.5 + spread(1);
                h.impact = (i % 5 != 0).then(|| ImpactExcitation::HalfSine {
                    force_n: 200.0 * 300f64.powf(spread(2)),
                    duration_mesh_periods: 0.02 * 60f64.powf(spread(3)),
                    start_mesh_periods: spread(4) - 0.5,
                });
            }
            if i % 4 == 1 {
                p.halves[1].phase_shift_mesh_periods = spread(4);
            }
            if i % 8 == 3 {
                p.couplings.pinion_torsion = Spring { stiffness: 2e6, damping: 20.0 };
                p.halves[1].gear_mass_kg *= 1.2;
            }
            out.push(p);
        }
        out
    }

    /// The mean tooth force is the static one, so the largest is not below it.
    #[test]
    fn the_mean_tooth_force_is_the_static_one() {
        let ids = ["tooth_force_left", "tooth_force_right"].map(|name| ChannelId::parse(name).unwrap()).to_vec();
        let mut errors = Vec::new();
        for p in various() {
            let analysis =
                Analysis { accuracy: 1e-8, channels: ids.clone(), samples_per_mesh_period: 0, ..Analysis::default() };
            let s = solve(&p, &analysis, &Watch::none()).unwrap().summary;
            let means = ["tooth_force_left", "tooth_force_right"].map(|name| s.statistics[name].mean);
            let of = [s.tooth_force.left, s.tooth_force.right];
            let factor = s.dynamic_factor.unwrap();
            let largest = of.iter().map(|f| f.max_n.max(-f.min_n) / f.static_n).fold(0.0, f64::max);
            assert!(factor >= 1.0 && factor == largest.max(1.0), "{factor} {of:?}");
            if s.period_mesh_periods.is_some() {
                assert!(largest >= 1.0 - 1e-9, "{largest}");
                errors.push((means[0] + means[1]) / (of[0].static_n + of[1].static_n) - 1.0);
                if p.couplings.pinion_torsion == Spring::default() {
                    errors.extend([means[0] / of[0].static_n - 1.0, means[1] / of[1].static_n - 1.0]);
                }
            }
        }
        assert!(errors.len() > 60, "{}", errors.len());
        check_worst("Response: tooth force", "mean over static one, motions off the reference cases", errors, 1e-7);
    }

    /// Tooth force = mesh force + pulse at every sample, by both integrators, and no sample beyond the extremes.
    #[test]
    fn the_tooth_force_is_mesh_force_and_impact() {
        let names = ["tooth_force_left", "f_n_left"];
        for (i, p) in various().into_iter().enumerate().filter(|(i, _)| i % 4 == 0 || i % 6 == 1) {
            for (integrator, limit) in [(Integrator::Taylor, 1e-7), (Integrator::RungeKutta, 1e-5)] {
                let analysis = Analysis {
                    method: SolutionMethod::Integrate { mesh_periods: 12, record_mesh_periods: 3 },
                    integrator,
                    accuracy: 1e-7,
                    channels: names.map(|name| ChannelId::parse(name).unwrap()).to_vec(),
                    samples_per_mesh_period: 500,
                    ..Analysis::default()
                };
                let r = solve(&p, &analysis, &Watch::none()).unwrap();
                let pulse = |phase: f64| match &p.halves[0].impact {
                    Some(ImpactExcitation::HalfSine { force_n, duration_mesh_periods: d, start_mesh_periods }) => {
                        let age = (phase - start_mesh_periods).rem_euclid(1.0);
                        (0..2)
                            .map(|k| age + f64::from(k))
                            .filter(|age| age < d)
                            .map(|age| force_n * (std::f64::consts::PI * age / d).sin())
                            .sum()
                    }
                    _ => 0.0,
                };
                let [tooth, mesh] = [&r.channels[0].values, &r.channels[1].values];
                let f = r.summary.tooth_force.left;
                let size = f.max_n.abs().max(f.min_n.abs());
                let mut worst = 0.0f64;
                for (k, (t, m)) in tooth.iter().zip(mesh).enumerate() {
                    let expected = m + pulse(k as f64 / 500.0) / p.helix_angle_rad.cos();
                    worst = worst.max((t - expected).abs() / size);
                    assert!(*t <= f.max_n + 1e-9 * size && *t >= f.min_n - 1e-9 * size, "case {i}: {t} beyond {f:?}");
                }
                println!("case {i}, {integrator:?}: {worst:.1e}");
                assert!(worst < limit, "case {i}, {integrator:?}: {worst}");
            }
        }
    }

    /// An impact on all motions loads the shafts axially: the mean axial force on the gear is that of the load, not the
    /// load less the mean impact.
    #[test]
    fn an_impact_on_all_motions_pushes_along_the_axis_too() {
        for (force_n, duration_mesh_periods) in [(3000.0, 0.08), (9000.0, 0.3)] {
            let mut p = parameters("A");
            for h in &mut p.halves {
                h.impact = Some(ImpactExcitation::HalfSine { force_n, duration_mesh_periods, start_mesh_periods: 0.1 });
            }
            let mean = |p: &Parameters, integrator| {
                let analysis = Analysis {
                    method: SolutionMethod::Integrate { mesh_periods: 600, record_mesh_periods: 20 },
                    integrator,
                    channels: vec![ChannelId::parse("z_g_left").unwrap()],
                    samples_per_mesh_period: 0,
                    accuracy: 1e-9,
                    energy_balance: true,
                    ..Analysis::default()
                };
                let s = solve(p, &analysis, &Watch::none()).unwrap().summary;
                assert!(s.energy_balance_residual.unwrap() < 1e-4, "{:?}", s.energy_balance_residual);
                (s.statistics["z_g_left"].mean, s.rms.mesh_circumferential_acceleration_m_s2.left)
            };
            let load_n = p.halves[0].pinion_torque_nm / p.pinion_radius_m;
            let impact_n = p.halves[0].impact.as_ref().unwrap().mean_n();
            let held = p.halves[0].gear_axial.stiffness + 2.0 * p.couplings.gear_axial.stiffness;
            let tan = p.helix_angle_rad.tan();
            let (torsion, _) = mean(&p, Integrator::Taylor);
            p.impact_acts_on = ImpactActsOn::All;
            let (all, taylor) = mean(&p, Integrator::Taylor);
            let (_, runge_kutta) = mean(&p, Integrator::RungeKutta);
            let topic = "Response: tooth force";
            let of = |what: &str| format!("mean axial displacement of the gear, pulse of {force_n} N on {what}, µm");
            check(topic, &of("torsion"), torsion * 1e6, tan * (load_n - impact_n) / held * 1e6, Relative(1e-6));
            check(topic, &of("all motions"), all * 1e6, tan * load_n / held * 1e6, Relative(1e-6));
            assert!((taylor / runge_kutta - 1.0).abs() < 1e-6, "{taylor} {runge_kutta}");
        }
    }

    /// The symmetric and antisymmetric multipliers of six coordinates are those of twelve.
    #[test]
    fn six_coordinates_have_the_multipliers_of_twelve() {
        for case in ["A", "C"] {
            let p = parameters(case);
            let mut q = p.clone();
            q.halves[1].gear_mass_kg *= 1.0 + 1e-13;
            let (six, twelve) = (multipliers(&p), multipliers(&q));
            assert_eq!(six.len(), twelve.len());
            let errors = six.iter().zip(&twelve).map(|(a, b)| a.modulus - b.modulus);
            check_worst(
                "Response: six against twelve coordinates",
                &format!("all multipliers, case {case}"),
                errors,
                1e-6,
            );
        }
    }
}
