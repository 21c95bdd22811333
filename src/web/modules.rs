//! The script modules that a page imports, directly or through others: a page names them all, so that the browser
//! requests them at once instead of finding them one after the other.

use super::assets;
use std::collections::VecDeque;

/// The addresses of a module of the assets and of everything that it imports without condition, each once, itself
/// first.
pub(super) fn needed_by(module: &str) -> Vec<String> {
    let mut found = vec![module.to_owned()];
    let mut open = VecDeque::from(found.clone());
    while let Some(name) = open.pop_front() {
        let Some(text) = assets::text(&name) else { continue };
        let folder = name.rsplit_once('/').map_or("", |(folder, _)| folder);
        for import in imports(&text) {
            let Some(import) = resolve(folder, import) else { continue };
            if !found.contains(&import) {
                found.push(import.clone());
                open.push_back(import);
            }
        }
    }
    found.into_iter().map(|name| format!("/assets/{name}")).collect()
}

/// Imports of a module: the relative addresses in its static `import … from "…"`, `import "…"` and `export … from "…"`.
fn imports(text: &str) -> impl Iterator<Item = &str> {
    let statements = text.match_indices('"').filter_map(|(quote, _)| {
        let before = text[..quote].trim_end();
        let word = before.rsplit(|letter: char| !letter.is_ascii_alphabetic()).next()?;
        // A static import begins a line; a dynamic one (`import("…")`) has a bracket.
        matches!(word, "from" | "import").then(|| text[quote + 1..].split('"').next())?
    });
    statements.filter(|address| address.starts_with('.'))
}

/// "../common/dom.js" seen from "design" is "common/dom.js".
pub(super) fn resolve(folder: &str, address: &str) -> Option<String> {
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in address.split('/') {
        match part {
            "." => {}
            ".." => drop(parts.pop()?),
            name => parts.push(name),
        }
    }
    Some(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn imports_are_those_that_a_module_always_needs() {
        let text = r#"import * as api from "../common/api.js";
import { a, b } from "./near.js";
import "./side.js";
export { c } from "./given.js";
const later = () => import("./later.js");
const word = "import"; say(from, "./not.js");
import plot from "elsewhere";"#;
        assert_eq!(imports(text).collect::<Vec<_>>(), ["../common/api.js", "./near.js", "./side.js", "./given.js"]);
    }

    #[test]
    fn addresses_are_found_from_a_modules_folder() {
        assert_eq!(resolve("design", "../common/dom.js").as_deref(), Some("common/dom.js"));
        assert_eq!(resolve("design", "./sweep.js").as_deref(), Some("design/sweep.js"));
        assert_eq!(resolve("", "../outside.js"), None);
    }

    #[test]
    fn every_module_that_is_needed_exists() {
        for page in
            ["design/page.js", "jobs/page.js", "job/page.js", "compare/page.js", "report/page.js", "system/page.js"]
        {
            let needed = needed_by(page);
            assert!(needed.len() > 4 && needed.contains(&"/assets/common/dom.js".to_owned()), "{needed:?}");
            for address in needed {
                assert!(assets::text(address.trim_start_matches("/assets/")).is_some(), "{address}");
            }
        }
    }
}
