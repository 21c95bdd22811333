//! The impact stage: the mesh-in impact of each half, and the pulse it puts on the equations.

use super::bounds;
use super::equations::MotionPlane;
use super::mesh::MeshStage;
use super::prepare::Prepared;
use crate::document::{CornerImpactInput, ImpactDuration, ImpactInput, ImpactSource, JobDocument, MeshForce};
use crate::result;
use crate::warning::Warning;
use herringbone_physics::dynamics;
use herringbone_physics::gear::Half;
use herringbone_physics::impact::{self, Inertia, MeshInConditions};

/// Outcome of the impact stage: its block of the result, and the pulse of each half.
pub(super) struct ImpactStage {
    pub summary: Option<result::ImpactResult>,
    pub pulses: [Option<dynamics::ImpactExcitation>; 2],
}

/// True where the impact of a document acts in the equations of motion; else it is only reported.
pub(super) fn applied(document: &JobDocument) -> bool {
    // The force of a mesh stiffness has no early contact; that of the loaded contact contains it.
    document.model.mesh_force == MeshForce::Stiffness && !matches!(document.model.impact, ImpactInput::None)
}

/// Runs the impact stage: an impact that is not applied has no pulses. Warns of pulses outside the range of their
/// model.
pub(super) fn run(
    document: &JobDocument,
    prepared: &Prepared,
    plane: &MotionPlane,
    mesh: &MeshStage,
    warnings: &mut Vec<Warning>,
) -> ImpactStage {
    let mut stage = calculate(document, prepared, plane, mesh, warnings);
    let applied = applied(document);
    if !applied {
        stage.pulses = [None, None];
    }
    if let Some(summary) = &mut stage.summary {
        summary.applied = applied;
        summary.acts_on = document.model.impact.acts_on();
    }
    warnings.extend(bounds::of_pulses(document, plane, &stage.pulses));
    stage
}

/// The impact, applied or not; `None`, with a warning of the reason, without a corner contact.
fn calculate(
    document: &JobDocument,
    prepared: &Prepared,
    plane: &MotionPlane,
    mesh: &MeshStage,
    warnings: &mut Vec<Warning>,
) -> ImpactStage {
    // The right half is staggered by the shift of the equations, unless its stiffness already is: then here.
    let shift = if mesh.stagger_included { -document.design.half_stagger } else { 0.0 };
    match &document.model.impact {
        ImpactInput::None => ImpactStage { summary: None, pulses: [None, None] },
        ImpactInput::Given(given) => {
            let pulse = |shift: f64| dynamics::ImpactExcitation::HalfSine {
                force_n: given.force_n,
                duration_mesh_periods: given.duration_mesh_periods,
                start_mesh_periods: given.start_mesh_periods + shift,
            };
            let summary = result::ImpactResult {
                force_n: given.force_n,
                duration_us: given.duration_mesh_periods / prepared.mesh_frequency_hz * 1e6,
                start_mesh_periods: given.start_mesh_periods,
                source: ImpactSource::Given,
                ..result::ImpactResult::default()
            };
            ImpactStage { summary: Some(summary), pulses: [Some(pulse(0.0)), Some(pulse(shift))] }
        }
        ImpactInput::CornerContact(corner) => calculated(prepared, plane, mesh, corner, true, shift, warnings),
        ImpactInput::Zhou2008(corner) => calculated(prepared, plane, mesh, corner, false, shift, warnings),
    }
}

fn not_calculated(why: &dyn std::fmt::Display) -> Warning {
    Warning {
        code: "impact-not-calculated".to_owned(),
        pointer: "/model/impact".to_owned(),
        detail: format!("{why}; mesh and response are without a mesh-in impact"),
    }
}

fn calculated(
    prepared: &Prepared,
    plane: &MotionPlane,
    mesh: &MeshStage,
    corner: &CornerImpactInput,
    buffered: bool,
    shift: f64,
    warnings: &mut Vec<Warning>,
) -> ImpactStage {
    if prepared.half_force_n <= 0.0 {
        let why = if prepared.half_force_n < 0.0 {
            "the torque is negative: the gear drives, and pairs enter the mesh at the pinion's tip corner, which the impact of the gear's tip corner does not cover"
        } else {
            "the torque is 0 N m: no pair in mesh is deflected"
        };
        warnings.push(not_calculated(&why));
        return ImpactStage { summary: None, pulses: [None, None] };
    }
    let [pinion_kg_m2, gear_kg_m2] = prepared.inertia_kg_m2.map(|inertia| inertia / 2.0);
    let solve = |half: Half| {
        let state = &mesh.entry[half.index()];
        let entry = MeshInConditions {
            half,
            pinion_speed_rad_s: prepared.pinion_speed_rad_s,
            inertia: Inertia { pinion_kg_m2, gear_kg_m2 },
            mesh_stiffness_n_per_m: state.stiffness_n_per_m,
            load_share: state.load_share,
            base_pitch_error_m: corner.base_pitch_error_um * 1e-6,
        };
        impact::mesh_in(&prepared.pair, &entry, |overrun_m| state.deflection_m(overrun_m))
    };
    let (left, right) = match (solve(Half::Left), solve(Half::Right)) {
        (Ok(left), Ok(right)) => (left, right),
        (Err(error), _) | (_, Err(error)) => {
            // The contact is solved: its result is kept although the impact is outside the range of its model.
            warnings.push(not_calculated(&error));
            return ImpactStage { summary: None, pulses: [None, None] };
        }
    };
    if let Some(none) = &left.none_because {
        warnings.push(Warning {
            code: "no-impact".to_owned(),
            pointer: "/model/impact".to_owned(),
            detail: format!(
                "the entering end is {:.2} µm open, more than the {:.2} µm by which the load closes it: no early contact, no impact",
                none.flank_gap_m * 1e6,
                none.deflection_m * 1e6
            ),
        });
    }
    let timing = |impact: &impact::MeshInImpact| {
        let duration_s = match corner.duration {
            ImpactDuration::EnergyBalance => impact.duration_s,
            ImpactDuration::CornerToStart => impact.lead_s,
        };
        let entry = -impact.overrun_m / prepared.pair.base_pitch_m;
        (duration_s, corner.start_mesh_periods.unwrap_or(entry))
    };
    let pulse = |impact: &impact::MeshInImpact, shift: f64| {
        let force = if buffered { impact.force_n } else { impact.zhou2008_force_n };
        let (duration_s, start) = timing(impact);
        // Shorter than this the pulse has no effect that could be computed.
        let duration_mesh_periods = duration_s * prepared.mesh_frequency_hz;
        (force > 0.0 && duration_mesh_periods >= 1e-9).then_some(dynamics::ImpactExcitation::HalfSine {
            force_n: force * plane.force_factor,
            duration_mesh_periods,
            start_mesh_periods: start + shift,
        })
    };
    let (duration_s, start_mesh_periods) = timing(&left);
    let deflection_m = mesh.entry[0].deflection_m(left.overrun_m);
    let summary = result::ImpactResult {
        force_n: left.force_n,
        zhou2008_force_n: Some(left.zhou2008_force_n),
        reduction_percent: Some(left.reduction_percent),
        velocity_m_s: Some(left.velocity_m_s),
        duration_us: duration_s * 1e6,
        energy_balance_duration_us: Some(left.duration_s * 1e6),
        theta_deg: Some(left.theta_rad.to_degrees()),
        equivalent_mass_kg: Some(left.equivalent_mass_kg),
        single_pair_stiffness_n_per_um: Some(left.single_pair_stiffness_n_per_m * 1e-6),
        other_pairs_stiffness_n_per_um: Some(left.other_pairs_stiffness_n_per_m * 1e-6),
        corner_deflection_um: Some(deflection_m * 1e6),
        corner_overrun_mm: Some(left.overrun_m * 1e3),
        start_mesh_periods,
        source: if buffered { ImpactSource::CornerContact } else { ImpactSource::Zhou2008 },
        ..result::ImpactResult::default()
    };
    ImpactStage { summary: Some(summary), pulses: [pulse(&left, 0.0), pulse(&right, shift)] }
}
