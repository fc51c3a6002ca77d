//! Units as a report shows them: `deg/sqrt(h)` as `°/√h`, each symbol through the locale table.

use crate::i18n::{Lang, lookup};

/// A unit text in print. A symbol that the table lacks shows as it is.
pub fn pretty(unit: &str, lang: Lang) -> String {
    let mut out = String::with_capacity(unit.len());
    let mut rest = unit.trim();
    if rest == "1" {
        return String::new();
    }
    while let Some(c) = rest.chars().next() {
        if let Some(inner) = rest.strip_prefix("sqrt(")
            && let Some(end) = inner.find(')')
        {
            out.push('√');
            let root = pretty(&inner[..end], lang);
            let compound = root.contains(['/', '·']);
            out.push_str(&if compound { format!("({root})") } else { root });
            rest = &inner[end + 1..];
        } else if c.is_alphabetic() || c == '°' || c == '%' || c == 'µ' {
            let end = rest.find(|c: char| !(c.is_alphabetic() || matches!(c, '°' | '%' | 'µ')));
            let (symbol, tail) = rest.split_at(end.unwrap_or(rest.len()));
            out.push_str(lookup(lang, &format!("unit.{symbol}")).unwrap_or(symbol));
            rest = tail;
        } else if let Some(tail) = rest.strip_prefix('^') {
            let end = tail.find(|c: char| !(c.is_ascii_digit() || c == '-')).unwrap_or(tail.len());
            let (power, tail) = tail.split_at(end);
            let raised = superscript(power);
            out.push_str(if raised.is_empty() { "^" } else { &raised });
            rest = tail;
        } else {
            out.push(if c == '*' { '·' } else { c });
            rest = &rest[c.len_utf8()..];
        }
    }
    out
}

/// A whole number in superscript figures.
pub fn superscript(ascii: &str) -> String {
    const FIGURES: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    ascii
        .chars()
        .filter_map(|c| match c {
            '-' => Some('⁻'),
            c => c.to_digit(10).and_then(|d| FIGURES.get(d as usize).copied()),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_read_as_printed_ones() {
        let en = |u| pretty(u, Lang::En);
        assert_eq!(en("deg/sqrt(h)"), "°/√h");
        assert_eq!(en("deg/h/sqrt(h)"), "°/h/√h");
        assert_eq!(en("deg/h/(degC/min)"), "°/h/(°C/min)");
        assert_eq!(en("arcsec"), "arcsec");
        assert_eq!(en("(deg/h)^2/Hz"), "(°/h)²/Hz");
        assert_eq!(en("1"), "");
        assert_eq!(en("sqrt("), "sqrt(");
        assert_eq!(en("furlong/h"), "furlong/h");
    }
}
