//! Recorded channels as files of arrays, encoded a part at a time, so that the memory used does not grow with their
//! length.

use super::problem::ApiError;
use super::text_body::TextBody;
use crate::store::{JobId, PackedSeries, SeriesEntry, Store};
use axum::body::Bytes;
use futures_util::stream::{self, Stream, TryStreamExt};
use herringbone_exchange::arrays::{ArrayForm, ArrayWriter};
use std::collections::VecDeque;
use std::io::{self, Write};
use std::mem;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of times that are encoded at once.
const TIMES: usize = 1 << 16;

/// Channels of a job that share their times.
pub(super) struct SeriesSource {
    pub store: Store,
    pub id: JobId,
    pub entries: Vec<SeriesEntry>,
    /// Indices of the samples.
    pub window: Range<usize>,
}

/// Channels as a file of arrays.
pub(super) struct SeriesFile {
    pub source: SeriesSource,
    pub form: ArrayForm,
}

/// What is written next.
enum Step {
    Head,
    Times(usize),
    Channel(SeriesEntry),
    Part(Box<PackedSeries>, usize, usize),
    End,
}

/// The bytes that a writer leaves behind.
#[derive(Clone, Default)]
struct Written(Arc<Mutex<Vec<u8>>>);

impl Written {
    fn take(&self) -> Vec<u8> {
        mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Written {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

struct Encoder {
    file: SeriesFile,
    writer: ArrayWriter<Written>,
    written: Written,
    names: Vec<String>,
    steps: VecDeque<Step>,
}

impl SeriesFile {
    /// The pieces of the file: `t0_s`, `dt_s`, the times `t_s`, each channel, and `channels` and `units` with their
    /// names and units.
    ///
    /// # Errors
    /// The file cannot be begun, which does not happen in memory.
    pub(super) fn pieces(self) -> Result<impl Stream<Item = Result<Bytes, ApiError>> + use<>, ApiError> {
        let written = Written::default();
        let writer = ArrayWriter::new(self.form, written.clone()).map_err(ApiError::internal)?;
        let mut names = self.form.names();
        for reserved in ["t0_s", "dt_s", "t_s", "channels", "units"] {
            names.name(reserved);
        }
        let names = self.source.entries.iter().map(|entry| names.name(&entry.channel)).collect();
        let channels = self.source.entries.iter().cloned().map(Step::Channel);
        let steps = [Step::Head, Step::Times(0)].into_iter().chain(channels).chain([Step::End]).collect();
        let encoder = Encoder { file: self, writer, written, names, steps };
        let parts = stream::try_unfold(encoder, async |mut encoder| {
            let Some(step) = encoder.steps.pop_front() else { return Ok::<_, ApiError>(None) };
            let is_end = matches!(step, Step::End);
            let mut encoder = encoder.step(step).await?;
            let mut bytes = encoder.written.take();
            if is_end {
                bytes.extend(encoder.end()?);
            }
            Ok(Some((bytes, encoder)))
        });
        let pieces = |bytes| stream::iter(TextBody::new(bytes).map(Ok));
        Ok(parts.map_ok(pieces).try_flatten())
    }
}

impl Encoder {
    async fn step(mut self, step: Step) -> Result<Self, ApiError> {
        let n = self.file.source.window.len();
        match step {
            Step::Head => {
                let first = self.file.source.entries.first();
                let (t0_s, dt_s) =
                    first.map_or((0.0, 0.0), |entry| (entry.time_s(self.file.source.window.start), entry.dt_s));
                self.writer.scalar("t0_s", t0_s).map_err(ApiError::internal)?;
                self.writer.scalar("dt_s", dt_s).map_err(ApiError::internal)?;
                self.writer.begin("t_s", n as u64).map_err(ApiError::internal)?;
            }
            Step::Times(done) => {
                let end = (done + TIMES).min(n);
                if let Some(entry) = self.file.source.entries.first() {
                    let times: Vec<f64> =
                        (done..end).map(|at| entry.time_s(self.file.source.window.start + at)).collect();
                    self.writer.push(&times).map_err(ApiError::internal)?;
                }
                if end < n {
                    self.steps.push_front(Step::Times(end));
                }
            }
            Step::Channel(entry) => {
                let packed = self.file.source.store.series(self.file.source.id, &entry.channel).await?;
                let packed = packed.ok_or_else(super::routes::job_not_found)?;
                let at = self.file.source.entries.iter().position(|other| *other == entry).unwrap_or_default();
                self.writer.begin(&self.names[at], n as u64).map_err(ApiError::internal)?;
                self.steps.push_front(Step::Part(Box::new(packed), 0, 0));
            }
            Step::Part(packed, part, first) => return self.part(packed, part, first).await,
            Step::End => {}
        }
        Ok(self)
    }

    /// Encodes the samples of a part, whose first one has this index.
    async fn part(mut self, packed: Box<PackedSeries>, part: usize, first: usize) -> Result<Self, ApiError> {
        let encoded = tokio::task::spawn_blocking(move || {
            let values = packed.unpack_part(part)?;
            let (start, end) = (self.file.source.window.start, self.file.source.window.end);
            let end_of_part = first + values.len();
            let within = start.clamp(first, end_of_part) - first..end.clamp(first, end_of_part) - first;
            self.writer.push(values.get(within).unwrap_or_default()).map_err(ApiError::internal)?;
            if part + 1 < packed.n_parts() && end_of_part < end {
                self.steps.push_front(Step::Part(packed, part + 1, end_of_part));
            }
            Ok(self)
        });
        encoded.await.map_err(ApiError::internal)?
    }

    /// The rest of the file.
    fn end(&mut self) -> Result<Vec<u8>, ApiError> {
        let empty = ArrayWriter::new(self.file.form, Written::default()).map_err(ApiError::internal)?;
        let mut writer = mem::replace(&mut self.writer, empty);
        let channels: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let units: Vec<&str> = self.file.source.entries.iter().map(|entry| entry.unit.as_str()).collect();
        writer.words("channels", &channels).map_err(ApiError::internal)?;
        writer.words("units", &units).map_err(ApiError::internal)?;
        writer.finish().map_err(ApiError::internal)?;
        Ok(self.written.take())
    }
}
