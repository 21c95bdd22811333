//! Derives by which a field of a job document and a scalar of a result are declared once, as a field of a struct.

mod input;
mod result;
mod units;

use proc_macro::TokenStream;
use syn::{Attribute, DeriveInput, Expr, ExprLit, Lit, Meta, parse_macro_input};

/// Declares the fields of an object of the job document: one for each field of the struct, with the first paragraph of
/// its doc comment as the help text. Implements `crate::field::Input`.
///
/// Types: `f64`, `u32`, `bool`, enums with `Words`, `String`, structs with `Input`; `Option` of them (may be left out
/// or null; the default, if there is one, is then only published), `Vec` of structs, texts and words,
/// `Option<Vec<f64>>`.
///
/// `#[input(…)]` on a field:
/// - `min`, `max`, `unit = "mm"`: range and unit of a number, or of the numbers of a list. The name has to end in the
///   unit. `object_unit = "um"` instead of it: the name of the object ends in the unit.
/// - `default = …`: an expression; the fields read before are variables in it. A value without a default is required.
/// - `required`: the object, or the list of objects, has to be given.
/// - `base = …`: the object whose values are the defaults of the fields; an expression like that of `default`.
/// - `min_items`, `max_items`, `max_chars`: lengths of lists and texts.
/// - `flatten`: the struct's fields stand among this object's.
/// - `first` (or `first = 1`, after those): read and published before the fields that are not.
/// - `group = "…"`, `order = …`, `symbol = "m_n"`, `when = "source = given"`, `derived = "…"` (or `derived(field =
///   "…")` for a field of an object): section of the form, rank in it, symbol, the values of another field for which
///   this one is in use, the description of the default.
///
/// On the struct: `group = "…"` for all fields, and `rules = path`, a function `fn(&mut Self, &ObjectPlace)` that
/// checks the rules between the fields and settles those that follow from others.
#[proc_macro_derive(Input, attributes(input))]
pub fn derive_input(item: TokenStream) -> TokenStream {
    input::derive_input(parse_macro_input!(item as DeriveInput)).unwrap_or_else(|error| error.to_compile_error()).into()
}

/// Declares a closed list of words as an enum: the variants in snake case, or renamed by `#[words(rename = "…")]`.
/// Implements `crate::field::Words`, `crate::field::Field` for the enum, `Option` and `Vec` of it, `serde::Serialize`,
/// and adds to the enum `ALL` (word and value of each) and `as_str`. `#[words(label = "…")]` is the label shown in
/// place of the word.
#[proc_macro_derive(Words, attributes(words))]
pub fn derive_words(item: TokenStream) -> TokenStream {
    input::derive_words(parse_macro_input!(item as DeriveInput)).unwrap_or_else(|error| error.to_compile_error()).into()
}

/// Declares the scalars of a struct of the result: numbers, words and flags, in nested structs too. A field with its
/// name and its doc comment is the declaration; `#[scalar(…)]` adds to it:
///
/// - `label = "…"`: its label, in lower case; else the words of its name. On a nested struct: an addition to the labels
///   of its fields.
/// - `symbol = "…"`: its symbol, that of ISO 21771 if there is one; an underscore begins the index.
/// - `unit = "…"`: its unit; else the unit in the ending of its name.
/// - `help = "…"`: its meaning; else the doc comment.
/// - `headline`, `headline = N`: it is one of the headline numbers; N > 0: after those of its block with a smaller N.
/// - `change = …`: form of the difference between two results, a `result::Change`.
/// - `percent`: a share of 1 that is displayed in per cent.
/// - `lower_is_better`: smaller values are better designs.
/// - `inherits`: the scalar that represents its struct; label, unit and help are those of the field with the struct.
///
/// - `halves`, on a field `left` beside others: the field `right` of the same type has the same declarations.
/// - `skip`: the value is declared elsewhere in the result.
///
/// `#[scalar(halves)]` on a struct: its fields are the values of the left and the right half.
#[proc_macro_derive(ResultFields, attributes(scalar))]
pub fn result_fields(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    result::result_fields(&input).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// Columns of the row of a sweep, a struct with a field `values`: `COLUMNS`, and `of_result`, which fills a row from
/// the result of a point. `#[column(…)]` makes a field a column:
///
/// - `from = "/response/dynamic_factor"`: pointer of the quantity in the result that it holds. With `{half}` in it the
///   field is an `Option<PerHalf>` and has a column for each half, their names with the half before the unit.
/// - `on_request`: only in answers that name it.
/// - `lists(a, b)`: fields of the value that are columns, each a list of numbers.
#[proc_macro_derive(SweepColumns, attributes(column))]
pub fn sweep_columns(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    result::sweep_columns(&input).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// The lines of a doc comment.
fn doc_lines(attributes: &[Attribute]) -> impl Iterator<Item = String> {
    attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(meta) if meta.path.is_ident("doc") => match &meta.value {
            Expr::Lit(ExprLit { lit: Lit::Str(line), .. }) => Some(line.value().trim().to_owned()),
            _ => None,
        },
        _ => None,
    })
}
