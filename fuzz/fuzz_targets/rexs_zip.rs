//! Bytes as an archive with a REXS model. The first byte chooses options, the second one whether the rest is an archive
//! itself or, so that mutations reach behind the checksums, what an archive is made of: names and contents in turn,
//! each ended by a zero byte, then places and bytes by which the archive is damaged.

#![no_main]

use herringbone_fuzz::check_import;
use libfuzzer_sys::{Corpus, fuzz_target};
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// The archive that the parts stand for; `None` where the writer does not take a name.
fn archive(method: CompressionMethod, parts: &[&[u8]]) -> Option<Vec<u8>> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method);
    let (files, damage) = parts.as_chunks();
    for [name, content] in files {
        writer.start_file(std::str::from_utf8(name).ok()?, options).ok()?;
        writer.write_all(content).ok()?;
    }
    let mut bytes = writer.finish().ok()?.into_inner();
    // No byte of it is zero. Places count from the end backwards: there the directory stands.
    for [coarse, fine, byte] in damage.iter().flat_map(|damage| damage.as_chunks().0) {
        let from_end = 255 * usize::from(coarse - 1) + usize::from(*fine);
        if let Some(target) = bytes.len().checked_sub(from_end).and_then(|place| bytes.get_mut(place)) {
            *target = byte - 1;
        }
    }
    Some(bytes)
}

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let [choice, form, rest @ ..] = bytes else { return Corpus::Reject };
    let method = match form % 3 {
        0 if rest.starts_with(b"PK") => {
            check_import(rest, *choice);
            return Corpus::Keep;
        }
        0 => return Corpus::Reject,
        1 => CompressionMethod::Stored,
        _ => CompressionMethod::Deflated,
    };
    let parts: Vec<&[u8]> = rest.split(|byte| *byte == 0).collect();
    let Some(bytes) = archive(method, &parts) else { return Corpus::Reject };
    check_import(&bytes, *choice);
    Corpus::Keep
});
