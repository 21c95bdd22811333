//! The design form: live check, errors at their fields, documents in and out.

use crate::browser::{Browser, flow};
use serde_json::{Value, json};

/// The document on the page can be solved.
pub(crate) const GOOD: &str = "document.querySelector('#check-state').classList.contains('good')";

pub(crate) async fn document(browser: &Browser) -> Value {
    let text = browser.value("document.querySelector('#document-text').textContent").await;
    serde_json::from_str(text.as_str().unwrap()).unwrap()
}

#[tokio::test]
async fn the_check_shows_contact_ratios_while_typing() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        let ratio = "document.querySelector('#check-geometry dd')?.textContent";
        let before = browser.value(ratio).await;
        // ISO 21771 with the example's data: 1.4968.
        assert_eq!(before, json!("1.4968"));
        browser.fill("/design/normal_module_mm", "5").await;
        browser.click("#group-tooth-form summary").await;
        browser.fill("/design/pinion/profile_shift", "0.2").await;
        browser.until(&format!("{ratio} && {ratio} !== '1.4968'")).await;
    })
    .await;
}

#[tokio::test]
async fn an_input_is_varied_from_its_field() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        browser.choose("[data-pointer='/kind'] select", "optimise").await;
        browser.until("!document.querySelector('#vary').hidden").await;
        browser.click("[data-pointer='/design/helix_angle_deg'] .vary").await;
        browser.until("document.querySelectorAll('#vary-rows tr').length === 1").await;
        let found = document(browser).await;
        let angle = found["design"]["helix_angle_deg"].as_f64().unwrap();
        let variable = &found["variables"][0];
        assert_eq!(variable["pointer"], "/design/helix_angle_deg");
        assert_eq!([&variable["from"], &variable["to"]], [&json!(0.5 * angle), &json!(1.5 * angle)]);
        // A bound that is typed, and the list emptied again.
        let type_bound = "(() => { const input = document.querySelector('#vary-rows input'); input.value = '20'; \
            input.dispatchEvent(new Event('change', { bubbles: true })); return true; })()";
        browser.value(type_bound).await;
        browser
            .until("JSON.parse(document.querySelector('#document-text').textContent).variables[0].from === 20")
            .await;
        browser.click("#vary-rows button").await;
        browser.until("document.querySelectorAll('#vary-rows tr').length === 0").await;
        assert!(document(browser).await.get("variables").is_none());
        browser.choose("[data-pointer='/kind'] select", "response").await;
        browser.until("document.querySelector('#vary').hidden && !document.querySelector('.vary')").await;
    })
    .await;
}

#[tokio::test]
async fn an_invalid_field_is_marked_with_the_servers_message() {
    flow(async |browser| {
        browser.open("/").await;
        browser.fill("/design/helix_angle_deg", "77").await;
        browser.fill("/design/pinion/teeth", "seventeen").await;
        browser.until("document.querySelectorAll('[aria-invalid=true]').length === 2").await;
        let error = browser.text("[data-pointer='/design/helix_angle_deg'] .error").await;
        assert_eq!(error, "is 77; permitted: 0 to 50°");
        // Submitting goes to the list of what is wrong, whose entries lead to the fields.
        browser.click("#submit").await;
        browser.until("!document.querySelector('#problems').hidden").await;
        browser.until("document.querySelector('#drawing').classList.contains('stale')").await;
        let first = browser.element("#problems li a").await;
        assert_eq!(browser.value("document.activeElement.id").await, json!("problems"));
        first.click().await.unwrap();
        let focused = browser.value("document.activeElement.closest('[data-pointer]').dataset.pointer").await;
        assert!(["/design/helix_angle_deg", "/design/pinion/teeth"].contains(&focused.as_str().unwrap()), "{focused}");
        assert_eq!(browser.value("location.pathname").await, json!("/"));
        // Put right, the marks go.
        browser.fill("/design/helix_angle_deg", "25").await;
        browser.fill("/design/pinion/teeth", "18").await;
        browser.until("document.querySelectorAll('[aria-invalid=true]').length === 0").await;
        assert_eq!(browser.text("[data-pointer='/design/helix_angle_deg'] .error").await, "");
    })
    .await;
}

#[tokio::test]
async fn an_error_opens_the_section_it_is_in() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        // The section is closed: the choice is made as a script makes it, so that no click races with the check.
        assert_eq!(browser.value("document.querySelector('#group-model').open").await, json!(false));
        browser.choose("[data-pointer='/model/mesh_stiffness/source'] select", "given").await;
        browser.until("document.querySelector('#group-model').open").await;
        let missing =
            "document.querySelector(\"[data-pointer='/model/mesh_stiffness/mean_n_per_um'] .error\").textContent";
        browser.until(&format!("{missing}.includes('is required with source \"given\"')")).await;
        // Closed by hand it stays closed, until the error is gone and comes again.
        browser.click("#group-model summary").await;
        browser.until("!document.querySelector('#group-model').open").await;
        browser.fill("/design/face_width_mm", "900000").await;
        browser.until("document.querySelector(\"[data-pointer='/design/face_width_mm'] .error\").textContent").await;
        assert_eq!(browser.value("document.querySelector('#group-model').open").await, json!(false));
        browser.choose("[data-pointer='/model/mesh_stiffness/source'] select", "ltca").await;
        browser.fill("/design/face_width_mm", "75").await;
        browser.until(GOOD).await;
        browser.choose("[data-pointer='/model/mesh_stiffness/source'] select", "given").await;
        browser.until("document.querySelector('#group-model').open").await;
    })
    .await;
}

#[tokio::test]
async fn the_document_says_what_differs_from_the_defaults() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until("document.querySelector('#document-text').textContent").await;
        let first = document(browser).await;
        assert_eq!(first["design"]["pressure_angle_plane"], json!("transverse"));
        assert_eq!(first["design"]["pinion"]["addendum"], Value::Null, "1 is the default: {first}");
        assert_eq!(first["design"]["backlash_um"], json!(230), "{first}");
        browser.fill("/design/backlash_um", "50").await;
        browser.choose("[data-pointer='/kind'] select", "sweep").await;
        // What is missing altogether is said at the first field of it.
        let missing = "document.querySelector(\"[data-pointer='/axes/0/pointer'] .error\").textContent";
        browser.until(&format!("{missing}.includes('is required for a sweep')")).await;
        browser.fill("/axes/0/pointer", "/operation/pinion_speed_rpm").await;
        browser.click("label:has([name='axis-0-mode'][value='list'])").await;
        browser.fill("/axes/0/values", "1000, 2000 3000").await;
        let changed = document(browser).await;
        assert_eq!(changed["design"]["backlash_um"], json!(50));
        let axis = json!({"pointer": "/operation/pinion_speed_rpm", "values": [1000, 2000, 3000]});
        assert_eq!(changed["axes"], json!([axis]));
        browser.until(GOOD).await;
        // Hidden again, the axes are no part of the document.
        browser.choose("[data-pointer='/kind'] select", "response").await;
        assert_eq!(document(browser).await["axes"], Value::Null);
    })
    .await;
}

#[tokio::test]
async fn a_file_fills_the_form_and_what_it_does_not_know_stays_in_the_document() {
    flow(async |browser| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("document.json");
        let mut given: Value = serde_json::from_str(include_str!("../../examples/table1.json")).unwrap();
        given["design"]["pinion"]["tip_relief"] = json!({"amount_um": 12.5, "length_mm": 4});
        given["model"]["damping_in_gap"] = json!(false);
        given["surplus"] = json!({"deep": [1, 2]});
        std::fs::write(&path, given.to_string()).unwrap();
        browser.open("/").await;
        browser.until(GOOD).await;
        browser.element("#upload").await.send_keys(path.to_str().unwrap()).await.unwrap();
        browser.until("document.querySelector('#extras').textContent.includes('“surplus › deep”')").await;
        let shown = document(browser).await;
        assert_eq!(shown["design"]["pinion"]["tip_relief"], json!({"amount_um": 12.5, "length_mm": 4}));
        assert_eq!(shown["model"]["damping_in_gap"], json!(false));
        assert_eq!(shown["surplus"], json!({"deep": [1, 2]}));
        // The server says what is wrong with it, and it goes only when it is told to.
        browser.until("document.querySelector('#problems li')?.textContent.includes('Surplus')").await;
        browser.click("#extras button").await;
        browser.until(GOOD).await;
        assert_eq!(document(browser).await["surplus"], Value::Null);
        // Dropped anywhere on the page, a file does the same.
        let drop = "const transfer = new DataTransfer(); \
                    transfer.items.add(new File([arguments[0]], 'dropped.json')); \
                    for (const name of ['dragenter', 'drop']) { \
                      document.querySelector('h1').dispatchEvent(new DragEvent(name, {bubbles: true, cancelable: true, dataTransfer: transfer})); \
                    }";
        given["design"]["pinion"]["teeth"] = json!(19);
        browser.driver.execute(drop, vec![json!(given.to_string())]).await.unwrap();
        browser.until("document.querySelector('#start-note').textContent.includes('dropped.json')").await;
        assert_eq!(document(browser).await["design"]["pinion"]["teeth"], json!(19));
        assert_eq!(browser.value("document.querySelector('#drop-target').hidden").await, json!(true));
        browser.driver.execute(drop, vec![json!("[1, 2")]).await.unwrap();
        browser.until("document.querySelector('#start-note').textContent.includes('is not a job document')").await;
        assert_eq!(document(browser).await["design"]["pinion"]["teeth"], json!(19), "a bad file changes nothing");
    })
    .await;
}

#[tokio::test]
async fn the_pair_is_drawn_and_the_drawing_follows_the_fields() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until("document.querySelectorAll('#drawing-section .flanks').length === 2").await;
        let title = "document.querySelector('#drawing-section title').textContent";
        assert!(browser.value(title).await.as_str().unwrap().contains("17 and 44 teeth"));
        let names = "[...document.querySelectorAll('#drawing-section text.name')].map((name) => name.textContent).join(' ')";
        assert_eq!(browser.value(names).await, json!("T₁ A B C D E T₂"));
        // One mesh period turns the pinion by one tooth, clockwise, and the lines of contact pass on.
        let turn = "Number(document.querySelector('#drawing-section .pinion .turning').getAttribute('transform').match(/-?[\\d.]+/)[0])";
        let set = |phase: &str| {
            format!("(() => {{ const slider = document.querySelector('#drawing-phase'); slider.value = {phase}; \
                     slider.dispatchEvent(new Event('input', {{bubbles: true}})); return {turn}; }})()")
        };
        let from = browser.value(&set("0")).await.as_f64().unwrap();
        let to = browser.value(&set("1")).await.as_f64().unwrap();
        assert!((from - to - 360.0 / 17.0).abs() < 1e-6, "{from} to {to}");
        assert_eq!(browser.value("document.querySelectorAll('#drawing-plane .lines').length").await, json!(2));
        let in_contact = "document.querySelectorAll('#drawing-section .contact:not(.away)').length";
        assert!(browser.value(in_contact).await.as_i64().is_some_and(|count| (1..=2).contains(&count)));
        let outline = "document.querySelector('#drawing-section .pinion .flanks').getAttribute('d')";
        let before = browser.value(outline).await;
        browser.fill("/design/pinion/teeth", "23").await;
        browser.until(&format!("{title}.includes('23 and 44 teeth')")).await;
        assert_ne!(browser.value(outline).await, before);
        // What cannot be drawn leaves the last pair, faded.
        browser.fill("/design/helix_angle_deg", "77").await;
        browser.until("document.querySelector('#drawing').classList.contains('stale')").await;
        assert!(browser.value(title).await.as_str().unwrap().contains("23 and 44"));
        browser.fill("/design/helix_angle_deg", "24").await;
        browser.until("!document.querySelector('#drawing').classList.contains('stale')").await;
    })
    .await;
}

#[tokio::test]
async fn the_form_starts_from_an_example_or_where_it_was_left() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        browser.choose("#start-from", "tip_relief").await;
        browser.until("document.querySelector('#start-note').textContent.includes('15 µm')").await;
        let relief = |document: Value| document["design"]["pinion"]["tip_relief"]["amount_um"].clone();
        assert_eq!(relief(document(browser).await), json!(15));
        let gist = "document.querySelector('#group-micro-geometry .gist').textContent";
        assert_eq!(browser.value(gist).await, json!("Tip relief, amount 15 / 15 µm, tip relief, length 6 / 6 mm"));
        // One step back.
        browser.click("#start-note button").await;
        browser.until(&format!("{gist} === 'none'")).await;
        // A field is put back to its default where it stands.
        browser.fill("/design/backlash_um", "50").await;
        browser
            .until("document.querySelector(\"[data-pointer='/design/backlash_um']\").classList.contains('differs')")
            .await;
        browser.click("[data-pointer='/design/backlash_um'] .reset").await;
        assert_eq!(
            browser.value("document.querySelector(\"[data-pointer='/design/backlash_um'] input\").value").await,
            json!("2")
        );
        // What was typed survives a reload, until it is discarded.
        browser.fill("/design/face_width_mm", "61").await;
        browser.until("sessionStorage.getItem('herringbone.draft')?.includes('61')").await;
        browser.open("/").await;
        browser.until("document.querySelector('#start-note').textContent.includes('Your draft')").await;
        assert_eq!(document(browser).await["design"]["face_width_mm"], json!(61));
        browser.click("#start-note button").await;
        assert_eq!(document(browser).await["design"]["face_width_mm"], json!(75));
        browser.open("/").await;
        browser.until(GOOD).await;
        assert_eq!(document(browser).await["design"]["face_width_mm"], json!(75));
        // Submitted, the document can be started from again.
        browser.fill("/name", "it's mine").await;
        browser.click("#submit").await;
        browser.until("location.pathname.startsWith('/jobs/')").await;
        browser.open("/").await;
        browser.until(GOOD).await;
        browser.choose("#start-from", "submitted").await;
        browser.until("document.querySelector('#document-text').textContent.includes(\"it's mine\")").await;
        // As a command of the shell, quotes and all.
        let copy = "navigator.clipboard.writeText = async (text) => { window.copied = text; }; \
                    document.querySelector('#copy-curl').click(); return true;";
        browser.driver.execute(copy, Vec::new()).await.unwrap();
        browser.until("window.copied?.includes(\"it'\\\\''s mine\") && window.copied.includes('/api/v1/jobs')").await;
    })
    .await;
}

#[tokio::test]
async fn help_and_warnings_stand_at_their_fields() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        let place = "[data-pointer='/design/helix_angle_deg']";
        let height = "document.querySelector('#group-widths').offsetHeight";
        let before = browser.value(height).await;
        browser.element(&format!("{place} input")).await.focus().await.unwrap();
        browser.until("document.querySelector('#help-line').textContent.includes('0 to 50 °')").await;
        browser.fill("/design/helix_angle_deg", "77").await;
        browser.until("document.querySelectorAll('[aria-invalid=true]').length === 1").await;
        assert_eq!(browser.value(height).await, before, "an error moves nothing");
        browser.fill("/design/helix_angle_deg", "24.43").await;
        browser.until(GOOD).await;
        // The help is disclosed where it is asked for.
        browser.click(&format!("{place} .why")).await;
        assert!(browser.text(&format!("{place} .help")).await.starts_with("Helix angle"));
        // An undercut pinion is a warning, at the field that cures it.
        browser.fill("/design/pinion/teeth", "15").await;
        browser.until("document.querySelector(\"[data-pointer='/design/pinion/profile_shift'] .caution\").textContent.includes('undercut')").await;
        browser.until("document.querySelector('#check-warnings li')").await;
        assert!(browser.value("document.querySelector('#check-gears .low')?.textContent.includes('below')").await == json!(true));
    })
    .await;
}
