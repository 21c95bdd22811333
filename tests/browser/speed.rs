//! What makes pages quick, as far as it can be counted: the script for plots (the only large file)
//! comes where a plot is. `scripts/page-speed` measures times.

use crate::browser::flow;
use crate::pages;
use serde_json::json;

#[tokio::test]
async fn the_script_for_plots_comes_only_where_a_plot_is() {
    flow(async |browser| {
        for page in pages::all(browser).await {
            browser.requests().await;
            page.open(browser).await;
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
