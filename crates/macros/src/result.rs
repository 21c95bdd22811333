//! The derives of results: `ResultFields` for the structs of a result, `SweepColumns` for the row of a sweep.

use super::{doc_lines, units};
use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};
use syn::meta::ParseNestedMeta;
use syn::spanned::Spanned;
use syn::{Data, DeriveInput, Error, Expr, Field, Fields, LitInt, LitStr, Meta, Result};

/// See [`crate::result_fields`].
pub(crate) fn result_fields(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    let mut halves = false;
    let mut theory = None;
    for attribute in input.attrs.iter().filter(|attribute| attribute.path().is_ident("scalar")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("halves") {
                halves = true;
            } else if meta.path.is_ident("theory") {
                theory = Some(text(&meta)?);
            } else {
                return Err(meta.error("expected `halves` or `theory`"));
            }
            Ok(())
        })?;
    }
    let theory = theory.map(|theory| quote! { let place = &place.with_theory(#theory); });
    let fields = named_fields(input)?;
    let declarations = if halves {
        // Both halves have the same fields: those of the left one stand for both.
        let half = &fields.first().ok_or_else(|| Error::new(name.span(), "expected a field for each half"))?.ty;
        quote! { <#half as crate::result::ResultFields>::declare(&place.half(), quantities); }
    } else {
        declarations(&fields)?
    };
    Ok(quote! {
        impl crate::result::ResultFields for #name {
            fn declare(place: &crate::result::Place, quantities: &mut Vec<crate::result::Quantity>) {
                #theory
                #declarations
            }
        }

        impl crate::result::Optional for #name {
            type Value = Self;

            fn value(&self) -> Option<&Self> {
                Some(self)
            }
        }
    })
}

/// The generated calls that declare the scalars of all fields.
fn declarations(fields: &[&Field]) -> Result<TokenStream> {
    let mut declared = TokenStream::new();
    let mut halves = false;
    for field in fields {
        let attributes = ScalarAttributes::of(field)?;
        // The right half has the declaration of the left one.
        let is_right = halves && field.ident.as_ref().is_some_and(|name| name == "right");
        if attributes.halves {
            halves = true;
            let ty = &field.ty;
            declared.extend(quote! { <#ty as crate::result::ResultFields>::declare(&place.half(), quantities); });
        } else if !is_right && !attributes.skip {
            declared.extend(declaration(field, attributes)?);
        }
    }
    Ok(declared)
}

/// The generated call that declares the scalars of a field.
fn declaration(field: &Field, attributes: ScalarAttributes) -> Result<TokenStream> {
    let ty = &field.ty;
    let name = serialized_name(field)?;
    let (stem, _, derived_unit) = units::split(&name);
    let symbol = attributes.symbol.unwrap_or_default();
    let unit = attributes.unit.unwrap_or_else(|| derived_unit.to_owned());
    let help = attributes.help.unwrap_or_else(|| doc_lines(&field.attrs).collect::<Vec<_>>().join(" "));
    let (label, is_labelled) = match attributes.label {
        Some(label) => (label, true),
        None => (units::words(stem), false),
    };
    let headline = match attributes.headline {
        Some(rank) => quote! { Some(#rank) },
        None => quote! { None },
    };
    let change = match attributes.change {
        Some(change) => quote! { Some(crate::result::Change::#change) },
        None => quote! { None },
    };
    let theory = match attributes.theory {
        Some(theory) => quote! { Some(#theory) },
        None => quote! { None },
    };
    let (percent, lower_is_better, inherits) = (attributes.percent, attributes.lower_is_better, attributes.inherits);
    let place = quote! {
        place.field(&crate::result::Declaration {
            name: #name,
            label: #label,
            is_labelled: #is_labelled,
            symbol: #symbol,
            unit: #unit,
            help: #help,
            theory: #theory,
            headline: #headline,
            percent: #percent,
            change: #change,
            lower_is_better: #lower_is_better,
            inherits: #inherits,
        })
    };
    Ok(match attributes.items {
        Some(items) => quote! { #place.declare_items(#items, quantities); },
        None => quote! { <#ty as crate::result::ResultFields>::declare(&#place, quantities); },
    })
}

/// The parsed `#[scalar(…)]` attributes of a field.
#[derive(Default)]
struct ScalarAttributes {
    label: Option<String>,
    symbol: Option<String>,
    unit: Option<String>,
    help: Option<String>,
    theory: Option<String>,
    headline: Option<u8>,
    change: Option<Ident>,
    percent: bool,
    lower_is_better: bool,
    inherits: bool,
    /// Number of items of a list of numbers that are scalars.
    items: Option<usize>,
    halves: bool,
    skip: bool,
}

impl ScalarAttributes {
    fn of(field: &Field) -> Result<Self> {
        let mut attributes = Self::default();
        for attribute in field.attrs.iter().filter(|attribute| attribute.path().is_ident("scalar")) {
            attribute.parse_nested_meta(|meta| attributes.read(&meta))?;
        }
        Ok(attributes)
    }

    fn read(&mut self, meta: &ParseNestedMeta) -> Result<()> {
        let name = meta.path.require_ident()?.to_string();
        match name.as_str() {
            "label" => self.label = Some(text(meta)?),
            "symbol" => self.symbol = Some(text(meta)?),
            "unit" => self.unit = Some(text(meta)?),
            "help" => self.help = Some(text(meta)?),
            "theory" => self.theory = Some(text(meta)?),
            "headline" if meta.input.peek(syn::Token![=]) => {
                self.headline = Some(meta.value()?.parse::<LitInt>()?.base10_parse()?);
            }
            "headline" => self.headline = Some(0),
            "change" => self.change = Some(meta.value()?.parse()?),
            "percent" => self.percent = true,
            "lower_is_better" => self.lower_is_better = true,
            "inherits" => self.inherits = true,
            "halves" => self.halves = true,
            "skip" => self.skip = true,
            "items" => self.items = Some(meta.value()?.parse::<LitInt>()?.base10_parse()?),
            _ => {
                return Err(meta.error(
                    "expected one of label, symbol, unit, help, theory, headline, change, percent, lower_is_better, inherits, \
                     items, halves, skip",
                ));
            }
        }
        Ok(())
    }
}

/// See [`crate::sweep_columns`].
pub(crate) fn sweep_columns(input: &DeriveInput) -> Result<TokenStream> {
    let row = &input.ident;
    let mut columns = TokenStream::new();
    let mut values = TokenStream::new();
    for field in named_fields(input)? {
        let Some(attribute) = field.attrs.iter().find(|attribute| attribute.path().is_ident("column")) else {
            continue;
        };
        let mut attributes = ColumnAttributes::default();
        if matches!(attribute.meta, Meta::List(_)) {
            attribute.parse_nested_meta(|meta| attributes.read(&meta))?;
        }
        columns.extend(columns_of(row, field, &attributes)?);
        if let (Some(pointer), Some(name)) = (&attributes.from, &field.ident) {
            let value = value_at(pointer)?;
            values.extend(quote! { #name: #value, });
        }
    }
    Ok(quote! {
        impl #row {
            /// Every column of the rows, in the order of the fields.
            pub const COLUMNS: &'static [crate::result::Column] = &[#columns];

            /// The row of a solved point: `values` of the axes, and the values of the result that have a column.
            pub fn of_result(values: Vec<f64>, result: &crate::result::JobResult) -> Self {
                Self { values, #values ..Self::default() }
            }
        }
    })
}

/// The parsed `#[column(…)]` attributes of a field.
#[derive(Default)]
struct ColumnAttributes {
    /// Pointer of the quantity in the result.
    from: Option<LitStr>,
    on_request: bool,
    /// Fields of the value that are columns, each a list.
    lists: Vec<Ident>,
}

impl ColumnAttributes {
    fn read(&mut self, meta: &ParseNestedMeta) -> Result<()> {
        let name = meta.path.require_ident()?.to_string();
        match name.as_str() {
            "from" => self.from = Some(meta.value()?.parse()?),
            "on_request" => self.on_request = true,
            "lists" => meta.parse_nested_meta(|list| {
                self.lists.push(list.path.require_ident()?.clone());
                Ok(())
            })?,
            _ => return Err(meta.error("expected one of from, on_request, lists")),
        }
        Ok(())
    }
}

const HALF: &str = "{half}";

fn columns_of(row: &Ident, field: &Field, attributes: &ColumnAttributes) -> Result<TokenStream> {
    let ident = field.ident.as_ref().ok_or_else(|| Error::new(field.span(), "expected a named field"))?;
    let ty = &field.ty;
    let name = serialized_name(field)?;
    let on_request = attributes.on_request;
    let quantity = match &attributes.from {
        Some(pointer) => quote! { Some(#pointer) },
        None => quote! { None },
    };
    let column = |column: &str, group: &str, half: TokenStream, ty: TokenStream, cell: TokenStream| {
        quote! {
            crate::result::Column {
                name: #column,
                group: #group,
                quantity: #quantity,
                half: #half,
                kind: <#ty as crate::result::ToCell>::KIND,
                on_request: #on_request,
                cell: |row: &#row| #cell,
            },
        }
    };
    if !attributes.lists.is_empty() {
        let lists = attributes.lists.iter().map(|list| {
            let name = format!("{name}_{list}");
            let cell = quote! { crate::result::Cell::Numbers(row.#ident.as_ref().map(|value| value.#list.as_slice())) };
            column(&name, &name, quote! { None }, quote! { Option<Vec<f64>> }, cell)
        });
        return Ok(lists.collect());
    }
    if attributes.from.as_ref().is_some_and(|pointer| pointer.value().contains(HALF)) {
        let (stem, ending, _) = units::split(&name);
        let halves = ["left", "right"].map(|half| {
            let name = format!("{stem}_{half}{ending}");
            let place = format_ident!("{half}");
            let cell = quote! { crate::result::Cell::Number(row.#ident.map(|halves| halves.#place)) };
            column(&name, stem, quote! { Some(#half) }, quote! { Option<f64> }, cell)
        });
        return Ok(halves.into_iter().collect());
    }
    let cell = quote! { crate::result::ToCell::to_cell(&row.#ident) };
    Ok(column(&name, &name, quote! { None }, quote! { #ty }, cell))
}

/// The value at a pointer of the result, as an option; that of both halves where the pointer has `{half}`.
fn value_at(pointer: &LitStr) -> Result<TokenStream> {
    let text = pointer.value();
    if !text.contains(HALF) {
        return path_value(&text, pointer);
    }
    let [left, right] = ["left", "right"].map(|half| path_value(&text.replace(HALF, half), pointer));
    let (left, right) = (left?, right?);
    Ok(quote! {
        match (#left, #right) {
            (Some(left), Some(right)) => Some(crate::result::PerHalf { left, right }),
            _ => None,
        }
    })
}

fn path_value(text: &str, pointer: &LitStr) -> Result<TokenStream> {
    let Some(path) = text.strip_prefix('/') else {
        return Err(Error::new(pointer.span(), "expected a JSON pointer"));
    };
    let mut value = quote! { Some(result) };
    for segment in path.split('/') {
        if let Ok(index) = segment.parse::<usize>() {
            value = quote! { #value.and_then(|list| list.get(#index)) };
            continue;
        }
        let mut segment = syn::parse_str::<Ident>(segment)
            .map_err(|_| Error::new(pointer.span(), format!("{segment} is no field")))?;
        segment.set_span(pointer.span());
        value = quote! { #value.and_then(|block| crate::result::Optional::value(&block.#segment)) };
    }
    Ok(quote! { #value.cloned() })
}

fn named_fields(input: &DeriveInput) -> Result<Vec<&Field>> {
    match &input.data {
        Data::Struct(data) => match &data.fields {
            Fields::Named(fields) => Ok(fields.named.iter().collect()),
            _ => Err(Error::new(input.span(), "expected named fields")),
        },
        _ => Err(Error::new(input.span(), "expected a struct")),
    }
}

/// The name in JSON: that of the field, or of its `#[serde(rename = "…")]`.
fn serialized_name(field: &Field) -> Result<String> {
    let mut name = field.ident.as_ref().map(ToString::to_string).unwrap_or_default();
    for attribute in field.attrs.iter().filter(|attribute| attribute.path().is_ident("serde")) {
        attribute.parse_nested_meta(|meta| {
            if meta.path.is_ident("rename") {
                name = text(&meta)?;
            } else if meta.input.peek(syn::Token![=]) {
                meta.value()?.parse::<Expr>()?;
            }
            Ok(())
        })?;
    }
    Ok(name)
}

/// The string literal of `name = "…"`.
fn text(meta: &ParseNestedMeta) -> Result<String> {
    Ok(meta.value()?.parse::<LitStr>()?.value())
}
