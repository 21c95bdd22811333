//! The help pages: what each number of a result and each input means, from their declarations, and the documentation of
//! `docs/`.

mod documents;
mod inputs;
mod markdown;
mod numbers;

use super::pages::{HasLogin, page};
use askama::Template;
use axum::Extension;
use axum::extract::Path;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use documents::SECTIONS;

/// A page of the list at the side: its address below `/help` and its title.
struct Entry {
    address: String,
    title: String,
}

/// Pages under a common heading.
struct Section {
    title: &'static str,
    entries: Vec<Entry>,
}

#[derive(Template)]
#[template(path = "help.html")]
struct HelpPage {
    has_login: bool,
    title: String,
    address: String,
    sections: Vec<Section>,
    content: Content,
}

/// The main part of a help page.
enum Content {
    /// The start page.
    Start,
    Numbers(Vec<numbers::Block>),
    Inputs(Vec<inputs::Block>),
    /// A page of the documentation as HTML, made from Markdown that is part of the program.
    Document(String),
}

const NUMBERS: &str = "results";
const INPUTS: &str = "inputs";

/// `/help`.
pub(super) async fn start(Extension(HasLogin(has_login)): Extension<HasLogin>) -> Response {
    respond(has_login, "Help", "", Content::Start)
}

/// `/help/{*address}`: a page of the help, or a figure of the documentation.
pub(super) async fn topic(
    Extension(HasLogin(has_login)): Extension<HasLogin>,
    Path(address): Path<String>,
) -> Response {
    if let Some(figure) = documents::figure(&address) {
        return ([(header::CONTENT_TYPE, "image/svg+xml"), (header::CACHE_CONTROL, "no-cache")], figure)
            .into_response();
    }
    match address.as_str() {
        NUMBERS => respond(has_login, numbers::TITLE, NUMBERS, Content::Numbers(numbers::blocks())),
        INPUTS => respond(has_login, inputs::TITLE, INPUTS, Content::Inputs(inputs::blocks())),
        _ => match documents::at(&address) {
            Some(document) => {
                let rendered = markdown::render(&document);
                respond(has_login, &rendered.title, &address, Content::Document(rendered.html))
            }
            None => super::not_found().await,
        },
    }
}

fn respond(has_login: bool, title: &str, address: &str, content: Content) -> Response {
    let (title, address) = (title.to_owned(), address.to_owned());
    page(StatusCode::OK, &HelpPage { has_login, title, address, sections: sections(), content })
}

/// The list at the side.
fn sections() -> Vec<Section> {
    let generated = [(NUMBERS, numbers::TITLE), (INPUTS, inputs::TITLE)];
    let entry = |(address, title): (&str, &str)| Entry { address: address.to_owned(), title: title.to_owned() };
    let first = Section { title: "Numbers and inputs", entries: generated.map(entry).into() };
    let documents = SECTIONS.iter().map(|(title, addresses)| Section {
        title,
        entries: addresses
            .iter()
            .filter_map(|address| {
                let title = markdown::title_of(&documents::at(address)?.text);
                Some(Entry { address: (*address).to_owned(), title })
            })
            .collect(),
    });
    std::iter::once(first).chain(documents).collect()
}

/// The fragment of the address at which a number or an input is explained.
fn anchor(pointer: &str) -> String {
    pointer.trim_start_matches('/').replace(['/', '{', '}', '*'], "-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::{gear_data_quantities, quantities};
    use std::collections::HashSet;

    /// Address and fragment of a link between help pages, seen from the page at `from`.
    fn exists(address: &str, fragment: &str) -> bool {
        match address {
            "" => fragment.is_empty(),
            NUMBERS | INPUTS => true,
            _ if documents::figure(address).is_some() => true,
            _ => documents::at(address).is_some_and(|document| {
                let rendered = markdown::render(&document);
                fragment.is_empty() || rendered.headings.iter().any(|heading| heading == fragment)
            }),
        }
    }

    #[test]
    fn every_number_has_a_section_with_source_validity_and_validation() {
        let mut sections = HashSet::new();
        for quantity in quantities().iter().chain(gear_data_quantities()) {
            assert!(quantity.theory.contains('#'), "{} has no theory", quantity.pointer);
            sections.insert(quantity.theory);
        }
        assert!(sections.len() > 25, "{}", sections.len());
        for section in sections {
            let (page, heading) = section.split_once('#').unwrap();
            let document = documents::at(&format!("theory/{page}")).unwrap_or_else(|| panic!("no {page}"));
            let text = markdown::section(&document.text, heading).unwrap_or_else(|| panic!("no {section}"));
            for part in ["- **Source**: ", "- **Valid for**: ", "- **Validated by**: "] {
                assert!(text.contains(part), "{section} lacks {part}");
            }
        }
    }

    /// An address without percent-encoding.
    fn decoded(address: &str) -> String {
        let (first, rest) = address.split_once('%').map_or((address, None), |(first, rest)| (first, Some(rest)));
        let mut bytes = first.as_bytes().to_vec();
        for part in rest.into_iter().flat_map(|rest| rest.split('%')) {
            bytes.extend(hex::decode(&part[..2]).unwrap());
            bytes.extend(&part.as_bytes()[2..]);
        }
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn every_link_between_help_pages_leads_somewhere() {
        let mut followed = 0;
        for address in SECTIONS.iter().flat_map(|(_, addresses)| addresses.iter()) {
            let html = markdown::render(&documents::at(address).unwrap()).html;
            for link in html.split("=\"/help/").skip(1) {
                let target = decoded(link.split('"').next().unwrap());
                let (page, fragment) = target.split_once('#').unwrap_or((&target, ""));
                assert!(exists(page, fragment), "{address} links to {target}");
                followed += 1;
            }
        }
        assert!(followed > 150, "{followed}");
    }
}
