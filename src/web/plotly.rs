//! Plotly.js and its style rules, taken from the HTML that the `plotly` crate carries, at the first request: the
//! repository contains no copy, and nothing is fetched from another host (docs/DESIGN.md, "Libraries and own code").

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use sha2::{Digest, Sha256};
use std::sync::LazyLock;

const FOR_A_YEAR: &str = "public, max-age=31536000, immutable";

struct Plotly {
    script: Bytes,
    stylesheet: String,
    /// Changes with the content; part of the script's address.
    version: String,
}

static PLOTLY: LazyLock<Plotly> = LazyLock::new(|| {
    let sources = plotly::Plot::offline_js_sources();
    let script = first_script(&sources).unwrap_or_default();
    let version = hex::encode(&Sha256::digest(script.as_bytes())[..6]);
    let stylesheet = style_rules(script).unwrap_or_default();
    Plotly { script: Bytes::copy_from_slice(script.as_bytes()), stylesheet, version }
});

/// Address of the script: with its version, so that it can be cached for a year.
pub(super) fn script_url() -> String {
    format!("/assets/plotly.js?v={}", PLOTLY.version)
}

/// The script, compressed once: it has some megabytes, and compressing it takes longer than the rest of a page.
static COMPRESSED: LazyLock<Option<Bytes>> =
    LazyLock::new(|| zstd::encode_all(&*PLOTLY.script, 12).ok().map(Bytes::from));

/// `/assets/plotly.js`: compressed beforehand for browsers that accept zstd (they do over TLS and on localhost), as
/// any other file for the rest.
pub(super) async fn script(request: HeaderMap) -> Response {
    let headers = [
        (header::CONTENT_TYPE, "text/javascript; charset=utf-8"),
        (header::CACHE_CONTROL, FOR_A_YEAR),
        (header::VARY, "accept-encoding"),
    ];
    if reads_zstd(&request) {
        // The first time it takes a moment, which other requests need not wait for.
        let compressed = tokio::task::spawn_blocking(|| COMPRESSED.clone()).await.ok().flatten();
        if let Some(compressed) = compressed {
            return (headers, [(header::CONTENT_ENCODING, "zstd")], compressed).into_response();
        }
    }
    (headers, PLOTLY.script.clone()).into_response()
}

fn reads_zstd(request: &HeaderMap) -> bool {
    let named = request.get_all(header::ACCEPT_ENCODING).iter().filter_map(|value| value.to_str().ok());
    // "zstd;q=0" refuses it; other weights make no difference.
    named.flat_map(|value| value.split(',')).any(|coding| {
        let (name, weight) = coding.split_once(';').unwrap_or((coding, ""));
        let weight = weight.trim().strip_prefix("q=").map_or(Ok(1.0), str::parse::<f32>);
        name.trim().eq_ignore_ascii_case("zstd") && weight.is_ok_and(|weight| weight > 0.0)
    })
}

/// `/assets/plotly.css`: the rules that the script would otherwise insert as an inline style element, which the
/// content security policy forbids. The script leaves them out when it finds an element with the id
/// `plotly.js-style-global` and the class `no-inline-styles`; the page's link to this file is that element.
pub(super) async fn stylesheet() -> Response {
    let headers = [(header::CONTENT_TYPE, "text/css; charset=utf-8"), (header::CACHE_CONTROL, "no-cache")];
    (headers, PLOTLY.stylesheet.as_str()).into_response()
}

/// The text of the first script element.
fn first_script(html: &str) -> Option<&str> {
    let start = html.find("<script")?;
    let start = start + html[start..].find('>')? + 1;
    // The script itself has no "</script>" in it, or it could not stand in a page.
    let end = start + html[start..].find("</script>")?;
    Some(&html[start..end])
}

/// The style rules in the script: an object literal `{"X,X div":"…", …, Y:"…"}` of selectors and declarations, in
/// which `X` stands for the plot and `Y` for its notices.
fn style_rules(script: &str) -> Option<String> {
    let start = script.find(r#"{"X,X div":"#)? + 1;
    let mut rest = &script[start..];
    let mut sheet = String::new();
    loop {
        let (selector, after) = literal(rest)?;
        let (declarations, after) = literal(after.strip_prefix(':')?)?;
        let selector = selector.replace('X', ".js-plotly-plot .plotly").replace('Y', ".plotly-notifier");
        sheet.push_str(&format!("{selector}{{{declarations}}}\n"));
        match after.as_bytes().first()? {
            b',' => rest = &after[1..],
            b'}' => return Some(sheet),
            _ => return None,
        }
    }
}

/// A string literal without escapes, or a bare name, at the start of `text`; and the rest of `text`.
fn literal(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next()?;
    if quote == '"' || quote == '\'' {
        let end = 1 + text[1..].find(quote)?;
        Some((&text[1..end], &text[end + 1..]))
    } else {
        let end = text.find(':')?;
        Some((&text[..end], &text[end..]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn script_is_plotly_and_nothing_else() {
        let text = std::str::from_utf8(&PLOTLY.script).unwrap();
        assert!(text.trim_start().starts_with("/**\n* plotly.js v"), "starts with {:?}", &text[..40]);
        assert!(text.len() > 1_000_000 && !text.contains("MathJax.loader"), "{} bytes", text.len());
        assert!(text.contains("no-inline-styles"), "the script no longer looks for its stylesheet");
    }

    #[tokio::test]
    async fn the_compressed_body_is_the_script() {
        let answered = async |coding: &'static str| {
            let headers =
                HeaderMap::from_iter([(header::ACCEPT_ENCODING, axum::http::HeaderValue::from_static(coding))]);
            let answer = script(headers).await;
            let named = answer.headers().get(header::CONTENT_ENCODING).map(|value| value.to_str().unwrap().to_owned());
            (named, axum::body::to_bytes(answer.into_body(), 1 << 24).await.unwrap())
        };
        let (named, body) = answered("gzip, deflate, br, zstd").await;
        assert_eq!(named.as_deref(), Some("zstd"));
        assert!(body.len() < PLOTLY.script.len() / 3, "{} bytes", body.len());
        assert!(zstd::decode_all(&*body).unwrap() == PLOTLY.script);
        for coding in ["gzip, deflate", "gzip, zstd;q=0"] {
            let (named, body) = answered(coding).await;
            assert!(named.is_none() && body == PLOTLY.script, "{coding}");
        }
    }

    #[test]
    fn stylesheet_has_every_rule_of_the_script() {
        let sheet = &PLOTLY.stylesheet;
        assert!(sheet.contains(".js-plotly-plot .plotly .main-svg{position:absolute;"), "{sheet}");
        assert!(sheet.contains(".plotly-notifier .notifier-close:hover{"), "{sheet}");
        assert_eq!(sheet.matches('{').count(), sheet.lines().count());
    }

    #[test]
    fn style_rules_are_found_between_other_code() {
        let script = r#"var a=1,G={"X,X div":'font:"A",b;',"X a:hover":"c:d;",Y:"e:f;"};for(k in G)"#;
        let expected = ".js-plotly-plot .plotly,.js-plotly-plot .plotly div{font:\"A\",b;}\n\
                        .js-plotly-plot .plotly a:hover{c:d;}\n.plotly-notifier{e:f;}\n";
        assert_eq!(style_rules(script).as_deref(), Some(expected));
        assert_eq!(style_rules("no rules here"), None);
        assert_eq!(style_rules(r#"{"X,X div":"cut off"#), None);
    }
}
