"""Figures as SVG in the manner of the other figures of docs/study: white, black text, colours of Okabe and Ito."""

from html import escape
from math import ceil, floor, log10

BLACK, BLUE, ORANGE, GREEN, PURPLE, GREY = "#222222", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a8a8a"


class Sheet:
    """An SVG document under construction."""

    def __init__(self, width, height):
        self.size, self.body = (width, height), []

    def add(self, text):
        self.body.append(text)

    def text(self, x, y, text, anchor="start", size=12, extra=""):
        self.add(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}"{extra}>{escape(text)}</text>')

    def title(self, x, y, text):
        self.text(x, y, text, size=13, extra=' font-weight="600"')

    def key(self, x, y, color, text, dashes="", dot=False):
        if dot:
            self.add(f'<circle cx="{x + 11:.1f}" cy="{y:.1f}" r="3.6" fill="{color}"/>')
        else:
            self.add(f'<path d="M{x:.1f} {y:.1f}h22" {stroke(color, dashes)}/>')
        self.text(x + 28, y + 4, text)

    def finish(self):
        width, height = self.size
        lines = "\n".join(self.body)
        return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="system-ui, sans-serif" '
                f'font-size="12" fill="{BLACK}">\n<rect width="{width}" height="{height}" fill="#ffffff"/>\n{lines}\n</svg>\n')


def stroke(color, dashes="", width=1.8):
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'fill="none" stroke="{color}" stroke-width="{width}" stroke-linejoin="round"{dashed}'


class Field:
    """Axes with curves; a scale is (from, to, logarithmic)."""

    def __init__(self, sheet, box, x, y, x_label, y_label):
        self.sheet, self.box, self.x, self.y = sheet, box, x, y
        left, top, width, height = box
        sheet.add(f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="{GREY}"/>')
        for value in ticks(x):
            at = self.to_x(value)
            sheet.add(f'<path d="M{at:.1f} {top}v{height}" stroke="#e4e4e4"/>')
            sheet.text(at, top + height + 16, label(value), "middle", 11)
        for value in ticks(y):
            at = self.to_y(value)
            sheet.add(f'<path d="M{left} {at:.1f}h{width}" stroke="#e4e4e4"/>')
            sheet.text(left - 6, at + 4, label(value), "end", 11)
        sheet.text(left + width / 2, top + height + 34, x_label, "middle")
        middle = top + height / 2
        sheet.text(left - 42, middle, y_label, "middle", extra=f' transform="rotate(-90 {left - 42} {middle})"')

    def to_x(self, value):
        left, _, width, _ = self.box
        return left + width * part(value, self.x)

    def to_y(self, value):
        _, top, _, height = self.box
        return top + height * (1 - part(value, self.y))

    def inside(self, x, y):
        return self.x[0] <= x <= self.x[1] and self.y[0] <= y <= self.y[1]

    def curve(self, points, color, dashes="", width=1.8):
        clipped = [(x, min(max(y, self.y[0]), self.y[1])) for x, y in points if y is not None and self.x[0] <= x <= self.x[1]]
        path = "L".join(f"{self.to_x(x):.1f} {self.to_y(y):.1f}" for x, y in clipped)
        if path:
            self.sheet.add(f'<path d="M{path}" {stroke(color, dashes, width)}/>')

    def dots(self, points, color, hollow=False, radius=3.6):
        fill = f'fill="#ffffff" stroke="{color}" stroke-width="1.6"' if hollow else f'fill="{color}"'
        for x, y in points:
            x, y = (min(max(v, s[0]), s[1]) for v, s in ((x, self.x), (y, self.y)))
            self.sheet.add(f'<circle cx="{self.to_x(x):.1f}" cy="{self.to_y(y):.1f}" r="{radius}" {fill}/>')

    def rule(self, x=None, y=None, color=GREY):
        left, top, width, height = self.box
        if x is not None:
            self.sheet.add(f'<path d="M{self.to_x(x):.1f} {top}v{height}" {stroke(color, "4 4", 1.2)}/>')
        if y is not None:
            self.sheet.add(f'<path d="M{left} {self.to_y(y):.1f}h{width}" {stroke(color, "4 4", 1.2)}/>')


def part(value, scale):
    low, high, logarithmic = scale
    if logarithmic:
        return (log10(value) - log10(low)) / (log10(high) - log10(low))
    return (value - low) / (high - low)


def ticks(scale):
    low, high, logarithmic = scale
    if logarithmic:
        decades = range(floor(log10(low)), ceil(log10(high)) + 1)
        steps = (1, 2, 5) if log10(high / low) < 3.2 else (1,)
        return [s * 10.0**d for d in decades for s in steps if low * 0.999 <= s * 10.0**d <= high * 1.001]
    raw = (high - low) / 6
    unit = 10.0**floor(log10(raw))
    step = next(unit * s for s in (1, 2, 5, 10) if unit * s >= raw)
    return [step * i for i in range(ceil(low / step - 1e-9), floor(high / step + 1e-9) + 1)]


def label(value):
    return f"{value:.4g}".replace("-", "−")
