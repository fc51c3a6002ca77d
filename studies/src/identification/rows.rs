//! The tally of a mix as rows of a study.

use super::mixes::Kind;
use super::rivals::TELLING;
use super::run::IDENTIFIABLE;
use super::tally::{METHODS, Tally};
use crate::study::{Asked, Row};
use sagnac::noise::data::NoiseType;

/// The first of the methods are ours.
const OURS: usize = 2;
/// A method that finds a term in fewer records is not compared.
const OFTEN: f64 = 0.5;

/// Rows on every quantity, on false claims, and on the usual methods.
pub(super) fn rows(tally: &Tally) -> Vec<Row> {
    let mut rows: Vec<Row> = (0..tally.quantities.len()).flat_map(|i| of_quantity(tally, i)).collect();
    rows.extend(of_false_claims(tally));
    rows.extend((0..tally.quantities.len()).flat_map(|i| of_methods(tally, i)));
    rows
}

fn of_quantity(tally: &Tally, i: usize) -> Vec<Row> {
    let (records, bound) = (tally.records.len() as u64, tally.bounds[i]);
    let quantity = &tally.quantities[i];
    let identifiable = bound <= IDENTIFIABLE;
    let asked = |asked: Asked| if identifiable { asked } else { Asked::Nothing };
    let share = |claim: &str, asked, hits, of| Row::share(quantity.label, claim, asked, hits, of);
    let number = |claim: &str, asked, value, of| Row::number(quantity.label, claim, asked, value, of);
    let count = |which: &dyn Fn(&super::tally::Outcome) -> bool| {
        tally.outcomes(i).filter(|o| which(o)).count() as u64
    };
    let found = count(&|o| o.values[0].is_some());
    let (intervals, held) = (count(&|o| o.interval.is_some()), count(&|o| o.interval.is_some_and(|i| i.0)));
    let mut rows = vec![
        number("Cramér-Rao bound, %", Asked::Nothing, 100.0 * bound, records),
        share("found", asked(Asked::AtLeast(0.95)), found, records),
    ];
    if found > 0 && bound.is_finite() {
        let wanted = if quantity.kind == Kind::Coefficient(NoiseType::AngleRandomWalk) { 1.1 } else { 1.3 };
        let ratio = tally.error(i, 0).of_found / bound;
        // Two standard errors of a root mean square.
        let slack = 2.0 / (2.0 * records as f64).sqrt();
        let interval = [ratio * (1.0 - slack), ratio * (1.0 + slack)];
        let claim = "rms error over the bound, where found";
        rows.push(Row::estimate(quantity.label, claim, asked(Asked::AtMost(wanted)), ratio, interval, found));
        let oracle = tally.oracle_rms(i) / bound;
        rows.push(number("rms error over the bound, structure known", Asked::Nothing, oracle, records));
    }
    if intervals > 0 {
        let range = asked(Asked::Between(0.93, 0.97));
        rows.push(share("95 % interval holds the truth", range, held, intervals));
        let width = tally.width_ratio(i);
        rows.push(number(
            "width over that with the structure known",
            asked(Asked::AtMost(1.2)),
            width,
            intervals,
        ));
    }
    let (limits, below) = (count(&|o| o.limit.is_some()), count(&|o| o.limit == Some(true)));
    if limits > 0 {
        let asked = if identifiable { Asked::Nothing } else { Asked::AtLeast(0.95) };
        rows.push(share("the upper limit lies above the truth", asked, below, limits));
    }
    let told: Vec<f64> = tally.outcomes(i).filter_map(|o| o.rise).collect();
    if !told.is_empty() {
        let hits = told.iter().filter(|r| **r > TELLING).count() as u64;
        rows.push(share("the record itself shows the term", Asked::Nothing, hits, told.len() as u64));
    }
    rows
}

fn of_false_claims(tally: &Tally) -> Vec<Row> {
    let records = tally.records.len() as u64;
    let share = |quantity: &str, claim: &str, asked, share: f64| {
        Row::share(quantity, claim, asked, (share * records as f64).round() as u64, records)
    };
    let claim = "an absent term is claimed";
    let beyond = "an absent term is claimed, exchanges of filter and Markov process that the record cannot tell left out";
    let mut rows = vec![
        share("all terms", claim, Asked::AtMost(0.07), tally.false_share()),
        share("all terms", beyond, Asked::AtMost(0.07), tally.false_share_beyond_swaps()),
    ];
    rows.extend(
        tally.false_by_term().into_iter().map(|(term, part)| share(term, claim, Asked::Nothing, part)),
    );
    let restricted = tally.records.iter().filter(|r| r.restricted).count() as u64;
    rows.push(Row::share("fit", "range restricted or interval widened", Asked::Nothing, restricted, records));
    rows
}

/// Relative rms errors of the methods, −100 % where nothing is found, and ours over the smallest of the usual ones.
fn of_methods(tally: &Tally, i: usize) -> Vec<Row> {
    let records = tally.records.len() as u64;
    let label = tally.quantities[i].label;
    let errors: Vec<_> = (0..METHODS.len()).map(|m| tally.error(i, m)).collect();
    let mut rows = vec![];
    for (name, error) in METHODS.iter().zip(&errors).filter(|(_, e)| e.found > 0.0) {
        let claim = format!("relative rms error, %, not found counts as −100 %: {name}");
        rows.push(Row::number(label, claim, Asked::Nothing, 100.0 * error.of_all, records));
    }
    let smallest = |some: &mut dyn Iterator<Item = f64>| some.fold(f64::INFINITY, f64::min);
    let usual = errors[OURS..].iter().filter(|e| e.found >= OFTEN && e.of_all.is_finite());
    let best = smallest(&mut usual.map(|e| e.of_all));
    let ours = smallest(&mut errors[..OURS].iter().map(|e| e.of_all));
    if best.is_finite() {
        // Not found at all: as far off as zero is.
        let ours = if ours.is_finite() { ours } else { 1.0 };
        // Two root mean squares of so many records differ by chance by this much at most.
        let chance = 2.0 / (records as f64).sqrt();
        let ratio = ours / best;
        let asked = if tally.bounds[i] <= IDENTIFIABLE { Asked::AtMost(1.0) } else { Asked::Nothing };
        let interval = [ratio * (1.0 - chance), ratio * (1.0 + chance)];
        let claim = "rms error over the smallest of the usual methods";
        rows.push(Row::estimate(label, claim, asked, ratio, interval, records));
    }
    rows
}
