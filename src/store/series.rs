//! Recorded channels.

use super::connect::{Store, StoreError};
use super::lifecycle::JobId;
use herringbone_job::study::RecordedChannel;
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row, Sqlite, Transaction};

/// Compression level of zstd; series of doubles gain little from higher ones.
const ZSTD_LEVEL: i32 = 3;

/// The description of a channel, without its samples.
#[derive(Debug, Clone, PartialEq)]
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

/// A channel with its samples compressed (zstd, f64 little-endian).
#[derive(Debug, Clone, PartialEq)]
pub struct PackedSeries {
    pub entry: SeriesEntry,
    samples: Vec<u8>,
}

impl PackedSeries {
    /// Compresses a channel. Takes milliseconds per million samples: not for async threads.
    ///
    /// # Errors
    /// The compression fails, for want of memory.
    pub fn pack(channel: &RecordedChannel) -> Result<Self, StoreError> {
        let bytes: Vec<u8> = channel.values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let samples = zstd::bulk::compress(&bytes, ZSTD_LEVEL).map_err(|error| corrupt(&error))?;
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
        Ok(Self { entry, samples })
    }

    /// Decompresses the samples. Takes milliseconds per million: not for async threads.
    ///
    /// # Errors
    /// [`StoreError::Corrupt`] when the stored bytes are damaged.
    pub fn unpack(&self) -> Result<Vec<f64>, StoreError> {
        let size = self.entry.n as usize * 8;
        let bytes = zstd::bulk::decompress(&self.samples, size).map_err(|error| corrupt(&error))?;
        if bytes.len() != size {
            return Err(corrupt(&format!("{} bytes instead of {size}", bytes.len())));
        }
        let (chunks, _) = bytes.as_chunks::<8>();
        Ok(chunks.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect())
    }

    pub(super) async fn insert(
        &self,
        transaction: &mut Transaction<'static, Sqlite>,
        job: JobId,
        position: usize,
    ) -> Result<(), StoreError> {
        sqlx::query(
            "INSERT INTO series (job_id, position, channel, quantity, unit, n, t0_s, dt_s, min, max, rms, samples) \
             VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12)",
        )
        .bind(job.to_string())
        .bind(position as i64)
        .bind(&self.entry.channel)
        .bind(&self.entry.quantity)
        .bind(&self.entry.unit)
        .bind(self.entry.n as i64)
        .bind(self.entry.t0_s)
        .bind(self.entry.dt_s)
        .bind(self.entry.min)
        .bind(self.entry.max)
        .bind(self.entry.rms)
        .bind(&self.samples)
        .execute(&mut **transaction)
        .await?;
        Ok(())
    }
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
    /// Reads the descriptions of the channels of a job, in the order of recording.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn series_catalogue(&self, id: JobId) -> Result<Vec<SeriesEntry>, StoreError> {
        Ok(sqlx::query_as(
            "SELECT channel, quantity, unit, n, t0_s, dt_s, min, max, rms FROM series WHERE job_id = $1 \
             ORDER BY position",
        )
        .bind(id.to_string())
        .fetch_all(&self.reader)
        .await?)
    }

    /// Reads one channel of a job.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn series(&self, id: JobId, channel: &str) -> Result<Option<PackedSeries>, StoreError> {
        let row = sqlx::query(
            "SELECT channel, quantity, unit, n, t0_s, dt_s, min, max, rms, samples FROM series \
             WHERE job_id = $1 AND channel = $2",
        )
        .bind(id.to_string())
        .bind(channel)
        .fetch_optional(&self.reader)
        .await?;
        row.map(|row| Ok(PackedSeries { entry: SeriesEntry::from_row(&row)?, samples: row.try_get("samples")? }))
            .transpose()
    }
}

fn corrupt(detail: &dyn std::fmt::Display) -> StoreError {
    StoreError::Corrupt { what: "series", detail: detail.to_string() }
}
