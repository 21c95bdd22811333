//! The list of jobs.

use crate::browser::flow;
use crate::job::{submit, succeeded};
use serde_json::json;

#[tokio::test]
async fn a_job_is_listed_filtered_and_deleted() {
    flow(async |browser| {
        browser.open("/").await;
        browser.choose("[data-pointer='/kind'] select", "mesh").await;
        // Text of a user's never becomes part of the page's code.
        browser.fill("/name", "<img src=x onerror=alert(1)> & \"co\"").await;
        browser.fill("/label", "browser").await;
        let id = submit(browser).await;
        succeeded(browser).await;
        assert_eq!(browser.text("h1").await, "<img src=x onerror=alert(1)> & \"co\"");

        browser.element("nav a[href='/jobs']").await.click().await.unwrap();
        let row = format!("tr[data-id='{id}']");
        browser.until(&format!("document.querySelector(\"{row}\")")).await;
        let text = browser.text(&row).await;
        assert!(text.contains("<img src=x") && text.contains("succeeded") && text.contains("mesh"), "{text}");
        browser.choose("#filter-kind", "sweep").await;
        browser.until(&format!("!document.querySelector(\"{row}\")")).await;
        browser.choose("#filter-kind", "").await;
        browser.until(&format!("document.querySelector(\"{row}\")")).await;
        browser.element(&format!("{row} button")).await.click().await.unwrap();
        browser.until(&format!("!document.querySelector(\"{row}\")")).await;
        assert_eq!(browser.value("document.querySelector('#notice').hidden").await, json!(true));
    })
    .await;
}

#[tokio::test]
async fn a_long_job_can_be_canceled() {
    flow(async |browser| {
        browser.open("/").await;
        browser.choose("[data-pointer='/kind'] select", "sweep").await;
        browser.fill("/axes/0/pointer", "/operation/pinion_speed_rpm").await;
        browser.fill("/axes/0/from", "300").await;
        browser.fill("/axes/0/to", "6000").await;
        browser.fill("/axes/0/points", "20000").await;
        browser.choose("[data-pointer='/analysis/method'] select", "integrate").await;
        submit(browser).await;
        browser.until("!document.querySelector('#cancel').hidden").await;
        browser.until("document.querySelector('#state').textContent === 'running'").await;
        browser.until("document.querySelector('#progress').value > 0").await;
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("document.querySelector('#state').textContent === 'canceled'").await;
        assert_eq!(browser.value("document.querySelector('#cancel').hidden").await, json!(true));
    })
    .await;
}
