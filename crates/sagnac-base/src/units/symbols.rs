//! The symbols of units, English and Russian.

use super::dimension::{
    ANGLE, BASES, COUNT, CURRENT, Dimension, LENGTH, MAGNETIC, PRESSURE, TEMPERATURE, TIME, VOLTAGE, inverse,
    one, per_time,
};

/// Spellings of the degree Celsius. A C may be Latin or Cyrillic.
pub(super) const CELSIUS: &[&str] = &[
    "degC",
    "°C",
    "ºC",
    "˚C",
    "℃",
    "celsius",
    "Celsius",
    "Deg C",
    "deg C",
    "degrees C",
    "° C",
    "C",
    "С",
    "DegC",
    "degc",
    "DEGC",
    "deg.C",
    "град.C",
    "град.С",
    "гр.C",
    "гр.С",
    "°С",
    "ºС",
    "degС",
];

/// Spellings of the degree Fahrenheit.
pub(super) const FAHRENHEIT: &[&str] = &[
    "degF",
    "°F",
    "ºF",
    "˚F",
    "℉",
    "deg F",
    "Deg F",
    "° F",
    "F",
    "DegF",
    "degf",
    "fahrenheit",
    "Fahrenheit",
];

const DEG: f64 = 180.0 / std::f64::consts::PI;
const NUMBER: Dimension = [0; BASES];
const HERTZ: Dimension = inverse(one(TIME));

/// Spellings, factor to the base unit, dimension.
const SYMBOLS: &[(&[&str], f64, Dimension)] = &[
    (&["1"], 1.0, NUMBER),
    (&["%", "percent"], 1e-2, NUMBER),
    (&["ppm"], 1e-6, NUMBER),
    (&["ppb"], 1e-9, NUMBER),
    (&["deg", "degs", "°", "º", "˚", "degree", "degrees", "град", "градус"], 1.0, one(ANGLE)),
    (&["mdeg", "мград"], 1e-3, one(ANGLE)),
    (&["udeg"], 1e-6, one(ANGLE)),
    (&["arcmin", "угл.мин", "угл.мин.", "′"], 1.0 / 60.0, one(ANGLE)),
    (&["arcsec", "asec", "угл.с", "угл.сек", "угл.сек.", "\"", "″", "ʺ"], 1.0 / 3600.0, one(ANGLE)),
    (&["marcsec", "mas"], 1.0 / 3.6e6, one(ANGLE)),
    (&["rad", "rads", "radian", "radians", "рад"], DEG, one(ANGLE)),
    (&["mrad", "мрад"], DEG * 1e-3, one(ANGLE)),
    (&["urad", "µrad", "μrad", "мкрад"], DEG * 1e-6, one(ANGLE)),
    (&["nrad", "нрад"], DEG * 1e-9, one(ANGLE)),
    (&["rev", "turn", "об"], 360.0, one(ANGLE)),
    (&["s", "sec", "secs", "second", "seconds", "с", "сек", "сек."], 1.0, one(TIME)),
    (&["ms", "msec", "millis", "millisecond", "milliseconds", "мс", "мсек"], 1e-3, one(TIME)),
    (&["us", "µs", "μs", "usec", "micros", "microsecond", "microseconds", "мкс", "мксек"], 1e-6, one(TIME)),
    (&["ns", "nsec", "nanos", "nanosecond", "nanoseconds", "нс", "нсек"], 1e-9, one(TIME)),
    (&["min", "minute", "minutes", "мин", "мин."], 60.0, one(TIME)),
    (&["h", "hr", "hrs", "hour", "hours", "ч", "час"], 3600.0, one(TIME)),
    (&["d", "day", "days", "сут"], 86400.0, one(TIME)),
    (&["Hz", "Гц"], 1.0, HERTZ),
    (&["mHz"], 1e-3, HERTZ),
    (&["kHz", "кГц"], 1e3, HERTZ),
    (&["dph"], 1.0 / 3600.0, per_time(ANGLE, 1)),
    (&["dps", "degps"], 1.0, per_time(ANGLE, 1)),
    (&["radps"], DEG, per_time(ANGLE, 1)),
    (&["rpm"], 6.0, per_time(ANGLE, 1)),
    (&["K", "К", "kelvin"], 1.0, one(TEMPERATURE)),
    (CELSIUS, 1.0, one(TEMPERATURE)),
    (FAHRENHEIT, 5.0 / 9.0, one(TEMPERATURE)),
    (&["mK"], 1e-3, one(TEMPERATURE)),
    (&["V", "В"], 1.0, one(VOLTAGE)),
    (&["mV", "мВ"], 1e-3, one(VOLTAGE)),
    (&["T", "Тл"], 1.0, one(MAGNETIC)),
    (&["mT", "мТл"], 1e-3, one(MAGNETIC)),
    (&["uT", "µT", "μT", "мкТл"], 1e-6, one(MAGNETIC)),
    (&["nT", "нТл"], 1e-9, one(MAGNETIC)),
    (&["gauss", "Oe", "Гс", "Э"], 1e-4, one(MAGNETIC)),
    (&["Pa", "Па"], 1.0, one(PRESSURE)),
    (&["hPa", "mbar", "гПа"], 100.0, one(PRESSURE)),
    (&["kPa", "кПа"], 1e3, one(PRESSURE)),
    (&["m", "м"], 1.0, one(LENGTH)),
    (&["mm", "мм"], 1e-3, one(LENGTH)),
    (&["um", "µm"], 1e-6, one(LENGTH)),
    (&["nm"], 1e-9, one(LENGTH)),
    (&["g", "gn"], 9.80665, per_time(LENGTH, 2)),
    (&["mg"], 9.80665e-3, per_time(LENGTH, 2)),
    (&["A", "А"], 1.0, one(CURRENT)),
    (&["mA", "мА"], 1e-3, one(CURRENT)),
    (
        &[
            "count",
            "counts",
            "cnt",
            "LSB",
            "lsb",
            "pulse",
            "pulses",
            "имп",
            "имп.",
            "отсч",
            "отсч.",
            "отсчёт",
            "отсчет",
            "ед",
            "ед.",
            "МЗР",
        ],
        1.0,
        one(COUNT),
    ),
];

/// Prefixes of the SI with their factors.
const PREFIXES: &[(&str, f64)] = &[
    ("мк", 1e-6),
    ("n", 1e-9),
    ("н", 1e-9),
    ("u", 1e-6),
    ("µ", 1e-6),
    ("μ", 1e-6),
    ("m", 1e-3),
    ("м", 1e-3),
    ("k", 1e3),
    ("к", 1e3),
    ("M", 1e6),
];

/// Symbols that take any prefix.
const PREFIXED: &[&str] = &[
    "deg", "rad", "arcsec", "dps", "dph", "degps", "radps", "sec", "Hz", "V", "A", "T", "Pa", "K", "град",
    "рад", "с", "сек", "Гц", "В", "А", "Тл", "Па",
];

/// Factor to the base unit and dimension of a symbol: as it is listed, with a prefix of the SI, or in capitals where that
/// is the only difference.
pub(super) fn symbol(name: &str) -> Option<(f64, Dimension)> {
    let listed = |name: &str| {
        let (_, factor, dimension) = SYMBOLS.iter().find(|(names, ..)| names.contains(&name))?;
        Some((*factor, *dimension))
    };
    let prefixed = |name: &str| {
        let (base, scale) =
            PREFIXES.iter().find_map(|(prefix, scale)| Some((name.strip_prefix(prefix)?, scale)))?;
        let (factor, dimension) = listed(base).filter(|_| PREFIXED.contains(&base))?;
        Some((scale * factor, dimension))
    };
    // Of one or two letters, case tells units apart.
    let lower = || Some(name.to_lowercase()).filter(|l| l.chars().count() > 2 && *l != name);
    listed(name).or_else(|| prefixed(name)).or_else(|| {
        lower().and_then(|l| listed(&l).or_else(|| prefixed(&l).filter(|_| !name.starts_with('M'))))
    })
}

/// True where two symbols differ by a prefix alone: one is not meant where the other is written.
pub(super) fn differ_by_prefix(written: &str, symbol: &str) -> bool {
    let without = |text: &str| -> Vec<String> {
        let stripped = PREFIXES.iter().filter_map(|(p, _)| text.strip_prefix(p));
        stripped.chain([text]).filter(|t| t.chars().count() > 1).map(str::to_owned).collect()
    };
    let mut tail = written.chars();
    tail.next();
    let others = without(symbol);
    without(written).iter().any(|w| others.contains(w)) || others.iter().any(|o| o == tail.as_str())
}

/// Every ASCII symbol offered as a suggestion for a misspelt one.
pub(super) const SUGGESTED: &[&str] = &[
    "deg", "mdeg", "arcmin", "arcsec", "rad", "mrad", "urad", "nrad", "rev", "s", "ms", "us", "ns", "min",
    "h", "day", "Hz", "kHz", "dph", "dps", "rpm", "degC", "K", "degF", "V", "mV", "mT", "uT", "Oe", "Pa",
    "hPa", "kPa", "m", "mm", "g", "mg", "A", "mA", "count", "LSB", "pulse", "ppm", "ppb", "sqrt",
];
