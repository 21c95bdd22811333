//! Run time against error, both logarithmic, as SVG: one figure for each case.

use crate::case::ReferenceCase;
use crate::measure::{Ladder, error_periods};
use crate::methods::Origin;
use crate::tables::{RESTARTED, better};
use herringbone_tools::plot::{Field, Label, Scale, Sheet, Style, place, power_of_ten, time_label};

/// Decades of s per mesh period and of the relative error.
const TIME: [f64; 2] = [-6.3, -1.5];
const ERROR: [i32; 2] = [-14, 0];

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

/// The figure of a case.
pub fn draw(case: &ReferenceCase, ladders: &[Ladder]) -> String {
    let title = format!("Case {}: run time against error", case.name);
    let mut sheet = Sheet::transparent(920.0, 560.0, 12.5, &title);
    let field = Field {
        place: [66.0, 20.0, 834.0, 480.0],
        x: Scale::logarithmic(10f64.powf(TIME[0]), 10f64.powf(TIME[1])),
        y: Scale::logarithmic(10f64.powi(ERROR[0]), 10f64.powi(ERROR[1])),
    };
    axes(&mut sheet, &field, case);
    let mut left = better(case, ladders);
    let (mut labels, mut curves) = (Vec::new(), Vec::new());
    for series in &SERIES {
        let time = |l: &Ladder| l.seconds_at(1e-6).unwrap_or(f64::INFINITY);
        let matching = left.iter().filter(|l| series.names.iter().any(|n| l.name.starts_with(n)));
        let Some(ladder) = matching.min_by(|a, b| time(a).total_cmp(&time(b))).copied() else { continue };
        left.retain(|l| !std::ptr::eq(*l, ladder));
        // Errors and times beyond the field lie on its edge.
        let points: Vec<(f64, f64)> =
            ladder.rungs.iter().map(|r| (field.x.clamp(r.seconds), field.y.clamp(r.error))).collect();
        let width = if ladder.origin == Origin::Own { 2.6 } else { 1.5 };
        let color = series.color;
        field.draw(&mut sheet, &points, Style { width, dot: 2.6, ..Style::line(color) });
        let curve: Vec<[f64; 2]> = points.iter().map(|&(x, y)| field.at_clamped(x, y)).collect();
        if let (Some(coarsest), Some(finest)) = (curve.first(), curve.last()) {
            labels.push(Label {
                ends: [*finest, *coarsest],
                name: ladder.name.replace(RESTARTED, " (restarted)"),
                color,
            });
        }
        curves.push(curve);
    }
    place(&mut sheet, &field, &labels, &curves);
    sheet.finish()
}

fn axes(sheet: &mut Sheet, field: &Field, case: &ReferenceCase) {
    for decade in -6..=-2 {
        field.grid_x(sheet, 10f64.powi(decade), 0.3, &time_label(decade));
    }
    for decade in ERROR[0]..=ERROR[1] {
        let label = if decade % 2 == 0 { power_of_ten(decade) } else { String::new() };
        field.grid_y(sheet, 10f64.powi(decade), if decade == -6 { 0.8 } else { 0.25 }, &label);
    }
    let y_name = format!("case {}: relative error after {} mesh periods", case.name, error_periods(case));
    field.open_frame(sheet, "run time per mesh period and operating point, one thread", &y_name);
}
