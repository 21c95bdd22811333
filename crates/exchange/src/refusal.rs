//! Refusals: why a file is not imported.

use herringbone_job::Violation;

/// Kind of a refusal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefusalKind {
    /// The file cannot be read, or lacks what a document needs.
    Invalid,
    /// The file can be read, but describes something that a document cannot.
    Unsupported,
}

/// The reasons why a file is not imported. Their pointers lead into the job document, or are `/pair` and its number;
/// their details name components and attributes of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{summary}")]
pub struct Refusal {
    pub kind: RefusalKind,
    /// One sentence.
    pub summary: String,
    pub errors: Vec<Violation>,
}

impl Refusal {
    pub(crate) fn invalid(summary: impl Into<String>, errors: Vec<Violation>) -> Self {
        Self { kind: RefusalKind::Invalid, summary: summary.into(), errors }
    }

    pub(crate) fn unsupported(summary: impl Into<String>, errors: Vec<Violation>) -> Self {
        Self { kind: RefusalKind::Unsupported, summary: summary.into(), errors }
    }

    /// The file as a whole cannot be read.
    pub(crate) fn unreadable(code: &str, detail: impl Into<String>) -> Self {
        let detail = detail.into();
        Self::invalid(format!("The file cannot be read: it {detail}."), vec![Violation::new("", code, detail)])
    }
}

/// At most so many characters of a text of the file, for messages.
pub(crate) fn short(text: &str) -> String {
    const MOST: usize = 80;
    let plain = |letter: char| if letter.is_control() { ' ' } else { letter };
    let mut letters = text.chars().map(plain);
    let mut shown: String = letters.by_ref().take(MOST).collect();
    if letters.next().is_some() {
        shown.push('…');
    }
    shown
}
