//! Samples that repeat the one before them. They have no kind of their own in the format of explanations.

use crate::effect::{Drivers, Param, Samples, Values, list, number};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub struct RepeatedSamples;

static PARAMS: [Param; 2] =
    [Param::reported("repeated_share", "", 1e-9, 1.0), Param::inner("repeated_rows_each", "", 1.0, 1e7)];

/// First row that repeats, and how many do, of each run.
const TIMES: &str = "repeats_time_s";
const ROWS: &str = "repeats_rows";

describe! {
    RepeatedSamples, "repeated_samples", Samples in Time, needs [],
    confusers ["markov_short", "quantization", "saturation"],
    lists [
        Param::inner(TIMES, "s", f64::MIN, f64::MAX),
        Param::inner(ROWS, "", 0.0, 1e7)
    ],
    with {
        fn in_format(&self) -> bool {
            false
        }
    }
}

impl Samples for RepeatedSamples {
    /// Runs that begin at the listed instants, else a share of all rows in runs anywhere, each of about
    /// `repeated_rows_each`. The first row has none to repeat.
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, rate: &mut [f64], _keep: &mut [bool]) {
        let n = rate.len();
        let mut repeat = |first: usize, rows: usize| {
            for i in first.max(1)..first.saturating_add(rows).min(n) {
                rate[i] = rate[i - 1];
            }
        };
        let times = list(values, TIMES);
        if !times.is_empty() {
            for (time, rows) in times.iter().zip(list(values, ROWS)) {
                let first = ((time - drivers.start_s) / drivers.dt_s).round().clamp(0.0, n as f64) as usize;
                repeat(first, rows.clamp(0.0, n as f64) as usize);
            }
            return;
        }
        let Some(share) = number(values, PARAMS[0].name).filter(|s| *s > 0.0) else { return };
        let each = number(values, PARAMS[1].name).filter(|r| *r >= 1.0).unwrap_or(1.0);
        // A row that repeats is followed by one that does with probability `go_on`, one that does not with `begin`.
        let go_on = 1.0 - 1.0 / each;
        let begin = (share / ((1.0 - share).max(1e-9) * each)).min(1.0);
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut repeats = false;
        for i in 1..n {
            repeats = rng.random::<f64>() < if repeats { go_on } else { begin };
            if repeats {
                repeat(i, 1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    fn applied(values: &Values, n: usize) -> Vec<f64> {
        let drivers = Drivers { dt_s: 0.5, start_s: 10.0, samples: n, ..Drivers::default() };
        let mut rate: Vec<f64> = (0..n).map(|i| i as f64).collect();
        RepeatedSamples.apply(values, &drivers, 7, &mut rate, &mut []);
        rate
    }

    #[test]
    fn listed_runs_hold_the_value_before_them() {
        let values = Values::from([
            (TIMES.to_owned(), Value::List(vec![9.0, 11.0, 13.5])),
            (ROWS.to_owned(), Value::List(vec![1.0, 2.0, 9.0])),
        ]);
        assert_eq!(applied(&values, 9), [0.0, 1.0, 1.0, 1.0, 4.0, 5.0, 6.0, 6.0, 6.0]);
    }

    #[test]
    fn a_share_of_the_rows_repeats_in_runs_of_the_length_asked_for() {
        for (share, each) in [(0.02, 1.0), (0.3, 2.5), (0.8, 10.0)] {
            let values = Values::from([
                ("repeated_share".to_owned(), Value::Number(share)),
                ("repeated_rows_each".to_owned(), Value::Number(each)),
            ]);
            let rate = applied(&values, 200_000);
            let repeats: Vec<bool> = rate.windows(2).map(|w| w[0] == w[1]).collect();
            let rows = repeats.iter().filter(|r| **r).count() as f64;
            let runs = repeats.windows(2).filter(|w| w[1] && !w[0]).count() as f64;
            assert!((rows / 200_000.0 / share - 1.0).abs() < 0.05, "{share}: {rows}");
            assert!((rows / runs / each - 1.0).abs() < 0.05, "{each}: {}", rows / runs);
        }
    }
}
