//! Bytes as a gear model of another program: reading never panics; what is taken is a valid document and a report whose
//! lines are true; what is refused has a reason. The first byte chooses options.

#![no_main]

use herringbone_exchange::{ImportOptions, PointChoice, import};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((choice, bytes)) = bytes.split_first() else { return };
    let options = ImportOptions {
        pair: (choice & 2 != 0).then_some(u64::from(choice >> 5) + 1),
        mirror: choice & 1 != 0,
        gap_width_mm: None,
        torque_nm: (choice & 4 != 0).then_some(500.0),
        point: if choice & 8 != 0 { PointChoice::Heaviest } else { PointChoice::First },
        ..ImportOptions::default()
    };
    match import(bytes, &options) {
        Ok(import) => {
            herringbone_job::parse_value(&import.document).expect("a valid document");
            for line in &import.taken {
                assert_eq!(import.document.pointer(&line.pointer), Some(&line.value), "{line:?}");
            }
        }
        Err(refusal) => assert!(!refusal.errors.is_empty(), "{refusal:?}"),
    }
});
