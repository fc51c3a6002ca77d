//! Probabilities of the names of a finding, given that one of the catalogue's effects is there.

use super::fitted_hypothesis::Candidate;
use crate::numeric::order::SortByNumber;

/// A name with its probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Probable {
    /// Kind of the format of explanations.
    pub kind: &'static str,
    /// 0 to 1.
    pub probability: f64,
}

/// A name with what speaks for it.
#[derive(Debug, Clone, Copy)]
pub struct ScoredName {
    /// Kind of the format of explanations.
    pub kind: &'static str,
    /// Log-likelihood, nats, less the price of the parameters.
    pub score: f64,
    /// Kind whose course is the same and whose odds are those of both.
    pub within: Option<&'static str>,
}

impl From<(&'static str, f64)> for ScoredName {
    fn from((kind, score): (&'static str, f64)) -> ScoredName {
        ScoredName { kind, score, within: None }
    }
}

/// Physics differs from the formulas that are fitted, by more where it is better seen: log-likelihoods that differ by less than this
/// share of the gain do not tell names apart. Set on 428 names of the development half of a generator that shares no formula with the engine; of
/// 227 names of the held-out half those stated .69 and .97 were right in .70 and .96 (with 0.05 and 2 nats .69 and .95 in .85 and .98).
const MODEL_ERROR: f64 = 0.032;
/// Least gain that names share, nats.
const MIN_SHARED_GAIN: f64 = 1.3;
/// Probability below which a name is not listed.
const MIN_LISTED_PROBABILITY: f64 = 0.01;

/// Probabilities of the names of one finding, the likeliest first. Two names of one course are one among their rivals, and share what it
/// has by their odds alone: no error of a formula lies between them. Names below [`MIN_LISTED_PROBABILITY`] are left out, so that the
/// others may add up to less than 1.
pub fn probabilities(names: impl IntoIterator<Item = ScoredName>) -> Vec<Probable> {
    let mut best: Vec<ScoredName> = vec![];
    for name in names.into_iter().filter(|n| n.score.is_finite()) {
        match best.iter_mut().find(|b| b.kind == name.kind) {
            // Effects of one kind are one name, as likely as the likelier.
            Some(b) => b.score = b.score.max(name.score),
            None => best.push(name),
        }
    }
    let stands = |kind: &str| best.iter().any(|b| b.kind == kind);
    let (same, own): (Vec<ScoredName>, Vec<ScoredName>) =
        best.iter().copied().partition(|n| n.within.is_some_and(stands));
    let most = own.iter().map(|b| b.score).fold(f64::NEG_INFINITY, f64::max);
    let scale = MIN_SHARED_GAIN.max(MODEL_ERROR * most);
    let sum: f64 = own.iter().map(|b| ((b.score - most) / scale).exp()).sum();
    let mut out: Vec<Probable> = own
        .iter()
        .map(|b| Probable { kind: b.kind, probability: ((b.score - most) / scale).exp() / sum })
        .collect();
    for name in same {
        let whole = own.iter().find(|b| Some(b.kind) == name.within);
        let share = whole.map_or(0.0, |b| (name.score - b.score).exp().min(0.5));
        let Some(both) = out.iter_mut().find(|p| Some(p.kind) == name.within) else { continue };
        let probability = share * both.probability;
        both.probability -= probability;
        out.push(Probable { kind: name.kind, probability });
    }
    out.retain(|p| p.probability >= MIN_LISTED_PROBABILITY);
    out.sort_descending_by(|a| a.probability);
    out
}

/// The names of a finding, of which that of a response is shared by the names of its laws. Without laws they stay as they are.
pub fn shared(names: Vec<Probable>, response: &str, laws: Vec<Probable>) -> Vec<Probable> {
    if laws.is_empty() {
        return names;
    }
    let (whole, mut out): (Vec<Probable>, Vec<Probable>) =
        names.into_iter().partition(|n| n.kind == response);
    let of_response: f64 = whole.iter().map(|n| n.probability).sum();
    for law in laws {
        let probability = of_response * law.probability;
        match out.iter_mut().find(|n| n.kind == law.kind) {
            Some(same) => same.probability += probability,
            None => out.push(Probable { kind: law.kind, probability }),
        }
    }
    out.sort_descending_by(|n| n.probability);
    out
}

/// The name of a candidate in reports, that of its law where it takes one, and its score over a hypothesis without it, nats.
pub fn name_of(
    candidate: &Candidate,
    law: Option<&Candidate>,
    rows: usize,
    bic_without: f64,
) -> (&'static str, f64) {
    let kind = law.map_or(candidate.effect, |law| law.effect).reported_kind();
    (kind, 0.5 * (bic_without - candidate.tried.rank(rows)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probabilities_of<const N: usize>(names: [(&'static str, f64); N]) -> Vec<Probable> {
        probabilities(names.map(ScoredName::from))
    }

    #[test]
    fn two_names_of_one_course_are_one_among_their_rivals() {
        // Odds of 3 : 1 between the two, and e⁻¹ for the third: the plainer name's score holds both.
        let same =
            ScoredName { kind: "heading_change", score: 20.0 + 0.25f64.ln(), within: Some("bias_step") };
        let named =
            probabilities([("bias_step", 20.0).into(), same, ("comb", 20.0 - MIN_SHARED_GAIN).into()]);
        let step = 1.0 / (1.0 + (-1f64).exp());
        let expected = [0.75 * step, 1.0 - step, 0.25 * step];
        assert_eq!(named.iter().map(|p| p.kind).collect::<Vec<_>>(), ["bias_step", "comb", "heading_change"]);
        assert!(named.iter().zip(expected).all(|(p, e)| (p.probability - e).abs() < 1e-12), "{named:?}");
        // Without the other name it stands for itself.
        assert_eq!(probabilities([same])[0].probability, 1.0);
    }

    #[test]
    fn laws_share_what_their_response_has_among_its_rivals() {
        let of = |kind: &'static str, probability: f64| Probable { kind, probability };
        let names = vec![of("temp_response", 0.6), of("excess_rrw", 0.3), of("temp_rate", 0.1)];
        let laws = vec![of("temp_polynomial", 0.75), of("temp_rate", 0.25)];
        let expected = [("temp_polynomial", 0.45), ("excess_rrw", 0.3), ("temp_rate", 0.25)];
        let said = shared(names.clone(), "temp_response", laws);
        assert!(
            said.iter()
                .zip(expected)
                .all(|(n, (kind, p))| n.kind == kind && (n.probability - p).abs() < 1e-12),
            "{said:?}"
        );
        assert_eq!(shared(names.clone(), "temp_response", vec![]), names);
    }

    #[test]
    fn names_share_by_what_they_are_worth() {
        // Twenty nats share by the least scale: e⁰ : e⁻¹ : e⁻⁶, of which the last is below a hundredth.
        let less = |scales: f64| 20.0 - scales * MIN_SHARED_GAIN;
        let named = probabilities_of([
            ("line", less(1.0)),
            ("comb", 20.0),
            ("bias_step", less(6.0)),
            ("comb", less(9.0)),
        ]);
        let sum = 1.0 + (-1f64).exp() + (-6f64).exp();
        assert_eq!(named.iter().map(|p| p.kind).collect::<Vec<_>>(), ["comb", "line"]);
        assert!((named[0].probability - 1.0 / sum).abs() < 1e-12, "{named:?}");
        assert!((named[1].probability - (-1f64).exp() / sum).abs() < 1e-12);
        // Of 500 nats, 16 are the model's own error.
        let clear = probabilities_of([("line", 500.0), ("comb", 484.0)]);
        assert!((clear[1].probability / clear[0].probability - (-1f64).exp()).abs() < 1e-9, "{clear:?}");
        assert!(probabilities_of([("line", f64::NAN)]).is_empty());
    }
}
