"""A page in Markdown: text with numbers filled in, and sentences that fail when the numbers no longer bear them out."""


class Page:
    def __init__(self):
        self.parts, self.failed, self.figures = [], [], {}

    def say(self, text):
        self.parts.append(text)

    def claim(self, holds, text):
        """A conclusion; the page is not written when it does not hold."""
        if not holds:
            self.failed.append(text)
        self.say(text)

    def table(self, header, rows):
        columns = header.count("|") + 1
        lines = [f"| {header} |", "|" + "---|" * columns] + [f"| {' | '.join(row)} |" for row in rows]
        self.say("\n".join(lines))

    def figure(self, name, sheet, caption):
        self.figures[name] = sheet.finish()
        short = caption.split(":")[0].split(".")[0]
        self.say(f"![{short}]({name}.svg)\n\n*{caption}*")

    def text(self):
        return "\n\n".join(self.parts) + "\n"


def sig(value, digits=3):
    """Significant digits as an engineer writes them."""
    if value is None:
        return "–"
    if value == 0:
        return "0"
    from math import floor, log10
    decimals = max(0, digits - 1 - floor(log10(abs(value))))
    return f"{value:.{decimals}f}".replace("-", "−")


def span(values, digits=2):
    """The least and the greatest of values, in words."""
    low, high = sig(min(values), digits), sig(max(values), digits)
    return low if low == high else f"{low} to {high}"
