//! What a reader learns of an effect: the entries of `effect.<kind>` in the locale tables.

use super::{Lang, lookup};

/// One text of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectText {
    /// Name in a sentence, without a capital: `bias step`.
    Title,
    /// What the verdict says was found; its places are parameters of the finding and `claimed`.
    Phrase,
    /// What happens in the instrument or around it.
    Mechanism,
    /// The forward model as a formula.
    Formula,
    /// How it shows in each view.
    Signature,
    /// What tells it from its nearest confusers.
    Distinguishing,
    /// The experiment that would confirm it.
    Confirm,
    /// Source.
    Source,
}

impl EffectText {
    /// Every text, in the order of the tables.
    pub const ALL: &'static [EffectText] = &[
        EffectText::Title,
        EffectText::Phrase,
        EffectText::Mechanism,
        EffectText::Formula,
        EffectText::Signature,
        EffectText::Distinguishing,
        EffectText::Confirm,
        EffectText::Source,
    ];

    /// Its key under `effect.<kind>`.
    pub fn id(self) -> &'static str {
        match self {
            EffectText::Title => "title",
            EffectText::Phrase => "phrase",
            EffectText::Mechanism => "mechanism",
            EffectText::Formula => "formula",
            EffectText::Signature => "signature",
            EffectText::Distinguishing => "distinguishing",
            EffectText::Confirm => "confirm",
            EffectText::Source => "source",
        }
    }
}

/// The key of a text of the effect of that kind.
pub fn effect_key(kind: &str, text: EffectText) -> String {
    format!("effect.{kind}.{}", text.id())
}

/// A text of the effect of that kind; empty where no table has it.
pub fn effect_text(kind: &str, text: EffectText, lang: Lang) -> &'static str {
    lookup(lang, &effect_key(kind, text)).unwrap_or_default()
}
