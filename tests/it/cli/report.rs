//! `sagnac report`: results rendered anew without their recordings.

use crate::support::shared::{SharedRun, analyzed_once, phased_once, shared, tested_once};
use crate::support::{names, root, sagnac, sample, shipped};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tempfile::tempdir;

/// The files below a folder with their contents.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|(below, bytes)| (format!("{name}/{below}"), bytes)));
        } else {
            found.insert(name, fs::read(&path).unwrap());
        }
    }
    found
}

/// The names of files that differ between two folders.
fn differences(a: &Path, b: &Path) -> Vec<String> {
    let (a, b) = (files(a), files(b));
    a.keys().chain(b.keys()).filter(|k| a.get(*k) != b.get(*k)).cloned().collect()
}

/// Renders a result anew in English, and in Russian and from there in English again.
fn comes_out_the_same(result: &SharedRun) {
    let folder = tempdir().unwrap();
    let dir = folder.path();
    let render = |from: &str, lang: &str, to: &str| {
        let said = sagnac(dir, &["report", from, "--lang", lang, "--out", to]);
        assert_eq!((said.code, said.err.as_str()), (0, ""), "{from}: {said:?}");
        assert_eq!(said.out, format!("{to}\n"));
    };
    let at = |name: &str| dir.join(name);
    render(result.path(), "en", "again");
    assert_eq!(differences(&result.out, &at("again")), [""; 0]);
    render(result.path(), "ru", "ru");
    let words = differences(&result.out, &at("ru"));
    let of_words =
        |name: &String| [".html", ".md", ".svg", "SHA256SUMS"].iter().any(|end| name.ends_with(end));
    assert!(words.len() > 2 && words.iter().all(of_words), "{words:?}");
    render("ru", "en", "back");
    assert_eq!(differences(&result.out, &at("back")), [""; 0]);
}

#[test]
fn a_run_an_analysis_and_a_test_of_several_phases_come_out_the_same() {
    comes_out_the_same(tested_once("pass"));
    comes_out_the_same(analyzed_once("faults"));
    comes_out_the_same(phased_once("fail"));
    // Shorter than what is required, so that nothing is evaluated.
    let short = ["run", &shipped("procedures/scale-factor.toml"), &sample("pass"), "--serial", "SN-1"];
    comes_out_the_same(shared(&short, "r"));
}

#[test]
fn an_explanation_comes_out_the_same_alone_and_in_a_run() {
    comes_out_the_same(crate::explain::step());
    let run = crate::explain::in_run::unlike_its_family();
    assert!(run.out.join("explain/report.html").is_file(), "{:?}", run.said);
    comes_out_the_same(run);
}

#[test]
fn comparisons_come_out_the_same() {
    for what in [sample("pass"), "--published".to_owned()] {
        let dir = tempdir().unwrap();
        let compared = shared(&["compare", &what], "c");
        assert_eq!(compared.said.code, 0, "{:?}", compared.said);
        let render = |from: &str, lang: &str, to: &str| {
            let said = sagnac(dir.path(), &["report", from, "--lang", lang, "--out", to]);
            assert_eq!((said.code, said.err.as_str()), (0, ""), "{said:?}");
        };
        render(compared.path(), "ru", "ru");
        render("ru", "en", "back");
        assert_eq!(differences(&compared.out, &dir.path().join("back")), [""; 0]);
        let page = fs::read_to_string(dir.path().join("ru/comparison.md")).unwrap();
        assert!(page.contains(if what == "--published" { "ОИУС" } else { "σ100" }), "{page}");
    }
}

#[test]
fn forms_are_chosen_and_what_is_missing_is_said() {
    let dir = tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    tested_once("indeterminate").copy_to(&at("o"));
    let report = |args: &[&str]| sagnac(dir.path(), &[&["report", "o", "--lang", "en"], args].concat());
    assert_eq!(report(&["--format", "html", "--out", "h"]).code, 0);
    assert_eq!(
        names(&at("h")),
        ["SHA256SUMS", "limits.toml", "procedure.toml", "report.html", "result.json"]
    );
    assert_eq!(report(&["--format", "csv,md", "--out", "c"]).code, 0);
    let of_both = [
        "SHA256SUMS",
        "figures",
        "limits.toml",
        "measurands.csv",
        "procedure.toml",
        "report.md",
        "result.json",
        "sigma_tau.csv",
    ];
    assert_eq!(names(&at("c")), of_both);
    assert!(!names(&at("c/figures")).contains(&"data.json".to_owned()));

    // Into its own folder it would take away what it reads.
    let refused = report(&["--out", "o"]);
    assert_eq!(refused.code, 2, "{refused:?}");

    // The record alone: the page says what it lacks, and so does the terminal.
    fs::remove_file(at("o/sigma_tau.csv")).unwrap();
    fs::remove_file(at("o/figures/data.json")).unwrap();
    let said = report(&["--out", "less"]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(said.err.contains("data.json") && said.err.contains("sigma_tau.csv"), "{}", said.err);
    let less = [
        "SHA256SUMS",
        "junit.xml",
        "limits.toml",
        "measurands.csv",
        "procedure.toml",
        "report.html",
        "report.md",
        "result.json",
    ];
    assert_eq!(names(&at("less")), less);
    let page = fs::read_to_string(at("less/report.html")).unwrap();
    assert!(page.contains("The figures are not shown") && !page.contains("<svg"));
    let verdict = |name: &str| fs::read_to_string(at(name)).unwrap().lines().nth(4).map(str::to_owned);
    assert_eq!(verdict("less/report.md"), verdict("o/report.md"));
}

#[test]
fn what_is_no_result_is_refused_in_one_message() {
    let dir = tempdir().unwrap();
    let whole =
        fs::read_to_string(root().join("tests/fixtures/results/static-bias-without-presentation.json"))
            .unwrap();
    let cases: [(&str, String, &str); 6] = [
        ("newer.json", whole.replacen("result/1", "result/2", 1), "`result/2` of another version"),
        ("cut.json", whole[..whole.len() / 2].to_owned(), "ends prematurely"),
        ("broken.json", whole.replacen(':', ";", 1), "invalid JSON at line"),
        ("foreign.json", "{\"name\": \"package\"}".to_owned(), "not a result of this program"),
        ("wrong.json", whole.replacen("\"verdict\": \"", "\"verdict\": \"very ", 1), "does not follow"),
        ("empty.json", String::new(), "ends prematurely"),
    ];
    for (name, text, fragment) in &cases {
        fs::write(dir.path().join(name), text).unwrap();
        let said = sagnac(dir.path(), &["report", name, "--lang", "en", "--out", "o"]);
        assert_eq!((said.code, said.out.as_str()), (2, ""), "{name}: {said:?}");
        assert!(said.err.starts_with("error: ") && said.err.lines().count() == 1, "{name}: {}", said.err);
        assert!(said.err.contains(name) && said.err.contains(fragment), "{name}: {}", said.err);
    }
    for (name, fragment) in [("none.json", "none.json"), (".", "without result.json")] {
        let said = sagnac(dir.path(), &["report", name, "--lang", "en", "--out", "o"]);
        assert_eq!(said.code, 2, "{said:?}");
        assert!(said.err.contains(fragment), "{}", said.err);
    }
    assert!(!dir.path().join("o").exists());
    // An earlier file of the format is rendered; it kept no data of figures.
    fs::write(dir.path().join("earlier.json"), whole).unwrap();
    let said = sagnac(dir.path(), &["report", "earlier.json", "--lang", "ru", "--out", "o"]);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(fs::read_to_string(dir.path().join("o/report.md")).unwrap().contains("Рисунков нет"));
}
