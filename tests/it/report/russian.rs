//! The Russian report of every shipped procedure on its sample: no English sentence in it, neither of the program nor of
//! the procedure.

use crate::support;
use crate::support::pairs::sample_once;
use crate::support::shared::{SharedRun, phased_once, shared};
use crate::support::{procedure, root, sagnac, shipped, steady};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;

/// The shipped procedures, each with its shortest sample that says most.
const CASES: &[(&str, &str)] = &[
    ("acceptance", "acceptance-fail"),
    ("acceleration", "acceleration-fail"),
    ("bias-repeatability", "bias-repeatability-fail"),
    ("electromagnetic-immunity", "electromagnetic-immunity-fail"),
    ("magnetic-sensitivity", "magnetic-sensitivity-fail"),
    ("maximum-rate", "maximum-rate-fail"),
    ("transfer-function", "transfer-function-fail"),
    ("start-up", "start-up-fail"),
    ("bench-check", "bench-check-fail"),
    ("misalignment", "misalignment-fail"),
    ("multi-position", "multi-position-software"),
    ("output-noise", "output-noise-fail"),
    ("pressure-sensitivity", "pressure-sensitivity-fail"),
    ("scale-factor", "scale-factor-fail"),
    ("scale-factor-over-temperature", "scale-factor-over-temperature-fail"),
    ("scale-factor-under-pressure", "scale-factor-under-pressure-fail"),
    ("static-bias", "unit-faults"),
    ("supply-sensitivity", "supply-sensitivity-fail"),
    ("temperature-ramp", "temperature-aborted"),
    ("temperature-soak", "temperature-soak-fail"),
    ("threshold", "threshold-fail"),
    ("vibration", "vibration-fail"),
    ("vibration-by-frequency", "vibration-by-frequency-fail"),
    ("warm-up", "warm-up-fail"),
];

/// Words in a row that make a sentence.
const SENTENCE: usize = 3;

/// Words that run on in Latin letters and are no sentence: titles of books and papers as they are cited.
const CITED: &[&str] = &[
    "Bendat and Piersol Random Data",
    "Bendat Piersol Random Data",
    "Bonferroni Berger Technometrics",
    "Trans Audio Electroacoust",
];

/// Tags within a sentence; every other ends it.
const INLINE: &[&str] = &["a", "abbr", "b", "em", "i", "small", "span", "strong", "sub", "sup", "tspan"];

/// Elements whose content is not for readers of a language.
const NOT_PROSE: &[&str] = &["code", "script", "style"];

/// Attributes that a reader sees or hears.
const READ_OUT: &[&str] = &["alt=\"", "title=\"", "aria-label=\""];

/// The texts of a page, each as a reader takes it in.
fn pieces_of_html(page: &str) -> Vec<String> {
    let (mut pieces, mut piece, mut rest) = (vec![], String::new(), page);
    while let Some((text, after)) = rest.split_once('<') {
        piece.push_str(text);
        let Some((tag, after)) = after.split_once('>') else { break };
        let name: String =
            tag.trim_start_matches('/').chars().take_while(char::is_ascii_alphanumeric).collect();
        rest = after;
        for attribute in READ_OUT {
            let value = tag.split_once(attribute).and_then(|(_, v)| v.split_once('"'));
            pieces.extend(value.map(|(v, _)| v.to_owned()));
        }
        if NOT_PROSE.contains(&name.as_str()) && !tag.starts_with('/') {
            rest = after.split_once(&format!("</{name}>")).map_or("", |(_, after)| after);
            piece.push_str(" | ");
        } else if !INLINE.contains(&name.as_str()) {
            pieces.push(std::mem::take(&mut piece));
        }
    }
    pieces.push(piece);
    pieces
}

/// The texts of a Markdown file.
fn pieces_of_markdown(text: &str) -> Vec<String> {
    let mut pieces = vec![];
    for (i, block) in text.split("```").enumerate().filter(|(i, _)| i % 2 == 0) {
        let prose = |line: &str| {
            line.split('`')
                .enumerate()
                .map(|(i, part)| if i % 2 == 0 { part } else { "|" })
                .collect::<String>()
        };
        assert!(i == 0 || !block.is_empty());
        pieces.extend(
            block.lines().flat_map(|line| prose(line).split('|').map(str::to_owned).collect::<Vec<_>>()),
        );
    }
    pieces
}

/// A word as English prose has it: letters, small but for the first. Symbols, identifiers, file names, numbers,
/// abbreviations such as IEEE and single letters but for the article are none.
fn is_word(token: &str) -> bool {
    let small = |c: char| c.is_ascii_lowercase() || c == '-' || c == '\'';
    let mut letters = token.chars();
    let first = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
    first && letters.all(small) && (token.len() > 1 || token.eq_ignore_ascii_case("a"))
}

/// Runs of at least so many such words.
pub fn sentences(piece: &str, least: usize) -> Vec<String> {
    let (mut found, mut run) = (vec![], vec![]);
    for token in piece.split_whitespace().chain(["|"]) {
        let bare = token.trim_matches(|c: char| "()[],;:.!?«»\"".contains(c));
        if is_word(bare) {
            run.push(bare);
            continue;
        }
        if run.len() >= least {
            found.push(run.join(" "));
        }
        run.clear();
    }
    found
}

/// English sentences of the reports in a folder that are no titles as cited; the titles that were met.
fn english(folder: &Path, cited: &mut BTreeSet<&'static str>) -> Vec<String> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let (html, markdown) = (pieces_of_html(&read("report.html")), pieces_of_markdown(&read("report.md")));
    assert!(html.len() > 100 && markdown.len() > 100, "a report has more text");
    let mut found: BTreeSet<String> =
        html.iter().chain(&markdown).flat_map(|p| sentences(p, SENTENCE)).collect();
    cited.extend(CITED.iter().filter(|title| found.remove(**title)));
    found.into_iter().collect()
}

/// The result of a sample; the faults under limits that hold published values alone.
fn tested(sample: &str) -> &'static SharedRun {
    match sample {
        "acceptance-fail" => phased_once("fail"),
        "unit-faults" => {
            let limits = shipped("procedures/limits/oius-501.toml");
            let args = ["run", &procedure(), &support::sample("faults"), "--limits", &limits];
            shared(&[&args[..], &["--serial", "SN-0001"]].concat(), "r")
        }
        _ => sample_once(sample),
    }
}

#[test]
fn no_shipped_procedure_gives_an_english_sentence_in_a_russian_report() {
    let names: BTreeSet<&str> = CASES.iter().map(|c| c.0).collect();
    let shipped = std::fs::read_dir(root().join("procedures")).unwrap().map(|e| e.unwrap().path());
    let shipped = shipped.filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let shipped: Vec<String> =
        shipped.map(|p| p.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    assert_eq!(shipped.iter().map(String::as_str).collect::<BTreeSet<_>>(), names);
    let (mut wrong, mut cited) = (vec![], BTreeSet::new());
    for (procedure, sample) in CASES {
        let rendered = shared(&["report", tested(sample).path(), "--lang", "ru"], "ru");
        let found = english(&rendered.out, &mut cited);
        wrong.extend(found.into_iter().map(|sentence| format!("{procedure}: {sentence}")));
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let idle: Vec<_> = CITED.iter().filter(|title| !cited.contains(*title)).collect();
    assert!(idle.is_empty(), "cited nowhere: {idle:?}");
}

#[test]
fn a_result_renders_in_the_other_language_without_its_procedure() {
    let dir = tempfile::tempdir().unwrap();
    let [procedure, sample] =
        ["procedures/magnetic-sensitivity.toml", "samples/magnetic-sensitivity-fail.csv"].map(shipped);
    let run = ["run", &procedure, &sample, "--serial", "SN-0114", "--lang", "ru", "--out", "ru"];
    let said = sagnac(dir.path(), &run);
    assert_eq!(said.code, 1, "{said:?}");
    let russian = dir.path().join("ru");
    let english = sample_once("magnetic-sensitivity-fail");
    let again = &shared(&["report", english.path(), "--lang", "ru"], "ru").out;
    let read = |folder: &Path| {
        let json = std::fs::read_to_string(folder.join("result.json")).unwrap();
        let json: Value = serde_json::from_str(&json).unwrap();
        let text = steady(&std::fs::read_to_string(folder.join("report.md")).unwrap(), &json);
        (text, json)
    };
    let ((direct, _), (rendered, json)) = (read(&russian), read(again));
    assert_eq!(rendered, direct);
    assert!(rendered.contains("# Чувствительность к магнитному полю"), "{rendered}");
    assert_eq!(json["procedure"]["title"], "Sensitivity to a magnetic field");
    assert_eq!(json["procedure"]["title_by_language"]["ru"], "Чувствительность к магнитному полю");
    assert_eq!(json["instruments"][0]["name_by_language"]["en"], json["instruments"][0]["name"]);
}

#[test]
fn the_watch_for_sentences_is_awake() {
    let html = "<p title=\"not a title\">Смещение <b>was not</b> measured, <code>this is code</code></p><td>a</td><td>b c</td>";
    let found = |pieces: Vec<String>| pieces.iter().flat_map(|p| sentences(p, SENTENCE)).collect::<Vec<_>>();
    assert_eq!(found(pieces_of_html(html)), ["not a title", "was not measured"]);
    let markdown = "| The unit, passed | by IEEE Std 952 |\n```\nsome code here\n```\nкод `in back ticks` N = 3 rate_deg_h";
    assert_eq!(found(pieces_of_markdown(markdown)), ["The unit passed"]);
}
