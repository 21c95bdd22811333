//! Bytes as a calculation file of KISSsoft. The first byte chooses options, the second one how the rest becomes a file:
//! as it is, or as text that is put after the first lines of such a file, in single bytes or in UTF-16.

#![no_main]

use herringbone_fuzz::check_import;
use libfuzzer_sys::{Corpus, fuzz_target};

const HEAD: &str = "VERSION=20.0;\r\nKSOFTVERSION=2020 D;\r\nMODULE=Z012;\r\n";

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let [choice, form, rest @ ..] = bytes else { return Corpus::Reject };
    let text = || format!("{HEAD}{}", String::from_utf8_lossy(rest));
    let file = match form % 4 {
        0 => rest.to_vec(),
        // Signs beyond Windows-1252 lose their higher bits, as any byte may stand in a file.
        1 => text().chars().map(|sign| sign as u32 as u8).collect(),
        2 => [0xfeff].into_iter().chain(text().encode_utf16()).flat_map(u16::to_le_bytes).collect(),
        _ => [0xfeff].into_iter().chain(text().encode_utf16()).flat_map(u16::to_be_bytes).collect(),
    };
    check_import(&file, *choice);
    Corpus::Keep
});
