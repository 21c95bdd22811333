//! One operating point: the stages of a document, in their order.

use super::check::CheckedJob;
use super::equations::{self, MotionPlane};
use super::mesh::{self, MeshMemo};
use super::prepare::geometry;
use super::rotor::{self, TurningRotor};
use super::shaft_contact::{self, MountedTrain, ShaftContact};
use super::{RecordedChannel, SolveContext, SolveError, Stage, accuracy, bounds, impact, response_result, vibration};
use crate::document::{Fidelity, JobDocument, JobKind, MeshStiffness, Recorded};
use crate::result::{JobResult, NaturalMode, NumericsResult, Poincare};
use herringbone_physics::dynamics::{DynamicsError, Parameters};
use herringbone_physics::response::Response;

/// A solved point.
pub(super) struct Point {
    pub result: JobResult,
    pub series: Vec<RecordedChannel>,
    /// State at the end (24 numbers in the source's order), to continue a neighbouring point from.
    pub end_state: Option<Vec<f64>>,
    /// Poincaré points and spectrum for the row of a sweep, if requested.
    pub poincare: Option<Poincare>,
    pub bands: Option<Vec<f64>>,
}

/// Extent of the solution of a point.
pub(super) struct PointOptions<'a> {
    /// A neighbour's end state to continue from.
    pub start: Option<&'a [f64]>,
    /// Whether the whole result is made; a point of a sweep leaves out the parts that its row does not contain.
    pub whole: bool,
    /// Requested data of the row of a sweep beside its numbers.
    pub record: &'a [Recorded],
}

impl PointOptions<'_> {
    /// The options of a single response.
    pub(super) const WHOLE: Self = Self { start: None, whole: true, record: &[] };

    pub(super) fn records(&self, data: Recorded) -> bool {
        self.record.contains(&data)
    }
}

/// A point with the stages before its response, and the equations of motion if the document requests a response.
pub(super) struct Staged<'a> {
    result: JobResult,
    on_shafts: Option<ShaftContact>,
    rotor: Option<TurningRotor>,
    parameters: Option<Parameters>,
    stopwatch: Stopwatch<'a>,
}

impl Staged<'_> {
    /// Adds to the block `shafts` what a single point shows beside its own contact.
    fn complete_shafts(&mut self, job: &CheckedJob, context: &SolveContext, memo: &MeshMemo) -> Result<(), SolveError> {
        let (document, prepared) = (job.document(), job.prepared());
        let (Some(contact), Some(shafts), MeshStiffness::Ltca(ltca)) =
            (&self.on_shafts, &mut self.result.shafts, &document.model.mesh_stiffness)
        else {
            return Ok(());
        };
        let case = mesh::ContactCase::new(document, ltca, prepared);
        shaft_contact::complete(document, &case, &prepared.pair, (contact, shafts), context, memo)?;
        self.result.numerics.wall_ms.mesh += self.stopwatch.lap_ms();
        Ok(())
    }

    pub(super) fn parameters(&self) -> Option<&Parameters> {
        self.parameters.as_ref()
    }

    /// The natural modes of the equations of motion, if the document requests a response.
    ///
    /// # Errors
    /// [`DynamicsError`] if the equations are refused.
    pub(super) fn natural_modes(&self) -> Result<Option<Vec<NaturalMode>>, DynamicsError> {
        let Some(parameters) = &self.parameters else { return Ok(None) };
        match &self.rotor {
            None => response_result::natural_modes(parameters).map(Some),
            Some(rotor) => Ok(Some(rotor.natural_modes(parameters))),
        }
    }
}

/// Solves one point.
///
/// # Errors
/// [`SolveError`].
pub(super) fn solve(
    job: &CheckedJob,
    context: &SolveContext,
    memo: &MeshMemo,
    options: &PointOptions,
) -> Result<Point, SolveError> {
    let progress = |stage, fraction| (context.progress)(stage, of_whole(job.document(), stage, fraction));
    let context = &SolveContext { progress: &progress, ..*context };
    let mut staged = stage(job, context, memo)?;
    if options.whole {
        staged.complete_shafts(job, context, memo)?;
    }
    respond(job.document(), staged, context, options)
}

/// Geometry, contact and impact of a point, and the equations of motion that follow.
///
/// # Errors
/// [`SolveError`].
pub(super) fn stage<'a>(
    job: &CheckedJob,
    context: &SolveContext<'a>,
    memo: &MeshMemo,
) -> Result<Staged<'a>, SolveError> {
    let (document, prepared) = (job.document(), job.prepared());
    let mut numerics = NumericsResult { solver_version: super::SOLVER_VERSION.to_owned(), ..NumericsResult::default() };
    let mut stopwatch = Stopwatch::new(context);
    let mut warnings = prepared.warnings.clone();
    numerics.wall_ms.geometry = stopwatch.lap_ms();
    (context.progress)(Stage::Geometry, 1.0);

    let plane = MotionPlane::new(document.model.plane, prepared);
    let (mesh, reused) = mesh::run(document, prepared, &plane, context, memo)?;
    numerics.reused.extend(reused);
    warnings.extend(bounds::of_mesh(document, &mesh.summary));
    numerics.wall_ms.mesh = stopwatch.lap_ms();

    let impact = impact::run(document, prepared, &plane, &mesh, &mut warnings);
    numerics.wall_ms.impact = stopwatch.lap_ms();
    (context.progress)(Stage::Impact, 1.0);

    let mounted = MountedTrain::of(document, &prepared.pair).filter(|_| document.kind != JobKind::Mesh);
    let rotor = mounted.map(|mounted| rotor::find(document, prepared, &mounted, &mesh, (context, memo))).transpose()?;
    let parameters = (document.kind != JobKind::Mesh).then(|| {
        let lead = if mesh.stagger_included { 0.0 } else { document.design.half_stagger };
        let parameters = equations::parameters(document, prepared, &plane, mesh.stiffness.clone(), impact.pulses, lead);
        let parameters = match &mesh.forces {
            None => parameters,
            Some(contact) => equations::with_contact_forces(document, parameters, &contact.forces),
        };
        match &rotor {
            None => parameters,
            Some(rotor) => rotor.in_equations(parameters, document),
        }
    });
    let result = JobResult {
        geometry: Some(geometry(prepared)),
        shafts: mesh.on_shafts.as_ref().map(|contact| shaft_contact::result(document, &prepared.pair, contact)),
        mesh: Some(mesh.summary.clone()),
        impact: impact.summary,
        supports: (document.kind != JobKind::Mesh && document.design.shafts.is_none())
            .then(|| prepared.supports.clone()),
        warnings,
        numerics,
        ..JobResult::default()
    };
    Ok(Staged { result, on_shafts: mesh.on_shafts.clone(), rotor, parameters, stopwatch })
}

/// The response of a staged point, where it has equations.
///
/// # Errors
/// [`SolveError`].
pub(super) fn respond(
    document: &JobDocument,
    staged: Staged,
    context: &SolveContext,
    options: &PointOptions,
) -> Result<Point, SolveError> {
    let solve = |parameters| vibration::solve(document, parameters, options, context);
    let response = staged.parameters().map(solve).transpose()?;
    assemble(document, staged, options, response)
}

/// A staged point with the response to its equations, where it has any.
///
/// # Errors
/// [`SolveError`].
pub(super) fn assemble(
    document: &JobDocument,
    staged: Staged,
    options: &PointOptions,
    response: Option<Result<Response, DynamicsError>>,
) -> Result<Point, SolveError> {
    let Staged { mut result, parameters, mut stopwatch, rotor, .. } = staged;
    let (Some(parameters), Some(response)) = (parameters, response) else {
        result.accuracy = Some(accuracy::of(document, &result));
        return Ok(Point { result, series: Vec::new(), end_state: None, poincare: None, bands: None });
    };
    let equations = (&parameters, rotor.as_ref());
    let vibration = vibration::to_result(document, equations, options, response, &mut result.numerics)?;
    result.response = Some(vibration.summary);
    result.accuracy = Some(accuracy::of(document, &result));
    result.warnings.extend(vibration.warnings);
    result.numerics.wall_ms.response = stopwatch.lap_ms();
    Ok(Point {
        result,
        series: vibration.series,
        end_state: vibration.end_state,
        poincare: vibration.poincare,
        bands: vibration.bands,
    })
}

/// Progress of the whole point, 0 to 1, at a fraction of one of its stages, by the usual computing times of the stages.
fn of_whole(document: &JobDocument, stage: Stage, fraction: f64) -> f64 {
    let has_elements =
        matches!(&document.model.mesh_stiffness, MeshStiffness::Ltca(ltca) if ltca.fidelity == Fidelity::Fe);
    let mesh_ends = match document.kind {
        JobKind::Mesh => 0.98,
        // Unless they are stored, finite elements take nearly all of the time.
        _ if has_elements => 0.95,
        _ => 0.6,
    };
    let (start, end) = match stage {
        Stage::Geometry => (0.0, 0.01),
        Stage::Mesh => (0.01, mesh_ends),
        Stage::Impact => (mesh_ends, mesh_ends + 0.02),
        Stage::Response | Stage::Sweep | Stage::Evaluations => (mesh_ends + 0.02, 1.0),
    };
    start + (end - start) * fraction.clamp(0.0, 1.0)
}

/// Times the stages of a point by the clock of the context.
struct Stopwatch<'a> {
    clock_ms: &'a (dyn Fn() -> f64 + Sync),
    last_ms: f64,
}

impl<'a> Stopwatch<'a> {
    fn new(context: &SolveContext<'a>) -> Self {
        Self { clock_ms: context.clock_ms, last_ms: (context.clock_ms)() }
    }

    /// Milliseconds since the last call, or since the stopwatch was made.
    fn lap_ms(&mut self) -> f64 {
        let now_ms = (self.clock_ms)();
        now_ms - std::mem::replace(&mut self.last_ms, now_ms)
    }
}
