//! Statements of a procedure about a test on a rate table: its evaluation, and inputs that are known without a table.

use crate::estimate::{Component, InputQuantity};

/// How a test on a table is evaluated. Uncertainties are standard uncertainties (k = 1).
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Every row of the recording is the mean of a step.
    pub rows_are_steps: bool,
    /// Time after a change of rate that is left out, s.
    pub settling_s: f64,
    /// Least time at one rate, s.
    pub minimum_step_s: f64,
    /// Whether steps are cut to whole turns.
    pub whole_turns: bool,
    /// True when the rate is taken from the angle of the table.
    pub by_angle: bool,
    /// Full scale, deg/h; `None`: the largest rate of the test.
    pub full_scale_deg_h: Option<f64>,
    /// Lowest rate at which a residual is given in ppm of the rate, deg/h; `None`: a tenth of full scale.
    pub of_rate_from_deg_h: Option<f64>,
    /// Relative difference from the highest rate at which it counts as reached.
    pub rate_tolerance: f64,
    /// Largest deviation from the line of a rate that the output follows, relative to the rate.
    pub maximum_rate_error: f64,
    /// Calibration of the rate of the table, relative.
    pub rate_uncertainty: f64,
    /// Relative difference of the scale factor outside a dead zone from the nominal one, where it is known.
    pub scale_factor_uncertainty: Option<f64>,
    /// One reading of the table angle, arcsec.
    pub angle_uncertainty_arcsec: f64,
    /// Angle between the input axis and the axis of the table, rad.
    pub alignment_uncertainty_rad: f64,
    /// Thermometer, degC.
    pub temperature_uncertainty_deg_c: f64,
    /// How far the temperature of a soak may be from the middle of its range, degC.
    pub soak_tolerance_deg_c: f64,
    /// Channel of the unit's temperature; `None`: the first.
    pub temperature: Option<String>,
    /// True when the response is the sine of an open-loop interferometer.
    pub sine: bool,
    /// Stretches whose input is known without a table.
    pub known: Vec<ReferenceInput>,
}

impl Setup {
    /// The calibration of the table as a component of a quantity that grows with its rate by `sensitivity`.
    pub fn of_table_rate(&self, sensitivity: f64) -> Component {
        Component::of(InputQuantity::TableRate, self.rate_uncertainty, "1", sensitivity)
    }

    /// The thermometer as a component of a quantity that changes with temperature by `sensitivity`, per degC.
    pub fn of_thermometer(&self, sensitivity: f64) -> Component {
        Component::of(InputQuantity::Thermometer, self.temperature_uncertainty_deg_c, "degC", sensitivity)
    }
}

impl Default for Setup {
    fn default() -> Setup {
        Setup {
            rows_are_steps: false,
            settling_s: 2.0,
            minimum_step_s: 5.0,
            whole_turns: true,
            by_angle: false,
            full_scale_deg_h: None,
            of_rate_from_deg_h: None,
            rate_tolerance: 0.01,
            maximum_rate_error: 0.01,
            rate_uncertainty: 0.0,
            scale_factor_uncertainty: None,
            angle_uncertainty_arcsec: 0.0,
            alignment_uncertainty_rad: 0.0,
            temperature_uncertainty_deg_c: 0.0,
            soak_tolerance_deg_c: 2.0,
            temperature: None,
            sine: false,
            known: vec![],
        }
    }
}

/// A stretch of the recording with a known input.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceInput {
    /// Phase of a manifest that it is.
    pub phase: Option<String>,
    /// Start, s from the start of the recording.
    pub from_s: Option<f64>,
    /// End, s from the start of the recording.
    pub to_s: Option<f64>,
    /// Channel concerned; `None`: every gyro channel.
    pub channel: Option<String>,
    /// The input.
    pub input: Input,
}

/// A known input. Uncertainties are standard uncertainties.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Input {
    /// The axis points somewhere, at rest: heading and elevation with their uncertainties, deg.
    Position {
        /// Heading from true north, positive to the east, deg.
        heading: (f64, f64),
        /// Elevation above the horizon, deg.
        elevation: (f64, f64),
    },
    /// The unit is turned about the axis of the channel by an angle, deg.
    Turn {
        /// Angle with its uncertainty, deg.
        angle: (f64, f64),
    },
    /// The unit rests: its bias is taken from here.
    Rest,
}
