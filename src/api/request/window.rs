//! A window of times: the query parameters `from` and `to`.

use super::query::QueryParameters;
use crate::store::SeriesEntry;
use herringbone_job::Violation;
use std::ops::Range;

/// Times in seconds, both ends included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimeWindow {
    pub from_s: f64,
    pub to_s: f64,
}

impl TimeWindow {
    /// Reads `from` and `to`; everything when they are left out.
    pub(crate) fn read(query: &mut QueryParameters) -> Self {
        let from_s = query.number("from", "s").unwrap_or(f64::NEG_INFINITY);
        let to_s = query.number("to", "s").unwrap_or(f64::INFINITY);
        if from_s > to_s {
            query.add_violation(Violation::new("/to", "conflict", "lies before from"));
        }
        Self { from_s, to_s }
    }

    /// The indices of the samples of a channel in the window.
    pub(crate) fn indices(&self, entry: &SeriesEntry) -> Range<usize> {
        let n = entry.n as usize;
        let start = partition_point(n, |index| entry.time_s(index) < self.from_s);
        start..partition_point(n, |index| entry.time_s(index) <= self.to_s).max(start)
    }
}

/// The first of the indices below `n` for which a predicate is false that is true for those before it.
fn partition_point(n: usize, is_before: impl Fn(usize) -> bool) -> usize {
    let (mut start, mut end) = (0, n);
    while start < end {
        let middle = start + (end - start) / 2;
        if is_before(middle) {
            start = middle + 1;
        } else {
            end = middle;
        }
    }
    start
}
