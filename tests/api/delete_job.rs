use crate::support::*;

#[tokio::test]
async fn an_ended_job_is_deleted_with_all_it_left() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let answer = app.delete(&path).await;
    assert_eq!((answer.status, answer.body.len()), (204, 0));
    for rest in ["", "/input", "/result", "/series", "/series/a_x_left", "/events"] {
        app.get(&format!("{path}{rest}")).await.assert_problem(404, "not-found");
    }
    app.delete(&path).await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn a_live_job_is_not_deleted() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.delete(&path).await.assert_problem(409, "job-not-ended");
    app.solver.breakpoints.reached("solve", 1).await;
    app.delete(&path).await.assert_problem(409, "job-not-ended");
    app.solver.breakpoints.release("solve");
}
