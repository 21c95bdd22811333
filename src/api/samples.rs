//! Samples of a recorded channel, encoded a piece at a time.

use super::csv::{CsvField, CsvWriter, Decimal};
use super::downsample::{DownsampleMethod, downsample};
use crate::store::{PackedSeries, SeriesEntry, StoreError};
use axum::body::Bytes;
use serde::Serialize;
use std::io;
use std::ops::Range;
use std::sync::Arc;

/// Number of samples in a piece of text.
const PIECE_SAMPLES: usize = 1024;

/// Samples of a channel, or a selection of them.
pub(super) struct Samples {
    entry: SeriesEntry,
    /// Index of the first sample of the time window.
    start: usize,
    /// Number of samples of the time window.
    n_source: usize,
    /// Indices of the values in the time window; empty when all of them are here.
    selected: Vec<usize>,
    values: Vec<f64>,
    method: DownsampleMethod,
}

/// What precedes the times in the JSON of samples.
#[derive(Serialize)]
struct Head<'a> {
    channel: &'a str,
    quantity: &'a str,
    unit: &'a str,
}

/// What follows the values in the JSON of samples.
#[derive(Serialize)]
struct Tail {
    n_source: usize,
    n_returned: usize,
    n_not_finite: usize,
    method: &'static str,
}

impl Samples {
    /// Unpacks a channel and selects at most `max_points` samples of a window by a method.
    ///
    /// # Errors
    /// The stored samples are damaged.
    pub(super) fn select(
        packed: &PackedSeries,
        window: Range<usize>,
        max_points: usize,
        method: DownsampleMethod,
    ) -> Result<Self, StoreError> {
        let mut values = packed.unpack()?;
        let (start, n_source) = (window.start, window.len());
        values.truncate(window.end);
        values.drain(..start.min(values.len()));
        let (selected, method) = downsample(&values, max_points, method);
        if method != DownsampleMethod::None {
            values = selected.iter().map(|index| values[*index]).collect();
        }
        values.shrink_to_fit();
        Ok(Self { entry: packed.entry.clone(), start, n_source, selected, values, method })
    }

    fn time_s(&self, at: usize) -> f64 {
        self.entry.time_s(self.start + self.selected.get(at).copied().unwrap_or(at))
    }

    /// The pieces of the text: CSV with this decimal sign, or JSON. Each is encoded when it is taken.
    ///
    /// # Errors
    /// JSON or CSV cannot be written, which does not happen in memory.
    pub(super) fn encode(
        self,
        csv_decimal: Option<Decimal>,
    ) -> io::Result<Box<dyn Iterator<Item = io::Result<Bytes>> + Send>> {
        let samples = Arc::new(self);
        Ok(match csv_decimal {
            Some(decimal) => Box::new(samples.csv(decimal)?),
            None => Box::new(samples.json()?),
        })
    }

    fn json(self: Arc<Self>) -> io::Result<impl Iterator<Item = io::Result<Bytes>>> {
        let head = Head { channel: &self.entry.channel, quantity: &self.entry.quantity, unit: &self.entry.unit };
        let n_not_finite = self.values.iter().filter(|value| !value.is_finite()).count();
        let (n_source, n_returned) = (self.n_source, self.values.len());
        let tail = Tail { n_source, n_returned, n_not_finite, method: self.method.as_str() };
        // The lists go between the members of one object.
        let head = serde_json::to_string(&head)?.trim_end_matches('}').to_owned() + ",\"t\":[";
        let tail = "],".to_owned() + serde_json::to_string(&tail)?.trim_start_matches('{');
        let (times, values) = (Arc::clone(&self), self);
        let times = list(n_returned, move |at| times.time_s(at));
        let values = list(n_returned, move |at| values.values[at]);
        let text = |text: String| std::iter::once(Ok(Bytes::from(text)));
        Ok(text(head).chain(times).chain(text("],\"y\":[".to_owned())).chain(values).chain(text(tail)))
    }

    fn csv(self: Arc<Self>, decimal: Decimal) -> io::Result<impl Iterator<Item = io::Result<Bytes>>> {
        let mut header = CsvWriter::with_mark(Vec::new(), decimal)?;
        header.write_record(["t_s", "value"].map(CsvField::Text))?;
        let records = pieces(self.values.len()).map(move |piece| {
            let mut writer = CsvWriter::new(Vec::new(), decimal);
            for at in piece {
                writer.write_record([self.time_s(at), self.values[at]].map(CsvField::Number))?;
            }
            writer.into_inner().map(Bytes::from)
        });
        Ok(std::iter::once(header.into_inner().map(Bytes::from)).chain(records))
    }
}

/// The elements of a JSON list of numbers, without its brackets.
fn list(n: usize, value: impl Fn(usize) -> f64) -> impl Iterator<Item = io::Result<Bytes>> {
    pieces(n).map(move |piece| {
        let mut text = Vec::new();
        for at in piece {
            if at > 0 {
                text.push(b',');
            }
            serde_json::to_writer(&mut text, &value(at))?;
        }
        Ok(Bytes::from(text))
    })
}

/// The indices below `n`, piece after piece.
fn pieces(n: usize) -> impl Iterator<Item = Range<usize>> {
    (0..n).step_by(PIECE_SAMPLES).map(move |start| start..(start + PIECE_SAMPLES).min(n))
}
