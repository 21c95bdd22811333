//! The report of a job.

use crate::browser::flow;
use crate::job::{STICKING_OUT, assert_complete, example, submit_document, succeeded};
use serde_json::json;

#[tokio::test]
async fn the_report_has_gear_data_inputs_results_and_plots() {
    flow(async |browser| {
        let mut document = example("table1");
        document["operation"]["rotation"] = json!("apex_trailing");
        let id = submit_document(browser, &document).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        browser.element("#report").await.click().await.unwrap();
        browser.until("document.querySelector('article')?.dataset.ready").await;
        assert!(browser.value("document.querySelector('#notice').hidden").await == json!(true));

        // Gear data in the terms of ISO 21771, with the numbers of the API.
        let data = browser.text("#gear-data").await;
        for symbol in ["mn", "αn", "αt", "αwt", "β", "βb", "pbt", "εα", "εβ", "εγ", "da", "df", "dw", "db"] {
            let cells = "[...document.querySelectorAll('#gear-data .symbol')].map((node) => node.textContent)";
            let symbols = browser.value(cells).await;
            assert!(symbols.as_array().unwrap().contains(&json!(symbol)), "{symbol} of {symbols}");
        }
        assert!(data.contains("272.474") && data.contains("200.996"), "{data}");
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        let rms = result["response"]["rms"]["mesh_circumferential_acceleration_m_s2"]["left"].as_f64().unwrap();
        let shown: f64 = browser.text("#rms tbody td").await.parse().unwrap();
        assert!((shown / rms - 1.0).abs() < 1e-4, "{shown} shown, {rms} reported");

        // Inputs: what differs from the default is marked.
        let marked =
            browser.value("[...document.querySelectorAll('.differs')].map((node) => node.innerText)").await.to_string();
        assert!(marked.contains("apex trailing") && marked.contains("apex leading"), "{marked}");

        // Plots are drawings, each told in words as well.
        let plots = browser
            .value("[...document.querySelectorAll('.figures img')].map((image) => [image.naturalWidth, image.alt])")
            .await;
        let plots = plots.as_array().unwrap();
        assert!(plots.len() >= 11, "{plots:?}");
        assert!(plots.iter().all(|plot| plot[0].as_f64() > Some(0.0) && plot[1].as_str() != Some("")), "{plots:?}");

        let job = browser.fetch(&format!("/api/v1/jobs/{id}")).await;
        let head = browser.text("#head").await;
        for words in ["input_hash", "solver_version"] {
            assert!(head.contains(job[words].as_str().unwrap()), "{words}: {head}");
        }
        assert_complete(browser).await;
        browser.driver.set_window_rect(0, 0, 390, 844).await.unwrap();
        assert_eq!(browser.value(STICKING_OUT).await, json!([]));
    })
    .await;
}

#[tokio::test]
async fn there_is_no_report_of_a_job_that_failed() {
    flow(async |browser| {
        let mut document = example("given_stiffness");
        document["analysis"] = json!({"method": "integrate", "mesh_periods": 20, "record_mesh_periods": 10, "initial_state": vec![1e6; 24]});
        let id = submit_document(browser, &document).await;
        browser.open(&format!("/jobs/{id}")).await;
        browser.until("document.querySelector('#state').textContent === 'failed'").await;
        browser.open(&format!("/jobs/{id}/report")).await;
        browser.until("!document.querySelector('#notice').hidden").await;
        let notice = browser.text("#notice").await;
        assert!(notice.contains("it is failed"), "{notice}");
        assert_eq!(browser.value("document.querySelector('#print').disabled").await, json!(true));
    })
    .await;
}
