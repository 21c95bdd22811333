//! CSV (RFC 4180) in one of two dialects.

use std::fmt::Write as _;
use std::io::{self, Write};

// The text is part of the OpenAPI document.
/// The decimal sign of numbers in CSV, and with it the dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, utoipa::ToSchema)]
#[schema(rename_all = "lowercase")]
pub enum Decimal {
    /// Fields between commas, lines that end in LF, no byte order mark.
    #[default]
    Point,
    /// For spreadsheets of languages with a decimal comma: fields between semicolons, lines that end in CR LF, UTF-8
    /// with a byte order mark. A text that would be taken for a formula has an apostrophe before it.
    Comma,
}

/// A field of a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CsvField<'a> {
    /// A number with the digits that read back exactly; an empty field if it is not finite.
    Number(f64),
    Integer(u64),
    /// A number formatted by the caller, with a decimal point.
    FormattedNumber(&'a str),
    Text(&'a str),
    Empty,
}

impl Decimal {
    /// Every variant with its name.
    pub const ALL: [(&'static str, Decimal); 2] = [("point", Decimal::Point), ("comma", Decimal::Comma)];

    fn byte_order_mark(self) -> &'static str {
        match self {
            Decimal::Point => "",
            Decimal::Comma => "\u{feff}",
        }
    }

    fn dialect(self) -> csv::WriterBuilder {
        let (delimiter, terminator) = match self {
            Decimal::Point => (b',', csv::Terminator::Any(b'\n')),
            Decimal::Comma => (b';', csv::Terminator::CRLF),
        };
        let mut builder = csv::WriterBuilder::new();
        builder.delimiter(delimiter).terminator(terminator).flexible(true);
        builder
    }
}

/// Writes records of [`CsvField`]s in the dialect of a [`Decimal`].
pub struct CsvWriter<W: Write> {
    writer: csv::Writer<W>,
    decimal: Decimal,
    /// Reused for each field.
    text: String,
}

impl<W: Write> CsvWriter<W> {
    /// A writer of records that continue a file.
    pub fn new(inner: W, decimal: Decimal) -> Self {
        Self { writer: decimal.dialect().from_writer(inner), decimal, text: String::new() }
    }

    /// A writer of a new file, which begins with the byte order mark of the dialect.
    ///
    /// # Errors
    /// Those of `inner`.
    pub fn with_mark(mut inner: W, decimal: Decimal) -> io::Result<Self> {
        inner.write_all(decimal.byte_order_mark().as_bytes())?;
        Ok(Self::new(inner, decimal))
    }

    /// Writes one record.
    ///
    /// # Errors
    /// Those of the inner writer.
    pub fn write_record<'a>(&mut self, fields: impl IntoIterator<Item = CsvField<'a>>) -> io::Result<()> {
        for field in fields {
            self.text.clear();
            // Writing to a string cannot fail.
            let _ = match field {
                CsvField::Number(number) if number.is_finite() => write!(self.text, "{number:?}"),
                CsvField::Integer(number) => write!(self.text, "{number}"),
                CsvField::FormattedNumber(number) => write!(self.text, "{number}"),
                CsvField::Text(text) => write!(self.text, "{}{text}", self.formula_guard(text)),
                CsvField::Number(_) | CsvField::Empty => Ok(()),
            };
            let is_number = !matches!(field, CsvField::Text(_));
            if is_number
                && self.decimal == Decimal::Comma
                && let Some(point) = self.text.find('.')
            {
                self.text.replace_range(point..=point, ",");
            }
            self.writer.write_field(&self.text)?;
        }
        self.writer.write_record(None::<&[u8]>)?;
        Ok(())
    }

    /// Flushes and returns the inner writer.
    ///
    /// # Errors
    /// Those of the inner writer.
    pub fn into_inner(self) -> io::Result<W> {
        self.writer.into_inner().map_err(csv::IntoInnerError::into_error)
    }

    /// The apostrophe before a text that spreadsheets would evaluate as a formula (CSV injection).
    fn formula_guard(&self, text: &str) -> &'static str {
        match self.decimal {
            Decimal::Comma if text.starts_with(['=', '+', '-', '@', '\t', '\r']) => "'",
            _ => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: [CsvField; 9] = [
        CsvField::Integer(1234),
        CsvField::Number(0.1),
        CsvField::Number(-1.5e-7),
        CsvField::Number(300.0),
        CsvField::Number(f64::NAN),
        CsvField::Empty,
        CsvField::Text("a.b, \"c\"; d"),
        CsvField::Text("=1+1"),
        CsvField::FormattedNumber("1.25e0"),
    ];

    fn record<'a>(decimal: Decimal, fields: impl IntoIterator<Item = CsvField<'a>>) -> String {
        let mut writer = CsvWriter::new(Vec::new(), decimal);
        writer.write_record(fields).unwrap();
        String::from_utf8(writer.into_inner().unwrap()).unwrap()
    }

    #[test]
    fn f12_a_record_in_both_dialects() {
        for (decimal, expected) in [
            (Decimal::Point, "1234,0.1,-1.5e-7,300.0,,,\"a.b, \"\"c\"\"; d\",=1+1,1.25e0\n"),
            (Decimal::Comma, "1234;0,1;-1,5e-7;300,0;;;\"a.b, \"\"c\"\"; d\";'=1+1;1,25e0\r\n"),
        ] {
            assert_eq!(record(decimal, FIELDS), expected);
        }
        let start = |decimal| CsvWriter::with_mark(Vec::new(), decimal).unwrap().into_inner().unwrap();
        assert_eq!((start(Decimal::Point), start(Decimal::Comma)), (Vec::new(), b"\xef\xbb\xbf".to_vec()));
    }

    #[test]
    fn f12_only_fields_with_special_characters_are_quoted() {
        for (decimal, text, expected) in [
            (Decimal::Comma, "1,5", "1,5"),
            (Decimal::Comma, "a;b", "\"a;b\""),
            (Decimal::Comma, "a\r\nb", "\"a\r\nb\""),
            (Decimal::Comma, "-a;b", "\"'-a;b\""),
            (Decimal::Point, "a;b", "a;b"),
            (Decimal::Point, "1,5", "\"1,5\""),
        ] {
            let line = record(decimal, [CsvField::Integer(0), CsvField::Text(text)]);
            assert_eq!(line.trim_end_matches(['\r', '\n'])[2..], *expected);
        }
    }

    #[test]
    fn f12_numbers_with_a_comma_read_back_to_the_bit() {
        for number in [0.1, 1.0 / 3.0, -2.0f64.powi(-1074), f64::MAX, 9.999999999999998, 1e21, 123456789.0] {
            let line = record(Decimal::Comma, [CsvField::Number(number)]);
            assert!(!line.contains('.'), "{line}");
            assert_eq!(line.trim_end().replace(',', ".").parse::<f64>().unwrap().to_bits(), number.to_bits(), "{line}");
        }
    }
}
