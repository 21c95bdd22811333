//! The mesh force of the equations as the loaded contact gives it, from the contact analysis of both halves.

use super::compliance;
use super::equations::MotionPlane;
use super::hash::force_hash;
use super::mesh::{ContactCase, MeshMemo, contact_failed};
use super::{SolveError, Stage, Surroundings};
use crate::contact::{ForceTable, SplineKnots, same_gaps};
use crate::dynamics::{ContactForce, FlankForce};
use crate::gear::{Half, Pair};
use crate::job::result::ContactForceTable;
use crate::watch::Watch;
use std::sync::Arc;

/// The contact force of both halves, along s of the plane in use.
#[derive(Debug, Clone)]
pub struct MeshForces {
    /// Left, right; the same where the halves are.
    pub forces: [Arc<ContactForce>; 2],
    pub summary: ContactForceTable,
}

/// Tables of one half, or of both where they differ, from the job's memory, the store, or solved.
pub fn tables(
    case: &ContactCase,
    pair: &Pair,
    surroundings: &Surroundings,
    memo: &MeshMemo,
) -> Result<Arc<Vec<ForceTable>>, SolveError> {
    let key = force_hash(case);
    if let Some(tables) = memo.forces.get(&key) {
        return Ok(tables);
    }
    let stored =
        surroundings.stages.load(&key).and_then(|bytes| serde_json::from_slice::<Vec<ForceTable>>(&bytes).ok());
    let tables = match stored {
        Some(tables) => tables,
        None => {
            let found = compliance::find(case, pair, surroundings, &memo.compliances)?;
            let quiet = |_: f64| {};
            let watch = Watch::new(&quiet, surroundings.canceled);
            let force_n = case.half_force_n(pair);
            let halves: &[Half] = if same_gaps(pair) { &[Half::Left] } else { &Half::BOTH };
            let tables: Result<Vec<_>, _> = halves
                .iter()
                .map(|&half| ForceTable::new(pair, half, force_n, &found.compliance, &case.settings, watch))
                .collect();
            let tables = tables.map_err(contact_failed)?;
            surroundings.stages.save(&key, Stage::Mesh, &serde_json::to_vec(&tables).unwrap_or_default());
            tables
        }
    };
    let tables = Arc::new(tables);
    memo.forces.put(key, tables.clone());
    Ok(tables)
}

/// The forces of both halves in the equations' coordinates.
///
/// # Errors
/// [`SolveError`] where the contact cannot be solved.
pub fn run(
    case: &ContactCase,
    pair: &Pair,
    plane: &MotionPlane,
    surroundings: &Surroundings,
    memo: &MeshMemo,
) -> Result<MeshForces, SolveError> {
    let tables = tables(case, pair, surroundings, memo)?;
    let force = |table: &ForceTable| {
        let knots = table.phase.clone();
        let driving = flank_force(table, &knots, plane, |phase| (phase, 1.0));
        let turn = coast_phase_sum(pair);
        let back = flank_force(table, &knots, plane, |phase| (turn - phase, -1.0));
        ContactForce::new(knots, [&driving, &back])
            .map(Arc::new)
            .map_err(|error| SolveError::failed(Stage::Mesh, "contact-failed", &error))
    };
    let forces: Vec<Arc<ContactForce>> = tables.iter().map(force).collect::<Result<_, _>>()?;
    let most = |of: &dyn Fn(&ForceTable) -> f64| tables.iter().map(of).fold(0.0f64, f64::max);
    let top = |table: &ForceTable| {
        let row = table.force_n.last();
        row.into_iter().flatten().copied().fold(f64::INFINITY, f64::min)
    };
    let summary = ContactForceTable {
        levels: most(&|table| (table.level_m.len() - 1) as f64) as u32,
        phases: most(&|table| table.phase.len() as f64) as u32,
        error_percent: 100.0 * most(&|table| table.error),
        largest_force_n: tables.iter().map(top).fold(f64::INFINITY, f64::min),
    };
    let last = forces.len() - 1;
    Ok(MeshForces { forces: [forces[0].clone(), forces[last].clone()], summary })
}

/// A flank's force at `knots`, along s of the plane in use. `place` gives the phase of the table at a phase of the equations, and the sign with which it
/// runs.
fn flank_force(
    table: &ForceTable,
    knots: &[f64],
    plane: &MotionPlane,
    place: impl Fn(f64) -> (f64, f64),
) -> FlankForce {
    let spline = SplineKnots::new(table.phase.clone());
    // F_n s and F_bt δ are the same work.
    let force_factor = plane.stiffness_factor.sqrt();
    let at = |values: &[f64]| -> Vec<[f64; 2]> {
        let slopes = spline.slopes(values);
        knots
            .iter()
            .map(|&knot| {
                let (phase, sign) = place(knot);
                let (value, slope) = spline.value_and_slope(values, &slopes, phase);
                [value, sign * slope]
            })
            .collect()
    };
    let nodes = table
        .force_n
        .iter()
        .zip(&table.stiffness_n_per_m)
        .map(|(force, stiffness)| {
            let (force, stiffness) = (at(force), at(stiffness));
            let node = |(f, k): (&[f64; 2], &[f64; 2])| {
                [f[0] * force_factor, k[0] * plane.stiffness_factor, f[1] * force_factor, k[1] * plane.stiffness_factor]
            };
            force.iter().zip(&stiffness).map(node).collect()
        })
        .collect();
    FlankForce {
        level_m: table.level_m.iter().map(|level| level / force_factor).collect(),
        free_m: at(&table.free_m).into_iter().map(|free| free.map(|v| v / force_factor)).collect(),
        nodes,
    }
}

/// Sum of the phases of the driving flanks' and of the back flanks' contact, from the symmetry of the pinion's tooth.
///
/// The flanks of one tooth touch at the roll lengths x and x' with x + x' = 2 r_b1 (α_wt + ψ_b1), ψ_b1 half the angle of the tooth at the base circle; the back
/// flanks' contact is that of the mirrored pair run backwards, whose lines enter at the other end of the face.
fn coast_phase_sum(pair: &Pair) -> f64 {
    let both = 2.0 * pair.pinion.base_radius_m * (pair.working_pressure_angle_rad + pair.pinion.base_half_angle_rad);
    let lines = pair.spec.face_width_m * pair.base_helix_angle_rad.tan();
    (both - 2.0 * pair.path_start_m + lines) / pair.base_pitch_m
}
