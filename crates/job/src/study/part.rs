//! A part of a sweep, a tolerance study or an optimisation that is solved apart from the rest, as on another machine:
//! some of its points, or a stretch of a line that is followed by continuation.

use super::mesh::MeshMemo;
use super::sweep::{Points, together, ways};
use super::{CheckedJob, EvaluationBatch, LineEnd, SolveContext, SolveError, branches, optimise, tolerance};
use crate::document::{Axis, JobDocument, JobKind};
use crate::result::BranchDirection;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The lines of a sweep and the order in which their points are solved.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepOrder {
    /// Number of lines: the values of the second axis, once for each direction of continuation.
    pub lines: usize,
    /// Points of a line.
    pub length: usize,
    ways: &'static [BranchDirection],
    /// Indices on the first axis from its least value up.
    upwards: Vec<usize>,
    /// Number of points that are solved in one go.
    together: usize,
}

impl SweepOrder {
    /// The order of a document of kind `sweep`; of one of kind `tolerance`, that of its evaluations: one line.
    pub fn of(document: &JobDocument) -> Self {
        if document.kind == JobKind::Tolerance {
            let length = usize::try_from(document.evaluations()).unwrap_or(usize::MAX);
            return Self { lines: 1, length, ways: &[], upwards: Vec::new(), together: 1 };
        }
        let ways = ways(document);
        let values = document.axes.get(1).map_or(1, Axis::len);
        let first = document.axes.first();
        let upwards = first.map(|first| branches::order(first, BranchDirection::Up)).unwrap_or_default();
        let (lines, length) = (values * ways.len().max(1), first.map_or(0, Axis::len));
        Self { lines, length, ways, upwards, together: together(document) }
    }

    /// Whether each point of a line continues the motion of the one before.
    pub fn is_continued(&self) -> bool {
        !self.ways.is_empty()
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.lines * self.length
    }

    /// Positions of the points of a line, in the order in which it is followed; in their own order without
    /// continuation.
    pub fn line(&self, line: usize) -> Vec<usize> {
        let position = |index: &usize| line * self.length + index;
        match self.way(line) {
            None => (0..self.length).map(|index| line * self.length + index).collect(),
            Some(BranchDirection::Up) => self.upwards.iter().map(position).collect(),
            Some(BranchDirection::Down) => self.upwards.iter().rev().map(position).collect(),
        }
    }

    /// The group with which a point without continuation is solved in one go; `None` for one that is solved alone. The
    /// last bits of a row may depend on the others of its group, so a part of a sweep has whole groups where it can.
    pub fn group(&self, position: usize) -> Option<usize> {
        let (line, index) = (position / self.length.max(1), position % self.length.max(1));
        (self.together > 1 && index > 0).then(|| (line * (self.length - 1) + index - 1) / self.together)
    }

    /// Direction in which a line is followed.
    pub(super) fn way(&self, line: usize) -> Option<BranchDirection> {
        let lines = self.lines / self.ways.len().max(1);
        self.ways.get(line / lines.max(1)).copied()
    }
}

/// A part of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub enum SweepPart {
    /// Points without continuation, by their positions.
    Points(Vec<usize>),
    /// Points of a line, in the order in which it is followed: those at the places `from` to `to` (not included) of
    /// [`SweepOrder::line`]. `start`: the state at the end of the point before.
    Stretch { line: usize, from: usize, to: usize, start: Option<Vec<f64>> },
    /// Evaluations of a document of kind `optimise`.
    Evaluations(EvaluationBatch),
}

/// Solves a part of a sweep: its rows go to the point store of the context. Returns where a line was left.
///
/// # Errors
/// [`SolveError::Canceled`]; [`SolveError::Failed`] when the sweep has no such part. The row of a point that fails
/// contains the error.
pub fn solve_part(job: &CheckedJob, part: &SweepPart, context: &SolveContext) -> Result<Option<LineEnd>, SolveError> {
    let (document, memo) = (job.document(), MeshMemo::default());
    let order = SweepOrder::of(document);
    let is_sweep = document.kind == JobKind::Sweep;
    match part {
        SweepPart::Points(positions) if document.kind == JobKind::Tolerance => {
            if positions.iter().any(|position| *position >= order.points()) {
                return Err(no_such_part());
            }
            tolerance::run_part(document, positions, context, &memo).map(|()| None)
        }
        SweepPart::Evaluations(batch) => {
            if document.kind != JobKind::Optimise {
                return Err(no_such_part());
            }
            optimise::run_part(document, batch, context, &memo).map(|()| None)
        }
        SweepPart::Points(positions) => {
            if !is_sweep || order.is_continued() || positions.iter().any(|position| *position >= order.points()) {
                return Err(no_such_part());
            }
            let points = Points::new(document, context, &memo, positions.len());
            let groups = groups(&order, positions);
            // The first one computes the parts that the others share (compliance, contact).
            let (first, others) = groups.split_at(groups.len().min(1));
            first.iter().try_for_each(|group| points.solve(group).map(drop))?;
            others.par_iter().try_for_each(|group| points.solve(group).map(drop))?;
            Ok(None)
        }
        SweepPart::Stretch { line, from, to, start } => {
            if !is_sweep || !order.is_continued() || *line >= order.lines || from >= to || *to > order.length {
                return Err(no_such_part());
            }
            let positions = order.line(*line);
            let points = Points::new(document, context, &memo, to - from);
            let (_, state) = points.follow(*line, &positions[*from..*to], start.clone())?;
            Ok(Some(LineEnd { line: *line, position: positions[*to - 1], state }))
        }
    }
}

/// Points in the groups that are solved in one go, those that are solved alone first.
fn groups(order: &SweepOrder, positions: &[usize]) -> Vec<Vec<usize>> {
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    let mut alone = Vec::new();
    for &position in positions {
        match order.group(position) {
            Some(group) => groups.entry(group).or_default().push(position),
            None => alone.push(vec![position]),
        }
    }
    alone.extend(groups.into_values());
    alone
}

fn no_such_part() -> SolveError {
    SolveError::Failed {
        stage: super::Stage::Sweep,
        code: "internal".to_owned(),
        detail: "the sweep has no such part".to_owned(),
        sim_time_s: None,
        step: None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::{NoStageStore, PointStore, StoredPoints, solve};
    use super::*;
    use crate::result::SweepPoint;
    use serde_json::{Value, json};
    use std::collections::BTreeMap;
    use std::sync::Mutex;

    fn sweep(change: impl Fn(&mut Value)) -> CheckedJob {
        let mut value: Value = serde_json::from_str(include_str!("../../../../examples/speed_sweep.json")).unwrap();
        value["model"] = json!({
            "mesh_stiffness": {"source": "given", "mean_n_per_um": 900.0, "harmonics": [{"amplitude": 0.1}]},
            "impact": {"source": "none"},
        });
        value["axes"] = json!([
            {"pointer": "/operation/pinion_speed_rpm", "values": [3000.0, 1000.0, 2000.0, 4000.0]},
            {"pointer": "/operation/pinion_torque_nm", "values": [300.0, 600.0]},
        ]);
        change(&mut value);
        CheckedJob::new(crate::parse(value.to_string().as_bytes()).unwrap()).unwrap()
    }

    /// The rows of parts, by position.
    #[derive(Default)]
    struct Rows(Mutex<BTreeMap<usize, SweepPoint>>);

    impl PointStore for Rows {
        fn load(&self) -> StoredPoints {
            StoredPoints::default()
        }

        fn save(&self, position: usize, row: &SweepPoint, _end: Option<&LineEnd>) {
            assert!(self.0.lock().unwrap().insert(position, row.clone()).is_none(), "{position} twice");
        }
    }

    impl Rows {
        fn solve(&self, job: &CheckedJob, part: &SweepPart) -> Option<LineEnd> {
            let none = SolveContext::none();
            let context = SolveContext { stages: &NoStageStore, points: self, ..none };
            solve_part(job, part, &context).unwrap()
        }

        fn assert_are_those_of(self, job: &CheckedJob) {
            let whole = solve(job, &SolveContext::none()).unwrap().result.sweep.unwrap().points;
            let text = |rows: Vec<SweepPoint>| serde_json::to_string(&rows).unwrap();
            assert_eq!(text(self.0.into_inner().unwrap().into_values().collect()), text(whole));
        }
    }

    #[test]
    fn points_apart_are_those_of_the_sweep() {
        for method in ["auto", "integrate"] {
            let job = sweep(|value| value["analysis"] = json!({"method": method, "mesh_periods": 100}));
            assert_eq!(SweepOrder::of(job.document()).group(5), (method == "integrate").then_some(0));
            let rows = Rows::default();
            for part in [vec![7, 0], vec![1, 2, 3, 4, 6], vec![5], Vec::new()] {
                assert_eq!(rows.solve(&job, &SweepPart::Points(part)), None);
            }
            rows.assert_are_those_of(&job);
        }
    }

    /// Where contact is lost at some speeds, neighbours in the lanes set steps, and with them the last bits of the
    /// largest force.
    #[test]
    fn whole_groups_are_those_of_the_sweep_to_the_last_bit() {
        let job = sweep(|value| {
            value["model"]["mesh_stiffness"]["harmonics"][0]["amplitude"] = json!(0.2);
            value["analysis"] = json!({"method": "integrate", "mesh_periods": 40, "record_mesh_periods": 10});
            value["axes"] = json!([
                {"pointer": "/operation/pinion_speed_rpm", "from": 1500.0, "to": 9000.0, "points": 25},
                {"pointer": "/design/backlash_um", "values": [2.0, 30.0, 60.0]},
            ]);
        });
        let order = SweepOrder::of(job.document());
        let mut parts: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
        (0..order.points()).for_each(|position| parts.entry(order.group(position)).or_default().push(position));
        assert_eq!(parts.values().map(Vec::len).collect::<Vec<_>>(), [3, 32, 32, 8]);
        let rows = Rows::default();
        for part in parts.into_values().rev() {
            rows.solve(&job, &SweepPart::Points(part));
        }
        rows.assert_are_those_of(&job);
    }

    #[test]
    fn stretches_of_lines_are_those_of_the_sweep() {
        let job = sweep(|value| {
            value["continuation"] = json!("both");
            value["analysis"] = json!({"method": "integrate", "mesh_periods": 100});
        });
        let rows = Rows::default();
        for line in (0..4).rev() {
            let mut start = None;
            for (from, to) in [(0, 1), (1, 3), (3, 4)] {
                let end = rows.solve(&job, &SweepPart::Stretch { line, from, to, start: start.take() }).unwrap();
                assert_eq!((end.line, end.position), (line, SweepOrder::of(job.document()).line(line)[to - 1]));
                start = end.state;
            }
        }
        rows.assert_are_those_of(&job);
    }

    #[test]
    fn evaluations_apart_are_those_of_the_study() {
        for sensitivity in ["jansen", "morris", "from_sample"] {
            let job = sweep(|value| {
                value["kind"] = json!("tolerance");
                value.as_object_mut().unwrap().remove("axes");
                value["operating_points"] = json!([{"pinion_torque_nm": 400.0}, {"pinion_torque_nm": 800.0}]);
                value["tolerances"] = json!([
                    {"pointer": "/operation/pinion_speed_rpm", "distribution": "normal", "tolerance": 100.0},
                    {"pointer": "/model/mesh_damping_ratio", "distribution": "uniform", "plus": 0.05},
                ]);
                let measures = json!([{"measure": "/response/rms/mesh_circumferential_acceleration_m_s2"}]);
                (value["measures"], value["sensitivity"]) = (measures, json!(sensitivity));
                if sensitivity != "morris" {
                    value["samples"] = json!(16);
                }
            });
            let order = SweepOrder::of(job.document());
            let rows = Rows::default();
            let (odd, even): (Vec<usize>, Vec<usize>) = (0..order.points()).partition(|position| position % 2 == 1);
            for part in [odd, even] {
                assert_eq!(rows.solve(&job, &SweepPart::Points(part)), None);
            }
            let whole = solve(&job, &SolveContext::none()).unwrap().result.tolerance.unwrap().points;
            assert_eq!(whole.len(), order.points());
            let text = |rows: Vec<SweepPoint>| serde_json::to_string(&rows).unwrap();
            assert_eq!(text(rows.0.into_inner().unwrap().into_values().collect()), text(whole), "{sensitivity}");
            let beyond = SweepPart::Points(vec![order.points()]);
            assert!(solve_part(&job, &beyond, &SolveContext::none()).is_err());
        }
    }

    #[test]
    fn what_is_no_part_is_refused() {
        let (plain, followed) = (sweep(|_| {}), sweep(|value| value["continuation"] = json!("up")));
        let stretch = |line, from, to| SweepPart::Stretch { line, from, to, start: None };
        let refused = |job, part| solve_part(job, &part, &SolveContext::none()).is_err();
        assert!(refused(&plain, SweepPart::Points(vec![8])) && refused(&plain, stretch(0, 0, 1)));
        assert!(refused(&followed, SweepPart::Points(vec![0])) && refused(&followed, stretch(2, 0, 1)));
        assert!(refused(&followed, stretch(0, 1, 1)) && refused(&followed, stretch(0, 3, 5)));
    }
}
