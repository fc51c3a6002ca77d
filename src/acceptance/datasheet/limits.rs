//! Limits that a lot can keep, as a limits file.

use crate::measurand;
use crate::record::{DataSheet, SheetOf, SheetQuantity, SheetSide};
use std::fmt::Write;

/// Digits of a limit.
const LIMIT_DIGITS: i32 = 3;

/// The text of a limits file: of every quantity that limits files know, the bounds for measured values, rounded outwards.
/// `comment` stands at its head.
pub fn limits_file(sheet: &DataSheet, comment: &str) -> String {
    let mut out = String::new();
    for line in comment.lines() {
        let _ = writeln!(out, "# {line}");
    }
    let model = sheet.model.clone().unwrap_or_else(|| sheet.procedure.id.clone());
    let id: String =
        model.to_lowercase().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let id = id.trim_matches('-');
    let _ = write!(
        out,
        "\nformat = \"limits/1\"\n\n[limits]\nid = {}\ntitle = {}\nrevision = \"proposal\"\nsource = {}\n",
        quoted(if id.is_empty() { "lot" } else { id }),
        quoted(if model.is_empty() { "lot" } else { &model }),
        quoted(&format!("{} units, {} lots", sheet.units, sheet.lots)),
    );
    let channels: Vec<&str> = sheet.quantities.iter().map(|q| q.channel.as_str()).collect();
    let several = |q: &SheetQuantity| {
        sheet.quantities.iter().filter(|o| o.id == q.id && o.phase == q.phase).count() > 1
            && !channels.is_empty()
    };
    for q in sheet.quantities.iter().filter(|q| q.phase.is_none() && measurand::find(&q.id).is_some()) {
        let at = |side: SheetSide| {
            q.bounds.iter().find(|b| b.of == SheetOf::Measured && b.side == side).map(|b| b.value)
        };
        let Some(max) = at(SheetSide::Upper) else { continue };
        let _ = write!(out, "\n[[limit]]\nmeasurand = {}\n", quoted(&q.id));
        if several(q) {
            let _ = writeln!(out, "channel = {}", quoted(&q.channel));
        }
        if let Some(min) = at(SheetSide::Lower) {
            let _ = writeln!(out, "min = {}", quoted(&quantity(outwards(min, false), &q.unit)));
        }
        let _ = writeln!(out, "max = {}", quoted(&quantity(outwards(max, true), &q.unit)));
    }
    out
}

fn quantity(value: f64, unit: &str) -> String {
    format!("{value} {unit}").trim_end().to_owned()
}

/// A value rounded to a few digits, away from what it bounds.
fn outwards(value: f64, up: bool) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let places = LIMIT_DIGITS - 1 - value.abs().log10().floor() as i32;
    let scaled = value * 10f64.powi(places);
    let whole = if up { (scaled - 1e-9).ceil() } else { (scaled + 1e-9).floor() };
    // Through text, so that no dust of the division is left.
    format!("{whole}e{}", -places).parse().unwrap_or(value)
}

/// A basic string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_rounded_away_from_what_they_bound() {
        assert_eq!(outwards(0.0026041, true), 0.00261);
        assert_eq!(outwards(0.0026, true), 0.0026);
        assert_eq!(outwards(-0.12345, false), -0.124);
        assert_eq!(outwards(-0.12345, true), -0.123);
        assert_eq!(outwards(1234.5, true), 1240.0);
        assert_eq!(outwards(0.0, true), 0.0);
    }

    #[test]
    fn texts_cannot_leave_their_quotes() {
        assert_eq!(quoted("a\"b\\c"), "'a\"b\\c'");
        assert!(toml::from_str::<toml::Table>(&format!("x = {}", quoted("a\"'b\n\u{1}"))).is_ok());
    }
}
