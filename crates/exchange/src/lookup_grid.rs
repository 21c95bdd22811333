//! Look-up tables of a mesh over the angle of the pinion and its torque, of the tables at several torques.

use crate::arrays::{ArrayForm, ArrayWriter};
use crate::lookup::{LookupForm, LookupQuantity, LookupTable, LookupTables, angles, json_file};
use serde::Serialize;
use std::fmt::Write as _;
use std::io;

/// A quantity over angle and torque.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LookupGrid {
    pub name: String,
    pub unit: &'static str,
    pub meaning: &'static str,
    /// Position in the mesh period, 0 to 1.
    pub phase: Vec<f64>,
    pub pinion_angle_rad: Vec<f64>,
    /// A row for each angle, in it a value for each torque.
    pub values: Vec<Vec<f64>>,
}

/// The tables of a pair over the torque of the pinion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LookupGrids {
    pub convention: &'static str,
    pub pinion_teeth: u32,
    pub gear_teeth: u32,
    pub pinion_speed_rpm: f64,
    pub half_stagger: f64,
    /// Ascending.
    pub pinion_torque_nm: Vec<f64>,
    pub grids: Vec<LookupGrid>,
}

impl LookupGrids {
    /// Of tables that differ in torque. A grid has the phases of all of them; between its own phases a table is linear,
    /// as whoever reads it takes it. `None` of fewer than two torques.
    pub fn new(mut tables: Vec<LookupTables>) -> Option<Self> {
        tables.sort_by(|a, b| a.pinion_torque_nm.total_cmp(&b.pinion_torque_nm));
        tables.dedup_by(|a, b| a.pinion_torque_nm == b.pinion_torque_nm);
        let first = tables.first().filter(|_| tables.len() > 1)?;
        let named = |name: &str| -> Option<Vec<&LookupTable>> {
            tables.iter().map(|one| one.tables.iter().find(|table| table.name == name)).collect()
        };
        let grids = first.tables.iter().filter_map(|table| Some(grid(&named(&table.name)?, first.pinion_teeth)));
        Some(Self {
            convention: first.convention,
            pinion_teeth: first.pinion_teeth,
            gear_teeth: first.gear_teeth,
            pinion_speed_rpm: first.pinion_speed_rpm,
            half_stagger: first.half_stagger,
            grids: grids.collect(),
            pinion_torque_nm: tables.iter().map(|one| one.pinion_torque_nm).collect(),
        })
    }

    /// The grid of a quantity; of the left half where the halves differ.
    pub fn grid(&self, quantity: LookupQuantity) -> Option<&LookupGrid> {
        self.grids.iter().find(|grid| quantity.is_named(&grid.name))
    }

    /// The file; `None` where there is no such grid, or the form has one axis only.
    ///
    /// # Errors
    /// The file cannot be written, which does not happen in memory.
    pub fn write(&self, form: LookupForm, quantity: LookupQuantity) -> io::Result<Option<Vec<u8>>> {
        Ok(match form {
            LookupForm::Json => Some(json_file(self)?),
            LookupForm::Modelica => Some(self.modelica().into_bytes()),
            LookupForm::Simulink => Some(self.variables()?),
            LookupForm::Amesim => self.grid(quantity).map(|grid| self.amesim(grid).into_bytes()),
            LookupForm::Simpack => None,
        })
    }

    /// `CombiTable2Ds`: the torques in the first row, the angles in the first column.
    fn modelica(&self) -> String {
        let mut text = "#1\n".to_owned();
        // Writing to a text does not fail.
        let _ = writeln!(text, "# {}", self.convention);
        for grid in &self.grids {
            let (rows, columns) = (grid.values.len() + 1, self.pinion_torque_nm.len() + 1);
            let _ = writeln!(
                text,
                "# {}: pinion angle in rad (first column), pinion torque in N m (first row), value in {}; {}",
                grid.name, grid.unit, grid.meaning
            );
            let _ = writeln!(text, "double {}({rows},{columns})", grid.name);
            text += &line(0.0, &self.pinion_torque_nm);
            for (angle, values) in grid.pinion_angle_rad.iter().zip(&grid.values) {
                text += &line(*angle, values);
            }
        }
        text
    }

    /// Numbers of angles and torques, the angles, the torques, then the values of each torque.
    fn amesim(&self, grid: &LookupGrid) -> String {
        let mut text = format!(
            "# Table format: 2D\n# pinion angle [rad], pinion torque [N m], {} [{}]\n{} {}\n",
            grid.name,
            grid.unit,
            grid.pinion_angle_rad.len(),
            self.pinion_torque_nm.len()
        );
        text += &words(&grid.pinion_angle_rad);
        text += &words(&self.pinion_torque_nm);
        for torque in 0..self.pinion_torque_nm.len() {
            let column: Vec<f64> = grid.values.iter().map(|values| values[torque]).collect();
            text += &words(&column);
        }
        text
    }

    fn variables(&self) -> io::Result<Vec<u8>> {
        let mut writer = ArrayWriter::new(ArrayForm::Mat, Vec::new())?;
        for (name, value) in [
            ("pinion_teeth", f64::from(self.pinion_teeth)),
            ("gear_teeth", f64::from(self.gear_teeth)),
            ("pinion_speed_rpm", self.pinion_speed_rpm),
            ("half_stagger", self.half_stagger),
        ] {
            writer.scalar(name, value)?;
        }
        writer.numbers("pinion_torque_nm", &self.pinion_torque_nm)?;
        for grid in &self.grids {
            writer.numbers(&format!("{}_angle_rad", grid.name), &grid.pinion_angle_rad)?;
            writer.numbers(&format!("{}_phase", grid.name), &grid.phase)?;
            writer.matrix(&grid.name, &grid.values)?;
            writer.words(&format!("{}_unit", grid.name), &[grid.unit])?;
        }
        writer.words("convention", &[self.convention])?;
        writer.finish()
    }
}

fn line(first: f64, values: &[f64]) -> String {
    format!("{first:?} {}", words(values))
}

fn words(values: &[f64]) -> String {
    let mut text = values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(" ");
    text.push('\n');
    text
}

/// The grid of the tables of one quantity, in the order of the torques.
fn grid(tables: &[&LookupTable], teeth: u32) -> LookupGrid {
    let mut phase: Vec<f64> = tables.iter().flat_map(|table| table.phase.iter().copied()).collect();
    phase.sort_by(f64::total_cmp);
    phase.dedup();
    LookupGrid {
        name: tables[0].name.clone(),
        unit: tables[0].unit,
        meaning: tables[0].meaning,
        pinion_angle_rad: angles(&phase, teeth),
        values: phase.iter().map(|at| tables.iter().map(|table| value_at(table, *at)).collect()).collect(),
        phase,
    }
}

/// The value of a table at a phase: its own where it has that phase, else on the line between its neighbours; beyond
/// its ends that of the end.
fn value_at(table: &LookupTable, at: f64) -> f64 {
    let next = table.phase.partition_point(|phase| *phase < at).min(table.phase.len() - 1);
    if next == 0 || table.phase[next] <= at {
        return table.values[next];
    }
    let (from, to) = (table.phase[next - 1], table.phase[next]);
    let share = (at - from) / (to - from);
    table.values[next - 1] + share * (table.values[next] - table.values[next - 1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::{JobResult, Mesh, MeshCurve};

    fn tables(torque_nm: f64, phases: usize) -> LookupTables {
        let mut document: serde_json::Value =
            serde_json::from_slice(include_bytes!("../../../examples/table1.json")).unwrap();
        document["operation"]["pinion_torque_nm"] = torque_nm.into();
        let document = herringbone_job::parse_value(&document).unwrap();
        let phase: Vec<f64> = (0..phases).map(|at| at as f64 / phases as f64).collect();
        let curve = MeshCurve {
            stiffness_n_per_um: phase.iter().map(|phase| torque_nm + phase).collect(),
            transmission_error_um: phase.iter().map(|phase| torque_nm - phase).collect(),
            phase,
            ..MeshCurve::default()
        };
        let result = JobResult { mesh: Some(Mesh { curve, ..Mesh::default() }), ..JobResult::default() };
        LookupTables::new(&document, &result).unwrap()
    }

    #[test]
    fn a_grid_has_the_numbers_of_its_tables() {
        let grids = LookupGrids::new(vec![tables(800.0, 4), tables(200.0, 4), tables(400.0, 2)]).unwrap();
        assert_eq!(grids.pinion_torque_nm, [200.0, 400.0, 800.0]);
        let stiffness = grids.grid(LookupQuantity::Stiffness).unwrap();
        assert_eq!(stiffness.phase, [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(stiffness.values[1], [200.25e6, 400.25e6, 800.25e6], "the coarse one on a line");
        assert_eq!(stiffness.values[4], [200e6, 400e6, 800e6], "closed");
        assert_eq!(LookupGrids::new(vec![tables(1.0, 4), tables(1.0, 4)]), None);
    }

    #[test]
    fn every_form_has_rows_of_angles_and_columns_of_torques() {
        let grids = LookupGrids::new(vec![tables(200.0, 4), tables(800.0, 4)]).unwrap();
        let file = |form| grids.write(form, LookupQuantity::Stiffness).unwrap();
        let text = |form| String::from_utf8(file(form).unwrap()).unwrap();
        let modelica = text(LookupForm::Modelica);
        let start = modelica.find("double stiffness(6,3)\n").unwrap();
        let rows: Vec<Vec<f64>> = modelica[start..]
            .lines()
            .skip(1)
            .take(6)
            .map(|row| row.split(' ').map(|word| word.parse().unwrap()).collect())
            .collect();
        let stiffness = grids.grid(LookupQuantity::Stiffness).unwrap();
        assert_eq!(rows[0], [0.0, 200.0, 800.0]);
        for (row, (angle, values)) in rows[1..].iter().zip(stiffness.pinion_angle_rad.iter().zip(&stiffness.values)) {
            assert_eq!(row, &[*angle, values[0], values[1]]);
        }
        let amesim = text(LookupForm::Amesim);
        let lines: Vec<&str> = amesim.lines().filter(|line| !line.starts_with('#')).collect();
        assert_eq!((lines[0], lines.len(), lines[2]), ("5 2", 5, "200.0 800.0"));
        assert_eq!(lines[4].split(' ').next(), Some("800000000.0"));
        let json: serde_json::Value = serde_json::from_str(&text(LookupForm::Json)).unwrap();
        assert_eq!(json["grids"][0]["values"][2][1], 800.5e6);
        assert!(file(LookupForm::Simulink).unwrap().starts_with(b"MATLAB 5.0"));
        assert_eq!(file(LookupForm::Simpack), None);
    }
}
