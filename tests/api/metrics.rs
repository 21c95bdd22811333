//! `/metrics`: the format's grammar line by line, and what may be a label.

use crate::support::*;
use std::collections::{BTreeMap, BTreeSet};

type Labels = BTreeMap<String, String>;

/// One sample.
#[derive(Debug)]
struct Sample {
    name: String,
    labels: Labels,
    value: f64,
}

/// A page of metrics.
#[derive(Debug, Default)]
struct Page {
    types: BTreeMap<String, String>,
    helps: BTreeSet<String>,
    samples: Vec<Sample>,
}

fn is_name(text: &str) -> bool {
    let mut characters = text.chars();
    characters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_' || first == ':')
        && characters.all(|character| character.is_ascii_alphanumeric() || character == '_' || character == ':')
}

/// The labels between braces, and what follows them.
fn labels(text: &str) -> (Labels, &str) {
    let mut found = BTreeMap::new();
    let mut rest = text;
    loop {
        let (name, after) = rest.split_once("=\"").expect("a label's name");
        assert!(is_name(name) && !name.contains(':'), "label {name}");
        let mut value = String::new();
        let mut characters = after.char_indices();
        let end = loop {
            match characters.next().expect("an end of the value") {
                (_, '\\') => match characters.next().expect("an escaped character").1 {
                    'n' => value.push('\n'),
                    character @ ('\\' | '"') => value.push(character),
                    other => panic!("\\{other} is no escape"),
                },
                (at, '"') => break at,
                (_, character) => value.push(character),
            }
        };
        assert!(found.insert(name.to_owned(), value).is_none(), "{name} twice");
        rest = &after[end + 1..];
        match rest.strip_prefix(',') {
            Some(more) if !more.starts_with('}') => rest = more,
            _ => return (found, rest.trim_start_matches(',').strip_prefix('}').expect("a closing brace")),
        }
    }
}

fn sample(line: &str) -> Sample {
    let end = line.find(['{', ' ']).expect("a name and a value");
    let (name, rest) = line.split_at(end);
    assert!(is_name(name), "{line}");
    let (labels, rest) = match rest.strip_prefix('{') {
        Some(inside) => labels(inside),
        None => (BTreeMap::new(), rest),
    };
    let value = rest.strip_prefix(' ').unwrap_or_else(|| panic!("{line}"));
    let value = match value {
        "+Inf" => f64::INFINITY,
        "-Inf" => f64::NEG_INFINITY,
        number => number.parse().unwrap_or_else(|error| panic!("{error}: {line}")),
    };
    Sample { name: name.to_owned(), labels, value }
}

/// Reads the text format, version 0.0.4; panics where it is broken.
fn parsed(text: &str) -> Page {
    assert!(text.ends_with('\n'), "the last line ends too");
    let mut page = Page::default();
    for line in text.lines().filter(|line| !line.is_empty()) {
        if let Some(help) = line.strip_prefix("# HELP ") {
            let (name, text) = help.split_once(' ').unwrap_or_else(|| panic!("{line}"));
            assert!(is_name(name) && !text.is_empty() && page.helps.insert(name.to_owned()), "{line}");
        } else if let Some(kind) = line.strip_prefix("# TYPE ") {
            let (name, kind) = kind.split_once(' ').unwrap_or_else(|| panic!("{line}"));
            assert!(["counter", "gauge", "histogram", "summary"].contains(&kind), "{line}");
            assert!(!page.samples.iter().any(|sample| sample.name == name), "{name}: TYPE comes first");
            assert!(page.types.insert(name.to_owned(), kind.to_owned()).is_none(), "{name}: one TYPE");
        } else {
            assert!(!line.starts_with('#'), "{line}");
            page.samples.push(sample(line));
        }
    }
    page
}

impl Page {
    /// The metric that a sample belongs to.
    fn family(&self, sample: &Sample) -> String {
        let base = ["_bucket", "_sum", "_count"].iter().find_map(|suffix| sample.name.strip_suffix(suffix));
        match base.filter(|base| self.types.get(*base).is_some_and(|kind| kind == "histogram")) {
            Some(base) => base.to_owned(),
            None => sample.name.clone(),
        }
    }

    fn value(&self, name: &str, labels: &[(&str, &str)]) -> Option<f64> {
        let fits = |sample: &&Sample| {
            sample.name == name
                && labels.iter().all(|(name, value)| sample.labels.get(*name).is_some_and(|found| found == value))
        };
        self.samples.iter().find(fits).map(|sample| sample.value)
    }
}

/// Buckets grow up to `+Inf`, which is the count.
fn check_histograms(page: &Page) {
    let mut series: BTreeMap<(String, Labels), Vec<(f64, f64)>> = BTreeMap::new();
    for sample in &page.samples {
        if let Some(base) = sample.name.strip_suffix("_bucket") {
            let mut labels = sample.labels.clone();
            let bound = labels.remove("le").expect("a bound");
            let bound = if bound == "+Inf" { f64::INFINITY } else { bound.parse().expect("a number") };
            series.entry((base.to_owned(), labels)).or_default().push((bound, sample.value));
        }
    }
    for ((name, labels), buckets) in series {
        assert!(buckets.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 <= pair[1].1), "{name} {labels:?}");
        let labels: Vec<_> = labels.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
        let count = page.value(&format!("{name}_count"), &labels).expect("a count");
        assert_eq!(buckets.last(), Some(&(f64::INFINITY, count)), "{name}");
        assert!(page.value(&format!("{name}_sum"), &labels).is_some_and(|sum| sum >= 0.0), "{name}");
    }
}

#[tokio::test]
async fn every_line_fits_the_format_and_no_label_names_a_job() {
    let app = app().await;
    let (path, job) = app.run(&document()).await;
    app.run(&scripted("fail")).await;
    app.run(&scripted("panic")).await;
    app.get(&format!("{path}/result")).await;
    app.get("/panics").await;
    app.get("/no/such/place").await;
    let page = parsed(&app.get("/metrics").await.text());
    check_histograms(&page);
    let id = job["id"].as_str().unwrap();
    let known = [
        "method",
        "route",
        "status",
        "kind",
        "state",
        "le",
        "stage",
        "part",
        "reason",
        "in",
        "version",
        "solver_version",
    ];
    let mut per_family: BTreeMap<String, usize> = BTreeMap::new();
    for sample in &page.samples {
        let family = page.family(sample);
        assert!(page.types.contains_key(&family), "{family} has no TYPE");
        assert!(page.helps.contains(&family), "{family} has no HELP");
        for (name, value) in &sample.labels {
            assert!(known.contains(&name.as_str()), "label {name} of {family}");
            assert!(!value.contains(id) && !value.contains("/no/such"), "{family} {name}={value}");
        }
        *per_family.entry(family).or_default() += 1;
    }
    for (family, samples) in per_family {
        assert!(samples < 1000, "{family} has {samples} lines");
    }
}

/// docs/OPERATIONS.md lists what there is, and nothing else.
#[tokio::test]
async fn every_metric_is_documented() {
    let app = app().await;
    app.run(&document()).await;
    let page = parsed(&app.get("/metrics").await.text());
    let text = include_str!("../../docs/OPERATIONS.md");
    let rows: Vec<_> = text.lines().filter(|line| line.starts_with("| `herringbone_")).collect();
    let documented: BTreeSet<_> = rows
        .iter()
        .flat_map(|line| line.split(" | ").next().unwrap_or_default().split('`').filter(|word| is_name(word)))
        .collect();
    // A metric has its line from its first value on: some need an event that does not come here.
    for family in page.types.keys() {
        assert!(documented.contains(family.as_str()), "docs/OPERATIONS.md lacks {family}");
    }
    for family in documented {
        let needs_an_event = family == "herringbone_stage_reuse_total";
        assert!(needs_an_event || page.types.contains_key(family), "there is no {family}");
    }
}

#[tokio::test]
async fn what_happens_is_counted() {
    let app = app().await;
    let before = parsed(&app.get("/metrics").await.text());
    let twice = document();
    let (path, _) = app.run(&twice).await;
    app.run(&twice).await;
    app.run(&scripted("stage")).await;
    app.run(&scripted("panic")).await;
    app.get("/panics").await;
    app.solver.breakpoints.hold("solve");
    let watched = app.submit(&document()).await;
    let mut events = app.events(&watched, &[]).await;
    events.next().await.expect("the job as it stands");
    let page = parsed(&app.get("/metrics").await.text());
    // Other tests of this process count too: only "at least" can be said.
    let grew = |name: &str, labels: &[(&str, &str)], by: f64| {
        let (was, is) = (before.value(name, labels).unwrap_or(0.0), page.value(name, labels).unwrap_or(0.0));
        assert!(is - was >= by, "{name} {labels:?}: {was} to {is}");
    };
    grew("herringbone_queue_wait_seconds_count", &[("kind", "response")], 3.0);
    grew("herringbone_stage_duration_seconds_count", &[("stage", "mesh")], 1.0);
    grew("herringbone_stage_reuse_total", &[("stage", "result")], 1.0);
    grew("herringbone_panics_total", &[("in", "job")], 1.0);
    grew("herringbone_panics_total", &[("in", "request")], 1.0);
    assert!(page.value("herringbone_event_streams", &[]).is_some_and(|streams| streams >= 1.0));
    for part in ["used", "file", "log"] {
        let bytes = page.value("herringbone_database_bytes", &[("part", part)]);
        assert!(bytes.is_some_and(|bytes| bytes >= if part == "log" { 0.0 } else { 4096.0 }), "{part}: {bytes:?}");
    }
    assert_eq!(page.value("herringbone_build_info", &[("version", env!("CARGO_PKG_VERSION"))]), Some(1.0));
    assert!(page.value("herringbone_uptime_seconds", &[]).is_some_and(|seconds| seconds >= 0.0));
    if cfg!(target_os = "linux") {
        assert!(page.value("herringbone_resident_memory_bytes", &[]).is_some_and(|bytes| bytes > 1e6));
    }
    app.solver.breakpoints.release("solve");
    app.ended(&watched).await;
    app.delete(&path).await;
}
