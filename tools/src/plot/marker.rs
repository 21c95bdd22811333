//! Symbols of single points.

use super::Sheet;

/// The outline of a symbol.
#[derive(Debug, Clone, Copy)]
pub enum Shape {
    /// Of the radius given.
    Circle,
    /// On a side.
    Square,
    /// On a corner.
    Diamond,
    /// On a side, point upwards.
    Triangle,
}

/// A symbol.
#[derive(Debug, Clone, Copy)]
pub struct Marker {
    /// Its outline.
    pub shape: Shape,
    /// Of its area, or of its outline where it is hollow.
    pub color: &'static str,
    /// Drawn as an outline.
    pub hollow: bool,
}

impl Marker {
    /// Draws the symbol about a point with a radius.
    pub fn draw(&self, sheet: &mut Sheet, [x, y]: [f64; 2], r: f64, opacity: f64) {
        let paint = if self.hollow {
            format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"", self.color, if r > 4.0 { 2.2 } else { 1.1 })
        } else {
            format!("fill=\"{}\"", self.color)
        };
        let shape = match self.shape {
            Shape::Circle => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\""),
            Shape::Square => {
                let (left, top, side) = (x - 0.9 * r, y - 0.9 * r, 1.8 * r);
                format!("<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{side:.1}\" height=\"{side:.1}\"")
            }
            Shape::Diamond => {
                let d = 1.25 * r;
                format!("<path d=\"M{x:.1} {:.1}l{d:.1} {d:.1}l-{d:.1} {d:.1}l-{d:.1} -{d:.1}z\"", y - d)
            }
            Shape::Triangle => {
                let (w, h) = (2.3 * r, 2.0 * r);
                format!("<path d=\"M{x:.1} {:.1}l{:.1} {h:.1}h-{w:.1}z\"", y - 1.2 * r, 0.5 * w)
            }
        };
        sheet.add(format!("{shape} {paint} opacity=\"{opacity}\"/>"));
    }
}
