//! The files, written with [`herringbone_exchange::parquet`].

use crate::api::guarded_body::GuardedBody;
use crate::api::problem::ApiError;
use crate::api::series_file::SeriesSource;
use crate::api::table::{Cells, POSITION, Table};
use crate::api::text_body::{PIECE_BYTES, TextBody};
use crate::store::JobRecord;
use axum::body::{Body, Bytes};
use futures_util::stream::{self, StreamExt};
use herringbone_exchange::parquet::{ParquetCells, ParquetColumn, ParquetKind, ParquetWriter};
use std::borrow::Cow;
use std::collections::HashSet;
use std::io::{self, Write};
use std::mem;
use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, mpsc};

/// Pieces of a large file that wait for the client.
const WAITING_PIECES: usize = 4;

/// The rows of a job in one group, with the names of its CSV; `input`, the job document, is in the metadata. Where a
/// row has no value, the file has null.
///
/// # Errors
/// A column does not fit its kind, which does not happen.
pub(in crate::api) fn table_bytes(table: &Table, job: &JobRecord, input: &str) -> Result<Vec<u8>, ApiError> {
    let mut names = HashSet::new();
    let columns = table.columns.iter().map(|column| ParquetColumn {
        name: unique(&mut names, &column.name),
        kind: match &column.cells {
            Cells::Numbers(_) if column.name == POSITION => ParquetKind::Integer,
            Cells::Numbers(_) => ParquetKind::NumberOrNull,
            Cells::Words(_) => ParquetKind::WordOrNull,
        },
        unit: column.unit.clone(),
        meaning: column.meaning.clone(),
    });
    let columns: Vec<_> = columns.collect();
    let id = job.id.to_string();
    let metadata = [("job_id", id.as_str()), ("solver_version", &job.solver_version), ("input", input)];
    let written = ParquetWriter::new(Vec::new(), &columns, &metadata).and_then(|mut writer| {
        writer.group(|index| {
            Ok(match &table.columns[index].cells {
                Cells::Numbers(values) if columns[index].kind == ParquetKind::Integer => {
                    ParquetCells::Integers(values.iter().map(|value| *value as i64).collect())
                }
                Cells::Numbers(values) => ParquetCells::Numbers(Cow::Borrowed(values)),
                Cells::Words(words) => ParquetCells::Words(Cow::Borrowed(words)),
            })
        })?;
        writer.finish()
    });
    written.map_err(ApiError::internal)
}

/// The name, with a number where a column before has it: a quantity may be both objective and constraint of a search.
fn unique(taken: &mut HashSet<String>, name: &str) -> String {
    let mut unique = name.to_owned();
    let mut number = 2;
    while !taken.insert(unique.clone()) {
        unique = format!("{name} ({number})");
        number += 1;
    }
    unique
}

/// Channels with their times as the body of an answer: at once where it is small, else, with the place of a large body,
/// written while it is sent, a channel's part in memory at a time.
///
/// # Errors
/// The channels cannot be read.
pub(in crate::api) async fn series_body(
    source: SeriesSource,
    job: &JobRecord,
    place: Option<OwnedSemaphorePermit>,
) -> Result<Body, ApiError> {
    let (runtime, file) = (Handle::current(), SeriesParquet::new(source, job));
    let Some(place) = place else {
        let bytes = tokio::task::spawn_blocking(move || file.write(&runtime, Vec::new()));
        return Ok(TextBody::new(bytes.await.map_err(ApiError::internal)?.map_err(ApiError::internal)?).into());
    };
    let (sender, receiver) = mpsc::channel(WAITING_PIECES);
    tokio::task::spawn_blocking(move || {
        let pieces = Pieces { sender: sender.clone(), bytes: Vec::with_capacity(PIECE_BYTES) };
        if let Err(error) = file.write(&runtime, pieces).and_then(|mut pieces| pieces.send()) {
            // Ends the connection; nobody is left to tell when the client has gone.
            let _ = sender.blocking_send(Err(error));
        }
    });
    let pieces = stream::unfold(receiver, async |mut receiver| Some((receiver.recv().await?, receiver)));
    // Compression asks once more after the end.
    Ok(Body::new(GuardedBody::new(Body::from_stream(Box::pin(pieces.fuse())), place)))
}

struct SeriesParquet {
    source: SeriesSource,
    columns: Vec<ParquetColumn>,
    metadata: Vec<(&'static str, String)>,
}

impl SeriesParquet {
    fn new(source: SeriesSource, job: &JobRecord) -> Self {
        let mut names = HashSet::new();
        let column = |name: String, unit: &str, meaning: &str| ParquetColumn {
            name,
            kind: ParquetKind::Number,
            unit: unit.to_owned(),
            meaning: meaning.to_owned(),
        };
        let mut columns = vec![column(unique(&mut names, "t_s"), "s", "time")];
        columns.extend(
            source.entries.iter().map(|entry| column(unique(&mut names, &entry.channel), &entry.unit, &entry.quantity)),
        );
        let mut metadata = vec![("job_id", job.id.to_string()), ("solver_version", job.solver_version.clone())];
        if let Some(first) = source.entries.first() {
            metadata.push(("t0_s", first.time_s(source.window.start).to_string()));
            metadata.push(("dt_s", first.dt_s.to_string()));
        }
        Self { source, columns, metadata }
    }

    /// Writes the file; not for async threads. A group of rows for each part in which the samples are stored.
    fn write<W: Write + Send>(&self, runtime: &Handle, out: W) -> io::Result<W> {
        let metadata: Vec<_> = self.metadata.iter().map(|(key, value)| (*key, value.as_str())).collect();
        let mut writer = ParquetWriter::new(out, &self.columns, &metadata)?;
        let SeriesSource { entries, window, .. } = &self.source;
        let Some(first) = entries.first() else { return writer.finish() };
        let mut start = 0;
        for part in 0.. {
            if start >= window.end {
                break;
            }
            let mut values = self.part(runtime, 0, part)?;
            let end = start + values.len();
            if start == end {
                return Err(io::Error::other("a channel has fewer samples than its description says"));
            }
            let within = window.start.clamp(start, end)..window.end.clamp(start, end);
            if !within.is_empty() {
                writer.group(|column| {
                    if column == 0 {
                        let times = within.clone().map(|index| first.time_s(index));
                        return Ok(ParquetCells::Numbers(times.collect()));
                    }
                    let mut values =
                        if column == 1 { mem::take(&mut values) } else { self.part(runtime, column - 1, part)? };
                    if values.len() != end - start {
                        return Err(io::Error::other("channels with the same times are stored in different parts"));
                    }
                    values.truncate(within.end - start);
                    values.drain(..within.start - start);
                    Ok(ParquetCells::Numbers(values.into()))
                })?;
            }
            start = end;
        }
        writer.finish()
    }

    /// The samples of a part of a channel.
    fn part(&self, runtime: &Handle, channel: usize, part: usize) -> io::Result<Vec<f64>> {
        let SeriesSource { store, id, entries, .. } = &self.source;
        let entry = entries.get(channel).ok_or_else(|| io::Error::other("there is no such channel"))?;
        let packed = runtime.block_on(store.series_part(*id, &entry.channel, part)).map_err(io::Error::other)?;
        // None where the job was deleted meanwhile.
        let packed = packed.ok_or_else(|| io::Error::from(io::ErrorKind::NotFound))?;
        packed.unpack_part(0).map_err(io::Error::other)
    }
}

/// Sends what is written in pieces, and waits while as many as are permitted are on their way.
struct Pieces {
    sender: mpsc::Sender<io::Result<Bytes>>,
    bytes: Vec<u8>,
}

impl Pieces {
    fn send(&mut self) -> io::Result<()> {
        if self.bytes.is_empty() {
            return Ok(());
        }
        let piece = mem::replace(&mut self.bytes, Vec::with_capacity(PIECE_BYTES));
        self.sender.blocking_send(Ok(piece.into())).map_err(|_| io::ErrorKind::BrokenPipe.into())
    }
}

impl Write for Pieces {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = PIECE_BYTES - self.bytes.len();
        let taken = bytes.get(..room).unwrap_or(bytes);
        self.bytes.extend_from_slice(taken);
        if self.bytes.len() == PIECE_BYTES {
            self.send()?;
        }
        Ok(taken.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
