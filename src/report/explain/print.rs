//! Values, places and probabilities as an explanation prints them.

use crate::effect::{self, Domain, find};
use crate::i18n::{EffectText, effect_text, lookup};
use crate::mismatch::finding::{MismatchVerdict, ParameterValue, PlaceRecord};
use crate::report::number::{Rounding, digits, limit_digits, typographic};
use crate::report::translator::Translator;

/// Ratio of the sides of an interval from which it is printed by its ends.
const MAX_SIDE_RATIO: f64 = 1.5;
/// Log-likelihoods beyond are printed with a power of ten.
const MAX_PLAIN_LOG_LIKELIHOOD: f64 = 1e9;
/// Share of the recording that counts as the whole of it.
const WHOLE_RECORD_SHARE: f64 = 0.97;

/// Title of a kind.
pub fn title(kind: &str, words: Translator) -> String {
    match find(kind) {
        Some(effect) => effect_text(effect.kind(), EffectText::Title, words.lang).to_owned(),
        None if kind == "unknown" => words.t("explain.unknown_cause"),
        None => kind.replace('_', " "),
    }
}

/// The text with a capital.
pub fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map(|c| c.to_uppercase().chain(chars).collect()).unwrap_or_default()
}

/// Class of a verdict, for colours, and its word.
pub fn verdict(verdict: MismatchVerdict, words: Translator) -> (&'static str, String) {
    match verdict {
        MismatchVerdict::Consistent => ("pass", words.t("explain.verdict.consistent")),
        MismatchVerdict::Mismatch => ("indeterminate", words.t("explain.verdict.mismatch")),
        MismatchVerdict::UnknownMismatch => ("fail", words.t("explain.verdict.unknown")),
    }
}

/// Name of a parameter; as the file has it where the tables lack it.
pub fn parameter(name: &str, words: Translator) -> String {
    lookup(words.lang, &format!("parameter.{name}")).unwrap_or(name).to_owned()
}

/// Name of a value that the claim states.
pub fn stated(name: &str, words: Translator) -> String {
    let last = name.rsplit('.').next().unwrap_or(name);
    let text = lookup(words.lang, &format!("stated.{last}"));
    text.map_or_else(|| parameter(last, words), str::to_owned)
}

/// Name of a test.
pub fn test(id: &str, words: Translator) -> String {
    words.name("explain.test", id)
}

/// Name of a view.
pub fn view(domain: Domain, words: Translator) -> String {
    words.name("explain.view", domain.id())
}

/// A parameter, printed in parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Printed {
    /// The value.
    pub value: String,
    /// The interval: ends.
    pub interval: String,
    /// Value, uncertainty and unit as a sentence has them.
    pub whole: String,
}

/// Prints a parameter, rounded by its interval.
pub fn value(name: &str, p: &ParameterValue, words: Translator) -> Printed {
    let lang = words.lang;
    let [low, high] = p.ci95;
    let usable = low.is_finite() && high.is_finite() && high > low;
    let param = effect::parameter(name);
    if param.is_some_and(|p| p.whole) {
        let shown = |v: f64| limit_digits(if v.is_finite() { v.round() } else { v }, 12, lang);
        let interval = if usable { between(&shown(low), &shown(high), words) } else { String::new() };
        return Printed { whole: shown(p.value), value: shown(p.value), interval };
    }
    let rounding = Rounding::of(p.value, usable.then_some((low, high)));
    let plus = if param.is_some_and(|p| p.signed) && p.value > 0.0 { "+" } else { "" };
    let shown = format!("{plus}{}", rounding.show(p.value, lang));
    if !usable {
        return Printed { whole: words.quantity(&shown, &p.unit), value: shown, interval: String::new() };
    }
    let (below, above) = (p.value - low, high - p.value);
    let even = below > 0.0 && above > 0.0 && below.max(above) < MAX_SIDE_RATIO * below.min(above);
    let interval = between(&rounding.show(low, lang), &rounding.show(high, lang), words);
    let whole = if even {
        let half = rounding.show(0.5 * (high - low), lang);
        words.quantity(&words.with("explain.plus_minus", &[("value", &shown), ("half", &half)]), &p.unit)
    } else {
        let whole = words.quantity(&shown, &p.unit);
        words.with("explain.with_interval", &[("value", &whole), ("interval", &interval)])
    };
    Printed { value: shown, interval, whole }
}

fn between(low: &str, high: &str, words: Translator) -> String {
    words.with("report.interval", &[("low", low), ("high", high)])
}

/// The ends of a place with their unit.
pub fn ends(place: &PlaceRecord, words: Translator) -> String {
    let unit = place.domain.unit();
    let (from, to) = (place.from, place.to);
    let text = if from == to {
        limit_digits(from, 6, words.lang)
    } else {
        // Ends far apart keep digits of their own: those of the upper one would round the lower one away.
        let apart = from >= 0.0 && to > 2.0 * from;
        let rounding = Rounding::of(0.5 * (from + to), Some((from, to)));
        let shown = |v: f64| {
            if !apart {
                rounding.show(v, words.lang)
            } else if v != 0.0 && v < 1e-3 {
                typographic(&format!("{v:.2e}"), words.lang)
            } else {
                limit_digits(v, 3, words.lang)
            }
        };
        between(&shown(from), &shown(to), words)
    };
    words.quantity(&text, unit)
}

/// Where a mismatch shows, as a phrase.
pub fn place(place: &PlaceRecord, length_s: f64, words: Translator) -> String {
    if place.domain == Domain::Time
        && place.to - place.from >= WHOLE_RECORD_SHARE * length_s
        && length_s > 0.0
    {
        return words.t("explain.where.whole");
    }
    words.with(&format!("explain.where.{}", place.domain.id()), &[("place", &ends(place, words))])
}

/// A probability under chance: two digits, with a power of ten below a thousandth, and a bound where it is nil.
pub fn chance(p: f64, words: Translator) -> String {
    if !p.is_finite() {
        return crate::report::number::NOTHING.to_owned();
    }
    if p < 1e-300 {
        return format!("< {}", typographic("1e-300", words.lang).replace("1×", ""));
    }
    if p >= 1e-3 { limit_digits(p, 2, words.lang) } else { typographic(&format!("{p:.0e}"), words.lang) }
}

/// A difference of log-likelihoods or BICs: one decimal, with its sign.
pub fn difference(v: f64, words: Translator) -> String {
    if !v.is_finite() {
        return crate::report::number::NOTHING.to_owned();
    }
    if v.abs() >= MAX_PLAIN_LOG_LIKELIHOOD {
        return digits(v, 3, words.lang);
    }
    let decimals = usize::from(v.abs() < 1000.0);
    let text = format!("{v:+.decimals$}");
    let nil = text.trim_start_matches(['+', '-']).chars().all(|c| matches!(c, '0' | '.'));
    typographic(if nil { text.trim_start_matches(['+', '-']) } else { &text }, words.lang)
}

/// A log-likelihood or BIC: one decimal.
pub fn plain(v: f64, words: Translator) -> String {
    if v.abs() < MAX_PLAIN_LOG_LIKELIHOOD {
        typographic(&format!("{v:.1}"), words.lang)
    } else {
        digits(v, 3, words.lang)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::i18n::Lang;

    const EN: Translator = Translator { lang: Lang::En };

    fn given(value: f64, low: f64, high: f64, unit: &str) -> ParameterValue {
        ParameterValue { value, unit: unit.into(), ci95: [low, high] }
    }

    #[test]
    fn parameters_are_rounded_by_their_intervals() {
        let step = value("step_deg_h", &given(0.031_23, 0.029_0, 0.033_4, "deg/h"), EN);
        assert_eq!(step.whole, "+0.0312 ± 0.0022\u{202f}°/h");
        assert_eq!(step.interval, "0.0290 … 0.0334");
        let lopsided = value("time_constant_s", &given(900.0, 700.0, 1500.0, "s"), EN);
        assert_eq!(lopsided.whole, "900\u{202f}s (95 %: 700 … 1500)");
        let exact = value("missing_rows", &given(12_345.0, 12_345.0, 12_345.0, ""), EN);
        assert_eq!((exact.whole.as_str(), exact.interval.as_str()), ("12\u{202f}345", ""));
        let unknown = value("x", &given(1.5, f64::NAN, f64::NAN, "Hz"), EN);
        assert_eq!(unknown.whole, "1.500\u{202f}Hz");
    }

    #[test]
    fn places_keep_the_digits_that_tell_their_ends() {
        let at = |domain: Domain, from: f64, to: f64| ends(&PlaceRecord { domain, from, to }, EN);
        assert_eq!(at(Domain::Frequency, 0.4118, 0.4124), "0.41180 … 0.41240\u{202f}Hz");
        assert_eq!(at(Domain::Frequency, 1.234e-4, 5.0), "1.23×10⁻⁴ … 5\u{202f}Hz");
        assert_eq!(at(Domain::Frequency, 0.0, 5.6e-5), "0 … 5.60×10⁻⁵\u{202f}Hz");
        assert_eq!(at(Domain::Temperature, -12.0, 41.0), "−12 … 41\u{202f}°C");
        assert_eq!(at(Domain::Time, 5100.0, 5300.0), "5100 … 5300\u{202f}s");
        let whole = PlaceRecord { domain: Domain::Time, from: 0.0, to: 35_999.0 };
        assert_eq!(place(&whole, 36_000.0, EN), EN.t("explain.where.whole"));
    }

    #[test]
    fn chances_near_nil_keep_their_power() {
        assert_eq!(chance(0.4321, EN), "0.43");
        assert_eq!(chance(2.2e-40, EN), "2×10⁻⁴⁰");
        assert_eq!(chance(0.0, EN), "< 10⁻³⁰⁰");
        assert_eq!(difference(212.44, EN), "+212.4");
        assert_eq!(difference(-0.001, EN), "0.0");
        assert_eq!(difference(-1234.5, EN), "−1234");
        assert_eq!(difference(-5e29, EN), "−5.00×10²⁹");
    }
}
