//! From the form to the result of a job.

use crate::browser::{Browser, flow};
use serde_json::{Value, json};

/// Submits the form as it stands and returns the job's id, on whose page the browser then is.
pub async fn submit(browser: &Browser) -> String {
    browser.element("#submit").await.click().await.unwrap();
    browser.until("location.pathname.startsWith('/jobs/')").await;
    let path = browser.value("location.pathname").await;
    path.as_str().unwrap().trim_start_matches("/jobs/").to_owned()
}

/// Waits until the job has succeeded and its whole result is drawn.
pub async fn succeeded(browser: &Browser) {
    browser.until("['succeeded', 'failed', 'canceled'].includes(document.querySelector('#state')?.textContent)").await;
    assert_eq!(browser.text("#state").await, "succeeded", "{}", browser.text("main").await);
    browser.until("document.querySelector('#job').dataset.ready").await;
    assert_eq!(browser.value("document.querySelector('#notice').hidden").await, json!(true));
}

/// A number as the page writes it, read back.
fn read_number(text: &str) -> f64 {
    let text = text.replace('\u{202f}', "").replace('−', "-");
    text.parse().unwrap_or_else(|_| panic!("{text:?} is not a number"))
}

#[tokio::test]
async fn the_example_goes_from_the_form_to_its_result() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        let id = submit(browser).await;
        succeeded(browser).await;

        // The page shows what the API reports.
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        let rms = &result["response"]["rms"]["mesh_circumferential_acceleration_m_s2"];
        for (column, side) in [(2, "left"), (3, "right")] {
            let reported = rms[side].as_f64().unwrap();
            assert!(reported > 0.0, "{result}");
            let shown = browser.text(&format!("#rms tbody tr:first-child :nth-child({column})")).await;
            let shown = read_number(&shown);
            assert!((shown / reported - 1.0).abs() < 1e-4, "{side}: {shown} shown, {reported} reported");
        }
        let force = result["impact"]["force_n"].as_f64().unwrap();
        let shown = browser.text("#impact-table tbody tr:first-child td").await;
        let shown = read_number(shown.trim_end_matches(" N"));
        assert!((shown / force - 1.0).abs() < 1e-4, "impact force: {shown} shown, {force} reported");
        let geometry = browser.text("#geometry-values").await;
        assert!(geometry.contains("Transverse contact ratio"), "{geometry}");
        assert_eq!(browser.value("document.querySelectorAll('#impact-table tbody tr').length").await, json!(3));
        let spectrum = !result["response"]["spectrum"].is_null();
        assert_eq!(browser.value("!document.querySelector('#spectrum').hidden").await, json!(spectrum));
        let plots = ["stiffness", "error", "share", "series", "phase", "spectrum"];
        for plot in plots.into_iter().filter(|plot| spectrum || *plot != "spectrum") {
            // Plots are drawn when they are scrolled near.
            browser.value(&format!("document.querySelector('#{plot}-plot').scrollIntoView()")).await;
            browser.until(&format!("document.querySelectorAll('#{plot}-plot .scatterlayer .trace').length >= 1")).await;
        }

        // On a telephone nothing sticks out, the plots included.
        browser.driver.set_window_rect(0, 0, 390, 844).await.unwrap();
        browser.driver.refresh().await.unwrap();
        succeeded(browser).await;
        let sticking = "[...document.querySelectorAll('main *')].filter((node) => node.getBoundingClientRect().right > \
                        window.innerWidth && !node.closest('.scroll, .visually-hidden, defs, clipPath, dialog:not([open])')).map((node) => \
                        `${node.tagName} ${node.id} ${node.getAttribute('class')}`)";
        assert_eq!(browser.value(sticking).await, json!([]));
        browser.driver.set_window_rect(0, 0, 1280, 1000).await.unwrap();

        // The document can be taken up again in the form.
        browser.element("#again").await.click().await.unwrap();
        browser.until("location.search.startsWith('?from=')").await;
        browser.until("document.querySelector('#document-text')?.textContent").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        assert_eq!(
            browser.value("document.querySelector('[data-pointer=\"/design/pinion/teeth\"] input').value").await,
            json!("17")
        );
    })
    .await;
}

#[tokio::test]
async fn zooming_in_fetches_finer_data() {
    flow(async |browser| {
        browser.open("/").await;
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        browser.choose("[data-pointer='/analysis/method'] select", "integrate").await;
        submit(browser).await;
        succeeded(browser).await;
        let read = async |name: &str| -> f64 {
            let value = browser.value(&format!("document.querySelector('#series-plot').dataset.{name}")).await;
            value.as_str().unwrap().parse().unwrap()
        };
        let (samples, points) = (read("samples").await, read("points").await);
        assert!(points < samples, "nothing to refine: {points} of {samples} samples");
        // Drag over the middle of the plot, as a person zooms.
        browser
            .driver
            .execute("document.querySelector('#series-plot').scrollIntoView({block: 'center'})", Vec::new())
            .await
            .unwrap();
        let layer = browser.element("#series-plot .nsewdrag").await;
        let width = layer.rect().await.unwrap().width as i64;
        browser
            .driver
            .action_chain()
            .move_to_element_with_offset(&layer, -width / 20, 0)
            .click_and_hold()
            .move_by_offset(width / 20, 0)
            .move_by_offset(width / 20, 0)
            .release()
            .perform()
            .await
            .unwrap();
        browser
            .until(&format!("Number(document.querySelector('#series-plot').dataset.samples) < {}", samples / 2.0))
            .await;
        let (window, shown) = (read("samples").await, read("points").await);
        assert!(shown / window > points / samples, "{shown} of {window} after, {points} of {samples} before");
        let range = browser.value("document.querySelector('#series-plot').layout.xaxis.range").await;
        let x =
            browser.value("(({x}) => [x[0], x[x.length - 1]])(document.querySelector('#series-plot').data[0])").await;
        for end in 0..2 {
            let (limit, drawn) = (range[end].as_f64().unwrap(), x[end].as_f64().unwrap());
            let span = range[1].as_f64().unwrap() - range[0].as_f64().unwrap();
            assert!((limit - drawn).abs() < 0.01 * span, "drawn {x} in a window of {range}");
        }
        // And back.
        browser.element("#whole").await.click().await.unwrap();
        browser.until(&format!("Number(document.querySelector('#series-plot').dataset.samples) === {samples}")).await;
    })
    .await;
}

#[tokio::test]
async fn a_mesh_job_has_no_response() {
    flow(async |browser| {
        browser.open("/").await;
        browser.choose("[data-pointer='/kind'] select", "mesh").await;
        let id = submit(browser).await;
        succeeded(browser).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        assert_eq!(result["response"], Value::Null);
        let hidden =
            "['response', 'series', 'phase', 'spectrum', 'sweep'].every((id) => document.getElementById(id).hidden)";
        assert_eq!(browser.value(hidden).await, json!(true));
        assert_eq!(browser.value("document.querySelector('#mesh').hidden").await, json!(false));
    })
    .await;
}
