//! The place at which an effect shows: a domain and an interval of it.

use serde::{Deserialize, Serialize};

/// A quantity along which an effect or a departure is located.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Domain {
    /// `time_s`, s.
    Time,
    /// Hz.
    Frequency,
    /// Autocorrelation lag, or delay between columns, s.
    Lag,
    /// °C.
    Temperature,
    /// °C/min.
    TemperatureRate,
    /// Rate of the table about the input axis, deg/s.
    InputRate,
    /// Rate of the table's other axis, deg/s.
    OuterRate,
    /// Table angle, or period of the sensed angle, deg.
    Angle,
    /// Size of the residual, deg/h.
    Amplitude,
    /// `time_s`, s, where the stamps themselves are at fault.
    Timestamps,
    /// V.
    Supply,
    /// A column without a role of its own, in the unit of its file; the finding names it.
    Driver,
}

impl Domain {
    /// Every domain.
    pub const ALL: &'static [Domain] = &[
        Domain::Time,
        Domain::Frequency,
        Domain::Lag,
        Domain::Temperature,
        Domain::TemperatureRate,
        Domain::InputRate,
        Domain::OuterRate,
        Domain::Angle,
        Domain::Amplitude,
        Domain::Timestamps,
        Domain::Supply,
        Domain::Driver,
    ];

    /// Its id in files.
    pub fn id(self) -> &'static str {
        match self {
            Domain::Time => "time",
            Domain::Frequency => "frequency",
            Domain::Lag => "lag",
            Domain::Temperature => "temperature",
            Domain::TemperatureRate => "temperature_rate",
            Domain::InputRate => "input_rate",
            Domain::OuterRate => "outer_rate",
            Domain::Angle => "angle",
            Domain::Amplitude => "amplitude",
            Domain::Timestamps => "timestamps",
            Domain::Supply => "supply",
            Domain::Driver => "driver",
        }
    }

    /// Its unit.
    pub fn unit(self) -> &'static str {
        match self {
            Domain::Time | Domain::Lag | Domain::Timestamps => "s",
            Domain::Frequency => "Hz",
            Domain::Temperature => "degC",
            Domain::TemperatureRate => "degC/min",
            Domain::InputRate | Domain::OuterRate => "deg/s",
            Domain::Angle => "deg",
            Domain::Amplitude => "deg/h",
            Domain::Supply => "V",
            Domain::Driver => "",
        }
    }

    /// The domain of an id.
    pub fn of_id(id: &str) -> Option<Domain> {
        Domain::ALL.iter().copied().find(|d| d.id() == id)
    }
}

/// An interval of a domain, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// The domain.
    pub domain: Domain,
    /// Lower end.
    pub from: f64,
    /// Upper end.
    pub to: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_domain_is_found_by_its_id_and_no_other() {
        for domain in Domain::ALL {
            assert_eq!(Domain::of_id(domain.id()), Some(*domain));
        }
        assert_eq!(Domain::of_id("Time"), None);
    }
}
