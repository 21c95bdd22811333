//! The points of a sweep, stored as they are solved, so that a sweep that was stopped resumes there.

use super::evaluation::EvaluationBatch;
use crate::result::SweepPoint;
use std::collections::{BTreeMap, HashMap};

/// Store of the points of one sweep while it runs. Positions are those in the result's `sweep.points`.
///
/// Loaded points must have been saved by a sweep over the same document under the same solver version.
pub trait PointStore: Sync {
    /// The points of an earlier run of the same sweep.
    fn load(&self) -> StoredPoints;

    /// Stores a solved point. `end`, with continuation: the point up to which its line has been followed.
    fn save(&self, position: usize, row: &SweepPoint, end: Option<&LineEnd>);

    /// Has evaluations made on other machines, and stores their rows; returns them by position. Those that are missing
    /// are to be made by the caller. `evaluation_ms`: mean time of an evaluation that was made here.
    fn evaluate(&self, _batch: EvaluationBatch, _evaluation_ms: Option<f64>) -> HashMap<usize, SweepPoint> {
        HashMap::new()
    }
}

/// Rows and line ends of an earlier run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoredPoints {
    /// By position.
    pub rows: HashMap<usize, SweepPoint>,
    /// Ends of the lines of a continuation, by the number of the line.
    pub ends: BTreeMap<usize, LineEnd>,
}

/// The point up to which a line was followed, and the state to go on from.
#[derive(Debug, Clone, PartialEq)]
pub struct LineEnd {
    /// Number of the line: with two directions, the lines of the first come first.
    pub line: usize,
    /// Position of the point.
    pub position: usize,
    /// State of the motion (24 numbers in the source's order); `None` if there is no motion to continue from.
    pub state: Option<Vec<f64>>,
}

/// A store that keeps nothing.
pub struct NoPointStore;

impl PointStore for NoPointStore {
    fn load(&self) -> StoredPoints {
        StoredPoints::default()
    }

    fn save(&self, _position: usize, _row: &SweepPoint, _end: Option<&LineEnd>) {}
}
