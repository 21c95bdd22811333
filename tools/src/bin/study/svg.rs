//! Line plots as SVG on a white sheet, so that they read in light and dark pages.

use std::fmt::Write;

/// Okabe and Ito's colours, told apart by every kind of eye.
pub const BLACK: &str = "#222222";
pub const BLUE: &str = "#0072b2";
pub const ORANGE: &str = "#d55e00";
pub const GREEN: &str = "#009e73";
pub const PURPLE: &str = "#cc79a7";
pub const GREY: &str = "#8a8a8a";

/// A sheet that is drawn on.
pub struct Sheet {
    body: String,
    size: [f64; 2],
}

impl Sheet {
    pub fn new(width: f64, height: f64) -> Self {
        Self { body: String::new(), size: [width, height] }
    }

    pub fn add(&mut self, element: impl AsRef<str>) {
        self.body.push_str(element.as_ref());
        self.body.push('\n');
    }

    pub fn text(&mut self, x: f64, y: f64, anchor: &str, size: f64, text: &str) {
        self.add(format!(r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}">{text}</text>"#));
    }

    pub fn title(&mut self, x: f64, y: f64, text: &str) {
        self.add(format!(r#"<text x="{x:.1}" y="{y:.1}" font-size="13" font-weight="600">{text}</text>"#));
    }

    /// One line of the legend: a stroke or a dot, and its meaning.
    pub fn key(&mut self, x: f64, y: f64, style: &Style, text: &str) {
        if style.width > 0.0 {
            self.add(format!(r#"<path d="M{x:.1} {y:.1}h22" {}/>"#, style.stroke()));
        }
        if style.dot > 0.0 {
            self.add(format!(r#"<circle cx="{:.1}" cy="{y:.1}" r="{}" {}/>"#, x + 11.0, style.dot, style.fill()));
        }
        self.text(x + 28.0, y + 4.0, "start", 12.0, text);
    }

    pub fn finish(self) -> String {
        let [width, height] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"system-ui, sans-serif\" font-size=\"12\" fill=\"{BLACK}\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }
}

/// How a curve or its points look.
#[derive(Clone, Copy)]
pub struct Style {
    pub color: &'static str,
    /// Of the line; 0: none.
    pub width: f64,
    pub dashes: &'static str,
    /// Radius of the points; 0: none.
    pub dot: f64,
    pub hollow: bool,
}

impl Style {
    pub fn line(color: &'static str) -> Self {
        Self { color, width: 1.8, dashes: "", dot: 0.0, hollow: false }
    }

    pub fn dots(color: &'static str) -> Self {
        Self { width: 0.0, dot: 3.6, ..Self::line(color) }
    }

    pub fn both(color: &'static str) -> Self {
        Self { dot: 3.2, ..Self::line(color) }
    }

    pub fn dashed(self) -> Self {
        Self { dashes: "5 4", ..self }
    }

    pub fn hollow(self) -> Self {
        Self { hollow: true, ..self }
    }

    pub fn thin(self) -> Self {
        Self { width: 1.0, ..self }
    }

    fn stroke(&self) -> String {
        let dashes =
            if self.dashes.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{}""#, self.dashes) };
        format!(r#"fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"{dashes}"#, self.color, self.width)
    }

    fn fill(&self) -> String {
        if self.hollow {
            format!(r##"fill="#ffffff" stroke="{}" stroke-width="1.6""##, self.color)
        } else {
            format!(r#"fill="{}""#, self.color)
        }
    }
}

/// One axis: its range, linear or logarithmic.
#[derive(Clone, Copy)]
pub struct Scale {
    pub from: f64,
    pub to: f64,
    pub logarithmic: bool,
}

impl Scale {
    pub fn linear(from: f64, to: f64) -> Self {
        Self { from, to, logarithmic: false }
    }

    pub fn logarithmic(from: f64, to: f64) -> Self {
        Self { from, to, logarithmic: true }
    }

    /// A linear scale that holds all values and begins at zero, or reaches as far down as up where some are negative.
    pub fn holding(values: impl Iterator<Item = f64> + Clone) -> Self {
        let most = values.clone().fold(1e-12, |most: f64, value| most.max(value.abs())) * 1.06;
        let least = values.fold(0.0, f64::min);
        Self::linear(if least < 0.0 { -most } else { 0.0 }, most)
    }

    pub fn part(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.from).ln() / (self.to / self.from).ln()
        } else {
            (value - self.from) / (self.to - self.from)
        }
    }

    fn ticks(&self) -> Vec<f64> {
        if self.logarithmic {
            let decades = (self.to / self.from).log10();
            let steps: &[f64] = if decades > 2.5 {
                &[1.0]
            } else if decades > 1.2 {
                &[1.0, 3.0]
            } else {
                &[1.0, 2.0, 5.0]
            };
            let first = self.from.log10().floor() as i32;
            let all = (first..=first + 8).flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
            return all.filter(|tick| (self.from * 0.999..=self.to * 1.001).contains(tick)).collect();
        }
        let rough = (self.to - self.from).abs() / 4.5;
        let decade = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 2.5, 5.0, 10.0]
            .map(|step| step * decade)
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(rough);
        let first = (self.from / step - 1e-9).ceil() as i64;
        let last = (self.to / step + 1e-9).floor() as i64;
        (first..=last).map(|tick| tick as f64 * step).collect()
    }
}

fn label(value: f64) -> String {
    let text = format!("{:.3}", value);
    let text = text.trim_end_matches('0').trim_end_matches('.').replace('-', "−");
    if text == "−0" { "0".into() } else { text }
}

/// A field with two axes.
pub struct Field {
    /// Left, top, width, height.
    pub place: [f64; 4],
    pub x: Scale,
    pub y: Scale,
}

impl Field {
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
            sheet.text(x, top + height + 15.0, "middle", 11.0, &label(tick));
        }
        for tick in self.y.ticks() {
            let y = top + height * (1.0 - self.y.part(tick));
            sheet.add(format!(r##"<path d="M{left} {y:.1}h{width}" stroke="#e4e4e4"/>"##));
            sheet.text(left - 5.0, y + 4.0, "end", 11.0, &label(tick));
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
