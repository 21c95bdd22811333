//! Results in the model: contact ratios, mesh stiffness, and what the format has no place for as attributes of our own.

use super::model::{Model, Typed};
use super::{ExportOptions, STAGE_DATA, STAGES, Source};
use herringbone_job::result::MeshCurve;

/// Positions of the mesh stiffness over one mesh period.
const POSITIONS: usize = 64;

/// Values of a periodic curve over one period at equal steps; linear between its points.
fn resampled(phase: &[f64], values: &[f64]) -> Option<Vec<f64>> {
    if phase.len() < 2 || phase.len() != values.len() || !values.iter().all(|value| value.is_finite()) {
        return None;
    }
    let count = phase.len();
    let at = |wanted: f64| {
        let next = phase.iter().position(|phase| *phase > wanted).unwrap_or(count);
        let (before, after) = (next.checked_sub(1), next % count);
        let (start, value) = match before {
            Some(index) => (phase[index], values[index]),
            None => (phase[count - 1] - 1.0, values[count - 1]),
        };
        let end = if next == count { phase[0] + 1.0 } else { phase[after] };
        let part = if end > start { ((wanted - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        value + (values[after] - value) * part
    };
    Some((0..POSITIONS).map(|step| at(step as f64 / POSITIONS as f64)).collect())
}

/// Writes the results of the geometry, and of a solved job where there is one.
pub(super) fn write(source: &Source, options: &ExportOptions, model: &mut Model) {
    let geometry = &source.geometry;
    let design = &source.document.design;
    let mesh = options.result.and_then(|result| result.mesh.as_ref());
    for half in [0, 1] {
        let curve: Option<&MeshCurve> = mesh.map(|mesh| match half {
            0 => &mesh.curve,
            _ => mesh.right_curve.as_ref().unwrap_or(&mesh.curve),
        });
        let stiffness = curve.and_then(|curve| resampled(&curve.phase, &curve.stiffness_n_per_um));
        let error = curve.and_then(|curve| resampled(&curve.phase, &curve.transmission_error_um));
        let positions = stiffness.as_ref().map(|_| {
            let step_deg = 360.0 / f64::from(design.pinion.teeth) / POSITIONS as f64;
            (0..POSITIONS).map(|step| step as f64 * step_deg).collect::<Vec<_>>()
        });
        if let Some(data) = model.components.iter_mut().find(|one| one.id == STAGE_DATA[half][0])
            && let Some(positions) = positions
        {
            data.result("rotational_meshing_position", "deg", Typed::Floats(positions));
        }
        let Some(stage) = model.components.iter_mut().find(|one| one.id == STAGES[half]) else { continue };
        stage
            .result("radial_contact_ratio", "none", Typed::Float(geometry.transverse_contact_ratio))
            .result("overlap_contact_ratio", "none", Typed::Float(geometry.overlap_ratio))
            .result("total_contact_ratio", "none", Typed::Float(geometry.total_contact_ratio));
        if let Some(stiffness) = stiffness {
            let n_per_mm = stiffness.iter().map(|n_per_um| n_per_um * 1e3).collect();
            stage.result("meshing_stiffness_characteristic", "N / mm", Typed::Floats(n_per_mm));
        }
        stage
            .set("custom_herringbone_partner_stage", "none", Typed::Reference(STAGES[1 - half]))
            .number("custom_herringbone_gap_width", "mm", design.gap_width_mm)
            .number("custom_herringbone_half_stagger", "none", design.half_stagger)
            .number("custom_herringbone_apex_offset", "mum", design.assembly.apex_offset_um);
        if let Some(error) = error {
            stage.result("custom_herringbone_transmission_error", "mum", Typed::Floats(error));
        }
        let Some(result) = options.result else { continue };
        if let Some(share) = mesh.and_then(|mesh| mesh.load_share_at_mesh_in) {
            stage.result("custom_herringbone_load_share", "none", Typed::Float(share));
        }
        if let Some(impact) = &result.impact {
            stage.result("custom_herringbone_impact_force", "N", Typed::Float(impact.force_n));
        }
        if let Some(response) = &result.response {
            let rms = response.rms.mesh_circumferential_acceleration_m_s2;
            for (name, value) in [("left", rms.left), ("right", rms.right)] {
                let id = format!("custom_herringbone_rms_mesh_acceleration_{name}");
                stage.result(&id, "m / s^2", Typed::Float(value));
            }
        }
        if let Some(id) = options.result_id {
            stage.result("custom_herringbone_result_id", "none", Typed::Text(id.to_owned()));
        }
        stage.result("custom_herringbone_solver_version", "none", Typed::Text(options.application_version.to_owned()));
    }
}
