//! Documents as editors and other programs save them: with a byte order mark, and in other encodings than UTF-8.

use super::JSON;
use crate::support::*;
use axum::http::Method;
use rstest::rstest;

const PATHS: [&str; 2] = ["/api/v1/jobs", "/api/v1/jobs/validate"];

#[tokio::test]
async fn f07_a_byte_order_mark_before_the_document_is_no_part_of_it() {
    let app = app().await;
    for content_type in ["application/json", "application/json; charset=utf-8", "application/vnd.herringbone+json"] {
        for path in PATHS {
            let body = format!("\u{feff}{}", document());
            let answer = app.send(Method::POST, path, &[("content-type", content_type)], body).await;
            assert!(answer.status == 200 || answer.status == 202, "{answer:?}");
        }
    }
    // What is wrong behind it is found at its own place.
    let answer = app.send(Method::POST, PATHS[0], &[JSON], "\u{feff}{,").await;
    answer.assert_problem(400, "malformed-json");
    assert!(answer.json["detail"].as_str().is_some_and(|detail| detail.contains("(line 1, column 2)")), "{answer:?}");
}

fn utf16(text: &str, mark: bool, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let mark = mark.then_some(0xfeff);
    mark.into_iter().chain(text.encode_utf16()).flat_map(bytes).collect()
}

#[rstest]
#[case::little_endian(true, u16::to_le_bytes, "UTF-16 (little-endian)")]
#[case::big_endian(true, u16::to_be_bytes, "UTF-16 (big-endian)")]
#[case::little_endian_without_mark(false, u16::to_le_bytes, "UTF-16 (little-endian)")]
#[case::big_endian_without_mark(false, u16::to_be_bytes, "UTF-16 (big-endian)")]
#[tokio::test]
async fn f07_utf_16_is_named(#[case] mark: bool, #[case] bytes: fn(u16) -> [u8; 2], #[case] name: &str) {
    let app = app().await;
    for path in PATHS {
        let answer = app.send(Method::POST, path, &[JSON], utf16(&document().to_string(), mark, bytes)).await;
        answer.assert_problem(400, "malformed-json");
        let detail = answer.json["detail"].as_str().unwrap_or_default();
        assert!(detail.contains(name) && detail.contains("needed: UTF-8"), "{detail}");
    }
}

#[tokio::test]
async fn f07_single_byte_encodings_are_told_from_utf_8() {
    let app = app().await;
    let mut document = document();
    document["name"] = "Gr@@e".into();
    let body: Vec<u8> = document.to_string().bytes().map(|byte| if byte == b'@' { 0xf6 } else { byte }).collect();
    let answer = app.send(Method::POST, PATHS[0], &[JSON], body).await;
    answer.assert_problem(400, "malformed-json");
    let detail = answer.json["detail"].as_str().unwrap_or_default();
    assert!(detail.contains("not encoded in UTF-8") && detail.contains("Windows-1252"), "{detail}");
}
