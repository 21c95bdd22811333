//! Pages of the documentation as HTML: CommonMark with tables, and formulas in TeX notation as MathML.

use super::super::modules::resolve;
use super::documents::{self, Document};
use math_core::{LatexToMathML, MathCoreConfig, MathDisplay};
use pulldown_cmark::{CowStr, Event, HeadingLevel, LinkType, Options, Parser, Tag, TagEnd, html};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// A page as HTML.
pub(super) struct Rendered {
    pub title: String,
    pub html: String,
    /// Fragments of its headings.
    #[cfg_attr(not(test), allow(dead_code, reason = "the tests follow links to them"))]
    pub headings: Vec<String>,
}

/// Page of the summary of all checks, whose rows are read for the theory pages.
const SUMMARY: &str = "validation/tables/summary";
/// Folder of the theory pages: formulas between dollar signs, and links to checks with their numbers.
const THEORY: &str = "theory/";

/// Number of checks of a family, and the error and tolerance of the check nearest to its tolerance.
struct Family {
    checks: String,
    error: String,
    tolerance: String,
}

/// The families of checks by the address of their table with its fragment.
static FAMILIES: LazyLock<BTreeMap<String, Family>> = LazyLock::new(|| {
    let Some(summary) = documents::at(SUMMARY) else { return BTreeMap::new() };
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(" | ").map(|cell| cell.trim_matches(['|', ' '])).collect();
        let [name, checks, _, error, tolerance] = cells.as_slice() else { return None };
        let target = name.rsplit_once("](")?.1.strip_suffix(')')?;
        let (file, fragment) = target.split_once('#')?;
        let address = format!("validation/tables/{}#{fragment}", file.strip_suffix(".md")?);
        let [checks, error, tolerance] = [checks, error, tolerance].map(|cell| (*cell).to_owned());
        Some((address, Family { checks, error, tolerance }))
    };
    summary.text.lines().filter_map(row).collect()
});

/// The text of the first heading.
pub(super) fn title_of(text: &str) -> String {
    text.lines().find_map(|line| line.strip_prefix("# ")).unwrap_or_default().to_owned()
}

/// The text below the heading with this fragment, up to the next one.
#[cfg(test)]
pub(super) fn section<'a>(text: &'a str, fragment: &str) -> Option<&'a str> {
    text.split("\n## ").skip(1).find_map(|section| {
        let (heading, rest) = section.split_once('\n')?;
        (slug(heading) == fragment).then_some(rest)
    })
}

/// Renders a page. Raw HTML in it is left out; links to files that the help does not show become text.
pub(super) fn render(document: &Document) -> Rendered {
    let is_theory = document.file.starts_with(THEORY);
    let mut options = Options::ENABLE_TABLES;
    options.set(Options::ENABLE_MATH, is_theory);
    let mut page = PageEvents { folder: folder_of(&document.file), is_theory, links: Vec::new(), headings: Vec::new() };
    let events: Vec<Event> = Parser::new_ext(&document.text, options).collect();
    let mut output = Vec::with_capacity(events.len());
    for (index, event) in events.iter().enumerate() {
        page.push(event, &events[index + 1..], &mut output);
    }
    let mut html = String::with_capacity(document.text.len() * 2);
    html::push_html(&mut html, output.into_iter());
    Rendered { title: title_of(&document.text), html, headings: page.headings }
}

/// The state while the events of a page are written.
struct PageEvents<'a> {
    /// Folder of the file in `docs/`.
    folder: &'a str,
    is_theory: bool,
    /// Addresses of the links that are open; `None` where the link is left out.
    links: Vec<Option<String>>,
    headings: Vec<String>,
}

impl PageEvents<'_> {
    /// Adds the events that stand for `event` in the page; `rest` are the events behind it.
    fn push<'e>(&mut self, event: &Event<'e>, rest: &[Event<'e>], output: &mut Vec<Event<'e>>) {
        match event {
            Event::Html(_) | Event::InlineHtml(_) => {}
            Event::InlineMath(formula) => output.push(math(formula, MathDisplay::Inline)),
            Event::DisplayMath(formula) => {
                output.push(markup("<span class=\"formula\" tabindex=\"0\" role=\"group\" aria-label=\"Formula\">"));
                output.push(math(formula, MathDisplay::Block));
                output.push(markup("</span>"));
            }
            Event::Start(Tag::Heading { level, .. }) => {
                let text = plain_text(rest.iter().take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_)))));
                let id = self.heading_id(&text);
                output.push(markup(format!("<{level} id=\"{id}\">")));
            }
            Event::End(TagEnd::Heading(level)) => output.push(heading_end(*level)),
            Event::Start(Tag::Table(_)) => {
                output.push(markup("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table\">"));
                output.push(event.clone());
            }
            Event::End(TagEnd::Table) => {
                output.push(event.clone());
                output.push(markup("</div>"));
            }
            Event::Start(Tag::CodeBlock(_)) => {
                output.push(markup("<pre tabindex=\"0\" role=\"region\" aria-label=\"Code\"><code>"));
            }
            Event::End(TagEnd::CodeBlock) => output.push(markup("</code></pre>")),
            Event::Start(Tag::Link { dest_url, .. }) => {
                let address = self.address(dest_url);
                if let Some(address) = &address {
                    output.push(Event::Start(link(address)));
                }
                self.links.push(address);
            }
            Event::End(TagEnd::Link) => {
                if let Some(address) = self.links.pop().flatten() {
                    output.push(Event::End(TagEnd::Link));
                    output.extend(self.checks(&address));
                }
            }
            Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
                let dest_url = self.address(dest_url).unwrap_or_default().into();
                let (link_type, title, id) = (*link_type, title.clone(), id.clone());
                output.push(Event::Start(Tag::Image { link_type, dest_url, title, id }));
            }
            _ => output.push(event.clone()),
        }
    }

    /// The fragment of a heading, with a number behind it where an earlier one is the same.
    fn heading_id(&mut self, text: &str) -> String {
        let slug = slug(text);
        let mut id = slug.clone();
        let mut count = 0;
        while self.headings.contains(&id) {
            count += 1;
            id = format!("{slug}-{count}");
        }
        self.headings.push(id.clone());
        id
    }

    /// Where a link of the page leads in the help; `None` for places outside of it.
    fn address(&self, target: &str) -> Option<String> {
        let (file, fragment) = target.split_once('#').unwrap_or((target, ""));
        if file.is_empty() {
            return Some(format!("#{fragment}"));
        }
        if file.contains(':') {
            return None;
        }
        let address = documents::address_of_file(&resolve(self.folder, file)?)?;
        let fragment = if fragment.is_empty() { String::new() } else { format!("#{fragment}") };
        Some(format!("/help/{address}{fragment}"))
    }

    /// In theory pages: the number of checks behind a link to a family, and how near the worst comes to its tolerance.
    fn checks<'e>(&self, address: &str) -> Option<Event<'e>> {
        let family = FAMILIES.get(address.strip_prefix("/help/")?).filter(|_| self.is_theory)?;
        let Family { checks, error, tolerance } = family;
        let noun = if checks == "1" { "check" } else { "checks" };
        let text = format!("({checks} {noun}; nearest to its tolerance: error {error}, permitted {tolerance})");
        Some(markup(format!(" <span class=\"muted\">{text}</span>")))
    }
}

fn link<'e>(address: &str) -> Tag<'e> {
    let dest_url = address.to_owned().into();
    Tag::Link { link_type: LinkType::Inline, dest_url, title: CowStr::Borrowed(""), id: CowStr::Borrowed("") }
}

fn heading_end<'e>(level: HeadingLevel) -> Event<'e> {
    markup(format!("</{level}>\n"))
}

fn markup<'e>(html: impl Into<CowStr<'e>>) -> Event<'e> {
    Event::InlineHtml(html.into())
}

/// A formula as MathML; as its TeX notation where it cannot be converted.
fn math<'e>(formula: &str, display: MathDisplay) -> Event<'e> {
    static CONVERTER: LazyLock<Option<LatexToMathML>> =
        LazyLock::new(|| LatexToMathML::new(MathCoreConfig::default()).ok());
    let converted = CONVERTER.as_ref().and_then(|converter| converter.convert_with_local_state(formula, display).ok());
    converted.map_or_else(|| Event::Code(formula.to_owned().into()), |converted| markup(converted.mathml))
}

/// The words of events, without markup.
fn plain_text<'a, 'e: 'a>(events: impl Iterator<Item = &'a Event<'e>>) -> String {
    events
        .filter_map(|event| match event {
            Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
            Event::SoftBreak => Some(" "),
            _ => None,
        })
        .collect()
}

/// The fragment of a heading: lower case, spaces as hyphens, no punctuation, as on the project's repository pages.
fn slug(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|sign| sign.is_alphanumeric() || "-_ ".contains(*sign));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

fn folder_of(file: &str) -> &str {
    file.rsplit_once('/').map_or("", |(folder, _)| folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(file: &str, text: &str) -> Rendered {
        render(&Document { file: file.to_owned(), text: text.to_owned() })
    }

    #[test]
    fn headings_links_and_formulas() {
        let text = "# A page\n\n## Mesh stiffness, k\n\nSee [it](#mesh-stiffness-k), [design](../DESIGN.md#conventions), \
                    [code](../../src/lib.rs) and [out](https://example.org). $k = \\frac{F}{s}$\n\n## Mesh stiffness, k\n";
        let page = page("theory/x.md", text);
        assert_eq!(
            (page.title.as_str(), page.headings.as_slice()),
            ("A page", ["a-page", "mesh-stiffness-k", "mesh-stiffness-k-1"].map(str::to_owned).as_slice())
        );
        assert!(page.html.contains("<h2 id=\"mesh-stiffness-k\">Mesh stiffness, k</h2>"), "{}", page.html);
        assert!(page.html.contains("<a href=\"#mesh-stiffness-k\">it</a>"), "{}", page.html);
        assert!(page.html.contains("<a href=\"/help/design#conventions\">design</a>"), "{}", page.html);
        assert!(page.html.contains(" code and out. "), "{}", page.html);
        assert!(page.html.contains("<mfrac>"), "{}", page.html);
    }

    #[test]
    fn every_formula_is_converted_and_has_no_inline_style() {
        let mut formulas = 0;
        for address in documents::SECTIONS.iter().flat_map(|(_, addresses)| addresses.iter()) {
            let html = render(&documents::at(address).unwrap()).html;
            assert!(!html.contains("style=") && !html.contains("<code>\\"), "{address}");
            formulas += html.matches("<math").count();
        }
        assert!(formulas > 25, "{formulas}");
    }

    #[test]
    fn a_family_of_checks_is_told_with_its_numbers() {
        assert!(FAMILIES.len() > 50, "{}", FAMILIES.len());
        let html = page("theory/x.md", "[FZG](../validation/tables/geometry.md#fzg-type-c)").html;
        assert!(html.contains("checks; nearest to its tolerance: error"), "{html}");
        let elsewhere = page("x.md", "[FZG](validation/tables/geometry.md#fzg-type-c)").html;
        assert!(elsewhere.contains("fzg-type-c") && !elsewhere.contains("nearest"), "{elsewhere}");
    }

    #[test]
    fn raw_html_is_left_out() {
        assert_eq!(page("x.md", "<script>1</script>\n\na <b>c</b>").html, "<p>a c</p>\n");
    }
}
