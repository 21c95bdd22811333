//! The point of a sweep that a job of its own repeats.

use herringbone_macros::Input;
use serde::Serialize;

/// Origin of a document that repeats a point of a sweep, with the values of that point to compare with.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct SweepPointInput {
    /// Id of the sweep.
    #[input(max_chars = 36)]
    pub job: String,
    /// Place of the point in the sweep's result, from 0.
    #[input(min = 0, max = 1_000_000)]
    pub position: u32,
    /// Hash of the inputs that determine the motion at the point.
    #[input(max_chars = 64)]
    pub input_hash: String,
    /// Whether the motion starts from the state from which the sweep reached the point.
    #[input(default = true)]
    pub same_start: bool,
    /// RMS of the circumferential mesh acceleration at the point, left and right half; null while the sweep has no motion there.
    #[input(unit = "SI", min = 0.0, max = 1e12, min_items = 2, max_items = 2)]
    pub mesh_circumferential_acceleration_rms_m_s2: Option<Vec<f64>>,
    /// Estimated relative error of these values.
    #[input(min = 0.0, max = 1e6)]
    pub error_estimate: Option<f64>,
    /// Kind of motion at the point, such as period-1.
    #[input(max_chars = 40)]
    pub regime: Option<String>,
}
