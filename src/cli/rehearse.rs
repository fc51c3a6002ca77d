//! `sagnac rehearse`: a test on simulated units before one is recorded.

use super::job::{Frame, Job, Made, execute};
use super::length::{self, Length};
use super::options::OutputArgs;
use super::place::{self, OutputPlace};
use super::procedures::say_which;
use super::progress::Measure;
use crate::config::model::{ModelFile, load_model};
use crate::config::procedure::phases::is_phased;
use crate::config::procedure::{
    EffectiveLimits, LimitsFile, Loaded, Procedure, effective, load, load_limits,
};
use crate::i18n::{Lang, Localize, note};
use crate::output::{Kind, StagedFolder};
use crate::rehearse::{Order, rehearse};
use crate::report::Results;
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

#[derive(Debug, Args)]
pub struct RehearseArgs {
    /// Procedure (TOML), or the name of a shipped one
    #[arg(value_name = "PROCEDURE")]
    procedure: PathBuf,
    /// Limits file (TOML), or the name of a shipped one
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Model (TOML) of a nominal unit [default: typical values, or half of each limit]
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Usable length with its unit, without the warm-up; several by repeating the option [default: those of the procedure, and the one that the slowest limit needs]
    #[arg(long = "length", value_name = "LENGTH", value_parser = length::above_zero)]
    lengths: Vec<Length>,
    /// Simulated units of each level
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    units: u32,
    /// Risk of a consumer and of a producer that a length is to keep
    #[arg(long, value_name = "RISK", default_value_t = 0.1)]
    risk: f64,
    /// Rate of the simulated recordings, Hz [default: that of the procedure or the model, else 1]
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<f64>,
    /// Seed, a whole number; equal seeds give equal rehearsals
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Output folder [default: named after the procedure and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn main(args: &RehearseArgs, lang: Lang) -> Result<u8, String> {
    execute(&args.output, lang, |_| {
        let wrong = |n| Err(place::error(&n, lang));
        if !(args.risk > 0.0 && args.risk < 1.0) {
            return wrong(note!("rehearse.risk", risk = args.risk));
        }
        if args.sample_rate.is_some_and(|hz| !(hz.is_finite() && hz > 0.0)) {
            return wrong(note!("rehearse.sample_rate"));
        }
        let named: Vec<&Path> =
            [Some(args.procedure.as_path()), args.limits.as_deref()].into_iter().flatten().collect();
        say_which(&named, lang);
        if is_phased(&args.procedure) {
            return wrong(note!("rehearse.phased", path = args.procedure.display().to_string()));
        }
        let procedure = load(&args.procedure).map_err(|p| p.say(lang))?;
        let limits = args.limits.as_deref().map(load_limits).transpose().map_err(|p| p.say(lang))?;
        let model = args.model.as_deref().map(load_model).transpose().map_err(|p| p.say(lang))?;
        let effective = effective(&procedure, limits.as_ref());
        for warning in procedure.warnings.iter().chain(&effective.warnings) {
            place::eprint_diagnostic(&format!("{}\n", warning.say(lang)));
        }
        Ok(Rehearsing { args, procedure, limits, effective, model })
    })
}

/// A rehearsal of a test.
struct Rehearsing<'a> {
    args: &'a RehearseArgs,
    procedure: Loaded<Procedure>,
    limits: Option<Loaded<LimitsFile>>,
    effective: EffectiveLimits,
    model: Option<ModelFile>,
}

impl Job for Rehearsing<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let args = self.args;
        let subject = Some(self.procedure.value.id.as_str());
        let out = OutputPlace::new(args.out.as_deref(), "rehearsal", subject, frame.now);
        let RehearseArgs { lengths, units, risk, sample_rate, seed, .. } = args;
        frame
            .inputs()
            .file("procedure", Some(&args.procedure))
            .file("limits", args.limits.as_deref())
            .file("model", args.model.as_deref())
            .options(&(lengths, units, risk, sample_rate, seed))
            .begin(&out, Kind::Rehearsal, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let args = self.args;
        let path = args.model.as_ref().map(|m| m.display().to_string());
        let order = Order {
            procedure: &self.procedure,
            limits: self.limits.as_ref(),
            effective: &self.effective,
            model: self.model.as_ref().zip(path),
            lengths_s: args.lengths.iter().map(|l| l.seconds).collect(),
            sample_rate_hz: args.sample_rate,
            units: args.units as usize,
            risk: args.risk,
            seed: args.seed,
            now: frame.now,
        };
        let lang = frame.lang;
        let label = note!("rehearse.progress").say(lang);
        let progress = Mutex::new(&mut frame.progress);
        let record = rehearse(&order, &|done, total| {
            if let Ok(mut progress) = progress.lock() {
                progress.update(&label, Measure::Steps, done, total);
            }
        });
        let record = record.map_err(|note| place::error(&note, lang))?;
        Ok(Results::of(record, vec![], vec![]).into())
    }
}
