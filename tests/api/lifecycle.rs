use crate::support::*;
use serde_json::Value;

#[tokio::test]
async fn queued_running_succeeded() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let running = app.get(&path).await;
    assert_eq!((running.json["state"].as_str(), running.json["attempt"].as_i64()), (Some("running"), Some(1)));
    assert_eq!(running.header("retry-after"), "1");
    app.solver.breakpoints.release("solve");
    let done = app.ended(&path).await;
    assert_eq!((done["state"].as_str(), done["progress"].as_f64()), (Some("succeeded"), Some(1.0)));
    for time in ["submitted_at", "started_at", "ended_at"] {
        let text = done[time].as_str().unwrap_or_default();
        assert!(text.parse::<jiff::Timestamp>().is_ok() && text.ends_with('Z'), "{time} is {text}");
    }
}

#[tokio::test]
async fn a_failed_job_says_why_with_numbers() {
    let app = app().await;
    let (path, job) = app.run(&scripted("fail")).await;
    assert_eq!(job["state"], "failed");
    let error = &job["error"];
    assert_eq!((error["code"].as_str(), error["type"].as_str()), (Some("diverged"), Some("/problems/diverged")));
    assert_eq!((error["sim_time_s"].as_f64(), error["step"].as_u64()), (Some(0.125), Some(42)));
    assert_eq!(error["stage"], "response");
    assert!(error["request_id"].as_str().is_some_and(|id| !id.is_empty()));
    app.get(&format!("{path}/result")).await.assert_problem(409, "job-not-succeeded");
}

#[tokio::test]
async fn a_cause_outside_the_closed_list_keeps_its_name_within() {
    let app = app().await;
    let (_, job) = app.run(&scripted("fail oddly")).await;
    assert_eq!(job["error"]["code"], "solve-failed");
    assert_eq!(job["error"]["errors"][0]["code"], "singular-matrix");
}

#[tokio::test]
async fn a_panic_fails_its_own_job_only() {
    let app = app().await;
    app.solver.breakpoints.hold("neighbour");
    let neighbour = app.submit(&scripted("neighbour")).await;
    app.solver.breakpoints.reached("neighbour", 1).await;
    let (_, job) = app.run(&scripted("panic")).await;
    assert_eq!((job["state"].as_str(), job["error"]["code"].as_str()), (Some("failed"), Some("internal")));
    assert!(!job.to_string().contains("secret"), "{job}");
    app.solver.breakpoints.release("neighbour");
    assert_eq!(app.ended(&neighbour).await["state"], "succeeded");
    let (_, after) = app.run(&document()).await;
    assert_eq!(after["state"], "succeeded");
}

#[tokio::test]
async fn every_worker_works_and_each_job_runs_once() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let mut paths = Vec::new();
    for _ in 0..8 {
        paths.push(app.submit(&document()).await);
    }
    app.solver.breakpoints.reached("solve", 2).await;
    let system = app.get("/api/v1/system").await.json;
    assert_eq!(system["workers"], serde_json::json!({"total": 2, "busy": 2, "sweeps_total": 2, "sweeps_busy": 0}));
    assert_eq!(system["queue"]["depth"], 6);
    app.solver.breakpoints.release("solve");
    for path in &paths {
        assert_eq!(app.ended(path).await["state"], "succeeded");
    }
    assert_eq!(app.solver.breakpoints.count("solve"), 8);
}

#[tokio::test]
async fn progress_is_stored() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    let mut events = app.events(&path, &[]).await;
    loop {
        let event = events.next().await.expect("progress comes");
        if event.name == "progress" {
            assert_eq!((event.data["progress"].as_f64(), event.data["stage"].as_str()), (Some(0.25), Some("mesh")));
            break;
        }
    }
    let job: Value = app.get(&path).await.json;
    assert_eq!(job["progress"], 0.25);
    app.solver.breakpoints.release("solve");
}
