//! Tables as workbooks (`.xlsx`): numbers as numbers, whatever the language of the spreadsheet.

use super::table::{Cells, Table, TableColumn};
use herringbone_job::document::JobDocument;
use herringbone_job::result::{QuantityKind, quantities};
use rust_xlsxwriter::{Format, Workbook, Worksheet, XlsxError};
use serde_json::Value;

/// Rows of a worksheet, without the header.
pub const MAX_WORKBOOK_ROWS: usize = 1_048_575;
pub(super) const MEDIA_TYPE: &str = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet";
/// Most letters of a cell.
const MAX_CELL_CHARS: usize = 32_767;

/// A workbook of three sheets: the table, the document (a line for each field) and the units of the columns. Rows that
/// are written go to temporary files, so that memory does not grow with them.
///
/// # Errors
/// There are more rows than a sheet has, or the temporary files cannot be written.
pub fn write_workbook(name: &str, table: &Table, document: &Value) -> Result<Vec<u8>, XlsxError> {
    let mut workbook = Workbook::new();
    let header = Format::new().set_bold();
    let sheet = workbook.add_worksheet_with_constant_memory()?.set_name(name)?;
    write_table(sheet, table, &header)?;
    let sheet = workbook.add_worksheet_with_constant_memory()?.set_name("input")?;
    write_table(sheet, &fields_of(document), &header)?;
    let sheet = workbook.add_worksheet_with_constant_memory()?.set_name("units")?;
    write_table(sheet, &units_of(table), &header)?;
    workbook.save_to_buffer()
}

/// The numbers and words of a result as a table with a row for each.
pub fn quantities_of(result: &Value) -> Table {
    let (mut pointers, mut labels, mut values, mut words) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut units, mut helps) = (Vec::new(), Vec::new());
    for quantity in quantities() {
        for (pointer, label) in quantity.places() {
            let Some(value) = result.pointer(&pointer).filter(|value| !value.is_null()) else { continue };
            let word = match value {
                Value::String(text) => text.clone(),
                Value::Bool(flag) => flag.to_string(),
                _ => String::new(),
            };
            values.push(value.as_f64().filter(|_| quantity.kind == QuantityKind::Number).unwrap_or(f64::NAN));
            words.push(word);
            pointers.push(pointer);
            labels.push(label);
            // A share is told as it is stored.
            units.push(if quantity.percent { "" } else { quantity.unit }.to_owned());
            helps.push(quantity.help.to_owned());
        }
    }
    let column = |name: &str, meaning: &str, cells| TableColumn {
        name: name.to_owned(),
        unit: String::new(),
        meaning: meaning.to_owned(),
        cells,
    };
    Table {
        columns: vec![
            column("quantity", "", Cells::Words(labels)),
            column("value", "in the unit beside it", Cells::Numbers(values)),
            column("unit", "", Cells::Words(units)),
            column("word", "value that is no number", Cells::Words(words)),
            column("pointer", "place in the result", Cells::Words(pointers)),
            column("meaning", "", Cells::Words(helps)),
        ],
    }
}

/// A document as JSON, for the sheet `input`.
pub fn document_value(document: &JobDocument) -> Value {
    serde_json::to_value(document).unwrap_or_default()
}

fn write_table(sheet: &mut Worksheet, table: &Table, header: &Format) -> Result<(), XlsxError> {
    sheet.set_freeze_panes(1, 0)?;
    for (at, column) in table.columns.iter().enumerate() {
        let longest = match &column.cells {
            Cells::Numbers(_) => 12,
            Cells::Words(words) => words.iter().take(200).map(|word| word.chars().count()).max().unwrap_or(0),
        };
        let width = column.name.chars().count().max(longest).clamp(8, 60) as f64 + 1.0;
        sheet.set_column_width(at as u16, width)?;
    }
    for (at, column) in table.columns.iter().enumerate() {
        sheet.write_string_with_format(0, at as u16, &column.name, header)?;
    }
    for row in 0..table.n_rows() {
        for (at, column) in table.columns.iter().enumerate() {
            let (to, at) = (row as u32 + 1, at as u16);
            match &column.cells {
                Cells::Numbers(values) => match values.get(row).filter(|value| value.is_finite()) {
                    Some(value) => sheet.write_number(to, at, *value)?,
                    None => continue,
                },
                Cells::Words(words) => match words.get(row).filter(|word| !word.is_empty()) {
                    Some(word) => sheet.write_string(to, at, short(word))?,
                    None => continue,
                },
            };
        }
    }
    Ok(())
}

fn short(word: &str) -> String {
    word.chars().take(MAX_CELL_CHARS).collect()
}

/// A line for each value of a document: its pointer, and the value as number or word.
fn fields_of(document: &Value) -> Table {
    let (mut pointers, mut numbers, mut words) = (Vec::new(), Vec::new(), Vec::new());
    walk(document, &mut String::new(), &mut |pointer, value| {
        pointers.push(pointer.to_owned());
        numbers.push(value.as_f64().unwrap_or(f64::NAN));
        words.push(match value {
            Value::String(text) => text.clone(),
            Value::Bool(flag) => flag.to_string(),
            _ => String::new(),
        });
    });
    let column =
        |name: &str, cells| TableColumn { name: name.to_owned(), unit: String::new(), meaning: String::new(), cells };
    Table {
        columns: vec![
            column("pointer", Cells::Words(pointers)),
            column("value", Cells::Numbers(numbers)),
            column("word", Cells::Words(words)),
        ],
    }
}

fn walk(value: &Value, pointer: &mut String, leaf: &mut impl FnMut(&str, &Value)) {
    let length = pointer.len();
    let mut descend = |key: &str, value: &Value| {
        pointer.push('/');
        pointer.push_str(key);
        walk(value, pointer, leaf);
        pointer.truncate(length);
    };
    match value {
        Value::Object(members) => members.iter().for_each(|(key, value)| descend(key, value)),
        Value::Array(items) => items.iter().enumerate().for_each(|(at, value)| descend(&at.to_string(), value)),
        Value::Null => {}
        other => leaf(pointer, other),
    }
}

fn units_of(table: &Table) -> Table {
    let words = |of: fn(&TableColumn) -> &String| Cells::Words(table.columns.iter().map(of).cloned().collect());
    let column =
        |name: &str, cells| TableColumn { name: name.to_owned(), unit: String::new(), meaning: String::new(), cells };
    Table {
        columns: vec![
            column("column", words(|column| &column.name)),
            column("unit", words(|column| &column.unit)),
            column("meaning", words(|column| &column.meaning)),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::io::{Cursor, Read};

    /// The text of a member of the archive.
    fn member(bytes: &[u8], name: &str) -> String {
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        let mut text = String::new();
        archive.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    }

    /// The text of the cells of a sheet, by their places.
    fn cell<'a>(sheet: &'a str, place: &str) -> Option<&'a str> {
        let start = sheet.find(&format!("<c r=\"{place}\""))?;
        let cell = &sheet[start..start + sheet[start..].find("</c>")?];
        let tag = if cell.contains("<v>") { "<v>" } else { "<t>" };
        let value = &cell[cell.find(tag)? + 3..];
        Some(&value[..value.find('<')?])
    }

    #[test]
    fn numbers_are_numbers_and_texts_are_no_formulas() {
        let values = [0.1, 1.0 / 3.0, f64::NAN, -2.5e-310, 123_456_789.123_456_78];
        let words = ["=1+1", "a<b", "", "+x", "-"].map(str::to_owned);
        let column = |name: &str, cells| TableColumn {
            name: name.to_owned(),
            unit: "m/s2".to_owned(),
            meaning: "what it is".to_owned(),
            cells,
        };
        let table = Table {
            columns: vec![
                column("number", Cells::Numbers(values.to_vec())),
                column("word", Cells::Words(words.to_vec())),
            ],
        };
        let document = json!({"design": {"pinion": {"teeth": 17}, "hand": "left"}, "list": [1.5], "nothing": null});
        let bytes = write_workbook("points", &table, &document).unwrap();
        let sheet = member(&bytes, "xl/worksheets/sheet1.xml");
        for (at, value) in values.iter().enumerate() {
            let read = cell(&sheet, &format!("A{}", at + 2)).map(|text| text.parse::<f64>().unwrap().to_bits());
            assert_eq!(read, value.is_finite().then_some(value.to_bits()));
        }
        assert!(!sheet.contains("<f>"));
        assert_eq!(cell(&sheet, "B3"), Some("a&lt;b"));
        let input = member(&bytes, "xl/worksheets/sheet2.xml");
        for text in ["/design/pinion/teeth", "/design/hand", "/list/0"] {
            assert!(input.contains(text), "{text}");
        }
        assert!(!input.contains("nothing"));
        assert!(member(&bytes, "xl/worksheets/sheet3.xml").contains("m/s2"));
    }

    #[test]
    fn a_result_is_a_line_for_each_quantity_that_it_has() {
        let result = json!({"geometry": {"transverse_contact_ratio": 1.5}, "response": null});
        let table = quantities_of(&result);
        assert_eq!(table.n_rows(), 1);
        assert_eq!(table.columns[1].cells, Cells::Numbers(vec![1.5]));
        assert_eq!(table.columns[4].cells, Cells::Words(vec!["/geometry/transverse_contact_ratio".to_owned()]));
    }
}
