//! `sagnac watch`: every recording that appears in a folder is tested once.

use super::ending;
use super::job::execute;
use super::keep::{Keeper, StoreArgs};
use super::options::OutputArgs;
use super::place;
use super::watch_pass::{Pass, PassOutcome};
use crate::config::procedure::phases::{is_phased, load_phased};
use crate::config::procedure::{load, load_limits};
use crate::config::watch::{self as rules_file, Completeness, WatchRule, WatchRules};
use crate::i18n::{Lang, Localize, Note, io_reason, note};
use crate::ingest::{ReadOptions, files_read};
use crate::moment;
use crate::output::outside_stores;
use crate::record::Untested;
use crate::watch::folder::{Found, Stamp, Stillness, age, found};
use crate::watch::identity::TestedBy;
use crate::watch::journal::{Journal, Tested};
use crate::watch::lock::{WATCHER_LOCK, take};
use crate::watch::recording::stands;
use crate::watch::{JOURNAL_FILE, hook};
use clap::Args;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Pause between two looks for a request to end.
const REQUEST_POLL: Duration = Duration::from_millis(50);

#[derive(Debug, Args)]
pub struct WatchArgs {
    /// Folder in which recordings appear
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Rules (TOML): which files are recordings of which test
    #[arg(long, value_name = "FILE", conflicts_with_all = ["procedure", "limits"])]
    rules: Option<PathBuf>,
    /// Procedure (TOML) for every file of the folder
    #[arg(long, value_name = "FILE", required_unless_present = "rules")]
    procedure: Option<PathBuf>,
    /// Limits file for every file of the folder
    #[arg(long, value_name = "FILE")]
    limits: Option<PathBuf>,
    /// Folder for results, pages of days and the journal
    #[arg(long, value_name = "DIR", default_value = "watched")]
    pub out: PathBuf,
    /// Look once, test what is complete, and end
    #[arg(long)]
    pub once: bool,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Watches until it is asked to end, or looks once; gives the exit code: after a single look, of the worst verdict.
///
/// # Errors
/// The diagnostic, in words.
pub fn main(args: &WatchArgs, lang: Lang) -> Result<u8, String> {
    ending::defer();
    let mut watch = Watch::begin(args, lang)?;
    loop {
        let looked = Instant::now();
        let done = watch.look_and_test();
        if args.once {
            return done;
        }
        // A disk that is full or a share that is gone now may be there again at the next look.
        if let Err(message) = done {
            place::eprint_diagnostic(&message);
        }
        while !ending::is_asked() && looked.elapsed() < watch.poll {
            std::thread::sleep(REQUEST_POLL.min(watch.poll));
        }
        if ending::is_asked() {
            return Ok(super::exit::PASS);
        }
    }
}

/// A rule with what it needs at work.
pub struct ActiveRule {
    /// The rule.
    pub rule: WatchRule,
    /// Contents of procedure and limits.
    pub by: TestedBy,
    /// Digest of them.
    pub digest: String,
    /// Options by which recordings are read.
    pub options: ReadOptions,
    /// Id of the procedure.
    pub procedure_id: String,
    /// Keeps results in the store of the rule.
    pub keeper: Keeper,
}

impl ActiveRule {
    fn load(rule: WatchRule, lang: Lang) -> Result<ActiveRule, String> {
        let by = TestedBy::now(&rule.procedure, rule.limits.as_deref());
        let (procedure_id, options) = if is_phased(&rule.procedure) {
            let phased = load_phased(&rule.procedure).map_err(|p| p.say(lang))?;
            (phased.identity.id, ReadOptions::default())
        } else {
            let procedure = load(&rule.procedure).map_err(|p| p.say(lang))?.value;
            (procedure.id, procedure.recording.read)
        };
        if let Some(limits) = &rule.limits {
            load_limits(limits).map_err(|p| p.say(lang))?;
        }
        let store = StoreArgs { store: rule.store.clone(), ..StoreArgs::default() };
        let keeper = Keeper::new(&store, lang)?;
        Ok(ActiveRule { digest: by.digest(), rule, by, options, procedure_id, keeper })
    }

    /// Reads procedure and limits again where they were changed.
    fn refresh(&mut self, lang: Lang) -> Result<(), String> {
        let by = TestedBy::now(&self.rule.procedure, self.rule.limits.as_deref());
        if by != self.by {
            *self = ActiveRule::load(self.rule.clone(), lang)?;
        }
        Ok(())
    }
}

/// A recording that is ready to be tested.
pub struct Ready {
    /// The file.
    pub found: Found,
    /// Every file that is read.
    pub files: Vec<PathBuf>,
    /// Their stamp.
    pub stamp: Stamp,
}

/// Something that is tried again later.
struct PutOff {
    failures: u32,
    until: Instant,
    why: Note,
}

/// A watched folder.
pub struct Watch<'a> {
    /// The options.
    pub args: &'a WatchArgs,
    /// The rules.
    pub rules: Vec<ActiveRule>,
    /// Folder that hook commands run in.
    pub hook_folder: PathBuf,
    /// Folder of results, absolute.
    pub out: PathBuf,
    /// The journal.
    pub journal: Journal,
    lang: Lang,
    poll: Duration,
    still: Stillness,
    put_off: BTreeMap<String, PutOff>,
    shown: Option<BTreeSet<(String, String)>>,
    _lock: File,
}

impl<'a> Watch<'a> {
    fn begin(args: &'a WatchArgs, lang: Lang) -> Result<Watch<'a>, String> {
        let error = |note: Note| place::error(&note, lang);
        let (WatchRules { poll, rules }, hook_folder) = args.rules(lang)?;
        let rules = rules.into_iter().map(|rule| ActiveRule::load(rule, lang));
        let rules = rules.collect::<Result<Vec<_>, _>>()?;
        let refused = |path: &Path, e: &std::io::Error| {
            error(note!("watch.unreadable", path = place::shown(path), reason = io_reason(e)))
        };
        let folder = args.folder.canonicalize().map_err(|e| refused(&args.folder, &e))?;
        if !folder.is_dir() {
            return Err(error(note!("watch.not_a_folder", path = place::shown(&args.folder))));
        }
        outside_stores(&args.out.join(JOURNAL_FILE)).map_err(|e| error(e.note()))?;
        std::fs::create_dir_all(&args.out).map_err(|e| refused(&args.out, &e))?;
        let out = args.out.canonicalize().map_err(|e| refused(&args.out, &e))?;
        if out.starts_with(&folder) {
            return Err(error(note!("watch.out_inside", path = place::shown(&args.out))));
        }
        let lock = take(&out.join(WATCHER_LOCK)).map_err(|e| refused(&out, &e))?;
        let lock = lock.ok_or_else(|| error(note!("watch.taken", path = place::shown(&args.out))))?;
        let today = day(moment::now());
        let journal = Journal::open(&out.join(JOURNAL_FILE), &today).map_err(error)?;
        Ok(Watch {
            args,
            rules,
            hook_folder,
            out,
            journal,
            lang,
            poll,
            still: Stillness::default(),
            put_off: BTreeMap::new(),
            shown: None,
            _lock: lock,
        })
    }

    /// The watched folder, as it was named.
    pub fn folder(&self) -> &'a Path {
        &self.args.folder
    }

    /// Looks at the folder, tests what is complete, and writes the page of the day where there is anything new; gives the exit
    /// code of the worst verdict.
    fn look_and_test(&mut self) -> Result<u8, String> {
        let (args, lang) = (self.args, self.lang);
        let (ready, untested) = self.look()?;
        let shown: BTreeSet<(String, String)> =
            untested.iter().map(|u| (u.recording.clone(), u.why.0.say(Lang::En))).collect();
        let is_new = self.shown.as_ref() != Some(&shown);
        if ready.is_empty() && self.due().is_empty() && !is_new {
            return Ok(super::exit::PASS);
        }
        let (outcome, watch) = (&PassOutcome::default(), &mut *self);
        let code = execute(&args.output, lang, move |_| Ok(Pass::new(watch, ready, untested, outcome)))?;
        self.shown = Some(shown);
        Ok(code)
    }

    /// The recordings that are ready, and those that are not with the reasons.
    fn look(&mut self) -> Result<(Vec<Ready>, Vec<Untested>), String> {
        for rule in &mut self.rules {
            rule.refresh(self.lang)?;
        }
        let rules: Vec<WatchRule> = self.rules.iter().map(|active| active.rule.clone()).collect();
        let (files, refused) = found(self.folder(), &rules).map_err(|note| place::error(&note, self.lang))?;
        let now = Instant::now();
        self.still.keep(&files.iter().map(|f| f.path.as_path()).collect());
        let mut untested: Vec<Untested> =
            refused.into_iter().map(|(recording, why)| Untested { recording, why: why.into() }).collect();
        let mut ready = vec![];
        for found in files {
            match self.state(found, now) {
                Ok(found) => ready.extend(found),
                Err(why) => untested.push(why),
            }
        }
        Ok((ready, untested))
    }

    /// A file that is ready; `None` for one that was tested, or is none to be tested.
    fn state(&mut self, found: Found, now: Instant) -> Result<Option<Ready>, Untested> {
        let Some(active) = self.rules.get(found.rule) else { return Ok(None) };
        let rule = &active.rule;
        if rule.complete == Completeness::Marker && found.name.ends_with(&rule.marker) {
            return Ok(None);
        }
        let untested = |why: Note| Untested { recording: found.name.clone(), why: why.into() };
        let files = files_read(std::slice::from_ref(&found.path), &active.options);
        let stamp = Stamp::of_all(&files).map_err(untested)?;
        if self.journal.knows(&found.name, stamp, &active.digest) {
            return Ok(None);
        }
        let seen = self.still.since(&found.path, stamp, now);
        let still = if self.args.once { age(stamp) } else { Some(seen) };
        stands(rule, &found.path, still).map_err(untested)?;
        match self.put_off.get(&found.name) {
            // What was changed since is another recording.
            Some(later) if now < later.until && seen > Duration::ZERO => Err(untested(later.why.clone())),
            _ => Ok(Some(Ready { found, files, stamp })),
        }
    }

    /// The tests of which a hook command is to be told now.
    pub fn due(&self) -> Vec<Tested> {
        let now = Instant::now();
        let mut pending = self.journal.pending();
        pending.retain(|p| {
            let is_later = self.put_off.get(&p.test.id).is_some_and(|later| now < later.until);
            !is_later && self.rules.iter().any(|r| r.rule.pattern == p.rule && !r.rule.hook.is_empty())
        });
        pending
    }

    /// Tries something again later: a recording by its name, a hook command by the id of the test.
    pub fn put_off(&mut self, what: &str, why: &Note) {
        let failures = self.put_off.get(what).map_or(0, |later| later.failures) + 1;
        let until = Instant::now() + hook::pause(failures);
        self.put_off.insert(what.to_owned(), PutOff { failures, until, why: why.clone() });
    }

    /// Forgets that something failed.
    pub fn succeeded(&mut self, what: &str) {
        self.put_off.remove(what);
    }
}

impl WatchArgs {
    /// The rules, and the folder that their hook commands run in.
    fn rules(&self, lang: Lang) -> Result<(WatchRules, PathBuf), String> {
        let here = PathBuf::from(".");
        if let Some(path) = &self.rules {
            let rules = rules_file::load(path).map_err(|p| p.say(lang))?;
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).map_or(here, Path::to_owned);
            return Ok((rules, folder));
        }
        let procedure = self.procedure.clone().unwrap_or_default();
        let rule = WatchRule::of_every_file(procedure, self.limits.clone());
        Ok((WatchRules { poll: rules_file::DEFAULT_POLL, rules: vec![rule] }, here))
    }
}

/// A day by UTC.
pub fn day(moment: chrono::DateTime<chrono::Utc>) -> String {
    moment.format("%Y-%m-%d").to_string()
}
