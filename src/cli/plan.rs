//! `sagnac plan`: the schedule of the next test, which tells the explanations of a recording apart.

use super::job::{Frame, Job, Made, execute};
use super::length::{self, Length};
use super::next_step;
use super::options::OutputArgs;
use super::place::{self, OutputPlace};
use super::progress::Measure;
use crate::claim::Claim;
use crate::config::alternatives;
use crate::config::model::load_model;
use crate::i18n::{Lang, Localize, Note, note};
use crate::ingest::ReadOptions;
use crate::mismatch::finding::Finding;
use crate::mismatch::{self, Alternative, Options};
use crate::output::{Kind, StagedFolder};
use crate::plan::{Limits, plan};
use crate::record::explanation::Explanation;
use crate::report::plan::{PlanContext, PlanFile};
use crate::report::{ALTERNATIVES_FILE, Record, Results, SCHEDULE_FILE, StoredResults};
use crate::series::SeriesOptions;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct PlanArgs {
    /// Explanation: its folder or its explain.json; or a recording, which is explained first
    #[arg(value_name = "EXPLANATION")]
    explained: PathBuf,
    /// Model (TOML) that the next recording will be explained against
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// Longest test with its unit, such as 8h, 90min or "2 d"
    #[arg(long, value_name = "LENGTH", value_parser = length::above_zero)]
    budget: Length,
    /// Lowest and highest temperature of the chamber, degC [default: 10:50]
    #[arg(long, value_name = "RANGE", allow_hyphen_values = true)]
    temperature_range: Option<String>,
    /// Slowest and fastest ramp of the chamber, degC/h [default: 4:60]
    #[arg(long, value_name = "RANGE")]
    ramp_range: Option<String>,
    /// Sizes of the rates of the table, deg/s; each is used in both directions [default: 3,10,30]
    #[arg(long, value_name = "RATES")]
    table_rates: Option<String>,
    /// There is no table: neither rates nor angles
    #[arg(long, conflicts_with = "table_rates")]
    no_table: bool,
    /// There is no chamber: the temperature stays as it is
    #[arg(long, conflicts_with_all = ["temperature_range", "ramp_range"])]
    no_chamber: bool,
    /// Output folder [default: named after the case and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

pub fn main(args: &PlanArgs, lang: Lang) -> Result<u8, String> {
    execute(&args.output, lang, |_| {
        let limits = limits(args, lang)?;
        let claim = load_model(&args.model).map_err(|p| p.say(lang))?.claim;
        Ok(Planning { args, limits, claim })
    })
}

/// The plan of the next test.
struct Planning<'a> {
    args: &'a PlanArgs,
    limits: Limits,
    claim: Claim,
}

impl Job for Planning<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let Planning { args, limits, claim } = self;
        let case = Some(claim.case.as_str()).filter(|c| !c.is_empty());
        let out = OutputPlace::new(args.out.as_deref(), "plan", case, frame.now);
        let explained = &args.explained;
        let read = if explained.is_dir() { explained.join(ALTERNATIVES_FILE) } else { explained.clone() };
        let inputs = frame.inputs().file("explanation", Some(&read)).beside(Some(explained));
        inputs.file("model", Some(&args.model)).options(limits).begin(&out, Kind::Plan, frame.lang)
    }

    fn run(&self, _: &StagedFolder, frame: &mut Frame<'_>) -> Result<Made, String> {
        let args = self.args;
        let Explained { alternatives, named } = explained(args, &self.claim, frame)?;
        let label = note!("plan.progress").say(frame.lang);
        let plan = plan(&self.claim, &alternatives, &self.limits, &mut |done, total| {
            frame.progress.update(&label, Measure::Steps, done, total);
        });
        let context = PlanContext {
            explained: args.explained.display().to_string(),
            model: args.model.display().to_string(),
            planned_at: frame.stamp(),
            notes: unplanned(&named, &alternatives).into_iter().collect(),
        };
        Ok(Results::of_plan(PlanFile { plan, context }).into())
    }

    fn next_step(&self, results: &Results, place: &Path) -> Option<Note> {
        let Record::Plan(file) = results.record().record() else { return None };
        file.plan.schedule.as_ref().filter(|planned| !planned.schedule.steps.is_empty())?;
        Some(next_step::after_plan(&self.args.model, &place.join(SCHEDULE_FILE)))
    }
}

/// The alternatives to choose between.
struct Explained {
    alternatives: Vec<Alternative>,
    /// Effects that the explanation names as equivalents.
    named: Vec<String>,
}

/// The alternatives of an explanation, or of a recording that is explained first.
fn explained(args: &PlanArgs, claim: &Claim, frame: &mut Frame<'_>) -> Result<Explained, String> {
    let is_record = args.explained.extension().is_some_and(|e| e == "json") || args.explained.is_dir();
    if is_record { of_folder(&args.explained, frame.lang) } else { of_recording(args, claim, frame) }
}

fn of_folder(path: &Path, lang: Lang) -> Result<Explained, String> {
    let say = |note: Note| place::error(&note, lang);
    let stored = StoredResults::open(path).map_err(say)?;
    let shown = || path.display().to_string();
    let Results::Explanation(results) = stored.results else {
        return Err(say(note!("plan.error.no_explanation", path = shown())));
    };
    let named = equivalents(&results.file.explanation);
    let table = results.tables.iter().find(|(name, _)| name == ALTERNATIVES_FILE);
    let Some((name, text)) = table else {
        if named.is_empty() {
            return Ok(Explained { alternatives: vec![], named });
        }
        let note = note!("plan.error.no_alternatives", path = shown());
        return Err(say(note.with("file", ALTERNATIVES_FILE)));
    };
    let folder = if path.is_dir() { Some(path) } else { path.parent() };
    let name = folder.unwrap_or(Path::new("")).join(name).display().to_string();
    let alternatives = alternatives::parse(&name, text.as_bytes()).map_err(|p| p.say(lang))?;
    Ok(Explained { alternatives, named })
}

fn of_recording(args: &PlanArgs, claim: &Claim, frame: &mut Frame<'_>) -> Result<Explained, String> {
    let options = SeriesOptions {
        read: ReadOptions::default(),
        sample_rate_hz: Some(claim.sample_rate_hz),
        ..SeriesOptions::default()
    };
    let series = frame.series(std::slice::from_ref(&args.explained), &options)?;
    let progress = &mut |p| frame.progress.explaining(p);
    let outcome = mismatch::explain(series, claim, &Options::default(), progress);
    let outcome = outcome.map_err(|note| place::error(&note, frame.lang))?;
    Ok(Explained { named: equivalents(&outcome.explanation), alternatives: outcome.alternatives })
}

/// Every effect that an explanation names as an equivalent.
fn equivalents(explanation: &Explanation) -> Vec<String> {
    explanation.effects.iter().flat_map(Finding::other_causes).cloned().collect()
}

/// Equivalents that have no parameters, and so cannot be planned for.
fn unplanned(named: &[String], alternatives: &[Alternative]) -> Option<Note> {
    let planned =
        |kind: &str| alternatives.iter().filter_map(|a| a.effects.first()).any(|s| s.effect.kind() == kind);
    let left: Vec<&str> = named.iter().map(String::as_str).filter(|kind| !planned(kind)).collect();
    (!left.is_empty()).then(|| note!("plan.note.unplanned", kinds = left.join(", ")))
}

/// The limits of the laboratory that the options state.
fn limits(args: &PlanArgs, lang: Lang) -> Result<Limits, String> {
    let usual = Limits::usual(args.budget.seconds);
    let chosen = |option: &'static str, text: &Option<String>, lowest: f64, default: [f64; 2]| match text {
        Some(text) => range(text, lowest).ok_or_else(|| {
            let note = note!("plan.error.range", option, given = text.as_str());
            place::error(&note, lang)
        }),
        None => Ok(default),
    };
    let temperature =
        chosen("--temperature-range", &args.temperature_range, -273.15, Limits::TEMPERATURE_DEGC)?;
    let ramp_degc_per_h =
        chosen("--ramp-range", &args.ramp_range, f64::MIN_POSITIVE, Limits::RAMP_DEGC_PER_H)?;
    let mut table_rates_deg_s = match &args.table_rates {
        Some(text) => rates(text)
            .ok_or_else(|| place::error(&note!("plan.error.rates", given = text.as_str()), lang))?,
        None => usual.table_rates_deg_s,
    };
    if args.no_table {
        table_rates_deg_s.clear();
    }
    Ok(Limits {
        temperature_degc: (!args.no_chamber).then_some(temperature),
        ramp_degc_per_h,
        table_rates_deg_s,
        headings: !args.no_table,
        ..Limits::usual(usual.budget_s)
    })
}

/// `LOW:HIGH`, both at least `lowest`, the first below the second.
fn range(text: &str, lowest: f64) -> Option<[f64; 2]> {
    let (low, high) = text.split_once(':')?;
    let (low, high): (f64, f64) = (low.trim().parse().ok()?, high.trim().parse().ok()?);
    (low >= lowest && low < high && high <= 1e6).then_some([low, high])
}

/// Sizes of rates in rising order.
fn rates(text: &str) -> Option<Vec<f64>> {
    let mut rates = text.split(',').map(|r| r.trim().parse::<f64>().ok()).collect::<Option<Vec<f64>>>()?;
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    rates.iter().all(|r| *r > 0.0 && *r <= 1e5).then_some(rates)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_and_rates_are_read_or_refused() {
        assert_eq!(range("-20:60", -273.15), Some([-20.0, 60.0]));
        for wrong in ["60:-20", "5", "a:b", "5:5", ":", "0:nan"] {
            assert_eq!(range(wrong, -273.15), None, "{wrong}");
        }
        assert_eq!(range("0:60", f64::MIN_POSITIVE), None);
        assert_eq!(rates("30, 1,10,10"), Some(vec![1.0, 10.0, 30.0]));
        assert!(rates("").is_none() && rates("-3").is_none() && rates("3;4").is_none());
    }
}
