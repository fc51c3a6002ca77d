//! One answer against the truth, after section 5 of the contract.

use super::answer::{Answer, Entry};
use super::truth::{Concealed, Family, Half, Place, Strength, Truth};

/// Whether an interval holds the true value.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// Kind and parameter.
    pub of: String,
    /// Whether it does.
    pub holds: bool,
}

/// A name with the probability that the answer gives it.
#[derive(Debug, Clone, PartialEq)]
pub struct Believed {
    /// 0 to 1.
    pub probability: f64,
    /// Whether it is the kind of a concealed effect.
    pub right: bool,
}

/// What an answer is worth.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// Name of the case.
    pub case: String,
    /// Subject.
    pub subject: String,
    /// Family.
    pub family: Family,
    /// Half.
    pub half: Half,
    /// Strength; absent for nulls.
    pub strength: Option<Strength>,
    /// The verdict is not `consistent`.
    pub detected: bool,
    /// Kind of the first entry; empty without one.
    pub first: String,
    /// The first entry is the kind of a concealed effect.
    pub named_first: bool,
    /// The same, or the kind is among at most three equivalents of the first entry.
    pub named: bool,
    /// Concealed effects that some entry names, alone or as an equivalent.
    pub found: usize,
    /// Concealed effects.
    pub concealed: usize,
    /// A place of the first entry that names an effect is right.
    pub located: bool,
    /// Entries that name what is not there, besides the first.
    pub extra: usize,
    /// Decoys named as columns.
    pub decoys_named: usize,
    /// The law of a driver is right; absent where there is none.
    pub law: Option<bool>,
    /// Intervals of the parameters.
    pub intervals: Vec<Held>,
    /// Each name that the first entry gives a probability.
    pub names: Vec<Believed>,
    /// Explained part of the variance of what was concealed, over the possible part; absent where nothing can be predicted.
    pub explained: Option<f64>,
    /// Explaining again with `augmented.toml` gave `consistent`; absent where it was not tried.
    pub closes: Option<bool>,
}

impl Score {
    /// Judges an answer. `time_s` are the instants of the rows; `again` is the verdict of the second explanation.
    pub fn of(truth: &Truth, answer: &Answer, time_s: &[f64], again: Option<&str>) -> Score {
        let names = |part: &Concealed| answer.effects.iter().find(|e| matches(part, e, true));
        let first = answer.effects.first();
        let naming = |loose| {
            let of_first = |e| truth.concealed.iter().any(|part| matches(part, e, loose));
            first.is_some_and(of_first)
        };
        let (named_first, named) = (naming(false), naming(true));
        let place = truth.concealed.iter().find_map(|part| names(part).map(|entry| located(part, entry)));
        // A wrong name may still be at the right place.
        let place = place.or_else(|| {
            let first = first?;
            Some(truth.concealed.iter().any(|part| located(part, first)))
        });
        let spurious = |e: &&Entry| {
            let beside = |part: &Concealed| part.beside.contains(&e.kind);
            !truth.concealed.iter().any(|part| matches(part, e, true) || beside(part))
        };
        let law = truth.concealed.iter().find_map(|part| {
            let law = part.law.as_ref().filter(|_| part.kind == "column_driver")?;
            let entry = names(part)?;
            Some(entry.law.as_ref() == Some(law))
        });
        let named_columns = answer.effects.iter().filter_map(|e| e.column.as_ref());
        Score {
            case: truth.case.clone(),
            subject: truth.subject.clone(),
            family: truth.family,
            half: truth.half,
            strength: truth.strength,
            detected: !answer.consistent(),
            first: first.map_or_else(String::new, |e| e.kind.clone()),
            named_first,
            named,
            found: truth.concealed.iter().filter(|part| names(part).is_some()).count(),
            concealed: truth.concealed.len(),
            located: place.unwrap_or(false),
            extra: answer.effects.iter().skip(1).filter(spurious).count(),
            decoys_named: named_columns.filter(|c| truth.decoys.contains(c)).count(),
            law,
            intervals: intervals(truth, answer),
            names: first.map_or_else(Vec::new, |entry| believed(truth, entry)),
            explained: explained(truth, answer, time_s),
            closes: again.map(|verdict| verdict == "consistent"),
        }
    }
}

/// Whether an entry names an effect; loosely, also as one of three equivalents.
fn matches(part: &Concealed, entry: &Entry, loose: bool) -> bool {
    let right = |kind: &String| *kind == part.kind || part.same.contains(kind);
    // These kinds say nothing without their column.
    let of_column = ["column_driver", "noise_variance_driver"];
    let column = match (&part.column, &entry.column) {
        (Some(asked), Some(named)) => asked == named,
        _ => !of_column.contains(&entry.kind.as_str()),
    };
    column && (right(&entry.kind) || loose && entry.equivalents.iter().take(3).any(right))
}

/// Whether one of the places of an entry is one of those of an effect: at least half of the shorter of the two is common,
/// and the entry says no more than four times as much as is true.
fn located(part: &Concealed, entry: &Entry) -> bool {
    entry.places.iter().any(|said| part.places.iter().any(|real| overlaps(said, real)))
}

fn overlaps(said: &Place, real: &Place) -> bool {
    if said.domain != real.domain {
        return false;
    }
    let width = |p: &Place| p.to - p.from;
    // An interval that brackets an instant may be as narrow as it likes.
    let least = 1e-9 + 1e-6 * real.to.abs().max(real.from.abs());
    let common = said.to.min(real.to) - said.from.max(real.from) + least;
    common >= 0.5 * width(said).min(width(real)) && width(said) <= 4.0 * width(real) + 4.0 * least
}

/// The probabilities of an entry, each with whether a concealed effect has that kind.
fn believed(truth: &Truth, entry: &Entry) -> Vec<Believed> {
    let right = |kind: &String| {
        truth.concealed.iter().any(|part| {
            // The column is that of the entry, whatever the kind.
            let named = Entry { kind: kind.clone(), equivalents: vec![], ..entry.clone() };
            matches(part, &named, false)
        })
    };
    let one = |(kind, p): (&String, &f64)| Believed { probability: *p, right: right(kind) };
    entry.probabilities.iter().map(one).collect()
}

fn intervals(truth: &Truth, answer: &Answer) -> Vec<Held> {
    let mut all = vec![];
    for part in &truth.concealed {
        let Some(entry) = answer.effects.iter().find(|e| e.kind == part.kind && matches(part, e, false))
        else {
            continue;
        };
        for (name, real) in &part.parameters {
            if let Some([low, high]) = entry.parameters.get(name).and_then(|p| p.ci95) {
                all.push(Held { of: format!("{} {name}", part.kind), holds: (low..=high).contains(real) });
            }
        }
    }
    all
}

fn explained(truth: &Truth, answer: &Answer, time_s: &[f64]) -> Option<f64> {
    let parts: Vec<&Concealed> = truth.concealed.iter().filter(|p| p.possible.is_some()).collect();
    let variance = |x: &[f64]| {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        x.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / x.len() as f64
    };
    let (mut could, mut all) = (0.0, 0.0);
    for part in &parts {
        let own = variance(&part.contribution_deg_h);
        could += part.possible.unwrap_or(0.0) * own;
        all += own;
    }
    if parts.is_empty() || all == 0.0 || could < 0.05 * all {
        return None;
    }
    let real = truth.contribution();
    let said = answer.correction_at(time_s);
    let left: Vec<f64> = match said.is_empty() {
        true => real.clone(),
        false => real.iter().zip(&said).map(|(r, s)| r - s).collect(),
    };
    Some(((1.0 - variance(&left) / variance(&real)) / (could / all)).clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::collections::BTreeMap;

    fn truth() -> Truth {
        Truth {
            case: "one".into(),
            half: Half::Development,
            family: Family::Driver,
            strength: Some(Strength::Clear),
            subject: "column_linear".into(),
            decoys: vec!["field_uT".into()],
            concealed: vec![Concealed {
                kind: "column_driver".into(),
                subject: "column_linear".into(),
                same: vec![],
                beside: vec!["supply_sensitivity".into()],
                column: Some("pressure_hPa".into()),
                law: Some("linear".into()),
                parameters: BTreeMap::from([("coefficient".into(), 2.0)]),
                places: vec![Place::new("driver", 990.0, 1010.0)],
                gain: Some(100.0),
                possible: Some(0.9),
                contribution_deg_h: vec![0.0, 1.0, 2.0, 3.0],
            }],
        }
    }

    fn answer(effects: serde_json::Value, correction: Vec<[f64; 2]>) -> Answer {
        Answer::of(&json!({"verdict": "mismatch", "effects": effects}), correction).unwrap()
    }

    #[test]
    fn a_right_answer_scores_in_everything() {
        let entry = json!({"kind": "column_driver", "column": "pressure_hPa", "law": "linear", "equivalents": [],
            "parameters": {"coefficient": {"value": 2.1, "ci95": [1.8, 2.4]}},
            "where": {"domain": "driver", "from": 992.0, "to": 1011.0}});
        let answer = answer(json!([entry]), vec![[0.0, 5.0], [3.0, 8.0]]);
        let score = Score::of(&truth(), &answer, &[0.0, 1.0, 2.0, 3.0], Some("consistent"));
        assert!(score.detected && score.named_first && score.named && score.located && score.found == 1);
        assert_eq!(
            (score.extra, score.decoys_named, score.law, score.closes),
            (0, 0, Some(true), Some(true))
        );
        assert_eq!(score.intervals, [Held { of: "column_driver coefficient".into(), holds: true }]);
        assert_eq!(score.explained, Some(1.0));
    }

    #[test]
    fn a_wrong_column_is_a_wrong_name() {
        let entry = json!({"kind": "column_driver", "column": "field_uT", "where": {"domain": "driver", "from": 0, "to": 1}});
        let score = Score::of(&truth(), &answer(json!([entry]), vec![]), &[0.0, 1.0, 2.0, 3.0], None);
        assert!(!score.named && !score.located && score.found == 0 && score.decoys_named == 1);
        assert_eq!((score.law, score.explained), (None, Some(0.0)));
    }

    #[test]
    fn a_second_name_is_extra_unless_the_physics_shows_it() {
        let right = json!({"kind": "excess_rrw", "equivalents": ["column_driver"], "column": "pressure_hPa"});
        let beside = json!({"kind": "supply_sensitivity"});
        let wrong = json!({"kind": "line"});
        let answer = answer(json!([right, beside, wrong]), vec![]);
        let score = Score::of(&truth(), &answer, &[0.0, 1.0, 2.0, 3.0], Some("mismatch"));
        assert!(
            !score.named_first && score.named && score.extra == 1 && score.closes == Some(false),
            "{score:?}"
        );
    }

    #[test]
    fn the_whole_record_is_no_place_of_a_step() {
        let real = Place::new("time", 100.0, 140.0);
        assert!(overlaps(&Place::new("time", 118.0, 119.0), &real));
        assert!(overlaps(&Place::new("time", 90.0, 150.0), &real));
        assert!(!overlaps(&Place::new("time", 0.0, 1000.0), &real));
        assert!(!overlaps(&Place::new("time", 200.0, 210.0), &real));
        assert!(!overlaps(&Place::new("frequency", 100.0, 140.0), &real));
    }
}
