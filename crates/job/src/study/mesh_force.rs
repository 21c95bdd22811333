//! The mesh force of the equations of motion by the loaded contact, from the contact analysis of both halves.

use super::compliance;
use super::equations::MotionPlane;
use super::hash::force_hash;
use super::mesh::{ContactCase, MeshMemo, contact_failed};
use super::shaft_contact::ShaftContact;
use super::{SolveContext, SolveError, Stage};
use crate::result::ContactForceTable;
use herringbone_physics::contact::{ForceTable, same_gaps};
use herringbone_physics::dynamics::{ContactForce, FlankForce};
use herringbone_physics::gear::{Half, Pair};
use herringbone_physics::numerics::PeriodicSpline;
use herringbone_physics::watch::Watch;
use std::sync::Arc;

/// The contact force of both halves, along s of the plane in use.
#[derive(Debug, Clone)]
pub(super) struct MeshForces {
    /// Left, right; identical if the halves are.
    pub forces: [Arc<ContactForce>; 2],
    pub summary: ContactForceTable,
}

/// Accuracy of the table of the unloaded flanks over that of the loaded ones: the unloaded flanks touch only after the
/// whole backlash is crossed.
const IDLE_FLANKS: f64 = 10.0;
/// The coarsest accuracy of a table.
const LOOSEST: f64 = 0.05;

/// Force tables of one half, or of both if they differ, of the flanks that carry the torque or of the others; from the
/// job's memo or the store, else solved.
fn tables(
    case: &ContactCase,
    pair: &Pair,
    on_shafts: Option<&ShaftContact>,
    flanks: Flanks,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<Arc<Vec<ForceTable>>, SolveError> {
    let key = force_hash(case, flanks.are_idle);
    if let Some(tables) = memo.forces.get(&key) {
        return Ok(tables);
    }
    let stored = context.stages.load(&key).and_then(|bytes| serde_json::from_slice::<Vec<ForceTable>>(&bytes).ok());
    let tables = match stored {
        Some(tables) => tables,
        None => {
            let compliances = compliance::find(case, pair, context, &memo.compliances)?;
            let quiet = |_: f64| {};
            let watch = Watch::new(&quiet, context.canceled);
            let force_n = case.half_force_n(pair).abs();
            let mut settings = case.settings;
            if flanks.are_idle {
                settings.accuracy = (IDLE_FLANKS * settings.accuracy).min(LOOSEST);
            }
            // Of the flanks that carry, with the bodies displaced by the shafts under the working load.
            let loaded = on_shafts.filter(|_| !flanks.are_idle);
            let equal = loaded.is_none() && same_gaps(flanks.pair);
            let halves: &[Half] = if equal { &[Half::Left] } else { &Half::BOTH };
            let with = (&*compliances.compliance, &settings);
            let tables: Result<Vec<_>, _> = halves
                .iter()
                .map(|&half| {
                    let field = loaded.map(|contact| contact.loaded.field_about_mesh_section(&contact.shafts, half));
                    ForceTable::displaced(flanks.pair, half, field.as_ref(), force_n, with, watch)
                })
                .collect();
            let tables = tables.map_err(contact_failed)?;
            context.stages.save(&key, Stage::Mesh, &serde_json::to_vec(&tables).unwrap_or_default());
            tables
        }
    };
    let tables = Arc::new(tables);
    memo.forces.put(key, tables.clone());
    Ok(tables)
}

/// The flanks on one side of the teeth, as the drive flanks of a pair.
#[derive(Clone, Copy)]
struct Flanks<'a> {
    pair: &'a Pair,
    /// Whether these are the flanks that do not carry the torque.
    are_idle: bool,
}

/// The forces of both halves in the equations' coordinates.
///
/// # Errors
/// [`SolveError`] if the contact cannot be solved.
pub(super) fn run(
    case: &ContactCase,
    pair: &Pair,
    on_shafts: Option<&ShaftContact>,
    plane: &MotionPlane,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<MeshForces, SolveError> {
    let coast = pair.coast();
    let driven = case.torque_nm < 0.0;
    let (working, idle) = if driven { (&coast, pair) } else { (pair, &coast) };
    let loaded = tables(case, pair, on_shafts, Flanks { pair: working, are_idle: false }, context, memo)?;
    let unloaded = if on_shafts.is_none() && same_flanks(working, idle) {
        loaded.clone()
    } else {
        tables(case, pair, on_shafts, Flanks { pair: idle, are_idle: true }, context, memo)?
    };
    let of_half = |tables: &'_ Arc<Vec<ForceTable>>, half: usize| half.min(tables.len() - 1);
    let force = |half: usize| {
        let (loaded_table, unloaded_table) = (&loaded[of_half(&loaded, half)], &unloaded[of_half(&unloaded, half)]);
        // Phases of the coast flanks fall as those of the equations grow.
        let mut knots = loaded_table.phase.clone();
        if driven {
            knots = knots.into_iter().map(|phase| pair.coast_phase(phase)).collect();
            knots.sort_by(f64::total_cmp);
        }
        let (of_driving, of_coast) =
            if driven { (unloaded_table, loaded_table) } else { (loaded_table, unloaded_table) };
        let driving = flank_force(of_driving, &knots, plane, |phase| (phase, 1.0));
        let back = flank_force(of_coast, &knots, plane, |phase| (pair.coast_phase(phase), -1.0));
        ContactForce::new(knots, [&driving, &back])
            .map(Arc::new)
            .map_err(|error| SolveError::failed(Stage::Mesh, "contact-failed", &error))
    };
    let left = force(0)?;
    let right = if loaded.len() == 1 && unloaded.len() == 1 { left.clone() } else { force(1)? };
    let most = |of: &dyn Fn(&ForceTable) -> f64| loaded.iter().map(of).fold(0.0f64, f64::max);
    let top = |table: &ForceTable| {
        let row = table.force_n.last();
        row.into_iter().flatten().copied().fold(f64::INFINITY, f64::min)
    };
    let summary = ContactForceTable {
        levels: most(&|table| (table.level_m.len() - 1) as f64) as u32,
        phases: most(&|table| table.phase.len() as f64) as u32,
        error_percent: 100.0 * most(&|table| table.error),
        largest_force_n: loaded.iter().map(top).fold(f64::INFINITY, f64::min),
    };
    Ok(MeshForces { forces: [left, right], summary })
}

/// True where both sides of the teeth have the same gaps through the mesh, sampled on a grid finer than any
/// modification needs.
fn same_flanks(one: &Pair, other: &Pair) -> bool {
    const GRID: usize = 16;
    let (length_m, width_m) = (one.path_end_m - one.path_start_m, one.spec.face_width_m);
    let gap = |pair: &Pair, half: Half, i: usize, j: usize| {
        let entry_m = width_m * j as f64 / GRID as f64;
        // entry_m is its own inverse.
        pair.initial_gap_m(half, pair.path_start_m + length_m * i as f64 / GRID as f64, pair.entry_m(entry_m))
    };
    Half::BOTH.into_iter().all(|half| {
        (0..=GRID).all(|i| {
            (0..=GRID).all(|j| {
                let (a, b) = (gap(one, half, i, j), gap(other, half, i, j));
                (a - b).abs() <= 1e-12 * (1e-6 + a.abs())
            })
        })
    })
}

/// Force of a flank at `knots`, along s of the plane in use. `place` maps a phase of the equations to that of the table
/// and the sign of its direction.
fn flank_force(
    table: &ForceTable,
    knots: &[f64],
    plane: &MotionPlane,
    place: impl Fn(f64) -> (f64, f64),
) -> FlankForce {
    let spline = PeriodicSpline::new(table.phase.clone());
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
