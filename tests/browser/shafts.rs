//! Shafts and bearings in the design form: a few numbers, or segment by segment; their drawing; errors at their fields.

use crate::browser::{Browser, flow};
use crate::form::{GOOD, document};
use serde_json::{Value, json};

/// The choice of which shafts are given.
pub(crate) const CHOICE: &str = "[data-pointer='/design/shafts'] select";

/// Number of elements of a selector.
async fn count(browser: &Browser, selector: &str) -> Value {
    browser.value(&format!("document.querySelectorAll(\"{selector}\").length")).await
}

pub(crate) async fn open_section(browser: &Browser) {
    browser.open("/").await;
    browser.until(GOOD).await;
    browser.click("#group-shafts > summary").await;
}

#[tokio::test]
async fn a_straddle_arrangement_takes_four_fields_and_is_drawn() {
    flow(async |browser| {
        open_section(browser).await;
        assert_eq!(document(browser).await["design"]["shafts"], Value::Null);
        assert_eq!(browser.value("document.querySelector('#shafts-drawing').hidden").await, json!(true));
        browser.choose(CHOICE, "arrangement").await;
        // Nothing more is needed: the rest is derived, and said.
        browser.until("document.querySelectorAll('#drawing-shafts .bearing').length === 4").await;
        assert_eq!(document(browser).await["design"]["shafts"], json!({"arrangement": {}}));
        let placeholder = "document.querySelector(\"[data-pointer='/design/shafts/arrangement/bearing_span_mm'] input\").placeholder";
        browser.until(&format!("{placeholder}.startsWith('derived: 335')")).await;
        browser.fill("/design/shafts/arrangement/bearing_span_mm", "340").await;
        browser.fill("/design/shafts/arrangement/pinion_shaft_diameter_mm", "80").await;
        browser.fill("/design/shafts/arrangement/gear_shaft_diameter_mm", "110").await;
        browser.until(GOOD).await;
        let arrangement = json!({"bearing_span_mm": 340, "pinion_shaft_diameter_mm": 80, "gear_shaft_diameter_mm": 110});
        assert_eq!(document(browser).await["design"]["shafts"], json!({"arrangement": arrangement}));
        browser.until("document.querySelector('#drawing-shafts desc').textContent.includes('−170 mm, 170 mm')").await;
        assert_eq!(count(browser, "#drawing-shafts .axial").await, json!(1));
        // What is wrong is said at its field, and the drawing fades.
        browser.fill("/design/shafts/arrangement/bearing_span_mm", "150").await;
        let error = "document.querySelector(\"[data-pointer='/design/shafts/arrangement/bearing_span_mm'] .error\").textContent";
        browser.until(&format!("{error}.includes('permitted: 180 mm and more')")).await;
        browser.until("document.querySelector('#shafts-drawing').classList.contains('stale')").await;
        browser.fill("/design/shafts/arrangement/bearing_span_mm", "340").await;
        browser.until(GOOD).await;
        // A sweep can vary what stands in the fields; hidden again, they are no part of the document.
        browser.choose(CHOICE, "").await;
        browser.until("document.querySelector('#shafts-drawing').hidden").await;
        assert_eq!(document(browser).await["design"]["shafts"], Value::Null);
    })
    .await;
}

#[tokio::test]
async fn derived_shafts_are_edited_segment_by_segment() {
    flow(async |browser| {
        open_section(browser).await;
        browser.choose(CHOICE, "arrangement").await;
        browser.until("!document.querySelector('#shafts-take-over').hidden").await;
        browser.click("#shafts-edit").await;
        browser.until("document.querySelector('#shafts-take-over').hidden").await;
        browser.until(GOOD).await;
        let shafts = document(browser).await["design"]["shafts"].clone();
        assert_eq!(shafts.get("arrangement"), None);
        assert_eq!(shafts["pinion"]["segments"].as_array().map(Vec::len), Some(5));
        assert_eq!(shafts["gear"]["bearings"].as_array().map(Vec::len), Some(2));
        assert!(shafts["gear"]["half_body"]["mass_kg"].as_f64().is_some(), "{shafts}");
        // A segment inserted after the first, and removed: the others move, with their numbers.
        let list = "[data-list='/design/shafts/pinion/segments']";
        let first = shafts["pinion"]["segments"][1].clone();
        browser.click(&format!("{list} [data-item] [data-act=insert]")).await;
        let focused = "document.activeElement.closest('[data-pointer]')?.dataset.pointer";
        assert_eq!(browser.value(focused).await, json!("/design/shafts/pinion/segments/1/length_mm"));
        let error = "document.querySelector(\"[data-pointer='/design/shafts/pinion/segments/1/diameter_mm']\")";
        assert_eq!(browser.value(&format!("{error} !== null")).await, json!(true));
        browser.fill("/design/shafts/pinion/segments/1/length_mm", "4").await;
        browser.fill("/design/shafts/pinion/segments/1/diameter_mm", "60").await;
        let changed = document(browser).await["design"]["shafts"]["pinion"]["segments"].clone();
        assert_eq!((&changed[1], &changed[2]), (&json!({"length_mm": 4, "diameter_mm": 60}), &first));
        browser.click(&format!("{list} [data-item]:nth-child(2) [data-act=remove]")).await;
        assert_eq!(document(browser).await["design"]["shafts"], shafts);
        browser.until(GOOD).await;
    })
    .await;
}

#[tokio::test]
async fn a_malformed_bearing_is_marked_where_it_stands() {
    flow(async |browser| {
        open_section(browser).await;
        browser.choose(CHOICE, "arrangement").await;
        browser.until("!document.querySelector('#shafts-take-over').hidden").await;
        browser.click("#shafts-edit").await;
        browser.until(GOOD).await;
        let position = "/design/shafts/pinion/bearings/1/position_mm";
        let place =
            browser.value(&format!("document.querySelector(\"[data-pointer='{position}'] input\").value")).await;
        browser.fill(position, "9999").await;
        let error = format!("document.querySelector(\"[data-pointer='{position}'] .error\").textContent");
        browser.until(&format!("{error}.includes('beyond the right end')")).await;
        assert_eq!(count(browser, "[aria-invalid=true]").await, json!(1));
        // Its name in the list of problems says which bearing it is.
        browser.click("#submit").await;
        browser.until("!document.querySelector('#problems').hidden").await;
        assert_eq!(browser.text("#problems li a").await, "Position, bearing 2, pinion");
        browser.fill(position, place.as_str().unwrap()).await;
        browser.until(GOOD).await;
        // Without the second bearing the shaft would tilt: that is said of the list.
        browser.click("[data-list='/design/shafts/pinion/bearings'] [data-item]:nth-child(2) [data-act=remove]").await;
        let error = "document.querySelector(\"[data-pointer='/design/shafts/pinion/bearings'] .error\").textContent";
        browser.until(&format!("{error}.includes('would tilt about that bearing')")).await;
        browser.fill("/design/shafts/pinion/bearings/0/tilting_nm_per_rad", "1e6").await;
        browser.until(GOOD).await;
    })
    .await;
}

#[tokio::test]
async fn lists_are_filled_from_a_document_and_kept_with_what_is_not_known() {
    flow(async |browser| {
        let row = |speed: u32| json!({"speed_rpm": speed, "stiffness_xx_n_per_um": 300, "stiffness_yy_n_per_um": 500, "stiffness_xy_n_per_um": 90});
        let bearing = json!({"position_mm": 40, "axial_n_per_um": 50, "speed_table": [row(500), row(4000)]});
        let other = json!({"position_mm": 380, "radial_n_per_um": 800, "colour": "blue"});
        let shaft = json!({
            "gear_position_mm": 210, "segments": [{"length_mm": 420, "diameter_mm": 95}], "bearings": [bearing, other],
            "coupling": {"position_mm": 0},
        });
        let mut given: Value = serde_json::from_str(include_str!("../../examples/contact.json")).unwrap();
        given["design"]["shafts"] = json!({"arrangement": {"output": "left"}, "pinion": shaft});
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("document.json");
        std::fs::write(&path, given.to_string()).unwrap();
        browser.open("/").await;
        browser.until(GOOD).await;
        browser.element("#upload").await.send_keys(path.to_str().unwrap()).await.unwrap();
        browser.until("document.querySelector('#extras').textContent.includes('colour')").await;
        let shown = document(browser).await;
        assert_eq!(shown["design"]["shafts"], given["design"]["shafts"]);
        browser.click("#extras button").await;
        browser.until(GOOD).await;
        assert_eq!(browser.value(&format!("document.querySelector(\"{CHOICE}\").value")).await, json!("pinion"));
        // The number of objects can be typed; a row of the inner list has its own numbers.
        browser.value("document.querySelector('#group-shafts').open = true").await;
        let speeds = "/design/shafts/pinion/bearings/0/speed_table";
        let count_of = format!("document.querySelector(\"[data-pointer='{speeds}'] input\")");
        browser
            .value(&format!("(() => {{ const input = {count_of}; input.value = '3'; input.dispatchEvent(new Event('change', {{bubbles: true}})); }})()"))
            .await;
        browser.until(&format!("document.querySelector(\"[data-pointer='{speeds}/2/speed_rpm']\") !== null")).await;
        let named = browser
            .value(&format!("document.querySelector(\"[data-pointer='{speeds}/2/speed_rpm']\").dataset.label"))
            .await;
        assert_eq!(named, json!("Speed, speed 3, bearing 1, pinion"));
        assert_eq!(
            document(browser).await["design"]["shafts"]["pinion"]["bearings"][0]["speed_table"][2],
            json!({})
        );
    })
    .await;
}
