//! Messages between the service and its workers. Those of results are not trusted: sizes are bounded, and what they say
//! is compared with the chunk that was issued.

use crate::store::{ChunkKey, ChunkPart, EndStateRow, Failure, LineEndRow, PointBatch, PointRow, SeriesEntry};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Version of the messages.
pub(super) const SCHEMA: u32 = 1;
/// Header with the version of the messages.
pub(super) const SCHEMA_HEADER: &str = "Hb-Schema";
/// Header with the version of the calculation.
pub(super) const SOLVER_HEADER: &str = "Hb-Solver";
/// Header with the trace of the request that submitted the job, for the logs.
pub(super) const TRACE_HEADER: &str = "Hb-Trace";
/// Header by which a stream recognises a message that was sent again.
pub(super) const ID_HEADER: &str = "Nats-Msg-Id";
/// Largest part of a message: half of what a NATS server takes by default.
pub(super) const PART_BYTES: usize = 512 << 10;
/// Largest message.
pub(super) const MESSAGE_BYTES: usize = 900 << 10;
/// Largest content of a message when it is decompressed.
const PLAIN_BYTES: usize = 64 << 20;
/// Compression level of zstd.
const ZSTD_LEVEL: i32 = 3;

/// A message that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("message: {0}")]
pub(super) struct MessageError(String);

/// A chunk as a worker receives it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ChunkMessage {
    pub schema: u32,
    pub job: String,
    pub attempt: i64,
    pub chunk: u32,
    pub issue: u32,
    /// The document as JSON.
    pub document: String,
    pub part: ChunkPart,
    /// State at the end of the point before a stretch.
    pub start: Option<State>,
    /// Longest computing time.
    pub time_limit_s: u64,
    /// Request that submitted the job.
    pub request_id: Option<String>,
}

/// The state of a motion: f64, little-endian, in hexadecimal, so that each bit arrives.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct State(String);

impl State {
    pub(super) fn of(values: &[f64]) -> Self {
        Self(hex::encode(values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>()))
    }

    pub(super) fn values(&self) -> Result<Vec<f64>, MessageError> {
        let bytes = hex::decode(&self.0).map_err(|error| MessageError(error.to_string()))?;
        match bytes.as_chunks::<8>() {
            (values, []) if values.len() <= 4096 => Ok(values.iter().map(|eight| f64::from_le_bytes(*eight)).collect()),
            _ => Err(MessageError("not a state".to_owned())),
        }
    }
}

/// A part of the result of a chunk; some have bytes besides.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ResultMessage {
    pub schema: u32,
    pub job: String,
    pub attempt: i64,
    pub chunk: u32,
    /// The computation: another one of the same chunk has another name.
    pub run: String,
    pub worker: String,
    pub content: ResultContent,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub(super) enum ResultContent {
    /// Rows of a sweep.
    Rows { rows: Vec<RowMessage> },
    /// A part of the samples of a channel: the bytes.
    Samples { position: u32, part: u32 },
    /// A piece of the summary of a whole job: the bytes.
    Piece { piece: u32 },
    /// The chunk is computed.
    End(EndMessage),
    /// The job cannot be solved.
    Failure { failure: Failure },
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct RowMessage {
    pub position: u64,
    /// The row as JSON.
    pub body: String,
    pub end_state: Option<State>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct EndMessage {
    /// Points that were solved.
    pub points: u64,
    /// Computing time.
    pub work_s: f64,
    /// Where a line was left.
    pub line_end: Option<LineEndMessage>,
    /// Pieces of the summary of a whole job.
    pub pieces: u32,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct LineEndMessage {
    pub line: u64,
    pub position: u64,
    pub state: Option<State>,
}

/// The result of a whole job without its samples: JSON, compressed, sent in pieces.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Summary {
    pub body: String,
    pub series: Vec<SeriesEntry>,
    /// Number of parts of samples that were sent.
    pub sample_parts: u64,
}

/// Whether a chunk that a worker has received is to be computed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StartRequest {
    pub job: String,
    pub attempt: i64,
    pub chunk: u32,
    pub issue: u32,
    pub worker: String,
    pub delivered: i64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct StartAnswer {
    /// Whether it is to be computed; else it is acknowledged at once.
    pub go: bool,
}

/// What a worker does, every second.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Beat {
    pub schema: u32,
    pub worker: String,
    pub host: String,
    /// Version of the program.
    pub version: String,
    pub solver_version: String,
    /// Names under which it takes work.
    pub solvers: Vec<String>,
    /// Chunks that it computes at once.
    pub slots: u32,
    pub running: Vec<BeatChunk>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct BeatChunk {
    pub job: String,
    pub attempt: i64,
    pub chunk: u32,
    pub stage: String,
    pub fraction: f64,
}

/// Chunks that a worker is to stop: their places in its beat.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct BeatAnswer {
    pub stop: Vec<u32>,
}

impl ChunkMessage {
    pub(super) fn key(&self) -> Result<ChunkKey, MessageError> {
        key_of(&self.job, self.attempt, self.chunk)
    }
}

impl ResultMessage {
    pub(super) fn key(&self) -> Result<ChunkKey, MessageError> {
        key_of(&self.job, self.attempt, self.chunk)
    }
}

pub(super) fn key_of(job: &str, attempt: i64, chunk: u32) -> Result<ChunkKey, MessageError> {
    let job = job.parse().map_err(|_| MessageError("not the id of a job".to_owned()))?;
    Ok(ChunkKey { job, attempt, chunk })
}

impl ResultContent {
    /// Rows of a batch.
    pub(super) fn rows(batch: PointBatch) -> Self {
        let PointBatch { rows, end_states, .. } = batch;
        let mut states: std::collections::HashMap<u64, State> =
            end_states.into_iter().map(|end| (end.position, State::of(&end.state))).collect();
        let row = |PointRow { position, body }| RowMessage { position, body, end_state: states.remove(&position) };
        ResultContent::Rows { rows: rows.into_iter().map(row).collect() }
    }
}

/// The rows of a message as they are stored.
pub(super) fn batch_of(rows: Vec<RowMessage>, solver_version: &str) -> Result<PointBatch, MessageError> {
    let mut batch = PointBatch { solver_version: solver_version.to_owned(), ..PointBatch::default() };
    for RowMessage { position, body, end_state } in rows {
        if let Some(state) = end_state {
            batch.end_states.push(EndStateRow { position, state: state.values()? });
        }
        batch.rows.push(PointRow { position, body });
    }
    Ok(batch)
}

impl LineEndMessage {
    pub(super) fn row(&self) -> Result<LineEndRow, MessageError> {
        let state = self.state.as_ref().map(State::values).transpose()?;
        Ok(LineEndRow { line: self.line, position: self.position, state })
    }
}

/// A message with bytes besides: the length of the compressed JSON, the JSON, the bytes.
pub(super) fn pack(message: &impl Serialize, bytes: &[u8]) -> Result<Vec<u8>, MessageError> {
    let head = compress(&serde_json::to_vec(message).map_err(|error| MessageError(error.to_string()))?)?;
    let length = u32::try_from(head.len()).map_err(|_| MessageError("too long".to_owned()))?;
    Ok([&length.to_le_bytes()[..], &head, bytes].concat())
}

/// Reads what [`pack`] wrote.
pub(super) fn unpack<T: DeserializeOwned>(payload: &[u8]) -> Result<(T, &[u8]), MessageError> {
    let short = || MessageError("ends early".to_owned());
    let (length, rest) = payload.split_first_chunk::<4>().ok_or_else(short)?;
    let (head, bytes) = rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(short)?;
    let json = decompress(head)?;
    Ok((serde_json::from_slice(&json).map_err(|error| MessageError(error.to_string()))?, bytes))
}

pub(super) fn compress(bytes: &[u8]) -> Result<Vec<u8>, MessageError> {
    zstd::bulk::compress(bytes, ZSTD_LEVEL).map_err(|error| MessageError(error.to_string()))
}

pub(super) fn decompress(bytes: &[u8]) -> Result<Vec<u8>, MessageError> {
    zstd::bulk::decompress(bytes, PLAIN_BYTES).map_err(|error| MessageError(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_arrives_bit_by_bit() {
        let values = [0.1, -0.0, f64::NAN, f64::INFINITY, 1e-320];
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&State::of(&values).values().unwrap()), bits(&values));
        assert!(State("00".into()).values().is_err() && State("zz".into()).values().is_err());
    }

    #[test]
    fn a_message_is_read_as_it_was_written_and_rubbish_is_refused() {
        let row = |position| PointRow { position, body: format!("{{\"p\":{position}}}") };
        let end = EndStateRow { position: 2, state: vec![1.5, 2.5] };
        let batch = PointBatch { rows: vec![row(1), row(2)], end_states: vec![end], ..PointBatch::default() };
        let packed = pack(&ResultContent::rows(batch.clone()), b"bytes").unwrap();
        let (content, bytes) = unpack::<ResultContent>(&packed).unwrap();
        let ResultContent::Rows { rows } = content else { panic!("not rows") };
        assert_eq!((batch_of(rows, "").unwrap(), bytes), (batch, &b"bytes"[..]));
        for wrong in [&packed[..3], &packed[..20], b"", b"\xff\xff\xff\xff rest", b"\0\0\0\0"] {
            assert!(unpack::<ResultContent>(wrong).is_err());
        }
    }
}
