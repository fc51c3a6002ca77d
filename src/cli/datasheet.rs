//! `sagnac datasheet`: what the results of some units promise of the population that they come from.

use super::job::{Frame, Job, Made, execute};
use super::keep::StoreArgs;
use super::options::OutputArgs;
use super::place::OutputPlace;
use super::{place, store};
use crate::acceptance::datasheet::{Refusal, TestedUnit, apply, datasheet, select};
use crate::config::sheet;
use crate::i18n::{Lang, Note, note};
use crate::ingest::each_of;
use crate::ingest::result_table::{TableResult, results_in, tables_at};
use crate::lot::tolerance::Promise;
use crate::output::{Kind, StagedFolder};
use crate::record::{DataSheet, SheetAudience};
use crate::report::Results;
use crate::store::Filter;
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub struct DatasheetArgs {
    /// Results of the units: result.json files, their folders, or quoted patterns of them
    #[arg(required_unless_present_any = ["store", "model", "lot"], value_name = "RESULT")]
    results: Vec<PathBuf>,
    /// Store that the results are taken from [default: SAGNAC_STORE, else the configuration of the user]
    #[arg(long, value_name = "STORE", conflicts_with = "results")]
    store: Option<PathBuf>,
    /// Model of the units, for a store
    #[arg(long = "device-model", alias = "model", value_name = "DEVICE", conflicts_with = "results")]
    model: Option<String>,
    /// Lot of the units, for a store; several by repeating the option
    #[arg(long, value_name = "LOT", conflicts_with = "results")]
    lot: Vec<String>,
    /// Id of the procedure, for a store
    #[arg(long, value_name = "ID", conflicts_with = "results")]
    procedure: Option<String>,
    /// Proportion of all units that a bound holds for
    #[arg(long, value_name = "SHARE", default_value_t = 0.95)]
    proportion: f64,
    /// Confidence in a bound
    #[arg(long, value_name = "PROBABILITY", default_value_t = 0.95)]
    confidence: f64,
    /// Rows, names, units and footnotes of the sheet (TOML) [default: every quantity]
    #[arg(long, value_name = "FILE")]
    sheet: Option<PathBuf>,
    /// Pages of the reader: the engineer's with every detail, or one for customers with it as an annex
    #[arg(long, value_name = "AUDIENCE", default_value = "engineer")]
    audience: Audience,
    /// Output folder [default: named after the model and UTC time]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    output: OutputArgs,
}

/// Reader of the pages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Audience {
    Engineer,
    Customer,
}

pub fn main(args: &DatasheetArgs, lang: Lang) -> Result<u8, String> {
    execute(&args.output, lang, |frame| Sheet::load(args, frame))
}

/// The data sheet of some results.
struct Sheet<'a> {
    args: &'a DatasheetArgs,
    /// The results that are read.
    files: Vec<PathBuf>,
    sheet: DataSheet,
}

impl<'a> Sheet<'a> {
    fn load(args: &'a DatasheetArgs, frame: &Frame<'_>) -> Result<Sheet<'a>, String> {
        let lang = frame.lang;
        let say = |note: Note| place::error(&note, lang);
        let promise = Promise { proportion: args.proportion, confidence: args.confidence };
        for (option, given) in [("--proportion", args.proportion), ("--confidence", args.confidence)] {
            // Beyond this neither the sample nor the arithmetic tells anything.
            if !(0.5..=0.9999).contains(&given) {
                return Err(say(note!("datasheet.refused.probability", option, given = given.to_string())));
            }
        }
        let rows = args.sheet.as_deref().map(sheet::load).transpose().map_err(|p| p.say(lang))?;
        let (files, mut broken) = args.files(lang)?;
        let mut read_units = vec![];
        let read: Vec<Vec<Result<TestedUnit, Note>>> = files.par_iter().map(|file| units_in(file)).collect();
        for unit in read.into_iter().flatten() {
            match unit {
                Ok(unit) => read_units.push(unit),
                Err(note) => {
                    frame.warn(&note);
                    broken.push(note);
                }
            }
        }
        let mut selected = select(read_units).map_err(|refusal| match refusal {
            Refusal::None => say("datasheet.refused.none".into()),
            Refusal::Mixed(note) => say(note),
        })?;
        selected.notes.extend(broken);
        let mut sheet = datasheet(selected, promise, frame.stamp());
        sheet.audience = match args.audience {
            Audience::Engineer => SheetAudience::Engineer,
            Audience::Customer => SheetAudience::Customer,
        };
        if let Some(rows) = &rows {
            apply(&mut sheet, rows);
        }
        Ok(Sheet { args, files, sheet })
    }
}

impl Job for Sheet<'_> {
    fn begin(&self, frame: &Frame<'_>) -> Result<StagedFolder, String> {
        let Sheet { args, files, sheet } = self;
        let out = OutputPlace::new(args.out.as_deref(), "datasheet", sheet.model.as_deref(), frame.now);
        let inputs = frame.inputs().files("results", files).file("sheet", args.sheet.as_deref());
        inputs.options(&(args.proportion, args.confidence)).begin(&out, Kind::DataSheet, frame.lang)
    }

    fn run(&self, _: &StagedFolder, _: &mut Frame<'_>) -> Result<Made, String> {
        Ok(Results::of_datasheet(self.sheet.clone()).into())
    }
}

impl DatasheetArgs {
    /// The results, as named or by what the store has of them, with what must be known of the choice.
    fn files(&self, lang: Lang) -> Result<(Vec<PathBuf>, Vec<Note>), String> {
        if self.results.is_empty() {
            return self.of_store(lang);
        }
        let mut files = vec![];
        for named in &self.results {
            match each_of(named) {
                Ok(found) => files.extend(found.iter().flat_map(|p| result_files(p))),
                Err(e) => return Err(crate::ingest::RecordingError::from(e).say(lang)),
            }
        }
        Ok((files, vec![]))
    }

    /// The results of a store: of products, as far as no other counts in their place.
    fn of_store(&self, lang: Lang) -> Result<(Vec<PathBuf>, Vec<Note>), String> {
        let say = |note: Note| place::error(&note, lang);
        let named = StoreArgs { store: self.store.clone(), ..StoreArgs::default() };
        let path = named.path(lang)?.ok_or_else(|| say("history.no_store".into()))?;
        let opened = store::open_to_read(&path, lang)?;
        let filter = Filter {
            model: self.model.clone(),
            lots: self.lot.clone(),
            procedure: self.procedure.clone(),
            ..Filter::default()
        };
        let found = opened.addresses(&filter).map_err(|e| say(e.note()))?;
        let folder = |address: &String| opened.layout().result(address).join(Kind::Result.record_file());
        let mut notes = vec![];
        if found.left_out > 0 {
            notes.push(note!("datasheet.note.left_out", n = found.left_out));
        }
        Ok((found.addresses.iter().map(folder).collect(), notes))
    }
}

/// The results that a path stands for: those of a folder, a file of one, or tables of many.
fn result_files(path: &Path) -> Vec<PathBuf> {
    if !path.is_dir() {
        return vec![path.to_owned()];
    }
    let record = path.join(Kind::Result.record_file());
    // The folder of a result is not searched.
    let tables = if record.is_file() { vec![] } else { tables_at(path) };
    if tables.is_empty() { vec![record] } else { tables }
}

/// The units of a file: one of a result, those of all rows of a table.
fn units_in(file: &Path) -> Vec<Result<TestedUnit, Note>> {
    if tables_at(file).is_empty() {
        return vec![TestedUnit::read(file)];
    }
    let rows = match results_in(file) {
        Ok(rows) => rows,
        Err(note) => return vec![Err(note)],
    };
    let unit = |row: Result<TableResult, Note>| {
        let TableResult { name, record } = row?;
        let nothing = || note!("result_table.no_result", recording = name.as_str());
        TestedUnit::in_memory(record.ok_or_else(nothing)?.as_bytes(), Path::new(&name), &[])
    };
    rows.map(unit).collect()
}
