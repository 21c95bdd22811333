//! Campbell data of a sweep over the speed: the speeds at which an order of the mesh frequency equals a natural
//! frequency.

use super::mesh::MeshMemo;
use super::{SolveContext, SolveError, point, row};
use crate::document::{Axis, JobDocument};
use crate::result::{Campbell, CampbellCrossing, NaturalMode};

/// The input whose sweep has a Campbell diagram.
const SPEED: &str = "/operation/pinion_speed_rpm";
/// Highest mesh order in the diagram.
const ORDERS: u32 = 10;

/// One diagram for every value of the other axis (one diagram without a second axis); empty if no axis is the speed.
/// Values at which a stage before the response fails have no diagram.
///
/// # Errors
/// [`SolveError::Canceled`].
pub(super) fn run(
    base: &JobDocument,
    sweep: &JobDocument,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<Vec<Campbell>, SolveError> {
    let Some(at) = sweep.axes.iter().position(|axis| axis.pointers().any(|pointer| pointer == SPEED)) else {
        return Ok(Vec::new());
    };
    let speed = &sweep.axes[at];
    let other = sweep.axes.get(1 - at);
    let quiet = SolveContext { progress: &|_, _| {}, ..*context };
    let mut diagrams = Vec::new();
    for index in 0..other.map_or(1, Axis::len) {
        let other_axis_value = other.map(|axis| axis.value(index));
        let mut values = vec![speed.value(0)];
        // In the order of the axes.
        other_axis_value.into_iter().for_each(|value| values.insert(1 - at, value));
        let modes = row::job(base, sweep, &values, memo).and_then(|job| {
            let staged = point::stage(&job, &quiet, memo)?;
            let modes = staged.natural_modes().map_err(super::vibration::failed)?;
            Ok((modes, job.document().design.pinion.teeth))
        });
        match modes {
            Ok((Some(modes), teeth)) => diagrams.push(diagram(speed, other_axis_value, f64::from(teeth), modes)),
            Ok((None, _)) => {}
            Err(SolveError::Canceled(canceled)) => return Err(canceled.into()),
            // The rows of the sweep contain the error.
            Err(_) => {}
        }
    }
    Ok(diagrams)
}

fn diagram(speed: &Axis, other_axis_value: Option<f64>, teeth: f64, natural_modes: Vec<NaturalMode>) -> Campbell {
    let speeds = speed.values();
    let [least, greatest] = [f64::min, f64::max].map(|of| speeds.iter().copied().reduce(of).unwrap_or_default());
    let range = [least, greatest];
    let mut crossings = Vec::new();
    for (mode, natural) in (0u32..).zip(&natural_modes) {
        let mesh_strain_energy =
            ["mesh_left", "mesh_right"].iter().filter_map(|group| natural.strain_energy.get(*group)).sum();
        for mesh_order in 1..=ORDERS {
            let pinion_speed_rpm = 60.0 * natural.frequency_hz / (f64::from(mesh_order) * teeth);
            if natural.frequency_hz > 0.0 && (range[0]..=range[1]).contains(&pinion_speed_rpm) {
                let frequency_hz = natural.frequency_hz;
                crossings.push(CampbellCrossing {
                    pinion_speed_rpm,
                    frequency_hz,
                    mesh_order,
                    mode,
                    mesh_strain_energy,
                });
            }
        }
    }
    crossings.sort_by(|a, b| a.pinion_speed_rpm.total_cmp(&b.pinion_speed_rpm));
    Campbell {
        other_axis_value,
        pinion_speed_rpm: range,
        mesh_frequency_hz: range.map(|rpm| rpm * teeth / 60.0),
        mesh_orders: (1..=ORDERS).collect(),
        natural_modes,
        crossings,
    }
}
