//! The pages of `docs/` that the help shows, built into the binary.

use rust_embed::RustEmbed;

#[derive(RustEmbed)]
#[folder = "docs/"]
#[include = "*.md"]
#[include = "*.svg"]
struct Files;

/// A page of the documentation.
pub(super) struct Document {
    /// Path of the file in `docs/`.
    pub file: String,
    pub text: String,
}

/// The pages in the list at the side, by their addresses: the file's path in lower case without its ending.
pub(super) const SECTIONS: &[(&str, &[&str])] = &[
    (
        "Theory",
        &[
            "theory/geometry",
            "theory/contact",
            "theory/shafts",
            "theory/impact",
            "theory/vibration",
            "theory/accuracy",
            "theory/source",
        ],
    ),
    (
        "Validation",
        &[
            "validation",
            "validation/gear-geometry",
            "validation/contact",
            "validation/vibration",
            "validation/shafts",
            "validation/jobs",
            "validation/optimisation",
            "validation/tables/summary",
            "validation/tables/geometry",
            "validation/tables/contact",
            "validation/tables/elements",
            "validation/tables/impact",
            "validation/tables/dynamics",
            "validation/tables/response",
            "validation/tables/shafts",
            "validation/tables/job",
        ],
    ),
    (
        "Background",
        &[
            "optimisation",
            "design",
            "study",
            "study/shafts",
            "benchmarks",
            "glossary",
            "operations",
            "scaling",
            "reliability",
        ],
    ),
];

/// The page at an address of the help.
pub(super) fn at(address: &str) -> Option<Document> {
    let file = Files::iter().find(|file| file.ends_with(".md") && address_of(file) == address)?.into_owned();
    let text = String::from_utf8(Files::get(&file)?.data.into_owned()).ok()?;
    Some(Document { file, text })
}

/// A figure of the documentation (SVG).
pub(super) fn figure(address: &str) -> Option<Vec<u8>> {
    address.ends_with(".svg").then(|| Files::get(address).map(|file| file.data.into_owned()))?
}

/// The address below `/help` of a file of `docs/` that the help shows: a page or a figure.
pub(super) fn address_of_file(file: &str) -> Option<String> {
    if file.ends_with(".svg") {
        return Files::get(file).map(|_| file.to_owned());
    }
    let address = address_of(file);
    let is_listed = SECTIONS.iter().any(|(_, addresses)| addresses.contains(&address.as_str()));
    is_listed.then_some(address)
}

fn address_of(file: &str) -> String {
    file.strip_suffix(".md").unwrap_or(file).to_lowercase()
}
