//! The compliance of the teeth: computed once per job and pair of gears, finite elements once per gear and store.

use super::hash::{compliance_hash, flank_hash};
use super::mesh::ContactCase;
use super::{SolveContext, SolveError, Stage};
use crate::document::Fidelity;
use herringbone_physics::compliance::Compliance;
use herringbone_physics::fe::{FeError, FlankFlexibility, FlankFlexibilityInput};
use herringbone_physics::gear::{FlankModification, Pair, Rotation};
use herringbone_physics::watch::Watch;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Compliances of one job, so that the points of a sweep share them.
#[derive(Default)]
pub(super) struct ComplianceMemo(Mutex<HashMap<String, Arc<Compliance>>>);

/// Largest number of compliances kept: a sweep over the teeth does not use old ones again.
pub(super) const KEPT: usize = 8;

/// Stations of a uniform foundation on shafts, whose flexibility is read between them.
const SHAFT_STATIONS: usize = 40;

/// Fraction of the progress of the mesh stage assigned to the solution of the finite elements.
const ELEMENTS_PART: f64 = 0.95;

/// A compliance and its origin.
pub(super) struct Found {
    pub compliance: Arc<Compliance>,
    /// Whether the finite elements of both gears were read from the store.
    pub elements_reused: bool,
    /// Fraction of the mesh stage that is done.
    pub done: f64,
}

/// The compliance of `case`, from the job's memory, from stored finite elements or computed.
pub(super) fn find(
    case: &ContactCase,
    pair: &Pair,
    context: &SolveContext,
    memo: &ComplianceMemo,
) -> Result<Found, SolveError> {
    let key = compliance_hash(case);
    let kept = memo.0.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
    if let Some(compliance) = kept {
        return Ok(Found { compliance, elements_reused: false, done: 0.0 });
    }
    let watch = Watch::new(&|_| {}, context.canceled);
    let (compliance, elements_reused, done) = match case.fidelity {
        Fidelity::Analytic => (Compliance::analytic(pair, &case.settings, watch)?, false, 0.0),
        Fidelity::Uniform => {
            let stations = if case.mounted.is_some() { SHAFT_STATIONS } else { 0 };
            let stiffness = case.line_stiffness_n_per_m2;
            (Compliance::uniform_between(pair, &case.settings, stiffness, stations), false, 0.0)
        }
        Fidelity::Fe => {
            let inputs = Compliance::finite_element_inputs(pair, &case.settings, case.resolution);
            let (pinion, pinion_reused) = flank(&inputs[0], context, (0.0, 0.4 * ELEMENTS_PART))?;
            let (gear, gear_reused) = flank(&inputs[1], context, (0.4 * ELEMENTS_PART, ELEMENTS_PART))?;
            let reused = pinion_reused && gear_reused;
            let compliance = Compliance::finite_elements(pair, &case.settings, [&pinion, &gear], watch)?;
            (compliance, reused, if reused { 0.0 } else { ELEMENTS_PART })
        }
    };
    let compliance = Arc::new(compliance);
    let mut map = memo.0.lock().unwrap_or_else(PoisonError::into_inner);
    if map.len() >= KEPT {
        map.clear();
    }
    map.insert(key, compliance.clone());
    Ok(Found { compliance, elements_reused, done })
}

/// Finite elements of one gear, read from the store or solved (over the given part of the stage's progress), and
/// whether they were read from the store.
fn flank(
    input: &FlankFlexibilityInput,
    context: &SolveContext,
    (from, to): (f64, f64),
) -> Result<(FlankFlexibility, bool), SolveError> {
    let key = flank_hash(input.key());
    let stored = context.stages.load(&key).and_then(|bytes| FlankFlexibility::from_bytes(&bytes).ok());
    if let Some(flank) = stored {
        return Ok((flank, true));
    }
    let progress = |fraction: f64| (context.progress)(Stage::Mesh, from + (to - from) * fraction);
    let flank = FlankFlexibility::new(input, Watch::new(&progress, context.canceled)).map_err(|error| match error {
        FeError::Canceled(canceled) => canceled.into(),
        other => SolveError::failed(Stage::Mesh, "finite-elements-failed", &other),
    })?;
    context.stages.save(&key, Stage::Mesh, &flank.to_bytes());
    Ok((flank, false))
}

/// The specification on which the compliance depends: that of `case` without flank modifications and misalignments.
pub(super) fn bare(case: &ContactCase) -> herringbone_physics::gear::PairSpec {
    let mut spec = *case.spec;
    for gear in [&mut spec.pinion, &mut spec.gear] {
        gear.flanks = [FlankModification::NONE; 2];
        gear.coast_flanks = None;
    }
    // Drive and coast flanks of the same teeth share it.
    spec.rotation = Rotation::ApexLeading;
    spec.assembly.in_plane_misalignment_m = 0.0;
    spec.assembly.out_of_plane_misalignment_m = 0.0;
    spec.assembly.apex_offset_m = 0.0;
    spec
}
