//! How often a unit of the same population is called unlike its siblings, and one that is not of it.

use crate::bench::chance::Chance;
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::lot::siblings::unlike;

/// What a report says of a unit beside its lot.
pub static STUDY: Study = Study {
    id: "sibling-alarms",
    title: "Units unlike their lot",
    method: "Units have two to six quantities that go together by a common cause; each value has an error of half the spread \
             between units. One more unit is drawn from the same population, or moved in one quantity by four spreads of the \
             values. In some lots a tenth of the siblings is moved as well. Units scatter normally, or as Student's t of 5 degrees \
             of freedom. The generator uses no code of the program.",
    records: 2000,
    cases,
};

/// Probability below which a unit is called unlike.
const ALARM: f64 = 0.01;
/// Error of a value in spreads between units, and share of the common cause in the variance between units.
const ERROR: f64 = 0.5;
const COMMON: f64 = 0.4;
/// How far a moved unit is, in spreads of the values; and how many units are drawn for each that is moved: an unlike unit takes
/// all the lots that the program simulates, a like one few.
const MOVED: f64 = 4.0;
const MOVED_PER_UNIT: u64 = 20;

#[derive(Debug, Clone, Copy)]
struct Design {
    siblings: usize,
    quantities: usize,
    heavy: bool,
    outlying: bool,
}

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for (heavy, outlying) in [(false, false), (true, false), (false, true)] {
        for (siblings, quantities) in [(9, 2), (29, 2), (29, 6), (99, 6)] {
            let design = Design { siblings, quantities, heavy, outlying };
            let law = if heavy { "heavy tails" } else { "normal" };
            let moved = if outlying { ", a tenth of them moved" } else { "" };
            let name = format!("{siblings} siblings, {quantities} quantities, {law}{moved}");
            let first = 73_000_000 + 100_000 * cases.len() as u64;
            cases.push(Case::new(name, move |records, seed| {
                design.rows(records, first + 10_000_000 * (seed - 1))
            }));
        }
    }
    cases
}

impl Design {
    fn rows(self, records: u64, first: u64) -> Vec<Row> {
        let moved_units = records.div_ceil(MOVED_PER_UNIT);
        let alarms = |moved: bool| {
            let of = if moved { moved_units } else { records };
            let seeds = (first..first + of).into_par_iter();
            seeds.filter(|seed| self.alarm(*seed, moved)).count() as u64
        };
        // What is promised is promised for normal units.
        let asked = match (self.heavy, self.outlying) {
            (false, false) => Asked::Between(0.8 * ALARM, 1.2 * ALARM),
            (false, true) => Asked::AtMost(1.2 * ALARM),
            (true, _) => Asked::Nothing,
        };
        vec![
            Row::share(
                "a unit of the population",
                "called unlike, of 1 % stated",
                asked,
                alarms(false),
                records,
            ),
            Row::share(
                "a unit moved by four spreads",
                "called unlike",
                Asked::Nothing,
                alarms(true),
                moved_units,
            ),
        ]
    }

    fn alarm(self, seed: u64, moved: bool) -> bool {
        let mut chance = Chance::new(seed);
        let spread = (1.0 + ERROR * ERROR).sqrt();
        let outlying = if self.outlying { self.siblings.div_ceil(10) } else { 0 };
        let siblings: Vec<Vec<f64>> = (0..self.siblings)
            .map(|i| {
                let mut unit = self.unit(&mut chance);
                unit[0] += if i < outlying { MOVED * spread } else { 0.0 };
                unit
            })
            .collect();
        let mut unit = self.unit(&mut chance);
        unit[self.quantities - 1] += if moved { MOVED * spread } else { 0.0 };
        unlike(&unit, &siblings).is_some_and(|found| found.p_value < ALARM)
    }

    fn unit(self, chance: &mut Chance) -> Vec<f64> {
        let squares: f64 = (0..5).map(|_| chance.normal().powi(2)).sum();
        let tail = if self.heavy { 1.0 / (squares / 5.0).sqrt() } else { 1.0 };
        let common = COMMON.sqrt() * chance.normal();
        (0..self.quantities)
            .map(|_| tail * (common + (1.0 - COMMON).sqrt() * chance.normal()) + ERROR * chance.normal())
            .collect()
    }
}
