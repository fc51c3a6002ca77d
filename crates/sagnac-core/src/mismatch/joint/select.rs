//! The shared laws of some recordings, the one that explains most first.

use super::fit::{Fitted, fit, refined};
use super::ground::Ground;
use super::law::{Law, of_catalogue};
use crate::effect::EFFECTS;
use crate::mismatch::options::Options;
use crate::mismatch::select::ENOUGH;
use crate::numeric::order::SortByNumber;
use std::collections::BTreeSet;

/// Below this probability of what the recordings say of the coefficients, one law does not hold for all.
const DISAGREE: f64 = 1e-3;
/// Laws whose numbers are searched for.
const REFINED: usize = 6;

/// What one look over the laws found.
pub(super) struct Look {
    /// The law that explains most, where one may be added.
    pub best: Option<Fitted>,
    /// Laws that would be, if the recordings agreed on them.
    pub unlike: Vec<Fitted>,
    /// Causes that were looked at.
    pub family: f64,
}

/// Fits every law to all recordings. `found` are laws that single recordings were found to follow; `rows` all rows.
pub(super) fn look(
    grounds: &[Ground<'_>],
    found: &[Law],
    taken: &[(&'static str, Option<String>)],
    rows: usize,
    options: &Options,
) -> Look {
    let mut laws: Vec<Law> = vec![];
    for ground in grounds {
        let drivers = &ground.problem.spectra.full.drivers;
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
    let mut fitted: Vec<Fitted> = laws.iter().filter_map(|l| fit(l, grounds)).collect();
    let rank = |f: &Fitted| f.delta_bic(rows);
    fitted.sort_descending_by(|a| rank(a));
    let mut causes = BTreeSet::new();
    fitted.retain(|f| causes.insert(f.law.cause()));
    let mut refined: Vec<Fitted> = fitted.into_iter().take(REFINED).map(|f| refined(f, grounds)).collect();
    refined.sort_descending_by(|a| rank(a));
    let passes = |f: &Fitted| rank(f) >= ENOUGH && f.p_value(family) < options.alpha;
    let mut out = Look { best: None, unlike: vec![], family };
    for law in refined.into_iter().filter(passes) {
        if law.agreement() < DISAGREE {
            out.unlike.push(law);
        } else if predicts(&law) {
            out.best = Some(law);
            break;
        }
    }
    out
}

/// Whether the law of the other recordings improves a recording, over all of them.
fn predicts(law: &Fitted) -> bool {
    (0..law.shares.len()).filter_map(|i| law.predicted_gain(i)).sum::<f64>() > 0.0
}
