//! `run --each`: every recording is a unit of its own, with a folder each and an index over all. And several files are
//! one recording only where `--join` says so.

use crate::support::schema::{closed, validate};
use crate::support::shared::{SharedRun, shared, shared_input};
use crate::support::{Said, files, names, sagnac, sagnac_as_typed, sagnac_with, shipped};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// A quick test with limits of its own.
const PROCEDURE: &str = "supply-sensitivity";

/// The text of a sample without its line that states the serial number.
fn recording(end: &str) -> String {
    let path = shipped(&format!("samples/supply-sensitivity-{end}.csv"));
    let text = std::fs::read_to_string(path).unwrap();
    let (stated, rest) = text.split_once('\n').unwrap();
    assert!(stated.starts_with("# serial: "), "{stated}");
    rest.to_owned()
}

/// A recording that passes and tells no serial number, one that fails and tells it, one of another unit than its manifest
/// says, and one that cannot be read; with the recording of that manifest.
fn texts() -> [(&'static str, String); 5] {
    [
        (NAMED[0], recording("pass")),
        (NAMED[1], format!("# serial: SN-1002\n{}", recording("fail"))),
        (
            NAMED[2],
            "format = \"manifest/1\"\nserial = \"SN-1003\"\n[[file]]\npath = \"other.csv\"\n".to_owned(),
        ),
        (NAMED[3], "time_s,rate_deg_h\nbroken\n".to_owned()),
        ("lot/other.csv", format!("# serial: SN-9\n{}", recording("pass"))),
    ]
}

/// A folder with them.
fn lot() -> TempDir {
    let dir = tempdir().unwrap();
    std::fs::create_dir(dir.path().join("lot")).unwrap();
    texts().iter().for_each(|(name, text)| std::fs::write(dir.path().join(name), text).unwrap());
    dir
}

/// The paths of those that are named, as other tests read them.
fn shared_lot() -> [String; 4] {
    let [a, b, c, d, _] = texts().map(|(name, text)| shared_input(name, || text));
    [a, b, c, d]
}

/// Them tested.
pub fn tested_lot() -> &'static SharedRun {
    let recordings = shared_lot();
    let recordings: Vec<&str> = recordings.iter().map(String::as_str).collect();
    shared(&[&["run", PROCEDURE], recordings.as_slice(), &["--each"]].concat(), "out")
}

const NAMED: [&str; 4] = ["lot/SN-1001.csv", "lot/b.csv", "lot/c.toml", "lot/d.csv"];

fn each(dir: &Path, recordings: &[&str], more: &[&str]) -> Said {
    sagnac(dir, &[&["run", PROCEDURE], recordings, &["--each"], more].concat())
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// A file without the moment of the evaluation.
fn steady(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().filter(|l| !l.contains("\"evaluated_at\"")).collect::<Vec<_>>().join("\n")
}

fn verdicts(index: &Value) -> Vec<(String, String, String)> {
    let text = |v: &Value| v.as_str().unwrap().to_owned();
    let units = index["units"].as_array().unwrap();
    units
        .iter()
        .map(|u| (text(&u["unit_under_test"]["serial"]), text(&u["serial_from"]), text(&u["verdict"])))
        .collect()
}

#[test]
fn every_unit_is_tested_and_the_worst_decides() {
    let dir = lot();
    let said = each(dir.path(), &NAMED, &["--out", "out"]);
    assert_eq!(said.code, 2, "{said:?}");
    let out = dir.path().join("out");
    assert_eq!(
        names(&out),
        [
            "SHA256SUMS",
            "SN-1001",
            "SN-1002",
            "SN-1003",
            "d",
            "index.csv",
            "index.html",
            "index.json",
            "index.md",
            "junit.xml"
        ]
    );
    let index = json(&out.join("index.json"));
    assert_eq!((&index["format"], &index["verdict"]), (&"lot/1".into(), &"error".into()));
    let expected = [
        ("SN-1001", "file_name", "pass"),
        ("SN-1002", "recording", "fail"),
        ("SN-1003", "manifest", "indeterminate"),
        ("d", "file_name", "error"),
    ];
    let expected = expected.map(|(a, b, c)| (a.to_owned(), b.to_owned(), c.to_owned()));
    assert_eq!(verdicts(&index), expected, "in the order of the command line");
    assert_eq!(
        index["counts"],
        serde_json::json!({"error": 1, "fail": 1, "indeterminate": 1, "pass": 1, "none": 0})
    );
    let schema: Value = serde_json::from_str(&sagnac(dir.path(), &["schema", "lot"]).out).unwrap();
    validate(&closed(&schema), &closed(&schema), &index, "index").unwrap();
    // Every file of the folder is listed, so that a later run may replace it.
    let listed: Vec<&str> = index["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    let found: Vec<String> = files(&out).into_iter().map(|(p, _)| p.to_string_lossy().into_owned()).collect();
    assert_eq!(listed.len(), found.len());
    assert!(found.iter().all(|f| listed.contains(&f.as_str())), "{found:?}");

    printed(&said.out);
    table(&out, &index);
    junit(&out);
    page(&out);

    // The same inputs replace the lot, others do not.
    assert_eq!(sagnac_as_typed(dir.path(), &again(&NAMED), &[]).code, 2);
    let fewer = sagnac_as_typed(dir.path(), &again(&NAMED[..3]), &[]);
    assert!(fewer.code == 2 && fewer.err.contains("a lot of 4 units evaluated "), "{fewer:?}");
    assert_eq!(verdicts(&json(&out.join("index.json"))), expected);
    assert_eq!(names(dir.path()), ["lot", "out"], "nothing half made");
}

fn again<'a>(recordings: &[&'a str]) -> Vec<&'a str> {
    [&["run", PROCEDURE], recordings, &["--each", "--out", "out"]].concat()
}

/// A line for each unit as it is done, then the table and the reasons, the worst first.
fn printed(out: &str) {
    let (done, summary) = out.split_once("\n\n").unwrap();
    for line in ["PASS  SN-1001 · lot/SN-1001.csv", "ERROR  d · lot/d.csv"] {
        assert!(done.lines().any(|l| l.starts_with(line)), "{out}");
    }
    assert!(summary.starts_with("ERROR  "), "{out}");
    assert!(summary.contains("units: 4 (error 1, fail 1, indeterminate 1, pass 1)"), "{out}");
    let rows: Vec<&str> = summary.lines().filter(|l| l.contains("  lot/")).collect();
    let first = |l: &&str| l.split_whitespace().next().unwrap().to_owned();
    assert_eq!(rows.iter().map(first).collect::<Vec<_>>(), ["d", "SN-1002", "SN-1003", "SN-1001"], "{out}");
    assert!(summary.contains(" is below the limit ") && summary.contains("SN-9"), "{out}");
    assert!(
        summary.contains("Serial numbers: stated by the manifest (1); stated by the recording (1);"),
        "{out}"
    );
    assert!(summary.ends_with("Report: out/index.html\n"), "{out}");
}

fn table(out: &Path, index: &Value) {
    let text = std::fs::read_to_string(out.join("index.csv")).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let head: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 4);
    let at = |row: usize, column: &str| {
        rows[row]
            .get(head.iter().position(|h| h == column).unwrap_or_else(|| panic!("{column}: {head:?}")))
            .unwrap()
    };
    for (i, unit) in index["units"].as_array().unwrap().iter().enumerate() {
        assert_eq!(at(i, "serial"), unit["unit_under_test"]["serial"]);
        assert_eq!(at(i, "verdict"), unit["verdict"]);
        assert_eq!(at(i, "folder"), unit["folder"]);
        for m in unit["measurands"].as_array().unwrap() {
            let column = head.iter().find(|h| h.starts_with(m["id"].as_str().unwrap())).unwrap();
            assert_eq!(at(i, column).parse::<f64>().ok(), m["value"].as_f64());
        }
    }
    assert_eq!((at(0, "reasons"), at(0, "limits_failed")), ("", "0"));
    assert!(at(1, "reasons").contains("is below the limit") && at(1, "limits_failed") != "0");
    assert_eq!(at(3, "limits"), "0");
}

/// Cases of a document by the names of their suites: name of each, and name and message of the element that says why it is not passed.
type Suites = BTreeMap<String, Vec<(String, Option<(String, String)>)>>;

fn suites(document: &str) -> Suites {
    let attribute = |e: &BytesStart, name: &str| {
        let attribute = e.try_get_attribute(name).unwrap().unwrap();
        quick_xml::escape::unescape(str::from_utf8(&attribute.value).unwrap()).unwrap().into_owned()
    };
    let mut reader = Reader::from_str(document);
    let (mut suites, mut suite) = (Suites::new(), String::new());
    loop {
        let event = reader.read_event().unwrap();
        let (Event::Start(e) | Event::Empty(e)) = &event else {
            if matches!(event, Event::Eof) {
                return suites;
            }
            continue;
        };
        match e.name().as_ref() {
            b"testsuite" => {
                suite = attribute(e, "name");
                assert_eq!(suites.insert(suite.clone(), vec![]), None);
            }
            b"testcase" => suites.get_mut(&suite).unwrap().push((attribute(e, "name"), None)),
            b"failure" | b"error" | b"skipped" => {
                let element = String::from_utf8(e.name().as_ref().to_vec()).unwrap();
                let case = suites.get_mut(&suite).unwrap().last_mut().unwrap();
                assert_eq!(case.1.replace((element, attribute(e, "message"))), None);
            }
            _ => {}
        }
    }
}

fn junit(out: &Path) {
    let text = std::fs::read_to_string(out.join("junit.xml")).unwrap();
    let suites = suites(&text);
    assert_eq!(suites.len(), 4);
    for cases in suites.values() {
        let names: BTreeSet<&str> = cases.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names.len(), cases.len(), "each case has its own name: {names:?}");
    }
    assert!(suites["SN-1001"].iter().all(|(_, why)| why.is_none()));
    let is = |suite: &str, element: &str, part: &str| {
        let mut outcomes = suites[suite].iter().filter_map(|(_, why)| why.as_ref());
        outcomes.any(|(name, message)| name == element && message.contains(part))
    };
    assert!(is("SN-1002", "failure", "is below the limit"));
    assert!(is("SN-1003", "skipped", "SN-9"));
    assert!(is("d", "error", ""));
    // What the document counts is what it has.
    let all = || suites.values().flatten();
    let of = |element: &str| all().filter(|(_, why)| why.as_ref().is_some_and(|w| w.0 == element)).count();
    let counts = format!(
        "tests=\"{}\" skipped=\"{}\" failures=\"{}\" errors=\"1\"",
        all().count(),
        of("skipped"),
        of("failure")
    );
    assert!(text.contains(&counts) && of("failure") > 0, "{counts}: {text}");
    assert!(text.contains("classname=\"supply-sensitivity.SN-1001\""), "{text}");
}

fn page(out: &Path) {
    let page = std::fs::read_to_string(out.join("index.html")).unwrap();
    for unit in ["SN-1001", "SN-1002", "SN-1003", "d"] {
        assert!(page.contains(&format!("href=\"./{unit}/report.html\"")), "{unit}");
        assert!(out.join(unit).join("report.html").is_file());
    }
    assert!(page.contains("prefers-color-scheme: dark") && page.contains("@page"));
}

#[test]
fn a_unit_of_a_lot_has_the_result_of_a_run_on_its_own() {
    let dir = tempdir().unwrap();
    let of_lot = [("SN-1001", Some("SN-1001")), ("SN-1002", None), ("SN-1003", None), ("d", Some("d"))];
    for (recording, (folder, serial)) in shared_lot().iter().zip(of_lot) {
        let mut args = vec!["run", PROCEDURE, recording, "--out", folder];
        args.extend(serial.iter().flat_map(|s| ["--serial", *s]));
        sagnac(dir.path(), &args);
        let (alone, of_lot) = (dir.path().join(folder), tested_lot().out.join(folder));
        assert_eq!(steady(&alone.join("result.json")), steady(&of_lot.join("result.json")), "{folder}");
        assert_eq!(names(&alone), names(&of_lot));
        let tables = |at: &Path| {
            // What holds the clock, or the hash of what does.
            let clocked = ["result.json", "junit.xml", "SHA256SUMS"];
            files(at).into_iter().filter(|(p, _)| !clocked.iter().any(|c| p.ends_with(c))).collect::<Vec<_>>()
        };
        for ((name, one), (_, other)) in tables(&alone).into_iter().zip(tables(&of_lot)) {
            let page = name.extension().is_some_and(|e| e == "html" || e == "md");
            assert!(page || one == other, "{}", name.display());
        }
    }
}

#[test]
fn threads_change_nothing_but_the_order_of_the_lines() {
    let dir = lot();
    let one = each(dir.path(), &NAMED, &["--jobs", "1", "--out", "one"]);
    let four = each(dir.path(), &NAMED, &["--jobs", "4", "--out", "four"]);
    let index = |name: &str| steady(&dir.path().join(name).join("index.json"));
    assert_eq!(index("one"), index("four"));
    let lines: Vec<&str> =
        one.out.lines().take_while(|l| !l.is_empty()).filter(|l| !l.starts_with(' ')).collect();
    assert_eq!(lines.len(), 4, "{}", one.out);
    assert!(lines[0].starts_with("PASS  SN-1001") && lines[1].starts_with("FAIL"), "{}", one.out);
    let summary = |said: &Said| said.out.split_once("\n\n").unwrap().1.replace("one/", "four/");
    assert_eq!(summary(&one), summary(&four));
}

#[test]
fn the_exit_code_is_that_of_the_worst_verdict() {
    let dir = lot();
    for (named, code) in [(&NAMED[..1], 0), (&NAMED[..2], 1), (&NAMED[..3], 1)] {
        assert_eq!(each(dir.path(), named, &["--out", "o", "--quiet"]).code, code, "{named:?}");
    }
    let pass_and_undecided = each(dir.path(), &[NAMED[0], NAMED[2]], &["--out", "o", "--quiet"]);
    assert_eq!((pass_and_undecided.code, pass_and_undecided.out.as_str()), (3, "Report: o/index.html\n"));
    let said = each(dir.path(), &NAMED[..1], &["--out", "o", "--format", "json"]);
    assert_eq!(said.out.as_bytes(), std::fs::read(dir.path().join("o/index.json")).unwrap());
}

#[test]
fn a_missing_column_is_said_at_the_line_of_the_procedure_once_for_all_units() {
    let dir = lot();
    for name in ["lot/SN-1001.csv", "lot/b.csv"] {
        let path = dir.path().join(name);
        let renamed = std::fs::read_to_string(&path).unwrap().replacen("rate_deg_h", "rate_degh", 1);
        std::fs::write(path, renamed).unwrap();
    }
    let said = each(dir.path(), &["lot/SN-1001.csv", "lot/b.csv"], &["--out", "out"]);
    assert_eq!(said.code, 2, "{said:?}");
    assert_eq!(said.err.matches("error: ").count(), 1, "{}", said.err);
    for part in [
        "there is no column `rate_deg_h`",
        "supply-sensitivity:",
        "column = \"rate_deg_h\"",
        "did you mean `rate_degh`?",
    ] {
        assert!(said.err.contains(part), "no `{part}` in\n{}", said.err);
    }
}

#[test]
fn a_lot_is_rendered_anew_in_another_language() {
    let dir = lot();
    let run = tested_lot();
    let said = sagnac(dir.path(), &["report", run.path(), "--lang", "ru", "--out", "ru"]);
    assert_eq!((said.code, said.err.as_str(), said.out.as_str()), (0, "", "ru\n"));
    let at = |name: &str| std::fs::read_to_string(dir.path().join("ru").join(name)).unwrap();
    for name in ["index.json", "index.csv", "junit.xml", "SN-1002/result.json"] {
        assert_eq!(run.text(name), at(name), "{name} depends on the language");
    }
    for (name, word) in
        [("index.html", "Не годны"), ("SN-1002/report.html", "не годен"), ("index.md", "Партия")]
    {
        let found = at(name).to_lowercase().contains(&word.to_lowercase());
        assert!(found || name == "index.md", "{name}: {word}");
    }
    let said = each(dir.path(), &NAMED, &["--out", "o", "--lang", "ru"]);
    assert!(
        said.out.contains("Источник заводских номеров: ") && said.out.contains("изделий: 4"),
        "{}",
        said.out
    );
}

/// Refused before anything runs: exit code 2, nothing printed, nothing written.
fn refused(dir: &Path, args: &[&str], fragments: &[&str]) {
    let before = names(dir);
    let said = sagnac_as_typed(dir, args, &[]);
    assert_eq!((said.code, said.out.as_str()), (2, ""), "{args:?}: {said:?}");
    for fragment in fragments {
        assert!(said.err.contains(fragment), "{args:?}: no `{fragment}` in\n{}", said.err);
    }
    assert_eq!(names(dir), before, "{args:?}");
}

#[test]
fn a_serial_number_that_is_not_one_units_own_is_refused_by_name() {
    let dir = lot();
    std::fs::write(dir.path().join("lot/e.csv"), format!("# serial: sn 1002\n{}", recording("pass")))
        .unwrap();
    let run = |more: &[&'static str]| [&["run", PROCEDURE], more, &["--each", "--out", "o"]].concat();
    refused(
        dir.path(),
        &run(&["lot/*.csv"]),
        &[
            "2 recordings have",
            "SN-1002, sn 1002: lot/b.csv, lot/e.csv",
            "--serial-from '{stem}'",
            "manifest",
        ],
    );
    refused(dir.path(), &run(&["lot/b.csv", "lot/b.csv"]), &["2 recordings have", "lot/b.csv, lot/b.csv"]);
    refused(dir.path(), &run(&["lot/b.csv", "none.csv"]), &["none.csv"]);
    refused(dir.path(), &run(&["none*.csv"]), &["no file matches"]);
    for (pattern, fragments) in [
        ("SN", &["{serial}"][..]),
        ("SN-{serial}", &["lot/b.csv", "`b`"]),
        ("{serial}*", &["lot/SN-1001.csv", "several ways"]),
    ] {
        let mut args = run(&["lot/SN-1001.csv", "lot/b.csv"]);
        args.extend(["--serial-from", pattern]);
        refused(dir.path(), &args, fragments);
    }
    for i in 0..7 {
        std::fs::write(dir.path().join(format!("lot/x{i}.csv")), "").unwrap();
    }
    refused(
        dir.path(),
        &run(&["lot/x*.csv", "--serial-from", "unit-{serial}"]),
        &["lot/x4.csv", "2 more like this"],
    );
    refused(dir.path(), &run(&["lot/b.csv", "--serial", "1"]), &["--serial", "--each"]);
    refused(dir.path(), &run(&["lot/b.csv", "--join"]), &["--join", "--each"]);
    refused(dir.path(), &["run", PROCEDURE, "lot/b.csv", "--serial-from", "{stem}"], &["--each"]);
}

#[test]
fn serial_numbers_are_taken_from_names_and_compared_with_the_recordings() {
    let dir = tempdir().unwrap();
    for (unit, stated) in [("SN-7", "SN-7"), ("SN-8", "SN-9")] {
        std::fs::create_dir_all(dir.path().join("lot").join(unit)).unwrap();
        let path = dir.path().join("lot").join(unit).join("supply.csv");
        std::fs::write(path, format!("# serial: {stated}\n{}", recording("pass"))).unwrap();
    }
    let said = each(dir.path(), &["lot/*/supply.csv"], &["--serial-from", "{serial}/*", "--out", "o"]);
    assert_eq!(said.code, 3, "{said:?}");
    let expected = [("SN-7", "pattern", "pass"), ("SN-8", "pattern", "indeterminate")]
        .map(|(a, b, c)| (a.into(), b.into(), c.into()));
    assert_eq!(verdicts(&json(&dir.path().join("o/index.json"))), expected);
}

#[test]
fn units_of_several_phases_are_tested_from_their_manifests() {
    let dir = tempdir().unwrap();
    for (end, serial) in [("pass", "SN-21"), ("fail", "SN-22")] {
        for kind in ["bias-repeatability", "scale-factor", "misalignment"] {
            let name = format!("{kind}-{end}.csv");
            let from = shipped(&format!("samples/{name}"));
            let text = std::fs::read_to_string(from).unwrap().replace("SN-0111", serial);
            std::fs::write(dir.path().join(name), text).unwrap();
        }
        let manifest = std::fs::read_to_string(shipped(&format!("samples/acceptance-{end}.toml"))).unwrap();
        let own = manifest.replace("SN-0111", serial);
        std::fs::write(dir.path().join(format!("{end}.toml")), own).unwrap();
    }
    std::fs::write(
        dir.path().join("gone.toml"),
        "format = \"manifest/1\"\nserial = \"SN-23\"\nfiles = \"none*.csv\"\n",
    )
    .unwrap();
    let acceptance = shipped("procedures/acceptance.toml");
    let run = ["run", &acceptance, "pass.toml", "fail.toml", "gone.toml", "--each", "--out", "o"];
    let said = sagnac(dir.path(), &run);
    assert_eq!(said.code, 2, "{said:?}");
    let index = json(&dir.path().join("o/index.json"));
    let found: Vec<String> = verdicts(&index).into_iter().map(|v| format!("{} {}", v.0, v.2)).collect();
    assert_eq!(found[..2], ["SN-21 pass", "SN-22 fail"]);
    assert!(found[2].ends_with(" error"), "{found:?}");
    assert!(dir.path().join("o/SN-22/phases/scale-factor/report.html").is_file());
    assert!(said.out.contains("scale-factor: ") && said.out.contains(" the limit "), "{}", said.out);
    refused(dir.path(), &["run", &acceptance, "scale-factor-pass.csv", "--each"], &["manifest"]);
}

#[test]
fn several_files_are_joined_only_where_that_is_asked_for() {
    let dir = tempdir().unwrap();
    let rows =
        |from: usize, to: usize| -> String { (from..to).map(|i| format!("{i},{}\n", i % 7)).collect() };
    for (name, from) in [("part1.csv", 0), ("part2.csv", 500)] {
        let text = format!("time_s,rate_deg_h\n{}", rows(from, from + 500));
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let model = shipped("samples/model-static.toml");
    for named in [&["part1.csv", "part2.csv"][..], &["part*.csv"], &["part1*.csv"]] {
        let with = |verb: &[&'static str], more: &[&'static str]| [verb, named, more].concat();
        refused(dir.path(), &with(&["run", "static-bias"], &["--out", "o"]), &["--join", "--each"]);
        refused(dir.path(), &with(&["analyze"], &["--out", "o"]), &["--join", "part"]);
        refused(dir.path(), &with(&["inspect"], &[]), &["--join"]);
        // Several recordings of a unit are explained together, one of a pattern alone; here none fits the model.
        let explain = [&["explain"], named, &["--model", &model, "--out", "o"]].concat();
        refused(dir.path(), &explain, &["the recording is sampled at 1.000000 Hz"]);
        let joined = sagnac(dir.path(), &with(&["inspect"], &["--join"]));
        assert_eq!(joined.code, 0, "{joined:?}");
    }
    refused(dir.path(), &["explain", "part1.csv", "--simulation", "part*.csv", "--out", "o"], &["--join"]);
    refused(dir.path(), &["simulate", &model, "--like", "part*.csv", "--out", "s.csv"], &["--join"]);
    refused(dir.path(), &["init", "part*.csv", "--out", "o"], &["single file"]);
    let russian = sagnac(dir.path(), &["analyze", "part*.csv", "--lang", "ru"]);
    assert!(russian.err.starts_with("ошибка: файлов по шаблону part*.csv: 2;"), "{}", russian.err);
    std::fs::write(dir.path().join("m.toml"), "format = \"manifest/1\"\nfiles = \"part*.csv\"\n").unwrap();
    assert_eq!(sagnac(dir.path(), &["inspect", "m.toml"]).code, 0, "a manifest says that they are one");
}

#[test]
fn progress_is_shown_where_it_is_wanted_only() {
    let dir = lot();
    let run = |more: &[&str], progress: &str| {
        let args = [&["run", PROCEDURE, "lot/SN-1001.csv", "--each", "--out", "o", "--force"], more].concat();
        sagnac_with(dir.path(), &args, &[("SAGNAC_PROGRESS", progress)]).err.replace("--force: ", "")
    };
    let shown = run(&[], "always");
    let states: Vec<&str> = shown.lines().filter(|l| l.contains("units/min")).collect();
    assert!(states.iter().any(|l| l.contains("testing units") && l.contains(" left")), "{shown}");
    for (more, progress) in [(&[][..], ""), (&[], "never"), (&["--quiet"], "always")] {
        let said = run(more, progress);
        assert!(!said.contains("testing") && !said.contains("units/min"), "{said}");
    }
    for verb in [
        &["inspect", "lot/SN-1001.csv"][..],
        &["analyze", "lot/b.csv", "--rate", "2", "--out", "a"],
        &["selftest"],
        &["report", "o", "--out", "again"],
    ] {
        let said = sagnac_with(dir.path(), verb, &[("SAGNAC_PROGRESS", "always")]);
        assert!(!said.err.is_empty() && !said.err.contains('\u{1b}'), "{verb:?}: {said:?}");
        assert!(sagnac(dir.path(), verb).err.lines().all(|l| l.contains("--force")), "{verb:?}");
    }
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_no_part_of_a_lot() {
    let dir = lot();
    let mut child = std::process::Command::new(crate::support::program())
        .current_dir(dir.path())
        .args(
            [&["run", PROCEDURE], &NAMED[..], &["--each", "--jobs", "1", "--out", "out", "--quiet"]].concat(),
        )
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let begun = |n: &String| n.starts_with(".out.partial-");
    while !names(dir.path()).iter().any(begun) && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), None, "ended by the signal");
    assert_eq!(names(dir.path()), ["lot"]);
}
