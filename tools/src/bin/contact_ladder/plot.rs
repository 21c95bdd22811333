//! Run time against error, both logarithmic, as SVG. Its greys and colours read on white and on black.

use std::fmt::Write;

use crate::rungs::{Answer, Rung};
use crate::tables::{middle, seconds, spread};
use herringbone_physics::fe::Resolution;

const SIZE: [f64; 2] = [920.0, 540.0];
/// Left, right, top, bottom edge of the field.
const FIELD: [f64; 4] = [74.0, 664.0, 28.0, 480.0];
/// Decades of s and of the relative error.
const TIME: [i32; 2] = [-7, 2];
const ERROR: [i32; 2] = [-4, 0];

#[derive(Clone, Copy)]
enum Marker {
    Circle,
    Square,
    Diamond,
    Triangle,
}

/// One series: name, colour, marker, which answers, whether with the teeth's compliance already stored.
struct Series {
    name: &'static str,
    color: &'static str,
    marker: Marker,
    rungs: &'static [Rung],
    stored: bool,
}

const SERIES: [Series; 9] = [
    Series {
        name: "ISO 6336-1 method B",
        color: "#8c8c8c",
        marker: Marker::Square,
        rungs: &[Rung::Iso6336],
        stored: false,
    },
    Series {
        name: "analytic, 12 slices, 16 positions",
        color: "#35a36b",
        marker: Marker::Triangle,
        rungs: &[Rung::Analytic(0)],
        stored: false,
    },
    Series {
        name: "analytic, default",
        color: "#1f8fd6",
        marker: Marker::Circle,
        rungs: &[Rung::Analytic(3)],
        stored: false,
    },
    Series {
        name: "analytic, 120 slices, 0.02 %",
        color: "#7a6fe0",
        marker: Marker::Diamond,
        rungs: &[Rung::Analytic(4)],
        stored: false,
    },
    Series {
        name: "fe coarse, stored",
        color: "#d9a400",
        marker: Marker::Triangle,
        rungs: &[Rung::Elements(Resolution::Coarse)],
        stored: true,
    },
    Series {
        name: "fe medium, stored",
        color: "#e8743b",
        marker: Marker::Circle,
        rungs: &[Rung::Elements(Resolution::Medium)],
        stored: true,
    },
    Series {
        name: "fe coarse, cold",
        color: "#d9a400",
        marker: Marker::Triangle,
        rungs: &[Rung::Elements(Resolution::Coarse)],
        stored: false,
    },
    Series {
        name: "fe medium, cold",
        color: "#e8743b",
        marker: Marker::Circle,
        rungs: &[Rung::Elements(Resolution::Medium)],
        stored: false,
    },
    Series {
        name: "fe standard, cold",
        color: "#d2475f",
        marker: Marker::Diamond,
        rungs: &[Rung::Elements(Resolution::Standard)],
        stored: false,
    },
];

/// The picture.
pub fn draw(answers: &[Answer]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"system-ui, sans-serif\" font-size=\"13\" \
         fill=\"#808080\">\n<title>Run time of one half against the error of its mean mesh stiffness</title>\n",
        SIZE[0], SIZE[1]
    );
    axes(&mut svg);
    for series in &SERIES {
        let of = answers.iter().filter(|a| series.rungs.contains(&a.rung));
        let places: Vec<[f64; 2]> =
            of.map(|a| [if series.stored { a.stored_s } else { a.cold_s }, a.tangent.abs()]).collect();
        for &[time_s, error] in &places {
            marker(&mut svg, series, [x(time_s), y(error)], 2.6, 0.55);
        }
        let time_s = middle(places.iter().map(|p| p[0]).collect());
        let [square, _] = spread(places.iter().map(|p| p[1]));
        marker(&mut svg, series, [x(time_s), y(square)], 7.0, 1.0);
    }
    legend(&mut svg);
    svg.push_str("</svg>\n");
    svg
}

fn axes(svg: &mut String) {
    let [left, right, top, bottom] = FIELD;
    for decade in TIME[0]..=TIME[1] {
        let (value, px) = (10f64.powi(decade), x(10f64.powi(decade)));
        line(svg, [px, top], [px, bottom], 0.3);
        let label = seconds(value * 1.0000001).replace(".0", "").replace(' ', "\u{202f}");
        let label = if decade < -6 { "0.1\u{202f}µs".into() } else { label };
        text(svg, [px, bottom + 20.0], "middle", &label);
    }
    for decade in ERROR[0]..=ERROR[1] {
        let py = y(10f64.powi(decade));
        line(svg, [left, py], [right, py], 0.3);
        let percent = 100.0 * 10f64.powi(decade);
        let digits = (-2 - decade).max(0) as usize;
        text(svg, [left - 8.0, py + 4.5], "end", &format!("{percent:.digits$}\u{202f}%"));
    }
    line(svg, [left, bottom], [right, bottom], 1.0);
    line(svg, [left, top], [left, bottom], 1.0);
    text(svg, [0.5 * (left + right), bottom + 44.0], "middle", "run time of one half over one mesh period, one core");
    let middle = 0.5 * (top + bottom);
    let _ = writeln!(
        svg,
        "<text x=\"16\" y=\"{middle}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {middle})\">error of the mean mesh stiffness</text>"
    );
}

fn legend(svg: &mut String) {
    let left = FIELD[1] + 26.0;
    for (i, series) in SERIES.iter().enumerate() {
        let py = FIELD[2] + 14.0 + 25.0 * i as f64;
        marker(svg, series, [left, py], 6.0, 1.0);
        text(svg, [left + 16.0, py + 4.5], "start", series.name);
    }
    let below = FIELD[2] + 14.0 + 25.0 * SERIES.len() as f64 + 10.0;
    for (i, words) in [
        "small: each case; large: median time,",
        "root mean square error over all cases;",
        "hollow: elements already stored",
    ]
    .into_iter()
    .enumerate()
    {
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{:.1}\" font-size=\"11.5\">{words}</text>",
            left - 8.0,
            below + 17.0 * i as f64
        );
    }
}

fn x(time_s: f64) -> f64 {
    let t = (time_s.log10() - f64::from(TIME[0])) / f64::from(TIME[1] - TIME[0]);
    FIELD[0] + (FIELD[1] - FIELD[0]) * t.clamp(0.0, 1.0)
}

/// Errors below the field lie on its edge.
fn y(error: f64) -> f64 {
    let t = (error.max(1e-12).log10() - f64::from(ERROR[0])) / f64::from(ERROR[1] - ERROR[0]);
    FIELD[3] - (FIELD[3] - FIELD[2]) * t.clamp(0.0, 1.0)
}

fn line(svg: &mut String, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], opacity: f64) {
    let _ = writeln!(
        svg,
        "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"#808080\" stroke-opacity=\"{opacity}\"/>"
    );
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, words: &str) {
    let _ = writeln!(svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>");
}

fn marker(svg: &mut String, series: &Series, [x, y]: [f64; 2], r: f64, opacity: f64) {
    let paint = if series.stored {
        format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"", series.color, if r > 4.0 { 2.2 } else { 1.1 })
    } else {
        format!("fill=\"{}\"", series.color)
    };
    let shape = match series.marker {
        Marker::Circle => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\""),
        Marker::Square => {
            let side = 1.8 * r;
            format!("<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{side:.1}\" height=\"{side:.1}\"", x - 0.9 * r, y - 0.9 * r)
        }
        Marker::Diamond => {
            let d = 1.25 * r;
            format!("<path d=\"M{x:.1} {:.1}l{d:.1} {d:.1}l-{d:.1} {d:.1}l-{d:.1} -{d:.1}z\"", y - d)
        }
        Marker::Triangle => {
            let (w, h) = (2.3 * r, 2.0 * r);
            format!("<path d=\"M{x:.1} {:.1}l{:.1} {h:.1}h-{w:.1}z\"", y - 1.2 * r, 0.5 * w)
        }
    };
    let _ = writeln!(svg, "{shape} {paint} opacity=\"{opacity}\"/>");
}
