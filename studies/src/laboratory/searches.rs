//! Number of independent tests that each kind of search amounts to, from answers to claims that are right.
//!
//! In records of a right claim −ln(1 − p) of the least p-value is exponential, its rate the sum of the rates of the searches that the
//! record had. The rate of a kind is the number of records in which the least p-value was its own, over the sum of −ln(1 − p) over the
//! records that had such a search, each as often as it had it: competing risks (D. R. Cox 1959).

use serde_json::Value;

/// A kind of search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// Changes of the spectrum.
    Noise,
    /// Courses of time.
    Time,
    /// Laws of a thermometer.
    Temperature,
    /// Laws of a table.
    Table,
    /// Laws of one other column.
    Column,
    /// Tests of the residual that look at no column.
    Residual,
    /// One test of the residual against a column or a product.
    ResidualOfColumn,
}

/// Kinds of effects that change the spectrum.
const NOISE: [&str; 9] = [
    "excess_arw",
    "excess_flicker",
    "excess_rrw",
    "markov_short",
    "markov_long",
    "quasi_periodic",
    "quantization",
    "bandwidth_filter",
    "power_law_noise",
];
/// Kinds that follow a column without a role of its own.
const COLUMN: [&str; 6] =
    ["supply_sensitivity", "column_driver", "column_law", "column_product", "column_curve", "sf_driver"];
/// Kinds that follow a table.
const TABLE: [&str; 12] = [
    "earth_rate_projection",
    "table_harmonic",
    "reset_ripple",
    "sf_error",
    "sf_asymmetry",
    "sf_nonlinearity",
    "sf_unrecorded",
    "dead_zone",
    "saturation",
    "cross_axis",
    "time_offset",
    "clock_drift",
];
/// Tests of the residual that look at a column.
const OF_COLUMNS: [&str; 3] = ["column_mean", "size", "product"];

impl Search {
    /// Every kind.
    pub const ALL: [Search; 7] = [
        Search::Noise,
        Search::Time,
        Search::Temperature,
        Search::Table,
        Search::Column,
        Search::Residual,
        Search::ResidualOfColumn,
    ];

    fn of_effect(kind: &str) -> Search {
        match kind {
            _ if NOISE.contains(&kind) => Search::Noise,
            _ if COLUMN.contains(&kind) => Search::Column,
            _ if TABLE.contains(&kind) => Search::Table,
            "thermal_lag" | "sf_temperature" => Search::Temperature,
            _ if kind.starts_with("temp_") => Search::Temperature,
            _ => Search::Time,
        }
    }

    fn of_test(id: &str) -> Search {
        if OF_COLUMNS.contains(&id) { Search::ResidualOfColumn } else { Search::Residual }
    }

    /// How often a record with such columns is searched so.
    fn times(self, columns: &[&str]) -> f64 {
        let of_table = |c: &&&str| ["table_rate_deg_s", "table_angle_deg", "outer_rate_deg_s"].contains(*c);
        let (table, warm) = (columns.iter().filter(of_table).count(), columns.contains(&"temp_degC"));
        let series = columns.len() + usize::from(warm);
        let times = match self {
            Search::Noise | Search::Time | Search::Residual => 1,
            Search::Temperature => usize::from(warm),
            Search::Table => usize::from(table > 0),
            Search::Column => columns.len() - table - usize::from(warm),
            Search::ResidualOfColumn => series * (series + 3) / 2,
        };
        times as f64
    }
}

/// The least p-value of a report of `explain`, the search that it is of, and how often each kind of search was made. Probabilities of
/// tests are reported times their number and at most 1: a least one above that is known to be no less, and of no search.
#[derive(Debug, Clone, PartialEq)]
pub struct Least {
    /// −ln(1 − p).
    pub exposure: f64,
    /// Its search; `None` where it is only a bound.
    pub search: Option<Search>,
    /// Of each kind, in the order of [`Search::ALL`].
    pub times: [f64; 7],
}

impl Least {
    /// Of a report; `None` where it lacks something.
    pub fn of(report: &Value) -> Option<Least> {
        let columns: Vec<&str> =
            report["recording"]["columns"].as_array()?.iter().filter_map(Value::as_str).collect();
        let tests = report["tests"].as_array()?;
        let many = tests.len() as f64;
        let of_effect =
            |c: &Value| Some((c["p_value"].as_f64()?, Some(Search::of_effect(c["kind"].as_str()?))));
        let of_test = |t: &Value| {
            let p = t["p_before"].as_f64()?;
            Some((p / many, (p < 1.0).then_some(Search::of_test(t["id"].as_str()?))))
        };
        let effects = report["candidates"].as_array()?.iter().filter_map(of_effect);
        let all = effects.chain(tests.iter().filter_map(of_test));
        let (p, search) = all.min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Least {
            exposure: -(-p.min(1.0 - 1e-12)).ln_1p(),
            search,
            times: Search::ALL.map(|s| s.times(&columns)),
        })
    }

    /// Probability of as small a p-value, at rates of each kind.
    pub fn probability(&self, rates: &[f64; 7]) -> f64 {
        let rate: f64 = rates.iter().zip(&self.times).map(|(r, t)| r * t).sum();
        -(-rate * self.exposure).exp_m1()
    }
}

/// Rate of each kind of search, in the order of [`Search::ALL`], with the number of records that it rests on.
pub fn rates(all: &[Least]) -> [(f64, usize); 7] {
    let mut place = 0;
    Search::ALL.map(|search| {
        let won = all.iter().filter(|l| l.search == Some(search)).count();
        let exposed: f64 = all.iter().map(|l| l.exposure * l.times[place]).sum();
        place += 1;
        (if exposed > 0.0 { won as f64 / exposed } else { 0.0 }, won)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::dice::Dice;
    use serde_json::json;

    #[test]
    fn the_least_p_value_of_a_report_is_of_a_test_or_of_an_effect() {
        let report = |p: f64, before: f64| {
            json!({
                "recording": {"columns": ["temp_degC", "supply_v"]},
                "candidates": [{"kind": "temp_rate", "p_value": p}, {"kind": "line", "p_value": 0.9}],
                "tests": [{"id": "size", "p_before": before}, {"id": "lag", "p_before": 1.0}],
            })
        };
        let least = Least::of(&report(0.1, 0.3)).unwrap();
        assert_eq!(
            (least.search, least.times),
            (Some(Search::Temperature), [1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 9.0])
        );
        assert!((least.exposure + 0.9f64.ln()).abs() < 1e-12);
        assert_eq!(Least::of(&report(0.2, 0.3)).unwrap().search, Some(Search::ResidualOfColumn));
        // A half is all that is known of the tests.
        let bound = Least::of(&report(0.6, 1.0)).unwrap();
        assert!(bound.search.is_none() && (bound.exposure - 2f64.ln()).abs() < 1e-12);
        assert!(Least::of(&json!({})).is_none());
    }

    #[test]
    fn rates_of_searches_that_race_are_found_and_make_p_uniform() {
        let mut dice = Dice::new(5);
        let truth = [2.0, 1.0, 3.0, 0.0, 0.5, 6.0, 0.2];
        let all: Vec<Least> = (0..4000)
            .map(|i| {
                let times = [1.0, 1.0, f64::from(i % 2), 0.0, f64::from(i % 3), 1.0, 5.0];
                // The least of exponential times, each of its own rate.
                let racing = (0..7).map(|s| (s, -dice.uniform(1e-12, 1.0).ln() / (truth[s] * times[s])));
                let first = racing.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
                Least { exposure: first.1, search: Some(Search::ALL[first.0]), times }
            })
            .collect();
        let found = rates(&all);
        for ((rate, won), truth) in found.iter().zip(truth) {
            assert!((rate - truth).abs() <= 4.5 * truth / (*won as f64).sqrt().max(1.0), "{rate} {truth}");
        }
        let small = all.iter().filter(|l| l.probability(&found.map(|f| f.0)) < 0.1).count();
        assert!((small as f64 / 4000.0 - 0.1).abs() < 4.5 * (0.09f64 / 4000.0).sqrt(), "{small}");
    }
}
