//! A rectangle with two axes.

use super::scale::{Scale, tick_label};
use super::sheet::{Sheet, Style};
use std::fmt::Write;

/// A rectangle of a sheet with two axes.
#[derive(Debug, Clone, Copy)]
pub struct Field {
    /// Left, top, width, height.
    pub place: [f64; 4],
    /// The scale to the right.
    pub x: Scale,
    /// The scale upwards.
    pub y: Scale,
}

impl Field {
    /// The point of the sheet of a pair of values.
    pub fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let [left, top, width, height] = self.place;
        (left + width * self.x.part(x), top + height * (1.0 - self.y.part(y)))
    }

    /// Frame, grid, ticks and names.
    pub fn axes(&self, sheet: &mut Sheet, title: &str, x_name: &str, y_name: &str) {
        let [left, top, width, height] = self.place;
        for tick in self.x.ticks() {
            let x = left + width * self.x.part(tick);
            sheet.add(format!(r##"<path d="M{x:.1} {top}v{height}" stroke="#e4e4e4"/>"##));
            sheet.text(x, top + height + 15.0, "middle", 11.0, &tick_label(tick));
        }
        for tick in self.y.ticks() {
            let y = top + height * (1.0 - self.y.part(tick));
            sheet.add(format!(r##"<path d="M{left} {y:.1}h{width}" stroke="#e4e4e4"/>"##));
            sheet.text(left - 5.0, y + 4.0, "end", 11.0, &tick_label(tick));
        }
        sheet.add(format!(
            r##"<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#777777"/>"##
        ));
        sheet.title(left, top - 8.0, title);
        sheet.text(left + width / 2.0, top + height + 32.0, "middle", 12.0, x_name);
        let (x, y) = (left - 42.0, top + height / 2.0);
        sheet.add(format!(
            r#"<text transform="translate({x:.1} {y:.1}) rotate(-90)" text-anchor="middle">{y_name}</text>"#
        ));
    }

    /// The point of the sheet of a pair of values; on the field's edge where they are outside.
    pub fn at_clamped(&self, x: f64, y: f64) -> [f64; 2] {
        let (x, y) = self.at(self.x.clamp(x), self.y.clamp(y));
        [x, y]
    }

    /// An upright grid line with its label below.
    pub fn grid_x(&self, sheet: &mut Sheet, value: f64, opacity: f64, label: &str) {
        let [_, top, _, height] = self.place;
        let (x, _) = self.at(value, self.y.from);
        sheet.line([x, top], [x, top + height], opacity);
        sheet.label(x, top + height + 20.0, "middle", label);
    }

    /// A level grid line with its label at the left; no label where it is empty.
    pub fn grid_y(&self, sheet: &mut Sheet, value: f64, opacity: f64, label: &str) {
        let [left, _, width, _] = self.place;
        let (_, y) = self.at(self.x.from, value);
        sheet.line([left, y], [left + width, y], opacity);
        if !label.is_empty() {
            sheet.label(left - 8.0, y + 4.5, "end", label);
        }
    }

    /// The left and the lower edge, and what the axes show.
    pub fn open_frame(&self, sheet: &mut Sheet, x_name: &str, y_name: &str) {
        let [left, top, width, height] = self.place;
        let bottom = top + height;
        sheet.line([left, bottom], [left + width, bottom], 1.0);
        sheet.line([left, top], [left, bottom], 1.0);
        sheet.label(left + 0.5 * width, bottom + 44.0, "middle", x_name);
        sheet.upright(16.0, top + 0.5 * height, y_name);
    }

    /// A curve, or points, or both; what is outside of the field is left out.
    pub fn draw(&self, sheet: &mut Sheet, points: &[(f64, f64)], style: Style) {
        let inside = |&&(x, y): &&(f64, f64)| {
            (-0.002..=1.002).contains(&self.x.part(x)) && (-0.002..=1.002).contains(&self.y.part(y))
        };
        if style.width > 0.0 {
            let mut path = String::new();
            let mut pen = 'M';
            for point in points {
                if !inside(&point) {
                    pen = 'M';
                    continue;
                }
                let (x, y) = self.at(point.0, point.1);
                let _ = write!(path, "{pen}{x:.1} {y:.1}");
                pen = 'L';
            }
            sheet.add(format!(r#"<path d="{path}" {}/>"#, style.stroke()));
        }
        if style.dot > 0.0 {
            for point in points.iter().filter(inside) {
                let (x, y) = self.at(point.0, point.1);
                sheet.add(format!(r#"<circle cx="{x:.1}" cy="{y:.1}" r="{}" {}/>"#, style.dot, style.fill()));
            }
        }
    }

    /// Bars from the bottom of the field.
    pub fn bars(&self, sheet: &mut Sheet, points: &[(f64, f64)], color: &str) {
        let bottom = self.place[1] + self.place[3];
        for &(x, y) in points.iter().filter(|(_, y)| self.y.part(*y) > 0.0) {
            let (x, y) = self.at(x, y);
            sheet.add(format!(
                r#"<path d="M{x:.1} {bottom:.1}V{:.1}" stroke="{color}" stroke-width="4"/>"#,
                y.max(self.place[1])
            ));
        }
    }
}
