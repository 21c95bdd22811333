//! Recorded channels.

use super::connect::{Store, StoreError};
use super::dataset::{ensure_dataset, is_current};
use super::lifecycle::JobId;
use herringbone_job::study::RecordedChannel;
use serde::{Deserialize, Serialize};
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row, Sqlite, Transaction};

/// Largest number of samples in a part, 2 MiB: compressed in some ten milliseconds.
const PART_SAMPLES: usize = 1 << 18;
/// Compressed samples that are stored in one transaction, for which other writers wait.
const BATCH_BYTES: usize = 2 << 20;
/// Compression level of zstd; series of doubles gain little from higher ones.
const ZSTD_LEVEL: i32 = 3;

/// The description of a channel, without its samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SeriesEntry {
    pub channel: String,
    pub quantity: String,
    pub unit: String,
    /// Number of samples.
    pub n: u64,
    pub t0_s: f64,
    pub dt_s: f64,
    /// Extremes and exact root mean square (without the mean, except for accelerations); `None` where they are not
    /// finite.
    pub min: Option<f64>,
    pub max: Option<f64>,
    pub rms: Option<f64>,
}

impl SeriesEntry {
    /// Time of a sample.
    pub fn time_s(&self, index: usize) -> f64 {
        self.t0_s + index as f64 * self.dt_s
    }
}

/// A channel with its samples compressed, in parts (zstd, f64 little-endian).
#[derive(Debug, Clone, PartialEq)]
pub struct PackedSeries {
    pub entry: SeriesEntry,
    parts: Vec<Vec<u8>>,
}

/// A compressed part of the samples of a channel.
#[derive(Debug, Clone, PartialEq)]
struct SamplePart {
    /// Index of the channel.
    position: usize,
    /// Index of the part in its channel.
    part: usize,
    samples: Vec<u8>,
}

/// Samples of channels that are stored in one transaction.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SampleBatch(Vec<SamplePart>);

impl PackedSeries {
    /// Compresses a channel; `None` when `is_stopped` becomes true, which is asked before each part. Takes milliseconds
    /// per million samples: not for async threads.
    ///
    /// # Errors
    /// The compression fails, for want of memory.
    pub fn pack(channel: &RecordedChannel, is_stopped: &dyn Fn() -> bool) -> Result<Option<Self>, StoreError> {
        Self::pack_in_parts(channel, PART_SAMPLES, is_stopped)
    }

    /// As [`PackedSeries::pack`], in parts of so many samples.
    ///
    /// # Errors
    /// The compression fails, for want of memory.
    pub fn pack_in_parts(
        channel: &RecordedChannel,
        part_samples: usize,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<Option<Self>, StoreError> {
        let mut parts = Vec::new();
        // A channel without samples has one part without content.
        let chunks = channel.values.chunks(part_samples).chain(channel.values.is_empty().then_some(&[][..]));
        for values in chunks {
            if is_stopped() {
                return Ok(None);
            }
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            parts.push(zstd::bulk::compress(&bytes, ZSTD_LEVEL).map_err(|error| corrupt(&error))?);
        }
        let finite = || channel.values.iter().copied().filter(|value| value.is_finite());
        let entry = SeriesEntry {
            channel: channel.name.clone(),
            quantity: channel.quantity.clone(),
            unit: channel.unit.clone(),
            n: channel.values.len() as u64,
            t0_s: channel.t0_s,
            dt_s: channel.dt_s,
            min: finite().reduce(f64::min),
            max: finite().reduce(f64::max),
            rms: Some(channel.rms).filter(|value| value.is_finite()),
        };
        Ok(Some(Self { entry, parts }))
    }

    /// The description, and the compressed parts of the samples.
    pub fn into_parts(self) -> (SeriesEntry, Vec<Vec<u8>>) {
        (self.entry, self.parts)
    }

    /// Number of parts of the samples.
    pub fn n_parts(&self) -> usize {
        self.parts.len()
    }

    /// Decompresses a part of the samples; none where there is no such part.
    ///
    /// # Errors
    /// As [`PackedSeries::unpack`].
    pub fn unpack_part(&self, part: usize) -> Result<Vec<f64>, StoreError> {
        let Some(part) = self.parts.get(part) else { return Ok(Vec::new()) };
        let bytes = zstd::zstd_safe::get_frame_content_size(part).ok().flatten();
        let most = usize::try_from(self.entry.n).unwrap_or(usize::MAX).saturating_mul(8);
        let bytes = bytes.and_then(|bytes| usize::try_from(bytes).ok()).unwrap_or(most).min(most);
        decode(&zstd::bulk::decompress(part, bytes).map_err(|error| corrupt(&error))?)
    }

    /// Decompresses the samples. Takes milliseconds per million: not for async threads.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] when the stored bytes are damaged.
    pub fn unpack(&self) -> Result<Vec<f64>, StoreError> {
        let n = self.entry.n as usize;
        let mut values = Vec::with_capacity(n);
        for part in &self.parts {
            let left = n - values.len();
            let bytes = zstd::bulk::decompress(part, left * 8).map_err(|error| corrupt(&error))?;
            values.extend(decode(&bytes)?);
        }
        if values.len() != n {
            return Err(corrupt(&format!("{} samples instead of {n}", values.len())));
        }
        Ok(values)
    }
}

impl SampleBatch {
    /// One compressed part of a channel, by the index of the channel and of the part.
    pub fn of_part(position: usize, part: usize, samples: Vec<u8>) -> Self {
        Self(vec![SamplePart { position, part, samples }])
    }

    /// The descriptions of channels in their order, and their samples in batches of about two megabytes.
    pub fn split(series: Vec<PackedSeries>) -> (Vec<SeriesEntry>, Vec<SampleBatch>) {
        let (mut entries, mut batches, mut bytes) = (Vec::new(), vec![SampleBatch::default()], 0);
        for (position, PackedSeries { entry, parts }) in series.into_iter().enumerate() {
            entries.push(entry);
            for (part, samples) in parts.into_iter().enumerate() {
                if bytes + samples.len() > BATCH_BYTES && bytes > 0 {
                    batches.push(SampleBatch::default());
                    bytes = 0;
                }
                bytes += samples.len();
                if let Some(SampleBatch(batch)) = batches.last_mut() {
                    batch.push(SamplePart { position, part, samples });
                }
            }
        }
        (entries, batches)
    }

    /// Stores the samples in the dataset of a job, in a transaction that has checked that the job belongs to this
    /// attempt. Parts that are stored are left as they are.
    pub(super) async fn insert(
        &self,
        transaction: &mut Transaction<'static, Sqlite>,
        dataset: JobId,
    ) -> Result<(), StoreError> {
        for SamplePart { position, part, samples } in &self.0 {
            sqlx::query(
                "INSERT INTO series_samples (dataset_id, position, part, samples) VALUES ($1, $2, $3, $4) \
                 ON CONFLICT (dataset_id, position, part) DO NOTHING",
            )
            .bind(dataset.to_string())
            .bind(*position as i64)
            .bind(*part as i64)
            .bind(samples)
            .execute(&mut **transaction)
            .await?;
        }
        Ok(())
    }
}

impl SeriesEntry {
    pub(super) async fn insert(
        &self,
        transaction: &mut Transaction<'static, Sqlite>,
        dataset: JobId,
        position: usize,
    ) -> Result<(), StoreError> {
        sqlx::query(
            "INSERT INTO series (dataset_id, position, channel, quantity, unit, n, t0_s, dt_s, min, max, rms) \
             VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)",
        )
        .bind(dataset.to_string())
        .bind(position as i64)
        .bind(&self.channel)
        .bind(&self.quantity)
        .bind(&self.unit)
        .bind(self.n as i64)
        .bind(self.t0_s)
        .bind(self.dt_s)
        .bind(self.min)
        .bind(self.max)
        .bind(self.rms)
        .execute(&mut **transaction)
        .await?;
        Ok(())
    }
}

/// Deletes the samples of a job that was stopped or failed before it succeeded.
pub(super) async fn drop_samples(transaction: &mut Transaction<'static, Sqlite>, id: JobId) -> Result<(), StoreError> {
    sqlx::query("DELETE FROM series_samples WHERE dataset_id = $1")
        .bind(id.to_string())
        .execute(&mut **transaction)
        .await?;
    Ok(())
}

impl<'r> FromRow<'r, SqliteRow> for SeriesEntry {
    fn from_row(row: &'r SqliteRow) -> Result<Self, sqlx::Error> {
        Ok(Self {
            channel: row.try_get("channel")?,
            quantity: row.try_get("quantity")?,
            unit: row.try_get("unit")?,
            n: row.try_get::<i64, _>("n")?.unsigned_abs(),
            t0_s: row.try_get("t0_s")?,
            dt_s: row.try_get("dt_s")?,
            min: row.try_get("min")?,
            max: row.try_get("max")?,
            rms: row.try_get("rms")?,
        })
    }
}

impl Store {
    /// Stores samples of a running job before its result; they do not count until it succeeds. False, and nothing
    /// stored, when the job no longer belongs to this attempt or is to be canceled.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn save_samples(&self, id: JobId, attempt: i64, batch: &SampleBatch) -> Result<bool, StoreError> {
        let mut transaction = self.begin().await?;
        if !is_current(&mut transaction, id, attempt).await? {
            return Ok(false);
        }
        ensure_dataset(&mut transaction, id).await?;
        batch.insert(&mut transaction, id).await?;
        transaction.commit().await?;
        Ok(true)
    }

    /// Reads the descriptions of the channels of a job that succeeded, in the order of recording.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn series_catalogue(&self, id: JobId) -> Result<Vec<SeriesEntry>, StoreError> {
        Ok(sqlx::query_as(
            "SELECT channel, quantity, unit, n, t0_s, dt_s, min, max, rms FROM series \
             WHERE dataset_id = (SELECT dataset_id FROM results WHERE job_id = $1) ORDER BY position",
        )
        .bind(id.to_string())
        .fetch_all(&self.reader)
        .await?)
    }

    /// Reads one channel of a job that succeeded.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn series(&self, id: JobId, channel: &str) -> Result<Option<PackedSeries>, StoreError> {
        let rows = sqlx::query(
            "SELECT channel, quantity, unit, n, t0_s, dt_s, min, max, rms, samples \
             FROM series JOIN series_samples USING (dataset_id, position) \
             WHERE dataset_id = (SELECT dataset_id FROM results WHERE job_id = $1) AND channel = $2 ORDER BY part",
        )
        .bind(id.to_string())
        .bind(channel)
        .fetch_all(&self.reader)
        .await?;
        let Some(first) = rows.first() else { return Ok(None) };
        let entry = SeriesEntry::from_row(first)?;
        let parts = rows.into_iter().map(|row| row.try_get("samples")).collect::<Result<_, _>>()?;
        Ok(Some(PackedSeries { entry, parts }))
    }

    /// Reads one channel of a job that succeeded with only the part of its samples that has this index.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn series_part(&self, id: JobId, channel: &str, part: usize) -> Result<Option<PackedSeries>, StoreError> {
        let row = sqlx::query(
            "SELECT channel, quantity, unit, n, t0_s, dt_s, min, max, rms, samples \
             FROM series JOIN series_samples USING (dataset_id, position) \
             WHERE dataset_id = (SELECT dataset_id FROM results WHERE job_id = $1) AND channel = $2 AND part = $3",
        )
        .bind(id.to_string())
        .bind(channel)
        .bind(part as i64)
        .fetch_optional(&self.reader)
        .await?;
        let Some(row) = row else { return Ok(None) };
        Ok(Some(PackedSeries { entry: SeriesEntry::from_row(&row)?, parts: vec![row.try_get("samples")?] }))
    }
}

fn decode(bytes: &[u8]) -> Result<Vec<f64>, StoreError> {
    let (chunks, rest) = bytes.as_chunks::<8>();
    if !rest.is_empty() {
        return Err(corrupt(&"a part ends within a sample"));
    }
    Ok(chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect())
}

fn corrupt(detail: &dyn std::fmt::Display) -> StoreError {
    StoreError::Corrupt { what: "series", detail: detail.to_string() }
}
