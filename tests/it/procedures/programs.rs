//! `[[program]]`: rows that a program of the user gives, what it is handed, what it may reach, and what goes wrong with it.

use crate::support::quick::Quick;
use crate::support::{Said, altered, result, sagnac};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// An answer with one estimate.
fn answer(estimate: &str) -> String {
    format!("{{\"format\": \"measurand/1\", \"estimates\": [{estimate}]}}")
}

/// A script that gives an answer without looking at its question.
fn echo(answer: &str) -> String {
    format!("read question\necho '{answer}'\n")
}

const DRIFT: &str = "{\"id\": \"day_drift\", \"unit\": \"deg/h\", \"value\": 0.2, \"interval\": [0.1, 0.3]}";

const LIMIT: &str = "[[derived_limit]]\nderived = \"day_drift\"\nmax = \"0.5 deg/h\"\n";

/// The table of a script that gives `day_drift`.
fn table(script: &str) -> String {
    let hash: String = Sha256::digest(script).iter().map(|byte| format!("{byte:02x}")).collect();
    format!(
        "[[program]]\nid = \"drift\"\ncommand = [\"sh\", \"drift.sh\"]\nsha256 = \"{hash}\"\nversion = \"1.2\"\n\
         timeout = \"20 s\"\nreturns = [{{ id = \"day_drift\", unit = \"deg/h\" }}]\n{LIMIT}"
    )
}

/// Writes a script and the quick procedure with tables that name it; gives the name of the procedure.
fn prepared(folder: &Path, script: &str, tables: &str) -> String {
    fs::write(folder.join("drift.sh"), script).unwrap();
    let tables = format!("{tables}\n[[measurand]]");
    altered(folder, "p.toml", &Quick::new("pass").procedure, &[("[[measurand]]", &tables)])
}

/// Runs the quick test with a script and the tables that name it.
fn run_with(folder: &Path, script: &str, tables: &str) -> Said {
    let quick = Quick::new("pass");
    let procedure = prepared(folder, script, tables);
    let arguments = ["--limits", &quick.limits, "--serial", "SN-1", "--out", "r"];
    sagnac(folder, &[&["run", &procedure, &quick.recording], &arguments[..]].concat())
}

fn run(folder: &Path, script: &str) -> Said {
    run_with(folder, script, &table(script))
}

fn rows(folder: &Path, id: &str) -> Value {
    let result = result(&folder.join("r"));
    result["measurands"].as_array().unwrap().iter().find(|r| r["id"] == id).unwrap().clone()
}

#[test]
fn a_program_gives_a_row_that_is_judged_and_marked_as_its_own() {
    let dir = tempfile::tempdir().unwrap();
    let script = echo(&answer(DRIFT));
    let said = run(dir.path(), &script);
    // The limits file replaces no limit that it does not have.
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let row = rows(dir.path(), "day_drift");
    assert_eq!((row["method"].as_str(), row["verdict"].as_str()), (Some("program"), Some("pass")), "{row}");
    assert!((row["value"].as_f64().unwrap() - 0.2).abs() < 1e-12, "{row}");
    assert!((row["interval"]["high"].as_f64().unwrap() - 0.3).abs() < 1e-3, "{row}");
    let own = row["notes"].as_array().unwrap().iter().find(|n| n["id"] == "program.own").unwrap();
    assert_eq!(own["args"]["version"], "1.2");
    let hash = own["args"]["sha256"].as_str().unwrap();
    assert!(table(&script).contains(hash), "{own}");
    let page = fs::read_to_string(dir.path().join("r/report.html")).unwrap();
    assert!(page.contains("customer&#39;s own program <code>drift</code>"), "marked as the customer's own");
    assert!(page.contains(hash) && page.contains("1.2"), "hash and version stand on the page");

    let worse = answer(&DRIFT.replace("0.2,", "0.7,").replace("[0.1, 0.3]", "[0.6, 0.8]"));
    assert_eq!(run(dir.path(), &echo(&worse)).code, 1);
    // The same in another unit, with a standard uncertainty.
    let other =
        "{\"id\": \"day_drift\", \"unit\": \"deg/s\", \"value\": 5e-5, \"standard_uncertainty\": 1e-6}";
    assert_eq!(run(dir.path(), &echo(&answer(other))).code, 0);
    assert!((rows(dir.path(), "day_drift")["value"].as_f64().unwrap() - 0.18).abs() < 1e-12);
}

#[test]
fn a_program_is_handed_the_channels_with_their_units_and_the_unit() {
    let dir = tempfile::tempdir().unwrap();
    // The number of rows by the size of the raw column, and the mean of three values by their bytes, as the program sees them.
    let script = "read question\n\
        file=$(printf %s \"$question\" | sed 's/.*\"id\":\"rate\",\"role\":\"rate\",\"unit\":\"deg\\/h\",\"file\":\"\\([^\"]*\\)\".*/\\1/')\n\
        scratch=$(printf %s \"$question\" | sed 's/.*\"scratch\":\"\\([^\"]*\\)\".*/\\1/')\n\
        case $question in *'\"format\":\"measurand/1\"'*'\"serial\":\"SN-1\"'*) ;; *) exit 3 ;; esac\n\
        echo kept > \"$scratch/own\" || exit 4\n\
        rows=$(($(wc -c < \"$file\") / 8))\n\
        first=$(od -An -N8 -t f8 \"$file\" | tr -d ' ')\n\
        echo '{\"format\": \"measurand/1\", \"estimates\": [{\"id\": \"day_drift\", \"unit\": \"deg/h\", \"value\": '$first', \
        \"standard_uncertainty\": '$rows'}]}'\n";
    let said = run(dir.path(), script);
    let row = rows(dir.path(), "day_drift");
    let quick = fs::read_to_string(Quick::new("pass").recording).unwrap();
    let first: f64 = quick.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse().unwrap();
    assert!((row["value"].as_f64().unwrap() - first).abs() < 1e-4, "{row} {first} {}", said.err);
    let half = row["interval"]["high"].as_f64().unwrap() - first;
    assert!((half / 1.96 - 3000.0).abs() < 3.0, "3000 rows, not {}", half / 1.96);
}

#[test]
fn whatever_goes_wrong_leaves_its_own_row_open_and_no_other() {
    let dir = tempfile::tempdir().unwrap();
    let twice = format!("{DRIFT}, {DRIFT}");
    let of = |estimate: &str| echo(&answer(estimate));
    for (script, id) in [
        ("echo no plateau >&2\nexit 7\n".to_owned(), "program.failed"),
        ("kill -9 $$\n".to_owned(), "program.failed"),
        ("echo nonsense\n".to_owned(), "program.garbage"),
        (":\n".to_owned(), "program.garbage"),
        (echo(&format!("{}\n{}", answer(DRIFT), answer(DRIFT))), "program.garbage"),
        (
            "while :; do echo aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa; done\n".to_owned(),
            "program.too_much",
        ),
        (echo(&answer(DRIFT).replace("measurand/1", "measurand/9")), "program.format"),
        (of(&DRIFT.replace("day_drift", "static_bias")), "program.unknown_id"),
        (of(&twice), "program.answered_twice"),
        (of(""), "program.not_answered"),
        (of(&DRIFT.replace("deg/h", "V")), "external.other_unit"),
        (of(&DRIFT.replace(", \"interval\": [0.1, 0.3]", "")), "program.no_interval"),
        (of(&DRIFT.replace("[0.1, 0.3]", "[0.3, 0.4]")), "program.interval"),
        (of(&DRIFT.replace("\"value\": 0.2, ", "")), "program.no_value"),
        (of("{\"id\": \"day_drift\", \"unresolved\": \"too short\"}"), "program.unresolved"),
    ] {
        let said = run(dir.path(), &script);
        assert_eq!(said.code, 3, "{script}: {}{}", said.out, said.err);
        let row = rows(dir.path(), "day_drift");
        assert!(row["value"].is_null() && row["verdict"] == "indeterminate", "{script}: {row}");
        let notes: Vec<&str> =
            row["notes"].as_array().unwrap().iter().filter_map(|n| n["id"].as_str()).collect();
        assert!(notes.contains(&id) && notes.contains(&"program.own"), "{script}: {row}");
        assert_eq!(rows(dir.path(), "angle_random_walk")["verdict"], "pass", "{script}");
    }
    let said = run(dir.path(), "echo no plateau >&2\nexit 7\n");
    assert!(rows(dir.path(), "day_drift").to_string().contains("(7): no plateau"), "{}", said.out);
}

#[test]
fn a_program_that_takes_too_long_is_ended_with_what_it_started() {
    let dir = tempfile::tempdir().unwrap();
    let script = "sleep 300 &\nsleep 300\n";
    let tables = table(script).replace("20 s", "0.3 s");
    let began = Instant::now();
    let said = run_with(dir.path(), script, &tables);
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    assert!(rows(dir.path(), "day_drift").to_string().contains("program.late"));
    assert!(began.elapsed() < Duration::from_secs(60), "{:?}", began.elapsed());
}

#[test]
fn a_program_of_another_hash_is_told_by_check_and_not_run() {
    let dir = tempfile::tempdir().unwrap();
    let stated = echo(&answer(DRIFT));
    let changed = format!("{stated}echo ran >&2\n");
    let said = run_with(dir.path(), &changed, &table(&stated));
    assert_eq!(said.code, 3, "{}{}", said.out, said.err);
    assert!(rows(dir.path(), "day_drift").to_string().contains("program.hash"));
    let said = sagnac(dir.path(), &["check", "p.toml"]);
    assert!(said.out.contains("p.toml:") && said.out.contains("SHA-256"), "{}{}", said.out, said.err);
    // Nor is one that is not there.
    fs::remove_file(dir.path().join("drift.sh")).unwrap();
    let said = sagnac(dir.path(), &["check", "p.toml"]);
    assert!(said.out.contains("command"), "{}{}", said.out, said.err);
}

#[test]
fn a_program_writes_nowhere_but_in_its_scratch_folder() {
    let (dir, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (secret, at) = (outside.path().join("secret"), outside.path().join("escaped"));
    fs::write(&secret, "secret").unwrap();
    let script = format!(
        "read question\ncat '{}' >&2 && seen=1\n( echo x > '{}' )\n( echo x >> drift.sh )\n\
         echo '{}'\n[ -z \"$seen\" ] && [ -z \"$HOME\" ]\n",
        secret.display(),
        at.display(),
        answer(DRIFT)
    );
    let said = run(dir.path(), &script);
    let row = rows(dir.path(), "day_drift");
    if row.to_string().contains("program.not_confined") {
        println!("skipped: this kernel confines nothing");
        return;
    }
    assert_eq!(said.code, 0, "{row} {}", said.err);
    assert!(!at.exists() && fs::read_to_string(dir.path().join("drift.sh")).unwrap() == script);
}

#[test]
fn mistakes_are_named_at_their_place() {
    let dir = tempfile::tempdir().unwrap();
    let script = echo(&answer(DRIFT));
    let sound = table(&script);
    let external = "[[external]]\nid = \"day_drift\"\nunit = \"deg/h\"\n";
    let formula = "[[derived]]\nid = \"day_drift\"\nunit = \"deg/sqrt(h)\"\nvalue = \"angle_random_walk\"\n";
    let returns = "{ id = \"day_drift\", unit = \"deg/h\" }";
    let second = sound.replace(LIMIT, "");
    for (tables, says) in [
        (sound.replace("\"day_drift\", unit", "\"static_bias\", unit"), "static_bias"),
        (sound.replace(returns, &format!("{returns}, {returns}")), "second quantity `day_drift`"),
        (format!("{second}{sound}"), "second"),
        (format!("{sound}{external}"), "second quantity"),
        (format!("{sound}{formula}"), "day_drift"),
        (sound.replace("sha256 = \"", "sha256 = \"x"), "SHA-256"),
        (sound.replace("timeout", "channels = [\"rat\"]\ntimeout"), "no channel `rat`"),
        (sound.replace("timeout", "reads = [\"here\"]\ntimeout"), "absolute"),
        (sound.replace("20 s", "-1 s"), "timeout"),
        (sound.replace("max = \"0.5 deg/h\"", "max = \"0.5 V\""), "V"),
        (sound.replace("version = \"1.2\"\n", ""), "version"),
    ] {
        let procedure = prepared(dir.path(), &script, &tables);
        let said = sagnac(dir.path(), &["check", &procedure]);
        assert_eq!(said.code, 2, "{tables}: {}", said.out);
        assert!(said.out.contains(says) && said.out.contains("p.toml:"), "{tables}: {}", said.out);
    }
    let procedure = prepared(dir.path(), &script, &sound);
    let said = sagnac(dir.path(), &["check", &procedure]);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
}

#[test]
fn a_check_of_a_folder_runs_no_program_that_came_with_it() {
    let dir = tempfile::tempdir().unwrap();
    let script = echo(&answer(DRIFT));
    assert_eq!(run(dir.path(), &script).code, 0);
    let recording = Quick::new("pass").recording;
    let said = sagnac(dir.path(), &["verify", "r", "--recording", &recording]);
    assert!(said.out.contains("--procedure"), "{}{}", said.out, said.err);
    let said = sagnac(dir.path(), &["verify", "r", "--recording", &recording, "--procedure", "p.toml"]);
    assert!(!said.out.contains("--procedure"), "{}{}", said.out, said.err);
}
