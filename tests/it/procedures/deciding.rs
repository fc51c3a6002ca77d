//! Limits from which no verdict can come, and slips of the pen in limits: `check` and `run` name them.

use crate::support::synthetic::recording;
use crate::support::{limits, procedure, result, sagnac, shipped, short_procedure};
use std::path::Path;
use tempfile::tempdir;

const HEAD: &str = "format = \"limits/1\"\n[limits]\nid = \"l\"\ntitle = \"L\"\nrevision = \"A\"\n";

fn written(folder: &Path, name: &str, rest: &str) -> String {
    std::fs::write(folder.join(name), format!("{HEAD}{rest}")).unwrap();
    name.to_owned()
}

#[test]
fn a_limits_file_that_decides_nothing_is_indeterminate_and_says_why() {
    let dir = tempdir().unwrap();
    std::fs::write(dir.path().join("r.csv"), recording(4000)).unwrap();
    let p = short_procedure(dir.path());
    let references = shipped("procedures/limits/oius-501.toml");
    let elsewhere = written(
        dir.path(),
        "other.toml",
        "[[limit]]\nmeasurand = \"scale_factor_nonlinearity\"\nmax = \"50 ppm\"\n",
    );
    let channel = written(
        dir.path(),
        "channel.toml",
        "[[limit]]\nmeasurand = \"angle_random_walk\"\nchannel = \"other\"\nmax = \"1 deg/sqrt(h)\"\n",
    );
    for (file, why) in [
        (references.as_str(), "has no limits"),
        (elsewhere.as_str(), "it cannot decide anything"),
        (channel.as_str(), "it cannot decide anything"),
    ] {
        let _ = std::fs::remove_dir_all(dir.path().join("r"));
        let said = sagnac(dir.path(), &["run", &p, "r.csv", "--serial", "S", "--limits", file, "--out", "r"]);
        // Conditions of so short a record may be invalid; the reason stands first whatever else is said.
        let sentences = said.out.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.code == 3 && sentences.contains(why), "{file}: {said:?}");
        let r = result(&dir.path().join("r"));
        assert_eq!(r["verdict"], "indeterminate");
        assert!(
            r["summary"][0]["text"].as_str().unwrap().contains("it cannot decide anything"),
            "{}",
            r["summary"]
        );
        let checked = sagnac(dir.path(), &["check", &p, file]);
        let named =
            checked.out.contains("it cannot decide anything") || checked.out.contains("gives no verdict");
        assert!(checked.code == 0 && named, "{file}: {checked:?}");
    }
}

#[test]
fn check_says_how_long_a_record_must_be_for_b_and_k() {
    let dir = tempdir().unwrap();
    let limits = |name: &str, expected: &str| {
        let rest = "[[limit]]\nmeasurand = \"bias_instability\"\nmax = \"0.005 deg/h\"\n\
                    [[limit]]\nmeasurand = \"angle_random_walk\"\nmax = \"0.003 deg/sqrt(h)\"\n";
        written(dir.path(), name, &format!("{expected}{rest}"))
    };
    let known = limits(
        "known.toml",
        "[expected]\nangle_random_walk = \"0.002 deg/sqrt(h)\"\nbias_instability = \"0.003 deg/h\"\n",
    );
    let checked = sagnac(dir.path(), &["check", &known]);
    let hours = |beginning: &str, text: &str| -> f64 {
        let line =
            text.lines().find(|l| l.trim_start().starts_with(beginning)).unwrap_or_else(|| panic!("{text}"));
        line.split(" by ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
    };
    let decided = hours("bias_instability <= 0.005 deg/h is decided", &checked.out);
    let resolved = hours("bias_instability = 0.003 deg/h, its typical value, is given a value", &checked.out);
    assert!((3.0..30.0).contains(&decided) && resolved > decided, "{decided} {resolved}");
    assert!(checked.out.contains("assumed: N = 0.002 °/√h, one sample per second"), "{}", checked.out);
    // Angle random walk is no slow term; a procedure states what is planned.
    assert!(!checked.out.contains("angle_random_walk <="), "{}", checked.out);
    let with = sagnac(dir.path(), &["check", &procedure(), &known]);
    assert!(with.out.contains("; planned: 100 h"), "{}", with.out);
    let unknown = limits("unknown.toml", "");
    let checked = sagnac(dir.path(), &["check", &unknown, "--lang", "ru"]);
    assert!(checked.out.contains("для bias_instability <= 0.005 deg/h, неизвестно"), "{}", checked.out);
    assert_eq!(checked.code, 0);
}

#[test]
fn without_limits_nothing_is_asked_and_the_verdict_is_none() {
    let dir = tempdir().unwrap();
    std::fs::write(
        dir.path().join("p.toml"),
        "format = \"procedure/1\"\n[procedure]\nid = \"p\"\ntitle = \"P\"\nrevision = \"A\"\n[unit_under_test]\n\
         serial_required = false\n[[channel]]\nid = \"time\"\ncolumn = 1\nrole = \"time\"\nunit = \"s\"\n[[channel]]\n\
         id = \"rate\"\ncolumn = 2\nrole = \"rate\"\nunit = \"deg/h\"\n[[measurand]]\nid = \"angle_random_walk\"\n",
    )
    .unwrap();
    std::fs::write(dir.path().join("r.csv"), recording(4000)).unwrap();
    let said = sagnac(dir.path(), &["run", "p.toml", "r.csv", "--out", "r"]);
    assert_eq!((said.code, result(&dir.path().join("r"))["verdict"].as_str()), (0, Some("none")), "{said:?}");
    let said = sagnac(dir.path(), &["check", "p.toml"]);
    assert!(said.code == 0 && said.out.contains("a verdict needs --limits"), "{said:?}");
    // A limits file of references over limits of the procedure decides nothing of its own.
    let own = std::fs::read_to_string(dir.path().join("p.toml")).unwrap()
        + "[[limit]]\nmeasurand = \"angle_random_walk\"\nmax = \"1000 deg/sqrt(h)\"\n";
    std::fs::write(dir.path().join("own.toml"), own).unwrap();
    let said = sagnac(dir.path(), &["run", "own.toml", "r.csv", "--out", "o"]);
    assert_eq!(said.code, 0, "{said:?}");
    let references = shipped("procedures/limits/oius-501.toml");
    let said = sagnac(dir.path(), &["run", "own.toml", "r.csv", "--limits", &references, "--out", "o2"]);
    assert_eq!(said.code, 3, "{said:?}");
}

#[test]
fn the_examples_of_the_help_judge() {
    let dir = tempdir().unwrap();
    for args in
        [&["--help"][..], &["run", "--help"], &["--help", "--lang", "ru"], &["run", "--help", "--lang", "ru"]]
    {
        let help = sagnac(dir.path(), args).out;
        // A narrow terminal wraps the line.
        let example = help.split("sagnac run procedures/").nth(1).unwrap();
        let mut words = example.split_whitespace().skip_while(|w| *w != "--limits");
        let file = words.nth(1).unwrap();
        let checked = sagnac(dir.path(), &["check", &procedure(), &shipped(file)]);
        assert!(checked.code == 0 && !checked.out.contains("0 limits, "), "{example}: {checked:?}");
        assert!(!checked.out.contains("it cannot decide anything"), "{example}: {checked:?}");
    }
}

#[test]
fn slips_of_the_pen_are_named() {
    let dir = tempdir().unwrap();
    let cases = [
        (
            "[[limit]]\nmeasurand = \"static_bias\"\nmax_abs = \"0.5 deg/s\"\n",
            "1800 deg/h: channel `rate` is read in deg/h",
        ),
        ("[[limit]]\nmeasurand = \"bias_instability\"\nmax = \"0.5 deg/s\"\n", "1800 deg/h: no working gyro"),
        (
            "[[limit]]\nmeasurand = \"static_bias\"\nmax_abs = \"2e-1 deg/s\"\n[[limit]]\nmeasurand = \"bias_instability\"\nmax = \"0.5 deg/h\"\n",
            "720 deg/h: the limit on `bias_instability`",
        ),
        (
            "[[reference]]\nmeasurand = \"angle_random_walk\"\nvalue = \"0.002 deg/sqrt(h)\"\nsource = \"s\"\n\
             [[limit]]\nmeasurand = \"angle_random_walk\"\nmax = \"7 deg/sqrt(h)\"\n",
            "far from its typical value",
        ),
        (
            "[[limit]]\nmeasurand = \"static_bias\"\nmax = \"-0.5 deg/h\"\n",
            "can be negative, and any value below",
        ),
        (
            "[[limit]]\nmeasurand = \"static_bias\"\nmax = \"0.5 deg/h\"\n",
            "can be negative, and any value below",
        ),
    ];
    for (text, why) in cases {
        let file = written(dir.path(), "l.toml", text);
        let said = sagnac(dir.path(), &["check", &procedure(), &file]);
        assert!(said.code == 0 && said.out.contains(why), "{text}: {}", said.out);
    }
    // No unit can meet it: an error, as before.
    let file =
        written(dir.path(), "l.toml", "[[limit]]\nmeasurand = \"bias_instability\"\nmax = \"-0.5 deg/h\"\n");
    let said = sagnac(dir.path(), &["check", &file]);
    assert!(said.code == 2 && said.out.contains("l.toml:8:7"), "{said:?}");
    // Units of the class, and those of a gyro that is read in deg/s, are no slips.
    let said = sagnac(dir.path(), &["check", &procedure(), &limits()]);
    assert!(!said.out.contains("check the unit"), "{}", said.out);
    let fast = std::fs::read_to_string(procedure()).unwrap().replace("unit = \"deg/h\"", "unit = \"deg/s\"");
    std::fs::write(dir.path().join("fast.toml"), fast).unwrap();
    let file =
        written(dir.path(), "l.toml", "[[limit]]\nmeasurand = \"static_bias\"\nmax_abs = \"0.5 deg/s\"\n");
    let said = sagnac(dir.path(), &["check", "fast.toml", &file]);
    assert!(!said.out.contains("check the unit"), "{}", said.out);
}

#[test]
fn instruments_without_a_serial_number_are_named() {
    let dir = tempdir().unwrap();
    let said = sagnac(dir.path(), &["check", &procedure()]);
    assert!(said.out.contains("without a serial number: thermal chamber, "), "{}", said.out);
    let text = std::fs::read_to_string(procedure()).unwrap();
    let named = text.replace("calibration_due", "serial = \"T-1\"\ncalibration_due");
    std::fs::write(dir.path().join("p.toml"), named).unwrap();
    let said = sagnac(dir.path(), &["check", "p.toml"]);
    assert!(!said.out.contains("serial number"), "{}", said.out);
}
