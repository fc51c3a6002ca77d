//! The symbols of units, English and Russian.

use super::{
    ANGLE, BASES, COUNT, CURRENT, Dimension, LENGTH, MAGNETIC, PRESSURE, TEMPERATURE, TIME, VOLTAGE,
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

/// Symbol, factor to the base unit, dimension (in halves).
pub(super) fn symbol(name: &str) -> Option<(f64, Dimension)> {
    const DEG: f64 = 180.0 / std::f64::consts::PI;
    let one = |i: usize| {
        let mut d = [0; BASES];
        d[i] = 2;
        d
    };
    let rate = |f: f64| {
        let mut d = one(ANGLE);
        d[TIME] = -2;
        (f, d)
    };
    Some(match name {
        "1" => (1.0, [0; BASES]),
        "%" | "percent" => (1e-2, [0; BASES]),
        "ppm" => (1e-6, [0; BASES]),
        "ppb" => (1e-9, [0; BASES]),
        "deg" | "degs" | "°" | "º" | "˚" | "degree" | "degrees" | "град" | "градус" => {
            (1.0, one(ANGLE))
        }
        "mdeg" | "мград" => (1e-3, one(ANGLE)),
        "udeg" => (1e-6, one(ANGLE)),
        "arcmin" | "угл.мин" | "угл.мин." | "′" => (1.0 / 60.0, one(ANGLE)),
        "arcsec" | "asec" | "угл.с" | "угл.сек" | "угл.сек." | "\"" | "″" | "ʺ" => {
            (1.0 / 3600.0, one(ANGLE))
        }
        "marcsec" | "mas" => (1.0 / 3.6e6, one(ANGLE)),
        "rad" | "рад" => (DEG, one(ANGLE)),
        "mrad" | "мрад" => (DEG * 1e-3, one(ANGLE)),
        "urad" | "µrad" | "μrad" | "мкрад" => (DEG * 1e-6, one(ANGLE)),
        "nrad" | "нрад" => (DEG * 1e-9, one(ANGLE)),
        "rev" | "turn" | "об" => (360.0, one(ANGLE)),
        "s" | "sec" | "secs" | "second" | "seconds" | "с" | "сек" | "сек." => (1.0, one(TIME)),
        "ms" | "msec" | "millisecond" | "milliseconds" | "мс" | "мсек" => (1e-3, one(TIME)),
        "us" | "µs" | "μs" | "usec" | "microsecond" | "microseconds" | "мкс" | "мксек" => {
            (1e-6, one(TIME))
        }
        "ns" | "nsec" | "nanosecond" | "nanoseconds" | "нс" | "нсек" => (1e-9, one(TIME)),
        "min" | "minute" | "minutes" | "мин" | "мин." => (60.0, one(TIME)),
        "h" | "hr" | "hrs" | "hour" | "hours" | "ч" | "час" => (3600.0, one(TIME)),
        "d" | "day" | "days" | "сут" => (86400.0, one(TIME)),
        "Hz" | "Гц" => (1.0, inverse(one(TIME))),
        "mHz" => (1e-3, inverse(one(TIME))),
        "kHz" | "кГц" => (1e3, inverse(one(TIME))),
        "dph" => rate(1.0 / 3600.0),
        "dps" => rate(1.0),
        "rpm" => rate(6.0),
        "K" | "К" | "kelvin" => (1.0, one(TEMPERATURE)),
        name if CELSIUS.contains(&name) => (1.0, one(TEMPERATURE)),
        "mK" => (1e-3, one(TEMPERATURE)),
        name if FAHRENHEIT.contains(&name) => (5.0 / 9.0, one(TEMPERATURE)),
        "V" | "В" => (1.0, one(VOLTAGE)),
        "mV" | "мВ" => (1e-3, one(VOLTAGE)),
        "T" | "Тл" => (1.0, one(MAGNETIC)),
        "mT" | "мТл" => (1e-3, one(MAGNETIC)),
        "uT" | "µT" | "μT" | "мкТл" => (1e-6, one(MAGNETIC)),
        "nT" | "нТл" => (1e-9, one(MAGNETIC)),
        "gauss" | "Oe" | "Гс" | "Э" => (1e-4, one(MAGNETIC)),
        "Pa" | "Па" => (1.0, one(PRESSURE)),
        "hPa" | "mbar" | "гПа" => (100.0, one(PRESSURE)),
        "kPa" | "кПа" => (1e3, one(PRESSURE)),
        "m" | "м" => (1.0, one(LENGTH)),
        "mm" | "мм" => (1e-3, one(LENGTH)),
        "um" | "µm" | "nm" => (if name == "nm" { 1e-9 } else { 1e-6 }, one(LENGTH)),
        "g" | "gn" => {
            let mut d = one(LENGTH);
            d[TIME] = -4;
            (9.80665, d)
        }
        "mg" => {
            let mut d = one(LENGTH);
            d[TIME] = -4;
            (9.80665e-3, d)
        }
        "A" | "А" => (1.0, one(CURRENT)),
        "mA" | "мА" => (1e-3, one(CURRENT)),
        "count" | "counts" | "cnt" | "LSB" | "lsb" | "pulse" | "pulses" | "имп" | "имп." | "отсч"
        | "отсч." | "отсчёт" | "отсчет" | "ед" | "ед." | "МЗР" => (1.0, one(COUNT)),
        _ => return None,
    })
}

/// Every ASCII symbol offered as a suggestion for a misspelt one.
pub(super) const SUGGESTED: &[&str] = &[
    "deg", "mdeg", "arcmin", "arcsec", "rad", "mrad", "urad", "nrad", "rev", "s", "ms", "us", "ns", "min",
    "h", "day", "Hz", "kHz", "dph", "dps", "rpm", "degC", "K", "degF", "V", "mV", "mT", "uT", "Oe", "Pa",
    "hPa", "kPa", "m", "mm", "g", "mg", "A", "mA", "count", "LSB", "pulse", "ppm", "ppb", "sqrt",
];

pub(super) fn inverse(mut d: Dimension) -> Dimension {
    d.iter_mut().for_each(|e| *e = -*e);
    d
}
