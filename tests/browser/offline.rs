//! The pages need this machine only. (No browser of these tests resolves any name but one, to this machine, and every
//! flow fails when a request goes elsewhere; here all pages are opened, and the policy is tried.)

use crate::browser::flow;
use crate::pages;
use serde_json::json;
use std::io::Read;
use std::net::TcpListener;

#[tokio::test]
async fn every_page_works_without_a_network() {
    flow(async |browser| {
        for page in pages::all(browser).await {
            page.open(browser).await;
            let requests = browser.requests().await;
            assert!(requests.contains(&page.path), "{}: {requests:?}", page.name);
        }
    })
    .await;
}

/// Not even a script that got into a page could send anything away: another origin on this machine, which would answer,
/// never gets a byte.
#[tokio::test]
async fn the_policy_keeps_scripts_from_other_origins() {
    flow(async |browser| {
        let elsewhere = TcpListener::bind("127.0.0.1:0").unwrap();
        elsewhere.set_nonblocking(true).unwrap();
        let url = format!("http://{}/", elsewhere.local_addr().unwrap());
        browser.open("/nowhere").await;
        browser.requests().await;
        let script = "const [url, done] = arguments; const told = []; \
            document.addEventListener('securitypolicyviolation', ({effectiveDirective, blockedURI}) => { \
              told.push(`${effectiveDirective} ${blockedURI}`); if (told.length === 4) done(told.sort()); }); \
            fetch(url, {mode: 'no-cors'}).catch(() => {}); \
            new Image().src = url; \
            const script = document.createElement('script'); script.src = url; document.head.append(script); \
            const frame = document.createElement('iframe'); frame.src = url; document.body.append(frame);";
        let told = browser.driver.execute_async(script, vec![json!(url)]).await.unwrap().json().clone();
        let origin = url.trim_end_matches('/');
        let expected = [
            format!("connect-src {url}"),
            format!("frame-src {origin}"),
            format!("img-src {url}"),
            format!("script-src-elem {url}"),
        ];
        assert_eq!(told, json!(expected));
        // The browser may have opened a connection in advance; it has sent nothing on it.
        while let Ok((mut connection, _)) = elsewhere.accept() {
            connection.set_nonblocking(true).unwrap();
            let sent = connection.read(&mut [0; 1]);
            assert!(!matches!(sent, Ok(1..)), "something was sent");
        }
        // The browser writes down what it refused, in the console and among the requests: here that is as it should be.
        browser.driver.get_log("performance").await.unwrap();
        assert!(browser.console().await.iter().any(|line| line.contains("Content Security Policy")));
    })
    .await;
}
