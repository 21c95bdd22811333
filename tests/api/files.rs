//! Series, points and results as files for other programs: the numbers are those of the JSON, to the bit.

use crate::support::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{Cursor, Read};

const XLSX: &str = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet";

/// The members of an archive.
fn members(bytes: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
    let n = archive.len();
    let read = |at: usize| {
        let mut member = archive.by_index(at).expect("a member");
        let mut bytes = Vec::new();
        member.read_to_end(&mut bytes).expect("its bytes");
        (member.name().expect("a name").into_owned(), bytes)
    };
    (0..n).map(read).collect()
}

/// The numbers of the `.npy` of an archive.
fn numbers(members: &BTreeMap<String, Vec<u8>>, name: &str) -> Vec<u64> {
    let bytes = members.get(&format!("{name}.npy")).unwrap_or_else(|| panic!("no {name}: {:?}", members.keys()));
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = String::from_utf8_lossy(&bytes[10..start]);
    assert!(header.contains("'<f8'"), "{header}");
    bytes[start..].chunks(8).map(|chunk| u64::from_le_bytes(chunk.try_into().expect("eight bytes"))).collect()
}

fn bits(values: &Value) -> Vec<u64> {
    values.as_array().expect("a list").iter().map(|value| value.as_f64().unwrap_or(f64::NAN).to_bits()).collect()
}

#[tokio::test]
async fn a_series_as_arrays_has_the_numbers_of_the_json_over_all_its_parts() {
    let app = app().await;
    let (path, _) = app.run(&scripted("large")).await;
    let json = app.get(&format!("{path}/series/a_x_left?method=none")).await.json;
    let npz = app.get(&format!("{path}/series?channels=a_x_left&format=npz")).await;
    assert_eq!((npz.status, npz.header("content-type")), (200, "application/x-npz"));
    assert!(npz.header("content-disposition").ends_with("-series.npz\""));
    let arrays = members(&npz.body);
    assert!(numbers(&arrays, "a_x_left") == bits(&json["y"]));
    assert!(numbers(&arrays, "t_s") == bits(&json["t"]));
    assert_eq!(numbers(&arrays, "dt_s"), [1e-4_f64.to_bits()]);
    let window = app.get(&format!("{path}/series/a_x_left?method=none&from=30&to=60")).await.json;
    let part = app.get(&format!("{path}/series?from=30&to=60&format=npz")).await;
    let arrays = members(&part.body);
    assert_eq!(window["y"].as_array().map(Vec::len), Some(300_001));
    assert!(numbers(&arrays, "a_x_left") == bits(&window["y"]) && numbers(&arrays, "t_s") == bits(&window["t"]));
    let mat = app.get_with(&format!("{path}/series?to=0.6"), &[("accept", "application/x-matlab-data")]).await;
    assert_eq!((mat.status, mat.header("vary")), (200, "accept"));
    let values = bits(&app.get(&format!("{path}/series/a_x_left?method=none&to=0.6")).await.json["y"]);
    let values: Vec<u8> = values.iter().flat_map(|bits| bits.to_le_bytes()).collect();
    assert!(mat.body.starts_with(b"MATLAB 5.0") && mat.body.windows(values.len()).any(|part| *part == values));
}

#[tokio::test]
async fn the_list_of_series_is_as_before_and_can_be_limited_to_names() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let all = app.get(&format!("{path}/series")).await;
    assert_eq!(app.get(&format!("{path}/series?channels=a_x_left")).await.json, all.json);
    app.get(&format!("{path}/series?channels=a_x_left,nothing")).await.assert_problem(404, "not-found");
    let csv = app.get_with(&format!("{path}/series"), &[("accept", "text/csv")]).await;
    csv.assert_problem(406, "not-acceptable");
    let wrong = app.get(&format!("{path}/series?format=hdf5")).await;
    wrong.assert_problem(400, "invalid-parameter");
    wrong.violation("/format");
    let nothing = app.get(&format!("{path}/series?format=npz&from=100")).await;
    assert_eq!(numbers(&members(&nothing.body), "t_s"), [0_u64; 0]);
}

#[tokio::test]
async fn points_as_workbook_and_arrays_have_the_numbers_of_the_json() {
    let app = app().await;
    let mut document = sweep("all", 4);
    document["axes"][0]["from"] = 1000.1.into();
    let (path, _) = app.run(&document).await;
    let items = app.get(&format!("{path}/points")).await.json["items"].clone();
    let speeds: Vec<u64> =
        items.as_array().unwrap().iter().map(|item| item["point"]["values"][0].as_f64().unwrap().to_bits()).collect();
    let npz = app.get_with(&format!("{path}/points"), &[("accept", "application/x-npz")]).await;
    let arrays = members(&npz.body);
    assert_eq!(numbers(&arrays, "operation_pinion_speed_rpm"), speeds);
    assert_eq!(numbers(&arrays, "position"), [0.0_f64, 1.0, 2.0, 3.0].map(f64::to_bits));
    assert!(numbers(&arrays, "dynamic_factor").iter().all(|bits| f64::from_bits(*bits).is_nan()));
    let mat = app.get(&format!("{path}/points?format=mat")).await;
    assert!(mat.body.starts_with(b"MATLAB 5.0"));
    let xlsx = app.get(&format!("{path}/points?format=xlsx")).await;
    assert_eq!((xlsx.status, xlsx.header("content-type")), (200, XLSX));
    let sheets = members(&xlsx.body);
    let sheet = String::from_utf8_lossy(&sheets["xl/worksheets/sheet1.xml"]).into_owned();
    for (at, speed) in speeds.iter().enumerate() {
        let cell = format!("<c r=\"C{}\"><v>", at + 2);
        let start = sheet.find(&cell).expect("a cell") + cell.len();
        let text = &sheet[start..start + sheet[start..].find('<').expect("its end")];
        assert_eq!(text.parse::<f64>().expect("a number").to_bits(), *speed);
    }
    let input = String::from_utf8_lossy(&sheets["xl/worksheets/sheet2.xml"]).into_owned();
    assert!(input.contains("/design/pinion/teeth"));
    let csv = app.get_with(&format!("{path}/points"), &[("accept", "text/csv")]).await;
    assert_eq!(app.get(&format!("{path}/points?format=csv")).await.text(), csv.text());
    let two = app.get(&format!("{path}/points?format=npz&from=1&limit=2")).await;
    assert_eq!(numbers(&members(&two.body), "operation_pinion_speed_rpm"), speeds[1..3]);
    let conflict = app.get(&format!("{path}/points?format=npz&decimal=comma")).await;
    conflict.assert_problem(400, "invalid-parameter");
    conflict.violation("/decimal");
}

#[tokio::test]
async fn a_result_as_workbook_has_its_own_tag() {
    let app = app().await;
    let (path, _) = app.run(&scripted("numbers")).await;
    let json = app.get(&format!("{path}/result")).await;
    let xlsx = app.get_with(&format!("{path}/result"), &[("accept", XLSX)]).await;
    assert_eq!((xlsx.status, xlsx.header("content-type"), xlsx.header("vary")), (200, XLSX, "accept"));
    let etag = xlsx.header("etag");
    assert!(!etag.is_empty() && etag != json.header("etag"));
    let again = app.get_with(&format!("{path}/result?format=xlsx"), &[("if-none-match", etag)]).await;
    assert_eq!(again.status, 304);
    let sheet = String::from_utf8_lossy(&members(&xlsx.body)["xl/worksheets/sheet1.xml"]).into_owned();
    assert!(sheet.contains("<v>50.25</v>") && sheet.contains("<v>52.5</v>"));
    app.get_with(&format!("{path}/result"), &[("accept", "image/png")]).await.assert_problem(406, "not-acceptable");
}

#[tokio::test]
async fn an_acceleration_is_heard_for_as_long_as_asked() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let sound = app.get(&format!("{path}/series/a_x_left.wav?seconds=0.5&rate_hz=8000")).await;
    assert_eq!((sound.status, sound.header("content-type")), (200, "audio/wav"));
    assert_eq!(&sound.body[8..12], b"WAVE");
    let start = sound.body.windows(4).position(|name| name == b"data").expect("samples") + 8;
    let samples: Vec<i16> = sound.body[start..].chunks(2).map(|pair| i16::from_le_bytes([pair[0], pair[1]])).collect();
    assert_eq!(samples.len(), 4000);
    assert!(samples.iter().any(|sample| sample.unsigned_abs() > 100));
    app.get(&format!("{path}/series/s_left.wav")).await.assert_problem(404, "not-found");
    for (query, pointer) in
        [("seconds=31", "/seconds"), ("rate_hz=44", "/rate_hz"), ("full_scale=0", "/full_scale"), ("x=1", "/x")]
    {
        let answer = app.get(&format!("{path}/series/a_x_left.wav?{query}")).await;
        answer.assert_problem(400, "invalid-parameter");
        answer.violation(pointer);
    }
    let json = app.get_with(&format!("{path}/series/a_x_left.wav"), &[("accept", "application/json")]).await;
    json.assert_problem(406, "not-acceptable");
}

#[tokio::test]
async fn a_job_without_a_curve_has_no_tables() {
    let app = app().await;
    let (path, _) = app.run(&scripted("numbers")).await;
    app.get(&format!("{path}/tables?format=modelica")).await.assert_problem(404, "not-found");
    app.get(&format!("{path}/tables?format=ascii")).await.violation("/format");
}

/// A sweep keeps no curves: its tables are calculated, those of each torque as a job of its own has them.
#[tokio::test]
async fn a_sweep_over_the_torque_has_tables_over_angle_and_torque() {
    let app = app().await;
    let mut over_torque = document();
    over_torque["kind"] = json!("sweep");
    over_torque["model"] = json!({"mesh_stiffness": {"source": "ltca", "positions": 32}, "impact": {"source": "none"}});
    over_torque["axes"] = json!([{"pointer": "/operation/pinion_torque_nm", "values": [900.0, 300.0, 600.0]}]);
    let (path, _) = app.run(&over_torque).await;
    let json = app.get(&format!("{path}/tables")).await;
    assert_eq!(json.status, 200, "{json:?}");
    assert_eq!(json.json["pinion_torque_nm"], json!([300.0, 600.0, 900.0]));
    let stiffness = &json.json["grids"][0];
    let (rows, angles) = (stiffness["values"].as_array().unwrap(), stiffness["pinion_angle_rad"].as_array().unwrap());
    assert_eq!((stiffness["name"].as_str(), rows.len(), rows[0].as_array().unwrap().len()), (Some("stiffness"), 33, 3));
    assert!((angles[32].as_f64().unwrap() - std::f64::consts::TAU / 17.0).abs() < 1e-12);
    let value = |row: usize, torque: usize| rows[row][torque].as_f64().unwrap();
    assert!(value(0, 0) < value(0, 2), "a loaded mesh is stiffer where more teeth touch");
    assert_eq!(rows[0], rows[32]);
    let modelica = app.get(&format!("{path}/tables?format=modelica")).await;
    assert!(modelica.text().contains("\ndouble stiffness(34,4)\n0.0 300.0 600.0 900.0\n"), "{}", modelica.text());
    let amesim = app.get(&format!("{path}/tables?format=amesim&quantity=transmission_error")).await;
    assert!(amesim.text().contains("transmission_error [m]\n33 3\n"), "{}", amesim.text());
    for none in ["format=simpack", "format=amesim&quantity=impact_force"] {
        app.get(&format!("{path}/tables?{none}")).await.assert_problem(404, "not-found");
    }
    let (path, _) = app.run(&sweep("numbers", 3)).await;
    let refused = app.get(&format!("{path}/tables")).await;
    refused.assert_problem(404, "not-found");
    assert!(refused.text().contains("/operation/pinion_torque_nm"), "{refused:?}");
}
