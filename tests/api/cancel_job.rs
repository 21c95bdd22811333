use crate::support::*;

#[tokio::test]
async fn a_waiting_job_is_canceled_at_once_and_never_runs() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    app.submit(&document()).await;
    app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 2).await;
    let path = app.submit(&scripted("waiting")).await;
    let first = app.post(&format!("{path}/cancel")).await;
    assert_eq!((first.status, first.json["state"].as_str()), (200, Some("canceled")));
    let second = app.post(&format!("{path}/cancel")).await;
    assert_eq!((second.status, &second.json), (200, &first.json));
    app.solver.breakpoints.release("solve");
    app.run(&document()).await;
    assert_eq!(app.solver.breakpoints.count("waiting"), 0);
}

#[tokio::test]
async fn a_running_job_is_asked_and_stops() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let asked = app.post(&format!("{path}/cancel")).await;
    assert_eq!(asked.status, 202);
    assert!(asked.json["cancel_requested_at"].is_string());
    let job = app.ended(&path).await;
    assert_eq!((job["state"].as_str(), job["error"].is_null()), (Some("canceled"), true));
    assert_eq!(app.post(&format!("{path}/cancel")).await.status, 200);
    app.get(&format!("{path}/result")).await.assert_problem(409, "job-not-succeeded");
}

/// The calculation was past its last checkpoint; its result is not yet written.
#[tokio::test]
async fn a_cancel_that_was_accepted_is_never_followed_by_a_result() {
    let app = app().await;
    app.solver.breakpoints.hold("at its end");
    let path = app.submit(&scripted("at its end")).await;
    app.solver.breakpoints.reached("at its end", 1).await;
    assert_eq!(app.post(&format!("{path}/cancel")).await.status, 202);
    app.solver.breakpoints.release("at its end");
    assert_eq!(app.ended(&path).await["state"], "canceled");
    app.get(&format!("{path}/series")).await.assert_problem(409, "job-not-succeeded");
}

#[tokio::test]
async fn an_ended_job_stays_as_it_is() {
    let app = app().await;
    let (path, job) = app.run(&document()).await;
    let answer = app.post(&format!("{path}/cancel")).await;
    assert_eq!((answer.status, answer.json), (200, job));
}
