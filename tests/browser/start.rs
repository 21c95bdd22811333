//! Pages that need no job.

use crate::browser::flow;
use serde_json::json;

#[tokio::test]
async fn an_unknown_address_says_so_and_leads_back() {
    flow(async |browser| {
        browser.open("/nowhere").await;
        assert_eq!(browser.text("h1").await, "Nothing here");
        browser.element("main a[href='/jobs']").await.click().await.unwrap();
        browser.until("location.pathname === '/jobs'").await;
    })
    .await;
}

#[tokio::test]
async fn an_unknown_job_says_so() {
    flow(async |browser| {
        browser.open("/jobs/0193a1f0-0000-7000-8000-000000000000").await;
        browser.until("!document.querySelector('#notice').hidden").await;
        assert_eq!(browser.value("document.querySelector('#life').hidden").await, json!(true));
    })
    .await;
}

#[tokio::test]
async fn pages_fit_a_telephone() {
    flow(async |browser| {
        browser.driver.set_window_rect(0, 0, 390, 844).await.unwrap();
        for path in ["/", "/jobs", "/nowhere"] {
            browser.open(path).await;
            browser.until("document.readyState === 'complete'").await;
            let width = browser.value("document.documentElement.scrollWidth").await.as_i64().unwrap();
            let visible = browser.value("window.innerWidth").await.as_i64().unwrap();
            assert!(width <= visible, "{path} is {width} px wide in a window of {visible} px");
        }
    })
    .await;
}
