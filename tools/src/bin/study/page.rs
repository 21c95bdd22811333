//! The page that is written: text with numbers filled in, and sentences that fail when the numbers no longer bear them
//! out.

use crate::ask::Outcome;
use std::fmt::Write;

#[derive(Default)]
pub(crate) struct Page {
    text: String,
    failed: Vec<String>,
}

impl Page {
    /// A paragraph, heading or list as it stands.
    pub(crate) fn say(&mut self, text: impl AsRef<str>) {
        let _ = writeln!(self.text, "{}\n", text.as_ref());
    }

    /// A conclusion, and whether the numbers bear it out: the page is not written when they do not.
    pub(crate) fn claim(&mut self, holds: bool, text: impl AsRef<str>) {
        if !holds {
            self.failed.push(text.as_ref().to_owned());
        }
        self.say(text);
    }

    pub(crate) fn table(&mut self, header: &str, rows: &[Vec<String>]) {
        let columns = header.matches('|').count() + 1;
        let _ = writeln!(self.text, "| {header} |\n|{}", "---|".repeat(columns));
        for row in rows {
            let _ = writeln!(self.text, "| {} |", row.join(" | "));
        }
        self.text.push('\n');
    }

    pub(crate) fn figure(&mut self, name: &str, caption: &str) {
        self.say(format!(
            "![{}](study/{name}.svg)\n\n*{caption}*",
            caption.split(['.', ':']).next().unwrap_or_default()
        ));
    }

    /// The text so far, whether its sentences hold or not.
    pub(crate) fn draft(&self) -> &str {
        &self.text
    }

    /// The text.
    ///
    /// # Errors
    /// Every sentence that does not hold any more.
    pub(crate) fn finish(self) -> Outcome<String> {
        if self.failed.is_empty() {
            return Ok(format!("{}\n", self.text.trim_end()));
        }
        Err(format!("the numbers do not bear out:\n- {}", self.failed.join("\n- ")).into())
    }
}

/// Significant digits as an engineer writes them.
pub(crate) fn sig(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { "–".into() };
    }
    let decimals = (digits - 1 - value.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    text.replace('-', "−")
}

/// A change in per cent, with its sign.
pub(crate) fn change(value: f64, from: f64) -> String {
    let percent = 100.0 * (value / from - 1.0);
    if percent.abs() < 0.05 {
        "0".into()
    } else {
        format!("{}{}", if percent > 0.0 { "+" } else { "" }, sig(percent, if percent.abs() < 1.0 { 1 } else { 2 }))
    }
}
