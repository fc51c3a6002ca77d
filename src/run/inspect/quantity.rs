//! Quantities with a unit that reads well.

use crate::text::significant;

/// A rate, given in deg/h: in deg/s from 0.1 deg/s on.
pub(super) fn rate(deg_h: f64) -> String {
    if deg_h.abs() >= 360.0 {
        format!("{} deg/s", plain(deg_h / 3600.0, 4))
    } else {
        format!("{} deg/h", plain(deg_h, 4))
    }
}

/// Two rates, given in deg/h, in one unit.
pub(super) fn rates(low_deg_h: f64, high_deg_h: f64) -> (String, String, &'static str) {
    let (factor, unit) =
        if low_deg_h.abs().max(high_deg_h.abs()) >= 360.0 { (1.0 / 3600.0, "deg/s") } else { (1.0, "deg/h") };
    (plain(low_deg_h * factor, 4), plain(high_deg_h * factor, 4), unit)
}

/// A length of time, given in s.
pub(super) fn time(s: f64) -> String {
    match s {
        s if s.abs() >= 7200.0 => format!("{} h", plain(s / 3600.0, 4)),
        s if s.abs() >= 300.0 => format!("{} min", plain(s / 60.0, 4)),
        s if s == 0.0 || s.abs() >= 0.1 => format!("{} s", plain(s, 4)),
        s if s.abs() >= 1e-4 => format!("{} ms", plain(s * 1e3, 4)),
        s => format!("{} us", plain(s * 1e6, 3)),
    }
}

/// A length of time in s and in h.
pub(super) fn time_both(s: f64) -> String {
    format!("{} s ({} h)", plain(s, 4), plain(s / 3600.0, 3))
}

/// A number with significant digits and without idle zeros behind the point.
pub(super) fn plain(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let (mantissa, exponent) = match text.split_once('e') {
        Some((m, e)) => (m, format!("e{e}")),
        None => (text.as_str(), String::new()),
    };
    let mantissa =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    format!("{mantissa}{exponent}")
}

/// A count in groups of three.
pub(super) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(c);
    }
    out
}

/// Names joined for a sentence.
pub(super) fn names<'a>(list: impl Iterator<Item = &'a str>) -> String {
    list.map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ")
}
