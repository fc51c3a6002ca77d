//! Sums over the records of one mix.

use super::mixes::Quantity;
use crate::coverage::median;

/// The methods of the comparison: our claims, our most likely values whether claimed or not, and the usual ones.
pub const METHODS: [&str; 7] =
    ["Sagnac", "Sagnac, most likely", "log-log LSQ", "slopes", "minimum/0.664", "NNLS", "GMWM, given"];

/// One value of one method in one record, relative to the truth; `None`: not found.
pub type Relative = Option<f64>;

/// What one record says about one quantity.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// Relative values of [`METHODS`].
    pub values: [Relative; METHODS.len()],
    /// Whether our 95 % interval holds the truth, and its width over the truth.
    pub interval: Option<(bool, f64)>,
    /// Whether our upper limit lies above the truth.
    pub limit: Option<bool>,
    /// Relative value of the oracle.
    pub oracle: f64,
    /// Whether the interval of the oracle holds the truth, and its width over the truth.
    pub oracle_interval: Option<(bool, f64)>,
    /// Rise of the deviance when other slow terms stand for this one.
    pub rise: Option<f64>,
}

/// One record.
#[derive(Debug, Clone, Default)]
pub struct Judged {
    /// One for each quantity of the mix.
    pub outcomes: Vec<Outcome>,
    /// Absent terms that are claimed.
    pub false_claims: Vec<&'static str>,
    /// A filter taken for a Markov process or the reverse: Δ ln L in favour of the truth.
    pub swap: Option<f64>,
    /// Whether the fit covers a part of the frequencies or widens its intervals.
    pub restricted: bool,
}

/// One mix over many records.
pub struct Tally {
    /// Name of the mix.
    pub name: &'static str,
    /// Length of a record, h.
    pub hours: f64,
    /// What an identification should give.
    pub quantities: Vec<Quantity>,
    /// Relative Cramér-Rao bounds of these.
    pub bounds: Vec<f64>,
    /// What each record says.
    pub records: Vec<Judged>,
}

/// Share; NaN of none.
pub fn share(part: usize, of: usize) -> f64 {
    if of == 0 { f64::NAN } else { part as f64 / of as f64 }
}

/// Root mean square of relative values about 1.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(s, n), v| (s + (v - 1.0).powi(2), n + 1));
    if count == 0 { f64::NAN } else { (sum / f64::from(count)).sqrt() }
}

/// What a method does with a quantity.
pub struct Error {
    /// Share of the records in which it is found.
    pub found: f64,
    /// Rms relative error over the records in which it is found.
    pub of_found: f64,
    /// The same with −100 % where it is not.
    pub of_all: f64,
}

impl Tally {
    /// What every record says of a quantity.
    pub fn outcomes(&self, quantity: usize) -> impl Iterator<Item = &Outcome> + '_ {
        self.records.iter().filter_map(move |r| r.outcomes.get(quantity))
    }

    /// What a method, by its place in [`METHODS`], does with a quantity.
    pub fn error(&self, quantity: usize, method: usize) -> Error {
        let values = || self.outcomes(quantity).map(move |o| o.values[method]);
        Error {
            found: share(values().flatten().count(), self.records.len()),
            of_found: rms(values().flatten()),
            of_all: rms(values().map(|v| v.unwrap_or(0.0))),
        }
    }

    /// Rms relative error with the structure known.
    pub fn oracle_rms(&self, quantity: usize) -> f64 {
        rms(self.outcomes(quantity).map(|o| o.oracle).filter(|v| v.is_finite()))
    }

    /// Share of intervals that hold the truth, of records with an interval.
    pub fn coverage(&self, quantity: usize) -> (f64, usize) {
        let all: Vec<bool> = self.outcomes(quantity).filter_map(|o| o.interval).map(|i| i.0).collect();
        (share(all.iter().filter(|c| **c).count(), all.len()), all.len())
    }

    /// Share of the intervals with the structure known that hold the truth.
    pub fn oracle_coverage(&self, quantity: usize) -> f64 {
        let all: Vec<bool> = self.outcomes(quantity).filter_map(|o| o.oracle_interval).map(|i| i.0).collect();
        share(all.iter().filter(|c| **c).count(), all.len())
    }

    /// Median over records of the width of our interval over that of the oracle.
    pub fn width_ratio(&self, quantity: usize) -> f64 {
        let ratio = |o: &Outcome| Some(o.interval?.1 / o.oracle_interval?.1);
        median(&self.outcomes(quantity).filter_map(ratio).collect::<Vec<f64>>())
    }

    /// Share of the records with a false claim.
    pub fn false_share(&self) -> f64 {
        share(self.records.iter().filter(|r| !r.false_claims.is_empty()).count(), self.records.len())
    }

    /// Records with false claims, those left out in which only a filter and a Markov process are exchanged and the
    /// record itself hardly prefers the truth.
    pub fn false_share_beyond_swaps(&self) -> f64 {
        let wrong = |r: &&Judged| {
            let within = r.swap.is_some_and(|d| d < 3.0);
            r.false_claims.iter().any(|c| !(within && (*c == "filter" || *c == "Markov")))
        };
        share(self.records.iter().filter(wrong).count(), self.records.len())
    }

    /// Shares of records in which each absent term is claimed.
    pub fn false_by_term(&self) -> Vec<(&'static str, f64)> {
        ["N", "B", "K", "Q", "R", "Markov", "quasi-periodic", "filter"]
            .into_iter()
            .map(|t| {
                let count = self.records.iter().filter(|r| r.false_claims.contains(&t)).count();
                (t, share(count, self.records.len()))
            })
            .filter(|(_, s)| *s > 0.0)
            .collect()
    }
}
