//! The response stage: the steady vibration of the pair and its statistics.

use super::point::PointOptions;
use super::rotor::{self, TurningRotor};
use super::{RecordedChannel, SolveContext, SolveError, Stage, bounds, response_result};
use crate::document::{IntegratorInput, JobDocument, MethodInput, Recorded};
use crate::result::{NumericsResult, Poincare, ResponseResult};
use crate::warning::Warning;
use crate::{DocumentError, Violation};
use herringbone_physics::dynamics::{self, DynamicsError, ModalTrain, Parameters};
use herringbone_physics::response::{self, Analysis, ChannelId, Regime};
use herringbone_physics::watch::Watch;

/// Poincaré points of a motion that does not repeat, of a single response.
const POINCARE_POINTS_OF_RESPONSE: usize = 2000;

/// Outcome of the response stage.
pub(super) struct Vibration {
    pub summary: ResponseResult,
    pub series: Vec<RecordedChannel>,
    pub warnings: Vec<Warning>,
    pub end_state: Option<Vec<f64>>,
    /// Poincaré points and spectrum for the row of a sweep, if the document requests them.
    pub poincare: Option<Poincare>,
    pub bands: Option<Vec<f64>>,
}

/// True where `requested` names the channel `name`: velocities and accelerations of x may leave the x out (`a_left`).
pub fn is_channel(requested: &str, name: &str) -> bool {
    canonical(requested) == name
}

fn canonical(requested: &str) -> String {
    match requested {
        "v_left" | "v_right" | "a_left" | "a_right" => format!("{}_x{}", &requested[..1], &requested[1..]),
        other => other.to_owned(),
    }
}

/// The channels requested by a document; all if it names none. Without the `train` of its shafts their channels are
/// left out.
///
/// # Errors
/// [`DocumentError::Invalid`] for names that are no channel.
pub(super) fn channels(document: &JobDocument, train: Option<&ModalTrain>) -> Result<Vec<ChannelId>, DocumentError> {
    let Some(requested) = &document.analysis.channels else {
        let outputs = train.into_iter().flat_map(ChannelId::outputs_of);
        return Ok(ChannelId::all().into_iter().chain(outputs).collect());
    };
    let of_shafts = rotor::channel_names(document);
    let mut ids = Vec::with_capacity(requested.len());
    let mut violations = Vec::new();
    for (index, name) in requested.iter().enumerate() {
        match ChannelId::parse_with(&canonical(name), train) {
            Some(id) if !ids.contains(&id) => ids.push(id),
            Some(_) => {}
            // A force that is zero has no channel.
            None if of_shafts.contains(name) => {}
            None => {
                let known: Vec<_> =
                    ChannelId::all().into_iter().map(ChannelId::name).chain(of_shafts.iter().cloned()).collect();
                let detail = format!("is no channel; permitted: {}", known.join(", "));
                violations.push(Violation::new(format!("/analysis/channels/{index}"), "not-one-of", detail));
            }
        }
    }
    if violations.is_empty() { Ok(ids) } else { Err(DocumentError::Invalid(violations)) }
}

/// Most points of the motion at the starts of mesh periods in the row of a sweep.
const POINCARE_POINTS: usize = 200;

/// Solves the equations of motion of a point by themselves.
///
/// # Errors
/// [`DocumentError::Invalid`] for names that are no channel.
pub(super) fn solve(
    document: &JobDocument,
    parameters: &Parameters,
    options: &PointOptions,
    context: &SolveContext,
) -> Result<Result<response::Response, DynamicsError>, DocumentError> {
    let analysis = analysis(document, parameters.train.as_deref(), options)?;
    let progress = |fraction: f64| (context.progress)(Stage::Response, fraction);
    let watch = Watch::new(&progress, context.canceled);
    Ok(response::solve(parameters, &analysis, &watch))
}

/// Turns a response into the outcome of the stage.
///
/// # Errors
/// [`SolveError`].
pub(super) fn to_result(
    document: &JobDocument,
    (parameters, rotor): (&Parameters, Option<&TurningRotor>),
    options: &PointOptions,
    response: Result<response::Response, DynamicsError>,
    numerics: &mut NumericsResult,
) -> Result<Vibration, SolveError> {
    let mut response = response.map_err(failed)?;
    let summary = &response.summary;
    numerics.steps = summary.counts.steps;
    numerics.rejected_steps = summary.counts.rejected_steps;
    numerics.force_evaluations = summary.counts.force_evaluations;
    numerics.degrees_of_freedom = summary.degrees_of_freedom;
    let mut block = response_result::summary(document, parameters, &response);
    if options.whole {
        block.poincare = response_result::poincare(&response, usize::MAX);
        block.spectrum = response_result::spectrum(&response, parameters.mesh_frequency_hz);
        if rotor.is_none() {
            block.natural_modes = response_result::natural_modes(parameters).map_err(failed)?;
        }
    }
    let mut warnings = warnings(document, &response.summary);
    if let Some(rotor) = rotor {
        rotor.complete(document, (parameters, &response), &mut block, options.whole)?;
        warnings.extend(rotor.warning(document));
    }
    let poincare = options.records(Recorded::Poincare).then(|| response_result::poincare(&response, POINCARE_POINTS));
    let bands =
        options.records(Recorded::Spectrum).then(|| response_result::bands(&response, parameters.mesh_frequency_hz));
    // Moved, not copied: a long record is most of the memory of a job.
    let channels = std::mem::take(&mut response.channels);
    let channel = |channel: response::Channel| RecordedChannel {
        rms: response.summary.rms.channels.get(&channel.name).copied().unwrap_or(0.0),
        quantity: word(&channel.quantity),
        name: channel.name,
        unit: channel.unit,
        t0_s: channel.t0_s,
        dt_s: channel.dt_s,
        values: channel.values,
    };
    Ok(Vibration {
        summary: block,
        poincare,
        bands: bands.flatten(),
        series: if options.whole { channels.into_iter().map(channel).collect() } else { Vec::new() },
        warnings,
        // A motion that grows without bound has no end state to continue from.
        end_state: (response.summary.regime != Regime::Unstable).then(|| response.final_state.to_vec()),
    })
}

/// The word of a unit-only enum in its serialised form.
fn word(value: &impl serde::Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}

/// The analysis that the document requests of the equations of motion.
///
/// # Errors
/// [`DocumentError::Invalid`] for names that are no channel.
pub(super) fn analysis(
    document: &JobDocument,
    train: Option<&ModalTrain>,
    options: &PointOptions,
) -> Result<Analysis, DocumentError> {
    let requested = &document.analysis;
    let state = options.start.or(requested.initial_state.as_deref());
    let mut channels = channels(document, train)?;
    if options.records(Recorded::Spectrum) {
        channels.extend(ChannelId::parse(response_result::SPECTRUM_CHANNEL));
    }
    Ok(Analysis {
        method: match requested.method {
            MethodInput::Integrate => response::SolutionMethod::Integrate {
                mesh_periods: u64::from(requested.mesh_periods),
                record_mesh_periods: u64::from(requested.record_mesh_periods),
            },
            MethodInput::Periodic => response::SolutionMethod::Periodic,
            MethodInput::Auto => response::SolutionMethod::Auto,
        },
        integrator: match requested.integrator {
            IntegratorInput::Taylor => dynamics::Integrator::Taylor,
            IntegratorInput::RungeKutta4 => dynamics::Integrator::RungeKutta,
        },
        accuracy: requested.accuracy,
        samples_per_mesh_period: requested.samples_per_mesh_period as usize,
        channels,
        initial_state: state.and_then(|state| <[f64; 24]>::try_from(state).ok()),
        energy_balance: options.whole,
        multipliers: options.whole,
        poincare_points: if options.whole { POINCARE_POINTS_OF_RESPONSE } else { 0 },
        ..Analysis::default()
    })
}

/// The error of a stage without a response.
pub(super) fn failed(error: DynamicsError) -> SolveError {
    let (code, sim_time_s) = match &error {
        DynamicsError::Canceled(canceled) => return (*canceled).into(),
        DynamicsError::Diverged { time_s } => ("diverged", Some(*time_s)),
        DynamicsError::StepSizeTooSmall { time_s, .. } => ("step-size-too-small", Some(*time_s)),
        DynamicsError::TooManySteps { time_s, .. } => ("too-many-steps", Some(*time_s)),
        _ => ("response-failed", None),
    };
    SolveError::Failed {
        stage: Stage::Response,
        code: code.to_owned(),
        detail: error.to_string(),
        sim_time_s,
        step: None,
    }
}

fn warnings(document: &JobDocument, summary: &response::Summary) -> Vec<Warning> {
    let mut warnings = bounds::of_motion(document, summary);
    // Numbers of an unstable motion mean nothing, and neither does their accuracy.
    if summary.error_estimate > document.analysis.accuracy && summary.regime != Regime::Unstable {
        let repeats = summary.period_mesh_periods.is_some();
        let reason =
            if repeats { "" } else { "; the motion does not repeat, so its means are those of a finite record" };
        warnings.push(Warning {
            code: "accuracy-not-reached".to_owned(),
            pointer: "/analysis/accuracy".to_owned(),
            detail: format!("the estimated relative error of the RMS values is {:.1e}{reason}", summary.error_estimate),
        });
    }
    warnings
}
