//! In which unit time stamps count, and from when, where nobody wrote it down: by their size and their step.

/// Unit and zero of time stamps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TimeScale {
    /// Unit as unit texts have it.
    pub unit: &'static str,
    /// Factor from the number in the file to that unit.
    pub scale: f64,
    /// Zero of the stamps, s since 1970, where their size shows it.
    pub epoch: Option<Epoch>,
}

/// A zero that clocks count from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Epoch {
    /// 1970-01-01, Unix.
    Unix,
    /// 1980-01-06, GPS.
    Gps,
    /// 1904-01-01, LabVIEW.
    LabView,
    /// 1601-01-01, file times of Windows.
    FileTime,
    /// Year 1, ticks of .NET.
    Ticks,
    /// Days from year 0, `datenum` of MATLAB.
    DateNumber,
    /// Days from 1899-12-30, serial dates of spreadsheets.
    SerialDate,
    /// Modified Julian date.
    ModifiedJulian,
    /// Julian date.
    Julian,
}

impl Epoch {
    /// Zero, s since 1970-01-01T00:00:00Z.
    pub fn zero_s(self) -> f64 {
        match self {
            Epoch::Unix => 0.0,
            Epoch::Gps => 315_964_800.0,
            Epoch::LabView => -2_082_844_800.0,
            Epoch::FileTime => -11_644_473_600.0,
            Epoch::Ticks => -62_135_596_800.0,
            Epoch::DateNumber => -719_529.0 * DAY_S,
            Epoch::SerialDate => -25_569.0 * DAY_S,
            Epoch::ModifiedJulian => -40_587.0 * DAY_S,
            Epoch::Julian => -2_440_587.5 * DAY_S,
        }
    }

    /// Key of its name.
    pub fn key(self) -> &'static str {
        match self {
            Epoch::Unix => "time_scale.unix",
            Epoch::Gps => "time_scale.gps",
            Epoch::LabView => "time_scale.labview",
            Epoch::FileTime => "time_scale.file_time",
            Epoch::Ticks => "time_scale.ticks",
            Epoch::DateNumber => "time_scale.date_number",
            Epoch::SerialDate => "time_scale.serial_date",
            Epoch::ModifiedJulian => "time_scale.modified_julian",
            Epoch::Julian => "time_scale.julian",
        }
    }
}

/// Seconds of a day.
const DAY_S: f64 = 86_400.0;

/// Dates of recordings, s since 1970: from 2000 to 2045.
const DATES_OF_RECORDINGS_S: std::ops::Range<f64> = 946_684_800.0..2_366_841_600.0;

/// Longest time since a clock was started, s: ten years.
const MAX_UPTIME_S: f64 = 3.2e8;

/// Sample rates at which stamps whose unit nobody states count in s, Hz.
const IN_SECONDS_HZ: std::ops::RangeInclusive<f64> = 0.22..=2e5;

/// Gain of the log-likelihood where the size of the stamps is that of a date counted in s or parts of it: chance hardly
/// ever puts them there.
const DATE_GAIN: f64 = 12.0;

/// The same for dates counted in days: some hours in s have that size too.
const DAY_GAIN: f64 = 5.0;

/// Gain where a scale gives the sample rate that the file states.
const STATED_GAIN: f64 = 10.0;

/// A unit in which clocks count.
struct CountedUnit {
    unit: &'static str,
    seconds: f64,
    /// Logarithm of how usual it is.
    usual: f64,
}

const fn counted(unit: &'static str, seconds: f64, usual: f64) -> CountedUnit {
    CountedUnit { unit, seconds, usual }
}

/// Units of clocks that count from any zero.
const RELATIVE: &[CountedUnit] = &[
    counted("s", 1.0, 0.0),
    counted("ms", 1e-3, -0.7),
    counted("us", 1e-6, -1.0),
    counted("ns", 1e-9, -2.5),
    counted("min", 60.0, -4.0),
    counted("h", 3600.0, -4.0),
    counted("d", DAY_S, -3.0),
];

/// Clocks that count from a known zero: zero, unit, factor to the unit.
const DATED: &[(Epoch, &str, f64)] = &[
    (Epoch::Unix, "s", 1.0),
    (Epoch::Unix, "ms", 1.0),
    (Epoch::Unix, "us", 1.0),
    (Epoch::Unix, "ns", 1.0),
    (Epoch::Gps, "s", 1.0),
    (Epoch::Gps, "ms", 1.0),
    (Epoch::Gps, "us", 1.0),
    (Epoch::Gps, "ns", 1.0),
    (Epoch::LabView, "s", 1.0),
    (Epoch::FileTime, "us", 0.1),
    (Epoch::Ticks, "us", 0.1),
    (Epoch::DateNumber, "d", 1.0),
    (Epoch::SerialDate, "d", 1.0),
    (Epoch::ModifiedJulian, "d", 1.0),
    (Epoch::Julian, "d", 1.0),
];

/// What is known of stamps beside their values.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Hints<'a> {
    /// Name of the column in lower case.
    pub name: &'a str,
    /// Unit that the name, the format or the user states.
    pub unit: Option<&'a str>,
    /// Sample rate that the file or the user states, Hz.
    pub rate_hz: Option<f64>,
}

/// The likeliest scale of stamps; `None` where they do not grow.
///
/// Each scale is scored by how usual its unit is, by the sample rate that the middle step gives in it (gyros are sampled
/// at about 100 Hz, give or take two decades), and by whether the stamps are then dates. Seconds stand wherever they
/// give a usual rate.
pub(crate) fn find(stamps: &[f64], hints: Hints<'_>) -> Option<TimeScale> {
    let step = middle_step(stamps)?;
    let first = stamps.iter().copied().find(|t| t.is_finite())?;
    let rate_score = |unit_s: f64| {
        let rate_hz = 1.0 / (step * unit_s);
        let usual = -0.5 * (rate_hz.log10() - 2.0).powi(2);
        // A rate that the file states speaks for the scale that gives it; it may be that of another sensor.
        let stated = hints.rate_hz.is_some_and(|stated| (rate_hz / stated).ln().abs() < 0.1);
        usual + if stated { STATED_GAIN } else { 0.0 }
    };
    let unit_s = |unit: &str| RELATIVE.iter().find(|u| u.unit == unit).map_or(1.0, |u| u.seconds);
    let fits = |unit: &str| hints.unit.is_none_or(|stated| stated == unit);
    let named = |epoch: Epoch| match epoch {
        Epoch::Gps => hints.name.contains("gps") || hints.name.contains("tow"),
        Epoch::Unix => !hints.name.contains("gps"),
        Epoch::ModifiedJulian => hints.name.contains("mjd"),
        Epoch::SerialDate => !hints.name.contains("mjd"),
        _ => true,
    };
    let dated = DATED.iter().filter(|(epoch, unit, _)| named(*epoch) && fits(unit)).filter_map(
        |(epoch, unit, scale)| {
            let seconds = unit_s(unit) * scale;
            let is_date = DATES_OF_RECORDINGS_S.contains(&(epoch.zero_s() + first * seconds));
            let found = TimeScale { unit, scale: *scale, epoch: Some(*epoch) };
            let gain = if *unit == "d" { DAY_GAIN } else { DATE_GAIN };
            is_date.then(|| (rate_score(seconds) + gain, found))
        },
    );
    let relative =
        RELATIVE.iter().filter(|u| fits(u.unit) && first.abs() * u.seconds < MAX_UPTIME_S).map(|u| {
            let stands = u.unit == "s" && IN_SECONDS_HZ.contains(&(1.0 / step));
            let scored = u.usual + rate_score(u.seconds);
            let score = if stands { scored.max(0.0) } else { scored };
            (score, TimeScale { unit: u.unit, scale: 1.0, epoch: None })
        });
    // Ticks of a tenth of a millisecond, as some inertial units count, where the stated rate tells them.
    let tick = TimeScale { unit: "ms", scale: 0.1, epoch: None };
    let ticks = hints.rate_hz.filter(|_| hints.unit.is_none()).map(|_| (rate_score(1e-4) - 3.0, tick));
    let all = relative.chain(dated).chain(ticks);
    all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, found)| found)
}

/// The middle one of the steps forward.
fn middle_step(stamps: &[f64]) -> Option<f64> {
    let pairs = stamps.iter().zip(stamps.get(1..).unwrap_or_default());
    let mut steps: Vec<f64> = pairs.map(|(a, b)| b - a).filter(|d| *d > 0.0 && d.is_finite()).collect();
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    Some(*steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(first: f64, step: f64, name: &str) -> TimeScale {
        let stamps: Vec<f64> = (0..50).map(|i| first + step * f64::from(i)).collect();
        find(&stamps, Hints { name, ..Hints::default() }).unwrap()
    }

    #[test]
    fn scales_are_told_by_size_and_step() {
        use Epoch::*;
        for (first, step, name, unit, epoch) in [
            (0.0, 0.01, "time", "s", None),
            (0.0, 1.0, "time", "s", None),
            (1.7e9, 0.01, "time", "s", Some(Unix)),
            (1.7e12, 5.0, "timestamp", "ms", Some(Unix)),
            (1.7e15, 5000.0, "timestamp", "us", Some(Unix)),
            (1.4e18, 5e6, "timestamp", "ns", Some(Unix)),
            (1.36e18, 5e6, "gps_ns", "ns", Some(Gps)),
            (1.36e9, 0.01, "gps time", "s", Some(Gps)),
            (12_345_875.0, 40_000.0, "timestamp", "us", None),
            (5000.0, 10.0, "time", "ms", None),
            (1e12, 5e6, "time", "ns", None),
            (738_000.25, 0.1 / 86_400.0, "t", "d", Some(DateNumber)),
            (45_000.25, 0.1 / 86_400.0, "time", "d", Some(SerialDate)),
            (60_000.25, 0.1 / 86_400.0, "mjd", "d", Some(ModifiedJulian)),
            (3.8e9, 0.01, "time", "s", Some(LabView)),
            (45_000.0, 0.01, "time", "s", None),
            (40_000.0, 0.001, "time", "s", None),
            (1.7e9, 300.0, "time", "s", Some(Unix)),
            (1.33e17, 1e5, "time", "us", Some(FileTime)),
        ] {
            let found = of(first, step, name);
            assert_eq!((found.unit, found.epoch), (unit, epoch), "{first} {step} {name}");
        }
    }

    #[test]
    fn a_stated_rate_decides() {
        let stamps: Vec<f64> = (0..50).map(|i| 250.0 * f64::from(i)).collect();
        let found = find(&stamps, Hints { rate_hz: Some(40.0), ..Hints::default() }).unwrap();
        assert_eq!((found.unit, found.scale), ("ms", 0.1));
        assert_eq!(find(&[1.0, 1.0, f64::NAN], Hints::default()), None);
    }
}
