//! How an explanation is found: words and formulas.

use crate::report::translator::Translator;
use serde::Serialize;

/// One paragraph of the method.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodView {
    /// Translator.
    pub text: String,
    /// Formulas.
    pub formulas: Vec<String>,
    /// Source.
    pub source: &'static str,
}

struct Method {
    text: &'static str,
    formulas: &'static [&'static str],
    source: &'static str,
}

const METHODS: &[Method] = &[
    Method {
        text: "explain.method.mean",
        formulas: &[
            "m(t) = b + a·(T(t) − T₀) + 3600·(1 + 10⁻⁶·ε)·Ω(t) + 15.041067·cos φ·cos(α(t) + α₀)",
            "S(f) = 3600·N² + B²/(2πf) + K²/[3600·(2πf)²]",
        ],
        source: "IEEE Std 952",
    },
    Method {
        text: "explain.method.likelihood",
        formulas: &["ln L = −½·Σₖ [ln(2π·Pₖ) + yₖ²/Pₖ],  y = DCT(r − m)"],
        source: "Whittle 1953",
    },
    Method {
        text: "explain.method.selection",
        formulas: &["BIC = −2·ln L + k·ln n"],
        source: "Schwarz 1978",
    },
    Method { text: "explain.method.family", formulas: &[], source: "Bonferroni 1936" },
];

/// All paragraphs.
pub(super) fn all(words: Translator) -> Vec<MethodView> {
    METHODS
        .iter()
        .map(|m| MethodView {
            text: words.t(m.text),
            formulas: m.formulas.iter().map(|f| words.formula(f)).collect(),
            source: m.source,
        })
        .collect()
}
