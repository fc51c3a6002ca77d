//! The arguments of `sagnac run`.

use super::exit;
use super::follow_args::FollowArgs;
use super::join::JoinArgs;
use super::keep::StoreArgs;
use super::options::{GridArgs, OutputArgs};
use super::source::SourceArgs;
use crate::i18n::Lang;
use crate::ingest::unit_data::UnitData;
use crate::report::Results;
use clap::Args;
use std::num::NonZeroUsize;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct RunArgs {
    /// Procedure (TOML)
    pub procedure: PathBuf,
    /// Recording: a file of any supported format, or a manifest; several files or a quoted pattern with --join or --each
    #[arg(required = true)]
    pub recording: Vec<PathBuf>,
    #[command(flatten)]
    pub join: JoinArgs,
    #[command(flatten)]
    pub each: EachArgs,
    #[command(flatten)]
    pub follow: FollowArgs,
    #[command(flatten)]
    pub sources: SourceArgs,
    /// Limits file; overrides the procedure's limits for the same measurand
    #[arg(long, value_name = "FILE")]
    pub limits: Option<PathBuf>,
    /// End with exit code 3, not 0, where no limit decided anything
    #[arg(long)]
    pub require_limits: bool,
    /// Serial number of the unit under test
    #[arg(long, value_name = "SN", conflicts_with = "each")]
    pub serial: Option<String>,
    /// Lot or batch of the unit, for data sheets
    #[arg(long, value_name = "LOT")]
    pub lot: Option<String>,
    /// Table of units (CSV) with columns serial, model, lot, build_date, reference and others
    #[arg(long, value_name = "FILE")]
    pub unit_data: Option<PathBuf>,
    /// Name of the operator
    #[arg(long, value_name = "NAME")]
    pub operator: Option<String>,
    /// Test station where the recording was made
    #[arg(long, value_name = "NAME")]
    pub station: Option<String>,
    /// Result of the check that released the bench, where the procedure demands one [default: the latest in the store]
    #[arg(long, value_name = "DIR")]
    pub bench_check: Option<PathBuf>,
    /// Output folder [default: named after procedure, serial number and UTC time]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub store: StoreArgs,
    #[command(flatten)]
    pub output: OutputArgs,
    #[command(flatten)]
    pub grid: GridArgs,
}

impl RunArgs {
    /// The exit code of the results.
    pub fn exit_code(&self, results: &Results) -> u8 {
        if self.require_limits { exit::where_limits_are_required(results) } else { exit::of(results) }
    }

    /// The table of units; empty where none is given.
    ///
    /// # Errors
    /// The diagnostics, in words.
    pub fn units(&self, lang: Lang) -> Result<UnitData, String> {
        let loaded = self.unit_data.as_deref().map(UnitData::load).transpose();
        loaded.map(Option::unwrap_or_default).map_err(|p| p.say(lang))
    }
}

/// Units instead of one recording.
#[derive(Debug, Default, Args)]
pub struct EachArgs {
    /// Test every file as a separate unit, and write an index of the lot
    #[arg(long, conflicts_with = "join")]
    pub each: bool,
    /// Take serial numbers from the file names, by a pattern such as 'unit-{serial}_*', or {stem} for the whole name
    #[arg(long, value_name = "PATTERN", requires = "each")]
    pub serial_from: Option<String>,
    /// Number of units tested in parallel [default: number of cores]
    #[arg(long, value_name = "COUNT", requires = "each")]
    pub jobs: Option<NonZeroUsize>,
}
