//! `GET /problems/{code}`

use crate::api::problem::{ApiError, CodeEntry, ProblemCode};
use crate::api::request::negotiate;
use axum::Json;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::http::header::VARY;
use axum::response::{Html, IntoResponse, Response};
use serde::Serialize;
use utoipa::ToSchema;

/// What a problem code means.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct ProblemExplanation {
    pub code: &'static str,
    pub status: u16,
    pub title: &'static str,
    pub explanation: &'static str,
}

/// Explain a problem code.
#[utoipa::path(
    get, path = "/problems/{code}", tag = "operation",
    params(("code" = String, Path, description = "`code` of a problem")),
    responses(
        (status = 200, description = "What the code means and what to do.", content(
            (ProblemExplanation = "application/json"), (String = "text/html"))),
        (status = 404, description = "No such code."),
    )
)]
pub(super) async fn explain_problem(Path(code): Path<String>, headers: HeaderMap) -> Result<Response, ApiError> {
    let media_type = negotiate(&headers, &["application/json", "text/html"])?;
    let code = ProblemCode::from_name(&code).ok_or_else(|| ApiError::not_found("There is no such problem code."))?;
    let entry = code.entry();
    let vary = [(VARY, "accept")];
    Ok(match media_type {
        "text/html" => (vary, Html(page(entry))).into_response(),
        _ => (vary, Json(explanation(entry))).into_response(),
    })
}

fn explanation(entry: &'static CodeEntry) -> ProblemExplanation {
    ProblemExplanation { code: entry.name, status: entry.status, title: entry.title, explanation: entry.explanation }
}

/// The explanation as a page. The texts of the table contain no markup, which a test checks.
fn page(entry: &CodeEntry) -> String {
    format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title>\
         <h1>{title}</h1><p><code>{name}</code>, status {status}</p><p>{explanation}</p></html>",
        title = entry.title,
        name = entry.name,
        status = entry.status,
        explanation = entry.explanation
    )
}

#[cfg(test)]
mod tests {
    use crate::api::problem::CODES;

    #[test]
    fn the_texts_need_no_escaping() {
        for entry in &CODES {
            assert!(![entry.title, entry.explanation].concat().contains(['<', '>', '&']), "{}", entry.name);
        }
    }
}
