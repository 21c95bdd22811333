//! Columns of the rows of a sweep: what each is called and where in a row it stands.

use herringbone_job::result::{PerHalf, SweepPoint};
use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};
use utoipa::openapi::{ObjectBuilder, RefOr, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

/// One value of a row; null where the row does not have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell<'a> {
    Number(Option<f64>),
    Word(Option<&'a str>),
    Numbers(Option<&'a [f64]>),
}

/// A column: its name, and its value in a row.
pub type Column = (&'static str, fn(&SweepPoint) -> Cell<'_>);

fn half(halves: Option<PerHalf>, pick: fn(PerHalf) -> f64) -> Cell<'static> {
    Cell::Number(halves.map(pick))
}

/// The numbers of a row, in the order of the table.
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
    ("dynamic_factor", |row| Cell::Number(row.dynamic_factor)),
    ("min_displacement_um", |row| Cell::Number(row.min_displacement_um)),
    ("stiffness_mean_n_per_um", |row| Cell::Number(row.stiffness_mean_n_per_um)),
    ("impact_force_n", |row| Cell::Number(row.impact_force_n)),
    ("total_contact_ratio", |row| Cell::Number(row.total_contact_ratio)),
    ("loaded_contact_ratio", |row| Cell::Number(row.loaded_contact_ratio)),
    ("error_estimate", |row| Cell::Number(row.error_estimate)),
    ("tooth_force_max_left_n", |row| half(row.tooth_force_max_n, |halves| halves.left)),
    ("tooth_force_max_right_n", |row| half(row.tooth_force_max_n, |halves| halves.right)),
];

/// The words of a row that stand at its end.
pub const WORDS: [Column; 3] = [
    ("regime", |row| Cell::Word(row.regime.as_deref())),
    ("contact", |row| Cell::Word(row.contact.as_deref())),
    ("error", |row| Cell::Word(row.error.as_deref())),
];

const OTHERS: [Column; 4] = [
    ("branch", |row| Cell::Word(row.branch.as_deref())),
    ("poincare_x_left_m", |row| Cell::Numbers(row.poincare.as_ref().map(|poincare| poincare.x_left_m.as_slice()))),
    ("poincare_v_x_left_m_s", |row| {
        Cell::Numbers(row.poincare.as_ref().map(|poincare| poincare.v_x_left_m_s.as_slice()))
    }),
    ("acceleration_spectrum_m_s2", |row| Cell::Numbers(row.acceleration_spectrum_m_s2.as_deref())),
];

/// Every column, by its name.
pub fn all() -> Vec<(&'static str, Column)> {
    NUMBERS.iter().chain(&WORDS).chain(&OTHERS).map(|column| (column.0, *column)).collect()
}

/// The name of a column, for the description.
pub struct ColumnName;

impl PartialSchema for ColumnName {
    fn schema() -> RefOr<Schema> {
        let names = all().into_iter().map(|(name, _)| name);
        let description = "A number or word of a row, or what `record` adds to it.";
        ObjectBuilder::new().schema_type(Type::String).enum_values(Some(names)).description(Some(description)).into()
    }
}

impl ToSchema for ColumnName {}

/// Rows as an object with a list for each column.
pub struct Table<'a> {
    pub columns: &'a [Column],
    pub rows: &'a [SweepPoint],
}

impl Serialize for Table<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.columns.len()))?;
        for column in self.columns {
            map.serialize_entry(column.0, &Values { column, rows: self.rows })?;
        }
        map.end()
    }
}

struct Values<'a> {
    column: &'a Column,
    rows: &'a [SweepPoint],
}

impl Serialize for Values<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(Some(self.rows.len()))?;
        for row in self.rows {
            match (self.column.1)(row) {
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
    use herringbone_job::result::Poincare;
    use serde_json::json;

    #[test]
    fn every_number_and_word_of_a_row_is_a_column() {
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
        let columns = [NUMBERS[1], WORDS[0], WORDS[2], OTHERS[3]];
        let expected = json!({
            "mesh_circumferential_acceleration_rms_right_m_s2": [2.5, null],
            "regime": ["period-1", null],
            "error": [null, "no"],
            "acceleration_spectrum_m_s2": [[0.5, 1.0], null],
        });
        assert_eq!(serde_json::to_value(Table { columns: &columns, rows: &rows }).unwrap(), expected);
    }
}
