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
pub(super) const FAHRENHEIT: &[&str] = &["degF", "°F", "ºF", "℉"];

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
    (&["rad", "рад"], DEG, one(ANGLE)),
    (&["mrad", "мрад"], DEG * 1e-3, one(ANGLE)),
    (&["urad", "µrad", "μrad", "мкрад"], DEG * 1e-6, one(ANGLE)),
    (&["nrad", "нрад"], DEG * 1e-9, one(ANGLE)),
    (&["rev", "turn", "об"], 360.0, one(ANGLE)),
    (&["s", "sec", "secs", "second", "seconds", "с", "сек", "сек."], 1.0, one(TIME)),
    (&["ms", "msec", "millisecond", "milliseconds", "мс", "мсек"], 1e-3, one(TIME)),
    (&["us", "µs", "μs", "usec", "microsecond", "microseconds", "мкс", "мксек"], 1e-6, one(TIME)),
    (&["ns", "nsec", "nanosecond", "nanoseconds", "нс", "нсек"], 1e-9, one(TIME)),
    (&["min", "minute", "minutes", "мин", "мин."], 60.0, one(TIME)),
    (&["h", "hr", "hrs", "hour", "hours", "ч", "час"], 3600.0, one(TIME)),
    (&["d", "day", "days", "сут"], 86400.0, one(TIME)),
    (&["Hz", "Гц"], 1.0, HERTZ),
    (&["mHz"], 1e-3, HERTZ),
    (&["kHz", "кГц"], 1e3, HERTZ),
    (&["dph"], 1.0 / 3600.0, per_time(ANGLE, 1)),
    (&["dps"], 1.0, per_time(ANGLE, 1)),
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

/// Factor to the base unit and dimension of a symbol.
pub(super) fn symbol(name: &str) -> Option<(f64, Dimension)> {
    let (_, factor, dimension) = SYMBOLS.iter().find(|(names, ..)| names.contains(&name))?;
    Some((*factor, *dimension))
}

/// Every ASCII symbol offered as a suggestion for a misspelt one.
pub(super) const SUGGESTED: &[&str] = &[
    "deg", "mdeg", "arcmin", "arcsec", "rad", "mrad", "urad", "nrad", "rev", "s", "ms", "us", "ns", "min",
    "h", "day", "Hz", "kHz", "dph", "dps", "rpm", "degC", "K", "degF", "V", "mV", "mT", "uT", "Oe", "Pa",
    "hPa", "kPa", "m", "mm", "g", "mg", "A", "mA", "count", "LSB", "pulse", "ppm", "ppb", "sqrt",
];
