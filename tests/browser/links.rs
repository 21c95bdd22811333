//! Addresses that keep what is shown, and the way back to it.

use crate::browser::flow;
use crate::job::{example, succeeded};
use serde_json::{Value, json};

#[tokio::test]
async fn the_address_of_a_response_keeps_channels_zoom_and_scale() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let id = browser.solved(&example("given_stiffness")).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        assert_eq!(browser.value("location.search").await, json!(""));
        browser.choose("#channel", "a_x_left").await;
        browser.choose("#second-channel", "").await;
        let drawn = "document.querySelector('#series-plot')";
        browser.value(&format!("{drawn}.scrollIntoView()")).await;
        browser.until(&format!("{drawn}._fullLayout && {drawn}.dataset.state === 'ready'")).await;
        // By the keyboard, as people may.
        browser.element("#series-plot").await.send_keys("+").await.unwrap();
        browser.until("new URLSearchParams(location.search).has('to')").await;
        browser.element("label:has(#scale-db)").await.click().await.unwrap();
        let told = browser.value("Object.fromEntries(new URLSearchParams(location.search))").await;
        assert_eq!((&told["channel"], &told["scale"]), (&json!("a_x_left"), &json!("db")));
        let range = |value: &Value| [0, 1].map(|end| value[end].as_f64().unwrap());
        let shown = range(&browser.value(&format!("{drawn}._fullLayout.xaxis.range")).await);
        let address = browser.value("location.pathname + location.search").await;

        // In another window, and on the way back from another page.
        browser.open("/jobs").await;
        browser.open(address.as_str().unwrap()).await;
        for _ in 0..2 {
            succeeded(browser).await;
            browser.value(&format!("{drawn}.scrollIntoView()")).await;
            browser.until(&format!("{drawn}._fullLayout && {drawn}.dataset.state === 'ready'")).await;
            assert_eq!(browser.value("document.querySelector('#channel').value").await, json!("a_x_left"));
            assert_eq!(browser.value("document.querySelector('#second-channel').value").await, json!(""));
            assert_eq!(browser.value("document.querySelector('#scale-db').checked").await, json!(true));
            let again = range(&browser.value(&format!("{drawn}._fullLayout.xaxis.range")).await);
            assert!((again[0] - shown[0]).abs() + (again[1] - shown[1]).abs() < 1e-6 * shown[1], "{again:?} {shown:?}");
            browser.open("/jobs").await;
            browser.driver.back().await.unwrap();
        }
    })
    .await;
}

#[tokio::test]
async fn a_comparison_refers_to_the_oldest_job_and_names_its_axes() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let mut ids = Vec::new();
        for torque in [400, 600] {
            let mut document = example("given_stiffness");
            document["operation"]["pinion_torque_nm"] = json!(torque);
            ids.push(browser.solved(&document).await);
        }
        let [older, newer] = [&ids[0], &ids[1]];
        browser.open(&format!("/compare?jobs={newer},{older}")).await;
        browser.until("document.querySelector('#curves[data-ready]')").await;
        let reference = "document.querySelector('input[name=reference]:checked').value";
        assert_eq!(browser.value(reference).await, json!(older));
        // One that is chosen stays in the address.
        browser.element(&format!("input[name=reference][value='{newer}']")).await.click().await.unwrap();
        browser.until("new URLSearchParams(location.search).has('reference')").await;
        browser.choose("#periods", "5").await;
        browser.driver.refresh().await.unwrap();
        browser.until("document.querySelector('#curves[data-ready]')").await;
        assert_eq!(browser.value(reference).await, json!(newer));
        assert_eq!(browser.value("document.querySelector('#periods').value").await, json!("5"));
        let title = "document.querySelector('#series .plot')";
        browser.value(&format!("{title}.scrollIntoView()")).await;
        browser.until(&format!("{title}._fullLayout")).await;
        for figure in ["series", "spectrum", "phase"] {
            let plot = format!("document.querySelector('#{figure} .plot')");
            browser.value(&format!("{plot}.scrollIntoView()")).await;
            browser.until(&format!("{plot}._fullLayout")).await;
            let y = browser.value(&format!("{plot}._fullLayout.yaxis.title.text")).await;
            assert!(y.as_str().unwrap().replace("<br>", " ").contains(", "), "{figure}: {y}");
        }
    })
    .await;
}

#[tokio::test]
async fn the_address_of_a_sweep_keeps_the_zoom() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let mut document = example("given_stiffness");
        document["kind"] = json!("sweep");
        document["analysis"] = json!({"accuracy": 1e-3});
        document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 1000, "to": 3000, "points": 21}]);
        let id = browser.solved(&document).await;
        browser.open(&format!("/jobs/{id}#view=curves&quantity=dynamic_factor&from=1500&to=2000")).await;
        succeeded(browser).await;
        browser.until("document.querySelector('#sweep-plot').dataset.points === '21'").await;
        let range = "document.querySelector('#sweep-plot')._fullLayout.xaxis.range";
        assert_eq!(browser.value(range).await, json!([1500, 2000]));
        browser.element("#sweep-plot").await.send_keys("+").await.unwrap();
        browser.until("Number(new URLSearchParams(location.hash.slice(1)).get('from')) > 1500").await;
    })
    .await;
}

/// Pairs of labels of a plot that cover each other by more than a few pixels.
const OVERLAPS: &str = "(() => { const boxes = [...document.querySelectorAll('#modes-plot .textpoint text, #modes-plot .annotation-text')] \
                        .filter((node) => node.textContent.trim()).map((node) => node.getBoundingClientRect()); \
                        return boxes.flatMap((a, i) => boxes.slice(i + 1).filter((b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 3 \
                        && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3)).length; })()";

#[tokio::test]
async fn labels_of_a_plot_do_not_cover_each_other_on_a_telephone() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let id = browser.solved(&example("table1")).await;
        browser.resize(390).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        let plot = "document.querySelector('#modes-plot')";
        browser.value(&format!("{plot}.scrollIntoView()")).await;
        browser.until(&format!("{plot}.querySelector('.textpoint text')")).await;
        assert_eq!(browser.value(OVERLAPS).await, json!(0));
        let labels = browser.value("document.querySelectorAll('#modes-plot .annotation-text').length").await;
        assert!(labels.as_u64() > Some(2), "{labels}");
    })
    .await;
}
