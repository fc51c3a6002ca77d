//! The unit that rates are shown in.

use crate::message::{Arg, Note};

/// Unit in which rates of a table or a range read well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RateUnit {
    /// deg/h.
    PerHour,
    /// deg/s.
    PerSecond,
}

impl RateUnit {
    /// For rates up to this one, deg/h: deg/s from 0.1 deg/s on.
    pub fn up_to(highest_deg_h: f64) -> RateUnit {
        if highest_deg_h.abs() >= 360.0 { RateUnit::PerSecond } else { RateUnit::PerHour }
    }

    /// A rate given in deg/h.
    pub fn of(self, deg_h: f64) -> f64 {
        match self {
            RateUnit::PerHour => deg_h,
            RateUnit::PerSecond => deg_h / 3600.0,
        }
    }

    /// The unit as unit texts have it.
    pub fn text(self) -> &'static str {
        match self {
            RateUnit::PerHour => "deg/h",
            RateUnit::PerSecond => "deg/s",
        }
    }

    /// Key of the unit alone.
    pub fn name(self) -> &'static str {
        match self {
            RateUnit::PerHour => "amount.unit_deg_h",
            RateUnit::PerSecond => "amount.unit_deg_s",
        }
    }

    /// A number with the unit behind it.
    pub fn with(self, value: Arg) -> Arg {
        let key = match self {
            RateUnit::PerHour => "amount.deg_h",
            RateUnit::PerSecond => "amount.deg_s",
        };
        Note::new(key).with("value", value).into()
    }

    /// A rate given in deg/h with so many significant digits, the unit behind it.
    pub fn figures(self, deg_h: f64, digits: usize) -> Arg {
        self.with(Arg::figures(self.of(deg_h), digits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_rates_are_shown_per_hour() {
        let shown = |highest: f64, rate: f64| {
            let unit = RateUnit::up_to(highest);
            (unit.of(rate), unit.text())
        };
        assert_eq!(shown(-13.7, 0.5), (0.5, "deg/h"));
        assert_eq!(shown(-360.0, 0.5 * 3600.0), (0.5, "deg/s"));
    }
}
