//! Names and numbers of a plan, printed.

use crate::i18n::{EffectText, effect_text};
use crate::report::number::percent;
use crate::report::translator::Translator;

/// Title of an effect.
pub(super) fn title(kind: &str, words: Translator) -> String {
    effect_text(kind, EffectText::Title, words.lang).to_owned()
}

/// A probability; what an approximation gives beyond a few digits is not shown.
pub(super) fn chance(probability: f64, words: Translator) -> String {
    match probability {
        p if p > 0.995 => words.t("plan.nearly_sure"),
        p if p < 0.005 => words.t("plan.hardly_ever"),
        p => percent((p * 100.0).round() / 100.0, words.lang),
    }
}

/// A probability that other explanations than those planned for can only lower.
pub(super) fn at_most(probability: f64, words: Translator) -> String {
    let percent = percent((probability * 100.0).ceil() / 100.0, words.lang);
    words.with("plan.at_most", &[("percent", &percent)])
}
