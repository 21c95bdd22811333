//! The page of a job on shafts: drawing, load along the faces, bearing forces with their file, modes in motion; the
//! report.

use crate::browser::{Browser, flow};
use crate::job::{STICKING_OUT, assert_complete, succeeded};
use serde_json::{Value, json};

/// A pair straddle-mounted by four fields, with a plain tooth model.
pub(crate) fn on_shafts() -> Value {
    json!({
        "kind": "response", "name": "On shafts",
        "design": {
            "normal_module_mm": 6, "pressure_angle_deg": 20, "pressure_angle_plane": "transverse", "helix_angle_deg": 24.43,
            "face_width_mm": 75, "gap_width_mm": 30, "pinion": {"teeth": 17}, "gear": {"teeth": 44},
            "shafts": {"arrangement": {"type": "straddle", "input": "left"}},
        },
        "operation": {"pinion_speed_rpm": 2000, "pinion_torque_nm": 800},
        "model": {"mesh_stiffness": {
            "source": "ltca", "fidelity": "uniform", "line_stiffness_n_per_mm_um": 14, "corner_contact": false,
        }},
    })
}

/// The place of a point of the mode that is drawn.
async fn place(browser: &Browser) -> String {
    let path = "document.querySelector('#mode-drawing .deflected.x').getAttribute('d')";
    browser.value(path).await.as_str().unwrap().to_owned()
}

async fn moves(browser: &Browser) -> Value {
    browser.value("document.querySelector('#mode-drawing').dataset.moves").await
}

#[tokio::test]
async fn a_job_on_shafts_shows_deflections_loads_bearing_forces_and_modes() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let id = browser.solved(&on_shafts()).await;
        browser.open(&format!("/jobs/{id}")).await;
        succeeded(browser).await;
        let result = browser.fetch(&format!("/api/v1/jobs/{id}/result")).await;

        // The drawing: both shafts, two deflected lines on each, four bearings with forces.
        for (selector, expected) in [("#deflection-drawing .shaft", 2), ("#deflection-drawing .deflected", 4)] {
            let count = browser.value(&format!("document.querySelectorAll('{selector}').length")).await;
            assert_eq!(count, json!(expected), "{selector}");
        }
        let forces = browser.value("document.querySelectorAll('#deflection-drawing .force').length").await;
        assert!(forces.as_u64() >= Some(4), "{forces}");
        assert!(browser.text("#deflection-factor").await.starts_with("magnified "));
        assert!(browser.text("#reactions").await.contains("Pinion, bearing 2"));
        let values = browser.text("#shafts-values").await;
        for words in ["Face load factor", "ISO 6336-1", "Proposed helix slope", "Transmission error between the couplings"] {
            assert!(values.contains(words), "{words}: {values}");
        }
        let headline = browser.text("#headline").await;
        assert!(headline.contains("Bearing force RMS, largest"), "{headline}");

        // Load along both faces: the numbers of the API.
        browser.value("document.querySelector('#face-load-plot').scrollIntoView()").await;
        browser.until("document.querySelector('#face-load-plot').data?.length === 4").await;
        let drawn = browser.value("document.querySelector('#face-load-plot').data[2].y").await;
        let stations = result["shafts"]["right"]["line_load_n_per_mm"].as_array().unwrap();
        assert_eq!(&drawn.as_array().unwrap()[1..=stations.len()], stations.as_slice());
        browser.until("document.querySelector('#torque-plot').data?.length >= 4").await;

        // Bearing forces: along y at first; x on request; nothing vibrates along z of all but the held gear.
        browser.value("document.querySelector('#bearings-plot').scrollIntoView()").await;
        browser.until("document.querySelector('#bearings-plot').data?.length === 4").await;
        let amplitudes = |axis: &str| result["response"]["bearings"][0]["force_n"][axis]["amplitudes"].clone();
        let first = "document.querySelector('#bearings-plot').data[0].y";
        assert_eq!(browser.value(first).await, amplitudes("y"));
        browser.value("document.querySelector('#bearing-axis-x').click()").await;
        let shown = format!("JSON.stringify({first}) === JSON.stringify({})", amplitudes("x"));
        browser.until(&shown).await;
        let table = browser.text("#bearings-table").await;
        assert!(table.contains("Order 10, N") && table.contains("Gear bearing 1"), "{table}");
        let href = browser.value("document.querySelector('#bearings-csv').getAttribute('href')").await;
        assert_eq!(href, json!(format!("/api/v1/jobs/{id}/bearing-forces")));
        let read = "const done = arguments[0]; fetch(document.querySelector('#bearings-csv').href).then((answer) => answer.text()).then(done)";
        let csv = browser.driver.execute_async(read, Vec::new()).await.unwrap().json().clone();
        let lines = csv.as_str().unwrap().lines().count();
        assert!(lines > 1 + 4 * 2 * 11 && csv.as_str().unwrap().starts_with("shaft,bearing,position_mm,axis"), "{csv}");

        // Modes: as many as the result has, the selected one moves, stands when paused, and can be another one.
        let modes = result["response"]["rotor"]["modes"].as_array().unwrap().len();
        assert_eq!(browser.value("document.querySelectorAll('#rotor-table tbody tr').length").await, json!(modes));
        browser.value("document.querySelector('#mode-drawing').scrollIntoView()").await;
        browser.until("document.querySelector('#mode-drawing').dataset.moves === 'true'").await;
        let before = place(browser).await;
        browser.until(&format!("document.querySelector('#mode-drawing .deflected.x').getAttribute('d') !== '{before}'")).await;
        browser.click("#mode-pause").await;
        assert_eq!((moves(browser).await, browser.text("#mode-pause").await), (json!("false"), "Move".to_owned()));
        let still = place(browser).await;
        tokio::time::sleep(std::time::Duration::from_millis(300)).await;
        assert_eq!(place(browser).await, still);
        browser.choose("#mode-select", "1").await;
        assert_ne!(place(browser).await, still);
        let described = browser.value("document.querySelector('#mode-drawing desc').textContent").await;
        assert!(described.as_str().unwrap().contains("mode 2: "), "{described}");

        // On paper nothing moves.
        browser.click("#mode-pause").await;
        browser.until("document.querySelector('#mode-drawing').dataset.moves === 'true'").await;
        browser.value("window.dispatchEvent(new Event('beforeprint'))").await;
        assert_eq!(moves(browser).await, json!("false"));
        browser.value("window.dispatchEvent(new Event('afterprint'))").await;
        // For people who want less motion it stands from the start.
        let calm = |value: &str| json!({"features": [{"name": "prefers-reduced-motion", "value": value}]});
        browser.command("Emulation.setEmulatedMedia", calm("reduce")).await;
        browser.driver.refresh().await.unwrap();
        succeeded(browser).await;
        browser.value("document.querySelector('#mode-drawing').scrollIntoView()").await;
        assert_eq!((moves(browser).await, browser.text("#mode-pause").await), (json!("false"), "Move".to_owned()));
        browser.command("Emulation.setEmulatedMedia", calm("")).await;
        assert_complete(browser).await;
        browser.driver.set_window_rect(0, 0, 390, 844).await.unwrap();
        assert_eq!(browser.value(STICKING_OUT).await, json!([]));
    })
    .await;
}

#[tokio::test]
async fn report_and_comparison_know_the_shafts() {
    flow(async |browser| {
        browser.open("/jobs").await;
        let mut other = on_shafts();
        other["design"]["shafts"] = json!({"arrangement": {"type": "overhung", "input": "left"}});
        let ids = [browser.solved(&on_shafts()).await, browser.solved(&other).await];
        browser.open(&format!("/jobs/{}/report", ids[0])).await;
        browser.until("document.querySelector('#report[data-ready]')").await;
        assert_eq!(browser.value("document.querySelectorAll('#mode-drawings svg').length").await, json!(4));
        assert!(browser.text("#shafts").await.contains("Pinion, bearing 1"));
        assert!(browser.text("#bearings-table").await.contains("Order 5, N"));
        let plots = browser
            .value("[...document.querySelectorAll('#figures figcaption')].map((node) => node.textContent)")
            .await;
        for title in [
            "Line load along both faces, on the shafts",
            "Face load factor over the torque",
            "Mesh orders of the bearing forces, y",
        ] {
            assert!(plots.as_array().unwrap().contains(&json!(title)), "{title} of {plots}");
        }
        let moving = browser.value("document.getAnimations().length").await;
        assert_eq!(moving, json!(0));
        assert_complete(browser).await;

        browser.open(&format!("/compare?jobs={}", ids.join(","))).await;
        browser.until("document.querySelector('#curves[data-ready]')").await;
        assert!(browser.text("#numbers-table").await.contains("Face load factor"));
        for id in ["face-load", "bearing-forces"] {
            assert_eq!(browser.value(&format!("document.getElementById('{id}').hidden")).await, json!(false), "{id}");
        }
    })
    .await;
}
