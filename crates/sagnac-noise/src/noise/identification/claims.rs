//! The rules of a claim: which of flicker, random walk and ramp a record is given, what a limit needs, which terms can stand
//! for one another.
//!
//! Flicker, random walk and ramp share the lowest few dozen modes of a record, and each can stand for another. Sets of them are compared
//! with one another, so that the better of two rivals is claimed where either alone explains the record; asked to beat
//! the other one by a threshold each, neither would be. Every set has a price in 2 ln L, set by simulation such that at
//! most about one record in twenty claims an absent term and an identifiable one is missed no more often.

use super::linear_fit::RAMP_INDEX;
use crate::estimate::Estimate;
use crate::message::{Note, note};
use crate::noise::data::NoiseType;
use crate::noise::model::TERMS;

/// Relative standard deviation up to which a coefficient counts as identifiable.
pub const MAX_IDENTIFIABLE_SIGMA: f64 = 0.20;

/// A set of slow terms as bits.
pub type SlowSet = usize;
/// Flicker.
pub const B: SlowSet = 1;
/// Random walk.
pub const K: SlowSet = 2;
/// Ramp.
pub const R: SlowSet = 4;
/// Number of sets of slow terms.
pub const SLOW_SET_COUNT: usize = 8;

/// Prices in 2 ln L.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlowPrices {
    /// Of each set of flicker, random walk and ramp.
    pub set: [f64; SLOW_SET_COUNT],
    /// Of a long Markov process in place of flicker and random walk: it has one parameter more than either, and a time
    /// that was searched for.
    pub markov: f64,
    /// Of a long Markov process and a ramp.
    pub markov_and_ramp: f64,
    /// What a long Markov process costs more in the place of random walk alone: few modes lie below its corner, and by chance alone
    /// they are as low in one walk of a hundred that is paid for at the price of flicker.
    pub markov_for_walk: f64,
}

impl Default for SlowPrices {
    fn default() -> Self {
        let mut set = [0.0; SLOW_SET_COUNT];
        set[B] = 4.2;
        set[K] = 4.6;
        set[R] = 7.0;
        set[B | K] = 9.2;
        set[B | R] = 13.5;
        set[K | R] = 11.2;
        set[B | K | R] = 18.5;
        SlowPrices { set, markov: 11.8, markov_and_ramp: 23.0, markov_for_walk: 4.0 }
    }
}

/// Preference in 2 ln L below which another description counts as nearly as good.
pub const NEARLY_AS_GOOD: f64 = 4.0;

/// Preference that flicker needs where it is known well: of records of white noise with a random walk that shows, 8 % are
/// described better by flicker, and half of those by less.
const FLICKER_PREFERENCE: f64 = 2.0;

/// Preference in 2 ln L over the best description without a slow term of some relative uncertainty that its claim needs.
pub fn needed_preference(term: NoiseType, relative_sigma: f64) -> f64 {
    match term {
        _ if relative_sigma.is_nan() || relative_sigma > MAX_IDENTIFIABLE_SIGMA => NEARLY_AS_GOOD,
        NoiseType::Flicker => FLICKER_PREFERENCE,
        _ => 0.0,
    }
}

/// The set of slow terms that was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlowChoice {
    /// The set.
    pub set: SlowSet,
    /// Its deviance with its price.
    pub cost: f64,
}

impl SlowPrices {
    /// The set with the least sum of deviance and price; `None` when none has a finite one.
    pub fn choose(&self, deviance: &[f64; SLOW_SET_COUNT]) -> Option<SlowChoice> {
        self.choose_among(deviance, |_| true)
    }

    /// As [`SlowPrices::choose`], among the sets for which `allowed` is true.
    pub fn choose_among(
        &self,
        deviance: &[f64; SLOW_SET_COUNT],
        allowed: impl Fn(SlowSet) -> bool,
    ) -> Option<SlowChoice> {
        (0..SLOW_SET_COUNT)
            .filter(|set| allowed(*set))
            .map(|set| SlowChoice { set, cost: deviance[set] + self.set[set] })
            .filter(|c| c.cost.is_finite())
            .min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    /// What a long Markov process costs more in the place of these terms than its own price. With flicker among them it
    /// stands for that, and has to bend nothing that a walk bends by chance.
    pub fn in_place_of(&self, set: SlowSet) -> f64 {
        if set & (B | K) == K { self.markov_for_walk } else { 0.0 }
    }

    /// By how much the best set without a term of [`crate::noise::model::TERMS`] costs more than the one chosen.
    pub fn preference(&self, deviance: &[f64; SLOW_SET_COUNT], choice: SlowChoice, term: usize) -> f64 {
        self.choose_among(deviance, |set| !contains_term(set, term))
            .map_or(f64::INFINITY, |c| c.cost - choice.cost)
    }

    /// 2 Δ ln L that a slow term of some relative uncertainty needs against the best model without it, its rival in its
    /// place; `None` for other terms.
    pub fn against_rival(&self, term: NoiseType, relative_sigma: f64) -> Option<f64> {
        let between = self.set[B] - self.set[K];
        let preference = needed_preference(term, relative_sigma);
        Some(match term {
            NoiseType::Flicker => (preference + between).max(0.0),
            NoiseType::RateRandomWalk => (preference - between).max(0.0),
            NoiseType::RateRamp => self.set[R],
            _ => return None,
        })
    }
}

/// True when a set contains a term, given by its position in [`crate::noise::model::TERMS`].
pub fn contains_term(set: SlowSet, term: usize) -> bool {
    match term {
        1 => set & B != 0,
        2 => set & K != 0,
        4 => set & R != 0,
        _ => false,
    }
}

/// Positions in [`TERMS`].
pub(crate) const WHITE_INDEX: usize = 0;
pub(crate) const FLICKER_INDEX: usize = 1;
pub(crate) const WALK_INDEX: usize = 2;
pub(crate) const QUANTIZATION_INDEX: usize = 3;
/// 2 Δ ln L from which a slow term that is not claimed widens the interval of N, and quantisation that is not claimed
/// the prediction of averages.
pub(crate) const MIN_SUSPICION_RATIO: f64 = 1.0;
/// 2 Δ ln L from which a rival that is not claimed widens the interval of a slow term.
pub(crate) const MIN_RIVAL_RATIO: f64 = 0.5;
pub(crate) const WHITTLE_METHOD: &str = "whittle";
/// Price of a term when the best description is chosen: Akaike's 2 raised to the 5 % point of one amplitude.
pub(crate) const TERM_PRICE: f64 = 2.71;
/// Coverage of upper limits.
pub(crate) const LIMIT_COVERAGE: f64 = 0.95;
/// Rise of the deviance that makes an upper limit. A limit is only given when the term was not claimed, that is when
/// chance made it look small; 5 in place of 2.71 keeps the coverage in spite of that.
pub(crate) const LIMIT_RISE: f64 = 5.0;

/// True when a slow term that was chosen may be claimed. A rival nearly as good matters little while the term is known
/// well; one that is hardly identifiable is claimed only where it is clearly preferred. Flicker needs some preference all the
/// same: chance makes a random walk look like it in one record of twelve.
pub(crate) fn is_claimable(term: usize, preference: f64, relative_sigma: f64) -> bool {
    preference >= needed_preference(TERMS[term], relative_sigma)
}

/// Says so where another slow term in place of this one describes the record nearly as well.
pub(crate) fn with_rivals(estimate: Estimate, term: usize, preference: f64) -> Estimate {
    let slow = matches!(term, FLICKER_INDEX | WALK_INDEX | RAMP_INDEX);
    if slow && preference < NEARLY_AS_GOOD {
        estimate.note(note!("slow_alike.term", fall = preference))
    } else {
        estimate
    }
}

/// Low-frequency noise is there, and which of the terms it is stays open.
pub(crate) fn low_frequency_note() -> Note {
    note!("note.low_frequency_ambiguous")
}

/// Positions of the terms that may hold a part of this one while too weak to be claimed and absent from a structure, by
/// their 2 Δ ln L.
///
/// Slow terms touch a few dozen modes only: one that shows nothing moves the level of the others by nothing.
/// Quantisation stands in the frequencies that N is read from. One of two thirds of its own standard deviation raises N
/// by one of N's, and every second such record shows none: it counts whether it shows or not.
pub(crate) fn suspects<'a>(
    term: usize,
    present: &'a [bool],
    ratios: &'a [f64],
) -> impl Iterator<Item = usize> + use<'a> {
    let all: &[usize] = match term {
        WHITE_INDEX => &[FLICKER_INDEX, WALK_INDEX, QUANTIZATION_INDEX],
        QUANTIZATION_INDEX => &[FLICKER_INDEX, WALK_INDEX],
        _ => &[],
    };
    let absent = |other: usize| present.get(other) == Some(&false);
    let counts = |other: usize| {
        other == QUANTIZATION_INDEX || ratios.get(other).is_some_and(|r| *r > MIN_SUSPICION_RATIO)
    };
    all.iter().copied().filter(move |other| absent(*other) && counts(*other))
}

/// The term that can stand for this one at the lowest frequencies.
pub(crate) fn rival_of(term: usize) -> Option<usize> {
    match term {
        FLICKER_INDEX => Some(WALK_INDEX),
        WALK_INDEX => Some(FLICKER_INDEX),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_better_of_two_rivals_is_claimed_where_each_explains_the_record() {
        let prices = SlowPrices::default();
        let mut deviance = [0.0; SLOW_SET_COUNT];
        // Nothing: 70; flicker or anything with it: 0; random walk alone 3: too little for a threshold of 4.5.
        deviance[0] = 70.0;
        deviance[K] = 3.0;
        deviance[R] = 60.0;
        deviance[K | R] = 2.0;
        assert_eq!(prices.choose(&deviance).map(|c| c.set), Some(B));
        deviance[0] = 3.0;
        assert_eq!(prices.choose(&deviance).map(|c| c.set), Some(0), "a rise of 3 shows nothing");
        assert_eq!(prices.choose(&[f64::NAN; SLOW_SET_COUNT]), None);
    }

    #[test]
    fn a_larger_set_costs_more_than_its_parts() {
        let prices = SlowPrices::default();
        for set in 0..SLOW_SET_COUNT {
            for term in [B, K, R] {
                if set & term == 0 {
                    assert!(prices.set[set | term] > prices.set[set], "{set} {term}");
                }
            }
        }
    }
}
