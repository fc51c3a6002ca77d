//! A case: a recording, its claim and the truth.

use super::bench::Bench;
use super::catalogue::{DROPPED, NULL, SUBJECTS, Subject, half};
use super::claim::{Claim, Columns};
use super::dice::Dice;
use super::effect::asked_gain;
use super::motion::Programme;
use super::oracle::Oracle;
use super::truth::{Concealed, Family, Place, Strength, Truth};
use super::unit::body::Pace;
use std::collections::BTreeMap;

/// Benches that are tried for a case before it counts as impossible.
const TRIES: u64 = 16;

/// A recording with its claim and the truth.
pub struct Case {
    /// The truth.
    pub truth: Truth,
    /// The claim.
    pub claim: Claim,
    /// Time of each row, s.
    pub time_s: Vec<f64>,
    /// Rate, deg/h.
    pub rate_deg_h: Vec<f64>,
    /// Other columns.
    pub columns: Columns,
}

/// Makes the case of a subject, a strength and a seed; the strength of a null means nothing. `None` if no subject has the
/// name, or if no bench of this seed lets its effects be as strong as asked.
pub fn make(name: &str, strength: Strength, seed: u64) -> Option<Case> {
    let label = format!("{name}/{}", strength.name());
    let mut dice = (0..TRIES).map(|attempt| Dice::of(&label, seed * TRIES + attempt));
    match name {
        NULL => dice.next().map(|dice| null(dice, seed)),
        DROPPED => dice.next().map(|dice| dropped(dice, strength, seed)),
        _ => {
            let subject = SUBJECTS.iter().find(|s| s.name == name)?;
            dice.find_map(|dice| concealed(subject, strength, dice, seed))
        }
    }
}

fn concealed(subject: &Subject, strength: Strength, dice: Dice, seed: u64) -> Option<Case> {
    let bench = if subject.days { Bench::of_days(dice) } else { Bench::new(dice) };
    on_bench(subject, bench, strength.gains(), Some(strength), seed)
}

/// The case of a subject on a bench, its effects with gains from a range. `None` where they cannot be as strong as asked.
pub fn on_bench(
    subject: &Subject,
    mut bench: Bench,
    gains: [f64; 2],
    strength: Option<Strength>,
    seed: u64,
) -> Option<Case> {
    (subject.scene)(&mut bench);
    let effects: Vec<_> = subject.effects.iter().map(|effect| effect(&mut bench)).collect();
    let oracle = Oracle::new(&bench.claim, &bench.columns, &bench.residual());
    let mut told: Vec<Concealed> = vec![];
    for effect in &effects {
        let asked = asked_gain(&mut bench.dice, gains);
        let hidden = effect.conceal(&mut bench, &oracle, asked)?;
        bench.added.iter_mut().zip(&hidden.added_deg_h).for_each(|(a, h)| *a += h);
        told.push(hidden.told);
    }
    told.sort_by(|a, b| b.gain.unwrap_or(0.0).total_cmp(&a.gain.unwrap_or(0.0)));
    Some(finish(bench, subject.family, subject.name, strength, told, seed))
}

/// The case of a bench with what is concealed in it.
pub fn finish(
    bench: Bench,
    family: Family,
    subject: &str,
    strength: Option<Strength>,
    concealed: Vec<Concealed>,
    seed: u64,
) -> Case {
    let decoys = bench.surroundings.keys().filter(|name| {
        bench.columns.contains_key(*name) && !concealed.iter().any(|c| c.column.as_ref() == Some(name))
    });
    let case = match strength {
        Some(strength) => format!("{subject}-{}-{seed:04}", strength.name()),
        None => format!("{subject}-{seed:04}"),
    };
    let half = half(subject, seed);
    let truth = Truth {
        case,
        half,
        family,
        strength,
        subject: subject.to_owned(),
        decoys: decoys.cloned().collect(),
        concealed,
    };
    Case {
        truth,
        time_s: bench.time_s(),
        rate_deg_h: bench.rate(),
        claim: bench.claim,
        columns: bench.columns,
    }
}

/// A claim that is right, in any of the scenes, with up to five columns that drive nothing.
fn null(mut dice: Dice, seed: u64) -> Case {
    let scene = dice.count(0, 7);
    let mut bench = if scene == 7 { Bench::of_days(dice) } else { Bench::new(dice) };
    match scene {
        1 => bench.warm(true, Pace::Quick),
        2 => bench.warm(false, Pace::Slow),
        3 => bench.turn(Programme::Steps),
        4 => bench.turn(Programme::Swings),
        5 => bench.index(true),
        6 => {
            bench.warm(true, Pace::Quick);
            bench.turn(Programme::Steps);
        }
        _ => {}
    }
    let count = bench.dice.count(0, 5);
    bench.record_others(count);
    finish(bench, Family::Null, NULL, None, vec![], seed)
}

/// Rows that were lost; single ones where it is middling.
fn dropped(mut dice: Dice, strength: Strength, seed: u64) -> Case {
    let table = dice.chance(0.4);
    let mut bench = Bench::new(dice);
    if table {
        bench.turn(Programme::Steps);
    }
    let gaps = match strength {
        Strength::Clear => bench.dice.count(3, 8),
        Strength::Middling => bench.dice.count(1, 3),
    };
    let mut lost: Vec<[usize; 2]> = vec![];
    while lost.len() < gaps {
        let length = match strength {
            Strength::Clear => bench.dice.decades(2.0, 150.0) as usize,
            Strength::Middling => bench.dice.count(1, 2),
        };
        let from = bench.dice.count(10, bench.rows - length - 10);
        if lost.iter().all(|[a, b]| from + length + 2 < *a || from > b + 2) {
            lost.push([from, from + length]);
        }
    }
    lost.sort_unstable();
    let rate_hz = bench.rate_hz;
    let at = |row: usize| (row as f64 + 0.5) / rate_hz;
    let mut places: Vec<Place> =
        lost.iter().map(|[from, to]| Place::new("timestamps", at(from - 1), at(*to))).collect();
    places.push(Place::new("timestamps", at(lost[0][0] - 1), at(lost[gaps - 1][1])));
    let missing: usize = lost.iter().map(|[from, to]| to - from).sum();
    let told = Concealed {
        kind: DROPPED.to_owned(),
        subject: DROPPED.to_owned(),
        same: vec![],
        beside: vec![],
        column: None,
        law: None,
        parameters: BTreeMap::from([("missing_rows".to_owned(), missing as f64)]),
        places,
        gain: None,
        possible: None,
        contribution_deg_h: vec![],
    };
    let mut case = finish(bench, Family::Table, DROPPED, Some(strength), vec![told], seed);
    let kept = |row: usize| !lost.iter().any(|[from, to]| (*from..*to).contains(&row));
    let keep = |values: &mut Vec<f64>| {
        let mut row = 0;
        values.retain(|_| {
            row += 1;
            kept(row - 1)
        });
    };
    keep(&mut case.time_s);
    keep(&mut case.rate_deg_h);
    case.columns.values_mut().for_each(keep);
    case
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::catalogue::names;
    use crate::laboratory::truth::Half;

    #[test]
    fn a_seed_gives_one_recording() {
        for name in ["temp_rate", "quasi_periodic", NULL] {
            let [a, b, other] = [3, 3, 5].map(|seed| make(name, Strength::Clear, seed).unwrap());
            assert!(a.rate_deg_h == b.rate_deg_h && a.columns == b.columns && a.truth == b.truth, "{name}");
            assert_ne!(a.rate_deg_h, other.rate_deg_h, "{name}");
        }
    }

    #[test]
    fn effects_are_as_strong_as_asked() {
        for name in ["temp_hysteresis", "sf_supply", "excess_rrw", "quantization", "heading_change", "chirp"]
        {
            for strength in Strength::ALL {
                let case = make(name, strength, 2).unwrap();
                let [low, high] = strength.gains();
                let gain = case.truth.concealed[0].gain.unwrap();
                assert!((low..=high).contains(&gain), "{name} {strength:?}: {gain}");
            }
        }
    }

    #[test]
    fn what_is_told_is_what_was_added() {
        // The rate less the contribution is that of a right claim: its modes have the variance of the claimed noise.
        let mut case = make("column_linear", Strength::Clear, 4).unwrap();
        let told = case.truth.contribution();
        case.rate_deg_h.iter_mut().zip(&told).for_each(|(r, t)| *r -= t);
        let mean = case.claim.mean(&case.columns, case.rate_deg_h.len());
        let left: Vec<f64> = case.rate_deg_h.iter().zip(mean).map(|(r, m)| r - m).collect();
        let white = Oracle::new(&case.claim, &case.columns, &left).whitened();
        let power = white.iter().map(|x| x * x).sum::<f64>() / white.len() as f64;
        // N may be off by two standard deviations of 2.5 %, its power by twice that.
        assert!((power - 1.0).abs() < 0.12, "{power}");
    }

    #[test]
    fn lost_rows_are_lost_from_every_column() {
        let case = make(DROPPED, Strength::Clear, 1).unwrap();
        let rows = case.time_s.len();
        assert!(case.rate_deg_h.len() == rows && case.columns.values().all(|c| c.len() == rows));
        let whole = ((case.time_s[rows - 1] - case.time_s[0]) * case.claim.rate_hz).round() as usize + 1;
        assert_eq!((whole - rows) as f64, case.truth.concealed[0].parameters["missing_rows"]);
    }

    #[test]
    fn the_halves_share_no_case_and_no_kind_of_unknown_physics() {
        let held = |name: &&str| half(name, 1) == Half::HeldOut;
        let unknown = names(Family::Unknown);
        assert!(unknown.iter().all(|n| half(n, 1) == half(n, 2)));
        let of = unknown.iter().filter(|n| held(n)).count();
        assert!(unknown.len() >= 10 && unknown.len().abs_diff(2 * of) <= 1, "{of} of {}", unknown.len());
        assert_ne!(half("line", 1), half("line", 2));
    }
}
