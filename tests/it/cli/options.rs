//! Options that mean the same in every verb: lengths of time, forms, the model of a device; and what a slip of the pen is answered.

use super::refused;
use crate::support::shared::{analyzed_once, shared, tested_once};
use crate::support::{limits, names, procedure, sagnac, sample};
use serde_json::Value;
use std::fs;
use tempfile::tempdir;

#[test]
fn a_length_of_time_has_its_unit_in_every_verb() {
    let warm_up = |given: &str| {
        let run = shared(&["analyze", &sample("pass"), "--warm-up", given], "w");
        assert_eq!(run.said.code, 0, "{given}: {:?}", run.said);
        run.result()["window"].clone()
    };
    // A number without a unit keeps its meaning: seconds.
    let seconds = warm_up("1800");
    for given in ["30min", "30 min", "0.5h", "1800s"] {
        assert_eq!(warm_up(given), seconds, "{given}");
    }
    assert_ne!(seconds, analyzed_once("pass").result()["window"]);

    let dir = tempdir().unwrap();
    let pass = sample("pass");
    for (args, option) in [
        (&["analyze", &*pass, "--warm-up", "3 deg"][..], "--warm-up"),
        (&["compare", &pass, "--warm-up", "3 deg"], "--warm-up"),
        (&["init", &pass, "--warm-up", "3 deg"], "--warm-up"),
        (&["plan", "explained", "--model", "m.toml", "--budget", "8"], "--budget"),
        (&["simulate", "m.toml", "--out", "a.csv", "--duration", "8"], "--duration"),
        (&["model", &pass, "--out", "m.toml", "--from", "8"], "--from"),
        (&["model", &pass, "--out", "m.toml", "--to", "8"], "--to"),
    ] {
        refused(dir.path(), args, &[option, "write a number with its unit"]);
        let russian = sagnac(dir.path(), &[args, &["--lang", "ru"]].concat());
        assert_eq!(russian.code, 2, "{russian:?}");
        assert!(russian.err.contains("напишите число с единицей"), "{}", russian.err);
    }
}

#[test]
fn averaging_times_may_have_their_units() {
    let table = |taus: &str| shared(&["analyze", &sample("pass"), "--taus", taus], "t").text("sigma_tau.csv");
    assert_eq!(table("10s,1min,0.5h"), table("10,60,1800"));
}

#[test]
fn forms_are_a_list_in_every_verb_that_writes_pages() {
    let dir = tempdir().unwrap();
    let run = |more: &[&str], out: &str| {
        let (procedure, pass, limits) = (procedure(), sample("pass"), limits());
        let args = ["run", &procedure, &pass, "--limits", &limits, "--serial", "SN-1", "--out", out];
        sagnac(dir.path(), &[&args, more].concat())
    };
    let said = run(&["--format", "md,csv"], "two");
    assert_eq!(said.code, 0, "{said:?}");
    let written = names(&dir.path().join("two"));
    for name in ["report.md", "measurands.csv", "result.json", "procedure.toml", "SHA256SUMS"] {
        assert!(written.contains(&name.to_owned()), "{name} is not among {written:?}");
    }
    assert!(!written.contains(&"report.html".to_owned()), "{written:?}");
    assert!(said.out.ends_with("two/report.md\n"), "the page that was written is named: {}", said.out);

    // The record alone is printed, as it is in the folder.
    let said = run(&["--format", "json"], "one");
    assert_eq!(said.out.as_bytes(), fs::read(dir.path().join("one/result.json")).unwrap());
    assert!(!dir.path().join("one/report.html").exists());
    tested_once("pass").copy_to(&dir.path().join("r"));
    let said = sagnac(dir.path(), &["report", "r", "--format", "json", "--out", "again"]);
    assert_eq!(said.out.as_bytes(), fs::read(dir.path().join("again/result.json")).unwrap());

    let said = sagnac(dir.path(), &["effects", "bias_step", "--format", "json"]);
    assert!(serde_json::from_str::<Value>(&said.out).is_ok(), "{said:?}");
    for verb in ["run", "analyze", "compare", "datasheet", "explain", "plan", "prove", "report", "effects"] {
        let help = sagnac(dir.path(), &[verb, "--help"]).out;
        assert!(help.contains("--format <FORM>") && !help.contains("--json"), "{verb}: {help}");
    }
}

#[test]
fn a_device_model_and_a_model_file_have_different_names() {
    let dir = tempdir().unwrap();
    let help = |verb: &str| sagnac(dir.path(), &[verb, "--help"]).out;
    for verb in ["datasheet", "history"] {
        assert!(help(verb).contains("--device-model <DEVICE>"), "{}", help(verb));
        assert!(!help(verb).contains("--model "), "{}", help(verb));
    }
    for verb in ["explain", "plan"] {
        assert!(help(verb).contains("--model <FILE>") && !help(verb).contains("--device-model"));
    }
}

#[test]
fn a_slip_in_the_name_of_a_file_is_answered_with_the_nearest_name() {
    let dir = tempdir().unwrap();
    fs::write(dir.path().join("my-limits.toml"), "").unwrap();
    fs::create_dir(dir.path().join("own")).unwrap();
    fs::copy(procedure(), dir.path().join("own/soak.toml")).unwrap();
    let pass = sample("pass");
    for (args, near) in [
        (&["run", "static-bais", &*pass][..], "did you mean `static-bias`?"),
        (&["run", "static-bias", &pass, "--limits", "sample-unti"], "did you mean `sample-unit`?"),
        (&["run", "static-bias", &pass, "--limits", "my-limit.toml"], "did you mean `my-limits.toml`?"),
        (&["run", "own/saok.toml", &pass], "did you mean `own/soak.toml`?"),
        (&["run", "zebra", &pass], "shipped procedures: acceleration, "),
    ] {
        let said = sagnac(dir.path(), args);
        assert!(said.code == 2 && said.err.contains(near), "{args:?}: {said:?}");
    }
    let russian = sagnac(dir.path(), &["run", "static-bais", &pass, "--lang", "ru"]);
    assert!(russian.err.contains("`static-bias`"), "{russian:?}");
}

#[test]
fn where_limits_are_required_nothing_decided_is_no_pass() {
    let dir = tempdir().unwrap();
    let (procedure, pass, limits) = (procedure(), sample("pass"), limits());
    let code = |more: &[&str], out: &str| {
        let args = ["run", &procedure, &pass, "--serial", "SN-1", "--quiet", "--out", out];
        sagnac(dir.path(), &[&args, more].concat()).code
    };
    assert_eq!(code(&[], "without"), 0);
    assert_eq!(code(&["--require-limits"], "required"), 3);
    assert_eq!(code(&["--require-limits", "--limits", &limits], "decided"), 0);
    let each = ["run", &procedure, &pass, "--each", "--serial-from", "{stem}", "--quiet", "--require-limits"];
    assert_eq!(sagnac(dir.path(), &[&each[..], &["--out", "lot"]].concat()).code, 3);
}

#[test]
fn init_writes_its_comments_in_the_language_asked_for() {
    let dir = tempdir().unwrap();
    let pass = sample("pass");
    for lang in ["en", "ru"] {
        let said = sagnac(dir.path(), &["init", &pass, "--lang", lang, "--out", lang]);
        assert_eq!(said.code, 0, "{said:?}");
    }
    for name in ["procedure.toml", "limits.toml", "ci.yml"] {
        let read = |lang: &str| fs::read_to_string(dir.path().join(lang).join(name)).unwrap();
        let without_comments = |lang: &str| {
            let text = read(lang);
            let lines = text.lines().filter(|line| !line.starts_with('#')).map(str::to_owned);
            lines.collect::<Vec<_>>()
        };
        assert_eq!(without_comments("en"), without_comments("ru"), "{name}");
        let is_cyrillic = |c: char| matches!(c, 'а'..='я' | 'А'..='Я');
        let comments = |lang: &str| -> Vec<String> {
            let text = read(lang);
            let of_words = text.lines().filter(|l| l.starts_with("# ") && !l.contains(" = "));
            of_words.filter(|l| !l.starts_with("# [")).map(str::to_owned).collect()
        };
        assert!(comments("ru").iter().all(|l| l.contains(is_cyrillic)), "{:#?}", comments("ru"));
        assert!(comments("en").iter().all(|l| !l.contains(is_cyrillic)), "{:#?}", comments("en"));
    }
    let checked = sagnac(dir.path(), &["check", "ru/procedure.toml", "ru/limits.toml"]);
    assert_eq!(checked.code, 0, "{checked:?}");
}

#[test]
fn verify_names_a_verdict_in_the_language_of_the_reader() {
    let dir = tempdir().unwrap();
    tested_once("fail").copy_to(&dir.path().join("r"));
    let russian = sagnac(dir.path(), &["verify", "r", "--lang", "ru"]).out;
    assert!(russian.contains("не годен") && !russian.contains("fail"), "{russian}");
}
