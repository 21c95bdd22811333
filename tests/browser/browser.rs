//! A headless Chromium for one flow.

use crate::process::Process;
use crate::server::{NAME, Server};
use futures_util::FutureExt;
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, resume_unwind};
use std::process::Command;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use thirtyfour::prelude::*;
use tokio::sync::Mutex;

const INSTALL: &str = "The browser tests need Chromium and its driver: run `scripts/prerequisites chromium` \
                       (on Debian: apt-get install chromium chromium-driver).";

/// How long a condition on the page may take to become true. Waiting costs nothing where it comes early, so the limit
/// is that of a machine that does much else; `HERRINGBONE_BROWSER_PATIENCE_S` is another one.
pub(crate) static PATIENCE: LazyLock<Duration> = LazyLock::new(|| {
    let given = std::env::var("HERRINGBONE_BROWSER_PATIENCE_S").ok();
    let seconds = given.map(|text| text.parse().expect("HERRINGBONE_BROWSER_PATIENCE_S is a number of seconds"));
    Duration::from_secs(seconds.unwrap_or(180))
});

/// Time between two looks at a condition.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// One browser at a time: several would only slow each other down.
static ONE_AT_A_TIME: Mutex<()> = Mutex::const_new(());

pub(crate) struct Browser {
    pub driver: WebDriver,
    pub server: Server,
    requested: AtomicUsize,
}

/// Runs a flow in a fresh browser against a fresh server, then checks the console and where requests went.
pub(crate) async fn flow(steps: impl AsyncFnOnce(&Browser)) {
    flow_against(Server::start, steps).await;
}

/// The same against a particular server.
pub(crate) async fn flow_against(server: impl FnOnce() -> Server, steps: impl AsyncFnOnce(&Browser)) {
    let _turn = ONE_AT_A_TIME.lock().await;
    let server = server();
    let mut command = Command::new(std::env::var("CHROMEDRIVER").unwrap_or_else(|_| "chromedriver".to_owned()));
    command.arg("--port=0");
    let process = Process::start(command, INSTALL);
    let port = process.wait_for("port of chromedriver", |line| {
        let (_, rest) = line.split_once("started successfully on port ")?;
        rest.trim_end_matches('.').parse::<u16>().ok()
    });
    let profile = tempfile::tempdir().unwrap();
    let capabilities = capabilities(profile.path().to_str().unwrap());
    let driver = match WebDriver::new(format!("http://127.0.0.1:{port}"), capabilities).await {
        Ok(driver) => driver,
        Err(error) => panic!("Chromium could not be started: {error}. {INSTALL}"),
    };
    driver.set_script_timeout(*PATIENCE).await.unwrap();
    let browser = Browser { driver, server, requested: AtomicUsize::new(0) };
    let outcome = AssertUnwindSafe(async {
        steps(&browser).await;
        browser.check_console().await;
        browser.check_requests().await;
    })
    .catch_unwind()
    .await;
    // A failed flow must not leave a browser behind.
    let _ = browser.driver.clone().quit().await;
    if let Err(panic) = outcome {
        resume_unwind(panic);
    }
}

fn capabilities(profile: &str) -> Capabilities {
    let mut arguments = vec![
        "--headless".to_owned(),
        "--disable-gpu".to_owned(),
        "--disable-dev-shm-usage".to_owned(),
        "--disable-quic".to_owned(),
        "--no-first-run".to_owned(),
        "--disable-background-networking".to_owned(),
        "--disable-component-update".to_owned(),
        "--disable-sync".to_owned(),
        "--window-size=1280,1000".to_owned(),
        // One name resolves, to this machine, and no other: whatever wanted to leave this machine fails, and shows in
        // the request log.
        format!("--host-resolver-rules=MAP {NAME} 127.0.0.1 , MAP * ~NOTFOUND , EXCLUDE 127.0.0.1"),
        // Containers and continuous integration run as root, where Chromium's sandbox does not start.
        "--no-sandbox".to_owned(),
    ];
    arguments.push(format!("--user-data-dir={profile}"));
    let mut options = json!({"args": arguments});
    if let Ok(path) = std::env::var("CHROMIUM") {
        options["binary"] = json!(path);
    }
    let logs = json!({"browser": "ALL", "performance": "ALL"});
    let all = json!({"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": logs});
    all.as_object().cloned().unwrap_or_default().into()
}

impl Browser {
    pub(crate) async fn open(&self, path: &str) {
        self.driver.goto(format!("{}{path}", self.server.url)).await.unwrap();
    }

    pub(crate) async fn element(&self, selector: &str) -> WebElement {
        let query = self.driver.query(By::Css(selector)).wait(*PATIENCE, LOOK_EVERY);
        query.first().await.unwrap_or_else(|error| panic!("{selector}: {error}"))
    }

    /// Clicks on an element, on the form once its check has been answered: the answer moves what is below a field.
    pub(crate) async fn click(&self, selector: &str) {
        self.until("!document.querySelector('#design[data-pending]')").await;
        let element = self.element(selector).await;
        // Away from what stays in sight at the edges of the window.
        element.scroll_into_view().await.unwrap();
        element.click().await.unwrap_or_else(|error| panic!("{selector}: {error}"));
    }

    /// The input of the field at a JSON pointer of the job document.
    pub(crate) async fn field(&self, pointer: &str) -> WebElement {
        self.element(&format!("[data-pointer='{pointer}'] :is(input, select, textarea)")).await
    }

    /// Replaces the text in a field as a person does.
    pub(crate) async fn fill(&self, pointer: &str, text: &str) {
        let input = self.field(pointer).await;
        input.clear().await.unwrap();
        input.send_keys(text).await.unwrap();
    }

    /// Chooses an option as the keyboard does: sets it and tells the page.
    pub(crate) async fn choose(&self, selector: &str, value: &str) {
        let script = "const node = document.querySelector(arguments[0]); node.value = arguments[1]; \
                      for (const name of ['input', 'change']) node.dispatchEvent(new Event(name, {bubbles: true})); \
                      return node.value;";
        let arguments = vec![json!(selector), json!(value)];
        let chosen: String = self.driver.execute(script, arguments).await.unwrap().convert().unwrap();
        assert_eq!(chosen, value, "{selector} has no such option");
    }

    pub(crate) async fn text(&self, selector: &str) -> String {
        self.element(selector).await.text().await.unwrap()
    }

    /// The value of a JavaScript expression.
    pub(crate) async fn value(&self, expression: &str) -> Value {
        let script = format!("return {expression};");
        let answer = self.driver.execute(&script, Vec::new()).await;
        answer.unwrap_or_else(|error| panic!("{expression}: {error}")).json().clone()
    }

    /// What `fetch` of a path of the API answers, as the page sees it.
    pub(crate) async fn fetch(&self, path: &str) -> Value {
        let script = "const done = arguments[1]; fetch(arguments[0]).then((answer) => answer.json()).then(done, (error) => done(String(error)));";
        self.driver.execute_async(script, vec![json!(path)]).await.unwrap().json().clone()
    }

    /// Submits a document as a page would (one has to be open); the job's id.
    pub(crate) async fn submitted(&self, document: &Value) -> String {
        let script = "const done = arguments[1]; const headers = {'Content-Type': 'application/json'}; \
                      fetch('/api/v1/jobs', {method: 'POST', headers, body: JSON.stringify(arguments[0])}) \
                      .then((answer) => answer.json()).then(done, (error) => done(String(error)));";
        let job = self.driver.execute_async(script, vec![document.clone()]).await.unwrap().json().clone();
        job["id"].as_str().unwrap_or_else(|| panic!("not accepted: {job}")).to_owned()
    }

    /// Waits until a job has ended, which may take longer than what a page does.
    pub(crate) async fn ended(&self, id: &str) {
        let deadline = Instant::now() + 10 * *PATIENCE;
        loop {
            let job = self.fetch(&format!("/api/v1/jobs/{id}")).await;
            if ["succeeded", "failed", "canceled"].iter().any(|state| job["state"] == *state) {
                return;
            }
            assert!(Instant::now() < deadline, "not ended: {job}");
            tokio::time::sleep(LOOK_EVERY).await;
        }
    }

    /// Submits a document and waits until its job has ended; its id.
    pub(crate) async fn solved(&self, document: &Value) -> String {
        let id = self.submitted(document).await;
        self.ended(&id).await;
        id
    }

    /// Makes the window so wide, also narrower than a desktop's windows can be.
    pub(crate) async fn resize(&self, width: u32) {
        let height = if width < 600 { 844 } else { 1000 };
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.command("Emulation.setDeviceMetricsOverride", size).await;
        assert_eq!(self.value("window.innerWidth").await, json!(width));
        // Scripts that follow the size of elements have run then.
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))").await;
    }

    /// Whether the system prefers dark pages.
    pub(crate) async fn prefer_dark(&self, dark: bool) {
        let scheme = json!({"name": "prefers-color-scheme", "value": if dark { "dark" } else { "light" }});
        self.command("Emulation.setEmulatedMedia", json!({"features": [scheme]})).await;
    }

    /// A command of the browser's own protocol.
    pub(crate) async fn command(&self, method: &str, parameters: Value) -> Value {
        self.driver.cdp().send_raw(method, parameters).await.unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// Waits until a JavaScript expression is true.
    pub(crate) async fn until(&self, expression: &str) {
        let deadline = Instant::now() + *PATIENCE;
        while self.value(&format!("Boolean({expression})")).await != json!(true) {
            if Instant::now() > deadline {
                let page = self.value("document.body.innerText").await;
                panic!("not within {:?}: {expression}\n{}", *PATIENCE, page.as_str().unwrap_or_default());
            }
            tokio::time::sleep(LOOK_EVERY).await;
        }
    }

    /// No error in the console. An answer outside 200–299 that the page handled shows there as well, though nothing
    /// went wrong in the page: those lines, of the browser's network code, are let through.
    async fn check_console(&self) {
        let log = self.driver.browser_log().await.unwrap();
        let errors: Vec<_> = log
            .iter()
            .filter(|entry| matches!(entry.level.as_str(), "SEVERE" | "WARNING"))
            .filter(|entry| !entry.message.contains("the server responded with a status of 4"))
            // Said of every page that comes by plain HTTP under a name.
            .filter(|entry| !entry.message.contains("Cross-Origin-Opener-Policy header has been ignored"))
            .map(|entry| entry.message.as_str())
            .collect();
        assert!(errors.is_empty(), "the console has {} errors:\n{}", errors.len(), errors.join("\n"));
    }

    /// What was requested from the server since this was last asked: paths with their queries. Whatever else was asked
    /// fails the flow.
    pub(crate) async fn requests(&self) -> Vec<String> {
        let mut paths = Vec::new();
        for entry in self.driver.get_log("performance").await.unwrap() {
            let event: Value = serde_json::from_str(&entry.message).unwrap();
            if event["message"]["method"] != "Network.requestWillBeSent" {
                continue;
            }
            let url = event["message"]["params"]["request"]["url"].as_str().unwrap();
            // The browser's own pages (chrome:) and what a page makes itself (data:, blob:) need no network.
            if ["chrome:", "data:", "blob:", "about:"].iter().any(|scheme| url.starts_with(scheme)) {
                continue;
            }
            let path = url.strip_prefix(&self.server.url).filter(|rest| rest.starts_with('/'));
            paths.push(path.unwrap_or_else(|| panic!("a request to {url}")).to_owned());
        }
        self.requested.fetch_add(paths.len(), Ordering::Relaxed);
        paths
    }

    async fn check_requests(&self) {
        self.requests().await;
        assert!(self.requested.load(Ordering::Relaxed) > 0, "the log of requests is empty: nothing was checked");
    }

    /// What the console says since this was last asked; what is read here is no matter of the check at the end.
    pub(crate) async fn console(&self) -> Vec<String> {
        self.driver.browser_log().await.unwrap().into_iter().map(|entry| entry.message).collect()
    }
}
