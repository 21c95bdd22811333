//! Models in archives.

use super::gearbox::Gearbox;
use super::*;
use std::io::{Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        writer.start_file(*name, SimpleFileOptions::default()).expect("started");
        writer.write_all(content).expect("written");
    }
    writer.finish().expect("finished").into_inner()
}

#[test]
fn an_archive_with_one_model_is_read() {
    let model = Gearbox::double_helical("1.6");
    let plain = imported(model.xml().as_bytes(), &ImportOptions::default());
    for (name, content) in
        [("model.rexs", model.xml()), ("rexs-model.rexsj", model.json()), ("a/b.REXS.XML", model.xml())]
    {
        let bytes = archive(&[("picture.png", b"\x89PNG"), (name, content.as_bytes())]);
        let import = imported(&bytes, &ImportOptions::default());
        assert_eq!((&import.document, import.source.file.as_deref()), (&plain.document, Some(name)));
        assert!(import.ignored.iter().any(|line| line.from == "picture.png"));
        assert_ne!(import.source.sha256, plain.source.sha256);
    }
}

#[test]
fn archives_without_one_model_are_refused() {
    let xml = Gearbox::double_helical("1.6").xml();
    let code = |bytes: &[u8]| refused(bytes, &ImportOptions::default()).errors[0].code.clone();
    assert_eq!(code(&archive(&[("readme.txt", b"no model")])), "no-model");
    assert_eq!(code(&archive(&[])), "no-model");
    assert_eq!(code(&archive(&[("a.rexs", xml.as_bytes()), ("b.rexsj", b"{}")])), "several-models");
    for path in ["../model.rexs", "a/../../model.rexs", "/etc/model.rexs", "..\\model.rexs", "C:\\model.rexs"] {
        assert_eq!(code(&archive(&[(path, xml.as_bytes())])), "path", "{path}");
    }
    let many: Vec<(String, &[u8])> = (0..101).map(|number| (format!("{number}.txt"), b"x".as_slice())).collect();
    let many: Vec<(&str, &[u8])> = many.iter().map(|(name, content)| (name.as_str(), *content)).collect();
    assert_eq!(code(&archive(&many)), "too-large");
    let whole = archive(&[("model.rexs", xml.as_bytes())]);
    assert_eq!(code(&whole[..whole.len() / 2]), "not-readable");
}

/// Two hundred megabytes of blanks in a few kilobytes: unpacking ends at the limit.
#[test]
fn a_bomb_is_not_unpacked() {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    writer.start_file("model.rexs", SimpleFileOptions::default()).expect("started");
    let blanks = vec![b' '; 1 << 20];
    for _ in 0..200 {
        writer.write_all(&blanks).expect("written");
    }
    let bytes = writer.finish().expect("finished").into_inner();
    assert!(bytes.len() < 1 << 20, "{}", bytes.len());
    let refusal = refused(&bytes, &ImportOptions::default());
    assert_eq!(refusal.errors[0].code, "too-large");
}

#[test]
fn models_of_very_many_elements_are_refused() {
    let xml = format!("<model><components>{}</components></model>", "<component id=\"1\"/>".repeat(500_001));
    assert_eq!(refused(xml.as_bytes(), &ImportOptions::default()).errors[0].code, "too-large");
    let json = format!("{{\"model\": {{\"components\": [{}{{\"id\": 2}}]}}}}", "{\"id\": 1},".repeat(500_001));
    assert_eq!(refused(json.as_bytes(), &ImportOptions::default()).errors[0].code, "too-large");
    let deep = "<a>".repeat(100_000);
    assert_eq!(refused(format!("<model>{deep}").as_bytes(), &ImportOptions::default()).errors[0].code, "not-rexs");
    let deep = format!("{{\"model\": {}", "[".repeat(100_000));
    refused(deep.as_bytes(), &ImportOptions::default());
}
