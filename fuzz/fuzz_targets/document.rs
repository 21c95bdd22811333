//! Bytes as a job document: reading never panics; what is read reads back as itself when written out; whether the gear
//! can exist is answered without a panic.

#![no_main]

use herringbone_job::study::CheckedJob;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Ok(document) = herringbone_job::parse(bytes) else { return };
    let written = serde_json::to_vec(&document).expect("a document holds numbers and texts");
    let again = herringbone_job::parse(&written).expect("a document written out is valid");
    assert!(document == again, "{document:?}\nreads back as\n{again:?}");
    let _ = CheckedJob::new(document);
});
