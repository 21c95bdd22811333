//! Entry of a pair of one's own: an empty pair, values of another geometry, what changed, drafts, submission.

use crate::browser::{Browser, flow};
use crate::form::{GOOD, document};
use crate::job::{submit, succeeded};
use serde_json::{Value, json};
use thirtyfour::Key;

const STATE: &str = "document.querySelector('#check-state').textContent";

/// Text of the mark below a field.
fn said(pointer: &str, kind: &str) -> String {
    format!("document.querySelector(\"[data-pointer='{pointer}'] .{kind}\").textContent")
}

fn input(pointer: &str) -> String {
    format!("document.querySelector(\"[data-pointer='{pointer}'] input\")")
}

/// Starts with an empty pair, as the page offers it on the first visit.
pub(crate) async fn empty_pair(browser: &Browser) {
    browser.open("/").await;
    browser.until(GOOD).await;
    browser.click("#start-note button").await;
    browser.until(&format!("{STATE} === '7 fields still to fill in'")).await;
}

/// The fields that an empty pair needs, with values.
pub(crate) const NEEDED: [(&str, &str); 7] = [
    ("/design/normal_module_mm", "4"),
    ("/design/pinion/teeth", "23"),
    ("/design/gear/teeth", "71"),
    ("/design/helix_angle_deg", "30"),
    ("/design/face_width_mm", "60"),
    ("/operation/pinion_speed_rpm", "1500"),
    ("/operation/pinion_torque_nm", "600"),
];

#[tokio::test]
async fn an_empty_pair_has_nothing_of_the_example_and_no_error_yet() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        // The first visit shows the example, and offers the choice.
        let offered = browser.text("#start-note").await;
        assert!(offered.contains("Start with an empty pair") && offered.contains("Keep the example"), "{offered}");
        empty_pair(browser).await;
        assert_eq!(document(browser).await, json!({"design": {"pinion": {}, "gear": {}}, "operation": {}}));
        assert_eq!(browser.value("document.querySelectorAll('[aria-invalid=true]').length").await, json!(0));
        assert_eq!(browser.value("document.querySelectorAll('#check-problems li a').length").await, json!(7));
        assert_eq!(browser.value("document.querySelectorAll('#drawing .world').length").await, json!(0));
        // It is remembered for this address.
        browser.open("/").await;
        browser.until(&format!("{STATE} === '7 fields still to fill in'")).await;
        // The list leads to the fields; what was touched and left empty is an error.
        browser.click("#check-problems li a").await;
        let first = browser.value("document.activeElement.closest('[data-pointer]').dataset.pointer").await;
        assert!(NEEDED.iter().any(|(pointer, _)| first == json!(pointer)), "{first}");
        browser.fill("/design/pinion/teeth", "23").await;
        browser.until(&format!("{STATE} === '6 fields still to fill in'")).await;
        browser.field("/design/pinion/teeth").await.send_keys(Key::Backspace + Key::Backspace).await.unwrap();
        browser.until(&format!("{}.includes('is required')", said("/design/pinion/teeth", "error"))).await;
        browser.until(&format!("{STATE}.startsWith('1 field needs attention, 6 still to fill in')")).await;
        for (pointer, value) in NEEDED {
            browser.fill(pointer, value).await;
        }
        browser.until(GOOD).await;
        // What depends on the geometry is the derived number in the field, and no part of the document.
        let inertia = "/design/gear/inertia_kg_m2";
        browser.until(&format!("/^derived: [0-9.]+$/.test({}.placeholder)", input(inertia))).await;
        let answer = "fetch('/api/v1/jobs/validate', {method: 'POST', headers: {'Content-Type': 'application/json'}, \
                      body: document.querySelector('#document-text').textContent}).then((answer) => answer.json())";
        let script = format!("const done = arguments[0]; {answer}.then(done, (error) => done(String(error)));");
        let report = browser.driver.execute_async(&script, Vec::new()).await.unwrap().json().clone();
        let derived =
            report["derived"].as_array().unwrap().iter().find(|one| one["pointer"] == inertia).unwrap().clone();
        let placeholder = browser.value(&format!("{}.placeholder", input(inertia))).await;
        let shown: f64 = placeholder.as_str().unwrap().trim_start_matches("derived: ").parse().unwrap();
        assert!((shown / derived["value"].as_f64().unwrap() - 1.0).abs() < 1e-3, "{shown} for {derived}");
        assert_eq!(browser.value(&said(inertia, "read")).await, json!("as solid discs"));
        assert_eq!(document(browser).await["design"]["gear"], json!({"teeth": 71}));
        // The default backlash is none of practice: the value of practice is a click away.
        browser.click("[data-pointer='/design/backlash_um'] [data-action='use']").await;
        browser.until(&format!("{GOOD} && Number({}.value) > 100", input("/design/backlash_um"))).await;
        submit(browser).await;
        succeeded(browser).await;
    })
    .await;
}

#[tokio::test]
async fn an_own_pair_over_the_example_does_not_keep_its_values_unnoticed() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        assert!(!document(browser).await["name"].is_null());
        // As in the case that was tried: an own pair typed over the example.
        for (pointer, value) in NEEDED {
            browser.fill(pointer, value).await;
        }
        browser.until(&format!("{STATE}.includes('values of another geometry')")).await;
        let stale = "[...document.querySelectorAll('.of-other-geometry')].map(({dataset}) => dataset.pointer)";
        let expected = json!([
            "/design/backlash_um",
            "/design/pinion/bore_diameter_mm",
            "/design/gear/bore_diameter_mm",
            "/design/pinion/inertia_kg_m2",
            "/design/gear/inertia_kg_m2",
        ]);
        let mut found: Vec<String> = serde_json::from_value(browser.value(stale).await).unwrap();
        let mut wanted: Vec<String> = serde_json::from_value(expected).unwrap();
        found.sort();
        wanted.sort();
        assert_eq!(found, wanted);
        // Name and label are no longer the example's, which is said, and can be undone.
        let shown = document(browser).await;
        assert_eq!((&shown["name"], &shown["label"]), (&Value::Null, &Value::Null));
        assert!(browser.value(&said("/name", "stale")).await.as_str().unwrap().contains("was taken out"));
        // What differs is listed, old and new, and what does not though it should.
        assert_eq!(browser.text("#changes-title").await, "Changed from the example pair: 9 fields");
        let list = "document.querySelector('#changes').textContent";
        let listed = browser.value(list).await;
        assert!(
            listed.as_str().unwrap().contains("17 → 23") && listed.as_str().unwrap().contains("75 mm → 60 mm"),
            "{listed}"
        );
        assert!(listed.as_str().unwrap().contains("Not changed, though the geometry is another"), "{listed}");
        // Nothing is submitted before the question is answered.
        browser.click("#submit").await;
        browser
            .until(
                "!document.querySelector('#problems').hidden && document.querySelectorAll('#problems li').length === 5",
            )
            .await;
        assert_eq!(browser.value("location.pathname").await, json!("/"));
        // One is kept, one replaced where it stands, the rest in one go.
        browser.click("[data-pointer='/design/gear/bore_diameter_mm'] [data-action='keep']").await;
        browser.until(&format!("{STATE}.includes('4 values of another geometry')")).await;
        browser.click("[data-pointer='/design/pinion/inertia_kg_m2'] [data-action='use']").await;
        browser.until(&format!("{STATE}.includes('3 values of another geometry')")).await;
        assert_eq!(document(browser).await["design"]["pinion"]["inertia_kg_m2"], Value::Null);
        // A mark survives a reload.
        browser.until("sessionStorage.getItem('herringbone.draft')?.includes('\"entered\"')").await;
        browser.driver.refresh().await.unwrap();
        browser.until(&format!("{STATE}.includes('3 values of another geometry')")).await;
        browser.click("#submit").await;
        browser.until("document.querySelectorAll('#problems li').length === 3").await;
        browser.click("#problems .actions button").await;
        browser.until("location.pathname.startsWith('/jobs/')").await;
        let path = browser.value("location.pathname").await;
        let accepted = browser.fetch(&format!("/api/v1{}/input", path.as_str().unwrap())).await;
        let design = &accepted["design"];
        assert_eq!(
            (&design["gear"]["bore_diameter_mm"], &design["gear"]["inertia_kg_m2"]),
            (&json!(120), &Value::Null)
        );
        assert_eq!(design["pinion"]["bore_diameter_mm"], Value::Null);
    })
    .await;
}

#[tokio::test]
async fn a_rule_between_fields_is_shown_at_the_one_edited_last() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        let (width, gap) = ("/design/pinion/face_width_mm", "/design/gap_width_mm");
        browser.fill(width, "90").await;
        browser.until(&format!("{GOOD} && {}.placeholder", input(width))).await;
        // The service names the width; the gap is what was edited.
        browser.fill(gap, "5").await;
        browser.until(&format!("{}.startsWith('with this value, Face width, pinion')", said(gap, "error"))).await;
        let link = browser.element(&format!("[data-pointer='{gap}'] .error a")).await;
        assert_eq!(link.text().await.unwrap(), "Face width, pinion");
        assert!(browser.value(&said(width, "error")).await.as_str().unwrap().contains("90 mm"));
        // All problems stand beside the status while one types.
        assert_eq!(browser.text("#check-state").await, "1 field needs attention");
        assert_eq!(browser.value("document.querySelectorAll('#check-problems li a').length > 0").await, json!(true));
        for place in [said(gap, "error"), said(width, "error"), "document.querySelector('#check-problems').textContent".to_owned()] {
            let text = browser.value(&place).await;
            let text = text.as_str().unwrap();
            assert!(!text.contains('_') && !text.contains('/') && !text.contains(" um"), "{text}");
        }
        // Not cut, in a table cell neither.
        let cut = "[...document.querySelectorAll('.error')].filter((node) => node.scrollWidth > node.clientWidth + 1 || getComputedStyle(node).textOverflow === 'ellipsis').length";
        assert_eq!(browser.value(cut).await, json!(0));
        link.click().await.unwrap();
        assert_eq!(browser.value("document.activeElement.closest('[data-pointer]').dataset.pointer").await, json!(width));
        // Edited itself, the width is at fault alone.
        browser.fill(width, "95").await;
        browser.until(&format!("{}.includes('95 mm') && {} === ''", said(width, "error"), said(gap, "error"))).await;
    })
    .await;
}

/// Sentences of the service have the units and names of the page wherever a person reads them.
#[tokio::test]
async fn sentences_have_symbols_of_units_and_no_pointers() {
    flow(async |browser| {
        browser.open("/").await;
        let cases = json!([
            ["is 5 um; permitted: 0 to 2000 um", "is 5 µm; permitted: 0 to 2000 µm"],
            ["is 77; permitted: 0 to 50 deg", "is 77; permitted: 0 to 50°"],
            ["not given: 0.065 kg m2 assumed", "not given: 0.065 kg·m² assumed"],
            ["a light load of 3 N m, 1 N/um", "a light load of 3 N·m, 1 N/µm"],
            ["above 1 m_n of amount_um", "above 1 mₙ of amount"],
            [
                "gear_axial_n_per_um 216.9, gear_halves_torsional_nm_per_rad 9.5e8 (E)",
                "gear axial 216.9 N/µm, gear halves torsional 9.5e8 N·m/rad (E)"
            ],
            ["face_width_mm 75 mm", "face width 75 mm"],
            ["\"/operation/pinion_speed_rpm\" is no number", "“Pinion speed” is no number"],
        ]);
        let script = "const done = arguments[1]; import('/assets/common/sentence.js').then(({readable}) => \
                      done(arguments[0].map(([text]) => readable(text))), (error) => done(String(error)));";
        let read = browser.driver.execute_async(script, vec![cases.clone()]).await.unwrap().json().clone();
        let expected: Vec<_> = cases.as_array().unwrap().iter().map(|case| case[1].clone()).collect();
        assert_eq!(read, json!(expected));
    })
    .await;
}

#[tokio::test]
async fn two_tabs_keep_a_draft_each_and_that_of_a_closed_tab_can_be_opened() {
    flow(async |browser| {
        let width = "/design/face_width_mm";
        let kept = |text: &str| format!("sessionStorage.getItem('herringbone.draft')?.includes('\"face_width_mm\":{text}')");
        browser.open("/").await;
        browser.until(GOOD).await;
        browser.fill(width, "61").await;
        browser.until(&kept("61")).await;
        let first = browser.driver.window().await.unwrap();
        let second = browser.driver.new_tab().await.unwrap();
        browser.driver.switch_to_window(second).await.unwrap();
        browser.open("/").await;
        browser.until(GOOD).await;
        assert_eq!(document(browser).await["design"]["face_width_mm"], json!(75), "the draft of the other tab is its own");
        browser.fill(width, "62").await;
        browser.until(&kept("62")).await;
        browser.driver.close_window().await.unwrap();
        browser.driver.switch_to_window(first).await.unwrap();
        browser.driver.refresh().await.unwrap();
        browser.until("document.querySelector('#start-note').textContent.includes('Your draft')").await;
        assert_eq!(document(browser).await["design"]["face_width_mm"], json!(61));
        // The closed tab's is among the choices.
        let open = "const choice = document.querySelector('#start-from'); choice.value = document.querySelector('#start-drafts option').value; \
                    choice.dispatchEvent(new Event('change', {bubbles: true}));";
        browser.driver.execute(open, Vec::new()).await.unwrap();
        browser.until("document.querySelector('#start-note').textContent.includes('The draft of')").await;
        assert_eq!(document(browser).await["design"]["face_width_mm"], json!(62));
    })
    .await;
}

#[tokio::test]
async fn enter_in_a_field_submits_nothing_and_back_returns_what_was_submitted() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        assert!(browser.text("#estimate").await.contains("no job like this was measured yet"));
        browser.fill("/operation/pinion_torque_nm", "655").await;
        let field = browser.field("/operation/pinion_torque_nm").await;
        browser.requests().await;
        field.send_keys("" + Key::Enter).await.unwrap();
        // The check that the edit starts has come and gone, and nothing was submitted before it or with it.
        field.send_keys("." + Key::Enter).await.unwrap();
        browser.until("sessionStorage.getItem('herringbone.draft')?.includes('655')").await;
        browser.until(GOOD).await;
        let asked = browser.requests().await;
        assert!(!asked.iter().any(|path| path == "/api/v1/jobs"), "{asked:?}");
        assert_eq!(browser.value("location.pathname").await, json!("/"));
        browser.field("/operation/pinion_torque_nm").await.send_keys(Key::Control + Key::Enter).await.unwrap();
        browser.until("location.pathname.startsWith('/jobs/')").await;
        succeeded(browser).await;
        browser.driver.back().await.unwrap();
        browser.until("location.pathname === '/' && document.querySelector('#start-note').textContent.includes('As submitted')").await;
        assert_eq!(document(browser).await["operation"]["pinion_torque_nm"], json!(655));
        assert_eq!(browser.value("document.querySelector('#submit').disabled").await, json!(false));
        // Now there is a measurement.
        browser.until("/about [0-9.]+ s|less than 0.1 s/.test(document.querySelector('#estimate').textContent)").await;
        assert!(browser.text("#estimate").await.contains("by 1 job like this"));
    })
    .await;
}

#[tokio::test]
async fn files_that_are_no_job_documents_are_named_for_what_they_are() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        let folder = tempfile::tempdir().unwrap();
        let large = format!("{{\"name\": \"{}\"}}", "x".repeat(3 << 20));
        for (name, bytes, expected) in [
            ("photo.json", b"\x89PNG\r\n\x1a\n....".to_vec(), "photo.json is a PNG image, not a job document"),
            (
                "pair.rexs",
                b"<?xml version=\"1.0\"?><model version=\"1.5\"></model>".to_vec(),
                "is a REXS model without components",
            ),
            ("pair.xml", b"<?xml version=\"1.0\"?>\n<model applicationId=\"REXS\">".to_vec(), "ends inside of <model>"),
            ("gear.Z12", b"VERSION=20.0;\r\nKSOFTVERSION=1;".to_vec(), "a calculation of KISSsoft"),
            ("large.json", large.into_bytes(), "large.json has 3 MiB; a job document has 1 MiB at most"),
            ("table.xlsx", b"PK\x03\x04rest".to_vec(), "is a ZIP archive or a spreadsheet"),
            ("result.json", br#"{"geometry": {}, "numerics": {}}"#.to_vec(), "is the result of a job"),
        ] {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            browser.element("#upload").await.send_keys(path.to_str().unwrap()).await.unwrap();
            browser.until(&format!("document.querySelector('#start-note').textContent.includes('{expected}')")).await;
        }
        assert_eq!(document(browser).await["design"]["pinion"]["teeth"], json!(17), "a bad file changes nothing");
    })
    .await;
}

/// Labels and inputs of the form, opened as a whole, on a telephone: none lies over another.
#[tokio::test]
async fn nothing_overlaps_on_a_telephone() {
    flow(async |browser| {
        browser.resize(390).await;
        browser.open("/").await;
        browser.until(GOOD).await;
        browser.choose("[data-pointer='/kind'] select", "sweep").await;
        browser.value("document.querySelectorAll('details').forEach((node) => { node.open = true; })").await;
        let overlapping = "(() => { const boxes = [...document.querySelectorAll('.sections :is(label, th, .symbol, .unit, .range, .why, input, select, legend, .help)')] \
            .filter((node) => !node.closest('.visually-hidden') && node.checkVisibility() && node.textContent.trim() + (node.value ?? '') !== '') \
            .map((node) => ({node, box: node.getBoundingClientRect()})).filter(({box}) => box.width > 1 && box.height > 1); \
            const found = []; \
            for (const [at, one] of boxes.entries()) for (const other of boxes.slice(at + 1)) { \
              if (one.node.contains(other.node) || other.node.contains(one.node)) continue; \
              const width = Math.min(one.box.right, other.box.right) - Math.max(one.box.left, other.box.left); \
              const height = Math.min(one.box.bottom, other.box.bottom) - Math.max(one.box.top, other.box.top); \
              if (width > 1 && height > 3) found.push(`${one.node.textContent.trim() || one.node.id} / ${other.node.textContent.trim() || other.node.id}`); } \
            return found; })()";
        assert_eq!(browser.value(overlapping).await, json!([]));
        let cut = "[...document.querySelectorAll('.input > .unit')].filter((node) => node.scrollWidth > node.clientWidth + 1).map((node) => node.textContent)";
        assert_eq!(browser.value(cut).await, json!([]));
        let wide = browser.value("document.documentElement.scrollWidth").await;
        assert!(wide.as_u64().is_some_and(|width| width <= 390), "{wide}");
    })
    .await;
}

/// From an empty form to a relieved design, by keyboard and mouse, with nothing read but the page.
#[tokio::test]
async fn a_stranger_comes_from_an_empty_form_to_a_relieved_design() {
    flow(async |browser| {
        empty_pair(browser).await;
        for (pointer, value) in NEEDED {
            browser.fill(pointer, value).await;
        }
        browser.fill("/design/gap_width_mm", "20").await;
        browser.until(GOOD).await;
        // Profile shifts and relief are in sections of their own, which the list of sections opens.
        browser.click("#sections a[href='#group-tooth-form']").await;
        browser.until("document.querySelector('#group-tooth-form').open").await;
        browser.fill("/design/pinion/profile_shift", "+0,3").await;
        browser.fill("/design/gear/profile_shift", "\u{2212}0,1").await;
        browser
            .until(&format!("{GOOD} && {}.includes('read as -0.1')", said("/design/gear/profile_shift", "read")))
            .await;
        browser.click("#sections a[href='#group-micro-geometry']").await;
        for member in ["pinion", "gear"] {
            browser.fill(&format!("/design/{member}/tip_relief/amount_um"), "20 µm").await;
        }
        // A relief without a length is refused where it was typed, and at the length that is missing.
        let missing = said("/design/gear/tip_relief/length_mm", "error");
        browser.until(&format!("{missing}.includes('length above 0 mm')")).await;
        for member in ["pinion", "gear"] {
            browser.fill(&format!("/design/{member}/tip_relief/length_mm"), "3").await;
        }
        browser.until(GOOD).await;
        browser.fill("/name", "z 23/71, relieved").await;
        let id = submit(browser).await;
        succeeded(browser).await;
        let accepted = browser.fetch(&format!("/api/v1/jobs/{id}/input")).await;
        let design = &accepted["design"];
        assert_eq!(design["pinion"]["tip_relief"]["amount_um"], json!(20));
        assert_eq!((&design["pinion"]["profile_shift"], &design["gear"]["profile_shift"]), (&json!(0.3), &json!(-0.1)));
        for name in ["inertia_kg_m2", "mass_kg", "bore_diameter_mm"] {
            assert_eq!((&design["pinion"][name], &design["gear"][name]), (&Value::Null, &Value::Null), "{name}");
        }
        let geometry = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await["geometry"].clone();
        // m_t (z1 + z2)/2 at a sum of shifts of 0.2: 217.08 mm and a little more.
        let distance_mm = geometry["center_distance_mm"].as_f64().unwrap();
        assert!(distance_mm > 217.08 && distance_mm < 218.0, "{distance_mm}");
    })
    .await;
}
