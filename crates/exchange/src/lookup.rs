//! Look-up tables of a mesh for programs that simulate drive trains: stiffness and transmission error over one mesh
//! period, and the pulse of the impact.

use crate::arrays::{ArrayForm, ArrayWriter};
use herringbone_job::document::JobDocument;
use herringbone_job::result::{JobResult, MeshCurve};
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::io;

/// Steps of the pulse of the impact.
const PULSE_STEPS: usize = 32;

/// The form of a file of tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LookupForm {
    /// Every table with units and conventions.
    Json,
    /// Text file of `Modelica.Blocks.Tables.CombiTable1Ds` (`tableOnFile`), a table for each quantity.
    Modelica,
    /// MATLAB variables, for Simulink's look-up tables.
    Simulink,
    /// ASCII table of Amesim, two columns, of one quantity.
    Amesim,
    /// Pairs for an input function of Simpack, of one quantity.
    Simpack,
}

/// What a table holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LookupQuantity {
    Stiffness,
    TransmissionError,
    ImpactForce,
}

impl LookupQuantity {
    /// Every quantity with the name of its table.
    pub const ALL: [(&'static str, LookupQuantity); 3] = [
        ("stiffness", LookupQuantity::Stiffness),
        ("transmission_error", LookupQuantity::TransmissionError),
        ("impact_force", LookupQuantity::ImpactForce),
    ];

    /// Whether a table of this name holds the quantity; of the left half where the halves differ.
    pub(crate) fn is_named(self, table: &str) -> bool {
        Self::ALL.contains(&(table.trim_start_matches("left_"), self))
    }
}

/// A quantity over the angle of the pinion; the first and the last value of a period are the same.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LookupTable {
    pub name: String,
    pub unit: &'static str,
    pub meaning: &'static str,
    /// Position in the mesh period, 0 to 1 (of a pulse that lasts into the next period, more).
    pub phase: Vec<f64>,
    /// Angle of the pinion: phase times 2π over its teeth.
    pub pinion_angle_rad: Vec<f64>,
    pub values: Vec<f64>,
}

/// The tables of a pair at one operating point.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LookupTables {
    /// What phase and values refer to.
    pub convention: &'static str,
    pub pinion_teeth: u32,
    pub gear_teeth: u32,
    pub pinion_speed_rpm: f64,
    pub pinion_torque_nm: f64,
    pub half_stagger: f64,
    pub tables: Vec<LookupTable>,
}

const CONVENTION: &str = "Phase 0 is the theoretical start of contact of a pair of the left half; the right half is later by \
    half_stagger. Stiffness (tangent), transmission error and impact force are those of one half, along the transverse base tangent; \
    tables with left_ and right_ where the halves differ.";

impl LookupTables {
    /// The tables of a document and its result; `None` when the result has no curve over the mesh period.
    pub fn new(document: &JobDocument, result: &JobResult) -> Option<Self> {
        let mesh = result.mesh.as_ref().filter(|mesh| mesh.curve.phase.len() > 1)?;
        let teeth = document.design.pinion.teeth;
        let mut tables = Vec::new();
        match &mesh.right_curve {
            None => tables.extend(of_curve("", &mesh.curve, teeth)),
            Some(right) => {
                tables.extend(of_curve("left_", &mesh.curve, teeth));
                tables.extend(of_curve("right_", right, teeth));
            }
        }
        let mesh_frequency_hz = result.geometry.as_ref().map(|geometry| geometry.mesh_frequency_hz);
        let pulse = result.impact.as_ref().zip(mesh_frequency_hz).filter(|(impact, _)| impact.force_n > 0.0);
        if let Some((impact, mesh_frequency_hz)) = pulse {
            let length = impact.duration_us * 1e-6 * mesh_frequency_hz;
            tables.push(pulse_table(impact.force_n, impact.start_mesh_periods, length, teeth));
        }
        Some(Self {
            convention: CONVENTION,
            pinion_teeth: teeth,
            gear_teeth: document.design.gear.teeth,
            pinion_speed_rpm: document.operation.pinion_speed_rpm,
            pinion_torque_nm: document.operation.pinion_torque_nm,
            half_stagger: document.design.half_stagger,
            tables,
        })
    }

    /// The table of a quantity; of the left half where the halves differ.
    pub fn table(&self, quantity: LookupQuantity) -> Option<&LookupTable> {
        self.tables.iter().find(|table| quantity.is_named(&table.name))
    }

    /// The file; `None` where it is of one quantity and there is no such table.
    ///
    /// # Errors
    /// The file cannot be written, which does not happen in memory.
    pub fn write(&self, form: LookupForm, quantity: LookupQuantity) -> io::Result<Option<Vec<u8>>> {
        Ok(match form {
            LookupForm::Json => Some(json_file(self)?),
            LookupForm::Modelica => Some(self.modelica().into_bytes()),
            LookupForm::Simulink => Some(self.variables()?),
            LookupForm::Amesim => self.table(quantity).map(|table| {
                let head = format!("# Table format: 1D\n# pinion angle [rad], {} [{}]\n", table.name, table.unit);
                (head + &pairs(table)).into_bytes()
            }),
            LookupForm::Simpack => self.table(quantity).map(|table| pairs(table).into_bytes()),
        })
    }

    fn modelica(&self) -> String {
        let mut text = "#1\n".to_owned();
        // Writing to a text does not fail.
        let _ = writeln!(text, "# {CONVENTION}");
        for table in &self.tables {
            let rows = table.values.len();
            let _ = writeln!(text, "# {}: pinion angle in rad, value in {}; {}", table.name, table.unit, table.meaning);
            let _ = writeln!(text, "double {}({rows},2)", table.name);
            text += &pairs(table);
        }
        text
    }

    fn variables(&self) -> io::Result<Vec<u8>> {
        let mut writer = ArrayWriter::new(ArrayForm::Mat, Vec::new())?;
        for (name, value) in [
            ("pinion_teeth", f64::from(self.pinion_teeth)),
            ("gear_teeth", f64::from(self.gear_teeth)),
            ("pinion_speed_rpm", self.pinion_speed_rpm),
            ("pinion_torque_nm", self.pinion_torque_nm),
            ("half_stagger", self.half_stagger),
        ] {
            writer.scalar(name, value)?;
        }
        for table in &self.tables {
            writer.numbers(&format!("{}_angle_rad", table.name), &table.pinion_angle_rad)?;
            writer.numbers(&format!("{}_phase", table.name), &table.phase)?;
            writer.numbers(&table.name, &table.values)?;
            writer.words(&format!("{}_unit", table.name), &[table.unit])?;
        }
        writer.words("convention", &[CONVENTION])?;
        writer.finish()
    }
}

/// A value as a JSON file.
pub(crate) fn json_file(value: &impl Serialize) -> io::Result<Vec<u8>> {
    let mut text = serde_json::to_vec_pretty(value)?;
    text.push(b'\n');
    Ok(text)
}

fn pairs(table: &LookupTable) -> String {
    let mut text = String::new();
    for (angle, value) in table.pinion_angle_rad.iter().zip(&table.values) {
        // Writing to a text does not fail.
        let _ = writeln!(text, "{angle:?} {value:?}");
    }
    text
}

/// The tables of a curve, closed: the first row again at the end of the period.
fn of_curve(half: &str, curve: &MeshCurve, teeth: u32) -> [LookupTable; 2] {
    let closed = |values: &[f64], factor: f64| {
        let first = values.first().copied();
        values.iter().copied().chain(first).map(|value| value * factor).collect::<Vec<_>>()
    };
    let mut phase = curve.phase.clone();
    phase.push(phase.first().copied().unwrap_or(0.0) + 1.0);
    let table = |name: &str, unit, meaning, values| LookupTable {
        name: format!("{half}{name}"),
        unit,
        meaning,
        pinion_angle_rad: angles(&phase, teeth),
        phase: phase.clone(),
        values,
    };
    [
        table("stiffness", "N/m", "mesh stiffness (tangent) of one half", closed(&curve.stiffness_n_per_um, 1e6)),
        table("transmission_error", "m", "loaded approach of the flanks", closed(&curve.transmission_error_um, 1e-6)),
    ]
}

/// A half sine with zeros before and after it, over a mesh period or, where the pulse lasts longer, more.
fn pulse_table(force_n: f64, start: f64, length: f64, teeth: u32) -> LookupTable {
    let start = start.rem_euclid(1.0);
    let (mut phase, mut values) = (Vec::new(), Vec::new());
    let mut add = |at: f64, value: f64| {
        if phase.last().is_none_or(|last| at > *last) {
            phase.push(at);
            values.push(value);
        }
    };
    if start > 0.0 {
        add(0.0, 0.0);
    }
    for step in 0..=PULSE_STEPS {
        let share = step as f64 / PULSE_STEPS as f64;
        let is_end = step == 0 || step == PULSE_STEPS;
        add(start + share * length, if is_end { 0.0 } else { force_n * (PI * share).sin() });
    }
    add(1.0, 0.0);
    LookupTable {
        name: "impact_force".to_owned(),
        unit: "N",
        meaning: "mesh-in impact force of one half, once per mesh period",
        pinion_angle_rad: angles(&phase, teeth),
        phase,
        values,
    }
}

pub(crate) fn angles(phase: &[f64], teeth: u32) -> Vec<f64> {
    phase.iter().map(|phase| phase * TAU / f64::from(teeth)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::{Geometry, ImpactResult, Mesh};

    fn tables(start_mesh_periods: f64) -> LookupTables {
        let document = herringbone_job::parse(include_bytes!("../../../examples/table1.json")).unwrap();
        let curve = MeshCurve {
            phase: vec![0.0, 0.25, 0.5, 0.75],
            stiffness_n_per_um: vec![900.0, 1000.0, 1100.0, 1000.5],
            transmission_error_um: vec![10.0, 9.0, 8.0, 9.0],
            ..MeshCurve::default()
        };
        let result = JobResult {
            geometry: Some(Geometry { mesh_frequency_hz: 500.0, ..Geometry::default() }),
            mesh: Some(Mesh { curve, ..Mesh::default() }),
            impact: Some(ImpactResult {
                force_n: 3000.0,
                duration_us: 200.0,
                start_mesh_periods,
                ..ImpactResult::default()
            }),
            ..JobResult::default()
        };
        LookupTables::new(&document, &result).unwrap()
    }

    #[test]
    fn a_period_is_closed_and_in_si_units() {
        let tables = tables(0.0);
        let stiffness = tables.table(LookupQuantity::Stiffness).unwrap();
        assert_eq!(stiffness.values, [9e8, 1e9, 1.1e9, 1000.5e6, 9e8]);
        assert_eq!(stiffness.phase, [0.0, 0.25, 0.5, 0.75, 1.0]);
        assert_eq!(stiffness.pinion_angle_rad[4], TAU / 17.0);
        let error = tables.table(LookupQuantity::TransmissionError).unwrap();
        assert!((error.values[2] - 8e-6).abs() < 1e-20 && error.values[4] == error.values[0]);
    }

    #[test]
    fn the_pulse_has_its_force_length_and_impulse() {
        for start in [0.0, 0.3, -0.05] {
            let tables = tables(start);
            let pulse = tables.table(LookupQuantity::ImpactForce).unwrap();
            assert!(pulse.phase.windows(2).all(|pair| pair[0] < pair[1]), "{:?}", pulse.phase);
            assert_eq!(pulse.values.iter().copied().fold(0.0, f64::max), 3000.0);
            let area: f64 = pulse
                .phase
                .windows(2)
                .zip(pulse.values.windows(2))
                .map(|(phase, force)| (phase[1] - phase[0]) * (force[0] + force[1]) / 2.0)
                .sum();
            // A half sine has 2/π of its box.
            assert!((area / (3000.0 * 0.1 * 2.0 / PI) - 1.0).abs() < 1e-3, "{area}");
            assert_eq!((pulse.values.first(), pulse.values.last()), (Some(&0.0), Some(&0.0)));
        }
    }

    #[test]
    fn every_form_has_the_numbers_to_the_bit() {
        let tables = tables(0.3);
        let file = |form, quantity| {
            let bytes = tables.write(form, quantity).unwrap().unwrap();
            String::from_utf8(bytes).unwrap()
        };
        let modelica = file(LookupForm::Modelica, LookupQuantity::Stiffness);
        assert!(modelica.starts_with("#1\n"));
        for table in &tables.tables {
            let start = modelica.find(&format!("\ndouble {}({},2)\n", table.name, table.values.len())).unwrap();
            let mut lines = modelica[start + 1..].lines().skip(1);
            for (angle, value) in table.pinion_angle_rad.iter().zip(&table.values) {
                let (x, y) = lines.next().unwrap().split_once(' ').unwrap();
                let bits = |text: &str| text.parse::<f64>().unwrap().to_bits();
                assert_eq!((bits(x), bits(y)), (angle.to_bits(), value.to_bits()));
            }
        }
        let simpack = file(LookupForm::Simpack, LookupQuantity::TransmissionError);
        assert_eq!(simpack.lines().count(), 5);
        let amesim = file(LookupForm::Amesim, LookupQuantity::TransmissionError);
        assert!(amesim.starts_with("# Table format: 1D\n") && amesim.ends_with(&simpack));
        let json: serde_json::Value = serde_json::from_str(&file(LookupForm::Json, LookupQuantity::Stiffness)).unwrap();
        assert_eq!(json["tables"][0]["values"][3], 1000.5e6);
        let mat = tables.write(LookupForm::Simulink, LookupQuantity::Stiffness).unwrap().unwrap();
        assert!(mat.starts_with(b"MATLAB 5.0"));
    }

    #[test]
    fn without_an_impact_there_is_no_table_of_it() {
        let document = herringbone_job::parse(include_bytes!("../../../examples/table1.json")).unwrap();
        assert_eq!(LookupTables::new(&document, &JobResult::default()), None);
        let mut without = tables(0.0);
        without.tables.pop();
        assert_eq!(without.write(LookupForm::Simpack, LookupQuantity::ImpactForce).unwrap(), None);
    }
}
