//! Tables as Parquet files, for pandas, DuckDB and other programs that read tables by columns.
//!
//! Written front to back, a group of rows at a time. Numbers are stored as they are, bit for bit; all columns are
//! compressed with zstd. The key-value metadata of a file has the columns' units and meanings, as JSON objects with a
//! member for each column that has one, and what the writer is given besides.

use ::parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as PhysicalType, ZstdLevel};
use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use ::parquet::errors::ParquetError;
use ::parquet::file::metadata::KeyValue;
use ::parquet::file::properties::{EnabledStatistics, WriterProperties};
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::types::{ColumnPath, Type};
use serde_json::{Map, Value};
use std::borrow::Cow;
use std::collections::HashSet;
use std::io::{Error, ErrorKind, Result, Write};
use std::sync::Arc;

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParquetColumn {
    /// Each name once.
    pub name: String,
    pub kind: ParquetKind,
    /// In ASCII; empty where there is none.
    pub unit: String,
    /// Empty where the name says it.
    pub meaning: String,
}

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParquetKind {
    /// Doubles, one in each row.
    Number,
    /// Doubles; not a number is written as null.
    NumberOrNull,
    /// Whole numbers of 64 bits, one in each row.
    Integer,
    /// Texts; an empty one is written as null.
    WordOrNull,
}

/// The values of a column in a group of rows.
#[derive(Debug, Clone, PartialEq)]
pub enum ParquetCells<'v> {
    Numbers(Cow<'v, [f64]>),
    Integers(Cow<'v, [i64]>),
    Words(Cow<'v, [String]>),
}

/// Writes groups of rows one after the other.
pub struct ParquetWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
    kinds: Vec<ParquetKind>,
}

impl<W: Write + Send> ParquetWriter<W> {
    /// Begins a file. `metadata`: further entries of its key-value metadata.
    ///
    /// # Errors
    /// Those of `out`; two columns have the same name.
    pub fn new(out: W, columns: &[ParquetColumn], metadata: &[(&str, &str)]) -> Result<Self> {
        let mut names = HashSet::new();
        if let Some(column) = columns.iter().find(|column| !names.insert(&column.name)) {
            return Err(invalid(&format!("two columns are called {}", column.name)));
        }
        let fields = columns.iter().map(|column| field(column).map(Arc::new)).collect::<Result<_>>()?;
        let schema = Type::group_type_builder("schema").with_fields(fields).build().map_err(error)?;
        let file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties(columns, metadata)?))
            .map_err(error)?;
        Ok(Self { file, kinds: columns.iter().map(|column| column.kind).collect() })
    }

    /// Adds a group of rows. `cells` gives the values of the column with an index; it is asked for each of them in
    /// turn, so that one column is in memory at a time.
    ///
    /// # Errors
    /// Those of the file and of `cells`; the columns differ in length, or have values of another kind.
    pub fn group<'v>(&mut self, mut cells: impl FnMut(usize) -> Result<ParquetCells<'v>>) -> Result<()> {
        let mut group = self.file.next_row_group().map_err(error)?;
        for (index, kind) in self.kinds.iter().enumerate() {
            let mut column = group
                .next_column()
                .map_err(error)?
                .ok_or_else(|| invalid("a group has fewer columns than the file"))?;
            match (kind, cells(index)?) {
                (ParquetKind::Number, ParquetCells::Numbers(values)) => {
                    column.typed::<DoubleType>().write_batch(&values, None, None)
                }
                (ParquetKind::NumberOrNull, ParquetCells::Numbers(values)) => {
                    let (known, levels) = split(&values, |value| (!value.is_nan()).then_some(*value));
                    column.typed::<DoubleType>().write_batch(&known, Some(&levels), None)
                }
                (ParquetKind::Integer, ParquetCells::Integers(values)) => {
                    column.typed::<Int64Type>().write_batch(&values, None, None)
                }
                (ParquetKind::WordOrNull, ParquetCells::Words(words)) => {
                    let (known, levels) =
                        split(&words, |word| (!word.is_empty()).then(|| ByteArray::from(word.as_str())));
                    column.typed::<ByteArrayType>().write_batch(&known, Some(&levels), None)
                }
                (kind, _) => return Err(invalid(&format!("a column of {kind:?} has values of another kind"))),
            }
            .map_err(error)?;
            column.close().map_err(error)?;
        }
        group.close().map_err(error)?;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of the file.
    pub fn finish(self) -> Result<W> {
        self.file.into_inner().map_err(error)
    }
}

/// The values that are there, and for each row whether it has one: 1 or 0, as the format has it.
fn split<T, V>(values: &[T], known: impl Fn(&T) -> Option<V>) -> (Vec<V>, Vec<i16>) {
    let levels = values.iter().map(|value| i16::from(known(value).is_some())).collect();
    (values.iter().filter_map(known).collect(), levels)
}

fn field(column: &ParquetColumn) -> Result<Type> {
    let (physical, repetition) = match column.kind {
        ParquetKind::Number => (PhysicalType::DOUBLE, Repetition::REQUIRED),
        ParquetKind::NumberOrNull => (PhysicalType::DOUBLE, Repetition::OPTIONAL),
        ParquetKind::Integer => (PhysicalType::INT64, Repetition::REQUIRED),
        ParquetKind::WordOrNull => (PhysicalType::BYTE_ARRAY, Repetition::OPTIONAL),
    };
    let builder = Type::primitive_type_builder(&column.name, physical).with_repetition(repetition);
    let builder = match column.kind {
        ParquetKind::WordOrNull => {
            builder.with_logical_type(Some(LogicalType::String)).with_converted_type(ConvertedType::UTF8)
        }
        _ => builder,
    };
    builder.build().map_err(error)
}

fn properties(columns: &[ParquetColumn], metadata: &[(&str, &str)]) -> Result<WriterProperties> {
    const LEVEL: i32 = 3;
    let object = |of: fn(&ParquetColumn) -> &String| {
        let with = columns.iter().filter(|column| !of(column).is_empty());
        Value::Object(with.map(|column| (column.name.clone(), of(column).as_str().into())).collect::<Map<_, _>>())
    };
    let mut entries = vec![
        KeyValue::new("units".to_owned(), object(|column| &column.unit).to_string()),
        KeyValue::new("meanings".to_owned(), object(|column| &column.meaning).to_string()),
    ];
    entries.extend(metadata.iter().map(|(key, value)| KeyValue::new((*key).to_owned(), (*value).to_owned())));
    // Doubles hardly ever repeat: a dictionary of them would only hold back what is written.
    let mut builder = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::try_new(LEVEL).map_err(error)?))
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_key_value_metadata(Some(entries));
    for column in columns.iter().filter(|column| column.kind == ParquetKind::WordOrNull) {
        builder = builder.set_column_dictionary_enabled(ColumnPath::from(column.name.as_str()), true);
    }
    Ok(builder.build())
}

/// The failure of a writer below as it is, any other one as its text.
fn error(error: ParquetError) -> Error {
    match error {
        ParquetError::External(source) => match source.downcast::<Error>() {
            Ok(error) => *error,
            Err(source) => Error::other(source),
        },
        other => Error::other(other),
    }
}

fn invalid(text: &str) -> Error {
    Error::new(ErrorKind::InvalidInput, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::parquet::file::reader::{FileReader, SerializedFileReader};
    use ::parquet::record::Field;

    const NUMBERS: [f64; 6] = [0.1, -1.0 / 3.0, 5e-324, f64::MAX, -0.0, f64::NAN];

    fn column(name: &str, kind: ParquetKind, unit: &str) -> ParquetColumn {
        ParquetColumn { name: name.to_owned(), kind, unit: unit.to_owned(), meaning: String::new() }
    }

    fn columns() -> Vec<ParquetColumn> {
        vec![
            column("position", ParquetKind::Integer, ""),
            column("/operation/pinion_speed_rpm", ParquetKind::Number, "r/min"),
            column("dynamic_factor", ParquetKind::NumberOrNull, "1"),
            column("regime", ParquetKind::WordOrNull, ""),
        ]
    }

    /// The cells of rows from `NUMBERS`.
    fn cells(rows: std::ops::Range<usize>, index: usize) -> ParquetCells<'static> {
        match index {
            0 => ParquetCells::Integers(rows.map(|row| row as i64).collect()),
            3 => {
                ParquetCells::Words(rows.map(|row| if row == 1 { String::new() } else { format!("µ{row}") }).collect())
            }
            _ => ParquetCells::Numbers(Cow::Borrowed(&NUMBERS[rows])),
        }
    }

    #[test]
    fn a_file_read_back_has_every_bit_null_and_entry() {
        let mut writer = ParquetWriter::new(Vec::new(), &columns(), &[("job_id", "7")]).unwrap();
        for rows in [0..4, 4..6] {
            writer.group(|index| Ok(cells(rows.clone(), index))).unwrap();
        }
        let file = SerializedFileReader::new(bytes::Bytes::from(writer.finish().unwrap())).unwrap();
        let metadata = file.metadata().file_metadata();
        assert_eq!((metadata.num_rows(), file.num_row_groups()), (6, 2));
        let entry = |key: &str| {
            let entries = metadata.key_value_metadata().expect("entries");
            entries.iter().find(|entry| entry.key == key).and_then(|entry| entry.value.clone()).expect("a value")
        };
        assert_eq!(entry("job_id"), "7");
        assert_eq!(entry("units"), r#"{"/operation/pinion_speed_rpm":"r/min","dynamic_factor":"1"}"#);
        assert_eq!(entry("meanings"), "{}");
        for (row, read) in file.get_row_iter(None).unwrap().enumerate() {
            let fields: Vec<Field> = read.unwrap().into_columns().into_iter().map(|(_, field)| field).collect();
            let [Field::Long(position), Field::Double(number), optional, word] = &fields[..] else {
                panic!("{fields:?}")
            };
            assert_eq!((*position, number.to_bits()), (row as i64, NUMBERS[row].to_bits()));
            match optional {
                Field::Double(number) => assert_eq!(number.to_bits(), NUMBERS[row].to_bits()),
                other => assert_eq!((other, row), (&Field::Null, 5)),
            }
            let expected = if row == 1 { Field::Null } else { Field::Str(format!("µ{row}")) };
            assert_eq!(word, &expected);
        }
    }

    #[test]
    fn a_file_without_rows_has_its_columns() {
        let writer = ParquetWriter::new(Vec::new(), &columns(), &[]).unwrap();
        let file = SerializedFileReader::new(bytes::Bytes::from(writer.finish().unwrap())).unwrap();
        let schema = file.metadata().file_metadata().schema_descr();
        let names: Vec<_> = (0..schema.num_columns()).map(|index| schema.column(index).name().to_owned()).collect();
        assert_eq!(names, ["position", "/operation/pinion_speed_rpm", "dynamic_factor", "regime"]);
    }

    #[test]
    fn columns_of_one_name_other_kinds_and_other_lengths_are_refused() {
        let twice = [column("a", ParquetKind::Number, ""), column("a", ParquetKind::Integer, "")];
        assert!(ParquetWriter::new(Vec::new(), &twice, &[]).is_err_and(|error| error.to_string().contains("called a")));
        let mut writer = ParquetWriter::new(Vec::new(), &columns(), &[]).unwrap();
        assert!(writer.group(|_| Ok(ParquetCells::Numbers(Cow::Borrowed(&NUMBERS)))).is_err());
        let mut writer = ParquetWriter::new(Vec::new(), &columns(), &[]).unwrap();
        assert!(writer.group(|index| Ok(cells(0..index + 1, index))).is_err());
        let mut writer = ParquetWriter::new(Vec::new(), &columns(), &[]).unwrap();
        let failed = writer.group(|_| Err(Error::new(ErrorKind::NotFound, "gone")));
        assert_eq!(failed.expect_err("a failure").kind(), ErrorKind::NotFound);
    }
}
