//! Procedures of several phases: each phase is a procedure of its own, on recordings of its own.

use super::LimitsFile;
use super::diagnostics::{Problem, Problems, SourceText, Span};
use super::load::{load, load_limits};
use super::model::{Loaded, Procedure};
use super::reader::{Reader, meant};
use super::section::Section;
use super::tables::phases::{CompareKeys, PHASES_FILE, PhaseKeys, PhasesFile};
use super::unit_facts::UnitFact;
use crate::config::contained_files;
use crate::config::read_tables::checked;
use crate::config::shipped::{self, Shipped};
use crate::config::table::Table;
use crate::config::text_file::{self, Wording};
use crate::estimate::Limit;
use crate::i18n::{LocalText, note};
use crate::measurand::Measurand;
use crate::record::{ClauseRecord, ProcedureRecord};
use sagnac_core::spelling::nearest;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

const READ_MESSAGES: Wording = Wording { unreadable: "check.unreadable", folder: "check.is_folder" };

/// A procedure of several phases.
#[derive(Debug, Clone, PartialEq)]
pub struct Phased {
    /// Identity of the whole.
    pub identity: ProcedureRecord,
    /// Family of the unit.
    pub family: Option<LocalText>,
    /// Part number.
    pub part: Option<String>,
    /// Revision of the part.
    pub part_revision: Option<String>,
    /// True when a run without a serial number is an error.
    pub serial_required: bool,
    /// Further facts that must be known of the unit.
    pub requires: Vec<UnitFact>,
    /// The phases in their order.
    pub phases: Vec<Phase>,
    /// Changes from one phase to another.
    pub changes: Vec<Change>,
    /// Clauses of the standard.
    pub clauses: Vec<ClauseRecord>,
}

/// One phase.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Id: files of a manifest with this phase, or with one that begins with it and a point, belong to it.
    pub id: String,
    /// Title; that of its procedure where none is given.
    pub title: LocalText,
    /// Its procedure.
    pub procedure: Loaded<Procedure>,
    /// Its limits file.
    pub limits: Option<Loaded<LimitsFile>>,
}

/// The change of a quantity from one phase to another.
#[derive(Debug, Clone, PartialEq)]
pub struct Change {
    /// The quantity.
    pub measurand: &'static Measurand,
    /// Phase before.
    pub before: String,
    /// Phase after.
    pub after: String,
    /// Limit on the change, both signs.
    pub limit: Option<Limit>,
    /// Where its measurand stands.
    pub span: Span,
}

/// What the file itself says of a phase.
struct Stated {
    id: String,
    title: Option<LocalText>,
    procedure: PathBuf,
    limits: Option<PathBuf>,
}

/// Home of the files of the phases.
#[derive(Debug, Clone, Copy)]
enum Home<'a> {
    /// In a folder or below it.
    Folder(&'a Path),
    /// In the program, as the procedure itself.
    Program,
}

impl Phased {
    /// A manifest for it, with a file for each phase.
    pub fn example_manifest(&self) -> String {
        let file = |p: &Phase| format!("\n[[file]]\npath = \"{0}.csv\"\nphase = \"{0}\"\n", p.id);
        let files: String = self.phases.iter().map(file).collect();
        format!("format = \"manifest/1\"\nserial = \"SN-0001\"\nseveral_phases = true\n{files}")
    }
}

/// True when a file states phases.
pub fn is_phased(path: &Path) -> bool {
    text_file::peek(path).is_some_and(|text| text.lines().any(|l| l.trim().starts_with("[[phase]]")))
}

/// Reads a procedure of several phases with the procedures of all of them.
///
/// # Errors
/// Every problem of the file; when it is sound, those of the files that it names.
pub fn load_phased(path: &Path) -> Result<Phased, Problems> {
    let name = path.display().to_string();
    let bytes = text_file::bytes(path, &READ_MESSAGES)?;
    let source = text_file::source(&name, &bytes)?;
    let home = match shipped::find(path).filter(|_| !path.is_file()) {
        Some(_) => Home::Program,
        None => Home::Folder(contained_files::folder_of(path)),
    };
    let sha256 = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    let (read, problems) = read(&source, &name, sha256, home);
    let Some((mut phased, stated)) = read else { return Err(problems) };
    let mut found: Option<Problems> = None;
    let mut keep = |problems: Problems| match &mut found {
        Some(all) => all.list.extend(problems.list),
        None => found = Some(problems),
    };
    for s in stated {
        let procedure = load(&s.procedure).map_err(&mut keep).ok();
        let limits = s.limits.as_ref().map(|l| load_limits(l).map_err(&mut keep));
        let (Some(procedure), Some(limits)) = (procedure, limits.transpose().ok()) else { continue };
        let title = s.title.unwrap_or_else(|| procedure.value.title.clone());
        phased.phases.push(Phase { id: s.id, title, procedure, limits });
    }
    match found {
        Some(problems) => Err(problems),
        None => not_measured(&phased, &source).map_or(Ok(phased), Err),
    }
}

/// Changes of quantities that a phase does not determine.
fn not_measured(phased: &Phased, source: &SourceText) -> Option<Problems> {
    let measures = |phase: &str, m: &Measurand| {
        let procedure = phased.phases.iter().find(|p| p.id == phase).map(|p| &p.procedure.value);
        procedure.is_none_or(|p| p.measurands.iter().any(|spec| spec.measurand == m))
    };
    let of = |change: &Change| {
        let lacks = [&change.before, &change.after].into_iter().find(|p| !measures(p, change.measurand))?;
        let message = note!("compare_phases.not_measured", id = change.measurand.id, phase = lacks.as_str());
        Some(source.error(&change.span, message))
    };
    let list: Vec<Problem> = phased.changes.iter().filter_map(of).collect();
    (!list.is_empty()).then_some(Problems { list })
}

fn read(
    source: &SourceText,
    path: &str,
    sha256: String,
    home: Home<'_>,
) -> (Option<(Phased, Vec<Stated>)>, Problems) {
    checked(source, &PHASES_FILE, |root, reader| {
        let file = PhasesFile::read(root);
        let (identity, unit) = (file.procedure, file.unit_under_test);
        let phased = Phased {
            identity: ProcedureRecord {
                id: identity.id,
                title: identity.title,
                revision: identity.revision,
                standard: identity.standard,
                clause: identity.clause,
                author: identity.author,
                path: path.to_owned(),
                sha256,
                signatures: None,
                organisation: None,
                place: None,
                signatories: vec![],
                limits: None,
            },
            family: unit.family,
            part: unit.part,
            part_revision: unit.revision,
            serial_required: unit.serial_required,
            requires: unit.requires,
            phases: vec![],
            changes: changes(file.compares, root, reader),
            clauses: file.clauses.into_iter().map(Into::into).collect(),
        };
        (phased, stated(file.phases, home, reader))
    })
}

/// Id that no phase may have: that of the changes between phases.
pub const CHANGES: &str = "compare";

/// Reads the changes; each is between two phases of the file.
fn changes(tables: Vec<CompareKeys>, root: &Section, reader: &mut Reader<'_>) -> Vec<Change> {
    let known: Vec<String> = root.tables("phase").iter().filter_map(|s| s.text("id")).collect();
    let mut found = vec![];
    for keys in tables {
        let CompareKeys { measurand: Some(measurand), before: Some(before), after: Some(after), .. } = keys
        else {
            continue;
        };
        let section = keys.section;
        for (key, id) in [("before", &before), ("after", &after)] {
            if !known.contains(id) {
                let help = nearest(id, known.iter().map(String::as_str)).map(meant);
                let message = note!("compare_phases.unknown", id = id.as_str(), known = known.join(", "));
                reader.error(&section.span_of(key), message, help);
            }
        }
        if before == after {
            reader.error(&section.span_of("after"), "compare_phases.same", None);
        }
        if measurand.unit.is_empty() {
            let message = note!("compare_phases.as_recorded", id = measurand.id);
            reader.error(&section.span_of("measurand"), message, None);
        }
        let source = reader.source.name.clone();
        let limit = keys.max_change.map(|most| Limit {
            min: Some(-most),
            max: Some(most),
            rule: keys.rule,
            risk: keys.risk,
            source,
        });
        if keys.max_change.is_some_and(|most| most <= 0.0) {
            reader.error(&section.span_of("max_change"), "compare_phases.positive", None);
        }
        let span = section.span_of("measurand");
        found.push(Change { measurand, before, after, limit, span });
    }
    found
}

fn stated(phases: Vec<PhaseKeys>, home: Home<'_>, reader: &mut Reader<'_>) -> Vec<Stated> {
    let mut list: Vec<Stated> = Vec::new();
    for keys in phases {
        let (Some(id), section) = (keys.id, keys.section) else { continue };
        let mut named = |text: Option<String>, key: &str| {
            let text = text?;
            let at = reader.source.inside_quotes(&section.span_of(key));
            match home {
                Home::Folder(folder) => contained_files::file(&text, folder, &at, reader).map(|f| f.path),
                // By its name; the text of the program names only what the program carries.
                Home::Program => shipped::at(&text).map(Shipped::name_as_path),
            }
        };
        let procedure = named(keys.procedure, "procedure");
        let limits = named(keys.limits, "limits");
        let procedure = procedure.unwrap_or_default();
        let clash = |other: &Stated| {
            other.id == id
                || other.id.starts_with(&format!("{id}."))
                || id.starts_with(&format!("{}.", other.id))
        };
        if id == CHANGES {
            reader.error(&section.span_of("id"), "compare_phases.reserved", None);
        }
        if let Some(other) = list.iter().find(|o| clash(o)) {
            let message = note!("phases.twice", id = id.as_str(), other = other.id.as_str());
            reader.error(&section.span_of("id"), message, None);
        }
        list.push(Stated { id, title: keys.title, procedure, limits });
    }
    list
}
