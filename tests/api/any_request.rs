//! Random queries and headers on everything that reads: answered or refused in the one form, never a failure of the
//! service.

use crate::support::*;
use axum::body::Body;
use axum::http::{HeaderValue, Method, Request, Uri};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use tower::ServiceExt;

/// Words that mean something to some parameter, and some that nearly do.
const WORDS: [&str; 31] = [
    "queued,failed",
    "mesh",
    "sweep",
    "minmax",
    "lttb",
    "none",
    "0",
    "1",
    "-1",
    "0.5",
    "1e308",
    "-1e-400",
    "NaN",
    "inf",
    "18446744073709551616",
    "200001",
    "%00",
    "%ff",
    "%",
    "+",
    "a%20b",
    "",
    "01",
    "\u{e9}",
    "*/*",
    "W/\"1\"",
    "name",
    "desc",
    "2026-02-30",
    "-009999-01-01T00:00:00%2B25:59",
    "%5B%5D*",
];
const NAMES: [&str; 14] = [
    "state",
    "kind",
    "label",
    "limit",
    "cursor",
    "from",
    "to",
    "max_points",
    "method",
    "page",
    "%66rom",
    "search",
    "sort",
    "order",
];
const HEADERS: [&str; 9] = [
    "accept",
    "if-none-match",
    "x-request-id",
    "last-event-id",
    "accept-encoding",
    "range",
    "idempotency-key",
    "host",
    "authorization",
];

/// The seed, unless `PROPTEST_RNG_SEED` sets another.
const SEED: u64 = 1;

#[derive(Debug, Clone)]
struct Asked {
    path: usize,
    query: String,
    headers: Vec<(&'static str, Vec<u8>)>,
}

fn asked() -> impl Strategy<Value = Asked> {
    let word = || prop_oneof![3 => select(&WORDS[..]).prop_map(str::to_owned), 1 => "[ -~]{0,12}", 1 => "\\PC{0,8}"];
    let pair = (prop_oneof![8 => select(&NAMES[..]).prop_map(str::to_owned), 1 => "[a-z]{0,5}"], word());
    let query = proptest::collection::vec(pair, 0..5)
        .prop_map(|pairs| pairs.into_iter().map(|(name, word)| format!("{name}={word}")).collect::<Vec<_>>().join("&"));
    let value = prop_oneof![word().prop_map(String::into_bytes), proptest::collection::vec(any::<u8>(), 0..12)];
    let headers = proptest::collection::vec((select(&HEADERS[..]), value), 0..3);
    (0..8usize, query, headers).prop_map(|(path, query, headers)| Asked { path, query, headers })
}

#[tokio::test]
async fn every_request_is_answered_or_refused() {
    let app = app().await;
    let (job, _) = app.run(&document()).await;
    let paths = [
        "/api/v1/jobs".to_owned(),
        job.clone(),
        format!("{job}/result"),
        format!("{job}/input"),
        format!("{job}/series"),
        format!("{job}/series/a_x_left"),
        format!("{job}/points"),
        "/problems/internal".to_owned(),
    ];
    let config = match Config::default() {
        Config { rng_seed: RngSeed::Random, .. } => Config { rng_seed: RngSeed::Fixed(SEED), ..Config::default() },
        given => given,
    };
    // Shown where the test fails.
    println!("PROPTEST_RNG_SEED: {:?}", config.rng_seed);
    let (mut runner, strategy) = (TestRunner::new(config), asked());
    let (mut answered, mut refused) = (0, 0);
    for _ in 0..1500 {
        let asked = strategy.new_tree(&mut runner).expect("a request").current();
        let text = format!("{}?{}", paths[asked.path], asked.query);
        // What is no address cannot be sent.
        let Ok(uri) = text.parse::<Uri>() else { continue };
        let mut request = Request::builder().method(Method::GET).uri(uri);
        if !asked.headers.iter().any(|(name, _)| name.eq_ignore_ascii_case("host")) {
            request = request.header("host", "localhost");
        }
        for (name, value) in &asked.headers {
            if let Ok(value) = HeaderValue::from_bytes(value) {
                request = request.header(*name, value);
            }
        }
        let request = request.body(Body::empty()).expect("a request");
        let answer = Answer::of(app.router.clone().oneshot(request).await.expect("an answer")).await;
        assert!(answer.status < 500, "{asked:?}: {answer:?}");
        if answer.status >= 400 {
            let code = answer.json["code"].as_str().unwrap_or_default().to_owned();
            answer.assert_problem(answer.status, &code);
            refused += 1;
        } else {
            answered += 1;
        }
    }
    assert!(answered > 100 && refused > 100, "{answered} answered, {refused} refused");
}
