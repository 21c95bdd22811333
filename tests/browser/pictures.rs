//! Pictures of every page for docs/screenshots, as people see them: `scripts/screenshots` makes them, against a server
//! of the release build.

use crate::browser::{Browser, flow, flow_against};
use crate::server::Server;
use serde_json::{Value, json};
use std::path::PathBuf;

/// No picture is longer; what lies below is more of the same.
const LONGEST: u64 = 3600;

/// Takes a picture of the page as a whole, drawn to its end, `limit` pixels of it at most.
async fn take(browser: &Browser, name: &str, limit: u64) {
    let [width, height] = draw(browser, limit).await;
    shoot(browser, name, [0.0, 0.0, width as f64, height as f64]).await;
}

/// Takes a picture of one section of the page.
async fn take_section(browser: &Browser, name: &str, selector: &str) {
    draw(browser, u64::MAX).await;
    let edges = format!(
        "(({{left, top, width, height}}) => [left, top, width, height])(document.querySelector('{selector}').getBoundingClientRect())"
    );
    let edges = browser.value(&edges).await;
    let edge = |index: usize| edges[index].as_f64().unwrap();
    shoot(browser, name, [edge(0), edge(1), edge(2), edge(3)]).await;
}

/// Makes the window as high as the page, `limit` pixels at most: plots are drawn when they come into it. Returns its
/// width and height.
async fn draw(browser: &Browser, limit: u64) -> [u64; 2] {
    let width = browser.value("window.innerWidth").await.as_u64().unwrap();
    let height = browser.value("document.documentElement.scrollHeight").await.as_u64().unwrap().min(limit);
    browser.command("Emulation.setScrollbarsHidden", json!({"hidden": true})).await;
    let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
    browser.command("Emulation.setDeviceMetricsOverride", size).await;
    browser.until(DRAWN).await;
    [width, height]
}

/// A picture of a part of the window: left edge, top edge, width, height.
async fn shoot(browser: &Browser, name: &str, [x, y, width, height]: [f64; 4]) {
    let clip = json!({"x": x, "y": y, "width": width, "height": height, "scale": 1});
    let shot = browser.command("Page.captureScreenshot", json!({"format": "png", "clip": clip})).await;
    let folder = std::env::var_os("HERRINGBONE_PICTURES")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs/screenshots"), PathBuf::from);
    let path = folder.join(format!("{name}.png"));
    std::fs::write(&path, decoded(shot["data"].as_str().unwrap())).unwrap();
    println!("{}", path.display());
}

/// Every plot in the window is drawn.
const DRAWN: &str = "[...document.querySelectorAll('.plot')].every((plot) => { const {top, height} = plot.getBoundingClientRect(); \
    return height === 0 || top > window.innerHeight || plot.querySelector('.main-svg'); })";

/// Base64, whose letters stand for six bits each.
fn decoded(text: &str) -> Vec<u8> {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let sextets: Vec<u32> = text
        .bytes()
        .filter_map(|letter| LETTERS.iter().position(|known| *known == letter))
        .map(|at| at as u32)
        .collect();
    let quads = sextets.chunks(4).flat_map(|quad| {
        let bits = quad.iter().enumerate().fold(0, |bits, (place, sextet)| bits | sextet << (18 - 6 * place));
        bits.to_be_bytes()[1..quad.len()].to_vec()
    });
    quads.collect()
}

/// A page in light and dark and on a telephone.
async fn takes(browser: &Browser, name: &str, path: &str, ready: &str) {
    for (ending, width, dark) in [("", 1280, false), ("-dark", 1280, true), ("-narrow", 390, false)] {
        browser.resize(width).await;
        browser.prefer_dark(dark).await;
        browser.open(path).await;
        browser.until(ready).await;
        take(browser, &format!("{name}{ending}"), LONGEST).await;
    }
    browser.resize(1280).await;
}

fn example(text: &str, change: impl FnOnce(&mut Value)) -> Value {
    let mut document = serde_json::from_str(text).unwrap();
    change(&mut document);
    document
}

const TABLE_1: &str = include_str!("../../examples/table1.json");
const SEPARATING: &str = include_str!("../../examples/given_stiffness.json");
const CHECKED: &str = "document.querySelector('#check-state').classList.contains('good')";
const SHOWN: &str = "document.querySelector('[data-ready]')";

/// Light load and little damping over speed: jumps, two motions at one speed, and chaos.
fn jumps() -> Value {
    example(SEPARATING, |document| {
        document["kind"] = json!("sweep");
        document["name"] = json!("Light load over speed, up and down");
        document["operation"]["pinion_torque_nm"] = json!(60);
        document["model"]["mesh_damping_ratio"] = json!(0.01);
        document["design"]["backlash_um"] = json!(20);
        document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 1500, "to": 6000, "points": 121}]);
        document["continuation"] = json!("both");
        document["record"] = json!(["poincare"]);
        document["analysis"] = json!({"method": "integrate", "mesh_periods": 200, "record_mesh_periods": 60});
    })
}

fn map() -> Value {
    example(TABLE_1, |document| {
        document["kind"] = json!("sweep");
        document["name"] = json!("Helix angle and face width");
        document["axes"] = json!([
            {"pointer": "/design/helix_angle_deg", "from": 20, "to": 32, "points": 13},
            {"pointer": "/design/face_width_mm", "from": 55, "to": 115, "points": 13},
        ]);
    })
}

#[tokio::test]
#[ignore = "makes pictures: scripts/screenshots"]
async fn pictures_of_every_page() {
    flow(async |browser| {
        browser.open("/nowhere").await;
        let sweep = browser.submitted(&jumps()).await;
        let grid = browser.submitted(&map()).await;
        let result = browser.solved(&example(TABLE_1, |_| {})).await;
        let separating = browser.solved(&example(SEPARATING, |_| {})).await;
        let relieved = browser.solved(&serde_json::from_str(include_str!("../../examples/tip_relief.json")).unwrap()).await;
        let failing = example(SEPARATING, |document| {
            document["name"] = json!("Started far from rest");
            document["analysis"]["initial_state"] = json!(vec![1e6; 24]);
        });
        let failed = browser.solved(&failing).await;
        browser.ended(&sweep).await;
        browser.ended(&grid).await;
        let endless = example(TABLE_1, |document| {
            document["kind"] = json!("sweep");
            document["name"] = json!("Speed and torque, finely");
            document["axes"] = json!([
                {"pointer": "/operation/pinion_speed_rpm", "from": 300, "to": 6000, "points": 600},
                {"pointer": "/operation/pinion_torque_nm", "from": 100, "to": 1000, "points": 100},
            ]);
        });
        let long = browser.submitted(&endless).await;

        takes(browser, "design", "/", CHECKED).await;
        browser.prefer_dark(false).await;
        browser.open("/").await;
        browser.until(CHECKED).await;
        browser.fill("/design/helix_angle_deg", "77").await;
        browser.fill("/design/pinion/teeth", "seventeen").await;
        browser.element("#submit").await.click().await.unwrap();
        browser.until("!document.querySelector('#problems').hidden && document.querySelectorAll('[aria-invalid=true]').length === 2").await;
        take(browser, "design-errors", 1400).await;

        takes(browser, "jobs", "/jobs", "document.querySelectorAll('tr[data-id]').length >= 6 && document.querySelector('progress')").await;
        let cancel = "const done = arguments[1]; fetch(`/api/v1/jobs/${arguments[0]}/cancel`, {method: 'POST'}).then(() => done());";
        browser.driver.execute_async(cancel, vec![json!(long)]).await.unwrap();
        browser.prefer_dark(false).await;

        // For the README: as much as a high window shows.
        browser.open(&format!("/jobs/{separating}")).await;
        browser.until(SHOWN).await;
        take(browser, "overview", 1950).await;
        takes(browser, "result", &format!("/jobs/{result}"), SHOWN).await;
        takes(browser, "failed", &format!("/jobs/{failed}"), "document.querySelector('#state')?.textContent === 'failed'").await;
        browser.prefer_dark(false).await;
        browser.open(&format!("/jobs/{result}/report")).await;
        browser.until(SHOWN).await;
        take(browser, "report", LONGEST).await;

        takes(browser, "sweep", &format!("/jobs/{sweep}"), SHOWN).await;
        browser.prefer_dark(false).await;
        browser.open(&format!("/jobs/{sweep}")).await;
        browser.until(SHOWN).await;
        browser.value("document.querySelector('#sweep-views input[value=bifurcation]').click()").await;
        browser.until("document.querySelector('#sweep-plot').data?.some(({mode}) => mode === 'markers')").await;
        take(browser, "sweep-bifurcation", 1300).await;
        browser.resize(1280).await;
        browser.open(&format!("/jobs/{grid}")).await;
        browser.until(SHOWN).await;
        take(browser, "sweep-map", 2000).await;

        let compared = format!("/compare?jobs={result},{relieved}");
        takes(browser, "compare", &compared, "document.querySelector('#curves[data-ready]')").await;
        browser.prefer_dark(false).await;
        browser.open("/nowhere").await;
        take(browser, "not-found", 500).await;
    })
    .await;
}

/// What scripts have drawn on the page of a job on shafts: deflections, and a mode that stands still.
const SHAFTS_DRAWN: &str = "document.querySelector('#job')?.dataset.ready && document.querySelectorAll('#deflection-drawing .deflected').length === 4 \
    && document.querySelector('#mode-drawing .deflected')";

#[tokio::test]
#[ignore = "makes pictures: scripts/screenshots"]
async fn pictures_of_shafts() {
    flow(async |browser| {
        browser.open("/nowhere").await;
        let straddle = browser.solved(&example(include_str!("../../examples/shafts.json"), |_| {})).await;
        let overhung = browser.solved(&example(include_str!("../../examples/shafts_overhung.json"), |_| {})).await;
        // Modes that move would be caught at any moment.
        let calm = json!({"features": [{"name": "prefers-reduced-motion", "value": "reduce"}]});
        browser.command("Emulation.setEmulatedMedia", calm).await;
        for (name, width) in [("", 1280), ("-narrow", 390)] {
            browser.resize(width).await;
            browser.open(&format!("/jobs/{straddle}")).await;
            browser.until(SHAFTS_DRAWN).await;
            take_section(browser, &format!("shafts{name}"), "#shafts").await;
            take_section(browser, &format!("shafts-modes{name}"), "#rotor").await;
            take_section(browser, &format!("shafts-bearings{name}"), "#bearings").await;
        }
        browser.resize(1280).await;
        browser.open(&format!("/jobs/{overhung}")).await;
        browser.until(SHAFTS_DRAWN).await;
        take_section(browser, "shafts-overhung", "#shafts").await;
        let compared = format!("/compare?jobs={straddle},{overhung}");
        browser.open(&compared).await;
        browser.until("document.querySelector('#curves[data-ready]')").await;
        take(browser, "shafts-compare", LONGEST).await;
        // The form draws the shafts as one types.
        browser.open("/").await;
        browser.until(CHECKED).await;
        browser.choose("#start-from", "shafts").await;
        browser
            .until(&format!(
                "document.querySelector('#start-note').textContent.includes('Both shafts drawn') && {CHECKED}"
            ))
            .await;
        browser.value("document.querySelector('#group-shafts').open = true").await;
        take(browser, "shafts-design", 2200).await;
    })
    .await;
}

#[tokio::test]
#[ignore = "makes pictures: scripts/screenshots"]
async fn pictures_of_the_login() {
    flow_against(
        || Server::start_with_token("a-token-for-pictures"),
        async |browser| {
            browser.resize(1280).await;
            browser.open("/").await;
            browser.until("document.querySelector('#token')").await;
            take(browser, "login", 600).await;
        },
    )
    .await;
}

#[test]
fn pictures_are_read_as_they_were_sent() {
    assert_eq!(decoded("aGVycmluZ2JvbmU="), b"herringbone");
    assert_eq!(decoded("aGVycmluZ2JvbmVz"), b"herringbones");
}
