//! The columns of the rows of a sweep, as declared with the fields of the row.

use herringbone_job::result::{Cell, CellKind, Column, SweepPoint};
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

/// A table of rows as JSON: an object with a list for each column. Only its text is kept of the rows.
pub(super) struct ColumnTable {
    lists: Vec<(&'static Column, Vec<u8>)>,
    n_rows: usize,
}

impl ColumnTable {
    pub(super) fn new(columns: Vec<&'static Column>) -> Self {
        Self { lists: columns.into_iter().map(|column| (column, Vec::new())).collect(), n_rows: 0 }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// JSON cannot be written, which does not happen in memory.
    pub(super) fn push(&mut self, row: &SweepPoint) -> serde_json::Result<()> {
        for (column, list) in &mut self.lists {
            if self.n_rows > 0 {
                list.push(b',');
            }
            match (column.cell)(row) {
                Cell::Number(value) => serde_json::to_writer(list, &value)?,
                Cell::Word(value) => serde_json::to_writer(list, &value)?,
                Cell::Numbers(value) => serde_json::to_writer(list, &value)?,
            }
        }
        self.n_rows += 1;
        Ok(())
    }

    /// The text of the object.
    ///
    /// # Errors
    /// As [`ColumnTable::push`].
    pub(super) fn into_json(self) -> serde_json::Result<Vec<u8>> {
        let mut text = vec![b'{'];
        for (at, (column, list)) in self.lists.into_iter().enumerate() {
            if at > 0 {
                text.push(b',');
            }
            serde_json::to_writer(&mut text, column.name)?;
            text.extend_from_slice(b":[");
            text.extend_from_slice(&list);
            text.push(b']');
        }
        text.push(b'}');
        Ok(text)
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
        let mut table = ColumnTable::new(columns.to_vec());
        rows.iter().for_each(|row| table.push(row).unwrap());
        let text = table.into_json().unwrap();
        assert_eq!(serde_json::from_slice::<serde_json::Value>(&text).unwrap(), expected);
        assert_eq!(ColumnTable::new(Vec::new()).into_json().unwrap(), b"{}");
    }
}
