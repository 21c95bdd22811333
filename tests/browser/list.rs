//! The list of jobs: live, filtered, in the address, with several jobs at once.

use crate::browser::{Browser, flow};
use crate::job::{submit, succeeded};
use serde_json::{Value, json};
use thirtyfour::prelude::*;

/// A document of a job that takes no time.
fn quick(name: &str, label: &str) -> Value {
    let mut document: Value = serde_json::from_str(include_str!("../../examples/table1.json")).unwrap();
    document["kind"] = json!("mesh");
    document["model"]["mesh_stiffness"] = json!({"source": "iso6336"});
    document["model"]["impact"] = json!({"source": "none"});
    document["name"] = json!(name);
    document["label"] = json!(label);
    document
}

/// A document of a job that takes long, in many small steps.
fn long(name: &str) -> Value {
    let mut document = quick(name, "long");
    document["kind"] = json!("sweep");
    document["analysis"] = json!({"method": "integrate", "mesh_periods": 40, "record_mesh_periods": 20});
    document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 300, "to": 6000, "points": 100_000}]);
    document
}

/// Submits a document from within the page that is open, as another program would; the job's id.
pub(crate) async fn post(browser: &Browser, document: &Value) -> String {
    let script = "const done = arguments[1]; fetch('/api/v1/jobs', {method: 'POST', body: arguments[0], \
                  headers: {'Content-Type': 'application/json'}}).then((answer) => answer.json()).then(done, (error) => done(String(error)));";
    let job = browser.driver.execute_async(script, vec![json!(document.to_string())]).await.unwrap().json().clone();
    job["id"].as_str().unwrap_or_else(|| panic!("{job}")).to_owned()
}

fn row(id: &str) -> String {
    format!("tr[data-id='{id}']")
}

async fn shown(browser: &Browser, id: &str) {
    browser.until(&format!("document.querySelector(\"{}\")", row(id))).await;
}

async fn not_shown(browser: &Browser, id: &str) {
    browser.until(&format!("!document.querySelector(\"{}\")", row(id))).await;
}

async fn click(browser: &Browser, selector: &str) {
    browser.element(selector).await.click().await.unwrap();
}

async fn in_state(browser: &Browser, id: &str, state: &str) {
    browser.until(&format!("document.querySelector(\"{} .badge\")?.textContent === '{state}'", row(id))).await;
}

#[tokio::test]
async fn a_job_is_listed_cloned_and_deleted_after_a_question() {
    flow(async |browser| {
        browser.open("/").await;
        browser.choose("[data-pointer='/kind'] select", "mesh").await;
        // Text of a user's never becomes part of the page's code.
        browser.fill("/name", "<img src=x onerror=alert(1)> & \"co\"").await;
        browser.fill("/label", "browser").await;
        let id = submit(browser).await;
        succeeded(browser).await;
        assert_eq!(browser.text("h1").await, "<img src=x onerror=alert(1)> & \"co\"");

        click(browser, "nav a[href='/jobs']").await;
        shown(browser, &id).await;
        let text = browser.text(&row(&id)).await;
        assert!(text.contains("<img src=x") && text.contains("succeeded") && text.contains("mesh"), "{text}");

        // Clone: the form with the job's document.
        click(browser, &format!("{} a[href^='/?from=']", row(&id))).await;
        browser.until("location.pathname === '/'").await;
        browser.until("document.querySelector(\"[data-pointer='/label'] input\")?.value === 'browser'").await;
        browser.driver.back().await.unwrap();
        shown(browser, &id).await;

        // Escape keeps it, as does the button that has the focus.
        let delete = format!("{} .row-actions button:not([hidden])", row(&id));
        click(browser, &delete).await;
        browser.until("document.querySelector('#confirm').open").await;
        assert_eq!(browser.value("document.activeElement.id").await, json!("confirm-no"));
        assert!(browser.text("#confirm").await.contains("<img src=x"));
        click(browser, "#confirm-no").await;
        browser.until("!document.querySelector('#confirm').open").await;
        assert_eq!(browser.fetch(&format!("/api/v1/jobs/{id}")).await["state"], json!("succeeded"));
        click(browser, &delete).await;
        click(browser, "#confirm-yes").await;
        not_shown(browser, &id).await;
        browser.until("document.querySelector('#empty').textContent.includes('No jobs yet')").await;
        assert_eq!(browser.value("document.querySelector('#notice').hidden").await, json!(true));
    })
    .await;
}

#[tokio::test]
async fn the_list_follows_jobs_without_a_reload_and_leaves_focus_and_selection_alone() {
    flow(async |browser| {
        browser.open("/jobs").await;
        browser.until("document.querySelector('#mode').textContent === 'Live'").await;
        browser.value("(window.same = true)").await;
        let first = post(browser, &quick("first", "")).await;
        in_state(browser, &first, "succeeded").await;
        let select = format!("{} input", row(&first));
        click(browser, &select).await;
        let running = post(browser, &long("long")).await;
        in_state(browser, &running, "running").await;
        browser.until(&format!("document.querySelector(\"{} progress\").value > 0", row(&running))).await;
        let above = browser.value("document.querySelector('#jobs tbody tr').dataset.id").await;
        assert_eq!(above, json!(running), "the newest comes first");
        let kept = format!("document.activeElement === document.querySelector(\"{select}\") && document.activeElement.checked");
        assert_eq!(browser.value(&kept).await, json!(true));

        // Whoever has the button that goes keeps a place in the row.
        click(browser, &format!("{} .row-actions button:not([hidden])", row(&running))).await;
        in_state(browser, &running, "canceled").await;
        // Where both ended within a second, they are announced together.
        browser.until("['long canceled', '2 jobs ended'].includes(document.querySelector('#announcement').textContent)").await;

        // Another hand deletes it.
        let script = "const done = arguments[1]; fetch('/api/v1/jobs/' + arguments[0], {method: 'DELETE'}).then(() => done(true));";
        browser.driver.execute_async(script, vec![json!(running)]).await.unwrap();
        not_shown(browser, &running).await;
        assert_eq!(browser.value("document.querySelectorAll('#jobs tbody tr').length").await, json!(1));
        assert_eq!(browser.value("window.same").await, json!(true));
    })
    .await;
}

#[tokio::test]
async fn without_a_stream_the_list_is_asked_for_again_and_again() {
    flow(async |browser| {
        browser.open("/jobs").await;
        browser.until("document.querySelector('#mode').textContent === 'Live'").await;
        browser.value("delete window.EventSource").await;
        browser.choose("#filter-kind", "sweep").await;
        browser.until("document.querySelector('#mode').dataset.mode === 'polling'").await;
        let id = post(browser, &long("long")).await;
        in_state(browser, &id, "running").await;
        click(browser, &format!("{} .row-actions button:not([hidden])", row(&id))).await;
        in_state(browser, &id, "canceled").await;
    })
    .await;
}

#[tokio::test]
async fn filters_and_pages_stand_in_the_address() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let mut ids = Vec::new();
        for number in 0..28 {
            ids.push(post(browser, &quick(&format!("number {number}"), if number < 2 { "a b,c" } else { "" })).await);
        }
        let running = post(browser, &long("long")).await;
        in_state(browser, &running, "running").await;

        // Older jobs on a page of their own; what comes meanwhile does not push them on.
        browser.until("document.querySelector('#jobs tbody tr:nth-child(26)')").await;
        browser.open("/jobs").await;
        shown(browser, &running).await;
        click(browser, "#older").await;
        shown(browser, &ids[0]).await;
        assert_eq!(browser.value("document.querySelectorAll('#jobs tbody tr').length").await, json!(4));
        assert_eq!(browser.value("new URLSearchParams(location.search).has('cursor')").await, json!(true));
        browser.until("document.querySelector('#mode').textContent === 'Live'").await;
        let late = post(browser, &quick("late", "")).await;
        browser.until("document.querySelector('#new-jobs').textContent.startsWith('1 new job')").await;
        browser.driver.refresh().await.unwrap();
        shown(browser, &ids[0]).await;
        assert_eq!(browser.value("document.querySelectorAll('#jobs tbody tr').length").await, json!(4));
        click(browser, "#newer").await;
        shown(browser, &late).await;

        // Two states and a label, shared as an address.
        click(browser, "#filters [value=running]").await;
        browser.until("location.search === '?state=running'").await;
        not_shown(browser, &late).await;
        shown(browser, &running).await;
        click(browser, "#filters [value=succeeded]").await;
        browser.element("#filter-label").await.send_keys("a b,c").await.unwrap();
        browser.until("document.querySelectorAll('#jobs tbody tr').length === 2").await;
        browser.until("location.search === '?state=running,succeeded&label=a+b%2Cc' || location.search === '?state=running,succeeded&label=a+b,c'").await;
        assert_eq!(browser.value("document.querySelectorAll('#labels option').length").await, json!(2));
        browser.driver.refresh().await.unwrap();
        browser.until("document.querySelectorAll('#jobs tbody tr').length === 2").await;
        let state = "[...document.querySelectorAll('#filters :checked')].filter((box) => box.name === 'state').map((box) => box.value)";
        assert_eq!(browser.value(state).await, json!(["running", "succeeded"]));
        browser.element("#filter-label").await.clear().await.unwrap();
        browser.choose("#filter-kind", "sweep").await;
        browser.until("document.querySelectorAll('#jobs tbody tr').length === 1").await;
        browser.driver.back().await.unwrap();
        browser.until("document.querySelector('#filter-kind').value === ''").await;

        // Several at once: what has not ended is canceled first.
        browser.open("/jobs?label=a+b%2Cc").await;
        shown(browser, &ids[1]).await;
        assert_eq!(browser.value("document.querySelector('#compare').disabled").await, json!(true));
        click(browser, "#select-all").await;
        assert_eq!(browser.text("#selected").await, "2 selected");
        assert_eq!(browser.value("document.querySelector('#compare').disabled").await, json!(false));
        click(browser, "#clear-filters").await;
        shown(browser, &running).await;
        click(browser, &format!("{} input", row(&running))).await;
        browser.until("document.querySelector('#selected').textContent === '3 selected, 2 of them not on this page'").await;
        click(browser, "#cancel-selected").await;
        click(browser, "#confirm-yes").await;
        in_state(browser, &running, "canceled").await;
        click(browser, "#delete-selected").await;
        browser.until("document.querySelector('#confirm-title').textContent === 'Delete 3 jobs?'").await;
        click(browser, "#confirm-yes").await;
        not_shown(browser, &running).await;
        browser.until("document.querySelector('#selected').textContent === 'None selected'").await;
        let gone = browser.fetch(&format!("/api/v1/jobs/{}", ids[0])).await;
        assert_eq!(gone["status"], json!(404));
    })
    .await;
}

#[tokio::test]
async fn among_many_jobs_one_is_found_sorted_and_described() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let mut ids = Vec::new();
        for number in 0..60 {
            ids.push(post(browser, &quick(&format!("variant {number:02} of the gearbox"), "study")).await);
        }
        let mut loud: Value = serde_json::from_str(include_str!("../../examples/table1.json")).unwrap();
        loud["name"] = json!("Überlast");
        let loud = browser.solved(&loud).await;
        let mut quiet: Value = serde_json::from_str(include_str!("../../examples/contact.json")).unwrap();
        quiet["name"] = json!("Quiet");
        let quiet = browser.solved(&quiet).await;
        let rows = "document.querySelectorAll('#jobs tbody tr').length";
        let place = "document.querySelector('#place').textContent";
        browser.until(&format!("{place} === '1 to 25 of 62 jobs'")).await;
        // Part of a name, in upper or lower case, in the address too.
        browser.element("#filter-search").await.send_keys("ARIANT 07").await.unwrap();
        browser.until(&format!("{rows} === 1 && {place} === '1 job fit the filters'")).await;
        browser.until("location.search === '?search=ARIANT+07'").await;
        shown(browser, &ids[7]).await;
        click(browser, "#clear-filters").await;
        browser.until(&format!("{place} === '1 to 25 of 62 jobs'")).await;
        browser.choose("#page-size", "50").await;
        browser.until(&format!("{rows} === 50 && location.search === '?limit=50'")).await;
        click(browser, "#older").await;
        browser.until(&format!("{place} === '51 to 62 of 62 jobs' && {rows} === 12")).await;
        // Sorted by a headline number, by the head of its column; jobs without one come last.
        click(browser, "th[data-sort^='mesh_circ'] button").await;
        let first = "document.querySelector('#jobs tbody tr')?.dataset.id";
        browser.until(&format!("{first} === '{loud}'")).await;
        let sorted = "document.querySelector(\"th[data-sort^='mesh_circ']\").getAttribute('aria-sort')";
        assert_eq!(browser.value(sorted).await, json!("descending"));
        let shown_rms = browser.text(&format!("{} td.value", row(&loud))).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{loud}/result")).await;
        let rms = result["response"]["rms"]["mesh_circumferential_acceleration_m_s2"]["left"].as_f64().unwrap();
        assert!((shown_rms.parse::<f64>().unwrap() / rms - 1.0).abs() < 1e-3, "{shown_rms} for {rms}");
        click(browser, "th[data-sort^='mesh_circ'] button").await;
        browser.until(&format!("{first} === '{quiet}'")).await;
        assert_eq!(browser.value(sorted).await, json!("ascending"));
        browser.driver.refresh().await.unwrap();
        browser.until(&format!("{first} === '{quiet}'")).await;

        // Another tab on the newest jobs sees what is changed and deleted here.
        let here = browser.driver.window().await.unwrap();
        let there = browser.driver.new_tab().await.unwrap();
        browser.driver.switch_to_window(there.clone()).await.unwrap();
        browser.open("/jobs").await;
        browser.until(&format!("{place} === '1 to 25 of 62 jobs'")).await;
        browser.driver.switch_to_window(here).await.unwrap();
        // By keyboard.
        browser.element(&format!("{} .describe-job", row(&quiet))).await.send_keys(Key::Enter).await.unwrap();
        browser.until("document.activeElement.id === 'describe-name'").await;
        browser.element("#describe-name").await.clear().await.unwrap();
        browser.element("#describe-name").await.send_keys("Quieter").await.unwrap();
        browser.element("#describe-notes").await.send_keys("<b>checked</b> by Anna").await.unwrap();
        browser.element("#describe-label").await.send_keys(Key::Enter).await.unwrap();
        browser.until(&format!("document.querySelector(\"{} a\").textContent === 'Quieter'", row(&quiet))).await;
        assert_eq!(browser.text(&format!("{} .notes", row(&quiet))).await, "<b>checked</b> by Anna");
        browser.element("#filter-search").await.send_keys("anna").await.unwrap();
        browser.until(&format!("{rows} === 1 && {first} === '{quiet}'")).await;
        // On its own page as well.
        click(browser, &format!("{} th a", row(&quiet))).await;
        browser.until("document.querySelector('#notes').textContent === '<b>checked</b> by Anna'").await;
        click(browser, "#describe").await;
        browser.until("document.activeElement.id === 'describe-name'").await;
        browser.element("#describe-notes").await.clear().await.unwrap();
        browser.element("#describe-notes").await.send_keys("by Anna and Bert").await.unwrap();
        click(browser, ".describe .primary").await;
        browser.until("document.querySelector('#notes').textContent === 'by Anna and Bert'").await;
        browser.driver.back().await.unwrap();
        browser.until(&format!("{rows} === 1 && {first} === '{quiet}'")).await;
        // Deleted here, the place is filled there.
        click(browser, &format!("{} .row-actions button:not([hidden])", row(&quiet))).await;
        browser.until("document.querySelector('#confirm').open").await;
        click(browser, "#confirm-yes").await;
        browser.until(&format!("{place} === '0 jobs fit the filters'")).await;
        browser.driver.switch_to_window(there).await.unwrap();
        browser.until(&format!("{place} === '1 to 25 of 61 jobs' && {rows} === 25")).await;
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
        click(browser, "#cancel").await;
        browser.until("document.querySelector('#state').textContent === 'canceled'").await;
        assert_eq!(browser.value("document.querySelector('#cancel').hidden").await, json!(true));
    })
    .await;
}
