//! `sagnac simulate` and `sagnac effects` as a user has them.

use crate::support::{root, sagnac};
use sagnac::ingest::open;
use sagnac::series::{SeriesOptions, load_series};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use tempfile::tempdir;

fn model(name: &str) -> String {
    root().join("samples").join(name).display().to_string()
}

/// The columns of a recording, as the library reads them back.
fn columns(path: &Path) -> Vec<Vec<f64>> {
    let source = open(path).unwrap();
    let wanted: Vec<usize> = (0..source.columns().len()).collect();
    let mut out = vec![vec![]; wanted.len()];
    source
        .read(&wanted, &mut |block| {
            for (all, part) in out.iter_mut().zip(&block.columns) {
                all.extend_from_slice(part);
            }
            std::ops::ControlFlow::Continue(())
        })
        .unwrap();
    out
}

#[test]
fn a_model_becomes_the_same_recording_in_both_formats() {
    let dir = tempdir().unwrap();
    for out in ["a.csv", "a.parquet"] {
        let said = sagnac(dir.path(), &["simulate", &model("model-static.toml"), "--out", out]);
        assert_eq!(said.code, 0, "{said:?}");
        assert!(
            said.out.contains("36000 rows, 1 h at 10 Hz; columns time_s, rate_deg_h, temp_degC"),
            "{}",
            said.out
        );
        assert!(said.out.contains("seed 1\n"), "{}", said.out);
    }
    let (csv, parquet) = (columns(&dir.path().join("a.csv")), columns(&dir.path().join("a.parquet")));
    assert_eq!((csv.len(), csv[0].len()), (3, 36_000));
    assert!(csv == parquet, "every number reads back as the same number");
    assert_eq!((csv[0][0], csv[0][3], csv[0][35_999]), (0.0, 0.3, 3599.9));
    let left: Vec<String> = std::fs::read_dir(dir.path())
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

#[test]
fn bytes_depend_on_the_seed_and_on_nothing_else() {
    let dir = tempdir().unwrap();
    let make = |out: &str, seed: &str, threads: &str| {
        let status = std::process::Command::new(env!("CARGO_BIN_EXE_sagnac"))
            .args([
                "simulate",
                &model("model-static.toml"),
                "--out",
                out,
                "--seed",
                seed,
                "--duration",
                "20 min",
            ])
            .env("RAYON_NUM_THREADS", threads)
            .current_dir(dir.path())
            .output()
            .unwrap();
        assert!(status.status.success());
        std::fs::read(dir.path().join(out)).unwrap()
    };
    let one = make("one.csv", "5", "1");
    assert!(one == make("two.csv", "5", "2") && one == make("eight.csv", "5", "8"));
    assert!(one != make("other.csv", "6", "2"));
    assert!(make("one.parquet", "5", "1") == make("two.parquet", "5", "4"));
}

#[test]
fn quiet_prints_the_path_alone() {
    let dir = tempdir().unwrap();
    let arguments = ["simulate", &model("model-step.toml"), "--out", "q.csv", "--duration", "100 s"];
    for quiet in ["--quiet", "-q"] {
        let said = sagnac(dir.path(), &[&arguments[..], &[quiet]].concat());
        assert_eq!((said.code, said.out.as_str()), (0, "q.csv\n"), "{said:?}");
    }
    assert!(sagnac(dir.path(), &arguments).out.contains("seed"), "and all of it without the option");
}

#[test]
fn a_recording_lends_its_rows_and_columns() {
    let dir = tempdir().unwrap();
    let faulty = root().join("samples/unit-faults.csv");
    let text = std::fs::read_to_string(model("model-static.toml")).unwrap();
    std::fs::write(dir.path().join("m.toml"), text.replace("sample_rate_hz = 10", "sample_rate_hz = 1"))
        .unwrap();
    let like = faulty.display().to_string();
    let said = sagnac(dir.path(), &["simulate", "m.toml", "--out", "s.csv", "--like", &like]);
    assert_eq!(said.code, 0, "{said:?}");
    let read =
        |path: &Path| load_series(&[path.to_path_buf()], &SeriesOptions::default(), &mut |_, _| {}).unwrap();
    let (given, made) = (read(&faulty), read(&dir.path().join("s.csv")));
    assert!(given.time_s == made.time_s && given.columns == made.columns && given.index == made.index);
    // A row that was left out is missing now.
    let missing = given.faults.missing + given.faults.without_rate;
    assert_eq!((made.faults.missing, made.faults.without_rate, made.faults.without_time), (missing, 0, 0));
    assert!(given.faults.missing >= 90 && given.faults.without_rate + given.faults.without_time >= 3);
    for line in ["samples are missing in the recording", "rows of the recording: ", "[[driver]]"] {
        assert!(said.out.contains(line), "no `{line}` in\n{}", said.out);
    }
}

#[test]
fn what_cannot_be_made_is_refused_and_leaves_nothing() {
    let dir = tempdir().unwrap();
    let model = model("model-static.toml");
    std::fs::write(dir.path().join("own.csv"), "time_s,rate_deg_h\n0,1\n1,2\n2,3\n").unwrap();
    std::fs::write(dir.path().join("bare.toml"), "[recording]\nsample_rate_hz = 10\n").unwrap();
    for (arguments, said) in [
        (&["simulate", &*model, "--out", "a.txt"][..], "must end in .csv or .parquet"),
        (&["simulate", &model, "--out", "a.csv", "--duration", "10"], "no unit"),
        (&["simulate", &model, "--out", "a.csv", "--duration=-5 s"], "above 0"),
        (
            &["simulate", &model, "--out", "a.csv", "--duration", "3 deg"],
            "help: write a number with its unit",
        ),
        (&["simulate", &model, "--out", "a.csv", "--duration", "1e9 d"], "cannot simulate"),
        (&["simulate", "bare.toml", "--out", "a.csv"], "no length"),
        (&["simulate", "none.toml", "--out", "a.csv"], "cannot be read"),
        (&["simulate", &model, "--out", "own.csv", "--like", "own.csv"], "write to another file"),
        (&["simulate", &model, "--out", "a.csv", "--like", "own.csv"], "the recording is sampled at 1 Hz"),
        (
            &["simulate", &model, "--out", "a.csv", "--like", "own.csv", "--duration", "1h"],
            "are mutually exclusive",
        ),
        (&["simulate", &model, "--out", "a.csv", "--seed=-1"], "--seed"),
    ] {
        let found = sagnac(dir.path(), arguments);
        assert_eq!(found.code, 2, "{arguments:?}: {found:?}");
        assert!(found.err.contains(said), "{arguments:?}: no `{said}` in\n{}", found.err);
    }
    assert_eq!(std::fs::read_to_string(dir.path().join("own.csv")).unwrap().lines().count(), 4);
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 2);
}

#[test]
fn the_catalogue_is_listed_and_each_effect_explained() {
    let dir = tempdir().unwrap();
    let json: Value =
        serde_json::from_str(&sagnac(dir.path(), &["effects", "--format", "json"]).out).unwrap();
    let effects = json.as_array().unwrap();
    let list = sagnac(dir.path(), &["effects"]);
    let mut kinds = BTreeSet::new();
    for effect in effects {
        let kind = effect["kind"].as_str().unwrap();
        assert!(kinds.insert(kind) && list.out.contains(kind), "{kind}");
        for lang in ["en", "ru"] {
            let page = sagnac(dir.path(), &["effects", kind, "--lang", lang]);
            assert_eq!(page.code, 0, "{page:?}");
            let cyrillic = page.out.chars().filter(|c| matches!(c, 'а'..='я')).count();
            assert_eq!(cyrillic > 200, lang == "ru", "{}", page.out);
            for parameter in effect["parameters"].as_array().unwrap() {
                assert!(page.out.contains(parameter["name"].as_str().unwrap()), "{}", page.out);
            }
            // Sources are cited in the language of the page.
            let (_, source) =
                page.out.rsplit_once(if lang == "en" { "\nSource\n" } else { "\nИсточник\n" }).unwrap();
            assert!(source.trim().chars().count() > 8, "{}", page.out);
            let first = effect["source"].as_str().unwrap().split(' ').next().unwrap();
            assert!(lang == "ru" || source.contains(first), "{}", page.out);
            assert!(page.out.lines().all(|l| l.chars().count() <= 80), "{}", page.out);
        }
    }
    assert!(kinds.contains("bias_step"));
    let wrong = sagnac(dir.path(), &["effects", "bias-stp"]);
    assert_eq!(wrong.code, 2);
    assert!(wrong.err.contains("did you mean `bias_step`"), "{}", wrong.err);
}

#[test]
fn the_summary_speaks_russian() {
    let dir = tempdir().unwrap();
    let arguments =
        ["simulate", &model("model-step.toml"), "--out", "a.csv", "--duration", "600s", "--lang", "ru"];
    let said = sagnac(dir.path(), &arguments);
    assert_eq!(said.code, 0, "{said:?}");
    assert!(
        said.out.contains("строк 6000, 10 мин при 10 Гц") && said.out.contains("эффекты: bias_step"),
        "{}",
        said.out
    );
}
