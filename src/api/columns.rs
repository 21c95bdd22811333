//! The columns of the rows of a sweep, as declared with the fields of the row.

use herringbone_job::result::{Cell, CellKind, Column, SweepPoint};
use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};
use utoipa::openapi::{ObjectBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// The columns of a table when none are requested: numbers, then texts.
pub(super) fn default_columns() -> Vec<&'static Column> {
    let of_kind = |kind| SweepPoint::COLUMNS.iter().filter(move |column| column.kind == kind && !column.on_request);
    of_kind(CellKind::Number).chain(of_kind(CellKind::Word)).collect()
}

/// Every column, by its name.
pub(super) fn all() -> Vec<(&'static str, &'static Column)> {
    let on_request = SweepPoint::COLUMNS.iter().filter(|column| column.on_request);
    default_columns().into_iter().chain(on_request).map(|column| (column.name, column)).collect()
}

/// The name of a column, for the OpenAPI document.
pub(super) struct ColumnName;

impl PartialSchema for ColumnName {
    fn schema() -> RefOr<Schema> {
        let names = all().into_iter().map(|(name, _)| name);
        let description = "A number or word of a row, or what `record` adds to it.";
        ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names)).description(Some(description)).into()
    }
}

impl ToSchema for ColumnName {}

/// Rows, serialized as an object with a list for each column.
pub(super) struct ColumnTable<'a> {
    pub columns: &'a [&'static Column],
    pub rows: &'a [SweepPoint],
}

impl Serialize for ColumnTable<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.columns.len()))?;
        for column in self.columns {
            map.serialize_entry(column.name, &ColumnValues { column, rows: self.rows })?;
        }
        map.end()
    }
}

struct ColumnValues<'a> {
    column: &'a Column,
    rows: &'a [SweepPoint],
}

impl Serialize for ColumnValues<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.rows.len()))?;
        for row in self.rows {
            match (self.column.cell)(row) {
                Cell::Number(value) => list.serialize_element(&value)?,
                Cell::Word(value) => list.serialize_element(&value)?,
                Cell::Numbers(value) => list.serialize_element(&value)?,
            }
        }
        list.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::{BranchDirection, PerHalf, Poincare, RegimeResult};
    use serde_json::json;

    #[test]
    fn every_number_and_word_of_a_row_is_a_column() {
        let row = SweepPoint {
            error: Some("why".to_owned()),
            branch: Some(BranchDirection::Up),
            poincare: Some(Poincare::default()),
            acceleration_spectrum_m_s2: Some(Vec::new()),
            ..SweepPoint::default()
        };
        let names: Vec<_> =
            all().into_iter().map(|(name, _)| name.replace("_left", "").replace("_right", "")).collect();
        let row = serde_json::to_value(row).unwrap();
        for name in row.as_object().unwrap().keys().filter(|name| *name != "values") {
            assert!(names.iter().any(|column| column == name || column.starts_with(&format!("{name}_"))), "{name}");
        }
    }

    #[test]
    fn a_column_is_a_list_with_a_value_for_each_row() {
        let halves = PerHalf { left: 1.5, right: 2.5 };
        let solved = SweepPoint {
            mesh_circumferential_acceleration_rms_m_s2: Some(halves),
            regime: Some(RegimeResult::Period(1)),
            acceleration_spectrum_m_s2: Some(vec![0.5, 1.0]),
            ..SweepPoint::default()
        };
        let rows = [solved, SweepPoint { error: Some("no".to_owned()), ..SweepPoint::default() }];
        let names =
            ["mesh_circumferential_acceleration_rms_right_m_s2", "regime", "error", "acceleration_spectrum_m_s2"];
        let all = all();
        let columns = names.map(|name| all.iter().find(|(known, _)| *known == name).expect("a column").1);
        let expected = json!({
            "mesh_circumferential_acceleration_rms_right_m_s2": [2.5, null],
            "regime": ["period-1", null],
            "error": [null, "no"],
            "acceleration_spectrum_m_s2": [[0.5, 1.0], null],
        });
        assert_eq!(serde_json::to_value(ColumnTable { columns: &columns, rows: &rows }).unwrap(), expected);
    }
}
