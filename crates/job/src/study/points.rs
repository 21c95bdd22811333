//! The points of a sweep, stored as they are solved, so that a sweep that was stopped resumes there.

use crate::result::SweepPoint;
use std::collections::{BTreeMap, HashMap};

/// Store of the points of one sweep while it runs. Positions are those in the result's `sweep.points`.
///
/// What is loaded must have been saved by a sweep over the same document under the same solver version.
pub trait PointStore: Sync {
    /// What an earlier run of the same sweep left.
    fn load(&self) -> StoredPoints;

    /// Keeps a point that was just solved. `end`, with continuation: how far its line is followed with it.
    fn save(&self, position: usize, row: &SweepPoint, end: Option<&LineEnd>);
}

/// Points of an earlier run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StoredPoints {
    /// By position.
    pub rows: HashMap<usize, SweepPoint>,
    /// By line of a continuation: up to where it was followed.
    pub ends: BTreeMap<usize, LineEnd>,
}

/// The point up to which a line was followed, and the state to go on from.
#[derive(Debug, Clone, PartialEq)]
pub struct LineEnd {
    /// Number of the line: with two directions, the lines of the first come first.
    pub line: usize,
    /// Position of the point.
    pub position: usize,
    /// Its state (24 numbers in the source's order); none when it has no motion to continue from.
    pub state: Option<Vec<f64>>,
}

/// Keeps nothing.
pub struct NoPointStore;

impl PointStore for NoPointStore {
    fn load(&self) -> StoredPoints {
        StoredPoints::default()
    }

    fn save(&self, _position: usize, _row: &SweepPoint, _end: Option<&LineEnd>) {}
}
