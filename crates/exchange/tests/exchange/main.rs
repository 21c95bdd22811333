//! Import of gear models: real files, every dialect, refusals, mutations.

mod archive;
mod dialects;
mod export;
mod files;
mod gearbox;
mod modifications;
mod mutations;
mod operation;
mod refusals;
mod shafts;
mod z12;

use herringbone_exchange::{Import, ImportOptions, Refusal, import};
use serde_json::Value;
use std::path::Path;

/// A file of the test data.
fn data(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn imported(bytes: &[u8], options: &ImportOptions) -> Import {
    import(bytes, options).unwrap_or_else(|refusal| panic!("{refusal:#?}"))
}

fn refused(bytes: &[u8], options: &ImportOptions) -> Refusal {
    match import(bytes, options) {
        Ok(import) => panic!("taken: {:#?}", import.pair),
        Err(refusal) => refusal,
    }
}

/// A number of the document.
fn number(import: &Import, pointer: &str) -> f64 {
    let value = import.document.pointer(pointer).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("{pointer}: {:?}", import.document.pointer(pointer)))
}

fn text<'i>(import: &'i Import, pointer: &str) -> &'i str {
    import.document.pointer(pointer).and_then(Value::as_str).unwrap_or_else(|| panic!("{pointer}: no text"))
}

#[track_caller]
fn assert_close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

/// The geometry that the service calculates for the document.
fn geometry(import: &Import) -> herringbone_job::result::Geometry {
    let document = herringbone_job::parse_value(&import.document).unwrap_or_else(|error| panic!("{error:#?}"));
    herringbone_job::study::CheckedJob::new(document).unwrap_or_else(|error| panic!("{error:#?}")).report().geometry
}

fn has_warning(import: &Import, code: &str) -> bool {
    import.warnings.iter().any(|warning| warning.code == code)
}
