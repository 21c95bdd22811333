//! From what was gathered to what is reported.

use std::collections::BTreeMap;

use super::analysis::{
    Analysis, ContactState, Halves, Multiplier, PoincarePoint, Regime, Response, Rms, RmsIntervals, Summary,
};
use super::channel::{Channel, ChannelId};
use super::confidence::rms_interval_95;
use super::recorder::Recorder;
use super::regime::Section;
use crate::dynamics::{Model, NaturalModes, Numerics, PER_HALF, Parameters, State};

/// The question.
pub(super) struct Asked<'a> {
    pub p: &'a Parameters,
    pub analysis: &'a Analysis,
    pub modes: &'a NaturalModes,
}

/// What is known of the motion beside what the recorder gathered.
pub(super) struct Verdict {
    pub regime: Regime,
    pub period: Option<u64>,
    pub floquet: Option<f64>,
    /// Over the motion's period, largest first.
    pub multipliers: Option<Vec<Multiplier>>,
    pub lyapunov: Option<f64>,
    pub method: &'static str,
    pub error_estimate: f64,
    pub energy_residual: Option<f64>,
    /// Time of the first recorded value.
    pub t0_s: f64,
    pub numerics: Numerics,
}

/// What `record` leaves beside the recorder's own.
pub(super) struct Record<const D: usize> {
    pub recent: Section<D>,
    pub points: Vec<PoincarePoint>,
    pub last: State<D>,
    pub numerics: Numerics,
    pub batch_error: f64,
    /// Mean squares of the accelerations of every response, mesh period by mesh period.
    pub mean_squares: Vec<(ChannelId, Vec<f64>)>,
}

/// Puts a response together from what was gathered.
pub(super) fn report<const D: usize>(
    asked: &Asked<'_>,
    model: &Model<D>,
    mut recorder: Recorder<D>,
    record: Record<D>,
    verdict: Verdict,
) -> Response {
    let recorded = record.points.len() as u64;
    let last = record.last;
    let right = if D > PER_HALF { 1 } else { 0 };
    let rms_of = |id: ChannelId| recorder.gathered(id).map_or(0.0, |g| g.mean_and_square().1.sqrt());
    let both = |id: fn(u8) -> ChannelId| Halves { left: rms_of(id(0)), right: rms_of(id(right)) };
    let mesh = both(ChannelId::mesh_acceleration);
    let axial = both(ChannelId::pinion_axial_acceleration);
    let mut channels: BTreeMap<String, f64> = recorder.all().map(|(id, g, _)| (id.name(), g.finish().rms)).collect();
    for (half, m, a) in [(0, mesh.left, axial.left), (1, mesh.right, axial.right)] {
        channels.insert(ChannelId::mesh_acceleration(half).name(), m);
        channels.insert(ChannelId::pinion_axial_acceleration(half).name(), a);
    }
    let statistics = asked
        .analysis
        .channels
        .iter()
        .filter_map(|id| recorder.gathered(*id).map(|g| (id.name(), g.finish())))
        .collect();
    let mut min_displacement_m = f64::INFINITY;
    let mut dynamic_factor: Option<f64> = None;
    for half in solved_halves::<D>() {
        if let Some(s) = recorder.gathered(ChannelId::s(half)) {
            min_displacement_m = min_displacement_m.min(s.finish().min);
        }
        let static_n = (model.halves[usize::from(half)].load / model.cos).abs();
        if let (Some(f), true) = (recorder.gathered(ChannelId::normal_force(half)), static_n > 0.0) {
            let f = f.finish();
            let factor = f.max.abs().max(f.min.abs()) / static_n;
            dynamic_factor = Some(dynamic_factor.map_or(factor, |d| d.max(factor)));
        }
    }
    let shares = recorder.contact_shares();
    let dt_s = asked.p.mesh_period_s() / asked.analysis.samples_per_mesh_period.max(1) as f64;
    let mut samples = recorder.take_samples();
    let series = asked
        .analysis
        .channels
        .iter()
        .filter_map(|id| {
            let at = samples.iter().position(|(other, _)| other == id)?;
            let (id, values) = samples.swap_remove(at);
            let quantity = id.quantity();
            Some(Channel { name: id.name(), quantity, unit: quantity.unit().into(), t0_s: verdict.t0_s, dt_s, values })
        })
        .collect();
    let final_state = model.source_state(&last);
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
        dynamic_factor,
        regime: verdict.regime,
        period_mesh_periods: verdict.period,
        contact: contact_state(&shares),
        contact_share: Halves { left: 1.0 - shares[0][1], right: 1.0 - shares[1][1] },
        min_displacement_m,
        natural_frequencies_hz: asked.modes.frequencies_hz.clone(),
        error_estimate: verdict.error_estimate,
        method: verdict.method.into(),
        floquet_modulus: verdict.floquet,
        floquet_multipliers: verdict.multipliers,
        lyapunov_per_mesh_period: verdict.lyapunov,
        rms_interval_95: if verdict.period.is_none() { rms_interval_95() } else { None },
        energy_balance_residual: verdict.energy_residual,
        recorded_mesh_periods: recorded,
        degrees_of_freedom: D as u32,
        damping_in_gap: asked.p.damping_in_gap,
        numerics: verdict.numerics,
    };
    Response { summary, channels: series, poincare: record.points, final_state }
}

/// The halves that are solved: the left one alone when the other is its mirror image.
pub(super) fn solved_halves<const D: usize>() -> std::ops::Range<u8> {
    0..(D / PER_HALF) as u8
}

fn contact_state(shares: &[[f64; 3]; 2]) -> ContactState {
    let touched = |j: usize, side: usize| shares[j][side] > 0.0;
    if (0..2).any(|j| touched(j, 0) && touched(j, 2)) {
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
    use crate::oracle::Tolerance::Relative;
    use crate::oracle::{check, check_worst};
    use crate::response::solve;
    use crate::watch::Watch;

    fn multipliers(p: &Parameters) -> Vec<Multiplier> {
        let analysis = Analysis { accuracy: 1e-9, ..Analysis::default() };
        solve(p, &analysis, &Watch::none()).unwrap().summary.floquet_multipliers.unwrap()
    }

    /// Liouville: the product of all multipliers is what the dampers take from a volume of states, exp(−T tr(M⁻¹ C)); the
    /// free screw motion, which no damper feels, has a factor of one and is left out.
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

    /// Multipliers within and against the mirror symmetry of six coordinates are those of twelve.
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
