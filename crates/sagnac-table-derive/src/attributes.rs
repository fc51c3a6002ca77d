//! The attributes `#[table(...)]` and `#[key(...)]`, as they are written.

use syn::meta::ParseNestedMeta;
use syn::parse::Parser;
use syn::{Attribute, Error, Expr, LitStr, Meta, Result, Token};

/// `#[table("name", format = "procedure/1")]`.
#[derive(Default)]
pub struct TableAttribute {
    /// Path of the table; `None` for a group of keys.
    pub name: Option<String>,
    /// Version of the format, for a file as a whole.
    pub format: Option<String>,
    /// Whether the version may be left out.
    pub format_may_lack: bool,
}

/// `#[key(...)]`.
#[derive(Default)]
pub struct KeyAttribute {
    pub name: Option<String>,
    pub role: Role,
    pub kind: KindAttribute,
    pub range: RangeAttribute,
    pub need: NeedAttribute,
    pub example: Option<Expr>,
}

/// Role of a field in its struct.
#[derive(Default, PartialEq)]
pub enum Role {
    /// A key.
    #[default]
    Key,
    /// A group of keys.
    Group,
    /// Place of the table.
    Span,
    /// The table as it was read, for the places of its values.
    Section,
}

/// Kind of value, where the type of the field does not say it.
#[derive(Default)]
pub enum KindAttribute {
    #[default]
    ByType,
    Quantity(Expr),
    Difference(Expr),
    UnitOf(String),
    Choice(Expr),
    Id,
    Remark,
    OneOrSeveral,
    Stated(Expr),
}

/// Range of a number.
#[derive(Default)]
pub struct RangeAttribute {
    pub constant: Option<Expr>,
    pub min: Option<Expr>,
    pub above: Option<Expr>,
    pub max: Option<Expr>,
}

impl RangeAttribute {
    /// True when a bound is stated.
    pub fn is_stated(&self) -> bool {
        [&self.constant, &self.min, &self.above, &self.max].iter().any(|bound| bound.is_some())
    }
}

/// Whether a key must be there.
#[derive(Default)]
pub enum NeedAttribute {
    #[default]
    ByType,
    Required,
    Optional,
    Default(Expr),
}

impl TableAttribute {
    /// Reads the attribute of a struct.
    pub fn of(attributes: &[Attribute]) -> Result<TableAttribute> {
        let mut table = TableAttribute::default();
        for attribute in attributes.iter().filter(|a| a.path().is_ident("table")) {
            let Meta::List(list) = &attribute.meta else {
                return Err(Error::new_spanned(attribute, "expected #[table(\"name\")]"));
            };
            let parser = |input: syn::parse::ParseStream<'_>| {
                table.name = Some(input.parse::<LitStr>()?.value());
                while input.parse::<Option<Token![,]>>()?.is_some() && !input.is_empty() {
                    let word: syn::Ident = input.parse()?;
                    if word == "format_may_lack" {
                        table.format_may_lack = true;
                    } else if word == "format" {
                        input.parse::<Token![=]>()?;
                        table.format = Some(input.parse::<LitStr>()?.value());
                    } else {
                        return Err(Error::new_spanned(word, "expected `format` or `format_may_lack`"));
                    }
                }
                Ok(())
            };
            parser.parse2(list.tokens.clone())?;
        }
        Ok(table)
    }
}

impl KeyAttribute {
    /// Reads the attribute of a field.
    pub fn of(attributes: &[Attribute]) -> Result<KeyAttribute> {
        let mut key = KeyAttribute::default();
        for attribute in attributes.iter().filter(|a| a.path().is_ident("key")) {
            attribute.parse_nested_meta(|meta| key.take(&meta))?;
        }
        Ok(key)
    }

    fn take(&mut self, meta: &ParseNestedMeta<'_>) -> Result<()> {
        let word = meta.path.get_ident().map(ToString::to_string).unwrap_or_default();
        let text = || Ok::<String, Error>(meta.value()?.parse::<LitStr>()?.value());
        let value = || meta.value()?.parse::<Expr>();
        match word.as_str() {
            "name" => self.name = Some(text()?),
            "flatten" => self.role = Role::Group,
            "span" => self.role = Role::Span,
            "section" => self.role = Role::Section,
            "quantity" => self.kind = KindAttribute::Quantity(value()?),
            "difference" => self.kind = KindAttribute::Difference(value()?),
            "unit_of" => self.kind = KindAttribute::UnitOf(text()?),
            "choice" => self.kind = KindAttribute::Choice(value()?),
            "id" => self.kind = KindAttribute::Id,
            "remark" => self.kind = KindAttribute::Remark,
            "one_or_several" => self.kind = KindAttribute::OneOrSeveral,
            "kind" => self.kind = KindAttribute::Stated(value()?),
            "range" => self.range.constant = Some(value()?),
            "min" => self.range.min = Some(value()?),
            "above" => self.range.above = Some(value()?),
            "max" => self.range.max = Some(value()?),
            "required" => self.need = NeedAttribute::Required,
            "optional" => self.need = NeedAttribute::Optional,
            "default" => self.need = NeedAttribute::Default(value()?),
            "example" => self.example = Some(value()?),
            _ => return Err(meta.error("no such attribute of a key")),
        }
        Ok(())
    }
}
