//! From a struct to its description and its reading.

use crate::attributes::{KeyAttribute, KindAttribute, NeedAttribute, RangeAttribute, Role, TableAttribute};
use crate::literal::{doc, text, toml, unit_suffix};
use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};
use syn::{Data, DeriveInput, Error, Expr, Field, Fields, GenericArgument, PathArguments, Result, Type};

/// A field of the struct, understood.
struct Member {
    /// Its initialiser.
    read: TokenStream,
    part: Part,
}

/// What a field adds to the description of the table.
enum Part {
    Nothing,
    /// A key with its name and its type.
    Key {
        spec: TokenStream,
        name: String,
        ty: Type,
    },
    /// A group of keys.
    Group(Type),
}

/// The implementations for a struct.
pub fn table(input: &DeriveInput) -> Result<TokenStream> {
    let Data::Struct(data) = &input.data else {
        return Err(Error::new_spanned(&input.ident, "a table is a struct"));
    };
    let Fields::Named(fields) = &data.fields else {
        return Err(Error::new_spanned(&input.ident, "the fields of a table have names"));
    };
    let attribute = TableAttribute::of(&input.attrs)?;
    let members = fields.named.iter().map(member).collect::<Result<Vec<_>>>()?;
    let (ident, text) = (&input.ident, doc(&input.attrs)?);
    if text.is_empty() {
        return Err(Error::new_spanned(ident, "a table needs a doc comment"));
    }
    let name = attribute.name.clone().unwrap_or_default();
    let keys = keys(&attribute, &members);
    let format = attribute.format.iter().map(|format| quote!(const FORMAT: &'static str = #format;));
    let reads = members.iter().map(|m| &m.read);
    let takes = members.iter().filter_map(|m| match &m.part {
        Part::Key { name, ty, .. } => {
            Some(quote!(#name => <#ty as crate::config::table::KeyValue>::of(entry).is_some(),))
        }
        _ => None,
    });
    let tests = format_ident!("table_of_{}", snake_case(&ident.to_string()));
    Ok(quote! {
        impl crate::config::table::Table for #ident {
            const SPEC: &'static crate::config::spec::TableSpec =
                &crate::config::spec::TableSpec { name: #name, doc: #text, keys: #keys };
            #(#format)*

            fn read(section: &crate::config::section::Section) -> Self {
                Self { #(#reads)* }
            }

            #[cfg(test)]
            fn takes(key: &str, entry: &crate::config::section::Entry) -> bool {
                match key {
                    #(#takes)*
                    _ => true,
                }
            }
        }

        impl crate::config::table::KeyValue for #ident {
            const VALUE_KIND: crate::config::spec::Kind =
                crate::config::spec::Kind::Table(<#ident as crate::config::table::Table>::SPEC);

            fn of(entry: &crate::config::section::Entry) -> Option<Self> {
                crate::config::table::nested(entry)
            }
        }

        impl Default for #ident {
            fn default() -> Self {
                crate::config::table::empty()
            }
        }

        #[cfg(test)]
        mod #tests {
            #[test]
            fn every_example_and_default_is_taken() {
                crate::config::table::takes_what_it_describes::<super::#ident>();
            }
        }
    })
}

/// The keys of a table, those of its groups among them.
fn keys(attribute: &TableAttribute, members: &[Member]) -> TokenStream {
    let mut parts: Vec<TokenStream> = vec![];
    let mut run: Vec<TokenStream> = vec![];
    if let Some(format) = &attribute.format {
        let need = if attribute.format_may_lack { quote!(Optional) } else { quote!(Required) };
        let example = format!("\"{format}\"");
        run.push(quote!(crate::config::spec::KeySpec {
            name: "format",
            kind: crate::config::spec::Kind::Format(#format),
            need: crate::config::spec::Need::#need,
            example: #example,
            doc: "Version of the format.",
        }));
    }
    for member in members {
        match &member.part {
            Part::Nothing => {}
            Part::Key { spec, .. } => run.push(spec.clone()),
            Part::Group(group) => {
                let before = std::mem::take(&mut run);
                parts.push(quote!(&[#(#before),*]));
                parts.push(quote!(<#group as crate::config::table::Table>::SPEC.keys));
            }
        }
    }
    if parts.is_empty() {
        return quote!(&[#(#run),*]);
    }
    parts.push(quote!(&[#(#run),*]));
    quote!({
        const PARTS: &[&[crate::config::spec::KeySpec]] = &[#(#parts),*];
        &crate::config::table::joined::<{ crate::config::table::count(PARTS) }>(PARTS)
    })
}

fn member(field: &Field) -> Result<Member> {
    let attribute = KeyAttribute::of(&field.attrs)?;
    let Some(ident) = &field.ident else { return Err(Error::new_spanned(field, "expected a name")) };
    let ty = &field.ty;
    let (value, part) = match &attribute.role {
        Role::Span => (quote!(section.span.clone()), Part::Nothing),
        Role::Section => (quote!(section.clone()), Part::Nothing),
        Role::Group => (quote!(<#ty as crate::config::table::Table>::read(section)), Part::Group(ty.clone())),
        Role::Key => {
            let name = match &attribute.name {
                Some(name) => name.clone(),
                None => key_name(&ident.to_string(), &attribute.kind)?,
            };
            let value = quote!(crate::config::table::value(section, Self::SPEC.keys, #name));
            (value, Part::Key { spec: key(field, &attribute, &name)?, name, ty: ty.clone() })
        }
    };
    Ok(Member { read: quote!(#ident: #value,), part })
}

/// The name of the key of a field: without the unit that the field ends in.
fn key_name(field: &str, kind: &KindAttribute) -> Result<String> {
    let plain = field.strip_prefix("r#").unwrap_or(field);
    let (KindAttribute::Quantity(unit) | KindAttribute::Difference(unit)) = kind else {
        return Ok(plain.to_owned());
    };
    let suffix = unit_suffix(&text(unit)?);
    let stem = plain.strip_suffix(suffix.as_str()).and_then(|stem| stem.strip_suffix('_'));
    Ok(stem.unwrap_or(plain).to_owned())
}

/// The description of a key.
fn key(field: &Field, attribute: &KeyAttribute, name: &str) -> Result<TokenStream> {
    let text = doc(&field.attrs)?;
    if text.is_empty() {
        return Err(Error::new_spanned(field, "a key needs a doc comment"));
    }
    let kind = kind(&field.ty, attribute)?;
    let need = match &attribute.need {
        NeedAttribute::Required => quote!(Required),
        NeedAttribute::Optional => quote!(Optional),
        NeedAttribute::Default(value) => {
            let default = toml(value)?;
            quote!(Default(#default))
        }
        NeedAttribute::ByType if inside(&field.ty, "Option").or(inside(&field.ty, "Vec")).is_some() => {
            quote!(Optional)
        }
        NeedAttribute::ByType => quote!(Required),
    };
    let example = attribute.example.as_ref().map(toml).transpose()?.unwrap_or_default();
    Ok(quote!(crate::config::spec::KeySpec {
        name: #name,
        kind: #kind,
        need: crate::config::spec::Need::#need,
        example: #example,
        doc: #text,
    }))
}

fn kind(ty: &Type, attribute: &KeyAttribute) -> Result<TokenStream> {
    let outer = inside(ty, "Option").unwrap_or(ty);
    let list = inside(outer, "Vec");
    let item = list.unwrap_or(outer);
    let range = range(&attribute.range)?;
    let kind = match &attribute.kind {
        KindAttribute::Stated(kind) => return Ok(quote!(#kind)),
        KindAttribute::Quantity(unit) => quote!(Quantity { unit: #unit, difference: false, range: #range }),
        KindAttribute::Difference(unit) => quote!(Quantity { unit: #unit, difference: true, range: #range }),
        KindAttribute::UnitOf(key) => quote!(QuantityBy(#key)),
        KindAttribute::Choice(words) if list.is_some() => quote!(Choices(#words)),
        KindAttribute::Choice(words) => quote!(Choice(#words)),
        KindAttribute::Id => quote!(Id),
        KindAttribute::Remark if is(item, "LocalText") => quote!(LocalRemark),
        KindAttribute::Remark => quote!(Remark),
        KindAttribute::OneOrSeveral => {
            quote!(TableOrTables(<#item as crate::config::table::Table>::SPEC))
        }
        KindAttribute::ByType if is_number(item) && list.is_some() => quote!(Numbers(#range)),
        KindAttribute::ByType if is_number(item) => quote!(Number(#range)),
        KindAttribute::ByType if attribute.range.is_stated() => {
            return Err(Error::new_spanned(ty, "a range is of a number"));
        }
        KindAttribute::ByType => return Ok(quote!(<#ty as crate::config::table::KeyValue>::VALUE_KIND)),
    };
    Ok(quote!(crate::config::spec::Kind::#kind))
}

fn range(range: &RangeAttribute) -> Result<TokenStream> {
    if let Some(constant) = &range.constant {
        return Ok(quote!(#constant));
    }
    let low = if range.above.is_some() { &range.above } else { &range.min };
    let (low, high) = (bound(low, quote!(f64::MIN))?, bound(&range.max, quote!(f64::MAX))?);
    let open = range.above.is_some();
    Ok(quote!(crate::config::spec::Range { low: #low, high: #high, open: #open }))
}

/// A bound of a range, or what stands where there is none.
fn bound(value: &Option<Expr>, none: TokenStream) -> Result<TokenStream> {
    let Some(value) = value else { return Ok(none) };
    let number: f64 =
        toml(value)?.replace('_', "").parse().map_err(|_| Error::new_spanned(value, "expected a number"))?;
    let size = Literal::f64_suffixed(number.abs());
    Ok(if number < 0.0 { quote!(-#size) } else { quote!(#size) })
}

/// The type in the brackets of another, `T` of `Option<T>`.
fn inside<'a>(ty: &'a Type, wrapper: &str) -> Option<&'a Type> {
    let Type::Path(path) = ty else { return None };
    let last = path.path.segments.last().filter(|segment| segment.ident == wrapper)?;
    let PathArguments::AngleBracketed(arguments) = &last.arguments else { return None };
    match arguments.args.first()? {
        GenericArgument::Type(inner) => Some(inner),
        _ => None,
    }
}

fn is(ty: &Type, name: &str) -> bool {
    matches!(ty, Type::Path(path) if path.path.segments.last().is_some_and(|s| s.ident == name))
}

fn is_number(ty: &Type) -> bool {
    ["f64", "u16", "u32", "u64", "usize"].into_iter().any(|name| is(ty, name))
}

fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for c in name.chars() {
        if c.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.extend(c.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;
    use syn::parse_quote;

    fn expanded(input: DeriveInput) -> String {
        table(&input).map_or_else(|e| format!("error: {e}"), |tokens| tokens.to_string().replace(' ', ""))
    }

    #[test]
    fn a_field_is_described_and_read_under_one_name() {
        let out = expanded(parse_quote! {
            /// A supply.
            #[table("conditions.supply")]
            struct Supply {
                /// Rest before
                /// the record counts.
                #[key(quantity = "s", min = 0, default = "0 s", example = "30 min")]
                settle_s: f64,
                /// Its serial number.
                #[key(example = "7")]
                serial: Option<String>,
            }
        });
        assert!(out.contains(r#"name:"conditions.supply",doc:"Asupply.""#), "{out}");
        assert!(
            out.contains(
                r#"name:"settle",kind:crate::config::spec::Kind::Quantity{unit:"s",difference:false"#
            )
        );
        assert!(out.contains("range:crate::config::spec::Range{low:0f64,high:f64::MAX,open:false}"), "{out}");
        assert!(
            out.contains(r#"Need::Default("\"0s\""),example:"\"30min\"",doc:"Restbeforetherecordcounts.""#)
        );
        assert!(
            out.contains(r#"settle_s:crate::config::table::value(section,Self::SPEC.keys,"settle"),"#),
            "{out}"
        );
        assert!(out.contains("Need::Optional"), "{out}");
    }

    #[test]
    fn groups_and_places_are_no_keys() {
        let out = expanded(parse_quote! {
            /// A run.
            #[table("run", format = "run/1")]
            struct Run {
                #[key(flatten)]
                stretch: Stretch,
                #[key(span)]
                span: Span,
                #[key(section)]
                section: Section,
            }
        });
        assert!(out.contains(r#"Kind::Format("run/1")"#), "{out}");
        assert!(out.contains("<Stretchascrate::config::table::Table>::SPEC.keys"), "{out}");
        assert!(out.contains(r#"span:section.span.clone(),section:section.clone(),"#), "{out}");
        assert_eq!(out.matches("doc:").count(), 2, "{out}");
    }

    #[test]
    fn what_a_table_lacks_is_an_error_of_the_compiler() {
        let without_doc = expanded(parse_quote! {
            /// A table.
            #[table("a")]
            struct A {
                #[key(example = 1)]
                b: f64,
            }
        });
        assert_eq!(without_doc, "error: a key needs a doc comment");
        let range_of_text = expanded(parse_quote! {
            /// A table.
            #[table("a")]
            struct A {
                /// A text.
                #[key(min = 0, example = "x")]
                b: String,
            }
        });
        assert_eq!(range_of_text, "error: a range is of a number");
        let unknown = expanded(parse_quote! {
            /// A table.
            #[table("a")]
            struct A {
                /// A text.
                #[key(exmaple = "x")]
                b: String,
            }
        });
        assert_eq!(unknown, "error: no such attribute of a key");
        assert_eq!(
            expanded(parse_quote!(
                enum A {}
            )),
            "error: a table is a struct"
        );
    }
}
