//! What files say of themselves beside the samples: entries of metadata, the sample rate and the serial number of the
//! unit among them.

use crate::column_inference::{named_unit, split_brackets};
use sagnac_core::units::Unit;

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
    "updaterate",
    "updateratehz",
    "outputrate",
    "outputratehz",
    "outputdatarate",
    "datarate",
    "dataratehz",
    "odr",
    "odrhz",
    "частотадискретизации",
    "частотаопроса",
    "частотаотсчётов",
    "частотаотсчетов",
    "частотавыдачи",
];

/// Names of entries that give a sample rate only where their value has the unit of a frequency.
const RATE_NAMES_WITH_UNIT: &[&str] = &["rate", "frequency", "freq", "частота"];

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
    "deltax",
    "timestep",
    "периодопроса",
    "интервалопроса",
    "периоддискретизации",
    "шагповремени",
];

/// Sample rates that are plausible, Hz.
const PLAUSIBLE_HZ: std::ops::RangeInclusive<f64> = 1e-6..=1e9;

/// A number with the unit behind it, as headers have it: `40.0Hz`, `131 LSB/(deg/s)`, `0,01`.
pub(crate) fn number_with_unit(text: &str) -> Option<(f64, Option<Unit>)> {
    let text = text.trim();
    let of_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '+' | '-');
    let mut end = text.find(|c: char| !of_number(c)).unwrap_or(text.len());
    // An exponent belongs to the number where digits follow.
    if let Some(rest) = text.get(end..).filter(|r| r.starts_with(['e', 'E'])) {
        let digits = rest.get(1..).unwrap_or_default();
        let length = digits.find(|c: char| !of_number(c)).unwrap_or(digits.len());
        if digits.get(..length).is_some_and(|d| d.trim_start_matches(['+', '-']).parse::<u32>().is_ok()) {
            end += 1 + length;
        }
    }
    let (number, unit) = text.split_at_checked(end)?;
    let value: f64 = number.trim_end_matches(',').replace(',', ".").parse().ok()?;
    let unit = unit.trim();
    if unit.is_empty() { Some((value, None)) } else { Some((value, Some(Unit::parse(unit).ok()?))) }
}

/// The sample rate in Hz that an entry of a header tells: by its name, with the unit of its value or of its name.
pub(crate) fn sample_rate_of_entry_hz(key: &str, value: &str) -> Option<f64> {
    let (number, unit) = number_with_unit(value)?;
    let unit = unit.or_else(|| named_unit(key, None));
    let stem = split_brackets(key).0;
    let converts = |to: &str| unit.as_ref().and_then(|u| u.factor_to(&Unit::parse(to).ok()?).ok());
    let plain = plain(&stem);
    match (converts("Hz"), converts("s")) {
        (Some(factor), _) => {
            let known = RATE_NAMES_WITH_UNIT.contains(&plain.as_str());
            stated_sample_rate_hz(if known { "fs" } else { &stem }, number * factor)
        }
        (_, Some(factor)) => stated_sample_rate_hz(&stem, number * factor),
        _ if unit.is_some() => None,
        _ => stated_sample_rate_hz(&stem, number),
    }
}

/// A name without signs, in lower case.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The sample rate in Hz that a number tells by its name, such as `fs`, `sample_rate_hz` or `dt`.
pub(crate) fn stated_sample_rate_hz(name: &str, value: f64) -> Option<f64> {
    let plain = plain(name);
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

/// Keys under which files state when the recording began, without signs and in lower case.
const START_KEYS: &[&str] = &[
    "start",
    "starttime",
    "startdate",
    "datetime",
    "recordingstart",
    "recordedat",
    "begin",
    "begun",
    "начало",
    "началозаписи",
    "датавремя",
    "датаивремя",
];

/// Ways to write a moment without a zone.
const MOMENTS: [&str; 5] = [
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%d.%m.%Y %H:%M:%S%.f",
    "%d-%b-%Y %H:%M:%S%.f",
];

/// When the recording began, RFC 3339, as an entry states it: with its zone, or taken as UTC without one. LabVIEW states
/// date and time in two entries.
pub(crate) fn stated_start(metadata: &[(String, String)]) -> Option<String> {
    let of = |wanted: &str| {
        metadata.iter().rev().find(|(key, _)| plain(key) == wanted).map(|(_, value)| value.trim())
    };
    let named = START_KEYS.iter().find_map(|key| of(key)).map(str::to_owned);
    let in_two = || {
        let (date, time) = of("date").zip(of("time"))?;
        // More digits than a clock has.
        let time = time.split_once('.').map_or(time.to_owned(), |(whole, f)| format!("{whole}.{:.9}", f));
        Some(format!("{date} {time}"))
    };
    let text = named.or_else(in_two)?;
    if let Ok(zoned) = chrono::DateTime::parse_from_rfc3339(&text.replacen(' ', "T", 1)) {
        return Some(zoned.to_rfc3339_opts(chrono::SecondsFormat::Millis, true));
    }
    let moment = MOMENTS.iter().find_map(|way| chrono::NaiveDateTime::parse_from_str(&text, way).ok())?;
    Some(moment.and_utc().to_rfc3339_opts(chrono::SecondsFormat::Millis, true))
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

/// Words before a serial number in the middle of a text, in lower case, the longest first.
const SERIAL_MARKS: &[&str] = &[
    "serial number",
    "serial no",
    "serial",
    "s/n",
    "sn",
    "заводской номер",
    "заводской №",
    "зав. номер",
    "зав. №",
    "зав.№",
    "зав №",
    "серийный номер",
];

/// The serial number that a text holds behind a word for it: `S/N FG-1`, `ВГ-035 зав. № 0117`.
fn serial_in(text: &str) -> Option<&str> {
    let begins = |at: usize, mark: &str| {
        let mut rest = text.get(at..)?.char_indices();
        for wanted in mark.chars() {
            let (_, c) = rest.next()?;
            if !c.to_lowercase().eq([wanted]) {
                return None;
            }
        }
        Some(at + rest.next().map_or(text.len() - at, |(i, _)| i))
    };
    let mut before = ' ';
    for (at, c) in text.char_indices() {
        let behind =
            (!before.is_alphanumeric()).then(|| SERIAL_MARKS.iter().find_map(|m| begins(at, m))).flatten();
        before = c;
        let Some(rest) =
            behind.and_then(|end| text.get(end..)).filter(|r| !r.starts_with(char::is_alphanumeric))
        else {
            continue;
        };
        let rest = rest.trim_start_matches(|c: char| c.is_whitespace() || ".:=#№-_".contains(c));
        let end = rest.find(|c: char| !c.is_alphanumeric() && !"-_/".contains(c)).unwrap_or(rest.len());
        let found = rest.get(..end).filter(|f| f.chars().any(|c| c.is_ascii_digit()));
        if found.is_some() {
            return found;
        }
    }
    None
}

/// The serial numbers among metadata, each once: under their keys, or in the words of other entries.
pub(crate) fn serial_numbers(metadata: &[(String, String)]) -> Vec<&str> {
    let without = |key: &str| -> String {
        key.chars().filter(|c| c.is_alphanumeric() && *c != '№').flat_map(char::to_lowercase).collect()
    };
    let mut found: Vec<&str> = Vec::new();
    for (key, value) in metadata {
        let in_key = SERIAL_KEYS.contains(&without(key).as_str());
        let serial = if in_key { None } else { serial_in(value) };
        found.extend(serial.filter(|s| !found.contains(s)));
    }
    for (_, value) in metadata.iter().filter(|(key, _)| SERIAL_KEYS.contains(&without(key).as_str())) {
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
    fn rates_stand_in_headers_with_and_without_units() {
        for (key, value, hz) in [
            ("Update Rate", "40.0Hz", 40.0),
            ("Sample interval (ms)", "5", 200.0),
            ("dt", "0,01 s", 100.0),
            ("Rate", "1 kHz", 1000.0),
            ("Delta_X", "1.0E-2", 100.0),
            ("Частота опроса", "50 Гц", 50.0),
            ("fs", "200", 200.0),
        ] {
            let found = sample_rate_of_entry_hz(key, value);
            assert!(found.is_some_and(|f| (f / hz - 1.0).abs() < 1e-9), "{key}: {found:?}");
        }
        for (key, value) in [("rate", "10"), ("Rate", "5 deg/s"), ("fs", "many"), ("Temperature", "20 degC")]
        {
            assert_eq!(sample_rate_of_entry_hz(key, value), None, "{key} {value}");
        }
    }

    #[test]
    fn starts_keep_their_zone() {
        let of = |entries: &[(&str, &str)]| {
            let entries: Vec<(String, String)> =
                entries.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
            stated_start(&entries)
        };
        assert_eq!(
            of(&[("Start time", "2026-03-01 10:00:00+03:00")]).as_deref(),
            Some("2026-03-01T10:00:00.000+03:00")
        );
        let labview = [("Date", "2023/05/11"), ("Time", "10:11:12.1234567890123456789")];
        assert_eq!(of(&labview).as_deref(), Some("2023-05-11T10:11:12.123Z"));
        assert_eq!(
            of(&[("Начало записи", "01.03.2026 10:00:00")]).as_deref(),
            Some("2026-03-01T10:00:00.000Z")
        );
        assert_eq!(of(&[("start", "soon")]), None);
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
        for text in ["S/N FG-1", "ВГ-035 зав. № FG-1", "gyro, serial no. FG-1, run 2", "unit SN: FG-1"]
        {
            assert_eq!(serial_numbers(&[("title".to_owned(), text.to_owned())]), ["FG-1"], "{text}");
        }
        for text in ["snow 12", "S/N unknown", "season 2"] {
            assert!(serial_numbers(&[("title".to_owned(), text.to_owned())]).is_empty(), "{text}");
        }
        for key in ["snow", "number", "прибор", "serialisation"] {
            assert!(serial_numbers(&[(key.to_owned(), "1".to_owned())]).is_empty(), "{key}");
        }
    }
}
