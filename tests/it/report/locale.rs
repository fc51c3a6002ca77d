//! Every word of a report stands in the locale tables: none is missing, none idle.

use crate::report::fixture;
use sagnac::effect::{self, Domain, EFFECTS, find};
use sagnac::i18n::{EffectText, Lang, effect_text, table};
use sagnac::measurand::MEASURANDS;
use sagnac::report::render::TEMPLATES;
use sagnac::report::{Renderer, render_html, render_markdown};
use std::collections::BTreeSet;
use std::path::Path;

/// Ids that a record may hold where its documentation lists them.
const LISTED: &[(&str, &[&str])] = &[
    ("day", &["hook.pending", "hook.told"]),
    ("interim", &["state.cannot_pass", "state.decided", "state.open", "state.undecided"]),
    ("rehearsal", &["from.expected", "from.limit", "from.model", "from.nothing"]),
    ("signer", &["approved", "reviewed", "tested"]),
    (
        "prove",
        &[
            "outcome.fails",
            "outcome.holds",
            "short.concealed",
            "short.unveiled",
            "step.claim",
            "step.concealed",
            "step.explained",
            "step.explained_again",
            "step.shown",
            "step.unveiled",
            "summary.fails",
            "summary.holds",
        ],
    ),
    (
        "terminal_column",
        &[
            "effect",
            "interval",
            "limit",
            "margin",
            "met",
            "noticed_from",
            "parameter",
            "phase",
            "place",
            "quantity",
            "read",
            "recording",
            "unit",
            "value",
            "unit_of_quantity",
            "verdict",
        ],
    ),
    (
        "fault",
        &[
            "gap",
            "duplicate_timestamp",
            "backward_timestamp",
            "non_finite",
            "unparsable",
            "outlier",
            "saturated",
            "stuck",
            "repeated",
            "interpolated",
            "rollover",
            "timestamp_disagreement",
        ],
    ),
    ("excluded", &["warm_up", "declared", "gap", "pause"]),
    ("clause", &["here", "elsewhere", "not_applicable", "not_done", "partly"]),
    // The inputs that distinguish a result from another.
    (
        "output_error",
        &[
            "input.explanation",
            "input.recording",
            "input.procedure",
            "input.limits",
            "input.layout",
            "input.model",
            "input.simulation",
            "input.unit",
            "input.unit_data",
            "input.options",
            "input.results",
        ],
    ),
    ("serial_from", &["manifest", "recording", "pattern", "file_name"]),
    ("status", &["ok", "remark", "invalid"]),
    ("calibration", &["ok", "remark", "invalid", "overdue", "unknown", "unidentified"]),
    // Of each channel: the id goes on with its name.
    ("condition", &["steadiness", "influence_beside"]),
    ("verdict", &["none", "pass", "indeterminate", "fail", "error"]),
];

/// Tables whose ids come from other parts of the program: a key is in use when its id stands in a source file.
const OPEN: &[&str] = &[
    "how",
    "check_name",
    "evidence",
    "compared",
    "condition",
    "observed",
    "option",
    "role",
    "term",
    "unit",
    "convention",
    "table_doc",
    "option_value",
    "explain.columns",
    "explain.law",
    "explain.noticeable",
    "explain.shape",
    "explain.test",
    "signatory",
    "stated",
    "goodness.view",
    "compare.column",
    "criticism",
    "budget.common_name",
    "budget.input",
    "budget.law_name",
    "budget.source_name",
    "datasheet.column",
    "datasheet.customer.column",
    "datasheet.condition",
    "datasheet.method",
    "history.column",
    "history.control",
    "history.kind",
    "history.rule",
    "laboratories.agreement",
    "laboratories.kind",
    "transfer_order",
];

/// Dotted names in the sources that only look like keys: tables of procedures.
const NO_KEYS: &[&str] = &[
    "attempt.earlier.result",
    "attempt.number",
    "budget.common_name",
    "budget.input",
    "budget.law_name",
    "budget.source_name",
    "datasheet.column",
    "datasheet.condition",
    "datasheet.method",
    "day.hook",
    "explain.columns",
    "explain.law",
    "explain.noticeable",
    "explain.shape",
    "explain.test",
    "explain.view",
    "history.column",
    "history.control",
    "history.kind",
    "history.rule",
    "interim.state",
    "laboratories.agreement",
    "laboratories.kind",
    "measurand.options",
    "note.withheld",
    "program.returns",
    "rehearsal.from",
    "unit.attribute",
    "unit.rec",
];

fn sources(folder: &Path, out: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(std::fs::read_to_string(&path).unwrap());
        }
    }
}

/// Every text between a pair of quotation marks on one line.
fn quoted(text: &str, mark: char) -> impl Iterator<Item = &str> {
    text.lines().flat_map(move |line| line.split(mark).skip(1).step_by(2))
}

fn is_key(text: &str, tables: &BTreeSet<String>) -> bool {
    let file = [".html", ".md", ".css", ".toml", ".json", ".csv", ".svg", ".xml", ".parquet"]
        .iter()
        .any(|e| text.ends_with(e));
    let plain = text.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '.');
    let first = text.split('.').next().unwrap_or_default();
    plain && !file && text.contains('.') && !text.ends_with('.') && tables.contains(first)
}

/// The keys of the notes that a source makes, tests left out.
fn keys_of_notes(text: &str) -> impl Iterator<Item = &str> {
    let product = text.split("#[cfg(test)]\nmod tests").next().unwrap_or(text);
    let made = ["note!(", "Note::new("].into_iter().flat_map(|call| product.split(call).skip(1));
    made.filter_map(|rest| rest.trim_start().strip_prefix('"')?.split('"').next())
}

/// All keys that templates and sources name in full, and all short texts of the sources.
fn used() -> (BTreeSet<String>, BTreeSet<String>) {
    let tables: BTreeSet<String> =
        table(Lang::En).keys().filter_map(|k| k.split('.').next()).map(str::to_owned).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut code = vec![];
    for folder in [
        "src",
        "crates/sagnac-base/src",
        "crates/sagnac-bench/src",
        "crates/sagnac-core/src",
        "crates/sagnac-explain/src",
        "crates/sagnac-ingest/src",
        "crates/sagnac-noise/src",
    ] {
        sources(&root.join(folder), &mut code);
    }
    let mut fixtures = vec![];
    sources(&root.join("tests/it/report/fixture"), &mut fixtures);
    let mut keys = BTreeSet::new();
    for text in &code {
        keys.extend(keys_of_notes(text).map(str::to_owned));
        keys.extend(quoted(text, '"').filter(|k| is_key(k, &tables)).map(str::to_owned));
    }
    for (_, text) in TEMPLATES {
        for mark in ['"', '\''] {
            keys.extend(quoted(text, mark).filter(|k| is_key(k, &tables)).map(str::to_owned));
        }
    }
    let words = code
        .iter()
        .chain(&fixtures)
        .flat_map(|t| quoted(t, '"'))
        .flat_map(|t| t.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.')))
        .map(str::to_owned)
        .collect();
    (keys, words)
}

#[test]
fn no_key_is_missing() {
    let (keys, _) = used();
    assert!(keys.len() > 100, "the search for keys found only {}", keys.len());
    let known = table(Lang::En);
    let missing: Vec<&String> =
        keys.iter().filter(|k| !known.contains_key(*k) && !NO_KEYS.contains(&k.as_str())).collect();
    assert!(missing.is_empty(), "not in the table: {missing:?}");
    for (prefix, ids) in LISTED {
        for id in *ids {
            assert!(known.contains_key(&format!("{prefix}.{id}")), "{prefix}.{id}");
        }
    }
}

#[test]
fn no_key_is_idle() {
    let (keys, words) = used();
    let idle: Vec<&String> = table(Lang::En)
        .keys()
        .filter(|key| {
            let Some((prefix, id)) = key.split_once('.') else { return true };
            let listed = LISTED.iter().any(|(p, ids)| *p == prefix && ids.contains(&id));
            let measurand = prefix == "measurand" && MEASURANDS.iter().any(|m| m.id == id);
            let open = OPEN.iter().any(|p| {
                key.strip_prefix(p).and_then(|k| k.strip_prefix('.')).is_some_and(|id| words.contains(id))
            });
            // Built from the ids of the methods and of the figures.
            let built = (prefix == "methods"
                && sagnac::report::methods::all()
                    .any(|m| id == format!("{}.title", m.id) || id == format!("{}.text", m.id)))
                || (key.starts_with("figure.") && words.contains(key.as_str()))
                || key.strip_prefix("figure.legend.").is_some_and(|term| words.contains(term))
                || (key.starts_with("axis.") && words.contains(key.as_str()))
                || key
                    .strip_prefix("figure.caption.")
                    .is_some_and(|f| words.contains(&format!("figure.title.{f}")));
            let effects = of_effects(key);
            !(keys.contains(*key) || listed || measurand || open || built || effects)
        })
        .collect();
    assert!(idle.is_empty(), "in the table, but nothing uses them: {idle:?}");
}

/// True for a key that the catalogue of effects asks for: the texts of an effect, the names of its parameters, the views.
fn of_effects(key: &str) -> bool {
    let Some((table, id)) = key.rsplit_once('.') else { return false };
    if let Some(kind) = table.strip_prefix("effect.") {
        return find(kind).is_some() && EffectText::ALL.iter().any(|t| t.id() == id);
    }
    match table {
        "parameter" => id == "rms_deg_h" || effect::parameter(id).is_some(),
        "effect_view" | "explain.view" | "explain.where" => Domain::of_id(id).is_some(),
        _ => false,
    }
}

#[test]
fn every_effect_has_every_text_in_every_language() {
    let cyrillic = |text: &str| text.chars().any(|c| ('а'..='я').contains(&c));
    let signs = ["cos", "sin", "exp", "sgn", "max", "ref"];
    let english = |text: &str| {
        let mut runs = text.split(|c: char| !c.is_ascii_lowercase());
        runs.any(|run| run.len() > 2 && !signs.contains(&run))
    };
    for kind in EFFECTS.iter().map(|e| e.kind()) {
        for text in EffectText::ALL {
            let key = format!("effect.{kind}.{}", text.id());
            let [en, ru] = [Lang::En, Lang::Ru].map(|lang| table(lang).get(&key).map_or("", String::as_str));
            assert!(!en.is_empty() && !ru.is_empty(), "{key} is missing in a language");
            assert_eq!(effect_text(kind, *text, Lang::Ru), ru);
            assert!(!cyrillic(en), "{key}: {en}");
            match text {
                EffectText::Formula => assert!(!english(ru), "{key}: {ru}"),
                EffectText::Source => {}
                _ => assert!(en.len() > 3 && cyrillic(ru), "{key}: {ru}"),
            }
        }
        let english = |text| effect_text(kind, text, Lang::En);
        assert!(!english(EffectText::Title).ends_with('.'), "{kind}");
        assert!(english(EffectText::Mechanism).ends_with('.'), "{kind}");
    }
}

#[test]
fn every_parameter_that_reports_show_has_a_name_and_every_domain_a_phrase() {
    for param in EFFECTS.iter().flat_map(|e| e.params()).filter(|p| p.reported) {
        let key = format!("parameter.{}", param.name);
        assert!(Lang::ALL.iter().all(|lang| table(*lang).contains_key(&key)), "{key}");
    }
    for domain in Domain::ALL {
        for prefix in ["effect_view", "explain.view", "explain.where"] {
            let key = format!("{prefix}.{}", domain.id());
            assert!(Lang::ALL.iter().all(|lang| table(*lang).contains_key(&key)), "{key}");
        }
    }
}

#[test]
fn no_report_shows_a_key() {
    let tables: BTreeSet<String> =
        table(Lang::En).keys().filter_map(|k| k.split('.').next()).map(str::to_owned).collect();
    for record in [fixture::pass(), fixture::three_channels(), fixture::error(), fixture::analysis()] {
        let figures = fixture::figures::all();
        for text in [
            render_html(&record, &figures, Lang::En, &Renderer::new()).unwrap(),
            render_markdown(&record, &figures, Lang::En, &Renderer::new()).unwrap(),
        ] {
            // Names of the script of the page are no words for a reader.
            let script = text.split_once("<script>").and_then(|(_, rest)| rest.split_once("</script>"));
            let text = script.map_or_else(|| text.clone(), |(script, _)| text.replace(script, ""));
            let shown: Vec<&str> = text
                .split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.'))
                .map(|w| w.trim_end_matches('.'))
                .filter(|w| is_key(w, &tables))
                .collect();
            assert!(shown.is_empty(), "{shown:?}");
        }
    }
}
