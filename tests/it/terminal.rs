//! Text from a file, or its name, steers neither the terminal nor a report.

#![cfg(unix)]

use crate::support::synthetic::row;
use crate::support::{Said, altered, procedure, sagnac, shipped};
use sagnac::i18n::steers;
use std::path::Path;
use tempfile::{TempDir, tempdir};

/// Sets the title of the window, clears the screen, paints, turns the order round, hides, forges a line.
const EVIL: &str = "\u{1b}]0;owned\u{7}\u{1b}[2J\u{1b}[32mPASS\u{9b}1A\u{7f}\u{8}\u{202e}\u{2066}\u{200b}\u{2028}\u{feff}\rFORGED a\u{b}";

/// The same with a line of its own, for names of files and what stands in TOML.
fn forged() -> String {
    format!("{EVIL}\nFORGED: PASS\n")
}

/// What would be markup.
const MARKUP: &str = "a|b <script>alert(1)</script> [x](http://e.com/) `c` ![y](z) www.e.com *d* | e";

fn in_toml(text: &str) -> String {
    text.chars()
        .map(|c| {
            if steers(c) || c == '"' || c == '\\' {
                format!("\\U{:08X}", u32::from(c))
            } else {
                c.to_string()
            }
        })
        .collect()
}

fn recording(rate: &str, temperature: &str) -> String {
    let field = |name: &str| format!("\"{}\"", name.replace('"', "\"\""));
    let mut text = format!("# serial: {EVIL}\n# operator = {EVIL}\n");
    text.push_str(&format!("time_s,{},{}\n", field(rate), field(temperature)));
    (0..3000).for_each(|i| text.push_str(&format!("{}\n", row(i))));
    text
}

/// A procedure whose every text holds something, for columns of these names.
fn procedure_of(folder: &Path, name: &str, evil: &str, rate: &str, temperature: &str) -> String {
    let t = in_toml(evil);
    let more = format!(
        "[[instrument]]\nname = \"{t}\"\nserial = \"{t}\"\ncalibration_due = 2020-01-01\n\n[[waiver]]\n\
         row = \"static_bias\"\nserial = \"S\"\nby = \"{t}\"\ndate = 2026-01-01\nreason = \"{t}\"\n\n[[channel]]"
    );
    altered(
        folder,
        name,
        &procedure(),
        &[
            ("warm_up = \"30 min\"", "warm_up = \"10 s\""),
            (
                "title = { en = \"Static bias and noise\", ru = \"Смещение нуля и шум в покое\" }",
                &format!("title = \"{t}\""),
            ),
            ("author = { en = \"Sagnac project\", ru = \"проект Sagnac\" }", &format!("author = \"{t}\"")),
            ("standard = \"IEEE Std 952-2020\"", &format!("standard = \"{t}\"")),
            ("\"rate_deg_h\"", &format!("\"{}\"", in_toml(rate))),
            ("\"temp_degC\"", &format!("\"{}\"", in_toml(temperature))),
            (
                "title = { en = \"Examination of product, mechanical\", ru = \"Внешний осмотр и проверка механической части\" }",
                &format!("title = \"{t}\""),
            ),
            (
                "note = { en = \"incoming inspection\", ru = \"входной контроль\" }",
                &format!("note = \"{t}\""),
            ),
            ("[[channel]]\nid = \"time\"", &format!("{more}\nid = \"time\"")),
        ],
    )
}

fn limits_of(folder: &Path, evil: &str) -> String {
    let t = in_toml(evil);
    let text = format!(
        "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"{t}\"\nrevision = \"{t}\"\nfamily = \"{t}\"\nsource = \"{t}\"\n\n\
         [[limit]]\nmeasurand = \"angle_random_walk\"\nmax = \"0.01 deg/sqrt(h)\"\n"
    );
    std::fs::write(folder.join("limits.toml"), text).unwrap();
    "limits.toml".to_owned()
}

fn clean(said: &Said, what: &[&str]) {
    for text in [&said.out, &said.err] {
        let odd: Vec<char> = text.chars().filter(|c| *c != '\n' && steers(*c)).collect();
        assert!(odd.is_empty(), "{what:?}: {odd:?} in {text:?}");
        // What a long name goes on with stands four columns in, deeper than any line begins.
        let begins = |l: &str| {
            l.starts_with("FORGED") || l.strip_prefix("  ").is_some_and(|l| l.starts_with("FORGED"))
        };
        assert!(!text.lines().any(begins), "{what:?}: {text}");
    }
}

/// Markdown and HTML of a folder: nothing steers, nothing from outside is markup, every table has its columns.
fn pages(folder: &Path) {
    let (mut seen, mut cells) = (0, 0);
    for (path, bytes) in crate::support::files(folder) {
        let text = String::from_utf8(bytes).unwrap();
        let shown = path.display();
        match path.extension().and_then(|e| e.to_str()) {
            Some("html" | "svg" | "md") => {
                let odd: Vec<char> =
                    text.chars().filter(|c| *c != '\n' && *c != '\t' && steers(*c)).collect();
                assert!(odd.is_empty(), "{shown}: {odd:?}");
                seen += 1;
            }
            _ => continue,
        }
        let code = |l: &str| l.contains('`');
        // A page has one script of its own, in its head; nothing from a file is one.
        let own = usize::from(path.extension().is_some_and(|e| e == "html"));
        let scripts = text.lines().filter(|l| l.contains("<script") && !code(l)).count();
        assert!(scripts <= own, "{shown}: {scripts}");
        let body = text.split_once("<body>").map_or("", |(_, body)| body);
        assert!(!body.contains("<script"), "{shown}");
        if path.extension().is_some_and(|e| e == "md") {
            // Outside code, which is every other part between backticks.
            let plain = text.replace("\\`", "").replace("\\]", "");
            let parts = plain.lines().flat_map(|l| l.split('`').step_by(2));
            let link = |p: &str| p.contains("](http") || p.contains("](z)") || p.contains("www.");
            assert!(!parts.into_iter().any(link), "{shown}");
            let bars = |l: &str| l.replace("\\\\", "").replace("\\|", "").matches('|').count();
            let mut columns = None;
            for line in text.lines() {
                if !line.starts_with('|') {
                    columns = None;
                    continue;
                }
                let n = *columns.get_or_insert(bars(line));
                assert_eq!(bars(line), n, "{shown}: {line}");
                cells += n;
            }
        }
    }
    assert!(seen > 3 && cells > 20, "{}: {seen} {cells}", folder.display());
}

fn home(evil: &str) -> (TempDir, String) {
    let dir = tempdir().unwrap();
    let (rate, temperature) = (format!("rate {EVIL}_deg_h"), format!("temp {EVIL}_degC"));
    let name = format!("u {}.csv", forged().replace('/', "_"));
    std::fs::write(dir.path().join(&name), recording(&rate, &temperature)).unwrap();
    // What TOML refuses in a text is refused with its place; the rest goes through to the report.
    procedure_of(dir.path(), "evil-p.toml", evil, &rate, &temperature);
    let by_position =
        [("warm_up = \"30 min\"", "warm_up = \"10 s\""), ("\"rate_deg_h\"", "2"), ("\"temp_degC\"", "3")];
    altered(dir.path(), "p.toml", &procedure(), &by_position);
    limits_of(dir.path(), evil);
    (dir, name)
}

/// Files of every other kind that hold the text, sound and broken ones.
fn hostile_files(folder: &Path, name: &str, evil: &str) {
    let t = in_toml(evil);
    let at = |n: &str| folder.join(n);
    std::fs::write(
        at("m.toml"),
        format!("format = \"manifest/1\"\nserial = \"{t}\"\n[[file]]\npath = \"{}\"\n", in_toml(name)),
    )
    .unwrap();
    std::fs::write(at("bad-m.toml"), format!("format = \"manifest/1\"\nserial = \"{t}\"\n\"{t}\" = 1\n[[file]]\npath = \"{t}\"\nsha256 = \"{t}\"\n")).unwrap();
    std::fs::write(at("l.toml"), format!("format = \"layout/1\"\nrecord_bytes = 4\nbyte_order = \"little\"\nsample_rate = \"10 Hz\"\n[[field]]\nname = \"rate {t}\"\ntype = \"f32\"\noffset = 0\nunit = \"deg/h\"\n")).unwrap();
    std::fs::write(
        at("raw.bin"),
        (0..4000u32).flat_map(|i| ((i % 97) as f32).to_le_bytes()).collect::<Vec<u8>>(),
    )
    .unwrap();
    std::fs::write(at("bad-p.toml"), format!("format = \"procedure/1\"\n[procedure]\nid = \"{t}\"\ntitle = 3\nmystery = \"{t}\"\n[[channel]]\nid = \"rate\"\ncolumn = \"{t}\"\nrole = \"{t}\"\nunit = \"{t}\"\n[explain]\nmodel = \"{t}\"\n")).unwrap();
    let model = std::fs::read_to_string(shipped("samples/model-static.toml")).unwrap();
    std::fs::write(
        at("model.toml"),
        model.replace("static, laboratory, vertical input axis", &t).replace("sample-static", &t),
    )
    .unwrap();
    std::fs::write(
        at("bad-model.toml"),
        model.replace("N_deg_rt_h", "mystery").replace("\"time_s\"", &format!("\"{t}\"")),
    )
    .unwrap();
    std::fs::write(at("bad.csv"), format!("time_s,{EVIL}\n0,{EVIL}\n1,{EVIL}\n{EVIL}\n")).unwrap();
}

#[test]
fn nothing_from_a_file_steers_the_terminal_in_any_verb() {
    let evil = forged();
    let (dir, name) = home(&evil);
    hostile_files(dir.path(), &name, &evil);
    let missing = format!("none{evil}");
    let (p, serial, rate) = ("p.toml", "S", "2");
    for verb in [
        vec!["inspect", &name],
        vec!["inspect", "m.toml"],
        vec!["inspect", "bad-m.toml"],
        vec!["inspect", "bad.csv"],
        vec!["inspect", &missing],
        vec!["inspect", "raw.bin", "--layout", "l.toml"],
        vec!["check", p, "limits.toml", "m.toml", "l.toml"],
        vec!["check", "bad-p.toml"],
        vec!["check", "evil-p.toml"],
        vec!["run", "evil-p.toml", &name, "--limits", "limits.toml", "--serial", "S", "--out", "r6"],
        vec!["check", "bad-m.toml"],
        vec!["check", &missing],
        vec!["run", p, &name, "--serial", &evil, "--operator", &evil, "--station", &evil, "--out", "r"],
        vec!["run", p, "bad.csv", "--serial", serial, "--out", "r2"],
        vec!["run", p, &missing, "--serial", serial, "--out", "r3"],
        vec!["run", p, "m.toml", "--serial", serial, "--out", "r4"],
        vec!["run", "bad-p.toml", &name, "--serial", serial, "--out", "r5"],
        vec!["run", p, &name, "--serial", serial, "--out", &missing],
        vec!["run", p, &name, "bad.csv", "--each", "--out", "lot"],
        vec!["run", p, &name, "bad.csv", "--each", "--serial-from", &evil, "--out", "lot3"],
        vec!["run", p, &name, "bad.csv"],
        vec!["analyze", &name, "--out", "a"],
        vec!["analyze", &name, "--rate", &evil, "--out", "a2"],
        vec!["analyze", &name, "--rate", rate, "--unit", &evil, "--out", "a3"],
        vec!["analyze", "bad.csv", "--out", "a4"],
        vec!["analyze", "raw.bin", "--layout", "l.toml", "--time", "none", "--out", "a5"],
        vec!["compare", &name, &name, "--out", "c"],
        vec!["compare", "r", &missing, "--out", "c2"],
        vec!["simulate", "model.toml", "--out", &missing],
        vec!["simulate", "model.toml", "--out", &name],
        vec!["simulate", "bad-model.toml", "--out", "s.csv"],
        vec!["simulate", "model.toml", "--out", "s.csv", "--duration", &evil],
        vec!["explain", &name, "--model", "model.toml", "--sample-rate", "1", "--out", "e"],
        vec!["explain", "bad.csv", "--simulation", &name, "--out", "e2"],
        vec!["explain", &name, "--model", "model.toml", "--hide", &evil, "--out", "e3"],
        vec!["effects", &evil],
        vec!["schema", &evil],
        vec![evil.as_str()],
        vec!["run", &evil, "--nothing", &evil],
    ] {
        let said = |lang: &'static str| {
            let verb = [&verb[..], &["--lang", lang]].concat();
            let said = sagnac(dir.path(), &verb);
            clean(&said, &verb);
            said.code
        };
        // A diagnostic is a sentence of its own in each language; a result is rendered anew below.
        if said("en") == 2 {
            said("ru");
        }
    }
    let rendered = ["report", "r", "--lang", "ru", "--out", "ru"];
    clean(&sagnac(dir.path(), &rendered), &rendered);
    for folder in ["r", "r2", "a", "c", "lot", "ru"] {
        pages_or_less(&dir.path().join(folder));
    }
}

/// As [`pages`], for folders that may hold an error report only.
fn pages_or_less(folder: &Path) {
    for (path, bytes) in crate::support::files(folder) {
        let text = String::from_utf8(bytes).unwrap();
        let odd: Vec<char> = text.chars().filter(|c| *c != '\n' && *c != '\t' && steers(*c)).collect();
        let page = path.extension().is_some_and(|e| e == "html" || e == "svg" || e == "md");
        assert!(!page || odd.is_empty(), "{}: {odd:?}", path.display());
    }
}

#[test]
fn nothing_from_a_file_is_markup_in_a_report() {
    let dir = tempdir().unwrap();
    let (rate, temperature) = (format!("{MARKUP} rate_deg_h"), format!("{MARKUP} temp_degC"));
    std::fs::write(dir.path().join("u.csv"), recording(&rate, &temperature)).unwrap();
    procedure_of(dir.path(), "p.toml", MARKUP, &rate, &temperature);
    limits_of(dir.path(), MARKUP);
    let run = [
        "run",
        "p.toml",
        "u.csv",
        "--limits",
        "limits.toml",
        "--serial",
        MARKUP,
        "--operator",
        MARKUP,
        "--out",
        "r",
    ];
    let said = sagnac(dir.path(), &run);
    assert!(said.code != 2, "{said:?}");
    pages(&dir.path().join("r"));
    let said = sagnac(dir.path(), &["analyze", "u.csv", "--rate", "2", "--unit", "deg/h", "--out", "a"]);
    assert!(said.code == 0, "{said:?}");
    pages(&dir.path().join("a"));
    let said = sagnac(dir.path(), &["compare", "a", "r", "--out", "c"]);
    assert!(said.code == 0, "{said:?}");
}

#[test]
fn a_name_is_no_formula_in_a_table() {
    let dir = tempdir().unwrap();
    let names = ["=1+1.csv", "+cmd.csv", "-x.csv", "@SUM(A1).csv", "\t=A1.csv", "a;=A1.csv"];
    for name in names {
        std::fs::write(dir.path().join(name), crate::support::synthetic::recording(3000)).unwrap();
    }
    let shown: Vec<String> = names.iter().map(|n| format!("./{n}")).collect();
    let mut args = vec!["compare"];
    args.extend(shown.iter().map(String::as_str));
    args.extend(["--out", "c"]);
    let said = sagnac(dir.path(), &args);
    assert_eq!(said.code, 0, "{said:?}");
    let table = std::fs::read_to_string(dir.path().join("c/comparison.csv")).unwrap();
    let mut reader = csv::ReaderBuilder::new().has_headers(true).from_reader(table.as_bytes());
    let mut rows = 0;
    for record in reader.records() {
        let record = record.unwrap();
        rows += 1;
        for cell in &record {
            let formula = cell.starts_with(['=', '+', '-', '@', '\t', '\r']) && cell.parse::<f64>().is_err();
            assert!(!formula && !cell.contains(";="), "{cell:?}");
        }
        assert!(
            record.iter().filter(|c| c.parse::<f64>().is_ok()).count() > 5,
            "numbers stay numbers: {record:?}"
        );
    }
    assert_eq!(rows, names.len());
}
