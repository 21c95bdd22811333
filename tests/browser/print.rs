//! Pages on paper and plots as files.

use crate::browser::{Browser, flow};
use crate::job::{example, succeeded};
use serde_json::{Value, json};

/// Width of A4 within margins of 10 mm, in CSS pixels.
const PAPER_PX: u32 = 718;

/// Shows the page as it is printed.
async fn on_paper(browser: &Browser) {
    browser.command("Emulation.setEmulatedMedia", json!({"media": "print"})).await;
    browser.resize(PAPER_PX).await;
    browser.value("window.dispatchEvent(new Event('beforeprint'))").await;
    let drawn = "[...document.querySelectorAll('.plot')].filter((node) => node.getClientRects().length)\
                 .every((node) => node._fullLayout && node._fullLayout.width <= window.innerWidth)";
    browser.until(drawn).await;
}

/// What is cut off on paper: what sticks out, and what would have to be scrolled.
const CUT: &str = "[...document.querySelectorAll('main *')].filter((node) => node.getClientRects().length \
                   && !node.closest('.visually-hidden, defs, clipPath, .plot, .drawing svg > *') \
                   && (node.getBoundingClientRect().right > window.innerWidth + 1 \
                   || (/auto|scroll|hidden/.test(getComputedStyle(node).overflow) && node.scrollHeight > node.clientHeight + 1 && node.tagName !== 'IMG'))) \
                   .map((node) => `${node.tagName} ${node.id} ${node.getAttribute('class')}`)";

/// Swatches without a colour of their own: a background is not printed.
const PALE: &str = "[...document.querySelectorAll('.swatch, .mark svg')].filter((node) => node.getClientRects().length) \
                    .filter((node) => { const style = getComputedStyle(node.querySelector('path') ?? node); \
                    return !(parseFloat(style.borderTopWidth) > 2 || parseFloat(style.strokeWidth) > 2); }).length";

async fn assert_printable(browser: &Browser, headings: &[&str]) {
    on_paper(browser).await;
    assert_eq!(browser.value(CUT).await, json!([]));
    assert_eq!(browser.value(PALE).await, json!(0));
    let shown = browser
        .value("[...document.querySelectorAll('h1, h2')].filter((node) => node.getClientRects().length).map((node) => node.textContent)")
        .await;
    for heading in headings {
        assert!(shown.as_array().unwrap().contains(&json!(heading)), "{heading} in {shown}");
    }
    // Light, whatever the screen had.
    let text =
        browser.value("document.querySelector('.plot, figure img') && getComputedStyle(document.body).color").await;
    assert_eq!(text, json!("rgb(26, 36, 40)"));
    browser.command("Emulation.setEmulatedMedia", json!({"media": ""})).await;
}

fn sweep() -> Value {
    let mut document = example("given_stiffness");
    document["kind"] = json!("sweep");
    document["name"] = json!("Speeds <i>of</i> a & b");
    document["analysis"] = json!({"accuracy": 1e-3});
    document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 1000, "to": 12000, "points": 23}]);
    document
}

#[tokio::test]
async fn five_jobs_side_by_side_are_whole_on_paper() {
    flow(async |browser| {
        browser.open("/jobs").await;
        browser.prefer_dark(true).await;
        let mut ids = Vec::new();
        for torque in [400, 600, 800, 1000, 1200] {
            let mut document = example("given_stiffness");
            document["name"] = json!(format!("A rather long name of a design, {torque} N m"));
            document["operation"]["pinion_torque_nm"] = json!(torque);
            ids.push(browser.solved(&document).await);
        }
        browser.open(&format!("/compare?jobs={}", ids.join(","))).await;
        browser.until("document.querySelector('#curves[data-ready]')").await;
        assert_printable(browser, &["Compare jobs", "Inputs that differ", "Headline numbers", "Curves"]).await;
        // The report of the comparison has the same tables, and drawings.
        browser.open(&format!("/compare/report?jobs={}", ids.join(","))).await;
        browser.until("document.querySelector('#report[data-ready]')").await;
        browser.element("#sheet-project").await.send_keys("Pump 7").await.unwrap();
        assert_printable(browser, &["Comparison of jobs", "Inputs that differ", "Headline numbers", "Plots"]).await;
        assert!(browser.text("#numbers-table").await.contains("reference"));
        let sheet = browser.value("document.querySelector('#sheet-values').textContent").await;
        assert!(sheet.as_str().unwrap().contains("Pump 7"), "{sheet}");
        let widths =
            browser.value("[...document.querySelectorAll('.figures img')].map((image) => image.naturalWidth)").await;
        assert!(widths.as_array().unwrap().len() >= 3 && !widths.to_string().contains("[0"), "{widths}");
    })
    .await;
}

#[tokio::test]
async fn a_sweep_and_its_report_are_whole_on_paper() {
    flow(async |browser| {
        browser.open("/jobs").await;
        browser.prefer_dark(true).await;
        let id = browser.solved(&sweep()).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        browser.until("document.querySelector('#sweep-plot').dataset.points === '23'").await;
        browser.element("#sweep-details > summary").await.click().await.unwrap();
        browser.until("document.querySelectorAll('#sweep-table tbody tr').length === 23").await;
        assert_printable(browser, &["Sweep"]).await;

        browser.element("#report").await.click().await.unwrap();
        browser.until("document.querySelector('#report[data-ready]')").await;
        browser.element("#sheet-author").await.send_keys("E. Gear").await.unwrap();
        browser.element("#sheet-notes").await.send_keys("First <b>draft</b>").await.unwrap();
        assert_printable(
            browser,
            &[
                "Summary",
                "Drawing of the pair",
                "Gear data (ISO 21771)",
                "Resonances in the range of speeds",
                "Points",
                "Inputs",
                "Plots",
            ],
        )
        .await;
        // Its points are those of the API.
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        let rows =
            browser.value("[...document.querySelectorAll('#points-table tbody tr')].map((row) => row.innerText)").await;
        assert_eq!(rows.as_array().map(Vec::len), Some(23));
        let greatest = result["sweep"]["points"].as_array().unwrap().iter();
        let greatest = greatest
            .filter_map(|point| point["mesh_circumferential_acceleration_rms_m_s2"]["left"].as_f64())
            .fold(0.0, f64::max);
        let said = browser.text("#sweep-findings").await;
        assert!(said.contains(&format!("{greatest:.0}")), "{greatest} in {said}");
        let printed = browser.value("document.querySelector('#sheet-notes-printed').textContent").await;
        assert_eq!(printed, json!("First <b>draft</b>"));
        assert!(browser.value("document.querySelectorAll('#drawing-section path').length").await.as_u64() > Some(2));
        // What was typed is there again.
        browser.driver.refresh().await.unwrap();
        browser.until("document.querySelector('#report[data-ready]')").await;
        assert_eq!(browser.value("document.querySelector('#sheet-author').value").await, json!("E. Gear"));
        assert_eq!(browser.value("document.querySelector('#sheet-notes').value").await, json!("First <b>draft</b>"));
    })
    .await;
}

#[tokio::test]
async fn an_image_says_what_it_shows() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let id = browser.solved(&sweep()).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        browser.until("document.querySelector('#sweep-plot').dataset.points === '23'").await;
        // What is saved, as text.
        browser
            .value("(() => { window.saved = []; const make = URL.createObjectURL; \
                    URL.createObjectURL = (blob) => { blob.text().then((text) => window.saved.push(text)); return make.call(URL, blob); }; })()")
            .await;
        browser.element("#sweep-plot ~ .plot-tools .plot-files button:nth-child(3)").await.click().await.unwrap();
        browser.until("window.saved.length === 1").await;
        let words = "window.saved[0].replace(/<[^>]+>/g, '').replace(/&#60;|&lt;/g, '<').replaceAll('&gt;', '>').replaceAll('&amp;', '&')";
        let words = browser.value(words).await.as_str().unwrap().to_owned();
        for part in ["acceleration", "m/s²", "Pinion speed, r/min", "Speeds <i>of</i> a & b", "motion: period-1", "contact: continuous"] {
            assert!(words.contains(part), "{part} in {words}");
        }
    })
    .await;
}
