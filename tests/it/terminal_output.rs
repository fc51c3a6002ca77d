//! What verbs print: tables by the width of the terminal, colour where it is wanted, JSON alone
//! where it is asked for; shipped files by their names.

use crate::support::synthetic::white;
use crate::support::{program, root, sample, shipped};
use std::path::Path;
use std::process::Output;
use tempfile::tempdir;

/// Runs the program as on a terminal of a width.
fn printed(folder: &Path, width: &str, more: &[(&str, &str)], args: &[&str]) -> Output {
    let mut command = std::process::Command::new(program());
    command.current_dir(folder).env("COLUMNS", width).env("LANG", "C.UTF-8").env_remove("LC_ALL");
    command.env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE");
    command.envs(more.iter().copied()).args(args).output().unwrap()
}

/// Standard output with the folders of this machine and the narrow spaces taken out.
fn text(output: &Output, folder: &Path) -> String {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let text = text.replace(&format!("{}/", folder.canonicalize().unwrap().display()), "");
    let text = text.replace(&format!("{}/", root().display()), "");
    text.replace(['\u{a0}', '\u{202f}', '\u{2009}'], " ")
}

fn run<'a>(name: &'a str, out: &'a str) -> Vec<&'a str> {
    vec!["run", "static-bias", name, "--limits", "sample-unit", "--serial", "SN-0001", "--out", out]
}

#[test]
fn a_run_prints_its_table_by_width_and_language() {
    let folder = tempdir().unwrap();
    let fail = sample("fail");
    let faults = sample("faults");
    let wide = printed(folder.path(), "140", &[], &run(&fail, "wide"));
    assert_eq!(wide.status.code(), Some(1));
    insta::assert_snapshot!("wide", text(&wide, folder.path()));
    let narrow = printed(folder.path(), "60", &[], &run(&fail, "narrow"));
    insta::assert_snapshot!("narrow", text(&narrow, folder.path()));
    assert!(text(&narrow, folder.path()).lines().all(|l| l.chars().count() <= 60));
    let usual = text(&printed(folder.path(), "80", &[], &run(&fail, "usual")), folder.path());
    assert!(usual.lines().any(|l| l.starts_with("  Quantity ") && l.ends_with("Limit  Verdict")), "{usual}");
    assert!(usual.lines().all(|l| l.chars().count() <= 80), "{usual}");
    assert!(usual.contains("\nVerdict: FAIL\nReport: usual/report.html\n"), "{usual}");
    let russian = printed(folder.path(), "140", &[("LANG", "ru_RU.UTF-8")], &run(&faults, "ru"));
    insta::assert_snapshot!("russian", text(&russian, folder.path()));
}

#[test]
fn a_comparison_and_a_data_sheet_keep_their_table_at_80_columns() {
    let folder = tempdir().unwrap();
    let units: Vec<String> =
        (1..=6).map(|i| shipped(&format!("samples/lot/SN-300{i}/result.json"))).collect();
    let units: Vec<&str> = units.iter().map(String::as_str).collect();
    for (verb, head) in [("compare", "Unit"), ("datasheet", "Quantity")] {
        let args = [&[verb], units.as_slice(), &["--out", verb]].concat();
        let done = printed(folder.path(), "80", &[], &args);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        let text = text(&done, folder.path());
        let is_head = |l: &str| l.starts_with(&format!("  {head} ")) && l.split_whitespace().count() > 3;
        assert!(text.lines().any(is_head), "{text}");
        assert!(text.lines().all(|l| l.chars().count() <= 80), "{text}");
    }
}

#[test]
fn colour_only_adds_to_the_text() {
    let folder = tempdir().unwrap();
    let fail = sample("fail");
    let plain = printed(folder.path(), "100", &[], &run(&fail, "same"));
    let colour = printed(folder.path(), "100", &[("CLICOLOR_FORCE", "1")], &run(&fail, "same"));
    let none = [("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")];
    let none = printed(folder.path(), "100", &none, &run(&fail, "same"));
    assert!(!plain.stdout.contains(&0x1b) && colour.stdout.contains(&0x1b));
    let coloured = String::from_utf8(colour.stdout.clone()).unwrap();
    assert!(coloured.starts_with("\u{1b}[1m\u{1b}[31mFAIL"), "{coloured:?}");
    assert_eq!(anstream::adapter::strip_str(&coloured).to_string().as_bytes(), plain.stdout);
    assert_eq!(none.stdout, plain.stdout);
}

#[test]
fn an_analysis_prints_coefficients_and_where_they_were_read() {
    let folder = tempdir().unwrap();
    let done = printed(folder.path(), "140", &[], &["analyze", &sample("pass"), "--out", "a"]);
    assert_eq!(done.status.code(), Some(0));
    insta::assert_snapshot!("analysis", text(&done, folder.path()));
}

#[test]
fn phases_are_a_line_each_with_the_reasons_of_the_failed_ones_below() {
    let folder = tempdir().unwrap();
    let root = root();
    let at = |name: &str| root.join(name).display().to_string();
    let args = ["run", &at("procedures/acceptance.toml"), &at("samples/acceptance-fail.toml"), "--out", "p"];
    let done = printed(folder.path(), "120", &[], &args);
    assert_eq!(done.status.code(), Some(1));
    insta::assert_snapshot!("phases", text(&done, folder.path()));
}

#[test]
fn json_is_the_result_and_nothing_else_and_quiet_is_the_place() {
    let folder = tempdir().unwrap();
    let pass = sample("pass");
    let mut args = run(&pass, "j");
    args.extend(["--format", "json"]);
    let json = printed(folder.path(), "80", &[], &args);
    assert_eq!(json.stdout, std::fs::read(folder.path().join("j/result.json")).unwrap());
    let mut args = run(&pass, "q");
    args.push("--quiet");
    assert_eq!(text(&printed(folder.path(), "80", &[], &args), folder.path()), "Report: q/report.html\n");
    args.extend(["--format", "json"]);
    assert_eq!(printed(folder.path(), "80", &[], &args).status.code(), Some(2));
}

#[test]
fn shipped_files_are_found_by_name_and_a_file_of_the_name_wins() {
    let folder = tempdir().unwrap();
    let (pass, at) = (sample("pass"), folder.path());
    let shipped = printed(at, "80", &[], &run(&pass, "one"));
    assert_eq!(shipped.status.code(), Some(0));
    let said = String::from_utf8(shipped.stderr).unwrap();
    assert!(said.contains("static-bias: the shipped file") && said.contains("sample-unit: "), "{said}");
    let show = printed(at, "80", &[], &["procedures", "show", "static-bias"]);
    let text = String::from_utf8(show.stdout).unwrap();
    assert_eq!(text, std::fs::read_to_string(root().join("procedures/static-bias.toml")).unwrap());
    std::fs::write(at.join("static-bias"), text.replace("\"Static bias and noise\"", "\"My own\"")).unwrap();
    let own = printed(at, "80", &[], &run(&pass, "two"));
    assert!(String::from_utf8(own.stdout).unwrap().contains("My own"));
    assert!(String::from_utf8(own.stderr).unwrap().contains("static-bias: the file in this folder"));
    let wrong = printed(at, "80", &[], &["run", "static-bia", &pass]);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8(wrong.stderr).unwrap().contains("did you mean `static-bias`?"));
}

#[test]
fn every_clause_is_listed_with_the_procedures_and_rows_that_deal_with_it() {
    let folder = tempdir().unwrap();
    let listed = |lang: &str| {
        let done = printed(folder.path(), "80", &[], &["procedures", "--clauses", "--lang", lang]);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        text(&done, folder.path())
    };
    let english = listed("en");
    let clauses: Vec<&str> =
        english.split("\n\n").map(|part| part.split_whitespace().next().unwrap_or_default()).collect();
    // By their numbers, not by their letters; what has none comes last.
    assert_eq!(clauses[..3], ["12.1", "12.2", "12.3"]);
    let place =
        |number: &str| clauses.iter().position(|c| *c == number).unwrap_or_else(|| panic!("{number}"));
    assert!(place("12.9") < place("12.10") && place("12.12") < place("Annex"), "{clauses:?}");
    let of = |number: &str| english.split("\n\n").nth(place(number)).unwrap().to_owned();
    assert!(of("12.7").contains("  maximum-rate: ") && of("12.7").contains("polarity"), "{english}");
    assert!(of("12.11").contains("  acceleration: ") && of("12.11").contains("g_sensitivity_i"), "{english}");
    assert!(of("12.11").contains("  output-noise: ") && of("12.11").contains("spectral_mask"), "{english}");
    // No recording closes the leak test.
    assert!(of("12.3").contains("no shipped procedure"), "{english}");
    assert!(english.lines().all(|l| l.chars().count() <= 80), "{english}");
    let russian = listed("ru");
    assert!(
        russian.contains("Испытания на скорость ухода") && russian.contains("нет встроенной"),
        "{russian}"
    );
    let both = printed(folder.path(), "80", &[], &["procedures", "--clauses", "show", "static-bias"]);
    assert_eq!(both.status.code(), Some(2), "{both:?}");
}

#[test]
fn saved_procedures_are_the_shipped_ones_and_replace_nothing() {
    let folder = tempdir().unwrap();
    let at = folder.path();
    let save = ["procedures", "save", "mine"];
    assert_eq!(printed(at, "80", &[], &save).status.code(), Some(0));
    let checked = printed(at, "80", &[], &["check", "mine/acceptance.toml", "mine/static-bias.toml"]);
    assert_eq!(checked.status.code(), Some(0));
    std::fs::write(at.join("mine/static-bias.toml"), "mine").unwrap();
    let refused = printed(at, "80", &[], &save);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8(refused.stderr).unwrap().contains("different content"));
    assert_eq!(std::fs::read_to_string(at.join("mine/static-bias.toml")).unwrap(), "mine");
}

#[test]
fn the_demo_runs_the_main_job_anywhere() {
    let folder = tempdir().unwrap();
    let done = printed(folder.path(), "100", &[], &["demo"]);
    assert_eq!(done.status.code(), Some(0));
    assert!(text(&done, folder.path()).starts_with("PASS  Static bias and noise · SN-0001"));
    assert!(folder.path().join("sagnac-demo/report/report.html").is_file());
    // Again on the same folder is the same; a file of other content is kept.
    assert_eq!(printed(folder.path(), "100", &[], &["demo"]).status.code(), Some(0));
    std::fs::write(folder.path().join("sagnac-demo/unit-pass.csv"), "mine").unwrap();
    assert_eq!(printed(folder.path(), "100", &[], &["demo"]).status.code(), Some(2));
}

#[test]
fn shells_and_manuals_are_served() {
    let folder = tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let done = printed(folder.path(), "80", &[], &["completions", shell]);
        assert!(String::from_utf8(done.stdout).unwrap().contains("sagnac"), "{shell}");
    }
    let man = printed(folder.path(), "80", &[], &["man"]);
    assert!(String::from_utf8(man.stdout).unwrap().contains(".TH sagnac 1"));
    let schema = printed(folder.path(), "80", &[], &["schema", "explain"]);
    let schema: serde_json::Value = serde_json::from_slice(&schema.stdout).unwrap();
    assert!(schema["properties"]["effects"].is_object(), "{schema}");
}

#[test]
fn what_init_writes_is_accepted_as_it_is() {
    let folder = tempdir().unwrap();
    let at = folder.path();
    let text = std::fs::read_to_string(sample("pass")).unwrap();
    let odd = text.replacen(
        "time_s,rate_deg_h,temp_degC",
        "t [s],\"Omega_Z \"\"1\"\" [deg/h]\",T chamber (degC)",
        1,
    );
    assert_ne!(odd, text);
    std::fs::write(at.join("odd name.csv"), odd).unwrap();
    let russian = "\"Время, с\",\"Выход ВОГ, град/ч\",\"Темп. корпуса, °C\"";
    std::fs::write(at.join("стенд.csv"), text.replacen("time_s,rate_deg_h,temp_degC", russian, 1)).unwrap();
    for (recording, out) in [
        ("odd name.csv".to_owned(), "odd"),
        ("стенд.csv".to_owned(), "russian"),
        (sample("pass"), "plain"),
        (sample("faults"), "faults"),
    ] {
        let done = printed(at, "80", &[], &["init", &recording, "--out", out]);
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        let (procedure, limits) = (format!("{out}/procedure.toml"), format!("{out}/limits.toml"));
        let check = printed(at, "80", &[], &["check", &procedure, &limits]);
        assert_eq!(check.status.code(), Some(0), "{}", String::from_utf8_lossy(&check.stdout));
        let report = format!("{out}/report");
        let args =
            ["run", &procedure, &recording, "--limits", &limits, "--serial", "SN-0001", "--out", &report];
        let run = printed(at, "80", &[], &args);
        // A recording passes the limits that are proposed from it, unless its faults keep it from being judged.
        let expected = if out == "faults" { 3 } else { 0 };
        assert_eq!(run.status.code(), Some(expected), "{}", text_of(&run));
        // Nothing is replaced.
        assert_eq!(printed(at, "80", &[], &["init", &recording, "--out", out]).status.code(), Some(2));
    }
}

#[test]
fn init_reads_as_it_is_asked_to_and_the_procedure_says_how() {
    let folder = tempdir().unwrap();
    let at = folder.path();
    // Two lines above the names, of which the first has as many fields as the data, and numbers with a comma.
    let text = std::fs::read_to_string(sample("pass")).unwrap();
    let rows: Vec<String> = text
        .lines()
        .skip_while(|l| l.starts_with('#'))
        .map(|l| l.replace(',', ";").replace('.', ","))
        .collect();
    let odd = format!("station;north;7\nstarted;today;8\n{}\n", rows.join("\n"));
    std::fs::write(at.join("odd.csv"), odd).unwrap();
    let reading = ["--delimiter", "semicolon", "--decimal", "comma", "--header-line", "3"];
    let done = printed(at, "80", &[], &[&["init", "odd.csv", "--out", "o"][..], &reading].concat());
    assert_eq!(done.status.code(), Some(0), "{}", text_of(&done));
    let procedure = std::fs::read_to_string(at.join("o/procedure.toml")).unwrap();
    for key in ["delimiter = \"semicolon\"", "decimal = \"comma\"", "header_line = 3"] {
        assert!(procedure.contains(key), "no `{key}` in\n{procedure}");
    }
    let check = printed(at, "80", &[], &["check", "o/procedure.toml", "o/limits.toml"]);
    assert_eq!(check.status.code(), Some(0), "{}", text_of(&check));
    let run =
        ["run", "o/procedure.toml", "odd.csv", "--limits", "o/limits.toml", "--serial", "1", "--out", "r"];
    let run = printed(at, "80", &[], &run);
    assert_eq!(run.status.code(), Some(0), "{}", text_of(&run));
    // What is shown next reads the same way.
    let inspect = printed(at, "80", &[], &[&["inspect", "odd.csv"][..], &reading].concat());
    let next = text_of(&inspect);
    assert!(
        next.ends_with("sagnac init odd.csv --delimiter semicolon --decimal comma --header-line 3\n"),
        "{next}"
    );
}

#[test]
fn init_copies_the_layout_of_a_raw_file_to_where_its_procedure_finds_it() {
    let folder = tempdir().unwrap();
    let at = folder.path();
    let layout = "format = \"layout/1\"\nrecord_bytes = 8\nsample_rate = \"100 Hz\"\n\n\
        [[field]]\nname = \"rate_deg_h\"\noffset = 0\ntype = \"f64\"\n";
    std::fs::write(at.join("logger.toml"), layout).unwrap();
    let bytes: Vec<u8> = (0..60_000u64).flat_map(|i| white(3, i).to_le_bytes()).collect();
    std::fs::write(at.join("raw.bin"), bytes).unwrap();
    let done = printed(at, "80", &[], &["init", "raw.bin", "--layout", "logger.toml", "--out", "o"]);
    assert_eq!(done.status.code(), Some(0), "{}", text_of(&done));
    let procedure = std::fs::read_to_string(at.join("o/procedure.toml")).unwrap();
    assert!(procedure.contains("layout = \"layout.toml\""), "{procedure}");
    assert_eq!(std::fs::read_to_string(at.join("o/layout.toml")).unwrap(), layout);
    let check = printed(at, "80", &[], &["check", "o/procedure.toml"]);
    assert_eq!(check.status.code(), Some(0), "{}", text_of(&check));
    let run = printed(at, "80", &[], &["run", "o/procedure.toml", "raw.bin", "--serial", "1", "--out", "r"]);
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", text_of(&run));
    // In its own folder it is used where it is.
    let done = printed(at, "80", &[], &["init", "raw.bin", "--layout", "logger.toml"]);
    assert_eq!(done.status.code(), Some(0), "{}", text_of(&done));
    let procedure = std::fs::read_to_string(at.join("procedure.toml")).unwrap();
    assert!(procedure.contains("layout = \"logger.toml\""), "{procedure}");
}

fn text_of(output: &Output) -> String {
    String::from_utf8_lossy(&[&output.stdout[..], &output.stderr].concat()).into_owned()
}

/// The picture of a terminal in the README: what the quick start prints, in its colours. `SAGNAC_WRITE_FIGURES=1` writes it.
#[test]
fn the_picture_of_a_terminal_shows_what_is_printed() {
    let folder = tempdir().unwrap();
    for name in ["procedures", "samples"] {
        std::os::unix::fs::symlink(root().join(name), folder.path().join(name)).unwrap();
    }
    let args = [
        "run",
        "procedures/static-bias.toml",
        "samples/unit-pass.csv",
        "--limits",
        "procedures/limits/sample-unit.toml",
        "--serial",
        "SN-0001",
        "--out",
        "report",
    ];
    let ran = printed(folder.path(), "100", &[("CLICOLOR_FORCE", "1")], &args);
    assert_eq!(ran.status.code(), Some(0), "{ran:?}");
    let told = format!("$ sagnac {}\n{}", args.join(" "), String::from_utf8(ran.stdout).unwrap());
    let drawn = anstyle_svg::Term::new().render_svg(&told);
    let path = root().join("docs/terminal.svg");
    if std::env::var_os("SAGNAC_WRITE_FIGURES").is_some() {
        std::fs::write(&path, &drawn).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(drawn == kept, "docs/terminal.svg is of another version: write it with SAGNAC_WRITE_FIGURES=1");
}
