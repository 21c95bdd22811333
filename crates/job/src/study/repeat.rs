//! A point of a sweep as a job of its own: its document, and the comparison of its motion with that of the sweep.

use super::{branches, input_hash};
use crate::document::{JobDocument, SweepPointInput};
use crate::result::{BranchDifference, JobResult, PerHalf, RegimeResult, SweepPoint};
use crate::warning::Warning;

/// Start of the motion of a point of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub enum PointStart {
    /// That of the sweep's document: a point without a neighbour whose motion it could continue.
    OfDocument,
    /// The state at the end of its neighbour.
    Continued(Vec<f64>),
    /// Not known: the neighbour's state is not stored.
    Unknown,
}

/// The document of a point of the sweep `job` as a job of its own, from the same start and so with the same motion.
/// `row`: the solved point. `None` if the sweep has no such point.
pub fn point_document(
    sweep: &JobDocument,
    job: &str,
    position: usize,
    start: PointStart,
    row: Option<&SweepPoint>,
) -> Option<JobDocument> {
    let mut document = sweep.of_row(position)?;
    let same_start = start != PointStart::Unknown;
    if let PointStart::Continued(state) = start {
        document.analysis.initial_state = Some(state);
    }
    let rms = row.and_then(|row| row.mesh_circumferential_acceleration_rms_m_s2);
    document.sweep_point = Some(SweepPointInput {
        job: job.to_owned(),
        position: u32::try_from(position).ok()?,
        input_hash: motion_hash(&document),
        same_start,
        mesh_circumferential_acceleration_rms_m_s2: rms.map(|rms| vec![rms.left, rms.right]),
        error_estimate: row.and_then(|row| row.error_estimate),
        regime: row.and_then(|row| row.regime).map(|regime| regime.as_str().into_owned()),
    });
    Some(document)
}

/// Hash of the inputs that determine the motion: not what is recorded of it.
fn motion_hash(document: &JobDocument) -> String {
    let mut document = JobDocument { sweep_point: None, ..document.clone() };
    document.analysis.channels = None;
    document.analysis.samples_per_mesh_period = 0;
    input_hash(&document)
}

/// Warning of a document with the start of a point of a sweep, but other inputs than the point has.
pub(super) fn changed_inputs(document: &JobDocument) -> Option<Warning> {
    let point = document.sweep_point.as_ref()?;
    document.analysis.initial_state.as_ref()?;
    (motion_hash(document) != point.input_hash).then(|| Warning {
        code: "initial-state-of-other-inputs".to_owned(),
        pointer: "/analysis/initial_state".to_owned(),
        detail: format!(
            "inputs were changed since the start of the motion was taken from point {} of a sweep; without the given \
             initial state the motion is found from rest, and may be another one",
            point.position + 1
        ),
    })
}

/// Warnings of a job that repeats a point of a sweep: that its motion is another one than the sweep's, that it may be,
/// or that its start belongs to other inputs.
pub(super) fn warnings(document: &JobDocument, result: &JobResult) -> Vec<Warning> {
    let Some(point) = &document.sweep_point else { return Vec::new() };
    if motion_hash(document) != point.input_hash {
        return changed_inputs(document).into_iter().collect();
    }
    let of_point = |code: &str, detail: String| {
        vec![Warning { code: code.to_owned(), pointer: "/sweep_point".to_owned(), detail }]
    };
    let number = point.position + 1;
    let own = SweepPoint::of_result(Vec::new(), result);
    let theirs = SweepPoint {
        mesh_circumferential_acceleration_rms_m_s2: match point.mesh_circumferential_acceleration_rms_m_s2.as_deref() {
            Some([left, right]) => Some(PerHalf { left: *left, right: *right }),
            _ => None,
        },
        error_estimate: point.error_estimate,
        regime: point.regime.as_deref().and_then(RegimeResult::parse),
        // Not known, so not compared.
        contact: own.contact,
        ..SweepPoint::default()
    };
    let rms = |row: &SweepPoint| row.mesh_circumferential_acceleration_rms_m_s2.map(|halves| halves.left);
    let (Some(own_rms), Some(their_rms)) = (rms(&own), rms(&theirs)) else {
        if point.same_start {
            return Vec::new();
        }
        let detail = format!(
            "the state from which the sweep reaches its point {number} is not stored, so that the motion is found from \
             rest; where several motions exist it may be another one than the sweep's"
        );
        return of_point("may-differ-from-sweep-point", detail);
    };
    let word = |row: &SweepPoint| row.regime.map(|regime| regime.as_str()).unwrap_or_default();
    let differ = branches::differences(&own, &theirs);
    if differ.is_empty() {
        return Vec::new();
    }
    let and = |regime: std::borrow::Cow<str>| match differ.contains(&BranchDifference::Regime) {
        true => format!(" ({regime})"),
        false => String::new(),
    };
    let detail = format!(
        "this is another motion than that of point {number} of the sweep: RMS of the mesh acceleration of the left half \
         {own_rms:.4} m/s²{} instead of {their_rms:.4} m/s²{}",
        and(word(&own)),
        and(word(&theirs)),
    );
    of_point("differs-from-sweep-point", detail)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_value;
    use crate::study::{CheckedJob, LineEnd, Outcome, PointStore, SolveContext, StoredPoints, continued_from, solve};
    use serde_json::{Value, json};
    use std::collections::HashMap;
    use std::sync::Mutex;

    /// States at the ends of the points, by position.
    #[derive(Default)]
    struct States(Mutex<HashMap<usize, Vec<f64>>>);

    impl PointStore for States {
        fn load(&self) -> StoredPoints {
            StoredPoints::default()
        }

        fn save(&self, _position: usize, _row: &SweepPoint, end: Option<&LineEnd>) {
            let Some(LineEnd { position, state: Some(state), .. }) = end else { return };
            self.0.lock().expect("unpoisoned").insert(*position, state.clone());
        }
    }

    /// Around the main resonance the teeth separate, and the curve bends over to lower speeds: two motions.
    fn bistable() -> Value {
        let mut value: Value =
            serde_json::from_str(include_str!("../../../../examples/given_stiffness.json")).expect("JSON");
        value["kind"] = json!("sweep");
        value["analysis"] = json!({"accuracy": 1e-4});
        value["operation"]["pinion_torque_nm"] = json!(300.0);
        value["model"]["mesh_damping_ratio"] = json!(0.01);
        value["model"]["mesh_stiffness"]["harmonics"] = json!([{"amplitude": 0.15, "phase_rad": 0.3}]);
        value["model"]["impact"] = json!({"source": "none"});
        value["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 10500, "to": 8500, "points": 21}]);
        value["continuation"] = json!("both");
        value
    }

    fn solved(document: &JobDocument, context: &SolveContext) -> Outcome {
        // As a client sends it.
        let sent = parse_value(&serde_json::to_value(document).expect("JSON")).expect("valid");
        solve(&CheckedJob::new(sent).expect("feasible"), context).expect("solved")
    }

    fn rms(row: &SweepPoint) -> f64 {
        row.mesh_circumferential_acceleration_rms_m_s2.expect("a motion").left
    }

    fn codes(outcome: &Outcome) -> Vec<&str> {
        let codes = outcome.result.warnings.iter().map(|warning| warning.code.as_str());
        codes.filter(|code| code.contains("sweep-point") || code.contains("initial-state")).collect()
    }

    /// The points of `sweep` at `positions` as jobs of their own, each with the row of the sweep.
    fn repeated(sweep: &JobDocument, positions: &[usize]) -> Vec<(JobDocument, Outcome, SweepPoint)> {
        let states = States::default();
        let outcome = solved(sweep, &SolveContext { points: &states, ..SolveContext::none() });
        let rows = outcome.result.sweep.expect("a sweep").points;
        let states = states.0.into_inner().expect("unpoisoned");
        let one = |position: usize| {
            let start = match continued_from(sweep, position) {
                None => PointStart::OfDocument,
                Some(before) => states.get(&before).cloned().map_or(PointStart::OfDocument, PointStart::Continued),
            };
            let document = point_document(sweep, "id", position, start, Some(&rows[position])).expect("a point");
            let outcome = solved(&document, &SolveContext::none());
            (document, outcome, rows[position].clone())
        };
        positions.iter().map(|position| one(*position)).collect()
    }

    #[test]
    fn the_points_of_both_branches_are_the_motions_of_the_sweep_to_the_last_bit() {
        let sweep = parse_value(&bistable()).expect("valid");
        let all: Vec<usize> = (0..42).collect();
        let repeated = repeated(&sweep, &all);
        let mut twofold = 0;
        for (position, (_, outcome, row)) in repeated.iter().enumerate() {
            let own = SweepPoint::of_result(Vec::new(), &outcome.result);
            assert_eq!((rms(&own), own.regime, own.contact), (rms(row), row.regime, row.contact), "{position}");
            assert_eq!(codes(outcome), Vec::<&str>::new(), "{position}");
            twofold += usize::from(position < 21 && rms(row) < 0.9 * rms(&repeated[position + 21].2));
        }
        assert!(twofold > 2, "{twofold} points with two motions");
    }

    #[test]
    fn motions_that_do_not_repeat_are_the_same_too() {
        let mut value: Value =
            serde_json::from_str(include_str!("../../../../examples/given_stiffness.json")).expect("JSON");
        value["kind"] = json!("sweep");
        value["analysis"] = json!({"accuracy": 1e-3});
        value["operation"]["pinion_torque_nm"] = json!(100.0);
        let speeds = json!([9000.0, 9333.0, 9667.0, 10_000.0, 10_333.0, 10_667.0]);
        value["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "values": speeds}]);
        value["continuation"] = json!("up");
        let sweep = parse_value(&value).expect("valid");
        let mut aperiodic = 0;
        for (_, outcome, row) in repeated(&sweep, &[0, 1, 2, 3, 4, 5]) {
            let own = SweepPoint::of_result(Vec::new(), &outcome.result);
            assert_eq!((rms(&own), own.regime), (rms(&row), row.regime));
            assert_eq!(codes(&outcome), Vec::<&str>::new());
            aperiodic += usize::from(!matches!(row.regime, Some(RegimeResult::Period(_))));
        }
        assert!(aperiodic > 0);
    }

    #[test]
    fn another_motion_is_said_on_the_job() {
        let sweep = parse_value(&bistable()).expect("valid");
        let repeated = repeated(&sweep, &(0..42).collect::<Vec<_>>());
        let (mut differing, mut changed) = (0, 0);
        for (upper, lower) in (0..21).map(|position| (&repeated[position + 21], &repeated[position])) {
            let twofold = rms(&lower.2) < 0.9 * rms(&upper.2);
            // Of the upper motion: the document as versions without stored states gave it.
            let mut document = upper.0.clone();
            document.analysis.initial_state = None;
            let input_hash = motion_hash(&document);
            document.sweep_point =
                document.sweep_point.map(|point| SweepPointInput { input_hash, same_start: false, ..point });
            let outcome = solved(&document, &SolveContext::none());
            assert_eq!(codes(&outcome), if twofold { vec!["differs-from-sweep-point"] } else { vec![] });
            differing += usize::from(twofold);
            if differing == 1 && twofold {
                // Without the values of the sweep.
                let mut unknown = document.clone();
                unknown.sweep_point = unknown
                    .sweep_point
                    .map(|point| SweepPointInput { mesh_circumferential_acceleration_rms_m_s2: None, ..point });
                assert_eq!(codes(&solved(&unknown, &SolveContext::none())), ["may-differ-from-sweep-point"]);
                // Another torque, with the start of the point.
                let mut other = upper.0.clone();
                other.operation.pinion_torque_nm += 1.0;
                assert_eq!(codes(&solved(&other, &SolveContext::none())), ["initial-state-of-other-inputs"]);
                let checked = CheckedJob::new(other).expect("feasible").report().warnings;
                assert!(checked.iter().any(|warning| warning.code == "initial-state-of-other-inputs"));
                // What is recorded does not matter.
                let mut recorded = upper.0.clone();
                recorded.analysis.samples_per_mesh_period = 64;
                assert_eq!(codes(&solved(&recorded, &SolveContext::none())), Vec::<&str>::new());
                changed += 1;
            }
        }
        assert!(differing > 2 && changed == 1, "{differing} {changed}");
    }

    #[test]
    fn a_point_continues_from_its_neighbour_on_its_branch() {
        let mut value = bistable();
        value["axes"] = json!([
            {"pointer": "/operation/pinion_speed_rpm", "values": [3000.0, 1000.0, 2000.0]},
            {"pointer": "/operation/pinion_torque_nm", "values": [100.0, 200.0]},
        ]);
        let sweep = parse_value(&value).expect("valid");
        // Rows: up at 100 N m, up at 200 N m, down at 100, down at 200.
        let found: Vec<_> = (0..13).map(|position| continued_from(&sweep, position)).collect();
        let up = [Some(2), None, Some(1), Some(5), None, Some(4)];
        let down = [None, Some(8), Some(6), None, Some(11), Some(9)];
        assert_eq!(found[..6], up);
        assert_eq!(found[6..12], down);
        assert_eq!(found[12], None);
        value["continuation"] = json!("none");
        let alone = parse_value(&value).expect("valid");
        assert!((0..6).all(|position| continued_from(&alone, position).is_none()));
    }
}
