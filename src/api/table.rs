//! Tables in memory, by columns, for files that are not written row by row: workbooks and arrays.

use super::columns;
use super::csv::{CsvField, CsvWriter};
use super::points::Pages;
use super::problem::ApiError;
use futures_util::StreamExt;
use herringbone_exchange::arrays::{ArrayForm, ArrayWriter};
use herringbone_job::SweepShape;
use herringbone_job::result::{BranchDirection, Cell, Column, SweepPoint, quantities};
use herringbone_job::unit::Unit;
use std::io;

/// A table with a name, unit and meaning for each column.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    pub columns: Vec<TableColumn>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct TableColumn {
    pub name: String,
    /// In ASCII; empty where there is none.
    pub unit: String,
    /// Empty where the name says it.
    pub meaning: String,
    pub cells: Cells,
}

/// The values of a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Not a number where a row has none.
    Numbers(Vec<f64>),
    /// Empty where a row has none.
    Words(Vec<String>),
}

impl Cells {
    /// Without values, for cells like this one.
    fn like(cell: &Cell<'_>) -> Self {
        match cell {
            Cell::Number(_) => Cells::Numbers(Vec::new()),
            Cell::Word(_) | Cell::Numbers(_) => Cells::Words(Vec::new()),
        }
    }

    /// Adds the value of a row; one of another kind counts as none.
    fn push(&mut self, cell: Cell<'_>) {
        match (self, cell) {
            (Cells::Numbers(values), Cell::Number(value)) => values.push(value.unwrap_or(f64::NAN)),
            (Cells::Numbers(values), _) => values.push(f64::NAN),
            (Cells::Words(words), Cell::Word(word)) => words.push(word.unwrap_or_default().into_owned()),
            (Cells::Words(words), _) => words.push(String::new()),
        }
    }

    fn len(&self) -> usize {
        match self {
            Cells::Numbers(values) => values.len(),
            Cells::Words(values) => values.len(),
        }
    }
}

impl Table {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.columns.iter().map(|column| column.cells.len()).max().unwrap_or(0)
    }

    /// The rows of a sweep, an optimisation or a tolerance study with the columns of its CSV.
    ///
    /// # Errors
    /// The rows cannot be read.
    pub(super) async fn of_points(mut pages: Pages, shape: &SweepShape) -> Result<Table, ApiError> {
        let names = shape.further().iter().cloned();
        let further = names.zip(shape.cells(&SweepPoint::default())).collect();
        let mut rows = PointColumns::new(shape.pointers(), further);
        while let Some(page) = pages.next().await.transpose()? {
            for row in page {
                let point: SweepPoint = serde_json::from_str(&row.body).map_err(ApiError::internal)?;
                rows.push(row.position, &point, shape.cells(&point));
            }
        }
        Ok(rows.into_table())
    }

    /// The rows of a sweep that was solved, with the columns of its CSV.
    pub fn of_sweep(points: &[SweepPoint], axes: &[String]) -> Table {
        let mut rows = PointColumns::new(axes, Vec::new());
        for (position, point) in points.iter().enumerate() {
            rows.push(position as u64, point, Vec::new());
        }
        rows.into_table()
    }

    /// The table as CSV, into a writer of a new file.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn to_csv<W: io::Write>(&self, mut writer: CsvWriter<W>) -> io::Result<W> {
        writer.write_record(self.columns.iter().map(|column| CsvField::Text(&column.name)))?;
        for row in 0..self.n_rows() {
            writer.write_record(self.columns.iter().map(|column| match &column.cells {
                // As the rows of a service have it.
                Cells::Numbers(_) if column.name == POSITION => CsvField::Integer(row_position(column, row)),
                Cells::Numbers(values) => values.get(row).map_or(CsvField::Empty, |value| CsvField::Number(*value)),
                Cells::Words(words) => words.get(row).map_or(CsvField::Empty, |word| CsvField::Text(word)),
            }))?;
        }
        writer.into_inner()
    }

    /// The columns as arrays, and their names and units as `columns` and `units`.
    ///
    /// # Errors
    /// The table is too large for the form.
    pub fn to_arrays(&self, form: ArrayForm) -> io::Result<Vec<u8>> {
        let mut writer = ArrayWriter::new(form, Vec::new())?;
        let mut names = form.names();
        let (list, units) = (names.name("columns"), names.name("units"));
        let mut of_columns = Vec::new();
        for column in &self.columns {
            let name = names.name(&column.name);
            match &column.cells {
                Cells::Numbers(values) => writer.numbers(&name, values)?,
                Cells::Words(words) => {
                    let words: Vec<&str> = words.iter().map(String::as_str).collect();
                    writer.words(&name, &words)?;
                }
            }
            of_columns.push(name);
        }
        writer.words(&list, &of_columns.iter().map(String::as_str).collect::<Vec<_>>())?;
        writer.words(&units, &self.columns.iter().map(|column| column.unit.as_str()).collect::<Vec<_>>())?;
        writer.finish()
    }
}

/// The column with the places of rows, which are whole numbers.
pub(super) const POSITION: &str = "position";

fn row_position(column: &TableColumn, row: usize) -> u64 {
    match &column.cells {
        Cells::Numbers(values) => values.get(row).map_or(0, |value| *value as u64),
        Cells::Words(_) => 0,
    }
}

/// The columns of the rows of a sweep while they are filled.
struct PointColumns {
    positions: Vec<f64>,
    branches: Vec<String>,
    axes: Vec<(String, Vec<f64>)>,
    others: Vec<(&'static Column, Cells)>,
    further: Vec<(String, Cells)>,
}

impl PointColumns {
    /// `further`: names of the cells beside the columns of every row, and cells of their kinds.
    fn new(axes: &[String], further: Vec<(String, Cell<'_>)>) -> Self {
        let none = SweepPoint::default();
        let others = columns::default_columns().into_iter();
        Self {
            positions: Vec::new(),
            branches: Vec::new(),
            axes: axes.iter().map(|pointer| (pointer.clone(), Vec::new())).collect(),
            others: others.map(|column| (column, Cells::like(&(column.cell)(&none)))).collect(),
            further: further.into_iter().map(|(name, cell)| (name, Cells::like(&cell))).collect(),
        }
    }

    fn push(&mut self, position: u64, point: &SweepPoint, further: Vec<Cell<'_>>) {
        self.positions.push(position as f64);
        self.branches.push(point.branch.map_or("", BranchDirection::as_str).to_owned());
        for (at, (_, values)) in self.axes.iter_mut().enumerate() {
            values.push(point.values.get(at).copied().unwrap_or(f64::NAN));
        }
        for (column, cells) in &mut self.others {
            cells.push((column.cell)(point));
        }
        for ((_, cells), cell) in self.further.iter_mut().zip(further) {
            cells.push(cell);
        }
    }

    fn into_table(self) -> Table {
        let plain = |name: &str, meaning: &str, cells| TableColumn {
            name: name.to_owned(),
            unit: String::new(),
            meaning: meaning.to_owned(),
            cells,
        };
        let mut columns = vec![
            plain(POSITION, "place in the result's sweep.points, from 0", Cells::Numbers(self.positions)),
            plain("branch", "with continuation: direction that found the point", Cells::Words(self.branches)),
        ];
        columns.extend(self.axes.into_iter().map(|(name, values)| {
            let unit = Unit::of_name(&name).map_or("", |unit| unit.text).to_owned();
            TableColumn { unit, meaning: "swept input".to_owned(), name, cells: Cells::Numbers(values) }
        }));
        columns.extend(self.others.into_iter().map(|(column, cells)| {
            let quantity = column.quantity.and_then(|pointer| quantities().iter().find(|one| one.pointer == pointer));
            let half = column.half.map(|half| format!(", {half}")).unwrap_or_default();
            TableColumn {
                name: column.name.to_owned(),
                unit: quantity.map_or("", |quantity| quantity.unit).to_owned(),
                meaning: quantity.map(|quantity| format!("{}{half}", quantity.label)).unwrap_or_default(),
                cells,
            }
        }));
        columns.extend(self.further.into_iter().map(|(name, cells)| plain(&name, "", cells)));
        Table { columns }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::PerHalf;

    #[test]
    fn a_sweep_by_columns_with_units() {
        let first = SweepPoint {
            values: vec![300.0],
            mesh_circumferential_acceleration_rms_m_s2: Some(PerHalf { left: 0.1, right: -0.0 }),
            ..SweepPoint::default()
        };
        let second = SweepPoint { values: vec![400.0], error: Some("why".to_owned()), ..SweepPoint::default() };
        let table = Table::of_sweep(&[first, second], &["/operation/pinion_speed_rpm".to_owned()]);
        let column = |name: &str| table.columns.iter().find(|column| column.name == name).expect("a column");
        assert_eq!(table.n_rows(), 2);
        assert_eq!(column("position").cells, Cells::Numbers(vec![0.0, 1.0]));
        let speed = column("/operation/pinion_speed_rpm");
        assert_eq!((speed.unit.as_str(), &speed.cells), ("r/min", &Cells::Numbers(vec![300.0, 400.0])));
        let left = column("mesh_circumferential_acceleration_rms_left_m_s2");
        let Cells::Numbers(values) = &left.cells else { panic!("numbers") };
        assert_eq!((left.unit.as_str(), values[0], values[1].is_nan()), ("m/s2", 0.1, true));
        assert!(left.meaning.ends_with(", left"), "{}", left.meaning);
        assert_eq!(column("error").cells, Cells::Words(vec![String::new(), "why".to_owned()]));
        for form in [ArrayForm::Npz, ArrayForm::Mat] {
            let bytes = table.to_arrays(form).unwrap();
            let has = |text: &str| bytes.windows(text.len()).any(|part| part == text.as_bytes());
            assert!(has("operation_pinion_speed_rpm") && has("columns") && has("units"));
        }
    }
}
