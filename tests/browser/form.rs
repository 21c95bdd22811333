//! The design form: live check, errors at their fields, documents in and out.

use crate::browser::{Browser, flow};
use serde_json::{Value, json};

async fn document(browser: &Browser) -> Value {
    let text = browser.value("document.querySelector('#document-text').textContent").await;
    serde_json::from_str(text.as_str().unwrap()).unwrap()
}

#[tokio::test]
async fn the_check_shows_contact_ratios_while_typing() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        let ratio = "document.querySelector('#check-geometry dd')?.textContent";
        let before = browser.value(ratio).await;
        // ISO 21771 with the example's data: 1.4968.
        assert_eq!(before, json!("1.4968"));
        browser.fill("/design/normal_module_mm", "5").await;
        browser.element("#group-tooth-form summary").await.click().await.unwrap();
        browser.fill("/design/pinion/profile_shift", "0.2").await;
        browser.until(&format!("{ratio} && {ratio} !== '1.4968'")).await;
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
        assert_eq!(error, "is 77; permitted: 0 to 50 deg");
        // Submitting goes to the list of what is wrong, whose entries lead to the fields.
        browser.element("#submit").await.click().await.unwrap();
        browser.until("!document.querySelector('#problems').hidden").await;
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
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        browser.element("#group-model summary").await.click().await.unwrap();
        browser.choose("[data-pointer='/model/mesh_stiffness/source'] select", "given").await;
        browser.element("#group-model summary").await.click().await.unwrap();
        browser.until("document.querySelector('#group-model').open").await;
        let error = browser.text("[data-pointer='/model/mesh_stiffness/mean_n_per_um'] .error").await;
        assert!(error.contains("is required with source \"given\""), "{error}");
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
        assert_eq!(first["design"]["backlash_um"], Value::Null, "2 µm is the default: {first}");
        browser.fill("/design/backlash_um", "50").await;
        browser.choose("[data-pointer='/kind'] select", "sweep").await;
        browser.fill("/axes/0/pointer", "/operation/pinion_speed_rpm").await;
        browser.fill("/axes/0/values", "1000, 2000 3000").await;
        let changed = document(browser).await;
        assert_eq!(changed["design"]["backlash_um"], json!(50));
        let axis = json!({"pointer": "/operation/pinion_speed_rpm", "values": [1000, 2000, 3000]});
        assert_eq!(changed["axes"], json!([axis]));
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        // Hidden again, the axes are no part of the document.
        browser.choose("[data-pointer='/kind'] select", "response").await;
        assert_eq!(document(browser).await["axes"], Value::Null);
    })
    .await;
}

#[tokio::test]
async fn a_file_fills_the_form() {
    flow(async |browser| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("document.json");
        let mut given: Value = serde_json::from_str(include_str!("../../examples/table1.json")).unwrap();
        given["design"]["pinion"]["tip_relief"] = json!({"amount_um": 12.5, "length_mm": 4});
        given["model"]["damping_in_gap"] = json!(false);
        given["surplus"] = json!(1);
        std::fs::write(&path, given.to_string()).unwrap();
        browser.open("/").await;
        browser.until("document.querySelector('#document-text').textContent").await;
        browser.element("#upload").await.send_keys(path.to_str().unwrap()).await.unwrap();
        browser.until("document.querySelector('#document-note').textContent.includes('/surplus')").await;
        let shown = document(browser).await;
        assert_eq!(shown["design"]["pinion"]["tip_relief"], json!({"amount_um": 12.5, "length_mm": 4}));
        assert_eq!(shown["model"]["damping_in_gap"], json!(false));
    })
    .await;
}
