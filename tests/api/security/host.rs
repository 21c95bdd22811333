//! Names that lead here without being ours.

use super::*;
use axum::http::Method;
use herringbone::api::Access;

async fn app_with_hosts(names: &[&str]) -> App {
    let allowed_hosts = names.iter().map(|name| name.parse().expect("a name")).collect();
    let access = AccessConfig { allowed_hosts, ..AccessConfig::default() };
    app_with_http(HttpConfig { access, ..HttpConfig::default() }).await
}

#[tokio::test]
async fn an_open_service_answers_under_its_own_names_only() {
    let app = app_with_hosts(&["gears.example"]).await;
    for ours in [
        "localhost",
        "localhost:8080",
        "LocalHost:1",
        "127.0.0.1:8080",
        "[::1]:8080",
        "gears.example",
        "Gears.Example:80",
    ] {
        assert_eq!(app.get_with("/api/v1/jobs", &[("host", ours)]).await.status, 200, "{ours}");
    }
    for other in
        ["evil.example", "evil.example:8080", "localhost.evil.example", "10.0.0.1", "gears.example.evil.example", ""]
    {
        for path in ["/", "/api/v1/jobs", "/metrics", "/docs/", "/nothing"] {
            app.get_with(path, &[("host", other)]).await.assert_problem(421, "misdirected-request");
        }
        app.submit_with(&document(), &[("host", other)]).await.assert_problem(421, "misdirected-request");
        assert_eq!(app.get_with("/healthz", &[("host", other)]).await.status, 200, "probes name the host as they like");
    }
    let two = [("host", "localhost"), ("host", "evil.example")];
    app.get_with("/api/v1/jobs", &two).await.assert_problem(400, "invalid-parameter");
    let whole = app.send(Method::GET, "http://evil.example/api/v1/jobs", &[("host", "localhost")], "").await;
    whole.assert_problem(421, "misdirected-request");
}

#[tokio::test]
async fn a_service_with_a_token_takes_every_name_unless_some_are_given() {
    let app = guarded().await;
    let (name, value) = bearer();
    let under = [(name, value.as_str()), ("host", "whatever.example")];
    assert_eq!(app.get_with("/api/v1/jobs", &under).await.status, 200);
}

#[test]
fn nothing_listens_to_others_without_a_token_or_a_word() {
    let listen = "0.0.0.0:8080".parse().expect("an address");
    let refused = Access::new(&AccessConfig::default(), listen).err().expect("refused").to_string();
    for hint in ["0.0.0.0:8080", "--token-file", "--insecure"] {
        assert!(refused.contains(hint), "{refused}");
    }
    let open = AccessConfig { insecure: true, ..AccessConfig::default() };
    assert!(Access::new(&open, listen).is_ok());
}
