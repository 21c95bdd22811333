use crate::support::*;
use serde_json::json;

#[tokio::test]
async fn the_catalogue() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let catalogue = app.get(&format!("{path}/series")).await.json;
    let lowest = (0..10_000).map(|index| (f64::from(index) * 0.01).sin()).fold(f64::INFINITY, f64::min);
    let expected = json!({"items": [{
        "name": "a_x_left", "quantity": "acceleration", "unit": "m/s2", "n": 10_000, "t0": 0.5,
        "t_end": 0.5 + 9_999.0 * 1e-4, "dt": 1e-4, "min": lowest, "max": 50.0, "rms": 0.75,
    }]});
    assert_eq!(catalogue, expected);
}

#[tokio::test]
async fn few_points_keep_the_spike() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let read = async |query: &str| app.get(&format!("{path}/series/a_x_left{query}")).await.json;
    for (query, method, most) in
        [("", "minmax", 2000), ("?max_points=100", "minmax", 100), ("?method=lttb&max_points=101", "lttb", 101)]
    {
        let data = read(query).await;
        assert_eq!((data["method"].as_str(), data["n_source"].as_u64()), (Some(method), Some(10_000)), "{query}");
        let y = data["y"].as_array().unwrap();
        assert!(y.len() <= most && y.len() * 2 > most, "{query} gave {}", y.len());
        assert_eq!(data["n_returned"], y.len());
        assert_eq!(data["t"].as_array().unwrap().len(), y.len());
        assert!(y.contains(&json!(50.0)), "{query} lost the spike");
    }
}

#[tokio::test]
async fn a_window_in_full() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let data = app.get(&format!("{path}/series/a_x_left?from=0.6&to=0.60101&method=none")).await.json;
    assert_eq!((data["n_source"].as_u64(), data["method"].as_str()), (Some(11), Some("none")));
    assert_eq!(data["y"][0], (1000.0f64 * 0.01).sin());
    let all = app.get(&format!("{path}/series/a_x_left?method=none")).await.json;
    assert_eq!(all["n_returned"], 10_000);
    let nothing = app.get(&format!("{path}/series/a_x_left?from=100")).await.json;
    assert_eq!((nothing["n_source"].as_u64(), &nothing["t"]), (Some(0), &json!([])));
}

#[tokio::test]
async fn csv_reads_back_exactly() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let path = format!("{path}/series/a_x_left?from=0.6&to=0.60101&method=none");
    let answer = app.get_with(&path, &[("accept", "text/csv")]).await;
    assert_eq!(answer.header("content-type"), "text/csv; charset=utf-8");
    assert_eq!(answer.header("vary"), "accept");
    let text = answer.text();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("t_s,value"));
    let rows: Vec<(f64, f64)> = lines
        .map(|line| line.split_once(',').unwrap())
        .map(|(t, y)| (t.parse().unwrap(), y.parse().unwrap()))
        .collect();
    assert_eq!(rows.len(), 11);
    assert_eq!(rows[3].1, (1003.0f64 * 0.01).sin());
}

#[tokio::test]
async fn refusals() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    app.get(&format!("{path}/series/nothing")).await.assert_problem(404, "not-found");
    for (query, pointer) in [
        ("max_points=3", "/max_points"),
        ("max_points=100001", "/max_points"),
        ("max_points=many", "/max_points"),
        ("method=mean", "/method"),
        ("from=NaN", "/from"),
        ("to=inf", "/to"),
        ("from=2&to=1", "/to"),
        ("method=none&max_points=10", "/max_points"),
        ("points=10", "/points"),
    ] {
        let answer = app.get(&format!("{path}/series/a_x_left?{query}")).await;
        answer.assert_problem(400, "invalid-parameter");
        answer.violation(pointer);
    }
    let png = app.get_with(&format!("{path}/series/a_x_left"), &[("accept", "image/png")]).await;
    png.assert_problem(406, "not-acceptable");
}
