//! Pages of live jobs: through a proxy that holds back events, and with a server that dies and comes back.

use crate::browser::{Browser, flow, flow_against};
use crate::job::succeeded;
use crate::server::Server;
use serde_json::{Value, json};

/// A sweep of so many quick points.
fn sweep(points: u32) -> Value {
    let mut document: Value = serde_json::from_str(include_str!("../../examples/given_stiffness.json")).unwrap();
    document["kind"] = json!("sweep");
    document["name"] = json!("Speeds");
    document["analysis"] = json!({"accuracy": 1e-3});
    document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 3500, "to": 5500, "points": points}]);
    document
}

async fn open_job(browser: &Browser, document: &Value) -> String {
    browser.open("/jobs").await;
    let id = browser.submitted(document).await;
    browser.open(&format!("/jobs/{id}")).await;
    id
}

const MODE: &str = "document.querySelector('#mode').dataset.mode";

#[tokio::test]
async fn a_job_is_followed_through_a_proxy_that_holds_back_events() {
    flow_against(Server::behind_a_buffering_proxy, async |browser| {
        open_job(browser, &sweep(100_000)).await;
        browser.until(&format!("{MODE} === 'polling'")).await;
        let shown = "Number(document.querySelector('#progress').value)";
        browser.until(&format!("{shown} > 0")).await;
        let before = browser.value(shown).await;
        browser.until(&format!("{shown} > {before}")).await;
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("document.querySelector('#state').textContent === 'canceled'").await;
        assert!(!browser.element("#mode").await.is_displayed().await.unwrap());
        // A short job gets its result.
        open_job(browser, &sweep(2000)).await;
        succeeded(browser).await;
        browser.until("document.querySelector('#sweep-plot').dataset.points === '2000'").await;
    })
    .await;
}

#[tokio::test]
async fn the_tab_tells_progress_and_the_page_the_time_left() {
    flow(async |browser| {
        open_job(browser, &sweep(30_000)).await;
        browser.until(&format!("{MODE} === 'live'")).await;
        browser.until(r"/^[1-9]\d? % · Speeds · herringbone$/.test(document.title)").await;
        browser.until(r"/left$/.test(document.querySelector('#left').textContent)").await;
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("document.title === 'Speeds · herringbone'").await;
        assert_eq!(browser.text("#left").await, "");
    })
    .await;
}

#[tokio::test]
async fn a_lost_connection_is_said_and_the_page_goes_on_after_a_restart() {
    flow(async |browser| {
        let id = open_job(browser, &sweep(100_000)).await;
        browser.until("Number(document.querySelector('#progress').value) > 0").await;
        browser.server.kill();
        browser.until(&format!("{MODE} === 'lost'")).await;
        assert!(browser.text("#mode").await.contains("Connection lost"));
        browser.server.start_again();
        browser.until(&format!("{MODE} !== 'lost'")).await;
        browser.until("document.querySelector('#state').textContent === 'running'").await;
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("document.querySelector('#state').textContent === 'canceled'").await;
        let job = browser.fetch(&format!("/api/v1/jobs/{id}")).await;
        assert_eq!(job["state"], "canceled");
        // The refused connections stand in the console, and nothing else.
        let console = browser.console().await;
        let others: Vec<_> = console.iter().filter(|line| !line.contains("net::ERR_")).collect();
        assert!(others.is_empty(), "{others:?}");
    })
    .await;
}

#[tokio::test]
async fn the_end_is_notified_to_those_who_asked_and_to_nobody_else() {
    flow(async |browser| {
        // Notifications of the browser's own are not seen by a page: what the page asks for is written down.
        let spy = "window.asked = 0; window.told = []; \
                   window.Notification = class { constructor(title, options) { window.told.push([title, options.body]); } \
                   addEventListener() {} static permission = 'default'; \
                   static async requestPermission() { window.asked += 1; return (window.Notification.permission = 'granted'); } };";
        browser.command("Page.addScriptToEvaluateOnNewDocument", json!({"source": spy})).await;
        open_job(browser, &sweep(100_000)).await;
        browser.until("!document.querySelector('#notify').hidden").await;
        assert_eq!(browser.value("window.asked").await, json!(0));
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("document.querySelector('#state').textContent === 'canceled'").await;
        assert_eq!(browser.value("window.told").await, json!([]));
        assert_eq!(browser.value("document.querySelector('#notify').hidden").await, json!(true));

        open_job(browser, &sweep(90_000)).await;
        browser.until("!document.querySelector('#notify').hidden").await;
        browser.element("#notify").await.click().await.unwrap();
        browser.until("document.querySelector('#notify').getAttribute('aria-pressed') === 'true'").await;
        assert_eq!(browser.value("window.asked").await, json!(1));
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("window.told.length === 1").await;
        assert_eq!(browser.value("window.told").await, json!([["Speeds", "The job was canceled."]]));
    })
    .await;
}
