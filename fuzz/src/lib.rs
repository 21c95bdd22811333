//! What the targets for readers of gear models share.

use herringbone_exchange::{FaceWidth, ImportOptions, PointChoice, import};

/// Options of an import that a byte chooses, one bit for each of them and the three highest ones for the number.
fn options(choice: u8) -> ImportOptions {
    let is_set = |bit: u8| choice & (1 << bit) != 0;
    let number = u64::from(choice >> 5) + 1;
    ImportOptions {
        pair: is_set(1).then_some(number),
        mirror: is_set(0),
        gap_width_mm: is_set(4).then_some(30.0),
        torque_nm: is_set(2).then_some(500.0),
        point: match (is_set(3), is_set(5)) {
            (false, _) => PointChoice::First,
            (true, false) => PointChoice::Heaviest,
            (true, true) => PointChoice::Number(number),
        },
        face_width: if is_set(4) { FaceWidth::Half } else { FaceWidth::Total },
    }
}

/// Imports a file: what is taken is a valid document with a report whose lines are true, what is refused has reasons
/// that can be read.
///
/// # Panics
/// One of these promises is broken, or the reader panics.
pub fn check_import(bytes: &[u8], choice: u8) {
    match import(bytes, &options(choice)) {
        Ok(import) => {
            herringbone_job::parse_value(&import.document).expect("a valid document");
            for line in &import.taken {
                assert_eq!(import.document.pointer(&line.pointer), Some(&line.value), "{line:?}");
            }
            assert!(!import.operating_points.is_empty(), "no operating point");
        }
        Err(refusal) => {
            assert!(!refusal.errors.is_empty() && !refusal.summary.is_empty(), "{refusal:?}");
            let is_readable = |detail: &str| !detail.is_empty() && detail.len() < 4000;
            assert!(refusal.errors.iter().all(|error| is_readable(&error.detail)), "{refusal:?}");
        }
    }
}

/// First byte of a text that is neither blank nor part of a byte order mark: it decides which reader a file goes to.
pub fn first_sign(bytes: &[u8]) -> Option<u8> {
    let body = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    body.iter().copied().find(|byte| !byte.is_ascii_whitespace())
}
