//! Tables as CSV, in one of two dialects.

use std::fmt::Write;

/// The decimal sign of numbers in CSV, and with it the dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, utoipa::ToSchema)]
#[schema(rename_all = "lowercase")]
pub enum Decimal {
    /// Fields between commas, lines that end in LF, no byte order mark.
    #[default]
    Point,
    /// What spreadsheets read whose language writes a decimal comma: fields between semicolons, lines that end in CR LF, UTF-8 with a
    /// byte order mark. A text that would be taken for a formula has an apostrophe before it.
    Comma,
}

/// A field of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Field<'a> {
    /// A number; what is not finite is an empty field. It reads back exactly.
    Number(f64),
    Whole(u64),
    /// A number that is written out already, with a decimal point.
    Written(&'a str),
    Text(&'a str),
    Nothing,
}

impl Decimal {
    pub const ALL: [(&'static str, Decimal); 2] = [("point", Decimal::Point), ("comma", Decimal::Comma)];

    /// What stands at the start of the file.
    pub fn start(self) -> &'static str {
        match self {
            Decimal::Point => "",
            Decimal::Comma => "\u{feff}",
        }
    }

    /// Adds a line.
    pub fn push_line<'a>(self, text: &mut String, fields: impl IntoIterator<Item = Field<'a>>) {
        for (index, field) in fields.into_iter().enumerate() {
            if index > 0 {
                text.push(self.separator());
            }
            self.push(text, field);
        }
        text.push_str(match self {
            Decimal::Point => "\n",
            Decimal::Comma => "\r\n",
        });
    }

    fn separator(self) -> char {
        match self {
            Decimal::Point => ',',
            Decimal::Comma => ';',
        }
    }

    fn push(self, text: &mut String, field: Field<'_>) {
        let start = text.len();
        // Writing to a string cannot fail.
        let _ = match field {
            Field::Number(number) if number.is_finite() => write!(text, "{number:?}"),
            Field::Whole(number) => write!(text, "{number}"),
            Field::Written(number) => write!(text, "{number}"),
            Field::Text(words) => return self.push_text(text, words),
            Field::Number(_) | Field::Nothing => Ok(()),
        };
        if self == Decimal::Comma
            && let Some(point) = text[start..].find('.')
        {
            text.replace_range(start + point..=start + point, ",");
        }
    }

    /// A text, in quotes where RFC 4180 wants it so.
    fn push_text(self, text: &mut String, words: &str) {
        let is_formula = self == Decimal::Comma && words.starts_with(['=', '+', '-', '@', '\t', '\r']);
        let guard = if is_formula { "'" } else { "" };
        if words.contains(['"', '\n', '\r', self.separator()]) {
            let _ = write!(text, "\"{guard}{}\"", words.replace('"', "\"\""));
        } else {
            text.push_str(guard);
            text.push_str(words);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: [Field; 9] = [
        Field::Whole(1234),
        Field::Number(0.1),
        Field::Number(-1.5e-7),
        Field::Number(300.0),
        Field::Number(f64::NAN),
        Field::Nothing,
        Field::Text("a.b, \"c\"; d"),
        Field::Text("=1+1"),
        Field::Written("1.25e0"),
    ];

    #[test]
    fn f12_a_line_in_both_dialects() {
        for (decimal, expected) in [
            (Decimal::Point, "1234,0.1,-1.5e-7,300.0,,,\"a.b, \"\"c\"\"; d\",=1+1,1.25e0\n"),
            (Decimal::Comma, "1234;0,1;-1,5e-7;300,0;;;\"a.b, \"\"c\"\"; d\";'=1+1;1,25e0\r\n"),
        ] {
            let mut text = String::new();
            decimal.push_line(&mut text, FIELDS);
            assert_eq!(text, expected);
        }
        assert_eq!((Decimal::Point.start(), Decimal::Comma.start().as_bytes()), ("", &b"\xef\xbb\xbf"[..]));
    }

    #[test]
    fn f12_only_what_separates_is_quoted() {
        for (decimal, words, expected) in [
            (Decimal::Comma, "1,5", "1,5"),
            (Decimal::Comma, "a;b", "\"a;b\""),
            (Decimal::Comma, "a\r\nb", "\"a\r\nb\""),
            (Decimal::Comma, "-a;b", "\"'-a;b\""),
            (Decimal::Point, "a;b", "a;b"),
            (Decimal::Point, "1,5", "\"1,5\""),
        ] {
            let mut text = String::new();
            decimal.push_text(&mut text, words);
            assert_eq!(text, expected);
        }
    }

    #[test]
    fn f12_numbers_with_a_comma_read_back_to_the_bit() {
        for number in [0.1, 1.0 / 3.0, -2.0f64.powi(-1074), f64::MAX, 9.999999999999998, 1e21, 123456789.0] {
            let mut text = String::new();
            Decimal::Comma.push(&mut text, Field::Number(number));
            assert!(!text.contains('.'), "{text}");
            assert_eq!(text.replace(',', ".").parse::<f64>().unwrap().to_bits(), number.to_bits(), "{text}");
        }
    }
}
