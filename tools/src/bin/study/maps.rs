//! Maps over contact ratio and one other input, through sweeps: RMS, dynamic factor, regime and contact, the best
//! designs marked.

use crate::Study;
use crate::ask::{Axis, Outcome, Swept};
use crate::page::sig;
use herringbone_job::document::Spacing;
use herringbone_job::grid;
use herringbone_tools::plot::{Field, Scale, Sheet, image};
use serde_json::Value;
use std::fmt::Write;

/// The input of a map that goes upwards.
#[derive(Clone)]
pub(crate) struct Upwards {
    pub pointer: &'static str,
    /// Inputs that go with it.
    pub also: &'static [&'static str],
    pub values: Vec<f64>,
    pub name: &'static str,
    pub logarithmic: bool,
}

/// One map: the contact ratio (by face width) to the right, another input upwards.
pub(crate) struct Map {
    pub name: &'static str,
    pub title: &'static str,
    pub document: Value,
    pub widths_mm: Vec<f64>,
    pub upwards: Upwards,
}

/// A solved map: points by column (width), then row (value).
pub(crate) struct Solved {
    pub map: Map,
    pub ratios: Vec<f64>,
    /// RMS of the circumferential acceleration, the larger of both halves.
    pub rms: Vec<Vec<f64>>,
    pub axial: Vec<Vec<f64>>,
    pub factor: Vec<Vec<f64>>,
    /// Least s, µm: negative where the back flanks touch.
    lowest: Vec<Vec<f64>>,
    pub contact: Vec<Vec<String>>,
    pub regime: Vec<Vec<String>>,
    pub seconds: f64,
}

/// So many values from one to another, in equal steps or equal ratios.
pub(crate) fn spaced(from: f64, to: f64, count: usize, logarithmic: bool) -> Vec<f64> {
    grid::values(from, to, count, if logarithmic { Spacing::Logarithmic } else { Spacing::Linear })
}

impl Map {
    pub(crate) fn solve(self, study: &mut Study) -> Outcome<Solved> {
        let Swept { points, seconds } = study.bench.sweep(
            &self.document,
            &[
                Axis { pointer: self.upwards.pointer, also: self.upwards.also, values: &self.upwards.values },
                Axis { pointer: "/design/face_width_mm", also: &[], values: &self.widths_mm },
            ],
        )?;
        if points.len() != self.widths_mm.len() * self.upwards.values.len() {
            return Err("a map has points missing".into());
        }
        let columns: Vec<&[Value]> = points.chunks(self.upwards.values.len()).collect();
        let table = |read: &dyn Fn(&Value) -> Outcome<f64>| -> Outcome<Vec<Vec<f64>>> {
            columns.iter().map(|column| column.iter().map(read).collect()).collect()
        };
        let words = |name: &str| {
            let word = |point: &Value| point[name].as_str().unwrap_or(UNKNOWN).to_owned();
            columns.iter().map(|column| column.iter().map(word).collect()).collect::<Vec<Vec<String>>>()
        };
        let larger = |point: &Value, name: &str| -> Outcome<f64> {
            let [left, right] = ["left", "right"].map(|half| point[name][half].as_f64());
            Ok(left.zip(right).map_or(f64::NAN, |(left, right)| left.max(right)))
        };
        Ok(Solved {
            ratios: columns.iter().map(|column| known(column, "total_contact_ratio")).collect::<Outcome<_>>()?,
            rms: table(&|point| larger(point, "mesh_circumferential_acceleration_rms_m_s2"))?,
            axial: table(&|point| larger(point, "pinion_axial_acceleration_rms_m_s2"))?,
            factor: table(&|point| Ok(point["dynamic_factor"].as_f64().unwrap_or(f64::NAN)))?,
            lowest: table(&|point| Ok(point["min_displacement_um"].as_f64().unwrap_or(f64::NAN)))?,
            contact: words("contact"),
            regime: words("regime"),
            seconds,
            map: self,
        })
    }
}

/// A number that all points of a column share, from the first one that has it.
fn known(column: &[Value], name: &str) -> Outcome<f64> {
    column
        .iter()
        .find_map(|point| point[name].as_f64())
        .ok_or_else(|| format!("no point of a column has its {name}").into())
}

impl Solved {
    pub(crate) fn count(&self) -> usize {
        self.rms.iter().map(Vec::len).sum()
    }

    /// For every value of the other input, the column with the lowest RMS.
    pub(crate) fn ridge(&self) -> Vec<usize> {
        let best = |row: usize| {
            (0..self.rms.len()).min_by(|a, b| self.rms[*a][row].total_cmp(&self.rms[*b][row])).unwrap_or(0)
        };
        (0..self.map.upwards.values.len()).map(best).collect()
    }

    /// The ridge in words.
    pub(crate) fn ridge_words(&self) -> String {
        let ridge = self.ridge();
        let last = self.ratios.len() - 1;
        let near = ridge.iter().filter(|column| **column + 2 >= last).count();
        let ratios = || ridge.iter().map(|column| self.ratios[*column]);
        let (least, most) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max));
        if near == ridge.len() {
            format!("the best contact ratio is the greatest of the map (ε {} or more) everywhere", sig(least, 3))
        } else {
            format!(
                "the best contact ratio lies between {} and {}; it is the greatest of the map in {} % of the rows",
                sig(least, 3),
                sig(most, 3),
                sig(100.0 * near as f64 / ridge.len() as f64, 2)
            )
        }
    }

    pub(crate) fn extremes(table: &[Vec<f64>]) -> (f64, f64) {
        let all = || table.iter().flatten().copied();
        (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max))
    }

    /// The column whose contact ratio is nearest.
    pub(crate) fn nearest(&self, ratio: f64) -> usize {
        let distance = |column: &usize| (self.ratios[*column] - ratio).abs();
        (0..self.ratios.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }

    /// Difference between the greatest and the least dynamic factor of a column, the largest of all columns.
    pub(crate) fn factor_swing(&self) -> f64 {
        let swing = |column: &Vec<f64>| {
            let (least, most) = column.iter().fold((f64::INFINITY, 0f64), |(a, b), v| (a.min(*v), b.max(*v)));
            most - least
        };
        self.factor.iter().map(swing).fold(0.0, f64::max)
    }

    /// Points that the solver gave up.
    pub(crate) fn unsolved(&self) -> usize {
        self.contact.iter().flatten().filter(|contact| *contact == UNKNOWN).count()
    }

    pub(crate) fn is_separated(&self, column: usize, row: usize) -> bool {
        !matches!(self.contact[column][row].as_str(), "continuous" | UNKNOWN)
    }

    /// Points without continuous contact.
    pub(crate) fn separated(&self) -> usize {
        let column =
            |column: usize| (0..self.map.upwards.values.len()).filter(|row| self.is_separated(column, *row)).count();
        (0..self.ratios.len()).map(column).sum()
    }

    /// Points that rest on their back flanks all the time.
    pub(crate) fn on_back_flanks(&self) -> usize {
        let column =
            |column: usize| (0..self.map.upwards.values.len()).filter(|row| self.state(column, *row) == 7).count();
        (0..self.ratios.len()).map(column).sum()
    }

    /// Points that do not repeat every mesh period.
    pub(crate) fn other_regimes(&self) -> usize {
        self.regime.iter().flatten().filter(|regime| !matches!(regime.as_str(), "period-1" | UNKNOWN)).count()
    }

    pub(crate) fn draw(&self, study: &mut Study) {
        let lines = self.present().len() as f64;
        let mut sheet = Sheet::white(970.0, f64::max(430.0, 374.0 + 16.0 * lines));
        let scale = |values: &[f64]| {
            let (from, to) = (values[0], values[values.len() - 1]);
            if self.map.upwards.logarithmic { Scale::logarithmic(from, to) } else { Scale::linear(from, to) }
        };
        let field = |index: f64| Field {
            place: [62.0 + 305.0 * index, 54.0, 240.0, 270.0],
            x: Scale::linear(self.ratios[0], self.ratios[self.ratios.len() - 1]),
            y: scale(&self.map.upwards.values),
        };
        sheet.title(20.0, 20.0, self.map.title);
        let (least, most) = Self::extremes(&self.rms);
        self.shades(&mut sheet, &field(0.0), "RMS, m/s²", &self.rms, Scale::logarithmic(least, most.max(1.05 * least)));
        let (least, most) = Self::extremes(&self.factor);
        let most = most.max(least + 0.02);
        let scale = if most > 3.0 * least { Scale::logarithmic(least, most) } else { Scale::linear(least, most) };
        self.shades(&mut sheet, &field(1.0), "Dynamic factor", &self.factor, scale);
        self.states(&mut sheet, &field(2.0));
        let ridge = field(0.0);
        let mut dots = String::new();
        for (row, column) in self.ridge().into_iter().enumerate() {
            let (x, y) = ridge.at(self.ratios[column], self.map.upwards.values[row]);
            let _ = write!(
                dots,
                r##"<circle cx="{x:.1}" cy="{y:.1}" r="2.2" fill="#ffffff" stroke="#222222" stroke-width="0.8"/>"##
            );
        }
        sheet.add(dots);
        sheet.add(r##"<circle cx="70" cy="414" r="2.6" fill="#ffffff" stroke="#222222"/>"##);
        sheet.text(80.0, 418.0, "start", 11.0, "lowest RMS of each row");
        study.figure(self.map.name, sheet, &format!("{}. RMS, dynamic factor, regime and contact.", self.map.title));
    }

    /// Rows of an image from the top, with a half cell cut off around by the field's frame.
    fn rows<T>(&self, color: impl Fn(usize, usize) -> T) -> Vec<Vec<T>> {
        (0..self.map.upwards.values.len())
            .rev()
            .map(|row| (0..self.ratios.len()).map(|column| color(column, row)).collect())
            .collect()
    }

    fn shades(&self, sheet: &mut Sheet, field: &Field, title: &str, table: &[Vec<f64>], scale: Scale) {
        sheet.add(image::image(&self.rows(|column, row| shade(scale.part(table[column][row]))), field.place));
        field.axes(sheet, title, "contact ratio", if field.place[0] < 100.0 { self.map.upwards.name } else { "" });
        let [left, top, width, height] = field.place;
        let steps: Vec<_> = (0..=60).map(|step| image::color(f64::from(step) / 60.0)).collect();
        sheet.add(image::image(&[steps], [left, top + height + 44.0, width, 9.0]));
        for (part, anchor) in [(0.0, "start"), (0.5, "middle"), (1.0, "end")] {
            sheet.text(left + part * width, top + height + 66.0, anchor, 11.0, &sig(scale.value(part), 3));
        }
    }

    fn states(&self, sheet: &mut Sheet, field: &Field) {
        sheet.add(image::image(&self.rows(|column, row| STATES[self.state(column, row)].1), field.place));
        field.axes(sheet, "Contact and regime", "contact ratio", "");
        let [left, top, _, height] = field.place;
        for (line, state) in self.present().into_iter().enumerate() {
            let (name, [red, green, blue]) = STATES[state];
            let y = top + height + 44.0 + 16.0 * line as f64;
            sheet.add(format!(r##"<rect x="{left}" y="{y}" width="14" height="10" fill="rgb({red},{green},{blue})" stroke="#777777" stroke-width="0.5"/>"##));
            sheet.text(left + 20.0, y + 9.0, "start", 11.0, name);
        }
    }

    /// The states that occur.
    fn present(&self) -> Vec<usize> {
        let rows = self.map.upwards.values.len();
        let occurs =
            |state: &usize| (0..self.ratios.len()).any(|column| (0..rows).any(|row| self.state(column, row) == *state));
        (0..STATES.len()).filter(occurs).collect()
    }

    fn state(&self, column: usize, row: usize) -> usize {
        let repeats = self.regime[column][row] == "period-1";
        match (self.contact[column][row].as_str(), repeats) {
            (UNKNOWN, _) => 6,
            ("continuous", _) if self.lowest[column][row] < 0.0 => 7,
            ("continuous", true) => 0,
            ("single-sided", true) => 1,
            ("double-sided", true) => 2,
            ("continuous", false) => 3,
            _ if self.regime[column][row].starts_with("period") => 4,
            _ => 5,
        }
    }
}

/// A part of the scale as a colour; grey where there is no number.
fn shade(part: f64) -> [u8; 3] {
    if part.is_nan() { [150, 150, 150] } else { image::color(part) }
}

/// Contact and regime of a point without a result.
const UNKNOWN: &str = "unknown";

/// States distinguished in the third panel, with their colours (RGB).
const STATES: [(&str, [u8; 3]); 8] = [
    ("contact kept, repeats every mesh period", [214, 231, 242]),
    ("teeth separate, every mesh period", [230, 159, 0]),
    ("also the back flanks meet, every mesh period", [213, 94, 0]),
    ("contact kept, longer period", [86, 180, 233]),
    ("teeth separate, longer period", [204, 121, 167]),
    ("teeth separate, never repeats", [60, 30, 80]),
    ("not found within the budget of steps", [150, 150, 150]),
    ("contact kept, but on the back flanks", [120, 160, 130]),
];
