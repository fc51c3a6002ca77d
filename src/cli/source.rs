//! Options that name files recorded beside the recording.

use super::place::for_shell;
use crate::ingest::SecondSource;
use clap::Args;
use std::path::PathBuf;

/// Files recorded beside the recording.
#[derive(Debug, Clone, Default, Args)]
pub struct SourceArgs {
    /// File recorded beside the recording, such as the log of a chamber, interpolated at its timestamps; may be repeated
    #[arg(long = "source", value_name = "FILE")]
    source: Vec<PathBuf>,
    /// Time added to the timestamps of that file, s [default: from the dates of both]
    #[arg(long, value_name = "NUMBER", requires = "source", allow_hyphen_values = true)]
    source_offset: Option<f64>,
    /// Standard uncertainty of that time, or of the dates, s
    #[arg(long, value_name = "NUMBER", requires = "source", value_parser = not_negative)]
    source_offset_uncertainty: Option<f64>,
    /// Estimate the offset and rate of that file's clock from what both record: the angle of a table, a temperature
    #[arg(long, requires = "source", conflicts_with_all = ["source_offset", "source_rate", "source_offset_uncertainty"])]
    estimate_offset: bool,
    /// Relative excess of that file's seconds, ppm
    #[arg(long, value_name = "PPM", requires = "source", allow_hyphen_values = true)]
    source_rate: Option<f64>,
}

/// A number that is not negative.
fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|n: &f64| n.is_finite() && *n >= 0.0);
    number.ok_or_else(|| "0, 0.2, 1e-3".to_owned())
}

impl SourceArgs {
    /// The options as they are typed, each behind a space.
    pub fn as_typed(&self) -> String {
        let mut typed: String = self
            .source
            .iter()
            .map(|path| format!(" --source {}", for_shell(&path.display().to_string())))
            .collect();
        let numbers = [
            ("--source-offset", self.source_offset),
            ("--source-offset-uncertainty", self.source_offset_uncertainty),
            ("--source-rate", self.source_rate),
        ];
        for (option, number) in numbers {
            typed.extend(number.map(|number| format!(" {option} {number}")));
        }
        if self.estimate_offset {
            typed.push_str(" --estimate-offset");
        }
        typed
    }

    /// The files.
    pub fn sources(&self) -> Vec<SecondSource> {
        let of = |path: &PathBuf| SecondSource {
            path: path.clone(),
            more: vec![],
            offset_s: self.source_offset,
            rate: self.source_rate.unwrap_or(0.0) * 1e-6,
            offset_uncertainty_s: self.source_offset_uncertainty.unwrap_or(0.0),
            estimate: self.estimate_offset,
        };
        self.source.iter().map(of).collect()
    }
}
