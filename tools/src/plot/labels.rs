//! Names beside the ends of curves.

use super::{Field, Sheet};
use std::f64::consts::TAU;

/// The name of a curve.
#[derive(Debug, Clone)]
pub struct Label {
    /// Points of the sheet beside which it may stand, preferred first.
    pub ends: [[f64; 2]; 2],
    /// Its text.
    pub name: String,
    /// Its colour.
    pub color: &'static str,
}

/// About the width of a letter over the font size.
const LETTER: f64 = 0.488;

/// Writes each label as near to an end of its curve as it fits without touching another label or a curve (polylines in
/// the sheet's coordinates). A label that fits nowhere stands on its first end.
pub fn place(sheet: &mut Sheet, field: &Field, labels: &[Label], curves: &[Vec<[f64; 2]>]) {
    let font = sheet.font_size();
    let ink: Vec<[f64; 2]> =
        curves.iter().flat_map(|curve| curve.windows(2).flat_map(|w| between(w[0], w[1]))).collect();
    let mut taken: Vec<[f64; 4]> = Vec::new();
    let [field_left, field_top, field_width, field_height] = field.place;
    for label in labels {
        let (width, height) = (LETTER * font * label.name.chars().count() as f64, font + 2.0);
        let fits = |[left, top]: [f64; 2]| {
            let (right, bottom) = (left + width, top + height);
            left > field_left + 2.0
                && right < field_left + field_width
                && top > field_top
                && bottom < field_top + field_height
                && taken.iter().all(|t| left > t[1] || right < t[0] || top > t[3] || bottom < t[2])
                && ink
                    .iter()
                    .all(|p| p[0] < left - 5.0 || p[0] > right + 5.0 || p[1] < top - 3.0 || p[1] > bottom + 3.0)
        };
        let corners = around(label.ends, width, height);
        let [left, top] = corners.into_iter().find(|corner| fits(*corner)).unwrap_or(label.ends[0]);
        taken.push([left, left + width, top, top + height]);
        let baseline = top + font - 1.0;
        let (color, name) = (label.color, &label.name);
        sheet.add(format!("<text x=\"{left:.1}\" y=\"{baseline:.1}\" fill=\"{color}\">{name}</text>"));
    }
}

/// Points of a straight line, at most 4 apart.
fn between(a: [f64; 2], b: [f64; 2]) -> impl Iterator<Item = [f64; 2]> {
    let pieces = ((a[0] - b[0]).hypot(a[1] - b[1]) / 4.0).ceil().max(1.0);
    (0..=pieces as usize).map(move |i| {
        let part = i as f64 / pieces;
        [a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])]
    })
}

/// Upper left corners of a box whose middle lies on widening rings about two points, each ring clockwise from the
/// right.
fn around(ends: [[f64; 2]; 2], width: f64, height: f64) -> Vec<[f64; 2]> {
    let rings = (0..60).flat_map(|ring| (0..48).map(move |turn| (4.0 * f64::from(ring), turn)));
    let corner = |(r, turn): (f64, usize)| {
        let (dy, dx) = ((turn % 24) as f64 * TAU / 24.0).sin_cos();
        let end = ends[turn / 24];
        let middle = [end[0] + (r + 0.5 * width + 8.0) * dx, end[1] + (r + 0.5 * height + 6.0) * dy];
        [middle[0] - 0.5 * width, middle[1] - 0.5 * height]
    };
    rings.map(corner).collect()
}
