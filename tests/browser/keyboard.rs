//! The pages without a pointer.

use crate::browser::{Browser, flow};
use crate::form::GOOD;
use crate::job::succeeded;
use serde_json::{Value, json};
use thirtyfour::Key;

/// More steps than any page has.
const MANY: usize = 400;

async fn press(browser: &Browser, key: Key) {
    browser.driver.action_chain().send_keys(key).perform().await.unwrap();
}

/// Presses Tab until the element has the focus. Wherever the focus rests on the way, one sees it.
async fn tab_to(browser: &Browser, selector: &str) {
    let place = "(() => { const node = document.activeElement; if (!node || node === document.body) return null; \
        const seen = (candidate) => candidate && getComputedStyle(candidate).outlineStyle !== 'none' && candidate.getClientRects().length > 0; \
        const label = node.id ? document.querySelector(`label[for='${node.id}']`) : null; \
        const visible = [node, label, node.nextElementSibling, node.closest('label')].some(seen); \
        return {name: `${node.nodeName} ${node.id} ${node.textContent.trim().slice(0, 30)}`, visible}; })()";
    let there = format!("document.activeElement.matches(\"{selector}\")");
    let mut passed = Vec::new();
    for _ in 0..MANY {
        press(browser, Key::Tab).await;
        let now = browser.value(place).await;
        if !now.is_null() {
            assert_eq!(now["visible"], json!(true), "one does not see that the focus is at {}", now["name"]);
            passed.push(now["name"].to_string());
        }
        if browser.value(&there).await == json!(true) {
            return;
        }
    }
    panic!("Tab does not lead to {selector} but to {passed:?}");
}

/// The document of the job whose page is open, numbers as the page's own language has them.
async fn document_of(browser: &Browser) -> Value {
    let path = browser.value("location.pathname").await;
    browser.fetch(&format!("/api/v1{}/input", path.as_str().unwrap())).await
}

#[tokio::test]
async fn the_example_is_submitted_by_keyboard_alone() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        // The first step is a link past the header.
        press(browser, Key::Tab).await;
        assert_eq!(browser.text(":focus").await, "Skip to the content");
        assert_eq!(browser.value("document.activeElement.getBoundingClientRect().left >= 0").await, json!(true));
        press(browser, Key::Enter).await;
        browser.until("document.activeElement.id === 'main'").await;
        // Choices go by arrows.
        tab_to(browser, "[data-pointer='/kind'] select").await;
        let kind = "document.activeElement.value";
        let before = browser.value(kind).await;
        press(browser, Key::Up).await;
        assert_ne!(browser.value(kind).await, before);
        press(browser, Key::Down).await;
        assert_eq!(browser.value(kind).await, before);
        tab_to(browser, "#submit").await;
        press(browser, Key::Enter).await;
        browser.until("location.pathname.startsWith('/jobs/')").await;
        succeeded(browser).await;
        let mut first = document_of(browser).await;
        // From the result back to the form, with the same document.
        tab_to(browser, "#again").await;
        press(browser, Key::Enter).await;
        browser.until("location.pathname === '/' && location.search.startsWith('?from=')").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        // One field is changed, and nothing else: a job of its own.
        tab_to(browser, "[data-pointer='/operation/pinion_torque_nm'] input").await;
        browser.driver.action_chain().send_keys("650").perform().await.unwrap();
        tab_to(browser, "#submit").await;
        press(browser, Key::Enter).await;
        browser.until("location.pathname.startsWith('/jobs/')").await;
        let changed = document_of(browser).await;
        first["operation"]["pinion_torque_nm"] = json!(650);
        assert_eq!(changed, first);
    })
    .await;
}

/// Types over what stands in the field that has the focus.
async fn type_over(browser: &Browser, text: &str) {
    browser
        .driver
        .action_chain()
        .key_down(Key::Control)
        .send_keys("a")
        .key_up(Key::Control)
        .send_keys(text)
        .perform()
        .await
        .unwrap();
}

/// An own pair from an empty form: numbers as people type them, an error found by the list beside the status, a value
/// of another geometry, and the question before it is submitted.
#[tokio::test]
async fn an_own_pair_is_entered_from_an_empty_form_by_keyboard_alone() {
    flow(async |browser| {
        let state = "document.querySelector('#check-state').textContent";
        browser.open("/").await;
        browser.until(GOOD).await;
        tab_to(browser, "#start-note button").await;
        press(browser, Key::Enter).await;
        browser.until(&format!("{state} === '7 fields still to fill in'")).await;
        for (pointer, typed) in [
            ("/design/normal_module_mm", "4 mm"),
            ("/design/pinion/teeth", "23"),
            ("/design/gear/teeth", "71"),
            ("/design/gear/inertia_kg_m2", "0,5 kg m2"),
            ("/design/helix_angle_deg", "77"),
            ("/design/face_width_mm", "60,0"),
            ("/design/gap_width_mm", "20"),
            ("/operation/pinion_speed_rpm", "1 500 rpm"),
            ("/operation/pinion_torque_nm", "600"),
        ] {
            tab_to(browser, &format!("[data-pointer='{pointer}'] input")).await;
            type_over(browser, typed).await;
            // In a field Enter submits nothing.
            press(browser, Key::Enter).await;
        }
        browser.until(&format!("{state} === '1 field needs attention'")).await;
        assert_eq!(browser.text("[data-pointer='/operation/pinion_speed_rpm'] .read").await, "read as 1500");
        tab_to(browser, "#check-problems a").await;
        press(browser, Key::Enter).await;
        browser
            .until("document.activeElement.closest('[data-pointer]')?.dataset.pointer === '/design/helix_angle_deg'")
            .await;
        type_over(browser, "30°").await;
        browser.until(GOOD).await;
        tab_to(browser, "[data-pointer='/design/face_width_mm'] input").await;
        type_over(browser, "65").await;
        browser.until(&format!("{state}.includes('1 value of another geometry')")).await;
        tab_to(browser, "#submit").await;
        press(browser, Key::Enter).await;
        browser.until("document.activeElement.id === 'problems'").await;
        assert_eq!(browser.value("location.pathname").await, json!("/"));
        tab_to(browser, "#problems .actions button").await;
        press(browser, Key::Enter).await;
        browser.until("location.pathname.startsWith('/jobs/')").await;
        let accepted = document_of(browser).await;
        let (design, operation) = (&accepted["design"], &accepted["operation"]);
        assert_eq!((&design["helix_angle_deg"], &design["face_width_mm"]), (&json!(30), &json!(65)));
        assert_eq!((&design["gear"]["inertia_kg_m2"], &operation["pinion_speed_rpm"]), (&Value::Null, &json!(1500)));
    })
    .await;
}

/// A rule between two fields, broken and mended by keyboard.
#[tokio::test]
async fn a_broken_rule_leads_to_both_fields_by_keyboard() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until(GOOD).await;
        let error =
            |pointer: &str| format!("document.querySelector(\"[data-pointer='{pointer}'] .error\").textContent");
        let (width, gap) = ("/design/pinion/face_width_mm", "/design/gap_width_mm");
        tab_to(browser, &format!("[data-pointer='{gap}'] input")).await;
        type_over(browser, "20").await;
        tab_to(browser, &format!("[data-pointer='{width}'] input")).await;
        type_over(browser, "90 mm").await;
        browser.until(GOOD).await;
        browser.driver.action_chain().key_down(Key::Shift).perform().await.unwrap();
        for _ in 0..MANY {
            press(browser, Key::Tab).await;
            if browser.value(&format!("document.activeElement.matches(\"[data-pointer='{gap}'] input\")")).await
                == json!(true)
            {
                break;
            }
        }
        browser.driver.action_chain().key_up(Key::Shift).perform().await.unwrap();
        type_over(browser, "5").await;
        browser.until(&format!("{}.startsWith('with this value, Face width, pinion')", error(gap))).await;
        tab_to(browser, &format!("[data-pointer='{gap}'] .error a")).await;
        press(browser, Key::Enter).await;
        browser
            .until(&format!("document.activeElement.closest('[data-pointer]')?.dataset.pointer === '{width}'"))
            .await;
        type_over(browser, "70").await;
        browser.until(GOOD).await;
        assert_eq!(browser.value(&error(gap)).await, json!(""));
    })
    .await;
}
