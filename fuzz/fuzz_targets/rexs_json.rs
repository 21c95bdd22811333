//! Bytes as a REXS model in JSON. The first byte chooses options; what another reader would get is left out.

#![no_main]

use herringbone_fuzz::{check_import, first_sign};
use libfuzzer_sys::{Corpus, fuzz_target};

fuzz_target!(|bytes: &[u8]| -> Corpus {
    match bytes.split_first() {
        Some((choice, bytes)) if first_sign(bytes) == Some(b'{') => {
            check_import(bytes, *choice);
            Corpus::Keep
        }
        _ => Corpus::Reject,
    }
});
