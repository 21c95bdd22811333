//! Sweeps: from the form to curves, maps and the response of one point.

use crate::browser::flow;
use crate::job::{submit, succeeded};
use serde_json::json;

#[tokio::test]
async fn a_sweep_goes_from_the_form_to_its_curves_and_table() {
    flow(async |browser| {
        browser.open("/").await;
        browser.choose("[data-pointer='/kind'] select", "sweep").await;
        browser.fill("/axes/0/pointer", "/operation/pinion_speed_rpm").await;
        browser.fill("/axes/0/from", "1000").await;
        browser.fill("/axes/0/to", "3000").await;
        browser.fill("/axes/0/points", "5").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        let id = submit(browser).await;
        succeeded(browser).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        assert_eq!(result["sweep"]["points"].as_array().map(Vec::len), Some(5));
        assert_eq!(
            browser.value("document.querySelectorAll('#sweep-plot .scatterlayer .trace').length").await,
            json!(2)
        );
        browser.element("#sweep-details > summary").await.click().await.unwrap();
        browser.until("document.querySelectorAll('#sweep-table tbody tr').length === 5").await;
    })
    .await;
}
