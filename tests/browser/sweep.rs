//! Sweeps: from the form to curves, maps and the response of one point.

use crate::browser::{Browser, flow};
use crate::job::{submit, succeeded};
use serde_json::{Value, json};

/// A pair with a given stiffness: a point takes milliseconds.
fn quick() -> Value {
    let mut document: Value = serde_json::from_str(include_str!("../../examples/given_stiffness.json")).unwrap();
    document["kind"] = json!("sweep");
    document["analysis"] = json!({"accuracy": 1e-3});
    document
}

/// Submits a document through the API, as the page would, and opens its job.
async fn start(browser: &Browser, document: &Value) -> String {
    browser.open("/jobs").await;
    let script = "const done = arguments[1]; fetch('/api/v1/jobs', {method: 'POST', headers: {'Content-Type': 'application/json'}, \
                  body: JSON.stringify(arguments[0])}).then((answer) => answer.json()).then(done, (error) => done(String(error)));";
    let answer = browser.driver.execute_async(script, vec![document.clone()]).await.unwrap();
    let id = answer.json()["id"].as_str().unwrap_or_else(|| panic!("{}", answer.json())).to_owned();
    browser.open(&format!("/jobs/{id}")).await;
    id
}

/// Number of curves drawn, without marks of direction and the like.
const CURVES: &str = "document.querySelector('#sweep-plot').data.filter(({type, aside, name, hoverinfo}) => type === 'scatter' \
                      && hoverinfo !== 'skip' && !name.startsWith('jump')).length";

#[tokio::test]
async fn a_sweep_goes_from_the_form_to_its_curves_and_table() {
    flow(async |browser| {
        browser.open("/").await;
        browser.choose("[data-pointer='/kind'] select", "sweep").await;
        // The input is found by a part of its name, with the keyboard.
        let input = browser.element("#axis-0-input").await;
        input.send_keys("pinion sp").await.unwrap();
        browser
            .until(
                "document.querySelector('#axis-0-input-list .active')?.textContent.startsWith('Pinion speed, r/min')",
            )
            .await;
        input.send_keys("\u{e007}").await.unwrap();
        let pointer = "document.querySelector('[data-pointer=\"/axes/0/pointer\"] input').value";
        assert_eq!(browser.value(pointer).await, json!("/operation/pinion_speed_rpm"));
        assert_eq!(browser.value("document.querySelector('#axis-0-input').value").await, json!("Pinion speed, r/min"));
        browser.fill("/axes/0/from", "1000").await;
        browser.fill("/axes/0/to", "3000").await;
        browser.fill("/axes/0/points", "5").await;
        browser.until("document.querySelector('#sweep-plan').textContent.startsWith('5 points')").await;
        let unit = browser.text("[data-pointer='/axes/0/from'] .axis-unit").await;
        assert_eq!(unit, "r/min");
        assert!(browser.text("#axis-0-now").await.contains("2000 r/min"));
        browser.until("document.querySelector('#check-state').classList.contains('good')").await;
        let id = submit(browser).await;
        succeeded(browser).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        assert_eq!(result["sweep"]["points"].as_array().map(Vec::len), Some(5));
        // The halves of this pair move alike: one curve says so; of one half alone it has that half's name.
        assert_eq!(browser.value(CURVES).await, json!(1));
        let name = "document.querySelector('#sweep-plot').data[0].name";
        assert_eq!(browser.value(name).await, json!("both halves alike"));
        browser.choose("#sweep-halves", "right").await;
        browser.until(&format!("{name} === 'right'")).await;
        browser.element("#sweep-details > summary").await.click().await.unwrap();
        browser.until("document.querySelectorAll('#sweep-table tbody tr').length === 5").await;
        let row = browser.text("#sweep-table tbody tr:nth-child(3)").await;
        assert!(row.starts_with("2000") && row.contains("period-1"), "{row}");
        // The page says what the sweep was over, and what stands out.
        assert!(browser.text("#sweep-axes").await.contains("Pinion speed from 1000 to 3000 r/min in 5 values"));
        assert!(browser.text("#sweep-findings").await.contains("Greatest value"));
    })
    .await;
}

#[tokio::test]
async fn both_branches_show_jumps_and_a_point_opens_as_a_response_of_its_own() {
    flow(async |browser| {
        let mut document = quick();
        // Around the main resonance the teeth separate, and the curve bends over to lower speeds: two motions, a jump
        // each way.
        document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 10500, "to": 8500, "points": 21}]);
        document["operation"]["pinion_torque_nm"] = json!(300.0);
        document["model"]["mesh_damping_ratio"] = json!(0.01);
        document["model"]["mesh_stiffness"]["harmonics"] = json!([{"amplitude": 0.15, "phase_rad": 0.3}]);
        document["model"]["impact"] = json!({"source": "none"});
        document["continuation"] = json!("both");
        document["record"] = json!(["poincare", "spectrum"]);
        let id = start(browser, &document).await;
        // Curves are there before the sweep has ended, and grow.
        browser.until("Number(document.querySelector('#sweep-plot').dataset.points) > 0").await;
        succeeded(browser).await;
        browser.until("document.querySelector('#sweep-plot').dataset.points === '42'").await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        let jumps = result["sweep"]["jumps"].as_array().unwrap().clone();
        assert_eq!(jumps.len(), 2, "{jumps:?}");
        assert_eq!(browser.value(CURVES).await, json!(2));
        let marked =
            "document.querySelector('#sweep-plot').data.filter(({name}) => name?.startsWith('jump')).map(({x}) => x)";
        let marked = browser.value(marked).await;
        let marked: Vec<f64> =
            marked.as_array().unwrap().iter().flat_map(|x| x.as_array().unwrap()).filter_map(Value::as_f64).collect();
        for jump in &jumps {
            assert!(marked.contains(&jump["from"].as_f64().unwrap()), "{jump} is not marked: {marked:?}");
        }
        let said = browser.text("#sweep-findings").await;
        assert!(said.contains("the motion jumps"), "{said}");
        // What is drawn is what the API has.
        let drawn = browser
            .value("(({customdata, y}) => [customdata[5], y[5]])(document.querySelector('#sweep-plot').data[0])")
            .await;
        let point = &result["sweep"]["points"][drawn[0].as_u64().unwrap() as usize];
        assert_eq!(drawn[1], point["mesh_circumferential_acceleration_rms_m_s2"]["left"]);

        for (view, layer) in [
            ("bifurcation", ".scatterlayer .point"),
            ("spectra", ".heatmaplayer image"),
            ("campbell", ".scatterlayer .trace"),
        ] {
            browser.element(&format!("label:has(#sweep-view-{view})")).await.click().await.unwrap();
            browser.until(&format!("document.querySelector('#sweep-plot').dataset.view === '{view}'")).await;
            browser.until(&format!("document.querySelector('#sweep-plot {layer}')")).await;
        }

        // A point by its row in the table, then its response.
        browser.element("#sweep-details > summary").await.click().await.unwrap();
        browser.until("document.querySelectorAll('#sweep-table tbody tr').length === 42").await;
        browser.element("#sweep-table tbody tr:first-child button").await.click().await.unwrap();
        browser
            .until("!document.querySelector('#sweep-point').hidden && document.querySelector('#sweep-point-values dd')")
            .await;
        assert!(browser.text("#sweep-point-title").await.contains("10 500 r/min, on the way up"));
        assert!(browser.value("location.hash").await.as_str().unwrap().contains("point=0"));
        browser.element("#sweep-open").await.click().await.unwrap();
        browser.until(&format!("location.pathname.startsWith('/jobs/') && location.pathname !== '/jobs/{id}'")).await;
        succeeded(browser).await;
        let path = browser.value("location.pathname").await;
        let response = browser.fetch(&format!("/api/v1{}/result", path.as_str().unwrap())).await;
        let rms = |value: &Value| value["left"].as_f64().unwrap();
        let of_row = rms(&result["sweep"]["points"][0]["mesh_circumferential_acceleration_rms_m_s2"]);
        let of_job = rms(&response["response"]["rms"]["mesh_circumferential_acceleration_m_s2"]);
        assert!((of_job / of_row - 1.0).abs() < 1e-3, "{of_job} on its own, {of_row} in the sweep");
        // Where two motions exist the points of both branches are what they are in the sweep.
        let points = &result["sweep"]["points"];
        let of_point = |at: usize| rms(&points[at]["mesh_circumferential_acceleration_rms_m_s2"]);
        let twofold: Vec<usize> = (0..21).filter(|at| of_point(*at) < 0.9 * of_point(at + 21)).collect();
        assert!(twofold.len() > 2, "{twofold:?}");
        for at in [twofold[0], twofold[0] + 21, twofold[twofold.len() - 1] + 21] {
            let document = browser.fetch(&format!("/api/v1/jobs/{id}/points/{at}/input")).await;
            let own = browser.solved(&document).await;
            let own = browser.fetch(&format!("/api/v1/jobs/{own}/result")).await;
            let of_job = rms(&own["response"]["rms"]["mesh_circumferential_acceleration_m_s2"]);
            assert_eq!((of_job, &own["response"]["regime"]), (of_point(at), &points[at]["regime"]), "point {at}");
            assert!(!own["warnings"].to_string().contains("sweep-point"), "{}", own["warnings"]);
        }
        // Without the start, the job says that it is another motion than the sweep's.
        let mut from_rest = browser.fetch(&format!("/api/v1/jobs/{id}/points/{}/input", twofold[0] + 21)).await;
        from_rest["analysis"].as_object_mut().unwrap().remove("initial_state");
        from_rest["sweep_point"]["input_hash"] = json!("");
        let other = browser.solved(&from_rest).await;
        let other = browser.fetch(&format!("/api/v1/jobs/{other}/result")).await;
        assert!(
            rms(&other["response"]["rms"]["mesh_circumferential_acceleration_m_s2"]) < 0.9 * of_point(twofold[0] + 21)
        );
        // The way back leads to the same point.
        browser.driver.back().await.unwrap();
        browser.until("document.querySelector('#sweep-point-title')?.textContent.includes('10 500 r/min')").await;
    })
    .await;
}

#[tokio::test]
async fn two_inputs_make_a_map_with_sections() {
    flow(async |browser| {
        let mut document = quick();
        document["axes"] = json!([
            {"pointer": "/operation/pinion_speed_rpm", "from": 4000, "to": 5000, "points": 6},
            {"pointer": "/operation/pinion_torque_nm", "values": [400.0, 200.0, 300.0]},
        ]);
        let id = start(browser, &document).await;
        succeeded(browser).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;
        browser.until("document.querySelector('#sweep-plot .heatmaplayer image')").await;
        let map = browser.value("(({x, y, z}) => ({x, y, z}))(document.querySelector('#sweep-plot').data[0])").await;
        // Rows by ascending torque, though the document has them otherwise.
        let torques: Vec<_> = map["y"].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
        assert_eq!(torques, [200.0, 300.0, 400.0]);
        let point = |at: usize| result["sweep"]["points"][at]["mesh_circumferential_acceleration_rms_m_s2"].clone();
        for (row, line) in [(0, 1), (1, 2), (2, 0)] {
            let halves = point(line * 6 + 3);
            let greater = halves["left"].as_f64().unwrap().max(halves["right"].as_f64().unwrap());
            assert_eq!(map["z"][row][3].as_f64(), Some(greater));
        }
        browser.element("#sweep-findings button").await.click().await.unwrap();
        browser.until("!document.querySelector('#sweep-sections').hidden && document.querySelector('#sweep-section-1 .trace')").await;
        // The kind of motion as a map, then the curve of one line.
        browser.choose("#sweep-quantity", "regime").await;
        browser.until("!document.querySelector('#sweep-regime-legend').hidden").await;
        assert!(browser.text("#sweep-regime-legend").await.contains("period-1"));
        browser.element("label:has(#sweep-view-curves)").await.click().await.unwrap();
        browser.until("document.querySelector('#sweep-plot').dataset.view === 'curves'").await;
        browser.choose("#sweep-line", "0").await;
        browser.until(&format!("document.querySelector('#sweep-plot').data[0].y[0] === {}", point(0)["left"])).await;
        // On a telephone nothing sticks out, the table included.
        browser.driver.set_window_rect(0, 0, 390, 844).await.unwrap();
        browser.driver.refresh().await.unwrap();
        succeeded(browser).await;
        browser.element("#sweep-details > summary").await.click().await.unwrap();
        browser.until("document.querySelectorAll('#sweep-table tbody tr').length === 18").await;
        let sticking = "[...document.querySelectorAll('main *')].filter((node) => node.getBoundingClientRect().right > \
                        window.innerWidth && !node.closest('.scroll, .visually-hidden, defs, clipPath')).map((node) => \
                        `${node.tagName} ${node.id} ${node.getAttribute('class')}`)";
        assert_eq!(browser.value(sticking).await, json!([]));
    })
    .await;
}

#[tokio::test]
async fn a_canceled_sweep_keeps_its_points_and_goes_on_when_it_is_resumed() {
    flow(async |browser| {
        let mut document = quick();
        document["axes"] =
            json!([{"pointer": "/operation/pinion_speed_rpm", "from": 3500, "to": 5500, "points": 100_000}]);
        let id = start(browser, &document).await;
        browser.until("Number(document.querySelector('#sweep-plot').dataset.points) > 0").await;
        let first = browser.value("Number(document.querySelector('#sweep-plot').dataset.points)").await;
        browser.until(&format!("Number(document.querySelector('#sweep-plot').dataset.points) > {first}")).await;
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("document.querySelector('#state').textContent === 'canceled'").await;
        let solved = browser.fetch(&format!("/api/v1/jobs/{id}/points?limit=1")).await["n_solved"].clone();
        browser.until(&format!("document.querySelector('#sweep-plot').dataset.points === '{solved}'")).await;
        assert!(browser.text("#sweep-count").await.contains("canceled"));
        // A new job takes over what is solved.
        browser.element("#sweep-resume").await.click().await.unwrap();
        browser.until(&format!("location.pathname.startsWith('/jobs/') && location.pathname !== '/jobs/{id}'")).await;
        browser.until(&format!("Number(document.querySelector('#sweep-plot')?.dataset.points) >= {solved}")).await;
        browser.element("#cancel").await.click().await.unwrap();
        browser.until("document.querySelector('#state').textContent === 'canceled'").await;
    })
    .await;
}
