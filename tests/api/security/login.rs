//! Sessions of browsers.

use super::*;
use axum::http::Method;

const BROWSER: (&str, &str) = ("accept", "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8");
const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");

async fn log_in(app: &App, token: &str, next: &str, headers: &[(&str, &str)]) -> Answer {
    let headers = [&[BROWSER, FORM], headers].concat();
    app.send(Method::POST, "/login", &headers, format!("token={token}&next={next}")).await
}

fn cookie_of(answer: &Answer) -> String {
    answer.header("set-cookie").split(';').next().unwrap_or_default().to_owned()
}

#[tokio::test]
async fn a_person_is_led_to_the_login_and_back() {
    let app = guarded().await;
    let led = app.get_with("/jobs?state=failed&label=a", &[BROWSER]).await;
    assert_eq!((led.status, led.header("location")), (303, "/login?next=/jobs%3Fstate%3Dfailed%26label%3Da"));
    let page = app.get_with(led.header("location"), &[BROWSER]).await;
    assert_eq!((page.status, page.header("cache-control")), (200, "no-store"));
    assert!(page.text().contains("name=\"next\" value=\"/jobs?state=failed&#38;label=a\""), "{}", page.text());
    assert_eq!(page.header("referrer-policy"), "same-origin", "else the form's origin is null");

    let entered = log_in(&app, TOKEN, "/jobs%3Fstate%3Dfailed%26label%3Da", &[]).await;
    assert_eq!((entered.status, entered.header("location")), (303, "/jobs?state=failed&label=a"));
    let cookie = entered.header("set-cookie");
    assert!(cookie.ends_with("; HttpOnly; SameSite=Strict; Path=/; Max-Age=43200"), "{cookie}");
    assert!(!cookie.contains(TOKEN));

    let session = cookie_of(&entered);
    for path in ["/jobs", "/", "/api/v1/jobs", "/metrics"] {
        assert_eq!(app.get_with(path, &[("cookie", &session)]).await.status, 200, "{path}");
    }
    let job = app.submit_with(&document(), &[("cookie", &session), ("sec-fetch-site", "same-origin")]).await;
    assert_eq!(job.status, 202, "{job:?}");
    assert!(app.get_with("/jobs", &[("cookie", &session)]).await.text().contains("action=\"/logout\""));

    let left = app.send(Method::POST, "/logout", &[BROWSER, ("cookie", &session)], "").await;
    assert_eq!((left.status, left.header("location")), (303, "/login"));
    assert!(
        left.header("set-cookie").starts_with("herringbone_session=; ")
            && left.header("set-cookie").contains("Max-Age=0")
    );
    app.get_with("/api/v1/jobs", &[("cookie", &session)]).await.assert_problem(401, "unauthenticated");
    let again = app.send(Method::POST, "/logout", &[BROWSER, ("cookie", &session)], "").await;
    assert_eq!((again.status, again.header("location")), (303, "/login"));
}

#[tokio::test]
async fn the_login_leads_to_no_other_site() {
    let app = guarded().await;
    for next in [
        "https://evil.example/",
        "//evil.example",
        "/%5Cevil.example",
        "%5C%5Cevil.example",
        "/%09/evil.example",
        "evil.example",
        "javascript:alert(1)",
        "%0d%0aset-cookie:%20a=b",
        "/a%0d%0aset-cookie:%20a=b",
        "/login",
        "",
    ] {
        let entered = log_in(&app, TOKEN, next, &[]).await;
        assert_eq!((entered.status, entered.header("location")), (303, "/"), "{next}");
        let page = app.get_with(&format!("/login?next={next}"), &[BROWSER]).await;
        assert!(page.text().contains("name=\"next\" value=\"/\""), "{next}: {}", page.text());
    }
    let led = app.get_with("//evil.example/x", &[BROWSER]).await;
    assert_eq!(led.header("location"), "/login?next=/");
}

#[tokio::test]
async fn a_wrong_token_opens_nothing() {
    let app = guarded().await;
    let refused = log_in(&app, "wrong-wrong-wrong-wrong", "/jobs", &[]).await;
    assert_eq!((refused.status, refused.header("set-cookie"), refused.header("www-authenticate")), (401, "", "Bearer"));
    assert!(refused.text().contains("This is not the token") && refused.text().contains("value=\"/jobs\""));
    assert!(!refused.text().contains("wrong-wrong"), "what was entered is not shown");
    app.send(Method::POST, "/login", &[FORM], "").await.assert_problem(401, "unauthenticated");
    app.send(Method::POST, "/login", &[], "token=x").await.assert_problem(415, "unsupported-media-type");
    let large = format!("token={}", "x".repeat(20_000));
    app.send(Method::POST, "/login", &[FORM], large).await.assert_problem(413, "payload-too-large");
    for cookie in ["herringbone_session=", "herringbone_session=0", "herringbone_session"] {
        app.get_with("/api/v1/jobs", &[("cookie", cookie)]).await.assert_problem(401, "unauthenticated");
    }
}

#[tokio::test]
async fn too_many_wrong_entries_are_told_to_wait() {
    let app = guarded().await;
    let mut answer = log_in(&app, "wrong", "/", &[]).await;
    for _ in 0..1000 {
        if answer.status != 401 {
            break;
        }
        answer = log_in(&app, "wrong", "/", &[]).await;
    }
    assert_eq!((answer.status, answer.header("retry-after")), (429, "1"));
    assert!(answer.header("content-type").starts_with("text/html"), "{answer:?}");
    assert_eq!(log_in(&app, TOKEN, "/", &[]).await.status, 303, "the right one is taken all the same");
}

#[tokio::test]
async fn only_pages_lead_to_the_login() {
    let app = guarded().await;
    for accept in ["application/json", "*/*", "application/problem+json, text/html;q=0.5", "text/event-stream"] {
        app.get_with("/api/v1/jobs", &[("accept", accept)]).await.assert_problem(401, "unauthenticated");
    }
    app.send(Method::POST, "/api/v1/jobs", &[BROWSER], "").await.assert_problem(401, "unauthenticated");
    let wrong = app.get_with("/jobs", &[BROWSER, ("authorization", "Bearer wrong-wrong-wrong-wrong")]).await;
    wrong.assert_problem(401, "unauthenticated");
}

#[tokio::test]
async fn the_cookie_is_for_tls_only_where_tls_is() {
    let app = guarded().await;
    for (headers, secure) in [
        (vec![], false),
        (vec![("x-forwarded-proto", "https")], true),
        (vec![("x-forwarded-proto", "http")], false),
        (vec![("host", "gears.example"), ("origin", "https://gears.example")], true),
        (vec![("host", "gears.example"), ("origin", "http://gears.example")], false),
    ] {
        let entered = log_in(&app, TOKEN, "/", &headers).await;
        assert_eq!(entered.header("set-cookie").contains("; Secure"), secure, "{headers:?}");
    }
}

#[tokio::test]
async fn another_site_cannot_log_a_browser_in_or_out() {
    let app = guarded().await;
    let foreign = [("host", "gears.example"), ("origin", "https://evil.example")];
    log_in(&app, TOKEN, "/", &foreign).await.assert_problem(403, "cross-origin");
    app.send(Method::POST, "/logout", &foreign, "").await.assert_problem(403, "cross-origin");
}
