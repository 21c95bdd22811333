//! Every page of the service, each in the states that people meet: for what holds of all of them.

use crate::browser::Browser;
use crate::rotor::on_shafts;
use serde_json::{Value, json};

/// A page with something on it.
pub(crate) struct Page {
    pub name: &'static str,
    pub path: String,
    /// True when everything is there: a JavaScript expression.
    ready: &'static str,
    /// Of the form: whether it is then filled in wrongly and submitted.
    spoilt: bool,
    pub has_plot: bool,
}

impl Page {
    fn new(name: &'static str, path: impl Into<String>, ready: &'static str) -> Self {
        Self { name, path: path.into(), ready, spoilt: false, has_plot: false }
    }

    fn with_plot(self) -> Self {
        Self { has_plot: true, ..self }
    }

    /// Whether the page is as its address gives it.
    pub(crate) fn can_be_timed(&self) -> bool {
        !self.spoilt
    }

    /// Opens the page and waits until everything is there.
    pub(crate) async fn open(&self, browser: &Browser) {
        if self.path == "/" {
            // The form keeps a draft of what was changed; here it starts as for somebody new.
            browser.open("/nowhere").await;
            browser.value("(localStorage.clear(), sessionStorage.clear())").await;
        }
        browser.open(&self.path).await;
        browser.until(self.ready).await;
        if self.spoilt {
            browser.fill("/design/helix_angle_deg", "77").await;
            browser.click("#submit").await;
            browser
                .until("!document.querySelector('#problems').hidden && document.querySelector('[aria-invalid=true]')")
                .await;
        }
    }
}

const CHECKED: &str = "document.querySelector('#check-state').classList.contains('good')";
const COMPARED: &str = "document.querySelector('#curves[data-ready]')";
const HELP: &str = "document.querySelector('article h1') && document.readyState === 'complete'";
const SHOWN: &str = "document.querySelector('[data-ready]')";

/// All pages of a service without a token, with jobs that it has solved for them.
pub(crate) async fn all(browser: &Browser) -> Vec<Page> {
    browser.open("/nowhere").await;
    let example: Value = serde_json::from_str(include_str!("../../examples/table1.json")).unwrap();
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut document = example.clone();
        change(&mut document);
        document
    };
    let response = browser.solved(&example).await;
    let other = browser.solved(&changed(&|document| document["operation"]["pinion_torque_nm"] = json!(400))).await;
    let mesh = browser.solved(&changed(&|document| document["kind"] = json!("mesh"))).await;
    let sweep = browser
        .solved(&changed(&|document| {
            document["kind"] = json!("sweep");
            document["name"] = json!("Three speeds");
            document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1000, 2000, 3000]}]);
        }))
        .await;
    let failed = browser
        .solved(&changed(&|document| {
            document["name"] = json!("Far from rest");
            document["analysis"]["method"] = json!("integrate");
            document["analysis"]["initial_state"] = json!(vec![1e6; 24]);
        }))
        .await;
    let quick = |change: &dyn Fn(&mut Value)| {
        let mut document: Value = serde_json::from_str(include_str!("../../examples/given_stiffness.json")).unwrap();
        document["analysis"] = json!({"accuracy": 1e-3});
        change(&mut document);
        document
    };
    let acceleration = "/response/rms/mesh_circumferential_acceleration_m_s2";
    let optimisation = browser
        .solved(&quick(&|document| {
            document["kind"] = json!("optimise");
            document["variables"] =
                json!([{"pointer": "/operation/pinion_speed_rpm", "from": 1500, "to": 3000, "step": 10}]);
            document["objectives"] = json!([{"measure": acceleration}]);
            document["budget"] = json!({"evaluations": 30});
        }))
        .await;
    let scatter = browser
        .solved(&quick(&|document| {
            document["kind"] = json!("tolerance");
            document["tolerances"] = json!([{"pointer": "/operation/pinion_torque_nm", "tolerance": 5},
                {"pointer": "/design/supports/damping_ratio", "distribution": "uniform", "plus": 0.01}]);
            document["measures"] = json!([{"measure": acceleration}]);
            document["samples"] = json!(64);
        }))
        .await;
    let shafts = browser.solved(&on_shafts()).await;
    vec![
        Page::new("design", "/", CHECKED),
        Page { spoilt: true, ..Page::new("design with errors", "/", CHECKED) },
        Page::new("system", "/system", "document.querySelectorAll('#service dt').length === 6"),
        Page::new("jobs", "/jobs", "document.querySelectorAll('tr[data-id]').length === 8"),
        Page::new("response", format!("/jobs/{response}"), SHOWN).with_plot(),
        Page::new("optimisation", format!("/jobs/{optimisation}"), SHOWN).with_plot(),
        Page::new("tolerance study", format!("/jobs/{scatter}"), SHOWN).with_plot(),
        Page::new("report", format!("/jobs/{response}/report"), SHOWN).with_plot(),
        Page::new("response on shafts", format!("/jobs/{shafts}"), SHOWN).with_plot(),
        Page::new("report on shafts", format!("/jobs/{shafts}/report"), SHOWN).with_plot(),
        Page::new("mesh", format!("/jobs/{mesh}"), SHOWN).with_plot(),
        Page::new("sweep", format!("/jobs/{sweep}"), SHOWN).with_plot(),
        Page::new("report of a sweep", format!("/jobs/{sweep}/report"), SHOWN).with_plot(),
        Page::new("compare", format!("/compare?jobs={response},{other}"), COMPARED).with_plot(),
        Page::new("report of a comparison", format!("/compare/report?jobs={response},{other}"), SHOWN).with_plot(),
        Page::new("compare nothing", "/compare", "document.querySelector('#compare').dataset.ready !== undefined"),
        Page::new(
            "failed job",
            format!("/jobs/{failed}"),
            "document.querySelector('#state')?.textContent === 'failed'",
        ),
        Page::new("help", "/help", HELP),
        Page::new("help: results", "/help/results", HELP),
        Page::new("help: inputs", "/help/inputs", HELP),
        Page::new("help: theory", "/help/theory/vibration", HELP),
        Page::new("help: validation", "/help/validation", HELP),
        Page::new("not found", "/nowhere", "document.readyState === 'complete'"),
    ]
}
