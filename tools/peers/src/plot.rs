//! Run time against error on logarithmic axes, as SVG: one figure per case, with colours for light and dark
//! backgrounds.

use std::f64::consts::TAU;
use std::fmt::Write;

use crate::case::ReferenceCase;
use crate::measure::{Ladder, error_periods};
use crate::methods::Origin;
use crate::tables::{RESTARTED, better};

const SIZE: [f64; 2] = [920.0, 560.0];
/// Left, right, top, bottom edge of the axes.
const FIELD: [f64; 4] = [66.0, 900.0, 20.0, 500.0];
/// Decades of s per mesh period and of the relative error.
const TIME: [f64; 2] = [-6.3, -1.5];
const ERROR: [f64; 2] = [-14.0, 0.0];
const FONT: f64 = 12.5;
/// Approximate width of a letter.
const LETTER: f64 = 6.1;

/// A line: prefixes of the names of the methods it may show (the fastest of them at 1e-6), and its colour.
struct PlottedMethod {
    names: &'static [&'static str],
    color: &'static str,
}

const SERIES: [PlottedMethod; 12] = [
    PlottedMethod { names: &["herringbone Taylor, 8"], color: "#12a5a5" },
    PlottedMethod { names: &["herringbone Taylor, 12"], color: "#35a36b" },
    PlottedMethod { names: &["herringbone Taylor"], color: "#1f8fd6" },
    PlottedMethod { names: &["herringbone Runge"], color: "#5f8fb0" },
    PlottedMethod { names: &["heyoka Taylor with events, 8"], color: "#c05fc0" },
    PlottedMethod { names: &["heyoka Taylor with events"], color: "#9a3fb0" },
    PlottedMethod { names: &["ode_solvers"], color: "#d9a400" },
    PlottedMethod { names: &["differential-equations DOP853"], color: "#e8743b" },
    PlottedMethod { names: &["differential-equations DOPRI5", "differential-equations Verner"], color: "#d2475f" },
    PlottedMethod { names: &["diffsol"], color: "#7a6fe0" },
    PlottedMethod { names: &["SciPy DOP853"], color: "#8c8c8c" },
    PlottedMethod { names: &["SciPy odeint", "SciPy ode(", "SciPy LSODA", "SciPy RK45"], color: "#a07850" },
];

/// Figure of a case.
pub fn draw(case: &ReferenceCase, ladders: &[Ladder]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"system-ui, sans-serif\" font-size=\"{FONT}\" \
         fill=\"#808080\">\n<title>Case {}: run time against error</title>\n",
        SIZE[0], SIZE[1], case.name
    );
    axes(&mut svg, case);
    let mut left = better(case, ladders);
    let (mut labels, mut lines) = (Vec::new(), Vec::new());
    for series in &SERIES {
        let time = |l: &Ladder| l.seconds_at(1e-6).unwrap_or(f64::INFINITY);
        let matching = left.iter().filter(|l| series.names.iter().any(|n| l.name.starts_with(n)));
        let Some(ladder) = matching.min_by(|a, b| time(a).total_cmp(&time(b))).copied() else { continue };
        left.retain(|l| !std::ptr::eq(*l, ladder));
        let places: Vec<[f64; 2]> = ladder.rungs.iter().map(|r| [x(r.seconds), y(r.error)]).collect();
        let path: Vec<String> = places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let width = if ladder.origin == Origin::Own { 2.6 } else { 1.5 };
        let color = series.color;
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"/>",
            path.join(" ")
        );
        for [x, y] in &places {
            let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.6\" fill=\"{color}\"/>");
        }
        if let (Some(begin), Some(end)) = (places.first(), places.last()) {
            labels.push(Label { ends: [*end, *begin], name: ladder.name.replace(RESTARTED, " (restarted)"), color });
        }
        lines.push(places);
    }
    place(&mut svg, labels, &lines);
    svg.push_str("</svg>\n");
    svg
}

struct Label {
    /// Points of the finest and the coarsest tolerance.
    ends: [[f64; 2]; 2],
    name: String,
    color: &'static str,
}

/// Places each name near an end of its line, without overlap with other names and lines.
fn place(svg: &mut String, labels: Vec<Label>, lines: &[Vec<[f64; 2]>]) {
    let between = |a: [f64; 2], b: [f64; 2]| {
        let pieces = ((a[0] - b[0]).hypot(a[1] - b[1]) / 4.0).ceil().max(1.0);
        (0..=pieces as usize).map(move |i| {
            let part = i as f64 / pieces;
            [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
        })
    };
    let inked: Vec<[f64; 2]> =
        lines.iter().flat_map(|l| l.windows(2).flat_map(|w| between(w[0], w[1])).collect::<Vec<_>>()).collect();
    let mut taken: Vec<[f64; 4]> = Vec::new();
    for label in labels {
        let (width, height) = (LETTER * label.name.chars().count() as f64, FONT + 2.0);
        let fits = |[left, top]: [f64; 2]| {
            let (right, bottom) = (left + width, top + height);
            left > FIELD[0] + 2.0
                && right < FIELD[1]
                && top > FIELD[2]
                && bottom < FIELD[3]
                && taken.iter().all(|t| left > t[1] || right < t[0] || top > t[3] || bottom < t[2])
                && inked
                    .iter()
                    .all(|p| p[0] < left - 5.0 || p[0] > right + 5.0 || p[1] < top - 3.0 || p[1] > bottom + 3.0)
        };
        // Centres of the name on widening rings about the ends, from the right downwards.
        let rings = (0..60).flat_map(|ring| (0..48).map(move |turn| (4.0 * f64::from(ring), turn)));
        let spot = rings
            .map(|(r, turn)| {
                let (dy, dx) = (f64::from(turn % 24) * TAU / 24.0).sin_cos();
                let end = label.ends[turn as usize / 24];
                let middle = [end[0] + (r + 0.5 * width + 8.0) * dx, end[1] + (r + 0.5 * height + 6.0) * dy];
                [middle[0] - 0.5 * width, middle[1] - 0.5 * height]
            })
            .find(|corner| fits(*corner));
        let [left, top] = spot.unwrap_or(label.ends[0]);
        taken.push([left, left + width, top, top + height]);
        let _ = writeln!(
            svg,
            "<text x=\"{left:.1}\" y=\"{:.1}\" fill=\"{}\">{}</text>",
            top + FONT - 1.0,
            label.color,
            label.name
        );
    }
}

fn axes(svg: &mut String, case: &ReferenceCase) {
    let [left, right, top, bottom] = FIELD;
    for (decade, label) in (-6..).zip(["1 µs", "10 µs", "0.1 ms", "1 ms", "10 ms"]) {
        let px = x(10f64.powi(decade));
        line(svg, [px, top], [px, bottom], 0.3);
        text(svg, [px, bottom + 20.0], "middle", &label.replace(' ', "\u{202f}"));
    }
    for decade in ERROR[0] as i32..=ERROR[1] as i32 {
        let py = y(10f64.powi(decade));
        line(svg, [left, py], [right, py], if decade == -6 { 0.8 } else { 0.25 });
        if decade % 2 == 0 {
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">10<tspan dy=\"-5\" font-size=\"9.5\">{}</tspan></text>",
                left - 8.0,
                py + 4.5,
                decade.to_string().replace('-', "−")
            );
        }
    }
    line(svg, [left, bottom], [right, bottom], 1.0);
    line(svg, [left, top], [left, bottom], 1.0);
    text(
        svg,
        [0.5 * (left + right), bottom + 44.0],
        "middle",
        "run time per mesh period and operating point, one thread",
    );
    let middle = 0.5 * (top + bottom);
    let _ = writeln!(
        svg,
        "<text x=\"16\" y=\"{middle}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {middle})\">case {}: relative error after {} mesh periods</text>",
        case.name,
        error_periods(case)
    );
}

/// Values outside the axes are drawn on their edge.
fn x(time_s: f64) -> f64 {
    let t = (time_s.log10() - TIME[0]) / (TIME[1] - TIME[0]);
    FIELD[0] + (FIELD[1] - FIELD[0]) * t.clamp(0.0, 1.0)
}

fn y(error: f64) -> f64 {
    let t = (error.max(1e-20).log10() - ERROR[0]) / (ERROR[1] - ERROR[0]);
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
