//! Numbers as people type them, files as programs save them, tables as spreadsheets of other languages read them.

use crate::browser::{Browser, flow};
use crate::job::{saved_by, succeeded};
use serde_json::{Value, json};

async fn document(browser: &Browser) -> Value {
    let text = browser.value("document.querySelector('#document-text').textContent").await;
    serde_json::from_str(text.as_str().unwrap()).unwrap()
}

/// A list of numbers; none when it is something else.
fn numbers(list: &Value) -> Option<Vec<f64>> {
    list.as_array()?.iter().map(Value::as_f64).collect()
}

/// Calls a function of a module of the pages for each of the arguments.
async fn called(browser: &Browser, module: &str, function: &str, arguments: &Value) -> Value {
    let script = "const [module, name, calls, done] = arguments; \
                  import(module).then((all) => done(calls.map((call) => all[name](...call))), (error) => done(String(error)));";
    let arguments = vec![json!(module), json!(function), arguments.clone()];
    browser.driver.execute_async(script, arguments).await.unwrap().json().clone()
}

/// What is typed, the unit of the field, and the value; null where it is refused with a word on the decimal point.
const NUMBERS: &[(&str, &str, Option<f64>)] = &[
    ("100.5", "", Some(100.5)),
    ("100,5", "", Some(100.5)),
    ("0,125", "", Some(0.125)),
    ("1234,567", "", Some(1234.567)),
    (",5", "", Some(0.5)),
    ("\u{2212}5", "", Some(-5.0)),
    ("1 000", "", Some(1000.0)),
    ("1\u{2009}000,5", "", Some(1000.5)),
    ("1\u{202f}234\u{202f}567", "", Some(1_234_567.0)),
    ("1'000.25", "", Some(1000.25)),
    ("1,5e-3", "", Some(1.5e-3)),
    ("1.5·10⁻⁶", "", Some(1.5e-6)),
    ("217.8 mm", "mm", Some(217.8)),
    ("217,8mm", "mm", Some(217.8)),
    ("20°", "°", Some(20.0)),
    ("30°15'", "°", Some(30.25)),
    ("\u{2212}30° 15′ 36″", "°", Some(-30.26)),
    ("2000 rpm", "r/min", Some(2000.0)),
    ("800 Nm", "N·m", Some(800.0)),
    ("3,7 kg m2", "kg·m²", Some(3.7)),
    ("5 um", "µm", Some(5.0)),
    ("1,234", "", None),
    ("1.234,5", "", None),
    ("1,234.5", "", None),
    ("12,345,678", "", None),
    ("10 00", "", None),
    ("1.2.3", "", None),
];

/// What is typed into a list, and its values.
const LISTS: &[(&str, Option<&[f64]>)] = &[
    ("200,5; 400,5", Some(&[200.5, 400.5])),
    ("200,5 mm\n1\u{202f}400,5 mm\n", Some(&[200.5, 1400.5])),
    ("100,5; 200,5; 300,5", Some(&[100.5, 200.5, 300.5])),
    ("100,5;200,5;300,5", Some(&[100.5, 200.5, 300.5])),
    ("100,5\t200,5\t300,5", Some(&[100.5, 200.5, 300.5])),
    ("100,5\n200,5\n300,5", Some(&[100.5, 200.5, 300.5])),
    ("100,5 200,5 300,5", Some(&[100.5, 200.5, 300.5])),
    ("100.5, 200.5, 300.5", Some(&[100.5, 200.5, 300.5])),
    ("100.5,200.5,300.5", Some(&[100.5, 200.5, 300.5])),
    ("100, 200, 300", Some(&[100.0, 200.0, 300.0])),
    ("100 200 300", Some(&[100.0, 200.0, 300.0])),
    ("1 000; 2 000,5", Some(&[1000.0, 2000.5])),
    ("\u{2212}1,5; 0; 1,5", Some(&[-1.5, 0.0, 1.5])),
    ("1,125; 2,5", Some(&[1.125, 2.5])),
    ("100,5", None),
    ("100,5, 200,5", None),
    ("100,200,300", None),
    ("1,125; 2,250", None),
    ("100.5; 200,5", None),
    ("1.000,5; 2.000,5", None),
    ("1 000 2 000", None),
];

#[tokio::test]
async fn f08_numbers_are_read_as_they_are_meant_or_refused() {
    flow(async |browser| {
        browser.open("/").await;
        let module = "/assets/design/typed.js";
        let calls: Value = NUMBERS.iter().map(|(text, unit, _)| json!([text, unit])).collect();
        let read = called(browser, module, "readField", &calls).await;
        for ((text, unit, expected), read) in NUMBERS.iter().zip(read.as_array().unwrap()) {
            let refused = read["refused"].as_str().is_some_and(|why| why.contains("decimal point"));
            assert_eq!((read["value"].as_f64(), refused), (*expected, expected.is_none()), "{text} {unit}: {read}");
        }
        let calls: Value = LISTS.iter().map(|(text, _)| json!([text, "mm"])).collect();
        let read = called(browser, module, "readList", &calls).await;
        for ((text, expected), read) in LISTS.iter().zip(read.as_array().unwrap()) {
            let refused = read["refused"].as_str().is_some_and(|why| why.contains("decimal point"));
            let values = numbers(&read["values"]);
            assert_eq!((values.as_deref(), refused), (*expected, expected.is_none()), "{text}: {read}");
        }
        // What is no number at all goes to the service, which says what is needed; another unit is named here.
        let other = called(
            browser,
            module,
            "readField",
            &json!([["seventeen", ""], ["0x11", ""], ["Infinity", ""], ["0.2 m", "mm"], ["1/3", ""]]),
        )
        .await;
        assert!(other.as_array().unwrap().iter().all(|read| read["value"].is_null()), "{other}");
        assert_eq!(other[3]["refused"], "is given in “m”; this field is in mm");
    })
    .await;
}

#[tokio::test]
async fn f08_a_list_with_decimal_commas_becomes_the_axis_of_a_sweep() {
    flow(async |browser| {
        browser.open("/").await;
        browser.choose("[data-pointer='/kind'] select", "sweep").await;
        let input = browser.element("#axis-0-input").await;
        input.send_keys("pinion torque").await.unwrap();
        browser.until("document.querySelector('#axis-0-input-list .active')").await;
        input.send_keys("\u{e007}").await.unwrap();
        browser.click("label:has([name='axis-0-mode'][value='list'])").await;
        let values = "[data-pointer='/axes/0/values']";
        for (text, expected) in [("100,5; 200,5; 300,5", [100.5, 200.5, 300.5]), ("1 000 Nm; 2 000 Nm; 3 000 Nm", [1000.0, 2000.0, 3000.0])] {
            browser.fill("/axes/0/values", text).await;
            browser.until("document.querySelector('#sweep-plan').textContent.startsWith('3 points')").await;
            assert_eq!(numbers(&document(browser).await["axes"][0]["values"]).unwrap(), expected);
            let read = expected.map(|value| value.to_string()).join("; ");
            assert_eq!(browser.text(&format!("{values} .read")).await, format!("read as {read}"));
        }
        // What can be read in two ways goes nowhere, and the field says why.
        browser.fill("/axes/0/values", "100,5").await;
        browser.until(&format!("document.querySelector(\"{values} .error\").textContent.includes('decimal point')")).await;
        browser.click("#submit").await;
        browser.until("document.querySelector('#problems')?.textContent.includes('decimal point')").await;
        assert_eq!(browser.value("location.pathname").await, json!("/"));
        // A column of a spreadsheet stays a list.
        let paste = "const input = document.querySelector(arguments[0]); input.value = ''; const clipboardData = new DataTransfer(); \
                     clipboardData.setData('text/plain', '100,5\\r\\n200,5\\r\\n300,5\\r\\n'); \
                     input.dispatchEvent(new ClipboardEvent('paste', {bubbles: true, cancelable: true, clipboardData}));";
        browser.driver.execute(paste, vec![json!(format!("{values} input"))]).await.unwrap();
        assert_eq!(document(browser).await["axes"][0]["values"], json!([100.5, 200.5, 300.5]));
        // So do the ends of a range.
        browser.click("label:has([name='axis-0-mode'][value='range'])").await;
        browser.fill("/axes/0/from", "0,5").await;
        browser.fill("/axes/0/to", "1 000 N·m").await;
        let axis = &document(browser).await["axes"][0];
        assert_eq!((&axis["from"], &axis["to"]), (&json!(0.5), &json!(1000)));
    })
    .await;
}

#[tokio::test]
async fn f08_single_fields_take_decimal_commas_and_units_and_say_what_they_read() {
    flow(async |browser| {
        browser.open("/").await;
        for (pointer, text, value, read) in [
            ("/design/normal_module_mm", "5,5 mm", json!(5.5), "read as 5.5"),
            ("/design/helix_angle_deg", "24°30'", json!(24.5), "read as 24.5"),
            ("/design/face_width_mm", "80", json!(80), ""),
            ("/operation/pinion_speed_rpm", "1\u{202f}500 r/min", json!(1500), "read as 1500"),
        ] {
            browser.fill(pointer, text).await;
            assert_eq!(document(browser).await.pointer(pointer), Some(&value), "{text}");
            assert_eq!(browser.text(&format!("[data-pointer='{pointer}'] .read")).await, read, "{text}");
        }
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        browser.fill("/design/face_width_mm", "1,080").await;
        browser.until("document.querySelector(\"[data-pointer='/design/face_width_mm'] .error\").textContent.includes('can be 1.08 or 1080')").await;
    })
    .await;
}

#[tokio::test]
async fn f07_files_are_read_with_a_byte_order_mark_and_other_encodings_are_named() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        let mut given: Value = serde_json::from_str(include_str!("../../examples/table1.json")).unwrap();
        given["design"]["pinion"]["teeth"] = json!(19);
        given["name"] = json!("Größe");
        let text = given.to_string();
        let utf16 =
            |bytes: fn(u16) -> [u8; 2]| format!("\u{feff}{text}").encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
        let latin1: Vec<u8> = text.chars().map(|letter| u8::try_from(letter).unwrap()).collect();
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes, said) in [
            ("little.json", utf16(u16::to_le_bytes), "it is encoded in UTF-16 (little-endian); needed: UTF-8"),
            ("big.json", utf16(u16::to_be_bytes), "it is encoded in UTF-16 (big-endian); needed: UTF-8"),
            ("single.json", latin1, "perhaps in Windows-1252"),
            ("marked.json", format!("\u{feff}{text}").into_bytes(), "From the file marked.json."),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            browser.element("#upload").await.send_keys(path.to_str().unwrap()).await.unwrap();
            browser.until(&format!("document.querySelector('#start-note').textContent.includes('{said}')")).await;
            let is_read = document(browser).await["design"]["pinion"]["teeth"] == json!(19);
            assert_eq!(is_read, name == "marked.json", "{name}");
        }
        assert_eq!(document(browser).await["name"], json!("Größe"));
    })
    .await;
}

#[tokio::test]
async fn f12_csv_files_have_decimal_commas_when_this_browser_is_told_so() {
    flow(async |browser| {
        let text = include_str!("../../examples/given_stiffness.json");
        browser.open("/jobs").await;
        let id = browser.solved(&serde_json::from_str(text).unwrap()).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        browser.until("document.querySelector('#stiffness-plot + .plot-tools button')").await;
        let plot = "#stiffness-plot + .plot-tools .plot-files button";
        let point = saved_by(browser, plot, "text/csv").await;
        browser.choose("#csv-decimal", "comma").await;
        let comma = saved_by(browser, plot, "text/csv").await;
        // `blob.text()` leaves the byte order mark out.
        let number = |cell: &str| cell.replace(',', ".").parse::<f64>().unwrap();
        let rows = |text: &str, separator: char| -> Vec<Vec<f64>> {
            text.trim_end().split("\r\n").skip(1).map(|row| row.split(separator).map(number).collect()).collect()
        };
        let expected: Vec<Vec<f64>> =
            point.trim_end().split("\r\n").skip(1).map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        assert!(!expected.is_empty() && rows(&comma, ';') == expected, "{comma:.200}");
        // The choice is remembered, and the service's own files follow it.
        browser.driver.refresh().await.unwrap();
        succeeded(browser).await;
        browser.until("document.querySelector('#csv-decimal').value === 'comma'").await;
        browser.until("document.querySelector('#series-csv').href.endsWith('decimal=comma')").await;
        // The script of the plots makes blobs of its own when it arrives.
        let script = "const done = arguments[0]; HTMLAnchorElement.prototype.click = function () {}; const make = URL.createObjectURL; \
                      URL.createObjectURL = (blob) => { if (blob.type.startsWith('text/csv')) \
                        blob.arrayBuffer().then((bytes) => done([...new Uint8Array(bytes)])); return make.call(URL, blob); }; \
                      document.querySelector('#series-csv').dispatchEvent(new MouseEvent('click', {bubbles: true, cancelable: true}));";
        let saved = browser.driver.execute_async(script, vec![]).await.unwrap();
        let bytes: Vec<u8> = serde_json::from_value(saved.json().clone()).unwrap();
        let channel = String::from_utf8(bytes).unwrap();
        assert!(channel.starts_with("\u{feff}t_s;value\r\n") && !channel.contains('.'), "{channel:.80}");
    })
    .await;
}

#[tokio::test]
async fn f13_the_pages_count_the_values_of_a_range_as_the_service_does() {
    flow(async |browser| {
        browser.open("/").await;
        for (from, to, points, spacing, expected) in [
            (1.0, 1000.0, 4, "logarithmic", vec![1.0, 10.0, 100.0, 1000.0]),
            (0.1, 1.0, 10, "linear", vec![0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
            (-0.3, 0.3, 7, "linear", vec![-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3]),
            (1000.0, 0.01, 6, "logarithmic", vec![1000.0, 100.0, 10.0, 1.0, 0.1, 0.01]),
        ] {
            let axis = json!([[{"from": from, "to": to, "points": points, "spacing": spacing}]]);
            let values = called(browser, "/assets/common/grid.js", "gridOf", &axis).await;
            assert_eq!(numbers(&values[0]).unwrap(), expected);
        }
        let mut document: Value = serde_json::from_str(include_str!("../../examples/given_stiffness.json")).unwrap();
        document["kind"] = json!("sweep");
        document["analysis"] = json!({"accuracy": 1e-3});
        let axis = json!({"pointer": "/operation/pinion_torque_nm", "from": 1, "to": 1000, "points": 4, "spacing": "logarithmic"});
        document["axes"] = json!([axis]);
        let id = browser.solved(&document).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        assert_eq!(numbers(&result["sweep"]["axes"][0]["values"]).unwrap(), [1.0, 10.0, 100.0, 1000.0]);
    })
    .await;
}
