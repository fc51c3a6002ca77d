//! The shared laws of some recordings, the one that explains most first.

use super::baseline::Baseline;
use super::fit::{FittedLaw, fit, refined};
use super::law::{Law, of_catalogue};
use crate::effect::EFFECTS;
use crate::mismatch::options::Options;
use crate::mismatch::select::MIN_DELTA_BIC;
use crate::numeric::order::SortByNumber;
use std::collections::BTreeSet;

/// Below this probability of what the recordings say of the coefficients, one law does not hold for all.
const DISAGREEMENT_PROBABILITY: f64 = 1e-3;
/// Laws whose numbers are searched for.
const MAX_REFINED_LAWS: usize = 6;

/// Result of one look over the laws.
pub(super) struct Look {
    /// The law that explains most, where one may be added.
    pub best: Option<FittedLaw>,
    /// Laws that would be, if the recordings agreed on them.
    pub unlike: Vec<FittedLaw>,
    /// Causes that were looked at.
    pub family: f64,
}

/// Fits every law to all recordings. `found` are laws that single recordings were found to follow; `rows` all rows.
pub(super) fn look(
    baselines: &[Baseline<'_>],
    found: &[Law],
    taken: &[(&'static str, Option<String>)],
    rows: usize,
    options: &Options,
) -> Look {
    let mut laws: Vec<Law> = vec![];
    for baseline in baselines {
        let drivers = &baseline.problem.spectra.full.drivers;
        for law in of_catalogue(EFFECTS.iter().copied().filter(|e| options.allows(e.kind())), drivers) {
            let known = |l: &Law| l.cause() == law.cause() && l.values == law.values;
            if !laws.iter().any(known) {
                laws.push(law);
            }
        }
    }
    laws.extend(found.iter().filter(|l| options.allows(l.effect.kind())).cloned());
    laws.retain(|l| !taken.contains(&l.cause()));
    let family = laws.iter().map(Law::cause).collect::<BTreeSet<_>>().len().max(1) as f64;
    let mut fitted: Vec<FittedLaw> = laws.iter().filter_map(|l| fit(l, baselines)).collect();
    let rank = |f: &FittedLaw| f.delta_bic(rows);
    fitted.sort_descending_by(|a| rank(a));
    let mut causes = BTreeSet::new();
    fitted.retain(|f| causes.insert(f.law.cause()));
    let mut refined: Vec<FittedLaw> =
        fitted.into_iter().take(MAX_REFINED_LAWS).map(|f| refined(f, baselines)).collect();
    refined.sort_descending_by(|a| rank(a));
    let passes = |f: &FittedLaw| rank(f) >= MIN_DELTA_BIC && f.p_value(family) < options.alpha;
    let mut out = Look { best: None, unlike: vec![], family };
    for law in refined.into_iter().filter(passes) {
        if law.agreement() < DISAGREEMENT_PROBABILITY {
            out.unlike.push(law);
        } else if predicts(&law) {
            out.best = Some(law);
            break;
        }
    }
    out
}

/// True where the law of the other recordings improves a recording, over all of them.
fn predicts(law: &FittedLaw) -> bool {
    (0..law.shares.len()).filter_map(|i| law.predicted_gain(i)).sum::<f64>() > 0.0
}
