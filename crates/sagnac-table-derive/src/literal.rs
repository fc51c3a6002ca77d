//! Values of TOML, as attributes have them, and texts of doc comments.

use syn::{Attribute, Error, Expr, ExprCall, ExprUnary, Lit, Meta, Result, UnOp};

/// A value as it is written in TOML.
pub fn toml(value: &Expr) -> Result<String> {
    let unknown = || Error::new_spanned(value, "expected a text, a number, a flag, a list or toml(\"...\")");
    match value {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Str(text) => Ok(quoted(&text.value())),
            Lit::Int(number) => Ok(number.to_string()),
            Lit::Float(number) => Ok(number.to_string()),
            Lit::Bool(flag) => Ok(flag.value.to_string()),
            _ => Err(unknown()),
        },
        Expr::Unary(ExprUnary { op: UnOp::Neg(_), expr, .. }) => Ok(format!("-{}", toml(expr)?)),
        Expr::Array(list) => {
            let items = list.elems.iter().map(toml).collect::<Result<Vec<_>>>()?;
            Ok(format!("[{}]", items.join(", ")))
        }
        Expr::Group(group) => toml(&group.expr),
        Expr::Call(ExprCall { func, args, .. }) => match (&**func, args.first()) {
            (Expr::Path(path), Some(verbatim)) if path.path.is_ident("toml") => text(verbatim),
            _ => Err(unknown()),
        },
        _ => Err(unknown()),
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

/// The text of a literal.
pub fn text(value: &Expr) -> Result<String> {
    match value {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Str(text) => Ok(text.value()),
            _ => Err(Error::new_spanned(value, "expected a text")),
        },
        Expr::Group(group) => text(&group.expr),
        _ => Err(Error::new_spanned(value, "expected a text")),
    }
}

/// The first paragraph of a doc comment in one line.
pub fn doc(attributes: &[Attribute]) -> Result<String> {
    let mut lines = vec![];
    for attribute in attributes.iter().filter(|a| a.path().is_ident("doc")) {
        if let Meta::NameValue(pair) = &attribute.meta {
            lines.push(text(&pair.value)?);
        }
    }
    let paragraph: Vec<&str> =
        lines.iter().flat_map(|l| l.split('\n')).map(str::trim).take_while(|line| !line.is_empty()).collect();
    Ok(paragraph.join(" "))
}

/// The end that a field has whose value is in a unit: `deg_c_h` of `degC/h`; empty for a pure number.
pub fn unit_suffix(unit: &str) -> String {
    let mut suffix = String::new();
    for c in unit.chars() {
        let begins_word = c.is_uppercase() || !c.is_alphanumeric();
        if begins_word && !suffix.is_empty() && !suffix.ends_with('_') {
            suffix.push('_');
        }
        if c.is_alphabetic() {
            suffix.extend(c.to_lowercase());
        }
    }
    suffix
}

#[cfg(test)]
mod tests {
    use super::*;
    use syn::parse_quote;

    fn written(value: Expr) -> String {
        toml(&value).unwrap_or_else(|e| format!("error: {e}"))
    }

    #[test]
    fn values_are_written_as_in_a_file() {
        assert_eq!(written(parse_quote!("20 degC")), "\"20 degC\"");
        assert_eq!(written(parse_quote!("a \"b\"")), r#""a \"b\"""#);
        assert_eq!(written(parse_quote!(2.0)), "2.0");
        assert_eq!(written(parse_quote!(-10.0)), "-10.0");
        assert_eq!(written(parse_quote!(0x0F)), "0x0F");
        assert_eq!(written(parse_quote!(true)), "true");
        assert_eq!(written(parse_quote!(["rate", "sigma_tau"])), "[\"rate\", \"sigma_tau\"]");
        assert_eq!(written(parse_quote!([0.0, -10.0])), "[0.0, -10.0]");
        assert_eq!(written(parse_quote!(toml("2030-12-31"))), "2030-12-31");
        assert!(written(parse_quote!(day("2030-12-31"))).starts_with("error: expected"));
        assert!(written(parse_quote!('a')).starts_with("error: expected"));
    }

    #[test]
    fn a_doc_comment_is_one_line_of_its_first_paragraph() {
        let field: syn::Field = parse_quote! {
            /// Positions at rest; needs
            /// [site].
            ///
            /// In deg.
            positions: Vec<Position>
        };
        assert_eq!(doc(&field.attrs).unwrap(), "Positions at rest; needs [site].");
    }

    #[test]
    fn a_field_ends_in_its_unit_as_units_are_spoken() {
        let cases =
            [("s", "s"), ("degC", "deg_c"), ("degC/h", "deg_c_h"), ("Hz", "hz"), ("V", "v"), ("1", "")];
        for (unit, suffix) in cases {
            assert_eq!(unit_suffix(unit), suffix, "{unit}");
        }
    }
}
