//! Every structure of N, B, K, Q and R fitted, and the one that a record is given.

use super::claims::{
    B, FLICKER_INDEX, K, QUANTIZATION_INDEX, R, SLOW_SET_COUNT, SlowChoice, SlowPrices, TERM_PRICE,
    WALK_INDEX,
};
use super::linear_fit::{Likelihood, Point, RAMP_INDEX, SPECTRAL_TERM_COUNT, Structure, toggled};

/// All structures fitted.
pub(super) struct Structures {
    /// Maximum of each set of spectral terms, by bit mask; second index: ramp fitted.
    points: Vec<[Option<Point>; 2]>,
    /// The maximum with every spectral term allowed, and the ramp where it is claimed.
    pub full: Point,
    /// 2 Δ ln L of each of [`TERMS`](crate::noise::model::TERMS) against the best model without it.
    pub ratios: [f64; 5],
    /// The slow terms chosen.
    pub slow: SlowChoice,
    /// By how much the best set without each of [`TERMS`](crate::noise::model::TERMS) costs more.
    pub preference: [f64; 5],
}

const ALL_SPECTRAL_TERMS: usize = (1 << SPECTRAL_TERM_COUNT) - 1;
const NOT_SLOW: usize = 1 | (1 << QUANTIZATION_INDEX);

impl Structures {
    /// Fits every structure and chooses among the slow terms.
    pub fn fit(likelihood: &Likelihood, prices: &SlowPrices) -> Option<Structures> {
        let mut points: Vec<[Option<Point>; 2]> = vec![[None, None]; ALL_SPECTRAL_TERMS + 1];
        for set in 1..=ALL_SPECTRAL_TERMS {
            for (ramp, with_ramp) in [false, true].into_iter().enumerate() {
                let structure = structure_of(set, with_ramp);
                let mut best = likelihood.maximise(&structure, None, None);
                // Never worse than any part of it: a second start from the best part.
                let part = (0..SPECTRAL_TERM_COUNT)
                    .filter(|i| set >> i & 1 == 1)
                    .filter_map(|i| points[set ^ (1 << i)][ramp])
                    .min_by(|a, b| a.deviance.total_cmp(&b.deviance));
                if let Some(part) = part
                    && best.is_none_or(|b| part.deviance < b.deviance)
                {
                    best = likelihood
                        .maximise(&structure, None, Some(&part))
                        .filter(|p| p.deviance <= part.deviance);
                    best = best.or(Some(part));
                }
                points[set][ramp] = best;
            }
        }
        let full = points[ALL_SPECTRAL_TERMS][0]?;
        let deviance = |set: usize, ramp: usize| points[set][ramp].map_or(f64::INFINITY, |p| p.deviance);
        let ratio = |term: usize, ramp: usize| {
            (deviance(ALL_SPECTRAL_TERMS ^ (1 << term), ramp) - deviance(ALL_SPECTRAL_TERMS, ramp)).max(0.0)
        };
        // The ramp: plain likelihood on both sides, at the restricted estimate.
        let restricted = points[ALL_SPECTRAL_TERMS][1]?;
        let plain =
            likelihood.maximise(&[true; 5], Some((RAMP_INDEX, restricted.ramp)), Some(&restricted))?;
        let ramp_ratio = (full.deviance - plain.deviance).max(0.0);
        let mut slow_deviance = [f64::INFINITY; SLOW_SET_COUNT];
        for (slow, value) in slow_deviance.iter_mut().enumerate() {
            let flicker = usize::from(slow & B != 0) << FLICKER_INDEX;
            let walk = usize::from(slow & K != 0) << WALK_INDEX;
            let set = NOT_SLOW | flicker | walk;
            // With a ramp the plain likelihood at the restricted estimate: the restricted one of another structure is
            // that of other data.
            *value = if slow & R == 0 {
                deviance(set, 0)
            } else {
                points[set][1]
                    .and_then(|p| {
                        likelihood.maximise(&structure_of(set, true), Some((RAMP_INDEX, p.ramp)), Some(&p))
                    })
                    .map_or(f64::INFINITY, |p| p.deviance)
            };
        }
        let slow = prices.choose(&slow_deviance)?;
        let preference = std::array::from_fn(|term| prices.preference(&slow_deviance, slow, term));
        let with_ramp = usize::from(slow.set & R != 0);
        // Random walk must show with a ramp allowed for, and also in the description that the record is given.
        let walk = ratio(2, 1).min(ratio(2, with_ramp));
        // A ramp that is left out bends the whole model, and other terms would seem to mend it.
        let ratios = [ratio(0, with_ramp), ratio(1, with_ramp), walk, ratio(3, with_ramp), ramp_ratio];
        Some(Structures {
            points,
            full: if with_ramp == 1 { restricted } else { full },
            ratios,
            slow,
            preference,
        })
    }

    /// The best description: claimed terms, and as few others as pay their price.
    pub fn supported(&self, claimed: &Structure) -> Structure {
        let ramp = usize::from(claimed[RAMP_INDEX]);
        let must = (0..SPECTRAL_TERM_COUNT).filter(|i| claimed[*i]).fold(0usize, |set, i| set | 1 << i);
        let cost = |set: usize| {
            self.points[set][ramp]
                .map_or(f64::INFINITY, |p| p.deviance + TERM_PRICE * f64::from(set.count_ones()))
        };
        // Quantisation is nearly white at the highest frequencies: on suspicion alone it would spoil N.
        let suspected =
            ALL_SPECTRAL_TERMS ^ if claimed[QUANTIZATION_INDEX] { 0 } else { 1 << QUANTIZATION_INDEX };
        let best = (1..=ALL_SPECTRAL_TERMS)
            .filter(|set| set & must == must && set & suspected == *set)
            .min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
        structure_of(best.unwrap_or(ALL_SPECTRAL_TERMS), claimed[RAMP_INDEX])
    }
}

fn structure_of(set: usize, ramp: bool) -> Structure {
    let spectral = (0..SPECTRAL_TERM_COUNT).fold([false; 5], |s, i| toggled(&s, i, set >> i & 1 == 1));
    toggled(&spectral, RAMP_INDEX, ramp)
}
