//! Files read back by readers written from the descriptions of the formats; other programs read them in
//! `scripts/check-files`.

use super::*;
use std::io::{Cursor, Read};

const VALUES: [f64; 4] = [0.1, -1.0 / 3.0, 5e-324, f64::MAX];
const WORDS: [&str; 3] = ["N/µm", "", "m/s²"];

fn file(form: ArrayForm) -> Vec<u8> {
    let mut writer = ArrayWriter::new(form, Vec::new()).unwrap();
    writer.scalar("dt_s", 1.5e-5).unwrap();
    writer.begin("a_x_left", 4).unwrap();
    writer.push(&VALUES[..3]).unwrap();
    assert!(writer.words("units", &WORDS).is_err(), "the array is not complete");
    writer.push(&VALUES[3..]).unwrap();
    writer.numbers("empty", &[]).unwrap();
    writer.words("units", &WORDS).unwrap();
    writer.finish().unwrap()
}

fn bits(bytes: &[u8]) -> Vec<u64> {
    bytes.chunks(8).map(|chunk| u64::from_le_bytes(chunk.try_into().unwrap())).collect()
}

#[test]
fn an_archive_of_numpy_arrays() {
    let mut archive = zip::ZipArchive::new(Cursor::new(file(ArrayForm::Npz))).unwrap();
    let mut member = |name: &str| {
        let mut bytes = Vec::new();
        let mut member = archive.by_name(name).unwrap();
        assert_eq!(member.compression(), zip::CompressionMethod::Stored);
        member.read_to_end(&mut bytes).unwrap();
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!((start % 64, bytes[start - 1]), (0, b'\n'));
        (String::from_utf8(bytes[10..start].to_vec()).unwrap().trim_end().to_owned(), bytes.split_off(start))
    };
    let (header, data) = member("a_x_left.npy");
    assert_eq!(header, "{'descr': '<f8', 'fortran_order': False, 'shape': (4,), }");
    assert_eq!(bits(&data), VALUES.map(f64::to_bits));
    let (header, data) = member("dt_s.npy");
    assert!(header.contains("'shape': ()"));
    assert_eq!(bits(&data), [1.5e-5_f64.to_bits()]);
    assert_eq!(member("empty.npy").1, b"");
    let (header, data) = member("units.npy");
    assert!(header.contains("'<U4'") && header.contains("(3,)"));
    let words: Vec<String> = data
        .chunks(16)
        .map(|word| {
            let letters = word.chunks(4).map(|letter| u32::from_le_bytes(letter.try_into().unwrap()));
            letters.filter(|letter| *letter > 0).map(|letter| char::from_u32(letter).unwrap()).collect()
        })
        .collect();
    assert_eq!(words, WORDS);
    assert_eq!(archive.len(), 4);
}

/// The elements of a MAT-file or of a matrix: type and content.
fn elements(mut bytes: &[u8]) -> Vec<(u32, &[u8])> {
    let mut elements = Vec::new();
    while !bytes.is_empty() {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let (kind, length) = (word(0), word(4) as usize);
        elements.push((kind, &bytes[8..8 + length]));
        bytes = &bytes[8 + length.next_multiple_of(8)..];
    }
    elements
}

#[test]
fn a_file_of_matlab_variables() {
    let file = file(ArrayForm::Mat);
    assert_eq!((file[..6].to_vec(), &file[124..128]), (b"MATLAB".to_vec(), &b"\x00\x01IM"[..]));
    let variables = elements(&file[128..]);
    let mut names = Vec::new();
    for (kind, variable) in variables {
        assert_eq!((kind, variable.len() % 8), (14, 0));
        let parts = elements(variable);
        let [(6, flags), (5, size), (1, name), (data_kind, data)] = parts.as_slice() else { panic!("{parts:?}") };
        let size: Vec<i32> = size.chunks(4).map(|word| i32::from_le_bytes(word.try_into().unwrap())).collect();
        let name = std::str::from_utf8(name).unwrap();
        match name {
            "dt_s" => assert_eq!((size, bits(data)), (vec![1, 1], vec![1.5e-5_f64.to_bits()])),
            "a_x_left" => {
                assert_eq!((flags[0], *data_kind, size), (6, 9, vec![4, 1]));
                assert_eq!(bits(data), VALUES.map(f64::to_bits));
            }
            "empty" => assert_eq!((size, data.len()), (vec![0, 1], 0)),
            _ => {
                assert_eq!((flags[0], *data_kind, size), (4, 4, vec![3, 4]));
                let letters: Vec<u16> = data.chunks(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect();
                let row = |row: usize| (0..4).map(|column| letters[column * 3 + row]).collect::<Vec<_>>();
                let words = [0, 1, 2].map(|at| String::from_utf16(&row(at)).unwrap().trim_end().to_owned());
                assert_eq!(words, WORDS);
            }
        }
        names.push(name.to_owned());
    }
    assert_eq!(names, ["dt_s", "a_x_left", "empty", "units"]);
}

#[test]
fn a_file_is_refused_when_its_arrays_are_not_complete_or_too_large() {
    for form in [ArrayForm::Npz, ArrayForm::Mat] {
        let mut writer = ArrayWriter::new(form, Vec::new()).unwrap();
        writer.begin("a", 2).unwrap();
        assert!(writer.push(&[1.0, 2.0, 3.0]).is_err());
        assert!(writer.begin("b", 1).is_err() && writer.scalar("c", 1.0).is_err());
        assert!(writer.finish().is_err());
    }
    let mut writer = ArrayWriter::new(ArrayForm::Mat, Vec::new()).unwrap();
    assert!(writer.begin("a", ArrayForm::Mat.max_values() + 1).is_err());
}

#[test]
fn names_are_variables_and_occur_once() {
    let mut names = ArrayForm::Mat.names();
    assert_eq!(names.name("/operation/pinion_speed_rpm"), "operation_pinion_speed_rpm");
    assert_eq!(names.name("1st"), "v_1st");
    assert_eq!(names.name(""), "v_");
    let long = "x".repeat(70);
    assert_eq!(names.name(&long), "x".repeat(63));
    assert_eq!(names.name(&long), "x".repeat(61) + "_2");
    assert_eq!(names.name(&long), "x".repeat(61) + "_3");
    assert_eq!(ArrayForm::Npz.names().name(&long), long);
}
