//! Answers, read whole or event by event.

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, Response};
use http_body_util::BodyExt;
use serde_json::Value;
use std::time::Duration;

/// An answer that was read to its end.
pub(crate) struct Answer {
    pub status: u16,
    pub headers: HeaderMap,
    pub body: Bytes,
    /// Null when the body is not JSON.
    pub json: Value,
}

impl Answer {
    pub(crate) async fn of(response: Response<Body>) -> Self {
        let (parts, body) = response.into_parts();
        let body = body.collect().await.expect("a whole body").to_bytes();
        let json = serde_json::from_slice(&body).unwrap_or_default();
        Self { status: parts.status.as_u16(), headers: parts.headers, body, json }
    }

    /// Empty when there is no such header.
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// Asserts a problem with this status and code, in the one schema.
    #[track_caller]
    pub(crate) fn assert_problem(&self, status: u16, code: &str) {
        assert_eq!((self.status, self.json["code"].as_str()), (status, Some(code)), "{self:?}");
        assert_eq!(self.header("content-type"), "application/problem+json");
        assert_eq!(self.json["type"], format!("/problems/{code}"));
        assert_eq!(self.json["status"], status);
        assert!(self.json["title"].as_str().is_some_and(|title| !title.is_empty()));
        assert_eq!(self.json["request_id"].as_str(), Some(self.header("x-request-id")));
        assert!(self.json["errors"].is_array());
    }

    #[track_caller]
    pub(crate) fn assert_status(&self, status: u16) {
        assert_eq!(self.status, status, "{self:?}");
    }

    /// The violation with this pointer.
    #[track_caller]
    pub(crate) fn violation(&self, pointer: &str) -> &Value {
        let errors = self.json["errors"].as_array().expect("errors");
        errors.iter().find(|error| error["pointer"] == pointer).unwrap_or_else(|| panic!("no {pointer}: {self:?}"))
    }
}

impl std::fmt::Debug for Answer {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{} {}", self.status, self.text())
    }
}

/// A server-sent event.
#[derive(Debug, PartialEq)]
pub(crate) struct Event {
    pub name: String,
    /// 0 when it has none.
    pub id: i64,
    pub data: Value,
}

/// An event stream, read one event at a time.
pub(crate) struct EventStream {
    pub status: u16,
    pub media_type: String,
    headers: HeaderMap,
    body: Body,
    buffer: String,
}

impl EventStream {
    pub(crate) fn of(response: Response<Body>) -> Self {
        let media_type = response.headers().get("content-type").and_then(|value| value.to_str().ok());
        Self {
            status: response.status().as_u16(),
            media_type: media_type.unwrap_or_default().to_owned(),
            headers: response.headers().clone(),
            body: response.into_body(),
            buffer: String::new(),
        }
    }

    /// Empty when there is no such header.
    pub(crate) fn header(&self, name: &str) -> &str {
        self.headers.get(name).and_then(|value| value.to_str().ok()).unwrap_or_default()
    }

    /// The next event, or `None` at the end of the stream.
    pub(crate) async fn next(&mut self) -> Option<Event> {
        loop {
            if let Some((block, rest)) = self.buffer.split_once("\n\n") {
                let event = parsed(block);
                self.buffer = rest.to_owned();
                match event {
                    Some(event) => return Some(event),
                    None => continue,
                }
            }
            let frame =
                tokio::time::timeout(Duration::from_secs(30), self.body.frame()).await.expect("an event in time");
            let data = frame?.expect("an unbroken stream").into_data().expect("data");
            self.buffer.push_str(std::str::from_utf8(&data).expect("text"));
        }
    }

    /// All events up to the end of the stream.
    pub(crate) async fn rest(&mut self) -> Vec<Event> {
        let mut events = Vec::new();
        while let Some(event) = self.next().await {
            events.push(event);
        }
        events
    }
}

/// `None` for comments.
fn parsed(block: &str) -> Option<Event> {
    let field = |name: &str| block.lines().find_map(|line| line.strip_prefix(name)).map(str::trim_start);
    let data = serde_json::from_str(field("data:")?).expect("data is JSON");
    Some(Event { name: field("event:")?.to_owned(), id: field("id:").map_or(Some(0), |id| id.parse().ok())?, data })
}
