//! An SVG document, and the styles of curves. Lengths are in the units of its view box.

/// Colours of Okabe and Ito, distinct for all kinds of colour vision, and greys.
pub const BLACK: &str = "#222222";
/// See [`BLACK`].
pub const BLUE: &str = "#0072b2";
/// See [`BLACK`].
pub const ORANGE: &str = "#d55e00";
/// See [`BLACK`].
pub const GREEN: &str = "#009e73";
/// See [`BLACK`].
pub const PURPLE: &str = "#cc79a7";
/// See [`BLACK`].
pub const GREY: &str = "#8a8a8a";

/// Text and lines of a sheet without background.
const NEUTRAL: &str = "#808080";

/// An SVG document under construction.
#[derive(Debug)]
pub struct Sheet {
    body: String,
    size: [f64; 2],
    font_size: f64,
    /// Of a sheet without background.
    title: Option<String>,
}

impl Sheet {
    /// White with black text.
    pub fn white(width: f64, height: f64) -> Self {
        Self { body: String::new(), size: [width, height], font_size: 12.0, title: None }
    }

    /// Without background; its grey text reads on white and on black.
    pub fn transparent(width: f64, height: f64, font_size: f64, title: &str) -> Self {
        Self { body: String::new(), size: [width, height], font_size, title: Some(title.to_owned()) }
    }

    /// Size of text where none is given.
    pub fn font_size(&self) -> f64 {
        self.font_size
    }

    /// An element as it stands.
    pub fn add(&mut self, element: impl AsRef<str>) {
        self.body.push_str(element.as_ref());
        self.body.push('\n');
    }

    /// Text of a size; `anchor` is SVG's `start`, `middle` or `end`.
    pub fn text(&mut self, x: f64, y: f64, anchor: &str, size: f64, text: &str) {
        self.add(format!(r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}">{text}</text>"#));
    }

    /// Text of the sheet's own size.
    pub fn label(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        self.add(format!(r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}">{text}</text>"#));
    }

    /// Text in the sheet's own size that reads upwards, its middle at a point.
    pub fn upright(&mut self, x: f64, y: f64, text: &str) {
        self.add(format!(
            r#"<text x="{x}" y="{y}" text-anchor="middle" transform="rotate(-90 {x} {y})">{text}</text>"#
        ));
    }

    /// A straight grey line.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], opacity: f64) {
        self.add(format!(
            r#"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" stroke="{NEUTRAL}" stroke-opacity="{opacity}"/>"#
        ));
    }

    /// A heading.
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

    /// The document.
    pub fn finish(self) -> String {
        let [width, height] = self.size;
        let (color, first) = match &self.title {
            Some(title) => (NEUTRAL, format!("<title>{title}</title>")),
            None => (BLACK, format!("<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>")),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"system-ui, sans-serif\" font-size=\"{}\" fill=\"{color}\">\n{first}\n{}</svg>\n",
            self.font_size, self.body
        )
    }
}

/// Style of a curve or its points.
#[derive(Debug, Clone, Copy)]
pub struct Style {
    /// Of line and points.
    pub color: &'static str,
    /// Of the line; 0: none.
    pub width: f64,
    /// SVG's `stroke-dasharray`; empty: a full line.
    pub dashes: &'static str,
    /// Radius of the points; 0: none.
    pub dot: f64,
    /// Points are circles instead of discs.
    pub hollow: bool,
}

impl Style {
    /// A full line.
    pub fn line(color: &'static str) -> Self {
        Self { color, width: 1.8, dashes: "", dot: 0.0, hollow: false }
    }

    /// Points alone.
    pub fn dots(color: &'static str) -> Self {
        Self { width: 0.0, dot: 3.6, ..Self::line(color) }
    }

    /// A line and its points.
    pub fn both(color: &'static str) -> Self {
        Self { dot: 3.2, ..Self::line(color) }
    }

    /// The same, dashed.
    pub fn dashed(self) -> Self {
        Self { dashes: "5 4", ..self }
    }

    /// The same with hollow points.
    pub fn hollow(self) -> Self {
        Self { hollow: true, ..self }
    }

    /// The same with a thin line.
    pub fn thin(self) -> Self {
        Self { width: 1.0, ..self }
    }

    pub(super) fn stroke(&self) -> String {
        let dashes =
            if self.dashes.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{}""#, self.dashes) };
        format!(r#"fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"{dashes}"#, self.color, self.width)
    }

    pub(super) fn fill(&self) -> String {
        if self.hollow {
            format!(r##"fill="#ffffff" stroke="{}" stroke-width="1.6""##, self.color)
        } else {
            format!(r#"fill="{}""#, self.color)
        }
    }
}
