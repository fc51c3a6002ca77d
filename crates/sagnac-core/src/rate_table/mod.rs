//! Tests on a rate table: steps of known rate found in the recording, the response of the gyro to them, and what follows
//! from it: scale factor, nonlinearity, asymmetry, repeatability, hysteresis, sensitivity to temperature, errors over a
//! turn, alignment, dead zone; and the same from turns by a known angle and from positions against the Earth's rotation.
//!
//! Sources: IEEE Std 952-2020, 12.9 (scale factor), 12.10 (input rate), 12.12 (alignment); GUM (JCGM 100).

pub mod alignment;
pub mod blocks;
pub mod combine;
pub mod dead_zone;
pub mod design;
pub mod inner_axis;
pub mod known;
mod largest;
pub mod model;
pub mod noise;
pub mod scale_factor;
pub mod settling;
pub mod sine;
pub mod stamps;
pub mod steps;
pub mod turns;

use blocks::Blocks;
use steps::Steps;

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
    /// Channel of the unit's temperature; `None`: the first.
    pub temperature: Option<String>,
    /// True when the response is the sine of an open-loop interferometer.
    pub sine: bool,
    /// Stretches whose input is known without a table.
    pub known: Vec<known::Known>,
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
            rate_uncertainty: 0.0,
            scale_factor_uncertainty: None,
            angle_uncertainty_arcsec: 0.0,
            alignment_uncertainty_rad: 0.0,
            temperature_uncertainty_deg_c: 0.0,
            temperature: None,
            sine: false,
            known: vec![],
        }
    }
}

/// A recording on a table, with what was found in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableRun {
    /// The blocks.
    pub blocks: Blocks,
    /// The steps.
    pub steps: Steps,
}

impl TableRun {
    /// Finds the steps of a recording.
    pub fn new(blocks: Blocks, setup: &Setup) -> TableRun {
        let steps = steps::find(&blocks, setup);
        TableRun { blocks, steps }
    }
}
