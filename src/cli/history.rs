//! `sagnac history`: what the results of a store tell over time.

use super::keep::StoreArgs;
use super::options::{Pages, pdf_pages, renderer};
use super::printer::standard_output;
use super::{exit, place, stdout, store};
use crate::acceptance::history::{figures, history};
use crate::i18n::{Lang, Note, note};
use crate::ingest::serial;
use crate::measurand;
use crate::output::StagedFile;
use crate::record::{HistoryAsked, HistoryRecord};
use crate::report::PageForm;
use crate::report::history::{csv, on_terminal, page};
use crate::report::page::terminal;
use crate::report::pdf::of_history;
use crate::report::terminal::Terminal;
use crate::store::{Attempt, Filter};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Width of text in a file.
const FILE_WIDTH: usize = 120;

#[derive(Debug, Args)]
pub struct HistoryArgs {
    /// Serial number of a unit [default: all units]
    #[arg(value_name = "SN")]
    serial: Option<String>,
    /// Store to ask [default: SAGNAC_STORE, else the configuration of the user]
    #[arg(long, value_name = "STORE")]
    store: Option<PathBuf>,
    /// Model of the units
    #[arg(long = "device-model", alias = "model", value_name = "DEVICE")]
    model: Option<String>,
    /// Lot; several by repeating the option
    #[arg(long, value_name = "LOT")]
    lot: Vec<String>,
    /// Id of the procedure
    #[arg(long, value_name = "ID")]
    procedure: Option<String>,
    /// Id of a measurand; all with a limit without the option
    #[arg(long, value_name = "ID")]
    measurand: Option<String>,
    /// Station
    #[arg(long, value_name = "NAME")]
    station: Option<String>,
    /// First day or moment, such as 2026-03-01
    #[arg(long, value_name = "DATE")]
    since: Option<String>,
    /// Standard uncertainty that all tests of a unit share, in the unit of the measurand; it cancels in a drift
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0, requires = "measurand")]
    common: f64,
    /// Form of the answer
    #[arg(long, value_name = "FORM", default_value = "table")]
    format: HistoryFormat,
    /// File to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long, requires = "out")]
    force: bool,
    /// Folder of templates that override built-in ones of the same name
    #[arg(long, value_name = "DIR")]
    templates: Option<PathBuf>,
    /// Pages of the PDF
    #[arg(long, value_name = "PAGES")]
    pages: Option<Pages>,
}

/// Form of the answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum HistoryFormat {
    /// Text
    Table,
    /// One row a result and measurand
    Csv,
    /// Everything
    Json,
    /// A page with figures
    Html,
    /// The same as PDF
    Pdf,
}

pub fn main(args: &HistoryArgs, lang: Lang) -> Result<u8, String> {
    let say = |note: Note| place::error(&note, lang);
    if let Some(id) = args.measurand.as_deref().filter(|id| measurand::find(id).is_none()) {
        return Err(say(note!("history.no_measurand", id)));
    }
    if !(args.common >= 0.0 && args.common.is_finite()) {
        return Err(say(note!("history.common", given = args.common.to_string())));
    }
    let named = StoreArgs { store: args.store.clone(), ..StoreArgs::default() };
    let path = named.path(lang)?.ok_or_else(|| say("history.no_store".into()))?;
    let opened = store::open_to_read(&path, lang)?;
    let attempts = opened.attempts(&args.filter()).map_err(|e| say(e.note()))?;
    if attempts.is_empty() {
        return Err(say("history.nothing".into()));
    }
    let record = history(&attempts, args.asked(), args.common);
    if args.format == HistoryFormat::Pdf && args.out.is_none() {
        return Err(say("history.pdf_to_file".into()));
    }
    let bytes = match pdf_pages(args.format == HistoryFormat::Pdf, args.pages, lang)? {
        Some(pages) => {
            let renderer = renderer(args.templates.as_deref(), lang)?;
            of_history(&record, &json(&record, lang)?, &renderer, pages, lang).map_err(|e| say(e.note()))?
        }
        None => rendered(args, &attempts, &record, lang)?.into_bytes(),
    };
    let text = String::from_utf8_lossy(&bytes);
    match &args.out {
        Some(out) => {
            let staged = StagedFile::begin(out, &[], args.force).map_err(|e| say(e.note()))?;
            staged.publish_with(&bytes).map_err(|e| say(e.note()))?;
            place::print(&format!("{}\n", place::shown(out)));
        }
        None if args.format == HistoryFormat::Table => stdout::write_styled(&text),
        None => place::print(&text),
    }
    Ok(exit::PASS)
}

impl HistoryArgs {
    fn filter(&self) -> Filter {
        Filter {
            serial_key: self.serial.as_deref().map(serial::plain),
            model: self.model.clone(),
            lots: self.lot.clone(),
            procedure: self.procedure.clone(),
            station: self.station.clone(),
            since: self.since.clone(),
        }
    }

    fn asked(&self) -> HistoryAsked {
        HistoryAsked {
            serial: self.serial.clone(),
            model: self.model.clone(),
            lots: self.lot.clone(),
            procedure: self.procedure.clone(),
            measurand: self.measurand.clone(),
            station: self.station.clone(),
            since: self.since.clone(),
        }
    }
}

fn rendered(
    args: &HistoryArgs,
    attempts: &[Attempt],
    record: &HistoryRecord,
    lang: Lang,
) -> Result<String, String> {
    let say = |note: Note| place::error(&note, lang);
    Ok(match args.format {
        HistoryFormat::Csv => csv(attempts, args.measurand.as_deref()),
        HistoryFormat::Json | HistoryFormat::Pdf => json(record, lang)?,
        HistoryFormat::Table => {
            let plain = Terminal { width: FILE_WIDTH, colour: false };
            let target = if args.out.is_some() { plain } else { standard_output() };
            terminal(&on_terminal(record, lang), target)
        }
        HistoryFormat::Html => {
            let renderer = renderer(args.templates.as_deref(), lang)?;
            let page = page(record, &figures::all(record), lang);
            PageForm::Html.page(&page, &renderer, lang).map_err(|e| say(e.note()))?
        }
    })
}

fn json(record: &HistoryRecord, lang: Lang) -> Result<String, String> {
    let json = serde_json::to_string_pretty(record)
        .map_err(|e| place::error(&note!("system.other", reason = e.to_string()), lang))?;
    Ok(format!("{json}\n"))
}
