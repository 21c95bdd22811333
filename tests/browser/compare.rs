//! Jobs side by side.

use crate::browser::{Browser, flow};
use crate::list::post;
use serde_json::{Value, json};

fn example() -> Value {
    serde_json::from_str(include_str!("../../examples/table1.json")).unwrap()
}

async fn ended(browser: &Browser, id: &str) -> Value {
    let script = "const done = arguments[1]; fetch('/api/v1/jobs/' + arguments[0], {headers: {Prefer: 'wait=30'}})\
                  .then((answer) => answer.json()).then(done, (error) => done(String(error)));";
    let job = browser.driver.execute_async(script, vec![json!(id)]).await.unwrap().json().clone();
    assert_eq!(job["state"], json!("succeeded"), "{job}");
    browser.fetch(&format!("/api/v1/jobs/{id}/result")).await
}

/// A number as the page writes it, read back.
fn read_number(text: &str) -> f64 {
    let text = text.replace('\u{202f}', "").replace('−', "-");
    text.parse().unwrap_or_else(|_| panic!("{text:?} is not a number"))
}

/// A number of the table, and what is said of its difference.
async fn cell(browser: &Browser, name: &str, id: &str) -> (f64, String) {
    let place = format!("#numbers-table tr[data-name='{name}'] td[data-job='{id}']");
    let value = browser.value(&format!("document.querySelector(\"{place} .value\").textContent")).await;
    let by = browser.value(&format!("document.querySelector(\"{place} .by\")?.textContent ?? ''")).await;
    (read_number(value.as_str().unwrap()), by.as_str().unwrap().to_owned())
}

async fn traces(browser: &Browser, figure: &str) -> usize {
    let place = format!("document.querySelector('#{figure} .plot')");
    browser.value(&format!("{place}.scrollIntoView({{block: 'center'}})")).await;
    browser.until(&format!("{place}.querySelector('.plot-container')")).await;
    let named = browser.value(&format!("{place}.data.filter((trace) => trace.name).length")).await;
    named.as_u64().unwrap() as usize
}

fn near(shown: f64, reported: &Value) {
    let reported = reported.as_f64().unwrap();
    assert!((shown / reported - 1.0).abs() < 1e-4, "{shown} shown, {reported} reported");
}

#[tokio::test]
async fn two_jobs_are_compared_and_a_third_is_added() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let mut other = example();
        other["name"] = json!("helix 28, 1200 N m");
        other["design"]["helix_angle_deg"] = json!(28);
        other["operation"]["pinion_torque_nm"] = json!(1200);
        let mut faster = example();
        faster["name"] = json!("faster");
        faster["operation"]["pinion_speed_rpm"] = json!(3000);
        let (a, b) = (post(browser, &example()).await, post(browser, &other).await);
        let c = post(browser, &faster).await;
        let (first, second) = (ended(browser, &a).await, ended(browser, &b).await);
        let third = ended(browser, &c).await;

        // From the list: two boxes and a button.
        for id in [&b, &a] {
            browser.element(&format!("tr[data-id='{id}'] input")).await.click().await.unwrap();
        }
        browser.element("#compare").await.click().await.unwrap();
        browser.until("location.pathname === '/compare'").await;
        browser.open(&format!("/compare?jobs={a},{b}")).await;
        browser.until(&format!("document.querySelector('#compare').dataset.ready === '{a},{b}'")).await;

        // The inputs that differ, and only these.
        let pointers = "[...document.querySelectorAll('#inputs-table tbody tr')].map((row) => row.dataset.pointer)";
        let expected = json!(["/design/helix_angle_deg", "/operation/pinion_torque_nm"]);
        assert_eq!(browser.value(pointers).await, expected);
        let torque = browser.text("#inputs-table tr[data-pointer='/operation/pinion_torque_nm']").await;
        assert!(torque.contains("800") && torque.contains("1200") && torque.contains("N·m"), "{torque}");

        // The numbers are the API's; the differences are theirs.
        let rms = |result: &Value| result["response"]["rms"]["mesh_circumferential_acceleration_m_s2"]["left"].clone();
        let (shown, by) = cell(browser, "/response/rms/mesh_circumferential_acceleration_m_s2/{half}-both", &a).await;
        near(shown, &rms(&first));
        assert_eq!(by, "", "the reference");
        let (shown, by) = cell(browser, "/response/rms/mesh_circumferential_acceleration_m_s2/{half}-both", &b).await;
        near(shown, &rms(&second));
        let percent = 100.0 * (rms(&second).as_f64().unwrap() / rms(&first).as_f64().unwrap() - 1.0);
        let (relative, level) = by.split_once(" %, ").unwrap();
        let said = read_number(relative.trim_start_matches('+'));
        assert!((said / percent - 1.0).abs() < 1e-2, "{by}, and it is {percent} %");
        assert!(level.ends_with(" dB"), "{by}");
        for (name, part, field) in [
            ("/impact/force_n", "impact", "force_n"),
            ("/mesh/transmission_error_pp_um", "mesh", "transmission_error_pp_um"),
            ("/geometry/total_contact_ratio", "geometry", "total_contact_ratio"),
        ] {
            near(cell(browser, name, &b).await.0, &second[part][field]);
        }

        // Curves of both in every figure.
        for figure in ["stiffness", "error", "share", "impact", "series", "phase", "spectrum"] {
            assert_eq!(traces(browser, figure).await, 2, "{figure}");
        }
        let drawn = "document.querySelector('#stiffness .plot').data[1].y.slice(0, 3)";
        let reported = &second["mesh"]["curve"]["stiffness_n_per_um"];
        assert_eq!(browser.value(drawn).await, json!(reported.as_array().unwrap()[..3]));

        // A third one, by its name; the comparison stands in the address.
        browser.element("[data-act=add]").await.click().await.unwrap();
        browser.until("document.querySelectorAll('#picker-jobs button').length === 1").await;
        browser.element("#picker-search").await.send_keys("FAST").await.unwrap();
        browser.element("#picker-jobs button").await.click().await.unwrap();
        browser.until(&format!("document.querySelector('#compare').dataset.ready === '{a},{b},{c}'")).await;
        assert_eq!(
            browser.value("new URLSearchParams(location.search).get('jobs')").await,
            json!(format!("{a},{b},{c}"))
        );
        let expected = json!(["/design/helix_angle_deg", "/operation/pinion_speed_rpm", "/operation/pinion_torque_nm"]);
        assert_eq!(browser.value(pointers).await, expected);
        near(
            cell(browser, "/response/rms/mesh_circumferential_acceleration_m_s2/{half}-both", &c).await.0,
            &rms(&third),
        );
        for figure in ["error", "series", "spectrum"] {
            browser
                .until(&format!(
                    "document.querySelector('#{figure} .plot').data.filter((trace) => trace.name).length === 3"
                ))
                .await;
        }
        // Mesh periods of different length lie above each other.
        let ends = "document.querySelector('#series .plot').data.map((trace) => trace.x.at(-1))";
        assert_eq!(browser.value(ends).await, json!([2, 2, 2]));
        assert!(browser.text("#curves-note").await.contains("mesh frequencies differ"));

        // Another reference; then the first goes, and the way back leads to it.
        browser.element(&format!("[data-act='refer {b}']")).await.click().await.unwrap();
        browser.until(&format!("new URLSearchParams(location.search).get('reference') === '{b}'")).await;
        let (_, by) = cell(browser, "/response/rms/mesh_circumferential_acceleration_m_s2/{half}-both", &a).await;
        assert!(by.contains(" %"), "{by}");
        browser.element(&format!("[data-act='remove {a}']")).await.click().await.unwrap();
        browser.until(&format!("document.querySelector('#compare').dataset.ready === '{b},{c}'")).await;
        browser.driver.back().await.unwrap();
        browser.until(&format!("document.querySelector('#compare').dataset.ready === '{a},{b},{c}'")).await;
        assert_eq!(browser.value("document.querySelector('#notice').hidden").await, json!(true));
    })
    .await;
}

#[tokio::test]
async fn what_has_no_result_is_said_in_words_and_what_ends_appears() {
    flow(async |browser| {
        browser.open("/compare").await;
        browser.until("document.querySelector('#chosen').textContent.includes('Two to five jobs')").await;
        let sweep = |name: &str, helix_deg: f64, points: u32| {
            let mut document = example();
            document["kind"] = json!("sweep");
            document["name"] = json!(name);
            document["design"]["helix_angle_deg"] = json!(helix_deg);
            document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 1000, "to": 1400, "points": points}]);
            document["analysis"] = if points > 1000 { json!({"method": "integrate"}) } else { json!({}) };
            document
        };
        // The long one takes the only place for sweeps: the short one waits until it is canceled.
        let long = post(browser, &sweep("long", 24.0, 20_000)).await;
        let short = post(browser, &sweep("short", 28.0, 3)).await;
        let same = post(browser, &sweep("same axis", 30.0, 4)).await;
        let gone = "0193a1f0-0000-7000-8000-000000000000";
        browser.open(&format!("/compare?jobs={long},{short},{same},{gone}")).await;
        browser.until(&format!("document.querySelector(\"[data-id='{long}']\")?.textContent.includes('Its result appears here')")).await;
        browser.until(&format!("document.querySelector(\"[data-id='{gone}']\").textContent.includes('There is no such job')")).await;
        browser.value("(window.same = true)").await;
        let script = "const done = arguments[1]; fetch('/api/v1/jobs/' + arguments[0] + '/cancel', {method: 'POST'}).then(() => done(true));";
        browser.driver.execute_async(script, vec![json!(long)]).await.unwrap();
        browser.until(&format!("document.querySelector(\"[data-id='{long}']\").textContent.includes('It has no result')")).await;
        browser.until("document.querySelector('#sweeps').dataset.ready").await;
        // The plot is drawn when it comes near the window. The canceled one has a curve as well when it had solved
        // points.
        browser.value("(document.querySelector('#sweep').scrollIntoView(), true)").await;
        let named = "(name) => document.querySelector('#sweep .plot').data?.some((trace) => trace.name?.includes(name))";
        browser.until(&format!("['short', 'same axis'].every({named})")).await;
        let point = browser.fetch(&format!("/api/v1/jobs/{short}/points")).await["items"][1]["point"].clone();
        let drawn = "document.querySelector('#sweep .plot').data.find((trace) => trace.name.includes('short'))";
        assert_eq!(browser.value(&format!("{drawn}.x[1]")).await, point["values"][0]);
        let reported = &point["mesh_circumferential_acceleration_rms_m_s2"]["left"];
        assert_eq!(browser.value(&format!("{drawn}.y[1]")).await, *reported);
        assert_eq!(browser.value("window.same").await, json!(true));
        assert_eq!(browser.value("document.querySelector('#notice').hidden").await, json!(true));
    })
    .await;
}
