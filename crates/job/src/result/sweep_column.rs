//! Columns of the rows of a sweep, declared by the fields of [`SweepPoint`] with `#[derive(SweepColumns)]`.

use super::SweepPoint;
use std::borrow::Cow;

/// A column: its name, and its value in a row.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    pub name: &'static str,
    /// The same for both halves of a quantity: their name without half and unit; else the name.
    pub group: &'static str,
    /// Pointer of the quantity of the result that it holds, as in [`super::Quantity::pointer`].
    pub quantity: Option<&'static str>,
    /// `left` or `right` where the quantity has a value for each half.
    pub half: Option<&'static str>,
    pub kind: CellKind,
    /// Only in answers that name it.
    pub on_request: bool,
    pub cell: fn(&SweepPoint) -> Cell<'_>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellKind {
    Number,
    Word,
    Numbers,
}

/// One value of a row; none where the row does not have it.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell<'a> {
    Number(Option<f64>),
    Word(Option<Cow<'a, str>>),
    Numbers(Option<&'a [f64]>),
}

/// A field of a row that is a column.
pub(crate) trait ToCell {
    const KIND: CellKind;

    fn to_cell(&self) -> Cell<'_>;
}

impl ToCell for Option<f64> {
    const KIND: CellKind = CellKind::Number;

    fn to_cell(&self) -> Cell<'_> {
        Cell::Number(*self)
    }
}

impl ToCell for Option<u32> {
    const KIND: CellKind = CellKind::Number;

    fn to_cell(&self) -> Cell<'_> {
        Cell::Number(self.map(f64::from))
    }
}

impl ToCell for Option<String> {
    const KIND: CellKind = CellKind::Word;

    fn to_cell(&self) -> Cell<'_> {
        Cell::Word(self.as_deref().map(Cow::Borrowed))
    }
}

impl ToCell for Option<Vec<f64>> {
    const KIND: CellKind = CellKind::Numbers;

    fn to_cell(&self) -> Cell<'_> {
        Cell::Numbers(self.as_deref())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        JobResult, Mesh, PerHalf, RegimeResult, ResponseResult, ToothForceResult, ToothForces, quantities,
    };
    use super::*;

    #[test]
    fn every_column_holds_a_quantity_that_there_is() {
        for column in SweepPoint::COLUMNS {
            let Some(pointer) = column.quantity else { continue };
            let quantity = quantities().iter().find(|quantity| quantity.pointer == pointer);
            assert!(quantity.is_some(), "{}: {pointer}", column.name);
        }
        assert!(SweepPoint::COLUMNS.iter().filter(|column| column.quantity.is_some()).count() > 10);
    }

    #[test]
    fn a_row_is_filled_from_the_result() {
        let force = |max| ToothForceResult { max, ..ToothForceResult::default() };
        let response = ResponseResult {
            dynamic_factor: Some(1.5),
            regime: RegimeResult::Period(3),
            tooth_force_n: ToothForces { left: force(1.0), right: force(2.0) },
            ..ResponseResult::default()
        };
        let mesh = Mesh {
            transmission_error_pp_um: 0.5,
            transmission_error_harmonics_um: vec![0.25, 0.125],
            max_contact_pressure_mpa: Some(900.0),
            max_line_load_n_per_mm: Some(300.0),
            ..Mesh::default()
        };
        let result = JobResult { response: Some(response), mesh: Some(mesh), ..JobResult::default() };
        let row = SweepPoint::of_result(vec![7.0], &result);
        let [first, second, third] = [
            row.transmission_error_harmonic_1_um,
            row.transmission_error_harmonic_2_um,
            row.transmission_error_harmonic_3_um,
        ];
        assert_eq!((row.transmission_error_pp_um, first, second, third), (Some(0.5), Some(0.25), Some(0.125), None));
        assert_eq!((row.max_contact_pressure_mpa, row.max_line_load_n_per_mm), (Some(900.0), Some(300.0)));
        assert_eq!((row.dynamic_factor, row.loaded_contact_ratio), (Some(1.5), None));
        assert_eq!(row.tooth_force_max_n, Some(PerHalf { left: 1.0, right: 2.0 }));
        let cell = |name: &str| {
            let column = SweepPoint::COLUMNS.iter().find(|column| column.name == name);
            column.map(|column| (column.cell)(&row)).unwrap_or_else(|| panic!("no column {name}"))
        };
        assert_eq!(cell("tooth_force_max_right_n"), Cell::Number(Some(2.0)));
        assert_eq!(cell("regime"), Cell::Word(Some("period-3".into())));
        assert_eq!((row.values.as_slice(), cell("error")), ([7.0].as_slice(), Cell::Word(None)));
        assert_eq!(SweepPoint::of_result(Vec::new(), &JobResult::default()), SweepPoint::default());
    }
}
