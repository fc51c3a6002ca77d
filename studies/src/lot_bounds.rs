//! Bounds and medians of simulated lots against the population that they are drawn from.

use crate::bench::chance::Chance;
use crate::study::{Asked, Case, Row, Study};
use rayon::prelude::*;
use sagnac::lot::population::{Of, Population, Reading, Side, Unit};
use sagnac::lot::tolerance::Promise;

/// What a data sheet promises.
pub static STUDY: Study = Study {
    id: "lot-bounds",
    title: "Bounds of lots",
    method: "Lots are drawn from a population of known median and spread, in sub-lots that differ by a third of the spread \
             between units; every value has an error of half that spread. In some, the lowest 30 % of readings are only bounded, by a limit of \
             detection, each by its own upper limit of 95 %, or all by the upper limit that the limit of detection has. Units scatter normally, or as Student's t of 5 degrees of freedom, on the scale of the quantity. The \
             generator uses no code of the program.",
    records: 300,
    cases,
};

/// The promise that is tested.
const PROMISE: Promise = Promise { proportion: 0.95, confidence: 0.95 };
/// Error of a value, and spread between lots, in spreads between units.
const ERROR: f64 = 0.5;
const BETWEEN_LOTS: f64 = 1.0 / 3.0;
/// Share of the units that are only bounded.
const BOUNDED: f64 = 0.3;
/// The 95 % point of a standard normal number, and of Student's t of 5 degrees of freedom.
const NORMAL_95: f64 = 1.644_854;
const STUDENT_95: f64 = 2.015_048;

/// Which units are only bounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bounded {
    /// None.
    None,
    /// Those whose reading lies below a limit of detection; they are known to lie below it.
    Reading,
    /// The same units, each with the upper limit of 95 % of its own reading.
    Confidence,
    /// The same units, all with the upper limit of 95 % that a reading at the limit of detection has.
    Common,
}

/// How a lot is drawn.
#[derive(Debug, Clone, Copy)]
struct Design {
    units: usize,
    lots: usize,
    bounded: Bounded,
    heavy: bool,
}

fn cases() -> Vec<Case> {
    let mut cases = vec![];
    for heavy in [false, true] {
        for bounded in [Bounded::None, Bounded::Reading, Bounded::Confidence, Bounded::Common] {
            if bounded == Bounded::Common && heavy {
                continue;
            }
            for (units, lots) in [(10, 1), (30, 1), (30, 3), (30, 6), (100, 1), (100, 6)] {
                let design = Design { units, lots, bounded, heavy };
                let law = if heavy { "heavy tails" } else { "normal" };
                let known = match bounded {
                    Bounded::None => "",
                    Bounded::Reading => ", 30 % of the readings below a limit",
                    Bounded::Confidence => ", 30 % with a confidence limit of their own",
                    Bounded::Common => ", 30 % with a common confidence limit",
                };
                let name = format!("{units} units in {lots} lots, {law}{known}");
                let first = 71_000_000 + 100_000 * cases.len() as u64;
                cases.push(Case::new(name, move |records, seed| {
                    design.rows(records, first + 10_000_000 * (seed - 1))
                }));
            }
        }
    }
    cases
}

impl Design {
    fn rows(self, records: u64, first: u64) -> Vec<Row> {
        let found: Vec<[bool; 3]> =
            (first..first + records).into_par_iter().filter_map(|seed| self.one(seed)).collect();
        let of = found.len() as u64;
        let count = |i: usize| found.iter().filter(|f| f.get(i) == Some(&true)).count() as u64;
        // With lots of which some are few the promise errs to the safe side.
        let asked = Asked::AtLeast(0.93);
        let promise = "95/95 bound holds";
        vec![
            Row::share("true values", promise, asked, count(0), of),
            Row::share("measured values", promise, asked, count(1), of),
            Row::share("median", "95 % interval holds the truth", Asked::AtLeast(0.93), count(2), of),
        ]
    }

    /// Whether the bounds of true and of measured values and the interval of the median hold; `None` where nothing is promised.
    fn one(self, seed: u64) -> Option<[bool; 3]> {
        let mut chance = Chance::new(seed);
        let between = if self.lots > 1 { BETWEEN_LOTS } else { 0.0 };
        let lots: Vec<f64> = (0..self.lots).map(|_| between * chance.normal()).collect();
        let mut readings: Vec<(usize, f64)> = (0..self.units)
            .map(|i| {
                let lot = i % self.lots;
                let own = lots.get(lot).copied().unwrap_or(0.0) + self.unit(&mut chance);
                (lot, own + ERROR * chance.normal())
            })
            .collect();
        readings.sort_by(|a, b| a.1.total_cmp(&b.1));
        let few = if self.bounded == Bounded::None { 0 } else { (BOUNDED * self.units as f64) as usize };
        let limit = readings.get(few).map_or(0.0, |r| r.1);
        let units: Vec<Unit> = readings
            .iter()
            .enumerate()
            .map(|(i, (lot, value))| {
                let reading = if i < few {
                    let bound = match self.bounded {
                        Bounded::Confidence => value + NORMAL_95 * ERROR,
                        Bounded::Common => limit + NORMAL_95 * ERROR,
                        Bounded::None | Bounded::Reading => limit,
                    };
                    Reading::AtMost { bound, standard: ERROR }
                } else {
                    Reading::Value { value: *value, standard: ERROR }
                };
                Unit { lot: *lot, reading }
            })
            .collect();
        let found = Population::of(&units)?;
        let at = |of: Of| found.bound(of, Side::Upper, PROMISE).map(|b| b.value);
        let median = found.typical(0.95);
        let (of_true, of_measured) = (at(Of::True)?, at(Of::Measured)?);
        Some([
            self.share_below(of_true, between) >= 0.95,
            self.share_below(of_measured, between.hypot(ERROR)) >= 0.95,
            median.low <= 0.0 && median.high >= 0.0,
        ])
    }

    /// A unit about its lot.
    fn unit(self, chance: &mut Chance) -> f64 {
        let z = chance.normal();
        if !self.heavy {
            return z;
        }
        let squares: f64 = (0..5).map(|_| chance.normal().powi(2)).sum();
        z / (squares / 5.0).sqrt()
    }

    /// The share of the population below a value, with a normal part of some deviation beside the units.
    fn share_below(self, value: f64, beside: f64) -> f64 {
        if !self.heavy {
            return normal_below(value / 1.0_f64.hypot(beside));
        }
        if beside == 0.0 {
            return if value >= STUDENT_95 { 1.0 } else { 0.0 };
        }
        // Student's density of 5 degrees of freedom, folded with the normal part.
        let density = |t: f64| 0.379_606_689_8 * (1.0 + t * t / 5.0).powi(-3);
        let step = 0.02;
        let points = (-2000..=2000).map(|i| f64::from(i) * step);
        points.map(|t| step * density(t) * normal_below((value - t) / beside)).sum()
    }
}

/// The normal probability below z (Abramowitz and Stegun 7.1.26, error below 2e-7).
fn normal_below(z: f64) -> f64 {
    let x = z.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let poly =
        ((((1.061_405_429 * t - 1.453_152_027) * t) + 1.421_413_741) * t - 0.284_496_736) * t + 0.254_829_592;
    let tail = 0.5 * poly * t * (-x * x).exp();
    if z > 0.0 { 1.0 - tail } else { tail }
}
