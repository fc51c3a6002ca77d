//! The store that a run is kept in.

use super::place;
use super::printer::Printer;
use crate::acceptance::datasheet::{TestedUnit, select};
use crate::acceptance::siblings::{MOST_SIBLINGS, siblings};
use crate::config::user;
use crate::estimate::Verdict;
use crate::i18n::{Lang, LocalText, Localize, note};
use crate::ingest::serial;
use crate::output::Kind;
use crate::record::{RunRecord, SiblingsRecord};
use crate::store::{Filter, Reservation, Store, StoreError, attempt_of};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The variable of the environment that names a store.
const STORE_VARIABLE: &str = "SAGNAC_STORE";
/// Digits of an address that are shown.
const SHOWN_ADDRESS_DIGITS: usize = 12;

/// The choice of a store.
#[derive(Debug, Default, Args)]
pub struct StoreArgs {
    /// Store to keep the result in [default: SAGNAC_STORE, else the configuration of the user, else none]
    #[arg(long, value_name = "STORE")]
    pub store: Option<PathBuf>,
    /// Keep a copy of the recording in the store too
    #[arg(long)]
    pub keep_recording: bool,
    /// Keep the result in no store
    #[arg(long, conflicts_with = "store")]
    pub no_store: bool,
}

impl StoreArgs {
    /// The store asked for: by the option, the environment, or the settings of the user.
    ///
    /// # Errors
    /// The diagnostic of settings that cannot be read, in words.
    pub fn path(&self, lang: Lang) -> Result<Option<PathBuf>, String> {
        if self.no_store {
            return Ok(None);
        }
        let set = || std::env::var_os(STORE_VARIABLE).filter(|v| !v.is_empty()).map(PathBuf::from);
        match self.store.clone().or_else(set) {
            Some(path) => Ok(Some(path)),
            None => Ok(user::load(|name| std::env::var_os(name)).map_err(|p| p.say(lang))?.store),
        }
    }
}

/// Keeps results in the store that was asked for, if any.
pub struct Keeper {
    path: Option<PathBuf>,
    recordings: bool,
    lang: Lang,
    /// The numbers of the attempts that are being made, until their results are in the store.
    numbers: Mutex<Vec<Reservation>>,
}

impl Keeper {
    /// The keeper that the options ask for. A store that cannot be used is found now, before any work is done.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn new(args: &StoreArgs, lang: Lang) -> Result<Keeper, String> {
        let keeper = Keeper {
            path: args.path(lang)?,
            recordings: args.keep_recording,
            lang,
            numbers: Mutex::default(),
        };
        if let Some(store) = keeper.open()? {
            for note in store.notes() {
                place::eprint_diagnostic(&place::warning(note, lang));
            }
        }
        Ok(keeper)
    }

    /// The store is open as briefly as possible: who makes its index anew must have it alone.
    fn open(&self) -> Result<Option<Store>, String> {
        self.path.as_deref().map(Store::open).transpose().map_err(|e| self.say(&e))
    }

    fn say(&self, error: &StoreError) -> String {
        place::error(&error.note(), self.lang)
    }

    /// Writes into a record which attempt at the test it is, and how unlike the other units of its lot the unit is.
    ///
    /// # Errors
    /// The diagnostic, in words.
    pub fn place_among_others(&self, record: &mut RunRecord) -> Result<(), String> {
        if let Some(store) = self.open()? {
            let attempt = attempt_of(&store, record).map_err(|e| self.say(&e))?;
            record.attempt = attempt.map(|(attempt, number)| {
                self.numbers.lock().unwrap_or_else(PoisonError::into_inner).push(number);
                attempt
            });
            record.siblings = self.siblings(&store, record)?;
        }
        Ok(())
    }

    /// The unit of a record beside the other units of its lot that were tested by the same procedure.
    fn siblings(&self, store: &Store, record: &RunRecord) -> Result<Option<SiblingsRecord>, String> {
        if record.verdict == Verdict::Error {
            return Ok(None);
        }
        let unit = &record.unit_under_test;
        let model = unit.model.as_deref().or(unit.family.as_ref().map(LocalText::text));
        let (Some(model), Some(lot), Some(procedure)) = (model, &unit.lot, &record.procedure) else {
            return Ok(None);
        };
        let filter = Filter {
            model: Some(model.to_owned()),
            lots: vec![lot.clone()],
            procedure: Some(procedure.id.clone()),
            ..Filter::default()
        };
        let found = store.addresses(&filter).map_err(|e| self.say(&e))?;
        let file = |address: &String| store.layout().result(address).join(Kind::Result.record_file());
        // The latest ones, retests of a unit among them: those that cannot be read are named by `store verify`.
        let results = found.addresses.iter().rev().take(2 * MOST_SIBLINGS).rev();
        let results = results.filter_map(|a| TestedUnit::read(&file(a)).ok()).collect();
        let Ok(selected) = select(results) else { return Ok(None) };
        let key = serial::plain(unit.serial.as_deref().unwrap_or_default());
        let mut others: Vec<TestedUnit> = selected.units;
        others.retain(|u| serial::plain(&u.serial) != key);
        let surplus = others.len().saturating_sub(MOST_SIBLINGS);
        others.drain(..surplus);
        Ok(siblings(record, model, lot, &others))
    }

    /// Keeps a result folder that is in its place, and says where.
    ///
    /// # Errors
    /// The diagnostic, in words, with how the result can be added later.
    pub fn keep(&self, folder: &Path, printer: Printer) -> Result<(), String> {
        let Some(path) = &self.path else { return Ok(()) };
        let later = |message: String| {
            let note = note!("store.not_kept", folder = place::shown(folder));
            format!("{message}{}\n", note.say(self.lang))
        };
        let Some(mut store) = self.open().map_err(later)? else { return Ok(()) };
        let added = store.add(folder).map_err(|e| later(self.say(&e)))?;
        if self.recordings {
            store.keep_recordings(&added.address).map_err(|e| self.say(&e))?;
        }
        let note = note!(
            "store.kept",
            address = added.address.get(..SHOWN_ADDRESS_DIGITS).unwrap_or(&added.address),
            store = place::shown(path)
        );
        printer.next_step(Some(&note));
        Ok(())
    }
}
