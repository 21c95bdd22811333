//! Exchange formats: gear models of other programs as job documents, and job documents as such models.
//!
//! Bytes in, a job document and a report out: [`import`]. No I/O, no clock. The report has a line for every field of
//! the document that was taken from the file or assumed, and for what the file has and the document has not. The other
//! way: [`export_rexs`].

pub mod arrays;
mod container;
mod draft;
pub mod lookup;
pub mod lookup_grid;
#[cfg(feature = "parquet")]
pub mod parquet;
mod refusal;
mod report;
mod rexs;
pub mod sound;
mod unit;
mod z12;

pub use container::{MAX_FILES, MAX_UNPACKED_BYTES};
pub use refusal::{Refusal, RefusalKind};
pub use report::{
    Alternative, Assumed, Check, Ignored, Import, ImportSource, ImportWarning, ImportedPair, Offered, OperatingPoint,
    StageKind, Taken,
};
pub use rexs::{ExportForm, ExportOptions, export_rexs};

use sha2::{Digest, Sha256};

/// What the file leaves to whoever imports it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ImportOptions {
    /// The pair: its number among the pairs of the file, or the id of its stage.
    pub pair: Option<u64>,
    /// Makes a symmetric double-helical pair of a single-helical stage.
    pub mirror: bool,
    /// Width of the gap of a mirrored pair.
    pub gap_width_mm: Option<f64>,
    /// Torque of the whole pinion, in place of the file's.
    pub torque_nm: Option<f64>,
    /// Operating point of the document.
    pub point: PointChoice,
    /// What the face width of a double-helical pair is in a file that does not say it (Z12).
    pub face_width: FaceWidth,
}

/// What a face width is of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum FaceWidth {
    /// Both halves and the groove between them.
    #[default]
    Total,
    /// One half.
    Half,
}

/// An operating point of a load spectrum.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PointChoice {
    /// The first one.
    #[default]
    First,
    /// The one with this number, counted from 1.
    Number(u64),
    /// The one with the largest torque.
    Heaviest,
}

/// Reads a gear model: REXS 1.0 to 2.0.0 as XML, JSON or zip, or a calculation file of KISSsoft for a gear pair (Z12),
/// detected by the contents.
///
/// # Errors
/// [`Refusal`] with every reason found: the file cannot be read, is not complete, or has no pair that a document can
/// describe.
pub fn import(bytes: &[u8], options: &ImportOptions) -> Result<Import, Refusal> {
    let mut import = match z12::recognise(bytes) {
        Some(text) => z12::import(&text, options)?,
        None => {
            let file = container::open(bytes)?;
            let mut import = rexs::import(&file, options)?;
            import.source.file = file.name;
            import
        }
    };
    import.source.sha256 = hex::encode(Sha256::digest(bytes));
    Ok(import)
}
