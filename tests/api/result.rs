use crate::support::*;

#[tokio::test]
async fn a_result_has_a_strong_entity_tag_and_every_name() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let answer = app.get(&format!("{path}/result")).await;
    assert_eq!(answer.status, 200);
    for name in ["geometry", "mesh", "impact", "response", "numerics", "warnings"] {
        assert!(answer.json.get(name).is_some(), "{name} is missing");
    }
    let etag = answer.header("etag").to_owned();
    assert!(etag.starts_with('"') && etag.len() == 34, "{etag}");
    let again = app.get_with(&format!("{path}/result"), &[("if-none-match", &etag)]).await;
    assert_eq!((again.status, again.body.len()), (304, 0));
}

#[tokio::test]
async fn a_live_job_has_none_yet() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    for what in ["result", "series", "series/a_x_left"] {
        let answer = app.get(&format!("{path}/{what}")).await;
        answer.assert_problem(409, "result-not-ready");
        assert_eq!(answer.header("retry-after"), "1");
    }
    app.solver.breakpoints.release("solve");
}
