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

/// Every number on the pages goes through one function: what it writes must read back as the number.
#[tokio::test]
async fn numbers_are_written_to_the_digits_asked_for() {
    flow(async |browser| {
        browser.open("/nowhere").await;
        let cases = json!([
            [5859.98, 4, "5860"], [4010.2, 4, "4010"], [66.18003, 4, "66.18"], [20, 4, "20"], [19.999999999999993, 5, "20"],
            [100, 5, "100"], [100.4, 3, "100"], [12800, 5, "12\u{202f}800"], [1234567.8, 5, "1\u{202f}234\u{202f}568"],
            [-0.05, 4, "−0.05"], [0.03089845, 5, "0.030898"], [0.00175, 3, "0.00175"], [3.2e-8, 3, "3.2·10⁻⁸"], [1e9, 4, "1·10⁹"], [0, 4, "0"], [null, 4, "–"],
        ]);
        let script = "const done = arguments[1]; import('/assets/common/format.js').then(({number}) => \
                      done(arguments[0].map(([value, digits]) => number(value, digits))), (error) => done(String(error)));";
        let written = browser.driver.execute_async(script, vec![cases.clone()]).await.unwrap().json().clone();
        let expected: Vec<_> = cases.as_array().unwrap().iter().map(|case| case[2].clone()).collect();
        assert_eq!(written, json!(expected));
    })
    .await;
}
