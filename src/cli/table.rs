//! The headline numbers of a result as a text table.

use herringbone_job::result::JobResult;
use std::io::{Result, Write};

/// Writes one line for each number: name, value, unit.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut impl Write, result: &JobResult) -> Result<()> {
    let mut row = |name: &str, value: f64, unit: &str| writeln!(out, "{name:<46} {value:>12.5} {unit}");
    if let Some(geometry) = &result.geometry {
        row("transverse contact ratio", geometry.transverse_contact_ratio, "")?;
        row("overlap ratio", geometry.overlap_ratio, "")?;
        row("total contact ratio", geometry.total_contact_ratio, "")?;
        row("centre distance", geometry.center_distance_mm, "mm")?;
        row("working pressure angle", geometry.working_pressure_angle_deg, "deg")?;
        row("mesh frequency", geometry.mesh_frequency_hz, "Hz")?;
    }
    if let Some(mesh) = &result.mesh {
        row("mesh stiffness of one half, mean", mesh.stiffness_mean_n_per_um, "N/um")?;
        row("mesh stiffness of one half, min", mesh.stiffness_min_n_per_um, "N/um")?;
        row("mesh stiffness of one half, max", mesh.stiffness_max_n_per_um, "N/um")?;
        row("transmission error, mean", mesh.transmission_error_mean_um, "um")?;
        row("transmission error, peak to peak", mesh.transmission_error_pp_um, "um")?;
        if let Some(ratio) = mesh.loaded_contact_ratio {
            row("loaded contact ratio", ratio, "")?;
        }
        if let Some(share) = mesh.load_share_at_mesh_in {
            row("load share at mesh-in", 100.0 * share, "%")?;
        }
    }
    if let Some(impact) = &result.impact {
        row("mesh-in impact force", impact.force_n, "N")?;
        if let Some(force_n) = impact.zhou2008_force_n {
            row("mesh-in impact force, Zhou et al. 2008", force_n, "N")?;
        }
        if let Some(velocity_m_s) = impact.velocity_m_s {
            row("impact velocity", velocity_m_s, "m/s")?;
        }
        row("impact duration", impact.duration_us, "us")?;
    }
    if let Some(response) = &result.response {
        let rms = &response.rms;
        row("mesh circumferential acceleration RMS, left", rms.mesh_circumferential_acceleration_m_s2.left, "m/s2")?;
        row("mesh circumferential acceleration RMS, right", rms.mesh_circumferential_acceleration_m_s2.right, "m/s2")?;
        row("pinion axial acceleration RMS, left", rms.pinion_axial_acceleration_m_s2.left, "m/s2")?;
        row("pinion axial acceleration RMS, right", rms.pinion_axial_acceleration_m_s2.right, "m/s2")?;
        if let Some(factor) = response.dynamic_factor {
            row("dynamic factor", factor, "")?;
        }
        let force = &response.tooth_force_n;
        row("largest tooth force, left", force.left.max_n, "N")?;
        row("largest tooth force, right", force.right.max_n, "N")?;
        row("smallest mesh displacement", response.min_displacement_um, "um")?;
        writeln!(out, "{:<46} {}, {} contact ({})", "motion", response.regime, response.contact, response.method)?;
    }
    if let Some(sweep) = &result.sweep {
        let failed = sweep.points.iter().filter(|point| point.error.is_some()).count();
        writeln!(out, "{:<46} {} points, {failed} without a response", "sweep", sweep.points.len())?;
    }
    if let Some(accuracy) = &result.accuracy {
        let model = &accuracy.model;
        let percent = |value: Option<f64>| value.map_or("unknown".to_owned(), |value| format!("{value} %"));
        let (stiffness, harmonic) =
            (percent(model.mesh_stiffness_percent), percent(model.transmission_error_harmonic_percent));
        let name = "error of the model";
        writeln!(out, "{name:<46} mesh stiffness {stiffness}, transmission error's first harmonic {harmonic}")?;
        if let Some(numerical) = accuracy.numerical {
            writeln!(out, "{:<46} {numerical:.1e}", "numerical error, relative")?;
        }
    }
    for warning in &result.warnings {
        writeln!(out, "warning ({}): {} {}", warning.code, warning.pointer, warning.detail)?;
    }
    Ok(())
}
