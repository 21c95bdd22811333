//! Points and series as Parquet files, in programs that are built with the feature `parquet`. Others refuse the form.

#[cfg(feature = "parquet")]
mod files;
#[cfg(not(feature = "parquet"))]
mod refusals;

use super::problem::{ApiError, ProblemCode};

#[cfg(feature = "parquet")]
pub(super) use files::{series_body, table_bytes};
#[cfg(not(feature = "parquet"))]
pub(super) use refusals::{series_body, table_bytes};

/// The name of the form in the query parameter `format`.
pub(super) const NAME: &str = "parquet";
pub(super) const MEDIA_TYPE: &str = "application/vnd.apache.parquet";
/// Whether this program has the form.
pub(super) const IS_BUILT: bool = cfg!(feature = "parquet");

/// The refusal of a program without it; `offers`: what the path has besides.
pub(super) fn missing(offers: &[&str]) -> ApiError {
    let detail = format!(
        "This program was built without Parquet (cargo feature \"parquet\"). This path has: {}.",
        offers.join(", ")
    );
    ApiError::new(ProblemCode::NotAcceptable, detail)
}
