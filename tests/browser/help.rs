//! The help: from a number on a page to its formula, its source and its validation; without scripts and offline.

use crate::browser::{Browser, flow};
use serde_json::{Value, json};
use thirtyfour::prelude::*;

async fn solved(browser: &Browser) -> String {
    browser.open("/nowhere").await;
    let example: Value = serde_json::from_str(include_str!("../../examples/table1.json")).unwrap();
    browser.solved(&example).await
}

#[tokio::test]
async fn every_row_leads_to_its_formula_source_and_validation() {
    flow(async |browser| {
        let id = solved(browser).await;
        browser.open(&format!("/jobs/{id}")).await;
        browser.until("document.querySelector('[data-ready]')").await;
        // Every row of these sections that shows a number of the result has its help.
        for section in ["geometry-values", "mesh-values", "impact-values", "response-values", "numerics-values"] {
            let rows = browser.value(&format!("document.querySelectorAll('#{section} > div').length")).await;
            let explained = browser.value(&format!("document.querySelectorAll('#{section} dt details.tip a').length")).await;
            assert!(rows.as_u64() > Some(5), "{section}: {rows} rows");
            // The input hash has no section of the theory.
            let without = if section == "numerics-values" { 1 } else { 0 };
            assert_eq!(explained.as_u64().unwrap() + without, rows.as_u64().unwrap(), "{section}");
        }
        // By keyboard: the "?" opens, its link leads to the section.
        let summary = browser.element("#mesh-values div:nth-of-type(3) summary").await;
        assert_eq!(summary.attr("aria-label").await.unwrap().unwrap(), "What is: Mesh stiffness of one half, mean?");
        summary.focus().await.unwrap();
        summary.send_keys(Key::Enter).await.unwrap();
        browser.until("document.querySelector('#mesh-values details.tip[open] a')").await;
        summary.send_keys(Key::Tab).await.unwrap();
        browser.until("document.activeElement.matches('#mesh-values details.tip[open] a')").await;
        browser.element("#mesh-values details.tip[open] a").await.send_keys(Key::Enter).await.unwrap();
        browser.until("location.pathname === '/help/theory/contact' && location.hash === '#mesh-stiffness'").await;
        browser.until("document.querySelector('h2#mesh-stiffness')?.textContent === 'Mesh stiffness'").await;
        assert!(browser.value("document.querySelectorAll('math mfrac').length").await.as_u64() > Some(3));
        let checks = "[...document.querySelectorAll('a[href=\"/help/validation/tables/contact#loaded-pair-2967-against-finite-elements\"] + .muted')][0].textContent";
        assert!(browser.value(checks).await.as_str().unwrap().contains("36 checks"));
        // On to the numbers that were measured.
        browser.element("a[href='/help/validation/tables/contact#loaded-pair-2967-against-finite-elements']").await.click().await.unwrap();
        browser.until("document.getElementById('loaded-pair-2967-against-finite-elements')?.matches('h2:target')").await;
    })
    .await;
}

#[tokio::test]
async fn the_numbers_the_inputs_and_the_source_are_found_from_every_page() {
    flow(async |browser| {
        browser.open("/jobs").await;
        browser.element("nav[aria-label='Pages'] a[href='/help']").await.click().await.unwrap();
        browser.until("location.pathname === '/help'").await;
        browser.element("article a[href='/help/results']").await.click().await.unwrap();
        let served = "document.querySelectorAll('.terms > div').length";
        browser.until(&format!("{served} > 150")).await;
        assert!(browser.text("#response-dynamic_factor").await.contains("Never below 1"));
        assert!(browser.text("#mesh-transmission_error_pp_um dt").await.ends_with("µm"));
        browser.element("#response-dynamic_factor a").await.click().await.unwrap();
        browser.until("location.hash === '#tooth-force-and-dynamic-factor'").await;
        browser.element(".contents a[href='/help/inputs']").await.click().await.unwrap();
        browser.until("document.getElementById('design-helix_angle_deg')").await;
        let helix = browser.text("#design-helix_angle_deg").await;
        assert!(helix.contains("0 to 50 °") && helix.contains("required"), "{helix}");
        browser.element(".contents a[href='/help/theory/source']").await.click().await.unwrap();
        browser.until("document.querySelector('h2#zhou-2008')").await;
        // The description of the interface has a way back.
        browser.open("/docs").await;
        browser.until("document.querySelectorAll('.opblock').length > 10").await;
        browser.element("nav[aria-label='Pages'] a[href='/jobs']").await.click().await.unwrap();
        browser.until("location.pathname === '/jobs'").await;
        assert_eq!(browser.value("document.querySelector('h1').textContent").await, json!("Jobs"));
    })
    .await;
}
