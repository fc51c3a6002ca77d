//! Single numbers beside the columns: the sample rate, and what else is worth keeping.

/// Names of scalars that hold a sample rate, Hz, in lower case without separators.
const RATES: &[&str] = &[
    "fs",
    "fshz",
    "samplerate",
    "sampleratehz",
    "samplingrate",
    "samplingratehz",
    "samplefrequency",
    "samplefrequencyhz",
    "samplingfrequency",
    "samplingfrequencyhz",
];

/// Names of scalars that hold a sample interval, s.
const INTERVALS: &[&str] = &[
    "dt",
    "dts",
    "ts",
    "tau0",
    "tau0s",
    "sampletime",
    "sampletimes",
    "sampleinterval",
    "sampleintervals",
    "samplinginterval",
    "samplingintervals",
];

/// Sample rates that are believed, Hz.
const BELIEVED: std::ops::RangeInclusive<f64> = 1e-6..=1e9;

/// Most entries that are kept of what a file says of itself.
const MOST_ENTRIES: usize = 64;

/// Longest value that is kept, characters.
const LONGEST: usize = 200;

/// The sample rate that a scalar of a name tells, Hz.
pub(crate) fn stated(name: &str, value: f64) -> Option<f64> {
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let rate = if RATES.contains(&plain.as_str()) {
        value
    } else if INTERVALS.contains(&plain.as_str()) {
        1.0 / value
    } else {
        return None;
    };
    // An interval written in decimal need not have the round rate it means for its reciprocal.
    let round = rate.round();
    let rate = if round > 0.0 && (rate / round - 1.0).abs() < 1e-12 { round } else { rate };
    BELIEVED.contains(&rate).then_some(rate)
}

/// Keeps what a file says of itself, a bounded number of entries of bounded length.
pub(crate) fn keep(metadata: &mut Vec<(String, String)>, key: &str, value: &str) {
    if metadata.len() < MOST_ENTRIES {
        let clip = |text: &str| text.trim().chars().filter(|c| !c.is_control()).take(LONGEST).collect();
        metadata.push((clip(key), clip(value)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_intervals_are_known_by_name() {
        for name in ["fs", "Fs", "sample_rate", "Sampling-Rate", "sample_rate_hz"] {
            assert_eq!(stated(name, 200.0), Some(200.0), "{name}");
        }
        for name in ["dt", "Ts", "sample_interval_s", "tau0"] {
            assert_eq!(stated(name, 0.005), Some(200.0), "{name}");
        }
        assert_eq!(stated("temperature", 20.0), None);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!((stated("fs", value), stated("dt", value)), (None, None), "{value}");
        }
    }

    #[test]
    fn what_is_kept_is_bounded() {
        let mut kept = Vec::new();
        for i in 0..1000 {
            keep(&mut kept, &format!("k{i}"), &"x".repeat(1000));
        }
        assert_eq!((kept.len(), kept[0].1.len()), (64, 200));
    }
}
