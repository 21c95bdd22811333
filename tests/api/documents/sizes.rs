//! Bodies of up to a megabyte that are as unlike a document as they can be: each gets the right answer, and a short
//! one.

use super::{JSON, with};
use crate::support::*;
use axum::http::Method;
use rstest::rstest;
use serde_json::{Value, json};

/// Largest body that is read.
const MEBIBYTE: usize = 1 << 20;
/// Violations listed, and one entry that says how many more there are.
const MOST_ERRORS: usize = 1001;

/// `part` as often as it fits into a large body.
fn many(part: &str) -> String {
    part.repeat((MEBIBYTE - 4096) / part.len())
}

/// An object with as many members as fit, no name twice.
fn many_members() -> String {
    let members: Vec<String> = (0..60_000).map(|index| format!("\"{index:x}\":{index}")).collect();
    format!("{{{}}}", members.join(","))
}

fn nested(levels: usize) -> String {
    format!("{}{}", "[".repeat(levels), "]".repeat(levels))
}

/// The document with raw text as the value of one more member of its root.
fn with_member(name: &str, text: &str) -> String {
    document().to_string().replacen('{', &format!("{{\"{name}\":{text},"), 1)
}

#[rstest]
#[case::blanks(many(" "))]
#[case::open_arrays(many("["))]
#[case::open_objects(many("{\"a\":"))]
#[case::levels(nested(128))]
#[case::digits(many("9"))]
#[case::exponent(format!("1e{}", many("9")))]
#[case::one_member_again_and_again(format!("{{\"kind\":0{}}}", many(",\"kind\":0")))]
#[case::member_twice("{\"kind\": \"mesh\", \"kind\": \"mesh\"}".into())]
#[case::member_twice_below(with_member("model", "{\"plane\":\"base\",\"pl\\u0061ne\":\"pitch\"}"))]
#[case::open_string(format!("\"{}", many("x")))]
#[case::lone_surrogate("{\"name\": \"\\ud800\"}".into())]
#[case::surrogates_the_wrong_way_round("{\"name\": \"\\udc00\\ud800\"}".into())]
#[case::raw_control_character("{\"name\": \"a\u{1}\"}".into())]
#[case::two_byte_order_marks(format!("\u{feff}\u{feff}{}", document()))]
#[case::garbage_behind(format!("{}\u{0}", document()))]
#[case::utf_16(document().to_string().chars().flat_map(|letter| [letter, '\0']).collect())]
#[tokio::test]
async fn not_json(#[case] body: String) {
    let app = app().await;
    let answer = app.send(Method::POST, "/api/v1/jobs", &[JSON], body).await;
    answer.assert_problem(400, "malformed-json");
    assert!(answer.body.len() < 1024, "{} bytes", answer.body.len());
}

#[rstest]
#[case::members(many_members(), "", "further")]
#[case::members_of_a_block(with("/design/material", serde_json::from_str(&many_members()).unwrap()), "", "further")]
#[case::long_name(with("/name", json!(many("x"))), "/name", "too-long")]
#[case::long_member(format!("{{\"{}\":1}}", many("/")), &format!("/{}…", "~1".repeat(60)), "unknown-field")]
#[case::long_word(with("/kind", json!(many("é"))), "/kind", "not-one-of")]
#[case::levels(with_member("shape", &nested(126)), "/shape", "unknown-field")]
#[case::objects(with("/axes", json!(vec![json!({}); 200_000])), "/axes", "out-of-range")]
#[case::numbers(with("/analysis", json!({"initial_state": vec![0; 400_000]})), "/analysis/initial_state", "out-of-range")]
#[case::texts(with("/analysis", json!({"channels": vec![""; 200_000]})), "/analysis/channels", "out-of-range")]
#[case::small_number(with_member("limit", &format!("0.{}1", many("0"))), "/limit", "unknown-field")]
#[case::array(format!("[{}0]", many("0,")), "", "wrong-type")]
#[tokio::test]
async fn json_but_no_document(#[case] body: String, #[case] pointer: &str, #[case] code: &str) {
    assert!(body.len() <= MEBIBYTE, "{}", body.len());
    let app = app().await;
    let answer = app.send(Method::POST, "/api/v1/jobs", &[JSON], body).await;
    answer.assert_problem(422, "invalid-design");
    let errors = answer.json["errors"].as_array().expect("errors");
    let found = errors.iter().any(|error| error["pointer"] == pointer && error["code"] == code);
    assert!(found, "{:.2000}", answer.text());
    assert!(errors.len() <= MOST_ERRORS && answer.body.len() < MEBIBYTE / 2, "{} bytes", answer.body.len());
}

#[tokio::test]
async fn what_is_not_listed_is_counted() {
    let app = app().await;
    let answer = app.send(Method::POST, "/api/v1/jobs/validate", &[JSON], many_members()).await;
    let errors = answer.json["errors"].as_array().expect("errors");
    assert_eq!(errors.len(), MOST_ERRORS);
    // Sixty thousand unknown members, and a design and an operation that are missing.
    assert_eq!(errors[1000]["detail"], "has 59002 further violations, not listed here");
}

fn sweep_over(n: usize) -> String {
    let mut sweep = document();
    let values: Vec<Value> = (0..n).map(|index| json!(1000 + index)).collect();
    sweep["kind"] = json!("sweep");
    sweep["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "values": values}]);
    sweep.to_string()
}

#[tokio::test]
async fn as_many_values_as_a_sweep_may_have() {
    let app = app().await;
    let answer = app.send(Method::POST, "/api/v1/jobs/validate", &[JSON], sweep_over(100_000)).await;
    assert_eq!(answer.status, 200, "{:.500}", answer.text());
    let answer = app.send(Method::POST, "/api/v1/jobs/validate", &[JSON], sweep_over(100_001)).await;
    answer.assert_problem(422, "invalid-design");
    answer.violation("/axes/0/values");
}

#[tokio::test]
async fn compressed_bodies_are_not_unpacked() {
    let app = app().await;
    for encoding in ["gzip", "deflate", "br", "zstd", "identity, gzip", "GZIP"] {
        let headers = [JSON, ("content-encoding", encoding)];
        let answer = app.send(Method::POST, "/api/v1/jobs", &headers, document().to_string()).await;
        answer.assert_problem(415, "unsupported-media-type");
    }
    let headers = [JSON, ("content-encoding", "identity")];
    assert_eq!(app.send(Method::POST, "/api/v1/jobs", &headers, document().to_string()).await.status, 202);
    // Packed without saying so: no text at all.
    let packed = vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3];
    app.send(Method::POST, "/api/v1/jobs", &[JSON], packed).await.assert_problem(400, "malformed-json");
}
