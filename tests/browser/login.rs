//! A service with a token.

use crate::browser::{flow, flow_against};
use crate::job::{submit, succeeded};
use crate::server::Server;

const TOKEN: &str = "a-token-for-a-browser";

#[tokio::test]
async fn a_person_logs_in_works_and_logs_out() {
    flow_against(|| Server::start_with_token(TOKEN), async |browser| {
        browser.open("/jobs?state=failed").await;
        browser.until("location.pathname === '/login'").await;
        browser.element("#token").await.send_keys("wrong-wrong-wrong-wrong").await.unwrap();
        browser.element("main button").await.click().await.unwrap();
        browser.until("document.querySelector('[role=alert]')?.textContent.includes('not the token')").await;
        browser.element("#token").await.send_keys(TOKEN).await.unwrap();
        browser.element("main button").await.click().await.unwrap();
        browser.until("location.pathname === '/jobs' && location.search === '?state=failed'").await;

        browser.element("nav a[href='/']").await.click().await.unwrap();
        browser.until("location.pathname === '/'").await;
        browser.choose("[data-pointer='/kind'] select", "mesh").await;
        submit(browser).await;
        succeeded(browser).await;

        // The session ends elsewhere: the page leads back to the login.
        let script = "const done = arguments[0]; fetch('/logout', {method: 'POST'}).then((answer) => done(answer.status), (error) => done(String(error)));";
        browser.driver.execute_async(script, Vec::new()).await.unwrap();
        browser.element("nav a[href='/jobs']").await.click().await.unwrap();
        browser.until("location.pathname === '/login' && location.search === '?next=/jobs'").await;
        browser.element("#token").await.send_keys(TOKEN).await.unwrap();
        browser.element("main button").await.click().await.unwrap();
        browser.until("location.pathname === '/jobs'").await;
        browser.element(".logout button").await.click().await.unwrap();
        browser.until("location.pathname === '/login'").await;
        browser.open("/").await;
        browser.until("location.pathname === '/login'").await;
    })
    .await;
}

/// The documentation page needs nothing that the policy forbids: its console is empty.
#[tokio::test]
async fn the_documentation_page_keeps_to_the_policy() {
    flow(async |browser| {
        browser.open("/docs/").await;
        browser.until("document.querySelectorAll('.opblock').length > 10").await;
        browser.element(".opblock-summary-control").await.click().await.unwrap();
        browser.until("document.querySelector('.opblock-body')").await;
    })
    .await;
}
