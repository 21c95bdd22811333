//! Sweeps: their points are rows, written while they run, read in pages, and gone on from.

use crate::support::*;
use herringbone::work::WorkConfig;
use http_body_util::BodyExt;
use serde_json::{Value, json};
use tower::ServiceExt;

async fn page(app: &App, path: &str, query: &str) -> Value {
    let answer = app.get(&format!("{path}/points{query}")).await;
    assert_eq!(answer.status, 200, "{answer:?}");
    answer.json
}

/// Waits until so many points are written.
async fn written(app: &App, path: &str, n: u64) {
    for _ in 0..3000 {
        if page(app, path, "?limit=1").await["n_solved"].as_u64() >= Some(n) {
            return;
        }
        tokio::time::sleep(std::time::Duration::from_millis(10)).await;
    }
    panic!("{n} points are not written");
}

#[tokio::test]
async fn the_result_has_all_points_and_the_list_has_them_in_pages() {
    let app = app().await;
    let (path, job) = app.run(&sweep("all", 25)).await;
    assert_eq!(
        (job["state"].as_str(), job["links"]["points"].as_str()),
        (Some("succeeded"), Some(&*format!("{path}/points")))
    );
    let result = app.get(&format!("{path}/result")).await;
    let points = result.json["sweep"]["points"].as_array().unwrap();
    assert_eq!(points.len(), 25);
    let mut from = json!(0);
    let mut seen = Vec::new();
    while !from.is_null() {
        let page = page(&app, &path, &format!("?from={from}&limit=10")).await;
        assert_eq!((page["n_solved"].as_u64(), page["n_points"].as_u64()), (Some(25), Some(25)));
        seen.extend(page["items"].as_array().unwrap().clone());
        from = page["next_position"].clone();
    }
    let positions: Vec<_> = seen.iter().map(|item| item["position"].as_u64().unwrap()).collect();
    assert_eq!(positions, (0..25).collect::<Vec<_>>());
    assert!(seen.iter().zip(points).all(|(item, point)| item["point"] == *point));
    app.get(&format!("{path}/points?limit=0")).await.assert_problem(400, "invalid-parameter");
    let (other, _) = app.run(&document()).await;
    app.get(&format!("{other}/points")).await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn the_table_is_csv_for_those_who_ask() {
    let app = app().await;
    let (path, _) = app.run(&sweep("all", 3)).await;
    let answer = app.get_with(&format!("{path}/points"), &[("accept", "text/csv")]).await;
    let text = answer.text();
    let lines: Vec<_> = text.lines().collect();
    assert_eq!(answer.header("content-type"), "text/csv; charset=utf-8");
    assert!(
        lines[0]
            .starts_with("position,branch,/operation/pinion_speed_rpm,mesh_circumferential_acceleration_rms_left_m_s2")
    );
    assert_eq!(lines.len(), 4);
    let columns = lines[0].split(',').count();
    // The scripted points carry an error with a comma and a quote.
    assert!(
        lines[1].starts_with("0,,1000.0,,") && lines[1].ends_with("\"no \"\"response\"\", scripted\""),
        "{}",
        lines[1]
    );
    assert_eq!(lines[1].split(',').count(), columns + 1);
}

#[tokio::test]
async fn a_reused_sweep_has_its_points_too() {
    let app = app().await;
    let document = sweep("all", 5);
    let (first, _) = app.run(&document).await;
    let (second, job) = app.run(&document).await;
    assert!(job["reused_from"].is_string());
    let results = [app.get(&format!("{first}/result")).await, app.get(&format!("{second}/result")).await];
    assert_eq!(results[0].json["sweep"], results[1].json["sweep"]);
    assert_ne!(results[0].header("etag"), results[1].header("etag"));
    // The copy does not need the first any more.
    app.delete(&first).await;
    assert_eq!(app.get(&format!("{second}/result")).await.json["sweep"]["points"].as_array().unwrap().len(), 5);
}

#[tokio::test]
async fn points_of_a_running_sweep_can_be_read() {
    let app = app().await;
    app.solver.breakpoints.hold("point 3");
    let path = app.submit(&sweep("all", 6)).await;
    written(&app, &path, 3).await;
    let first = page(&app, &path, "").await;
    assert_eq!((first["items"].as_array().unwrap().len(), first["n_points"].as_u64()), (3, Some(6)));
    app.get(&format!("{path}/result")).await.assert_problem(409, "result-not-ready");
    app.solver.breakpoints.release("point 3");
    app.ended(&path).await;
    assert_eq!(page(&app, &path, "").await["n_solved"], 6);
}

#[tokio::test]
async fn a_sweep_goes_on_after_a_restart_where_it_was() {
    let app = app().await;
    app.solver.breakpoints.hold("point 4");
    let path = app.submit(&sweep("all", 8)).await;
    app.solver.breakpoints.reached("point 4", 1).await;
    let app = app.restart().await;
    let job = app.ended(&path).await;
    assert_eq!((job["state"].as_str(), job["attempt"].as_i64()), (Some("succeeded"), Some(2)));
    // Solved before the shutdown, although nothing had told the progress yet.
    assert_eq!(app.solver.breakpoints.count("point 3"), 0);
    assert_eq!(app.solver.breakpoints.count("point 4"), 1);
    assert_eq!(app.get(&format!("{path}/result")).await.json["numerics"]["reused"], json!(["points"]));
    assert_eq!(page(&app, &path, "").await["n_solved"], 8);
}

#[tokio::test]
async fn a_canceled_sweep_is_gone_on_with_when_it_is_submitted_again() {
    let app = app().await;
    app.solver.breakpoints.hold("point 4");
    let document = sweep("all", 8);
    let first = app.submit(&document).await;
    app.solver.breakpoints.reached("point 4", 1).await;
    app.post(&format!("{first}/cancel")).await;
    assert_eq!(app.ended(&first).await["state"], "canceled");
    assert_eq!(page(&app, &first, "").await["n_solved"], 4);
    app.solver.breakpoints.release("point 4");
    let (second, _) = app.run(&document).await;
    assert_eq!(app.solver.breakpoints.count("point 3"), 1);
    assert_eq!(app.solver.breakpoints.count("point 4"), 2);
    // Each keeps what is its own.
    app.delete(&first).await.assert_status(204);
    assert_eq!(page(&app, &second, "").await["n_solved"], 8);
    app.get(&format!("{first}/points")).await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn sweeps_do_not_keep_single_jobs_waiting() {
    let app = app_with(WorkConfig { workers: Some(1), threads: Some(1), sweep_workers: 1, ..small() }).await;
    app.solver.breakpoints.hold("point 0");
    let sweeps = [app.submit(&sweep("all", 3)).await, app.submit(&sweep("all", 3)).await];
    app.solver.breakpoints.reached("point 0", 1).await;
    // The only thread of the sweeps is taken, and a sweep waits; a single job runs all the same.
    let (_, job) = app.run(&document()).await;
    assert_eq!(job["state"], "succeeded");
    assert_eq!(app.get("/api/v1/system").await.json["workers"]["sweeps_busy"], 1);
    app.solver.breakpoints.release("point 0");
    for path in &sweeps {
        assert_eq!(app.ended(path).await["state"], "succeeded");
    }
}

#[tokio::test]
async fn a_sweep_that_had_its_turn_makes_way_and_goes_on_later() {
    let app = app_with(WorkConfig { sweep_workers: 1, sweep_turn_s: 0, ..small() }).await;
    app.solver.breakpoints.hold("point 2");
    let long = app.submit(&sweep("all", 4)).await;
    app.solver.breakpoints.reached("point 2", 1).await;
    let other = app.submit(&sweep("failing", 1)).await;
    // The first cannot get past its third point, so the second runs only if the first makes way.
    assert_eq!(app.ended(&other).await["state"], "failed");
    app.solver.breakpoints.release("point 2");
    let job = app.ended(&long).await;
    assert_eq!(job["state"], "succeeded");
    assert!(job["attempt"].as_i64() >= Some(2), "{job}");
    assert_eq!(app.solver.breakpoints.count("point 0"), 1);
}

#[tokio::test]
async fn a_job_that_computes_too_long_fails_and_a_sweep_keeps_its_points() {
    let limits = WorkConfig { job_time_limit_s: 1, sweep_time_limit_s: 1, ..small() };
    let app = app_with(limits).await;
    app.solver.breakpoints.hold("slow");
    app.solver.breakpoints.hold("point 2");
    let paths = [app.submit(&scripted("slow")).await, app.submit(&sweep("all", 4)).await];
    for path in &paths {
        let job = app.ended(path).await;
        assert_eq!((job["state"].as_str(), job["error"]["code"].as_str()), (Some("failed"), Some("time-limit")));
    }
    assert_eq!(page(&app, &paths[1], "").await["n_solved"], 2);
}

#[tokio::test]
async fn numbers_that_are_not_finite_leave_as_null_with_a_reason() {
    let app = app().await;
    let (path, _) = app.run(&scripted("not finite")).await;
    let result = app.get(&format!("{path}/result")).await.json;
    assert!(result["numerics"]["wall_ms"]["mesh"].is_null());
    assert_eq!(result["numerics"]["not_finite"][0]["pointer"], "/numerics/wall_ms/mesh");
    let series = format!("{path}/series/a_x_left?method=none");
    let data = app.get(&series).await.json;
    assert_eq!((data["y"][1].is_null(), data["n_not_finite"].as_u64()), (true, Some(1)));
    let text = app.get_with(&series, &[("accept", "text/csv")]).await.text();
    assert_eq!(text.lines().nth(2).map(|line| line.ends_with(',')), Some(true));
    let (path, _) = app.run(&sweep("not finite", 2)).await;
    let item = &page(&app, &path, "").await["items"][0];
    assert!(item["point"]["dynamic_factor"].is_null());
    assert!(item["point"]["error"].as_str().is_some_and(|error| error.starts_with("/dynamic_factor")), "{item}");
}

#[tokio::test]
async fn columns_of_the_points_come_a_page_at_a_time() {
    let app = app().await;
    let (path, _) = app.run(&sweep("all", 7)).await;
    let read = async |query: &str| app.get(&format!("{path}/points/columns{query}")).await;
    let whole = read("").await.json;
    assert_eq!(whole["positions"], json!([0, 1, 2, 3, 4, 5, 6]));
    assert_eq!((whole["n_solved"].as_u64(), whole["n_points"].as_u64()), (Some(7), Some(7)));
    assert!(whole["next_position"].is_null() && whole["columns"]["regime"].is_array());
    // Each column agrees with the rows.
    let items = page(&app, &path, "").await["items"].clone();
    for (at, item) in items.as_array().unwrap().iter().enumerate() {
        assert_eq!(whole["columns"]["error"][at], item["point"]["error"]);
        assert_eq!(whole["columns"]["dynamic_factor"][at], item["point"]["dynamic_factor"]);
    }
    let some = read("?names=error,branch,error&from=2&to=6&limit=3").await.json;
    assert_eq!((&some["positions"], &some["next_position"]), (&json!([2, 3, 4]), &json!(5)));
    assert_eq!(some["columns"].as_object().unwrap().keys().collect::<Vec<_>>(), ["error", "branch"]);
    assert!(read("?from=5&to=5").await.json["positions"].as_array().unwrap().is_empty());
    for wrong in ["?names=nothing", "?limit=0", "?column=error", "?to=200001"] {
        read(wrong).await.assert_problem(400, "invalid-parameter");
    }
    let (other, _) = app.run(&document()).await;
    app.get(&format!("{other}/points/columns")).await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn the_document_of_a_point_is_a_response_at_its_values() {
    let app = app().await;
    let mut document = sweep("all", 3);
    document["axes"] = json!([
        {"pointer": "/operation/pinion_speed_rpm", "values": [1000.0, 2000.0, 3000.0]},
        {"pointer": "/design/backlash_um", "values": [10.0, 40.0]},
    ]);
    document["continuation"] = json!("both");
    document["record"] = json!(["spectrum"]);
    document["analysis"]["channels"] = json!(["a_x_left"]);
    let (path, _) = app.run(&document).await;
    let read = async |position: &str| app.get(&format!("{path}/points/{position}/input")).await;
    // The fifth of the second direction: second speed, second backlash.
    let point = read("10").await.json;
    assert_eq!((point["kind"].as_str(), point["name"].as_str()), (Some("response"), document["name"].as_str()));
    assert_eq!(point["operation"]["pinion_speed_rpm"], 2000.0);
    assert_eq!(point["design"]["backlash_um"], 40.0);
    assert_eq!(point["analysis"]["channels"], json!(["a_x_left"]));
    for gone in ["axes", "continuation", "record"] {
        assert!(point.get(gone).is_none(), "{gone}: {point}");
    }
    let job = app.get(&app.submit(&point).await).await;
    assert_eq!(job.json["kind"], "response");
    for nowhere in ["12", "-1", "first"] {
        read(nowhere).await.assert_problem(404, "not-found");
    }
    let (other, _) = app.run(&super::support::document()).await;
    app.get(&format!("{other}/points/0/input")).await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn the_result_of_a_sweep_can_be_read_without_its_rows() {
    let app = app().await;
    let (path, _) = app.run(&sweep("all", 5)).await;
    let whole = app.get(&format!("{path}/result")).await;
    let rest = app.get(&format!("{path}/result?rows=false")).await;
    let mut expected = whole.json.clone();
    expected["sweep"]["points"] = json!([]);
    assert_eq!(rest.json, expected);
    assert_ne!(whole.header("etag"), rest.header("etag"));
    assert_eq!(app.get(&format!("{path}/result?rows=true")).await.json, whole.json);
    app.get(&format!("{path}/result?rows=no")).await.assert_problem(400, "invalid-parameter");
    app.get(&format!("{path}/result?row=true")).await.assert_problem(400, "invalid-parameter");
}

/// A response of which only the head has come.
async fn begun(app: &App, path: &str) -> axum::body::Body {
    let request = axum::http::Request::get(path).header("host", "localhost").body(axum::body::Body::empty());
    let response = app.router.clone().oneshot(request.expect("a request")).await.expect("an answer");
    assert_eq!(response.status(), 200, "{path}");
    response.into_body()
}

#[tokio::test]
async fn a_download_breaks_off_when_its_sweep_is_deleted() {
    let app = app().await;
    for rows in ["points?decimal=point", "points?decimal=comma&limit=350", "points?limit=10000", "result"] {
        let (path, _) = app.run(&sweep("large", 400)).await;
        let whole = app.get(&format!("{path}/{rows}")).await;
        let mut body = begun(&app, &format!("{path}/{rows}")).await;
        let first = body.frame().await.expect("a piece").expect("unbroken").into_data().expect("data");
        assert!(first.len() < whole.body.len() / 2, "{rows}");
        app.delete(&path).await.assert_status(204);
        let mut received = first.len();
        let ended = loop {
            match body.frame().await {
                Some(Ok(frame)) => received += frame.data_ref().map_or(0, |data| data.len()),
                Some(Err(error)) => break Err(error),
                None => break Ok(()),
            }
        };
        assert!(ended.is_err(), "{rows}: {received} of {} bytes look whole", whole.body.len());
    }
}

#[tokio::test]
async fn a_limit_bounds_what_is_read() {
    let app = app().await;
    let (path, _) = app.run(&sweep("large", 400)).await;
    let body = begun(&app, &format!("{path}/points?decimal=point&from=3&limit=1")).await;
    app.delete(&path).await.assert_status(204);
    // The only row was read before.
    let text = body.collect().await.expect("a whole body").to_bytes();
    let text = String::from_utf8(text.to_vec()).expect("UTF-8");
    let positions: Vec<_> = text.lines().map(|line| line.split(',').next().unwrap_or_default()).collect();
    assert_eq!(positions, ["position", "3"]);
}

#[tokio::test]
async fn a_page_that_ends_where_a_piece_ends_is_whole() {
    let app = app().await;
    for n in [2, 15, 16, 17, 33] {
        let (path, _) = app.run(&sweep("large", n)).await;
        let n = n as usize;
        let whole = page(&app, &path, "").await;
        let positions = |page: &Value| -> Vec<u64> {
            page["items"].as_array().unwrap().iter().map(|item| item["position"].as_u64().unwrap()).collect()
        };
        assert_eq!(positions(&whole), (0..n as u64).collect::<Vec<_>>());
        assert!(whole["next_position"].is_null());
        let first = page(&app, &path, "?limit=1").await;
        assert_eq!((positions(&first), first["next_position"].as_u64()), (vec![0], Some(1)));
        assert!(positions(&page(&app, &path, "?from=200").await).is_empty());
        let result = app.get(&format!("{path}/result")).await.json;
        assert_eq!(result["sweep"]["points"].as_array().map(Vec::len), Some(n));
        let columns = app.get(&format!("{path}/points/columns")).await.json;
        assert_eq!(columns["positions"].as_array().map(Vec::len), Some(n));
        let text = app.get(&format!("{path}/points?decimal=point")).await.text();
        assert_eq!(text.lines().count(), n + 1);
    }
}

#[tokio::test]
async fn the_document_of_a_point_starts_where_the_sweep_started_it() {
    let app = app().await;
    let mut document = sweep("all", 6);
    document["continuation"] = json!("up");
    app.solver.breakpoints.hold("point 4");
    let path = app.submit(&document).await;
    app.solver.breakpoints.reached("point 4", 1).await;
    written(&app, &path, 4).await;
    let point = async |path: &str, position: u64| app.get(&format!("{path}/points/{position}/input")).await.json;
    let start = |point: &Value| point["analysis"]["initial_state"].clone();
    let id = path.rsplit('/').next().unwrap();
    // From rest, from the neighbour, and from a neighbour that is not solved yet.
    let [first, fourth, last] = [point(&path, 0).await, point(&path, 3).await, point(&path, 5).await];
    assert_eq!((start(&first), start(&fourth), start(&last)), (Value::Null, json!(vec![2.0; 24]), Value::Null));
    for (position, point, same_start) in [(0, &first, true), (3, &fourth, true), (5, &last, false)] {
        let origin = &point["sweep_point"];
        assert_eq!(
            (origin["job"].as_str(), origin["position"].as_u64(), origin["same_start"].as_bool()),
            (Some(id), Some(position), Some(same_start)),
            "{origin}"
        );
    }
    // A sweep that goes on with the points of a canceled one has their states, a copy of its result too.
    app.post(&format!("{path}/cancel")).await;
    app.ended(&path).await;
    app.solver.breakpoints.release("point 4");
    let (resumed, _) = app.run(&document).await;
    assert_eq!(app.solver.breakpoints.count("point 2"), 1);
    let (copy, job) = app.run(&document).await;
    assert!(job["reused_from"].is_string());
    app.delete(&path).await.assert_status(204);
    app.delete(&resumed).await.assert_status(204);
    for position in 1..6 {
        assert_eq!(start(&point(&copy, position).await), json!(vec![position as f64 - 1.0; 24]));
    }
    // It is a document to submit, with any method.
    for method in ["auto", "periodic", "integrate"] {
        let mut fourth = fourth.clone();
        fourth["analysis"]["method"] = json!(method);
        let sent = app.get(&app.submit(&fourth).await).await.json;
        assert_eq!(
            app.get(sent["links"]["input"].as_str().unwrap()).await.json["analysis"]["initial_state"],
            start(&fourth)
        );
    }
}
