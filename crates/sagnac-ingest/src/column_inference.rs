//! What a column may be, from its name: role and unit, with the reason. Used where no procedure says it.

use sagnac_core::message::{Arg, Note};
use sagnac_core::recording::Role;
use sagnac_core::units::Unit;

/// Role and unit of a column, inferred from its name and from the unit that the file states.
#[derive(Debug, Clone, PartialEq)]
pub struct InferredColumn {
    /// Role.
    pub role: Role,
    /// Unit of the numbers in the file.
    pub unit: Unit,
    /// False if neither name nor file states the unit, and the usual unit of the role was assumed.
    pub unit_is_named: bool,
    /// Why role and unit were chosen.
    pub reason: Note,
}

/// Name endings that mean a unit, as words joined by `_`.
const UNIT_WORDS: &[(&[&str], &str)] = &[
    (&["deg", "per", "h"], "deg/h"),
    (&["deg", "per", "hr"], "deg/h"),
    (&["deg", "per", "hour"], "deg/h"),
    (&["deg", "per", "s"], "deg/s"),
    (&["deg", "per", "sec"], "deg/s"),
    (&["rad", "per", "s"], "rad/s"),
    (&["rad", "per", "sec"], "rad/s"),
    (&["deg", "h"], "deg/h"),
    (&["deg", "hr"], "deg/h"),
    (&["deg", "s"], "deg/s"),
    (&["deg", "sec"], "deg/s"),
    (&["mdeg", "s"], "mdeg/s"),
    (&["mdeg", "h"], "mdeg/h"),
    (&["rad", "s"], "rad/s"),
    (&["mrad", "s"], "mrad/s"),
    (&["urad", "s"], "urad/s"),
    (&["nrad", "s"], "nrad/s"),
    (&["arcsec", "s"], "arcsec/s"),
    (&["m", "s2"], "m/s^2"),
    (&["mm", "s2"], "mm/s^2"),
    (&["um", "s2"], "um/s^2"),
    (&["nm", "s2"], "nm/s^2"),
    (&["dph"], "deg/h"),
    (&["dps"], "deg/s"),
    (&["rpm"], "rpm"),
    (&["degc"], "degC"),
    (&["degf"], "degF"),
    (&["degk"], "K"),
    (&["k"], "K"),
    (&["c"], "degC"),
    (&["deg"], "deg"),
    (&["mdeg"], "mdeg"),
    (&["arcsec"], "arcsec"),
    (&["arcmin"], "arcmin"),
    (&["rad"], "rad"),
    (&["mrad"], "mrad"),
    (&["urad"], "urad"),
    (&["nrad"], "nrad"),
    (&["counts"], "count"),
    (&["count"], "count"),
    (&["lsb"], "count"),
    (&["raw"], "count"),
    (&["pulses"], "count"),
    (&["pct"], "%"),
    (&["percent"], "%"),
    (&["hpa"], "hPa"),
    (&["kpa"], "kPa"),
    (&["pa"], "Pa"),
    (&["mbar"], "hPa"),
    (&["hz"], "Hz"),
    (&["khz"], "kHz"),
    (&["mv"], "mV"),
    (&["v"], "V"),
    (&["ma"], "mA"),
    (&["a"], "A"),
    (&["ut"], "uT"),
    (&["nt"], "nT"),
    (&["mt"], "mT"),
    (&["gauss"], "gauss"),
    (&["mg"], "mg"),
    (&["g"], "g"),
    (&["ms"], "ms"),
    (&["us"], "us"),
    (&["ns"], "ns"),
    (&["sec"], "s"),
    (&["seconds"], "s"),
    (&["s"], "s"),
    (&["min"], "min"),
    (&["h"], "h"),
];

/// What a dimension of a unit says of a column, with the words for it.
const RATE: &str = "deg/h";

/// Infers role and unit of a column. `declared_unit` is the unit that the format itself states, if any.
pub fn infer(name: &str, declared_unit: Option<&str>) -> InferredColumn {
    let (stem, bracketed) = split_brackets(name);
    let words = words(&stem);
    let (unit, body, source) = if let Some(unit) = declared_unit.and_then(parse) {
        (Some(unit), words.as_slice(), "guess.declared")
    } else if let Some(unit) = bracketed.as_deref().filter(|b| *b != "1").and_then(parse) {
        (Some(unit), words.as_slice(), "guess.brackets")
    } else if let Some((unit, used)) = unit_at_end(&words) {
        (Some(unit), words.get(..words.len() - used).unwrap_or_default(), "guess.ending")
    } else {
        (None, words.as_slice(), "guess.none")
    };
    let role = role(body, unit.as_ref());
    let named = unit.is_some();
    let usual = role.internal_unit().unwrap_or("1");
    let fitting = unit.filter(|u| role.internal_unit().is_none_or(|i| parse(i).is_some_and(|i| fits(u, &i))));
    let unit = fitting.unwrap_or_else(|| Unit::parse(usual).expect("the inside units are units"));
    let key = match (role, named) {
        (Role::Auxiliary, _) => "guess.nothing",
        (_, true) => "guess.by_unit",
        (_, false) => "guess.by_name",
    };
    let reason = Note::new(key)
        .with("name", name)
        .with("source", Note::new(source))
        .with("role", Arg::key("role", role.id()))
        .with("unit", usual);
    InferredColumn { role, unit, unit_is_named: named, reason }
}

/// The words of a name without its unit: `Rate [deg/h]` and `rate_deg_s` are one quantity.
pub fn stem(name: &str) -> Vec<String> {
    let (body, bracketed) = split_brackets(name);
    let mut words = words(&body);
    if bracketed.is_none()
        && let Some((_, used)) = unit_at_end(&words)
    {
        words.truncate(words.len() - used);
    }
    words
}

/// The unit that the format of a file declares for a column, or else the one that its name spells, whatever it measures.
pub fn named_unit(name: &str, declared_unit: Option<&str>) -> Option<Unit> {
    let (stem, bracketed) = split_brackets(name);
    declared_unit
        .and_then(parse)
        .or_else(|| bracketed.as_deref().and_then(parse))
        .or_else(|| unit_at_end(&words(&stem)).map(|(unit, _)| unit))
}

fn parse(text: &str) -> Option<Unit> {
    Unit::parse(text).ok()
}

fn fits(unit: &Unit, role_unit: &Unit) -> bool {
    unit.same_dimension(role_unit) || parse("count").is_some_and(|c| unit.same_dimension(&c))
}

/// The text before brackets and the text in them: `rate [deg/h]`, `Rate (deg/s)`, `rate, deg/h`.
pub(crate) fn split_brackets(name: &str) -> (String, Option<String>) {
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some((stem, rest)) = name.split_once(open) {
            let inner = rest.rfind(close).and_then(|end| rest.get(..end));
            if let Some(inner) = inner {
                return (stem.trim().to_owned(), Some(inner.trim().to_owned()));
            }
        }
    }
    match name.rsplit_once(',').filter(|(_, u)| parse(u).is_some()) {
        Some((stem, unit)) => (stem.trim().to_owned(), Some(unit.trim().to_owned())),
        None => (name.to_owned(), None),
    }
}

/// Lower-case words of a name: cut at anything that is no letter or digit, and between `camelCase`.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut word = String::new();
    let mut before = ' ';
    for c in name.chars() {
        // `degC`, `degF` and prefixed units such as `hPa` are one word.
        let degree = word.ends_with("deg") && matches!(c, 'C' | 'F' | 'K');
        let hump = before.is_lowercase() && c.is_uppercase() && word.chars().count() > 1 && !degree;
        if (!c.is_alphanumeric() && c != '/' && c != '°' && c != '%') || hump {
            words.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
        }
        if c.is_alphanumeric() || c == '/' || c == '°' || c == '%' {
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    words.extend((!word.is_empty()).then_some(word));
    words
}

/// The unit that the last words of a name spell, and how many words it takes. A name that is all unit, such as `g`,
/// is no unit.
fn unit_at_end(words: &[String]) -> Option<(Unit, usize)> {
    for (ending, unit) in UNIT_WORDS {
        let Some(start) = words.len().checked_sub(ending.len()).filter(|&s| s > 0) else { continue };
        if words.get(start..).is_some_and(|w| w.iter().map(String::as_str).eq(ending.iter().copied())) {
            return parse(unit).map(|u| (u, ending.len()));
        }
    }
    // A unit in its own spelling, such as `deg/h`.
    let last = words.last().filter(|_| words.len() > 1)?;
    if last.contains('/') { parse(last).map(|u| (u, 1)) } else { None }
}

/// Words of names of temperatures.
const TEMPERATURE: &[&str] = &["temperature", "температура", "температуры", "темп"];
/// Words of names of quantities of a rate table.
const TABLE: &[&str] = &["table", "turntable", "стенд", "стенда", "стол", "стола", "платформа", "платформы"];
/// Words that mean the outer axis of a table.
const OUTER: &[&str] = &["outer", "внешняя", "внешней"];
/// Words of names of rates.
const GYRO: &[&str] = &[
    "gyro",
    "gyr",
    "gyroscope",
    "rate",
    "omega",
    "rot",
    "rotation",
    "angular",
    "w",
    "wx",
    "wy",
    "wz",
    "gx",
    "gy",
    "gz",
    "fog",
    "rlg",
    "ω",
    "ωx",
    "ωy",
    "ωz",
    "угловая",
    "скорость",
    "гироскоп",
    "гироскопа",
    "вог",
    "лг",
    "выходной",
];
/// Words of names of angles that accrue from sample to sample.
const INCREMENT: &[&str] =
    &["delta", "dtheta", "increment", "inc", "dangle", "dtheta_x", "приращение", "приращения"];
/// Words of names of times.
const TIME: &[&str] = &[
    "time",
    "t",
    "timestamp",
    "stamp",
    "seconds",
    "sec",
    "epoch",
    "utc",
    "unix",
    "gps",
    "tow",
    "sow",
    "clock",
    "datetime",
    "время",
    "т",
    "секунды",
];
/// Words of names of sample counters.
const COUNTER: &[&str] =
    &["counter", "sample", "samples", "seq", "sequence", "счётчик", "счетчик", "отсчёт", "отсчет"];
/// Words of names of other sensors, whose counts are no rates.
const OTHER_SENSOR: &[&str] =
    &["accel", "acc", "accelerometer", "mag", "magnetometer", "pressure", "humidity"];
/// Words of names of supply voltages where the name has no unit.
const SUPPLY: &[&str] = &["supply", "vcc", "vdd", "питание", "питания", "напряжение"];
/// Further words of names of supply voltages in V.
const SUPPLY_IN_VOLTS: [&str; 2] = ["psu", "voltage"];

/// What the words of a name speak of.
struct NameWords<'a>(&'a [String]);

impl NameWords<'_> {
    fn any(&self, list: &[&str]) -> bool {
        self.0.iter().any(|w| list.contains(&w.as_str()))
    }

    /// True when a word is a stem with a number behind it, such as `temp2`.
    fn numbered(&self, stem: &str) -> bool {
        let number = |w: &String| w.strip_prefix(stem).is_some_and(|r| r.chars().all(|c| c.is_ascii_digit()));
        self.0.iter().any(number)
    }

    fn temperature(&self) -> bool {
        self.any(TEMPERATURE) || ["temp", "t", "т"].into_iter().any(|stem| self.numbered(stem))
    }

    fn counter(&self) -> bool {
        let alone = ["n", "index", "idx", "i", "count", "номер"];
        let by_itself = matches!(self.0, [only] if alone.contains(&only.as_str()));
        self.any(COUNTER) || by_itself || self.0.is_empty()
    }
}

/// The role of a column by the words of its name and its unit.
fn role(words: &[String], unit: Option<&Unit>) -> Role {
    let is = |text: &str| unit.is_some_and(|u| parse(text).is_some_and(|t| u.same_dimension(&t)));
    let name = NameWords(words);
    let (table, gyro, increment) = (name.any(TABLE), name.any(GYRO), name.any(INCREMENT));
    match () {
        _ if is(RATE) && name.any(OUTER) => Role::OuterRate,
        _ if is(RATE) && table => Role::TableRate,
        _ if is(RATE) && (gyro || words.len() <= 2) => Role::Rate,
        _ if is("deg") && table => Role::TableAngle,
        _ if is("deg") && increment => Role::AngleIncrement,
        _ if is("degC") => Role::Temperature,
        _ if is("s") && name.any(TIME) => Role::Time,
        _ if is("V") && (name.any(SUPPLY) || name.any(&SUPPLY_IN_VOLTS)) => Role::Supply,
        _ if unit.is_some() && !is("count") => Role::Auxiliary,
        _ => role_without_dimension(&name, unit.is_some()),
    }
}

/// The role of a column of counts, or of one whose unit is not known.
fn role_without_dimension(name: &NameWords<'_>, counts: bool) -> Role {
    let (table, gyro, increment) = (name.any(TABLE), name.any(GYRO), name.any(INCREMENT));
    match () {
        _ if name.any(OTHER_SENSOR) => Role::Auxiliary,
        _ if name.counter() && !gyro && !increment => Role::Counter,
        _ if counts => Role::Auxiliary,
        _ if table && name.any(&["rate", "speed", "скорость"]) => Role::TableRate,
        _ if table && name.any(&["angle", "position", "угол", "положение"]) => Role::TableAngle,
        _ if increment => Role::AngleIncrement,
        _ if gyro => Role::Rate,
        _ if name.any(&["time", "timestamp", "время"]) || name.0 == ["t"] => Role::Time,
        // `seconds_of_day`: nothing but time is counted in them. Seconds of a week are recognised by the reader.
        _ if name.any(&["seconds", "sod", "секунды"]) => Role::Time,
        _ if name.temperature() => Role::Temperature,
        _ if name.any(SUPPLY) => Role::Supply,
        _ => Role::Auxiliary,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_real_recordings_are_understood() {
        for (name, role, unit) in [
            ("time_s", Role::Time, "s"),
            ("t_s", Role::Time, "s"),
            ("time_nominal_s", Role::Time, "s"),
            ("Timestamp [ms]", Role::Time, "ms"),
            ("time", Role::Time, "s"),
            ("seconds_of_day", Role::Time, "s"),
            ("rate_deg_h", Role::Rate, "deg/h"),
            ("gyro_x_rad_s", Role::Rate, "rad/s"),
            ("rate_x_deg_s", Role::Rate, "deg/s"),
            ("rotation_z_nrad_s", Role::Rate, "nrad/s"),
            ("rot_rate_nrad_s", Role::Rate, "nrad/s"),
            ("rate [deg/h]", Role::Rate, "deg/h"),
            ("Rate (deg/s)", Role::Rate, "deg/s"),
            ("скорость [град/ч]", Role::Rate, "deg/h"),
            ("rate", Role::Rate, "deg/h"),
            ("temp_degC", Role::Temperature, "degC"),
            ("temp_gyro_x_degC", Role::Temperature, "degC"),
            ("Temperature (K)", Role::Temperature, "K"),
            ("supply_v", Role::Supply, "V"),
            ("table_rate_deg_s", Role::TableRate, "deg/s"),
            ("rate_table_deg_s", Role::TableRate, "deg/s"),
            ("table_angle_deg", Role::TableAngle, "deg"),
            ("delta_angle_x_deg", Role::AngleIncrement, "deg"),
            ("freq_hz", Role::Auxiliary, "Hz"),
            ("phase_s", Role::Auxiliary, "s"),
            ("accel_x_g", Role::Auxiliary, "g"),
            ("accel_x_m_s2", Role::Auxiliary, "m/s^2"),
            ("acc_vertical_nm_s2", Role::Auxiliary, "nm/s^2"),
            ("humidity_pct", Role::Auxiliary, "%"),
            ("pressure_hPa", Role::Auxiliary, "hPa"),
            ("mag_x_uT", Role::Auxiliary, "uT"),
            ("pitch_deg", Role::Auxiliary, "deg"),
            ("angle_sum_x_deg", Role::Auxiliary, "deg"),
            ("gyro_raw_counts", Role::Auxiliary, "count"),
            ("sample_index", Role::Counter, "1"),
            ("host_counter", Role::Counter, "1"),
            ("N", Role::Counter, "1"),
            ("№", Role::Counter, "1"),
            ("Время, мс", Role::Time, "ms"),
            ("t, с", Role::Time, "s"),
            ("timestamp_us", Role::Time, "us"),
            ("Угловая скорость, град/ч", Role::Rate, "deg/h"),
            ("ωx, °/с", Role::Rate, "deg/s"),
            ("Ω", Role::Rate, "deg/h"),
            ("Выходной сигнал, град/ч", Role::Rate, "deg/h"),
            ("Гироскоп", Role::Rate, "deg/h"),
            ("Приращение угла, угл.с", Role::AngleIncrement, "arcsec"),
            ("Температура, °C", Role::Temperature, "degC"),
            ("Т1, °С", Role::Temperature, "degC"),
            ("Т1", Role::Temperature, "degC"),
            ("Напряжение, В", Role::Supply, "V"),
            ("Питание, мВ", Role::Supply, "mV"),
            ("Угол стола, град", Role::TableAngle, "deg"),
            ("Скорость стенда, град/с", Role::TableRate, "deg/s"),
            ("segment_index", Role::Auxiliary, "1"),
            ("rate (1)", Role::Rate, "deg/h"),
            ("section", Role::Auxiliary, "1"),
            ("reset", Role::Auxiliary, "1"),
        ] {
            let g = infer(name, None);
            let expected = Unit::parse(unit).unwrap();
            assert_eq!(g.role, role, "{name}: {}", g.reason.plain());
            assert!(
                g.unit.factor_to(&expected).is_ok_and(|f| (f - 1.0).abs() < 1e-12),
                "{name}: {} instead of {unit}",
                g.unit
            );
        }
    }

    #[test]
    fn a_unit_declared_by_the_file_counts() {
        let g = infer("timestamp", Some("ns"));
        assert_eq!((g.role, g.unit.text()), (Role::Time, "ns"));
    }

    #[test]
    fn an_assumed_unit_is_said_to_be_assumed() {
        let g = infer("gyro_z", None);
        assert!(!g.unit_is_named && g.reason.id == "guess.by_name", "{}", g.reason.plain());
    }
}
