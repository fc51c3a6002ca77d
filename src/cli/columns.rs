//! The options that name the columns of a recording without a procedure.

use super::length::{self, Length};
use super::place::for_shell;
use crate::acceptance::column_choice::ColumnChoice;
use clap::Args;

/// Choice of the columns.
#[derive(Debug, Clone, Args)]
pub struct ColumnArgs {
    /// Rate column by name or position; may be repeated [default: every column that looks like a gyro output]
    #[arg(long, value_name = "COLUMN")]
    pub rate: Vec<String>,
    /// Accumulated-angle column by name or position, differenced to a rate; may be repeated
    #[arg(long, value_name = "COLUMN")]
    pub angle: Vec<String>,
    /// Angle-increment column by name or position, divided by the sample interval; may be repeated
    #[arg(long, value_name = "COLUMN")]
    pub increment: Vec<String>,
    /// Unit of the rate columns [default: from their names]
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
    /// Factor from the numbers of the rate columns to the unit: the size of one count [default: as the file states, or 1]
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    pub scale: Option<f64>,
    /// Sample counter by name or position, or `none`; used to detect lost and repeated samples
    #[arg(long, value_name = "COLUMN")]
    pub counter: Option<String>,
    /// Time column by name or position, or `none` to use only the sample rate [default: from the names]
    #[arg(long, value_name = "COLUMN")]
    pub time: Option<String>,
    /// Sample rate, required without a usable time column
    #[arg(long, value_name = "HZ")]
    pub sample_rate: Option<f64>,
}

/// Span left out at the start.
#[derive(Debug, Clone, Args)]
pub struct WarmUpArgs {
    /// Time excluded at the start, such as 30min; a number without a unit is in seconds
    #[arg(long, value_name = "LENGTH", default_value = "0s", value_parser = length::from_zero_or_seconds)]
    pub warm_up: Length,
}

impl WarmUpArgs {
    /// The option as it is typed, behind a space.
    pub fn as_typed(&self) -> String {
        if self.warm_up.seconds > 0.0 {
            format!(" --warm-up {}", for_shell(&self.warm_up.to_string()))
        } else {
            String::new()
        }
    }
}

impl ColumnArgs {
    /// The options as they are typed, each behind a space.
    pub fn as_typed(&self) -> String {
        let mut typed = String::new();
        let mut add = |option: &str, value: &str| typed.push_str(&format!(" {option} {}", for_shell(value)));
        self.rate.iter().for_each(|column| add("--rate", column));
        self.angle.iter().for_each(|column| add("--angle", column));
        self.increment.iter().for_each(|column| add("--increment", column));
        let texts = [("--unit", &self.unit), ("--counter", &self.counter), ("--time", &self.time)];
        for (option, value) in texts {
            if let Some(value) = value {
                add(option, value);
            }
        }
        for (option, number) in [("--scale", self.scale), ("--sample-rate", self.sample_rate)] {
            if let Some(number) = number {
                add(option, &number.to_string());
            }
        }
        typed
    }

    /// The choice that they make, with the time that is left out at the start.
    pub fn choice(&self, warm_up_s: f64) -> ColumnChoice {
        ColumnChoice {
            rate: self.rate.clone(),
            angle: self.angle.clone(),
            increment: self.increment.clone(),
            scale: self.scale,
            unit: self.unit.clone(),
            counter: self.counter.clone(),
            time: self.time.clone(),
            sample_rate_hz: self.sample_rate,
            warm_up_s,
        }
    }
}
