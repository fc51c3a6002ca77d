//! Rows are missing.

use crate::effect::sizing::numbers;
use crate::effect::{
    Detection, Detector, Domain, Drivers, Param, Place, Reported, RowDetector, Rows, RowsFound, Samples,
    Values, list, number,
};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

pub struct DroppedSamples;

static PARAMS: [Param; 2] =
    [Param::reported("missing_rows", "", 1.0, 1e7).count(10.0), Param::inner("gaps", "", 1.0, 1e6)];

/// Last instant before each gap is later than this; rows that the gap swallows.
const TIMES_LIST: &str = "gaps_time_s";
const ROWS_LIST: &str = "gaps_rows";

describe! {
    DroppedSamples, "dropped_samples", Samples in Timestamps, needs [],
    confusers [ClockDrift, TimeOffset],
    lists [
        Param::inner(TIMES_LIST, "s", f64::MIN, f64::MAX),
        Param::inner(ROWS_LIST, "", 0.0, 1e7)
    ]
}

impl Samples for DroppedSamples {
    /// Gaps that begin at the listed instants, else `gaps` of about equal length anywhere inside; neither the first nor
    /// the last row is lost.
    fn apply(&self, values: &Values, drivers: &Drivers, seed: u64, _rate: &mut [f64], keep: &mut [bool]) {
        let n = keep.len().min(drivers.samples);
        if n < 3 {
            return;
        }
        let times = list(values, TIMES_LIST);
        if !times.is_empty() {
            for (time, rows) in times.iter().zip(list(values, ROWS_LIST)) {
                let first =
                    ((time - drivers.start_s) / drivers.dt_s).round().clamp(1.0, n as f64 - 1.0) as usize;
                let rows = rows.clamp(0.0, n as f64) as usize;
                keep[first..(first + rows).min(n - 1).max(first)].fill(false);
            }
            return;
        }
        let Some(missing) = number(values, PARAMS[0].name) else { return };
        let mut left = (missing.clamp(0.0, 0.5 * n as f64)) as usize;
        let gaps = number(values, PARAMS[1].name).unwrap_or(1.0).clamp(1.0, left.max(1) as f64) as usize;
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
        let length = left.div_ceil(gaps);
        // A gap begins at a row that is still there and runs on over those that are; it ends when its length is used up.
        while left > 0 {
            let mut at = rng.random_range(1..n - 1);
            let mut rows = length.min(left);
            while rows > 0 && at < n - 1 {
                if keep[at] {
                    keep[at] = false;
                    rows -= 1;
                    left -= 1;
                }
                at += 1;
            }
        }
    }

    fn detector(&self) -> Detector {
        Detector::Missing(&DroppedSamples)
    }
}

impl RowDetector for DroppedSamples {
    /// Every place of the grid that no row fills. Each counts as a parameter: which row it was is known.
    fn find(&self, rows: &Rows<'_>) -> Option<RowsFound> {
        let (first, last) = (rows.gaps.first()?, rows.gaps.last()?);
        let missing: Vec<usize> = rows.gaps.iter().flat_map(|(first, count)| *first..first + count).collect();
        let count = missing.len() as f64;
        let place = Place {
            domain: Domain::Timestamps,
            from: rows.time_s(first.0.saturating_sub(1)),
            to: rows.time_s(last.0 + last.1),
        };
        let detection = Detection {
            reported: vec![Reported::new(PARAMS[0].name, PARAMS[0].unit, count, [count, count])],
            stated: numbers([(PARAMS[0].name, count)]),
            places: vec![place],
            gain: f64::INFINITY,
            parameters: missing.len(),
            p_value: 1e-300,
        };
        Some(RowsFound { rows: missing, detection })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Value;

    fn lost(values: &Values, n: usize, seed: u64) -> Vec<usize> {
        let drivers = Drivers { dt_s: 0.1, start_s: 5.0, samples: n, ..Drivers::default() };
        let mut keep = vec![true; n];
        DroppedSamples.apply(values, &drivers, seed, &mut vec![0.0; n], &mut keep);
        (0..n).filter(|i| !keep[*i]).collect()
    }

    #[test]
    fn listed_gaps_are_where_they_are_said_to_be() {
        let values = Values::from([
            (TIMES_LIST.to_owned(), Value::List(vec![5.3, 6.0, 99.0])),
            (ROWS_LIST.to_owned(), Value::List(vec![2.0, 1.0, 5.0])),
        ]);
        assert_eq!(lost(&values, 20, 0), [3, 4, 10]);
    }

    #[test]
    fn every_missing_row_is_found_between_its_neighbours() {
        let rows = Rows { rate: &[], present: &[], gaps: &[(3, 2), (10, 1)], start_s: 5.0, dt_s: 0.5 };
        let found = DroppedSamples.find(&rows).unwrap();
        assert_eq!(found.rows, [3, 4, 10]);
        let Detection { reported, places, .. } = found.detection;
        assert_eq!((reported[0].value, reported[0].ci95), (3.0, [3.0, 3.0]));
        // From the row before the first gap, at 6 s, to that behind the last, at 10.5 s.
        assert_eq!((places[0].from, places[0].to), (6.0, 10.5));
        assert!(DroppedSamples.find(&Rows { gaps: &[], ..rows }).is_none());
    }

    #[test]
    fn as_many_rows_are_lost_as_asked_for() {
        for (missing, gaps) in [(1.0, 1.0), (37.0, 5.0), (400.0, 400.0)] {
            let values = numbers([("missing_rows", missing), ("gaps", gaps)]);
            let lost = lost(&values, 1000, 4);
            assert_eq!(lost.len(), missing as usize);
            assert!(!lost.contains(&0) && !lost.contains(&999));
        }
    }
}
