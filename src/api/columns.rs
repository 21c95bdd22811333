//! The columns of the rows of a sweep: their names and values.

use herringbone_job::result::{PerHalf, SweepPoint};
use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};
use utoipa::openapi::{ObjectBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// The value of a column in a row; `None` where the row does not have one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ColumnValue<'a> {
    Number(Option<f64>),
    Text(Option<&'a str>),
    Numbers(Option<&'a [f64]>),
}

/// A column: its name, and the function that reads its value from a row.
pub type Column = (&'static str, fn(&SweepPoint) -> ColumnValue<'_>);

fn half(halves: Option<PerHalf>, pick: fn(PerHalf) -> f64) -> ColumnValue<'static> {
    ColumnValue::Number(halves.map(pick))
}

/// The columns of numbers, in the order of the CSV table.
pub const NUMBERS: [Column; 13] = [
    ("mesh_circumferential_acceleration_rms_left_m_s2", |row| {
        half(row.mesh_circumferential_acceleration_rms_m_s2, |halves| halves.left)
    }),
    ("mesh_circumferential_acceleration_rms_right_m_s2", |row| {
        half(row.mesh_circumferential_acceleration_rms_m_s2, |halves| halves.right)
    }),
    ("pinion_axial_acceleration_rms_left_m_s2", |row| {
        half(row.pinion_axial_acceleration_rms_m_s2, |halves| halves.left)
    }),
    ("pinion_axial_acceleration_rms_right_m_s2", |row| {
        half(row.pinion_axial_acceleration_rms_m_s2, |halves| halves.right)
    }),
    ("dynamic_factor", |row| ColumnValue::Number(row.dynamic_factor)),
    ("min_displacement_um", |row| ColumnValue::Number(row.min_displacement_um)),
    ("stiffness_mean_n_per_um", |row| ColumnValue::Number(row.stiffness_mean_n_per_um)),
    ("impact_force_n", |row| ColumnValue::Number(row.impact_force_n)),
    ("total_contact_ratio", |row| ColumnValue::Number(row.total_contact_ratio)),
    ("loaded_contact_ratio", |row| ColumnValue::Number(row.loaded_contact_ratio)),
    ("error_estimate", |row| ColumnValue::Number(row.error_estimate)),
    ("tooth_force_max_left_n", |row| half(row.tooth_force_max_n, |halves| halves.left)),
    ("tooth_force_max_right_n", |row| half(row.tooth_force_max_n, |halves| halves.right)),
];

/// The columns of texts at the end of the CSV table.
pub const TEXTS: [Column; 3] = [
    ("regime", |row| ColumnValue::Text(row.regime.as_deref())),
    ("contact", |row| ColumnValue::Text(row.contact.as_deref())),
    ("error", |row| ColumnValue::Text(row.error.as_deref())),
];

/// The columns that CSV does not have at the end.
const OTHERS: [Column; 4] = [
    ("branch", |row| ColumnValue::Text(row.branch.as_deref())),
    ("poincare_x_left_m", |row| {
        ColumnValue::Numbers(row.poincare.as_ref().map(|poincare| poincare.x_left_m.as_slice()))
    }),
    ("poincare_v_x_left_m_s", |row| {
        ColumnValue::Numbers(row.poincare.as_ref().map(|poincare| poincare.v_x_left_m_s.as_slice()))
    }),
    ("acceleration_spectrum_m_s2", |row| ColumnValue::Numbers(row.acceleration_spectrum_m_s2.as_deref())),
];

/// Every column, by its name.
pub fn all() -> Vec<(&'static str, Column)> {
    NUMBERS.iter().chain(&TEXTS).chain(&OTHERS).map(|column| (column.0, *column)).collect()
}

/// The name of a column, for the OpenAPI document.
pub struct ColumnName;

impl PartialSchema for ColumnName {
    fn schema() -> RefOr<Schema> {
        let names = all().into_iter().map(|(name, _)| name);
        let description = "A number or word of a row, or what `record` adds to it.";
        ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names)).description(Some(description)).into()
    }
}

impl ToSchema for ColumnName {}

/// Rows, serialized as an object with a list for each column.
pub struct ColumnTable<'a> {
    pub columns: &'a [Column],
    pub rows: &'a [SweepPoint],
}

impl Serialize for ColumnTable<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.columns.len()))?;
        for column in self.columns {
            map.serialize_entry(column.0, &ColumnValues { column, rows: self.rows })?;
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
            match (self.column.1)(row) {
                ColumnValue::Number(value) => list.serialize_element(&value)?,
                ColumnValue::Text(value) => list.serialize_element(&value)?,
                ColumnValue::Numbers(value) => list.serialize_element(&value)?,
            }
        }
        list.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::Poincare;
    use serde_json::json;

    #[test]
    fn every_number_and_text_of_a_row_is_a_column() {
        let row = SweepPoint {
            error: Some("why".to_owned()),
            branch: Some("up".to_owned()),
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
            regime: Some("period-1".to_owned()),
            acceleration_spectrum_m_s2: Some(vec![0.5, 1.0]),
            ..SweepPoint::default()
        };
        let rows = [solved, SweepPoint { error: Some("no".to_owned()), ..SweepPoint::default() }];
        let columns = [NUMBERS[1], TEXTS[0], TEXTS[2], OTHERS[3]];
        let expected = json!({
            "mesh_circumferential_acceleration_rms_right_m_s2": [2.5, null],
            "regime": ["period-1", null],
            "error": [null, "no"],
            "acceleration_spectrum_m_s2": [[0.5, 1.0], null],
        });
        assert_eq!(serde_json::to_value(ColumnTable { columns: &columns, rows: &rows }).unwrap(), expected);
    }
}
