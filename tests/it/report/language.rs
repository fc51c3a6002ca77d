//! The tables of words against one another, and what the program says in Russian.

use crate::report::russian::sentences;
use crate::support::corpus::{cases, problems};
use crate::support::shared::{shared, tested_once};
use crate::support::{limits, procedure, sample};
use sagnac::config::procedure::{parse_limits, parse_procedure};
use sagnac::i18n::{Lang, Localize, table};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Latin words that stand in Russian sentences: names of formats, options, units of files, keys of procedures, symbols
/// and names of standards. What stands between backticks or double quotes, or in square brackets, is the user's or a
/// file's and is not looked at.
const LATIN: &[&str] = &[
    // Verbs, options and their words.
    "Ctrl",
    "follow",
    "inspect",
    "length",
    "port",
    "behind",
    "proxy",
    "https",
    "bench",
    "example",
    "com",
    "ZIP",
    "recordings",
    "HOST",
    "PORT",
    "allow",
    "root",
    "proof",
    "approved",
    "dcc",
    "key",
    "laboratory",
    "name",
    "pages",
    "pdf",
    "quiet",
    "reason",
    "reviewed",
    "sign",
    "tested",
    "to",
    "waive",
    // Names of keys and files of signatures, and of a quantity.
    "Ed",
    "OpenSSH",
    "SUMS",
    "ed",
    "instability",
    "lead",
    "pub",
    "ssh",
    // Symbols of formulas.
    "c",
    "cargo",
    "k",
    "w",
    "dT",
    "dt",
    // Formats, encodings, and programs.
    "CSV",
    "Parquet",
    "TOML",
    "JSON",
    "Schema",
    "SHA",
    "UTF",
    "PDF",
    "ASCII",
    "DAQmx",
    "LabVIEW",
    "Latin",
    "MCAP",
    "Python",
    "ArduPilot",
    "Gazebo",
    "Kalibr",
    "MATLAB",
    "NaveGo",
    "PX",
    "VINS",
    "ROS",
    "SQLite",
    "TDMS",
    "deflate",
    "HDF",
    "NumPy",
    "gzip",
    "zstd",
    "snappy",
    "gz",
    "GPS",
    "UTC",
    "Z",
    "zip",
    "z",
    "bzip",
    "xz",
    "sagnac",
    "result",
    "json",
    "NaN",
    "true",
    "false", // Standards and people.
    "NIST",
    "SP",
    "IEEE",
    "Std",
    "ISO",
    "SEMATECH",
    "JCGM",
    // Formats, programs and makers of files.
    "Arrow",
    "Feather",
    "Avro",
    "DataFlash",
    "MDF",
    "NetCDF",
    "NovAtel",
    "pickle",
    "RAR",
    "blox",
    "WAV",
    "AVI",
    "Xsens",
    "RAWIMU",
    "ULog",
    "datenum",
    "Windows",
    "NET",
    "Unix",
    // Options, paths of examples, words of procedures.
    "counter",
    "none",
    "time",
    "rows",
    "ms",
    "us",
    "ns",
    "d",
    "rate",
    "sample",
    "out",
    "force",
    "serial",
    "unit",
    "data",
    "build",
    "date",
    "reference",
    "store",
    "SAGNAC",
    "STORE",
    "common",
    "yes",
    "no",
    "warm",
    "up",
    "limits",
    "operator",
    "help",
    "octave",
    "decade",
    "all",
    "id",
    "role",
    "min",
    "max",
    "abs",
    "factor",
    "scale",
    "calibration",
    "due",
    "duration",
    "minimum",
    "latitude",
    "elevation",
    "options",
    "earth",
    "heading",
    "format",
    "table",
    "deg",
    "rad",
    "h",
    "s",
    "sqrt",
    "arcsec",
    "count",
    "degC",
    "run",
    "check",
    "procedures",
    "static",
    "bias",
    "toml",
    "recording",
    "csv",
    "SN",
    "reports",
    "templates",
    "x",
    "simulate",
    "simulated",
    "model",
    "effects",
    "comparison",
    "ru",
    "V",
    "y",
    "g",
    // Symbols.
    "ARW",
    "RRW",
    "Cp",
    "Cpk",
    "N",
    "B",
    "K",
    "R",
    "Q",
    "T",
    "TL",
    "S",
    "M",
    "I",
    "G",
    "A",
    "E",
    "Ci",
    "C",
    "L",
    "f",
    "n",
    "p",
    "r",
    "m",
    "u",
    "t",
    "BIC",
    "ln",
    "P",
    "explain",
    "temp",
    "ADAPT",
    "CI",
    "each",
    "once",
    "from",
    "index",
    "init",
    "join",
    "lot",
    "alternatives",
    "plan",
    "schedule",
    "joint",
    "engineer",
    "customer",
    "sigma",
    "tau",
    "source",
    "offset",
    // Units of a width, and programs that turn one picture into another.
    "mm",
    "cm",
    "in",
    "ppm",
    "SVG",
    "Inkscape",
    // Symbols of formulas.
    "FS",
    "H",
    "O",
    "D",
    "U",
    "a",
    "e",
    "F",
    "station",
];

/// Prefixes of translations that have their English text for a key: of the help and of the comments that `init` writes. The command
/// and the templates hold the English, and their tests compare the two.
const KEYED_BY_ENGLISH: [&str; 2] = ["help_text.", "init_comment."];

/// The English text of a key that is one.
fn english_of_key(key: &str) -> Option<&str> {
    KEYED_BY_ENGLISH.iter().find_map(|prefix| key.strip_prefix(prefix))
}

/// Entries that are the same in both languages: symbols, names and sentences that are arguments only.
const SAME: &[&str] = &[
    "laboratories.en",
    "laboratories.expanded",
    "report.of_channel",
    "follow.row",
    "follow.row_state",
    "follow.value",
    "interim.span",
    "acceleration.deviation",
    "figure.legend.minus_90",
    "figure_paper.axis_times_root",
    "budget.law_name.chi_square",
    "budget.whole",
    "time_scale.parts",
    "watch.unreadable",
    "signer.quantity",
    "verify.of_unit",
    "prove.found.named",
    "prove.found.place",
    "prove.found.share",
    "prove.found.value",
    "explain.error.of_recording",
    "history.column.cp",
    "history.column.cpk",
    "history.index",
    "store_finding.unreadable",
    "explain.noticeable.at",
    "explain.noticeable.beyond",
    "explain.noticeable.parameter",
    "figure_influence.axis_name",
    "figure_positions.name",
    "figure_polar.angle",
    "compare.more.fault",
    "phases.verdict",
    "phases.failed",
    "phases.error",
    "ingest.parts.and",
    "ingest.raw.hint.help",
    "ingest.raw.problem",
    "time_base.fault_in",
    "report.sha256",
    "report.excluded_because",
    "report.reference_notes",
    "report.at_least",
    "report.at_most",
    "report.interval",
    "report.unit_coverage",
    "unit.degC",
    "unit.g",
    "inspect.fault_row",
    "inspect.fault_of",
    "inspect.of_column",
    "fault_note.no_place",
    "summary.condition_invalid",
    "system.other",
    "keyed.kind.quoted",
    "ingest_error.",
    "template_error.io",
    "term.",
    "note.required.held",
    "selftest.from.sp1065",
    "selftest.from.iso_14253",
    "inspect.unit_guessed",
    "dimension.power",
    "cli.of_option",
    "number.group",
    "compare.label",
    "compare.column.sigma100",
    "compare.column.n_allan",
    "compare.column.six_n",
    "compare.column.over_six_n",
    "compare.column.steep",
    "explain.column.delta_bic",
    "explain.column.gain",
    "explain.column.p",
    "explain.fit.bic",
    "explain.fit.log_likelihood",
    "explain.plus_minus",
    "explain.with_interval",
    "reason.with_interval",
    "terminal.condition_plain",
];

fn places(text: &str) -> BTreeSet<String> {
    text.split('{').skip(1).filter_map(|p| p.split_once('}')).map(|p| p.0.to_owned()).collect()
}

fn is_cyrillic(c: char) -> bool {
    matches!(c, 'а'..='я' | 'А'..='Я' | 'ё' | 'Ё')
}

/// The text without what is quoted, in brackets of TOML, or an argument.
fn prose(text: &str) -> String {
    let mut out = String::new();
    let mut until = None;
    for c in text.chars() {
        match (until, c) {
            (Some(end), c) if c == end => until = None,
            (Some(_), _) => {}
            (None, '`') => until = Some('`'),
            (None, '"') => until = Some('"'),
            (None, '{') => until = Some('}'),
            (None, '[') => until = Some(']'),
            (None, c) => out.push(c),
        }
    }
    out
}

/// Words of Latin letters in a prose that the list does not know.
fn strangers(text: &str) -> Vec<String> {
    let words = text.split(|c: char| !(c.is_ascii_alphabetic() || is_cyrillic(c)));
    let latin = words.filter(|w| w.chars().any(|c| c.is_ascii_alphabetic()));
    latin.filter(|w| !LATIN.contains(w)).map(str::to_owned).collect()
}

#[test]
fn both_tables_have_the_same_keys_and_arguments() {
    let (en, ru) = (table(Lang::En), table(Lang::Ru));
    let missing: Vec<&String> = en.keys().filter(|k| !ru.contains_key(*k)).collect();
    assert!(missing.is_empty(), "not in Russian: {missing:#?}");
    let idle: Vec<&String> =
        ru.keys().filter(|k| !en.contains_key(*k) && english_of_key(k).is_none()).collect();
    assert!(idle.is_empty(), "in Russian only: {idle:#?}");
    for (key, english) in en {
        // In English the TOML parser is quoted; in Russian its faults have words of their own.
        if !key.starts_with("keyed.syntax.") {
            assert_eq!(places(english), places(&ru[key]), "{key}");
        }
    }
}

#[test]
fn nothing_is_left_untranslated() {
    let (en, ru) = (table(Lang::En), table(Lang::Ru));
    let mut latin: Vec<String> = vec![];
    for (key, russian) in ru {
        let of_effect = |part: &str| key.starts_with("effect.") && key.ends_with(part);
        if of_effect(".formula") {
            continue;
        }
        // Authors, journals and standards are cited by their names; what is said of them is Russian.
        if of_effect(".source") {
            let small = |run: &String| run.split(' ').filter(|w| w.starts_with(char::is_lowercase)).count();
            let english = sentences(russian, 2).into_iter().filter(|run| small(run) >= 2);
            latin.extend(english.map(|english| format!("{key}: {english}")));
            continue;
        }
        let same = SAME.iter().any(|s| key == s || (s.ends_with('.') && key.starts_with(s)));
        let english = english_of_key(key).unwrap_or_else(|| &en[key]);
        if !same && russian == english {
            latin.push(format!("{key} is the same in both languages: {russian}"));
        }
        let foreign = if key == "language.code" { vec![] } else { strangers(&prose(russian)) };
        if !foreign.is_empty() {
            latin.push(format!("{key}: {foreign:?} in `{russian}`"));
        }
        // A decimal point between digits, but for what is written in a procedure.
        let digits: Vec<char> = prose(russian).chars().collect();
        let point = !russian.contains(" = ")
            && digits.windows(3).any(|w| w[0].is_ascii_digit() && w[1] == '.' && w[2].is_ascii_digit());
        assert!(!point, "{key}: a decimal point in `{russian}`");
    }
    assert!(latin.is_empty(), "{latin:#?}");
}

#[test]
fn the_allow_lists_hold_nothing_idle() {
    let (en, ru) = (table(Lang::En), table(Lang::Ru));
    for same in SAME {
        let used =
            ru.iter().any(|(k, v)| (k == same || k.starts_with(same) && same.ends_with('.')) && en[k] == *v);
        assert!(used, "{same} differs, or is no key");
    }
    let all: String = ru.values().map(|v| prose(v) + " ").collect();
    let words: BTreeSet<&str> = all.split(|c: char| !(c.is_ascii_alphabetic() || is_cyrillic(c))).collect();
    let idle: Vec<&&str> = LATIN.iter().filter(|w| !words.contains(**w)).collect();
    assert!(idle.is_empty(), "in no Russian sentence: {idle:?}");
}

#[test]
fn every_broken_file_has_a_russian_diagnostic() {
    let mut seen = 0;
    for kind in ["procedure", "limits"] {
        for file in cases(kind, "toml") {
            let bytes = std::fs::read(&file).unwrap();
            let name = file.display().to_string();
            let found = if kind == "limits" {
                problems(parse_limits("f", &bytes))
            } else {
                problems(parse_procedure("f", &bytes))
            };
            for problem in found {
                seen += 1;
                let said = problem.say(Lang::Ru);
                assert!(said.starts_with("ошибка: ") || said.starts_with("предупреждение: "), "{said}");
                for note in [Some(&problem.message), problem.help.as_ref()].into_iter().flatten() {
                    let said = note.say(Lang::Ru);
                    assert!(said.chars().any(is_cyrillic), "{name}: {said}");
                    assert!(!said.contains('{'), "{name}: {said}");
                    // Names of keys and units stand bare in lists and examples; what may not stand is a sentence.
                    let text = prose(&said);
                    let run = text
                        .split(|c: char| is_cyrillic(c) || ",;:=()".contains(c))
                        .map(|piece| {
                            piece
                                .split_whitespace()
                                .filter(|w| w.chars().all(|c| c.is_ascii_alphabetic()))
                                .count()
                        })
                        .max();
                    assert!(run.unwrap_or(0) < 3, "{name}: an English sentence in: {said}");
                }
            }
        }
    }
    assert!(seen > 90, "only {seen} problems were seen");
}

fn sagnac(arguments: &[&str], variables: &[(&str, &str)]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sagnac"));
    command.args(arguments).env_remove("LC_ALL").env_remove("LC_MESSAGES").env_remove("LANG");
    command.envs(variables.iter().copied()).current_dir(env!("CARGO_MANIFEST_DIR"));
    let out = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (out.status.code(), text(&out.stdout), text(&out.stderr))
}

/// `result.json` without the moment of the evaluation, and the table.
fn machine_readable(folder: &Path) -> (String, Vec<u8>) {
    let json = std::fs::read_to_string(folder.join("result.json")).unwrap();
    let lines: Vec<&str> = json.lines().filter(|l| !l.contains("\"evaluated_at\"")).collect();
    (lines.join("\n"), std::fs::read(folder.join("sigma_tau.csv")).unwrap())
}

#[test]
fn results_for_programs_are_the_same_in_every_language() {
    let english = tested_once("faults");
    let (procedure, faults, limits) = (procedure(), sample("faults"), limits());
    let args = ["run", &procedure, &faults, "--limits", &limits, "--serial", "SN-1", "--lang", "ru"];
    let russian = shared(&args, "r");
    for (lang, run) in [("en", english), ("ru", russian)] {
        assert_eq!(run.said.err, "");
        assert!(run.text("report.html").contains(&format!("<html lang=\"{lang}\">")));
    }
    assert_eq!(english.said.code, russian.said.code);
    let same = machine_readable(&english.out) == machine_readable(&russian.out);
    assert!(same, "result.json or sigma_tau.csv depends on the language");
    assert_ne!(english.said.out, russian.said.out);
    assert!(russian.said.out.starts_with("НЕ "), "{}", russian.said.out);
}

#[test]
fn the_locale_chooses_and_the_option_goes_before_it() {
    let (code, out, err) = sagnac(&["inspect", "none.csv"], &[("LANG", "ru_RU.UTF-8")]);
    assert_eq!((code, out.as_str()), (Some(2), ""));
    assert_eq!(
        err,
        "ошибка: none.csv: не читается: нет такого файла или папки (код ошибки 2); проверьте путь\n"
    );
    let (_, _, err) = sagnac(&["inspect", "none.csv", "--lang", "en"], &[("LC_ALL", "ru_RU.UTF-8")]);
    assert!(err.starts_with("error: none.csv: cannot be read: "), "{err}");
}

#[test]
fn what_inspect_and_selftest_say_is_russian() {
    let (code, text, err) = sagnac(&["inspect", "samples/unit-faults.csv", "--lang", "ru"], &[]);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let is_prose = |l: &&str| !l.trim().is_empty() && !l.contains("SHA-256") && !l.starts_with("  sagnac ");
    for line in text.lines().skip(1).filter(is_prose) {
        let runs = prose(line);
        let longest = runs.split(is_cyrillic).map(|piece| {
            piece
                .split_whitespace()
                .filter(|w| w.len() > 2 && w.chars().all(|c| c.is_ascii_alphabetic()))
                .count()
        });
        assert!(longest.max().unwrap_or(0) < 2, "{line}");
    }
    assert!(text.contains("град/ч") && text.contains("Выход гироскопа"), "{text}");
    let (code, text, _) = sagnac(&["selftest", "--lang", "ru"], &[]);
    assert_eq!(code, Some(0));
    assert!(text.contains("проверок: ") && text.contains("расхождений: 0"), "{text}");
    assert!(text.contains("0,664"), "a decimal comma: {text}");
}

#[test]
fn the_russian_report_of_the_pass_sample() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("r");
    let out = folder.display().to_string();
    let (code, _, err) = sagnac(
        &[
            "run",
            "procedures/static-bias.toml",
            "samples/unit-pass.csv",
            "--limits",
            "procedures/limits/sample-unit.toml",
            "--serial",
            "SN-0001",
            "--operator",
            "А. Иванова",
            "--out",
            &out,
            "--lang",
            "ru",
        ],
        &[],
    );
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let markdown = std::fs::read_to_string(folder.join("report.md")).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("result.json")).unwrap()).unwrap();
    let text = crate::support::steady(&markdown, &json);
    insta::assert_snapshot!("russian_report_of_the_pass_sample", text);
}
