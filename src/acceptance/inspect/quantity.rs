//! Quantities with a unit that reads well.

use crate::i18n::{Arg, Note, note};
use crate::units::RateUnit;

fn amount(key: &'static str, value: f64, digits: usize) -> Arg {
    Note::new(key).with("value", plain(value, digits)).into()
}

/// A rate, given in deg/h: in deg/s from 0.1 deg/s on.
pub(super) fn rate(deg_h: f64) -> Arg {
    let unit = RateUnit::up_to(deg_h);
    unit.with(plain(unit.of(deg_h), 4))
}

/// Two rates, given in deg/h, in one unit.
pub(super) fn rates(low_deg_h: f64, high_deg_h: f64) -> (Arg, Arg, Arg) {
    let unit = RateUnit::up_to(low_deg_h.abs().max(high_deg_h.abs()));
    (plain(unit.of(low_deg_h), 4), plain(unit.of(high_deg_h), 4), Note::new(unit.name()).into())
}

/// A length of time, given in s.
pub(super) fn time(s: f64) -> Arg {
    match s {
        s if s.abs() >= 7200.0 => amount("amount.h", s / 3600.0, 4),
        s if s.abs() >= 300.0 => amount("amount.min", s / 60.0, 4),
        s if s == 0.0 || s.abs() >= 0.1 => amount("amount.s", s, 4),
        s if s.abs() >= 1e-4 => amount("amount.ms", s * 1e3, 4),
        s => amount("amount.us", s * 1e6, 3),
    }
}

/// A length of time in s and in h.
pub(super) fn time_both(s: f64) -> Arg {
    note!("amount.s_and_h", s = plain(s, 4), h = plain(s / 3600.0, 3)).into()
}

/// A number with significant digits and without idle zeros behind the decimal mark.
pub(super) fn plain(value: f64, digits: usize) -> Arg {
    Arg::rounded(value, digits)
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
