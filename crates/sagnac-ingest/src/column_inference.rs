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
    /// Factor from the numbers in the file to that unit; 1 unless the file states another.
    pub scale: f64,
    /// False if neither name nor file states the unit, and the usual unit of the role was assumed.
    pub unit_is_named: bool,
    /// Why role and unit were chosen.
    pub reason: Note,
}

impl InferredColumn {
    /// True when the name of the column speaks of a gyro but the numbers are counts, whose size is not known.
    pub fn counts_of_a_gyro(&self, name: &str) -> bool {
        let counts = parse("count").is_some_and(|c| c.same_dimension(&self.unit));
        let name = name.to_lowercase();
        counts && ["gyro", "fog", "rlg", "rate", "omega"].iter().any(|w| name.contains(w))
    }
}

/// Last words of names that mean a unit, in lower case.
const UNIT_WORDS: &[(&str, &str)] = &[
    ("°f", "degF"),
    ("°c", "degC"),
    ("dph", "deg/h"),
    ("dps", "deg/s"),
    ("degps", "deg/s"),
    ("mdps", "mdps"),
    ("udps", "udps"),
    ("radps", "rad/s"),
    ("mradps", "mrad/s"),
    ("uradps", "urad/s"),
    ("rpm", "rpm"),
    ("degc", "degC"),
    ("celsius", "degC"),
    ("degf", "degF"),
    ("fahrenheit", "degF"),
    ("degk", "K"),
    ("kelvin", "K"),
    ("k", "K"),
    ("c", "degC"),
    ("deg", "deg"),
    ("degrees", "deg"),
    ("mdeg", "mdeg"),
    ("arcsec", "arcsec"),
    ("arcmin", "arcmin"),
    ("rad", "rad"),
    ("radians", "rad"),
    ("mrad", "mrad"),
    ("urad", "urad"),
    ("nrad", "nrad"),
    ("counts", "count"),
    ("count", "count"),
    ("lsb", "count"),
    ("raw", "count"),
    ("pulses", "count"),
    ("pct", "%"),
    ("percent", "%"),
    ("hpa", "hPa"),
    ("kpa", "kPa"),
    ("pa", "Pa"),
    ("mbar", "hPa"),
    ("hz", "Hz"),
    ("khz", "kHz"),
    ("mv", "mV"),
    ("v", "V"),
    ("ma", "mA"),
    ("a", "A"),
    ("ut", "uT"),
    ("nt", "nT"),
    ("mt", "mT"),
    ("gauss", "gauss"),
    ("mg", "mg"),
    ("g", "g"),
    ("ms", "ms"),
    ("msec", "ms"),
    ("millis", "ms"),
    ("milliseconds", "ms"),
    ("us", "us"),
    ("usec", "us"),
    ("micros", "us"),
    ("microseconds", "us"),
    ("ns", "ns"),
    ("nsec", "ns"),
    ("nanos", "ns"),
    ("nanoseconds", "ns"),
    ("nanosec", "ns"),
    ("sec", "s"),
    ("secs", "s"),
    ("seconds", "s"),
    ("s", "s"),
    ("min", "min"),
    ("h", "h"),
    ("hours", "h"),
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
    // An angle that is no increment says nothing of a rate: `gyro_rad` is in rad/s or in rad.
    let of_angle = |u: &Unit| parse("deg").is_some_and(|deg| u.same_dimension(&deg));
    let body_is = NameWords(body);
    let half = source == "guess.ending"
        && unit.as_ref().is_some_and(of_angle)
        && body_is.any(GYRO_NAMES)
        && !body_is.any(INCREMENT)
        && !body_is.any(ANGLE);
    let (unit, source) = if half { (None, "guess.none") } else { (unit, source) };
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
    InferredColumn { role, unit, scale: 1.0, unit_is_named: named, reason }
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
    let mut rest = name.chars();
    while let Some(c) = rest.next() {
        // `degC`, `degF` and prefixed units such as `hPa` are one word.
        let degree = word.ends_with("deg") && matches!(c, 'C' | 'F' | 'K');
        // Behind capitals a new word begins with the last of them: `GyroXRadPerSec`, but `MHz`.
        let after = rest.clone().next().is_some_and(char::is_lowercase);
        let prefixed =
            ["Hz", "Pa"].into_iter().any(|u| rest.as_str().starts_with(&u[1..]) && u.starts_with(c));
        let hump = c.is_uppercase()
            && !degree
            && ((before.is_lowercase() && word.chars().count() > 1)
                || (before.is_uppercase() && after && !prefixed));
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
    let word = |back: usize| {
        words.len().checked_sub(back).filter(|&i| i > 0).and_then(|i| words.get(i)).map(String::as_str)
    };
    let over = |quantity: Option<&str>, time: Option<&str>, used: usize| {
        // `gyro_rad_s`, `RadPerSec`: an angle over a time.
        let is =
            |text: &str, like: &str| parse(text).zip(parse(like)).is_some_and(|(u, l)| u.same_dimension(&l));
        let (quantity, time) = (quantity?, time?);
        let angle = is(quantity, "deg") && is(time, "s");
        angle.then(|| parse(&format!("{quantity}/{time}"))).flatten().map(|unit| (unit, used))
    };
    let acceleration = |length: Option<&str>, square: Option<&str>, used: usize| {
        let length = length.filter(|l| matches!(*l, "m" | "mm" | "um" | "nm"))?;
        square.filter(|s| *s == "s2")?;
        Some((parse(&format!("{length}/s^2"))?, used))
    };
    let of_rate = || match (word(3), word(2), word(1)) {
        (quantity, Some("per"), time) => over(quantity, time, 3),
        // The words of `rad s^-1` and `m s^-2`.
        (quantity, time, Some("1")) => over(quantity, time, 3),
        (length, Some("s"), Some("2")) => acceleration(length, Some("s2"), 3),
        (_, quantity, time) => over(quantity, time, 2),
    };
    if let Some(found) = of_rate().or_else(|| acceleration(word(2), word(1), 2)) {
        return Some(found);
    }
    // Names that are all unit and mean nothing but a time.
    if let [only] = words {
        let parts = ["millis", "micros", "nanos", "milliseconds", "microseconds", "nanoseconds"];
        return parse(only).filter(|_| parts.contains(&only.as_str())).map(|unit| (unit, 0));
    }
    let last = word(1)?;
    // A bare F may be anything but behind a temperature.
    if last == "f" && words.iter().any(|w| w == "temp" || TEMPERATURE.contains(&w.as_str())) {
        return parse("degF").map(|u| (u, 1));
    }
    let listed = UNIT_WORDS.iter().find(|(ending, _)| *ending == last).map(|(_, unit)| *unit);
    // A unit in its own spelling, such as `deg/h`.
    let unit = listed.or_else(|| Some(last).filter(|l| l.contains('/')))?;
    parse(unit).map(|u| (u, 1))
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
/// Further words of names of rates where the unit is that of a rate.
const ANGULAR: &[&str] =
    &["ang", "vel", "velocity", "angvel", "gyros", "ars", "roll", "pitch", "yaw", "output"];
/// Words of names that speak of a gyro and yet are no output of it.
const NO_OUTPUT: &[&str] = &[
    "orientation",
    "quaternion",
    "quat",
    "attitude",
    "status",
    "flag",
    "flags",
    "valid",
    "error",
    "errors",
    "clip",
    "clipping",
    "baud",
];
/// Words before `rate` that make it none of a gyro.
const OTHER_RATES: &[&str] = &["sample", "sampling", "data", "frame", "update", "refresh", "bit", "packet"];
/// Words of names of angles.
const ANGLE: &[&str] =
    &["angle", "angles", "theta", "sum", "heading", "yaw", "roll", "pitch", "угол", "угла"];
/// Words that mean a gyro and nothing else.
const GYRO_NAMES: &[&str] = &["gyro", "gyr", "gyroscope", "гироскоп", "гироскопа", "вог"];
/// Words of names of angles that accrue from sample to sample.
const INCREMENT: &[&str] =
    &["delta", "dtheta", "increment", "inc", "dangle", "dtheta_x", "приращение", "приращения"];
/// Words of names of times.
const TIME: &[&str] = &[
    "time",
    "t",
    "ts",
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
    "datenum",
    "millis",
    "micros",
    "nanos",
    "milliseconds",
    "microseconds",
    "nanoseconds",
    "время",
    "т",
    "секунды",
];
/// Words of names of sample counters.
const COUNTER: &[&str] = &[
    "counter",
    "sample",
    "samples",
    "packet",
    "cnt",
    "пакет",
    "кадр",
    "seq",
    "sequence",
    "счётчик",
    "счетчик",
    "отсчёт",
    "отсчет",
];
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

    /// True for rates such as `sample_rate`.
    fn of_another_rate(&self) -> bool {
        let gyro: Vec<&String> = self.0.iter().filter(|w| GYRO.contains(&w.as_str())).collect();
        self.any(OTHER_RATES) && gyro.iter().all(|w| *w == "rate")
    }

    /// True when a word can mean nothing but a temperature.
    fn temperature_word(&self) -> bool {
        self.any(TEMPERATURE) || self.numbered("temp")
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
        _ if is(RATE) && (gyro || words.len() <= 2 || name.any(ANGULAR)) => Role::Rate,
        _ if is("deg") && table => Role::TableAngle,
        _ if is("deg") && increment => Role::AngleIncrement,
        _ if is("degC") => Role::Temperature,
        // LabVIEW names its times `X_Value`.
        _ if is("s") && (name.any(TIME) || words == ["x", "value"]) => Role::Time,
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
        _ if name.counter() && !gyro && !increment && !name.any(&["time", "timestamp"]) => Role::Counter,
        _ if counts => Role::Auxiliary,
        _ if table && name.any(&["rate", "speed", "скорость"]) => Role::TableRate,
        _ if table && name.any(&["angle", "position", "угол", "положение"]) => Role::TableAngle,
        _ if gyro && name.temperature_word() => Role::Temperature,
        _ if gyro && (name.any(NO_OUTPUT) || name.of_another_rate()) => Role::Auxiliary,
        _ if increment => Role::AngleIncrement,
        _ if gyro => Role::Rate,
        _ if name.any(&["time", "timestamp", "время"]) || name.0 == ["t"] => Role::Time,
        // `seconds_of_day`: nothing but time is counted in them. Seconds of a week are recognised by the reader.
        _ if name.any(&["seconds", "sod", "datenum", "секунды"]) => Role::Time,
        _ if name.temperature() => Role::Temperature,
        _ if name.any(SUPPLY) => Role::Supply,
        _ => Role::Auxiliary,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::too_many_lines, reason = "one list of cases or data")]
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
            ("w_RS_S_x [rad s^-1]", Role::Rate, "rad/s"),
            ("wx (rad.s-1)", Role::Rate, "rad/s"),
            ("gyro_x [deg s-1]", Role::Rate, "deg/s"),
            ("gx (mdps)", Role::Rate, "mdps"),
            ("gyro_x_radps", Role::Rate, "rad/s"),
            ("Gyro X (Degrees/s)", Role::Rate, "deg/s"),
            ("UncalGyroXRadPerSec", Role::Rate, "rad/s"),
            ("ang_vel_x [rad/s]", Role::Rate, "rad/s"),
            ("gyro_rad_s^-1", Role::Rate, "rad/s"),
            ("utcTimeMillis", Role::Time, "ms"),
            ("time_usec", Role::Time, "us"),
            ("TimeUS", Role::Time, "us"),
            ("timestamp_sample", Role::Time, "s"),
            ("millis", Role::Time, "ms"),
            ("Temp (F)", Role::Temperature, "degF"),
            ("temp_f", Role::Temperature, "degF"),
            ("Temperature °F", Role::Temperature, "degF"),
            ("gyro_temp", Role::Temperature, "degC"),
            ("field.orientation.w", Role::Auxiliary, "1"),
            ("sample_rate", Role::Auxiliary, "1"),
            ("gyro_data_x", Role::Rate, "deg/h"),
            ("gyro_rad[0]", Role::Rate, "deg/h"),
            ("gyro_status", Role::Auxiliary, "1"),
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
