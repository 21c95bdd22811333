//! `Authorization: Bearer`.

use super::*;

#[tokio::test]
async fn the_token_opens_every_path() {
    let app = guarded().await;
    for path in
        ["/", "/jobs", "/api/v1/jobs", "/api/v1/system", "/metrics", "/openapi.json", "/docs/", "/assets/job/page.js"]
    {
        for scheme in ["Bearer", "bearer", "BEARER"] {
            let header = format!("{scheme} {TOKEN}");
            assert_eq!(app.get_with(path, &[("authorization", &header)]).await.status, 200, "{path} {scheme}");
        }
    }
    let submitted = app.submit_with(&document(), &[("authorization", &bearer().1)]).await;
    assert_eq!(submitted.status, 202, "{submitted:?}");
}

#[tokio::test]
async fn without_it_only_probes_and_the_login_page_are_open() {
    let app = guarded().await;
    for open in ["/healthz", "/readyz", "/login", "/assets/common/style.css", "/assets/icon.svg"] {
        assert_eq!(app.get(open).await.status, 200, "{open}");
    }
    for closed in [
        "/",
        "/jobs",
        "/api/v1/jobs",
        "/api/v1/kinds",
        "/api/v1/system",
        "/metrics",
        "/openapi.json",
        "/docs",
        "/docs/",
        "/problems/internal",
        "/assets/job/page.js",
        "/assets/plotly.js",
        "/nothing",
        "/healthz/",
        "//healthz",
        "/%68ealthz",
        "/login/",
        "/assets/../metrics",
        "/api/v1/jobs/1/events",
        "/panics",
    ] {
        let answer = app.get(closed).await;
        answer.assert_problem(401, "unauthenticated");
        assert_eq!(answer.header("www-authenticate"), "Bearer", "{closed}");
    }
    let answer = app.submit_with(&document(), &[]).await;
    answer.assert_problem(401, "unauthenticated");
    app.delete("/api/v1/jobs/1").await.assert_problem(401, "unauthenticated");
}

#[tokio::test]
async fn what_is_nearly_the_token_is_not_the_token() {
    // Each has its own service, so that none is refused for the number of attempts.
    for wrong in [
        format!("Bearer {}", &TOKEN[..TOKEN.len() - 1]),
        format!("Bearer {}", &TOKEN[1..]),
        format!("Bearer {TOKEN}x"),
        format!("Bearer {}", TOKEN.to_uppercase()),
        format!("Bearer{TOKEN}"),
        format!("Basic {TOKEN}"),
        format!("Token {TOKEN}"),
        format!("Bearer {TOKEN}, Bearer {TOKEN}"),
        format!("Bearer \"{TOKEN}\""),
        TOKEN.to_owned(),
        "Bearer ".to_owned(),
        "Bearer".to_owned(),
        String::new(),
    ] {
        let app = guarded().await;
        let answer = app.get_with("/api/v1/jobs", &[("authorization", &wrong)]).await;
        answer.assert_problem(401, "unauthenticated");
        assert!(!answer.text().contains(TOKEN), "{answer:?}");
    }
    let app = guarded().await;
    let (name, value) = bearer();
    let twice = app.get_with("/api/v1/jobs", &[(name, &value), (name, "Bearer other")]).await;
    twice.assert_problem(401, "unauthenticated");
}

#[tokio::test]
async fn too_many_wrong_tokens_are_told_to_slow_down_and_lock_nobody_out() {
    let app = guarded().await;
    let wrong = [("authorization", "Bearer wrong-wrong-wrong-wrong")];
    let mut statuses = Vec::new();
    let slowed = loop {
        let answer = app.get_with("/api/v1/jobs", &wrong).await;
        statuses.push(answer.status);
        if answer.status != 401 {
            break answer;
        }
        assert!(statuses.len() < 1000, "no end of attempts");
    };
    slowed.assert_problem(429, "too-many-attempts");
    assert!(statuses.len() > 10, "{statuses:?}");
    assert_eq!(slowed.header("retry-after"), "1");
    let (name, value) = bearer();
    assert_eq!(app.get_with("/api/v1/jobs", &[(name, &value)]).await.status, 200);
    app.get("/api/v1/jobs").await.assert_problem(401, "unauthenticated");
}

#[tokio::test]
async fn an_open_service_asks_for_nothing_and_has_no_login() {
    let app = app().await;
    assert_eq!(app.get("/api/v1/jobs").await.status, 200);
    assert_eq!(app.get_with("/api/v1/jobs", &[("authorization", "Bearer whatever")]).await.status, 200);
    app.get("/login").await.assert_problem(404, "not-found");
    assert!(!app.get("/jobs").await.text().contains("/logout"));
}

#[tokio::test]
async fn what_is_answered_to_those_with_credentials_is_kept_by_nobody() {
    let app = guarded().await;
    let (name, value) = bearer();
    for path in ["/api/v1/jobs", "/api/v1/system", "/metrics", "/api/v1/jobs/1", "/openapi.json"] {
        let answer = app.get_with(path, &[(name, &value)]).await;
        assert_eq!(answer.header("cache-control"), "no-store", "{path}");
    }
    let job = app.submit_with(&document(), &[(name, &value)]).await;
    assert_eq!(job.header("cache-control"), "no-cache", "said by the route, which has an entity tag");
}
