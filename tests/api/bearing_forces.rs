//! The forces that the bearings transmit, as CSV.

use crate::support::*;
use serde_json::json;

const HEADER: &str = "shaft,bearing,position_mm,axis,mesh_order,frequency_hz,amplitude_n,phase_rad";

#[tokio::test]
async fn a_row_for_every_bearing_axis_and_order() {
    let app = app().await;
    let (path, _) = app.run(&scripted("bearings")).await;
    let answer = app.get(&format!("{path}/bearing-forces")).await;
    assert_eq!(answer.header("content-type"), "text/csv; charset=utf-8");
    assert_eq!(answer.header("vary"), "accept");
    let text = answer.text();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], HEADER);
    // Three bearings; mean and two orders along x and y, the mean alone along z.
    assert_eq!(lines.len(), 1 + 3 * (3 + 3 + 1));
    assert_eq!(
        lines[4..7],
        [
            "pinion,1,120.5,y,0,0.0,-7000.5,0.0",
            "pinion,1,120.5,y,1,425.0,2.5,0.25",
            "pinion,1,120.5,y,2,850.0,0.5,-3.0",
        ]
    );
    assert!(lines.contains(&"gear,1,120.5,x,1,425.0,2.5,0.25"), "{text}");
    // The numbers are those of the result.
    let result = app.get(&format!("{path}/result")).await.json;
    assert_eq!(result["response"]["bearings"][0]["force_n"]["y"]["mean"], json!(-7000.5));
    // A browser's link asks for anything.
    let asked = app.get_with(&format!("{path}/bearing-forces"), &[("accept", "text/html,*/*;q=0.8")]).await;
    assert_eq!(asked.text(), text);
    let comma = app.get(&format!("{path}/bearing-forces?decimal=comma")).await.text();
    let named = app.get_with(&format!("{path}/bearing-forces"), &[("accept", "text/csv; decimal=comma")]).await.text();
    assert_eq!(comma, named);
    assert!(comma.contains("pinion;1;120,5;y;2;850,0;0,5;-3,0\r\n"), "{comma}");
}

#[tokio::test]
async fn jobs_without_bearings_have_none() {
    let app = app().await;
    let (plain, _) = app.run(&document()).await;
    let (bearings, _) = app.run(&scripted("bearings")).await;
    let (sweep, _) = app.run(&sweep("all", 2)).await;
    let (failed, _) = app.run(&scripted("fail")).await;
    for (path, accept, status, code) in [
        (&plain, "*/*", 404, "not-found"),
        (&sweep, "*/*", 404, "not-found"),
        (&failed, "*/*", 409, "job-not-succeeded"),
        (&bearings, "application/json", 406, "not-acceptable"),
    ] {
        let answer = app.get_with(&format!("{path}/bearing-forces"), &[("accept", accept)]).await;
        assert_eq!((answer.status, &answer.json["code"]), (status, &json!(code)), "{path}");
    }
    let refused = app.get(&format!("{bearings}/bearing-forces?decimal=period")).await;
    assert_eq!((refused.status, &refused.json["code"]), (400, &json!("invalid-parameter")));
    let unknown = app.get("/api/v1/jobs/00000000-0000-7000-8000-000000000000/bearing-forces").await;
    assert_eq!(unknown.status, 404);
}
