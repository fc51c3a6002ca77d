//! Scores as rows of a study.

use super::kinds::catalogued;
use super::table::{Row, Tally};
use crate::study::{self, Asked};
use std::collections::BTreeMap;

/// Lower ends of the bands of strength in which detection is reported.
const STRENGTHS: [f64; 7] = [0.0, 7.0, 14.0, 28.0, 56.0, 110.0, 220.0];

/// What correct claims must give: hardly an alarm, and figures that agree with the verdict.
pub fn of_nulls(rows: &[Row]) -> Vec<study::Row> {
    let t = Tally::of(rows.iter().filter(|r| r.score.null));
    let share =
        |claim: &str, asked, hits| study::Row::share("null", claim, asked, hits as u64, t.cases as u64);
    vec![
        share("a correct claim is called a mismatch", Asked::AtMost(0.015), t.detected),
        share("figures of fit are finite and agree with the verdict", Asked::AtLeast(1.0), t.sane),
    ]
}

/// What clear cases of effects of the catalogue must give, all kinds together.
pub fn of_clear(rows: &[Row]) -> Vec<study::Row> {
    let known = |r: &&Row| !r.score.null && catalogued(&r.score.kind);
    let t = Tally::of(rows.iter().filter(known));
    let share = |claim: &str, least, hits| shared("all kinds", claim, Asked::AtLeast(least), hits, t.cases);
    let mut rows = vec![
        share("detected", 0.99, t.detected),
        share("the right name comes first", 0.85, t.first),
        share("the right name or an equivalent", 0.95, t.class),
        share("located", 0.90, t.located),
        shared(
            "all kinds",
            "95 % intervals hold the truth",
            Asked::Between(0.93, 0.97),
            t.inside,
            t.intervals,
        ),
    ];
    let ratio = |claim: &str, asked, value: Option<f64>| {
        study::Row::number("all kinds", claim, asked, value.unwrap_or(f64::NAN), t.cases as u64)
    };
    rows.extend([
        ratio("median width over that of a fit that knows the truth", Asked::AtMost(1.3), t.width_ratio),
        ratio("median removed variance over that of such a fit", Asked::AtLeast(0.9), t.removed_ratio),
    ]);
    rows
}

/// Closed loop: what the augmented claim says of four recordings.
pub fn of_loop(rows: &[Row]) -> Vec<study::Row> {
    let t = Tally::of(rows.iter());
    let claims = [
        ("the augmented claim fits the same recording", Asked::AtLeast(0.95)),
        ("the augmented claim fits a fresh one", Asked::AtLeast(0.95)),
        ("the augmented claim does not fit one of another case", Asked::AtLeast(0.95)),
        ("the augmented claim does not fit one without the effect", Asked::Nothing),
    ];
    let row =
        |((claim, asked), hits): ((&str, Asked), usize)| shared("all kinds", claim, asked, hits, t.looped);
    claims.into_iter().zip(t.loops).map(row).collect()
}

/// What pairs of effects must give.
pub fn of_pairs(rows: &[Row]) -> Vec<study::Row> {
    let t = Tally::of(rows.iter().filter(|r| r.score.kind == "pair"));
    vec![
        shared("pair", "both are named", Asked::AtLeast(0.8), t.all_named, t.cases),
        shared("pair", "a third one is named", Asked::AtMost(0.05), t.surplus, t.cases),
    ]
}

/// What effects of no catalogue must give, or such as were taken out of it.
pub fn of_unknown(rows: &[Row]) -> Vec<study::Row> {
    let right = rows.iter().filter(|r| r.score.class && r.score.located).count();
    let claim = "unknown or a replacement, in the right place";
    vec![shared("all kinds", claim, Asked::AtLeast(0.75), right, rows.len())]
}

/// Every kind for itself.
pub fn of_kinds(rows: &[Row]) -> Vec<study::Row> {
    let mut kinds: BTreeMap<&str, Vec<&Row>> = BTreeMap::new();
    rows.iter().for_each(|r| kinds.entry(&r.score.kind).or_default().push(r));
    kinds.iter().flat_map(|(kind, of)| reported(kind, &Tally::of(of.iter().copied()))).collect()
}

/// Every band of strength.
pub fn of_strengths(rows: &[Row]) -> Vec<study::Row> {
    let band = |(i, low): (usize, &f64)| {
        let high = STRENGTHS.get(i + 1).copied().unwrap_or(f64::INFINITY);
        let inside = |r: &&Row| r.score.strength.is_some_and(|s| (*low..high).contains(&s));
        reported(&format!("strength from {low}"), &Tally::of(rows.iter().filter(inside)))
    };
    STRENGTHS.iter().enumerate().flat_map(band).collect()
}

/// Intervals by kind and parameter.
pub fn of_parameters(rows: &[Row]) -> Vec<study::Row> {
    let mut found: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for row in rows {
        for c in &row.score.covered {
            let entry = found.entry(format!("{} {}", row.score.kind, c.name)).or_default();
            entry.0 += usize::from(c.inside);
            entry.1 += 1;
        }
    }
    let row = |(name, (inside, all)): (&String, &(usize, usize))| {
        shared(name, "95 % interval of the parameter holds the truth", Asked::Nothing, *inside, *all)
    };
    found.iter().map(row).collect()
}

fn reported(name: &str, t: &Tally) -> Vec<study::Row> {
    if t.cases == 0 {
        return vec![];
    }
    let share = |claim: &str, hits| shared(name, claim, Asked::Nothing, hits, t.cases);
    let mut rows = vec![
        share("detected", t.detected),
        share("the right name comes first", t.first),
        share("the right name or an equivalent", t.class),
        share("located", t.located),
        share("called unknown", t.unknown),
        share("held-out likelihood gains", t.held_out),
    ];
    if t.intervals > 0 {
        rows.push(shared(name, "95 % intervals hold the truth", Asked::Nothing, t.inside, t.intervals));
    }
    if let Some(removed) = t.removed {
        let claim = "median share of the variance that the correction removes";
        rows.push(study::Row::number(name, claim, Asked::Nothing, removed, t.cases as u64));
    }
    rows
}

fn shared(quantity: &str, claim: &str, asked: Asked, hits: usize, of: usize) -> study::Row {
    study::Row::share(quantity, claim, asked, hits as u64, of as u64)
}
