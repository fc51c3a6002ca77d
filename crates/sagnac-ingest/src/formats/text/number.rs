//! Numbers as text: the correctly rounded double, or why there is none.

/// Powers of ten that are exact in a double.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

use sagnac_core::numeric::range::usable;

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Field {
    /// A finite number.
    Value(f64),
    /// Nothing.
    Empty,
    /// NaN, infinity, or a number beyond 1e60.
    NonFinite,
    /// Something that is no number.
    Unparsable,
}

/// Reads a plain decimal number (`-12.345`) that starts at `at`; returns it with the position of its terminator, or
/// `None` when it is anything else (exponent, spaces, quotes, words, more than 19 digits). `BLANKS`: a tab ends it too.
///
/// A mantissa below 2^53 divided by an exact power of ten is rounded once, hence correctly (W. D. Clinger, How to read
/// floating point numbers accurately, 1990).
#[inline(always)]
pub fn plain_decimal<const DECIMAL: u8, const BLANKS: bool>(
    bytes: &[u8],
    at: usize,
    delimiter: u8,
) -> Option<(f64, usize)> {
    let byte = |i: usize| bytes.get(i).copied().unwrap_or(b'\n');
    let negative = byte(at) == b'-';
    let start = at + usize::from(negative);
    let mut i = start;
    let mut mantissa = 0u64;
    let mut c = byte(i);
    loop {
        let digit = c.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        i += 1;
        c = byte(i);
    }
    let mut digits = i - start;
    let mut decimals = 0;
    if c == DECIMAL {
        i += 1;
        let first = i;
        c = byte(i);
        loop {
            let digit = c.wrapping_sub(b'0');
            if digit > 9 {
                break;
            }
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            i += 1;
            c = byte(i);
        }
        decimals = i - first;
        digits += decimals;
    }
    let terminated = c == delimiter || c == b'\n' || c == b'\r' || (BLANKS && c == b'\t');
    if !terminated || digits == 0 || digits > 19 || mantissa >= 1 << 53 {
        return None;
    }
    // At most 19 digits, so the power is always there.
    let value = mantissa as f64 / POWERS.get(decimals).copied()?;
    Some((if negative { -value } else { value }, i))
}

/// Reads any field: spaces and one pair of quotes around it are allowed, exponents, a leading plus, `nan`, `inf`.
pub fn field(text: &[u8], decimal: u8) -> Field {
    let mut t = trim(text);
    if let Some(inner) = t.strip_prefix(b"\"").and_then(|r| r.strip_suffix(b"\"")) {
        t = trim(inner);
    }
    if t.is_empty() {
        return Field::Empty;
    }
    let unsigned = t.strip_prefix(b"-").or_else(|| t.strip_prefix(b"+")).unwrap_or(t);
    if [&b"nan"[..], b"inf", b"infinity"].iter().any(|w| unsigned.eq_ignore_ascii_case(w)) {
        return Field::NonFinite;
    }
    if !unsigned.first().is_some_and(|c| c.is_ascii_digit() || *c == decimal) {
        return Field::Unparsable;
    }
    let t = t.strip_prefix(b"+").unwrap_or(t);
    let parsed = if decimal == b'.' {
        fast_float2::parse::<f64, _>(t)
    } else if t.contains(&b'.') {
        return Field::Unparsable;
    } else {
        let dotted: Vec<u8> = t.iter().map(|&c| if c == decimal { b'.' } else { c }).collect();
        fast_float2::parse::<f64, _>(&dotted)
    };
    match parsed {
        Ok(v) if usable(v) => Field::Value(v),
        Ok(_) => Field::NonFinite,
        Err(_) => Field::Unparsable,
    }
}

fn trim(mut t: &[u8]) -> &[u8] {
    loop {
        let before = t.len();
        t = t.trim_ascii();
        // A no-break space, as spreadsheets write it.
        t = t.strip_prefix("\u{a0}".as_bytes()).unwrap_or(t);
        t = t.strip_suffix("\u{a0}".as_bytes()).unwrap_or(t);
        if t.len() == before {
            return t;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_way_to_write_a_number_is_read() {
        for (text, value) in [
            ("1", 1.0),
            ("-1.5", -1.5),
            ("+2.25", 2.25),
            ("  3 ", 3.0),
            ("\"4.5\"", 4.5),
            ("1e3", 1000.0),
            ("-1.5E-3", -0.0015),
            (".5", 0.5),
            ("5.", 5.0),
            ("1e60", 1e60),
            ("5e-324", 5e-324),
            ("0.08511601033439709", 0.085_116_010_334_397_09),
            ("\u{a0}7\u{a0}", 7.0),
        ] {
            assert_eq!(field(text.as_bytes(), b'.'), Field::Value(value), "{text}");
        }
        assert_eq!(field(b"1,5", b','), Field::Value(1.5));
        assert_eq!(field(b"-1,5e3", b','), Field::Value(-1500.0));
    }

    #[test]
    fn what_is_no_number_is_told_apart() {
        for text in ["", "  ", "\"\""] {
            assert_eq!(field(text.as_bytes(), b'.'), Field::Empty, "{text}");
        }
        for text in ["nan", "NaN", "-nan", "inf", "-Inf", "+INFINITY", "1e999", "1e61", "-1.8e308"] {
            assert_eq!(field(text.as_bytes(), b'.'), Field::NonFinite, "{text}");
        }
        for text in ["abc", "#N/A", "1,5", "1.5.2", "--1", "+-1", "0x10", "1 2", "-", "e5", "1e", "null"] {
            assert_eq!(field(text.as_bytes(), b'.'), Field::Unparsable, "{text}");
        }
        assert_eq!(field(b"1.234,5", b','), Field::Unparsable);
    }

    proptest! {
        #[test]
        fn the_fast_path_agrees_with_the_standard_library(
            negative: bool, whole in 0u64..2_000_000_000_000, fraction in 0u64..10_000_000, decimals in 1usize..12
        ) {
            let sign = if negative { "-" } else { "" };
            let text = format!("{sign}{whole}.{fraction:0decimals$},");
            if let Some((value, end)) = plain_decimal::<b'.', false>(text.as_bytes(), 0, b',') {
                prop_assert_eq!(end, text.len() - 1);
                prop_assert_eq!(value.to_bits(), text[..end].parse::<f64>().unwrap().to_bits());
            }
        }

        #[test]
        fn no_field_panics(bytes: Vec<u8>) {
            let _ = field(&bytes, b'.');
            let _ = field(&bytes, b',');
            let _ = plain_decimal::<b'.', false>(&bytes, 0, b',');
        }
    }
}
