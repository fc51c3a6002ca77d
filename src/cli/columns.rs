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
    /// Unit of the rate columns [default: from their names]
    #[arg(long, value_name = "UNIT")]
    pub unit: Option<String>,
    /// Sample counter by name or position; used to detect lost and repeated samples
    #[arg(long, value_name = "COLUMN")]
    pub counter: Option<String>,
    /// Time column by name or position, or `none` to use only the sample rate [default: from the names]
    #[arg(long, value_name = "COLUMN")]
    pub time: Option<String>,
    /// Sample rate, required without a time column
    #[arg(long, value_name = "HZ")]
    pub sample_rate: Option<f64>,
    /// Time excluded at the start, such as 30min; a number without a unit is in seconds
    #[arg(long, value_name = "LENGTH", default_value = "0s", value_parser = length::from_zero_or_seconds)]
    pub warm_up: Length,
}

impl ColumnArgs {
    /// The options as they are typed, each behind a space.
    pub fn as_typed(&self) -> String {
        let mut typed = String::new();
        let mut add = |option: &str, value: &str| typed.push_str(&format!(" {option} {}", for_shell(value)));
        self.rate.iter().for_each(|column| add("--rate", column));
        self.angle.iter().for_each(|column| add("--angle", column));
        let texts = [("--unit", &self.unit), ("--counter", &self.counter), ("--time", &self.time)];
        for (option, value) in texts {
            if let Some(value) = value {
                add(option, value);
            }
        }
        if let Some(hz) = self.sample_rate {
            add("--sample-rate", &hz.to_string());
        }
        if self.warm_up.seconds > 0.0 {
            add("--warm-up", &self.warm_up.to_string());
        }
        typed
    }

    /// The choice that they make.
    pub fn choice(&self) -> ColumnChoice {
        ColumnChoice {
            rate: self.rate.clone(),
            angle: self.angle.clone(),
            unit: self.unit.clone(),
            counter: self.counter.clone(),
            time: self.time.clone(),
            sample_rate_hz: self.sample_rate,
            warm_up_s: self.warm_up.seconds,
        }
    }
}
