//! What is said of mistakes that people make often: names that are nearly right, text without quotes, columns that a
//! recording lacks, a procedure of phases without its manifest; and what is not said of files that are right.

use crate::support::synthetic::recording;
use crate::support::{Said, altered, names, procedure, result, root, sagnac, sample, short_procedure};
use std::path::Path;
use tempfile::tempdir;

/// What `check` says of the static procedure with one text replaced: one diagnostic, exit code 2.
fn one_mistake(folder: &Path, from: &str, to: &str) -> String {
    let path = altered(folder, "p.toml", &procedure(), &[(from, to)]);
    let said = sagnac(folder, &["check", &path]);
    assert_eq!(said.code, 2, "{to}: {said:?}");
    assert_eq!(said.out.matches("error: ").count(), 1, "{to}: {}", said.out);
    said.out
}

#[test]
fn measurands_and_roles_are_offered_by_what_they_mean() {
    let dir = tempdir().unwrap();
    let id = "[[measurand]]\nid = \"angle_random_walk\"\n";
    for (written, meant) in [
        ("arw", "did you mean `angle_random_walk`?"),
        ("N", "did you mean `angle_random_walk`?"),
        ("rrw", "did you mean `rate_random_walk`?"),
        ("bi", "did you mean `bias_instability`?"),
        ("bias", "did you mean `static_bias`?"),
        ("sf", "did you mean `scale_factor`?"),
        ("misalignment", "one of: misalignment_x, misalignment_y"),
        ("hysteresis", "one of: thermal_hysteresis, scale_factor_hysteresis"),
    ] {
        let said = one_mistake(dir.path(), id, &id.replace("angle_random_walk", written));
        assert!(said.contains(meant), "{written}: {said}");
    }
    for (written, meant) in [("temp", "temperature"), ("thermometer", "temperature"), ("voltage", "supply")] {
        let said = one_mistake(dir.path(), "role = \"temperature\"", &format!("role = \"{written}\""));
        assert!(said.contains(&format!("did you mean \"{meant}\"?")), "{written}: {said}");
    }
}

#[test]
fn text_without_quotes_is_shown_with_them() {
    let dir = tempdir().unwrap();
    for (from, to, message, right) in [
        ("id = \"temp\"", "id = temp", "text must be in quotes", "write `id = \"temp\"`"),
        (
            "role = \"temperature\"",
            "role = temperature # sensor",
            "text must be in quotes",
            "write `role = \"temperature\"`",
        ),
        ("unit = \"deg/h\"", "unit = deg/h", "text must be in quotes", "write `unit = \"deg/h\"`"),
        (
            "nominal = \"20 degC\"",
            "nominal = 20 degC",
            "text must be in quotes",
            "write `nominal = \"20 degC\"`",
        ),
        (
            "column = \"rate_deg_h\"",
            "column = Omega_z [deg/h]",
            "text must be in quotes",
            "write `column = \"Omega_z [deg/h]\"`",
        ),
        ("revision = \"A\"", "revision = “A”", "straight double quotes", "write `revision = \"A\"`"),
        ("serial_required = true", "serial_required = True", "lower case", "write `serial_required = true`"),
        ("revision = \"A\"", "revision: \"A\"", "`=` separates", "write `revision = \"A\"`"),
    ] {
        let said = one_mistake(dir.path(), from, to);
        assert!(said.contains(message) && said.contains(right), "{to}: {said}");
    }
    // Mistakes on two lines are two.
    let both =
        [("revision = \"A\"", "revision = A"), ("column = \"rate_deg_h\"", "column = Omega_z [deg/h]")];
    let path = altered(dir.path(), "p.toml", &procedure(), &both);
    let said = sagnac(dir.path(), &["check", &path]).out;
    assert!(said.contains("write `revision = \"A\"`") && said.contains("2 problems"), "{said}");
    let text = std::fs::read_to_string(procedure()).unwrap().replace("= 2030-12-31", "= 31.12.2030");
    std::fs::write(dir.path().join("p.toml"), text).unwrap();
    let said = sagnac(dir.path(), &["check", "p.toml"]);
    assert!(said.out.contains("write `calibration_due = 2030-12-31`"), "{}", said.out);
}

/// A recording of other columns than those of the shipped procedures.
fn other_columns(folder: &Path) {
    let rows = recording(300).replacen("time_s,rate_deg_h,temp_degC", "t,Omega_z [deg/h],temp_C", 1);
    std::fs::write(folder.join("w.csv"), rows).unwrap();
}

#[test]
fn a_column_that_is_missing_is_told_at_the_line_that_asks_for_it() {
    let dir = tempdir().unwrap();
    other_columns(dir.path());
    let short = short_procedure(dir.path());
    let path = altered(dir.path(), "p.toml", &short, &[("column = \"rate_deg_h\"", "column = \"Omega_z\"")]);
    let text = std::fs::read_to_string(&path).unwrap();
    let said = sagnac(dir.path(), &["run", "p.toml", "w.csv", "--serial", "S", "--out", "r"]);
    assert_eq!(said.code, 2, "{said:?}");
    // All of them at once.
    assert_eq!(said.err.matches("error: ").count(), 3, "{}", said.err);
    for (column, meant) in [("time_s", "t"), ("Omega_z", "Omega_z [deg/h]"), ("temp_degC", "temp_C")] {
        let line = text.lines().position(|l| l == format!("column = \"{column}\"")).unwrap() + 1;
        let place = format!("p.toml:{line}:11\n");
        let shown = format!("{line} | column = \"{column}\"");
        let missing = format!("w.csv: there is no column `{column}`");
        let hint = format!("did you mean `{meant}`? The file has: t, Omega_z [deg/h], temp_C");
        for part in [place, shown, missing, hint] {
            assert!(said.err.contains(&part), "no `{part}` in\n{}", said.err);
        }
    }
    assert!(said.err.ends_with("Written to the report: r\n"), "{}", said.err);
    assert_eq!(result(&dir.path().join("r"))["verdict"], "error");
    // Of a shipped procedure the next step is one of its own.
    let said = sagnac(dir.path(), &["run", "static-bias", "w.csv", "--out", "s"]);
    assert!(said.err.contains("static-bias:") && said.err.ends_with("  sagnac init w.csv\n"), "{}", said.err);
}

#[test]
fn a_phase_tells_its_missing_columns_once_and_at_their_lines() {
    let dir = tempdir().unwrap();
    other_columns(dir.path());
    let short = short_procedure(dir.path());
    let name = Path::new(&short).file_name().unwrap().to_string_lossy().into_owned();
    let phased = format!(
        "format = \"procedure/1\"\n[procedure]\nid = \"w\"\ntitle = \"W\"\nrevision = \"A\"\n\n[[phase]]\nid = \"a\"\nprocedure = \"{name}\"\n"
    );
    std::fs::write(dir.path().join("w.toml"), phased).unwrap();
    let manifest = "format = \"manifest/1\"\n[[file]]\npath = \"w.csv\"\nphase = \"a\"\n";
    std::fs::write(dir.path().join("m.toml"), manifest).unwrap();
    let said = sagnac(dir.path(), &["run", "w.toml", "m.toml", "--serial", "S", "--out", "r"]);
    assert_eq!(said.code, 2, "{said:?}");
    assert_eq!(said.err.matches("error: ").count(), 3, "{}", said.err);
    assert!(said.err.contains(&format!("{name}:")) && said.err.contains("did you mean `t`?"), "{}", said.err);
}

#[test]
fn a_procedure_of_phases_shows_its_manifest_and_runs_by_name() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["run", "acceptance", &sample("pass")]);
    assert_eq!(said.code, 2, "{said:?}");
    assert_eq!(said.err.matches("error: ").count(), 1, "{}", said.err);
    let (_, manifest) = said.err.split_once("\n\n").unwrap();
    // What is shown is a manifest once its files are there.
    std::fs::write(dir.path().join("manifest.toml"), manifest).unwrap();
    for (phase, file) in [
        ("repeatability", "bias-repeatability-pass"),
        ("scale-factor", "scale-factor-fail"),
        ("alignment", "misalignment-pass"),
    ] {
        let from = root().join(format!("samples/{file}.csv"));
        std::fs::copy(from, dir.path().join(format!("{phase}.csv"))).unwrap();
    }
    let checked = sagnac(dir.path(), &["check", "acceptance", "manifest.toml"]);
    assert_eq!(checked.code, 0, "{checked:?}");
    let said = sagnac(dir.path(), &["run", "acceptance", "manifest.toml", "--out", "r"]);
    assert_eq!(said.code, 1, "{said:?}");
    assert!(said.err.contains("acceptance: the shipped file"), "{}", said.err);
    assert_eq!(result(&dir.path().join("r"))["phases"].as_array().unwrap().len(), 3);
    // A manifest that is not there is reported as such.
    let said = sagnac(dir.path(), &["run", "acceptance", "none.toml"]);
    assert!(
        said.code == 2 && said.err.contains("none.toml") && said.err.contains("cannot be read"),
        "{said:?}"
    );
}

/// Standard output of `check`: no warning, no error, a line for each file and the total.
fn silent(said: &Said, files: usize) {
    assert_eq!((said.code, said.err.as_str()), (0, ""), "{}", said.out);
    assert!(!said.out.contains("warning: "), "{}", said.out);
    // Indented lines state lengths of records.
    let of_files = said.out.lines().filter(|line| !line.starts_with("  "));
    assert_eq!(of_files.count(), files + 1, "{}", said.out);
    let total = format!("Files: {files}; with errors: 0; warnings: 0.\n");
    assert!(said.out.ends_with(&total), "{}", said.out);
}

#[test]
fn check_is_silent_on_all_shipped_files_and_on_its_own_example() {
    let help = sagnac(root(), &["check", "--help"]).out;
    let (_, example) = help.split_once("\nExample:\n").unwrap();
    let example = example.trim().strip_prefix("sagnac check ").unwrap().trim_matches('\'');
    let count = |folder: &str| {
        let entries = std::fs::read_dir(root().join(folder)).unwrap();
        entries.filter(|e| e.as_ref().unwrap().path().extension().is_some_and(|e| e == "toml")).count()
    };
    let all = count("procedures") + count("procedures/limits");
    let said = sagnac(root(), &["check", example]);
    silent(&said, all);
    assert!(said.out.contains("limits/sample-unit.toml: limits `sample-unit`"), "{}", said.out);
    assert!(said.out.contains("; checked with static-bias\n"), "{}", said.out);
    assert!(said.out.contains("; checked with temperature-ramp, temperature-soak\n"), "{}", said.out);
    // The same file twice is one file, and a pattern of none is an error.
    let twice = sagnac(root(), &["check", "procedures/*.toml", "procedures/static-bias.toml"]);
    silent(&twice, count("procedures"));
    let none = sagnac(root(), &["check", "procedures/*.tml"]);
    assert!(none.code == 2 && none.err.contains("no file matches"), "{none:?}");
    assert!(names(root()).contains(&"Cargo.toml".to_owned()));
}

#[test]
fn a_limits_file_is_judged_with_the_procedures_that_it_belongs_to() {
    let dir = tempdir().unwrap();
    let head = "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"L\"\nrevision = \"A\"\n";
    let limit = |id: &str, unit: &str| format!("[[limit]]\nmeasurand = \"{id}\"\nmax = \"50 {unit}\"\n");
    let check = |text: String, procedures: &[&str]| {
        std::fs::write(dir.path().join("l.toml"), format!("{head}{text}")).unwrap();
        let said = sagnac(dir.path(), &[&["check", "l.toml"], procedures].concat());
        assert_eq!(said.code, 0, "{said:?}");
        (said.out.matches("warning: ").count(), said.out)
    };
    let of_both = || limit("dead_zone", "deg/h") + &limit("warm_up_time", "s");
    // Each limit is used by one of them.
    let (warnings, said) = check(of_both(), &["threshold", "warm-up", "vibration"]);
    assert!(warnings == 0 && said.contains("checked with threshold, warm-up\n"), "{said}");
    // One limit is used by none: said once.
    let (warnings, said) = check(of_both(), &["threshold", "vibration", "static-bias"]);
    assert!(warnings == 1 && said.contains("this limit is not used: procedure `threshold`"), "{said}");
    // No limit is used by any: said once.
    let (warnings, said) = check(limit("warm_up_time", "s"), &["threshold", "vibration"]);
    assert!(warnings == 1 && said.contains("the procedures threshold, vibration measure"), "{said}");
    // A planned duration is what limits are to be decided in; it cannot be shorter than the least.
    let planned = "planned_duration = \"100 h\"";
    let path = altered(dir.path(), "p.toml", &procedure(), &[(planned, "planned_duration = \"9 h\"")]);
    let said = sagnac(dir.path(), &["check", &path]);
    assert!(said.code == 2 && said.out.contains("shorter than `minimum_duration`"), "{}", said.out);
}

#[test]
fn a_next_step_is_shown_where_there_is_one_and_never_beside_json() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("my unit.csv"), recording(3000)).unwrap();
    let said = sagnac(dir.path(), &["inspect", "my unit.csv"]);
    assert!(said.out.ends_with("\n  sagnac init 'my unit.csv'\n"), "{}", said.out);
    let options = ["--rate", "rate_deg_h", "--unit", "deg/h"];
    let analyze = |out: &str, more: &[&str]| {
        sagnac(dir.path(), &[&["analyze", "my unit.csv", "--out", out], &options[..], more].concat()).out
    };
    let said = analyze("a", &[]);
    let step = "\n  sagnac init 'my unit.csv' --rate rate_deg_h --unit deg/h\n";
    assert!(said.ends_with(step), "{said}");
    // The command is carried out as it is shown.
    let done = sagnac(dir.path(), &["init", "my unit.csv", "--rate", "rate_deg_h", "--unit", "deg/h"]);
    assert_eq!(done.code, 0, "{done:?}");
    assert!(!analyze("b", &["--quiet"]).contains("sagnac init"));
    assert!(serde_json::from_str::<serde_json::Value>(&analyze("c", &["--format", "json"])).is_ok());
    // Nothing that looks like a gyro output: nothing to write a procedure for.
    std::fs::write(dir.path().join("t.csv"), "time_s,temp_degC\n0,20\n1,21\n2,22\n").unwrap();
    assert!(!sagnac(dir.path(), &["inspect", "t.csv"]).out.contains("sagnac init"));
    let run = |name: &str| {
        let (p, l) = (procedure(), crate::support::limits());
        sagnac(dir.path(), &["run", &p, &sample(name), "--limits", &l, "--serial", "SN-0001", "--out", name])
            .out
    };
    assert!(run("fail").ends_with(&format!("\n  sagnac explain {} --model MODEL.toml\n", sample("fail"))));
    assert!(run("pass").ends_with("Report: pass/report.html\n"));
}
