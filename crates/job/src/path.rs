//! JSON pointers (RFC 6901) into a document: composed while a document is read, and parsed to find a field.

use std::fmt;

/// The path of a value in a document, as a linked list up to the root; the pointer's text is composed on demand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Path<'a> {
    parent: Option<&'a Path<'a>>,
    step: Step<'a>,
}

#[derive(Debug, Clone, Copy)]
enum Step<'a> {
    Root,
    Member(&'a str),
    /// An item of a list: the list's name and the index; `None`: all items.
    Item(&'a str, Option<usize>),
}

impl<'a> Path<'a> {
    pub(crate) const ROOT: Path<'static> = Path { parent: None, step: Step::Root };

    pub(crate) fn member(&'a self, name: &'a str) -> Path<'a> {
        Path { parent: Some(self), step: Step::Member(name) }
    }

    /// An item of the list `name`; without an index `*`, for all items.
    pub(crate) fn item(&'a self, name: &'a str, index: Option<usize>) -> Path<'a> {
        Path { parent: Some(self), step: Step::Item(name, index) }
    }
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        if let Some(parent) = self.parent {
            write!(formatter, "{parent}")?;
        }
        match self.step {
            Step::Root => Ok(()),
            Step::Member(name) => write!(formatter, "/{name}"),
            Step::Item(list, Some(index)) => write!(formatter, "/{list}/{index}"),
            Step::Item(list, None) => write!(formatter, "/{list}/*"),
        }
    }
}

/// First member and rest of a pointer; `None` if it is empty or does not begin with a slash. Names of fields need no
/// escapes.
pub(crate) fn split_first(pointer: &str) -> Option<(&str, &str)> {
    let rest = pointer.strip_prefix('/')?;
    Some(rest.find('/').map_or((rest, ""), |end| rest.split_at(end)))
}

/// The index of an item in a pointer: digits without a sign or leading zeros.
pub(crate) fn index(text: &str) -> Option<usize> {
    let written_so = text == "0" || text.starts_with(|first: char| ('1'..='9').contains(&first));
    text.parse().ok().filter(|_| written_so)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_written_as_a_pointer_and_a_pointer_taken_apart() {
        let axes = Path::ROOT;
        let axis = axes.item("axes", Some(1));
        assert_eq!(axis.member("also").to_string(), "/axes/1/also");
        assert_eq!(axes.item("axes", None).to_string(), "/axes/*");
        assert_eq!(Path::ROOT.to_string(), "");
        assert_eq!(split_first("/axes/1/also"), Some(("axes", "/1/also")));
        assert_eq!(split_first("/axes"), Some(("axes", "")));
        assert_eq!(split_first("/"), Some(("", "")));
        assert_eq!((split_first(""), split_first("axes")), (None, None));
        assert_eq!(
            ["0", "17", "01", "+1", "-1", "", "1e0"].map(index),
            [Some(0), Some(17), None, None, None, None, None]
        );
    }
}
