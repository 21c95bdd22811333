//! From the form to the result of a job.

use crate::browser::{Browser, flow};
use serde_json::{Value, json};

/// Submits the form as it stands and returns the job's id, on whose page the browser then is.
pub(crate) async fn submit(browser: &Browser) -> String {
    browser.click("#submit").await;
    browser.until("location.pathname.startsWith('/jobs/')").await;
    let path = browser.value("location.pathname").await;
    path.as_str().unwrap().trim_start_matches("/jobs/").to_owned()
}

/// Waits until the job has succeeded and its whole result is drawn.
pub(crate) async fn succeeded(browser: &Browser) {
    browser.until("['succeeded', 'failed', 'canceled'].includes(document.querySelector('#state')?.textContent)").await;
    assert_eq!(browser.text("#state").await, "succeeded", "{}", browser.text("main").await);
    browser.until("document.querySelector('#job').dataset.ready").await;
    assert_eq!(browser.value("document.querySelector('#notice').hidden").await, json!(true));
}

/// A document of the folder of examples.
pub(crate) fn example(name: &str) -> Value {
    let path = format!("{}/examples/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// Submits a document to the API from a page of the service; returns the job's id.
pub(crate) async fn submit_document(browser: &Browser, document: &Value) -> String {
    browser.open("/nowhere").await;
    let script = "const done = arguments[1]; fetch('/api/v1/jobs', {method: 'POST', headers: {'Content-Type': 'application/json'}, \
                  body: JSON.stringify(arguments[0])}).then((answer) => answer.json()).then(done, (error) => done(String(error)));";
    let job = browser.driver.execute_async(script, vec![document.clone()]).await.unwrap().json().clone();
    job["id"].as_str().unwrap_or_else(|| panic!("{job}")).to_owned()
}

/// Elements that reach beyond the right edge of the window, but those that scroll inside.
pub(crate) const STICKING_OUT: &str = "[...document.querySelectorAll('main *')].filter((node) => node.getBoundingClientRect().right > \
     window.innerWidth && !node.closest('.scroll, .visually-hidden, defs, clipPath, .drawing svg > *, dialog:not([open])')).map((node) => \
     `${node.tagName} ${node.id} ${node.getAttribute('class')}`)";

/// Nothing that is missing shows as a word of the programming language.
pub(crate) async fn assert_complete(browser: &Browser) {
    let words = "document.querySelector('main').innerText.match(/\\b(null|undefined|NaN|Infinity)\\b|\\[object/g)";
    assert_eq!(browser.value(words).await, Value::Null, "{}", browser.text("main").await);
}

/// The text of the file of a media type that a click on a button saves.
pub(crate) async fn saved_by(browser: &Browser, selector: &str, media_type: &str) -> String {
    let script = "const [selector, type, done] = arguments; const make = URL.createObjectURL; \
                  HTMLAnchorElement.prototype.click = function () {}; \
                  URL.createObjectURL = (blob) => { if (blob.type.startsWith(type)) blob.text().then(done); return make.call(URL, blob); }; \
                  document.querySelector(selector).click();";
    let text = browser.driver.execute_async(script, vec![json!(selector), json!(media_type)]).await.unwrap();
    text.json().as_str().unwrap().to_owned()
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
        let headline = browser.text("#headline").await;
        for words in ["Teeth stay in contact", "Period 1", "only reported", "Nearest resonance"] {
            assert!(headline.contains(words), "{words}: {headline}");
        }
        for plot in [
            "stiffness",
            "error",
            "share",
            "sharing",
            "flank",
            "harmonics",
            "impact",
            "series",
            "phase",
            "spectrum",
            "modes",
        ] {
            // Plots are drawn when they are scrolled near.
            browser.value(&format!("document.querySelector('#{plot}-plot').scrollIntoView()")).await;
            browser
                .until(&format!("document.querySelectorAll('#{plot}-plot :is(.trace, .point, .hm)').length >= 1"))
                .await;
        }
        assert_complete(browser).await;

        // A plot's file has the numbers of the API.
        let text = saved_by(browser, "#stiffness-plot + .plot-tools .plot-files button", "text/csv").await;
        let curve = &result["mesh"]["curve"];
        let mut rows = text.trim_end().split("\r\n");
        let header = rows.next().unwrap();
        assert!(header.starts_with("Position in the mesh period,Mesh stiffness tangent dF/dδ [N/µm]"), "{header}");
        let rows: Vec<Vec<f64>> = rows.map(|row| row.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
        let numbers = |name: &str| curve[name].as_array().unwrap().iter().map(|value| value.as_f64().unwrap());
        assert!(rows.iter().map(|row| row[0]).zip(numbers("phase")).all(|(a, b)| a == b));
        assert!(rows.iter().map(|row| row[1]).zip(numbers("stiffness_n_per_um")).all(|(a, b)| a == b));
        assert_eq!(rows.len(), curve["phase"].as_array().unwrap().len() + 1, "the period's end repeats its start");

        let image =
            saved_by(browser, "#stiffness-plot + .plot-tools .plot-files button:nth-child(2)", "image/png").await;
        assert!(image.chars().take(8).collect::<String>().contains("PNG"), "{image:.40}");
        let drawing =
            saved_by(browser, "#stiffness-plot + .plot-tools .plot-files button:nth-child(3)", "image/svg").await;
        assert!(drawing.starts_with("<svg") && drawing.contains("tangent"), "{drawing:.80}");

        // Files for other programs, and the acceleration of the chosen channel to be heard.
        for (id, ending) in [
            ("series-npz", "/series?format=npz"),
            ("series-mat", "/series?format=mat"),
            ("download-workbook", "/result?format=xlsx"),
        ] {
            let script = format!(
                "fetch(document.querySelector('#{id}').href).then(({{ok}}) => window.{ending_name} = ok)",
                ending_name = id.replace('-', "_")
            );
            browser.value(&script).await;
            browser.until(&format!("window.{} === true", id.replace('-', "_"))).await;
            browser.until(&format!("document.querySelector('#{id}').href.endsWith('{ending}')")).await;
        }
        assert_eq!(browser.value("document.querySelector('#play').hidden").await, json!(false));
        browser.choose("#channel", "v_x_left").await;
        browser.until("document.querySelector('#play').title.includes('a_x_left')").await;

        // On a telephone nothing sticks out, the plots included.
        browser.driver.set_window_rect(0, 0, 390, 844).await.unwrap();
        browser.driver.refresh().await.unwrap();
        succeeded(browser).await;
        assert_eq!(browser.value(STICKING_OUT).await, json!([]));
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

        // A job is deleted only when that is confirmed.
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        for (answer, path) in [("cancel", format!("/jobs/{id}")), ("delete", "/jobs".to_owned())] {
            browser.element("#delete").await.click().await.unwrap();
            browser.until("document.querySelector('#delete-dialog').open").await;
            browser.element(&format!("#delete-dialog [value='{answer}']")).await.click().await.unwrap();
            browser.until(&format!("location.pathname === '{path}' && !document.querySelector('dialog[open]')")).await;
        }
        assert_eq!(browser.fetch(&format!("/api/v1/jobs/{id}")).await["status"], 404);
    })
    .await;
}

#[tokio::test]
async fn a_failed_job_says_why_when_and_what_to_do() {
    flow(async |browser| {
        let mut document = example("given_stiffness");
        document["analysis"] = json!({"method": "integrate", "mesh_periods": 20, "record_mesh_periods": 10, "initial_state": vec![1e6; 24]});
        let id = submit_document(browser, &document).await;
        browser.open(&format!("/jobs/{id}")).await;
        browser.until("!document.querySelector('#failure').hidden && document.querySelector('#failure-advice').textContent").await;
        assert_eq!(browser.text("#state").await, "failed");
        let failure = browser.text("#failure").await;
        let error = browser.fetch(&format!("/api/v1/jobs/{id}")).await["error"].clone();
        for words in [error["title"].as_str().unwrap(), &error["detail"].as_str().unwrap()[1..], "Simulated time", "Vibration", "damping and mesh stiffness are where to look"] {
            assert!(failure.contains(words), "{words}: {failure}");
        }
        let visible = "['headline', 'response', 'mesh', 'report', 'cancel'].filter((id) => !document.getElementById(id).hidden)";
        assert_eq!(browser.value(visible).await, json!([]));
        assert_complete(browser).await;
    })
    .await;
}

#[tokio::test]
async fn a_given_stiffness_with_separation_is_told_in_words_with_its_subharmonics() {
    flow(async |browser| {
        let id = submit_document(browser, &example("given_stiffness")).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        let headline = browser.text("#headline").await;
        for words in ["Teeth separate", "Period 2", "1/2 of the mesh frequency"] {
            assert!(headline.contains(words), "{words}: {headline}");
        }
        let spectrum = browser.text("#spectrum-note").await;
        assert!(spectrum.contains("/2 ("), "no subharmonic among the strongest lines: {spectrum}");
        // Levels instead of amplitudes: the greatest stays the greatest.
        browser.value("document.querySelector('#spectrum-plot').scrollIntoView({block: 'center'})").await;
        browser.until("document.querySelector('#spectrum-plot').data").await;
        let greatest = "((y) => y.indexOf(Math.max(...y)))(document.querySelector('#spectrum-plot').data[0].y)";
        let linear = browser.value(greatest).await;
        browser.element("label:has(#scale-db)").await.click().await.unwrap();
        browser.until("document.querySelector('#spectrum-plot').layout.yaxis.title.text.endsWith('dB')").await;
        assert_eq!(browser.value(greatest).await, linear);
        // The edges of the gap stand in the plane of the normal displacement.
        browser.choose("#phase-plane", "s").await;
        browser.until("document.querySelector('#phase-plot').layout?.shapes?.length >= 1").await;
        let edge = browser.value("document.querySelector('#phase-plot').layout.shapes[0].x0").await;
        assert_eq!(edge, json!(20), "half of the backlash");
        assert_complete(browser).await;
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
        assert_complete(browser).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        assert_eq!(result["response"], Value::Null);
        let hidden =
            "['response', 'series', 'phase', 'spectrum', 'modes', 'sweep'].every((id) => document.getElementById(id).hidden)";
        assert_eq!(browser.value(hidden).await, json!(true));
        assert_eq!(browser.value("document.querySelector('#mesh').hidden").await, json!(false));
    })
    .await;
}
