use crate::support::*;
use serde_json::json;

fn ids(answer: &Answer) -> Vec<String> {
    answer.json["items"].as_array().unwrap().iter().map(|job| job["id"].as_str().unwrap().to_owned()).collect()
}

#[tokio::test]
async fn pages_newest_first() {
    let app = app().await;
    let mut all = Vec::new();
    for _ in 0..5 {
        all.push(app.run(&document()).await.1["id"].as_str().unwrap().to_owned());
    }
    all.reverse();
    let first = app.get("/api/v1/jobs?limit=2").await;
    assert_eq!(ids(&first), all[..2]);
    // A job submitted meanwhile shifts nothing.
    app.run(&document()).await;
    let cursor = first.json["next_cursor"].as_str().unwrap();
    let second = app.get(&format!("/api/v1/jobs?limit=3&cursor={cursor}")).await;
    assert_eq!(ids(&second), all[2..]);
    assert!(second.json["next_cursor"].is_null());
}

#[tokio::test]
async fn filters_combine() {
    let app = app().await;
    let mut labeled = scripted("fail");
    labeled["label"] = json!("batch 7");
    app.run(&labeled).await;
    let mut mesh = document();
    mesh["kind"] = json!("mesh");
    app.run(&mesh).await;
    let count = async |query: &str| ids(&app.get(&format!("/api/v1/jobs?{query}")).await).len();
    assert_eq!(count("").await, 2);
    assert_eq!(count("state=failed").await, 1);
    assert_eq!(count("state=failed,succeeded").await, 2);
    assert_eq!(count("state=canceled").await, 0);
    assert_eq!(count("kind=mesh&state=succeeded").await, 1);
    assert_eq!(count("label=batch%207").await, 1);
    assert_eq!(count("label=batch").await, 0);
    assert_eq!(count("limit=100000").await, 2);
}

#[tokio::test]
async fn what_is_not_a_parameter_is_refused_all_at_once() {
    let app = app().await;
    let answer = app.get("/api/v1/jobs?state=done&kind=x&limit=-1&page=2&label=a&label=b").await;
    answer.assert_problem(400, "invalid-parameter");
    assert_eq!(answer.json["errors"].as_array().unwrap().len(), 5);
    assert_eq!(answer.violation("/state")["code"], "not-one-of");
    assert_eq!(answer.violation("/limit")["maximum"], 200.0);
    assert_eq!(answer.violation("/page")["code"], "unknown-field");
    assert_eq!(answer.violation("/label")["code"], "conflict");
}

#[tokio::test]
async fn a_cursor_is_bound_to_its_filters() {
    let app = app().await;
    for _ in 0..3 {
        app.run(&document()).await;
    }
    let first = app.get("/api/v1/jobs?limit=1&state=succeeded").await;
    let cursor = first.json["next_cursor"].as_str().unwrap();
    let same = app.get(&format!("/api/v1/jobs?state=succeeded&limit=2&cursor={cursor}")).await;
    assert_eq!(same.json["items"].as_array().unwrap().len(), 2);
    for query in [
        format!("cursor={cursor}"),
        format!("state=failed&cursor={cursor}"),
        format!("state=succeeded&cursor={cursor}0"),
        format!("state=succeeded&cursor=01{}", &cursor[2..]),
        format!("state=succeeded&order=asc&cursor={cursor}"),
        format!("state=succeeded&sort=name&cursor={cursor}"),
        format!("state=succeeded&search=a&cursor={cursor}"),
        format!("state=succeeded&from=2026-01-01&cursor={cursor}"),
        "state=succeeded&cursor=%F0%9F%92%A9".to_owned(),
    ] {
        app.get(&format!("/api/v1/jobs?{query}")).await.assert_problem(400, "invalid-cursor");
    }
}

#[tokio::test]
async fn a_list_of_many_is_searched_sorted_and_counted() {
    let app = app().await;
    for name in ["Ritzel Öl", "gear b", "Gear A"] {
        app.run(&scripted(name)).await;
    }
    let read = async |query: &str| {
        let page = app.get(&format!("/api/v1/jobs?{query}")).await;
        assert_eq!(page.status, 200, "{page:?}");
        let names: Vec<_> =
            page.json["items"].as_array().unwrap().iter().map(|job| job["name"].as_str().unwrap().to_owned()).collect();
        (names, page.json["total"].as_u64().unwrap(), page.json["next_cursor"].as_str().map(str::to_owned))
    };
    let names = async |query: &str| read(query).await.0;
    assert_eq!(names("").await, ["Gear A", "gear b", "Ritzel Öl"]);
    assert_eq!(names("order=asc").await, ["Ritzel Öl", "gear b", "Gear A"]);
    assert_eq!(names("sort=name").await, ["Gear A", "gear b", "Ritzel Öl"]);
    assert_eq!(names("sort=name&order=desc").await, ["Ritzel Öl", "gear b", "Gear A"]);
    assert_eq!(names("sort=ended&order=asc").await, ["Ritzel Öl", "gear b", "Gear A"]);
    assert_eq!(names("search=GEAR&sort=name").await, ["Gear A", "gear b"]);
    assert_eq!(names("search=%C3%B6l").await, ["Ritzel Öl"]);
    assert_eq!(read("search=gear&limit=1").await.1, 2, "all that fit, not those of the page");
    assert_eq!(names("from=2020-01-01&to=2020-01-02T00:00:00Z").await, Vec::<String>::new());
    assert_eq!(names("from=2020-01-01").await.len(), 3);
    let (first, total, cursor) = read("sort=name&search=gear&limit=1").await;
    let (second, rest, end) = read(&format!("sort=name&search=gear&limit=1&cursor={}", cursor.unwrap())).await;
    assert_eq!((first, second, total, rest, end), (vec!["Gear A".into()], vec!["gear b".into()], 2, 2, None));
    let long = "a".repeat(201);
    for wrong in ["sort=best", "order=up", "from=yesterday", "from=", "to=2026-13-01", &format!("search={long}")] {
        app.get(&format!("/api/v1/jobs?{wrong}")).await.assert_problem(400, "invalid-parameter");
    }
}

#[tokio::test]
async fn an_ended_job_tells_the_numbers_of_its_result() {
    let app = app().await;
    app.run(&scripted("numbers")).await;
    app.run(&scripted("fail")).await;
    let page = app.get("/api/v1/jobs?sort=mesh_circumferential_acceleration_rms").await.json;
    let expected = json!({
        "mesh_circumferential_acceleration_rms_m_s2": 52.5, "dynamic_factor": 1.25, "transmission_error_pp_um": 0.75,
    });
    assert_eq!((&page["items"][0]["headline"], &page["items"][1]["headline"]), (&expected, &json!(null)));
    let (path, again) =
        app.run(&app.get(&format!("{}/input", page["items"][0]["links"]["self"].as_str().unwrap())).await.json).await;
    assert_eq!((&again["headline"], again["reused_from"].is_null()), (&expected, false), "{path}");
}
