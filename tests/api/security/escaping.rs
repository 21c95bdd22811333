//! Names and labels are the clients' words: markup in them stays text.
//!
//! Pages are shells without data: their scripts fetch it as JSON and set it as text, never as markup, which a test over
//! the scripts holds. What a spreadsheet makes of a cell that starts with `=` is out of scope: the one CSV has numbers
//! only.

use super::*;
use std::path::Path;

const NAME: &str = "<script>alert(1)</script>";
const LABEL: &str = "\"'><img src=x onerror=alert(1)>";

#[tokio::test]
async fn markup_in_names_and_labels_is_answered_as_json_text() {
    let app = app().await;
    let mut document = document();
    document["name"] = NAME.into();
    document["label"] = LABEL.into();
    let (path, job) = app.run(&document).await;
    assert_eq!((job["name"].as_str(), job["label"].as_str()), (Some(NAME), Some(LABEL)));
    let filter = "/api/v1/jobs?label=%22%27%3E%3Cimg%20src%3Dx%20onerror%3Dalert(1)%3E";
    assert_eq!(app.get(filter).await.json["items"].as_array().map(Vec::len), Some(1));
    for path in
        [path.clone(), format!("{path}/input"), format!("{path}/result"), format!("{path}/series"), filter.to_owned()]
    {
        // A browser that is led there by a link takes it for data, whatever it likes best.
        let answer = app.get_with(&path, &[("accept", "text/html,*/*;q=0.8")]).await;
        assert_eq!((answer.status, answer.header("content-type")), (200, "application/json"), "{path}");
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
    }
    let csv = app.get_with(&format!("{path}/series/a_x_left"), &[("accept", "text/csv")]).await;
    assert!(csv.header("content-type").starts_with("text/csv"));
    assert!(csv.text().lines().skip(1).all(|line| line.split(',').all(|cell| cell.parse::<f64>().is_ok())));
    let id = path.rsplit('/').next().expect("an id");
    for page in ["/", "/jobs", &format!("/jobs/{id}"), &format!("/?from={id}")] {
        let text = app.get(page).await.text();
        assert!(!text.contains("alert(1)"), "{page}");
    }
}

#[tokio::test]
async fn markup_in_addresses_and_parameters_comes_back_as_text() {
    let app = guarded().await;
    let (name, value) = bearer();
    let (authorized, markup) = ((name, value.as_str()), "%22%3E%3Cscript%3Ealert(1)%3C%2Fscript%3E");
    for path in ["/jobs/", "/?from=", "/login?next=/", "/nothing", "/problems/", "/assets/", "/docs/"] {
        let answer = app.get_with(&format!("{path}{markup}"), &[authorized, ("accept", "text/html")]).await;
        assert!(!answer.text().contains("<script>alert"), "{path}: {}", answer.text());
    }
    let answer = app.get_with(&format!("/api/v1/jobs?{markup}={markup}"), &[authorized]).await;
    answer.assert_problem(400, "invalid-parameter");
    let odd = format!("/api/v1/jobs/{markup}");
    app.get_with(&odd, &[authorized, ("accept", "text/html,*/*;q=0.1")]).await.assert_problem(404, "not-found");
}

#[test]
fn no_script_of_a_page_takes_data_for_markup() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/web/assets");
    let mut folders = vec![assets];
    let mut scripts = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("assets") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            if path.extension().is_none_or(|extension| extension != "js") {
                continue;
            }
            let text = std::fs::read_to_string(&path).expect("text");
            for markup in
                ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "new Function", "DOMParser"]
            {
                assert!(!text.contains(markup), "{markup} in {}", path.display());
            }
            scripts += 1;
        }
    }
    assert!(scripts > 10, "{scripts} scripts");
}
