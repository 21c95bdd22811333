//! The page of the service itself. Workers on other machines are put into the answer, as they need NATS.

use crate::browser::{Browser, flow};
use serde_json::{Value, json};

/// Gives the page another answer of `GET /api/v1/system` from now on: the real one with these members.
async fn answer(browser: &Browser, members: Value) {
    let script = "const members = arguments[0]; \
                  window.realFetch ??= window.fetch; \
                  window.fetch = async (address, options) => { \
                    const response = await window.realFetch(address, options); \
                    if (!String(address).endsWith('/system')) return response; \
                    const answer = await response.json(); \
                    Object.assign(answer.queue, members.queue); \
                    return new Response(JSON.stringify({...answer, ...members, queue: answer.queue})); \
                  };";
    browser.driver.execute(script, vec![members]).await.unwrap();
}

fn worker(id: &str, silent_s: f64, lost: bool, running: Value) -> Value {
    json!({
        "id": id, "host": "node-7", "version": "0.1.0", "solver_version": "0.1.0-9", "slots": 2,
        "last_beat_at": "2026-01-01T00:00:00Z", "silent_s": silent_s, "lost": lost, "running": running,
    })
}

#[tokio::test]
async fn a_service_without_workers_says_where_it_computes() {
    flow(async |browser| {
        browser.open("/").await;
        browser.element("header a[href='/system']").await.click().await.unwrap();
        browser.until("document.querySelectorAll('#service dt').length === 6").await;
        assert!(browser.text("#workers-note").await.contains("computes in its own process"));
        assert_eq!(browser.text("#waiting").await, "Nothing waits.");
        assert_eq!(browser.value("document.querySelector('#workers-scroll').hidden").await, json!(true));
        assert_eq!(browser.value("document.querySelector('#unconnected').hidden").await, json!(true));
        assert!(browser.text("#service").await.contains(env!("CARGO_PKG_VERSION")));
    })
    .await;
}

#[tokio::test]
async fn workers_are_shown_with_what_they_do_and_what_waits_why() {
    flow(async |browser| {
        browser.open("/system").await;
        browser.until("document.querySelectorAll('#service dt').length === 6").await;
        let chunk =
            json!([{"job": "0193a1f0-0000-7000-8000-00000012abcd", "chunk": 4, "stage": "sweep", "fraction": 0.375}]);
        let (nats, workers) = (
            json!({"transport": "nats", "connected": true, "ack_wait_s": 30, "depth": 3}),
            json!({"total": 4, "busy": 4, "sweeps_total": 1, "sweeps_busy": 1}),
        );
        let waiting =
            json!([{"solver": "0_1_0-9", "chunks": 5, "slots": 4}, {"solver": "0_0_1-1", "chunks": 1, "slots": 0}]);
        let machines = json!([worker("first", 0.4, false, chunk.clone()), worker("second", 3.0, false, json!([]))]);
        answer(browser, json!({"queue": nats, "workers": workers, "machines": machines, "waiting_work": waiting}))
            .await;
        browser.until("document.querySelectorAll('#workers tbody tr').length === 2").await;
        let row = browser.text("#workers tbody tr:first-child").await;
        for words in ["first", "node-7", "0.1.0", "…12abcd, part 5: sweep 38 %"] {
            assert!(row.contains(words), "{words}: {row}");
        }
        assert!(browser.text("#workers tbody tr:nth-child(2)").await.contains("nothing"));
        let link = browser.value("document.querySelector('#workers tbody a').getAttribute('href')").await;
        assert_eq!(link, json!("/jobs/0193a1f0-0000-7000-8000-00000012abcd"));
        let reasons = browser.text("#waiting").await;
        for words in [
            "5 parts of running jobs wait for calculation 0_1_0-9: all 4 threads are busy.",
            "1 part of running jobs waits for calculation 0_0_1-1: no worker of this version is there.",
            "3 jobs in the queue wait: those before them run first.",
        ] {
            assert!(reasons.contains(words), "{words}: {reasons}");
        }
        // The first one is killed: it is lost, and its work goes to the other.
        let machines = json!([worker("first", 21.0, true, chunk), worker("second", 0.2, false, json!([]))]);
        let nats = json!({"transport": "nats", "connected": true, "ack_wait_s": 30, "depth": 0});
        let idle = json!({"total": 2, "busy": 0, "sweeps_total": 1, "sweeps_busy": 1});
        answer(browser, json!({"queue": nats, "workers": idle, "machines": machines, "waiting_work": []})).await;
        browser.until("document.querySelector('#workers tr.lost')").await;
        let row = browser.text("#workers tr.lost").await;
        assert!(row.contains("lost: silent for 21 s") && row.contains("had:"), "{row}");
        assert_eq!(browser.text("#said").await, "1 worker left or lost.");
        let reasons = browser.text("#waiting").await;
        assert!(
            reasons.contains("1 part was with workers that are lost: another worker gets each after 30 s"),
            "{reasons}"
        );
        // Without NATS nothing moves.
        let cut = json!({"transport": "nats", "connected": false, "ack_wait_s": 30, "depth": 0});
        let waiting = json!([{"solver": "0_1_0-9", "chunks": 1, "slots": 2}]);
        answer(browser, json!({"queue": cut, "workers": idle, "machines": [], "waiting_work": waiting})).await;
        browser.until("!document.querySelector('#unconnected').hidden").await;
        assert!(browser.text("#waiting").await.contains("there is no connection to NATS."));
        assert!(browser.text("#workers-note").await.contains("herringbone worker --nats"));
    })
    .await;
}
