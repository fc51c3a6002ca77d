//! Tables in CSV, a line at a time.

/// A line of a table, its end included: each field in quotation marks where it must be (RFC 4180). A spreadsheet takes a text that
/// begins with one of a few signs for a formula; such a text gets an apostrophe in front. A number stays a number.
pub fn csv_line<T: AsRef<str>>(fields: impl IntoIterator<Item = T>) -> String {
    let fields: Vec<String> = fields.into_iter().map(|f| quoted(f.as_ref())).collect();
    format!("{}\n", fields.join(","))
}

fn quoted(text: &str) -> String {
    let text = harmless(text);
    if text.contains([',', ';', '"', '\n', '\r', '\t']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

/// The text without formulas: neither at its beginning nor behind a sign that separates fields elsewhere.
fn harmless(text: &str) -> String {
    let digits = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
    if text.chars().all(digits) && text.parse::<f64>().is_ok() {
        return text.to_owned();
    }
    let mut out = String::with_capacity(text.len() + 1);
    let mut first = true;
    for c in text.chars() {
        // The wide forms count as the narrow ones in some spreadsheets.
        if first && matches!(c, '=' | '+' | '-' | '@' | '\t' | '\r' | '＝' | '＋' | '－' | '＠') {
            out.push('\'');
        }
        out.push(c);
        first = matches!(c, ';' | '\t' | '\n' | '\r') || first && c == ' ';
    }
    out
}

#[cfg(test)]
mod tests {
    use super::{csv_line, quoted};

    #[test]
    fn a_line_holds_no_formula_in_any_field() {
        assert_eq!(csv_line(["A", "=1", "-2.5e-3", "b,c", ""]), "A,'=1,-2.5e-3,\"b,c\",\n");
    }

    #[test]
    fn a_text_is_no_formula_and_a_number_stays_one() {
        for (given, written) in [
            ("unit-7", "unit-7"),
            ("=1+1", "'=1+1"),
            ("+7", "+7"),
            ("-0.5", "-0.5"),
            ("-axis", "'-axis"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("  =A1", "  '=A1"),
            ("\t=A1", "\"'\t'=A1\""),
            ("\r=A1", "\"'\r'=A1\""),
            ("a;=A1", "\"a;'=A1\""),
            ("a\n=A1", "\"a\n'=A1\""),
            ("＝A1", "'＝A1"),
            ("=HYPERLINK(\"x\",\"y\")", "\"'=HYPERLINK(\"\"x\"\",\"\"y\"\")\""),
            ("", ""),
        ] {
            assert_eq!(quoted(given), written, "{given:?}");
        }
    }
}
