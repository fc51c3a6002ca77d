//! The whole of a report, and of one over several phases.

use super::comparison::{self, Comparison};
use super::evidence::Evidence;
use super::explained::Explained;
use super::figures::{FigureView, select};
use super::matrix::Matrix;
use super::rows::{self, Row};
use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n::{Lang, LocalText};
use crate::record::{self, MeasurandRecord, Message, PhaseRecord, RunKind, RunRecord};
use crate::report::methods;
use crate::report::number::{count, date_time, duration, limit};
use crate::report::translator::{Field, Translator};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Everything a report shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct View {
    /// Title of the report.
    pub title: String,
    /// Id of the verdict, for colours.
    pub verdict: &'static str,
    /// The verdict in words.
    pub verdict_word: String,
    /// Why the verdict is what it is.
    pub summary: Vec<String>,
    /// What checks contradict: the first of these reasons.
    pub contradicted: Vec<String>,
    /// Errors, first of all when there are any.
    pub errors: Vec<String>,
    /// Which attempt at the test this is and what came of those before, and that the unit is unlike the others of its lot; empty
    /// for a first attempt of a unit that is not.
    pub attempt: Vec<String>,
    /// Unit, procedure, session.
    pub identity: Vec<Field>,
    /// Paths of the recording; how many there are where they are many.
    pub recordings: String,
    /// Files with their digests.
    pub files: Vec<FileView>,
    /// True when rows must name their channel.
    pub several_channels: bool,
    /// True when rows with a limit must name their channel.
    pub several_judged: bool,
    /// True when a row has a reference value.
    pub has_references: bool,
    /// The decision rule, when all rows with a limit have the same one; empty otherwise.
    pub shared_rule: String,
    /// Where the reference values come from.
    pub references: Vec<String>,
    /// Rows with a limit.
    pub judged: Vec<Row>,
    /// How they were obtained: each method with its quantities.
    pub judged_methods: Vec<Field>,
    /// Rows without a limit.
    pub further: Vec<Row>,
    /// The same with a column for each channel, when there are several but few.
    pub by_channel: Option<Matrix>,
    /// What the rows refer to by number.
    pub footnotes: Vec<String>,
    /// Russian and Allan values side by side, per channel.
    pub comparison: Vec<Comparison>,
    /// The recording against the model of its family.
    pub explained: Option<Explained>,
    /// Conditions, integrity, window, lines, models, power, instruments, waivers, clauses.
    #[serde(flatten)]
    pub evidence: Evidence,
    /// Conditions that are declared and not shown by the recording, by name.
    pub declared: Vec<String>,
    /// Figures.
    pub figures: Vec<FigureView>,
    /// That there were figures whose data are not kept; empty otherwise.
    pub figures_missing: String,
    /// The methods appendix.
    pub methods: Vec<MethodView>,
    /// Options of the analysis.
    pub options: Vec<Field>,
    /// Line at the foot of every page.
    pub footer: String,
    /// What marks that others refer to begin with: they differ between the phases of one page.
    pub anchor: String,
    /// The phases of a test of several.
    pub phases: Vec<PhaseView>,
}

/// A file that went into the report.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FileView {
    /// What it is, in words.
    pub label: String,
    /// Path as given.
    pub path: String,
    /// SHA-256.
    pub sha256: String,
    /// Size, rows, interval, start, length; columns.
    pub details: Vec<String>,
}

/// An entry of the methods appendix.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MethodView {
    /// Title.
    pub title: String,
    /// Explanation.
    pub text: String,
    /// Formulas.
    pub formulas: Vec<String>,
    /// Source.
    pub source: String,
}

impl View {
    /// Builds the view of a record with its figures.
    pub fn new(record: &RunRecord, figures: &[Figure], lang: Lang) -> View {
        let words = Translator { lang };
        let mut footnotes = vec![];
        let (judged, further) = rows::rows(record, words, &mut footnotes);
        let several_channels = has_several_channels(&record.measurands);
        View {
            title: record
                .procedure
                .as_ref()
                .map_or_else(|| words.t("report.title_analysis"), |p| words.local(&p.title)),
            verdict: record.verdict.id(),
            verdict_word: words.verdict(record.verdict),
            summary: summary(&record.summary, &record.measurands, several_channels, words),
            contradicted: record
                .summary
                .iter()
                .filter(|n| n.id == CONTRADICTED)
                .map(|n| words.say(n))
                .collect(),
            errors: record.errors.iter().map(|n| words.say(n)).collect(),
            attempt: attempt(record, words),
            identity: identity(record, words),
            recordings: recordings(record, words),
            files: files(record, words),
            several_channels,
            several_judged: judged.iter().any(|r| judged.first().is_some_and(|f| f.channel != r.channel)),
            has_references: judged.iter().chain(&further).any(|r| !r.reference.is_empty()),
            shared_rule: match judged.first() {
                Some(first) if judged.iter().all(|r| r.rule == first.rule) => first.rule.clone(),
                _ => String::new(),
            },
            references: references(record, words),
            comparison: comparison::comparisons(record, words),
            explained: record.explained.as_ref().map(|e| Explained::new(e, lang)),
            by_channel: Matrix::new(&further),
            judged_methods: methods_of(&judged),
            judged,
            further,
            footnotes,
            declared: declared(record, words),
            evidence: Evidence::new(record, words),
            figures: select(record, figures, words),
            figures_missing: if figures.is_empty() && !record.figures.is_empty() {
                words.t("report.figures_missing")
            } else {
                String::new()
            },
            methods: methods::applicable(record)
                .map(|m| MethodView {
                    title: words.t(&format!("methods.{}.title", m.id)),
                    text: words.t(&format!("methods.{}.text", m.id)),
                    formulas: m.formulas.iter().map(|f| words.formula(f)).collect(),
                    source: words.citation(m.source),
                })
                .collect(),
            options: record
                .options
                .iter()
                .map(|o| Field { label: words.name("option", &o.name), value: option_value(&o.value, words) })
                .collect(),
            footer: footer(record, words),
            anchor: String::new(),
            phases: vec![],
        }
    }
}

/// What must be known of earlier attempts, and of the unit beside the others of its lot.
fn attempt(record: &RunRecord, words: Translator) -> Vec<String> {
    let earlier = record.attempt.iter().flat_map(|a| &a.summary);
    let others = record.siblings.iter().flat_map(|s| &s.summary);
    earlier.chain(others).map(|m| words.say(m)).collect()
}

/// Files of a recording that are named on the first page.
const NAMED_FILES: usize = 3;

/// The paths of the recording, or the first of many and their number.
fn recordings(record: &RunRecord, words: Translator) -> String {
    let paths: Vec<&str> = record.recording.iter().map(|f| f.path.as_str()).collect();
    let shown = paths.iter().take(NAMED_FILES).copied().collect::<Vec<_>>().join(", ");
    match paths.len().saturating_sub(NAMED_FILES) {
        0 => shown,
        more => {
            words.with("report.and_more", &[("shown", &shown), ("more", &count(more as u64, words.lang))])
        }
    }
}

/// Each method with the quantities that were obtained by it, in the order of the rows.
fn methods_of(rows: &[Row]) -> Vec<Field> {
    let mut out: Vec<Field> = vec![];
    for row in rows {
        match out.iter_mut().find(|f| f.label == row.method) {
            Some(known) if known.value.split("; ").any(|name| name == row.name) => {}
            Some(known) => {
                known.value.push_str("; ");
                known.value.push_str(&row.name);
            }
            None => out.push(Field { label: row.method.clone(), value: row.name.clone() }),
        }
    }
    out
}

/// True where rows belong to more channels than one, so that each must be named.
fn has_several_channels(rows: &[MeasurandRecord]) -> bool {
    rows.iter().any(|m| rows.first().is_some_and(|first| first.channel != m.channel))
}

/// Names of the conditions that are only declared, in alphabetical order.
fn declared(record: &RunRecord, words: Translator) -> Vec<String> {
    let declared = record.conditions.iter().filter(|c| c.evidence == Some(record::Evidence::Declared));
    let names = declared.map(|c| words.name("condition", c.id.split('.').next().unwrap_or(&c.id)));
    names.collect::<BTreeSet<String>>().into_iter().collect()
}

/// The reason that a check contradicts what a row rests on.
const CONTRADICTED: &str = "summary.contradicted";

/// Reasons that a record gives for a row; a report states them with their numbers.
const ROW_REASONS: [&str; 6] = [
    "summary.row_failed",
    "summary.row_failed_of",
    "summary.row_not_shown",
    "summary.row_not_shown_of",
    "summary.row_indeterminate",
    "summary.row_indeterminate_of",
];

/// The reasons for the verdict; those of rows with their numbers.
pub fn summary(
    reasons: &[Message],
    rows: &[MeasurandRecord],
    several_channels: bool,
    words: Translator,
) -> Vec<String> {
    let is_row = |id: &str| ROW_REASONS.contains(&id);
    let first_row = reasons.iter().position(|n| is_row(&n.id)).unwrap_or(reasons.len());
    let (before, after) = reasons.split_at(first_row);
    let of = |verdict: Verdict| rows.iter().filter(move |m| m.verdict == verdict);
    let rows = of(Verdict::Fail).chain(of(Verdict::Indeterminate)).filter(|m| m.objections.is_empty());
    let mut out: Vec<String> = before.iter().map(|n| words.say(n)).collect();
    if !after.is_empty() {
        out.extend(rows.filter_map(|m| rows::reason(m, several_channels, words)));
    }
    out.extend(after.iter().filter(|n| !is_row(&n.id)).map(|n| words.say(n)));
    out
}

/// The value of an option, which the result holds as it is written in a procedure.
fn option_value(value: &str, words: Translator) -> String {
    let number = |text: &str| text.parse::<f64>().ok().map(|v| limit(v, words.lang));
    let seconds = |text: &str| {
        let shown = number(text.strip_suffix(" s")?)?;
        Some(words.with("option_value.seconds", &[("value", &shown)]))
    };
    match value {
        "true" => words.t("report.yes"),
        "false" => words.t("report.no"),
        "octave" | "decade" | "all" => words.name("option_value", value),
        list => list
            .split(", ")
            .map(|part| seconds(part).or_else(|| number(part)).unwrap_or_else(|| part.to_owned()))
            .collect::<Vec<_>>()
            .join(&words.t("number.list")),
    }
}

/// Where the reference values come from, each source once with the conventions of its values.
fn references(record: &RunRecord, words: Translator) -> Vec<String> {
    let mut sources: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for r in record.measurands.iter().filter_map(|m| m.reference.as_ref()) {
        let notes = sources.entry(words.local(&r.source)).or_default();
        notes.extend(r.note.as_ref().map(|n| words.local(n)));
    }
    let said = |(source, notes): (String, BTreeSet<String>)| match notes.len() {
        0 => source,
        _ => {
            let notes: Vec<String> = notes.into_iter().collect();
            words.with("report.reference_notes", &[("source", &source), ("notes", &notes.join("; "))])
        }
    };
    sources.into_iter().map(said).collect()
}

fn identity(record: &RunRecord, words: Translator) -> Vec<Field> {
    let mut out = vec![];
    let mut put = |key: &str, value: Option<&str>| {
        if let Some(value) = value.filter(|v| !v.trim().is_empty()) {
            out.push(Field { label: words.t(key), value: value.to_owned() });
        }
    };
    let unit = &record.unit_under_test;
    let missing = words.t("report.missing");
    let expected = record.kind == RunKind::Run;
    put("report.serial", unit.serial.as_deref().or(expected.then_some(missing.as_str())));
    put("report.family", unit.family.as_ref().map(|f| words.local(f)).as_deref());
    put("report.part", unit.part.as_deref());
    put("report.part_revision", unit.revision.as_deref());
    put("report.model", unit.model.as_deref());
    put("report.lot", unit.lot.as_deref());
    put("report.build_date", unit.build_date.as_deref());
    put("report.reference_unit", unit.reference.then(|| words.t("report.yes")).as_deref());
    if let Some(p) = &record.procedure {
        let id = words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)]);
        put("report.procedure", Some(&id));
        let local = |text: &Option<LocalText>| text.as_ref().map(|t| words.local(t));
        let standard = match (local(&p.standard), local(&p.clause)) {
            (Some(s), Some(c)) => {
                Some(words.with("report.standard_clause", &[("standard", &s), ("clause", &c)]))
            }
            (s, c) => s.or(c),
        };
        put("report.standard", standard.as_deref());
        put("report.author", local(&p.author).as_deref());
        if let Some(l) = &p.limits {
            let id = words.with("report.id_revision", &[("id", &l.id), ("revision", &l.revision)]);
            put("report.limits", Some(&format!("{} ({id})", words.local(&l.title))));
            put("report.limits_source", local(&l.source).as_deref());
        }
    }
    put("report.station", record.session.station.as_deref());
    put("report.operator", record.session.operator.as_deref());
    put("report.evaluated_at", Some(&date_time(&record.session.evaluated_at)));
    put("report.program", Some(&format!("{} {}", record.program.name, record.program.version)));
    // The names of free attributes are the user's own.
    let free =
        unit.attributes.iter().map(|(name, value)| Field { label: name.clone(), value: value.clone() });
    out.extend(free);
    out
}

fn files(record: &RunRecord, words: Translator) -> Vec<FileView> {
    let lang = words.lang;
    let mut out: Vec<FileView> = record
        .recording
        .iter()
        .map(|f| {
            let mut details = vec![words.with("report.file_bytes", &[("bytes", &count(f.bytes, lang))])];
            if f.samples > 0 {
                details.extend([
                    words.with("report.file_samples", &[("samples", &count(f.samples, lang))]),
                    words.with("report.file_interval", &[("interval", &duration(f.sample_interval_s, lang))]),
                    words.with("report.file_duration", &[("duration", &duration(f.duration_s, lang))]),
                ]);
            }
            if let Some(start) = &f.start {
                details.push(words.with("report.file_start", &[("start", &date_time(start))]));
            }
            for c in &f.columns {
                let role = words.name("role", c.role.id());
                let unit = words.unit(&c.unit);
                let args = [("name", c.name.as_str()), ("role", &role), ("unit", &unit)];
                let key = if unit.is_empty() { "report.file_column_plain" } else { "report.file_column" };
                details.push(words.with(key, &args));
            }
            FileView {
                label: words.t("report.recording"),
                path: f.path.clone(),
                sha256: f.sha256.clone(),
                details,
            }
        })
        .collect();
    if let Some(p) = &record.procedure {
        let mut add = |key: &str, path: &str, sha256: &str| {
            out.push(FileView {
                label: words.t(key),
                path: path.to_owned(),
                sha256: sha256.to_owned(),
                details: vec![],
            });
        };
        add("report.procedure", &p.path, &p.sha256);
        if let Some(l) = &p.limits {
            add("report.limits", &l.path, &l.sha256);
        }
    }
    out
}

fn footer(record: &RunRecord, words: Translator) -> String {
    let mut parts = vec![];
    if let Some(serial) = &record.unit_under_test.serial {
        parts.push(words.with("report.footer_serial", &[("serial", serial)]));
    }
    if let Some(p) = &record.procedure {
        parts.push(words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)]));
    }
    parts.push(date_time(&record.session.evaluated_at));
    parts.push(format!("{} {}", record.program.name, record.program.version));
    parts.join(" · ")
}

/// A phase as the report needs it.
pub struct PhasePart<'a> {
    /// The phase in the record of the whole.
    pub phase: &'a PhaseRecord,
    /// Its own record; `None` when it was not recorded.
    pub record: Option<&'a RunRecord>,
    /// Its figures, under the names that they have in the record of the whole.
    pub figures: &'a [Figure],
}

/// One phase, printed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PhaseView {
    /// Id.
    pub id: String,
    /// Title.
    pub title: String,
    /// Id of the verdict, for colours.
    pub verdict: &'static str,
    /// The verdict in words.
    pub verdict_word: String,
    /// Why.
    pub summary: Vec<String>,
    /// Procedure with its revision, and its limits.
    pub procedure: String,
    /// Files that were read.
    pub files: Vec<String>,
    /// Folder of its own report, empty without one.
    pub folder: String,
    /// What it found; empty when it was not recorded.
    pub view: Vec<View>,
}

impl View {
    /// The view of a test of several phases.
    pub fn of_phases(record: &RunRecord, parts: &[PhasePart<'_>], lang: Lang) -> View {
        let mut whole = View::new(record, &[], lang);
        // Each phase shows its own.
        whole.figures_missing = String::new();
        whole.phases = parts.iter().map(|p| one(p, lang)).collect();
        whole
    }
}

fn one(part: &PhasePart<'_>, lang: Lang) -> PhaseView {
    let words = Translator { lang };
    let phase = part.phase;
    let procedure = phase.procedure.as_ref().map_or_else(String::new, |p| {
        let id = words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)]);
        let limits = p
            .limits
            .as_ref()
            .map(|l| words.with("report.id_revision", &[("id", &l.id), ("revision", &l.revision)]));
        limits.map_or_else(|| id.clone(), |l| format!("{id}; {l}"))
    });
    PhaseView {
        id: phase.id.clone(),
        title: words.local(&phase.title),
        verdict: phase.verdict.id(),
        verdict_word: words.verdict(phase.verdict),
        summary: summary(&phase.summary, &phase.measurands, has_several_channels(&phase.measurands), words),
        procedure,
        files: phase.recording.iter().map(|f| f.path.clone()).collect(),
        folder: phase.folder.clone().unwrap_or_default(),
        view: part
            .record
            .map(|r| {
                let own = RunRecord { figures: phase.figures.clone(), ..r.clone() };
                View { anchor: format!("{}-", phase.id), ..View::new(&own, part.figures, lang) }
            })
            .into_iter()
            .collect(),
    }
}
