//! Numbers as a report shows them: rounded by their uncertainty, with a true minus sign and powers of ten, in the
//! decimal mark of the language. Values are rounded for the eye only; decisions were made on the unrounded ones.

use super::unit::superscript;
use crate::i18n::{Lang, lookup, significant, with_decimals};

/// Shown where there is nothing to show.
pub const NOTHING: &str = "–";

/// An ASCII number (`-12345.6e-9`) in print: true minus, whole part in groups, decimal mark of the language, `×10ⁿ`.
pub fn typographic(ascii: &str, lang: Lang) -> String {
    let (mantissa, exponent) = match ascii.split_once(['e', 'E']) {
        Some((m, e)) => (m, Some(e)),
        None => (ascii, None),
    };
    let (sign, mantissa) = match mantissa.strip_prefix('-') {
        Some(rest) => ("−", rest),
        None => ("", mantissa),
    };
    let (whole, decimals) = match mantissa.split_once('.') {
        Some((whole, decimals)) => (whole, Some(decimals)),
        None => (mantissa, None),
    };
    let mut out = format!("{sign}{}", grouped(whole, lang));
    if let Some(decimals) = decimals {
        out.push_str(lookup(lang, "number.decimal").unwrap_or("."));
        out.push_str(decimals);
    }
    if let Some(exponent) = exponent {
        out.push_str(lookup(lang, "number.times").unwrap_or("×10"));
        out.push_str(&superscript(exponent));
    }
    out
}

/// A number with a count of significant digits.
pub fn digits(value: f64, count: usize, lang: Lang) -> String {
    typographic(&significant(value, count), lang)
}

/// A limit: every digit it was stated with (twelve significant ones, which hides the dust of unit conversion only).
pub fn limit(value: f64, lang: Lang) -> String {
    if !value.is_finite() {
        return NOTHING.to_owned();
    }
    let text = significant(value, 12);
    let (mantissa, exponent) = match text.split_once('e') {
        Some((m, e)) => (m, Some(e)),
        None => (text.as_str(), None),
    };
    let short =
        if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    match exponent {
        Some(e) => typographic(&format!("{short}e{e}"), lang),
        None => typographic(short, lang),
    }
}

/// A bound rounded away from the better side to three digits: upwards for an upper bound, downwards for a lower one.
pub fn bound(value: f64, upwards: bool, lang: Lang) -> String {
    directed(value, 3, upwards, lang)
}

/// An acceptance limit: four digits, rounded towards the inside so that what is printed is never too generous.
pub fn acceptance(value: f64, is_maximum: bool, lang: Lang) -> String {
    directed(value, 4, !is_maximum, lang)
}

fn directed(value: f64, count: i32, upwards: bool, lang: Lang) -> String {
    if value == 0.0 || !value.is_finite() {
        return digits(value, 1, lang);
    }
    let exponent = value.abs().log10().floor() as i32;
    let scale = 10f64.powi(count - 1 - exponent);
    let scaled = value * scale;
    if !scaled.is_finite() || scale == 0.0 {
        return digits(value, count as usize, lang);
    }
    // A value that stands on its digits already, but for the last bit, keeps them.
    let nearest = scaled.round();
    let whole = if (scaled - nearest).abs() < 1e-9 * nearest.abs().max(1.0) {
        nearest
    } else if upwards {
        scaled.ceil()
    } else {
        scaled.floor()
    };
    limit(whole / scale, lang)
}

/// Least side of a lopsided interval that sets the rounding, as a share of the value.
const MIN_SIDE_SHARE: f64 = 0.01;

/// How the numbers of one row are rounded: all to the same place, set by the uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rounding {
    /// Decimals of the mantissa.
    decimals: usize,
    /// Place that is rounded to, as a power of ten.
    place: i32,
    /// Power of ten taken out, 0 for plain numbers.
    exponent: i32,
}

impl Rounding {
    /// Rounds to two significant digits of the half-width of the interval, or of its shorter side where that is less
    /// than half of it: a long tail on one side must not round the value away.
    ///
    /// Without a usable interval the value keeps four significant digits.
    pub fn of(value: f64, interval: Option<(f64, f64)>) -> Rounding {
        let half = interval.map(|(low, high)| 0.5 * (high - low)).filter(|h| h.is_finite() && *h > 0.0);
        let shorter = interval.map(|(low, high)| (value - low).min(high - value));
        let half = half.map(|h| match shorter.map(|s| s.max(MIN_SIDE_SHARE * value.abs())) {
            Some(s) if s > 0.0 && s < 0.5 * h => s,
            _ => h,
        });
        let size = value.abs().max(interval.map_or(0.0, |(l, h)| l.abs().max(h.abs())));
        let place = match half {
            // Rounding may carry (0.0996 to 0.10), so the exponent is read from the rounded text.
            Some(h) => decimal_exponent(h, 1) - 1,
            None => decimal_exponent(value, 3) - 3,
        };
        let top = decimal_exponent(size, 3);
        let exponent = if place < -9 || top >= 7 { top } else { 0 };
        Rounding { decimals: (exponent - place).clamp(0, 15) as usize, place, exponent }
    }

    /// A number in this rounding.
    pub fn show(&self, value: f64, lang: Lang) -> String {
        if !value.is_finite() {
            return NOTHING.to_owned();
        }
        // Places above the units have no decimals to round by.
        let value = if self.place > 0 {
            let unit = 10f64.powi(self.place);
            let rounded = (value / unit).round() * unit;
            if rounded.is_finite() { rounded } else { value }
        } else {
            value
        };
        let scaled = value / 10f64.powi(self.exponent);
        if !scaled.is_finite() {
            return digits(value, 4, lang);
        }
        let mantissa = format!("{:.*}", self.decimals, scaled);
        let zero = mantissa.chars().all(|c| matches!(c, '-' | '0' | '.'));
        let mantissa = if zero { mantissa.trim_start_matches('-') } else { &mantissa };
        if self.exponent == 0 || zero {
            typographic(mantissa, lang)
        } else {
            typographic(&format!("{mantissa}e{}", self.exponent), lang)
        }
    }
}

fn decimal_exponent(value: f64, decimals: usize) -> i32 {
    if value == 0.0 || !value.is_finite() {
        return 0;
    }
    format!("{value:.decimals$e}").split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0)
}

/// A probability in percent; what is near 0 or 1 shows as a bound, for no risk is exactly nil.
pub fn percent(probability: f64, lang: Lang) -> String {
    if !probability.is_finite() {
        return NOTHING.to_owned();
    }
    let p = 100.0 * probability.clamp(0.0, 1.0);
    let text = if p < 0.01 {
        format!("< {}", typographic("0.01", lang))
    } else if p > 99.99 {
        format!("> {}", typographic("99.99", lang))
    } else {
        let decimals = if !(1.0..=99.0).contains(&p) { 2 } else { usize::from(!(10.0..=90.0).contains(&p)) };
        // A stated risk of 5 % is a whole number and reads as one.
        let whole = (p - p.round()).abs() < 1e-9;
        typographic(&format!("{p:.0$}", if whole { 0 } else { decimals }), lang)
    };
    format!("{text}\u{202f}%")
}

/// A count in groups of three figures.
pub fn count(value: u64, lang: Lang) -> String {
    grouped(&value.to_string(), lang)
}

/// Five and more figures in groups of three; what is no row of figures stays as it is.
fn grouped(figures: &str, lang: Lang) -> String {
    if figures.len() < 5 || !figures.bytes().all(|b| b.is_ascii_digit()) {
        return figures.to_owned();
    }
    let group = lookup(lang, "number.group").unwrap_or("\u{202f}");
    let mut out = String::with_capacity(2 * figures.len());
    for (i, c) in figures.chars().enumerate() {
        if i > 0 && (figures.len() - i).is_multiple_of(3) {
            out.push_str(group);
        }
        out.push(c);
    }
    out
}

/// Gives the numbers of a column equal decimals: zeros are added to those that have fewer.
pub fn align(column: Vec<&mut String>, lang: Lang) {
    let mark = lookup(lang, "number.decimal").unwrap_or(".");
    let times = lookup(lang, "number.times").unwrap_or("×10");
    let decimals = |text: &str| text.split_once(mark).map_or(0, |(_, decimals)| decimals.len());
    let most = column.iter().map(|text| decimals(text)).max().unwrap_or(0);
    if column.iter().any(|text| text.contains(times)) {
        return;
    }
    for text in column.into_iter().filter(|text| !text.is_empty()) {
        let missing = most - decimals(text);
        if missing > 0 && missing == most {
            text.push_str(mark);
        }
        text.push_str(&"0".repeat(missing));
    }
}

/// A span of time in the units that suit it: `9 h 29 min 59 s`, `30 min`, `12.005 s`, `1.3 µs`.
pub fn duration(seconds: f64, lang: Lang) -> String {
    if !seconds.is_finite() {
        return NOTHING.to_owned();
    }
    let size = seconds.abs();
    if (120.0..1e12).contains(&size) {
        let tenths = (size * 10.0).round() as u64;
        let parts = [(tenths / 36_000, "h"), (tenths / 600 % 60, "min")];
        let mut out: Vec<String> = parts
            .iter()
            .filter(|(n, _)| *n > 0)
            .map(|(n, unit)| format!("{}\u{202f}{}", count(*n, lang), super::unit::pretty(unit, lang)))
            .collect();
        let rest = tenths % 600;
        if rest > 0 {
            let rest = limit_digits(rest as f64 / 10.0, 3, lang);
            out.push(format!("{rest}\u{202f}{}", super::unit::pretty("s", lang)));
        }
        let sign = if seconds < 0.0 { "−" } else { "" };
        return format!("{sign}{}", out.join(" "));
    }
    let (factor, unit) = if size >= 1.0 || size == 0.0 {
        (1.0, "s")
    } else if size >= 1e-3 {
        (1e-3, "ms")
    } else {
        (1e-6, "us")
    };
    format!("{}\u{202f}{}", limit_digits(seconds / factor, 5, lang), super::unit::pretty(unit, lang))
}

/// Up to so many significant digits, with trailing zeros left out.
pub fn limit_digits(value: f64, count: usize, lang: Lang) -> String {
    let text = significant(value, count);
    if text.contains('.') && !text.contains('e') {
        typographic(text.trim_end_matches('0').trim_end_matches('.'), lang)
    } else {
        typographic(&text, lang)
    }
}

/// A number with so many decimals, or at most so many where zeros that say nothing are left out.
pub fn decimals(value: f64, count: usize, zeros: bool, lang: Lang) -> String {
    if !value.is_finite() {
        return NOTHING.to_owned();
    }
    let text = with_decimals(value, count);
    let short =
        if !zeros && text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    // What was rounded to zero has no sign.
    let zero = short.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    typographic(if zero { short.trim_start_matches('-') } else { short }, lang)
}

/// An RFC 3339 stamp as `2026-11-21 04:23:29 UTC`; any other text as it is.
pub fn date_time(stamp: &str) -> String {
    match chrono::DateTime::parse_from_rfc3339(stamp) {
        Ok(t) => t.to_utc().format("%Y-%m-%d %H:%M:%S UTC").to_string(),
        Err(_) => stamp.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EN: Lang = Lang::En;

    #[test]
    fn values_are_rounded_by_their_uncertainty() {
        let r = Rounding::of(0.002_314_9, Some((0.002_291_2, 0.002_338_7)));
        assert_eq!(r.show(0.002_314_9, EN), "0.002315");
        assert_eq!(r.show(0.002_291_2, EN), "0.002291");
        let r = Rounding::of(123_456.0, Some((120_000.0, 127_000.0)));
        assert_eq!(r.show(123_456.0, EN), "123\u{202f}500");
        let r = Rounding::of(-0.04, Some((-0.14, 0.06)));
        assert_eq!(r.show(-0.004, EN), "0.00");
        assert_eq!(r.show(-0.14, EN), "−0.14");
    }

    #[test]
    fn small_values_share_one_power_of_ten() {
        let r = Rounding::of(2.31e-8, Some((2.1e-8, 2.5e-8)));
        assert_eq!(r.show(2.31e-8, EN), "2.31×10⁻⁸");
        assert_eq!(r.show(2.1e-9, EN), "0.21×10⁻⁸");
    }

    #[test]
    fn a_carry_in_the_uncertainty_moves_the_place() {
        // The half-width 0.0996 is 0.10 in two digits, so the value has two decimals.
        assert_eq!(Rounding::of(1.0, Some((0.9004, 1.0996))).show(1.0, EN), "1.00");
    }

    #[test]
    fn a_long_tail_does_not_round_the_value_away() {
        let r = Rounding::of(0.448, Some((0.31, 3700.0)));
        assert_eq!([0.448, 0.31, 3700.0].map(|v| r.show(v, EN)), ["0.45", "0.31", "3700.00"]);
        // A value at the end of its interval keeps four digits.
        let r = Rounding::of(7.5, Some((7.5, 250.0)));
        assert_eq!(r.show(7.5, EN), "7.500");
    }

    #[test]
    fn no_number_is_too_odd_to_print() {
        let odd =
            [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, 5e-324, -5e-324, f64::MAX, f64::MIN];
        for v in odd {
            for w in odd {
                let r = Rounding::of(v, Some((w, v)));
                for text in [r.show(v, EN), r.show(w, EN), bound(v, true, EN), acceptance(v, false, EN)] {
                    let fine = |c: char| c.is_ascii_digit() || ".−–×⁻⁰¹²³⁴⁵⁶⁷⁸⁹\u{202f}".contains(c);
                    assert!(!text.is_empty() && text.chars().all(fine), "{v} {w}: {text}");
                }
            }
            for text in [percent(v, EN), duration(v, EN), digits(v, 4, EN), limit(v, EN)] {
                assert!(!text.contains("inf") && !text.contains("NaN"), "{v}: {text}");
            }
        }
    }

    #[test]
    fn numbers_of_a_column_have_equal_decimals() {
        let aligned = |mut column: [String; 3], lang| {
            align(column.iter_mut().collect(), lang);
            column
        };
        assert_eq!(aligned(["5", "−0.1", ""].map(str::to_owned), EN), ["5.0", "−0.1", ""]);
        assert_eq!(aligned(["1,25", "0,5", "3"].map(str::to_owned), Lang::Ru), ["1,25", "0,50", "3,00"]);
        assert_eq!(aligned(["1", "2", "3"].map(str::to_owned), EN), ["1", "2", "3"]);
        assert_eq!(aligned(["1×10⁻⁹", "2", "0.5"].map(str::to_owned), EN), ["1×10⁻⁹", "2", "0.5"]);
    }

    #[test]
    fn limits_keep_every_digit() {
        assert_eq!(limit(0.003, EN), "0.003");
        assert_eq!(limit(0.1 + 0.2, EN), "0.3");
        assert_eq!(limit(12.345_678_9, EN), "12.3456789");
        assert_eq!(limit(1.5e-9, EN), "1.5×10⁻⁹");
        assert_eq!(limit(100.0, EN), "100");
        assert_eq!(limit(f64::INFINITY, EN), "–");
    }

    #[test]
    fn bounds_are_rounded_to_the_safe_side() {
        assert_eq!(bound(0.001_231, true, EN), "0.00124");
        assert_eq!(bound(0.001_23, true, EN), "0.00123");
        assert_eq!(acceptance(0.002_983_49, true, EN), "0.002983");
        assert_eq!(acceptance(0.002_983_41, false, EN), "0.002984");
        assert_eq!(acceptance(-0.002_983_41, true, EN), "−0.002984");
    }

    #[test]
    fn risks_near_nil_show_as_bounds() {
        assert_eq!(percent(0.0, EN), "< 0.01\u{202f}%");
        assert_eq!(percent(1.0, EN), "> 99.99\u{202f}%");
        assert_eq!(percent(0.0231, EN), "2.3\u{202f}%");
        assert_eq!(percent(0.5, EN), "50\u{202f}%");
        assert_eq!(percent(0.00031, EN), "0.03\u{202f}%");
    }

    #[test]
    fn counts_times_and_dates() {
        assert_eq!(count(36_000_000, EN), "36\u{202f}000\u{202f}000");
        assert_eq!(count(3600, EN), "3600");
        // Numbers that are not counts are grouped alike.
        assert_eq!(limit(-81_920.5, EN), "−81\u{202f}920.5");
        assert_eq!(limit_digits(10_000.0, 6, EN), "10\u{202f}000");
        assert_eq!(decimals(-0.004, 2, false, EN), "0");
        assert_eq!(decimals(-1.50, 2, false, EN), "−1.5");
        assert_eq!(decimals(-1.50, 2, true, Lang::Ru), "−1,50");
        assert_eq!(digits(12_345.0, 6, Lang::Ru), "12\u{202f}345,0");
        assert_eq!(duration(36_000.0, EN), "10\u{202f}h");
        assert_eq!(duration(34_199.0, EN), "9\u{202f}h 29\u{202f}min 59\u{202f}s");
        assert_eq!(duration(-1800.5, EN), "−30\u{202f}min 0.5\u{202f}s");
        assert_eq!(duration(0.01, EN), "10\u{202f}ms");
        assert_eq!(date_time("2026-11-21T04:23:29Z"), "2026-11-21 04:23:29 UTC");
        assert_eq!(date_time("2026-11-21T04:23:29+03:00"), "2026-11-21 01:23:29 UTC");
        assert_eq!(date_time("unknown"), "unknown");
    }
}
