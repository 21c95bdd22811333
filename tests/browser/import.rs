//! Gear models of other programs on the form: a file dropped or opened, what was taken and assumed, choices.

use crate::browser::{Browser, flow};
use crate::form::{GOOD, document};
use crate::job::{assert_complete, submit, succeeded};
use serde_json::json;
use std::path::Path;

fn model(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/exchange/tests/data").join(name)
}

/// Mark of a field: `taken`, `assumed`, or null.
fn origin(pointer: &str) -> String {
    format!("document.querySelector(\"[data-pointer='{pointer}']\").dataset.origin ?? null")
}

async fn opened(browser: &Browser, name: &str) {
    let path = model(name);
    browser.element("#upload").await.send_keys(path.to_str().unwrap()).await.unwrap();
}

#[tokio::test]
async fn a_model_fills_the_form_and_says_where_each_field_is_from() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        assert_eq!(browser.value("document.querySelector('#imported').hidden").await, json!(true));
        // Dropped anywhere on the page.
        let drop = "const transfer = new DataTransfer(); \
                    transfer.items.add(new File([arguments[0]], 'gearbox.rexs')); \
                    for (const name of ['dragenter', 'drop']) { \
                      document.querySelector('h1').dispatchEvent(new DragEvent(name, {bubbles: true, cancelable: true, dataTransfer: transfer})); \
                    }";
        let text = std::fs::read_to_string(model("herringbone_pair_1_7.rexs")).unwrap();
        browser.driver.execute(drop, vec![json!(text)]).await.unwrap();
        browser.until("document.querySelector('#start-note').textContent.includes('From the model gearbox.rexs')").await;
        let shown = document(browser).await;
        assert_eq!(shown["design"]["pinion"]["teeth"], json!(17));
        assert_eq!(shown["design"]["shafts"]["gear"]["bearings"][0]["axial_n_per_um"], json!(100));
        for (pointer, mark) in [
            ("/design/normal_module_mm", json!("taken")),
            ("/design/pinion/tip_relief/amount_um", json!("taken")),
            ("/design/pinion/fillet_radius", json!("assumed")),
            ("/design/shafts/pinion/bearings/1/radial_n_per_um", json!("taken")),
            ("/analysis/accuracy", json!(null)),
        ] {
            assert_eq!(browser.value(&origin(pointer)).await, mark, "{pointer}");
        }
        let described = "document.querySelector(\"[data-pointer='/design/normal_module_mm'] .origin\").textContent";
        let described = browser.value(described).await;
        assert!(described.as_str().unwrap().contains("cylindrical_gear[40].normal_module"), "{described}");
        let report = browser.value("document.querySelector('#imported').textContent").await;
        for words in ["gearbox.rexs: REXS 1.7 by illustration 0", "no tip rounding of a tool", "another program’s"] {
            assert!(report.as_str().unwrap().replace('\'', "’").contains(words), "{words}: {report}");
        }
        browser.until(GOOD).await;
        // A field that is edited is no longer the file's.
        browser.fill("/design/face_width_mm", "60").await;
        browser.until(&format!("({}) === null", origin("/design/face_width_mm"))).await;
        browser.fill("/design/face_width_mm", "55").await;
        browser.until(&format!("({}) === 'taken'", origin("/design/face_width_mm"))).await;
        // The draft keeps the report.
        browser.open("/").await;
        browser.until("!document.querySelector('#imported').hidden").await;
        assert_eq!(browser.value(&origin("/design/normal_module_mm")).await, json!("taken"));
        // An example has none.
        browser.choose("#start-from", "tip_relief").await;
        browser.until("document.querySelector('#imported').hidden").await;
        assert_eq!(browser.value("document.querySelectorAll('[data-origin]').length").await, json!(0));
    })
    .await;
}

#[tokio::test]
async fn single_helical_stages_are_offered_mirrored() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        opened(browser, "FVA-Industriegetriebe_2stufig_1-4.rexsj").await;
        browser.until("document.querySelectorAll('#start-note button').length === 2").await;
        let note = browser.text("#start-note").await;
        assert!(note.contains("single-helical stages only") && note.contains("Mirror pair 2"), "{note}");
        assert_eq!(document(browser).await["design"]["pinion"]["teeth"], json!(17), "a refusal changes nothing");
        browser.click("#start-note button:nth-of-type(2)").await;
        browser.until("document.querySelector('#start-note').textContent.includes('mirrored')").await;
        let shown = document(browser).await;
        assert_eq!(shown["design"]["pinion"]["teeth"], json!(23));
        assert_eq!(browser.value(&origin("/design/gap_width_mm")).await, json!("assumed"));
        // The other load cases are a click away.
        let before = shown["operation"]["pinion_torque_nm"].as_f64().unwrap();
        let case = "[...document.querySelectorAll('#start-note button')].find((button) => button.textContent === 'Load case 4')";
        browser.value(&format!("{case}.click()")).await;
        browser.until(&format!("JSON.parse(document.querySelector('#document-text').textContent).operation.pinion_torque_nm !== {before}")).await;
        let heavier = document(browser).await["operation"]["pinion_torque_nm"].as_f64().unwrap();
        assert!((heavier / before - 789.0 / 567.0).abs() < 1e-9, "{heavier} after {before}");
    })
    .await;
}

#[tokio::test]
async fn a_torque_that_is_not_in_the_file_is_asked_for() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        let text = std::fs::read_to_string(model("herringbone_pair_1_7.rexs")).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("idle.rexs");
        std::fs::write(&path, text.replace("torque_around_u_axis", "custom_torque")).unwrap();
        browser.element("#upload").await.send_keys(path.to_str().unwrap()).await.unwrap();
        browser.until("document.querySelector('#import-torque')").await;
        browser.element("#import-torque").await.send_keys("650,5").await.unwrap();
        browser.value("document.querySelector('#import-torque').parentElement.querySelector('button').click()").await;
        browser.until("document.querySelector('#start-note').textContent.includes('From the model idle.rexs')").await;
        assert_eq!(document(browser).await["operation"]["pinion_torque_nm"], json!(650.5));
    })
    .await;
}

/// Somebody with a file and nothing else: dropped, submitted as it stands, read on paper. With
/// `HERRINGBONE_WALK=FOLDER` each step is a picture there.
#[tokio::test]
async fn a_model_goes_to_a_report_without_a_word_typed() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        opened(browser, "herringbone_pair_1_7.rexs").await;
        browser.until("document.querySelector('#start-note').textContent.includes('From the model')").await;
        browser.until(GOOD).await;
        picture(browser, "1-form").await;
        submit(browser).await;
        succeeded(browser).await;
        picture(browser, "2-job").await;
        browser.element("#report").await.click().await.unwrap();
        browser.until("document.querySelector('article')?.dataset.ready").await;
        assert_complete(browser).await;
        picture(browser, "3-report").await;
        let report = browser.text("main").await;
        for words in ["55", "N/µm", "transmission error"] {
            assert!(report.to_lowercase().contains(&words.to_lowercase()), "{words}: {report}");
        }
    })
    .await;
}

async fn picture(browser: &Browser, name: &str) {
    if let Some(folder) = std::env::var_os("HERRINGBONE_WALK") {
        let path = Path::new(&folder).join(format!("{name}.png"));
        browser.driver.screenshot(&path).await.unwrap();
    }
}
