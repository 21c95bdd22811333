//! Large answers: as many at once as fit.

use super::*;
use crate::support::Service;
use std::io::{Read, Write};

/// A response whose body is not read.
async fn unread(app: &App, path: &str) -> axum::http::Response<axum::body::Body> {
    let request = axum::http::Request::get(path).header("host", "localhost").body(axum::body::Body::empty());
    tower::ServiceExt::oneshot(app.router.clone(), request.expect("a request")).await.expect("an answer")
}

#[tokio::test]
async fn large_answers_are_bounded_and_the_next_one_is_refused() {
    let served = served(HttpConfig { request_timeout_s: 1, ..HttpConfig::default() }).await;
    let (path, _) = served.app.run(&document()).await;
    let series = format!("{path}/series/a_x_left?method=none");
    let mut answers = Vec::new();
    for _ in 0..16 {
        let answer = unread(&served.app, &series).await;
        assert_eq!(answer.status(), 200);
        answers.push(answer);
    }
    let refused = served.app.get(&series).await;
    refused.assert_problem(503, "too-many-large-answers");
    assert_eq!(refused.header("retry-after"), "5");
    // What is small finds no bound.
    assert_eq!(served.app.get(&format!("{path}/series/a_x_left")).await.json["n_returned"], 2000);
    assert!(served.get(&format!("{path}/result")).await.text.to_lowercase().contains("content-length: "));
    answers.pop();
    let answer = served.app.get(&series).await;
    assert_eq!((answer.status, answer.json["n_returned"].as_u64()), (200, Some(10_000)));
    drop(answers);
}

#[tokio::test]
async fn a_series_in_pieces_is_the_whole_series() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let samples = |index: u32| if index == 7_777 { 50.0 } else { (f64::from(index) * 0.01).sin() };
    let whole = app.get(&format!("{path}/series/a_x_left?method=none")).await.json;
    let text = app.get(&format!("{path}/series/a_x_left?method=none&decimal=point")).await.text();
    let mut lines = text.lines().skip(1);
    for index in 0..10_000 {
        let (t, y) = (0.5 + f64::from(index) * 1e-4, samples(index));
        let at = index as usize;
        assert_eq!((whole["t"][at].as_f64(), whole["y"][at].as_f64()), (Some(t), Some(y)), "{index}");
        assert_eq!(lines.next(), Some(format!("{t:?},{y:?}").as_str()), "{index}");
    }
    assert_eq!((lines.next(), whole["t"].as_array().map(Vec::len)), (None, Some(10_000)));
}

/// Hundred clients of each large answer that read no more than its status. In the first version of this interface a
/// hundred series held 3.6 GB.
#[test]
fn clients_that_do_not_read_hold_little_memory() {
    let directory = tempfile::tempdir().expect("a directory");
    let (single, sweep) = stored_large_jobs(directory.path());
    // The bound on the wait for a place is a third of the request timeout.
    let service = Service::start_with(directory.path(), &["--log", "warn", "--request-timeout-s", "35"]);
    let program = service.program();
    let before = program.peak_memory_mb();
    let paths = [
        format!("{single}/series/a_x_left?method=none"),
        format!("{single}/series/a_x_left?method=none&decimal=point"),
        format!("{single}/result"),
        format!("{sweep}/result"),
        format!("{sweep}/points?limit=10000"),
        format!("{sweep}/points?decimal=comma"),
        format!("{sweep}/points/columns?limit=10000"),
    ];
    let mut streams = Vec::new();
    for path in paths.iter().flat_map(|path| std::iter::repeat_n(path, 100)) {
        let mut stream = std::net::TcpStream::connect(program.address()).expect("a connection");
        write!(stream, "GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").expect("sent");
        streams.push((path, stream));
    }
    let mut counts = std::collections::BTreeMap::<_, u32>::new();
    for (path, stream) in &mut streams {
        let mut start = [0; 12];
        stream.read_exact(&mut start).expect("a status");
        let status = String::from_utf8_lossy(&start[9..]).into_owned();
        *counts.entry((path.as_str(), status)).or_default() += 1;
    }
    let held = program.peak_memory_mb() - before;
    println!("700 clients: {held:.0} MB more than {before:.0} MB; answers: {counts:?}");
    assert!(held < 600.0, "{held} MB");
    let count = |status: &str| counts.iter().filter(|((_, other), _)| other == status).map(|(_, n)| n).sum::<u32>();
    assert_eq!(count("200") + count("503"), 700, "{counts:?}");
    // Rows are streamed and need no place.
    for path in &paths[3..6] {
        assert_eq!(counts.get(&(path.as_str(), "200".to_owned())), Some(&100), "{counts:?}");
    }
    assert!(count("503") > 0 && count("200") >= 316, "{counts:?}");
    drop(streams);
    let (status, body) = program.get(&format!("{single}/series/a_x_left?method=none&decimal=point"));
    assert_eq!((status, body.len() > 20_000_000), (200, true), "{} bytes", body.len());
}

/// Stores a job with a million samples and ten megabytes of result, and a sweep with 12 000 long rows; their paths.
fn stored_large_jobs(directory: &std::path::Path) -> (String, String) {
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(async {
        let app = app_at(directory).await;
        let (single, job) = app.run(&scripted("large")).await;
        assert_eq!(job["state"], "succeeded", "{job}");
        let (rows, job) = app.run(&sweep("large", 12_000)).await;
        assert_eq!(job["state"], "succeeded", "{job}");
        app.close().await;
        (single, rows)
    })
}
