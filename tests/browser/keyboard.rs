//! The pages without a pointer.

use crate::browser::{Browser, flow};
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
