//! How an explanation is found: words and formulas.

use crate::report::page::{Block, Method};
use crate::report::translator::Translator;

/// Text, formulas and source of each part of the method.
const METHODS: &[(&str, &[&str], &str)] = &[
    (
        "explain.method.mean",
        &[
            "m(t) = b + a·(T(t) − T₀) + 3600·(1 + 10⁻⁶·ε)·Ω(t) + 15.041067·cos φ·cos(α(t) + α₀)",
            "S(f) = 3600·N² + B²/(2πf) + K²/[3600·(2πf)²]",
        ],
        "IEEE Std 952",
    ),
    ("explain.method.likelihood", &["ln L = −½·Σₖ [ln(2π·Pₖ) + yₖ²/Pₖ],  y = DCT(r − m)"], "Whittle 1953"),
    ("explain.method.selection", &["BIC = −2·ln L + k·ln n"], "Schwarz 1978"),
    ("explain.method.family", &[], "Bonferroni 1936"),
];

/// The parts of the method, a block each.
pub(super) fn blocks(words: Translator) -> Vec<Block> {
    let block = |(text, formulas, source): &(&str, &[&str], &str)| {
        Block::Method(Method {
            title: String::new(),
            formulas: formulas.iter().map(|f| words.formula(f)).collect(),
            text: words.t(text),
            source: (*source).to_owned(),
        })
    };
    METHODS.iter().map(block).collect()
}
