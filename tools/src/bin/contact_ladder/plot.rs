//! Run time against error, both logarithmic, as SVG.

use crate::rungs::{Answer, Rung};
use herringbone_physics::fe::Resolution;
use herringbone_tools::plot::{Field, Marker, Scale, Shape, Sheet, time_label};
use herringbone_tools::statistics::{median, root_mean_square};

/// Decades of s and of the relative error.
const TIME: [i32; 2] = [-7, 2];
const ERROR: [i32; 2] = [-4, 0];

/// The answers that are drawn alike.
struct Series {
    name: &'static str,
    color: &'static str,
    shape: Shape,
    rungs: &'static [Rung],
    /// With the teeth's compliance already stored.
    stored: bool,
}

impl Series {
    fn marker(&self) -> Marker {
        Marker { shape: self.shape, color: self.color, hollow: self.stored }
    }
}

const SERIES: [Series; 9] = [
    Series {
        name: "ISO 6336-1 method B",
        color: "#8c8c8c",
        shape: Shape::Square,
        rungs: &[Rung::Iso6336],
        stored: false,
    },
    Series {
        name: "analytic, 12 slices, 16 positions",
        color: "#35a36b",
        shape: Shape::Triangle,
        rungs: &[Rung::Analytic(0)],
        stored: false,
    },
    Series {
        name: "analytic, default",
        color: "#1f8fd6",
        shape: Shape::Circle,
        rungs: &[Rung::Analytic(3)],
        stored: false,
    },
    Series {
        name: "analytic, 120 slices, 0.02 %",
        color: "#7a6fe0",
        shape: Shape::Diamond,
        rungs: &[Rung::Analytic(4)],
        stored: false,
    },
    Series {
        name: "fe coarse, stored",
        color: "#d9a400",
        shape: Shape::Triangle,
        rungs: &[Rung::Elements(Resolution::Coarse)],
        stored: true,
    },
    Series {
        name: "fe medium, stored",
        color: "#e8743b",
        shape: Shape::Circle,
        rungs: &[Rung::Elements(Resolution::Medium)],
        stored: true,
    },
    Series {
        name: "fe coarse, cold",
        color: "#d9a400",
        shape: Shape::Triangle,
        rungs: &[Rung::Elements(Resolution::Coarse)],
        stored: false,
    },
    Series {
        name: "fe medium, cold",
        color: "#e8743b",
        shape: Shape::Circle,
        rungs: &[Rung::Elements(Resolution::Medium)],
        stored: false,
    },
    Series {
        name: "fe standard, cold",
        color: "#d2475f",
        shape: Shape::Diamond,
        rungs: &[Rung::Elements(Resolution::Standard)],
        stored: false,
    },
];

/// The figure.
pub(crate) fn draw(answers: &[Answer]) -> String {
    let title = "Run time of one half against the error of its mean mesh stiffness";
    let mut sheet = Sheet::transparent(920.0, 540.0, 13.0, title);
    let decades = |[from, to]: [i32; 2]| Scale::logarithmic(10f64.powi(from), 10f64.powi(to));
    let field = Field { place: [74.0, 28.0, 590.0, 452.0], x: decades(TIME), y: decades(ERROR) };
    for decade in TIME[0]..=TIME[1] {
        field.grid_x(&mut sheet, 10f64.powi(decade), 0.3, &time_label(decade));
    }
    for decade in ERROR[0]..=ERROR[1] {
        let digits = (-2 - decade).max(0) as usize;
        let label = format!("{:.digits$}\u{202f}%", 100.0 * 10f64.powi(decade));
        field.grid_y(&mut sheet, 10f64.powi(decade), 0.3, &label);
    }
    let x_name = "run time of one half over one mesh period, one core";
    field.open_frame(&mut sheet, x_name, "error of the mean mesh stiffness");
    for series in &SERIES {
        let of = answers.iter().filter(|a| series.rungs.contains(&a.rung));
        let points: Vec<[f64; 2]> =
            of.map(|a| [if series.stored { a.stored_s } else { a.cold_s }, a.tangent.abs()]).collect();
        for &[time_s, error] in &points {
            series.marker().draw(&mut sheet, field.at_clamped(time_s, error), 2.6, 0.55);
        }
        let time_s = median(points.iter().map(|p| p[0]));
        let error = root_mean_square(points.iter().map(|p| p[1]));
        series.marker().draw(&mut sheet, field.at_clamped(time_s, error), 7.0, 1.0);
    }
    legend(&mut sheet);
    sheet.finish()
}

fn legend(sheet: &mut Sheet) {
    let (left, top) = (690.0, 42.0);
    for (i, series) in SERIES.iter().enumerate() {
        let y = top + 25.0 * i as f64;
        series.marker().draw(sheet, [left, y], 6.0, 1.0);
        sheet.label(left + 16.0, y + 4.5, "start", series.name);
    }
    let below = top + 25.0 * SERIES.len() as f64 + 10.0;
    for (i, words) in [
        "small: each case; large: median time,",
        "root mean square error over all cases;",
        "hollow: elements already stored",
    ]
    .into_iter()
    .enumerate()
    {
        sheet.text(left - 8.0, below + 17.0 * i as f64, "start", 11.5, words);
    }
}
