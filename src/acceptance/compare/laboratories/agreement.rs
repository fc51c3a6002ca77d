//! Whether two values of one quantity agree: their difference over its expanded uncertainty (E_n of ISO/IEC 17043), where errors that
//! both have in common drop out.

use super::given::Given;
use crate::acceptance::changes::same_instruments;
use crate::config::procedure::site::Site;
use crate::estimate::{CommonTo, Component, InputQuantity, SCORE_TWO_SIDED_95};
use crate::record::{InstrumentRecord, MeasurandRecord};
use serde::{Deserialize, Serialize};

/// Whether two values agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Agreement {
    /// The difference lies within its expanded uncertainty, or a value within the bound of the other.
    Agrees,
    /// It lies beyond.
    Differs,
    /// Nothing tells: a value or its interval is missing, or a check contradicts one of them.
    Undecided,
}

impl Agreement {
    /// Word of it in a result.
    pub fn id(self) -> &'static str {
        match self {
            Agreement::Agrees => "agrees",
            Agreement::Differs => "differs",
            Agreement::Undecided => "undecided",
        }
    }
}

/// A difference with its uncertainty, in the unit of the rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Second value less the first.
    pub difference: f64,
    /// Expanded uncertainty of the difference, 95 %, without what is common.
    pub expanded: f64,
    /// The difference over it.
    pub en: f64,
    /// Standard uncertainty of the second value that the first shares, which dropped out.
    pub common: f64,
}

impl Score {
    /// True where the difference lies within its uncertainty.
    pub fn agrees(&self) -> bool {
        self.en.abs() <= 1.0
    }
}

/// What two results have in common.
pub struct Common<'a> {
    benches: [&'a [InstrumentRecord]; 2],
    /// True where all instruments are the same.
    one_bench: bool,
    /// True where both were recorded on one bench at one known site, with one orientation.
    one_site: bool,
}

impl<'a> Common<'a> {
    /// Of two results.
    pub(super) fn of(first: &Given<'a>, second: &Given<'a>) -> Common<'a> {
        let benches = [first.record.instruments.as_slice(), second.record.instruments.as_slice()];
        let place = |site: &Site| (site.latitude_deg, site.heading_deg, site.elevation_deg);
        let places = [first, second].map(|g| g.site.as_ref().map(place));
        // Two laboratories may have a chamber each: only serial numbers tell that it is the same one.
        let known = |bench: &[InstrumentRecord]| {
            !bench.is_empty()
                && bench.iter().all(|i| i.serial.as_deref().is_some_and(|s| !s.trim().is_empty()))
        };
        let one_bench = known(benches[0]) && same_instruments(benches[0], benches[1]);
        let one_site = one_bench && places[0].is_some() && places[0] == places[1];
        Common { benches, one_bench, one_site }
    }

    /// True where both were recorded with the same instruments.
    pub(super) fn is_one_bench(&self) -> bool {
        self.one_bench
    }

    /// True where both results share the error of an input.
    fn shares(&self, input: InputQuantity, to: CommonTo) -> bool {
        match to {
            CommonTo::Site => self.one_site,
            CommonTo::Table | CommonTo::Thermometer | CommonTo::InfluenceSource => {
                self.one_bench || self.one_instrument(input)
            }
            CommonTo::Inputs => false,
        }
    }

    /// True where the certificate of one instrument states the component of both.
    fn one_instrument(&self, input: InputQuantity) -> bool {
        let of = |bench: &'a [InstrumentRecord]| {
            let own = bench.iter().find(|i| i.component == Some(input))?;
            Some((own.name.text().to_owned(), own.serial.as_deref().filter(|s| !s.trim().is_empty())?))
        };
        let [first, second] = self.benches.map(of);
        first.is_some() && first == second
    }
}

/// The difference of two rows with its uncertainty; `None` where one has no value or no interval, or is contradicted.
pub fn score(first: &MeasurandRecord, second: &MeasurandRecord, common: &Common<'_>) -> Option<Score> {
    if [first, second].iter().any(|r| !r.objections.is_empty()) {
        return None;
    }
    let (x, y) = (first.value?, second.value?);
    let (a, b) = (first.interval?, second.interval?);
    let shared: Vec<(f64, f64)> = first
        .budget
        .iter()
        .filter(|c| c.common_to.is_some_and(|to| common.shares(c.input, to)))
        .filter_map(|c| Some((signed(c), signed(second.budget.iter().find(|o| o.input == c.input)?))))
        .collect();
    // A sum of nothing would be minus zero.
    let variance = |of: fn(&(f64, f64)) -> f64| shared.iter().fold(0.0, |sum, c| sum + of(c).powi(2));
    let (of_first, of_second) = (variance(|c| c.0), variance(|c| c.1));
    // Of an error that both have, only that remains by which they respond to it differently.
    let rest = SCORE_TWO_SIDED_95 * variance(|c| c.1 - c.0).sqrt();
    // The sides that lie between the two values.
    let (of_x, of_y) = if y >= x { (a.high - x, y - b.low) } else { (x - a.low, b.high - y) };
    let expanded = own(of_x, first, of_first).hypot(own(of_y, second, of_second)).hypot(rest);
    let difference = y - x;
    let en = difference / expanded;
    en.is_finite().then_some(Score { difference, expanded, en, common: of_second.sqrt() })
}

/// A component with the sign of its sensitivity.
fn signed(component: &Component) -> f64 {
    component.contribution.copysign(component.sensitivity)
}

/// Half an interval without what is common.
fn own(half: f64, row: &MeasurandRecord, common_variance: f64) -> f64 {
    let whole: f64 = row.budget.iter().map(|c| c.contribution * c.contribution).sum();
    let share = if whole > 0.0 { (common_variance / whole).clamp(0.0, 1.0) } else { 0.0 };
    half * (1.0 - share).sqrt()
}

/// Whether two rows agree, by their score where they have one and else by a bound.
pub(super) fn agreement(
    first: &MeasurandRecord,
    second: &MeasurandRecord,
    score: Option<&Score>,
) -> Agreement {
    if let Some(score) = score {
        return if score.agrees() { Agreement::Agrees } else { Agreement::Differs };
    }
    if [first, second].iter().any(|r| !r.objections.is_empty()) {
        return Agreement::Undecided;
    }
    let within = |low: f64, bound: f64| if low <= bound { Agreement::Agrees } else { Agreement::Differs };
    match (
        (first.value, first.interval, first.upper_limit),
        (second.value, second.interval, second.upper_limit),
    ) {
        ((Some(_), Some(interval), _), (None, _, Some(bound)))
        | ((None, _, Some(bound)), (Some(_), Some(interval), _)) => within(interval.low, bound.value),
        _ => Agreement::Undecided,
    }
}
