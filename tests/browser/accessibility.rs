//! What axe-core finds on the pages: WCAG 2.2 to level AA and its best practices.

use crate::browser::{Browser, flow, flow_against};
use crate::pages;
use crate::server::Server;
use crate::{entry, shafts};
use serde_json::json;
use std::path::PathBuf;

const INSTALL: &str = "The accessibility check needs axe-core: run `scripts/prerequisites axe-core` (npm puts the pinned version into \
                       target/axe), or set AXE_CORE to the path of its axe.min.js.";

/// Rules by whose tags axe-core chooses; those of version 2.2 are off by default.
const TAGS: [&str; 7] = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22a", "wcag22aa", "best-practice"];

fn axe_core() -> String {
    let path = std::env::var_os("AXE_CORE").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/axe/node_modules/axe-core/axe.min.js"),
        PathBuf::from,
    );
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}. {INSTALL}", path.display()))
}

/// One rule that an element breaks.
struct Finding {
    rule: String,
    serious: bool,
    text: String,
}

/// What axe-core finds on the page that is open.
async fn findings(browser: &Browser, axe: &str) -> Vec<Finding> {
    let loaded = browser.value("Boolean(window.axe)").await == json!(true);
    if !loaded {
        browser.driver.execute(axe, Vec::new()).await.unwrap();
    }
    let script = "const done = arguments[1]; const rules = {'target-size': {enabled: true}}; \
                  axe.run(document, {runOnly: {type: 'tag', values: arguments[0]}, rules, resultTypes: ['violations']}) \
                  .then(({violations, passes}) => done({violations, passes: passes.length}), (error) => done(String(error)));";
    let outcome = browser.driver.execute_async(script, vec![json!(TAGS)]).await.unwrap().json().clone();
    assert!(outcome["passes"].as_u64() > Some(5), "axe-core checked nothing: {outcome}");
    let mut found = Vec::new();
    for violation in outcome["violations"].as_array().unwrap() {
        for node in violation["nodes"].as_array().unwrap() {
            let impact = node["impact"].as_str().or(violation["impact"].as_str()).unwrap_or("unknown");
            let rule = violation["id"].as_str().unwrap().to_owned();
            let summary = node["failureSummary"].as_str().unwrap_or_default().replace('\n', " ");
            let text = format!("{impact} {rule} at {}: {summary}", node["target"]);
            found.push(Finding { rule, serious: matches!(impact, "serious" | "critical"), text });
        }
    }
    found
}

/// The findings in light and dark, wide and narrow; each told once.
async fn everywhere(browser: &Browser, axe: &str, name: &str) -> Vec<Finding> {
    let mut all: Vec<Finding> = Vec::new();
    for width in [1280, 390] {
        browser.resize(width).await;
        for dark in [false, true] {
            browser.prefer_dark(dark).await;
            let scheme = if dark { "dark" } else { "light" };
            for finding in findings(browser, axe).await {
                let text = format!("{name}: {}", finding.text);
                if !all.iter().any(|known| known.text.starts_with(&text)) {
                    all.push(Finding { text: format!("{text} ({scheme}, {width} px)"), ..finding });
                }
            }
        }
    }
    browser.prefer_dark(false).await;
    browser.resize(1280).await;
    all
}

/// Nothing serious or critical; what else there is, is printed.
fn accept(found: &[Finding]) {
    for finding in found {
        println!("{}", finding.text);
    }
    let serious: Vec<_> = found.iter().filter(|finding| finding.serious).map(|finding| finding.text.as_str()).collect();
    assert!(serious.is_empty(), "{} serious findings:\n{}", serious.len(), serious.join("\n"));
}

#[tokio::test]
async fn no_page_has_a_serious_finding() {
    let axe = axe_core();
    flow(async |browser| {
        let mut found = Vec::new();
        for page in pages::all(browser).await {
            page.open(browser).await;
            found.extend(everywhere(browser, &axe, page.name).await);
        }
        accept(&found);
    })
    .await;
}

/// States of the form that it does not open with: an empty pair, problems, values of another geometry, the question
/// about them.
#[tokio::test]
async fn no_state_of_the_form_has_a_serious_finding() {
    let axe = axe_core();
    flow(async |browser| {
        let state = "document.querySelector('#check-state').textContent";
        entry::empty_pair(browser).await;
        let mut found = everywhere(browser, &axe, "empty pair").await;
        browser.choose("#start-from", "contact").await;
        browser.until(&format!("{state}.startsWith('Can be solved')")).await;
        browser.fill("/design/face_width_mm", "60").await;
        browser.until(&format!("{state}.includes('of another geometry')")).await;
        browser.click("#changes-title").await;
        browser.click("#submit").await;
        browser.until("document.querySelector('#problems .actions')").await;
        found.extend(everywhere(browser, &axe, "values of another geometry").await);
        browser.fill("/design/pinion/face_width_mm", "900").await;
        browser.fill("/design/gear/teeth", "many").await;
        browser.until(&format!("{state}.includes('2 fields need attention')")).await;
        found.extend(everywhere(browser, &axe, "problems").await);
        accept(&found);
    })
    .await;
}

/// The section of the shafts: a few numbers, then lists of segments and bearings with a mistake in one.
#[tokio::test]
async fn no_state_of_the_shafts_has_a_serious_finding() {
    let axe = axe_core();
    flow(async |browser| {
        shafts::open_section(browser).await;
        browser.choose(shafts::CHOICE, "arrangement").await;
        browser.until("!document.querySelector('#shafts-take-over').hidden").await;
        let mut found = everywhere(browser, &axe, "shafts from a few numbers").await;
        browser.click("#shafts-edit").await;
        browser.until("document.querySelector('#shafts-take-over').hidden").await;
        browser.value("document.querySelector('.inner-list').open = true").await;
        browser.click(".inner-list [data-act=add]").await;
        browser.until("document.querySelectorAll('[aria-invalid=true]').length > 0").await;
        // What stays in sight at the edges of the window lies over what happens to stand there after scrolling.
        browser.value("(document.activeElement.blur(), window.scrollTo(0, 0))").await;
        found.extend(everywhere(browser, &axe, "shafts segment by segment").await);
        accept(&found);
    })
    .await;
}

#[tokio::test]
async fn the_login_page_has_no_serious_finding() {
    let axe = axe_core();
    flow_against(
        || Server::start_with_token("a-token-for-axe-core"),
        async |browser| {
            browser.open("/jobs").await;
            let mut found = everywhere(browser, &axe, "login").await;
            browser.element("#token").await.send_keys("not-the-token-at-all").await.unwrap();
            browser.click("main button").await;
            browser.until("document.querySelector('[role=alert]')").await;
            found.extend(everywhere(browser, &axe, "login refused").await);
            accept(&found);
        },
    )
    .await;
}

/// The check can fail: a page that was spoilt on purpose.
#[tokio::test]
async fn a_spoilt_page_has_serious_findings() {
    let axe = axe_core();
    flow(async |browser| {
        browser.open("/nowhere").await;
        assert!(findings(browser, &axe).await.iter().all(|finding| !finding.serious));
        let spoil = "document.querySelector('h1').style.color = '#ccc'; document.querySelector('main').append(document.createElement('input'));";
        browser.driver.execute(spoil, Vec::new()).await.unwrap();
        let found = findings(browser, &axe).await;
        let mut rules: Vec<_> = found.iter().filter(|finding| finding.serious).map(|finding| finding.rule.as_str()).collect();
        rules.sort_unstable();
        assert_eq!(rules, ["color-contrast", "label"]);
    })
    .await;
}
