//! Derives by which a field of a job document and a scalar of a result are declared once, as a field of a struct.

mod input;
mod result;

use proc_macro::TokenStream;

/// Declares the fields of an object of the job document: each field of the struct is one, its doc comment's first paragraph the help that
/// people read. Implements `crate::field::Input`; see there what follows from it.
///
/// Types: `f64`, `u32`, `bool`, enums with `Words`, `String`, structs with `Input`; `Option` of them (may be left out or null; the default,
/// if there is one, is then only published), `Vec` of structs, texts and words, `Option<Vec<f64>>`.
///
/// `#[input(…)]` on a field:
/// - `min`, `max`, `unit = "mm"`: range and unit of a number, or of the numbers of a list. The name has to end in the unit.
/// - `default = …`: an expression; the fields read before are variables in it. A value without a default is required.
/// - `required`: an object that has to be given.
/// - `base = …`: where the fields of an object have their defaults from; an expression like that of `default`.
/// - `min_items`, `max_items`, `max_chars`: lengths of lists and texts.
/// - `flatten`: the struct's fields stand among this object's.
/// - `first` (or `first = 1`, after those): read and published before the fields that are not.
/// - `group = "…"`, `order = …`, `symbol = "m_n"`, `when = "source = given"`, `derived = "…"` (or `derived(field = "…")` for a field of an
///   object): section of the form, place in it, symbol, the values of another field for which this one matters, the default in words.
///
/// On the struct: `group = "…"` for all fields, and `rules = path`, a function `fn(&mut Self, &Place)` that checks the rules between the
/// fields and settles those that follow from others.
#[proc_macro_derive(Input, attributes(input))]
pub fn derive_input(item: TokenStream) -> TokenStream {
    input::derive_input(syn::parse_macro_input!(item)).unwrap_or_else(|error| error.to_compile_error()).into()
}

/// Declares a closed list of words as an enum: the variants in snake case, or as `#[words(rename = "…")]` says. Implements
/// `crate::field::Words`, `crate::field::Field` for the enum, `Option` and `Vec` of it, `serde::Serialize`, and gives the enum `ALL` (word
/// and value of each) and `as_str`. `#[words(label = "…")]` is what people read where it is not the word.
#[proc_macro_derive(Words, attributes(words))]
pub fn derive_words(item: TokenStream) -> TokenStream {
    input::derive_words(syn::parse_macro_input!(item)).unwrap_or_else(|error| error.to_compile_error()).into()
}
