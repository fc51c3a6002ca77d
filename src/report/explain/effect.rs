//! One cause, printed.

use super::print::{capital, chance, difference, parameter, place, stated, title, value};
use super::sentence;
use crate::effect::find;
use crate::i18n::{EffectText, effect_text};
use crate::mismatch::finding::{Explanation, Finding};
use crate::report::number::{limit_digits, percent};
use crate::report::translator::Translator;
use serde::Serialize;

/// A parameter of a cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterRow {
    /// In words.
    pub name: String,
    /// As the files have it.
    pub id: String,
    /// Value.
    pub value: String,
    /// 95 % interval.
    pub interval: String,
    /// Unit.
    pub unit: String,
    /// What the claim states, where it states it.
    pub claimed: String,
}

/// Something that this recording cannot tell from the cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EquivalentView {
    /// Title.
    pub title: String,
    /// How it shows.
    pub signature: String,
    /// What tells it from its neighbours.
    pub told_by: String,
    /// The experiment that would decide.
    pub confirm: String,
    /// Whether a longer record would, and how long.
    pub longer: String,
}

/// A cause.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectView {
    /// Number, counted from 1.
    pub number: usize,
    /// Title.
    pub title: String,
    /// Kind as the files have it.
    pub kind: String,
    /// True for a cause that has no name.
    pub unknown: bool,
    /// Sentences about it.
    pub sentences: Vec<String>,
    /// What happens in the instrument or around it.
    pub mechanism: String,
    /// How it shows in each view.
    pub signature: String,
    /// What tells it from its neighbours.
    pub told_by: String,
    /// The experiment that would confirm it.
    pub confirm: String,
    /// Formula.
    pub formula: String,
    /// Source.
    pub source: String,
    /// Parameters.
    pub parameters: Vec<ParameterRow>,
    /// True when the claim states one of them.
    pub has_claimed: bool,
    /// Where it shows.
    pub places: Vec<String>,
    /// What it is worth; empty for a cause without a name, which has no model.
    pub delta_bic: String,
    /// Probability under its absence.
    pub p: String,
    /// Held-out gain; empty where there is none.
    pub heldout_gain: String,
    /// Share of the misfit removed; empty where there is none.
    pub removed: String,
    /// What cannot be distinguished from it.
    pub equivalents: Vec<EquivalentView>,
}

impl EffectView {
    /// Prints a cause.
    pub(super) fn new(number: usize, f: &Finding, all: &Explanation, words: Translator) -> EffectView {
        let text = |part| effect_text(f.effect_id(), part, words.lang).to_owned();
        let parameters = parameters(f, all, words);
        EffectView {
            number,
            title: capital(&title(f.effect_id(), words)),
            kind: f.kind.clone(),
            unknown: f.is_unnamed(),
            sentences: sentence::finding(f, all, words),
            mechanism: text(EffectText::Mechanism),
            signature: text(EffectText::Signature),
            told_by: text(EffectText::Distinguishing),
            confirm: text(EffectText::Confirm),
            formula: words.formula(&text(EffectText::Formula)),
            source: text(EffectText::Source),
            has_claimed: parameters.iter().any(|p| !p.claimed.is_empty()),
            parameters,
            places: f.places.iter().map(|p| place(p, all.recording.length_s, words)).collect(),
            delta_bic: if f.is_unnamed() { String::new() } else { difference(f.delta_bic, words) },
            p: chance(f.p_value, words),
            heldout_gain: f.heldout_gain.map(|v| difference(v, words)).unwrap_or_default(),
            removed: f
                .removed_share
                .filter(|s| s.is_finite())
                .map(|s| percent(s, words.lang))
                .unwrap_or_default(),
            equivalents: f.other_causes().map(|k| equivalent(k, &f.kind, all, words)).collect(),
        }
    }
}

/// Parameters in the order of the catalogue, the size of the contribution last.
fn parameters(f: &Finding, all: &Explanation, words: Translator) -> Vec<ParameterRow> {
    let order: Vec<&str> =
        find(f.effect_id()).map(|e| e.params().iter().map(|p| p.name).collect()).unwrap_or_default();
    let place = |name: &str| match order.iter().position(|p| *p == name) {
        Some(i) => i,
        None if name == "rms_deg_h" => usize::MAX,
        None => order.len(),
    };
    let mut given: Vec<_> = f.parameters.iter().collect();
    given.sort_by_key(|(name, _)| place(name));
    let row = |(name, p): &(&String, &_)| {
        let printed = value(name, p, words);
        let claimed = all.nuisances.iter().find(|n| n.name.rsplit('.').next() == Some(name.as_str()));
        ParameterRow {
            name: parameter(name, words),
            id: (*name).clone(),
            value: printed.value,
            interval: printed.interval,
            unit: words.unit(&p.unit),
            claimed: claimed.map(|n| limit_digits(n.claimed, 6, words.lang)).unwrap_or_default(),
        }
    };
    given.iter().map(row).collect()
}

fn equivalent(kind: &str, chosen: &str, all: &Explanation, words: Translator) -> EquivalentView {
    let text = |part| effect_text(kind, part, words.lang).to_owned();
    let experiment = all.experiments.iter().find(|e| e.kind == chosen && e.against == kind);
    let times = experiment.and_then(|e| e.times_longer).filter(|t| t.is_finite());
    let longer = match (times, experiment) {
        (Some(times), _) if times <= 1.0 => words.t("explain.same_length"),
        (Some(times), _) => {
            let length = crate::report::number::duration(rounded(times * all.recording.length_s), words.lang);
            let times = limit_digits(times, 2, words.lang);
            words.with("explain.longer", &[("times", &times), ("length", &length)])
        }
        (None, Some(_)) => words.t("explain.no_length"),
        (None, None) => String::new(),
    };
    EquivalentView {
        title: capital(&title(kind, words)),
        signature: text(EffectText::Signature),
        told_by: text(EffectText::Distinguishing),
        confirm: text(EffectText::Confirm),
        longer,
    }
}

/// Two significant digits: a needed length is no finer known.
fn rounded(v: f64) -> f64 {
    format!("{v:.1e}").parse().unwrap_or(v)
}

/// A value that the claim states, with what the recording says of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatedRow {
    /// In words.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// As claimed.
    pub claimed: String,
    /// Stated standard deviation; empty for an exact value.
    pub uncertainty: String,
    /// Fitted with the claim.
    pub baseline: String,
    /// Fitted with the augmented claim.
    pub augmented: String,
    /// How far it moved, in stated standard deviations; empty for an exact or free one.
    pub moved: String,
}

/// Prints the values that a claim states.
pub fn stated_rows(all: &Explanation, words: Translator) -> Vec<StatedRow> {
    let shown = |v: f64| limit_digits(v, 4, words.lang);
    all.nuisances
        .iter()
        .map(|n| StatedRow {
            name: stated(&n.name, words),
            unit: words.unit(&n.unit),
            claimed: limit_digits(n.claimed, 6, words.lang),
            uncertainty: if n.uncertainty > 0.0 { shown(n.uncertainty) } else { String::new() },
            baseline: shown(n.baseline),
            augmented: shown(n.augmented),
            moved: if n.uncertainty > 0.0 {
                difference((n.augmented - n.claimed) / n.uncertainty, words)
            } else {
                String::new()
            },
        })
        .collect()
}
