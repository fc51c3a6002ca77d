//! What is said of an effect, in both languages.

/// A text in English and Russian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Both {
    /// English.
    pub en: &'static str,
    /// Russian.
    pub ru: &'static str,
}

impl Both {
    /// A text without words, the same in every language.
    pub const fn same(text: &'static str) -> Both {
        Both { en: text, ru: text }
    }
}

/// What an effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Doc {
    /// Name as a reader of reports meets it, without a capital: `bias step`.
    pub title: Both,
    /// What happens in the instrument or around it.
    pub mechanism: Both,
    /// The forward model as a formula.
    pub formula: Both,
    /// How it shows in each view.
    pub signature: Both,
    /// What tells it from its nearest confusers.
    pub told_by: Both,
    /// The experiment that would confirm it.
    pub confirm: Both,
    /// Source.
    pub source: &'static str,
}
