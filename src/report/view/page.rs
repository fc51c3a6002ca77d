//! The page of a run, an analysis, or a test of several phases: its blocks in their order.

use super::part::{Part, Phase};
use super::{
    budget, checks, comparison, conditions, evidence, explained, faults, figures, further, instruments,
    interim, interval_means, limits, lines, models, phases, table_steps,
};
use crate::i18n::LocalText;
use crate::record::{RunKind, RunRecord};
use crate::report::methods;
use crate::report::number::{count, date_time, duration, limit};
use crate::report::page::{Block, Facts, Head, Heading, Method, Page, Reasons, State, Table, Value};
use crate::report::translator::Translator;

/// The page of a run or an analysis; of a test of several phases with those.
pub fn page(whole: &Part<'_>, phases: &[Phase<'_>]) -> Page {
    let (record, words) = (whole.record, whole.words);
    let is_judged = record.kind == RunKind::Run;
    let mut blocks = if is_judged { cover(whole, phases) } else { opening(whole) };
    if phases.is_empty() {
        blocks.extend(figures::others(whole));
        blocks.extend(if is_judged { measured(whole) } else { conventions(whole) });
        blocks.extend(shown(whole));
    } else {
        blocks.extend(phases::overview(phases, words));
    }
    for phase in phases {
        blocks.extend(phases::head(phase, words));
        if let Some(part) = &phase.part {
            blocks.extend(conditions::section(part));
            blocks.extend(figures::all(part));
            blocks.extend(measured(part));
            blocks.extend(shown(part));
        }
    }
    if !phases.is_empty() {
        blocks.extend(evidence::clauses(whole));
    }
    blocks.extend(file_table(record, words));
    blocks.push(method_list(record, words));
    let verdict = is_judged.then(|| words.verdict(record.verdict));
    let serial = record.unit_under_test.serial.clone();
    let title: Vec<String> = [Some(whole.title()), serial, verdict].into_iter().flatten().collect();
    Page {
        title: title.join(" · "),
        generator: format!("{} {}", record.program.name, record.program.version),
        footer: footer(record, words),
        blocks,
    }
}

/// The first page of a test: verdict with its reasons, identity, limits, conditions, lines to be signed. The key figure
/// stands behind it on paper, where the lines to be signed must be on the first page, and behind the reasons on a screen.
fn cover(whole: &Part<'_>, phases: &[Phase<'_>]) -> Vec<Block> {
    let (record, words) = (whole.record, whole.words);
    let mut blocks = vec![Block::Head(head(whole))];
    blocks.extend(reasons(whole));
    blocks.extend(Block::remarks(whole.attempt()));
    blocks.extend((!record.waivers.is_empty()).then(|| Block::Hint(words.t("report.waivers_below"))));
    blocks.push(identity_section(whole));
    blocks.extend(limits::limits(whole, phases));
    if phases.is_empty() {
        blocks.extend(conditions::section(whole));
    } else {
        blocks.extend(phases::conditions_met(phases, words));
    }
    blocks.extend([Block::SignOff, Block::PageEnd]);
    blocks.extend(figures::key(whole));
    vec![Block::Section("cover", blocks)]
}

/// The first page of an analysis, on which nothing is decided: numbers, then the key figure.
fn opening(whole: &Part<'_>) -> Vec<Block> {
    let errors = reasons(whole).into_iter().filter(|b| matches!(b, Block::Reasons(r) if r.id == "error"));
    let mut blocks: Vec<Block> = std::iter::once(Block::Head(head(whole))).chain(errors).collect();
    let said = whole.record.summary.iter().filter(|n| n.id != NO_LIMITS).map(|n| whole.words.say(n));
    blocks.extend(Block::remarks(said.chain(whole.attempt())));
    blocks.extend(further::further(whole));
    blocks.extend(figures::key(whole));
    blocks.extend(conditions::section(whole));
    blocks.push(identity_section(whole));
    blocks
}

/// The reason of a record without a limit, which tells nothing on a page without a verdict.
const NO_LIMITS: &str = "summary.no_limits";

pub(super) fn identity_section(whole: &Part<'_>) -> Block {
    let identity = Block::identity(identity(whole.record, whole.words));
    Block::section("identity", whole.words.t("report.identity"), vec![identity])
}

fn head(whole: &Part<'_>) -> Head {
    let (record, words) = (whole.record, whole.words);
    let kind = if record.kind == RunKind::Run { "report.kind_run" } else { "report.kind_analyze" };
    Head {
        kind: self::kind(record, &words.t(kind), words),
        title: whole.title(),
        is_signed: true,
        label: words.t("report.verdict"),
        verdict: if record.kind == RunKind::Run {
            State { id: record.verdict.id().to_owned(), word: words.verdict(record.verdict) }
        } else {
            State::default()
        },
        ..Head::default()
    }
}

/// Kind of a document, behind the organisation and before the number of the protocol where they are stated.
pub(super) fn kind(record: &RunRecord, kind: &str, words: Translator) -> String {
    let organisation = record.procedure.as_ref().and_then(|p| p.organisation.as_ref());
    let number = record.session.protocol.as_ref();
    let numbered = number.map(|n| words.with("report.protocol_number", &[("number", n)]));
    let kind = [organisation.map(|o| words.local(o)), Some(kind.to_owned()), numbered];
    kind.into_iter().flatten().collect::<Vec<_>>().join(" · ")
}

/// Errors, then the reasons for the verdict.
fn reasons(whole: &Part<'_>) -> Vec<Block> {
    let words = whole.words;
    let both = [
        ("error", "report.errors", whole.errors()),
        (whole.record.verdict.id(), "report.reasons", whole.summary()),
    ];
    let block = |(id, key, sentences): (&str, &str, Vec<String>)| {
        let (id, heading) = (id.to_owned(), words.t(key));
        Block::Reasons(Reasons { class: "reasons", id, heading, sentences, ..Reasons::default() })
    };
    both.into_iter().filter(|(_, _, sentences)| !sentences.is_empty()).map(block).collect()
}

/// Methods of the quantities with a limit, and the quantities without one.
fn measured(part: &Part<'_>) -> Vec<Block> {
    let mut blocks = limits::methods(part);
    blocks.extend(further::further(part));
    blocks.extend(conventions(part));
    blocks
}

/// Where reference values come from, and values by both conventions side by side.
fn conventions(part: &Part<'_>) -> Vec<Block> {
    further::references(part).into_iter().chain(comparison::section(part)).collect()
}

/// What the verdict rests on.
fn shown(part: &Part<'_>) -> Vec<Block> {
    let sections: [fn(&Part<'_>) -> Vec<Block>; 15] = [
        interim::section,
        explained::section,
        conditions::remarks,
        checks::section,
        instruments::section,
        faults::section,
        evidence::window,
        interval_means::section,
        table_steps::section,
        lines::section,
        models::section,
        budget::section,
        evidence::power,
        evidence::waivers,
        evidence::clauses,
    ];
    sections.iter().flat_map(|section| section(part)).collect()
}

/// The methods appendix, and the options of the analysis.
fn method_list(record: &RunRecord, words: Translator) -> Block {
    let method = |m: methods::Method| {
        Block::Method(Method {
            title: words.t(&format!("methods.{}.title", m.id)),
            formulas: m.formulas.iter().map(|f| words.formula(f)).collect(),
            text: words.t(&format!("methods.{}.text", m.id)),
            source: words.citation(m.source),
        })
    };
    let mut below: Vec<Block> = methods::applicable(record).map(method).collect();
    if !record.options.is_empty() {
        let options = record.options.iter();
        let rows = options
            .map(|o| (words.name("option", &o.name).into(), option_value(&o.value, words).into()))
            .collect();
        below.push(Block::subheading(words.t("report.options")));
        below.push(Block::Facts(Facts { class: "options", rows }));
    }
    let heading = Heading { level: 2, text: words.t("report.methods").into(), verdict: None };
    Block::Section("methods", vec![Block::Fold(heading, below)])
}

pub(super) fn file_table(record: &RunRecord, words: Translator) -> Vec<Block> {
    let files = files(record, words);
    if files.is_empty() {
        return vec![];
    }
    let column = |i: usize| files.iter().filter_map(move |f| f.get(i).cloned());
    let table = Table::new("files", files.len())
        .column(words.column("report.file"), column(0))
        .column(words.column("report.path"), column(1))
        .column(words.column("report.sha256").class("digest"), column(2));
    vec![Block::section("", words.t("report.files"), vec![Block::Table(table)])]
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
        "octave" | "decade" | "all" | "linear" | "quadratic" | "linear_quadratic" | "on_off" => {
            words.name("option_value", value)
        }
        list => list
            .split(", ")
            .map(|part| seconds(part).or_else(|| number(part)).unwrap_or_else(|| part.to_owned()))
            .collect::<Vec<_>>()
            .join(&words.t("number.list")),
    }
}

/// Unit, procedure, session: label and value.
fn identity(record: &RunRecord, words: Translator) -> Vec<(String, String)> {
    let mut out = vec![];
    let mut put = |key: &str, value: Option<&str>| {
        if let Some(value) = value.filter(|v| !v.trim().is_empty()) {
            out.push((words.t(key), value.to_owned()));
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
    put("report.protocol", record.session.protocol.as_deref());
    let place = record.procedure.as_ref().and_then(|p| p.place.as_ref());
    put("report.place", place.map(|text| words.local(text)).as_deref());
    put(
        "report.tested_at",
        record.recording.first().and_then(|f| f.start.as_deref()).map(date_time).as_deref(),
    );
    put("report.station", record.session.station.as_deref());
    put("report.operator", record.session.operator.as_deref());
    put("report.evaluated_at", Some(&date_time(&record.session.evaluated_at)));
    put("report.program", Some(&format!("{} {}", record.program.name, record.program.version)));
    // The names of free attributes are the user's own.
    out.extend(unit.attributes.iter().map(|(name, value)| (name.clone(), value.clone())));
    out.push((words.t("report.recording"), recordings(record, words)));
    out
}

/// The files of a recording, of the procedure and of its limits: label, path with details, SHA-256.
fn files(record: &RunRecord, words: Translator) -> Vec<[Value; 3]> {
    let lang = words.lang;
    let file = |key: &str, path: &str, sha256: &str, details: Vec<String>| {
        let path = Value::from(path).over([Value::Text(details.join(" · "))]);
        [words.t(key).into(), path, sha256.into()]
    };
    let mut out: Vec<[Value; 3]> = record
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
            file("report.recording", &f.path, &f.sha256, details)
        })
        .collect();
    if let Some(p) = &record.procedure {
        out.push(file("report.procedure", &p.path, &p.sha256, vec![]));
        out.extend(p.limits.as_ref().map(|l| file("report.limits", &l.path, &l.sha256, vec![])));
    }
    out
}

/// Line at the foot of every page.
pub(super) fn footer(record: &RunRecord, words: Translator) -> String {
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
