//! The points of a sweep that are kept as they are found, so that a sweep which was stopped goes on where it was.

use crate::result::SweepPoint;
use std::collections::{BTreeMap, HashMap};

/// Where the points of one sweep are kept while it runs. Positions are those in the result's `sweep.points`.
///
/// What is loaded must have been saved by a sweep over the same document under the same solver version.
pub trait PointStore: Sync {
    /// What an earlier run of the same sweep left.
    fn load(&self) -> KeptPoints;

    /// Keeps a point that was just solved. `end`, with continuation: how far its line is followed with it.
    fn save(&self, position: usize, row: &SweepPoint, end: Option<&LineEnd>);
}

/// Points of an earlier run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct KeptPoints {
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
    fn load(&self) -> KeptPoints {
        KeptPoints::default()
    }

    fn save(&self, _position: usize, _row: &SweepPoint, _end: Option<&LineEnd>) {}
}
