//! What makes pages quick, as far as it can be counted: nothing moves while a page fills, and the script for plots (the
//! only large file) comes where a plot is. `scripts/page-speed` measures times.

use crate::browser::{Browser, flow};
use crate::pages;
use serde_json::json;

/// How much of the window moved unasked, by how far (cumulative layout shift); and what moved most.
async fn shift(browser: &Browser) -> (f64, String) {
    let script = "const done = arguments[0]; const seen = []; \
        new PerformanceObserver((list) => seen.push(...list.getEntries())).observe({type: 'layout-shift', buffered: true}); \
        requestAnimationFrame(() => setTimeout(() => { \
          const counted = seen.filter((entry) => !entry.hadRecentInput); \
          const sources = counted.toSorted((a, b) => b.value - a.value).flatMap((entry) => entry.sources.map(({node}) => \
            `${entry.value.toFixed(4)} ${node?.nodeName} ${node?.id ?? ''} ${node?.className ?? ''}`)); \
          done([counted.reduce((sum, entry) => sum + entry.value, 0), sources.slice(0, 6).join('; ')]); }, 50));";
    let answer = browser.driver.execute_async(script, Vec::new()).await.unwrap().json().clone();
    (answer[0].as_f64().unwrap(), answer[1].as_str().unwrap().to_owned())
}

#[tokio::test]
async fn nothing_moves_while_a_page_fills() {
    flow(async |browser| {
        let mut moving = Vec::new();
        let pages = pages::all(browser).await;
        for width in [1280, 390] {
            browser.resize(width).await;
            for page in &pages {
                page.open(browser).await;
                let (sum, sources) = shift(browser).await;
                println!("{} at {width} px: {sum:.4} {sources}", page.name);
                if sum > 0.02 {
                    moving.push(format!("{} at {width} px: {sum:.4} {sources}", page.name));
                }
            }
        }
        assert!(moving.is_empty(), "{}", moving.join("\n"));
        // That would show: something comes in above the text.
        let insert = "const box = document.createElement('div'); box.style.height = '300px'; document.querySelector('main').prepend(box);";
        browser.driver.execute(insert, Vec::new()).await.unwrap();
        assert!(shift(browser).await.0 > 0.02);
    })
    .await;
}

#[tokio::test]
async fn the_script_for_plots_comes_only_where_a_plot_is() {
    flow(async |browser| {
        for page in pages::all(browser).await {
            browser.requests().await;
            page.open(browser).await;
            if page.has_plot {
                // It comes when the first plot is scrolled near.
                let look =
                    "[...document.querySelectorAll('.plot')].find((plot) => plot.clientHeight > 0)?.scrollIntoView()";
                browser.value(look).await;
                browser
                    .until("performance.getEntriesByType('resource').some(({name}) => name.includes('/plotly.js'))")
                    .await;
            }
            let requests = browser.requests().await;
            let came = requests.iter().any(|path| path.starts_with("/assets/plotly.js"));
            assert_eq!(came, page.has_plot, "{}: {requests:?}", page.name);
        }
    })
    .await;
}

/// A page's scripts are asked for at once, as told by the page, and not one after the other as each names the next.
#[tokio::test]
async fn a_pages_scripts_are_named_by_the_page() {
    flow(async |browser| {
        for page in pages::all(browser).await {
            page.open(browser).await;
            let late = "[...new Set(performance.getEntriesByType('resource').map(({name}) => new URL(name).pathname))] \
                .filter((path) => path.endsWith('.js') && path !== '/assets/plotly.js') \
                .filter((path) => !document.querySelector(`link[rel=modulepreload][href='${path}'], script[src='${path}']`))";
            assert_eq!(browser.value(late).await, json!([]), "{}", page.name);
        }
    })
    .await;
}

/// Prints how long pages take to come, for docs/BENCHMARKS.md: medians of visits with an empty cache, from the click to
/// the first and to the largest content that shows, to the end of loading; and what comes over the wire.
#[tokio::test]
#[ignore = "prints times: scripts/page-speed"]
async fn times_of_every_page() {
    const VISITS: usize = 15;
    flow(async |browser| {
        println!("| page | first content, ms | largest content, ms | loaded, ms | requests | kB | of these plots |\n|---|---|---|---|---|---|---|");
        for page in pages::all(browser).await.iter().filter(|page| page.can_be_timed()) {
            let mut visits = Vec::new();
            for _ in 0..VISITS {
                browser.command("Network.clearBrowserCache", json!({})).await;
                page.open(browser).await;
                visits.push(times(browser).await);
            }
            let median = |index: usize| {
                let mut values: Vec<f64> = visits.iter().map(|visit| visit[index]).collect();
                values.sort_by(f64::total_cmp);
                values[VISITS / 2]
            };
            let [first, largest, loaded, requests, all, plots] = [0, 1, 2, 3, 4, 5].map(median);
            println!(
                "| {} | {first:.0} | {largest:.0} | {loaded:.0} | {requests:.0} | {:.0} | {:.0} |",
                page.name, all / 1e3, plots / 1e3
            );
        }
    })
    .await;
}

async fn times(browser: &Browser) -> Vec<f64> {
    let script = "const done = arguments[0]; let largest = 0; \
        new PerformanceObserver((list) => { for (const entry of list.getEntries()) largest = Math.max(largest, entry.startTime); }) \
          .observe({type: 'largest-contentful-paint', buffered: true}); \
        requestAnimationFrame(() => setTimeout(() => { \
          const [page] = performance.getEntriesByType('navigation'); const files = performance.getEntriesByType('resource'); \
          const size = (list) => list.reduce((sum, entry) => sum + entry.transferSize, 0); \
          done([performance.getEntriesByName('first-contentful-paint')[0].startTime, largest, page.loadEventEnd, files.length + 1, \
            size([page, ...files]), size(files.filter(({name}) => name.includes('/plotly.js')))]); }, 50));";
    let answer = browser.driver.execute_async(script, Vec::new()).await.unwrap().json().clone();
    answer.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}
