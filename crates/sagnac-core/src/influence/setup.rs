//! What a procedure states of such a test.

use crate::noise::in_band::Band;
use crate::recording::{Channel, Role};

/// A stretch of the recording: the files of a phase, or a span of time, or both.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stated {
    /// Phase of a manifest.
    pub phase: Option<String>,
    /// Start, s from the start of the recording.
    pub from_s: Option<f64>,
    /// End, s from the start of the recording.
    pub to_s: Option<f64>,
}

/// A series of switching off and on.
#[derive(Debug, Clone, PartialEq)]
pub struct RepeatabilityTest {
    /// Time after switching on that is left out of every run, s.
    pub settling_s: f64,
    /// Least length of a run without its settling, s.
    pub minimum_run_s: f64,
    /// Least time without output that divides two runs of one file, s.
    pub off_s: f64,
    /// Runs that there must be at least.
    pub fewest: usize,
    /// Channel of the unit's temperature; `None`: the first.
    pub temperature: Option<String>,
    /// The runs; empty: every file is one, or every stretch between times without output.
    pub runs: Vec<Stated>,
}

/// What a test changes on purpose: one of the influences with a table of their own, or one that a procedure declares.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Influence {
    /// Magnetic field.
    MagneticField,
    /// Supply voltage.
    Supply,
    /// Vibration, rms acceleration.
    Vibration,
    /// Any other, with the channel, unit and law that the procedure declares.
    Declared,
}

impl Influence {
    /// Every influence.
    pub const ALL: [Influence; 4] =
        [Influence::MagneticField, Influence::Supply, Influence::Vibration, Influence::Declared];

    /// Table of a procedure that asks for the test.
    pub fn table(self) -> &'static str {
        match self {
            Influence::MagneticField => "magnetic_test",
            Influence::Supply => "supply_test",
            Influence::Vibration => "vibration_test",
            Influence::Declared => "influence_test",
        }
    }
}

/// The law that bias and scale factor follow the level by. Every term is zero at the reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// In proportion to the level.
    Linear,
    /// In proportion to the square of the level, as of what is rectified.
    Square,
    /// A parabola about the reference.
    LinearQuadratic,
    /// A change when the influence is there, of its own size at every level.
    OnOff,
}

impl Law {
    /// Every law.
    pub const ALL: [Law; 4] = [Law::Linear, Law::Square, Law::LinearQuadratic, Law::OnOff];

    /// Id in procedures and results.
    pub fn id(self) -> &'static str {
        match self {
            Law::Linear => "linear",
            Law::Square => "quadratic",
            Law::LinearQuadratic => "linear_quadratic",
            Law::OnOff => "on_off",
        }
    }

    /// Degrees of the terms; 0 is that of presence alone.
    pub fn degrees(self) -> &'static [u8] {
        match self {
            Law::Linear => &[1],
            Law::Square => &[2],
            Law::LinearQuadratic => &[1, 2],
            Law::OnOff => &[0],
        }
    }

    /// The quantity that the term of a degree is proportional to, at a level other than the reference.
    pub fn drive(self, degree: u8, level: f64, reference: f64) -> f64 {
        match (self, degree) {
            (Law::OnOff, _) => 1.0,
            (Law::Square, _) => level * level - reference * reference,
            (_, 2) => (level - reference).powi(2),
            _ => level - reference,
        }
    }
}

/// A unit of a level, with the units of what is told per level and per square of it.
#[derive(Debug, PartialEq)]
pub struct LevelUnit {
    /// The unit.
    pub id: &'static str,
    /// Units of a change of the bias per level and per square of the level.
    pub bias: [&'static str; 2],
    /// Units of a change of the scale factor per level and per square of the level.
    pub scale_factor: [&'static str; 2],
}

macro_rules! level_units {
    ($($unit:literal $per:literal),* $(,)?) => {
        /// Every unit that a level may have.
        pub static LEVEL_UNITS: &[LevelUnit] = &[$(LevelUnit {
            id: $unit,
            bias: [concat!("deg/h/", $per), concat!("deg/h/", $per, "^2")],
            scale_factor: [concat!("ppm/", $per), concat!("ppm/", $per, "^2")],
        }),*];

        /// Units of a change of the bias per level.
        pub const BIAS_PER_LEVEL: &[&str] = &[$(concat!("deg/h/", $per)),*];
        /// Units of a change of the bias per square of the level.
        pub const BIAS_PER_SQUARE: &[&str] = &[$(concat!("deg/h/", $per, "^2")),*];
        /// Units of a change of the scale factor per level.
        pub const SCALE_FACTOR_PER_LEVEL: &[&str] = &[$(concat!("ppm/", $per)),*];
        /// Units of a change of the scale factor per square of the level.
        pub const SCALE_FACTOR_PER_SQUARE: &[&str] = &[$(concat!("ppm/", $per, "^2")),*];
    };
}

level_units! {
    "mT" "mT",
    "V" "V",
    "g" "g",
    "kPa" "kPa",
    "%" "%",
    "A" "A",
    "V/m" "(V/m)",
    "W/m^2" "(W/m^2)",
    "Gy" "Gy",
    "deg/s^2" "(deg/s^2)",
}

impl LevelUnit {
    /// The unit of an id.
    pub fn of(id: &str) -> Option<&'static LevelUnit> {
        LEVEL_UNITS.iter().find(|u| u.id == id)
    }
}

/// What tells the level of an influence.
#[derive(Debug, Clone, PartialEq)]
pub enum ToldBy {
    /// Every channel of a role, each an axis of its own.
    Role(Role),
    /// One channel.
    Channel(String),
    /// No channel: the procedure states the level.
    Nothing,
}

/// How an influence is tested: what tells its level, in which unit, and what follows it by which law.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The influence.
    pub influence: Influence,
    /// What tells the level.
    pub told_by: ToldBy,
    /// Unit of the level; `None` where it is a number of its own.
    pub unit: Option<&'static LevelUnit>,
    /// The law.
    pub law: Law,
    /// Name in rows where there is one axis only; empty: rows name none.
    pub name: String,
    /// True where the scale factor may follow too, so that rates of a table are part of every interval.
    pub on_scale_factor: bool,
}

impl Setting {
    /// The setting of an influence that a role of channels tells.
    pub fn of_role(influence: Influence, role: Role, law: Law) -> Setting {
        Setting {
            influence,
            unit: role.internal_unit().and_then(LevelUnit::of),
            told_by: ToldBy::Role(role),
            law,
            name: String::new(),
            on_scale_factor: false,
        }
    }

    /// The magnetic field: the bias is proportional to it.
    pub fn magnetic_field() -> Setting {
        Setting::of_role(Influence::MagneticField, Role::MagneticField, Law::Linear)
    }

    /// The supply voltage: the bias is proportional to it.
    pub fn supply() -> Setting {
        Setting::of_role(Influence::Supply, Role::Supply, Law::Linear)
    }

    /// Vibration: it is rectified, so that the bias is proportional to its square.
    pub fn vibration() -> Setting {
        Setting::of_role(Influence::Vibration, Role::Vibration, Law::Square)
    }

    /// True for a channel that tells the level.
    pub fn tells_level(&self, channel: &Channel) -> bool {
        match &self.told_by {
            ToldBy::Role(role) => channel.role == *role,
            ToldBy::Channel(id) => channel.id == *id,
            ToldBy::Nothing => false,
        }
    }

    /// Unit of the level as it is printed.
    pub fn level_unit(&self) -> &'static str {
        self.unit.map_or("1", |u| u.id)
    }
}

/// An interval at a level.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedLevel {
    /// Where it stands in the recording.
    pub stretch: Stated,
    /// Level, unit of the influence.
    pub level: f64,
    /// Axis that it acts along, where several are tested.
    pub axis: Option<String>,
}

/// Vibration by frequency: the channel that tells it at the full rate of the recording, and the bands.
#[derive(Debug, Clone, PartialEq)]
pub struct ByFrequency {
    /// Channel of the accelerometer.
    pub accelerometer: String,
    /// Bands in the order of frequency, none over another.
    pub bands: Vec<Band>,
}

/// A comparison without and with an influence.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparisonTest {
    /// The influence that is changed, and how.
    pub setting: Setting,
    /// Level that counts as without.
    pub reference: f64,
    /// Time after a change of level that is left out, s.
    pub settling_s: f64,
    /// Time after a change of the rate of a table that is left out, s.
    pub rate_settling_s: f64,
    /// Least length of an interval without its settling, s.
    pub minimum_interval_s: f64,
    /// Intervals with the influence, each between two without, that there must be at least.
    pub alternations: usize,
    /// Standard uncertainty of the level, relative.
    pub level_uncertainty: f64,
    /// Largest difference of temperature between without and with, degC.
    pub temperature_difference_deg_c: f64,
    /// Largest temperature coefficient that the bias may have, deg/h/degC; `None`: not stated.
    pub temperature_coefficient: Option<f64>,
    /// True where the procedure takes it for granted that the influence acted as stated.
    pub declared: bool,
    /// Channel of the unit's temperature; `None`: the first.
    pub temperature: Option<String>,
    /// The intervals; empty: found from the channels of the influence's role.
    pub intervals: Vec<StatedLevel>,
    /// Bands in which the effect of vibration is told apart; `None`: not asked for.
    pub by_frequency: Option<ByFrequency>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terms_are_zero_at_the_reference_and_follow_their_law() {
        for law in [Law::Linear, Law::Square, Law::LinearQuadratic] {
            assert!(law.degrees().iter().all(|d| law.drive(*d, 101.3, 101.3) == 0.0), "{law:?}");
        }
        let at_3 = |law: Law| law.degrees().iter().map(|d| law.drive(*d, 3.0, 1.0)).collect::<Vec<_>>();
        assert_eq!(Law::ALL.map(at_3), [vec![2.0], vec![8.0], vec![2.0, 4.0], vec![1.0]]);
    }

    #[test]
    fn influences_with_a_table_of_their_own_are_settings() {
        for (setting, unit, degree) in [
            (Setting::magnetic_field(), "mT", 1),
            (Setting::supply(), "V", 1),
            (Setting::vibration(), "g", 2),
        ] {
            assert_eq!((setting.level_unit(), setting.law.degrees()), (unit, &[degree][..]));
            assert!(setting.name.is_empty() && !setting.on_scale_factor);
        }
    }
}
