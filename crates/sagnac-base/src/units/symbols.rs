//! The symbols of units, English and Russian.

use super::dimension::{BASE_COUNT, Base, Dimension, inverse, one, per_time, product};

/// Spellings of the degree Celsius. A C may be Latin or Cyrillic.
pub(super) const CELSIUS_SYMBOLS: &[&str] = &[
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
pub(super) const FAHRENHEIT_SYMBOLS: &[&str] = &[
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

const DEG_PER_RAD: f64 = 180.0 / std::f64::consts::PI;
const NO_DIMENSION: Dimension = [0; BASE_COUNT];
const PER_SECOND: Dimension = inverse(one(Base::Time));
const GRAY: Dimension = {
    let mut dimension = one(Base::Length);
    dimension[Base::Length as usize] = 4;
    dimension[Base::Time as usize] = -4;
    dimension
};

/// Spellings, factor to the base unit, dimension.
const UNIT_SYMBOLS: &[(&[&str], f64, Dimension)] = &[
    (&["1"], 1.0, NO_DIMENSION),
    (&["%", "percent"], 1e-2, NO_DIMENSION),
    (&["ppm"], 1e-6, NO_DIMENSION),
    (&["ppb"], 1e-9, NO_DIMENSION),
    (&["deg", "degs", "°", "º", "˚", "degree", "degrees", "град", "градус"], 1.0, one(Base::Angle)),
    (&["mdeg", "мград"], 1e-3, one(Base::Angle)),
    (&["udeg"], 1e-6, one(Base::Angle)),
    (&["arcmin", "угл.мин", "угл.мин.", "′"], 1.0 / 60.0, one(Base::Angle)),
    (&["arcsec", "asec", "угл.с", "угл.сек", "угл.сек.", "\"", "″", "ʺ"], 1.0 / 3600.0, one(Base::Angle)),
    (&["marcsec", "mas"], 1.0 / 3.6e6, one(Base::Angle)),
    (&["rad", "rads", "radian", "radians", "рад"], DEG_PER_RAD, one(Base::Angle)),
    (&["mrad", "мрад"], DEG_PER_RAD * 1e-3, one(Base::Angle)),
    (&["urad", "µrad", "μrad", "мкрад"], DEG_PER_RAD * 1e-6, one(Base::Angle)),
    (&["nrad", "нрад"], DEG_PER_RAD * 1e-9, one(Base::Angle)),
    (&["rev", "turn", "об"], 360.0, one(Base::Angle)),
    (&["s", "sec", "secs", "second", "seconds", "с", "сек", "сек."], 1.0, one(Base::Time)),
    (&["ms", "msec", "millis", "millisecond", "milliseconds", "мс", "мсек"], 1e-3, one(Base::Time)),
    (
        &["us", "µs", "μs", "usec", "micros", "microsecond", "microseconds", "мкс", "мксек"],
        1e-6,
        one(Base::Time),
    ),
    (&["ns", "nsec", "nanos", "nanosecond", "nanoseconds", "нс", "нсек"], 1e-9, one(Base::Time)),
    (&["min", "minute", "minutes", "мин", "мин."], 60.0, one(Base::Time)),
    (&["h", "hr", "hrs", "hour", "hours", "ч", "час"], 3600.0, one(Base::Time)),
    (&["d", "day", "days", "сут"], 86400.0, one(Base::Time)),
    (&["Hz", "Гц"], 1.0, PER_SECOND),
    (&["mHz"], 1e-3, PER_SECOND),
    (&["kHz", "кГц"], 1e3, PER_SECOND),
    (&["dph"], 1.0 / 3600.0, per_time(Base::Angle, 1)),
    (&["dps", "degps"], 1.0, per_time(Base::Angle, 1)),
    (&["radps"], DEG_PER_RAD, per_time(Base::Angle, 1)),
    (&["rpm"], 6.0, per_time(Base::Angle, 1)),
    (&["K", "К", "kelvin"], 1.0, one(Base::Temperature)),
    (CELSIUS_SYMBOLS, 1.0, one(Base::Temperature)),
    (FAHRENHEIT_SYMBOLS, 5.0 / 9.0, one(Base::Temperature)),
    (&["mK"], 1e-3, one(Base::Temperature)),
    (&["V", "В"], 1.0, one(Base::Voltage)),
    (&["mV", "мВ"], 1e-3, one(Base::Voltage)),
    (&["T", "Тл"], 1.0, one(Base::Magnetic)),
    (&["mT", "мТл"], 1e-3, one(Base::Magnetic)),
    (&["uT", "µT", "μT", "мкТл"], 1e-6, one(Base::Magnetic)),
    (&["nT", "нТл"], 1e-9, one(Base::Magnetic)),
    (&["gauss", "Oe", "Гс", "Э"], 1e-4, one(Base::Magnetic)),
    (&["Pa", "Па"], 1.0, one(Base::Pressure)),
    (&["hPa", "mbar", "гПа"], 100.0, one(Base::Pressure)),
    (&["kPa", "кПа"], 1e3, one(Base::Pressure)),
    (&["m", "м"], 1.0, one(Base::Length)),
    (&["mm", "мм"], 1e-3, one(Base::Length)),
    (&["um", "µm"], 1e-6, one(Base::Length)),
    (&["nm"], 1e-9, one(Base::Length)),
    (&["g", "gn"], 9.80665, per_time(Base::Length, 2)),
    (&["mg"], 9.80665e-3, per_time(Base::Length, 2)),
    // Energy taken up by a mass.
    (&["Gy", "Гр"], 1.0, GRAY),
    (&["A", "А"], 1.0, one(Base::Current)),
    // Decibels of a ratio of amplitudes: their zero is a ratio of 1, so that they are no pure number.
    (&["dB", "дБ"], 1.0, one(Base::Level)),
    (&["mA", "мА"], 1e-3, one(Base::Current)),
    (&["W", "Вт"], 1.0, product(Base::Voltage, Base::Current)),
    (&["mW", "мВт"], 1e-3, product(Base::Voltage, Base::Current)),
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
        one(Base::Count),
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
    "deg", "rad", "arcsec", "dps", "dph", "degps", "radps", "sec", "Hz", "V", "A", "T", "Pa", "K", "Gy",
    "град", "рад", "с", "сек", "Гц", "В", "А", "Тл", "Па", "Гр",
];

/// Factor to the base unit and dimension of a symbol: as it is listed, with a prefix of the SI, or in capitals where that
/// is the only difference.
pub(super) fn symbol(name: &str) -> Option<(f64, Dimension)> {
    let listed = |name: &str| {
        let (_, factor, dimension) = UNIT_SYMBOLS.iter().find(|(names, ..)| names.contains(&name))?;
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
pub(super) const SUGGESTED_SYMBOLS: &[&str] = &[
    "deg", "mdeg", "arcmin", "arcsec", "rad", "mrad", "urad", "nrad", "rev", "s", "ms", "us", "ns", "min",
    "h", "day", "Hz", "kHz", "dph", "dps", "rpm", "degC", "K", "degF", "V", "mV", "mT", "uT", "Oe", "Pa",
    "hPa", "kPa", "m", "mm", "g", "mg", "A", "mA", "W", "mW", "Gy", "dB", "count", "LSB", "pulse", "ppm",
    "ppb", "sqrt",
];
