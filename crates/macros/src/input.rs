//! The derives of job documents.

use super::doc_lines;
use proc_macro2::{Ident, TokenStream};
use quote::{ToTokens, format_ident, quote};
use syn::ext::IdentExt;
use syn::punctuated::Punctuated;
use syn::{
    Attribute, Data, DataEnum, DeriveInput, Error, Expr, Fields, LitInt, LitStr, Meta, Path, Result, Token, Type,
};

/// The parsed `#[input(…)]` attributes of a field.
#[derive(Default)]
struct Attributes {
    min: Option<Expr>,
    max: Option<Expr>,
    unit: Option<LitStr>,
    /// The unit, which is in the name of the object that the field is in.
    object_unit: Option<LitStr>,
    default: Option<Expr>,
    base: Option<Expr>,
    required: bool,
    /// Rank among the fields that are read before the others.
    first: Option<u32>,
    flatten: bool,
    min_items: Option<Expr>,
    max_items: Option<Expr>,
    max_chars: Option<Expr>,
    group: Option<LitStr>,
    order: Option<Expr>,
    symbol: Option<LitStr>,
    when: Option<LitStr>,
    derived: Option<LitStr>,
    derived_in: Vec<(String, LitStr)>,
}

impl Attributes {
    fn of(attributes: &[Attribute]) -> Result<Self> {
        let mut found = Self::default();
        for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("input")) {
            attribute.parse_nested_meta(|meta| {
                let name = meta.path.require_ident()?.to_string();
                match name.as_str() {
                    "required" => found.required = true,
                    "first" if meta.input.peek(Token![=]) => {
                        found.first = Some(meta.value()?.parse::<LitInt>()?.base10_parse()?);
                    }
                    "first" => found.first = Some(0),
                    "flatten" => found.flatten = true,
                    "min" => found.min = Some(meta.value()?.parse()?),
                    "max" => found.max = Some(meta.value()?.parse()?),
                    "default" => found.default = Some(meta.value()?.parse()?),
                    "base" => found.base = Some(meta.value()?.parse()?),
                    "min_items" => found.min_items = Some(meta.value()?.parse()?),
                    "max_items" => found.max_items = Some(meta.value()?.parse()?),
                    "max_chars" => found.max_chars = Some(meta.value()?.parse()?),
                    "order" => found.order = Some(meta.value()?.parse()?),
                    "unit" => found.unit = Some(meta.value()?.parse()?),
                    "object_unit" => found.object_unit = Some(meta.value()?.parse()?),
                    "group" => found.group = Some(meta.value()?.parse()?),
                    "symbol" => found.symbol = Some(meta.value()?.parse()?),
                    "when" => found.when = Some(meta.value()?.parse()?),
                    "derived" if meta.input.peek(Token![=]) => found.derived = Some(meta.value()?.parse()?),
                    "derived" => meta.parse_nested_meta(|inner| {
                        let field = inner.path.require_ident()?.to_string();
                        found.derived_in.push((field, inner.value()?.parse()?));
                        Ok(())
                    })?,
                    _ => return Err(meta.error("not an attribute of an input field")),
                }
                Ok(())
            })?;
        }
        Ok(found)
    }
}

/// The parsed `#[input(…)]` attributes of a struct.
#[derive(Default)]
struct StructAttributes {
    group: Option<LitStr>,
    rules: Option<Path>,
}

impl StructAttributes {
    fn of(attributes: &[Attribute]) -> Result<Self> {
        let mut found = Self::default();
        for attribute in attributes.iter().filter(|attribute| attribute.path().is_ident("input")) {
            attribute.parse_nested_meta(|meta| {
                if meta.path.is_ident("group") {
                    found.group = Some(meta.value()?.parse()?);
                } else if meta.path.is_ident("rules") {
                    found.rules = Some(meta.value()?.parse()?);
                } else {
                    return Err(meta.error("not an attribute of a struct of input fields"));
                }
                Ok(())
            })?;
        }
        Ok(found)
    }
}

/// A declared field.
struct Declaration {
    name: Ident,
    /// Name of the constant with the declaration.
    constant: Ident,
    ty: Type,
    help: String,
    omitted: bool,
    attributes: Attributes,
}

impl Declaration {
    fn of(field: syn::Field) -> Result<Self> {
        let name = field.ident.clone().ok_or_else(|| Error::new_spanned(&field, "an input field has a name"))?;
        let declaration = Self {
            constant: format_ident!("{}", name.unraw().to_string().to_uppercase()),
            help: help(&field.attrs),
            omitted: is_omitted(&field.attrs),
            attributes: Attributes::of(&field.attrs)?,
            ty: field.ty,
            name,
        };
        declaration.check()?;
        Ok(declaration)
    }

    /// Refuses attributes that do not apply to the type of the field.
    fn check(&self) -> Result<()> {
        let attributes = &self.attributes;
        let kind = innermost(&self.ty);
        let fail = |message: &str| Err(Error::new_spanned(&self.name, message));
        if self.help.is_empty() && !attributes.flatten {
            return fail("a field needs a doc comment: it is the help that people read");
        }
        let is_number = kind == "f64" || kind == "u32";
        if is_number != (attributes.min.is_some() && attributes.max.is_some()) {
            return fail("numbers, and only numbers, need `min` and `max`");
        }
        if (attributes.unit.is_some() || attributes.object_unit.is_some()) && kind != "f64" {
            return fail("only an `f64` has a unit");
        }
        if (kind == "String" && !is_list(&self.ty)) != attributes.max_chars.is_some() {
            return fail("texts, and only texts, need `max_chars`");
        }
        if self.is_scalar() && attributes.base.is_some() {
            return fail("only an object has a base");
        }
        Ok(())
    }

    /// Whether the value is none of the types that are declared elsewhere: an object or an enum.
    fn is_scalar(&self) -> bool {
        matches!(innermost(&self.ty).as_str(), "f64" | "u32" | "bool" | "String")
    }

    /// The constant with the declaration.
    fn declared(&self, group: Option<&LitStr>) -> Result<TokenStream> {
        let Self { constant, help, omitted, attributes, .. } = self;
        let name = self.name.unraw().to_string();
        let Attributes { required, min, max, min_items, max_items, max_chars, order, .. } = attributes;
        let mut given: Vec<TokenStream> =
            [("min", min), ("max", max), ("min_items", min_items), ("max_items", max_items), ("max_chars", max_chars)]
                .into_iter()
                .filter_map(|(name, value)| {
                    let (name, value) = (format_ident!("{name}"), value.as_ref()?);
                    Some(if name == "min" || name == "max" {
                        quote!(#name: (#value) as f64)
                    } else {
                        quote!(#name: #value)
                    })
                })
                .collect();
        if let Some(unit) = &attributes.object_unit {
            given.push(quote!(unit: crate::unit::Unit::of_object(#unit)));
        } else if innermost(&self.ty) == "f64" {
            let unit = attributes.unit.as_ref().map_or_else(|| "1".to_owned(), LitStr::value);
            given.push(quote!(unit: crate::unit::Unit::of_field(#name, #unit)));
        }
        let mut form = Vec::new();
        if let Some(group) = attributes.group.as_ref().or(group) {
            form.push(quote!(group: #group));
        }
        if let Some(order) = order {
            form.push(quote!(order: #order));
        }
        if let Some(symbol) = &attributes.symbol {
            let text = symbol.value();
            let (letter, subscript) = text.split_once('_').unwrap_or((&text, ""));
            form.push(quote!(symbol: (#letter, #subscript)));
        }
        if let Some(when) = &attributes.when {
            let text = when.value();
            let (sibling, values) =
                text.split_once(" = ").ok_or_else(|| Error::new_spanned(when, "written as \"field = values\""))?;
            form.push(quote!(when: Some((#sibling, #values))));
        }
        if let Some(derived) = &attributes.derived {
            form.push(quote!(derived: Some(#derived)));
        }
        if !attributes.derived_in.is_empty() {
            let pairs = attributes.derived_in.iter().map(|(field, words)| quote!((#field, #words)));
            form.push(quote!(derived_in: &[#(#pairs),*]));
        }
        Ok(quote! {
            pub(crate) const #constant: &'static crate::field::Declared = &crate::field::Declared {
                name: #name,
                help: #help,
                required: #required,
                omitted: #omitted,
                #(#given,)*
                form: crate::field::FormPlace { #(#form,)* ..crate::field::Declared::NOTHING.form },
                ..crate::field::Declared::NOTHING
            };
        })
    }

    /// The statement that reads the field into a variable of its name.
    fn read(&self) -> TokenStream {
        let Self { name, constant, ty, attributes, .. } = self;
        let wrapped = |value: &Expr| if is_option(ty) { quote!(Some(#value)) } else { quote!(#value) };
        let default = match (&attributes.base, &attributes.default) {
            (Some(base), _) => {
                let base = wrapped(base);
                quote!(Some(&#base))
            }
            (None, Some(default)) => {
                let default = wrapped(default);
                quote!(Some(__base.map_or(&#default, |__base| &__base.#name)))
            }
            (None, None) if self.is_scalar() => quote!(None),
            (None, None) => quote!(__base.map(|__base| &__base.#name)),
        };
        if attributes.flatten {
            return quote!(let #name = <#ty as crate::field::Input>::read(__object, #default););
        }
        quote!(let #name = <#ty as crate::field::Field>::read(__object, Self::#constant, #default);)
    }

    fn check_rules(&self) -> TokenStream {
        let Self { name, constant, ty, attributes, .. } = self;
        if attributes.flatten {
            return quote!(<#ty as crate::field::Input>::check(&mut self.#name, __place););
        }
        if self.is_scalar() {
            return TokenStream::new();
        }
        quote!(<#ty as crate::field::Field>::check(&mut self.#name, Self::#constant, __place);)
    }
}

pub(crate) fn derive_input(item: DeriveInput) -> Result<TokenStream> {
    let StructAttributes { group, rules } = StructAttributes::of(&item.attrs)?;
    let Data::Struct(data) = item.data else {
        return Err(Error::new_spanned(item.ident, "only a struct has input fields"));
    };
    let Fields::Named(fields) = data.fields else {
        return Err(Error::new_spanned(item.ident, "input fields have names"));
    };
    let declarations = fields.named.into_iter().map(Declaration::of).collect::<Result<Vec<_>>>()?;
    let ident = &item.ident;
    let (flattened, own): (Vec<_>, Vec<_>) = declarations.iter().partition(|field| field.attributes.flatten);
    let constants = own.iter().map(|field| field.declared(group.as_ref())).collect::<Result<Vec<_>>>()?;
    let mut in_order: Vec<&Declaration> = declarations.iter().collect();
    in_order.sort_by_key(|field| field.attributes.first.unwrap_or(u32::MAX));
    let reads = in_order.iter().map(|field| field.read());
    let checks = in_order.iter().map(|field| field.check_rules());
    let names = declarations.iter().map(|field| &field.name);
    let arms = own.iter().map(|Declaration { name, constant, ty, .. }| {
        let text = name.unraw().to_string();
        quote!(#text => <#ty as crate::field::Field>::slot(&mut self.#name, Self::#constant, __rest),)
    });
    let others = flattened.iter().map(|Declaration { name, ty, .. }| {
        quote! {
            if let Some(__slot) = <#ty as crate::field::Input>::slot(&mut self.#name, __pointer) {
                return Some(__slot);
            }
        }
    });
    let rules_when_read = rules.iter().map(|rules| quote!(#rules(&mut __value, &__object.place());));
    let rules_when_checked = rules.iter().map(|rules| quote!(#rules(self, __place);));
    let mutable = rules.iter().map(|_| quote!(mut));
    Ok(quote! {
        impl #ident {
            #(#constants)*
        }

        impl crate::field::Input for #ident {
            fn read(__object: &crate::reader::Object, __base: Option<&Self>) -> Self {
                #(#reads)*
                let #(#mutable)* __value = Self { #(#names),* };
                #(#rules_when_read)*
                __value
            }

            fn check(&mut self, __place: &crate::reader::ObjectPlace) {
                #(#checks)*
                #(#rules_when_checked)*
            }

            fn slot(&mut self, __pointer: &str) -> Option<crate::field::Slot<'_>> {
                let (__name, __rest) = crate::path::split_first(__pointer)?;
                match __name {
                    #(#arms)*
                    _ => {
                        #(#others)*
                        None
                    }
                }
            }
        }
    })
}

/// A word of an enum.
struct Word {
    variant: Ident,
    word: String,
    label: Option<LitStr>,
}

impl Word {
    fn of(variant: &syn::Variant) -> Result<Self> {
        if !matches!(variant.fields, Fields::Unit) {
            return Err(Error::new_spanned(variant, "a word has no fields"));
        }
        let mut word =
            Self { variant: variant.ident.clone(), word: snake_case(&variant.ident.to_string()), label: None };
        for attribute in variant.attrs.iter().filter(|attribute| attribute.path().is_ident("words")) {
            attribute.parse_nested_meta(|meta| {
                if meta.path.is_ident("rename") {
                    word.word = meta.value()?.parse::<LitStr>()?.value();
                } else if meta.path.is_ident("label") {
                    word.label = Some(meta.value()?.parse()?);
                } else {
                    return Err(meta.error("not an attribute of a word"));
                }
                Ok(())
            })?;
        }
        Ok(word)
    }
}

pub(crate) fn derive_words(item: DeriveInput) -> Result<TokenStream> {
    let Data::Enum(DataEnum { variants, .. }) = item.data else {
        return Err(Error::new_spanned(item.ident, "a list of words is an enum"));
    };
    let words = variants.iter().map(Word::of).collect::<Result<Vec<_>>>()?;
    let ident = &item.ident;
    let count = words.len();
    let pairs = words.iter().map(|Word { variant, word, .. }| quote!((#word, Self::#variant)));
    let arms = words.iter().map(|Word { variant, word, .. }| quote!(Self::#variant => #word));
    let labels =
        words.iter().filter_map(|Word { word, label, .. }| label.as_ref().map(|label| quote!((#word, #label))));
    Ok(quote! {
        impl #ident {
            /// Every word with its value.
            pub const ALL: [(&'static str, Self); #count] = [#(#pairs),*];

            /// The word in documents and results.
            pub const fn as_str(self) -> &'static str {
                match self {
                    #(#arms),*
                }
            }
        }

        impl crate::field::Words for #ident {
            const WORDS: &'static [(&'static str, Self)] = &Self::ALL;
            const LABELS: &'static [(&'static str, &'static str)] = &[#(#labels),*];

            fn as_word(self) -> &'static str {
                self.as_str()
            }
        }

        impl crate::field::Field for #ident {
            fn read(object: &crate::reader::Object, declared: &'static crate::field::Declared, default: Option<&Self>) -> Self {
                let default = default.copied();
                object.choice(declared, default, default.is_none()).or(default).unwrap_or(Self::ALL[0].1)
            }

            fn slot(&mut self, _: &'static crate::field::Declared, pointer: &str) -> Option<crate::field::Slot<'_>> {
                pointer.is_empty().then_some(crate::field::Slot::Other)
            }
        }

        impl crate::field::Field for Option<#ident> {
            fn read(object: &crate::reader::Object, declared: &'static crate::field::Declared, default: Option<&Self>) -> Self {
                object.choice(declared, default.copied().flatten(), false)
            }

            fn slot(&mut self, declared: &'static crate::field::Declared, pointer: &str) -> Option<crate::field::Slot<'_>> {
                let is_there = self.is_some() || !declared.omitted;
                (pointer.is_empty() && is_there).then_some(crate::field::Slot::Other)
            }
        }

        impl crate::field::Field for Vec<#ident> {
            fn read(object: &crate::reader::Object, declared: &'static crate::field::Declared, _: Option<&Self>) -> Self {
                object.choices(declared)
            }

            fn slot(&mut self, declared: &'static crate::field::Declared, pointer: &str) -> Option<crate::field::Slot<'_>> {
                let is_there = !self.is_empty() || !declared.omitted;
                (pointer.is_empty() && is_there).then_some(crate::field::Slot::Other)
            }
        }

        impl serde::Serialize for #ident {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.as_str())
            }
        }

        impl<'de> serde::Deserialize<'de> for #ident {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let word = <std::borrow::Cow<str> as serde::Deserialize>::deserialize(deserializer)?;
                <Self as crate::field::Words>::of_word(&word)
                    .ok_or_else(|| serde::de::Error::custom(format!("{word:?} is not one of the permitted words")))
            }
        }
    })
}

/// The first paragraph of a doc comment, in one line.
fn help(attributes: &[Attribute]) -> String {
    doc_lines(attributes).take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ")
}

/// Whether an empty field is omitted when the document is serialized (`#[serde(skip_serializing_if = …)]`).
fn is_omitted(attributes: &[Attribute]) -> bool {
    let serde = attributes.iter().filter(|attribute| attribute.path().is_ident("serde"));
    serde
        .filter_map(|attribute| attribute.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated).ok())
        .any(|metas| metas.iter().any(|meta| meta.path().is_ident("skip_serializing_if")))
}

fn last_segment(ty: &Type) -> Option<&syn::PathSegment> {
    match ty {
        Type::Path(path) => path.path.segments.last(),
        _ => None,
    }
}

fn is_option(ty: &Type) -> bool {
    last_segment(ty).is_some_and(|segment| segment.ident == "Option")
}

/// The type inside an `Option` or a `Vec`.
fn inner(ty: &Type) -> Option<&Type> {
    let segment = last_segment(ty).filter(|segment| segment.ident == "Option" || segment.ident == "Vec")?;
    match &segment.arguments {
        syn::PathArguments::AngleBracketed(arguments) => match arguments.args.first()? {
            syn::GenericArgument::Type(ty) => Some(ty),
            _ => None,
        },
        _ => None,
    }
}

fn is_list(ty: &Type) -> bool {
    last_segment(ty).is_some_and(|segment| segment.ident == "Vec") || inner(ty).is_some_and(is_list)
}

/// Name of the type inside all `Option`s and `Vec`s.
fn innermost(ty: &Type) -> String {
    match inner(ty) {
        Some(ty) => innermost(ty),
        None => last_segment(ty).map_or_else(|| ty.to_token_stream().to_string(), |segment| segment.ident.to_string()),
    }
}

fn snake_case(name: &str) -> String {
    let mut text = String::with_capacity(name.len() + 4);
    for letter in name.chars() {
        if letter.is_uppercase() && !text.is_empty() {
            text.push('_');
        }
        text.extend(letter.to_lowercase());
    }
    text
}
