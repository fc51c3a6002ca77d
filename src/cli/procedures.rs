//! `sagnac procedures`: the procedures and limits that the program carries.

use super::{exit, place};
use crate::config::shipped::{SHIPPED_LIMITS, SHIPPED_PROCEDURES, Shipped, StatedClause, find};
use crate::i18n::{Lang, Localize, Note, note};
use crate::report::terminal::wrapped;
use clap::{Args, Subcommand};
use sagnac_ingest::read_file;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct ProceduresArgs {
    /// List the clauses of the standard with the procedures and rows that deal with them
    #[arg(long)]
    clauses: bool,
    #[command(subcommand)]
    what: Option<What>,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Print a shipped procedure or limits file
    Show {
        /// Name of the procedure or limits file
        name: String,
    },
    /// Write all shipped procedures and limits into a folder
    Save {
        /// Folder to create; existing files are not replaced
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
}

pub fn main(args: &ProceduresArgs, lang: Lang) -> Result<u8, String> {
    match &args.what {
        None if args.clauses => clauses(lang),
        None => list(lang),
        Some(What::Show { name }) => {
            let Some(shipped) = find(Path::new(name)) else {
                let names: Vec<&str> =
                    SHIPPED_PROCEDURES.iter().chain(SHIPPED_LIMITS).map(|s| s.name).collect();
                let note = note!("procedures.unknown", name = name.as_str());
                return Err(place::error(&note.with("names", names.join(", ")), lang));
            };
            place::print(shipped.text);
        }
        Some(What::Save { folder }) => save(folder, lang)?,
    }
    Ok(exit::PASS)
}

/// Says for each name of the command line whether the shipped file is taken or a file of the same name.
pub fn say_which(named: &[&Path], lang: Lang) {
    for path in named {
        let Some(shipped) = find(path) else { continue };
        let key = if path.is_file() { "procedures.file_taken" } else { "procedures.shipped_taken" };
        place::eprint_diagnostic(&format!("{}\n", Note::new(key).with("name", shipped.name).say(lang)));
    }
}

fn list(lang: Lang) {
    let width = SHIPPED_PROCEDURES.iter().chain(SHIPPED_LIMITS).map(|s| s.name.len()).max().unwrap_or(0);
    let group = |key: &'static str, all: &[Shipped]| {
        let rows: String = all.iter().map(|s| format!("  {:width$}  {}\n", s.name, s.title(lang))).collect();
        format!("{}\n{rows}", Note::new(key).say(lang))
    };
    let text =
        [group("procedures.procedures", SHIPPED_PROCEDURES), group("procedures.limits", SHIPPED_LIMITS)]
            .join("\n");
    place::print(&format!("{text}\n{}\n", note!("procedures.more").say(lang)));
}

/// Columns of a list.
const LIST_WIDTH_COLUMNS: usize = 80;

/// A text in lines, set in by `indent`.
fn lines(indent: &str, text: &str) -> String {
    let within = LIST_WIDTH_COLUMNS - indent.len();
    wrapped(text, within).iter().map(|line| format!("{indent}{line}\n")).collect()
}

/// Lists every clause that a shipped procedure names, with those that deal with it and their rows.
fn clauses(lang: Lang) {
    let mut found: BTreeMap<Vec<u32>, (StatedClause, Vec<String>)> = BTreeMap::new();
    for procedure in SHIPPED_PROCEDURES {
        for clause in procedure.clauses(lang) {
            // Numbers are sorted by their parts: 12.9 comes before 12.10.
            let parts = clause.number.split('.').map(|part| part.parse().unwrap_or(u32::MAX)).collect();
            let dealt_with = clause.here.then(|| {
                let note = if clause.note.is_empty() { String::new() } else { format!(": {}", clause.note) };
                let rows = clause.measurands.join(", ");
                let named = lines("  ", &format!("{}{note}", procedure.name));
                if rows.is_empty() { named } else { named + &lines("    ", &rows) }
            });
            found.entry(parts).or_insert_with(|| (clause, vec![])).1.extend(dealt_with);
        }
    }
    let of_clause = |(clause, dealt_with): &(StatedClause, Vec<String>)| {
        let none = || lines("  ", &note!("procedures.no_clause").say(lang));
        let below = if dealt_with.is_empty() { none() } else { dealt_with.concat() };
        lines("", &format!("{} {}", clause.number, clause.title)) + &below
    };
    place::print(&found.values().map(of_clause).collect::<Vec<String>>().join("\n"));
}

/// Writes what is not there yet; a file of other content ends it before anything is written.
fn save(folder: &Path, lang: Lang) -> Result<(), String> {
    let failed = |path: &Path, reason: String| {
        let note = note!("procedures.not_saved", path = place::shown(path), reason);
        place::error(&note, lang)
    };
    let all: Vec<(PathBuf, &Shipped)> =
        SHIPPED_PROCEDURES.iter().chain(SHIPPED_LIMITS).map(|s| (folder.join(s.path()), s)).collect();
    for (path, shipped) in &all {
        if path.exists()
            && read_file(path, shipped.text.len() as u64).ok().as_deref() != Some(shipped.text.as_bytes())
        {
            return Err(failed(path, note!("procedures.other_content").say(lang)));
        }
    }
    for (path, shipped) in &all {
        let parent = path.parent().unwrap_or(folder);
        std::fs::create_dir_all(parent).map_err(|e| failed(parent, e.to_string()))?;
        std::fs::write(path, shipped.text).map_err(|e| failed(path, e.to_string()))?;
    }
    let note = note!("procedures.saved", n = all.len(), folder = place::shown(folder));
    place::print(&format!("{}\n", note.say(lang)));
    Ok(())
}
