//! The `response` block of the result, made from a solved response.

use super::bounds::backlash_um;
use crate::document::JobDocument;
use crate::result::{
    ContactStateResult, FloquetMultiplier, IntervalPerHalf, IntervalResult, MethodResult, NaturalMode, PerHalf,
    Poincare, RegimeResult, ResponseResult, RmsIntervalsResult, RmsResult, SpectrumResult, ToothForceResult,
    ToothForces,
};
use herringbone_physics::dynamics::{DynamicsError, NaturalModes, Parameters};
use herringbone_physics::response::{self, AppliedMethod, ContactState, Halves, Regime};

fn per_half(halves: Halves<f64>) -> PerHalf {
    PerHalf { left: halves.left, right: halves.right }
}

fn tooth_force(force: response::ToothForce) -> ToothForceResult {
    ToothForceResult { static_n: force.static_n, max: force.max_n, min: force.min_n }
}

fn interval(halves: Halves<response::ConfidenceInterval>) -> IntervalPerHalf {
    let of = |interval: response::ConfidenceInterval| IntervalResult { low: interval.low, high: interval.high };
    IntervalPerHalf { left: of(halves.left), right: of(halves.right) }
}

fn regime(summary: &response::Summary) -> RegimeResult {
    match (summary.regime, summary.period_mesh_periods) {
        (_, Some(mesh_periods)) => RegimeResult::Period(mesh_periods),
        (Regime::Period1 | Regime::PeriodN, None) => RegimeResult::Period(1),
        (Regime::QuasiPeriodic, None) => RegimeResult::QuasiPeriodic,
        (Regime::Chaotic, None) => RegimeResult::Chaotic,
        (Regime::NotSettled, None) => RegimeResult::NotSettled,
        (Regime::Unstable, None) => RegimeResult::Unstable,
    }
}

fn contact(state: ContactState) -> ContactStateResult {
    match state {
        ContactState::Continuous => ContactStateResult::Continuous,
        ContactState::SingleSided => ContactStateResult::SingleSided,
        ContactState::DoubleSided => ContactStateResult::DoubleSided,
        ContactState::Apart => ContactStateResult::Apart,
    }
}

/// The channel of the spectra.
pub(super) const SPECTRUM_CHANNEL: &str = "a_x_left";

fn full_spectrum(response: &response::Response, mesh_frequency_hz: f64) -> Option<response::Spectrum> {
    let channel = response.channels.iter().find(|channel| channel.name == SPECTRUM_CHANNEL)?;
    Some(response::Spectrum::of(channel, mesh_frequency_hz))
}

/// Bands per mesh order of the spectra in the rows of a sweep.
const BANDS_PER_ORDER: usize = 4;

/// Amplitudes around the mesh orders of [`band_orders`].
pub(super) fn bands(response: &response::Response, mesh_frequency_hz: f64) -> Option<Vec<f64>> {
    Some(full_spectrum(response, mesh_frequency_hz)?.bands(BANDS_PER_ORDER, SPECTRUM_ORDERS as usize))
}

/// The mesh orders of the spectra in the rows of a sweep: 1/4, 1/2, … 20.
pub(super) fn band_orders() -> Vec<f64> {
    (1..=BANDS_PER_ORDER * SPECTRUM_ORDERS as usize).map(|band| band as f64 / BANDS_PER_ORDER as f64).collect()
}

/// The motion at the starts of the last `most` recorded mesh periods.
pub(super) fn poincare(response: &response::Response, most: usize) -> Poincare {
    let points = &response.poincare[response.poincare.len().saturating_sub(most)..];
    Poincare {
        x_left_m: points.iter().map(|point| point.x_left_m).collect(),
        v_x_left_m_s: points.iter().map(|point| point.v_x_left_m_s).collect(),
    }
}

/// The natural modes of the equations, with names, shapes and shares of energy.
///
/// # Errors
/// [`DynamicsError`] if the equations are refused.
pub(super) fn natural_modes(parameters: &Parameters) -> Result<Vec<NaturalMode>, DynamicsError> {
    let modes = NaturalModes::new(parameters)?.describe(parameters).into_iter().map(|mode| NaturalMode {
        frequency_hz: mode.frequency_hz,
        name: mode.name,
        shape: mode.shape.to_vec(),
        modal_mass_kg: mode.modal_mass_kg,
        damping_ratio: mode.damping_ratio,
        strain_energy: mode.strain_energy.iter().map(|(group, share)| (group.as_str().to_owned(), *share)).collect(),
        kinetic_energy: mode.kinetic_energy.iter().map(|(kind, share)| ((*kind).to_owned(), *share)).collect(),
    });
    Ok(modes.collect())
}

fn multipliers(multipliers: &[response::Multiplier]) -> Vec<FloquetMultiplier> {
    multipliers.iter().map(|m| FloquetMultiplier { modulus: m.modulus, angle_rad: m.angle_rad }).collect()
}

/// The numbers of the result's response block, without the parts that only a single response has (points, spectrum,
/// modes).
pub(super) fn summary(
    document: &JobDocument,
    parameters: &Parameters,
    response: &response::Response,
) -> ResponseResult {
    let summary = &response.summary;
    ResponseResult {
        rms: RmsResult {
            mesh_circumferential_acceleration_m_s2: per_half(summary.rms.mesh_circumferential_acceleration_m_s2),
            pinion_axial_acceleration_m_s2: per_half(summary.rms.pinion_axial_acceleration_m_s2),
            channels: summary.rms.channels.clone(),
        },
        dynamic_factor: summary.dynamic_factor,
        tooth_force_n: ToothForces {
            left: tooth_force(summary.tooth_force.left),
            right: tooth_force(summary.tooth_force.right),
        },
        regime: regime(summary),
        contact: contact(summary.contact),
        min_displacement_um: summary.min_displacement_m * 1e6,
        natural_frequencies_hz: summary.natural_frequencies_hz.clone(),
        error_estimate: summary.error_estimate,
        method: match summary.method {
            AppliedMethod::Periodic => MethodResult::Periodic,
            AppliedMethod::Integrate => MethodResult::Integrate,
        },
        fraction_in_contact: 0.5 * (summary.contact_share.left + summary.contact_share.right),
        damping_in_gap: summary.damping_in_gap,
        backlash_um: Some(backlash_um(document)),
        plane: document.model.plane,
        mesh_frequency_hz: parameters.mesh_frequency_hz,
        averaged_mesh_periods: summary.recorded_mesh_periods,
        poincare: Poincare::default(),
        spectrum: None,
        period_mesh_periods: summary.period_mesh_periods,
        floquet_multipliers: summary.floquet_multipliers.as_deref().map(multipliers),
        floquet_modulus_per_mesh_period: summary.floquet_modulus,
        lyapunov_per_mesh_period: summary.lyapunov_per_mesh_period.filter(|exponent| exponent.is_finite()),
        contact_share: per_half(summary.contact_share),
        confidence_interval_95: summary.rms_interval_95.map(|intervals| RmsIntervalsResult {
            mesh_circumferential_acceleration_m_s2: interval(intervals.mesh_circumferential_acceleration_m_s2),
            pinion_axial_acceleration_m_s2: interval(intervals.pinion_axial_acceleration_m_s2),
        }),
        energy_balance_residual: summary.energy_balance_residual,
        natural_modes: Vec::new(),
        bearings: Vec::new(),
        largest_bearing_force_rms_n: None,
        lowest_natural_frequency_hz: None,
        tooth_force_orders_n: None,
        rotor: None,
    }
}

/// Highest mesh order and largest number of lines of the spectrum in the result; the recorded series has the rest.
const SPECTRUM_ORDERS: f64 = 20.0;
const SPECTRUM_LINES: usize = 4000;

/// Spectrum of the left half's circumferential acceleration, where it was recorded. Of more lines than the result
/// holds, the largest of each group of neighbours stays.
pub(super) fn spectrum(response: &response::Response, mesh_frequency_hz: f64) -> Option<SpectrumResult> {
    let full = full_spectrum(response, mesh_frequency_hz)?;
    let lines = full.mesh_order.iter().filter(|order| **order <= SPECTRUM_ORDERS).count();
    let group = lines.div_ceil(SPECTRUM_LINES).max(1);
    let largest = |start: usize| {
        (start..(start + group).min(lines)).max_by(|&a, &b| full.amplitude[a].total_cmp(&full.amplitude[b]))
    };
    let chosen: Vec<usize> = (1..lines).step_by(group).filter_map(largest).collect();
    Some(SpectrumResult {
        frequency_hz: chosen.iter().map(|&line| full.frequency_hz[line]).collect(),
        amplitude_m_s2: chosen.iter().map(|&line| full.amplitude[line]).collect(),
    })
}
