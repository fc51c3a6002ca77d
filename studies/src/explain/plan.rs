//! Which cases are made: from the words of the environment.

use super::case::{Case, null, pair, single};
use super::kinds::{DEVELOPMENT_UNKNOWNS, HELD_OUT_UNKNOWNS, KINDS, Kind, find};

/// What to make: one kind, nulls or pairs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// A correct claim.
    Null,
    /// Two effects.
    Pair,
    /// One effect of a kind.
    Kind(&'static str),
}

/// Wishes of a list such as `null,pair,line`; `all` are the kinds of the contract, `unknown` those for development,
/// `held_out` the others.
pub fn wishes(words: &str) -> Vec<Wish> {
    let names = |kinds: &'static [Kind]| kinds.iter().map(|k| Wish::Kind(k.name)).collect();
    words
        .split(',')
        .map(str::trim)
        .filter(|w| !w.is_empty())
        .flat_map(|word| -> Vec<Wish> {
            match word {
                "null" => vec![Wish::Null],
                "pair" => vec![Wish::Pair],
                "all" => names(KINDS),
                "unknown" => names(DEVELOPMENT_UNKNOWNS),
                "held_out" => names(HELD_OUT_UNKNOWNS),
                name => vec![Wish::Kind(find(name).unwrap_or_else(|| panic!("no kind {name}")).name)],
            }
        })
        .collect()
}

/// A strength such as `60-300` or `80`.
pub fn strength(word: &str) -> (f64, f64) {
    let number = |w: &str| w.trim().parse::<f64>().unwrap_or_else(|_| panic!("not a strength: {word}"));
    word.split_once('-').map_or_else(|| (number(word), number(word)), |(a, b)| (number(a), number(b)))
}

/// The case of a wish.
pub fn made(wish: &Wish, seed: u64, strength: (f64, f64)) -> Case {
    match wish {
        Wish::Null => null(seed),
        Wish::Pair => pair(seed, strength),
        Wish::Kind(name) => single(seed, find(name).expect("wishes hold kinds of the table"), strength),
    }
}
