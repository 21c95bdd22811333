//! The extractor of changes of a job.

use super::body::read_json_body;
use crate::api::config::MAX_NOTES_CHARS;
use crate::api::problem::{ApiError, Problem, ProblemCode};
use crate::store::JobDescription;
use axum::extract::{FromRequest, Request};
use herringbone_job::document::{MAX_LABEL_CHARS, MAX_NAME_CHARS};
use herringbone_job::{Violation, parse_json};
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

/// A change of a job: each member a text, or null to remove it.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[expect(dead_code, reason = "only for the description: null and left out differ")]
pub(crate) struct JobPatch {
    #[schema(max_length = 200, pattern = r"^[^\u0000-\u001f\u007f-\u009f]*$")]
    pub name: Option<String>,
    #[schema(max_length = 100, pattern = r"^[^\u0000-\u001f\u007f-\u009f]*$")]
    pub label: Option<String>,
    /// Text of several lines.
    #[schema(max_length = 5000, pattern = r"^[^\u0000-\u0008\u000b\u000c\u000e-\u001f\u007f-\u009f]*$")]
    pub notes: Option<String>,
}

/// A parsed merge patch (RFC 7396) of name, label and notes.
#[derive(Debug)]
pub(crate) struct PatchBody(pub JobDescription);

impl<S: Send + Sync> FromRequest<S> for PatchBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &S) -> Result<Self, ApiError> {
        let bytes = read_json_body(request, state).await?;
        read(&parse_json(&bytes)?).map(Self)
    }
}

fn read(patch: &Value) -> Result<JobDescription, ApiError> {
    let mut description = JobDescription::default();
    let mut violations = Vec::new();
    let Value::Object(members) = patch else {
        return Err(refusal(vec![Violation::new("", "wrong-type", "is not an object")]));
    };
    for (member, value) in members {
        let (text, max_chars) = match member.as_str() {
            "name" => (&mut description.name, MAX_NAME_CHARS),
            "label" => (&mut description.label, MAX_LABEL_CHARS),
            "notes" => (&mut description.notes, MAX_NOTES_CHARS),
            _ => {
                let detail = "cannot be changed; permitted: name, label, notes";
                violations.push(Violation::new(pointer(member), "unknown-field", detail));
                continue;
            }
        };
        match value {
            Value::Null => *text = Some(None),
            Value::String(value) if value.chars().any(|letter| letter.is_control() && !permits(member, letter)) => {
                let detail = "has control characters; permitted: printable characters";
                violations.push(Violation::new(pointer(member), "out-of-range", detail));
            }
            Value::String(value) if value.chars().count() <= max_chars => *text = Some(Some(value.clone())),
            Value::String(value) => {
                let detail = format!("has {} characters; permitted: at most {max_chars}", value.chars().count());
                violations.push(Violation {
                    maximum: Some(max_chars as f64),
                    ..Violation::new(pointer(member), "too-long", detail)
                });
            }
            _ => violations.push(Violation::new(pointer(member), "wrong-type", "is neither a text nor null")),
        }
    }
    if violations.is_empty() { Ok(description) } else { Err(refusal(violations)) }
}

/// Whether a member may contain a control character: notes have lines.
fn permits(member: &str, letter: char) -> bool {
    member == "notes" && ['\n', '\r', '\t'].contains(&letter)
}

/// The JSON pointer of a member, which may be long.
fn pointer(member: &str) -> String {
    let short: String = member.chars().take(60).collect();
    format!("/{}", short.replace('~', "~0").replace('/', "~1"))
}

fn refusal(violations: Vec<Violation>) -> ApiError {
    let detail = format!("{} member(s) of the patch are invalid", violations.len());
    Problem::new(ProblemCode::InvalidPatch, detail).with_errors(violations).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn left_out_null_and_text_differ() {
        let patch = read(&json!({"name": "a", "notes": null})).unwrap();
        let expected = JobDescription { name: Some(Some("a".into())), label: None, notes: Some(None) };
        assert_eq!(patch, expected);
        assert_eq!(read(&json!({})).unwrap(), JobDescription::default());
    }

    #[test]
    fn texts_are_bounded_in_characters() {
        let fits = json!({"label": "µ".repeat(MAX_LABEL_CHARS), "notes": "\n".repeat(MAX_NOTES_CHARS)});
        assert!(read(&fits).is_ok());
        for wrong in [
            json!({"name": "a".repeat(MAX_NAME_CHARS + 1)}),
            json!({"label": "µ".repeat(MAX_LABEL_CHARS + 1)}),
            json!({"notes": "a".repeat(MAX_NOTES_CHARS + 1)}),
            json!({"name": "a\nb"}),
            json!({"notes": "a\u{7}"}),
            json!({"name": 1}),
            json!({"kind": "mesh"}),
            json!({"a/b~c": null}),
            json!([]),
            json!(null),
        ] {
            assert!(read(&wrong).is_err(), "{wrong}");
        }
        assert_eq!(pointer("a/b~c"), "/a~1b~0c");
    }
}
