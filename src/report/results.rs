//! Everything that a run or an explanation gives, in memory or read back from its folder.

use super::document::{Document, Documented};
use super::figure_file::{FIGURES_FILE, FIGURES_FORMAT, FigureFile};
use super::files::{Context, ExplainFile, JointFile, PlanFile};
use super::{compare, lot};
use crate::acceptance::Outcome;
use crate::acceptance::changes;
use crate::acceptance::compare::{COMPARISON_FORMAT, Comparison, figures};
use crate::acceptance::datasheet;
use crate::config::{alternatives, model, schedule};
use crate::figure::Figure;
use crate::i18n::{Lang, Localize, Note, note};
use crate::mismatch;
use crate::mismatch::joint::record::JOINT_FORMAT;
use crate::output::Kind;
use crate::plan::record::PLAN_FORMAT;
use crate::record::explanation::Explanation;
use crate::record::read::{self, ReadError};
use crate::record::{
    DATASHEET_FORMAT, DAY_FORMAT, DataSheet, DayRecord, FigureRecord, LOT_FORMAT, LotRecord, PROOF_FORMAT,
    PhaseRecord, ProofRecord, REHEARSAL_FORMAT, RESULT_FORMAT, RehearsalRecord, RunRecord,
};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};

/// What would explain a recording as well, beside `explain.json`.
pub const ALTERNATIVES_FILE: &str = "alternatives.toml";
/// The schedule beside `plan.json`.
pub const SCHEDULE_FILE: &str = "schedule.toml";
/// Version of `explain.json`.
const EXPLAIN_FORMAT: &str = "explain/1";

/// What a run gives.
pub struct RunResults {
    /// Record, figures and tables; of a test of several phases those of the whole.
    pub outcome: Outcome,
    /// The outcomes of the phases, in the order of the record; `None` for one that was not recorded.
    pub phases: Vec<Option<Outcome>>,
    /// The recording against the model that the procedure names, where it names one.
    pub explanation: Option<ExplanationResults>,
}

impl From<Outcome> for RunResults {
    fn from(outcome: Outcome) -> RunResults {
        RunResults { outcome, phases: vec![], explanation: None }
    }
}

/// What an explanation gives.
#[derive(Clone)]
pub struct ExplanationResults {
    /// What `explain.json` holds.
    pub file: ExplainFile,
    /// The figures, in the order of the page.
    pub figures: Vec<Figure>,
    /// `correction.csv`, where there is a correction, `augmented.toml`, and `alternatives.toml`, where an effect has
    /// equivalents.
    pub tables: Vec<(String, String)>,
}

impl ExplanationResults {
    /// The results of an explanation.
    pub fn new(outcome: &mismatch::Outcome, context: Context) -> ExplanationResults {
        let correction =
            outcome.correction.as_ref().map(|c| ("correction.csv".to_owned(), correction_csv(c)));
        let augmented = ("augmented.toml".to_owned(), model::write(&outcome.augmented));
        let equal = outcome.explanation.effects.iter().any(|f| f.other_causes().next().is_some());
        let alternatives =
            equal.then(|| (ALTERNATIVES_FILE.to_owned(), alternatives::write(&outcome.alternatives)));
        ExplanationResults {
            file: ExplainFile { explanation: outcome.explanation.clone(), context },
            figures: outcome.figures.clone(),
            tables: correction.into_iter().chain([augmented]).chain(alternatives).collect(),
        }
    }
}

impl ExplanationResults {
    /// The document of the explanation.
    pub fn document(&self, lang: Lang) -> Document<'_> {
        Document::new(&self.file, &self.figures, &self.tables, lang)
    }
}

/// `correction.csv`: the shortest digits from which time and correction come back to the bit.
fn correction_csv(correction: &[(f64, f64)]) -> String {
    let mut out = String::with_capacity(24 + 32 * correction.len());
    out.push_str("time_s,correction_deg_h\n");
    for (time, value) in correction {
        let _ = writeln!(out, "{time},{value:e}");
    }
    out
}

/// Results of several recordings that are explained together.
pub struct JointResults {
    /// What `joint.json` holds.
    pub file: JointFile,
    /// The explanation of each recording, in the order of the record; `None` for one that is missing.
    pub recordings: Vec<Option<ExplanationResults>>,
    /// `augmented.toml`.
    pub tables: Vec<(String, String)>,
}

/// Results of any kind.
pub enum Results {
    /// Of a run or an analysis.
    Run(Box<RunResults>),
    /// Of an explanation.
    Explanation(Box<ExplanationResults>),
    /// Of several recordings that are explained together.
    Joint(Box<JointResults>),
    /// Of any other record.
    Other(OtherResults),
}

/// A record that needs nothing but itself, its figures and its tables.
pub struct OtherResults {
    /// The record.
    pub record: Box<dyn Documented>,
    /// The figures, in the order of the page.
    pub figures: Vec<Figure>,
    /// Tables and other data files: name and contents.
    pub tables: Vec<(String, String)>,
}

impl Results {
    /// The results of a record that needs nothing but itself, its figures and its tables.
    pub fn of(
        record: impl Documented + 'static,
        figures: Vec<Figure>,
        tables: Vec<(String, String)>,
    ) -> Results {
        Results::Other(OtherResults { record: Box::new(record), figures, tables })
    }

    /// The results of a comparison.
    pub fn of_comparison(comparison: Comparison) -> Results {
        let figures = figures::all(&comparison.units);
        let rows = ("comparison.csv".to_owned(), compare::csv(&comparison));
        let agreement = compare::agreement_csv(&comparison).map(|rows| ("agreement.csv".to_owned(), rows));
        Results::of(comparison, figures, std::iter::once(rows).chain(agreement).collect())
    }

    /// The results of a lot. Those of its units stand in folders of their own.
    pub fn of_lot(record: LotRecord) -> Results {
        let rows = lot::csv(&record);
        Results::of(record, vec![], vec![("index.csv".into(), rows)])
    }

    /// The results of a plan: the record and its schedule.
    pub fn of_plan(file: PlanFile) -> Results {
        let planned = file.plan.schedule.as_ref();
        let schedule = planned.map(|s| (SCHEDULE_FILE.to_owned(), schedule::write(&s.schedule)));
        let tables = schedule.into_iter().collect();
        Results::of(file, vec![], tables)
    }

    /// The results of a data sheet. The head of its limits file is in one language, as files of limits are.
    pub fn of_datasheet(record: DataSheet) -> Results {
        let head = note!("datasheet.limits_head", n = record.units).say(Lang::En);
        let limits = datasheet::limits::limits_file(&record, &head);
        let figures = datasheet::figures::all(&record);
        Results::of(record, figures, vec![("limits.toml".into(), limits)])
    }

    /// The files of the recording that were read, with the SHA-256 of what was read.
    pub fn files_read(&self) -> Vec<(PathBuf, String)> {
        let Results::Run(results) = self else { return vec![] };
        let files = results.outcome.record.recording.iter();
        files.map(|f| (PathBuf::from(&f.path), f.sha256.clone())).collect()
    }

    /// The record of the whole.
    pub fn record(&self) -> &dyn Documented {
        match self {
            Results::Run(results) => &results.outcome.record,
            Results::Explanation(results) => &results.file,
            Results::Joint(results) => &results.file,
            Results::Other(results) => &*results.record,
        }
    }

    /// What the folder of the results holds.
    pub fn kind(&self) -> Kind {
        self.record().kind()
    }

    /// Version of the program that wrote the results; `None` where their record does not tell it.
    pub fn program_version(&self) -> Option<&str> {
        self.record().program_version()
    }

    /// What a folder is named after: the serial number of the unit, or the case that is explained.
    pub fn subject(&self) -> Option<&str> {
        self.record().folder_name()
    }

    /// The document of the whole.
    pub fn whole(&self, lang: Lang) -> Document<'_> {
        match self {
            Results::Run(results) if results.outcome.record.phases.is_empty() => {
                Document::of_run(&results.outcome, lang)
            }
            Results::Run(results) => Document::of_phases(&results.outcome.record, &results.phases, lang),
            Results::Explanation(results) => results.document(lang),
            Results::Joint(results) => Document::new(&results.file, &[], &results.tables, lang),
            Results::Other(results) => {
                Document::new(&*results.record, &results.figures, &results.tables, lang)
            }
        }
    }

    /// The certificate of conformity of a test that is passed.
    ///
    /// # Errors
    /// Why there is none.
    pub fn certificate(&self, lang: Lang) -> Result<Document<'_>, Note> {
        match self {
            Results::Run(results) => Document::certificate(&results.outcome, &results.phases, lang),
            Results::Explanation(_) | Results::Joint(_) | Results::Other(_) => {
                Err("certificate.no_test".into())
            }
        }
    }

    /// The documents that stand in folders below that of the whole, each with its folder, such as `phases/static`.
    pub fn parts(&self, lang: Lang) -> Vec<(String, Document<'_>)> {
        if let Results::Joint(results) = self {
            let folders = results.file.explanation.recordings.iter().map(|r| r.folder.clone());
            let parts =
                folders.zip(&results.recordings).filter_map(|(folder, e)| Some((folder, e.as_ref()?)));
            return parts.map(|(folder, e)| (folder, e.document(lang))).collect();
        }
        let Results::Run(results) = self else { return vec![] };
        let phases = results.outcome.record.phases.iter().zip(&results.phases);
        let phases = phases.filter_map(|(phase, o)| phase.folder.clone().zip(o.as_ref()));
        let explanation = results.explanation.as_ref().map(|e| ("explain".to_owned(), e));
        let phases = phases.map(|(folder, o)| (folder, Document::of_run(o, lang)));
        let explanation = explanation.map(|(folder, e)| (folder, e.document(lang)));
        phases.chain(explanation).collect()
    }
}

/// Results read back from their folder.
pub struct StoredResults {
    /// The results.
    pub results: Results,
    /// Their inputs, as the result lists them.
    pub inputs: BTreeMap<String, String>,
    /// The files of the folder, as the result lists them.
    pub files: Vec<String>,
    /// What is not there any more, or was never kept: the page is made without it.
    pub missing: Vec<Note>,
}

/// What a record says of its folder.
#[derive(Default, Deserialize)]
struct Listing {
    #[serde(default)]
    inputs: BTreeMap<String, String>,
    #[serde(default)]
    files: Vec<String>,
}

impl StoredResults {
    /// Reads a `result.json`, `explain.json`, `joint.json`, `comparison.json`, `index.json`, `plan.json`, `datasheet.json`,
    /// `day.json`, `rehearsal.json` or `proof.json`, or the folder of one, with what stands beside it.
    ///
    /// # Errors
    /// A note that names the file and what is wrong with it.
    pub fn open(path: &Path) -> Result<StoredResults, Note> {
        let file = record_file(path)?;
        let wrong = |e: ReadError| e.note(&file);
        let bytes = read::bytes(&file).map_err(wrong)?;
        let format = read::format_of(&bytes).map_err(wrong)?.unwrap_or_default();
        let listing: Listing = serde_json::from_slice(&bytes).unwrap_or_default();
        let folder = file.parent().map(Path::to_owned).unwrap_or_default();
        let mut from = Folder { path: folder, files: listing.files, missing: vec![] };
        let results = match format.split('/').next() {
            Some("explain") => Results::Explanation(Box::new(from.explanation("", &bytes).map_err(wrong)?)),
            Some("comparison") => {
                Results::of_comparison(read::of_format(&bytes, COMPARISON_FORMAT).map_err(wrong)?)
            }
            Some("explain-joint") => Results::Joint(Box::new(from.joint(&bytes).map_err(wrong)?)),
            Some("plan") => {
                Results::of_plan(read::of_format::<PlanFile>(&bytes, PLAN_FORMAT).map_err(wrong)?)
            }
            Some("lot") => Results::of_lot(read::of_format::<LotRecord>(&bytes, LOT_FORMAT).map_err(wrong)?),
            Some("datasheet") => {
                Results::of_datasheet(read::of_format(&bytes, DATASHEET_FORMAT).map_err(wrong)?)
            }
            Some("day") => {
                Results::of(read::of_format::<DayRecord>(&bytes, DAY_FORMAT).map_err(wrong)?, vec![], vec![])
            }
            Some("rehearsal") => {
                let rehearsal: RehearsalRecord = read::of_format(&bytes, REHEARSAL_FORMAT).map_err(wrong)?;
                Results::of(rehearsal, vec![], vec![])
            }
            Some("proof-result") => {
                let proof: ProofRecord = read::of_format(&bytes, PROOF_FORMAT).map_err(wrong)?;
                let figures = from.figures("", 1, &[]);
                Results::of(proof, figures, from.tables("", Kind::Proof))
            }
            _ => Results::Run(Box::new(from.run(&bytes).map_err(wrong)?)),
        };
        Ok(StoredResults { results, inputs: listing.inputs, files: from.files, missing: from.missing })
    }
}

impl StoredResults {
    /// True where the data of figures are missing, or a phase with its own: the page is not the one that was written.
    pub fn lacks_figures(&self) -> bool {
        self.missing
            .iter()
            .any(|n| matches!(n.id.as_ref(), "result_error.no_figures" | "result_error.no_phase"))
    }
}

/// The file that a path stands for.
fn record_file(path: &Path) -> Result<PathBuf, Note> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    Kind::ALL
        .iter()
        .map(|k| path.join(k.record_file()))
        .find(|p| p.is_file())
        .ok_or_else(|| note!("result_error.no_result_in", path = path.display().to_string()))
}

/// A folder that results are read from.
struct Folder {
    path: PathBuf,
    files: Vec<String>,
    missing: Vec<Note>,
}

impl Folder {
    fn run(&mut self, bytes: &[u8]) -> Result<RunResults, ReadError> {
        let record: RunRecord = read::of_format(bytes, RESULT_FORMAT)?;
        if !record.phases.is_empty() {
            let phases = record.phases.iter().map(|p| self.of_phase(p)).collect();
            let outcome = Outcome { record, figures: vec![], tables: vec![] };
            return Ok(RunResults { outcome, phases, explanation: None });
        }
        let explanation = record.explained.as_ref().and_then(|e| e.explanation.clone());
        let outcome = self.outcome(record, "");
        let explanation = explanation.map(|e| self.explanation_of_run(e));
        Ok(RunResults { outcome, phases: vec![], explanation })
    }

    /// The outcome of a part of a test: of its folder, or of the changes between phases, which stand in the record itself.
    fn of_phase(&mut self, phase: &PhaseRecord) -> Option<Outcome> {
        changes::outcome(phase).or_else(|| self.phase(&phase.id, phase.folder.as_deref()?))
    }

    /// The outcome of a phase; `None` where its result is missing.
    fn phase(&mut self, id: &str, folder: &str) -> Option<Outcome> {
        // A result leads to no place outside its folder.
        let inside = Path::new(folder).components().all(|c| matches!(c, Component::Normal(_)));
        let path = self.path.join(folder).join(Kind::Result.record_file());
        let record = if inside { read::open(&path) } else { return None };
        match record {
            Ok(record) => Some(self.outcome(record, &format!("{folder}/"))),
            Err(e) => {
                self.missing.push(note!("result_error.no_phase", id, why = e.note(&path)));
                None
            }
        }
    }

    fn outcome(&mut self, record: RunRecord, before: &str) -> Outcome {
        let figures = self.figures(before, record.figures.len(), &record.figures);
        Outcome { figures, tables: self.tables(before, Kind::Result), record }
    }

    fn explanation(&mut self, before: &str, bytes: &[u8]) -> Result<ExplanationResults, ReadError> {
        let explanation: Explanation = read::of_format(bytes, EXPLAIN_FORMAT)?;
        let file: ContextOf = read::of_format(bytes, EXPLAIN_FORMAT)?;
        Ok(self.with_context(explanation, file.context, before))
    }

    fn joint(&mut self, bytes: &[u8]) -> Result<JointResults, ReadError> {
        let file: JointFile = read::of_format(bytes, JOINT_FORMAT)?;
        let folders: Vec<String> = file.explanation.recordings.iter().map(|r| r.folder.clone()).collect();
        let recordings = folders.iter().map(|folder| self.part(folder)).collect();
        Ok(JointResults { recordings, tables: self.tables("", Kind::Joint), file })
    }

    /// The explanation of one of several recordings; `None` where it is missing.
    fn part(&mut self, folder: &str) -> Option<ExplanationResults> {
        // A record leads to no place outside its folder.
        let inside = Path::new(folder).components().all(|c| matches!(c, Component::Normal(_)));
        let path = self.path.join(folder).join(Kind::Explanation.record_file());
        let read = if inside { read::bytes(&path) } else { return None };
        match read.and_then(|bytes| self.explanation(&format!("{folder}/"), &bytes)) {
            Ok(explanation) => Some(explanation),
            Err(e) => {
                self.missing.push(e.note(&path));
                None
            }
        }
    }

    /// The explanation that the record of a run holds, with what stands in its folder.
    fn explanation_of_run(&mut self, explanation: Explanation) -> ExplanationResults {
        let path = self.path.join("explain").join(Kind::Explanation.record_file());
        let file = read::bytes(&path).and_then(|b| read::of_format::<ContextOf>(&b, EXPLAIN_FORMAT));
        let context = match file {
            Ok(file) => file.context,
            Err(e) => {
                self.missing.push(e.note(&path));
                Context::default()
            }
        };
        self.with_context(explanation, context, "explain/")
    }

    fn with_context(
        &mut self,
        explanation: Explanation,
        context: Context,
        before: &str,
    ) -> ExplanationResults {
        let figures = self.figures(before, 1, &[]);
        let tables = self.tables(before, Kind::Explanation);
        ExplanationResults { file: ExplainFile { explanation, context }, figures, tables }
    }

    /// The figures whose data stand below a part of the folder.
    fn figures(&mut self, before: &str, expected: usize, named: &[FigureRecord]) -> Vec<Figure> {
        if expected == 0 {
            return vec![];
        }
        let path = self.path.join(format!("{before}{FIGURES_FILE}"));
        let file =
            read::bytes(&path).and_then(|b| read::of_format::<FigureFile<'static>>(&b, FIGURES_FORMAT));
        match file {
            Ok(file) => {
                let known = |f: &Figure| named.is_empty() || named.iter().any(|n| n.id == f.id);
                file.figures.into_owned().into_iter().filter(known).collect()
            }
            Err(e) => {
                self.missing.push(note!("result_error.no_figures", why = e.note(&path)));
                vec![]
            }
        }
    }

    /// The tables that the record lists below a part of the folder; where it lists nothing, those that are there.
    fn tables(&mut self, before: &str, kind: Kind) -> Vec<(String, String)> {
        let below = self.path.join(before);
        let listed = self.files.iter().filter_map(|f| f.strip_prefix(before)).map(str::to_owned);
        let mut names: Vec<String> = listed.filter(|n| kind.is_table(n)).collect();
        if self.files.is_empty() {
            let there = std::fs::read_dir(&below).into_iter().flatten().flatten();
            names = there.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
            names.retain(|n| kind.is_table(n));
            names.sort();
        }
        let mut tables = vec![];
        for name in names {
            let path = below.join(&name);
            match read::bytes(&path).map(String::from_utf8) {
                Ok(Ok(text)) => tables.push((name, text)),
                Ok(Err(_)) => {
                    self.missing.push(note!("result_error.not_text", path = path.display().to_string()))
                }
                Err(e) => self.missing.push(e.note(&path)),
            }
        }
        tables
    }
}

/// The part of an `explain.json` that a page needs beside the explanation.
#[derive(Deserialize)]
struct ContextOf {
    #[serde(default)]
    context: Context,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_comes_back_to_the_bit() {
        let given = [(0.1 + 0.2, -1.0 / 3.0), (1e6 + 0.1, 2.5e-9), (3.0, 0.0)];
        let text = correction_csv(&given);
        let read: Vec<(f64, f64)> = text
            .lines()
            .skip(1)
            .map(|l| l.split_once(',').unwrap())
            .map(|(a, b)| (a.parse().unwrap(), b.parse().unwrap()))
            .collect();
        assert_eq!(read, given);
        assert_eq!(text.lines().next(), Some("time_s,correction_deg_h"));
    }
}
