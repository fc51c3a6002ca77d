//! The view: the run record as words and printed numbers, ready for a template.
//!
//! Everything a template shows by default is a string here, so that HTML and Markdown cannot differ and no template
//! computes. The record itself is handed to the templates as well, for those that users write.

mod checks;
mod comparison;
mod conditions;
mod deviations;
mod evidence;
mod explained;
mod faults;
mod figures;
mod goodness;
mod interval_means;
mod matrix;
mod phase;
mod rows;
mod table_steps;

pub use comparison::{Comparison, Pair, Side};
pub use conditions::Condition;
pub use deviations::{DeviationCell, DeviationRow, Deviations};
pub use evidence::{Clause, Evidence, Excluded, Instrument, Line, Model, ModelRemark, Power, Waiver};
pub use explained::Explained;
pub use faults::{Fault, FaultKind, Faults};
pub use figures::FigureView;
pub(crate) use figures::caption;
use figures::drawn;
pub use goodness::Goodness;
pub use interval_means::{IntervalMean, IntervalMeans};
pub use matrix::{Matrix, MatrixRow};
pub use phase::{PhasePart, PhaseView};
pub use rows::Row;
pub use table_steps::{TableStep, TableSteps};

use crate::estimate::Verdict;
use crate::figure::Figure;
use crate::i18n;
use crate::i18n::{Arg, Lang, Localize, Note, fill, lookup};
use crate::record::{RunKind, RunRecord};
use crate::report::number::{count, date_time, duration, limit};
use crate::report::{methods, unit};
use serde::Serialize;

/// A label and what stands beside it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Field {
    /// Label, in words.
    pub label: String,
    /// Value, printed.
    pub value: String,
}

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
    /// Errors, first of all when there are any.
    pub errors: Vec<String>,
    /// Unit, procedure, session.
    pub identity: Vec<Field>,
    /// Files with their digests.
    pub files: Vec<FileView>,
    /// True when rows must name their channel.
    pub several_channels: bool,
    /// True when a row has a reference value.
    pub has_references: bool,
    /// The decision rule, when all rows with a limit have the same one; empty otherwise.
    pub shared_rule: String,
    /// Where the reference values come from.
    pub references: Vec<String>,
    /// Rows with a limit.
    pub judged: Vec<rows::Row>,
    /// Rows without a limit.
    pub further: Vec<rows::Row>,
    /// The same with a column for each channel, when there are several but few.
    pub by_channel: Option<Matrix>,
    /// What the rows refer to by number.
    pub footnotes: Vec<String>,
    /// Russian and Allan values side by side, per channel.
    pub comparison: Vec<comparison::Comparison>,
    /// The recording against the model of its family.
    pub explained: Option<Explained>,
    /// Conditions, integrity, window, lines, models, power, instruments, waivers, clauses.
    #[serde(flatten)]
    pub evidence: evidence::Evidence,
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
    pub phases: Vec<phase::PhaseView>,
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
    pub source: &'static str,
}

/// The words of a language.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Words {
    pub lang: Lang,
}

impl Words {
    /// The text of a key; the key itself, so that it is noticed, when the table lacks it.
    pub fn t(self, key: &str) -> String {
        lookup(self.lang, key).unwrap_or(key).to_owned()
    }

    /// The text of `prefix.id`; a readable form of the id when the table lacks it.
    pub fn name(self, prefix: &str, id: &str) -> String {
        lookup(self.lang, &format!("{prefix}.{id}")).map_or_else(|| id.replace('_', " "), str::to_owned)
    }

    /// The text of a key with its places filled.
    pub fn with(self, key: &str, args: &[(&str, &str)]) -> String {
        fill(lookup(self.lang, key).unwrap_or(key), |name| {
            args.iter().find(|a| a.0 == name).map(|a| a.1.to_owned())
        })
    }

    /// A note with printed numbers.
    pub fn say(self, note: &Note) -> String {
        fill(lookup(self.lang, &note.id).unwrap_or(&note.id), |name| {
            note.args.get(name).map(|arg| match arg {
                Arg::Number(v) => super::number::limit_digits(*v, 4, self.lang),
                Arg::Stated(v) => super::number::limit(*v, self.lang),
                Arg::Count(v) => count(*v, self.lang),
                Arg::Text(t) => t.clone(),
                Arg::Key(k) => i18n::words(k, self.lang),
                Arg::Note(n) => self.say(n),
                Arg::Decimals { .. } | Arg::Several(..) => arg.say(self.lang),
                Arg::Figures { value, digits, zeros: true } => {
                    super::number::digits(*value, *digits, self.lang)
                }
                Arg::Figures { value, digits, zeros: false } => {
                    super::number::limit_digits(*value, *digits, self.lang)
                }
            })
        })
    }

    /// A formula with the decimal mark of the language.
    pub fn formula(self, text: &str) -> String {
        let mark = lookup(self.lang, "number.decimal").unwrap_or(".");
        let chars: Vec<char> = text.chars().collect();
        let mut out = String::with_capacity(text.len());
        for (i, c) in chars.iter().enumerate() {
            let figure = |at: Option<usize>| at.and_then(|i| chars.get(i)).is_some_and(char::is_ascii_digit);
            if *c == '.' && figure(i.checked_sub(1)) && figure(Some(i + 1)) {
                out.push_str(mark);
            } else {
                out.push(*c);
            }
        }
        out
    }

    pub fn unit(self, text: &str) -> String {
        unit::pretty(text, self.lang)
    }

    /// A printed number with its unit.
    pub fn quantity(self, number: &str, unit: &str) -> String {
        let unit = self.unit(unit);
        match unit.as_str() {
            "" => number.to_owned(),
            // Degrees, minutes and seconds of arc stand at the figure.
            "°" | "′" | "″" => format!("{number}{unit}"),
            _ => format!("{number}\u{202f}{unit}"),
        }
    }
}

impl View {
    /// Builds the view of a record with its figures.
    pub fn new(record: &RunRecord, figures: &[Figure], lang: Lang) -> View {
        let words = Words { lang };
        let mut footnotes = vec![];
        let (judged, further) = rows::rows(record, words, &mut footnotes);
        let channels: std::collections::BTreeSet<&str> =
            record.measurands.iter().map(|m| m.channel.as_str()).collect();
        View {
            title: record
                .procedure
                .as_ref()
                .map_or_else(|| words.t("report.title_analysis"), |p| p.title.clone()),
            verdict: record.verdict.id(),
            verdict_word: words.name("verdict", record.verdict.id()),
            summary: record.summary.iter().map(|n| words.say(n)).collect(),
            errors: record.errors.iter().map(|n| words.say(n)).collect(),
            identity: identity(record, words),
            files: files(record, words),
            several_channels: channels.len() > 1,
            has_references: judged.iter().chain(&further).any(|r| !r.reference.is_empty()),
            shared_rule: match judged.first() {
                Some(first) if judged.iter().all(|r| r.rule == first.rule) => first.rule.clone(),
                _ => String::new(),
            },
            references: record
                .measurands
                .iter()
                .filter_map(|m| m.reference.as_ref())
                .map(|r| r.source.clone())
                .collect::<std::collections::BTreeSet<String>>()
                .into_iter()
                .collect(),
            comparison: comparison::comparisons(record, words),
            explained: record.explained.as_ref().map(|e| Explained::new(e, lang)),
            by_channel: Matrix::new(&further),
            judged,
            further,
            footnotes,
            evidence: evidence::Evidence::new(record, words),
            figures: drawn(record, figures, words),
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
                    source: m.source,
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

/// The value of an option, which the result holds as it is written in a procedure.
fn option_value(value: &str, words: Words) -> String {
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

fn identity(record: &RunRecord, words: Words) -> Vec<Field> {
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
    put("report.family", unit.family.as_deref());
    put("report.part", unit.part.as_deref());
    put("report.part_revision", unit.revision.as_deref());
    put("report.lot", unit.lot.as_deref());
    if let Some(p) = &record.procedure {
        let id = words.with("report.id_revision", &[("id", &p.id), ("revision", &p.revision)]);
        put("report.procedure", Some(&id));
        let standard = match (&p.standard, &p.clause) {
            (Some(s), Some(c)) => {
                Some(words.with("report.standard_clause", &[("standard", s), ("clause", c)]))
            }
            (s, c) => s.clone().or_else(|| c.clone()),
        };
        put("report.standard", standard.as_deref());
        put("report.author", p.author.as_deref());
        if let Some(l) = &p.limits {
            let id = words.with("report.id_revision", &[("id", &l.id), ("revision", &l.revision)]);
            put("report.limits", Some(&format!("{} ({id})", l.title)));
            put("report.limits_source", l.source.as_deref());
        }
    }
    put("report.station", record.session.station.as_deref());
    put("report.operator", record.session.operator.as_deref());
    put("report.evaluated_at", Some(&date_time(&record.session.evaluated_at)));
    put("report.program", Some(&format!("{} {}", record.program.name, record.program.version)));
    out
}

fn files(record: &RunRecord, words: Words) -> Vec<FileView> {
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
                let role = words.name("role", &c.role);
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

fn footer(record: &RunRecord, words: Words) -> String {
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

/// The word of a verdict.
pub(crate) fn verdict_word(verdict: Verdict, words: Words) -> String {
    words.name("verdict", verdict.id())
}
