//! Tables as CSV for spreadsheets whose language writes a decimal comma.

use crate::support::*;
use serde_json::Value;

/// The lines of CSV with decimal commas, read as a spreadsheet of such a language reads them: each field a number or a
/// text.
fn read(text: &str) -> Vec<Vec<Result<f64, String>>> {
    let text = text.strip_prefix('\u{feff}').expect("a byte order mark");
    let text = text.strip_suffix("\r\n").expect("lines end in CR LF");
    let field = |field: &str| match field.replace(',', ".").parse() {
        Ok(number) if !field.contains('.') => Ok(number),
        _ => Err(field.to_owned()),
    };
    text.split("\r\n").map(|line| line.split(';').map(field).collect()).collect()
}

#[tokio::test]
async fn f12_points_with_decimal_commas_have_the_numbers_of_the_json() {
    let app = app().await;
    let mut document = sweep("all", 4);
    document["axes"][0]["from"] = 1000.5.into();
    document["axes"][0]["to"] = 1001.25.into();
    let (path, _) = app.run(&document).await;
    let by_header = app.get_with(&format!("{path}/points"), &[("accept", "text/csv; decimal=comma")]).await;
    let by_query = app.get(&format!("{path}/points?decimal=comma")).await;
    assert_eq!(by_header.header("content-type"), "text/csv; charset=utf-8");
    assert_eq!(by_header.text(), by_query.text());
    let rows = read(&by_header.text());
    assert_eq!(rows[0][2], Err("/operation/pinion_speed_rpm".to_owned()));
    let items = app.get(&format!("{path}/points")).await.json["items"].clone();
    assert_eq!(rows.len(), 1 + 4);
    for (row, item) in rows[1..].iter().zip(items.as_array().unwrap()) {
        assert_eq!(row.len(), rows[0].len());
        assert_eq!(row[0], Ok(item["position"].as_f64().unwrap()));
        assert_eq!(row[2].clone().ok().map(f64::to_bits), item["point"]["values"][0].as_f64().map(f64::to_bits));
    }
    let second = app.get(&format!("{path}/points?decimal=comma&from=1&limit=1")).await;
    assert_eq!(read(&second.text())[1..], rows[2..3]);
}

#[tokio::test]
async fn f12_a_series_with_decimal_commas_has_the_numbers_of_the_json() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let path = format!("{path}/series/a_x_left?from=0.6&to=0.60101&method=none");
    let by_header = app.get_with(&path, &[("accept", "text/csv;decimal=comma")]).await;
    let by_query = app.get(&format!("{path}&decimal=comma")).await;
    assert_eq!(by_header.header("content-type"), "text/csv; charset=utf-8");
    assert_eq!(by_header.text(), by_query.text());
    let rows = read(&by_header.text());
    assert_eq!(rows[0], [Err("t_s".to_owned()), Err("value".to_owned())]);
    let data = app.get(&path).await.json;
    for (column, name) in ["t", "y"].into_iter().enumerate() {
        let numbers: Vec<_> = rows[1..].iter().map(|row| row[column].clone().unwrap()).collect();
        let expected: Vec<_> = data[name].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
        assert_eq!(numbers, expected);
    }
}

#[tokio::test]
async fn f12_the_decimal_point_stays_what_scripts_rely_on() {
    let app = app().await;
    let (sweep, _) = app.run(&sweep("all", 2)).await;
    let (single, _) = app.run(&document()).await;
    for path in [format!("{sweep}/points"), format!("{single}/series/a_x_left")] {
        let plain = app.get_with(&path, &[("accept", "text/csv")]).await.text();
        assert!(!plain.contains([';', '\r', '\u{feff}']), "{plain:.80}");
        assert_eq!(app.get(&format!("{path}?decimal=point")).await.text(), plain);
        let named = app.get_with(&path, &[("accept", "text/csv; decimal=point")]).await.text();
        assert_eq!(named, plain);
    }
}

#[tokio::test]
async fn f12_what_is_no_decimal_sign_is_refused() {
    let app = app().await;
    let (sweep, _) = app.run(&sweep("all", 2)).await;
    let (single, _) = app.run(&document()).await;
    for path in [format!("{sweep}/points"), format!("{single}/series/a_x_left")] {
        let answer = app.get(&format!("{path}?decimal=period")).await;
        answer.assert_problem(400, "invalid-parameter");
        assert_eq!(answer.violation("/decimal")["code"], "not-one-of");
        let other = [("accept", "application/json")];
        app.get_with(&format!("{path}?decimal=comma"), &other).await.assert_problem(406, "not-acceptable");
        let other = [("accept", "text/csv; decimal=period")];
        app.get_with(&path, &other).await.assert_problem(406, "not-acceptable");
    }
}
