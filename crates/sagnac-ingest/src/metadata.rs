//! What files say of themselves beside the samples: entries of metadata, the sample rate and the serial number of the
//! unit among them.

/// Most entries that are kept, and the most characters of a key or a value.
const MAX_ENTRIES: usize = 64;
const MAX_CHARACTERS: usize = 200;

/// Keys and values as a file has them, bounded in number and length.
#[derive(Debug, Default)]
pub(crate) struct Metadata(Vec<(String, String)>);

impl Metadata {
    /// Keeps an entry while there is room. An entry without key or value is left out.
    pub fn add(&mut self, key: &str, value: &str) {
        let cut = |text: &str| {
            let clean = text.trim().chars().filter(|c| !c.is_control());
            clean.take(MAX_CHARACTERS).collect::<String>()
        };
        let (key, value) = (cut(key), cut(value));
        if !self.is_full() && !key.is_empty() && !value.is_empty() {
            self.0.push((key, value));
        }
    }

    /// True when no more entries are kept.
    pub fn is_full(&self) -> bool {
        self.0.len() >= MAX_ENTRIES
    }

    /// The entries in the order in which they came.
    pub fn entries(self) -> Vec<(String, String)> {
        self.0
    }
}

/// Names of numbers that give a sample rate in Hz, in lower case and without separators.
const RATE_NAMES: &[&str] = &[
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
    "samprate",
    "sampratehz",
];

/// Names of numbers that give a sample interval in s.
const INTERVAL_NAMES: &[&str] = &[
    "dt",
    "dts",
    "ts",
    "deltat",
    "tau0",
    "tau0s",
    "sampletime",
    "sampletimes",
    "sampleinterval",
    "sampleintervals",
    "sampleperiod",
    "samplinginterval",
    "samplingintervals",
    "samplingperiod",
];

/// Sample rates that are plausible, Hz.
const PLAUSIBLE_HZ: std::ops::RangeInclusive<f64> = 1e-6..=1e9;

/// The sample rate in Hz that a number tells by its name, such as `fs`, `sample_rate_hz` or `dt`.
pub(crate) fn stated_sample_rate_hz(name: &str, value: f64) -> Option<f64> {
    let plain: String = name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect();
    let rate = if RATE_NAMES.contains(&plain.as_str()) {
        value
    } else if INTERVAL_NAMES.contains(&plain.as_str()) {
        1.0 / value
    } else {
        return None;
    };
    // An interval written in decimal need not have the round rate it means for its reciprocal.
    let round = rate.round();
    let rate = if round > 0.0 && (rate / round - 1.0).abs() < 1e-12 { round } else { rate };
    PLAUSIBLE_HZ.contains(&rate).then_some(rate)
}

/// Keys under which files state the serial number of a unit, without signs and in lower case.
const SERIAL_KEYS: &[&str] = &[
    "serial",
    "serialnumber",
    "serialno",
    "serialnum",
    "sn",
    "unitserial",
    "deviceserial",
    "deviceserialnumber",
    "зав",
    "завномер",
    "заводскойномер",
    "заводской",
    "номерприбора",
    "серийныйномер",
];

/// The serial numbers among metadata, each once.
pub(crate) fn serial_numbers(metadata: &[(String, String)]) -> Vec<&str> {
    let plain = |key: &str| -> String {
        key.chars().filter(|c| c.is_alphanumeric() && *c != '№').flat_map(char::to_lowercase).collect()
    };
    let mut found: Vec<&str> = Vec::new();
    for (_, value) in metadata.iter().filter(|(key, _)| SERIAL_KEYS.contains(&plain(key).as_str())) {
        let value = value.trim().trim_start_matches('№').trim();
        if !value.is_empty() && !found.contains(&value) {
            found.push(value);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_and_intervals_are_known_by_name() {
        for name in ["fs", "Fs", "sample_rate", "Sampling-Rate", "sample_rate_hz"] {
            assert_eq!(stated_sample_rate_hz(name, 200.0), Some(200.0), "{name}");
        }
        for name in ["dt", "Ts", "sample_interval_s", "tau0", "sampling_period"] {
            assert_eq!(stated_sample_rate_hz(name, 0.005), Some(200.0), "{name}");
        }
        assert_eq!(stated_sample_rate_hz("temperature", 20.0), None);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            let found = (stated_sample_rate_hz("fs", value), stated_sample_rate_hz("dt", value));
            assert_eq!(found, (None, None), "{value}");
        }
    }

    #[test]
    fn entries_are_bounded_in_number_and_length() {
        let mut metadata = Metadata::default();
        for i in 0..1000 {
            metadata.add(&format!("k{i}"), &"x".repeat(1000));
        }
        let entries = metadata.entries();
        assert_eq!((entries.len(), entries[0].1.len()), (64, 200));
    }

    #[test]
    fn serial_numbers_stand_under_many_keys() {
        for key in [
            "serial",
            "Serial Number",
            "serial_number",
            "S/N",
            "sn",
            "SN.",
            "Зав. №",
            "зав.№",
            "Заводской номер",
            "заводской №",
            "Номер прибора",
            "Serial No.",
        ] {
            let metadata = [("rate".to_owned(), "10".to_owned()), (key.to_owned(), " SN-0042 ".to_owned())];
            assert_eq!(serial_numbers(&metadata), ["SN-0042"], "{key}");
        }
        for key in ["snow", "number", "прибор", "serialisation"] {
            assert!(serial_numbers(&[(key.to_owned(), "1".to_owned())]).is_empty(), "{key}");
        }
    }
}
